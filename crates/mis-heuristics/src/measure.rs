//! Densities whose measure is a type.

use core::fmt;
use core::marker::PhantomData;
use core::ops::Mul;

use crate::{Densities, Float};

/// The measure of directions: densities in 1/sr.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolidAngle {}

/// The measure of points on surfaces: densities in 1/length^2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {}

/// A density that knows its measure `M`: a marker of this module, or any type of yours.
///
/// ```text
/// p_solid_angle = p_area d^2 / |cos|          p_area = p_solid_angle |cos| / d^2
/// ```
///
/// **Symbols.** `d`: distance between the point that looks and the point on the surface; `cos`: cosine between the surface's
/// geometric normal and the line between the two.
///
/// **Assumptions.** None on the values; weights read them as [`Densities`] says. Where `cos` is zero, or a result would be
/// NaN, the density is zero: no technique finds a surface from its edge.
///
/// It is a plain number to the compiler; what it costs is the writing. Arrays and slices of one measure are
/// [`Densities`], and an array has one:
///
/// ```
/// use mis_heuristics::measure::{Area, Density, SolidAngle};
/// use mis_heuristics::{Balance, Heuristic};
///
/// let light = Density::<f32, Area>::new(0.5); // 1 / (2 m^2)
/// let bsdf = Density::<f32, SolidAngle>::new(1.0);
/// let weight: f32 = Balance.weight(0, &[light.per_solid_angle(4.0, 0.5), bsdf]);
/// assert_eq!(weight, 0.8);
/// ```
///
/// The same without the conversion does not compile; as plain numbers it would have, and be wrong by `d^2 / |cos|`:
///
/// ```compile_fail,E0308
/// use mis_heuristics::measure::{Area, Density, SolidAngle};
/// use mis_heuristics::{Balance, Heuristic};
///
/// let light = Density::<f32, Area>::new(0.5);
/// let bsdf = Density::<f32, SolidAngle>::new(1.0);
/// let weight: f32 = Balance.weight(0, &[light, bsdf]);
/// ```
///
/// **Source.** Veach 1997, sections 8.2.2.2 and 9.2.
pub struct Density<F, M> {
    value: F,
    // Not `PhantomData<M>`: a density is `Send` whatever its marker is.
    measure: PhantomData<fn() -> M>,
}

impl<F: Float, M> Density<F, M> {
    /// A density in the measure `M`.
    #[inline]
    pub const fn new(value: F) -> Self {
        Self { value, measure: PhantomData }
    }

    /// The number, whose measure is then up to the reader.
    #[inline]
    pub const fn value(self) -> F {
        self.value
    }
}

impl<F: Float> Density<F, Area> {
    /// The density of the direction to the point, seen from `distance_squared` away under this cosine at the surface.
    #[inline]
    #[must_use]
    pub fn per_solid_angle(self, distance_squared: F, cos: F) -> Density<F, SolidAngle> {
        Density::new(converted(self.value, cos, |cos| distance_squared / cos))
    }
}

impl<F: Float> Density<F, SolidAngle> {
    /// The density of the point that the direction finds, `distance_squared` away under this cosine at the surface.
    #[inline]
    #[must_use]
    pub fn per_area(self, distance_squared: F, cos: F) -> Density<F, Area> {
        Density::new(converted(self.value, cos, |cos| cos / distance_squared))
    }
}

/// The density times the change of measure, zero where that has no limit.
#[inline]
fn converted<F: Float>(density: F, cos: F, change: impl Fn(F) -> F) -> F {
    let cos = if cos < F::ZERO { F::ZERO - cos } else { cos };
    if cos > F::ZERO { (density * change(cos)).positive_part() } else { F::ZERO }
}

/// Times the number of samples of the technique, or the probability to choose it.
impl<F: Float, M> Mul<F> for Density<F, M> {
    type Output = Self;

    #[inline]
    fn mul(self, count: F) -> Self {
        Self::new(self.value * count)
    }
}

impl<F: Float, M> Densities<F> for [Density<F, M>] {
    #[inline]
    fn len(&self) -> usize {
        <[Density<F, M>]>::len(self)
    }
    #[inline]
    fn density(&self, technique: usize) -> F {
        self[technique].value
    }
}

impl<F: Float, M, const N: usize> Densities<F> for [Density<F, M>; N] {
    #[inline]
    fn len(&self) -> usize {
        N
    }
    #[inline]
    fn density(&self, technique: usize) -> F {
        self[technique].value
    }
}

// By hand: derived ones would ask the same of the marker.
impl<F: Copy, M> Clone for Density<F, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: Copy, M> Copy for Density<F, M> {}

impl<F: PartialEq, M> PartialEq for Density<F, M> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<F: PartialOrd, M> PartialOrd for Density<F, M> {
    fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<F: fmt::Debug, M> fmt::Debug for Density<F, M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Density").field(&self.value).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Heuristic, Power};

    #[test]
    fn there_and_back_is_the_same_density() {
        let area = Density::<f64, Area>::new(0.25);
        for (d2, cos) in [(1.0, 1.0), (4.0, -0.5), (1e-6, 0.125), (1e12, 1e-3)] {
            let back = area.per_solid_angle(d2, cos).per_area(d2, cos);
            assert!((back.value() - 0.25).abs() < 1e-15, "{back:?} at {d2}, {cos}");
        }
    }

    #[test]
    fn what_has_no_limit_is_zero() {
        let area = Density::<f32, Area>::new(2.0);
        assert_eq!(area.per_solid_angle(1.0, 0.0).value(), 0.0);
        assert_eq!(area.per_solid_angle(1.0, f32::NAN).value(), 0.0);
        assert_eq!(area.per_solid_angle(f32::NAN, 1.0).value(), 0.0);
        let angle = Density::<f32, SolidAngle>::new(2.0);
        assert_eq!(angle.per_area(f32::NAN, 1.0).value(), 0.0);
        assert_eq!(angle.per_area(1.0, 0.0).value(), 0.0);
        // A Dirac delta stays one.
        assert_eq!(Density::<f32, Area>::new(f32::INFINITY).per_solid_angle(1.0, 0.5).value(), f32::INFINITY);
    }

    #[test]
    fn weights_are_those_of_the_plain_numbers() {
        let plain = [6.0_f32, 2.0];
        let typed = plain.map(Density::<f32, SolidAngle>::new);
        for i in 0..2 {
            let weight: f32 = Power::TWO.weight(i, &typed);
            assert_eq!(weight, Power::TWO.weight(i, &plain));
            assert_eq!(weight, Power::TWO.weight(i, &&typed[..]));
        }
    }

    #[test]
    fn counts_multiply() {
        let weight: f32 = Power::ONE.weight(0, &[Density::<f32, Area>::new(1.0) * 3.0, Density::new(1.0)]);
        assert_eq!(weight, 0.75);
    }
}
