//! Light paths: connecting to the lens.

use qmc_sampling::Sampler;
use scene_core::{EmitterChoice, Scene, Sensor, Spectrum, TransportMode, Vertex};

use super::Bidirectional;
use super::light_paths::LightPaths;
use super::path::{Joint, LensRay, Path};
use super::techniques::PathHeuristic;
use crate::lights::LightKind;

impl<H: PathHeuristic, C: EmitterChoice> Bidirectional<H, C> {
    /// Connects every vertex of the light paths to the lens, and calls `splat` with the raster position and the value of each that contributes.
    ///
    /// The mean over all light paths (not over calls), times the reconstruction filter, is what is to be added to the image of
    /// [`radiance`](Self::radiance). Does nothing without the connection to the lens. Takes two numbers per light vertex. Each light path must
    /// be connected to the lens once, also if many eye paths share it.
    pub fn splats<S, V>(
        &self,
        scene: &S,
        lights: &LightPaths<V>,
        sampler: &mut impl Sampler,
        mut splat: impl FnMut([f32; 2], S::Spectrum),
    ) where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum>,
    {
        let samples = self.samples(lights);
        if samples.to_lens.is_none() {
            return;
        }
        let [width, height] = scene.sensor().resolution();
        let pixels = f64::from(width) * f64::from(height);
        let paths = lights.paths() as f32;
        for (index, light) in lights.lights().as_slice().iter().enumerate() {
            let LightKind::Surface(vertex) = &light.kind else { continue };
            let u_lens = sampler.next_2d();
            if !vertex.is_connectible() || light.length >= self.max_depth {
                continue;
            }

            // Connect.
            let Some(connection) = scene.sensor().connect(vertex.point().position, u_lens) else { continue };
            let scattered = vertex.eval(connection.wi, TransportMode::Importance);
            let value = light.scale * scattered * (connection.weight * paths);
            if value.is_black() || !value.is_finite() {
                continue;
            }

            // Weigh.
            let origin = connection.lens.position;
            let density = pixels * f64::from(scene.sensor().pdf_ray(origin, -connection.wi).1);
            let path: Path<'_, S, V, V> = Path {
                scene,
                lights,
                eye: &[],
                lens: LensRay { origin, density },
                samples,
                joint: Joint::Lens { light: index, wi: connection.wi },
                technique: light.length as usize + 1,
            };
            let weight = self.heuristic.weight(path.technique, &path) as f32;
            if weight != 0.0 && scene.visible(vertex.point(), &connection.lens) {
                splat(connection.raster, value * weight);
            }
        }
    }
}
