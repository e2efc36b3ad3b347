//! The few operations on vectors that this crate needs.

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
