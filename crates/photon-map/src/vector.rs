//! The few operations on vectors that this crate needs.

#[inline]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn subtract(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The unit vector; `None` for zero, infinite and NaN vectors. In `f64`, so that no length overflows or vanishes.
#[inline]
pub(crate) fn normalise(v: [f32; 3]) -> Option<[f32; 3]> {
    let [x, y, z] = v.map(f64::from);
    let length = (x * x + y * y + z * z).sqrt();
    (length > 0.0 && length.is_finite()).then(|| [(x / length) as f32, (y / length) as f32, (z / length) as f32])
}

pub(crate) fn is_finite(v: [f32; 3]) -> bool {
    v.iter().all(|component| component.is_finite())
}
