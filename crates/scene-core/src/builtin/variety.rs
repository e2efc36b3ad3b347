//! Numbers that make books, leaves and chairs differ.

/// A fixed sequence of numbers in `[0, 1)`: the Weyl sequence of the golden ratio, hashed by the finaliser of
/// MurmurHash3 (Appleby 2008). The same on every machine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variety(u32);

impl Variety {
    /// The sequence number `seed`.
    pub(crate) fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x85eb_ca6b))
    }

    /// The next number.
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        let mut x = self.0;
        x = (x ^ x >> 16).wrapping_mul(0x85eb_ca6b);
        x = (x ^ x >> 13).wrapping_mul(0xc2b2_ae35);
        ((x ^ x >> 16) >> 8) as f32 / (1 << 24) as f32
    }

    /// The next number, between `low` and `high`.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// The next number, as an index below `count`.
    pub(crate) fn index(&mut self, count: usize) -> usize {
        (self.unit() * count as f32) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_even_and_repeat() {
        let (mut a, mut b) = (Variety::new(7), Variety::new(7));
        let mut counts = [0; 10];
        for _ in 0..10_000 {
            let x = a.unit();
            assert_eq!(x, b.unit());
            counts[(10.0 * x) as usize] += 1;
        }
        assert!(counts.iter().all(|count| (900..1100).contains(count)), "{counts:?}");
        assert!((0..100).all(|_| a.index(6) < 6 && (2.0..3.0).contains(&a.between(2.0, 3.0))));
        assert_ne!(Variety::new(1).unit(), Variety::new(2).unit());
    }
}
