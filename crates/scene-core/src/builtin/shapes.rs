//! Putting a scene together by hand.

use std::sync::Arc;

use glam::{Affine3A, Mat3, Vec3, Vec3A};

use crate::film::Filter;
use crate::material::Material;
use crate::reference::{
    CameraDescription, Instance, Light, MaterialId, SceneDescription, Shape, ShapeId, TriangleMesh,
};
use crate::traits::Rgb;

/// Builds a [`SceneDescription`] from simple shapes.
///
/// ```
/// use scene_core::builtin::SceneBuilder;
/// use scene_core::glam::Vec3A;
/// use scene_core::material::Material;
/// use scene_core::{ReferenceScene, Rgb, Scene};
///
/// let mut builder = SceneBuilder::new("plane and lamp");
/// let grey = builder.material(Material::Diffuse { reflectance: Rgb::splat(0.5).into() });
/// builder.quad(grey, Vec3A::new(-1.0, 0.0, -1.0), Vec3A::Z * 2.0, Vec3A::X * 2.0);
/// builder.sphere(grey, Vec3A::Y, 0.1);
/// builder.emit(Rgb::splat(10.0));
/// builder.look(Vec3A::new(0.0, 1.0, 3.0), Vec3A::ZERO, 45.0, 64, 48);
/// let scene = ReferenceScene::new(builder.finish())?;
/// assert_eq!(scene.emitters().len(), 1);
/// # Ok::<(), scene_core::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    description: SceneDescription,
}

impl SceneBuilder {
    /// An empty scene with a camera at the origin that looks along +z.
    pub fn new(name: &str) -> Self {
        Self {
            description: SceneDescription {
                name: name.to_owned(),
                shapes: Vec::new(),
                instances: Vec::new(),
                materials: Vec::new(),
                lights: Vec::new(),
                camera: CameraDescription {
                    to_world: Affine3A::IDENTITY,
                    fov_x: 0.8,
                    aperture_radius: 0.0,
                    focus_distance: 1.0,
                    width: 512,
                    height: 512,
                },
                filter: Filter::BOX,
                max_depth: None,
                samples_per_pixel: None,
                warnings: Vec::new(),
                source: None,
            },
        }
    }

    /// The scene.
    pub fn finish(self) -> SceneDescription {
        self.description
    }

    /// The description so far, for anything that has no method here.
    pub fn description(&mut self) -> &mut SceneDescription {
        &mut self.description
    }

    /// Adds a material.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.description.materials.push(material);
        MaterialId(self.description.materials.len() as u32 - 1)
    }

    /// Adds a diffuse material that reflects on both sides.
    pub fn diffuse(&mut self, r: f32, g: f32, b: f32) -> MaterialId {
        let front = Material::Diffuse { reflectance: Rgb::new(r, g, b).into() };
        self.material(Material::TwoSided { front: Box::new(front), back: None })
    }

    /// Adds a light that is not a surface.
    pub fn light(&mut self, light: Light) -> &mut Self {
        self.description.lights.push(light);
        self
    }

    /// Places a shape.
    pub fn place(&mut self, shape: Shape, material: MaterialId, to_world: Affine3A) -> &mut Self {
        let id = ShapeId(self.description.shapes.len() as u32);
        self.description.shapes.push(shape);
        self.description.instances.push(Instance { shape: id, to_world, material, radiance: None });
        self
    }

    /// Places the shape that was placed last once more.
    pub fn place_again(&mut self, material: MaterialId, to_world: Affine3A) -> &mut Self {
        let shape = ShapeId(self.description.shapes.len().saturating_sub(1) as u32);
        self.description.instances.push(Instance { shape, to_world, material, radiance: None });
        self
    }

    /// Makes what was placed last emit.
    pub fn emit(&mut self, radiance: Rgb) -> &mut Self {
        if let Some(instance) = self.description.instances.last_mut() {
            instance.radiance = Some(radiance);
        }
        self
    }

    /// A mesh of quadrilaterals `[a, b, c, d]`, each seen counterclockwise from outside.
    pub fn quads(&mut self, material: MaterialId, quads: &[[Vec3A; 4]]) -> &mut Self {
        let positions = quads.iter().flatten().map(|p| p.to_array()).collect();
        let uvs = quads.iter().flat_map(|_| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).collect();
        let triangles = (0..quads.len() as u32).map(|q| 4 * q).flat_map(|i| [[i, i + 1, i + 2], [i, i + 2, i + 3]]);
        // Indices are below the number of vertices by construction.
        let mesh = TriangleMesh::new(positions, Vec::new(), uvs, triangles.collect()).unwrap_or_default();
        self.place(Shape::Mesh(Arc::new(mesh)), material, Affine3A::IDENTITY)
    }

    /// A parallelogram with corner `corner` and sides `a`, `b`; its outside is that of `a x b`.
    pub fn quad(&mut self, material: MaterialId, corner: Vec3A, a: Vec3A, b: Vec3A) -> &mut Self {
        self.quads(material, &[[corner, corner + a, corner + a + b, corner + b]])
    }

    /// The box with half sides `half` around `center`, turned by `angle` (radians) about the vertical axis.
    pub fn cuboid(&mut self, material: MaterialId, center: Vec3A, half: Vec3A, angle: f32) -> &mut Self {
        let turn = Mat3::from_rotation_y(angle);
        let corner = |i: u32| {
            let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            center + Vec3A::from(turn * (Vec3::new(sign(0), sign(1), sign(2)) * Vec3::from(half)))
        };
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        self.quads(material, &faces.map(|face| face.map(corner)))
    }

    /// A surface of revolution about the vertical axis through `base`: `profile` lists (radius, height) from the
    /// bottom up; the outside is away from the axis. Smooth normals. Closed if the first and last radius are zero.
    pub fn lathe(&mut self, material: MaterialId, base: Vec3A, profile: &[[f32; 2]], segments: u32) -> &mut Self {
        let rows = profile.len() as u32;
        let (mut positions, mut normals, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (j, &[radius, height]) in profile.iter().enumerate() {
            let before = profile[j.saturating_sub(1)];
            let after = profile[(j + 1).min(profile.len() - 1)];
            let slope = [after[0] - before[0], after[1] - before[1]];
            for i in 0..=segments {
                let (sin, cos) = (core::f32::consts::TAU * (i % segments) as f32 / segments as f32).sin_cos();
                positions.push((base + Vec3A::new(radius * cos, height, radius * sin)).to_array());
                normals.push([slope[1] * cos, -slope[0], slope[1] * sin]);
                uvs.push([i as f32 / segments as f32, j as f32 / (rows - 1).max(1) as f32]);
            }
        }
        for j in 0..rows.saturating_sub(1) {
            for i in 0..segments {
                let a = j * (segments + 1) + i;
                let b = a + segments + 1;
                triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
            }
        }
        let mesh = TriangleMesh::new(positions, normals, uvs, triangles).unwrap_or_default();
        self.place(Shape::Mesh(Arc::new(mesh)), material, Affine3A::IDENTITY)
    }

    /// A sphere.
    pub fn sphere(&mut self, material: MaterialId, center: Vec3A, radius: f32) -> &mut Self {
        self.place(Shape::Sphere { center, radius, flip_normals: false }, material, Affine3A::IDENTITY)
    }

    /// Points the camera: from `eye` to `target`, +y up, with a horizontal angle of view in degrees.
    pub fn look(&mut self, eye: Vec3A, target: Vec3A, fov_degrees: f32, width: u32, height: u32) -> &mut Self {
        let z = (target - eye).normalize_or(Vec3A::Z);
        let x = Vec3A::Y.cross(z).normalize_or(Vec3A::X);
        let matrix3 = glam::Mat3A::from_cols(x, z.cross(x), z);
        let camera = &mut self.description.camera;
        camera.to_world = Affine3A { matrix3, translation: eye };
        (camera.fov_x, camera.width, camera.height) = (fov_degrees.to_radians(), width, height);
        self
    }
}
