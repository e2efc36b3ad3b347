//! Participating media: phase function, free flight, and walks against closed forms.
#![cfg(feature = "reference")]
// The lint exempts test functions, but not their helpers.
#![allow(clippy::unwrap_used)]

mod flight;
mod furnace;
mod phase;
mod robust;
mod slab;

use estimator_checks::{Check, Moments, Suite};
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::{SceneBuilder, furnace};
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::medium::Medium;
use scene_core::reference::Light;
use scene_core::{Ray, ReferenceScene, Rgb, Scene, Spectrum, TransportMode, Vertex};

pub(crate) static SUITE: Suite = Suite::with_share("scene-core media", 48, 2e-8);

/// A ball of radius 1 around the origin, filled, in uniform radiance 1.
pub(crate) fn ball(int_ior: f32, medium: Medium<Rgb>) -> ReferenceScene {
    ReferenceScene::new(furnace(Material::glass(int_ior).filled_with(medium))).unwrap()
}

/// A box of this thickness below z = 0, filled, in uniform radiance 1; 50 wide.
pub(crate) fn slab(int_ior: f32, thickness: f32, medium: Medium<Rgb>) -> ReferenceScene {
    let mut b = SceneBuilder::new("slab");
    let material = b.material(Material::glass(int_ior).filled_with(medium));
    b.cuboid(material, Vec3A::new(0.0, 0.0, -0.5 * thickness), Vec3A::new(25.0, 25.0, 0.5 * thickness), 0.0);
    b.light(Light::Constant { radiance: Rgb::ONE });
    b.look(Vec3A::new(0.0, 0.0, 4.0), Vec3A::ZERO, 40.0, 16, 16);
    ReferenceScene::new(b.finish()).unwrap()
}

/// How a path ended.
pub(crate) struct End {
    /// What it brings from outside, where radiance is one.
    pub throughput: Rgb,
    /// How often it scattered in media.
    pub scatterings: u32,
    /// The direction in which it left.
    pub direction: Vec3A,
}

/// Follows a path from `ray` until it leaves the scene; nothing if it does not.
pub(crate) fn path(scene: &ReferenceScene, mut ray: Ray, sampler: &mut impl Sampler) -> Option<End> {
    let (mut throughput, mut medium, mut scatterings) = (Rgb::ONE, None::<Medium<Rgb>>, 0);
    loop {
        let mut vertex = None;
        match &medium {
            None => vertex = scene.intersect(&ray),
            Some(medium) => {
                let exit = medium.walk(scene, ray, throughput, sampler)?;
                scatterings += exit.scatterings;
                (vertex, ray, throughput) = (exit.vertex.or(vertex), exit.ray, exit.throughput);
            }
        }
        let Some(vertex) = vertex else { return Some(End { throughput, scatterings, direction: ray.direction }) };
        let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
        let sample = vertex.sample([lobe, u, v], TransportMode::Radiance)?;
        throughput *= sample.throughput;
        assert!(throughput.is_finite());
        medium = vertex.medium(sample.wi, medium);
        ray = vertex.spawn_ray(sample.wi);
    }
}

/// Moments of `value` over independent paths from `ray`; of those that end inside it is zero.
pub(crate) fn moments(
    check: &Check,
    scene: &ReferenceScene,
    ray: Ray,
    paths: u64,
    value: impl Fn(&End) -> f32,
) -> Moments {
    let family = Independent::new(check.seed());
    let sample = |i| path(scene, ray, &mut family.sampler(0, i)).map_or(0.0, |end| f64::from(value(&end)));
    (0..paths).map(sample).collect()
}

/// Downwards onto the middle of the ball or slab, at this cosine.
pub(crate) fn down(cos: f32) -> Ray {
    let direction = Vec3A::new((1.0 - cos * cos).sqrt(), 0.0, -cos);
    Ray::new(Vec3A::new(0.0, 0.0, 1e-3) - direction * 2.0, direction)
}
