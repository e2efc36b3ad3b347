//! Contributions of light paths, which arrive anywhere on the film.

use super::Filter;
use super::pixel::is_finite;
use super::sum::Sum;

/// Contributions of a batch of light paths, to be added to a [`Film`](super::Film) in a fixed order.
///
/// A light path that connects to the sensor arrives at the raster position `r` with the value `v`, scaled such that
/// its mean over all light paths is what the pixel with box filter around `r` receives. With the reconstruction filter
/// `h`, the pixel with centre `c` receives
/// ```text
/// h(r - c) v
/// ```
/// for every pixel within the filter's radius. In expectation that is what samples by
/// [`Filter::sample`] see, except in a border as wide as the filter's radius less half a pixel: camera samples look
/// beyond the film's edge there, light paths do not.
///
/// One buffer per batch makes the sums independent of the number of threads: batches fill their buffers in parallel,
/// and the film adds the buffers in order. Values or positions that are not finite are counted and dropped.
///
/// ```
/// use scene_core::film::{Film, Filter, SplatBuffer};
///
/// let mut splats = SplatBuffer::new(4, 4, Filter::BOX);
/// splats.add([1.5, 2.25], [8.0, 4.0, 2.0]); // one of two light paths hits the film
/// let mut film = Film::new(4, 4)?;
/// film.add_splats(&splats)?;
/// assert_eq!(film.develop(2).channel("R").map(|r| r[2 * 4 + 1]), Some(4.0));
/// # Ok::<(), scene_core::film::FilmError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SplatBuffer {
    width: u32,
    height: u32,
    filter: Filter,
    splats: Vec<(u32, [f32; 3])>,
    rejected: u64,
}

impl SplatBuffer {
    /// An empty buffer for a film of this size.
    pub fn new(width: u32, height: u32, filter: Filter) -> Self {
        Self { width, height, filter, splats: Vec::new(), rejected: 0 }
    }

    /// Width and height of the film that it is for.
    pub fn resolution(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Adds the value that arrives at the position `raster`, in pixels from the upper left corner. Positions outside
    /// of the film contribute to the pixels whose filter reaches there.
    pub fn add(&mut self, raster: [f32; 2], rgb: [f32; 3]) {
        if !(raster[0].is_finite() && raster[1].is_finite() && is_finite(&rgb)) {
            self.rejected += 1;
            return;
        }
        let [columns, rows] = [(raster[0], self.width), (raster[1], self.height)].map(|(x, n)| self.reach(x, n));
        for y in rows {
            let weight_y = self.filter.density_1d(raster[1] - (y as f32 + 0.5));
            for x in columns.clone() {
                let weight = weight_y * self.filter.density_1d(raster[0] - (x as f32 + 0.5));
                if weight > 0.0 {
                    self.splats.push((y * self.width + x, rgb.map(|value| value * weight)));
                }
            }
        }
    }

    /// Forgets all splats and keeps the memory.
    pub fn clear(&mut self) {
        self.splats.clear();
        self.rejected = 0;
    }

    /// The pixels along an axis whose filter may reach the position `x`.
    fn reach(&self, x: f32, size: u32) -> std::ops::Range<u32> {
        if self.filter == Filter::BOX {
            // Exactly one pixel, whatever the differences to the centres round to.
            let pixel = x.floor();
            return if pixel >= 0.0 && pixel < size as f32 { pixel as u32..pixel as u32 + 1 } else { 0..0 };
        }
        let radius = self.filter.radius();
        // The conversions saturate at zero and the largest integer.
        (x - 0.5 - radius).ceil() as u32..((x + 0.5 + radius).floor() as u32).min(size)
    }
}

/// Sums over the splats of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SplatPixel {
    pub(super) sum: [Sum; 3],
    pub(super) sum_squares: [Sum; 3],
}

/// Sums of splats over the whole film.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SplatLayer {
    /// Empty until the first splat, then one per pixel of the film.
    pub(super) pixels: Vec<SplatPixel>,
    pub(super) rejected: u64,
}

impl SplatLayer {
    pub(super) fn add(&mut self, buffer: &SplatBuffer, pixel_count: usize) {
        self.rejected += buffer.rejected;
        if self.pixels.is_empty() && !buffer.splats.is_empty() {
            self.pixels.resize(pixel_count, SplatPixel::default());
        }
        for &(index, rgb) in &buffer.splats {
            let pixel = &mut self.pixels[index as usize];
            for (channel, value) in rgb.into_iter().enumerate() {
                let value = f64::from(value);
                pixel.sum[channel].add(value);
                pixel.sum_squares[channel].add(value * value);
            }
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.rejected += other.rejected;
        if self.pixels.is_empty() {
            self.pixels.clone_from(&other.pixels);
            return;
        }
        for (pixel, other) in self.pixels.iter_mut().zip(&other.pixels) {
            for channel in 0..3 {
                pixel.sum[channel].merge(&other.sum[channel]);
                pixel.sum_squares[channel].merge(&other.sum_squares[channel]);
            }
        }
    }
}
