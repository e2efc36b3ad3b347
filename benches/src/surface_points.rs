//! Points on surfaces, for range searches.

/// Points on a sphere of radius 1 and a square of the same area that touches it from below, uniformly distributed, in random order.
///
/// With the radius at which there are about 50 points in the neighbourhood of each. `peers/nanoflann` makes the same ones.
pub fn surface_points(count: usize) -> (Vec<[f32; 3]>, f32) {
    const AREA: f64 = 8.0 * std::f64::consts::PI;
    // Knuth's MMIX generator: simple enough to be written again in other languages.
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    let edge = std::f32::consts::PI.sqrt() * 2.0;
    let points = (0..count)
        .map(|i| {
            let (u, v) = (random(), random());
            if i % 2 == 0 {
                let (height, angle) = (2.0 * u - 1.0, 2.0 * std::f32::consts::PI * v);
                let radius = (1.0 - height * height).max(0.0).sqrt();
                [radius * angle.cos(), radius * angle.sin(), height]
            } else {
                [edge * (u - 0.5), edge * (v - 0.5), -1.0]
            }
        })
        .collect();
    (points, (50.0 * AREA / (std::f64::consts::PI * count as f64)).sqrt() as f32)
}
