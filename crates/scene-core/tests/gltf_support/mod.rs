//! What the tests of the importer share: small assets, put together in memory.
#![allow(dead_code, clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use scene_core::gltf::{self, ImportError};
use scene_core::material::Material;
use scene_core::reference::{SceneDescription, Shape, TriangleMesh};

/// Buffer, views and accessors of an asset.
#[derive(Clone, Default)]
pub(crate) struct Data {
    pub(crate) bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Data {
    /// Adds a view; its index.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length}}}"#));
        self.bytes.extend(bytes);
        self.views.len() - 1
    }

    /// Adds an accessor as JSON, without its braces; its index.
    pub(crate) fn accessor(&mut self, fields: &str) -> usize {
        self.accessors.push(format!("{{{fields}}}"));
        self.accessors.len() - 1
    }

    /// Adds vectors of floats.
    pub(crate) fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let (view, count) = (self.view(&bytes), values.len());
        let bounds = r#""min":[-1,-1,-1],"max":[1,1,1],"#;
        let bounds = if N == 3 { bounds } else { "" };
        self.accessor(&format!(r#"{bounds}"bufferView":{view},"componentType":5126,"count":{count},"type":"VEC{N}""#))
    }

    /// Adds indices of 16 bits.
    pub(crate) fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let (view, count) = (self.view(&bytes), indices.len());
        self.accessor(&format!(r#""bufferView":{view},"componentType":5123,"count":{count},"type":"SCALAR""#))
    }

    /// The JSON with other fields behind these; `uri` is that of the buffer.
    pub(crate) fn json(&self, uri: Option<&str>, rest: &str) -> String {
        let uri = uri.map_or_else(String::new, |uri| format!(r#","uri":"{uri}""#));
        let mut json = r#"{"asset":{"version":"2.0"}"#.to_owned();
        if !self.bytes.is_empty() {
            json += &format!(r#","buffers":[{{"byteLength":{}{uri}}}]"#, self.bytes.len());
            json += &format!(r#","bufferViews":[{}]"#, self.views.join(","));
        }
        if !self.accessors.is_empty() {
            json += &format!(r#","accessors":[{}]"#, self.accessors.join(","));
        }
        let separator = if rest.is_empty() { "" } else { "," };
        json + separator + rest + "}"
    }

    /// A binary container.
    pub(crate) fn glb(&self, rest: &str) -> Vec<u8> {
        container(&self.json(None, rest), &self.bytes)
    }

    pub(crate) fn import(&self, rest: &str) -> Result<SceneDescription, ImportError> {
        gltf::load_slice(&self.glb(rest), Path::new("folder"))
    }

    /// Imports what must be right, and give no warnings but those of the defaults.
    pub(crate) fn load(&self, rest: &str) -> SceneDescription {
        let scene = self.import(rest).unwrap_or_else(|error| panic!("{error}"));
        let unexpected: Vec<_> = scene.warnings.iter().filter(|warning| !warning.contains("there is no ")).collect();
        assert!(unexpected.is_empty(), "{unexpected:?}");
        scene
    }

    /// The message about what must be wrong, without the file's name.
    pub(crate) fn error(&self, rest: &str) -> String {
        let text = self.import(rest).map(|_| ()).unwrap_err().to_string();
        text.strip_prefix("folder/<bytes>: ").map_or(text.clone(), str::to_owned)
    }

    /// All warnings but those of the defaults, without the file's name.
    pub(crate) fn warnings(&self, rest: &str) -> Vec<String> {
        let scene = self.import(rest).unwrap_or_else(|error| panic!("{error}"));
        let lines = scene.warnings.iter().filter(|warning| !warning.contains("there is no "));
        lines.map(|line| line.strip_prefix("folder/<bytes>: ").unwrap().to_owned()).collect()
    }
}

/// A container of JSON and, if there are any, bytes.
pub(crate) fn container(json: &str, bytes: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, content, fill) in [(b"JSON", json.as_bytes(), b' '), (b"BIN\0", bytes, 0)] {
        if content.is_empty() {
            continue;
        }
        let length = content.len().next_multiple_of(4);
        chunks.extend((length as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(content);
        chunks.resize(chunks.len() + length - content.len(), fill);
    }
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((chunks.len() as u32 + 12).to_le_bytes());
    glb.extend(chunks);
    glb
}

pub(crate) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let bits = (0..3).fold(0, |bits, i| bits << 8 | u32::from(chunk.get(i).copied().unwrap_or(0)));
        for i in 0..4 {
            let digit = char::from(DIGITS[(bits >> (18 - 6 * i)) as usize & 63]);
            text.push(if i <= chunk.len() { digit } else { '=' });
        }
    }
    text
}

/// The unit square in the plane z = 0 with normal +z; v points down. Accessors 0 to 3: indices, positions, normals, coordinates.
pub(crate) fn square() -> Data {
    let mut data = Data::default();
    data.indices(&[0, 1, 2, 0, 2, 3]);
    data.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    data.floats(&[[0.0, 0.0, 1.0]; 4]);
    data.floats(&[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
    data
}

/// The primitive of [`square`], with material 0.
pub(crate) const PRIMITIVE: &str =
    r#"{"indices":0,"attributes":{"POSITION":1,"NORMAL":2,"TEXCOORD_0":3},"material":0}"#;

/// A scene of one square with the material of these fields, and more.
pub(crate) fn with_material(material: &str, more: &str) -> String {
    let separator = if more.is_empty() { "" } else { "," };
    format!(
        r#""meshes":[{{"primitives":[{PRIMITIVE}]}}],"nodes":[{{"mesh":0}}],"materials":[{{{material}}}]{separator}{more}"#
    )
}

/// The only material of a square, which must give no warnings.
pub(crate) fn material(fields: &str) -> Material {
    let mut scene = square().load(&with_material(fields, ""));
    assert_eq!(scene.materials.len(), 1);
    scene.materials.remove(0)
}

/// The mesh of a shape.
pub(crate) fn mesh(scene: &SceneDescription, shape: usize) -> &TriangleMesh {
    let Shape::Mesh(mesh) = &scene.shapes[shape] else { panic!("no mesh") };
    mesh
}

/// The downloaded assets, if they are there.
pub(crate) fn assets() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets");
    path.is_dir().then_some(path)
}
