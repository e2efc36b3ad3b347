//! OpenEXR out.

use std::io::Cursor;
use std::path::Path;

use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::{AttributeValue, Compression, LineOrder, Text};
use exr::meta::header::LayerAttributes;

use super::exr_header::sort_attributes;
use super::{Attribute, ImageFileError, LayeredImage};

impl LayeredImage {
    /// The bytes of an OpenEXR file: a single part of scan lines, 32-bit float channels, ZIP compression (lossless).
    /// Attributes become `string` (UTF-8) and `double` attributes of the same name, in the order of their names: the same image is the
    /// same bytes.
    ///
    /// It is encoded in memory: whoever writes the bytes notices a full disk, and can replace an old file in one step.
    ///
    /// # Errors
    /// [`ImageFileError::Encode`] if there are no channels, or an attribute has a name that OpenEXR reserves
    /// (`compression`, `owner`, ..).
    pub fn encode_exr(&self) -> Result<Vec<u8>, ImageFileError> {
        if self.channels().len() == 0 {
            return Err(ImageFileError::Encode("it has no channels".to_owned()));
        }
        let mut channels = Vec::with_capacity(self.channels().len());
        for (name, values) in self.channels() {
            channels.push(AnyChannel::new(text(name)?, FlatSamples::F32(values.to_vec())));
        }
        let channels = AnyChannels::sort(channels.into_iter().collect());
        let mut attributes = LayerAttributes::default();
        for (name, value) in self.attributes() {
            attributes.other.insert(text(name)?, attribute(value));
        }
        let encoding =
            Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
        let size = (self.width() as usize, self.height() as usize);
        let image = Image::from_layer(Layer::new(size, attributes, encoding, channels));
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).map_err(|error| ImageFileError::Encode(error.to_string()))?;
        let mut bytes = bytes.into_inner();
        sort_attributes(&mut bytes);
        Ok(bytes)
    }

    /// Writes an OpenEXR file, see [`encode_exr`](Self::encode_exr). An existing file is overwritten in place.
    ///
    /// # Errors
    /// As for encoding, and [`ImageFileError::Io`] with the path if it cannot be written.
    pub fn write_exr(&self, path: &Path) -> Result<(), ImageFileError> {
        std::fs::write(path, self.encode_exr()?).map_err(|error| ImageFileError::io(path, error))
    }
}

/// Names have one byte per character.
fn text(name: &str) -> Result<Text, ImageFileError> {
    Text::new_or_none(name).ok_or_else(|| ImageFileError::Encode(format!("the name '{name}' is not in Latin-1")))
}

/// Values are bytes of any encoding; UTF-8 is what other programs expect.
fn attribute(value: &Attribute) -> AttributeValue {
    match value {
        Attribute::Text(value) => AttributeValue::Text(Text::from_slice_unchecked(value.as_bytes())),
        Attribute::Number(value) => AttributeValue::F64(*value),
    }
}
