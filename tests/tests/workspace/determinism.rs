//! The same seed gives the same image, bit for bit: at any number of threads, however the passes are cut.
#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;
use std::time::Duration;

use lichtwerk::program::{EstimatorName, RenderSettings, SamplerName, estimate};
use lichtwerk::render::{Budget, Rendering};
use lichtwerk_tests::scenes;

/// Tiles and light tasks come in several; their sides do not divide the image.
const SIZE: [u32; 2] = [70, 50];

fn render(settings: &RenderSettings, pause: Duration) -> (Rendering, Vec<u64>) {
    let scene = scenes::build(scenes::resized(scenes::lens_and_masks(), SIZE[0], SIZE[1]));
    let mut passes = Vec::new();
    let rendering = estimate(&scene, settings, |pass| {
        passes.push(pass.samples);
        std::thread::sleep(pause);
        ControlFlow::Continue(())
    });
    (rendering.unwrap(), passes)
}

fn settings(estimator: EstimatorName, sampler: SamplerName) -> RenderSettings {
    RenderSettings { estimator, sampler, threads: 1, seed: 7, ..RenderSettings::new(Budget::Samples(3)) }
}

fn assert_same(a: &Rendering, b: &Rendering, what: &str) {
    assert!(a.film == b.film, "{what}: the films differ");
    assert_eq!(a.rays, b.rays, "{what}: numbers of rays");
    assert_eq!((a.samples, a.light_paths), (b.samples, b.light_paths), "{what}");
    let bits = |rendering: &Rendering| -> Vec<u32> {
        let image = rendering.film.develop(rendering.light_paths);
        image.channels().flat_map(|(_, values)| values.iter().map(|value| value.to_bits())).collect()
    };
    assert!(bits(a) == bits(b), "{what}: the images differ");
}

#[test]
fn serial_equals_parallel_bit_for_bit() {
    for estimator in [EstimatorName::Path, EstimatorName::Light, EstimatorName::Direct, EstimatorName::Ao] {
        for &sampler in SamplerName::all() {
            let serial = settings(estimator, sampler);
            let (expected, _) = render(&serial, Duration::ZERO);
            assert!(expected.rays.closest_hit > 0 && expected.rays.visibility > 0);
            assert_eq!(expected.threads, 1);
            for threads in [2, 8] {
                let (parallel, _) = render(&RenderSettings { threads, ..serial.clone() }, Duration::ZERO);
                assert_eq!(parallel.threads, threads);
                assert_same(&expected, &parallel, &format!("{estimator:?}, {sampler:?}, {threads} threads"));
            }
        }
    }
}

#[test]
fn passes_may_be_cut_anywhere() {
    for &sampler in SamplerName::all() {
        let settings = RenderSettings { threads: 2, ..settings(EstimatorName::Light, sampler) };
        let (quick, few) = render(&settings, Duration::ZERO);
        // So slow that every sample is a pass of its own.
        let (slow, many) = render(&settings, Duration::from_millis(260));
        assert_eq!(many, [1, 2, 3]);
        assert!(few.len() <= many.len());
        assert_same(&quick, &slow, &format!("{sampler:?} in passes up to {few:?} and {many:?}"));
    }
}

#[test]
fn a_seed_is_an_image() {
    for &sampler in SamplerName::all() {
        for estimator in [EstimatorName::Path, EstimatorName::Light] {
            let settings = settings(estimator, sampler);
            let (a, _) = render(&settings, Duration::ZERO);
            let (b, _) = render(&settings, Duration::ZERO);
            assert_same(&a, &b, "same seed");
            let (other, _) = render(&RenderSettings { seed: 8, ..settings }, Duration::ZERO);
            assert!(a.film != other.film, "another seed gives another image");
        }
    }
}

#[test]
fn an_interrupted_rendering_is_the_beginning_of_the_whole() {
    let scene = scenes::build(scenes::cornell_box());
    let settings = RenderSettings { budget: Budget::Samples(64), ..settings(EstimatorName::Light, SamplerName::Sobol) };
    let stopped = estimate(&scene, &settings, |_| ControlFlow::Break(())).unwrap();
    assert_eq!(stopped.samples, 1);
    let whole = RenderSettings { budget: Budget::Samples(1), ..settings };
    assert_same(&stopped, &estimate(&scene, &whole, |_| ControlFlow::Continue(())).unwrap(), "one sample per pixel");
}
