//! Reading image files.

use std::path::Path;

use image::{DynamicImage, ImageReader};

use super::{ColorSpace, Image, TextureError};

impl Image {
    /// Reads a PNG, JPEG, Radiance HDR or OpenEXR file; the content decides which, not the name.
    ///
    /// `color_space` applies to files of integers; those of floats (HDR, EXR) are linear. Grey images become RGB. Of
    /// an EXR file it takes the channels `R`, `G`, `B` (or `Y`) and `A` of the first layer that has them.
    ///
    /// # Errors
    /// If the file cannot be read or decoded, with its name and the decoder's reason.
    pub fn open(path: impl AsRef<Path>, color_space: ColorSpace) -> Result<Self, TextureError> {
        let path = path.as_ref();
        let failed = |reason: String| TextureError::File { path: path.to_owned(), reason };
        if is_exr(path).map_err(|e| failed(e.to_string()))? {
            return open_exr(path).map_err(failed)?.map_err(|e| failed(e.to_string()));
        }
        let mut reader = ImageReader::open(path)
            .and_then(|reader| reader.with_guessed_format())
            .map_err(|e| failed(e.to_string()))?;
        reader.no_limits();
        let image = reader.decode().map_err(|e| failed(e.to_string()))?;
        convert(image, color_space).map_err(|e| failed(e.to_string()))
    }

    /// Decodes a PNG, JPEG or Radiance HDR file in memory; the content decides which.
    ///
    /// As [`open`](Self::open), but images that need more than 512 MiB are refused: bytes from elsewhere may lie about their size.
    ///
    /// # Errors
    /// If it cannot be decoded, with the decoder's reason.
    pub fn decode(bytes: &[u8], color_space: ColorSpace) -> Result<Self, TextureError> {
        let failed = |reason: String| TextureError::Encoded { reason };
        let reader = ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
        let image = reader.map_err(|e| failed(e.to_string()))?.decode().map_err(|e| failed(e.to_string()))?;
        convert(image, color_space)
    }
}

fn is_exr(path: &Path) -> std::io::Result<bool> {
    let mut magic = [0; 4];
    let read = std::io::Read::read(&mut std::fs::File::open(path)?, &mut magic)?;
    Ok(read == 4 && magic == [0x76, 0x2f, 0x31, 0x01])
}

fn convert(image: DynamicImage, color_space: ColorSpace) -> Result<Image, TextureError> {
    let (width, height) = (image.width(), image.height());
    let is_float = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let is_short = matches!(
        image,
        DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_)
    );
    if !is_float && !is_short {
        let rgba = image.into_rgba8().pixels().map(|p| p.0).collect();
        return Image::from_rgba8(width, height, rgba, color_space);
    }
    let color_space = if is_float { ColorSpace::Linear } else { color_space };
    let has_alpha = image.color().has_alpha();
    let rgba = image.into_rgba32f();
    let rgb = rgba.pixels().map(|p| [p[0], p[1], p[2]].map(|c| color_space.decode(c))).collect();
    let alpha = if has_alpha { rgba.pixels().map(|p| p[3]).collect() } else { Vec::new() };
    Image::from_rgb_and_alpha(width, height, rgb, alpha)
}

fn open_exr(path: &Path) -> Result<Result<Image, TextureError>, String> {
    let file = exr::prelude::read_all_flat_layers_from_file(path).map_err(|e| e.to_string())?;
    for layer in &file.layer_data {
        let channel = |name: &str| {
            let list = &layer.channel_data.list;
            list.iter().find(|c| c.name.eq_case_insensitive(name)).map(|c| c.sample_data.values_as_f32())
        };
        let colors = match (channel("R"), channel("G"), channel("B"), channel("Y")) {
            (Some(r), Some(g), Some(b), _) => r.zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect(),
            (_, _, _, Some(y)) => y.map(|y| [y; 3]).collect(),
            _ => continue,
        };
        let alpha = channel("A").map(Iterator::collect).unwrap_or_default();
        let (width, height) = (layer.size.width() as u32, layer.size.height() as u32);
        return Ok(Image::from_rgb_and_alpha(width, height, colors, alpha));
    }
    Err("no layer has the channels R, G, B or Y".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_come_back_as_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("grey.png");
        image::GrayImage::from_raw(2, 1, vec![0, 188]).unwrap().save(&path).unwrap();
        let read = Image::open(&path, ColorSpace::Srgb).unwrap();
        assert_eq!((read.width(), read.height()), (2, 1));
        assert!((read.pixel(1, 0)[2] - 0.5029).abs() < 1e-3);
        assert!((Image::open(&path, ColorSpace::Linear).unwrap().pixel(1, 0)[0] - 188.0 / 255.0).abs() < 1e-6);

        let path = folder.path().join("float.exr");
        exr::prelude::write_rgba_file(&path, 3, 2, |x, y| (x as f32, y as f32, 7.5f32, 0.5f32)).unwrap();
        let read = Image::open(&path, ColorSpace::Srgb).unwrap();
        assert_eq!(read.pixel(2, 1).to_array(), [2.0, 1.0, 7.5]);
        assert_eq!(read.alpha(2, 1), 0.5);

        let path = folder.path().join("light.hdr");
        image::Rgb32FImage::from_fn(2, 2, |x, _| image::Rgb([x as f32 * 4.0, 0.5, 0.25])).save(&path).unwrap();
        assert_eq!(Image::open(&path, ColorSpace::Srgb).unwrap().pixel(1, 1).to_array(), [4.0, 0.5, 0.25]);
    }

    #[test]
    fn errors_name_the_file() {
        let missing = Image::open("no/such/file.png", ColorSpace::Srgb).unwrap_err();
        assert!(missing.to_string().contains("no/such/file.png"), "{missing}");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.jpg");
        std::fs::write(&path, b"not an image").unwrap();
        assert!(Image::open(&path, ColorSpace::Srgb).unwrap_err().to_string().contains("broken.jpg"));
    }
}
