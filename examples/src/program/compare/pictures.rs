//! The pictures of a comparison.

use scene_core::film::LayeredImage;

use super::measure::Measured;
use crate::metrics::{ImagePair, RELATIVE_EPSILON, flip_ldr_map};
use crate::program::Failure;
use crate::report::{Colours, Picture, Shown};

/// The decades that maps of errors show.
const ERROR_DECADES: f32 = 4.0;
/// The share of pixels that may be brighter than the brightest colour.
const ERROR_BEYOND: f64 = 0.001;

/// The mean of the renderings, which is what is shown of an estimator. Nothing without renderings.
pub(super) fn mean_image(measured: &Measured) -> Option<LayeredImage> {
    let first = measured.first.as_ref()?;
    let mut values = measured.trials.values().iter().map(|moments| moments.mean() as f32);
    let pixels: Vec<[f32; 3]> = std::iter::from_fn(|| Some([values.next()?, values.next()?, values.next()?])).collect();
    let mut image = LayeredImage::new(first.width(), first.height()).ok()?;
    image.set_rgb(&pixels).ok()?;
    Some(image)
}

/// The relative squared error of a pixel: mean over channels and renderings. Its mean over the pixels is the relative MSE.
fn squared_errors(measured: &Measured, reference: &[[f32; 3]]) -> Vec<f32> {
    let of_channel = |(moments, &truth): (&qmc_sampling::Replications, &f32)| {
        let (count, truth) = (moments.count() as f64, f64::from(truth));
        // Of one rendering, the variance is unknown and the deviation is all there is.
        let scatter = if count > 1.0 { moments.variance() * (count - 1.0) / count } else { 0.0 };
        (scatter + (moments.mean() - truth).powi(2)) / (truth * truth + RELATIVE_EPSILON)
    };
    let channels: Vec<f64> = measured.trials.values().iter().zip(reference.iter().flatten()).map(of_channel).collect();
    channels.chunks_exact(3).map(|pixel| (pixel.iter().sum::<f64>() / 3.0) as f32).collect()
}

/// All pictures: the reference, the means of all estimators, their errors, their FLIP, and what the first hits are like.
pub(super) fn pictures(reference: &LayeredImage, all: &[(&str, &Measured)]) -> Result<Vec<Picture>, Failure> {
    let size = [reference.width(), reference.height()];
    let truth = reference.rgb()?;
    let flat = |pixels: Vec<[f32; 3]>| pixels.into_iter().flatten().collect::<Vec<f32>>();
    let mut pictures = vec![Picture::new("reference", Shown::Radiance, size, flat(truth.clone()))?];
    let means: Vec<(&str, &Measured, LayeredImage)> =
        all.iter().filter_map(|&(name, measured)| Some((name, measured, mean_image(measured)?))).collect();
    for (name, _, mean) in &means {
        pictures.push(Picture::new(name, Shown::Radiance, size, flat(mean.rgb()?))?);
    }
    let errors: Vec<Vec<f32>> = means.iter().map(|(_, measured, _)| squared_errors(measured, &truth)).collect();
    let high = brightest(&errors);
    let low = high * 10f32.powf(-ERROR_DECADES);
    let shown = Shown::Map { low, high, log: true, colours: Colours::Magma };
    for ((name, ..), errors) in means.iter().zip(errors) {
        pictures.push(Picture::new(&format!("squared error, {name}"), shown, size, errors)?);
    }
    let shown = Shown::Map { low: 0.0, high: 1.0, log: false, colours: Colours::Magma };
    for (name, _, mean) in &means {
        let map = flip_ldr_map(&ImagePair::of_images(mean, reference)?);
        pictures.push(Picture::new(&format!("FLIP, {name}"), shown, size, map)?);
    }
    let first = means.iter().find_map(|(_, measured, _)| measured.first.as_ref());
    pictures.extend(auxiliary(std::iter::once(reference).chain(first)));
    Ok(pictures)
}

/// The power of ten that nearly all errors are below, so that all estimators can share a scale.
fn brightest(errors: &[Vec<f32>]) -> f32 {
    let mut sorted: Vec<f32> = errors.iter().flatten().copied().filter(|error| error.is_finite()).collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let index = ((1.0 - ERROR_BEYOND) * sorted.len() as f64) as usize;
    match sorted.get(index.min(sorted.len().saturating_sub(1))) {
        Some(&error) if error > 0.0 => 10f32.powf(error.log10().ceil().clamp(-3.0, 4.0)),
        _ => 1.0,
    }
}

/// Albedo, normal and depth of the first image that has them.
fn auxiliary<'a>(images: impl Iterator<Item = &'a LayeredImage> + Clone) -> Vec<Picture> {
    let find = |names: [&str; 3]| {
        images.clone().find_map(|image| {
            let [x, y, z] = names.map(|name| image.channel(name));
            let values = x?.iter().zip(y?).zip(z?).flat_map(|((&x, &y), &z)| [x, y, z]).collect::<Vec<f32>>();
            Some(([image.width(), image.height()], values))
        })
    };
    let mut pictures = Vec::new();
    let mut push = |name, shown, found: Option<([u32; 2], Vec<f32>)>| {
        pictures.extend(found.and_then(|(size, values)| Picture::new(name, shown, size, values).ok()));
    };
    push("albedo", Shown::Albedo, find(["Albedo.R", "Albedo.G", "Albedo.B"]));
    push("normal", Shown::Normal, find(["N.X", "N.Y", "N.Z"]));
    let depth = images.clone().find_map(|image| Some(([image.width(), image.height()], image.channel("Z")?.to_vec())));
    let hits = |values: &[f32]| {
        let hits = values.iter().copied().filter(|depth| *depth > 0.0 && depth.is_finite());
        hits.fold((f32::INFINITY, 0.0f32), |(low, high), depth| (low.min(depth), high.max(depth)))
    };
    if let Some((size, values)) = depth {
        let (low, high) = hits(&values);
        // Nothing was hit, or a wall that is everywhere as far.
        let (low, high) = if low < high { (low, high) } else { (0.0, high.max(1.0)) };
        let shown = Shown::Map { low, high, log: false, colours: Colours::Viridis };
        push("depth", shown, Some((size, values)));
    }
    pictures
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_of_errors_is_a_power_of_ten_above_nearly_all() {
        assert_eq!(brightest(&[vec![0.02; 5000], vec![f32::NAN, 900.0]]), 0.1);
        assert_eq!(brightest(&[vec![0.0; 4]]), 1.0);
        assert_eq!(brightest(&[]), 1.0);
    }

    #[test]
    fn auxiliary_pictures_come_from_the_first_image_that_has_them() {
        let mut bare = LayeredImage::new(2, 1).unwrap();
        bare.set_rgb(&[[1.0; 3]; 2]).unwrap();
        let mut full = bare.clone();
        for name in ["Albedo.R", "Albedo.G", "Albedo.B", "N.X", "N.Y", "N.Z", "Z"] {
            full.set_channel(name, vec![0.0, 2.0]).unwrap();
        }
        assert!(auxiliary([&bare].into_iter()).is_empty());
        assert_eq!(auxiliary([&bare, &full].into_iter()).len(), 3);
    }
}
