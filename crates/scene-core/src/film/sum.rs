//! Sums that do not depend on their order.

/// A sum of floating-point numbers together with the sum of all its rounding errors (Knuth's two-sum; Ogita, Rump, Oishi 2005).
///
/// Exact, and so the same bit for bit in any order and however it is cut into parts, as long as
/// ```text
/// n |sum| < 2^106 g
/// ```
/// where all `n` numbers, and the partial sums, are multiples of `g` and no larger than `|sum|`: each rounding error is a multiple of `g` and at most
/// `2^-53 |sum|`, so their sum is below `2^53 g`, and exact. Samples of single precision have `g = 2^-23` of the smallest: a thousand of them may differ by a
/// factor of `2^63`, a million by `2^43`. Beyond that the error is about `n 2^-106 |sum|`, far below the precision of an image.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    /// Adds a finite number.
    #[inline]
    pub(super) fn add(&mut self, x: f64) {
        let sum = self.high + x;
        let part = sum - self.high;
        self.low += (self.high - (sum - part)) + (x - part);
        self.high = sum;
    }

    /// Adds another sum.
    #[inline]
    pub(super) fn merge(&mut self, other: &Self) {
        self.add(other.high);
        self.low += other.low;
    }

    /// The sum, rounded once.
    #[inline]
    pub(super) fn value(&self) -> f64 {
        self.high + self.low
    }

    /// Both parts, to be stored.
    pub(super) fn parts(&self) -> [f64; 2] {
        [self.high, self.low]
    }

    /// From stored parts; nothing if one is not finite.
    pub(super) fn from_parts([high, low]: [f64; 2]) -> Option<Self> {
        (high.is_finite() && low.is_finite()).then_some(Self { high, low })
    }
}

/// Parts may differ where sums do not.
impl PartialEq for Sum {
    fn eq(&self, other: &Self) -> bool {
        self.value() == other.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(values: impl IntoIterator<Item = f64>) -> Sum {
        let mut sum = Sum::default();
        values.into_iter().for_each(|value| sum.add(value));
        sum
    }

    #[test]
    fn what_plain_sums_lose_is_kept() {
        let values = [1e16, 1.0, 1.0, -1e16];
        assert_eq!(values.iter().sum::<f64>(), 0.0);
        assert_eq!(of(values).value(), 2.0);
        assert_eq!(Sum::from_parts([f64::NAN, 0.0]), None);
        assert_eq!(Sum::from_parts(of(values).parts()), Some(of(values)));
    }

    proptest! {
        /// Samples between 1e-6 and 1e6, of any sign, and their squares: every order and every cut give the same bits.
        #[test]
        fn neither_order_nor_cuts_change_a_bit(
            samples in prop::collection::vec((-6.0f32..6.0, any::<bool>()), 1..200),
            squares in any::<bool>(),
            cut in any::<prop::sample::Index>(),
            seed in any::<u64>(),
        ) {
            let value = |&(exponent, negative): &(f32, bool)| {
                let value = f64::from(10.0f32.powf(exponent));
                if squares { value * value } else if negative { -value } else { value }
            };
            let values: Vec<f64> = samples.iter().map(value).collect();
            let (before, after) = values.split_at(cut.index(values.len()));
            let mut parts = of(after.iter().copied());
            parts.merge(&of(before.iter().copied()));
            let mut shuffled: Vec<f64> = values.clone();
            shuffled.sort_by_key(|value| value.to_bits().wrapping_mul(seed | 1));
            let whole = of(values).value().to_bits();
            prop_assert_eq!(parts.value().to_bits(), whole);
            prop_assert_eq!(of(shuffled).value().to_bits(), whole);
        }
    }
}
