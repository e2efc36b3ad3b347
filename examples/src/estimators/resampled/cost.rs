//! What candidates and samples cost here: the times of Talbot, Cline and Egbert's section 5.1.

use std::hint::black_box;

use qmc_sampling::{Sampler, SamplerFamily};
use ris::{CostError, CostModel, Reservoir, seconds};
use scene_core::{EmitterChoice, Scene, Sensor, Spectrum, Vertex};

use super::ResampledDirect;

/// Vertices that are measured with.
const VERTICES: usize = 4096;
/// Vertices per timing: clocks are coarse.
const BLOCK: usize = 64;

/// Measures `T_X` and `T_Y` at what a few thousand primary rays hit: `T_X` is the time to draw a candidate, score it and offer it to a
/// reservoir; `T_Y` the time to evaluate what was selected and to trace its shadow ray. In seconds.
///
/// With one candidate there is nothing to select, and black ones get no shadow ray: importance sampling is cheaper than these two numbers say.
///
/// # Errors
/// If too few primary rays hit something that scatters.
pub fn measure_cost<S: Scene, F: SamplerFamily, C: EmitterChoice>(
    scene: &S,
    samplers: &F,
    direct: &ResampledDirect<'_, C>,
) -> Result<CostModel, CostError> {
    // Primary rays, all over the image.
    let [width, height] = scene.sensor().resolution();
    let mut vertices = Vec::with_capacity(VERTICES);
    for index in 0..2 * VERTICES as u64 {
        let mut sampler = samplers.sampler(COST_STREAM, index);
        let [x, y] = sampler.next_2d();
        let ray = scene.sensor().sample_ray([x * width as f32, y * height as f32], sampler.next_2d()).ray;
        if let Some(vertex) = scene.intersect(&ray).filter(|vertex| vertex.is_connectible()) {
            vertices.push((vertex, sampler));
        }
        if vertices.len() == VERTICES {
            break;
        }
    }

    // Candidates and samples in turn, over the same vertices.
    let draw = |(vertex, sampler): &(S::Vertex<'_>, F::Sampler)| -> Vec<_> {
        let mut sampler = sampler.clone();
        let (source, target) = (direct.source(scene, vertex), direct.target(scene, vertex));
        let mut select = || Reservoir::draw(EVALUATIONS, &source, &target, &mut || sampler.next_1d()).selected;
        (0..EVALUATIONS).filter_map(|_| select()).map(|selected| selected.sample).collect()
    };
    let selected: Vec<_> = vertices.iter().map(draw).collect();
    let blocks = vertices.len() / BLOCK;
    let mut candidate_block = (0..blocks).cycle();
    let mut sample_block = (0..blocks).cycle();
    let candidates = || {
        let Some(block) = candidate_block.next() else { return 0 };
        for (vertex, sampler) in &vertices[block * BLOCK..(block + 1) * BLOCK] {
            let mut sampler = sampler.clone();
            let (source, target) = (direct.source(scene, vertex), direct.target(scene, vertex));
            let picked = Reservoir::draw(EVALUATIONS, &source, &target, &mut || sampler.next_1d());
            black_box(picked.contribution_weight());
        }
        BLOCK * EVALUATIONS as usize
    };
    let samples = || {
        let Some(block) = sample_block.next() else { return 0 };
        let range = block * BLOCK..(block + 1) * BLOCK;
        let mut count = 0;
        for ((vertex, _), candidates) in vertices[range.clone()].iter().zip(&selected[range]) {
            for candidate in candidates {
                let value = candidate.value(vertex);
                if !value.is_black() {
                    black_box(candidate.is_visible(scene, vertex));
                }
                black_box(value.luminance());
                count += 1;
            }
        }
        count
    };
    CostModel::measure(blocks.max(1) * ROUNDS, seconds(), candidates, samples)
}

/// Candidates, and samples, at each vertex: in use there are several as well, and the first of them finds colder caches.
const EVALUATIONS: u32 = 8;
/// How often each block is timed.
const ROUNDS: usize = 4;
/// A stream of numbers that no pixel and no light path has.
const COST_STREAM: u64 = (1 << 40) - 1;
