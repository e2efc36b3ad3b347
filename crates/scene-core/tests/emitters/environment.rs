//! Light from all around.

use std::f64::consts::PI;
use std::sync::Arc;

use estimator_checks::{ChiSquare, Disk, Moments, Truth, Uniforms, mean_is};
use scene_core::builtin::SceneBuilder;
use scene_core::glam::{Affine3A, Vec3A};
use scene_core::reference::Light;
use scene_core::texture::Image;
use scene_core::{Emitter, EmitterId, Frame, ReferenceScene, Rgb, Scene};

use crate::{Lit, RADIANCE, SUITE, direct_samples_agree, emission_agrees, emission_directions, mean_flux, tilt};

/// A scene with nothing but an environment and something small far away from where it is looked at.
fn lit(name: &'static str, light: Light) -> Lit {
    let mut b = SceneBuilder::new(name);
    let black = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(black, Vec3A::new(1.0, 2.0, 3.0), 0.5).light(light);
    let scene = ReferenceScene::new(b.finish()).unwrap();
    Lit { name, scene, id: EmitterId(0), from: Vec3A::new(1.0, 2.0, 3.0) }
}

const SIZE: [u32; 2] = [24, 12];

/// A smooth sky, a black ground, and a sun that is brighter than everything else together.
fn sky(sun: f32) -> Light {
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let pixels = pixels.map(|(x, y)| match (x, y) {
        (17, 3) => [sun, 0.9 * sun, 0.7 * sun],
        (_, 9..) => [0.0; 3],
        _ => [0.2 + 0.01 * x as f32, 0.3, 0.8 - 0.03 * y as f32],
    });
    let image = Image::from_rgb(SIZE[0], SIZE[1], pixels.collect()).unwrap();
    Light::Environment {
        image: Arc::new(image),
        scale: 1.5,
        to_world: Affine3A { matrix3: tilt(), translation: Vec3A::ZERO },
    }
}

fn constant_image() -> Light {
    let image = Image::from_rgb(8, 4, vec![RADIANCE.to_array(); 32]).unwrap();
    Light::Environment { image: Arc::new(image), scale: 1.0, to_world: Affine3A::IDENTITY }
}

fn all() -> Vec<Lit> {
    vec![
        lit("constant", Light::Constant { radiance: RADIANCE }),
        lit("constant image", constant_image()),
        lit("sky", sky(2.0)),
        lit("sky with sun", sky(400.0)),
    ]
}

/// `integral f(w) dw` over the sphere, by midpoints in coordinates that follow the image's cells.
fn integral(f: impl Fn(Vec3A) -> f64) -> f64 {
    let (columns, rows) = (SIZE[0] as usize * 16, (SIZE[1] as usize - 1) * 16);
    let mut sum = 0.0;
    for j in 0..rows {
        let theta = PI * (j as f64 + 0.5) / rows as f64;
        for i in 0..columns {
            let phi = 2.0 * PI * (i as f64 + 0.5) / columns as f64;
            let local = [theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos()];
            sum += theta.sin() * f(tilt() * Vec3A::from(local.map(|x| x as f32)));
        }
    }
    sum * 2.0 * PI * PI / (rows * columns) as f64
}

#[test]
fn directions_follow_their_densities() {
    for lit in all() {
        lit.direct(SUITE.check(&format!("direct: {}", lit.name)), |_, pdf| pdf).expect_pass();
        lit.direct(SUITE.twin(&format!("{}: 2 % too little", lit.name)), |_, pdf| 0.98 * pdf).expect_reject();
        lit.direct(SUITE.twin(&format!("{}: 2 % too much", lit.name)), |_, pdf| 1.02 * pdf).expect_reject();
        let check = SUITE.check(&format!("emission: {}", lit.name));
        emission_directions(check, lit.emitter(), true, |pdf| pdf).expect_pass();
    }
    // The sine of the polar angle forgotten, and the image mirrored.
    let sky = lit("sky", sky(2.0));
    let up = tilt() * Vec3A::Y;
    let sine = |wi: Vec3A, pdf: f64| pdf * f64::from(wi.cross(up).length()) * 4.0 / PI;
    sky.direct(SUITE.twin("sky: sine forgotten"), sine).expect_reject();
    let mirrored = |wi: Vec3A, _| {
        let local = tilt().transpose() * wi;
        f64::from(sky.density(tilt() * local.with_x(-local.x)))
    };
    sky.direct(SUITE.twin("sky: mirrored"), mirrored).expect_reject();
}

#[test]
fn directions_and_radiance_agree() {
    for lit in all() {
        direct_samples_agree(&lit);
        emission_agrees(lit.name, lit.emitter(), true);
    }
}

/// Importance sampling and light paths integrate to the quadrature of the image; power is what light paths carry.
#[test]
fn samples_integrate_to_the_quadrature() {
    for lit in [lit("sky", sky(2.0)), lit("sky with sun", sky(400.0))] {
        let (name, emitter) = (lit.name, lit.emitter());
        let radiance = |w: Vec3A| f64::from(emitter.radiance(None, w).mean());
        let radius = f64::from(lit.scene.bounding_sphere().1);
        let truth = integral(radiance);
        let power = f64::from(emitter.power().mean());
        assert!((power / (PI * radius * radius * truth) - 1.0).abs() < 1e-3, "{name}: {power} {truth}");

        let check = SUITE.check(&format!("flux: {name}"));
        let flux = mean_flux(emitter, &mut check.uniforms(), 40_000);
        mean_is(check, &flux, Truth::relative(power, 1e-4)).expect_pass();
        let twin = SUITE.twin(&format!("flux: {name}, 5 % too much power"));
        let flux = mean_flux(emitter, &mut twin.uniforms(), 40_000);
        mean_is(twin, &flux, 1.05 * power).expect_reject();

        let normal = Vec3A::new(0.3, 0.8, -0.2).normalize();
        let irradiance = integral(|w| radiance(w) * f64::from(normal.dot(w).max(0.0)));
        let check = SUITE.check(&format!("irradiance: {name}"));
        let estimates = irradiance_estimates(&lit, normal, &mut check.uniforms());
        mean_is(check, &estimates, Truth::relative(irradiance, 2e-3)).expect_pass();
    }
}

fn irradiance_estimates(lit: &Lit, normal: Vec3A, uniforms: &mut Uniforms) -> Moments {
    (0..40_000)
        .map(|_| {
            let [u, v] = uniforms.array::<2>().map(|x| x as f32);
            let sample = lit.emitter().sample_direct(lit.from, [u, v]).unwrap();
            f64::from(sample.radiance.mean() * normal.dot(sample.wi).max(0.0) / sample.pdf_solid_angle)
        })
        .collect()
}

/// The irradiance of uniform radiance is `pi L`, its power `4 pi^2 R^2 L`, whether it is a constant or an image.
#[test]
fn uniform_light_has_closed_forms() {
    for lit in &all()[..2] {
        let mean = f64::from(RADIANCE.mean());
        let check = SUITE.check(&format!("uniform: {}", lit.name));
        let estimates = irradiance_estimates(lit, Vec3A::new(-0.6, 0.0, 0.8), &mut check.uniforms());
        mean_is(check, &estimates, Truth::relative(PI * mean, 1e-5)).expect_pass();
        let radius = f64::from(lit.scene.bounding_sphere().1);
        let power = 4.0 * PI * PI * radius * radius * mean;
        assert!((f64::from(lit.emitter().power().mean()) / power - 1.0).abs() < 1e-5, "{}", lit.name);
    }
}

/// Light paths cover the disk in front of the scene uniformly, and start outside of the bounding sphere.
#[test]
fn light_paths_cover_the_scene() {
    let lit = lit("sky", sky(2.0));
    let (center, radius) = lit.scene.bounding_sphere();
    let u_direction = [0.3, 0.7];
    let direction = lit.emitter().sample_emission([0.5; 2], u_direction).unwrap().direction;
    let frame = Frame::from_z(direction);
    let sample = |[u, v, _]: [f64; 3]| {
        let point = lit.emitter().sample_emission([u as f32, v as f32], u_direction).unwrap().point;
        let local = frame.to_local(point.position - center) / radius;
        assert!(local.z < -0.999 && point.normal == Vec3A::ZERO && point.error == 0.0);
        Some([local.x * 0.999_99, local.y * 0.999_99])
    };
    ChiSquare::on(Disk).samples(50_000).run(SUITE.check("positions: sky"), sample, |_| 1.0 / PI).expect_pass();
}

/// Rows at the poles are single points, columns are periodic: the lookup is continuous everywhere.
#[test]
fn there_is_no_seam() {
    let lit = lit("sky", sky(2.0));
    let radiance = |local: Vec3A| lit.emitter().radiance(None, tilt() * local.normalize());
    let same = |a: Rgb, b: Rgb| (a - b).0.abs().max_element() < 1e-2;
    for y in [-0.9, -0.1, 0.3, 2.0] {
        assert!(same(radiance(Vec3A::new(1e-4, y, -1.0)), radiance(Vec3A::new(-1e-4, y, -1.0))), "behind");
        assert!(same(radiance(Vec3A::new(1e-4, y, 1.0)), radiance(Vec3A::new(-1e-4, y, 1.0))), "in front");
    }
}
