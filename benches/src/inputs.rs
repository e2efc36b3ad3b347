//! Scenes, rays and directions, the same in every run.

use std::f32::consts::TAU;

use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::SceneBuilder;
use scene_core::glam::Vec3A;
use scene_core::reference::{Light, SceneDescription, Shape};
use scene_core::{Ray, ReferenceScene, Rgb, Scene, SceneError, Sensor, Vertex};

/// The scene with an image of `width` times `height` pixels.
///
/// # Errors
/// If the scene cannot be built, or has no pixel.
pub fn sized(mut description: SceneDescription, width: u32, height: u32) -> Result<ReferenceScene, SceneError> {
    (description.camera.width, description.camera.height) = (width, height);
    ReferenceScene::new(description)
}

/// A bumpy ball of 131,072 triangles in uniform light.
pub fn blob() -> SceneDescription {
    const ROWS: u32 = 256;
    let mut builder = SceneBuilder::new("blob");
    let grey = builder.diffuse(0.5, 0.5, 0.5);
    let profile: Vec<[f32; 2]> = (0..=ROWS)
        .map(|row| {
            let angle = 0.01 + (0.5 * TAU - 0.02) * row as f32 / ROWS as f32;
            let radius = 1.0 + 0.1 * (12.0 * angle).sin();
            [radius * angle.sin(), -radius * angle.cos()]
        })
        .collect();
    builder.lathe(grey, Vec3A::ZERO, &profile, 256);
    builder.light(Light::Constant { radiance: Rgb::ONE });
    builder.look(Vec3A::new(0.0, 0.5, 3.0), Vec3A::ZERO, 45.0, 64, 64);
    builder.finish()
}

/// All triangles of a scene's meshes, in world coordinates; spheres and disks are left out.
pub fn triangles_of(description: &SceneDescription) -> Vec<[Vec3A; 3]> {
    let mut triangles = Vec::new();
    for instance in &description.instances {
        if let Some(Shape::Mesh(mesh)) = description.shapes.get(instance.shape.0 as usize) {
            let place = |corners: [Vec3A; 3]| corners.map(|p| instance.to_world.transform_point3a(p));
            triangles.extend((0..mesh.len()).map(|i| place(mesh.corners(i))));
        }
    }
    triangles
}

/// Rays from the sensor through random points of the film: coherent in origin, of unlimited length.
pub fn camera_rays(scene: &ReferenceScene, count: usize) -> Vec<Ray> {
    let [width, height] = scene.sensor().resolution().map(|n| n as f32);
    let mut numbers = Independent::new(1).sampler(0, 0);
    let mut ray = || {
        let [x, y] = numbers.next_2d();
        scene.sensor().sample_ray([x * width, y * height], [0.5; 2]).ray
    };
    (0..count).map(|_| ray()).collect()
}

/// Rays between random pairs of visible points on surfaces: incoherent, of bounded length, as visibility rays are.
/// Fewer than `count` if little of the scene is seen.
pub fn segments(scene: &ReferenceScene, count: usize) -> Vec<Ray> {
    let points: Vec<_> =
        camera_rays(scene, 2 * count).iter().filter_map(|ray| scene.intersect(ray)).map(|v| *v.point()).collect();
    let half = points.len() / 2;
    (0..half.min(count)).map(|i| points[i].ray_to(&points[half + i])).collect()
}

/// Unit vectors, uniform over the hemisphere around +z.
pub fn directions(count: usize) -> Vec<Vec3A> {
    let mut numbers = Independent::new(2).sampler(0, 0);
    let mut direction = || {
        let [z, turn] = numbers.next_2d();
        let (sin, cos) = (TAU * turn).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        Vec3A::new(radius * cos, radius * sin, z)
    };
    (0..count).map(|_| direction()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brute_force;
    use scene_core::builtin::interior;

    #[test]
    fn the_blob_is_as_large_as_promised_and_hit_as_brute_force_hits_it() {
        let description = blob();
        let triangles = triangles_of(&description);
        assert_eq!(triangles.len(), 131_072);
        let scene = ReferenceScene::new(description).unwrap();
        assert_eq!(scene.triangle_count(), 131_072);
        let rays: Vec<Ray> = camera_rays(&scene, 20).into_iter().chain(segments(&scene, 10)).collect();
        for ray in &rays {
            let distance = scene.intersect(ray).map(|v| (v.point().position - ray.origin).length());
            match (distance, brute_force(&triangles, ray)) {
                (Some(fast), Some(plain)) => assert!((fast - plain).abs() < 1e-4, "{ray:?}"),
                (None, None) => (),
                other => panic!("{ray:?} {other:?}"),
            }
            assert_eq!(scene.occluded(ray), distance.is_some());
        }
        assert!(rays.len() > 25);
    }

    #[test]
    fn inputs_are_what_they_say() {
        assert!(matches!(sized(interior(), 0, 8), Err(SceneError::Camera(_))));
        let scene = sized(interior(), 16, 9).unwrap();
        assert_eq!(scene.sensor().resolution(), [16, 9]);
        assert!(segments(&scene, 64).iter().all(|ray| ray.max_distance.is_finite()));
        assert!(directions(64).iter().all(|w| w.z >= 0.0 && (w.length() - 1.0).abs() < 1e-5));
    }
}
