//! Several images at once, whose vertices average each other.

use std::ops::ControlFlow;

use path_space_filter::PathFilter;
use qmc_sampling::SamplerFamily;
use scene_core::film::{Film, FilmError, Filter};
use scene_core::{RayCounts, Scene, Sensor};

use super::pass::add_to_film;
use super::traced::{self, Tracing};
use super::{FilterVertex, Observable, Selection, Traced};
use crate::render::PassContext;

/// One of several images: another camera, another frame, another point in time.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, S, E> {
    /// The scene as it is then, with its camera.
    pub scene: &'a S,
    /// Traces its paths.
    pub estimator: &'a E,
    /// The point in time.
    pub time: f32,
}

/// Renders several views of a scene together: a stereo pair, the frames of an animation, or points in time whose images are averaged to motion blur. Vertices are shared
/// between all of them; a weight of proximity in time keeps apart what has moved.
///
/// `batches` of `batch` samples per pixel each, until `observe`, which is told the number of the next batch, breaks. Returns the images, and the rays traced.
///
/// # Errors
/// If an image has no pixels, or too many.
pub fn render_views<S: Scene + Sync, F: SamplerFamily, E: Observable>(
    views: &[View<'_, S, E>],
    samplers: &F,
    filter: &(impl PathFilter<FilterVertex> + Sync),
    selection: Selection,
    batches: core::ops::Range<u64>,
    batch: u64,
    observe: &mut (dyn FnMut(u64) -> ControlFlow<()> + Send),
) -> Result<(Vec<Film>, RayCounts), FilmError> {
    let film = |view: &View<'_, S, E>| {
        let [width, height] = view.scene.sensor().resolution();
        Film::new(width, height)
    };
    let mut films: Vec<Film> = views.iter().map(film).collect::<Result<_, _>>()?;
    let mut rays = RayCounts::default();
    for number in batches {
        // The vertices of all views.
        let mut all = Vec::new();
        for (number_of_view, (view, film)) in (0..).zip(views.iter().zip(&films)) {
            let context = PassContext { scene: view.scene, samplers, filter: Filter::BOX };
            let tracing = Tracing { estimator: view.estimator, selection, point_lights: false, time: view.time };
            let mut traced = Traced::default();
            for index in number * batch..(number + 1) * batch {
                // Numbers of its own for each view: two that see the same are two samples.
                let index = index * views.len() as u64 + number_of_view;
                traced.append(tracing.image(&context, [film.width(), film.height()], index));
            }
            all.push(traced);
        }
        rays += traced::rays(&all);

        // Average them together, and give each view its own.
        let vertices: Vec<FilterVertex> = all.iter().flat_map(|traced| traced.vertices.iter().copied()).collect();
        let averages = filter.average(&vertices, number + 1).into_values();
        let mut first = 0;
        for (traced, film) in all.iter().zip(&mut films) {
            let own = &averages[first..first + traced.vertices.len()];
            first += traced.vertices.len();
            let radiances: Vec<[f32; 3]> = traced.radiance(own).collect();
            add_to_film(film, traced, &radiances);
        }
        if observe(number + 1).is_break() {
            break;
        }
    }
    Ok((films, rays))
}
