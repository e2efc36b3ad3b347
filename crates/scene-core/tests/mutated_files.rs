//! Files with some bytes changed, cut off, doubled or put in are scenes and images, or errors; never a panic, never memory without bound.
#![cfg(all(feature = "mitsuba", feature = "image-files"))]
#![allow(clippy::unwrap_used)]

use std::io::Write;
use std::path::Path;

use proptest::prelude::*;
use proptest::sample::Index;
use scene_core::film::LayeredImage;
use scene_core::{ReferenceScene, mitsuba};
use tempfile::TempDir;

/// A scene with every kind of element, and every kind of file beside it.
const SCENE: &str = r#"<scene version="3.0.0">
<default name="spp" value="4"/>
<integrator type="path"><integer name="max_depth" value="5"/></integrator>
<sensor type="thinlens"><float name="fov" value="40"/><float name="aperture_radius" value="0.1"/><float name="focus_distance" value="3"/>
  <transform name="to_world"><lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="6"/><rfilter type="gaussian"/></film>
  <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>
<bsdf type="twosided" id="wall"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="t.png"/></texture></bsdf></bsdf>
<bsdf type="roughdielectric" id="glass"><float name="alpha" value="0.1"/><float name="int_ior" value="1.5"/></bsdf>
<bsdf type="bumpmap" id="bumps"><texture type="checkerboard" name="arbitrary"><rgb name="color0" value="0.1 0.2 0.3"/></texture><bsdf type="roughplastic"/></bsdf>
<shape type="obj"><string name="filename" value="m.obj"/><ref id="wall"/></shape>
<shape type="ply"><string name="filename" value="a.ply"/><ref id="glass"/><transform name="to_world"><scale x="2"/><rotate y="1" angle="30"/></transform></shape>
<shape type="ply"><string name="filename" value="b.ply"/><ref id="bumps"/></shape>
<shape type="serialized"><string name="filename" value="m.serialized"/><integer name="shape_index" value="0"/><ref id="wall"/></shape>
<shape type="sphere"><float name="radius" value="0.5"/><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>
<emitter type="envmap"><string name="filename" value="e.exr"/><float name="scale" value="2"/></emitter>
<emitter type="point"><point name="position" x="0" y="2" z="0"/><rgb name="intensity" value="1 2 3"/></emitter>
</scene>"#;

const OBJ: &str = "# a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf 1//1 3//1 4//1\nf -4 -3 -2 -1\n";

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v\n\
    element face 2\nproperty list uchar uint vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2\n3 0 2 3\n";

fn binary_ply() -> Vec<u8> {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let mut bytes = header.as_bytes().to_vec();
    for value in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(value.to_le_bytes());
    }
    bytes.push(3);
    [0i32, 1, 2].iter().for_each(|index| bytes.extend(index.to_le_bytes()));
    bytes
}

fn serialized() -> Vec<u8> {
    let mut data = Vec::new();
    // Single precision, no normals, no coordinates; an empty name.
    data.extend(0x1000u32.to_le_bytes());
    data.push(0);
    data.extend(3u64.to_le_bytes());
    data.extend(1u64.to_le_bytes());
    for value in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        data.extend(value.to_le_bytes());
    }
    [0u32, 1, 2].iter().for_each(|index| data.extend(index.to_le_bytes()));
    let mut bytes = [0x041c_u16.to_le_bytes(), 4u16.to_le_bytes()].concat();
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(&data).unwrap();
    bytes.extend(encoder.finish().unwrap());
    bytes.extend(0u64.to_le_bytes());
    bytes.extend(1u32.to_le_bytes());
    bytes
}

fn image() -> LayeredImage {
    let mut image = LayeredImage::new(4, 2).unwrap();
    image.set_rgb(&[[0.2, 0.4, 0.8]; 8]).unwrap();
    image
}

fn files() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("scene.xml", SCENE.as_bytes().to_vec()),
        ("m.obj", OBJ.as_bytes().to_vec()),
        ("a.ply", PLY.as_bytes().to_vec()),
        ("b.ply", binary_ply()),
        ("m.serialized", serialized()),
        ("t.png", image().encode_png(0.0).unwrap()),
        ("e.exr", image().encode_exr().unwrap()),
    ]
}

fn write(folder: &Path, files: &[(&str, Vec<u8>)]) {
    files.iter().for_each(|(name, bytes)| std::fs::write(folder.join(name), bytes).unwrap());
}

/// Loads the scene, and builds it if that is possible.
fn load(folder: &Path) -> Result<(), String> {
    let description = mitsuba::load(&folder.join("scene.xml"), &[]).map_err(|error| error.to_string())?;
    ReferenceScene::new(description).map(|_| ()).map_err(|error| error.to_string())
}

/// A change of a file.
#[derive(Clone, Debug)]
enum Change {
    Byte(Index, u8),
    Cut(Index),
    Double(Index, Index),
    Insert(Index, &'static str),
}

fn change() -> impl Strategy<Value = Change> {
    let odd = prop::sample::select(vec![
        "-1",
        "99999999999999999999",
        "nan",
        "1e39",
        "/",
        "<",
        ">",
        "\"",
        "$",
        "\0",
        "\u{fffd}",
        "\n",
        "4294967295",
        " ",
        "id",
    ]);
    prop_oneof![
        4 => (any::<Index>(), any::<u8>()).prop_map(|(at, to)| Change::Byte(at, to)),
        1 => any::<Index>().prop_map(Change::Cut),
        1 => (any::<Index>(), any::<Index>()).prop_map(|(a, b)| Change::Double(a, b)),
        2 => (any::<Index>(), odd).prop_map(|(at, what)| Change::Insert(at, what)),
    ]
}

fn changed(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for change in changes {
        if bytes.is_empty() {
            break;
        }
        match change {
            Change::Byte(at, to) => {
                let at = at.index(bytes.len());
                bytes[at] = *to;
            }
            Change::Cut(at) => bytes.truncate(at.index(bytes.len())),
            Change::Double(a, b) => {
                let (a, b) = (a.index(bytes.len()), b.index(bytes.len()));
                let part = bytes[a.min(b)..a.max(b)].to_vec();
                bytes.splice(b..b, part);
            }
            Change::Insert(at, what) => {
                let at = at.index(bytes.len());
                bytes.splice(at..at, what.bytes());
            }
        }
    }
    bytes
}

#[test]
fn unchanged_it_is_a_scene() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), &files());
    load(folder.path()).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Each file of the scene in turn. An error names a file of the scene.
    #[test]
    fn scenes_with_a_changed_file_do_not_panic(which in any::<Index>(), changes in prop::collection::vec(change(), 1..5)) {
        let folder = TempDir::new().unwrap();
        let mut files = files();
        let which = which.index(files.len());
        files[which].1 = changed(files[which].1.clone(), &changes);
        write(folder.path(), &files);
        if let Err(message) = load(folder.path()) {
            prop_assert!(!message.is_empty());
        }
    }

    /// Images that are read back: for `diff`, `--continue`, `merge`.
    #[test]
    fn changed_images_do_not_panic(changes in prop::collection::vec(change(), 1..5)) {
        let bytes = changed(image().encode_exr().unwrap(), &changes);
        if let Ok(image) = LayeredImage::decode_exr(&bytes, Path::new("a.exr")) {
            prop_assert!(image.pixel_count() < 1 << 28);
        }
    }
}
