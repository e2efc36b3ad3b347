//! A scene as data, before anything is built: what importers produce and builtin scenes are written in.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Affine3A, Vec3A};

use crate::film::Filter;
use crate::material::Material;
use crate::texture::Image;
use crate::traits::Rgb;

use super::geometry::TriangleMesh;

/// Index of a shape in [`SceneDescription::shapes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShapeId(pub u32);

/// Index of a material in [`SceneDescription::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MaterialId(pub u32);

/// A surface in its own coordinates.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A triangle mesh.
    Mesh(Arc<TriangleMesh>),
    /// An analytic sphere. Instances may rotate, move and scale it uniformly.
    Sphere {
        /// Centre.
        center: Vec3A,
        /// Radius.
        radius: f32,
        /// Whether the normal points to the centre.
        flip_normals: bool,
    },
    /// An analytic disk in the plane z = 0 around the origin with radius 1 and normal +z. Instances may scale it to an ellipse.
    Disk,
}

/// A shape placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// What is placed.
    pub shape: ShapeId,
    /// From the shape's coordinates to the world.
    pub to_world: Affine3A,
    /// How it scatters.
    pub material: MaterialId,
    /// Radiance that it emits to the side of its normal, in W/(m^2 sr).
    pub radiance: Option<Rgb>,
}

/// A source of light that is not a surface.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Light {
    /// A point that shines equally in all directions.
    Point {
        /// Where it is.
        position: Vec3A,
        /// Radiant intensity, in W/sr.
        intensity: Rgb,
    },
    /// A point that shines into a cone.
    Spot {
        /// Where it is.
        position: Vec3A,
        /// Axis of the cone.
        direction: Vec3A,
        /// Radiant intensity on the axis, in W/sr.
        intensity: Rgb,
        /// Half angle in radians, up to which the intensity is constant.
        beam_width: f32,
        /// Half angle in radians, at which it has fallen (linearly in the angle) to zero.
        cutoff: f32,
    },
    /// Parallel light from infinity.
    Directional {
        /// The direction in which the light travels.
        direction: Vec3A,
        /// Irradiance on a plane that faces it, in W/m^2.
        irradiance: Rgb,
    },
    /// The same radiance from everywhere.
    Constant {
        /// In W/(m^2 sr).
        radiance: Rgb,
    },
    /// An image around the scene in equirectangular projection. In its own coordinates +y is up (the image's top);
    /// `u = atan2(x, -z) / 2 pi`, `v = acos(y) / pi`, as in Mitsuba 3.
    Environment {
        /// Radiance, in W/(m^2 sr).
        image: Arc<Image>,
        /// Factor for it.
        scale: f32,
        /// From the image's directions to the world's.
        to_world: Affine3A,
    },
}

/// A perspective camera: looks along +z in its own coordinates, with +y up and +x to the left of the image
/// (as in Mitsuba).
#[derive(Clone, Debug)]
pub struct CameraDescription {
    /// From the camera's coordinates to the world.
    pub to_world: Affine3A,
    /// Horizontal angle of view, in radians.
    pub fov_x: f32,
    /// Radius of the lens; zero is a pinhole.
    pub aperture_radius: f32,
    /// Distance along the axis of the plane in focus.
    pub focus_distance: f32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

impl CameraDescription {
    /// The same camera moved to the right of its image by a length in units of the world, as the other eye of a pair.
    #[must_use]
    pub fn moved_right(&self, length: f32) -> Self {
        let mut moved = self.clone();
        moved.to_world.translation -= self.to_world.matrix3.x_axis.normalize_or_zero() * length;
        moved
    }
}

/// Everything a scene is made of.
#[derive(Clone, Debug)]
pub struct SceneDescription {
    /// Name, for reports.
    pub name: String,
    /// Surfaces, each in its own coordinates.
    pub shapes: Vec<Shape>,
    /// Placed surfaces.
    pub instances: Vec<Instance>,
    /// Scattering functions.
    pub materials: Vec<Material>,
    /// Other light.
    pub lights: Vec<Light>,
    /// The camera.
    pub camera: CameraDescription,
    /// Reconstruction filter.
    pub filter: Filter,
    /// Path length up to which the file wants light to be gathered, counted as Mitsuba does: 1 is directly visible
    /// emission, 2 direct light, ..; `None` is unlimited.
    pub max_depth: Option<u32>,
    /// Samples per pixel that the file asks for.
    pub samples_per_pixel: Option<u32>,
    /// What an importer noticed and passed over, one line each.
    pub warnings: Vec<String>,
    /// The file this came from, if any.
    pub source: Option<PathBuf>,
}
