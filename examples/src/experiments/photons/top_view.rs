//! Where photons lie, seen from above.

use scene_core::ReferenceScene;
use scene_core::Scene;
use scene_core::film::{LayeredImage, LayeredImageError};

/// Longer side of the picture, in pixels.
const SIDE: f32 = 400.0;

/// A picture of photons from above: brightness is the number of photons in a pixel, over four times the mean of those
/// that have any.
pub(super) fn top_view(
    scene: &ReferenceScene,
    photons: impl Iterator<Item = [f32; 3]>,
) -> Result<LayeredImage, LayeredImageError> {
    let photons: Vec<[f32; 3]> = photons.collect();
    let (center, radius) = scene.bounding_sphere();
    // The box of what lies there; of the scene if nothing does.
    let bounds = |axis: usize| {
        let along = photons.iter().map(|x| x[axis]);
        let [low, high] = along.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        if low < high { [low, high] } else { [center[axis] - radius, center[axis] + radius] }
    };
    let [x, z] = [bounds(0), bounds(2)];
    let scale = SIDE / (x[1] - x[0]).max(z[1] - z[0]).max(f32::MIN_POSITIVE);
    let size = [x, z].map(|[low, high]| ((high - low) * scale).ceil().max(1.0) as usize);
    let mut counts = vec![0_u32; size[0] * size[1]];
    for [px, _, pz] in photons {
        let column = (((px - x[0]) * scale) as usize).min(size[0] - 1);
        let row = (((pz - z[0]) * scale) as usize).min(size[1] - 1);
        counts[row * size[0] + column] += 1;
    }
    let (sum, any) = counts.iter().fold((0, 0), |(sum, any), &n| (sum + u64::from(n), any + u64::from(n > 0)));
    let white = 4.0 * sum as f32 / any.max(1) as f32;
    let pixels: Vec<[f32; 3]> = counts.iter().map(|&n| [n as f32 / white.max(1.0); 3]).collect();
    let mut image = LayeredImage::new(size[0] as u32, size[1] as u32)?;
    image.set_rgb(&pixels)?;
    Ok(image)
}
