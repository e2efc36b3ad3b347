//! Which lights get shadow rays.

use super::table::Excluded;
use super::{ContributingLights, LightTable};

/// How the shadow rays for contributing lights are shared out by importance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Allocation {
    /// Expected counts in proportion to importance: Keller and Wald's stratification by area. A light of little importance
    /// often gets no ray, and then counts all the more when it gets one.
    Proportional,
    /// With enough rays, one for each light, the rest in proportion. With fewer, lights are sorted by importance: the
    /// brightest get one ray each for certain, and the others share what is left in proportion.
    ///
    /// The sorting is Ward's (1991); his estimate for the dim lights is replaced by a random choice, which keeps it
    /// unbiased.
    #[default]
    BrightestFirst,
}

/// A shadow ray to be traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowRay {
    /// The light.
    pub light: u32,
    /// One over the expected number of rays to this light: what the ray's contribution is to be multiplied by.
    pub weight: f64,
    /// Which of the light's strata the ray belongs to, from zero.
    pub stratum: u32,
    /// How many rays this light gets: strata of equal probability to place them in.
    pub strata: u32,
    /// Whether the light is one of the contributing.
    pub contributing: bool,
}

/// Why there is no such selection.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SelectionError {
    /// Without rays to the contributing lights, their light is lost.
    #[error("the contributing lights need at least one shadow ray")]
    NoRay,
}

/// Chooses the lights that get shadow rays: a fixed number, whatever the number of lights.
///
/// ```text
/// sum_j s_j  ~  sum over rays of s_j(ray) / e_j        e_j = E(number of rays to light j)
///
/// j in C      e_j from the importance m_j by the Allocation, sum e_j = S_con, counts by systematic rounding:
///             n_j = floor(c_j + e_j + u) - floor(c_j + u),   c_j = sum of e before j
/// j not in C  e_j = S_other a_j / sum over i not in C of a_i
/// ```
///
/// **Symbols.** `s_j`: what light `j` contributes, an estimate by a ray to a random place on it; `C`: the
/// contributing lights, from [`PrimaryPhotonMap`](crate::PrimaryPhotonMap); `S_con`, `S_other`: rays for those in `C`
/// and for all others; `a_j`: the weight in the [`LightTable`]; `m_j`: importance of a contributing light. `u`: one
/// uniform number; it makes `E n_j = e_j` exactly, and their sum `S_con` always. With fewer rays than lights this is
/// systematic resampling, with more it is stratification with unbiased rounding: one piece of code for Keller and Wald's two
/// cases.
///
/// **Assumptions.** `s_j` is zero or estimated without bias for each ray. The set `C` is chosen independently of the
/// rays.
///
/// **Unbiased** for `S_other >= 1`, whatever `C` is: every light has `e_j > 0`. Importance below a thousandth of the
/// mean is raised to that (zero, negative and NaN as well), so no contributing light is lost; infinite counts as very
/// large. A light that contributes although it is not in `C` comes with the large weight `1 / e_j` and shows as a
/// bright dot: choose the radius of the query large. **`S_other = 0` is biased**: light from outside of `C` is
/// missing.
///
/// **Cost.** `O(|C| log |C| + S_con + S_other log M)`; nothing is proportional to the number `M` of lights, and
/// nothing allocated once the vectors have grown. If `C` is empty its rays are not shot; if `C` is everything, the
/// others' are not.
///
/// **Source.** Keller and Wald 2000, section 3; G. Ward, "Adaptive shadow testing for ray tracing", 1991; systematic sampling: W. G.
/// Madow and L. H. Madow, "On the theory of systematic sampling", 1944.
///
/// # Example
/// ```
/// use photon_map::{Allocation, ContributingLights, LightSelection, LightTable, ShadowRays};
/// let areas = [1.0, 1.0, 2.0, 4.0];
/// let selection = LightSelection::new(LightTable::new(&areas)?, 4, 1, Allocation::BrightestFirst)?;
/// let contributing = ContributingLights::from_lights(areas.len(), [0, 2]);
/// let mut rays = ShadowRays::default();
/// selection.select_by_weight(&contributing, [0.1, 0.7], &mut rays);
/// assert_eq!(rays.as_slice().iter().map(|ray| ray.light).collect::<Vec<_>>(), [2, 2, 0, 0, 3]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LightSelection {
    table: LightTable,
    contributing_rays: u32,
    other_rays: u32,
    allocation: Allocation,
}

/// The shadow rays of one point, and the memory to choose them in: keep one per thread.
#[derive(Clone, Debug, Default)]
pub struct ShadowRays {
    rays: Vec<ShadowRay>,
    /// Contributing lights with their importance.
    importance: Vec<(u32, f64)>,
    excluded: Excluded,
}

impl ShadowRays {
    /// The rays: those to contributing lights first, rays to one light in a row.
    #[must_use]
    pub fn as_slice(&self) -> &[ShadowRay] {
        &self.rays
    }
}

/// Importance below this share of the mean is raised to it.
const LEAST_IMPORTANCE: f64 = 1e-3;
/// What infinite importance counts as; sums of it are finite.
const MOST_IMPORTANCE: f64 = 1e150;

impl LightSelection {
    /// `contributing_rays` for the contributing lights, `other_rays` for all others; zero of these is biased.
    ///
    /// # Errors
    /// [`SelectionError::NoRay`] if `contributing_rays` is zero.
    pub fn new(
        table: LightTable,
        contributing_rays: u32,
        other_rays: u32,
        allocation: Allocation,
    ) -> Result<Self, SelectionError> {
        if contributing_rays == 0 {
            return Err(SelectionError::NoRay);
        }
        Ok(Self { table, contributing_rays, other_rays, allocation })
    }

    /// The lights with their weights.
    #[must_use]
    pub const fn table(&self) -> &LightTable {
        &self.table
    }

    /// Selects by the weights of the table (the emission area) as importance of the contributing lights.
    ///
    /// `u`: two numbers, uniform in `[0, 1)`.
    pub fn select_by_weight(&self, contributing: &ContributingLights, u: [f64; 2], rays: &mut ShadowRays) {
        self.select(contributing, |light, _| self.table.weight(light) as f64, u, rays);
    }

    /// Selects by any importance of the contributing lights: `importance(light, its number of primary photons)`, as the
    /// unoccluded contribution, or the number of photons itself.
    ///
    /// `u`: two numbers, uniform in `[0, 1)`: one for the contributing lights, one for the others.
    pub fn select(
        &self,
        contributing: &ContributingLights,
        mut importance: impl FnMut(u32, u32) -> f64,
        u: [f64; 2],
        rays: &mut ShadowRays,
    ) {
        let ShadowRays { rays, importance: lights, excluded } = rays;
        rays.clear();
        lights.clear();
        lights.extend(contributing.as_slice().iter().map(|&(light, photons)| (light, importance(light, photons))));
        if !lights.is_empty() {
            sanitise(lights);
            expect(lights, self.contributing_rays, self.allocation);
            round(lights, u[0], rays);
        }
        excluded.set(&self.table, contributing);
        let others = f64::from(self.other_rays);
        for ray in 0..self.other_rays {
            let u = (f64::from(ray) + u[1]) / others;
            let Some((light, probability)) = self.table.sample_outside(excluded, u) else { break };
            let weight = 1.0 / (others * probability);
            rays.push(ShadowRay { light, weight, stratum: 0, strata: 1, contributing: false });
        }
    }
}

/// Makes importance positive and finite.
fn sanitise(lights: &mut [(u32, f64)]) {
    for (_, importance) in lights.iter_mut() {
        *importance = if *importance > 0.0 { importance.min(MOST_IMPORTANCE) } else { 0.0 };
    }
    let mean = lights.iter().map(|(_, importance)| importance).sum::<f64>() / lights.len() as f64;
    // All zero: equal.
    let least = if mean > 0.0 { LEAST_IMPORTANCE * mean } else { 1.0 };
    lights.iter_mut().for_each(|(_, importance)| *importance = importance.max(least));
}

/// Replaces importance by expected counts, which sum to `rays` and are positive.
fn expect(lights: &mut [(u32, f64)], rays: u32, allocation: Allocation) {
    let proportional = |lights: &mut [(u32, f64)], rays: f64, each: f64| {
        let sum: f64 = lights.iter().map(|(_, importance)| importance).sum();
        lights.iter_mut().for_each(|(_, importance)| *importance = each + rays * (*importance / sum));
    };
    let rays = f64::from(rays);
    if allocation == Allocation::Proportional {
        return proportional(lights, rays, 0.0);
    }
    // The brightest first; equal ones by their number, so that the order is a function of the set.
    lights.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let surplus = rays - lights.len() as f64;
    if surplus >= 0.0 {
        return proportional(lights, surplus, 1.0);
    }
    // A light is certain as long as its share of the remaining rays is at least one.
    let mut left: f64 = lights.iter().map(|(_, importance)| importance).sum();
    let mut certain = 0;
    while rays - certain as f64 > 1.0 && lights[certain].1 * (rays - certain as f64) >= left {
        left -= lights[certain].1;
        certain += 1;
    }
    let (bright, dim) = lights.split_at_mut(certain);
    bright.iter_mut().for_each(|(_, importance)| *importance = 1.0);
    proportional(dim, rays - certain as f64, 0.0);
}

/// Systematic rounding of expected counts: each light gets one of the two whole numbers next to its count.
fn round(lights: &[(u32, f64)], u: f64, rays: &mut Vec<ShadowRay>) {
    let mut sum = 0.0;
    let mut before = (sum + u).floor();
    for &(light, expected) in lights {
        sum += expected;
        let after = (sum + u).floor();
        let strata = (after - before).max(0.0) as u32;
        before = after;
        let ray = |stratum| ShadowRay { light, weight: 1.0 / expected, stratum, strata, contributing: true };
        rays.extend((0..strata).map(ray));
    }
}
