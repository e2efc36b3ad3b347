//! What it takes to use the crates that know no scene. Lines between the markers are counted.

use mis_heuristics::{Densities, Heuristic};
use path_space_filter::{HasNormal, NormalCone, PathFilter, PathSpaceFilter, PathVertex, Radius, RadiusError};
use photon_map::{DensityEstimation, Flux, Gather, GatherPoint, Kernel, Photon, PhotonMap, Photons, Scratch};
use qmc_sampling::warp::SphericalRectangle;
use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
use ris::{Budget, Ris, from_fn};

use crate::renderer::{Hit, Numbers, Scene, Shape};
use crate::vector::V;

/// Direct light: the best of eight points of the lamp, one shadow ray.
// glue: ris
pub fn resampled(scene: &Scene, x: &Hit<'_>, mut u: &mut Numbers<'_>) -> V {
    let (lamp, area) = (scene.lamp(), scene.lamp().point(0.0, 0.0).2);
    let source = from_fn(|u: &mut dyn FnMut() -> f64| (lamp.point(u(), u()).0, 1.0 / area), |_: &V| 1.0 / area);
    let target = |y: &V| scene.unshadowed(x, *y).0.mean();
    Ris::new(Budget::new(8.0, 1.0)).estimate(&source, &target, &mut u, |y| {
        if scene.sees(x, *y) { scene.unshadowed(x, *y).0 } else { V::default() }
    })
}
// end

/// A heuristic of one's own: the power 3/2.
// glue: mis-heuristics
pub struct ThreeHalves;
impl Heuristic<f64> for ThreeHalves {
    fn weight(&self, technique: usize, densities: &(impl Densities<f64> + ?Sized)) -> f64 {
        let power = |i| densities.density(i).max(0.0).powf(1.5);
        if power(technique) > 0.0 { power(technique) / (0..densities.len()).map(power).sum::<f64>() } else { 0.0 }
    }
}
pub fn combined<'s>(scene: &'s Scene, x: Hit<'s>, u: &mut Numbers<'_>) -> V {
    scene.reflected(x, u, |technique, densities| ThreeHalves.weight(technique, &densities))
}
// end

/// Direct light by solid angle, with quasi-Monte Carlo points.
// glue: qmc-sampling
pub fn stratified(scene: &Scene, x: &Hit<'_>, pixel: usize, index: u64, seed: u64) -> V {
    let [u, v] = OwenSobol::new(seed).sampler(pixel as u64, index).next_2d().map(f64::from);
    let Shape::Rectangle { corner, x: edge, y } = scene.lamp().shape else { return V::default() };
    let [p, corner, edge, y] = [x.p, corner, edge, y].map(<[f64; 3]>::from);
    let Ok(seen) = SphericalRectangle::new(p, corner, edge, y) else { return V::default() };
    let wi = V::from(seen.sample([u, v]));
    let hit = scene.hit((x.p, wi), f64::INFINITY);
    let emitted = hit.map_or(V::default(), |hit| hit.emitted());
    emitted * x.value(wi) * (x.n.dot(wi).max(0.0) * seen.solid_angle())
}
// end

pub const PHOTON_RADIUS: f32 = 0.02;

// glue: photon-map
impl Flux for V {
    const ZERO: Self = Self(0.0, 0.0, 0.0);
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn scale(self, factor: f64) -> Self {
        self * factor
    }
    fn is_finite(self) -> bool {
        self.0.is_finite() && self.1.is_finite() && self.2.is_finite()
    }
}
pub fn photons(scene: &Scene, paths: u64, u: &mut Numbers<'_>) -> Result<PhotonMap<V>, photon_map::MapError> {
    let mut photons = Photons::new();
    for _ in 0..paths {
        scene.light_path(u, |y, flux| photons.store(Photon::new(y.p.into(), y.wo.into(), flux)));
    }
    photons.add_paths(paths);
    PhotonMap::build(photons, PHOTON_RADIUS)
}
pub fn density(map: &PhotonMap<V>, x: &Hit<'_>) -> Result<V, photon_map::GatherError> {
    let estimation = DensityEstimation { gather: Gather::within(PHOTON_RADIUS)?, kernel: Kernel::Constant };
    let (at, scratch) = (GatherPoint::on(x.p.into(), x.n.into()), &mut Scratch::default());
    Ok(map.estimate(&estimation, &at, scratch, |photon| x.value(photon.wi().into()) * photon.flux()).value)
}
// end

// glue: path-space-filter
#[derive(Clone, Copy)]
pub struct Seen<'s>(pub Hit<'s>, pub V);
impl PathVertex for Seen<'_> {
    type Contribution = [f64; 3];
    fn position(&self) -> [f32; 3] {
        self.0.p.into()
    }
    fn contribution(&self) -> [f64; 3] {
        self.1.into()
    }
}
impl HasNormal for Seen<'_> {
    fn normal(&self) -> [f32; 3] {
        self.0.n.into()
    }
}
pub fn filtered(vertices: &[Seen<'_>]) -> Result<Vec<V>, RadiusError> {
    let filter = PathSpaceFilter::new(Radius::absolute(0.03)?).similarity(NormalCone::PAPER);
    Ok(filter.average(vertices, 1).into_iter().map(V::from).collect())
}
// end

/// Points cross the crates' interfaces as arrays.
// glue: (arrays, shared)
impl From<V> for [f64; 3] {
    fn from(v: V) -> Self {
        [v.0, v.1, v.2]
    }
}
impl From<V> for [f32; 3] {
    fn from(v: V) -> Self {
        [v.0 as f32, v.1 as f32, v.2 as f32]
    }
}
impl From<[f64; 3]> for V {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self(x, y, z)
    }
}
impl From<[f32; 3]> for V {
    fn from(v: [f32; 3]) -> Self {
        v.map(f64::from).into()
    }
}
// end
