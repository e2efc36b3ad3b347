//! What a heuristic may know of a path, and how it weighs.

use glam::Vec3A;
use mis_heuristics::{Densities, Heuristic, Lazy, Stratification};

use crate::partition::Partition;

/// A complete path `x_0 .. x_l` from the lens to a light, and the techniques that generate such paths.
///
/// Technique `i` has `i` light vertices: it connects the eye path's `x_(l-i)` to the light path's `x_(l-i+1)`. Technique 0 hits the light;
/// technique `l`, if it is in the set, connects the light path to the lens.
///
/// # Laws
/// Everything is a function of the path alone, whichever technique generated it (densities up to a common factor).
///
/// Not dyn compatible: `densities` returns a type of its own. Whoever takes a path is generic.
pub trait PathTechniques {
    /// `l`.
    fn segments(&self) -> usize;

    /// `n_i p_i` for all techniques of the set, in the product area measure, over that of the technique that generated the path. Nothing
    /// is computed before it is asked for.
    fn densities(&self) -> impl Densities<f64>;

    /// `|cos cos| / d^2` between `x_k` and `x_(k+1)`, in 1/length^2: zero if one of them is at infinity or has no normal.
    fn geometry_term(&self, k: usize) -> f32;

    /// Where `x_k` is; nothing at infinity.
    fn position(&self, k: usize) -> Option<Vec3A>;

    /// Unit direction from `x_k` to `x_(k+1)`.
    fn direction(&self, k: usize) -> Vec3A;

    /// Whether the path goes on by a Dirac delta at `x_k`.
    fn is_specular(&self, k: usize) -> bool;

    /// Whether technique `l - k` can generate the path: neither `x_k` nor `x_(k+1)` scatters by a Dirac delta. `k = 0` is the connection
    /// to the lens.
    fn can_connect(&self, k: usize) -> bool;

    /// Whether technique 0 can generate the path: a ray can hit the light.
    fn can_hit(&self) -> bool;

    /// Squared distance between `x_k` and `x_(k+1)`: infinite if one of them is at infinity.
    fn distance_squared(&self, k: usize) -> f32 {
        match (self.position(k), self.position(k + 1)) {
            (Some(x), Some(y)) => x.distance_squared(y),
            _ => f32::INFINITY,
        }
    }
}

/// Shares the weight of a path out among its techniques.
///
/// # Laws
/// The weights of all techniques of a path sum to one if any of them can generate it; those that cannot have weight zero.
///
/// Not dyn compatible, because `weight` is generic: to choose at run time, implement it for an enum of the choices.
pub trait PathHeuristic {
    /// The weight of `technique`.
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64;

    /// Whether to weigh before the shadow ray is traced, because weights are cheap and often zero; otherwise what is occluded is never
    /// weighed.
    #[inline]
    fn weighs_first(&self) -> bool {
        false
    }
}

/// Any [`Heuristic`] of densities: balance, power, maximum, cutoff, ...
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Classical<H>(pub H);

impl<H: Heuristic<f64>> PathHeuristic for Classical<H> {
    #[inline]
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        self.0.weight(technique, &path.densities())
    }
}

/// The stratification heuristic by the geometry terms of a path's edges. Asks for no density.
///
/// ```text
/// w(l,i) = s(x_(l-i), x_(l-i+1)) prod_(k<l-i) (1 - s(x_k, x_(k+1))),  k from 1,      w(l,0) = prod_(k<l) (1 - s(x_k, x_(k+1)))
/// ```
/// **Symbols.** `s`: the [`Partition`]'s share of connections. Techniques that cannot generate the path take no share; where the light
/// cannot be hit, the last that can takes the rest. The connection to the lens, which Kollig and Keller 2004 does not know, takes what nothing else can
/// generate.
///
/// With shared light paths this is [`RobustIgi`](crate::RobustIgi), which does not trace what it knows to weigh zero: this one is for comparison.
///
/// **Source.** Kollig and Keller 2004, section 3.2; see [`Stratification`] for the weight that the print leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stratified(pub Partition);

impl PathHeuristic for Stratified {
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        let segments = path.segments();
        if technique == segments {
            let others = path.can_hit() || (1..segments).any(|k| path.can_connect(k));
            return if others { 0.0 } else { 1.0 };
        }
        let share = |k: usize| {
            path.can_connect(k)
                .then(|| f64::from(self.0.share_with(path.geometry_term(k), || path.distance_squared(k))))
        };
        let mut strata = Stratification::by_light_vertices(share);
        if !path.can_hit() {
            strata = strata.without_last();
        }
        strata.weight(technique, &Lazy::new(segments, |_| f64::NAN))
    }

    #[inline]
    fn weighs_first(&self) -> bool {
        true
    }
}
