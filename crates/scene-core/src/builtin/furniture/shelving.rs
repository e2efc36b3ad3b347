//! Shelves, and the books and binders on them.

use core::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::Affine3A;

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, at, v};
use crate::builtin::variety::Variety;

/// Things on shelves, sorted by what they are made of.
#[derive(Default)]
pub(crate) struct Volumes {
    covers: [Form; 6],
    paper: Form,
    rings: Form,
}

impl Volumes {
    /// Adds a book that stands at `to`, its rounded spine towards +z.
    pub(crate) fn book(&mut self, to: Affine3A, [thickness, height, depth]: [f32; 3], cover: usize) {
        let x = 0.5 * thickness;
        let block = Form::cuboid(
            v(0.0, 0.5 * height, -0.5 * depth - 0.001),
            v(x - 0.0015, 0.5 * height - 0.003, 0.5 * depth - 0.003),
        );
        let board = |x: f32| Form::cuboid(v(x, 0.5 * height, -0.5 * depth), v(0.0012, 0.5 * height, 0.5 * depth));
        let spine = Form::patch(8, 1, |u, w| {
            let (sin, cos) = (PI * (u - 0.5)).sin_cos();
            v((x + 0.001) * sin, w * height, 0.25 * thickness * cos - 0.0002)
        });
        let case = Form::all([board(x), board(-x), spine]);
        append(&mut self.covers[cover], case.moved(to));
        append(&mut self.paper, block.moved(to));
    }

    /// Adds a binder, its back with label and ring towards +z.
    pub(crate) fn binder(&mut self, to: Affine3A, cover: usize) {
        let [x, y, z] = [0.037, 0.158, 0.14];
        append(&mut self.covers[cover], Form::rounded_box(v(0.0, y, -z), v(x, y, z), 0.005, 1).moved(to));
        let label = Form::cuboid(v(0.0, 0.2, 0.0), v(0.026, 0.07, 0.0012));
        append(&mut self.paper, label.moved(to));
        let circle: Vec<_> = (0..=12)
            .map(|i| (TAU * i as f32 / 12.0).sin_cos())
            .map(|(s, c)| v(0.011 * c, 0.07 + 0.011 * s, 0.001))
            .collect();
        append(&mut self.rings, Form::tube(&circle, [0.0022; 2], 5).moved(to));
    }

    /// Fills a board of `width` from its left end at `to`: books or binders, a gap here and there, one that leans.
    pub(crate) fn fill(&mut self, to: Affine3A, width: f32, clear: f32, variety: &mut Variety) {
        let binders = clear > 0.34 && variety.unit() < 0.35;
        let end = width * if variety.unit() < 0.5 { 0.98 } else { variety.between(0.55, 0.85) };
        let mut x = 0.006;
        let mut cover = variety.index(6);
        while x < end {
            if variety.unit() < 0.3 {
                cover = variety.index(6);
            }
            let depth = variety.between(-0.012, 0.004);
            if binders {
                if x + 0.08 > end {
                    break;
                }
                self.binder(to * at(x + 0.038, -0.001, 0.0 + depth, 0.0), cover);
                x += 0.0775;
                continue;
            }
            let size = [
                variety.between(0.016, 0.046),
                variety.between(0.58, 0.9) * clear.min(0.33),
                variety.between(0.15, 0.22),
            ];
            if x + size[0] > end {
                break;
            }
            self.book(to * at(x + 0.5 * size[0] + 0.002, -0.001, depth, 0.0), size, cover);
            x += size[0] + 0.0045;
        }
        // The last one leans against the others.
        let (lean, height) = (0.2f32, 0.22f32.min(0.7 * clear));
        let reach = height * lean.sin() + 0.06;
        if !binders && x + reach < width {
            let turn = Affine3A::from_rotation_z(lean);
            self.book(
                to * at(x + reach - 0.04, -0.001, 0.0, 0.0) * turn * at(0.013, 0.0, 0.0, 0.0),
                [0.024, height, 0.17],
                (cover + 1) % 6,
            );
        }
    }

    /// Adds a pile of lying books at `to`.
    pub(crate) fn pile(&mut self, to: Affine3A, count: u32, variety: &mut Variety) {
        let mut y = 0.001;
        for _ in 0..count {
            let size = [variety.between(0.018, 0.04), variety.between(0.22, 0.28), variety.between(0.16, 0.2)];
            let turn = at(0.0, y + 0.5 * size[0], 0.0, variety.between(-12.0, 12.0));
            let flat = Affine3A::from_rotation_z(FRAC_PI_2);
            self.book(to * turn * flat * at(0.0, -0.5 * size[1], 0.5 * size[2], 0.0), size, variety.index(6));
            y += size[0] + 0.0035;
        }
    }

    /// Places all of them.
    pub(crate) fn place(&self, b: &mut SceneBuilder, f: &Finishes) {
        for (form, material) in
            self.covers.iter().zip(f.covers).chain([(&self.paper, f.paper), (&self.rings, f.chrome)])
        {
            if !form.is_empty() {
                b.form(material, form);
            }
        }
    }
}

fn append(form: &mut Form, other: Form) {
    *form = core::mem::take(form).and(other);
}

/// A bookcase of `bays` bays of 0.8 m, `boards` boards high, 0.3 m deep, with its back at z = 0; filled, but for the
/// places `(bay, board)` in `empty`.
pub(crate) fn bookcase(
    b: &mut SceneBuilder,
    f: &Finishes,
    to: Affine3A,
    bays: u32,
    boards: u32,
    empty: &[(u32, u32)],
    variety: &mut Variety,
) {
    let (bay, pitch, depth) = (0.8, 0.37, 0.3);
    let (width, height) = (bay * bays as f32, pitch * boards as f32 + 0.08);
    let left = -0.5 * width;
    let side = |i: u32| {
        Form::rounded_box(
            v(left + bay * i as f32, 0.5 * height - 0.001, 0.5 * depth),
            v(0.011, 0.5 * height, 0.5 * depth),
            0.003,
            1,
        )
    };
    let level = |j: u32| 0.08 + pitch * j as f32;
    let board = |j: u32| {
        Form::rounded_box(
            v(0.0, level(j) - 0.011, 0.5 * depth - 0.004),
            v(0.5 * width + 0.002, 0.011, 0.5 * depth - 0.003),
            0.003,
            1,
        )
    };
    let back = Form::cuboid(v(0.0, 0.5 * height, 0.006), v(0.5 * width, 0.5 * height - 0.01, 0.003));
    b.form(f.wood, &Form::all((0..=bays).map(side)).and(Form::all((0..=boards).map(board))).moved(to));
    b.form(f.white, &back.moved(to));
    b.form(f.black, &Form::cuboid(v(0.0, 0.028, 0.14), v(0.5 * width - 0.005, 0.03, 0.12)).moved(to));
    let mut volumes = Volumes::default();
    for (i, j) in (0..bays).flat_map(|i| (0..boards).map(move |j| (i, j))) {
        if !empty.contains(&(i, j)) {
            let start = at(left + bay * i as f32 + 0.015, level(j), depth - 0.035, 0.0);
            volumes.fill(to * start, bay - 0.03, pitch - 0.03, variety);
        }
    }
    volumes.place(b, f);
}
