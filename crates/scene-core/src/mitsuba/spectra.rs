//! From wavelengths to linear RGB.

/// First wavelength of [`OBSERVER`], in nanometres.
const FIRST: f64 = 380.0;
/// Distance between its wavelengths.
const STEP: f64 = 10.0;

/// The colour matching functions of the CIE 1931 standard observer, and the relative power of the CIE standard
/// illuminant D65 (ISO/CIE 11664-1 and -2), every 10 nm from 380 to 780 nm.
#[rustfmt::skip]
const OBSERVER: [[f64; 4]; 41] = [
    [0.001368, 0.000039, 0.006450, 49.9755],
    [0.004243, 0.000120, 0.020050, 54.6482],
    [0.014310, 0.000396, 0.067850, 82.7549],
    [0.043510, 0.001210, 0.207400, 91.486],
    [0.134380, 0.004000, 0.645600, 93.4318],
    [0.283900, 0.011600, 1.385600, 86.6823],
    [0.348280, 0.023000, 1.747060, 104.865],
    [0.336200, 0.038000, 1.772110, 117.008],
    [0.290800, 0.060000, 1.669200, 117.812],
    [0.195360, 0.090980, 1.287640, 114.861],
    [0.095640, 0.139020, 0.812950, 115.923],
    [0.032010, 0.208020, 0.465180, 108.811],
    [0.004900, 0.323000, 0.272000, 109.354],
    [0.009300, 0.503000, 0.158200, 107.802],
    [0.063270, 0.710000, 0.078250, 104.79],
    [0.165500, 0.862000, 0.042160, 107.689],
    [0.290400, 0.954000, 0.020300, 104.405],
    [0.433450, 0.994950, 0.008750, 104.046],
    [0.594500, 0.995000, 0.003900, 100.0],
    [0.762100, 0.952000, 0.002100, 96.3342],
    [0.916300, 0.870000, 0.001650, 95.788],
    [1.026300, 0.757000, 0.001100, 88.6856],
    [1.062200, 0.631000, 0.000800, 90.0062],
    [1.002600, 0.503000, 0.000340, 89.5991],
    [0.854450, 0.381000, 0.000190, 87.6987],
    [0.642400, 0.265000, 0.000050, 83.2886],
    [0.447900, 0.175000, 0.000020, 83.6992],
    [0.283500, 0.107000, 0.000000, 80.0268],
    [0.164900, 0.061000, 0.000000, 80.2146],
    [0.087400, 0.032000, 0.000000, 82.2778],
    [0.046770, 0.017000, 0.000000, 78.2842],
    [0.022700, 0.008210, 0.000000, 69.7213],
    [0.011359, 0.004102, 0.000000, 71.6091],
    [0.005790, 0.002091, 0.000000, 74.349],
    [0.002899, 0.001047, 0.000000, 61.604],
    [0.001440, 0.000520, 0.000000, 69.8856],
    [0.000690, 0.000249, 0.000000, 75.087],
    [0.000332, 0.000120, 0.000000, 63.5927],
    [0.000166, 0.000060, 0.000000, 46.4182],
    [0.000083, 0.000030, 0.000000, 66.8054],
    [0.000042, 0.000015, 0.000000, 63.3828],
];

/// XYZ to linear RGB with the primaries of BT.709 and the white D65.
const XYZ_TO_RGB: [[f64; 3]; 3] =
    [[3.240_479, -1.537_150, -0.498_535], [-0.969_256, 1.875_991, 0.041_556], [0.055_648, -0.204_043, 1.057_311]];

/// The linear RGB value of a reflectance (or of anything that multiplies light): its colour under D65, so that the
/// constant one is white.
pub(super) fn reflectance_to_rgb(pairs: &[(f64, f64)]) -> [f32; 3] {
    to_rgb(pairs, |row| row[3])
}

/// The linear RGB value of emitted light: its colour, so that the constant one is the (reddish) equal energy white,
/// with luminance one.
pub(super) fn emission_to_rgb(pairs: &[(f64, f64)]) -> [f32; 3] {
    to_rgb(pairs, |_| 1.0)
}

/// `XYZ = sum s(w) I(w) (x, y, z)(w) / sum I(w) y(w)`, out-of-gamut components clamped to zero.
fn to_rgb(pairs: &[(f64, f64)], illuminant: impl Fn(&[f64; 4]) -> f64) -> [f32; 3] {
    let (mut xyz, mut norm) = ([0.0; 3], 0.0);
    for (i, row) in OBSERVER.iter().enumerate() {
        let light = illuminant(row);
        let value = interpolate(pairs, FIRST + STEP * i as f64) * light;
        norm += row[1] * light;
        for (sum, response) in xyz.iter_mut().zip(row) {
            *sum += value * response;
        }
    }
    XYZ_TO_RGB.map(|row| ((row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]) / norm).max(0.0) as f32)
}

/// Linear between the given wavelengths, zero outside.
fn interpolate(pairs: &[(f64, f64)], wavelength: f64) -> f64 {
    let after = pairs.partition_point(|&(w, _)| w < wavelength);
    match (after.checked_sub(1).map(|before| pairs[before]), pairs.get(after)) {
        (_, Some(&(w, value))) if w == wavelength => value,
        (Some((w0, v0)), Some(&(w1, v1))) => v0 + (v1 - v0) * (wavelength - w0) / (w1 - w0),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values that Mitsuba 3.9.1 (`scalar_rgb`) derives from the same spectra.
    #[test]
    fn agrees_with_mitsuba_within_two_percent() {
        let close = |a: [f32; 3], b: [f32; 3]| {
            let scale = b[0].max(b[1]).max(b[2]);
            assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 0.02 * scale), "{a:?} against {b:?}");
        };
        let flat = [(400.0, 0.5), (700.0, 0.5)];
        let rising = [(400.0, 0.1), (500.0, 0.2), (600.0, 0.8), (700.0, 0.9)];
        close(reflectance_to_rgb(&flat), [0.497_671, 0.499_878, 0.497_455]);
        close(reflectance_to_rgb(&rising), [0.958_689, 0.446_356, 0.105_71]);
        close(emission_to_rgb(&flat), [0.599_847, 0.474_76, 0.451_722]);
        close(emission_to_rgb(&[(400.0, 0.0), (500.0, 1.0), (600.0, 0.0)]), [0.0, 0.593_79, 0.486_677]);
        close(emission_to_rgb(&[(300.0, 1.0), (900.0, 1.0)]), [1.204_88, 0.948_228, 0.909_267]);
    }

    #[test]
    fn wavelengths_outside_are_dark() {
        assert_eq!(interpolate(&[(400.0, 1.0), (500.0, 3.0)], 450.0), 2.0);
        assert_eq!(interpolate(&[(400.0, 1.0), (500.0, 3.0)], 500.0), 3.0);
        assert_eq!(interpolate(&[(400.0, 1.0), (500.0, 3.0)], 501.0), 0.0);
        assert_eq!(interpolate(&[(400.0, 1.0), (500.0, 3.0)], 399.0), 0.0);
    }
}
