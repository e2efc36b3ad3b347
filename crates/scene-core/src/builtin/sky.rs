//! A sky with a small sun, as an image around the scene.

use core::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::Vec3A;

use crate::texture::Image;

/// Columns and rows.
const SIZE: [u32; 2] = [512, 256];
/// Where the sun stands.
pub(crate) const TO_SUN: Vec3A = Vec3A::new(-0.62, 0.60, 0.505);
/// Half of the angle under which the sun is seen, in radians, and the width of its soft edge.
const SUN: [f32; 2] = [0.045, 0.012];
/// Radiance of the sun.
const SUN_RADIANCE: [f32; 3] = [560.0, 475.0, 350.0];

/// An equirectangular image (for [`Light::Environment`](crate::reference::Light::Environment)) of a clear sky in the
/// late afternoon, in W/(m^2 sr): blue towards the zenith, pale at the horizon, with a glow around the sun, over brown
/// ground.
///
/// The sun has a diameter of five degrees and thousands of times the radiance of the zenith: with the glow around it, 63 % of
/// the light come from less than 0.5 % of the directions. The integral over the sphere, estimated by one uniform direction, has a
/// relative standard deviation of 23: very noisy, and not hopeless. Directions chosen by radiance have next to none.
pub fn sky_image() -> Arc<Image> {
    let [width, height] = SIZE;
    let sun = TO_SUN.normalize();
    let pixels = (0..width * height)
        .map(|i| {
            // Nodes as the emitter's grid has them.
            let phi = TAU * ((i % width) as f32 + 0.5) / width as f32;
            let theta = PI * (i / width) as f32 / (height - 1) as f32;
            let direction = Vec3A::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
            radiance(direction, sun).to_array()
        })
        .collect();
    // All finite, and as many as the size says.
    Arc::new(Image::from_rgb(width, height, pixels).expect("a complete image of finite values"))
}

fn radiance(direction: Vec3A, sun: Vec3A) -> Vec3A {
    let to_sun = direction.dot(sun).clamp(-1.0, 1.0);
    let height = direction.y;
    let (zenith, horizon) = (Vec3A::new(0.05, 0.11, 0.27), Vec3A::new(0.38, 0.37, 0.35));
    let ground = Vec3A::new(0.20, 0.185, 0.165);
    let sky = zenith.lerp(horizon, (1.0 - height.max(0.0)).powi(4));
    // A narrow transition at the horizon.
    let background = ground.lerp(sky, smooth(height / 0.02));
    let glow = Vec3A::new(1.0, 0.8, 0.55) * (1.0 * to_sun.max(0.0).powi(60) + 0.16 * to_sun.max(0.0).powi(6));
    let disk = smooth((SUN[0] + SUN[1] - to_sun.acos()) / SUN[1]);
    background + glow * smooth(height / 0.02) + Vec3A::from(SUN_RADIANCE) * disk
}

/// From 0 below 0 to 1 above 1.
fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
