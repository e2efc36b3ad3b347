//! From the document to the scene description.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

use super::buffers::Buffers;
use super::document::Source;
use super::error::{Place, Result};
use super::meshes::Primitive;
use super::textures::ImageKey;
use super::{cameras, emission, nodes};
use crate::builtin::SceneBuilder;
use crate::film::Filter;
use crate::reference::{Instance, Light, MaterialId, SceneDescription, Shape, ShapeId};
use crate::texture::Image;
use crate::traits::Rgb;
use crate::warnings::Warnings;

/// State of an import.
pub(super) struct Importer<'s> {
    pub(super) source: &'s Source,
    pub(super) buffers: &'s Buffers,
    pub(super) directory: &'s Path,
    pub(super) images: HashMap<ImageKey, Arc<Image>>,
    description: SceneDescription,
    warnings: Warnings,
}

impl<'s> Importer<'s> {
    pub(super) fn new(source: &'s Source, buffers: &'s Buffers, directory: &'s Path) -> Self {
        Self {
            source,
            buffers,
            directory,
            images: HashMap::new(),
            description: SceneBuilder::new("").finish(),
            warnings: Warnings::default(),
        }
    }

    /// Warns; the same message at other places is counted only.
    pub(super) fn warn(&mut self, place: &Place, message: impl Into<String>) {
        self.warnings.add(place, message);
    }

    pub(super) fn run(mut self) -> Result<SceneDescription> {
        let source = self.source;
        let root = Place { file: source.file.clone(), element: "asset".to_owned() };
        for name in source.unknown_extensions() {
            self.warn(&root, format!("ignored: the extension `{name}`"));
        }
        let animations = source.document.animations().len();
        if animations > 0 {
            self.warn(&root, format!("ignored: {animations} animations"));
        }
        let placed = nodes::placed(&mut self)?;
        // Meshes that are placed, each read once.
        let mut meshes = BTreeMap::new();
        for node in &placed {
            if let Some(mesh) = node.node.mesh()
                && !meshes.contains_key(&mesh.index())
            {
                let primitives = self.mesh(&mesh)?;
                meshes.insert(mesh.index(), primitives);
            }
        }
        let surfaces = self.surfaces(&meshes)?;
        self.place_meshes(&placed, &meshes, &surfaces)?;
        let camera = self.camera(&placed)?;
        self.lights(&placed)?;
        // Emissive textures are accents, such as displays and headlights, of assets to be lit by their viewer.
        let is_lamp = |surface: &SurfaceOf| surface.emitted.as_ref().is_some_and(|emitted| emitted.texture.is_none());
        if self.description.lights.is_empty() && !surfaces.values().any(is_lamp) {
            self.warn(&root, "there is no light: a constant environment of radiance 1 is added");
            self.description.lights.push(Light::Constant { radiance: Rgb::ONE });
        }
        self.description.camera = match camera {
            Some(camera) => camera,
            None => {
                self.warn(&root, "there is no camera: a default one shows the whole scene");
                cameras::framing(&self.description)
            }
        };
        Ok(self.finish())
    }

    /// Materials of the scene, one for each that a mesh has, in the order of the document, and what they emit.
    fn surfaces(&mut self, meshes: &BTreeMap<usize, Vec<Primitive>>) -> Result<BTreeMap<Option<usize>, SurfaceOf>> {
        let mut users: BTreeMap<Option<usize>, Vec<&Primitive>> = BTreeMap::new();
        for primitive in meshes.values().flatten() {
            users.entry(primitive.material).or_default().push(primitive);
        }
        let mut surfaces = BTreeMap::new();
        for (index, users) in users {
            let (material, emitted) = self.material(index, &users)?;
            let id = MaterialId(self.description.materials.len() as u32);
            self.description.materials.push(material);
            surfaces.insert(index, SurfaceOf { material: id, emitted });
        }
        Ok(surfaces)
    }

    fn place_meshes(
        &mut self,
        placed: &[nodes::Placed<'_>],
        meshes: &BTreeMap<usize, Vec<Primitive>>,
        surfaces: &BTreeMap<Option<usize>, SurfaceOf>,
    ) -> Result<()> {
        // Shapes of each mesh, with material and radiance; all nodes that use it share them.
        let mut shapes: BTreeMap<usize, Vec<(ShapeId, MaterialId, Option<Rgb>)>> = BTreeMap::new();
        for (&index, primitives) in meshes {
            let parts = shapes.entry(index).or_default();
            for primitive in primitives {
                let surface = &surfaces[&primitive.material];
                for (mesh, radiance) in emission::split(primitive, surface.emitted.as_ref()) {
                    parts.push((ShapeId(self.description.shapes.len() as u32), surface.material, radiance));
                    self.description.shapes.push(Shape::Mesh(mesh));
                }
            }
        }
        for node in placed {
            let Some(parts) = node.node.mesh().and_then(|mesh| shapes.get(&mesh.index())) else { continue };
            let to_world = node.to_world;
            if !(to_world.matrix3.determinant() != 0.0 && to_world.inverse().is_finite()) {
                self.warn(&node.place, "its mesh is scaled to nothing, and left out");
                continue;
            }
            for &(shape, material, radiance) in parts {
                self.description.instances.push(Instance { shape, to_world, material, radiance });
            }
        }
        Ok(())
    }

    pub(super) fn add_light(&mut self, light: Light) {
        self.description.lights.push(light);
    }

    fn finish(self) -> SceneDescription {
        let Self { mut description, source, warnings, .. } = self;
        let stem = source.file.file_stem();
        description.name = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        description.filter = Filter::GAUSSIAN;
        description.source = Some(source.file.to_path_buf());
        description.warnings.extend(warnings.into_lines());
        description
    }
}

/// What a material of the document became.
struct SurfaceOf {
    material: MaterialId,
    emitted: Option<emission::Emission>,
}
