//! The Cornell box.

use glam::Vec3A;

use super::SceneBuilder;
use crate::reference::SceneDescription;
use crate::traits::Rgb;

/// The Cornell box, with the geometry that was measured at Cornell University (in metres here), and the usual linear RGB
/// values of its spectra.
///
/// Source: <https://www.graphics.cornell.edu/online/box/data.html> (Goral et al. 1984; data of 1998).
pub fn cornell_box() -> SceneDescription {
    let mut b = SceneBuilder::new("cornell-box");
    let white = b.diffuse(0.725, 0.71, 0.68);
    let red = b.diffuse(0.63, 0.065, 0.05);
    let green = b.diffuse(0.14, 0.45, 0.091);
    let dark = b.diffuse(0.0, 0.0, 0.0);
    let p = |x: f32, y: f32, z: f32| Vec3A::new(x, y, z) * 0.001;

    let floor = [p(552.8, 0.0, 0.0), p(0.0, 0.0, 0.0), p(0.0, 0.0, 559.2), p(549.6, 0.0, 559.2)];
    let ceiling = [p(556.0, 548.8, 0.0), p(556.0, 548.8, 559.2), p(0.0, 548.8, 559.2), p(0.0, 548.8, 0.0)];
    let back = [p(549.6, 0.0, 559.2), p(0.0, 0.0, 559.2), p(0.0, 548.8, 559.2), p(556.0, 548.8, 559.2)];
    b.quads(white, &[floor, ceiling, back]);
    b.quads(green, &[[p(0.0, 0.0, 559.2), p(0.0, 0.0, 0.0), p(0.0, 548.8, 0.0), p(0.0, 548.8, 559.2)]]);
    b.quads(red, &[[p(552.8, 0.0, 0.0), p(549.6, 0.0, 559.2), p(556.0, 548.8, 559.2), p(556.0, 548.8, 0.0)]]);

    // The blocks stand on the floor: a lid and four walls.
    let block = |lid: [[f32; 2]; 4], height: f32| {
        let top = lid.map(|[x, z]| p(x, height, z));
        let wall = |i: usize| {
            let ([x0, z0], [x1, z1]) = (lid[i], lid[(i + 1) % 4]);
            [p(x0, 0.0, z0), p(x0, height, z0), p(x1, height, z1), p(x1, 0.0, z1)]
        };
        [top, wall(0), wall(1), wall(2), wall(3)]
    };
    b.quads(white, &block([[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]], 165.0));
    b.quads(white, &block([[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]], 330.0));

    // The light lies just below the ceiling and shines down.
    let y = 548.7;
    b.quads(dark, &[[p(343.0, y, 227.0), p(343.0, y, 332.0), p(213.0, y, 332.0), p(213.0, y, 227.0)]]);
    b.emit(Rgb::new(17.0, 12.0, 4.0));

    // Focal length 35 mm on a film of 25 mm.
    let fov = 2.0 * (0.0125f32 / 0.035).atan();
    b.look(p(278.0, 273.0, -800.0), p(278.0, 273.0, 0.0), fov.to_degrees(), 512, 512);
    b.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use crate::reference::ReferenceScene;
    use crate::traits::{Emitter, Scene, Spectrum, Vertex};

    #[test]
    fn the_light_has_its_power_and_shines_down() {
        let scene = ReferenceScene::new(cornell_box()).unwrap();
        assert_eq!(scene.triangle_count(), 2 * (3 + 1 + 1 + 5 + 5 + 1));
        let power = scene.emitters()[0].power();
        assert!((power[0] / (core::f32::consts::PI * 0.130 * 0.105 * 17.0) - 1.0).abs() < 1e-3);
        let up = Ray::new(Vec3A::new(0.278, 0.3, 0.28), Vec3A::Y);
        assert_eq!(scene.intersect(&up).unwrap().emitted(), Rgb::new(17.0, 12.0, 4.0));
        // Geometric normals point into the room, so that one-sided materials would do as well.
        for direction in [Vec3A::X, -Vec3A::X, Vec3A::Y, -Vec3A::Y, Vec3A::Z] {
            let ray = Ray::new(Vec3A::new(0.278, 0.45, 0.15), direction);
            assert!(scene.intersect(&ray).unwrap().point().normal.dot(direction) < 0.0, "{direction}");
        }
        let out = Ray::new(Vec3A::new(0.278, 0.3, 0.28), -Vec3A::Z);
        assert!(scene.intersect(&out).is_none() && scene.environment_radiance(out.direction).is_black());
    }
}
