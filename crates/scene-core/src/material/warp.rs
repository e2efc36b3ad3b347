//! Maps from the unit square to disks and hemispheres, without calls to trigonometric functions.

use core::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4};

use glam::Vec3A;

/// The largest number below one.
pub(super) const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;
/// Density of the uniform hemisphere.
pub(super) const UNIFORM_HEMISPHERE_PDF: f32 = 0.5 * FRAC_1_PI;

/// Sine and cosine for `|x| <= pi/4`, to about one unit in the last place.
///
/// Source: the minimax polynomials of the Cephes library's `sinf` and `cosf` (Moshier 1992).
#[inline]
fn sin_cos_octant(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = x + x * z * (-1.666_665_5e-1 + z * (8.332_161e-3 - z * 1.951_529_6e-4));
    let cos = 1.0 - 0.5 * z + z * z * (4.166_664_6e-2 + z * (-1.388_731_6e-3 + z * 2.443_315_7e-5));
    (sin, cos)
}

/// Sine and cosine of `2 pi turn`, for `turn` in `[0, 1]`.
#[inline]
pub(super) fn sin_cos_turn(turn: f32) -> (f32, f32) {
    // The cast truncates, which is the floor here.
    let quarters = (4.0 * turn + 0.5) as i32;
    let (sin, cos) = sin_cos_octant((4.0 * turn - quarters as f32) * FRAC_PI_2);
    let (sin, cos) = if quarters & 1 == 0 { (sin, cos) } else { (cos, sin) };
    // Signs by quadrant, without branches that would be mispredicted half the time.
    let negate = |x: f32, bit: i32| f32::from_bits(x.to_bits() ^ ((bit as u32 & 2) << 30));
    (negate(sin, quarters), negate(cos, quarters + 1))
}

/// The concentric map of the square to the unit disk (Shirley and Chiu 1997).
#[inline]
pub(super) fn concentric_disk(u: [f32; 2]) -> [f32; 2] {
    let [a, b] = u.map(|x| 2.0 * x - 1.0);
    // Which of the two is larger cannot be guessed: select by masks.
    let mask = u32::from(a.abs() > b.abs()).wrapping_neg();
    let (r, other) = (select(mask, a, b), select(mask, b, a));
    // Both are zero, or r is not.
    let (sin, cos) = sin_cos_octant(FRAC_PI_4 * (other / (r + f32::from_bits(u32::from(r == 0.0)))));
    let (long, short) = (r * cos, r * sin);
    [select(mask, long, short), select(mask, short, long)]
}

/// `a` if the mask is all ones, `b` if it is zero.
#[inline(always)]
fn select(mask: u32, a: f32, b: f32) -> f32 {
    f32::from_bits(a.to_bits() & mask | b.to_bits() & !mask)
}

/// A direction with density `cos / pi`. Its cosine is never zero.
#[inline]
pub(super) fn cosine_hemisphere(u: [f32; 2]) -> Vec3A {
    let [x, y] = concentric_disk(u);
    Vec3A::new(x, y, (1.0 - x * x - y * y).max(1e-12).sqrt())
}

/// A direction with density `1 / 2 pi`. Its cosine is never zero.
#[inline]
pub(super) fn uniform_hemisphere(u: [f32; 2]) -> Vec3A {
    let z = (1.0 - u[0]).max(1e-6);
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = sin_cos_turn(u[1]);
    Vec3A::new(r * cos, r * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_match_the_library() {
        for i in 0..=10_000 {
            let turn = i as f32 / 10_000.0;
            let (sin, cos) = sin_cos_turn(turn);
            let (s, c) = (f64::from(turn) * std::f64::consts::TAU).sin_cos();
            assert!((f64::from(sin) - s).abs() < 3e-7 && (f64::from(cos) - c).abs() < 3e-7, "{turn}");
        }
    }

    #[test]
    fn directions_are_unit_vectors_above_the_surface() {
        for i in 0..=40 {
            for j in 0..=40 {
                let u = [i as f32 / 40.0, j as f32 / 40.0].map(|x| x.min(ONE_MINUS_EPSILON));
                for direction in [cosine_hemisphere(u), uniform_hemisphere(u)] {
                    assert!((direction.length() - 1.0).abs() < 1e-5 && direction.z > 0.0, "{u:?} {direction}");
                }
            }
        }
    }
}
