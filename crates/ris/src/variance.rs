//! The variance model: e1, e2, e3 per component, and what they predict.

use crate::{Budget, Float};

/// A streaming estimate of the three numbers that the variance of resampled importance sampling consists of.
///
/// ```text
/// V(M, N) = 1/N [ (e3 - e2)/M + (e2 - e1) ]                                               (Talbot, Cline and Egbert 2005, equation 2)
/// e1 = (E[f/p])^2     e2 = E[f^2/(g p)] E[g/p]     e3 = E[f^2/p^2]
/// ```
///
/// **Symbols.** `f`: the integrand, with `C` components; `g`: the target, not normalised; `p`: the density of the candidates, over
/// which the expectations `E` are taken. (Talbot, Cline and Egbert 2005 prints `E(f/p)^2` for `e1`: the square is outside.)
///
/// **Estimates.** From `n` independent candidates with `a = f/p`, `b = f^2/(g p)`, `c = g/p`:
///
/// ```text
/// e1 ~ (S_a^2 - S_aa) / (n (n-1))     e2 ~ (S_b S_c - S_bc) / (n (n-1)),  bc = a^2     e3 ~ S_aa / n
/// ```
///
/// The products of sums of *different* candidates make all three unbiased. They are noisy where `f/p` is: pool them over many
/// points ([`merge`](Self::merge), [`RatioMap`](crate::RatioMap)).
///
/// **The sign of `e3 - e2`.** As `e3 = E[b c]`, the difference is the covariance of `b` and `c`. It is negative if `g` promises
/// much where `f^2/(g p)` is small, that is, if `g` fits `f` worse than `p` does: more candidates then make the variance
/// **larger**, see [`more_candidates_hurt`](Self::more_candidates_hurt).
///
/// **Bad input.** Candidates with `p <= 0`, or with numbers or quotients that are not finite (or beyond 1e140), count as zero in all sums (and among the `n`).
/// Where `g = 0` and `f != 0` resampling is biased and `e2` infinite: such candidates are counted, see
/// [`unsupported`](Self::unsupported), and left out of `e2`.
///
/// **Source.** Talbot, Cline and Egbert 2005, section 4.1; Talbot 2005 for the derivation; `docs/ris.md` repeats it.
///
/// # Example
/// ```
/// use ris::{Budget, VarianceModel};
/// // f = x^2, p = 1 on [0, 1], g = x: e1 = 1/9, e2 = E[x^3] E[x] = 1/8, e3 = 1/5.
/// let mut model = VarianceModel::<1>::new();
/// for k in 0..1000 {
///     let x = (k as f64 + 0.5) / 1000.0;
///     model.add([x * x], x, 1.0);
/// }
/// let variance = model.predict(Budget::new(2.0, 1.0))[0];
/// assert!((variance - ((0.2 - 0.125) / 2.0 + 0.125 - 1.0 / 9.0)).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceModel<const C: usize> {
    count: u64,
    unsupported: u64,
    /// Sum of `v g / p`.
    target: f64,
    components: [Sums; C],
}

/// Products of sums of smaller numbers are finite.
const HUGE: f64 = 1e140;

/// Sums of one component of the integrand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sums {
    /// `v f / p`, with `v = p / q` for candidates of density `q`.
    ratio: f64,
    /// `(v f / p)^2`: the part that `e1` has to leave out.
    square: f64,
    /// `v (f / p)^2`.
    square_ratio: f64,
    /// `v f^2 / (g p)`.
    over_target: f64,
    /// `(v f / p)^2` of the candidates with `g > 0`: the part that `e2` has to leave out.
    paired: f64,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.ratio += other.ratio;
        self.square += other.square;
        self.square_ratio += other.square_ratio;
        self.over_target += other.over_target;
        self.paired += other.paired;
    }
}

/// `e1`, `e2`, `e3` of one component.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expectations {
    /// `(E[f/p])^2`: the square of the integral.
    pub e1: f64,
    /// `E[f^2/(g p)] E[g/p]`.
    pub e2: f64,
    /// `E[f^2/p^2]`.
    pub e3: f64,
}

impl Expectations {
    /// `e3 - e2`: the variance that more candidates reduce. Negative if they increase it.
    pub fn reducible(&self) -> f64 {
        self.e3 - self.e2
    }

    /// `e2 - e1`: the variance that is left with infinitely many candidates.
    pub fn remaining(&self) -> f64 {
        self.e2 - self.e1
    }

    /// Equation 2.
    pub fn variance(&self, mean_inverse_candidates: f64, mean_inverse_samples: f64) -> f64 {
        mean_inverse_samples * (mean_inverse_candidates * self.reducible() + self.remaining())
    }
}

impl<const C: usize> Default for VarianceModel<C> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const C: usize> VarianceModel<C> {
    /// Without candidates.
    pub const fn new() -> Self {
        const NONE: Sums = Sums { ratio: 0.0, square: 0.0, square_ratio: 0.0, over_target: 0.0, paired: 0.0 };
        Self { count: 0, unsupported: 0, target: 0.0, components: [NONE; C] }
    }

    /// Adds a candidate with its integrand `f`, target `g` and density `p`.
    pub fn add<F: Float>(&mut self, f: [F; C], g: F, p: F) {
        self.add_drawn(f, g, p, p);
    }

    /// [`add`](Self::add) for a candidate that was drawn with density `drawn` instead of `p`: the model is that of candidates of density `p`
    /// all the same. So the variance of a poor source can be known from the candidates of a good one, without waiting for its rare events.
    ///
    /// ```text
    /// E_p[h] = E_q[h p/q]
    /// ```
    /// `drawn` has to be positive wherever `p` and `f` or `g` are.
    ///
    /// ```
    /// use ris::VarianceModel;
    /// // f = x^2, g = x, and p = 1 as above, but drawn with density 2x: e1 = 1/9, e2 = 1/8, e3 = 1/5.
    /// let mut model = VarianceModel::<1>::new();
    /// for k in 0..10_000 {
    ///     let x = ((f64::from(k) + 0.5) / 10_000.0).sqrt();
    ///     model.add_drawn([x * x], x, 1.0, 2.0 * x);
    /// }
    /// let [all] = model.expectations().unwrap();
    /// assert!((all.e1 - 1.0 / 9.0).abs() < 1e-3 && (all.e2 - 0.125).abs() < 1e-3 && (all.e3 - 0.2).abs() < 1e-3);
    /// ```
    pub fn add_drawn<F: Float>(&mut self, f: [F; C], g: F, p: F, drawn: F) {
        self.count += 1;
        let [g, p, drawn] = [g, p, drawn].map(|x| x.weight_or_zero().to_f64());
        let weight = p / drawn;
        let f = f.map(Float::to_f64);
        let terms = f.map(|f| {
            let ratio = f / p;
            let square = (weight * ratio) * (weight * ratio);
            let (over_target, paired) = if g > 0.0 { (weight * ratio * (f / g), square) } else { (0.0, 0.0) };
            Sums { ratio: weight * ratio, square, square_ratio: weight * ratio * ratio, over_target, paired }
        });
        let finite = |sums: &Sums| sums.square < HUGE && sums.square_ratio < HUGE && sums.over_target < HUGE;
        if p == 0.0 || drawn == 0.0 || g / drawn >= HUGE || !terms.iter().all(finite) {
            return;
        }
        if g == 0.0 && f.iter().any(|&f| f != 0.0) {
            self.unsupported += 1;
        }
        self.target += g / drawn;
        for (sums, term) in self.components.iter_mut().zip(&terms) {
            sums.add(term);
        }
    }

    /// Adds a candidate that could not be drawn: all is zero, but it counts.
    pub fn add_nothing(&mut self) {
        self.count += 1;
    }

    /// Adds the candidates of another model.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.unsupported += other.unsupported;
        self.target += other.target;
        for (sums, other) in self.components.iter_mut().zip(&other.components) {
            sums.add(other);
        }
    }

    /// Number of candidates.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Number of candidates with `f != 0` where `g = 0`: if there are any, resampling with this target is biased.
    pub fn unsupported(&self) -> u64 {
        self.unsupported
    }

    /// The estimates per component; `None` with fewer than two candidates.
    pub fn expectations(&self) -> Option<[Expectations; C]> {
        if self.count < 2 {
            return None;
        }
        let n = self.count as f64;
        let pairs = n * (n - 1.0);
        Some(self.components.map(|sums| Expectations {
            e1: (sums.ratio * sums.ratio - sums.square) / pairs,
            e2: (sums.over_target * self.target - sums.paired) / pairs,
            e3: sums.square_ratio / n,
        }))
    }

    /// Variance per component with this budget, whose counts are rounded at random as [`Ris`](crate::Ris) does; NaN with
    /// fewer than two candidates. Estimates of small variances may come out negative.
    pub fn predict(&self, budget: Budget) -> [f64; C] {
        let m = Budget::mean_inverse(budget.candidates());
        let n = Budget::mean_inverse(budget.samples());
        match self.expectations() {
            Some(all) => all.map(|component| component.variance(m, n)),
            None => [f64::NAN; C],
        }
    }

    /// Whether the sum of `e3 - e2` over the components, with these factors, is negative: `M = 1` is then the best.
    pub fn more_candidates_hurt(&self, factors: [f64; C]) -> bool {
        self.expectations().is_some_and(|all| {
            all.iter().zip(factors).map(|(component, factor)| factor * component.reducible()).sum::<f64>() < 0.0
        })
    }
}
