//! A fence of wires that are thinner than a pixel.

use core::f32::consts::PI;

use glam::{Affine3A, Vec3, Vec3A};

use super::SceneBuilder;
use super::finish::{lacquer, tiles};
use super::form::{Form, v};
use super::sky::sky_image;
use crate::material::Material;
use crate::reference::{Light, SceneDescription};
use crate::traits::Rgb;

/// Width and height of a mesh of the fence, and the radius of its wires.
const MESH: f32 = 0.06;
const WIRE: f32 = 0.0014;
/// Half the length of the fence, and its height.
const HALF_LENGTH: f32 = 3.6;
const HEIGHT: f32 = 1.5;
/// Distance between posts.
const BAY: f32 = 1.8;

/// A chain-link fence before a yard with a chequered ground, two walls and a few toys, under a clear sky with a low
/// sun ([`sky_image`]), in metres.
///
/// The wires are 2.8 mm thick, a mesh is 60 mm wide; at the size of 640 x 480 pixels a pixel covers 5 to 11 mm of the
/// fence, and the shadows of the wires on the ground are as thin. Made for anti-aliasing.
///
/// It stands in for the fence of Keller, Dahm and Binder 2014, "Path Space Filtering", figure 7.
pub fn fence() -> SceneDescription {
    let mut b = SceneBuilder::new("fence");
    let ground = tiles(Rgb::new(0.46, 0.43, 0.38), Rgb::new(0.20, 0.22, 0.21), 12.0, 12.0);
    let ground = b.material(Material::diffuse(ground).two_sided());
    b.quad(ground, v(-9.0, 0.0, -13.0), v(0.0, 0.0, 18.0), v(18.0, 0.0, 0.0));
    let zinc = b.diffuse(0.52, 0.54, 0.56);
    b.form(zinc, &chain_link());
    b.form(zinc, &frame());
    yard(&mut b);
    b.light(Light::Environment { image: sky_image(), scale: 1.0, to_world: Affine3A::IDENTITY });
    b.look(v(-2.3, 1.45, 3.3), v(0.55, 0.72, -0.6), 52.0, 640, 480);
    b.finish()
}

/// Zigzag wires that hook into their neighbours, in the plane z = 0.
fn chain_link() -> Form {
    let step = 0.5 * MESH;
    let wires = (2.0 * HALF_LENGTH / step).round() as u32;
    let bends = (HEIGHT / step).round() as u32;
    Form::all((0..wires).map(|wire| {
        let middle = -HALF_LENGTH + step * (wire as f32 + 0.5);
        let path: Vec<Vec3A> = (0..=bends)
            .map(|bend| {
                let side = if (bend + wire) % 2 == 0 { 1.0 } else { -1.0 };
                // Wires cross where they hook: one passes in front, the other behind.
                v(middle + side * 0.5 * step, 0.04 + step * bend as f32, side * WIRE)
            })
            .collect();
        Form::tube(&path, [WIRE; 2], 4)
    }))
}

/// Posts with caps, and a rail along the top.
fn frame() -> Form {
    let posts = (2.0 * HALF_LENGTH / BAY).round() as i32;
    let post = |i: i32| {
        let x = -HALF_LENGTH + BAY * i as f32;
        let profile = [[0.0, -0.001], [0.025, -0.001], [0.025, HEIGHT + 0.09], [0.0, HEIGHT + 0.115]];
        Form::lathe(&profile, 24).moved(Affine3A::from_translation(Vec3::new(x, 0.0, -0.03)))
    };
    let rail = |y: f32| {
        let ends = [-HALF_LENGTH, HALF_LENGTH].map(|x| v(x, y, -0.012));
        Form::tube(&ends, [0.009; 2], 16)
    };
    Form::all((0..=posts).map(post)).and(rail(0.04)).and(rail(HEIGHT + 0.03))
}

/// What is behind the fence.
fn yard(b: &mut SceneBuilder) {
    let plaster = b.diffuse(0.62, 0.55, 0.44);
    let brick = tiles(Rgb::new(0.42, 0.17, 0.11), Rgb::new(0.34, 0.13, 0.09), 14.0, 6.0);
    let brick = b.material(Material::diffuse(brick).two_sided());
    b.quad(brick, v(-9.0, 0.0, -6.5), v(18.0, 0.0, 0.0), v(0.0, 2.3, 0.0));
    b.cuboid(plaster, v(5.2, 1.0, -3.4), v(0.12, 1.0, 3.1), 0.0);
    let red = b.material(lacquer(Rgb::new(0.55, 0.05, 0.04), 0.1));
    let blue = b.diffuse(0.08, 0.19, 0.46);
    let yellow = b.diffuse(0.62, 0.46, 0.07);
    let green = b.diffuse(0.12, 0.34, 0.12);
    b.sphere(red, v(0.35, 0.45, -1.7), 0.45);
    b.cuboid(blue, v(1.9, 0.4, -2.6), v(0.4, 0.4, 0.4), 0.5);
    b.cuboid(yellow, v(2.02, 1.0, -2.55), v(0.2, 0.2, 0.2), 0.2 + 0.25 * PI);
    let barrel: Vec<[f32; 2]> = (0..=16)
        .map(|i| i as f32 / 16.0)
        .map(|t| [0.30 + 0.06 * (PI * t).sin(), 0.95 * t])
        .chain([[0.0, 0.95]])
        .collect();
    b.form(green, &Form::lathe(&barrel, 64).moved(Affine3A::from_translation(Vec3::new(-1.05, 0.0, -2.9))));
}

#[cfg(test)]
mod tests {
    use super::super::form::tests::normals_agree;
    use super::*;
    use crate::ray::Ray;
    use crate::reference::ReferenceScene;
    use crate::traits::{Scene, Sensor, Vertex};

    #[test]
    fn the_fence_is_thinner_than_a_pixel_and_lets_most_light_pass() {
        assert!(normals_agree(&frame()));
        let scene = ReferenceScene::new(fence()).unwrap();
        let (mut wires, mut all) = (0, 0);
        for i in 0..20_000 {
            let x = -1.5 + 3.0 * (i as f32 * 0.618_034).fract();
            let y = 0.2 + 1.0 * (i as f32 * 0.754_878).fract();
            let ray = Ray::new(v(x, y, 0.5), -Vec3A::Z);
            let hit = scene.intersect(&ray).map_or(1.0, |vertex| vertex.point().position.z.abs());
            wires += u32::from(hit < 0.005);
            all += 1;
        }
        // Per square of side MESH / 2 a wire of length 2^(1/2) MESH / 2 and of width 2 WIRE, less where it is bent:
        // up to 0.13.
        let share = wires as f32 / all as f32;
        assert!((0.07..0.14).contains(&share), "{share}");
        // A pixel at the fence's closest and farthest visible point.
        let [width, height] = scene.sensor().resolution();
        let middle = scene.sensor().sample_ray([0.5 * width as f32, 0.5 * height as f32], [0.5; 2]).ray;
        let next = scene.sensor().sample_ray([0.5 * width as f32 + 1.0, 0.5 * height as f32], [0.5; 2]).ray;
        let distance = -middle.origin.z / middle.direction.z;
        assert!((middle.direction - next.direction).length() * distance > 2.0 * WIRE);
    }
}
