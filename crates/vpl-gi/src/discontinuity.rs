//! The discontinuity buffer.

/// What tells whether two pixels see about the same surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFeatures {
    /// Albedo of what the pixel sees.
    pub albedo: [f32; 3],
    /// Its normal; need not have unit length.
    pub normal: [f32; 3],
    /// Its distance from the sensor; zero if the pixel sees nothing.
    pub depth: f32,
}

/// The discontinuity buffer: pixels of one interleaved tile share their light if they see about the same surface.
///
/// ```text
/// L'(p) = albedo(p)  mean over q in N(p) of  L(q) / albedo(q),
/// N(p) = { q in the tile around p : normals within an angle, depths within a fraction }, p included
/// ```
/// Interleaved sampling turns the error of few light paths into a pattern with the period of the tile. A window of the size of the tile sees
/// every sub-pattern once, hence the mean over it is as smooth as if every pixel had been lit by the light paths of all.
///
/// **Biased**, and not consistent: light is blurred over the tile where features do not tell surfaces apart (shadows, textures that the albedo does not know,
/// glossy reflections). Off by default.
///
/// **Cost.** As many comparisons per pixel as the tile has pixels.
///
/// **Source.** Keller, "Quasi-Monte Carlo Methods for Photorealistic Image Synthesis", 1998; Wald, Kollig, Benthin, Keller, Slusallek, "Interactive Global
/// Illumination using Fast Ray Tracing", 2002.
///
/// ```
/// use vpl_gi::{DiscontinuityBuffer, PixelFeatures};
///
/// let wall = PixelFeatures { albedo: [0.5; 3], normal: [0.0, 0.0, 1.0], depth: 2.0 };
/// let floor = PixelFeatures { normal: [0.0, 1.0, 0.0], ..wall };
/// let buffer = DiscontinuityBuffer::new([3, 1]);
/// let smooth = buffer.filter([4, 1], &[wall, wall, wall, floor], &[[1.0; 3], [3.0; 3], [5.0; 3], [9.0; 3]]);
/// assert_eq!(smooth.map(|image| image[1]), Some([3.0; 3])); // the mean of three
/// # let smooth = buffer.filter([4, 1], &[wall, wall, wall, floor], &[[1.0; 3], [3.0; 3], [5.0; 3], [9.0; 3]]).unwrap();
/// assert_eq!(smooth[3], [9.0; 3]); // another surface
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscontinuityBuffer {
    /// Sides of the interleaved tile.
    pub tile: [u32; 2],
    /// Smallest cosine between normals.
    pub least_cosine: f32,
    /// Largest difference of depths, as a fraction of the depth.
    pub depth_tolerance: f32,
}

impl DiscontinuityBuffer {
    /// For a tile of this size: normals within 18 degrees, depths within 3 %.
    pub const fn new(tile: [u32; 2]) -> Self {
        Self { tile, least_cosine: 0.95, depth_tolerance: 0.03 }
    }

    /// Filters an image of `size` pixels, row by row. `None` if there are not as many features and pixels.
    pub fn filter(
        &self,
        [width, height]: [u32; 2],
        features: &[PixelFeatures],
        radiance: &[[f32; 3]],
    ) -> Option<Vec<[f32; 3]>> {
        let [width, height] = [width as usize, height as usize];
        let count = width.checked_mul(height)?;
        if features.len() != count || radiance.len() != count {
            return None;
        }
        // As many pixels before as after, one more before if the side is even: each sub-pattern once.
        let window = |at: usize, side: u32, end: usize| {
            let side = side.max(1) as usize;
            at.saturating_sub(side / 2)..(at + side - side / 2).min(end)
        };
        let pixel = |p: usize| {
            let (x, y) = (p % width, p / width);
            let mut sum = [0.0f64; 3];
            let mut similar = 0.0;
            for row in window(y, self.tile[1], height) {
                for q in window(x, self.tile[0], width).map(|column| row * width + column) {
                    if q == p || self.is_similar(&features[p], &features[q]) {
                        similar += 1.0;
                        (0..3).for_each(|c| sum[c] += f64::from(radiance[q][c] / albedo(&features[q], c)));
                    }
                }
            }
            core::array::from_fn(|c| (sum[c] / similar) as f32 * albedo(&features[p], c))
        };
        Some((0..count).map(pixel).collect())
    }

    fn is_similar(&self, a: &PixelFeatures, b: &PixelFeatures) -> bool {
        let dot = |x: &[f32; 3], y: &[f32; 3]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f32>();
        let cosine = dot(&a.normal, &b.normal) / (dot(&a.normal, &a.normal) * dot(&b.normal, &b.normal)).sqrt();
        a.depth > 0.0
            && b.depth > 0.0
            && cosine >= self.least_cosine
            && (a.depth - b.depth).abs() <= self.depth_tolerance * a.depth
    }
}

/// What to divide by: black surfaces keep their radiance as it is.
fn albedo(features: &PixelFeatures, channel: usize) -> f32 {
    let albedo = features.albedo[channel];
    if albedo > 1e-3 { albedo } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GREY: PixelFeatures = PixelFeatures { albedo: [0.5; 3], normal: [0.0, 0.0, 1.0], depth: 1.0 };

    /// A pattern of the period of the tile becomes its mean, wherever the window lies within the image.
    #[test]
    fn patterns_of_the_tile_vanish() {
        for [columns, rows] in [[3, 3], [2, 3], [4, 1]] {
            let (width, height) = (12, 12);
            let at = |p: usize| ((p % width) % columns + columns * ((p / width) % rows)) as f32;
            let image: Vec<[f32; 3]> = (0..width * height).map(|p| [at(p); 3]).collect();
            let buffer = DiscontinuityBuffer::new([columns as u32, rows as u32]);
            let smooth = buffer.filter([12, 12], &vec![GREY; image.len()], &image).unwrap();
            let mean = (columns * rows - 1) as f32 / 2.0;
            for y in rows..height - rows {
                for x in columns..width - columns {
                    assert!((smooth[y * width + x][1] - mean).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn textures_stay_sharp_and_edges_too() {
        let red = PixelFeatures { albedo: [0.8, 0.1, 0.1], ..GREY };
        let far = PixelFeatures { depth: 1.2, ..GREY };
        let sky = PixelFeatures { depth: 0.0, ..GREY };
        let features = [GREY, red, far, sky];
        let image = [[0.5; 3], [0.8, 0.1, 0.1], [7.0; 3], [9.0; 3]];
        let smooth = DiscontinuityBuffer::new([3, 3]).filter([4, 1], &features, &image).unwrap();
        for (a, b) in smooth.iter().flatten().zip(image.iter().flatten()) {
            assert!((a - b).abs() < 1e-6);
        }
    }

    #[test]
    fn sizes_are_checked_and_black_stays() {
        let buffer = DiscontinuityBuffer::new([3, 3]);
        assert_eq!(buffer.filter([2, 2], &[GREY; 4], &[[0.0; 3]; 3]), None);
        assert_eq!(buffer.filter([u32::MAX, u32::MAX], &[], &[]), None);
        assert_eq!(buffer.filter([0, 5], &[], &[]), Some(Vec::new()));
        let black = PixelFeatures { albedo: [0.0; 3], ..GREY };
        assert_eq!(buffer.filter([1, 1], &[black], &[[0.25; 3]]), Some(vec![[0.25; 3]]));
    }
}
