//! The rule that all indices share: what is within a radius.

/// `((px - cx)^2 + (py - cy)^2) + (pz - cz)^2` in `f32`, rounded after each operation, in this order.
///
/// Every index computes distances like this, and so they agree bit for bit. The result may overflow to infinity and
/// underflow to zero.
#[inline(always)]
pub fn distance_squared(point: [f32; 3], center: [f32; 3]) -> f32 {
    let [x, y, z] = [point[0] - center[0], point[1] - center[1], point[2] - center[2]];
    x * x + y * y + z * z
}

/// Whether all three coordinates are finite. Only such points are found, and only around such centres.
#[inline(always)]
pub(crate) fn is_finite(p: [f32; 3]) -> bool {
    p[0].is_finite() && p[1].is_finite() && p[2].is_finite()
}

/// A valid query: a finite centre and a radius that is not negative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) center: [f32; 3],
    pub(crate) radius_squared: f32,
    /// No coordinate of a point in the ball is further from the centre's than this.
    pub(crate) reach: f32,
}

impl Ball {
    /// Nothing, where nothing can be found: the centre is not finite, the radius negative or NaN.
    #[inline(always)]
    pub(crate) fn new(center: [f32; 3], radius: f32) -> Option<Self> {
        // A comparison with NaN is false.
        (is_finite(center) && radius >= 0.0).then(|| Self {
            center,
            radius_squared: radius * radius,
            reach: reach(radius),
        })
    }

    /// All points are in it: their squared distances cannot be larger than infinity.
    #[inline(always)]
    pub(crate) fn is_everything(&self) -> bool {
        self.radius_squared == f32::INFINITY
    }

    /// The ball's bounding box.
    #[inline(always)]
    pub(crate) fn bounds(&self) -> ([f32; 3], [f32; 3]) {
        (self.center.map(|x| x - self.reach), self.center.map(|x| x + self.reach))
    }
}

/// A bound of `|p - c|` along an axis for all points `p` within the radius of `c`, whatever the rounding.
///
/// With `u = 2^-24`: the rounded square of the rounded difference is at most the rounded sum, so
/// `(p - c)^2 (1 - u)^3 <= r^2 (1 + u)`, which is `|p - c| <= r (1 + 2.5 u)`, as long as squares are normal numbers. Squares that
/// are not may be off by `2^-150`, whose root is 2.7e-23. Since rounding is monotone and `p` is a number that `f32` has,
/// `c - reach` rounds to at most `p`, and `c + reach` to at least `p`.
#[inline(always)]
fn reach(radius: f32) -> f32 {
    radius * (1.0 + 4.0 * f32::EPSILON) + 1e-22
}
