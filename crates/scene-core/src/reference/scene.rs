//! The reference scene: built from a description, ready for every estimator.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, Vec3A};
use thiserror::Error;

use super::camera::{CameraError, PerspectiveCamera};
use super::description::{Light, SceneDescription, Shape};
use super::emitters::{
    AreaTables, DirectionalEmitter, DiskEmitter, EnvironmentEmitter, MeshEmitter, PointEmitter, ReferenceEmitter,
    SphereEmitter, SpotEmitter, similarity_scale,
};
use super::geometry::{Object, ObjectShape, TriangleMesh, Triangles, World, WorldMesh};
use super::light_checks::check_light;
use super::vertex::SceneVertex;
use crate::material::{CompiledMaterial, MaterialError};
use crate::ray::Ray;
use crate::traits::{EmitterId, Rgb, Scene, Sharpness};

/// Why a scene cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Nothing can be seen.
    #[error("the scene is empty: no surface and no environment")]
    Empty,
    /// An instance names a shape or material that does not exist.
    #[error("instance {instance} refers to {what} {index}, but there are only {count}")]
    UnknownReference {
        /// Which instance.
        instance: usize,
        /// Shape or material.
        what: &'static str,
        /// The index it names.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// An instance's transform has no inverse, is not finite, or does not suit its shape.
    #[error("instance {instance}: the transform {transform:?} {reason}")]
    Transform {
        /// Which instance.
        instance: usize,
        /// The transform.
        transform: Affine3A,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// More than one environment.
    #[error("the scene has {0} environments, but light can come from outside only once")]
    SeveralEnvironments(usize),
    /// A material with impossible parameters.
    #[error("material {index}: {error}")]
    Material {
        /// Which material.
        index: usize,
        /// What is wrong with it.
        error: MaterialError,
    },
    /// A light or a radiance that is negative or not finite.
    #[error("{what} has the value {value:?}, but light must be finite and not negative")]
    Emission {
        /// Which light.
        what: String,
        /// The value.
        value: [f32; 3],
    },
    /// A light that is nowhere, points nowhere, or is distorted.
    #[error("{what} {reason}")]
    Light {
        /// Which light.
        what: String,
        /// What is wrong with it, with the value.
        reason: String,
    },
    /// The camera.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// Meshes that are placed several times are copied into the world up to this number of triangles in all: that is faster
/// to trace than a second level. Larger ones share their triangles.
const MAX_COPIED_TRIANGLES: u64 = 50_000;

/// What a surface is made of.
#[derive(Clone, Copy, Debug)]
struct Surface {
    material: u32,
    emitter: Option<EmitterId>,
    radiance: Rgb,
}

/// A scene of triangle meshes, spheres and disks, with materials, emitters and a perspective camera.
#[derive(Clone, Debug)]
pub struct ReferenceScene {
    name: String,
    world: World,
    surfaces: Vec<Surface>,
    materials: Vec<CompiledMaterial>,
    emitters: Vec<ReferenceEmitter>,
    environment: Option<EmitterId>,
    camera: PerspectiveCamera,
    bounding_sphere: (Vec3A, f32),
    triangles: u64,
    sharpness: Sharpness,
    has_media: bool,
    warnings: Vec<String>,
}

impl ReferenceScene {
    /// Builds the scene: moves meshes that are single or small into the world, builds the hierarchies, compiles the materials and makes
    /// the emitters, those of surfaces first, in the order of the description.
    ///
    /// # Errors
    /// See [`SceneError`].
    pub fn new(description: SceneDescription) -> Result<Self, SceneError> {
        let camera = PerspectiveCamera::new(&description.camera)?;
        check_references(&description)?;
        let mut warnings = description.warnings.clone();
        let mut builder = Builder::new(&description, &mut warnings);
        for index in 0..description.instances.len() {
            builder.place(index)?;
        }
        let Builder { meshes, objects, surfaces, mut emitters, triangles, .. } = builder;
        let world = World::new(meshes, objects);

        let bounds = world.bounds();
        let bounding_sphere = bounds.map_or((Vec3A::ZERO, 1.0), |b| {
            let radius = 0.5 * (b.max - b.min).length();
            (0.5 * (b.min + b.max), radius.max(f32::MIN_POSITIVE) * 1.0001)
        });
        let environment = add_lights(&description.lights, bounding_sphere, &mut emitters, &mut warnings)?;
        if bounds.is_none() && environment.is_none() {
            return Err(SceneError::Empty);
        }

        let mut materials = Vec::with_capacity(description.materials.len());
        for (index, material) in description.materials.into_iter().enumerate() {
            materials.push(material.compile().map_err(|error| SceneError::Material { index, error })?);
        }
        let sharpness = surfaces.iter().map(|surface| materials[surface.material as usize].sharpness());
        let sharpness = sharpness.max().unwrap_or(Sharpness::Diffuse);
        let has_media = surfaces.iter().any(|surface| materials[surface.material as usize].interior().is_some());
        Ok(Self {
            name: description.name,
            world,
            surfaces,
            materials,
            emitters,
            environment,
            camera,
            bounding_sphere,
            triangles,
            sharpness,
            has_media,
            warnings,
        })
    }

    /// The scene's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of triangles, counting those of instances each time they are placed.
    pub fn triangle_count(&self) -> u64 {
        self.triangles
    }

    /// Whether any surface encloses a participating medium. Estimators that do not ask
    /// [`Vertex::medium`](crate::Vertex::medium) take it for clear.
    pub fn has_media(&self) -> bool {
        self.has_media
    }

    /// What was noticed and passed over, one line each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

impl Scene for ReferenceScene {
    type Spectrum = Rgb;
    type Vertex<'s> = SceneVertex<'s>;
    type Emitter = ReferenceEmitter;
    type Sensor = PerspectiveCamera;

    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<SceneVertex<'_>> {
        let hit = self.world.closest(ray)?;
        let surface = &self.surfaces[hit.surface as usize];
        let material = &self.materials[surface.material as usize];
        let geometry = self.world.local_geometry(ray, &hit, material.needs_tangents());
        Some(SceneVertex::new(&geometry, material, -ray.direction, surface.emitter, surface.radiance))
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.world.any(ray)
    }

    #[inline]
    fn emitters(&self) -> &[ReferenceEmitter] {
        &self.emitters
    }

    #[inline]
    fn environment(&self) -> Option<EmitterId> {
        self.environment
    }

    #[inline]
    fn sensor(&self) -> &PerspectiveCamera {
        &self.camera
    }

    fn bounding_sphere(&self) -> (Vec3A, f32) {
        self.bounding_sphere
    }

    fn sharpness(&self) -> Sharpness {
        self.sharpness
    }
}

fn check_references(description: &SceneDescription) -> Result<(), SceneError> {
    let (shapes, materials) = (description.shapes.len(), description.materials.len());
    for (instance, placed) in description.instances.iter().enumerate() {
        for (what, index, count) in [("shape", placed.shape.0, shapes), ("material", placed.material.0, materials)] {
            if index as usize >= count {
                return Err(SceneError::UnknownReference { instance, what, index, count });
            }
        }
    }
    Ok(())
}

fn check_emission(what: impl FnOnce() -> String, value: Rgb) -> Result<(), SceneError> {
    let value = value.to_array();
    if value.iter().all(|x| x.is_finite() && *x >= 0.0) {
        Ok(())
    } else {
        Err(SceneError::Emission { what: what(), value })
    }
}

/// Places instances one after the other.
struct Builder<'d> {
    description: &'d SceneDescription,
    warnings: &'d mut Vec<String>,
    uses: Vec<u32>,
    hierarchies: HashMap<u32, Arc<Triangles>>,
    areas: AreaTables,
    meshes: Vec<WorldMesh>,
    objects: Vec<Object>,
    surfaces: Vec<Surface>,
    emitters: Vec<ReferenceEmitter>,
    triangles: u64,
}

impl<'d> Builder<'d> {
    fn new(description: &'d SceneDescription, warnings: &'d mut Vec<String>) -> Self {
        let mut uses = vec![0; description.shapes.len()];
        for instance in &description.instances {
            uses[instance.shape.0 as usize] += 1;
        }
        Self {
            description,
            warnings,
            uses,
            hierarchies: HashMap::new(),
            areas: AreaTables::default(),
            meshes: Vec::new(),
            objects: Vec::new(),
            surfaces: Vec::new(),
            emitters: Vec::new(),
            triangles: 0,
        }
    }

    fn place(&mut self, index: usize) -> Result<(), SceneError> {
        let instance = &self.description.instances[index];
        let radiance = instance.radiance.unwrap_or(Rgb::ZERO);
        check_emission(|| format!("the radiance of instance {index}"), radiance)?;
        let to_world = instance.to_world;
        let surface = self.surfaces.len() as u32;
        let emitter = match &self.description.shapes[instance.shape.0 as usize] {
            Shape::Mesh(mesh) => self.place_mesh(index, instance.shape.0, mesh, to_world, radiance, surface)?,
            Shape::Sphere { center, radius, flip_normals } => {
                let is_finite = to_world.is_finite() && center.is_finite() && radius.is_finite();
                let scale = similarity_scale(&to_world).filter(|s| *s > 0.0 && *radius > 0.0 && is_finite);
                let Some(scale) = scale else {
                    return Err(transform_error(
                        index,
                        to_world,
                        "must scale a sphere uniformly, to a positive radius",
                    ));
                };
                let shape = ObjectShape::Sphere { center: *center, radius: *radius, flip_normals: *flip_normals };
                self.objects.push(Object::new(shape, to_world, surface));
                let center = to_world.transform_point3a(*center);
                Some(ReferenceEmitter::Sphere(SphereEmitter::new(center, radius * scale, *flip_normals, radiance)))
            }
            Shape::Disk => {
                check_invertible(index, to_world)?;
                self.objects.push(Object::new(ObjectShape::Disk, to_world, surface));
                Some(ReferenceEmitter::Disk(DiskEmitter::new(to_world, radiance)))
            }
        };
        let emitter = emitter.filter(|_| radiance != Rgb::ZERO).map(|emitter| {
            self.emitters.push(emitter);
            EmitterId(self.emitters.len() as u32 - 1)
        });
        self.surfaces.push(Surface { material: instance.material.0, emitter, radiance });
        Ok(())
    }

    fn place_mesh(
        &mut self,
        index: usize,
        shape: u32,
        mesh: &Arc<TriangleMesh>,
        to_world: Affine3A,
        radiance: Rgb,
        surface: u32,
    ) -> Result<Option<ReferenceEmitter>, SceneError> {
        if !to_world.is_finite() {
            return Err(transform_error(index, to_world, "is not finite"));
        }
        let copies = u64::from(self.uses[shape as usize]) * mesh.len() as u64;
        let (placed, placed_to_world) = if self.uses[shape as usize] == 1 || copies <= MAX_COPIED_TRIANGLES {
            let moved =
                if to_world == Affine3A::IDENTITY { mesh.clone() } else { Arc::new(mesh.transformed(&to_world)) };
            self.meshes.push(WorldMesh { mesh: moved.clone(), surface });
            (moved, Affine3A::IDENTITY)
        } else {
            check_invertible(index, to_world)?;
            let triangles =
                self.hierarchies.entry(shape).or_insert_with(|| Arc::new(Triangles::new([(&**mesh, 0)].into_iter())));
            self.objects.push(Object::new(ObjectShape::Mesh(triangles.clone()), to_world, surface));
            (mesh.clone(), to_world)
        };
        self.triangles += placed.len() as u64;
        // What the mesh itself dropped was for its maker to report.
        let dropped = placed.dropped() - mesh.dropped();
        if dropped > 0 {
            self.warnings.push(format!(
                "instance {index}: its transform leaves {dropped} triangles without area, which are dropped"
            ));
        }
        if radiance == Rgb::ZERO {
            return Ok(None);
        }
        let table = self.areas.table(&placed, &placed_to_world);
        if table.is_none() {
            self.warnings.push(format!("instance {index}: emits, but has no area"));
        }
        Ok(table.map(|table| ReferenceEmitter::Mesh(MeshEmitter::new(placed, placed_to_world, table, radiance))))
    }
}

fn transform_error(instance: usize, transform: Affine3A, reason: &'static str) -> SceneError {
    SceneError::Transform { instance, transform, reason }
}

fn check_invertible(instance: usize, transform: Affine3A) -> Result<(), SceneError> {
    let determinant = transform.matrix3.determinant();
    if transform.is_finite() && transform.inverse().is_finite() && determinant != 0.0 {
        Ok(())
    } else {
        Err(transform_error(instance, transform, "has no inverse"))
    }
}

/// Adds the lights that are not surfaces; returns the environment.
fn add_lights(
    lights: &[Light],
    (center, radius): (Vec3A, f32),
    emitters: &mut Vec<ReferenceEmitter>,
    warnings: &mut Vec<String>,
) -> Result<Option<EmitterId>, SceneError> {
    let mut environments = Vec::new();
    for (index, light) in lights.iter().enumerate() {
        let name = |kind: &str| format!("{kind} light {index}");
        check_light(index, light)?;
        let id = EmitterId(emitters.len() as u32);
        emitters.push(match light {
            Light::Point { position, intensity } => {
                check_emission(|| name("point"), *intensity)?;
                ReferenceEmitter::Point(PointEmitter::new(*position, *intensity))
            }
            Light::Spot { position, direction, intensity, beam_width, cutoff } => {
                check_emission(|| name("spot"), *intensity)?;
                ReferenceEmitter::Spot(SpotEmitter::new(*position, *direction, *intensity, *beam_width, *cutoff))
            }
            Light::Directional { direction, irradiance } => {
                check_emission(|| name("directional"), *irradiance)?;
                ReferenceEmitter::Directional(DirectionalEmitter::new(*direction, *irradiance, center, radius))
            }
            Light::Constant { radiance } => {
                check_emission(|| name("constant"), *radiance)?;
                environments.push(id);
                ReferenceEmitter::Environment(EnvironmentEmitter::constant(*radiance, center, radius))
            }
            Light::Environment { image, scale, to_world } => {
                check_emission(|| name("environment"), Rgb::splat(*scale))?;
                let emitter = EnvironmentEmitter::image(image, *scale, to_world.matrix3, center, radius);
                let Some(emitter) = emitter else {
                    warnings.push(format!("{} is black", name("environment")));
                    continue;
                };
                environments.push(id);
                ReferenceEmitter::Environment(emitter)
            }
        });
    }
    if environments.len() > 1 {
        return Err(SceneError::SeveralEnvironments(environments.len()));
    }
    Ok(environments.first().copied())
}
