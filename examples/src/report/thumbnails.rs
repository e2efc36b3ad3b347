//! Small copies of pictures for pages that hold many.

use std::io;
use std::path::{Path, PathBuf};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::PngEncoder;
use image::imageops::FilterType;
use image::{ImageEncoder, ImageFormat};

/// A picture in the page.
#[derive(Clone, Debug)]
pub(super) struct Thumbnail {
    /// The file's name without its ending.
    pub(super) name: String,
    /// The picture as an address.
    pub(super) data: String,
    /// Width and height.
    pub(super) size: [u32; 2],
}

/// The PNG files of a folder in alphabetical order; none if there is no such folder.
pub(super) fn pictures_in(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")))
        .collect();
    files.sort();
    files
}

impl Thumbnail {
    /// A copy of a PNG file that is no wider than `width`.
    ///
    /// # Errors
    /// If the file cannot be read or is no PNG.
    pub(super) fn of(path: &Path, width: u32) -> io::Result<Self> {
        let full = image::load_from_memory_with_format(&std::fs::read(path)?, ImageFormat::Png)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        let small = if full.width() > width { full.resize(width, u32::MAX, FilterType::Triangle) } else { full };
        let small = small.into_rgb8();
        let size = [small.width(), small.height()];
        let mut bytes = Vec::new();
        PngEncoder::new(&mut bytes)
            .write_image(&small, size[0], size[1], image::ExtendedColorType::Rgb8)
            .map_err(io::Error::other)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, data: format!("data:image/png;base64,{}", STANDARD.encode(bytes)), size })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_found_and_made_smaller() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        image::RgbImage::from_pixel(900, 600, image::Rgb([9, 8, 7])).save(file("wide.png")).unwrap();
        image::RgbImage::from_pixel(20, 10, image::Rgb([9, 8, 7])).save(file("small.png")).unwrap();
        std::fs::write(file("broken.png"), "no picture").unwrap();
        std::fs::write(file("report.json"), "{}").unwrap();
        let found = pictures_in(folder.path());
        assert_eq!(found, [file("broken.png"), file("small.png"), file("wide.png")]);
        assert!(Thumbnail::of(&found[0], 320).is_err());
        let [small, wide] = [1, 2].map(|index: usize| Thumbnail::of(&found[index], 320).unwrap());
        assert_eq!((small.size, wide.size), ([20, 10], [320, 213]));
        assert_eq!(wide.name, "wide");
        let bytes = STANDARD.decode(wide.data.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let copy = image::load_from_memory(&bytes).unwrap().into_rgb8();
        assert!(copy.pixels().all(|pixel| pixel.0 == [9, 8, 7]));
        assert!(pictures_in(&file("nowhere")).is_empty());
    }
}
