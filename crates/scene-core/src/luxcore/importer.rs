//! From properties to the scene description.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Affine3A, DMat4, Vec3A};

use super::error::{ImportError, Place, Result, data, invalid, unsupported};
use super::materials::ImportedMaterial;
use super::properties::{Document, Group, Property};
use crate::builtin::SceneBuilder;
use crate::film::Filter;
use crate::mitsuba::ply;
use crate::mitsuba::raw_mesh::MeshOptions;
use crate::reference::{Instance, Light, SceneDescription, Shape, ShapeId, TriangleMesh};
use crate::traits::Rgb;
use crate::warnings::Warnings;

/// State of an import.
pub(super) struct Importer<'d> {
    pub(super) document: &'d Document,
    directory: &'d Path,
    pub(super) description: SceneDescription,
    pub(super) materials: HashMap<String, ImportedMaterial>,
    meshes: HashMap<PathBuf, (ShapeId, Arc<TriangleMesh>)>,
    warnings: Warnings,
}

impl<'d> Importer<'d> {
    pub(super) fn new(document: &'d Document, directory: &'d Path) -> Self {
        Self {
            document,
            directory,
            description: SceneBuilder::new("").finish(),
            materials: HashMap::new(),
            meshes: HashMap::new(),
            warnings: Warnings::default(),
        }
    }

    /// Warns; the same message at other places is counted only.
    pub(super) fn warn_at(&mut self, place: &Place, message: impl Into<String>) {
        self.warnings.add(place, message);
    }

    /// Warns of everything in a group that no conversion asked for.
    pub(super) fn warn_unused(&mut self, group: &Group) {
        for property in group.unused() {
            self.warn_at(&property.place, format!("unknown property `{}` of the {}", property.name, group.kind));
        }
    }

    pub(super) fn run(mut self, path: &Path) -> Result<SceneDescription> {
        let document = self.document;
        let Some(camera) = document.group("camera", "") else {
            return Err(ImportError::NoCamera { path: path.to_path_buf() });
        };
        self.description.camera = self.camera(camera)?;
        for group in document.all("object") {
            self.object(group)?;
        }
        for group in document.all("light") {
            self.light(group)?;
        }
        self.warn_of_the_rest();
        self.description.name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        self.description.filter = Filter::GAUSSIAN;
        self.description.source = Some(path.to_path_buf());
        self.description.warnings.extend(self.warnings.into_lines());
        Ok(self.description)
    }

    fn warn_of_the_rest(&mut self) {
        let document = self.document;
        for kind in ["texture", "volume", "shape"] {
            for group in document.all(kind) {
                self.warn_at(&group.place, format!("ignored: the {kind} `{}`", group.name));
            }
        }
        for group in document.all("material") {
            if !self.materials.contains_key(&group.name) {
                self.warn_at(&group.place, format!("no object has the material `{}`", group.name));
            }
        }
        for (name, place) in &document.others {
            self.warn_at(place, format!("unknown property `{name}`"));
        }
    }

    fn object(&mut self, group: &Group) -> Result<()> {
        if let Some(shape) = group.get("shape") {
            return Err(unsupported(&shape.place, "an object with a `shape`"));
        }
        let (shape, mesh) = self.mesh(group.require("ply")?)?;
        let named = group.require("material")?;
        let material = self.material(named.text(), &named.place)?;
        let to_world = group.get("transformation").map_or(Ok(Affine3A::IDENTITY), transformation)?;
        if group.flag("camerainvisible", false)? {
            self.warn_at(&group.place, "ignored: `camerainvisible`");
        }
        // What has been applied to the vertices is in them.
        group.ignore(&["id", "appliedtransformation"]);
        self.warn_unused(group);
        let radiance = material.emission.map(|emission| emission.radiance(|| area(&mesh, &to_world))).transpose()?;
        self.description.instances.push(Instance { shape, to_world, material: material.id, radiance });
        Ok(())
    }

    /// A mesh file, read once.
    fn mesh(&mut self, named: &Property) -> Result<(ShapeId, Arc<TriangleMesh>)> {
        let path = self.directory.join(named.text());
        if let Some(known) = self.meshes.get(&path) {
            return Ok(known.clone());
        }
        let bytes = std::fs::read(&path).map_err(|error| data(&path, &named.place, error))?;
        let raw = ply::read(&bytes).map_err(|error| data(&path, &named.place, error))?;
        let not_finite = raw.count_not_finite();
        // Without normals of its own a mesh is flat. Its outside moves with it, mirrored or not.
        let options = MeshOptions { face_normals: raw.normals.is_empty(), ..MeshOptions::default() };
        let mesh = raw.finish(options, &Affine3A::IDENTITY).map_err(|error| data(&path, &named.place, error))?;
        if mesh.dropped() > 0 {
            let message = format!(
                "{}: {} triangles are dropped, {not_finite} with vertices that are not finite and the others without area",
                path.display(),
                mesh.dropped()
            );
            self.warn_at(&named.place, message);
        }
        let mesh = Arc::new(mesh);
        self.description.shapes.push(Shape::Mesh(mesh.clone()));
        let known = (ShapeId(self.description.shapes.len() as u32 - 1), mesh);
        self.meshes.insert(path, known.clone());
        Ok(known)
    }

    /// Light that is no object.
    fn light(&mut self, group: &Group) -> Result<()> {
        let kind = group.require("type")?;
        if kind.text() != "constantinfinite" {
            let (place, name) = (kind.place.clone(), kind.text().to_owned());
            return Err(ImportError::UnknownType { place, kind: "light", name });
        }
        let gain = group.color("gain")?.unwrap_or([1.0; 3]);
        let color = group.color("color")?.unwrap_or([1.0; 3]);
        let radiance = [0, 1, 2].map(|c| gain[c] * color[c]);
        if radiance.iter().any(|x| *x < 0.0) {
            return Err(invalid(&group.place, "a light must not be negative"));
        }
        group.ignore(&["id", "importance"]);
        self.warn_unused(group);
        self.description.lights.push(Light::Constant { radiance: Rgb::from(radiance.map(|x| x as f32)) });
        Ok(())
    }
}

/// An affine matrix, column by column.
fn transformation(property: &Property) -> Result<Affine3A> {
    let matrix = DMat4::from_cols_array(&property.numbers::<16>()?);
    if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err(invalid(&property.place, "the transformation is not affine"));
    }
    let to_world = Affine3A::from_mat4(matrix.as_mat4());
    if !(to_world.matrix3.determinant() != 0.0 && to_world.inverse().is_finite()) {
        return Err(invalid(&property.place, "the transformation has no inverse"));
    }
    Ok(to_world)
}

/// The area of a mesh in the world.
fn area(mesh: &TriangleMesh, to_world: &Affine3A) -> f64 {
    let corner = |p: Vec3A| to_world.transform_point3a(p).as_dvec3();
    let areas = (0..mesh.len()).map(|i| {
        let [a, b, c] = mesh.corners(i).map(corner);
        0.5 * (b - a).cross(c - a).length()
    });
    areas.sum()
}
