//! A conference room.

use super::SceneBuilder;
use super::finish::{Finishes, tiles};
use super::form::{Form, at, v};
use super::furniture::{self, DESK_HEIGHT, Room};
use crate::reference::SceneDescription;
use crate::traits::Rgb;

const ROOM: Room = Room { x: [-4.0, 4.0], z: [-2.7, 2.7], height: 2.9 };
/// Where the table stands, along x.
const TABLE: f32 = -0.35;

/// A conference room of 8 x 5.4 m with a long table and twelve chairs, in metres. Eight panels below the ceiling light it
/// directly, a cove above the panelled wall indirectly.
///
/// It stands in for the conference room of Kollig and Keller 2004, "On the Efficiency of Multiple Importance Sampling:
/// Robust Instant Global Illumination", figure 6, which was never published.
pub fn conference() -> SceneDescription {
    let mut b = SceneBuilder::new("conference");
    let f = Finishes::new(&mut b, Rgb::new(0.33, 0.10, 0.06));
    room(&mut b, &f);
    lamps(&mut b, &f);
    seats(&mut b, &f);
    on_the_table(&mut b, &f);
    along_the_walls(&mut b, &f);
    b.look(v(3.62, 1.72, 2.28), v(-1.1, 0.78, -0.65), 64.0, 640, 480);
    b.finish()
}

fn room(b: &mut SceneBuilder, f: &Finishes) {
    let wall = b.diffuse(0.74, 0.72, 0.67);
    let ceiling = b.diffuse(0.80, 0.80, 0.78);
    let carpet = tiles(Rgb::new(0.33, 0.34, 0.36), Rgb::new(0.29, 0.30, 0.32), 8.0, 5.4);
    let carpet = b.material(crate::material::Material::diffuse(carpet).two_sided());
    b.form(carpet, &ROOM.floor()).form(ceiling, &ROOM.ceiling());
    b.form(wall, &Form::all([0, 1, 3].map(|side| ROOM.wall(side))));
    // Two windows in the near wall.
    b.form(wall, &ROOM.wall_with_niche(2, [-2.4, 2.4], [0.9, 2.4], 0.2));
    let near = ROOM.wall_frame(2);
    for x in [-1.2, 1.2] {
        furniture::window(b, f, near * at(x, 0.9, 0.0005 * x, 0.0), [1.2, 0.75]);
        furniture::blind(b, f, near * at(x, 2.4, -0.075, 0.0), 1.18, 1.4, 0.5);
    }
    furniture::door(b, f, ROOM.wall_frame(1) * at(-1.75, 0.0, 0.0, 0.0));
    for (side, x) in [(1, [-1.2, 2.7]), (2, [-4.0, 4.0]), (3, [-2.7, 2.7])] {
        ROOM.skirting(b, f.white, side, x);
    }
    // The grid of a suspended ceiling.
    let bar = b.diffuse(0.7, 0.7, 0.68);
    let y = ROOM.height - 0.003;
    let along = (1..9).map(|i| Form::rounded_box(v(0.0, y, 0.6 * i as f32 - 2.7), v(4.01, 0.006, 0.011), 0.003, 1));
    let across = (1..13).map(|i| Form::rounded_box(v(0.6 * i as f32 - 3.9, y, 0.0), v(0.011, 0.007, 2.71), 0.003, 1));
    b.form(bar, &Form::all(along.chain(across)));
    // The panelled wall.
    let far = ROOM.wall_frame(0);
    let panel = |i: u32| Form::rounded_box(v(1.33 * (i as f32 - 2.5), 1.2, 0.012), v(0.655, 1.09, 0.016), 0.008, 3);
    b.form(f.wood, &Form::all((0..6).map(panel)).moved(far));
    let plinth = Form::rounded_box(v(0.0, 0.05, 0.006), v(4.01, 0.052, 0.012), 0.004, 2);
    b.form(f.black, &plinth.moved(far));
}

fn lamps(b: &mut SceneBuilder, f: &Finishes) {
    for (x, z) in (0..4).flat_map(|i| [-0.9, 0.9].map(|z| (1.8 * i as f32 - 3.0, z))) {
        furniture::ceiling_panel(b, f, at(x, ROOM.height, z, 0.0), 1.18, 0.28, Rgb::new(1.0, 0.93, 0.82) * 19.0);
    }
    let cove = ROOM.wall_frame(0) * at(0.0, 2.36, 0.064, 0.0);
    furniture::cove(b, f, cove, 7.9, Rgb::new(1.0, 0.80, 0.56) * 12.0);
    furniture::projector(b, f, at(0.0, ROOM.height, 0.0, 270.0));
}

fn seats(b: &mut SceneBuilder, f: &Finishes) {
    furniture::conference_table(b, f, at(TABLE, 0.0, 0.0, 0.0), 4.6, 1.35);
    // Nobody puts chairs back exactly.
    let shifts = [[0.0, 0.06, 3.0], [0.03, 0.0, -4.0], [-0.04, 0.1, 8.0], [0.0, 0.02, 2.0], [0.05, 0.16, -22.0]];
    for (i, [dx, dz, turn]) in shifts.into_iter().enumerate() {
        let x = TABLE + 0.82 * (i as f32 - 2.0);
        furniture::cantilever_chair(b, f, at(x + dx, 0.0, 0.72 + dz, 180.0 + turn));
        let [dx, dz, turn] = shifts[(i + 2) % 5];
        furniture::cantilever_chair(b, f, at(x - dx, 0.0, -0.72 - dz, 0.5 * turn));
    }
    furniture::cantilever_chair(b, f, at(TABLE - 2.42, 0.0, 0.03, 90.0));
    furniture::cantilever_chair(b, f, at(TABLE + 2.5, 0.0, -0.05, 262.0));
}

fn on_the_table(b: &mut SceneBuilder, f: &Finishes) {
    let on = |x: f32, z: f32, turn: f32| at(TABLE + x, DESK_HEIGHT, z, turn);
    furniture::conference_phone(b, f, on(0.1, 0.3, 20.0) * at(0.0, 0.0, -0.02, 0.0));
    for (i, x) in [-1.64, -0.82, 0.0, 0.82, 1.64].into_iter().enumerate() {
        let turn = 7.0 * (i as f32 - 2.0);
        furniture::notepad(b, f, on(x, 0.46, 180.0 + turn));
        furniture::notepad(b, f, on(x, -0.46, -turn));
        if i != 2 {
            furniture::cup(b, f, on(x + 0.26, 0.38, 30.0 * turn));
            furniture::cup(b, f, on(x - 0.26, -0.38, 110.0 + turn));
        }
    }
    furniture::jug(b, f, on(-1.2, 0.17, 30.0));
    furniture::jug(b, f, on(1.1, -0.2, 200.0));
    furniture::papers(b, f, on(0.42, 0.36, 195.0), 6, 31);
    furniture::papers(b, f, on(-1.28, -0.42, 12.0), 4, 32);
}

fn along_the_walls(b: &mut SceneBuilder, f: &Finishes) {
    let left = ROOM.wall_frame(1);
    furniture::whiteboard(b, f, left * at(0.75, 1.5, 0.0, 0.0), 2.3, 1.3);
    furniture::clock(b, f, left * at(-0.85, 2.3, 0.0, 0.0));
    let far = ROOM.wall_frame(0);
    furniture::sideboard(b, f, far * at(1.6, 0.0, 0.245, 0.0), 2.0, 4);
    let top = |x: f32, z: f32| far * at(1.6 + x, 0.746, 0.245 + z, 0.0);
    furniture::jug(b, f, top(-0.6, 0.0));
    for i in 0..4 {
        furniture::cup(b, f, top(-0.38 + 0.16 * (i / 2) as f32, 0.09 - 0.16 * (i % 2) as f32));
    }
    furniture::plant(b, f, top(0.6, 0.0), 0.12, 0.45, 34, 12);
    furniture::plant(b, f, at(-3.55, 0.0, -2.2, 0.0), 0.22, 1.1, 50, 13);
    furniture::picture(b, f, far * at(0.65, 1.5, 0.027, 0.0), [0.45, 0.34], [f.covers[1], f.covers[0]]);
    furniture::basket(b, f, at(-3.7, 0.0, 0.75, 0.0));
}
