//! How far to look for photons.

use range_search::{Neighbour, RangeIndex};

use crate::Kernel;

/// The radius of the nearest photons is at least this share of the largest one.
const LEAST_RADIUS: f32 = 1.0 / 4096.0;

/// How far to look for photons: a fixed radius, or as far as the `k`-th nearest.
///
/// # Fixed radius
/// The estimate is linear in the photons: its bias is that of the kernel alone, zero where irradiance is uniform
/// within the radius.
///
/// # The nearest photons
/// ```text
/// r = clamp(distance of the k-th nearest photon, R / 4096, R),     photons with d < r count
/// ```
/// The disk is open: the `k`-th nearest photon gives the radius, and only the `k - 1` nearer ones are summed up. On a
/// uniform sheet of density `lambda` the expected number `pi lambda r^2` is Gamma(k) distributed, so with the
/// constant kernel
///
/// ```text
/// E[ (k-1) / (pi r^2) ] = lambda            this crate: unbiased
/// E[  k    / (pi r^2) ] = lambda k / (k-1)  counting the k-th as well (Jensen 2001): too bright by 1 / (k-1)
/// ```
/// It holds as well
/// - for every kernel: given `r`, the nearer photons are independent in the disk;
/// - for a fixed number of independent photons: `r^2` is Beta distributed;
/// - with the clamp: `E[N(R) / R^2; N(R) < k]` fills in exactly what `r_k > R` cuts off;
/// - where photons are *not* of equal density or flux, as after deposition, if only irradiance is uniform: `pi lambda
///   r^2` is then the expected number `Lambda(r)` of photons in the ball, and `E[(k-1) / Lambda(r_k)] = 1`;
/// - if photons of other surfaces are around, which the tests of [`GatherPoint`](crate::GatherPoint) then leave out,
///   for the same reason.
///
/// Where irradiance is not uniform, the estimate is biased like one with a fixed radius, and not only by the kernel's
/// second moment, since radius and photons depend on each other.
///
/// # Example
/// ```
/// use photon_map::Gather;
/// let gather = Gather::nearest(50, 0.1)?;
/// assert_eq!(gather.max_radius(), 0.1);
/// assert!(Gather::nearest(1, 0.1).is_err() && Gather::within(f32::NAN).is_err());
/// # Ok::<(), photon_map::GatherError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Named", into = "Named"))]
pub struct Gather {
    /// The number of photons, or none for a fixed radius.
    count: Option<usize>,
    max_radius: f32,
}

/// Why one cannot look so far.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GatherError {
    /// A radius that is not positive and finite, or whose square is not.
    #[error("a radius is positive and finite and so is its square: between 1e-15 and 1e18, not {0}")]
    Radius(f32),
    /// Too few photons to tell a density.
    #[error("a density from the nearest photons needs at least 2 of them, not {0}")]
    Count(usize),
}

/// As it is in a file: the name of the constructor, and what it takes.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Named {
    Within(f32),
    Nearest { count: usize, max_radius: f32 },
}

#[cfg(feature = "serde")]
impl TryFrom<Named> for Gather {
    type Error = GatherError;

    fn try_from(named: Named) -> Result<Self, GatherError> {
        match named {
            Named::Within(radius) => Self::within(radius),
            Named::Nearest { count, max_radius } => Self::nearest(count, max_radius),
        }
    }
}

#[cfg(feature = "serde")]
impl From<Gather> for Named {
    fn from(Gather { count, max_radius }: Gather) -> Self {
        count.map_or(Self::Within(max_radius), |count| Self::Nearest { count, max_radius })
    }
}

/// Checks a radius: its square and the inverse of that are ordinary numbers.
fn positive_radius(radius: f32) -> Result<f32, GatherError> {
    if (1e-15..=1e18).contains(&radius) { Ok(radius) } else { Err(GatherError::Radius(radius)) }
}

/// Memory that queries for the nearest photons use again and again: keep one per thread. Queries within a fixed
/// radius need none.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    pub(crate) found: Vec<Neighbour>,
}

impl Gather {
    /// All photons within a fixed radius.
    ///
    /// # Errors
    /// [`GatherError::Radius`] if it is not between 1e-15 and 1e18.
    pub fn within(radius: f32) -> Result<Self, GatherError> {
        Ok(Self { count: None, max_radius: positive_radius(radius)? })
    }

    /// As far as the `count`-th nearest photon, but not farther than `max_radius` (and not nearer than `max_radius /
    /// 4096`, so that photons that coincide give no infinite density).
    ///
    /// # Errors
    /// [`GatherError`] if there are less than two photons to count, or the radius is not between 1e-15 and 1e18.
    pub fn nearest(count: usize, max_radius: f32) -> Result<Self, GatherError> {
        if count < 2 {
            return Err(GatherError::Count(count));
        }
        Ok(Self { count: Some(count), max_radius: positive_radius(max_radius)? })
    }

    /// The fixed radius, or the largest one.
    #[must_use]
    pub const fn max_radius(&self) -> f32 {
        self.max_radius
    }

    /// How many of the nearest photons; `None` with a fixed radius.
    #[must_use]
    pub const fn count(&self) -> Option<usize> {
        self.count
    }

    /// Calls `f` with the disk, and with id and squared distance of all points at most as far as its rim; returns the disk.
    #[inline]
    pub(crate) fn for_each<I: RangeIndex>(
        &self,
        index: &I,
        centre: [f32; 3],
        scratch: &mut Scratch,
        mut f: impl FnMut(Disk, usize, f32),
    ) -> Disk {
        let mut within = |radius: f32| {
            let disk = Disk::new(radius * radius);
            index.for_each_within(centre, radius, |id, distance_squared| f(disk, id, distance_squared));
            disk
        };
        let Some(count) = self.count else { return within(self.max_radius) };
        index.k_nearest(centre, count, self.max_radius, &mut scratch.found);
        let farthest = match scratch.found.last() {
            Some(farthest) if scratch.found.len() == count => farthest.distance_squared(),
            _ => self.max_radius * self.max_radius,
        };
        let least = self.max_radius * LEAST_RADIUS;
        if farthest < least * least {
            // There may be more than `count` of them.
            return within(least);
        }
        let disk = Disk::new(farthest);
        scratch.found.iter().for_each(|neighbour| f(disk, neighbour.id(), neighbour.distance_squared()));
        disk
    }
}

/// A radius that was found.
///
/// Squared, because the root of the `k`-th photon's squared distance need not square to it, and that photon must not count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Disk {
    pub(crate) radius_squared: f32,
    inverse: f64,
}

impl Disk {
    fn new(radius_squared: f32) -> Self {
        Self { radius_squared, inverse: 1.0 / f64::from(radius_squared) }
    }

    /// A photon's weight per area, without the factor that all photons share: see [`per_area`](Self::per_area).
    #[inline]
    pub(crate) fn weight(&self, kernel: &Kernel, distance_squared: f32) -> f64 {
        // Compared before it is divided, since the product may round to one on either side of it.
        if distance_squared < self.radius_squared { kernel.at(f64::from(distance_squared) * self.inverse) } else { 0.0 }
    }

    /// One over the squared radius.
    pub(crate) fn per_area(&self) -> f64 {
        self.inverse
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use range_search::BruteForce;

    fn radius(gather: Gather, points: &[[f32; 3]]) -> (f32, usize) {
        let index = BruteForce::build(points, |p| *p).unwrap();
        let mut visited = 0;
        let disk = gather.for_each(&index, [0.0; 3], &mut Scratch::default(), |_, _, _| visited += 1);
        (disk.radius_squared.sqrt(), visited)
    }

    #[test]
    fn the_radius_is_that_of_the_kth_nearest_between_its_bounds() {
        let gather = Gather::nearest(2, 4.0).unwrap();
        assert_eq!(gather.count(), Some(2));
        assert_eq!(radius(gather, &[[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 3.0, 0.0]]), (2.0, 2));
        assert_eq!(radius(gather, &[[1.0, 0.0, 0.0], [0.0, 5.0, 0.0]]), (4.0, 1));
        assert_eq!(radius(gather, &[]), (4.0, 0));
        // Coincident photons: all of them count, within the least radius.
        assert_eq!(radius(gather, &[[0.0; 3]; 7]), (4.0 / 4096.0, 7));
        assert_eq!(radius(Gather::within(1.5).unwrap(), &[[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]), (1.5, 1));
    }

    #[test]
    fn impossible_radii_and_counts_are_refused() {
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-20, 1e19] {
            assert!(matches!(Gather::within(bad), Err(GatherError::Radius(_))));
            assert!(matches!(Gather::nearest(9, bad), Err(GatherError::Radius(_))));
        }
        assert_eq!(Gather::nearest(1, 1.0), Err(GatherError::Count(1)));
    }
}
