//! A furnished office.

use glam::Affine3A;

use super::SceneBuilder;
use super::finish::{Finishes, tiles};
use super::form::{Form, at, v};
use super::furniture::{self, DESK_HEIGHT, Room};
use super::variety::Variety;
use crate::reference::SceneDescription;
use crate::traits::Rgb;

const ROOM: Room = Room { x: [-3.0, 3.0], z: [-2.6, 2.6], height: 2.8 };

/// An office of 6 x 5.2 m for two in the evening, in metres. Its lamps shine at the ceiling and at the walls, so that
/// little of what the camera sees is lit by one of them directly; it has many concave corners, and things that stand closely
/// together.
///
/// It stands in for the office of Kollig and Keller 2004, "On the Efficiency of Multiple Importance Sampling: Robust
/// Instant Global Illumination", figure 6, which was never published.
pub fn office() -> SceneDescription {
    let mut b = SceneBuilder::new("office");
    let f = Finishes::new(&mut b, Rgb::new(0.10, 0.17, 0.26));
    room(&mut b, &f);
    lamps(&mut b, &f);
    shelves(&mut b, &f);
    desk_at_the_window(&mut b, &f);
    desk_in_the_middle(&mut b, &f);
    near_side(&mut b, &f);
    b.look(v(2.62, 1.56, 2.28), v(-0.62, 0.88, -1.1), 58.0, 640, 480);
    b.finish()
}

/// The colour of the lamps at a radiance.
fn warm(radiance: f32) -> Rgb {
    Rgb::new(1.0, 0.83, 0.62) * radiance
}

fn room(b: &mut SceneBuilder, f: &Finishes) {
    let wall = b.diffuse(0.76, 0.73, 0.66);
    let ceiling = b.diffuse(0.84, 0.83, 0.81);
    let carpet = tiles(Rgb::new(0.42, 0.38, 0.32), Rgb::new(0.37, 0.335, 0.28), 6.0, 5.0);
    let carpet = b.material(crate::material::Material::diffuse(carpet).two_sided());
    b.form(carpet, &ROOM.floor()).form(ceiling, &ROOM.ceiling());
    b.form(wall, &Form::all([0, 2, 3].map(|side| ROOM.wall(side))));
    // The window in the left wall.
    b.form(wall, &ROOM.wall_with_niche(1, [-0.3, 1.5], [0.95, 2.25], 0.2));
    let left = ROOM.wall_frame(1);
    furniture::window(b, f, left * at(0.6, 0.95, 0.0, 0.0), [0.9, 0.65]);
    furniture::blind(b, f, left * at(0.6, 2.25, -0.075, 0.0), 0.885, 0.95, 1.0);
    furniture::radiator(b, f, left * at(0.6, 0.0, 0.0, 0.0), 1.5);
    let far = ROOM.wall_frame(0);
    furniture::door(b, f, far * at(1.0, 0.0, 0.0, 0.0));
    furniture::clock(b, f, far * at(1.0, 2.42, 0.0, 0.0));
    for (side, x) in
        [(0, [-3.0, -2.12]), (0, [0.32, 0.46]), (0, [1.54, 3.0]), (1, [-2.6, 2.6]), (2, [-3.0, 3.0]), (3, [-2.6, 2.6])]
    {
        ROOM.skirting(b, f.white, side, x);
    }
}

/// All of the lamps but two shine upwards.
fn lamps(b: &mut SceneBuilder, f: &Finishes) {
    for z in [-0.75, 1.05] {
        furniture::pendant(b, f, at(-0.1, ROOM.height, z, 0.0), 1.7, 0.6, warm(75.0));
    }
    furniture::torchiere(b, f, at(-2.58, 0.0, -2.18, 0.0), warm(55.0));
    furniture::cove(b, f, ROOM.wall_frame(0) * at(-0.9, 1.93, 0.09, 0.0), 2.3, warm(7.0));
    furniture::sconce(b, f, ROOM.wall_frame(1) * at(-0.85, 1.75, 0.0, 0.0), warm(30.0));
    for x in [-1.2, 1.2] {
        furniture::sconce(b, f, ROOM.wall_frame(3) * at(x, 1.75, 0.0, 0.0), warm(60.0));
    }
}

fn shelves(b: &mut SceneBuilder, f: &Finishes) {
    let mut variety = Variety::new(5);
    let to = ROOM.wall_frame(0) * at(-0.9, 0.0, -0.001, 0.0);
    furniture::bookcase(b, f, to, 3, 5, &[(1, 3), (2, 1)], &mut variety);
    let level = |j: f32| 0.08 + 0.37 * j;
    let mut volumes = furniture::Volumes::default();
    volumes.pile(to * at(-0.2, level(3.0), 0.15, 0.0), 4, &mut variety);
    volumes.pile(to * at(0.62, level(1.0), 0.15, 0.0), 6, &mut variety);
    volumes.place(b, f);
    furniture::plant(b, f, to * at(0.16, level(3.0), 0.15, 0.0), 0.07, 0.2, 26, 2);
    furniture::trays(b, f, to * at(1.0, level(1.0), 0.165, 0.0));
}

fn desk_at_the_window(b: &mut SceneBuilder, f: &Finishes) {
    let to = at(-2.37, 0.0, -0.55, 90.0);
    furniture::desk(b, f, to, 1.8, 0.8);
    let on = |x: f32, z: f32, turn: f32| to * at(x, DESK_HEIGHT, z, turn);
    furniture::monitor(b, f, on(-0.05, -0.16, 4.0));
    furniture::keyboard(b, f, on(-0.05, 0.17, 0.0));
    furniture::mouse(b, f, on(0.32, 0.18, -10.0));
    furniture::mug(b, f, on(0.45, -0.06, 40.0));
    furniture::papers(b, f, on(-0.56, 0.16, 8.0), 7, 21);
    furniture::pens(b, f, on(0.55, -0.25, 0.0));
    furniture::desk_lamp(b, f, on(-0.68, -0.22, 25.0), warm(30.0));
    furniture::telephone(b, f, on(0.72, 0.1, -20.0));
    furniture::computer(b, f, to * at(0.55, 0.0, -0.05, 0.0));
    furniture::office_chair(b, f, at(-1.58, 0.0, -0.42, 244.0));
}

fn desk_in_the_middle(b: &mut SceneBuilder, f: &Finishes) {
    let to = at(0.15, 0.0, -0.75, -6.0);
    furniture::desk(b, f, to, 1.7, 0.8);
    let on = |x: f32, z: f32, turn: f32| to * at(x, DESK_HEIGHT, z, turn);
    furniture::monitor(b, f, on(0.28, -0.17, -14.0));
    furniture::monitor(b, f, on(-0.36, -0.17, 14.0));
    furniture::keyboard(b, f, on(-0.02, 0.18, 3.0));
    furniture::mouse(b, f, on(0.36, 0.2, 0.0));
    furniture::trays(b, f, on(-0.68, -0.2, 8.0));
    furniture::notepad(b, f, on(-0.45, 0.2, 14.0));
    furniture::mug(b, f, on(0.5, 0.02, -60.0));
    furniture::desk_lamp(b, f, on(0.74, -0.25, -35.0), warm(30.0));
    let mut volumes = furniture::Volumes::default();
    volumes.pile(on(0.7, 0.16, 10.0), 3, &mut Variety::new(9));
    volumes.place(b, f);
    furniture::drawers(b, f, to * at(0.5, 0.0, -0.02, 0.0), 0.42, 0.6, 3);
    furniture::office_chair(b, f, at(0.0, 0.0, 0.1, 205.0));
    furniture::cantilever_chair(b, f, at(1.16, 0.0, 0.1, 207.0));
    furniture::basket(b, f, at(1.5, 0.0, -0.85, 0.0));
    furniture::plant(b, f, at(-2.6, 0.0, 0.78, 30.0), 0.2, 0.95, 46, 4);
}

/// What stands beside the camera and behind it.
fn near_side(b: &mut SceneBuilder, f: &Finishes) {
    let right = ROOM.wall_frame(3);
    furniture::sideboard(b, f, right * at(0.9, 0.0, 0.225, 0.0), 1.6, 4);
    let top = |x: f32, z: f32| right * at(0.9 + x, 0.746, 0.225 + z, 0.0);
    furniture::plant(b, f, top(-0.5, 0.0), 0.11, 0.4, 30, 8);
    furniture::jug(b, f, top(0.3, 0.0));
    for x in [0.5, 0.62] {
        furniture::cup(b, f, top(x, 0.05));
    }
    furniture::whiteboard(b, f, ROOM.wall_frame(2) * at(-0.6, 1.5, 0.0, 0.0), 1.8, 1.1);
    let frame: Affine3A = right * at(0.9, 1.45, 0.0, 0.0);
    furniture::picture(b, f, frame, [0.3, 0.4], [f.covers[1], f.covers[3]]);
}
