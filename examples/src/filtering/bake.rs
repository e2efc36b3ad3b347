//! Light probes and textures.

use path_space_filter::PathFilter;
use qmc_sampling::SamplerFamily;
use scene_core::film::Filter;
use scene_core::{Ray, Scene};

use super::traced::{Tracing, trace_rays};
use super::{FilterVertex, Observable, Selection, Traced};
use crate::render::PassContext;

/// Radiance that arrives along given rays, filtered: bakes a light probe if they start at its centre, a texture if each looks at a texel.
///
/// Every batch takes `batch` samples along each ray; the mean over all batches, in linear RGB and the order of the rays.
///
/// ```
/// use glam::Vec3A;
/// use lichtwerk::estimators::AmbientOcclusion;
/// use lichtwerk::filtering::{Selection, bake};
/// use path_space_filter::{PathSpaceFilter, Radius};
/// use scene_core::{Ray, ReferenceScene, builtin};
/// let scene = ReferenceScene::new(builtin::cornell_box())?;
/// // Texels of the floor, looked at from right above.
/// let texel = |i: u32| {
///     let place = Vec3A::new(0.05 + 0.05 * (i % 10) as f32, 0.01, 0.05 + 0.05 * (i / 10) as f32);
///     Ray::new(place, Vec3A::NEG_Y)
/// };
/// let rays: Vec<Ray> = (0..100).map(texel).collect();
/// let filter = PathSpaceFilter::new(Radius::absolute(0.1)?);
/// let ao = AmbientOcclusion { distance: 0.2 };
/// let texture = bake(&scene, &rays, &ao, &qmc_sampling::Independent::new(1), &filter, Selection::default(), 0..4, 4);
/// assert!(texture.iter().all(|rgb| (0.0..=1.0).contains(&rgb[0])));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[expect(clippy::too_many_arguments, reason = "what is baked, how it is estimated, and how it is filtered")]
pub fn bake<S: Scene + Sync, F: SamplerFamily, E: Observable>(
    scene: &S,
    rays: &[Ray],
    estimator: &E,
    samplers: &F,
    filter: &impl PathFilter<FilterVertex>,
    selection: Selection,
    batches: core::ops::Range<u64>,
    batch: u64,
) -> Vec<[f32; 3]> {
    let context = PassContext { scene, samplers, filter: Filter::BOX };
    let tracing = Tracing { estimator, selection, point_lights: false, time: 0.0 };
    let mut sums = vec![[0.0_f64; 3]; rays.len()];
    let samples = batches.end.saturating_sub(batches.start) * batch;
    for number in batches {
        let mut traced = Traced::default();
        for index in number * batch..(number + 1) * batch {
            traced.append(trace_rays(&tracing, &context, rays, index));
        }
        let averages = filter.average(&traced.vertices, number + 1);
        for (path, radiance) in traced.radiance(averages.values()).enumerate() {
            let sum = &mut sums[path % rays.len()];
            (0..3).for_each(|k| sum[k] += f64::from(radiance[k]));
        }
    }
    sums.into_iter().map(|sum| sum.map(|s| (s / samples.max(1) as f64) as f32)).collect()
}
