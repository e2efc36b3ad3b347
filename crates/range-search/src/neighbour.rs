//! What a query finds.

use core::fmt;

/// A point that a query found: its position in the input slice, and its squared distance from the query's centre.
///
/// Neighbours are ordered by distance, and by id where distances are equal. Both are packed into one integer, whose
/// order that is: squared distances are not negative, and the bits of such numbers are ordered like the numbers.
///
/// ```
/// use range_search::Neighbour;
/// let (near, far) = (Neighbour::new(7, 0.25), Neighbour::new(3, 4.0));
/// assert!(near < far && Neighbour::new(3, 0.25) < near);
/// assert_eq!((far.id(), far.distance_squared(), far.distance()), (3, 4.0, 2.0));
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Neighbour(u64);

impl Neighbour {
    /// A point by its position in the input slice, and its squared distance. The order is meant for distances that are
    /// neither negative nor NaN.
    #[inline(always)]
    pub fn new(id: u32, distance_squared: f32) -> Self {
        Self((u64::from(distance_squared.to_bits()) << 32) | u64::from(id))
    }

    /// The point's position in the input slice.
    #[inline(always)]
    pub fn id(self) -> usize {
        self.0 as u32 as usize
    }

    /// Squared distance from the query's centre, rounded as [`distance_squared`](crate::distance_squared) rounds.
    #[inline(always)]
    pub fn distance_squared(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    /// Distance from the query's centre.
    #[inline]
    pub fn distance(self) -> f32 {
        self.distance_squared().sqrt()
    }
}

impl fmt::Debug for Neighbour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Neighbour").field("id", &self.id()).field("distance_squared", &self.distance_squared()).finish()
    }
}
