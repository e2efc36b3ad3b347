//! Resampled connections of bidirectional path tracing.

use qmc_sampling::Sampler;
use ris::Reservoir;
use scene_core::{Ray, Spectrum};
use smallvec::SmallVec;
use vpl_gi::ConnectionTests;

/// Of all connections of an eye path a few are tested for occlusion, chosen in proportion to their weighted contributions.
///
/// ```text
/// sum over connections of c_j V_j  ~  1/N sum_i  c_Y V_Y  sum_j |c_j| / |c_Y|
/// ```
/// **Symbols.** `c_j`: the weighted, unoccluded contribution of connection `j`, `|c|` its luminance; `V`: visibility; `N`: rays per eye path.
///
/// **Unbiased.** **Cost**: `N` shadow rays per eye path instead of one per connection.
///
/// **Source.** Lafortune and Willems 1995 (*Reducing the number of shadow rays in bidirectional path tracing*); it is resampling with the
/// connections as candidates (Talbot, Cline and Egbert 2005, section 2).
#[derive(Clone, Debug)]
pub struct ResampledConnections<P, R> {
    reservoirs: SmallVec<[Reservoir<(P, Ray)>; 4]>,
    numbers: R,
}

impl<P: Spectrum, R: Sampler> ResampledConnections<P, R> {
    /// With so many rays per eye path, at least one; numbers come from `numbers`.
    pub fn new(rays: u32, numbers: R) -> Self {
        Self { reservoirs: (0..rays.max(1)).map(|_| Reservoir::new()).collect(), numbers }
    }
}

impl<P: Spectrum, R: Sampler> ConnectionTests<P> for ResampledConnections<P, R> {
    fn connect(&mut self, value: P, ray: Ray, _: impl FnOnce(&Ray) -> bool) -> P {
        let score = value.luminance();
        for reservoir in &mut self.reservoirs {
            reservoir.update((value, ray), score, 1.0, self.numbers.next_1d());
        }
        P::ZERO
    }

    fn finish(&mut self, mut is_occluded: impl FnMut(&Ray) -> bool) -> P {
        let part = 1.0 / self.reservoirs.len() as f32;
        let mut sum = P::ZERO;
        for reservoir in &mut self.reservoirs {
            let picked = core::mem::take(reservoir).finish();
            // The sum over the candidates, not their mean.
            let scale = picked.contribution_weight() * picked.confidence * part;
            if let Some((value, ray)) = picked.sample()
                && !is_occluded(ray)
            {
                sum += *value * scale;
            }
        }
        sum
    }
}
