//! Two rooms and a door that is ajar.

use super::SceneBuilder;
use super::finish::{Finishes, tiles};
use super::form::{Form, at, v};
use super::furniture::{self, DESK_HEIGHT, Room};
use super::variety::Variety;
use crate::material::Material;
use crate::reference::SceneDescription;
use crate::traits::Rgb;

/// The room of the camera.
const ROOM: Room = Room { x: [-4.0, -0.06], z: [-1.9, 1.9], height: 2.6 };
/// The room with the light.
const LIT: Room = Room { x: [0.06, 4.0], z: [-1.9, 1.9], height: 2.6 };
/// From where to where the doorway goes along z, and its height.
const DOORWAY: [f32; 3] = [-0.75, 0.15, 2.05];
/// By how much the door is open, in degrees.
const AJAR: f32 = 9.0;

/// Two rooms of 3.94 x 3.8 m, in metres, joined by a door that is ajar: a slit of about ten centimetres beside the leaf, and
/// a wedge above it. The only lamp hangs in the one, the camera is in the other.
///
/// A five-hundredth of the lamp's light gets through directly, and all that the camera sees comes through: photons and virtual point
/// lights end on the wrong side, shadow rays are blocked.
///
/// Source: Keller and Wald 2000, "Efficient Importance Sampling Techniques for the Photon Map", figure 4.
pub fn door_slit() -> SceneDescription {
    let mut b = SceneBuilder::new("door-slit");
    let f = Finishes::new(&mut b, Rgb::new(0.10, 0.17, 0.26));
    shell(&mut b, &f);
    dark_room(&mut b, &f);
    lit_room(&mut b, &f);
    b.look(v(-3.72, 1.6, 1.62), v(-0.75, 0.75, -0.62), 72.0, 640, 480);
    b.finish()
}

fn shell(b: &mut SceneBuilder, f: &Finishes) {
    let plaster = b.diffuse(0.76, 0.74, 0.69);
    let ceiling = b.diffuse(0.82, 0.82, 0.80);
    let boards = tiles(Rgb::new(0.47, 0.34, 0.22), Rgb::new(0.42, 0.295, 0.19), 16.0, 2.0);
    let boards = b.material(Material::diffuse(boards).two_sided());
    // One floor, one ceiling, and walls along both rooms.
    let both = Room { x: [ROOM.x[0], LIT.x[1]], ..ROOM };
    b.form(boards, &both.floor()).form(ceiling, &both.ceiling());
    b.form(plaster, &Form::all((0..4).map(|side| both.wall(side))));
    // The wall between them: beside the doorway and above it.
    let block = |[z0, z1]: [f32; 2], [y0, y1]: [f32; 2]| {
        Form::cuboid(0.5 * v(0.0, y0 + y1, z0 + z1), v(0.06, 0.5 * (y1 - y0), 0.5 * (z1 - z0)))
    };
    let [far, near, top] = DOORWAY;
    let blocks =
        [block([-1.92, far], [-0.02, 2.62]), block([near, 1.92], [-0.02, 2.62]), block([far, near], [top, 2.62])];
    b.form(plaster, &Form::all(blocks));
    // The leaf hangs at the far side and opens into the lit room. Its hinge side reaches into the wall, its lower edge into the
    // floor, so that light passes at its free side and above it only.
    let width = near - far;
    let leaf = Form::cuboid(v(0.5 * width, 0.5 * top, 0.0), v(0.5 * width + 0.02, 0.5 * top + 0.01, 0.02));
    let hinge = at(0.035, 0.0, far, AJAR - 90.0);
    b.form(f.wood, &leaf.moved(hinge));
    let lever = Form::cuboid(v(width - 0.1, 1.04, -0.05), v(0.06, 0.012, 0.01));
    let rose = Form::cuboid(v(width - 0.05, 1.04, -0.03), v(0.012, 0.012, 0.021));
    b.form(f.chrome, &lever.and(rose).moved(hinge));
}

fn dark_room(b: &mut SceneBuilder, f: &Finishes) {
    let desk = at(-2.2, 0.0, -1.38, 0.0);
    furniture::desk(b, f, desk, 1.6, 0.8);
    let on = |x: f32, z: f32, turn: f32| desk * at(x, DESK_HEIGHT, z, turn);
    furniture::monitor(b, f, on(-0.1, -0.15, 10.0));
    furniture::mug(b, f, on(0.5, 0.1, -40.0));
    let mut volumes = furniture::Volumes::default();
    volumes.pile(on(0.6, -0.2, 12.0), 5, &mut Variety::new(2));
    volumes.place(b, f);
    furniture::cantilever_chair(b, f, at(-1.55, 0.0, -0.35, 250.0));
    furniture::plant(b, f, at(-0.5, 0.0, 1.2, 0.0), 0.18, 0.75, 44, 4);
    furniture::picture(b, f, ROOM.wall_frame(0) * at(0.0, 1.65, 0.0, 0.0), [0.4, 0.3], [f.covers[1], f.covers[0]]);
}

fn lit_room(b: &mut SceneBuilder, f: &Finishes) {
    // It sees the slit at an angle, so that a sheet of light falls through it.
    let panel = at(1.4, LIT.height, 1.3, 0.0);
    furniture::ceiling_panel(b, f, panel, 0.9, 0.9, Rgb::new(1.0, 0.86, 0.68) * 1500.0);
    furniture::cantilever_chair(b, f, at(2.6, 0.0, -0.6, 240.0));
    furniture::sideboard(b, f, LIT.wall_frame(3) * at(0.0, 0.0, 0.225, 0.0), 1.4, 3);
}
