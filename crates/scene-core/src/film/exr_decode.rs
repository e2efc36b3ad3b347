//! OpenEXR in.

use std::io::Cursor;
use std::path::Path;

use exr::block::reader::Reader;
use exr::image::read::image::ReadLayers;
use exr::image::read::layers::ReadChannels;
use exr::image::{AnyChannels, FlatSamples, Image, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use exr::meta::header::Header;

use super::accumulation::check_size;
use super::{Attribute, ImageFileError, LayeredImage};

/// Files whose channels have more values than this altogether are taken for broken ones.
const MAX_VALUES: u64 = 1 << 30;
/// A chunk takes at least this many bytes: its entry in the offset table, its position and its length.
const MIN_CHUNK_BYTES: u64 = 16;

type FlatLayer = Layer<AnyChannels<FlatSamples>>;

impl LayeredImage {
    /// Reads an OpenEXR file.
    ///
    /// Takes other programs' files, too: half, float and unsigned channels, scan lines and tiles (the largest level),
    /// every compression that the `exr` crate knows. A data window that differs from the display window is placed
    /// into the latter; pixels outside are lost, missing ones are zero. Of several parts the first one is read. Text
    /// and numbers among the attributes are kept, other attributes are not.
    ///
    /// # Errors
    /// [`ImageFileError::Io`] if the file cannot be read, [`ImageFileError::Invalid`] if it is truncated, contradicts
    /// itself or claims an absurd size, [`ImageFileError::Unsupported`] for deep data and subsampled channels. All of
    /// them name the file.
    pub fn read_exr(path: &Path) -> Result<Self, ImageFileError> {
        let bytes = std::fs::read(path).map_err(|error| ImageFileError::io(path, error))?;
        Self::decode_exr(&bytes, path)
    }

    /// Reads the contents of an OpenEXR file, see [`read_exr`](Self::read_exr). Errors call it by the given name.
    ///
    /// # Errors
    /// As for reading.
    pub fn decode_exr(bytes: &[u8], name: &Path) -> Result<Self, ImageFileError> {
        let failed = |error| match error {
            exr::error::Error::NotSupported(reason) => ImageFileError::unsupported(name, reason),
            error => ImageFileError::invalid(name, error.to_string()),
        };
        let reader = exr::block::read(Cursor::new(bytes), false).map_err(failed)?;
        check_headers(&reader, bytes.len() as u64, name)?;
        let image: Image<FlatLayer> = exr::image::read::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_chunks(reader)
            .map_err(failed)?;
        convert(image, name)
    }
}

/// Rejects what would take absurd amounts of memory before any of it is allocated.
fn check_headers<R: std::io::Read + std::io::Seek>(
    reader: &Reader<R>,
    file_length: u64,
    name: &Path,
) -> Result<(), ImageFileError> {
    let chunks: u64 = reader.headers().iter().map(|header| header.chunk_count as u64).sum();
    if chunks.saturating_mul(MIN_CHUNK_BYTES) > file_length {
        return Err(ImageFileError::invalid(name, "the file is truncated"));
    }
    reader.headers().iter().try_for_each(|header| check_header(header, name))
}

fn check_header(header: &Header, name: &Path) -> Result<(), ImageFileError> {
    let Vec2(width, height) = header.layer_size;
    let values = (width as u64).saturating_mul(height as u64).saturating_mul(header.channels.list.len() as u64);
    if values == 0 {
        return Err(ImageFileError::invalid(name, "it has no pixels or no channels"));
    }
    if values > MAX_VALUES {
        return Err(ImageFileError::invalid(name, format!("{width}x{height} pixels are too many")));
    }
    if let Some(channel) = header.channels.list.iter().find(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(ImageFileError::unsupported(name, format!("channel '{}' is subsampled", channel.name)));
    }
    Ok(())
}

fn convert(image: Image<FlatLayer>, name: &Path) -> Result<LayeredImage, ImageFileError> {
    let layer = image.layer_data;
    let window = Window::new(layer.attributes.layer_position, layer.size, image.attributes.display_window);
    let invalid = |error: super::LayeredImageError| ImageFileError::invalid(name, error.to_string());
    let mut result = LayeredImage::new(window.size.0 as u32, window.size.1 as u32).map_err(invalid)?;
    for channel in layer.channel_data.list {
        let values = match channel.sample_data {
            FlatSamples::F16(values) => values.into_iter().map(|value| value.to_f32()).collect(),
            FlatSamples::F32(values) => values,
            FlatSamples::U32(values) => values.into_iter().map(|value| value as f32).collect(),
        };
        result.set_channel(&channel.name.to_string(), window.place(values)).map_err(invalid)?;
    }
    for (key, value) in image.attributes.other.iter().chain(&layer.attributes.other) {
        if let Some(value) = attribute(value) {
            result.set_attribute(&key.to_string(), value).map_err(invalid)?;
        }
    }
    Ok(result)
}

fn attribute(value: &AttributeValue) -> Option<Attribute> {
    Some(match value {
        AttributeValue::Text(value) => Attribute::Text(string(value)),
        AttributeValue::F64(value) => Attribute::Number(*value),
        AttributeValue::F32(value) => Attribute::Number(f64::from(*value)),
        AttributeValue::I32(value) => Attribute::Number(f64::from(*value)),
        _ => return None,
    })
}

/// UTF-8 if it is, else one character per byte.
fn string(text: &Text) -> String {
    std::str::from_utf8(text.as_slice()).map_or_else(|_| text.to_string(), str::to_owned)
}

/// How the data window lies in the image that is returned.
struct Window {
    /// Size of the data window.
    data: (usize, usize),
    /// Position of its upper left corner in the returned image.
    offset: (i64, i64),
    /// Size of the returned image.
    size: (usize, usize),
}

impl Window {
    fn new(position: Vec2<i32>, data: Vec2<usize>, display: IntegerBounds) -> Self {
        let (data, shown) = ((data.0, data.1), (display.size.0, display.size.1));
        let offset = (
            i64::from(position.0) - i64::from(display.position.0),
            i64::from(position.1) - i64::from(display.position.1),
        );
        let overlaps = |offset: i64, data: usize, shown: usize| offset < shown as i64 && offset + data as i64 > 0;
        let is_sane = u32::try_from(shown.0).ok().zip(u32::try_from(shown.1).ok()).is_some_and(|(width, height)| {
            check_size(width, height).is_ok_and(|pixels| pixels <= 64 * data.0 * data.1)
        });
        if is_sane && overlaps(offset.0, data.0, shown.0) && overlaps(offset.1, data.1, shown.1) {
            Self { data, offset, size: shown }
        } else {
            // A display window that shows nothing of the data, or next to nothing, is a mistake of whoever wrote it.
            Self { data, offset: (0, 0), size: data }
        }
    }

    fn place(&self, values: Vec<f32>) -> Vec<f32> {
        if self.offset == (0, 0) && self.size == self.data {
            return values;
        }
        let clip = |offset: i64, data: usize, size: usize| {
            (0.max(-offset) as usize)..((size as i64 - offset).clamp(0, data as i64) as usize)
        };
        let columns = clip(self.offset.0, self.data.0, self.size.0);
        let mut placed = vec![0.0; self.size.0 * self.size.1];
        for row in clip(self.offset.1, self.data.1, self.size.1) {
            let source = &values[row * self.data.0..][columns.clone()];
            let start =
                (row as i64 + self.offset.1) as usize * self.size.0 + (columns.start as i64 + self.offset.0) as usize;
            placed[start..start + source.len()].copy_from_slice(source);
        }
        placed
    }
}
