//! What rooms are fitted with: walls, doors, radiators, boards, pictures.

use core::f32::consts::PI;

use glam::{Affine3A, Quat, Vec3A};

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, v};
use crate::builtin::solids::rounded_path;
use crate::reference::MaterialId;

/// How far walls go on behind the corners, so that nothing shows through the edges.
const OVERLAP: f32 = 0.02;

/// A room with its floor at y = 0: `x`, `z` and height.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Room {
    /// From the left to the right wall.
    pub(crate) x: [f32; 2],
    /// From the far to the near wall.
    pub(crate) z: [f32; 2],
    /// Height of the ceiling.
    pub(crate) height: f32,
}

impl Room {
    /// The floor; texture coordinates go from 0 to 1 along x and z.
    pub(crate) fn floor(&self) -> Form {
        let ([x0, x1], [z0, z1]) = (self.x, self.z);
        let (x, z) = (x1 - x0 + 2.0 * OVERLAP, z1 - z0 + 2.0 * OVERLAP);
        Form::parallelogram(v(x0 - OVERLAP, 0.0, z1 + OVERLAP), v(x, 0.0, 0.0), v(0.0, 0.0, -z))
    }

    /// The ceiling.
    pub(crate) fn ceiling(&self) -> Form {
        let ([x0, x1], [z0, z1]) = (self.x, self.z);
        let (x, z) = (x1 - x0 + 2.0 * OVERLAP, z1 - z0 + 2.0 * OVERLAP);
        Form::parallelogram(v(x0 - OVERLAP, self.height, z0 - OVERLAP), v(x, 0.0, 0.0), v(0.0, 0.0, z))
    }

    /// The placement of a wall, from its own coordinates: x along it from its middle, y up, +z into the room.
    /// 0 is the far wall, 1 the left, 2 the near, 3 the right one.
    pub(crate) fn wall_frame(&self, wall: u32) -> Affine3A {
        let middle = 0.5 * v(self.x[0] + self.x[1], 0.0, self.z[0] + self.z[1]);
        let out = 0.5 * self.span(wall + 1);
        let turn = Quat::from_rotation_y(0.5 * PI * wall as f32);
        let position = middle - Vec3A::from(turn * glam::Vec3::Z) * out;
        Affine3A::from_rotation_translation(turn, position.into())
    }

    /// The length of a wall.
    pub(crate) fn span(&self, wall: u32) -> f32 {
        let [a, b] = if wall.is_multiple_of(2) { self.x } else { self.z };
        b - a
    }

    /// A wall.
    pub(crate) fn wall(&self, wall: u32) -> Form {
        let (x, y) = (0.5 * self.span(wall) + OVERLAP, self.height + 2.0 * OVERLAP);
        let plane = Form::parallelogram(v(-x, -OVERLAP, 0.0), v(2.0 * x, 0.0, 0.0), v(0.0, y, 0.0));
        plane.moved(self.wall_frame(wall))
    }

    /// A wall with an opening from `x[0]` to `x[1]` and `y[0]` to `y[1]` in its own coordinates, and a niche of the
    /// depth `depth` behind it.
    pub(crate) fn wall_with_niche(&self, wall: u32, x: [f32; 2], y: [f32; 2], depth: f32) -> Form {
        let end = 0.5 * self.span(wall) + OVERLAP;
        let (xs, ys) = ([-end, x[0], x[1], end], [-OVERLAP, y[0], y[1], self.height + OVERLAP]);
        let cells = (0..9).filter(|&k| k != 4).map(|k| (k % 3, k / 3));
        let around = cells.map(|(i, j)| {
            Form::parallelogram(v(xs[i], ys[j], 0.0), v(xs[i + 1] - xs[i], 0.0, 0.0), v(0.0, ys[j + 1] - ys[j], 0.0))
        });
        let (width, height, back) = (v(x[1] - x[0], 0.0, 0.0), v(0.0, y[1] - y[0], 0.0), v(0.0, 0.0, -depth));
        let corner = v(x[0], y[0], 0.0);
        let niche = [
            Form::parallelogram(corner + back, width, height),
            Form::parallelogram(corner, width, back),
            Form::parallelogram(corner + height, back, width),
            Form::parallelogram(corner, back, height),
            Form::parallelogram(corner + width, height, back),
        ];
        Form::all(around).and(Form::all(niche)).moved(self.wall_frame(wall))
    }

    /// Skirting boards along a wall, between two places.
    pub(crate) fn skirting(&self, b: &mut SceneBuilder, material: MaterialId, wall: u32, x: [f32; 2]) {
        let center = v(0.5 * (x[0] + x[1]), 0.039, 0.003);
        let board = Form::rounded_box(center, v(0.5 * (x[1] - x[0]), 0.04, 0.011), 0.005, 1);
        b.form(material, &board.moved(self.wall_frame(wall)));
    }
}

/// A closed door in its frame on the wall z = 0: 0.9 x 2.05 m, with panels and a handle.
pub(crate) fn door(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let post = |x: f32| Form::rounded_box(v(x, 1.05, 0.012), v(0.045, 1.052, 0.022), 0.006, 2);
    let lintel = Form::rounded_box(v(0.0, 2.115, 0.012), v(0.537, 0.045, 0.023), 0.006, 2);
    b.form(f.white, &Form::all([post(0.49), post(-0.49), lintel]).moved(to));
    let leaf = Form::rounded_box(v(0.0, 1.037, 0.005), v(0.443, 1.03, 0.014), 0.003, 1);
    // Mouldings around two panels.
    let moulding = |y: f32, half: f32| {
        let (x, z) = (0.3, 0.019);
        let corners = [
            v(0.0, y - half, z),
            v(x, y - half, z),
            v(x, y + half, z),
            v(-x, y + half, z),
            v(-x, y - half, z),
            v(0.0, y - half, z),
        ];
        Form::tube(&rounded_path(&corners, 0.01, 3), [0.012; 2], 10)
    };
    b.form(f.wood, &Form::all([leaf, moulding(0.55, 0.36), moulding(1.5, 0.44)]).moved(to));
    let rose = Form::lathe(&[[0.026, 0.0], [0.026, 0.006], [0.02, 0.009], [0.0, 0.009]], 32)
        .moved(Affine3A::from_rotation_translation(Quat::from_rotation_x(0.5 * PI), glam::vec3(-0.37, 1.04, 0.018)));
    let lever = rounded_path(&[v(-0.37, 1.04, 0.02), v(-0.37, 1.04, 0.07), v(-0.25, 1.04, 0.07)], 0.025, 6);
    b.form(f.chrome, &rose.and(Form::tube(&lever, [0.009; 2], 12)).moved(to));
}

/// A radiator with ribs in front of the wall z = 0.
pub(crate) fn radiator(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, width: f32) {
    let count = (width / 0.07) as u32;
    let rib = |i: u32| {
        let x = 0.07 * (i as f32 + 0.5 - 0.5 * count as f32);
        Form::cushion(v(x, 0.38, 0.1), v(0.022, 0.27, 0.045), 0.02, 2, [1; 3])
    };
    let pipe = |y: f32| Form::tube(&[v(-0.5 * width - 0.03, y, 0.1), v(0.5 * width + 0.03, y, 0.1)], [0.017; 2], 12);
    let supply = rounded_path(
        &[v(0.5 * width + 0.02, 0.18, 0.1), v(0.5 * width + 0.07, 0.18, 0.1), v(0.5 * width + 0.07, -0.002, 0.1)],
        0.03,
        5,
    );
    let bracket = |x: f32| Form::cuboid(v(x, 0.55, 0.04), v(0.01, 0.012, 0.043));
    let parts =
        [pipe(0.18), pipe(0.58), Form::tube(&supply, [0.012; 2], 12), bracket(0.3 * width), bracket(-0.3 * width)];
    b.form(f.white, &Form::all((0..count).map(rib)).and(Form::all(parts)).moved(to));
}

/// A white board with a tray and pens on the wall z = 0; the origin is its centre.
pub(crate) fn whiteboard(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, width: f32, height: f32) {
    let (x, y) = (0.5 * width, 0.5 * height);
    b.form(f.porcelain, &Form::cuboid(v(0.0, 0.0, 0.006), v(x - 0.005, y - 0.005, 0.008)).moved(to));
    let rail = |y: f32| Form::rounded_box(v(0.0, y, 0.009), v(x + 0.01, 0.012, 0.014), 0.006, 3);
    let post = |x: f32| Form::rounded_box(v(x, 0.0, 0.009), v(0.012, y, 0.013), 0.006, 3);
    let tray = Form::rounded_box(v(0.0, -y - 0.012, 0.045), v(0.3, 0.006, 0.045), 0.004, 2);
    b.form(f.aluminium, &Form::all([rail(y), rail(-y), post(x), post(-x), tray]).moved(to));
    for (i, cover) in [0, 1, 2, 4].into_iter().enumerate() {
        let start = v(0.14 * i as f32 - 0.25, 0.003 - y, 0.05 + 0.006 * i as f32);
        let pen = Form::tube(&[start, start + v(0.11, 0.0, 0.004)], [0.008; 2], 12);
        b.form(f.covers[cover], &pen.moved(to));
    }
}

/// A framed picture on the wall z = 0 with two fields of colour; the origin is its centre.
pub(crate) fn picture(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, half: [f32; 2], fields: [MaterialId; 2]) {
    let [x, y] = half;
    let rail = |y: f32| Form::rounded_box(v(0.0, y, 0.012), v(x + 0.014, 0.014, 0.016), 0.005, 2);
    let post = |x: f32| Form::rounded_box(v(x, 0.0, 0.012), v(0.0135, y, 0.0155), 0.005, 2);
    b.form(f.black, &Form::all([rail(y), rail(-y), post(x), post(-x)]).moved(to));
    b.form(f.paper, &Form::cuboid(v(0.0, 0.0, 0.007), v(x, y, 0.006)).moved(to));
    let field = |y: f32, half: f32| Form::cuboid(v(0.0, y, 0.008), v(0.68 * x, half, 0.0065)).moved(to);
    b.form(fields[0], &field(0.3 * y, 0.36 * y)).form(fields[1], &field(-0.45 * y, 0.3 * y));
}

/// A clock on the wall z = 0; the origin is its centre.
pub(crate) fn clock(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let forwards = to * Affine3A::from_rotation_x(0.5 * PI);
    let rim = [[0.15, -0.002], [0.155, 0.02], [0.15, 0.03], [0.14, 0.03], [0.136, 0.016]];
    b.form(f.aluminium, &Form::lathe(&rim, 48).moved(forwards));
    b.form(f.paper, &Form::disk(v(0.0, 0.018, 0.0), Vec3A::Y, 0.137, 48).moved(forwards));
    let hand = |angle: f32, length: f32, z: f32| {
        let (sin, cos) = angle.sin_cos();
        let tip = v(length * sin, length * cos, z);
        Form::tube(&[v(-0.2 * tip.x, -0.2 * tip.y, z), tip], [0.004, 0.002], 8)
    };
    let mark = |i: u32| {
        let (sin, cos) = (PI * i as f32 / 6.0).sin_cos();
        Form::tube(&[v(0.108 * sin, 0.108 * cos, 0.019), v(0.126 * sin, 0.126 * cos, 0.019)], [0.003; 2], 6)
    };
    let hands = [hand(5.45, 0.075, 0.024), hand(0.9, 0.11, 0.03)];
    b.form(f.black, &Form::all(hands).and(Form::all((0..12).map(mark))).moved(to));
}
