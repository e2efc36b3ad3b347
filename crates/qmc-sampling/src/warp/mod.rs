//! Maps from the unit square to where samples are wanted, as triads `sample`, `pdf`, `invert`.
//!
//! Plain functions on arrays, generic over `f32` and `f64` ([`Real`]). All of them are area-preserving up to
//! the density, so stratification survives. Laws of every triad:
//!
//! - `sample_x(u)` is defined for every `u` in `[0, 1)`, ends included, and `pdf_x` of the result is positive;
//! - `invert_x(sample_x(u))` is `u` up to rounding, and in `[0, 1)`;
//! - `pdf_x` integrates to one in the measure its docs name; it is zero where nothing is sampled.
//!
//! Directions are in a frame with the pole at `(0, 0, 1)`.
mod cone;
mod disk;
mod gaussian;
mod hemisphere;
mod sphere;
mod tent;
mod triangle;

#[cfg(feature = "alloc")]
mod alias;
#[cfg(feature = "alloc")]
mod error;
#[cfg(feature = "alloc")]
mod piecewise_1d;
#[cfg(feature = "alloc")]
mod piecewise_2d;

#[cfg(feature = "alloc")]
pub use alias::AliasTable;
pub use cone::{invert_uniform_cone, pdf_uniform_cone, sample_uniform_cone};
pub use disk::{invert_concentric_disk, pdf_concentric_disk, sample_concentric_disk};
#[cfg(feature = "alloc")]
pub use error::TableError;
pub use gaussian::{invert_gaussian, pdf_gaussian, sample_gaussian};
pub use hemisphere::{
    invert_cosine_hemisphere, invert_uniform_hemisphere, pdf_cosine_hemisphere, pdf_uniform_hemisphere,
    sample_cosine_hemisphere, sample_uniform_hemisphere,
};
#[cfg(feature = "alloc")]
pub use piecewise_1d::PiecewiseConstant1d;
#[cfg(feature = "alloc")]
pub use piecewise_2d::PiecewiseConstant2d;
pub use sphere::{invert_uniform_sphere, pdf_uniform_sphere, sample_uniform_sphere};
pub use tent::{invert_tent, pdf_tent, sample_tent};
pub use triangle::{invert_triangle, pdf_triangle, sample_triangle};

use crate::Real;
use core::f64::consts::PI;

/// The azimuth of `(x, y)` as a fraction of the circle, in `[0, 1)`.
#[inline]
fn turn<F: Real>(x: F, y: F) -> F {
    let fraction = y.atan2(x) * F::of(0.5 / PI);
    if fraction < F::ZERO { (fraction + F::ONE).clamp_unit() } else { fraction.clamp_unit() }
}

/// The unit vector whose azimuth is the fraction `u` of the circle.
#[inline]
fn circle<F: Real>(u: F) -> [F; 2] {
    let (sin, cos) = (F::of(2.0 * PI) * u).sin_cos();
    [cos, sin]
}

#[cfg(test)]
mod testing {
    use crate::Real;
    use std::vec::Vec;

    /// A grid of the unit square with the ends, and numbers next to them.
    pub(crate) fn square<F: Real>() -> Vec<[F; 2]> {
        let mut axis: Vec<F> = (0..16).map(|i| F::of((f64::from(i) + 0.37) / 16.0)).collect();
        axis.extend([F::ZERO, F::EPSILON, F::of(0.25), F::of(0.5), F::of(0.75), F::ONE_MINUS_EPSILON]);
        axis.iter().flat_map(|&x| axis.iter().map(move |&y| [x, y])).collect()
    }

    /// The mean of `f` over a midpoint grid of the unit square.
    pub(crate) fn mean(n: u32, f: impl Fn([f64; 2]) -> f64) -> f64 {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n * n).map(|i| f([at(i % n), at(i / n)])).sum::<f64>() / f64::from(n * n)
    }

    #[track_caller]
    pub(crate) fn assert_close<F: Real>(a: &[F], b: &[F], tolerance: f64) {
        for (x, y) in a.iter().zip(b) {
            assert!((x.to_f64() - y.to_f64()).abs() <= tolerance, "{a:?} is not {b:?}");
        }
    }
}
