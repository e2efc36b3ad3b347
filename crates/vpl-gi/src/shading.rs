//! The shading loop: one lit vertex, all virtual point lights.

use glam::Vec3A;
use scene_core::{Emitter, Ray, Scene, Spectrum, TransportMode, Vertex};

use crate::lights::{LANES, LightKind, Towards, VirtualPointLights, facing_normal};
use crate::partition::{Partition, peak};

/// What connections at a vertex take, apart from the lights.
#[derive(Clone, Copy)]
pub(crate) struct Connections<'a> {
    /// The share of edges.
    pub(crate) partition: &'a Partition,
    /// Longest light paths that count, in segments.
    pub(crate) longest: u32,
    /// The same for lights that nothing later on the eye path finds.
    pub(crate) longest_last_chance: u32,
    /// Whether a caustic map finds what arrives by Dirac deltas: then there are no last chances, and as it knows no directions, peaks of
    /// lights that are reached so do not count.
    pub(crate) mapped: bool,
    /// Whether the peaks of scattering functions count as if they were part of the geometry term.
    pub(crate) peaks: bool,
    /// What is left for connections in a direction, if it depends on it.
    pub(crate) left: Option<&'a dyn Fn(Vec3A) -> f32>,
}

impl<'a> Connections<'a> {
    /// Light paths of up to `longest` segments, by the geometry term alone.
    pub(crate) fn up_to(longest: u32, partition: &'a Partition) -> Self {
        Self { partition, longest, longest_last_chance: longest, mapped: false, peaks: false, left: None }
    }

    /// All light paths, by the geometry term alone.
    pub(crate) fn all(partition: &'a Partition) -> Self {
        Self::up_to(u32::MAX, partition)
    }
}

/// Calls `with(light, value)` for every light that contributes at `x` if nothing is in between:
/// ```text
/// value = s(x, y_j) f_x G(x, y_j) I_j
/// ```
/// Geometry terms come first, for [`LANES`] lights at once; BSDFs are evaluated for those that are left.
#[inline]
pub(crate) fn for_each_unshadowed<S, X, V>(
    scene: &S,
    x: &X,
    lights: &VirtualPointLights<V>,
    connections: &Connections<'_>,
    mut with: impl FnMut(usize, V::Spectrum),
) where
    S: Scene<Spectrum = V::Spectrum>,
    X: Vertex<Spectrum = V::Spectrum>,
    V: Vertex,
{
    let &Connections { partition, longest, longest_last_chance, mapped, peaks, left } = connections;
    let all = lights.as_slice();
    let is_last_chance = |index: usize| !mapped && lights.any_last_chance() && all[index].is_last_chance;
    let is_too_long = |index: usize| {
        longest < lights.longest()
            && all[index].length > if is_last_chance(index) { longest_last_chance } else { longest }
    };
    let (from, normal) = (x.point().position, facing_normal(x));
    let is_lambertian = peaks && x.lambertian().is_some();
    let diffuse = if lights.all_lambertian() && left.is_none() { x.lambertian() } else { None };
    for (block, lanes) in lights.lanes().iter().enumerate() {
        if let Some(f) = diffuse {
            let terms = lanes.geometry_terms::<true>(from, normal);
            for (lane, g) in terms.into_iter().enumerate().filter(|(_, g)| *g > 0.0) {
                let index = block * LANES + lane;
                let distance = || all[index].point().map_or(0.0, |y| y.position.distance_squared(from));
                let share = if is_last_chance(index) { 1.0 } else { partition.share_with(g, distance) };
                let bounded = g * share;
                if bounded > 0.0 && !is_too_long(index) {
                    with(index, f * lights.intensities()[index] * bounded);
                }
            }
            continue;
        }
        let terms = lanes.geometry_terms::<false>(from, normal).map(f32::abs);
        for (lane, g) in terms.into_iter().enumerate().filter(|(_, g)| *g > 0.0) {
            let index = block * LANES + lane;
            let light = &all[index];
            let Some(y) = light.point() else { continue };
            let towards = Towards::new(from, y.position);
            // Peaks only make the share smaller.
            let mut share = if is_last_chance(index) { 1.0 } else { partition.share(g, towards.d2) };
            if share <= 0.0 || is_too_long(index) {
                continue;
            }
            let scattered = if peaks && !is_last_chance(index) {
                let (scattered, pdf) = x.eval_pdf(towards.wi, TransportMode::Radiance);
                let at_x = if is_lambertian { 1.0 } else { peak(pdf, x.shading_normal().dot(towards.wi)) };
                let at_y = if mapped && light.after_specular { 1.0 } else { lights.peak(index, towards.wi) };
                share = partition.share(g * at_x * at_y, towards.d2);
                scattered
            } else {
                x.eval(towards.wi, TransportMode::Radiance)
            };
            if scattered.is_black() || share <= 0.0 {
                continue;
            }
            let share = share * left.map_or(1.0, |left| left(towards.wi));
            let value = scattered * lights.intensity(scene, index, towards.wi) * (share / towards.d2);
            if !value.is_black() {
                with(index, value);
            }
        }
    }
    for &index in lights.remote() {
        let index = index as usize;
        if !is_too_long(index)
            && let Some(value) = remote(scene, x, lights, connections, index)
        {
            with(index, value);
        }
    }
}

/// The contribution of a Dirac emitter, or of a light at infinity.
fn remote<S, X, V>(
    scene: &S,
    x: &X,
    lights: &VirtualPointLights<V>,
    connections: &Connections<'_>,
    index: usize,
) -> Option<V::Spectrum>
where
    S: Scene<Spectrum = V::Spectrum>,
    X: Vertex<Spectrum = V::Spectrum>,
    V: Vertex,
{
    let light = &lights.as_slice()[index];
    let (wi, radiance) = match light.kind {
        // No ray hits it: connections take all, whatever the geometry term.
        LightKind::Delta { emitter } => {
            let direct = scene.emitters()[emitter.index()].sample_direct(x.point().position, CENTRE)?;
            (direct.wi, direct.radiance)
        }
        LightKind::Distant { emitter, towards } => {
            let radiance = scene.emitters()[emitter.index()].radiance(None, towards);
            (towards, radiance * connections.partition.share_at_infinity())
        }
        LightKind::Emission { .. } | LightKind::Surface(_) => return None,
    };
    let left = connections.left.map_or(1.0, |left| left(wi));
    let value = x.eval(wi, TransportMode::Radiance) * radiance * light.scale * left;
    (!value.is_black()).then_some(value)
}

/// Dirac emitters do not look at these numbers.
const CENTRE: [f32; 2] = [0.5; 2];

/// The ray from `x` to a light.
#[inline]
pub(crate) fn shadow_ray<S, X, V>(scene: &S, x: &X, lights: &VirtualPointLights<V>, index: usize) -> Ray
where
    S: Scene<Spectrum = V::Spectrum>,
    X: Vertex<Spectrum = V::Spectrum>,
    V: Vertex,
{
    let light = &lights.as_slice()[index];
    match &light.kind {
        LightKind::Emission { point, .. } => x.point().ray_to(point),
        LightKind::Surface(vertex) => x.point().ray_to(vertex.point()),
        LightKind::Distant { towards, .. } => x.spawn_ray(*towards),
        LightKind::Delta { emitter } => {
            match scene.emitters()[emitter.index()].sample_direct(x.point().position, CENTRE) {
                Some(direct) => direct.shadow_ray(x),
                None => Ray::new(x.point().position, x.wo()).up_to(0.0),
            }
        }
    }
}

/// The radiance that `x` would reflect if nothing cast a shadow: the shading loop without its rays.
///
/// ```text
/// sum over lights j of  s(x, y_j) f_x G(x, y_j) I_j
/// ```
/// **Cost**, if `x` and all lights are diffuse: 24 bytes and about 25 floating point operations per light in vector instructions for the
/// geometry term, and one multiply-add per component of the spectrum.
pub fn unshadowed<S, X, V>(scene: &S, x: &X, lights: &VirtualPointLights<V>, partition: &Partition) -> V::Spectrum
where
    S: Scene<Spectrum = V::Spectrum>,
    X: Vertex<Spectrum = V::Spectrum>,
    V: Vertex,
{
    let mut sum = V::Spectrum::ZERO;
    match x.lambertian() {
        Some(f) if lights.all_lambertian() && !lights.any_last_chance() && partition.is_of_geometry_term() => {
            let (from, normal) = (x.point().position, facing_normal(x));
            for (lanes, intensities) in lights.lanes().iter().zip(lights.intensities().chunks(LANES)) {
                let terms = lanes.geometry_terms::<true>(from, normal).map(|g| partition.bounded(g));
                for (intensity, g) in intensities.iter().zip(terms) {
                    sum += *intensity * g;
                }
            }
            sum *= f;
            for &index in lights.remote() {
                sum +=
                    remote(scene, x, lights, &Connections::all(partition), index as usize).unwrap_or(V::Spectrum::ZERO);
            }
        }
        _ => for_each_unshadowed(scene, x, lights, &Connections::all(partition), |_, value| sum += value),
    }
    sum
}
