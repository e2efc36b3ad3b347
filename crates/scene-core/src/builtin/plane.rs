//! Lights on a plane and closely over it: where the geometry term has no bound.

use super::SceneBuilder;
use super::form::v;
use crate::reference::{Light, SceneDescription};
use crate::traits::Rgb;
use glam::Vec3A;

/// A grey plane of 5 x 5 m around the origin.
fn plane(name: &str) -> SceneBuilder {
    let mut b = SceneBuilder::new(name);
    let grey = b.diffuse(0.6, 0.6, 0.6);
    b.quad(grey, v(-2.5, 0.0, -2.5), Vec3A::Z * 5.0, Vec3A::X * 5.0);
    b
}

/// A rectangular light of 1 x 0.5 m that stands upright on a plane, and touches it: in metres.
///
/// Along the edge that they share, the geometry term between light and plane has no bound; the irradiance of the plane
/// tends to `pi L / 2`. All light is direct.
///
/// Source: Kollig and Keller 2004, "On the Efficiency of Multiple Importance Sampling: Robust Instant Global
/// Illumination", figure 3.
pub fn plane_light() -> SceneDescription {
    let mut b = plane("plane-light");
    let black = b.diffuse(0.0, 0.0, 0.0);
    b.quad(black, v(-0.5, 0.0, -0.5), Vec3A::X, Vec3A::Y * 0.5).emit(Rgb::splat(2.5));
    b.look(v(0.9, 1.5, 2.3), v(0.0, 0.05, 0.0), 44.0, 512, 384);
    b.finish()
}

/// A point light 0.25 m over a plane: in metres.
///
/// The geometry term between the light and the point of the plane below it is 16 m^-2, and falls with the cube of the distance.
/// All light is direct.
///
/// Source: Kollig and Keller 2004, "On the Efficiency of Multiple Importance Sampling: Robust Instant Global
/// Illumination", figure 2.
pub fn plane_point() -> SceneDescription {
    let mut b = plane("plane-point");
    b.light(Light::Point { position: v(0.0, 0.25, 0.0), intensity: Rgb::splat(0.33) });
    b.look(v(0.0, 2.0, 2.4), v(0.0, 0.0, 0.1), 50.0, 512, 384);
    b.finish()
}
