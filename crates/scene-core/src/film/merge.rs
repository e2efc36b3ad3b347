//! Merging of images from files.

use super::{Attribute, LayeredImage, LayeredImageError};

/// Name of the attribute that holds the number of samples per pixel of an image.
pub const SAMPLES_PER_PIXEL: &str = "spp";

impl LayeredImage {
    /// The mean of images of the same scene, weighted by the sample counts `n_i` in their attribute
    /// [`SAMPLES_PER_PIXEL`]:
    /// ```text
    /// m = sum n_i m_i / n,   v = sum (n_i / n)^2 v_i,   n = sum n_i
    /// ```
    /// with `m_i` any channel but those of the layer `Variance`, and `v_i` the latter: variances of means. The result
    /// has `n` as its sample count and keeps the attributes that all images agree on.
    ///
    /// Unbiased if the images are. The variance assumes that they are independent: rendered with different seeds.
    ///
    /// # Errors
    /// If there are no images, they differ in size or channels, or one does not tell a positive sample count.
    ///
    /// ```
    /// use scene_core::film::{LayeredImage, SAMPLES_PER_PIXEL};
    ///
    /// let image = |value, samples: u32| {
    ///     let mut image = LayeredImage::new(1, 1)?;
    ///     image.set_rgb(&[[value; 3]])?;
    ///     image.set_attribute(SAMPLES_PER_PIXEL, samples)?;
    ///     Ok(image)
    /// };
    /// let merged = LayeredImage::merge(&[image(1.0, 30)?, image(2.0, 10)?])?;
    /// assert_eq!(merged.rgb()?, [[1.25; 3]]);
    /// assert_eq!(merged.attribute(SAMPLES_PER_PIXEL).and_then(|spp| spp.as_u64()), Some(40));
    /// # Ok::<(), scene_core::film::LayeredImageError>(())
    /// ```
    pub fn merge(images: &[Self]) -> Result<Self, LayeredImageError> {
        let first = images.first().ok_or(LayeredImageError::NoImages)?;
        let counts = sample_counts(images)?;
        let total: f64 = counts.iter().sum();
        check_alike(first, images)?;

        let mut merged = Self::of_film(first.width(), first.height());
        for (name, _) in first.channels() {
            let is_variance = name.starts_with("Variance.");
            let mut sum = vec![0.0f64; first.pixel_count()];
            for (image, count) in images.iter().zip(&counts) {
                let weight = count / total;
                let weight = if is_variance { weight * weight } else { weight };
                let values = image.channel(name).unwrap_or_default();
                sum.iter_mut().zip(values).for_each(|(sum, &value)| *sum += weight * f64::from(value));
            }
            merged.put_planes([name], [sum.into_iter().map(|sum| sum as f32).collect()]);
        }
        for (name, value) in first.attributes() {
            if images.iter().all(|image| image.attribute(name) == Some(value)) {
                merged.set_attribute(name, value.clone())?;
            }
        }
        merged.set_attribute(SAMPLES_PER_PIXEL, Attribute::Number(total))?;
        Ok(merged)
    }
}

fn sample_counts(images: &[LayeredImage]) -> Result<Vec<f64>, LayeredImageError> {
    let count = |(index, image): (usize, &LayeredImage)| {
        image
            .attribute(SAMPLES_PER_PIXEL)
            .and_then(Attribute::as_f64)
            .filter(|count| *count > 0.0 && count.is_finite())
            .ok_or(LayeredImageError::NoSampleCount(index))
    };
    images.iter().enumerate().map(count).collect()
}

fn check_alike(first: &LayeredImage, images: &[LayeredImage]) -> Result<(), LayeredImageError> {
    for image in images {
        let [expected, found] = [first, image].map(|image| [image.width(), image.height()]);
        if expected != found {
            return Err(super::FilmError::SizeMismatch { expected, found }.into());
        }
        for (one, other) in [(first, image), (image, first)] {
            if let Some((name, _)) = one.channels().find(|(name, _)| other.channel(name).is_none()) {
                return Err(LayeredImageError::ChannelMismatch(name.to_owned()));
            }
        }
    }
    Ok(())
}
