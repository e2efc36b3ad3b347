//! The stratification heuristic.

use crate::{Densities, Float, Heuristic};

/// What the predicate of a [`Stratification`] says about one technique.
///
/// Implemented for `bool` (the whole remaining weight, or none of it), for `f32` and `f64` (a fraction of it, in `[0,
/// 1]`;
/// NaN counts as zero), and for `Option` of these, where `None` says that the technique **cannot generate** the sample.
pub trait Verdict<F> {
    /// The fraction of the remaining weight, or `None` if the technique cannot generate the sample.
    fn share(self) -> Option<F>;
}

impl<F: Float> Verdict<F> for bool {
    #[inline]
    fn share(self) -> Option<F> {
        Some(if self { F::ONE } else { F::ZERO })
    }
}

impl<F: Float> Verdict<F> for F {
    #[inline]
    fn share(self) -> Option<F> {
        let share = self.positive_part();
        Some(if share < F::ONE { share } else { F::ONE })
    }
}

impl<F, V: Verdict<F>> Verdict<F> for Option<V> {
    #[inline]
    fn share(self) -> Option<F> {
        self.and_then(V::share)
    }
}

/// The stratification heuristic: techniques are tried in order, and a predicate, not a density, says who takes the
/// sample.
///
/// ```text
/// w_k = s_k prod_(j<k) (1 - s_j)    for k < l-1,
/// w_(l-1) =  prod_(j<l-1) (1 - s_j)
/// ```
///
/// **Symbols.** `l`: number of techniques; `s_k` in `[0, 1]`: the share that technique `k` takes of what the
/// techniques before it
/// left, zero or one for a hard stratification. Any function of the sample will do: Kollig and Keller 2004 takes `s_k = 1` where the
/// geometry
/// term between the path vertices `x_k` and `x_(k+1)` is below a threshold (see
/// [`GeometryPartition`](crate::GeometryPartition)).
/// The last technique takes the rest: Kollig and Keller's print leaves its weight out, and without it the sum is not one.
///
/// **Assumptions.** The predicate depends on the sample alone, not on the technique that generated it. A technique that
/// cannot generate the sample must get no weight: for it the predicate returns `None`, or a share of zero
/// where it is certain that a later one can. (At a specular vertex the connection to a point light has density zero,
/// hence the eye path goes on there, however small the geometry term.) If the *last* technique cannot generate the
/// sample (a path tracer that would have to hit a point light), say so by [`without_last`](Self::without_last); then
/// the last possible technique takes the rest. If all are impossible, all weights are zero.
///
/// **Unbiased.** The weights sum to one by construction. It may have more variance than the balance heuristic, and
/// still be the more
/// efficient: no technique has to be evaluated, or even sampled, for the weight of another.
///
/// **Cost.** Asks for **no density**; the predicate at most once for each technique up to the one in question
/// (and for those after it only after [`without_last`](Self::without_last)), never for the last.
///
/// **Source.** Kollig and Keller 2004, section 3.2; the soft form follows T. Kollig and A. Keller, "Illumination in the Presence of Weak
/// Singularities", 2006.
///
/// # Example
/// A path `x_0 .. x_3` (lens to light) has three techniques, told apart by the number of light vertices.
/// ```
/// use mis_heuristics::{Heuristic, Lazy, Stratification};
///
/// let geometry_term = [0.0, 2.5, 0.1, 0.0]; // between x_k and x_(k+1)
/// let strata = Stratification::by_light_vertices(|k| geometry_term[k] < 0.3);
/// let densities = Lazy::new(3, |_| -> f32 { unreachable!("no density is asked for") });
///
/// assert_eq!(strata.weight(2, &densities), 0.0); // connecting x_1 to the light path: too close to x_2
/// assert_eq!(strata.weight(1, &densities), 1.0); // connecting x_2 to the light
/// assert_eq!(strata.weight(0, &densities), 0.0); // hitting the light
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stratification<P> {
    predicate: P,
    order: Order,
    last_possible: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    Technique,
    LightVertices,
}

impl<P> Stratification<P> {
    /// Technique 0 is tried first; `predicate(k)` gives the [`Verdict`] on technique `k`.
    #[inline]
    pub const fn new(predicate: P) -> Self {
        Self { predicate, order: Order::Technique, last_possible: true }
    }

    /// Kollig and Keller's indices: technique `i` of `l` has `i` light vertices, and technique `l-1` is tried first.
    ///
    /// `predicate(k)` gives the [`Verdict`] on connecting eye path vertex `x_k` to light path vertex `x_(k+1)`,
    /// `k` from 1 to `l-1`, which is technique `i = l - k`.
    #[inline]
    pub const fn by_light_vertices(predicate: P) -> Self {
        Self { predicate, order: Order::LightVertices, last_possible: true }
    }

    /// Says that the last technique to be tried cannot generate the sample.
    #[inline]
    #[must_use]
    pub fn without_last(mut self) -> Self {
        self.last_possible = false;
        self
    }
}

impl<F: Float, V: Verdict<F>, P: Fn(usize) -> V> Heuristic<F> for Stratification<P> {
    /// # Panics
    /// If `technique >= densities.len()`.
    #[inline]
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        let len = densities.len();
        assert!(technique < len, "technique {technique} of {len}");
        let last = len - 1;
        let (position, first) = match self.order {
            Order::Technique => (technique, 0),
            Order::LightVertices => (last - technique, 1),
        };
        let share = |position: usize| (self.predicate)(first + position).share();

        let mut rest = Remainder::WHOLE;
        for earlier in 0..position {
            if let Some(taken) = share(earlier) {
                rest = rest.after(taken);
                if rest.is_used_up() {
                    return F::ZERO;
                }
            }
        }
        if position == last {
            return if self.last_possible { rest.left } else { F::ZERO };
        }
        match share(position) {
            None => F::ZERO,
            Some(taken) if self.last_possible || (position + 1..last).any(|later| share(later).is_some()) => {
                rest.taken(taken)
            }
            Some(_) => rest.left,
        }
    }
}

/// The weight that is left along an eye path: the stratification heuristic while the path is being traced.
///
/// ```text
/// left_1 = 1,    left_(k+1) = left_k (1 - s_k)
/// ```
///
/// **Symbols.** `s_k`: share of the connection at vertex `x_k`, as in [`Stratification`]. A connection to a light
/// path vertex
/// `y` weighs `taken(s(x_k, y))`; scattering to `x_(k+1)` leaves `after(s(x_k, x_(k+1)))`, and the path ends when
/// nothing is left.
///
/// **Cost.** One multiplication.
///
/// **Source.** Kollig and Keller 2004, section 2, steps a and b.
///
/// # Example
/// ```
/// use mis_heuristics::{GeometryPartition, Remainder};
///
/// let partition = GeometryPartition::soft(0.5_f32)?;
/// let at_x1 = Remainder::<f32>::WHOLE;
/// assert_eq!(at_x1.taken(partition.share(0.1)), 1.0);  // a point light far away
/// assert_eq!(at_x1.taken(partition.share(2.0)), 0.25); // a close one
/// let at_x2 = at_x1.after(partition.share(2.0));       // the scattered ray hits something close
/// assert_eq!(at_x2.left(), 0.75);
/// assert!(at_x1.after(partition.share(0.1)).is_used_up());
/// # Ok::<(), mis_heuristics::PartitionError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder<F> {
    left: F,
}

impl<F: Float> Remainder<F> {
    /// At the first vertex, before anything was taken.
    pub const WHOLE: Self = Self { left: F::ONE };

    /// The weight that is left.
    #[inline]
    pub fn left(self) -> F {
        self.left
    }

    /// The weight of a connection that takes `share` (in `[0, 1]`) of what is left.
    #[inline]
    pub fn taken(self, share: F) -> F {
        self.left * share
    }

    /// What is left when `share` (in `[0, 1]`) has been taken.
    #[inline]
    #[must_use]
    pub fn after(self, share: F) -> Self {
        Self { left: self.left * (F::ONE - share) }
    }

    /// Whether nothing is left, so that the path can end.
    #[inline]
    pub fn is_used_up(self) -> bool {
        self.left == F::ZERO
    }
}

/// Everything is left.
impl<F: Float> Default for Remainder<F> {
    fn default() -> Self {
        Self::WHOLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Counting, HeuristicExt};

    const UNIT: [f64; 4] = [1.0; 4];

    fn weights(strata: &impl Heuristic<f64>) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| strata.weight(i, &UNIT))
    }

    #[test]
    fn hard_strata_follow_the_paper() {
        for mask in 0..8 {
            let connects = |k: usize| mask >> k & 1 == 1;
            let expected = (0..3).find(|&k| connects(k)).unwrap_or(3);
            let found = weights(&Stratification::new(connects));
            assert_eq!(found, [0, 1, 2, 3].map(|k| f64::from(u8::from(k == expected))));
            // w(l, l-k) = w(x_k, x_(k+1)) prod_(j<k) (1 - w(x_j, x_(j+1))), k from 1.
            let mut reversed = weights(&Stratification::by_light_vertices(|k| connects(k - 1)));
            reversed.reverse();
            assert_eq!(found, reversed);
        }
    }

    #[test]
    fn soft_strata_share() {
        let shares = [0.5, 0.0, 0.25];
        assert_eq!(weights(&Stratification::new(|k| shares[k])), [0.5, 0.0, 0.125, 0.375]);
        assert_eq!(weights(&Stratification::new(|k| [f64::NAN, 2.0, 0.5][k])), [0.0, 1.0, 0.0, 0.0]);
        assert_eq!(weights(&Stratification::new(|k| [-1.0, f64::INFINITY, 0.5][k])), [0.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn impossible_techniques_get_nothing() {
        // x_1 is specular; nothing may be connected there, however far away the light.
        assert_eq!(weights(&Stratification::new(|k| (k != 0).then_some(true))), [0.0, 1.0, 0.0, 0.0]);
        // A point light cannot be hit: the last connection takes the rest.
        assert_eq!(weights(&Stratification::new(|_| false).without_last()), [0.0, 0.0, 1.0, 0.0]);
        let specular_end = |k: usize| (k != 2).then_some(0.25);
        assert_eq!(weights(&Stratification::new(specular_end).without_last()), [0.25, 0.75, 0.0, 0.0]);
        assert_eq!(weights(&Stratification::new(|_| None::<bool>)), [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(weights(&Stratification::new(|_| None::<bool>).without_last()), [0.0; 4]);
    }

    #[test]
    fn no_density_is_asked_for() {
        let densities = Counting::new(UNIT);
        assert_eq!(Stratification::new(|k| k == 1).weight_sum(&densities), 1.0);
        assert_eq!(Stratification::new(|k| 0.125 * k as f64).without_last().weight_sum(&densities), 1.0);
        assert_eq!(densities.asked(), 0);
    }

    #[test]
    fn one_technique_takes_all() {
        assert_eq!(Stratification::new(|_| -> bool { unreachable!() }).weight(0, &[0.3]), 1.0);
    }

    #[test]
    #[should_panic(expected = "technique 4 of 4")]
    fn technique_must_exist() {
        let _: f64 = Stratification::new(|_| true).weight(4, &UNIT);
    }
}
