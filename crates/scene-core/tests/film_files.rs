//! Image files: round trips, other programs' files, and broken ones.
#![cfg(feature = "image-files")]

use std::io::Cursor;
use std::path::Path;

use exr::prelude::*;
use scene_core::film::{Attribute, Film, ImageFileError, LayeredImage};

fn gradient(width: u32, height: u32) -> LayeredImage {
    let mut film = Film::new(width, height).unwrap();
    for mut tile in film.tiles_mut(5) {
        for ([x, y], pixel) in tile.pixels_mut() {
            let (x, y) = (x as f32 / width as f32, y as f32 / height as f32);
            pixel.add([x, y, x * y]);
            pixel.add([x + 0.1, y * y, 1e-4]);
            pixel.add_aov([x, 0.5, y], [0.0, x, y], 1.0 + x);
        }
    }
    let mut image = film.develop(0);
    image.set_attribute("estimator", "path").unwrap();
    image.set_attribute("scene", "cornell-böx 世界").unwrap();
    image.set_attribute("seed", u64::MAX).unwrap();
    image.set_attribute("spp", 2u32).unwrap();
    image.set_attribute("seconds", 0.1).unwrap();
    image
}

/// Writes an image as another program might.
fn foreign(channels: Vec<AnyChannel<FlatSamples>>, size: (usize, usize), encoding: Encoding) -> Vec<u8> {
    foreign_at(channels, size, encoding, (0, 0), IntegerBounds::from_dimensions(size))
}

fn foreign_at(
    channels: Vec<AnyChannel<FlatSamples>>,
    size: (usize, usize),
    encoding: Encoding,
    position: (i32, i32),
    display: IntegerBounds,
) -> Vec<u8> {
    let attributes = LayerAttributes::default().with_position(Vec2(position.0, position.1));
    let layer = Layer::new(size, attributes, encoding, AnyChannels::sort(channels.into_iter().collect()));
    let image = Image::new(ImageAttributes::new(display), layer);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn decode(bytes: &[u8]) -> std::result::Result<LayeredImage, ImageFileError> {
    LayeredImage::decode_exr(bytes, Path::new("some.exr"))
}

#[test]
fn exr_round_trip_is_exact() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.exr");
    for (width, height) in [(1, 1), (17, 33), (64, 48)] {
        let image = gradient(width, height);
        image.write_exr(&path).unwrap();
        let back = LayeredImage::read_exr(&path).unwrap();
        assert_eq!(back, image);
        assert_eq!(back.attribute("seed").and_then(Attribute::as_u64), Some(u64::MAX));
    }
}

#[test]
fn values_that_are_not_finite_survive() {
    let mut image = LayeredImage::new(4, 1).unwrap();
    image.set_channel("Y", vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0]).unwrap();
    let back = decode(&image.encode_exr().unwrap()).unwrap();
    let bits = |image: &LayeredImage| image.channel("Y").unwrap().iter().map(|y| y.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&back), bits(&image));
}

#[test]
fn reads_half_float_and_unsigned_scan_lines_and_tiles() {
    let (width, height) = (37, 21);
    let count = width * height;
    let channels = || {
        vec![
            AnyChannel::new("R", FlatSamples::F16((0..count).map(|i| f16::from_f32(i as f32)).collect())),
            AnyChannel::new("G", FlatSamples::F32((0..count).map(|i| i as f32 * 0.5).collect())),
            AnyChannel::new("B", FlatSamples::U32((0..count).map(|i| i as u32 * 2).collect())),
            AnyChannel::new("A", FlatSamples::F16(vec![f16::ONE; count])),
        ]
    };
    use Compression::{PIZ, RLE, Uncompressed, ZIP1, ZIP16};
    for compression in [Uncompressed, RLE, ZIP1, ZIP16, PIZ] {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 8)), Blocks::Tiles(Vec2(64, 64))] {
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            let image = decode(&foreign(channels(), (width, height), encoding)).unwrap();
            for (i, pixel) in image.rgb().unwrap().into_iter().enumerate() {
                assert_eq!(pixel, [i as f32, i as f32 * 0.5, i as f32 * 2.0], "{compression:?}, {blocks:?}");
            }
            assert_eq!(image.channels().count(), 4);
        }
    }
}

#[test]
fn reads_grey_images() {
    let channels = vec![AnyChannel::new("Y", FlatSamples::F16(vec![f16::from_f32(0.25); 4]))];
    let image = decode(&foreign(channels, (2, 2), Encoding::FAST_LOSSLESS)).unwrap();
    assert_eq!(image.rgb().unwrap(), [[0.25; 3]; 4]);
}

#[test]
fn places_the_data_window_into_the_display_window() {
    let values: Vec<f32> = (1..=6).map(|i| i as f32).collect(); // 1 2 3 / 4 5 6
    let read = |position, corner: (i32, i32), size: (usize, usize)| {
        let channels = vec![AnyChannel::new("Y", FlatSamples::F32(values.clone()))];
        let display = IntegerBounds::new(Vec2(corner.0, corner.1), Vec2(size.0, size.1));
        let image = decode(&foreign_at(channels, (3, 2), Encoding::UNCOMPRESSED, position, display)).unwrap();
        (image.width(), image.height(), image.channel("Y").unwrap().to_vec())
    };
    let all = (3, 2, values.clone());
    assert_eq!(read((0, 0), (0, 0), (3, 2)), all);
    assert_eq!(read((-7, 9), (-7, 9), (3, 2)), all);
    assert_eq!(read((1, 1), (0, 0), (4, 3)), (4, 3, vec![0., 0., 0., 0., 0., 1., 2., 3., 0., 4., 5., 6.]));
    assert_eq!(read((-1, -1), (0, 0), (2, 2)), (2, 2, vec![5., 6., 0., 0.]), "what lies outside is lost");
    assert_eq!(read((10, 10), (0, 0), (2, 2)), all, "a display window that misses the data is ignored");
    assert_eq!(read((0, 0), (0, 0), (100_000, 100_000)), all, "so is an absurd one");
}

#[test]
fn truncated_files_are_errors() {
    let bytes = gradient(23, 40).encode_exr().unwrap();
    for length in (0..bytes.len() - 1).step_by(7).chain(bytes.len() - 9..bytes.len() - 1) {
        let error = decode(&bytes[..length]).expect_err(&format!("{length} of {} bytes", bytes.len()));
        assert!(error.to_string().starts_with("some.exr: "), "{error}");
    }
}

#[test]
fn corrupted_files_never_panic() {
    let tiled = foreign(
        vec![AnyChannel::new("Y", FlatSamples::F16(vec![f16::ONE; 35 * 7]))],
        (35, 7),
        Encoding {
            compression: Compression::PIZ,
            blocks: Blocks::Tiles(Vec2(8, 8)),
            line_order: LineOrder::Increasing,
        },
    );
    for original in [gradient(9, 7).encode_exr().unwrap(), tiled] {
        for position in 0..original.len() {
            for value in [0x00, 0x01, 0x7f, 0x80, 0xff] {
                let mut bytes = original.clone();
                bytes[position] = value;
                if let Ok(image) = decode(&bytes) {
                    assert!(image.pixel_count() > 0);
                }
            }
        }
    }
}

#[test]
fn garbage_and_missing_files_are_errors_that_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.exr");
    let error = LayeredImage::read_exr(&missing).unwrap_err();
    assert!(matches!(error, ImageFileError::Io { .. }) && error.to_string().contains("missing.exr"), "{error}");
    assert!(LayeredImage::read_exr(folder.path()).is_err(), "a directory");
    for garbage in [&b""[..], b"P6 1 1 255", &[0; 4096], &[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]] {
        assert!(matches!(decode(garbage), Err(ImageFileError::Invalid { .. } | ImageFileError::Unsupported { .. })));
    }
}

#[test]
fn absurd_sizes_are_rejected_before_memory_is_allocated() {
    let image = foreign(vec![AnyChannel::new("Y", FlatSamples::F32(vec![1.0]))], (1, 1), Encoding::UNCOMPRESSED);
    let name = b"dataWindow\0box2i\0";
    let window = image.windows(name.len()).position(|bytes| bytes == name).unwrap() + name.len() + 4;
    for (right, bottom) in [(i32::MAX / 2 - 2, 0), (1 << 29, 1 << 29), (0, 1 << 29), (40_000, 40_000)] {
        let mut bytes = image.clone();
        bytes[window + 8..window + 12].copy_from_slice(&i32::to_le_bytes(right));
        bytes[window + 12..window + 16].copy_from_slice(&i32::to_le_bytes(bottom));
        assert!(decode(&bytes).is_err(), "{right}x{bottom}");
    }
}

#[test]
fn images_that_cannot_be_encoded_are_errors() {
    assert!(LayeredImage::new(2, 2).unwrap().encode_exr().is_err(), "no channels");
    let mut image = gradient(2, 2);
    image.set_attribute("compression", "zip").unwrap();
    let error = image.encode_exr().unwrap_err();
    assert!(error.to_string().contains("compression"), "{error}");
    let error = gradient(1, 1).write_exr(Path::new("/nonexistent/image.exr")).unwrap_err();
    assert!(error.to_string().contains("/nonexistent/image.exr"), "{error}");
}

#[test]
fn png_is_srgb_with_exposure() {
    let mut image = LayeredImage::new(2, 2).unwrap();
    let nonfinite = [f32::NAN, -1.0, f32::INFINITY];
    image.set_rgb(&[[0.0, 0.25, 1.0], nonfinite, [0.214_041, 2.0, 1e-9], [0.5; 3]]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.png");
    image.write_png(&path, 0.0).unwrap();
    let read = image::open(&path).unwrap().into_rgb8();
    assert_eq!((read.width(), read.height()), (2, 2));
    assert_eq!(read.get_pixel(0, 0).0, [0, 137, 255]);
    assert_eq!(read.get_pixel(1, 0).0, [0, 0, 255]);
    assert_eq!(read.get_pixel(0, 1).0, [128, 255, 0]);
    image.write_png(&path, 1.0).unwrap();
    let brighter = image::open(&path).unwrap().into_rgb8();
    assert_eq!(brighter.get_pixel(1, 1).0, [255; 3]);
    assert!(LayeredImage::new(1, 1).unwrap().encode_png(0.0).is_err());
}

#[test]
fn reads_the_references_of_another_renderer() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets");
    let mut found = 0;
    for entry in std::fs::read_dir(&assets).into_iter().flatten().flatten() {
        let path = entry.path().join("TungstenRender.exr");
        if path.exists() {
            let image = LayeredImage::read_exr(&path).unwrap();
            let rgb = image.rgb().unwrap();
            let mean = rgb.iter().flatten().map(|&value| f64::from(value)).sum::<f64>() / (3 * rgb.len()) as f64;
            assert!(rgb.iter().flatten().all(|value| value.is_finite()) && mean > 0.0, "{}", path.display());
            println!("{}: {}x{}, mean {mean}", path.display(), image.width(), image.height());
            found += 1;
        }
    }
    if found == 0 {
        println!("skipped: no references under {}", assets.display());
    }
}
