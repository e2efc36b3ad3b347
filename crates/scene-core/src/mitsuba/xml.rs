//! From the XML text to a [`Document`]: includes, parameters and names are resolved here.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use roxmltree::{Node, ParsingOptions};

use super::document::{Child, Document, Object, Property, Tag, Target, Value};
use super::error::{ImportError, Place, Result};
use super::parameters::Parameters;
use super::property::{self, Attributes};
use super::{names, transforms};

/// Deepest nesting of elements and of includes.
const DEEPEST: usize = 64;
/// Longest XML file, in bytes. The tree takes a few times as much.
const LONGEST: u64 = 1 << 30;

/// One file while it is read.
struct Source<'a> {
    path: Arc<Path>,
    /// Byte offsets at which lines start.
    lines: Vec<usize>,
    /// Whether parameter names are those of versions before 2.0.
    is_old: bool,
    /// The files that include this one, and itself.
    chain: &'a [PathBuf],
}

impl Source<'_> {
    fn place(&self, node: Node<'_, '_>) -> Place {
        let line = self.lines.partition_point(|&start| start <= node.range().start);
        Place { file: self.path.clone(), line }
    }
}

/// Reads files into a document.
pub(super) struct Reader {
    pub(super) document: Document,
    pub(super) parameters: Parameters,
    /// Directories in which files are looked for, after that of the file that names them.
    pub(super) directories: Vec<PathBuf>,
}

impl Reader {
    pub(super) fn new(parameters: &[(String, String)], directory: Option<&Path>) -> Self {
        Self {
            document: Document::default(),
            parameters: Parameters::new(parameters),
            directories: directory.map(Path::to_path_buf).into_iter().collect(),
        }
    }

    /// Reads a file and those that it includes.
    pub(super) fn read_file(&mut self, path: &Path, chain: &[PathBuf], place: Option<&Place>) -> Result<()> {
        let error = |source| ImportError::Read { path: path.to_path_buf(), source };
        let canonical = path.canonicalize().map_err(error)?;
        let mut files = chain.to_vec();
        files.push(canonical.clone());
        if let Some(place) = place
            && (chain.contains(&canonical) || files.len() > DEEPEST)
        {
            return Err(ImportError::IncludeCycle { place: place.clone(), chain: files });
        }
        let length = std::fs::metadata(path).map_err(error)?.len();
        if length > LONGEST {
            return Err(error(std::io::Error::other(format!("{length} bytes are too many for a scene description"))));
        }
        let text = std::fs::read_to_string(path).map_err(error)?;
        if chain.is_empty() {
            self.directories.push(path.parent().unwrap_or(Path::new("")).to_path_buf());
        }
        self.read_text(&text, path, &files)
    }

    /// Reads `text` as if it stood in the file `path`.
    pub(super) fn read_text(&mut self, text: &str, path: &Path, chain: &[PathBuf]) -> Result<()> {
        let file: Arc<Path> = path.into();
        let options = ParsingOptions { nodes_limit: 1 << 26, ..ParsingOptions::default() };
        let xml = roxmltree::Document::parse_with_options(text, options).map_err(|error| ImportError::Xml {
            place: Place { file: file.clone(), line: error.pos().row as usize },
            message: error.to_string(),
        })?;
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        let mut source = Source { path: file, lines, is_old: false, chain };
        let root = xml.root_element();
        let version = root.attribute("version").ok_or_else(|| {
            source.place(root).invalid(format!("<{}> has no `version`, so this is no scene", root.tag_name().name()))
        })?;
        source.is_old = is_old(version).ok_or_else(|| {
            source.place(root).invalid(format!("`{version}` is not a version of the form major.minor.patch"))
        })?;
        if root.tag_name().name() == "scene" {
            for node in root.children().filter(Node::is_element) {
                self.read_top_level(node, &source)?;
            }
            Ok(())
        } else {
            self.read_top_level(root, &source)
        }
    }

    fn read_top_level(&mut self, node: Node<'_, '_>, source: &Source<'_>) -> Result<()> {
        let place = source.place(node);
        match node.tag_name().name() {
            "default" | "path" | "alias" | "include" => self.read_directive(node, source),
            name => match Tag::from_name(name) {
                Some(tag) => {
                    let object = self.read_object(node, tag, source, 0)?;
                    self.document.roots.push(object);
                    Ok(())
                }
                None => Err(place.invalid(format!("unexpected element <{name}>"))),
            },
        }
    }

    fn read_directive(&mut self, node: Node<'_, '_>, source: &Source<'_>) -> Result<()> {
        let place = source.place(node);
        let attributes = self.attributes(node, &place)?;
        match node.tag_name().name() {
            "default" => {
                self.parameters.set_default(attributes.required("name")?, attributes.required("value")?.to_owned());
            }
            "path" => {
                let path = attributes.required("value")?;
                let directory = source.path.parent().unwrap_or(Path::new("")).join(path);
                self.directories.push(directory);
            }
            "alias" => {
                let (id, alias) = (attributes.required("id")?, attributes.required("as")?);
                let Some(&object) = self.document.ids.get(id) else {
                    return Err(ImportError::UnresolvedReference { place, id: id.to_owned() });
                };
                self.document.define(alias.to_owned(), object, &place)?;
            }
            _ => {
                let path = find_file(attributes.required("filename")?, &source.path, &self.directories);
                self.read_file(&path, source.chain, Some(&place))?;
            }
        }
        Ok(())
    }

    fn read_object(&mut self, node: Node<'_, '_>, tag: Tag, source: &Source<'_>, depth: usize) -> Result<usize> {
        let place = source.place(node);
        if depth > DEEPEST {
            return Err(place.invalid(format!("elements are nested more than {DEEPEST} deep")));
        }
        let attributes = self.attributes(node, &place)?;
        let mut object = Object::new(tag, attributes.required("type")?.to_owned(), place.clone());
        for child in node.children().filter(Node::is_element) {
            self.read_child(child, &mut object, source, depth)?;
        }
        if source.is_old {
            upgrade_uv(&mut object);
        }
        self.document.objects.push(object);
        let index = self.document.objects.len() - 1;
        if let Some(id) = attributes.get("id") {
            self.document.define(id.to_owned(), index, &place)?;
        }
        Ok(index)
    }

    fn read_child(&mut self, node: Node<'_, '_>, object: &mut Object, source: &Source<'_>, depth: usize) -> Result<()> {
        let place = source.place(node);
        let tag = node.tag_name().name();
        if matches!(tag, "default" | "path" | "alias" | "include") {
            return self.read_directive(node, source);
        }
        let attributes = self.attributes(node, &place)?;
        let mut name = attributes.get("name").unwrap_or_default().to_owned();
        if source.is_old {
            name = names::upgrade(&name, &object.plugin);
        }
        let target = match Tag::from_name(tag) {
            // A spectrum is an object if it has a type, and a value otherwise.
            Some(tag) if tag != Tag::Spectrum || attributes.get("type").is_some() => {
                Target::Object(self.read_object(node, tag, source, depth + 1)?)
            }
            _ if tag == "ref" => Target::Reference(attributes.required("id")?.to_owned()),
            _ if tag == "transform" => {
                let value = self.read_transform(node, source)?;
                return object.add_property(Property::new(name, value, place));
            }
            _ => {
                let value = property::read(&attributes, &source.path, &self.directories)?;
                return object.add_property(Property::new(name, value, place));
            }
        };
        object.add_child(Child::new(name, target, place))
    }

    fn read_transform(&self, node: Node<'_, '_>, source: &Source<'_>) -> Result<Value> {
        let mut result = DAffine3::IDENTITY;
        for step in node.children().filter(Node::is_element) {
            let place = source.place(step);
            let attributes = self.attributes(step, &place)?;
            result = transforms::operation(&attributes).map_err(|message| place.invalid(message))? * result;
        }
        Ok(Value::Transform(result))
    }

    fn attributes(&self, node: Node<'_, '_>, place: &Place) -> Result<Attributes> {
        let substituted =
            |a: roxmltree::Attribute<'_, '_>| Ok((a.name().to_owned(), self.parameters.substitute(a.value(), place)?));
        let values = node.attributes().map(substituted).collect::<Result<_>>()?;
        Ok(Attributes { tag: node.tag_name().name().to_owned(), place: place.clone(), values })
    }
}

/// Whether a version is below 2.0; nothing if it is no version.
fn is_old(version: &str) -> Option<bool> {
    let mut numbers = version.trim().split('.').map(str::parse::<u32>);
    let major = numbers.next()?.ok()?;
    numbers.all(|number| number.is_ok()).then_some(major < 2)
}

/// A file as the scene names it: beside the file that names it, else in the other directories.
pub(super) fn find_file(name: &str, named_in: &Path, directories: &[PathBuf]) -> PathBuf {
    let beside = named_in.parent().unwrap_or(Path::new("")).join(name);
    if beside.exists() {
        return beside;
    }
    directories.iter().map(|directory| directory.join(name)).find(|path| path.exists()).unwrap_or(beside)
}

/// `uscale`, `vscale`, `uoffset`, `voffset` of old files become `to_uv`.
fn upgrade_uv(object: &mut Object) {
    if object.tag != Tag::Texture {
        return;
    }
    let mut number = |name: &str, default: f64| match object.take_property(name).map(|property| property.value) {
        Some(Value::Float(value)) => (true, value),
        Some(Value::Integer(value)) => (true, value as f64),
        _ => (false, default),
    };
    let scale = [number("uscale", 1.0), number("vscale", 1.0)];
    let offset = [number("uoffset", 0.0), number("voffset", 0.0)];
    if scale.iter().chain(&offset).any(|&(given, _)| given) {
        let scale = DVec3::new(scale[0].1, scale[1].1, 1.0);
        let offset = DVec3::new(offset[0].1, offset[1].1, 0.0);
        let transform = DAffine3::from_scale(scale) * DAffine3::from_translation(offset);
        object.replace_property(Property::new("to_uv".into(), Value::Transform(transform), object.place.clone()));
    }
}
