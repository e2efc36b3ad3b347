//! Glass and metal that focus light onto diffuse surfaces.

use core::f32::consts::PI;

use glam::Affine3A;

use super::SceneBuilder;
use super::finish::{Finishes, tiles};
use super::form::{Form, v};
use super::furniture::Room;
use crate::material::{Material, conductors};
use crate::reference::{SceneDescription, Shape};
use crate::traits::Rgb;

/// A polished metal by its name in [`conductors`], on both sides.
fn polished(name: &str) -> Material {
    let (eta, k) = conductors::named(name).unwrap_or((Rgb::ZERO, Rgb::ONE));
    Material::Conductor { eta, k, specular_reflectance: 1.0.into() }.two_sided()
}

/// A ring of metal sheet around the vertical: its radius, height and thickness.
fn ring(radius: f32, height: f32, thickness: f32) -> Form {
    let outer = radius + thickness;
    Form::lathe(&[[radius, -0.001], [outer, -0.001], [outer, height], [radius, height], [radius, -0.001]], 192)
}

/// A glass ball and a golden ring on a diffuse floor under a small disk light, in metres: the two classical caustics, of the kinds
/// `L S S D` (through the ball) and `L S D` (the cardioid in the ring), and nothing else but the shadows.
///
/// The light is a disk with a diameter of 0.2 m at a height of 2.4 m. All of the floor that the camera sees is lit directly outside of the shadows;
/// path tracing finds the caustics only by chance, when a diffuse bounce hits the light through glass or mirror.
pub fn glass_ball() -> SceneDescription {
    let mut b = SceneBuilder::new("glass-ball");
    let floor = b.diffuse(0.7, 0.68, 0.64);
    b.quad(floor, v(-3.0, 0.0, -3.0), v(0.0, 0.0, 6.0), v(6.0, 0.0, 0.0));
    let clear = b.material(Material::glass(1.5));
    b.sphere(clear, v(-0.36, 0.30, -0.12), 0.27);
    let gold = b.material(polished("Au"));
    b.form(gold, &ring(0.30, 0.16, 0.012).moved(Affine3A::from_translation(glam::vec3(0.40, 0.0, 0.16))));
    let dark = b.diffuse(0.0, 0.0, 0.0);
    // The disk's normal is +z: turned to shine at the middle of the floor.
    let position = v(1.75, 1.55, 0.35);
    let turn = glam::Quat::from_rotation_arc(glam::Vec3::Z, (v(0.0, 0.1, 0.0) - position).normalize().into());
    let to_world = Affine3A::from_scale_rotation_translation(glam::Vec3::splat(0.1), turn, position.into());
    b.place(Shape::Disk, dark, to_world).emit(Rgb::new(360.0, 338.0, 300.0));
    b.look(v(-0.25, 1.40, 1.75), v(-0.14, 0.04, 0.05), 48.0, 640, 480);
    b.finish()
}

const ROOM: Room = Room { x: [-2.0, 2.0], z: [-1.6, 1.6], height: 2.4 };

/// A closed room of 4 x 3.2 m with things of glass and metal on a table, in metres, lit via a bright wall only: a lamp in a
/// deep black box shines at the white left wall from close by, and no point but those of this wall sees it.
///
/// So the caustics on the table come from an indirect source, which a projection map at the lamp could not find: a glass ball, a solid cylinder of
/// glass, a silver ring and a copper bowl focus the light of the patch on the wall.
///
/// Source of the idea: Keller and Wald 2000, "Efficient Importance Sampling Techniques for the Photon Map", section 2.2 and figure 3.
pub fn caustic_room() -> SceneDescription {
    let mut b = SceneBuilder::new("caustic-room");
    let f = Finishes::new(&mut b, Rgb::splat(0.3));
    let white = b.diffuse(0.86, 0.85, 0.83);
    let wall = b.diffuse(0.55, 0.55, 0.58);
    let accent = b.diffuse(0.30, 0.38, 0.42);
    let slabs = tiles(Rgb::new(0.36, 0.33, 0.30), Rgb::new(0.32, 0.29, 0.26), 4.0, 3.0);
    let slabs = b.material(Material::diffuse(slabs).two_sided());
    b.form(slabs, &ROOM.floor()).form(wall, &ROOM.ceiling());
    b.form(accent, &ROOM.wall(0)).form(white, &ROOM.wall(1)).form(wall, &ROOM.wall(2).and(ROOM.wall(3)));
    lamp(&mut b);
    table(&mut b, &f);
    b.look(v(1.0, 1.62, 1.32), v(-0.30, 0.80, -0.02), 50.0, 640, 480);
    b.finish()
}

/// A black box under the ceiling, open towards the left wall, with the lamp deep in it.
fn lamp(b: &mut SceneBuilder) {
    let black = b.diffuse(0.02, 0.02, 0.02);
    let dark = b.diffuse(0.0, 0.0, 0.0);
    let ([x0, x1], [y0, y1], z) = ([-1.72, -1.32], [1.38, 1.58], 0.1);
    let block = |x: [f32; 2], y: [f32; 2], z: [f32; 2]| {
        let low = v(x[0], y[0], z[0]);
        let high = v(x[1], y[1], z[1]);
        Form::cuboid(0.5 * (low + high), 0.5 * (high - low))
    };
    let t = 0.01;
    let sides = [
        block([x0, x1], [y0 - t, y0], [-z - t, z + t]),
        block([x0, x1], [y1, y1 + t], [-z - t, z + t]),
        block([x0, x1], [y0 - t, y1 + t], [-z - t, -z]),
        block([x0, x1], [y0 - t, y1 + t], [z, z + t]),
        block([x1, x1 + t], [y0 - t, y1 + t], [-z - t, z + t]),
        // What it hangs from.
        block([-1.53, -1.51], [y1, ROOM.height + 0.01], [-0.01, 0.01]),
    ];
    b.form(black, &Form::all(sides));
    let (half, middle) = (0.05, 0.5 * (y0 + y1));
    b.quad(dark, v(x1 - 0.02, middle - half, -half), v(0.0, 0.0, 2.0 * half), v(0.0, 2.0 * half, 0.0));
    b.emit(Rgb::new(1.0, 0.90, 0.76) * 14000.0);
}

fn table(b: &mut SceneBuilder, f: &Finishes) {
    const TOP: f32 = 0.72;
    let cloth = b.diffuse(0.72, 0.70, 0.66);
    b.form(cloth, &Form::rounded_box(v(-0.3, TOP - 0.02, 0.0), v(0.75, 0.02, 0.62), 0.01, 2));
    let leg = |x: f32, z: f32| Form::rounded_box(v(x, 0.35, z), v(0.03, 0.352, 0.03), 0.01, 2);
    b.form(f.wood, &Form::all([leg(-0.98, -0.54), leg(0.38, -0.54), leg(-0.98, 0.54), leg(0.38, 0.54)]));
    let to = |x: f32, z: f32| Affine3A::from_translation(glam::vec3(x, TOP, z));
    let clear = b.material(Material::glass(1.5));
    b.sphere(clear, v(-0.55, TOP + 0.151, -0.22), 0.15);
    let solid = [[0.0, 0.001], [0.085, 0.001], [0.09, 0.006], [0.09, 0.254], [0.085, 0.26], [0.0, 0.26]];
    b.form(clear, &Form::lathe(&solid, 96).moved(to(-0.62, 0.22)));
    let silver = b.material(polished("Ag"));
    b.form(silver, &ring(0.16, 0.09, 0.006).moved(to(-0.12, 0.12)));
    let copper = b.material(polished("Cu"));
    b.form(copper, &bowl().moved(to(0.1, -0.3)));
}

/// An open bowl of sheet metal, 0.3 m wide.
fn bowl() -> Form {
    let arc = |radius: f32, i: u32| {
        let angle = 0.48 * PI * i as f32 / 24.0;
        [radius * angle.sin(), 0.151 - radius * angle.cos()]
    };
    let outside = (0..=24).map(|i| arc(0.15, i));
    let inside = (0..=24).rev().map(|i| arc(0.144, i));
    Form::lathe(&outside.chain(inside).collect::<Vec<_>>(), 128)
}
