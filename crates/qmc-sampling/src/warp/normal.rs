//! The normal distribution in one dimension, by inversion.
use crate::Real;
use core::f64::consts::{FRAC_1_SQRT_2, PI};

/// A normal number of mean zero and standard deviation `sigma`: the inverse of the distribution function, so monotonic in
/// `u`. At `u = 0` it is a large negative number, not infinite.
///
/// Source: Wichura, "Algorithm AS 241: the percentage points of the normal distribution" (1988), PPND16, computed in double
/// precision: relative error about 1e-16.
///
/// ```
/// use qmc_sampling::warp::sample_normal;
/// assert_eq!(sample_normal(0.5_f64, 1.0), 0.0);
/// assert!((sample_normal(0.975_f64, 1.0) - 1.959_963_984_540_054).abs() < 1e-12);
/// ```
#[must_use]
pub fn sample_normal<F: Real>(u: F, sigma: F) -> F {
    // half of the first step above zero stands for all below
    let u = u.clamp_unit().max(F::EPSILON * F::of(0.25)).to_f64();
    sigma * F::of(quantile(u))
}

/// The density of [`sample_normal`] with respect to length.
#[inline]
#[must_use]
pub fn pdf_normal<F: Real>(x: F, sigma: F) -> F {
    let z = x / sigma;
    (F::of(-0.5) * z * z).exp() / (sigma * F::of(2.0 * PI).sqrt())
}

/// The number that [`sample_normal`] maps to `x`: the distribution function.
#[inline]
#[must_use]
pub fn invert_normal<F: Real>(x: F, sigma: F) -> F {
    F::of(0.5 * libm::erfc(-(x / sigma).to_f64() * FRAC_1_SQRT_2)).clamp_unit()
}

/// The quantile of the standard normal distribution.
pub(crate) fn quantile(p: f64) -> f64 {
    let polynomial = |coefficients: &[f64; 8], x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180625 - q * q;
        return q * polynomial(&A, r) / polynomial(&B, r);
    }
    let r = Real::sqrt(-Real::ln(if q < 0.0 { p } else { 1.0 - p }));
    let x = if r <= 5.0 {
        polynomial(&C, r - 1.6) / polynomial(&D, r - 1.6)
    } else {
        polynomial(&E, r - 5.0) / polynomial(&F, r - 5.0)
    };
    if q < 0.0 { -x } else { x }
}

const A: [f64; 8] = [
    3.387_132_872_796_366_608,
    1.331_416_678_917_843_774_5e2,
    1.971_590_950_306_551_442_7e3,
    1.373_169_376_550_946_112_5e4,
    4.592_195_393_154_987_145_7e4,
    6.726_577_092_700_870_085_3e4,
    3.343_057_558_358_812_810_5e4,
    2.509_080_928_730_122_672_7e3,
];
const B: [f64; 8] = [
    1.0,
    4.231_333_070_160_091_125_2e1,
    6.871_870_074_920_579_083e2,
    5.394_196_021_424_751_107_7e3,
    2.121_379_430_158_659_586_7e4,
    3.930_789_580_009_271_061e4,
    2.872_908_573_572_194_267_4e4,
    5.226_495_278_852_854_561e3,
];
const C: [f64; 8] = [
    1.423_437_110_749_683_577_34,
    4.630_337_846_156_545_295_9,
    5.769_497_221_460_691_405_5,
    3.647_848_324_763_204_605_04,
    1.270_458_252_452_368_382_58,
    2.417_807_251_774_506_117_7e-1,
    2.272_384_498_926_918_458_33e-2,
    7.745_450_142_783_414_076_4e-4,
];
const D: [f64; 8] = [
    1.0,
    2.053_191_626_637_758_821_87,
    1.676_384_830_183_803_849_4,
    6.897_673_349_851_000_045_5e-1,
    1.481_039_764_274_800_745_9e-1,
    1.519_866_656_361_645_719_66e-2,
    5.475_938_084_995_344_946e-4,
    1.050_750_071_644_416_843_24e-9,
];
const E: [f64; 8] = [
    6.657_904_643_501_103_777_2,
    5.463_784_911_164_114_369_9,
    1.784_826_539_917_291_335_8,
    2.965_605_718_285_048_912_3e-1,
    2.653_218_952_657_612_309_3e-2,
    1.242_660_947_388_078_438_6e-3,
    2.711_555_568_743_487_578_15e-5,
    2.010_334_399_292_288_132_65e-7,
];
const F: [f64; 8] = [
    1.0,
    5.998_322_065_558_879_376_9e-1,
    1.369_298_809_227_358_053_1e-1,
    1.487_536_129_085_061_485_25e-2,
    7.868_691_311_456_132_591e-4,
    1.846_318_317_510_054_681_8e-5,
    1.421_511_758_316_445_888_7e-7,
    2.044_263_103_389_939_785_64e-15,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, square};

    #[test]
    fn inverts() {
        for [u, _] in square::<f64>() {
            assert_close(&[invert_normal(sample_normal(u, 2.5), 2.5)], &[u], 1e-15);
        }
        for [u, _] in square::<f32>() {
            let x = sample_normal(u, 0.3);
            assert!(x.is_finite() && pdf_normal(x, 0.3) > 0.0);
            assert_close(&[invert_normal(x, 0.3)], &[u], 2e-7);
        }
    }

    #[test]
    fn known_percentage_points() {
        for (p, x) in
            [(0.25, -0.674_489_750_196_081_7), (0.001, -3.090_232_306_167_813_5), (1e-20, -9.262_340_089_798_408)]
        {
            assert!((quantile(p) - x).abs() < 1e-12, "{p} {}", quantile(p));
        }
    }
}
