//! Stanford PLY: ASCII and binary.

use std::io::Cursor;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    BeginList, ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::raw_mesh::{MeshFileError, RawMesh};

/// Reads the elements `vertex` and `face`; others are passed over, and so are unknown properties. Polygons become fans.
///
/// # Errors
/// A malformed header, fewer bytes than it promises, an index that no vertex has.
pub(crate) fn read(bytes: &[u8]) -> Result<RawMesh, MeshFileError> {
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(message)?;
    let mut mesh = RawMesh::default();
    let mut has_faces = false;
    for (_, element) in &header.elements {
        check_length(element, header.encoding, bytes.len() as u64 - reader.get_ref().position())?;
        match element.name.as_str() {
            "vertex" => {
                let vertices = Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header);
                add_vertices(&mut mesh, element, &vertices.map_err(message)?)?;
            }
            "face" => {
                has_faces = true;
                let faces = Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header);
                add_faces(&mut mesh, &faces.map_err(message)?)?;
            }
            _ => drop(
                Parser::<Skipped>::new().read_payload_for_element(&mut reader, element, &header).map_err(message)?,
            ),
        }
    }
    if has_faces { Ok(mesh) } else { Err(MeshFileError::new("there is no element `face`")) }
}

fn message(error: impl ToString) -> MeshFileError {
    // The parser's messages span several lines and quote the input.
    let text = error.to_string();
    let line: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    MeshFileError::new(line.chars().take(300).collect::<String>())
}

/// Rejects headers that promise more elements than the rest of the file can hold, before anything is allocated.
fn check_length(element: &ElementDef, encoding: Encoding, remaining: u64) -> Result<(), MeshFileError> {
    let smallest: u64 = match encoding {
        // A line break.
        Encoding::Ascii => 1,
        _ => element.properties.iter().map(|(_, property)| smallest_size(&property.data_type)).sum(),
    };
    // The last line of an ASCII file may lack its break.
    let enough = (element.count as u64).checked_mul(smallest).is_some_and(|bytes| bytes <= remaining + 1);
    if (smallest == 0 && element.count > 0) || !enough {
        let (name, count) = (&element.name, element.count);
        return Err(MeshFileError::new(format!(
            "the header promises {count} of the element `{name}`, but only {remaining} bytes are left"
        )));
    }
    Ok(())
}

fn smallest_size(data_type: &PropertyType) -> u64 {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = data_type;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

fn add_vertices(mesh: &mut RawMesh, element: &ElementDef, vertices: &[Vertex]) -> Result<(), MeshFileError> {
    let has = |name: &str| element.properties.iter().any(|(key, _)| slot(key) == slot(name));
    if !["x", "y", "z"].iter().all(|name| has(name)) {
        return Err(MeshFileError::new("the vertices have no x, y and z"));
    }
    mesh.positions = vertices.iter().map(|v| [v.0[0], v.0[1], v.0[2]]).collect();
    if ["nx", "ny", "nz"].iter().all(|name| has(name)) {
        mesh.normals = vertices.iter().map(|v| [v.0[3], v.0[4], v.0[5]]).collect();
    }
    if has("u") && has("v") {
        mesh.uvs = vertices.iter().map(|v| [v.0[6], v.0[7]]).collect();
    }
    Ok(())
}

fn add_faces(mesh: &mut RawMesh, faces: &[Face]) -> Result<(), MeshFileError> {
    for (number, Face { indices, invalid }) in faces.iter().enumerate() {
        if let Some(index) = invalid {
            return Err(MeshFileError::new(format!("face {number} refers to vertex {index}")));
        }
        if indices.len() < 3 {
            return Err(MeshFileError::new(format!("face {number} has fewer than three corners")));
        }
        mesh.triangles.extend(indices[1..].windows(2).map(|pair| [indices[0], pair[0], pair[1]]));
    }
    Ok(())
}

/// Where a vertex property goes.
fn slot(name: &str) -> Option<usize> {
    Some(match name {
        "x" => 0,
        "y" => 1,
        "z" => 2,
        "nx" => 3,
        "ny" => 4,
        "nz" => 5,
        "u" | "s" | "texture_u" => 6,
        "v" | "t" | "texture_v" => 7,
        _ => return None,
    })
}

/// Position, normal, texture coordinates.
struct Vertex([f32; 8]);

impl Vertex {
    fn set(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        match slot(name) {
            Some(slot) => {
                self.0[slot] = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::Ignored,
        }
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([0.0; 8])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match property.to_f32_lossy() {
            Some(value) => self.set(name, value),
            None => PropertyAccessResult::Ignored,
        }
    }

    // The usual type, without a detour.
    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set(name, value)
    }
}

/// Indices of a polygon.
struct Face {
    indices: Vec<u32>,
    /// An index that is negative or no integer.
    invalid: Option<String>,
}

fn is_index_list(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self { indices: Vec::new(), invalid: None }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !is_index_list(name) {
            return PropertyAccessResult::Ignored;
        }
        match property.to_u32_list() {
            Some(indices) => self.indices = indices,
            None => self.invalid = Some("that is negative or no integer".into()),
        }
        PropertyAccessResult::Set
    }

    fn set_list_int(&mut self, name: &str, values: Vec<i32>) -> PropertyAccessResult {
        if !is_index_list(name) {
            return PropertyAccessResult::Ignored;
        }
        self.indices.reserve_exact(values.len());
        for value in values {
            match u32::try_from(value) {
                Ok(index) => self.indices.push(index),
                Err(_) => self.invalid = Some(value.to_string()),
            }
        }
        PropertyAccessResult::Set
    }

    fn begin_list_uint(&mut self, name: &str, _: usize) -> BeginList<'_, u32> {
        if is_index_list(name) { BeginList::Fill(&mut self.indices) } else { BeginList::UseSetter }
    }
}

/// An element of no interest.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }

    fn set_property(&mut self, _: &str, _: Property) -> PropertyAccessResult {
        PropertyAccessResult::Ignored
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(format: &str, vertices: &str, faces: &str) -> String {
        format!(
            "ply\nformat {format} 1.0\ncomment test\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
             property float z\nproperty float s\nproperty float t\nproperty uchar red\nelement edge 1\n\
             property int a\nelement face {faces}\nproperty uchar flags\nproperty list uchar int vertex_indices\n\
             end_header\n"
        )
    }

    const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]];

    fn ascii(face: &str) -> String {
        let vertices: String = CORNERS.iter().map(|[x, y, z]| format!("{x} {y} {z} 0.25 0.75 255\n")).collect();
        header("ascii", "4", "1") + &vertices + "7\n" + face
    }

    fn binary(big: bool) -> Vec<u8> {
        let format = if big { "binary_big_endian" } else { "binary_little_endian" };
        let mut bytes = header(format, "4", "1").into_bytes();
        let word = |bits: u32, bytes: &mut Vec<u8>| {
            bytes.extend(if big { bits.to_be_bytes() } else { bits.to_le_bytes() });
        };
        for corner in CORNERS {
            corner.iter().chain(&[0.25, 0.75]).for_each(|x| word(x.to_bits(), &mut bytes));
            bytes.push(255);
        }
        word(7, &mut bytes);
        bytes.extend([0, 4]);
        (0..4).for_each(|i| word(i, &mut bytes));
        bytes
    }

    #[test]
    fn all_encodings_agree() {
        let expected = RawMesh {
            positions: CORNERS.to_vec(),
            uvs: vec![[0.25, 0.75]; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..RawMesh::default()
        };
        assert_eq!(read(ascii("0 4 0 1 2 3\n").as_bytes()).unwrap(), expected);
        assert_eq!(read(&binary(true)).unwrap(), expected);
        assert_eq!(read(&binary(false)).unwrap(), expected);
    }

    #[test]
    fn every_truncation_is_an_error() {
        for bytes in [ascii("0 4 0 1 2 3").into_bytes(), binary(true), binary(false)] {
            for length in 0..bytes.len() {
                assert!(read(&bytes[..length]).is_err(), "{length} of {}", bytes.len());
            }
        }
    }

    #[test]
    fn damaged_bytes_do_not_panic() {
        for bytes in [ascii("0 4 0 1 2 3").into_bytes(), binary(true), binary(false)] {
            for position in 0..bytes.len() {
                for mask in [0xff, 0x01, 0x80] {
                    let mut damaged = bytes.clone();
                    damaged[position] ^= mask;
                    drop(read(&damaged));
                }
            }
        }
    }

    #[test]
    fn absurd_counts_do_not_allocate() {
        for (vertices, faces) in [("4294967295", "1"), ("18446744073709551615", "1"), ("1", "4000000000")] {
            for format in ["ascii", "binary_little_endian"] {
                let error = read(header(format, vertices, faces).as_bytes()).unwrap_err().to_string();
                assert!(error.contains("bytes are left") || error.contains("end of file"), "{error}");
            }
        }
        let empty = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nend_header\n";
        assert!(read(empty.as_bytes()).is_err());
        let list = "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint int vertex_indices\n\
                    end_header\n\u{7f}\u{7f}\u{7f}\u{7f}";
        assert!(read(list.as_bytes()).is_err());
    }

    #[test]
    fn bad_faces_and_headers_are_errors() {
        for face in ["0 2 0 1\n", "0 3 0 1 -1\n", "0 3 0 1 x\n", "0 5 0 1 2 3\n", "0 -3 0 1 2\n"] {
            assert!(read(ascii(face).as_bytes()).is_err(), "{face}");
        }
        for text in
            ["", "ply", "ply\nformat ascii 1.0\nend_header\n", "PK\x03\x04", "ply\nformat ascii 1.0\nelement a b\n"]
        {
            assert!(read(text.as_bytes()).is_err(), "{text}");
        }
    }
}
