//! Scenes whose light is known in closed form: polygonal lights, furnaces, and the rays of the camera.

#![cfg(feature = "reference")]
// Helper functions of tests may unwrap.
#![allow(clippy::unwrap_used)]

use core::ops::ControlFlow;
use std::f64::consts::PI;
use std::sync::Arc;

use estimator_checks::{
    Check, ChiSquare, Domain, Hemisphere, Moments, Outcome, Sphere, Suite, Truth, Uniforms, mean_is,
};
use qmc_sampling::{Independent, SamplerFamily};
use scene_core::builtin::{SceneBuilder, furnace, furnace_box};
use scene_core::glam::{Affine3A, DVec3, Vec3A};
use scene_core::material::{Distribution, Material, conductors};
use scene_core::reference::{CameraDescription, PerspectiveCamera, Shape, TriangleMesh};
use scene_core::{
    Emitter, Frame, Ray, ReferenceScene, Rgb, RussianRoulette, Scene, Sensor, Spectrum, TransportMode, Vertex,
    WalkStart, random_walk,
};

static SUITE: Suite = Suite::with_share("scene-core closed forms", 64, 8e-8);

/// Lambert's formula for the irradiance of a polygon of unit radiance in front of a surface element:
/// `E = 1/2 sum over edges of angle(r_i, r_{i+1}) n . (r_i x r_{i+1}) / |r_i x r_{i+1}|` (Lambert 1760; Arvo 1994, equation 2).
fn lambert(polygon: &[Vec3A], from: Vec3A, normal: Vec3A) -> f64 {
    let at = |i: usize| (polygon[i % polygon.len()].as_dvec3() - from.as_dvec3()).normalize();
    let edge = |i: usize| {
        let (a, b): (DVec3, DVec3) = (at(i), at(i + 1));
        a.angle_between(b) * normal.as_dvec3().dot(a.cross(b).normalize())
    };
    (0.5 * (0..polygon.len()).map(edge).sum::<f64>()).abs()
}

const RECTANGLE: [[f32; 2]; 4] = [[-1.0, -0.5], [0.5, -0.5], [0.5, 0.75], [-1.0, 0.75]];
const PENTAGON: [[f32; 2]; 5] = [[-0.7, -0.6], [0.4, -0.9], [1.1, 0.1], [0.2, 0.8], [-0.8, 0.5]];

/// A grey floor and a lamp above it that shines down: the polygon, tilted.
fn lamp(corners: &[[f32; 2]]) -> (ReferenceScene, Vec<Vec3A>) {
    let place = Affine3A::from_translation(scene_core::glam::Vec3::new(0.3, 1.5, -0.2))
        * Affine3A::from_rotation_x(0.5 + std::f32::consts::FRAC_PI_2)
        * Affine3A::from_rotation_y(0.2);
    let polygon: Vec<Vec3A> = corners.iter().map(|&[x, y]| place.transform_point3a(Vec3A::new(x, y, 0.0))).collect();
    let positions = corners.iter().map(|&[x, y]| [x, y, 0.0]).collect();
    let fan = (1..corners.len() as u32 - 1).map(|i| [0, i, i + 1]).collect();
    let mesh = TriangleMesh::new(positions, vec![], vec![], fan).unwrap();
    let mut b = SceneBuilder::new("lamp");
    let grey = b.diffuse(0.6, 0.6, 0.6);
    let black = b.diffuse(0.0, 0.0, 0.0);
    b.quad(grey, Vec3A::new(-4.0, 0.0, -4.0), Vec3A::Z * 8.0, Vec3A::X * 8.0);
    b.place(Shape::Mesh(Arc::new(mesh)), black, place).emit(Rgb::splat(2.0));
    (ReferenceScene::new(b.finish()).unwrap(), polygon)
}

/// Estimates of the radiance that leaves a vertex, by sampling the emitter.
fn next_event(scene: &ReferenceScene, vertex: &impl Vertex<Spectrum = Rgb>, uniforms: &mut Uniforms) -> f64 {
    let [u, v] = uniforms.array::<2>().map(|x| x as f32);
    let Some(light) = scene.emitters()[0].sample_direct(vertex.point().position, [u, v]) else { return 0.0 };
    let visible = light.at.is_none_or(|(at, _)| scene.visible(vertex.point(), &at));
    let value = vertex.eval(light.wi, TransportMode::Radiance) * light.radiance * (1.0 / light.pdf_solid_angle);
    if visible { f64::from(value.mean()) } else { 0.0 }
}

/// The same by scattering.
fn scattering(scene: &ReferenceScene, vertex: &impl Vertex<Spectrum = Rgb>, uniforms: &mut Uniforms) -> f64 {
    let u = uniforms.array::<3>().map(|x| x as f32);
    let Some(sample) = vertex.sample(u, TransportMode::Radiance) else { return 0.0 };
    let light = scene.intersect(&vertex.spawn_ray(sample.wi)).map_or(Rgb::ZERO, |hit| hit.emitted());
    f64::from((sample.throughput * light).mean())
}

#[test]
fn polygonal_lights_follow_lamberts_formula() {
    for (name, corners) in [("rectangle", &RECTANGLE[..]), ("pentagon", &PENTAGON[..])] {
        let (scene, polygon) = lamp(corners);
        for (x, z) in [(0.3, -0.2), (-1.5, 1.0), (2.0, 0.4)] {
            let from = Vec3A::new(x, 0.0, z);
            let vertex = scene.intersect(&Ray::new(Vec3A::new(x, 0.2, z), -Vec3A::Y)).unwrap();
            let truth = 0.6 / PI * 2.0 * lambert(&polygon, from, Vec3A::Y);
            let run = |check: Check, n: usize, estimate: &dyn Fn(&mut Uniforms) -> f64, truth: f64| -> Outcome {
                let mut uniforms = check.uniforms();
                let moments: Moments = (0..n).map(|_| estimate(&mut uniforms)).collect();
                mean_is(check, &moments, Truth::relative(truth, 1e-5))
            };
            let by_light = |uniforms: &mut Uniforms| next_event(&scene, &vertex, uniforms);
            let by_scattering = |uniforms: &mut Uniforms| scattering(&scene, &vertex, uniforms);
            run(SUITE.check(&format!("{name} {x}: emitter")), 40_000, &by_light, truth).expect_pass();
            run(SUITE.check(&format!("{name} {x}: scattering")), 40_000, &by_scattering, truth).expect_pass();
            run(SUITE.twin(&format!("{name} {x}: 3 %")), 40_000, &by_light, 1.03 * truth).expect_reject();
        }
    }
}

const ROULETTES: [RussianRoulette; 3] = [
    RussianRoulette::Never,
    RussianRoulette::LocalAlbedo { from_length: 1 },
    RussianRoulette::PathThroughput { from_length: 3 },
];

/// In a closed box of albedo `rho` that emits `L_e` everywhere the radiance is `L = L_e / (1 - rho)`: walks from the camera
/// collect it, and walks from the lamps, with flux `pi A L_e`, bring the flux `pi A L` to the walls.
#[test]
fn the_furnace_box_glows_as_the_geometric_series() {
    let (rho, emitted, area) = (0.5f32, 3.0f32, 24.0);
    let scene = ReferenceScene::new(furnace_box(rho, emitted)).unwrap();
    let truth = f64::from(emitted) / (1.0 - f64::from(rho));
    let family = Independent::new(7);
    // Walks without roulette are cut where 2^-40 of the light is left.
    let walk = |start: WalkStart<Rgb>, index: u64, value: &dyn Fn(Rgb, Rgb) -> f32| -> f64 {
        let mut sum = 0.0;
        random_walk(&scene, start, &mut family.sampler(1, index), |walk| {
            sum += f64::from(value(walk.throughput, walk.vertex.emitted()));
            ControlFlow::Continue(())
        });
        sum
    };
    for roulette in ROULETTES {
        let check = SUITE.check(&format!("furnace box: camera, {roulette:?}"));
        let mut uniforms = check.uniforms();
        let from_camera: Moments = (0..4000)
            .map(|i| {
                let [x, y] = uniforms.array::<2>().map(|x| 64.0 * x as f32);
                let ray = scene.sensor().sample_ray([x, y], [0.5; 2]).ray;
                let (mode, throughput) = (TransportMode::Radiance, Rgb::ONE);
                walk(WalkStart { ray, throughput, mode, max_length: 40, roulette }, i, &|beta, l| (beta * l).mean())
            })
            .collect();
        mean_is_or_equals(check, &from_camera, truth);

        let check = SUITE.check(&format!("furnace box: light, {roulette:?}"));
        let mut uniforms = check.uniforms();
        let from_light: Moments = (0..4000)
            .map(|i| {
                let u = uniforms.array::<4>().map(|x| x as f32);
                let emission = scene.emitters()[0].sample_emission([u[0], u[1]], [u[2], u[3]]).unwrap();
                let ray = emission.point.ray_along(emission.direction);
                let (mode, throughput) = (TransportMode::Importance, emission.flux);
                walk(WalkStart { ray, throughput, mode, max_length: 40, roulette }, i, &|beta, _| beta.mean())
            })
            .collect();
        mean_is_or_equals(check, &from_light, truth * PI * area);
        let twin = SUITE.twin(&format!("furnace box: light, {roulette:?}, a bounce forgotten"));
        mean_is(twin, &from_light, truth * PI * area * 0.75).expect_reject();
    }
}

/// Without roulette every walk brings the same: there is no variance to test with.
fn mean_is_or_equals(check: Check, moments: &Moments, truth: f64) {
    if moments.variance() < 1e-6 * truth * truth {
        assert!((moments.mean() / truth - 1.0).abs() < 1e-4, "{} {truth}", moments.mean());
    } else {
        mean_is(check, moments, Truth::relative(truth, 1e-5)).expect_pass();
    }
}

fn materials() -> Vec<(&'static str, Material, bool)> {
    let (eta, k) = conductors::named("Cu").unwrap();
    let one = || 1.0.into();
    let rough =
        |distribution, alpha| Material::RoughConductor { eta, k, specular_reflectance: one(), distribution, alpha };
    let glass = |rough: Option<f32>| match rough {
        None => Material::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: one(),
            specular_transmittance: one(),
        },
        Some(alpha) => Material::RoughDielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: one(),
            specular_transmittance: one(),
            distribution: Distribution::Ggx,
            alpha: [alpha; 2],
        },
    };
    let rough_plastic = Material::RoughPlastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: 0.9.into(),
        specular_reflectance: one(),
        nonlinear: true,
        distribution: Distribution::Beckmann,
        alpha: 0.3,
    };
    let plastic = Material::Plastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: 0.9.into(),
        specular_reflectance: one(),
        nonlinear: false,
    };
    let phong = Material::Phong { diffuse_reflectance: 0.5.into(), specular_reflectance: 0.5.into(), exponent: 20.0 };
    let cook = Material::CookTorrance {
        diffuse_reflectance: 0.3.into(),
        specular_reflectance: 0.7.into(),
        ior: 1.5,
        alpha: 0.3,
    };
    // The flag: whether everything that is reflected is in `eval`, without Dirac deltas and without transmission.
    vec![
        ("diffuse", Material::diffuse(0.8), true),
        ("conductor", Material::Conductor { eta, k, specular_reflectance: one() }, false),
        ("rough conductor", rough(Distribution::Ggx, [0.2, 0.4]), true),
        ("dielectric", glass(None), false),
        ("rough dielectric", glass(Some(0.3)), false),
        ("plastic", plastic, false),
        ("rough plastic", rough_plastic, true),
        ("phong", phong.clone(), true),
        ("cook-torrance", cook, true),
        ("mask", Material::Mask { opacity: 0.5.into(), inner: Box::new(Material::diffuse(1.0).two_sided()) }, false),
        ("evaluate only", Material::EvaluateOnly(Box::new(phong)), true),
    ]
}

/// Paths from the camera through a sphere in uniform radiance 1.
#[test]
fn no_material_is_brighter_than_the_furnace() {
    for (name, material, is_reflection_alone) in materials() {
        let scene = ReferenceScene::new(furnace(material)).unwrap();
        for height in [0.1f32, 0.4, 0.7] {
            let direction = Vec3A::new(0.0, height, -3.0).normalize();
            let ray = Ray::new(Vec3A::new(0.0, 0.0, 4.0), direction);
            let Some(vertex) = scene.intersect(&ray) else { panic!("{name}: the sphere is missed") };
            let check = SUITE.check(&format!("white furnace: {name} {height}"));
            let mut uniforms = check.uniforms();
            let weights: Moments = (0..20_000).map(|_| furnace_path(&scene, ray, &mut uniforms)).collect();
            let noise = 6.0 * (weights.variance() / weights.count() as f64).sqrt();
            assert!(weights.mean() <= 1.0 + noise + 1e-4, "{name} {height}: {}", weights.mean());
            if is_reflection_alone {
                mean_is(check, &weights, Truth::relative(albedo(&vertex), 3e-3)).expect_pass();
            }
        }
    }
}

/// The directional albedo by midpoints on the hemisphere.
fn albedo(vertex: &impl Vertex<Spectrum = Rgb>) -> f64 {
    let n = 400;
    let frame = Frame::from_z(vertex.shading_normal());
    let cells = (0..n * n).map(|k| [(k % n) as f64 + 0.5, (k / n) as f64 + 0.5].map(|x| x / n as f64));
    let sum: f64 = cells
        .map(|u| {
            let wi = frame.to_world(Vec3A::from(Hemisphere.point(u).map(|x| x as f32)));
            f64::from(vertex.eval(wi, TransportMode::Radiance).mean())
        })
        .sum();
    sum * 2.0 * PI / (n * n) as f64
}

fn furnace_path(scene: &ReferenceScene, mut ray: Ray, uniforms: &mut Uniforms) -> f64 {
    let mut throughput = Rgb::ONE;
    for _ in 0..64 {
        let Some(vertex) = scene.intersect(&ray) else {
            return f64::from((throughput * scene.environment_radiance(ray.direction)).mean());
        };
        let u = uniforms.array::<3>().map(|x| x as f32);
        let Some(sample) = vertex.sample(u, TransportMode::Radiance) else { return 0.0 };
        throughput *= sample.throughput;
        ray = vertex.spawn_ray(sample.wi);
    }
    assert!(throughput.max_component() < 1.1);
    f64::from(throughput.mean())
}

#[test]
fn camera_rays_follow_their_density() {
    for aperture_radius in [0.0, 0.3] {
        let camera = PerspectiveCamera::new(&CameraDescription {
            to_world: Affine3A::from_rotation_y(0.7) * Affine3A::from_rotation_x(-0.3),
            fov_x: 1.9,
            aperture_radius,
            focus_distance: 1.5,
            width: 40,
            height: 30,
        });
        let camera = camera.unwrap();
        let u_lens = [0.2, 0.9];
        let lens = camera.sample_ray([0.0; 2], u_lens).ray.origin;
        let sample = |[u, v, _]: [f64; 3]| {
            Some(camera.sample_ray([40.0 * u as f32, 30.0 * v as f32], u_lens).ray.direction.to_array())
        };
        let density = |w: [f64; 3]| f64::from(camera.pdf_ray(lens, Vec3A::from(w.map(|x| x as f32))).1);
        let test = ChiSquare::on(Sphere).cells(12, 24).samples(30_000).min_expected(40.0);
        test.run(SUITE.check(&format!("camera {aperture_radius}")), sample, density).expect_pass();
        let axis = camera.sample_ray([20.0, 15.0], [0.5; 2]).ray.direction;
        let no_cosine = |w: [f64; 3]| density(w) * f64::from(axis.dot(Vec3A::from(w.map(|x| x as f32))));
        test.run(SUITE.twin(&format!("camera {aperture_radius}: cosine forgotten")), sample, no_cosine).expect_reject();
        let (area, _) = camera.pdf_ray(lens, axis);
        let expected = if aperture_radius > 0.0 { 1.0 / (PI as f32 * 0.09) } else { 1.0 };
        assert!((area / expected - 1.0).abs() < 1e-5);
    }
}
