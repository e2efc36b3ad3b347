//! The laws of the traits of `scene-core`: `Spectrum`, `Vertex`, `Emitter`, `EmitterChoice`, `Sensor` and `Scene`; and all of
//! them at once, for a renderer that implements these: [`check_renderer`].

mod choice;
mod emitter;
mod rays;
mod renderer;
mod sensor;
mod spectrum;
mod vertex;

pub use choice::check_emitter_choice;
pub use emitter::check_emitter;
pub use rays::check_scene;
pub use renderer::{RendererLaws, check_renderer};
pub use sensor::{SensorLaws, check_sensor};
pub use spectrum::check_spectrum;
pub use vertex::{VertexLaws, check_vertex};

use scene_core::Spectrum;
use scene_core::glam::Vec3A;

use crate::seed::Uniforms;

use super::near;

/// A direction as a chi-square test has it, and as a renderer.
fn direction(w: [f64; 3]) -> Vec3A {
    Vec3A::from(w.map(|x| x as f32)).normalize()
}

/// A uniform direction.
fn on_sphere(uniforms: &mut Uniforms) -> Vec3A {
    let [u, v] = uniforms.array();
    let (z, (sin, cos)) = (1.0 - 2.0 * u, (std::f64::consts::TAU * v).sin_cos());
    let r = (1.0 - z * z).max(0.0).sqrt();
    direction([r * cos, r * sin, z])
}

fn is_unit(w: Vec3A) -> bool {
    (w.length() - 1.0).abs() <= 1e-4
}

/// The components of a spectrum.
pub(in crate::laws) fn components<S: Spectrum>(spectrum: &S) -> Vec<f64> {
    (0..S::COMPONENTS).map(|i| f64::from(spectrum.component(i))).collect()
}

/// Whether every component is finite and not negative.
pub(in crate::laws) fn is_amount<S: Spectrum>(spectrum: &S) -> bool {
    spectrum.is_finite() && components(spectrum).iter().all(|&c| c >= 0.0 && c.is_finite())
}

/// Whether all components are as near as that: relative to the larger one of each, or to the largest of all, whichever is coarser
/// by a hundredth.
fn alike<S: Spectrum>(a: &S, b: &S, tolerance: f64) -> bool {
    let (a, b) = (components(a), components(b));
    let largest = a.iter().chain(&b).fold(0.0_f64, |largest, c| largest.max(c.abs()));
    a.iter().zip(&b).all(|(a, b)| near(*a, *b, tolerance) || (a - b).abs() <= 0.01 * tolerance * largest)
}
