//! Very many rooms with a lamp each.

use glam::{Affine3A, Vec3A};

use super::SceneBuilder;
use super::finish::{Finishes, tiles};
use super::form::{Form, at, v};
use super::furniture::{self, DESK_HEIGHT};
use super::variety::Variety;
use crate::material::Material;
use crate::reference::{MaterialId, SceneDescription, Shape};
use crate::traits::Rgb;

/// Distance between the middles of neighbouring rooms.
const PITCH: f32 = 4.0;
/// Half of the thickness of walls.
const WALL: f32 = 0.06;
const HEIGHT: f32 = 2.6;
/// Half of the width of doorways, and their height.
const DOORWAY: [f32; 2] = [0.34, 1.95];
/// How far a doorway may lie from the middle of its wall.
const DOORWAY_OFFSET: f32 = 0.9;
/// Half of the side of lamps.
const LAMP: f32 = 0.25;
/// Up to this number, all rooms have chairs and tables with legs.
const FURNISHED_IN_DETAIL: u32 = 200;

/// `columns` times `rows` rooms of 3.88 x 3.88 m, each with a square lamp below its ceiling and a few pieces of
/// furniture, in metres. The camera stands in a room in the middle.
///
/// Each wall between two rooms has a narrow doorway at another place, so that a room is lit by its own lamp, to a small
/// part by those of its neighbours, and by hardly any other. The powers of the lamps differ by up to a factor of five. Rooms are
/// simpler where there are more than 200 of them: 10,000 have about a million triangles.
///
/// The builtin scenes are `rooms` (10 x 10), `rooms-1000` (40 x 25) and `rooms-10000` (100 x 100). Numbers of zero count
/// as one, and those above 512 as 512.
///
/// Source: Keller and Wald 2000, "Efficient Importance Sampling Techniques for the Photon Map", figures 1, 2 and 5.
pub fn rooms(columns: u32, rows: u32) -> SceneDescription {
    let (columns, rows) = (columns.clamp(1, 512), rows.clamp(1, 512));
    let mut b = SceneBuilder::new("rooms");
    let f = Finishes::new(&mut b, Rgb::new(0.30, 0.09, 0.07));
    let mut variety = Variety::new(71);
    shell(&mut b, columns, rows, &mut variety);
    let here = [columns / 2, rows / 2];
    furniture(&mut b, &f, [columns, rows], here, &mut variety);
    lamps(&mut b, &f, [columns, rows], &mut variety);
    let middle = middle(here);
    studio(&mut b, &f, middle);
    b.look(middle + v(1.78, 1.62, 1.74), middle + v(-0.75, 0.85, -0.85), 76.0, 640, 480);
    b.finish()
}

/// The point of the floor in the middle of a room.
fn middle([i, j]: [u32; 2]) -> Vec3A {
    PITCH * v(i as f32 + 0.5, 0.0, j as f32 + 0.5)
}

/// All rooms, row by row.
fn all([columns, rows]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..rows).flat_map(move |j| (0..columns).map(move |i| [i, j]))
}

/// Floor, ceiling and walls.
fn shell(b: &mut SceneBuilder, columns: u32, rows: u32, variety: &mut Variety) {
    let plaster = b.diffuse(0.74, 0.72, 0.67);
    let ceiling = b.diffuse(0.80, 0.80, 0.78);
    let boards = tiles(Rgb::new(0.45, 0.33, 0.22), Rgb::new(0.40, 0.285, 0.185), 4.0 * columns as f32, rows as f32);
    let boards = b.material(Material::diffuse(boards).two_sided());
    let size = PITCH * v(columns as f32, 0.0, rows as f32);
    let (corner, x, z) = (v(-0.2, 0.0, -0.2), v(size.x + 0.4, 0.0, 0.0), v(0.0, 0.0, size.z + 0.4));
    b.form(boards, &Form::parallelogram(corner, z, x));
    b.form(ceiling, &Form::parallelogram(corner + v(0.0, HEIGHT, 0.0), x, z));
    let mut walls = Form::default();
    for [i, j] in all([columns, rows]) {
        let center = middle([i, j]);
        // Each room has the walls on the side of greater coordinates; the outermost ones those of lesser, too.
        for (turn, side, inner) in [(0.0, 1.0, j + 1 < rows), (90.0, 1.0, i + 1 < columns)] {
            let offset = variety.between(-DOORWAY_OFFSET, DOORWAY_OFFSET);
            walls = walls.and(wall(inner.then_some(offset)).moved(placed(center, turn, side)));
        }
        for (turn, outer) in [(0.0, j == 0), (90.0, i == 0)] {
            if outer {
                walls = walls.and(wall(None).moved(placed(center, turn, -1.0)));
            }
        }
    }
    b.form(plaster, &walls);
}

/// The placement of a wall of a room: turned by `degrees`, and moved to one of the two sides.
fn placed(center: Vec3A, degrees: f32, side: f32) -> Affine3A {
    Affine3A::from_translation(center.into()) * at(0.0, 0.0, 0.0, degrees) * at(0.0, 0.0, 0.5 * side * PITCH, 0.0)
}

/// A wall along x around the origin, with a doorway at `doorway`.
fn wall(doorway: Option<f32>) -> Form {
    // Beyond floor and ceiling, and through the walls that cross at the ends.
    let (end, [bottom, top]) = (0.5 * PITCH, [-0.02, HEIGHT + 0.02]);
    let block = |[x0, x1]: [f32; 2], [y0, y1]: [f32; 2]| {
        Form::cuboid(0.5 * v(x0 + x1, y0 + y1, 0.0), v(0.5 * (x1 - x0), 0.5 * (y1 - y0), WALL))
    };
    let Some(middle) = doorway else { return block([-end, end], [bottom, top]) };
    let [left, right] = [middle - DOORWAY[0], middle + DOORWAY[0]];
    Form::all([
        block([-end, left], [bottom, top]),
        block([right, end], [bottom, top]),
        block([left, right], [DOORWAY[1], top]),
    ])
}

/// Tables, chairs and cupboards of all rooms but `here`.
fn furniture(b: &mut SceneBuilder, f: &Finishes, size: [u32; 2], here: [u32; 2], variety: &mut Variety) {
    let finishes = [f.wood, f.white, f.fabric, f.grey, f.covers[1], f.covers[2]];
    let mut forms: Vec<(MaterialId, Form)> = finishes.map(|finish| (finish, Form::default())).into();
    let mut add = |index: usize, form: Form| forms[index].1 = core::mem::take(&mut forms[index].1).and(form);
    let in_detail = size[0] * size[1] <= FURNISHED_IN_DETAIL;
    for room in all(size).filter(|room| *room != here) {
        let turn = 90.0 * variety.index(4) as f32 + variety.between(-12.0, 12.0);
        let center = Affine3A::from_translation(middle(room).into());
        let to = center * at(variety.between(-0.5, 0.5), 0.0, variety.between(-0.5, 0.5), turn);
        let top = variety.index(2);
        if in_detail {
            add(top, table().moved(to));
            for (z, degrees) in [(0.62, 180.0), (-0.62, 0.0)] {
                add(2 + variety.index(4), chair().moved(to * at(variety.between(-0.25, 0.25), 0.0, z, degrees)));
            }
        } else {
            add(top, Form::cuboid(v(0.0, 0.36, 0.0), v(0.6, 0.361, 0.38)).moved(to));
        }
        // In the corner between two walls, where no doorway reaches.
        let corner = at(0.0, 0.0, 0.0, 90.0 * variety.index(4) as f32);
        let half = v(0.30, variety.between(0.45, 1.0), 0.18);
        let cupboard = Form::cuboid(v(1.92 - half.x, half.y - 0.001, half.z - 1.92), half);
        add(variety.index(6), cupboard.moved(center * corner));
    }
    for (finish, form) in &forms {
        if !form.is_empty() {
            b.form(*finish, form);
        }
    }
}

fn table() -> Form {
    let leg = |x: f32, z: f32| Form::cuboid(v(x, 0.349, z), v(0.03, 0.35, 0.03));
    let legs = [leg(-0.56, -0.33), leg(0.56, -0.33), leg(-0.56, 0.33), leg(0.56, 0.33)];
    Form::cuboid(v(0.0, 0.715, 0.0), v(0.62, 0.02, 0.39)).and(Form::all(legs))
}

/// A chair, its front towards +z.
fn chair() -> Form {
    let seat = Form::cuboid(v(0.0, 0.43, 0.0), v(0.21, 0.025, 0.2));
    let foot = Form::cuboid(v(0.0, 0.2, 0.0), v(0.05, 0.206, 0.05));
    seat.and(foot).and(Form::cuboid(v(0.0, 0.66, -0.2), v(0.2, 0.21, 0.02)))
}

fn lamps(b: &mut SceneBuilder, f: &Finishes, size: [u32; 2], variety: &mut Variety) {
    // They share one square.
    let mut square = SceneBuilder::new("lamp");
    square.quad(f.lamp, v(-LAMP, 0.0, -LAMP), v(2.0 * LAMP, 0.0, 0.0), v(0.0, 0.0, 2.0 * LAMP));
    let shape: Option<Shape> = square.finish().shapes.pop();
    for (k, room) in all(size).enumerate() {
        let place = middle(room) + v(variety.between(-0.6, 0.6), HEIGHT - 0.03, variety.between(-0.6, 0.6));
        let to = Affine3A::from_translation(place.into());
        match &shape {
            Some(shape) if k == 0 => b.place(shape.clone(), f.lamp, to),
            _ => b.place_again(f.lamp, to),
        };
        let hue = variety.unit();
        b.emit(Rgb::new(1.0, 0.84 - 0.10 * hue, 0.68 - 0.24 * hue) * variety.between(10.0, 50.0));
    }
}

/// The room of the camera.
fn studio(b: &mut SceneBuilder, f: &Finishes, middle: Vec3A) {
    let room = Affine3A::from_translation(middle.into());
    let desk = room * at(-0.35, 0.0, -0.35, 24.0);
    furniture::desk(b, f, desk, 1.4, 0.75);
    let on = |x: f32, z: f32, turn: f32| desk * at(x, DESK_HEIGHT, z, turn);
    furniture::mug(b, f, on(0.3, 0.1, 30.0));
    furniture::papers(b, f, on(-0.15, 0.08, 10.0), 6, 3);
    let mut volumes = furniture::Volumes::default();
    volumes.pile(on(-0.5, -0.15, 15.0), 4, &mut Variety::new(4));
    volumes.place(b, f);
    furniture::cantilever_chair(b, f, room * at(0.1, 0.0, 0.42, 200.0));
    furniture::plant(b, f, room * at(-1.62, 0.0, -1.62, 0.0), 0.17, 0.7, 40, 4);
    furniture::basket(b, f, room * at(0.75, 0.0, -0.7, 0.0));
}
