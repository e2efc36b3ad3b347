//! Emitters that no ray can hit: exact laws.

use std::f64::consts::PI;

use estimator_checks::{ChiSquare, Disk, Truth, Uniforms, mean_is};
use scene_core::builtin::SceneBuilder;
use scene_core::glam::Vec3A;
use scene_core::reference::Light;
use scene_core::{Emitter, Frame, ReferenceScene, Rgb, Scene, SurfacePoint};

use crate::{SUITE, close, emission_directions, mean_flux};

const INTENSITY: Rgb = Rgb::new(5.0, 4.0, 3.0);
const POSITION: Vec3A = Vec3A::new(1.0, -2.0, 0.5);
const BEAM_WIDTH: f32 = 0.3;
const CUTOFF: f32 = 0.9;

fn scene(light: Light) -> ReferenceScene {
    let mut b = SceneBuilder::new("delta");
    let black = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(black, Vec3A::new(4.0, 0.0, 0.0), 2.0).light(light);
    ReferenceScene::new(b.finish()).unwrap()
}

fn axis() -> Vec3A {
    Vec3A::new(0.3, -0.4, 0.8).normalize()
}

fn point() -> ReferenceScene {
    scene(Light::Point { position: POSITION, intensity: INTENSITY })
}

fn spot() -> ReferenceScene {
    let direction = axis() * 3.0;
    scene(Light::Spot { position: POSITION, direction, intensity: INTENSITY, beam_width: BEAM_WIDTH, cutoff: CUTOFF })
}

fn directional() -> ReferenceScene {
    scene(Light::Directional { direction: axis() * 0.1, irradiance: INTENSITY })
}

#[test]
fn nothing_but_sampling_finds_them() {
    for scene in [point(), spot(), directional()] {
        let emitter = &scene.emitters()[0];
        let at = SurfacePoint::in_space(POSITION);
        assert!(emitter.is_delta() && scene.environment().is_none());
        for at in [None, Some(&at)] {
            assert_eq!(emitter.pdf_direct(Vec3A::ZERO, -axis(), at), 0.0);
            assert_eq!(emitter.radiance(at, axis()), Rgb::ZERO);
        }
    }
}

#[test]
fn irradiance_falls_with_the_squared_distance() {
    let scene = point();
    let emitter = &scene.emitters()[0];
    let mut uniforms = Uniforms::named("inverse square");
    for _ in 0..1000 {
        let [x, y, z, r] = uniforms.array::<4>().map(|x| x as f32 - 0.5);
        let direction = Vec3A::new(x, y, z).normalize();
        let distance = (20.0 * r).exp2();
        let sample = emitter.sample_direct(POSITION + direction * distance, [0.5; 2]).unwrap();
        // Beyond 1e-3 of the coordinates round-off is all there is.
        if distance > 1e-2 {
            assert!((sample.wi + direction).length() < 1e-4);
            assert!(close(sample.radiance[1] * distance * distance, 4.0, 1e-4 + 1e-6 / distance), "{sample:?}");
        }
        assert!(sample.is_delta && sample.pdf_solid_angle == 1.0);
        assert_eq!(sample.at.unwrap().0, SurfacePoint::in_space(POSITION));
    }
    assert!(emitter.sample_direct(POSITION, [0.5; 2]).is_none());
    assert!(emitter.sample_direct(Vec3A::NAN, [0.5; 2]).is_none());
    assert!(close(emitter.power()[0], 20.0 * PI as f32, 1e-6));
    emission_directions(SUITE.check("emission: point"), emitter, true, |pdf| pdf).expect_pass();
    for u in [0.1, 0.5, 0.9] {
        let sample = emitter.sample_emission([u, u], [u, 1.0 - u]).unwrap();
        assert_eq!((sample.flux, sample.pdf_area), (emitter.power(), 1.0));
        assert_eq!(
            (sample.pdf_area, sample.pdf_solid_angle),
            emitter.pdf_emission(Some(&sample.point), sample.direction)
        );
    }
}

/// The intensity at an angle from the axis, as Mitsuba's `spot` has it.
fn falloff(angle: f64) -> f64 {
    let (beam, cutoff) = (f64::from(BEAM_WIDTH), f64::from(CUTOFF));
    ((cutoff - angle) / (cutoff - beam)).clamp(0.0, 1.0)
}

#[test]
fn spots_fall_off_and_end() {
    let scene = spot();
    let emitter = &scene.emitters()[0];
    let frame = Frame::from_z(axis());
    for k in 0..300 {
        let (angle, turn) = (PI * f64::from(k) / 299.0, f64::from(k) * 0.7);
        let local = [angle.sin() * turn.cos(), angle.sin() * turn.sin(), angle.cos()].map(|x| x as f32);
        let direction = frame.to_world(Vec3A::from(local));
        let sample = emitter.sample_direct(POSITION + direction * 2.0, [0.5; 2]);
        let expected = 5.0 / 4.0 * falloff(angle);
        let value = sample.map_or(0.0, |sample| f64::from(sample.radiance[0]));
        assert!((value - expected).abs() < 1e-4, "{angle}: {value} {expected}");
        assert!(expected < 1e-3 || emitter.pdf_emission(None, direction).1 > 0.0);
    }
}

#[test]
fn the_power_of_spots_is_their_integral() {
    let n = 20_000;
    for (beam_width, cutoff) in [(BEAM_WIDTH, CUTOFF), (0.0, 0.2), (0.5, 0.5), (1.0, 3.0)] {
        let direction = axis();
        let light = Light::Spot { position: POSITION, direction, intensity: INTENSITY, beam_width, cutoff };
        let scene = scene(light);
        let emitter = &scene.emitters()[0];
        let at = |angle: f64| -> f64 {
            let (beam, cutoff) = (f64::from(beam_width), f64::from(cutoff));
            if angle <= beam { 1.0 } else { ((cutoff - angle) / (cutoff - beam)).max(0.0) }
        };
        let step = f64::from(cutoff) / f64::from(n);
        let quadrature: f64 = (0..n).map(|k| (f64::from(k) + 0.5) * step).map(|a| at(a) * a.sin()).sum();
        let truth = 2.0 * PI * quadrature * step;
        assert!((f64::from(emitter.power()[0]) / (5.0 * truth) - 1.0).abs() < 1e-4, "{beam_width} {cutoff}");
        if beam_width == BEAM_WIDTH {
            let check = SUITE.check("flux: spot");
            let flux = mean_flux(emitter, &mut check.uniforms(), 40_000);
            mean_is(check, &flux, Truth::relative(4.0 * truth, 1e-4)).expect_pass();
            let twin = SUITE.twin("flux: spot, 5 % too much power");
            let flux = mean_flux(emitter, &mut twin.uniforms(), 40_000);
            mean_is(twin, &flux, 1.05 * 4.0 * truth).expect_reject();
            emission_directions(SUITE.check("emission: spot"), emitter, true, |pdf| pdf).expect_pass();
        }
    }
}

#[test]
fn directional_light_is_parallel_and_covers_the_scene() {
    let scene = directional();
    let emitter = &scene.emitters()[0];
    let (center, radius) = scene.bounding_sphere();
    for from in [Vec3A::ZERO, Vec3A::splat(1e6)] {
        let sample = emitter.sample_direct(from, [0.2, 0.3]).unwrap();
        assert!((sample.wi + axis()).length() < 1e-6);
        assert_eq!((sample.radiance, sample.pdf_solid_angle, sample.at), (INTENSITY, 1.0, None));
    }
    let power = f64::from(emitter.power()[0]);
    assert!((power / (5.0 * PI * f64::from(radius).powi(2)) - 1.0).abs() < 1e-5);
    let frame = Frame::from_z(axis());
    let sample = |[u, v, _]: [f64; 3]| {
        let emission = emitter.sample_emission([u as f32, v as f32], [0.5; 2]).unwrap();
        assert!((emission.direction - axis()).length() < 1e-6 && emission.flux == emitter.power());
        assert_eq!((emission.pdf_area, 1.0), emitter.pdf_emission(None, emission.direction));
        let local = frame.to_local(emission.point.position - center) / radius;
        assert!(local.z < -0.999, "starts outside of the bounding sphere");
        Some([local.x * 0.999_99, local.y * 0.999_99])
    };
    ChiSquare::on(Disk).samples(50_000).run(SUITE.check("positions: directional"), sample, |_| 1.0 / PI).expect_pass();
}
