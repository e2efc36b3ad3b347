//! Wavefront OBJ.
//!
//! Written here rather than taken from a crate, because Mitsuba reads all groups of a file as one mesh, and computes
//! missing normals across them; and because errors should name a line.

use std::collections::HashMap;

use super::raw_mesh::{MeshFileError, RawMesh};

/// Positions, texture coordinates, normals: the indices of a corner, counted from zero.
type Corner = (u32, Option<u32>, Option<u32>);

/// Reads the triangles and polygons of all groups. Materials, lines, points and curves are passed over.
///
/// Corners without texture coordinates get (0, 0), corners without normal a zero normal, where others have some.
///
/// # Errors
/// A line that is no number, an index that no element has.
pub(super) fn read(bytes: &[u8]) -> Result<RawMesh, MeshFileError> {
    let mut reader = Reader::default();
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        reader.line(line).map_err(|message| MeshFileError::at_line(number + 1, message))?;
    }
    Ok(reader.finish())
}

#[derive(Default)]
struct Reader {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    /// The vertex of each combination of indices.
    vertices: HashMap<Corner, u32>,
    mesh: RawMesh,
    has_normals: bool,
    has_uvs: bool,
}

impl Reader {
    fn line(&mut self, line: &[u8]) -> Result<(), String> {
        let line = line.trim_ascii();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(end);
        if !matches!(keyword, b"v" | b"vn" | b"vt" | b"f") {
            return Ok(());
        }
        let rest = std::str::from_utf8(rest).map_err(|_| "not text")?;
        match keyword {
            b"v" => self.positions.push(numbers(rest)?),
            b"vn" => self.normals.push(numbers(rest)?),
            // The second coordinate is optional.
            b"vt" => self.uvs.push(numbers(rest).or_else(|e| numbers(rest).map(|[u]| [u, 0.0]).map_err(|_| e))?),
            _ => self.face(rest)?,
        }
        Ok(())
    }

    /// A polygon, as a fan around its first corner.
    fn face(&mut self, text: &str) -> Result<(), String> {
        let mut corners = text.split_ascii_whitespace();
        let mut next = || corners.next().map(|corner| self.corner(corner)).transpose();
        let incomplete = || format!("the face `{}` has fewer than three corners", text.trim());
        let first = next()?.ok_or_else(incomplete)?;
        let mut previous = next()?.ok_or_else(incomplete)?;
        let mut current = next()?.ok_or_else(incomplete)?;
        let mut triangles = Vec::with_capacity(2);
        loop {
            triangles.push([first, previous, current]);
            match next()? {
                Some(corner) => (previous, current) = (current, corner),
                None => break,
            }
        }
        self.mesh.triangles.append(&mut triangles);
        Ok(())
    }

    /// The vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&mut self, text: &str) -> Result<u32, String> {
        let mut parts = text.split('/');
        let position = parts.next().unwrap_or_default();
        let corner = (
            index(position, self.positions.len(), "vertex")?,
            optional_index(parts.next(), self.uvs.len(), "texture coordinate")?,
            optional_index(parts.next(), self.normals.len(), "normal")?,
        );
        if parts.next().is_some() {
            return Err(format!("`{text}` has more than three indices"));
        }
        if let Some(&vertex) = self.vertices.get(&corner) {
            return Ok(vertex);
        }
        let vertex = u32::try_from(self.mesh.positions.len()).map_err(|_| "more than 2^32 vertices")?;
        let (position, uv, normal) = corner;
        self.mesh.positions.push(self.positions[position as usize]);
        self.mesh.uvs.push(uv.map_or([0.0; 2], |i| self.uvs[i as usize]));
        self.mesh.normals.push(normal.map_or([0.0; 3], |i| self.normals[i as usize]));
        self.has_uvs |= uv.is_some();
        self.has_normals |= normal.is_some();
        self.vertices.insert(corner, vertex);
        Ok(vertex)
    }

    fn finish(mut self) -> RawMesh {
        if !self.has_normals {
            self.mesh.normals = Vec::new();
        }
        if !self.has_uvs {
            self.mesh.uvs = Vec::new();
        }
        self.mesh
    }
}

/// The first `N` numbers. NaN and infinities pass: triangles that use them are dropped and counted later.
fn numbers<const N: usize>(text: &str) -> Result<[f32; N], String> {
    let mut tokens = text.split_ascii_whitespace();
    let mut result = [0.0; N];
    for value in &mut result {
        let token = tokens.next().ok_or_else(|| format!("`{}` has fewer than {N} numbers", text.trim()))?;
        *value = token.parse().map_err(|_| format!("`{token}` is not a number"))?;
    }
    Ok(result)
}

fn optional_index(text: Option<&str>, count: usize, what: &str) -> Result<Option<u32>, String> {
    text.filter(|text| !text.is_empty()).map(|text| index(text, count, what)).transpose()
}

/// From an index counted from one, or from the end if negative, to one counted from zero.
fn index(text: &str, count: usize, what: &str) -> Result<u32, String> {
    let written: i64 = text.parse().map_err(|_| format!("`{text}` is not an index"))?;
    let from_zero = match written {
        1.. => written - 1,
        0 => -1,
        _ => count as i64 + written,
    };
    match u32::try_from(from_zero) {
        Ok(index) if (index as usize) < count => Ok(index),
        _ => Err(format!("{what} {written} does not exist, there are {count}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn error(faces: &str) -> String {
        read(format!("{SQUARE}{faces}").as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn polygons_become_fans_and_corners_are_merged_across_groups() {
        let mesh = read(format!("# caf\u{e9}\r\n{SQUARE}g a\nf 1 2 3 4\ng b\nf -4 -3 -2\r\n").as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        assert_eq!((mesh.positions.len(), mesh.normals.len(), mesh.uvs.len()), (4, 0, 0));
    }

    #[test]
    fn corners_split_where_attributes_differ() {
        let text = format!("{SQUARE}vt 0.25 0.75\nvt 1\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/2/1 3//1 4\n");
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!(mesh.positions.len(), 6);
        assert_eq!(mesh.uvs[..4], [[0.25, 0.75], [0.25, 0.75], [0.25, 0.75], [1.0, 0.0]]);
        assert_eq!(mesh.normals[5], [0.0; 3]);
    }

    #[test]
    fn bad_input_is_named_by_line() {
        assert_eq!(error("f 1 2 9"), "line 5: vertex 9 does not exist, there are 4");
        assert_eq!(error("f 1 2 -5"), "line 5: vertex -5 does not exist, there are 4");
        assert_eq!(error("f 0 1 2"), "line 5: vertex 0 does not exist, there are 4");
        assert_eq!(error("f 1/1 2/1 3/1"), "line 5: texture coordinate 1 does not exist, there are 0");
        assert_eq!(error("\nv 1 2"), "line 6: `1 2` has fewer than 3 numbers");
        assert_eq!(error("v 1 2 x"), "line 5: `x` is not a number");
        for bad in ["f 1 2", "f", "f a b c", "f 1/2/3/4 2 3", "f 99999999999999999999 1 2", "f 1//1 2//1 3//1", "vt"] {
            assert!(error(bad).starts_with("line 5: "), "{bad}");
        }
        assert!(read(b"v 0 0 \xff0").unwrap_err().to_string().contains("not text"));
    }
}
