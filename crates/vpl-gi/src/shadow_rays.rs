//! Which shadow rays are traced.

use qmc_sampling::Sampler;
use scene_core::{Scene, Spectrum, Vertex};

use crate::lights::VirtualPointLights;
use crate::shading::{Connections, for_each_unshadowed, shadow_ray};

/// Which of the lights that contribute get a shadow ray.
///
/// All forms are unbiased: the expectation is the sum over all lights, given the lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ShadowRays {
    /// One for each: no variance beyond that of the lights.
    #[default]
    All,
    /// `count` at most, for lights chosen in proportion to their unshadowed contribution `c_j` (its largest component), by
    /// systematic sampling:
    /// ```text
    /// sum over j of  n_j V_j c_j / E(n_j),    E(n_j) = count c_j / sum c
    /// ```
    /// Source: Wald, Benthin, Slusallek, "Interactive Global Illumination in Complex and Highly Occluded Environments", 2003 (the choice by
    /// contribution); Keller, PhD thesis, 1998.
    Sampled {
        /// Number of rays.
        count: u32,
    },
    /// The brightest first, until what has not been tested contributes at most `tolerance` times what was found visible, or 32 are
    /// tested; the remainder by `remainder` rays as in [`Sampled`](Self::Sampled).
    ///
    /// Source: Ward, "Adaptive Shadow Testing for Ray Tracing", 1991, whose remainder is an extrapolation, and biased.
    Ordered {
        /// 0 tests all of the 32 brightest.
        tolerance: f32,
        /// Rays for the remainder; one at least.
        remainder: u32,
    },
}

/// Number of lights that are sorted.
const BRIGHTEST: usize = 32;

/// The brightest lights so far, sorted.
struct Brightest<S> {
    entries: [(u32, f32, S); BRIGHTEST],
    len: usize,
}

impl<S: Spectrum> Brightest<S> {
    fn new() -> Self {
        Self { entries: [(0, 0.0, S::ZERO); BRIGHTEST], len: 0 }
    }

    fn offer(&mut self, index: usize, brightness: f32, value: S) {
        if self.len == BRIGHTEST && brightness <= self.entries[BRIGHTEST - 1].1 {
            return;
        }
        let mut at = self.len.min(BRIGHTEST - 1);
        self.len = (self.len + 1).min(BRIGHTEST);
        while at > 0 && self.entries[at - 1].1 < brightness {
            self.entries[at] = self.entries[at - 1];
            at -= 1;
        }
        self.entries[at] = (index as u32, brightness, value);
    }

    fn as_slice(&self) -> &[(u32, f32, S)] {
        &self.entries[..self.len]
    }
}

/// The lights as seen from one vertex.
pub(crate) struct Shading<'a, S, X, V: Vertex> {
    pub(crate) scene: &'a S,
    pub(crate) x: &'a X,
    pub(crate) lights: &'a VirtualPointLights<V>,
    pub(crate) connections: Connections<'a>,
}

impl<S, X, V> Shading<'_, S, X, V>
where
    S: Scene<Spectrum = V::Spectrum>,
    X: Vertex<Spectrum = V::Spectrum>,
    V: Vertex,
{
    fn is_visible(&self, index: usize) -> bool {
        !self.scene.occluded(&shadow_ray(self.scene, self.x, self.lights, index))
    }

    fn for_each(&self, with: impl FnMut(usize, V::Spectrum)) {
        for_each_unshadowed(self.scene, self.x, self.lights, &self.connections, with);
    }

    /// The radiance that is reflected.
    #[inline]
    pub(crate) fn radiance(&self, shadow_rays: ShadowRays, sampler: &mut impl Sampler) -> V::Spectrum {
        match shadow_rays {
            ShadowRays::All => {
                let mut sum = V::Spectrum::ZERO;
                self.for_each(|index, value| {
                    if self.is_visible(index) {
                        sum += value;
                    }
                });
                sum
            }
            ShadowRays::Sampled { count } => {
                let u = sampler.next_1d();
                let mut total = 0.0;
                self.for_each(|_, value| total += f64::from(value.max_component()));
                self.systematic(count, total, u, |_| false)
            }
            ShadowRays::Ordered { tolerance, remainder } => self.ordered(tolerance, remainder, sampler.next_1d()),
        }
    }

    /// `count` rays to lights chosen in proportion to their contributions, which sum to `total` without those that are done.
    fn systematic(&self, count: u32, total: f64, u: f32, is_done: impl Fn(usize) -> bool) -> V::Spectrum {
        let mut sum = V::Spectrum::ZERO;
        let step = total / f64::from(count.max(1));
        if step.is_nan() || step <= 0.0 || step.is_infinite() {
            return sum;
        }
        let (mut before, mut next) = (0.0, f64::from(u) * step);
        self.for_each(|index, value| {
            if is_done(index) {
                return;
            }
            let brightness = f64::from(value.max_component());
            before += brightness;
            if next >= before {
                return;
            }
            let hits = ((before - next) / step).ceil();
            next += hits * step;
            if self.is_visible(index) {
                sum += value * (hits * step / brightness) as f32;
            }
        });
        sum
    }

    fn ordered(&self, tolerance: f32, remainder: u32, u: f32) -> V::Spectrum {
        let mut brightest = Brightest::new();
        let mut rest = 0.0;
        self.for_each(|index, value| {
            let brightness = value.max_component();
            rest += f64::from(brightness);
            brightest.offer(index, brightness, value);
        });
        let mut sum = V::Spectrum::ZERO;
        let mut tested = 0;
        for &(index, brightness, value) in brightest.as_slice() {
            if rest <= f64::from(tolerance * sum.max_component()) {
                break;
            }
            if self.is_visible(index as usize) {
                sum += value;
            }
            rest -= f64::from(brightness);
            tested += 1;
        }
        let done = &brightest.as_slice()[..tested];
        let is_done = |index: usize| done.iter().any(|entry| entry.0 as usize == index);
        // Rounding leaves a little where nothing is left; summed anew, the step has the right size.
        let mut total = 0.0;
        self.for_each(|index, value| {
            if !is_done(index) {
                total += f64::from(value.max_component());
            }
        });
        sum + self.systematic(remainder, total, u, is_done)
    }
}
