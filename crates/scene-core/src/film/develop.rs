//! From sums to an image.

use super::pixel::{scaled, variance_of_mean};
use super::{Film, LayeredImage};

impl Film {
    /// The image so far, with these channels:
    ///
    /// | channels | what | where nothing is known |
    /// |---|---|---|
    /// | `R G B` | mean radiance, plus the splats over the number of light paths | 0 |
    /// | `Variance.R` .. `.B` | variance of that mean | infinity |
    /// | `Albedo.R` .. `.B` | mean albedo over samples that hit something | 0 |
    /// | `N.X` .. `.Z` | mean normal over them | 0 |
    /// | `Z` | mean distance over them | 0 |
    /// | `Camera.R` .. `.B`, `Splat.R` .. `.B` | the two parts of `R G B`, if there are splats | 0 |
    ///
    /// `light_paths` is the number of light paths that the splats came from, those that missed the sensor included;
    /// with zero the splats are left out. With one of them the variance is unknown, as it is with one sample per
    /// pixel. The variance of splats counts each splat as an independent path: light paths that hit the same pixel
    /// several times make it an underestimate.
    pub fn develop(&self, light_paths: u64) -> LayeredImage {
        let count = self.pixels().len();
        let has_splats = light_paths > 0 && !self.splats.pixels.is_empty();
        let (mut combined, mut variance) = (planes(count), planes(count));
        let (mut albedo, mut normal, mut depth) = (planes(count), planes(count), Vec::with_capacity(count));
        let splat_planes = if has_splats { count } else { 0 };
        let (mut camera, mut splat) = (planes(splat_planes), planes(splat_planes));

        for (index, pixel) in self.pixels().iter().enumerate() {
            let mut mean = pixel.mean();
            // A pixel that only light paths contribute to has no uncertainty from the camera's side.
            let unsampled = has_splats && pixel.samples() == 0;
            let mut pixel_variance =
                if unsampled { [0.0; 3] } else { pixel.variance_of_mean().unwrap_or([f64::INFINITY; 3]) };
            if has_splats {
                let sums = &self.splats.pixels[index];
                let splat_mean = scaled(sums.sum, light_paths);
                let splat_variance =
                    variance_of_mean(sums.sum, sums.sum_squares, light_paths).unwrap_or([f64::INFINITY; 3]);
                push(&mut camera, mean);
                push(&mut splat, splat_mean);
                for channel in 0..3 {
                    mean[channel] += splat_mean[channel];
                    pixel_variance[channel] += splat_variance[channel];
                }
            }
            push(&mut combined, mean);
            push(&mut variance, pixel_variance);
            push(&mut albedo, pixel.albedo());
            push(&mut normal, pixel.normal());
            depth.push(pixel.depth() as f32);
        }

        let mut image = LayeredImage::of_film(self.width(), self.height());
        image.put_planes(["R", "G", "B"], combined);
        image.put_planes(["Variance.R", "Variance.G", "Variance.B"], variance);
        image.put_planes(["Albedo.R", "Albedo.G", "Albedo.B"], albedo);
        image.put_planes(["N.X", "N.Y", "N.Z"], normal);
        image.put_planes(["Z"], [depth]);
        if has_splats {
            image.put_planes(["Camera.R", "Camera.G", "Camera.B"], camera);
            image.put_planes(["Splat.R", "Splat.G", "Splat.B"], splat);
        }
        image
    }
}

fn planes(capacity: usize) -> [Vec<f32>; 3] {
    std::array::from_fn(|_| Vec::with_capacity(capacity))
}

fn push(planes: &mut [Vec<f32>; 3], values: [f64; 3]) {
    for (plane, value) in planes.iter_mut().zip(values) {
        plane.push(value as f32);
    }
}
