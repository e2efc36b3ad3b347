//! Shapes, groups and instances.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Affine3A, DAffine3, Vec3A};

use super::error::Result;
use super::importer::Importer;
use super::object::{Object, Tag};
use super::raw_mesh::{MeshOptions, RawMesh};
use super::{obj, ply, primitives, serialized, transforms};
use crate::reference::{Instance, MaterialId, Shape, ShapeId};
use crate::traits::Rgb;

/// A shape that has everything but, inside a group, its final place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    shape: ShapeId,
    to_world: Affine3A,
    material: MaterialId,
    radiance: Option<Rgb>,
}

/// What decides the content of a mesh: file, number in the file, options, linear part of the transform.
pub(super) type MeshKey = (PathBuf, usize, MeshOptions, [u32; 9]);

impl Importer<'_> {
    pub(super) fn top_level_shape(&mut self, index: usize) -> Result<()> {
        let document = self.document;
        let object = &document.objects[index];
        match object.plugin.as_str() {
            "shapegroup" => drop(self.group(index)?),
            "instance" => self.instance(object)?,
            _ => {
                let placed = self.shape(object)?;
                self.instances.extend(placed.map(|placed| placed.into_instance(&Affine3A::IDENTITY)));
            }
        }
        Ok(())
    }

    fn instance(&mut self, object: &Object) -> Result<()> {
        let document = self.document;
        let to_world = to_world(object)?;
        let mut groups = document.children(object, &[Tag::Shape]);
        let (Some((_, group)), None) = (groups.next(), groups.next()) else {
            return Err(object.place.invalid("an instance needs exactly one shapegroup"));
        };
        if document.objects[group].plugin != "shapegroup" {
            return Err(object.place.invalid("an instance needs a shapegroup, not another shape"));
        }
        let members = self.group(group)?;
        self.instances.extend(members.iter().map(|member| member.into_instance(&to_world)));
        self.warn_unused(object);
        Ok(())
    }

    /// The shapes of a group, converted once.
    fn group(&mut self, index: usize) -> Result<Arc<[Placed]>> {
        if let Some(members) = self.groups.get(&index) {
            return Ok(members.clone());
        }
        let document = self.document;
        let object = &document.objects[index];
        let mut members = Vec::new();
        for (child, shape) in document.children(object, &[Tag::Shape]) {
            let shape = &document.objects[shape];
            if matches!(shape.plugin.as_str(), "shapegroup" | "instance") {
                return Err(child.place.invalid("groups of shapes must not be nested"));
            }
            members.extend(self.shape(shape)?);
        }
        self.warn_unused(object);
        let members: Arc<[Placed]> = members.into();
        self.groups.insert(index, members.clone());
        Ok(members)
    }

    /// A shape; nothing if no triangle of it is usable.
    fn shape(&mut self, object: &Object) -> Result<Option<Placed>> {
        let mut to_world = to_world(object)?;
        let flip_normals = object.boolean("flip_normals")?.unwrap_or(false);
        let shape = match object.plugin.as_str() {
            "obj" | "ply" | "serialized" => self.mesh_file(object, flip_normals, &to_world)?,
            "rectangle" => Some(self.primitive("rectangle", flip_normals, primitives::rectangle)),
            "cube" => Some(self.primitive("cube", flip_normals, primitives::cube)),
            "cylinder" => Some(self.cylinder(object, flip_normals, &to_world)?),
            "sphere" => Some(self.sphere(object, flip_normals, &to_world)?),
            "disk" => {
                if flip_normals {
                    to_world *= Affine3A::from_rotation_x(std::f32::consts::PI);
                }
                Some(self.add_shape(Shape::Disk))
            }
            _ => return Err(Self::unknown(object)),
        };
        object.ignore(&["silhouette_sampling_weight"]);
        let material = self.shape_material(object)?;
        let radiance = self.area_light(object)?;
        self.warn_unused(object);
        Ok(shape.map(|shape| Placed { shape, to_world, material, radiance }))
    }

    pub(super) fn add_shape(&mut self, shape: Shape) -> ShapeId {
        self.shapes.push(shape);
        ShapeId((self.shapes.len() - 1) as u32)
    }

    fn primitive(&mut self, name: &'static str, flip_normals: bool, make: fn() -> RawMesh) -> ShapeId {
        if let Some(&id) = self.primitives.get(&(name, flip_normals)) {
            return id;
        }
        let options = MeshOptions { flip_normals, ..MeshOptions::default() };
        let mesh = make().finish(options, &Affine3A::IDENTITY).unwrap_or_default();
        let id = self.add_shape(Shape::Mesh(Arc::new(mesh)));
        self.primitives.insert((name, flip_normals), id);
        id
    }

    fn sphere(&mut self, object: &Object, flip_normals: bool, to_world: &Affine3A) -> Result<ShapeId> {
        let center = object.vector("center")?.unwrap_or_default().map(|x| x as f32);
        let radius = object.float("radius")?.unwrap_or(1.0);
        if !(radius != 0.0 && center.iter().all(|x| x.is_finite())) {
            return Err(object.place.invalid(format!("no sphere has the radius {radius} and the centre {center:?}")));
        }
        if transforms::similarity_scale(to_world).is_none() {
            return Err(object.place.unsupported("a sphere that is scaled unequally along its axes"));
        }
        // Mitsuba turns the normals of mirrored spheres, and of those with a negative radius.
        let flip_normals = flip_normals ^ (radius < 0.0) ^ (to_world.matrix3.determinant() < 0.0);
        Ok(self.add_shape(Shape::Sphere { center: Vec3A::from(center), radius: radius.abs(), flip_normals }))
    }

    fn cylinder(&mut self, object: &Object, flip_normals: bool, to_world: &Affine3A) -> Result<ShapeId> {
        let p0 = object.vector("p0")?.unwrap_or([0.0; 3]).map(|x| x as f32);
        let p1 = object.vector("p1")?.unwrap_or([0.0, 0.0, 1.0]).map(|x| x as f32);
        let radius = object.float("radius")?.unwrap_or(1.0);
        if radius <= 0.0 || p0 == p1 {
            return Err(object.place.invalid(format!("no cylinder goes from {p0:?} to {p1:?} with radius {radius}")));
        }
        let segments = primitives::CYLINDER_SEGMENTS;
        self.warn_at(&object.place, format!("the cylinder is tessellated into {segments} segments"));
        let options = MeshOptions { flip_normals, ..MeshOptions::default() };
        let mesh = primitives::cylinder(p0.into(), p1.into(), radius).finish(options, to_world);
        let mesh = mesh.map_err(|error| object.place.invalid(error.to_string()))?;
        Ok(self.add_shape(Shape::Mesh(Arc::new(mesh))))
    }

    fn mesh_file(&mut self, object: &Object, flip_normals: bool, to_world: &Affine3A) -> Result<Option<ShapeId>> {
        let (path, place) = self.filename(object)?;
        let flips_by_default = object.plugin == "obj";
        let options = MeshOptions {
            face_normals: object.boolean("face_normals")?.unwrap_or(false),
            flip_normals,
            flip_tex_coords: object.boolean("flip_tex_coords")?.unwrap_or(flips_by_default),
        };
        let number = match (object.plugin.as_str(), object.integer("shape_index")?) {
            ("serialized", Some(number)) => usize::try_from(number)
                .map_err(|_| object.place.invalid(format!("`shape_index` is {number}, which is negative")))?,
            _ => 0,
        };
        let key = (path.clone(), number, options, to_world.matrix3.to_cols_array().map(f32::to_bits));
        if let Some(&shape) = self.meshes.get(&key) {
            return Ok(shape);
        }
        let bytes = std::fs::read(&path).map_err(|error| place.data(&path, error.to_string()))?;
        let raw = match object.plugin.as_str() {
            "obj" => obj::read(&bytes),
            "ply" => ply::read(&bytes),
            _ => serialized::read(&bytes, number),
        };
        let raw = raw.map_err(|error| place.data(&path, error.to_string()))?;
        let not_finite = raw.count_not_finite();
        let mesh = raw.finish(options, to_world).map_err(|error| place.data(&path, error.to_string()))?;
        self.without_area += mesh.dropped() - not_finite;
        if not_finite > 0 {
            let path = path.display();
            self.warn(format!("{path}: dropped {not_finite} triangles with vertices that are not finite"));
        }
        let shape = if mesh.is_empty() {
            self.warn(format!("{}: ignored, there is no usable triangle", path.display()));
            None
        } else {
            Some(self.add_shape(Shape::Mesh(Arc::new(mesh))))
        };
        self.meshes.insert(key, shape);
        Ok(shape)
    }
}

impl Placed {
    fn into_instance(self, outer: &Affine3A) -> Instance {
        let Self { shape, to_world, material, radiance } = self;
        Instance { shape, to_world: *outer * to_world, material, radiance }
    }
}

/// The transform of a shape, which must have an inverse.
fn to_world(object: &Object) -> Result<Affine3A> {
    let transform: DAffine3 = object.transform("to_world")?.unwrap_or_default();
    let place = object.property("to_world").map_or(&object.place, |property| &property.place);
    transforms::invertible(&transform).ok_or_else(|| place.invalid("`to_world` has no inverse"))
}
