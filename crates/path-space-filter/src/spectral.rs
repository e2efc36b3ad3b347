//! Monochromatic contributions in an average of colours.

/// Functions of the wavelength onto which contributions are projected.
///
/// A path with one wavelength `l`, drawn with density `p(l)`, contributes `c b_k(l) / p(l)` to component `k`. The filter sums these:
///
/// ```text
/// mean_ik = sum_j X w_ij b_k(l_j) c_j / p(l_j)  /  sum_j X w_ij
/// ```
/// so neighbours with all wavelengths mix, and the colour noise of single wavelengths is averaged away.
///
/// **On the print.** The paper multiplies the basis functions "as factors to the weights". Read literally that puts them into the denominator of equation 1 as well; then the
/// average of a vertex that is alone is `c_i` in every component, whatever its wavelength, and the limit is not the image. They belong into the numerator
/// alone, where they make the weighted sum a projection: [`project`](Self::project) does that when a contribution is read, so that a vertex stores two numbers,
/// its value and its wavelength.
///
/// ```
/// use path_space_filter::{Basis, CieXyz, PathVertex};
/// struct Monochromatic { position: [f32; 3], wavelength: f32, radiance: f32 }
/// impl PathVertex for Monochromatic {
///     type Contribution = [f32; 3];
///     fn position(&self) -> [f32; 3] { self.position }
///     fn contribution(&self) -> [f32; 3] { CieXyz.project(self.wavelength, self.radiance, 1.0 / 400.0) } // drawn from 380 to 780 nm
/// }
/// ```
///
/// Dyn compatible: `&dyn Basis<N>`.
pub trait Basis<const N: usize> {
    /// The functions at a wavelength, in nanometres. Finite.
    fn at(&self, wavelength: f32) -> [f32; N];

    /// The contribution of a path that carries `value` at a wavelength of density `pdf`, in 1/nm. Nothing if the density is not positive.
    #[inline]
    fn project(&self, wavelength: f32, value: f32, pdf: f32) -> [f32; N] {
        let factor = if pdf > 0.0 { value / pdf } else { 0.0 };
        self.at(wavelength).map(|b| b * factor)
    }
}

// Its docs say so.
const _: Option<&dyn Basis<3>> = None;

impl<const N: usize, F: Fn(f32) -> [f32; N]> Basis<N> for F {
    #[inline]
    fn at(&self, wavelength: f32) -> [f32; N] {
        self(wavelength)
    }
}

/// The CIE 1931 colour matching functions, as sums of Gaussians whose two halves differ in width.
///
/// Their integrals over the visible wavelengths are 106.8 to 106.9. Without unit.
///
/// **Source.** C. Wyman, P.-P. Sloan, P. Shirley, *Simple Analytic Approximations to the CIE XYZ Color Matching Functions*, JCGT 2(2), 2013, the multi-lobe fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "CieXyzName", into = "CieXyzName"))]
pub struct CieXyz;

#[cfg(feature = "serde")]
by_name!(CieXyzName: CieXyz);

impl CieXyz {
    /// Integral of the second function over the visible wavelengths, in nm: what divides `Y` if radiance of value 1 is to have `Y = 1`.
    pub const Y_INTEGRAL: f32 = 106.92;
}

impl Basis<3> for CieXyz {
    fn at(&self, wavelength: f32) -> [f32; 3] {
        let lobe = |height: f32, mean: f32, below: f32, above: f32| {
            let t = (wavelength - mean) / if wavelength < mean { below } else { above };
            height * (-0.5 * t * t).exp()
        };
        if !wavelength.is_finite() {
            return [0.0; 3];
        }
        [
            lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
            lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
            lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_functions_have_equal_integrals_and_peak_where_they_should() {
        let mut sums = [0.0_f64; 3];
        for i in 0..4000 {
            let b = CieXyz.at(380.0 + 0.1 * i as f32);
            (0..3).for_each(|k| sums[k] += 0.1 * f64::from(b[k]));
        }
        for sum in sums {
            assert!((sum - 106.9).abs() < 0.6, "{sums:?}");
        }
        assert!((sums[1] - f64::from(CieXyz::Y_INTEGRAL)).abs() < 0.05, "{sums:?}");
        // CIE 1931: y(555 nm) = 1, x(600 nm) = 1.0622, z(445 nm) = 1.7826.
        assert!((CieXyz.at(555.0)[1] - 1.0).abs() < 0.01);
        assert!((CieXyz.at(600.0)[0] - 1.0622).abs() < 0.02);
        assert!((CieXyz.at(445.0)[2] - 1.7826).abs() < 0.05);
        assert_eq!(CieXyz.at(f32::NAN), [0.0; 3]);
        assert_eq!(CieXyz.project(550.0, 1.0, 0.0), [0.0; 3]);
    }
}
