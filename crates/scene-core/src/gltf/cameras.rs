//! Cameras, and the one that is made up where there is none.

use std::f32::consts::PI;

use ::gltf::json::camera::Type;
use ::gltf::json::validation::Checked;
use glam::{Affine3A, Mat3A, Vec3A};

use super::error::Result;
use super::importer::Importer;
use super::nodes::Placed;
use crate::reference::{CameraDescription, SceneDescription, Shape};

/// Width of the image in pixels: assets do not say it.
const WIDTH: f32 = 640.0;
/// Width over height, where the asset leaves it to the canvas.
const ASPECT: f32 = 4.0 / 3.0;
/// Largest height.
const LARGEST_HEIGHT: f32 = 65_536.0;
/// From the middle of the scene to the default camera: in front (glTF's front is +z), to the right and above.
const TO_DEFAULT: Vec3A = Vec3A::new(0.5, 0.4, 1.0);
/// Vertical angle of view of the default camera, in radians.
const DEFAULT_YFOV: f32 = 0.7;

impl Importer<'_> {
    /// The first perspective camera of the scene.
    pub(super) fn camera(&mut self, placed: &[Placed<'_>]) -> Result<Option<CameraDescription>> {
        let root = self.source.document.as_json();
        let mut found = None;
        let mut others = 0;
        for node in placed {
            let named = root.nodes.get(node.node.index()).and_then(|node| node.camera);
            let Some((index, camera)) = named.and_then(|i| Some((i.value(), root.cameras.get(i.value())?))) else {
                continue;
            };
            let place = self.source.place("cameras", index, camera.name.as_deref());
            let (Checked::Valid(Type::Perspective), Some(perspective)) = (camera.type_, &camera.perspective) else {
                self.warn(&place, "left out: a camera that is not perspective");
                continue;
            };
            if found.is_some() {
                others += 1;
                continue;
            }
            let (yfov, aspect) = (perspective.yfov, perspective.aspect_ratio.unwrap_or(ASPECT));
            if !(yfov > 0.0 && yfov < PI && aspect > 0.0 && aspect.is_finite()) {
                let message = format!("a camera of a yfov of {yfov} and an aspectRatio of {aspect} sees nothing");
                return Err(place.invalid(message));
            }
            found = Some((place, view(looking_back(node.to_world), yfov, aspect)));
        }
        let Some((place, camera)) = found else { return Ok(None) };
        if others > 0 {
            self.warn(&place, format!("of {} cameras this one is taken", others + 1));
        }
        Ok(Some(camera))
    }
}

/// Cameras of glTF look along -z with +x to the right; ours look along +z with +x to the left.
fn looking_back(mut to_world: Affine3A) -> Affine3A {
    to_world.matrix3.x_axis = -to_world.matrix3.x_axis;
    to_world.matrix3.z_axis = -to_world.matrix3.z_axis;
    to_world
}

fn view(to_world: Affine3A, yfov: f32, aspect: f32) -> CameraDescription {
    CameraDescription {
        to_world,
        fov_x: 2.0 * ((0.5 * yfov).tan() * aspect).atan(),
        aperture_radius: 0.0,
        focus_distance: 1.0,
        width: WIDTH as u32,
        height: (WIDTH / aspect).round().clamp(1.0, LARGEST_HEIGHT) as u32,
    }
}

/// The default camera: looks from [`TO_DEFAULT`] at the middle of the scene's box, whose circumscribed ball it just holds.
pub(super) fn framing(scene: &SceneDescription) -> CameraDescription {
    let (mut min, mut max) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    for instance in &scene.instances {
        let Some(Shape::Mesh(mesh)) = scene.shapes.get(instance.shape.0 as usize) else { continue };
        for corner in mesh.triangles().iter().flatten() {
            let position = instance.to_world.transform_point3a(mesh.positions()[*corner as usize].into());
            (min, max) = (min.min(position), max.max(position));
        }
    }
    let (center, radius) = (0.5 * (min + max), 0.5 * (max - min).length());
    let usable = center.is_finite() && radius.is_finite() && radius > 0.0;
    let (center, radius) = if usable { (center, radius) } else { (Vec3A::ZERO, 1.0) };
    let backwards = TO_DEFAULT.normalize();
    let right = Vec3A::Y.cross(backwards).normalize();
    let matrix3 = Mat3A::from_cols(-right, backwards.cross(right), -backwards);
    // The height is less than the width.
    let distance = radius / (0.5 * DEFAULT_YFOV).sin();
    let to_world = Affine3A { matrix3, translation: center + backwards * distance };
    view(to_world, DEFAULT_YFOV, ASPECT)
}
