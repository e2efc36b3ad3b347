//! From the document to the scene description: what is shared by the conversions of all kinds.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::Document;
use super::error::{ImportError, Place, Result};
use super::object::{Object, Tag};
use super::sensors::Camera;
use super::shapes::{MeshKey, Placed};
use super::xml::find_file;
use crate::material::Material;
use crate::reference::{Instance, Light, MaterialId, SceneDescription, Shape, ShapeId};
use crate::texture::{ColorSpace, Image};

/// State of an import.
pub(super) struct Importer<'d> {
    pub(super) document: &'d Document,
    directories: &'d [PathBuf],
    pub(super) shapes: Vec<Shape>,
    pub(super) instances: Vec<Instance>,
    pub(super) materials: Vec<Material>,
    pub(super) lights: Vec<Light>,
    warnings: Vec<String>,
    /// So that an object that is used twice warns once.
    warned: HashSet<String>,
    pub(super) images: HashMap<(PathBuf, ColorSpace), Arc<Image>>,
    /// Nothing stands for a mesh without usable triangles.
    pub(super) meshes: HashMap<MeshKey, Option<ShapeId>>,
    /// Triangles that were dropped because they have no area.
    pub(super) without_area: usize,
    pub(super) primitives: HashMap<(&'static str, bool), ShapeId>,
    /// Materials by the objects that they come from: bsdf and medium inside. No bsdf is the default.
    pub(super) material_ids: HashMap<(Option<usize>, Option<usize>), MaterialId>,
    /// The bsdfs among them.
    pub(super) used_bsdfs: HashSet<usize>,
    pub(super) groups: HashMap<usize, Arc<[Placed]>>,
}

impl<'d> Importer<'d> {
    pub(super) fn new(document: &'d Document, directories: &'d [PathBuf]) -> Self {
        Self {
            document,
            directories,
            shapes: Vec::new(),
            instances: Vec::new(),
            materials: Vec::new(),
            lights: Vec::new(),
            warnings: Vec::new(),
            warned: HashSet::new(),
            images: HashMap::new(),
            meshes: HashMap::new(),
            without_area: 0,
            primitives: HashMap::new(),
            material_ids: HashMap::new(),
            used_bsdfs: HashSet::new(),
            groups: HashMap::new(),
        }
    }

    pub(super) fn warn(&mut self, message: String) {
        if self.warned.insert(message.clone()) {
            self.warnings.push(message);
        }
    }

    pub(super) fn warn_at(&mut self, place: &Place, message: impl AsRef<str>) {
        self.warn(format!("{place}: {}", message.as_ref()));
    }

    /// Warns of everything in an object that no conversion asked for.
    pub(super) fn warn_unused(&mut self, object: &Object) {
        let kind = format!("{} `{}`", object.tag.name(), object.plugin);
        for (name, place) in object.unused() {
            if name.is_empty() {
                self.warn_at(place, format!("ignored: an object inside the {kind}"));
            } else {
                self.warn_at(place, format!("ignored: unknown parameter `{name}` of the {kind}"));
            }
        }
    }

    pub(super) fn unknown(object: &Object) -> ImportError {
        let (kind, plugin) = (object.tag.name(), object.plugin.clone());
        ImportError::UnknownPlugin { place: object.place.clone(), kind, plugin }
    }

    /// The file that the parameter `filename` names, and where it does.
    pub(super) fn filename(&self, object: &Object) -> Result<(PathBuf, Place)> {
        let name = object.string("filename")?;
        let name = name.ok_or_else(|| object.place.invalid(format!("the {} needs a `filename`", object.tag.name())))?;
        let place = object.property("filename").map_or(&object.place, |property| &property.place).clone();
        Ok((find_file(name, &place.file, self.directories), place))
    }

    /// Converts everything.
    pub(super) fn run(mut self, path: &Path) -> Result<SceneDescription> {
        let (document, mut camera, mut max_depth) = (self.document, None, None);
        for &index in &document.roots {
            let object = &document.objects[index];
            match object.tag {
                Tag::Shape => self.top_level_shape(index)?,
                Tag::Emitter => self.light(object)?,
                Tag::Sensor if camera.is_none() => camera = Some(self.camera(object)?),
                Tag::Sensor => self.warn_at(&object.place, "ignored: all sensors after the first"),
                Tag::Integrator => max_depth = self.max_depth(object)?,
                // Shared objects are converted where they are used, or in the end.
                Tag::Bsdf | Tag::Texture | Tag::Spectrum | Tag::Medium | Tag::Volume | Tag::Phase => {}
                Tag::Film | Tag::Sampler | Tag::Filter => {
                    self.warn_at(&object.place, format!("ignored: a {} outside a sensor", object.tag.name()));
                }
            }
        }
        self.check_unused_objects()?;
        if self.without_area > 0 {
            self.warn(format!("{}: dropped {} triangles without area", path.display(), self.without_area));
        }
        let Some(Camera { description, filter, samples_per_pixel }) = camera else {
            return Err(ImportError::NoSensor { path: path.to_path_buf() });
        };
        Ok(SceneDescription {
            name: scene_name(path),
            shapes: self.shapes,
            instances: self.instances,
            materials: self.materials,
            lights: self.lights,
            camera: description,
            filter,
            max_depth,
            samples_per_pixel,
            warnings: self.warnings,
            source: path.is_file().then(|| path.to_path_buf()),
        })
    }

    /// Objects that nothing refers to must be right, too.
    fn check_unused_objects(&mut self) -> Result<()> {
        let document = self.document;
        for &index in &document.roots {
            let object = &document.objects[index];
            match object.tag {
                Tag::Bsdf if !self.used_bsdfs.contains(&index) => drop(self.bsdf(object, 0)?),
                Tag::Texture | Tag::Spectrum => drop(self.texture_object(object)?),
                _ => {}
            }
        }
        Ok(())
    }

    /// The path length that the integrator, or one inside it, asks for.
    fn max_depth(&mut self, object: &Object) -> Result<Option<u32>> {
        let document = self.document;
        let mut result = None;
        match object.integer("max_depth")? {
            None | Some(-1) => {}
            Some(depth) => {
                let invalid = || object.place.invalid(format!("`max_depth` is {depth}, not -1 or a count"));
                result = Some(u32::try_from(depth).map_err(|_| invalid())?);
            }
        }
        if object.plugin == "path" || object.plugin == "volpath" {
            object.ignore(&["rr_depth"]);
            if object.boolean("hide_emitters")? == Some(true) {
                self.warn_at(&object.place, "ignored: `hide_emitters`");
            }
            self.warn_unused(object);
        } else {
            self.warn_at(&object.place, format!("of the integrator `{}` only `max_depth` is taken", object.plugin));
            object.ignore_all();
        }
        for (_, inner) in document.children(object, &[Tag::Integrator]) {
            let inner = self.max_depth(&document.objects[inner])?;
            result = result.or(inner);
        }
        Ok(result)
    }
}

/// The file's name, or its directory's if it is called `scene` and something.
fn scene_name(path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    match path.parent().and_then(Path::file_name) {
        Some(directory) if stem.starts_with("scene") => directory.to_string_lossy().into_owned(),
        _ => stem,
    }
}
