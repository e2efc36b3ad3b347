//! Where buffers and images are: in the JSON as base64, or in files beside it.

use std::path::{Path, PathBuf};

use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use base64::{DecodeError, Engine as _, alphabet};

use super::error::{Place, Result};

/// The bytes that a URI names, and the file that they came from, if any.
pub(super) fn read(uri: &str, directory: &Path, place: &Place) -> Result<(Vec<u8>, Option<PathBuf>)> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (media, payload) =
            data.split_once(',').ok_or_else(|| place.invalid("the data URI has no comma before its data"))?;
        if !media.ends_with(";base64") {
            return Err(place.unsupported(format!("a data URI of `{media}` that is not base64")));
        }
        let bytes = base64(payload).map_err(|error| place.invalid(format!("the data URI: {error}")))?;
        return Ok((bytes, None));
    }
    if uri.contains("://") {
        return Err(place.unsupported(format!("the URI `{uri}`")));
    }
    let path = directory.join(percent_decoded(uri));
    let bytes = std::fs::read(&path).map_err(|error| place.data(&path, error))?;
    Ok((bytes, Some(path)))
}

/// Padding may be missing, and unused bits anything.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::RequireNone)
        .with_decode_allow_trailing_bits(true),
);

/// Bytes of base64 (RFC 4648, section 4), with or without padding.
fn base64(text: &str) -> std::result::Result<Vec<u8>, String> {
    let digits = text.trim_end_matches('=');
    BASE64.decode(digits).map_err(|error| match error {
        DecodeError::InvalidByte(at, digit) => format!("`{}` at {at} is no base64 digit", digit.escape_ascii()),
        _ => format!("{} base64 digits encode no whole number of bytes", digits.len()),
    })
}

/// `%20` and its like; what is no such escape stays.
fn percent_decoded(uri: &str) -> String {
    let hex = |byte: &u8| char::from(*byte).to_digit(16);
    let (bytes, mut decoded) = (uri.as_bytes(), Vec::with_capacity(uri.len()));
    let mut at = 0;
    while at < bytes.len() {
        match (bytes[at], bytes.get(at + 1).and_then(hex), bytes.get(at + 2).and_then(hex)) {
            (b'%', Some(high), Some(low)) => {
                decoded.push((high * 16 + low) as u8);
                at += 3;
            }
            (byte, ..) => {
                decoded.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&decoded).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmE", "fooba")] {
            assert_eq!(base64(text).unwrap(), bytes.as_bytes());
        }
        assert_eq!(base64("+/8=").unwrap(), [0xfb, 0xff]);
        assert!(base64("Zm9-").unwrap_err().contains("`-` at 3"));
        assert!(base64("Zm9vY").is_err());
    }

    #[test]
    fn escapes_of_names_are_undone() {
        assert_eq!(percent_decoded("a%20b%2Fc.bin"), "a b/c.bin");
        assert_eq!(percent_decoded("100%"), "100%");
        assert_eq!(percent_decoded("%zz%C3%BC"), "%zzü");
    }
}
