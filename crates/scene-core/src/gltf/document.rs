//! From bytes to the validated document: the binary container, JSON, versions and extensions.

use std::path::Path;
use std::sync::Arc;

use ::gltf::Document;
use ::gltf::json;
use ::gltf::json::validation::{Error as Invalid, Validate};

use super::error::{ImportError, Place, Result};

/// Extensions whose meaning is known here.
const KNOWN_EXTENSIONS: [&str; 8] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BINARY_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");

/// A document whose indices are all within range, and the binary chunk of its container.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) document: Document,
    pub(super) binary: Option<Vec<u8>>,
    pub(super) file: Arc<Path>,
}

impl Source {
    /// Reads a `.glb`, which starts with a magic number, or the JSON of a `.gltf`.
    pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Self> {
        let file: Arc<Path> = path.into();
        let format = |message: String| ImportError::Format { path: path.to_path_buf(), message };
        let (text, binary) = if bytes.starts_with(MAGIC) { container(bytes).map_err(format)? } else { (bytes, None) };
        let value: json::Value =
            json::deserialize::from_slice(text).map_err(|error| format(format!("the JSON is broken: {error}")))?;
        let version = value.pointer("/asset/version").and_then(json::Value::as_str);
        match version {
            Some(version) if version == "2" || version.starts_with("2.") => {}
            Some(version) => return Err(format(format!("glTF of version `{version}` cannot be read, only 2.0"))),
            None => return Err(format("no glTF: there is no asset.version".to_owned())),
        }
        let required = value.get("extensionsRequired").and_then(json::Value::as_array).into_iter().flatten();
        if let Some(name) = required.filter_map(json::Value::as_str).find(|name| !KNOWN_EXTENSIONS.contains(name)) {
            return Err(ImportError::RequiredExtension { path: path.to_path_buf(), name: name.to_owned() });
        }
        let root: json::Root = json::deserialize::from_slice(text).map_err(|error| format(error.to_string()))?;
        validate(&root, &file)?;
        let document = Document::from_json_without_validation(root);
        Ok(Self { document, binary: binary.map(<[u8]>::to_vec), file })
    }

    /// Extensions that the asset uses and that mean nothing here.
    pub(super) fn unknown_extensions(&self) -> impl Iterator<Item = &str> {
        self.document.extensions_used().filter(|name| !KNOWN_EXTENSIONS.contains(name))
    }

    /// An element of one of the document's lists.
    pub(super) fn place(&self, list: &str, index: usize, name: Option<&str>) -> Place {
        Place::new(&self.file, list, index, name)
    }
}

/// Checks that all indices are within range and all that is required is there. The error is the first of what is not so.
fn validate(root: &json::Root, file: &Arc<Path>) -> Result<()> {
    let invalid = |element: String, message: String| {
        Err(ImportError::Invalid { place: Place { file: file.clone(), element }, message })
    };
    // The crate's validation takes these for granted.
    for (mesh, i) in root.meshes.iter().zip(0..) {
        for (primitive, j) in mesh.primitives.iter().zip(0..) {
            if primitive.attributes.values().any(|accessor| accessor.value() >= root.accessors.len()) {
                let element = format!("meshes[{i}].primitives[{j}].attributes");
                return invalid(element, INDEX_OUT_OF_BOUNDS.to_owned());
            }
        }
    }
    let mut errors: Vec<(json::Path, Invalid)> = Vec::new();
    root.validate(root, json::Path::new, &mut |path, error| errors.push((path(), error)));
    errors.retain(|(path, error)| !is_allowed(path.as_str(), *error));
    let Some((path, error)) = errors.first() else { return Ok(()) };
    let message = error.to_string().to_lowercase();
    let more = errors.len() - 1;
    let message = if more > 0 { format!("{message} (and {more} more errors)") } else { message };
    invalid(path.as_str().to_owned(), message)
}

const INDEX_OUT_OF_BOUNDS: &str = "index out of bounds";

/// What the crate's validation is stricter about than the specification, or checks by a list of its own: accessors without a view are
/// zero (section 3.6.2.1), and required extensions have been checked.
fn is_allowed(element: &str, error: Invalid) -> bool {
    let is_zero = element.starts_with("accessors[") && element.ends_with("].bufferView") && error == Invalid::Missing;
    is_zero || element.starts_with("extensionsRequired")
}

/// JSON and binary chunk of a container of version 2: a header of magic number, version and length, then chunks of length, type and bytes.
fn container(bytes: &[u8]) -> std::result::Result<(&[u8], Option<&[u8]>), String> {
    let number = |at: usize| -> std::result::Result<u32, String> {
        let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
        four.map(u32::from_le_bytes).ok_or_else(|| format!("the container ends after {} bytes", bytes.len()))
    };
    let version = number(4)?;
    if version != 2 {
        return Err(format!("a container of version {version} cannot be read, only 2"));
    }
    let length = number(8)? as usize;
    if length > bytes.len() {
        return Err(format!("the container promises {length} bytes and has {}", bytes.len()));
    }
    let (mut at, mut text, mut binary) = (12, None, None);
    while at < length {
        let (size, kind) = (number(at)? as usize, number(at + 4)?);
        let Some(chunk) = bytes[..length].get(at + 8..at + 8 + size) else {
            return Err(format!("a chunk of {size} bytes at byte {at} exceeds the container of {length}"));
        };
        match kind {
            JSON_CHUNK if text.is_none() => text = Some(chunk),
            BINARY_CHUNK if binary.is_none() => binary = Some(chunk),
            // The specification asks to ignore unknown chunks.
            _ => {}
        }
        // Chunks start at multiples of four.
        at += 8 + size.next_multiple_of(4);
    }
    Ok((text.ok_or("the container has no JSON")?, binary))
}
