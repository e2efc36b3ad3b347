//! What takes the place of all estimators in the tests of comparisons: those take minutes to compile.

use scene_core::RayCounts;
use scene_core::film::{Film, LayeredImage, SAMPLES_PER_PIXEL};

use crate::program::RenderSettings;
use crate::render::{Budget, Observe, RenderError, Rendering};

/// A grey image of 4 x 3 pixels, of as many samples as are asked for.
pub(super) fn grey(settings: &RenderSettings, observe: Observe<'_>) -> Result<(LayeredImage, Rendering), RenderError> {
    let Budget::Samples(samples) = settings.budget else { unreachable!("these tests count samples") };
    let mut film = Film::new(4, 3).unwrap();
    (0..12).for_each(|i| (0..samples).for_each(|_| film.pixel_mut(i % 4, i / 4).add([0.25; 3])));
    let mut image = film.develop(0);
    image.set_attribute(SAMPLES_PER_PIXEL, samples).unwrap();
    let rays = RayCounts { closest_hit: 12 * samples, visibility: 0 };
    let rendering =
        Rendering { film, samples, light_paths: 0, rays, seconds: 0.5, preparation_seconds: 0.0, threads: 1 };
    let _ = observe(rendering.progress());
    Ok((image, rendering))
}
