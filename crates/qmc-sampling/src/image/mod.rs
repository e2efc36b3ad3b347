//! One sequence through all the pixels of an image.
//!
//! The first two dimensions of a sequence, scaled up to the pixel grid, say which pixel a point belongs to. A batch of
//! consecutive points puts exactly one into each cell of a grid that covers the image, so the image is refined by contiguous
//! batches, each of which can be drawn alone, and pixels are correlated as the sequence is: their errors cancel over areas.
//! Source: Grünschloß, Raab and Keller, "Enumerating quasi-Monte Carlo point sequences in elementary intervals" (2012).
mod halton;
mod sobol;

pub use halton::HaltonImage;
pub use sobol::SobolImage;

/// The map between the points of a sequence and the pixels of an image.
///
/// # Laws
/// - `pixel(index(p, batch)) == Some(p)` for all pixels `p` of the image and all batches below [`batches`](Self::batches).
/// - `index(p, batch) / batch_len() == batch`; two pixels never share an index.
///
/// Dyn compatible: `&dyn ImageSequence`.
pub trait ImageSequence {
    /// Width and height in pixels.
    fn size(&self) -> [u32; 2];

    /// How many consecutive points make a batch: one for each cell of the grid that covers the image.
    fn batch_len(&self) -> u64;

    /// How many batches there are before the sequence repeats: samples per pixel.
    fn batches(&self) -> u64;

    /// The pixel that a point falls into, as column and row; none if that is outside of the image.
    fn pixel(&self, index: u64) -> Option<[u32; 2]>;

    /// The index of the point that `batch` puts into a pixel (column, row).
    fn index(&self, pixel: [u32; 2], batch: u64) -> u64;

    /// Where in its pixel a point lies, from `[0, 0]` to below `[1, 1]`.
    fn offset(&self, index: u64) -> [f64; 2];
}

// Its docs say so.
const _: Option<&dyn ImageSequence> = None;

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn check(image: &impl ImageSequence) {
        let [width, height] = image.size();
        for batch in [0, 1, 7] {
            // All the points of the batch in a row ...
            let mut found: Vec<([u32; 2], u64)> = (0..image.batch_len())
                .map(|i| batch * image.batch_len() + i)
                .filter_map(|index| image.pixel(index).map(|pixel| (pixel, index)))
                .collect();
            // ... are the points asked for pixel by pixel.
            let mut asked: Vec<([u32; 2], u64)> = (0..height)
                .flat_map(|y| (0..width).map(move |x| [x, y]))
                .map(|pixel| (pixel, image.index(pixel, batch)))
                .collect();
            found.sort_unstable();
            asked.sort_unstable();
            assert_eq!(found, asked);
        }
    }

    #[test]
    fn batches_hit_every_pixel_once() {
        for (width, height) in [(1, 1), (2, 1), (16, 16), (13, 40), (100, 3)] {
            check(&SobolImage::new(width, height).unwrap());
            check(&HaltonImage::new(width, height).unwrap());
        }
    }

    fn round_trip(image: &impl ImageSequence) {
        let [width, height] = image.size();
        assert!(image.batches() >= 1 << 16, "{}", image.batches());
        for batch in [0, 1, 1 << 15, (1 << 16) - 1] {
            for pixel in [[0, 0], [width - 1, height - 1], [width / 2, 17], [1234, height / 3]] {
                let index = image.index(pixel, batch);
                assert_eq!((image.pixel(index), index / image.batch_len()), (Some(pixel), batch));
                assert!(image.offset(index).iter().all(|x| (0.0..1.0).contains(x)));
            }
        }
    }

    #[test]
    fn four_k_with_65536_samples_per_pixel_does_not_overflow() {
        round_trip(&SobolImage::new(3840, 2160).unwrap());
        round_trip(&HaltonImage::new(3840, 2160).unwrap());
    }
}
