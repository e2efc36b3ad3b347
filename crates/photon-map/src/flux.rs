//! What photons carry.

/// What a photon carries: flux per component, in whatever components the renderer has.
///
/// Implemented for `f32`, `f64` and `[f32; 3]`; importance is a flux, too (`f32`).
///
/// **Laws**, up to round-off: `add` is commutative and associative with [`ZERO`](Self::ZERO) as its neutral element,
/// `scale` distributes over `add` and multiplies every component, `scale(1.0)` changes no bit, and
/// [`is_finite`](Self::is_finite) looks at all components. [`check_flux`](crate::check::check_flux) tests them on anybody's
/// implementation.
///
/// # Example
/// A renderer with its own spectrum:
/// ```
/// use photon_map::Flux;
/// #[derive(Clone, Copy)]
/// struct Spectrum([f32; 8]);
/// impl Flux for Spectrum {
///     const ZERO: Self = Self([0.0; 8]);
///     fn add(self, other: Self) -> Self { Self(std::array::from_fn(|i| self.0[i] + other.0[i])) }
///     fn scale(self, factor: f64) -> Self { Self(self.0.map(|c| c * factor as f32)) }
///     fn is_finite(self) -> bool { self.0.iter().all(|c| c.is_finite()) }
/// }
/// assert_eq!(Spectrum([1.0; 8]).add(Spectrum::ZERO).scale(2.0).0, [2.0; 8]);
/// let samples = [Spectrum([1.0; 8]), Spectrum(std::array::from_fn(|i| i as f32))];
/// photon_map::check::check_flux(&samples, |flux| flux.0.map(f64::from), 1e-6)?;
/// # Ok::<(), photon_map::check::Violation>(())
/// ```
///
/// Not dyn compatible: it is a number.
pub trait Flux: Copy {
    /// Nothing.
    const ZERO: Self;
    /// The sum.
    #[must_use]
    fn add(self, other: Self) -> Self;
    /// Every component times a factor.
    #[must_use]
    fn scale(self, factor: f64) -> Self;
    /// Whether no component is NaN or infinite.
    fn is_finite(self) -> bool;
}

impl Flux for f32 {
    const ZERO: Self = 0.0;
    #[inline]
    fn add(self, other: Self) -> Self {
        self + other
    }
    #[inline]
    fn scale(self, factor: f64) -> Self {
        self * factor as Self
    }
    #[inline]
    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

impl Flux for f64 {
    const ZERO: Self = 0.0;
    #[inline]
    fn add(self, other: Self) -> Self {
        self + other
    }
    #[inline]
    fn scale(self, factor: f64) -> Self {
        self * factor
    }
    #[inline]
    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

impl Flux for [f32; 3] {
    const ZERO: Self = [0.0; 3];
    #[inline]
    fn add(self, other: Self) -> Self {
        [self[0] + other[0], self[1] + other[1], self[2] + other[2]]
    }
    #[inline]
    fn scale(self, factor: f64) -> Self {
        let factor = factor as f32;
        self.map(|component| component * factor)
    }
    #[inline]
    fn is_finite(self) -> bool {
        self.iter().all(|component| component.is_finite())
    }
}
