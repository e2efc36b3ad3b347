//! Mitsuba's own mesh format, `serialized`, versions 3 and 4.
//!
//! A file is a sequence of meshes, each a header (`0x041C`, version) and a zlib stream, and ends with a directory: the
//! offset of each mesh (4 bytes in version 3, 8 in version 4) and their number. All numbers are little endian.

use std::io::{ErrorKind, Read};

use flate2::read::ZlibDecoder;

use super::raw_mesh::{MeshFileError, RawMesh};

const MAGIC: u16 = 0x041C;
const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE: u32 = 0x2000;

/// No zlib stream grows by more than this factor.
const LARGEST_RATIO: u64 = 1100;

/// Reads mesh number `shape` of a file.
///
/// # Errors
/// A file that is no such, an index that does not exist, a stream that ends early, counts that the stream cannot hold.
pub(super) fn read(bytes: &[u8], shape: usize) -> Result<RawMesh, MeshFileError> {
    let version = check_magic(bytes)?;
    let stream = &bytes[offset(bytes, shape, version)?..];
    check_magic(stream)?;
    let limit = stream.len() as u64 * LARGEST_RATIO;
    let mut source = Source { stream: ZlibDecoder::new(&stream[4..]), double: false };

    let flags = source.u32()?;
    if version == 4 {
        while source.bytes::<1>()? != [0] {}
    }
    let [vertices, triangles] = [source.u64()?, source.u64()?];
    source.double = flags & DOUBLE != 0;
    let real = if source.double { 8 } else { 4 };
    let smallest = vertices.checked_mul(3 * real).zip(triangles.checked_mul(12)).map(|(a, b)| a.saturating_add(b));
    if smallest.is_none_or(|size| size > limit) || u32::try_from(vertices).is_err() {
        return Err(MeshFileError::new(format!(
            "{vertices} vertices and {triangles} triangles do not fit into {} compressed bytes",
            stream.len()
        )));
    }
    let mut mesh = RawMesh { positions: source.reals(vertices)?, ..RawMesh::default() };
    if flags & HAS_NORMALS != 0 {
        mesh.normals = source.reals(vertices)?;
    }
    if flags & HAS_UVS != 0 {
        mesh.uvs = source.reals(vertices)?;
    }
    if flags & HAS_COLORS != 0 {
        source.reals::<3>(vertices)?;
    }
    for _ in 0..triangles {
        mesh.triangles.push([source.u32()?, source.u32()?, source.u32()?]);
    }
    mesh.face_normals = flags & FACE_NORMALS != 0;
    Ok(mesh)
}

/// The version.
fn check_magic(bytes: &[u8]) -> Result<u16, MeshFileError> {
    match *bytes {
        [a, b, c, d, ..] if u16::from_le_bytes([a, b]) == MAGIC => match u16::from_le_bytes([c, d]) {
            version @ (3 | 4) => Ok(version),
            version => Err(MeshFileError::new(format!("version {version} is neither 3 nor 4"))),
        },
        _ => Err(MeshFileError::new("this is not a serialized mesh")),
    }
}

/// The offset of a mesh, from the directory at the end.
fn offset(bytes: &[u8], shape: usize, version: u16) -> Result<usize, MeshFileError> {
    let truncated = || MeshFileError::new("the directory at the end is damaged");
    let (rest, count) = bytes.split_last_chunk::<4>().ok_or_else(truncated)?;
    let count = u32::from_le_bytes(*count) as usize;
    if shape >= count {
        return Err(MeshFileError::new(format!("there is no shape {shape}, the file has {count}")));
    }
    let size: usize = if version == 4 { 8 } else { 4 };
    let start = size.checked_mul(count - shape).and_then(|n| rest.len().checked_sub(n)).ok_or_else(truncated)?;
    let mut entry = [0; 8];
    entry[..size].copy_from_slice(&rest[start..start + size]);
    usize::try_from(u64::from_le_bytes(entry)).ok().filter(|&offset| offset < bytes.len()).ok_or_else(truncated)
}

/// Numbers from a compressed stream.
struct Source<R> {
    stream: R,
    double: bool,
}

impl<R: Read> Source<R> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], MeshFileError> {
        let mut bytes = [0; N];
        self.stream.read_exact(&mut bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => MeshFileError::new("the data end early"),
            _ => MeshFileError::new(format!("the data are damaged: {error}")),
        })?;
        Ok(bytes)
    }

    fn u32(&mut self) -> Result<u32, MeshFileError> {
        self.bytes().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, MeshFileError> {
        self.bytes().map(u64::from_le_bytes)
    }

    fn reals<const N: usize>(&mut self, count: u64) -> Result<Vec<[f32; N]>, MeshFileError> {
        let mut result = Vec::new();
        for _ in 0..count {
            let mut tuple = [0.0; N];
            for value in &mut tuple {
                *value = if self.double {
                    f64::from_le_bytes(self.bytes()?) as f32
                } else {
                    f32::from_le_bytes(self.bytes()?)
                };
            }
            result.push(tuple);
        }
        Ok(result)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::ZlibEncoder;

    use super::*;

    fn mesh(version: u16, flags: u32, counts: [u64; 2], payload: &[u8]) -> Vec<u8> {
        let mut content = flags.to_le_bytes().to_vec();
        if version == 4 {
            content.extend(b"name\0");
        }
        counts.iter().for_each(|count| content.extend(count.to_le_bytes()));
        content.extend(payload);
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&content).unwrap();
        let mut bytes = [MAGIC.to_le_bytes(), version.to_le_bytes()].concat();
        bytes.extend(encoder.finish().unwrap());
        bytes
    }

    fn file(version: u16, meshes: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = meshes.concat();
        let mut offset = 0u64;
        for mesh in meshes {
            bytes.extend(&offset.to_le_bytes()[..if version == 4 { 8 } else { 4 }]);
            offset += mesh.len() as u64;
        }
        bytes.extend((meshes.len() as u32).to_le_bytes());
        bytes
    }

    fn triangle(double: bool, scale: f64) -> Vec<u8> {
        let reals =
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25].map(|x: f64| x * scale);
        let mut bytes: Vec<u8> = match double {
            true => reals.iter().flat_map(|x| x.to_le_bytes()).collect(),
            false => reals.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect(),
        };
        bytes.extend([0u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
        bytes
    }

    #[test]
    fn both_versions_and_precisions() {
        for version in [3, 4] {
            let meshes = [
                mesh(version, HAS_UVS | 0x1000, [3, 1], &triangle(false, 1.0)),
                mesh(version, HAS_UVS | FACE_NORMALS | DOUBLE, [3, 1], &triangle(true, 2.0)),
            ];
            let bytes = file(version, &meshes);
            let first = read(&bytes, 0).unwrap();
            assert_eq!(
                (first.positions[1], first.uvs[0], first.triangles[0]),
                ([1.0, 0.0, 0.0], [0.5, 0.25], [0, 1, 2])
            );
            let second = read(&bytes, 1).unwrap();
            assert_eq!((second.positions[1], second.face_normals), ([2.0, 0.0, 0.0], true));
            assert_eq!(read(&bytes, 2).unwrap_err().to_string(), "there is no shape 2, the file has 2");
        }
    }

    #[test]
    fn damaged_files_are_errors() {
        let bytes = file(4, &[mesh(4, HAS_UVS | 0x1000, [3, 1], &triangle(false, 1.0))]);
        for length in 0..bytes.len() {
            assert!(read(&bytes[..length], 0).is_err(), "{length}");
        }
        for position in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[position] ^= 0xff;
            drop(read(&damaged, 0));
        }
        let absurd = file(4, &[mesh(4, 0x1000, [1 << 40, 1], &[])]);
        assert!(read(&absurd, 0).unwrap_err().to_string().contains("do not fit"));
        let absurd = file(4, &[mesh(4, 0x1000, [u64::MAX, u64::MAX], &[])]);
        assert!(read(&absurd, 0).is_err());
        let early = file(4, &[mesh(4, 0x1000, [4, 1], &triangle(false, 1.0)[..20])]);
        assert_eq!(read(&early, 0).unwrap_err().to_string(), "the data end early");
    }
}
