//! Rank-1 lattices.
use super::SequenceError;
use crate::float::f64_from_bits;
use crate::hash::combine;
use crate::sequence::Sequence;

/// A generating vector for 2^10 to 2^20 points: the beginning of `lattice-33002-1024-1048576.9125` of F. Y. Kuo, constructed
/// as in Cools, Kuo and Nuyens, "Constructing embedded lattice rules for multivariate integration" (2006).
#[rustfmt::skip]
pub static KUO_VECTOR: [u32; 128] = [
    1, 182667, 213731, 255351, 96013, 116671, 479315, 424089, 271103, 464421, 124483, 230887, 392877, 162965,
    109125, 168491, 216103, 5613, 207895, 506745, 189519, 114879, 133967, 374257, 254597, 502087, 298245, 191333,
    242099, 285991, 397887, 507051, 511437, 129779, 406987, 345291, 225123, 511175, 432153, 306191, 116577, 809,
    370175, 402615, 485791, 201053, 366959, 54087, 395609, 211615, 68543, 443345, 327293, 290819, 278623, 362043,
    236117, 11091, 216837, 31545, 325799, 503877, 410523, 88371, 240077, 423807, 479855, 330835, 134517, 329989,
    473381, 59205, 337775, 355995, 372243, 279827, 367217, 277741, 267077, 417971, 152599, 184949, 511773,
    397077, 520041, 98063, 52983, 91233, 363069, 23829, 424377, 225285, 171171, 496765, 352791, 223231, 253273,
    296195, 273379, 407265, 305849, 215121, 489851, 245893, 397947, 174723, 329797, 213325, 357759, 346031,
    131433, 110731, 487615, 371877, 330799, 124595, 48775, 273275, 405083, 436731, 465257, 158265, 82033, 67805,
    203565, 190785, 351165, 19555
];

/// A rank-1 lattice with a generating vector, extensible or of a fixed number of points.
///
/// Extensible: `x = {phi_2(i) z + shift}` with the radical inverse in base 2, so that the first 2^m points are a lattice for
/// every `m`. Fixed: `x = {i z / n + shift}`.
///
/// Errors fall about as `n^-1` on smooth integrands, and as `n^-2` or faster if these are periodic.
/// Source: Sloan and Joe, "Lattice methods for multiple integration" (1994); Cranley and Patterson (1976) for the shift.
///
/// ```
/// use qmc_sampling::{Sequence, sequences::Lattice};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let fibonacci = Lattice::with_points(&[1, 5], 8)?;
/// assert_eq!(fibonacci.sample_2d(3), [0.375, 0.875]);
/// assert!(Lattice::default().shifted(7).sample(1 << 20, 127) < 1.0);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice<'a> {
    vector: &'a [u32],
    /// Zero for an extensible lattice.
    points: u64,
    shift: Option<u64>,
}

impl Default for Lattice<'static> {
    fn default() -> Self {
        Self { vector: &KUO_VECTOR, points: 0, shift: None }
    }
}

impl<'a> Lattice<'a> {
    /// The extensible lattice of a generating vector, one number per dimension.
    ///
    /// # Errors
    /// If the vector is empty.
    pub fn new(vector: &'a [u32]) -> Result<Self, SequenceError> {
        if vector.is_empty() {
            return Err(SequenceError::Dimensions { asked: 0, limit: u32::MAX });
        }
        Ok(Self { vector, points: 0, shift: None })
    }

    /// The lattice of a fixed number of points. Indices beyond repeat it.
    ///
    /// # Errors
    /// If the vector is empty or there are no points.
    pub fn with_points(vector: &'a [u32], points: u64) -> Result<Self, SequenceError> {
        if points == 0 {
            return Err(SequenceError::NoPoints);
        }
        Ok(Self { points, ..Self::new(vector)? })
    }

    /// The same, shifted by a random vector (modulo one).
    #[must_use]
    pub fn shifted(self, seed: u64) -> Self {
        Self { shift: Some(seed), ..self }
    }
}

impl Sequence for Lattice<'_> {
    fn dimensions(&self) -> u32 {
        self.vector.len() as u32
    }

    /// # Panics
    /// If the vector has no such dimension.
    #[inline]
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        let z = u64::from(self.vector[dimension as usize]);
        // A binary fraction of 64 digits, so that wrapping is taking the fractional part.
        let bits = if self.points == 0 {
            index.reverse_bits().wrapping_mul(z)
        } else {
            let numerator = u128::from(index % self.points) * u128::from(z) % u128::from(self.points);
            ((numerator << 64) / u128::from(self.points)) as u64
        };
        f64_from_bits(self.shift.map_or(bits, |seed| bits.wrapping_add(combine(seed, u64::from(dimension)))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensible_and_fixed_lattices_are_the_same_set() {
        let fixed = Lattice::with_points(&KUO_VECTOR, 1024).unwrap();
        let sorted = |lattice: &Lattice| {
            let mut points: std::vec::Vec<_> = (0..1024).map(|i| [0, 1, 50].map(|d| lattice.sample(i, d))).collect();
            points.sort_by(|a, b| a.partial_cmp(b).unwrap());
            points
        };
        assert_eq!(sorted(&fixed), sorted(&Lattice::default()));
    }

    /// A shifted lattice integrates every exponential that is not in its dual lattice exactly, and projections are regular.
    #[test]
    fn one_dimensional_projections_are_regular() {
        let lattice = Lattice::default().shifted(3);
        for d in 0..128 {
            let mut x: std::vec::Vec<f64> = (0..1024).map(|i| lattice.sample(i, d)).collect();
            x.sort_by(f64::total_cmp);
            assert!(x.windows(2).all(|w| (w[1] - w[0] - 1.0 / 1024.0).abs() < 1e-12), "dimension {d}");
        }
    }

    #[test]
    fn refuses_nothing() {
        assert!(Lattice::new(&[]).is_err());
        assert_eq!(Lattice::with_points(&[1], 0), Err(SequenceError::NoPoints));
    }
}
