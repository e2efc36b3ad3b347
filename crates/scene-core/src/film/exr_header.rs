//! The header of OpenEXR files, in an order.

/// Version and flags follow the magic number.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
const START: usize = 8;

/// Sorts the attributes of a file of one part by their names, as OpenEXR's own library does.
///
/// The crate `exr` keeps them in a hash map, whose order is another one in each run: the same image would have other bytes. Nothing
/// else moves, so that the offsets of the chunks stay right. What is no such file is left as it is.
pub(super) fn sort_attributes(bytes: &mut [u8]) {
    let Some(mut attributes) = attributes(bytes) else { return };
    attributes.sort_by(|one, other| name(one).cmp(name(other)));
    let sorted = attributes.concat();
    bytes[START..START + sorted.len()].copy_from_slice(&sorted);
}

/// Each with its name, type, length and value.
fn attributes(bytes: &[u8]) -> Option<Vec<&[u8]>> {
    let mut rest = bytes.strip_prefix(&MAGIC)?.get(START - MAGIC.len()..)?;
    let mut attributes = Vec::new();
    while *rest.first()? != 0 {
        let length = attribute_length(rest)?;
        let (attribute, behind) = rest.split_at_checked(length)?;
        attributes.push(attribute);
        rest = behind;
    }
    Some(attributes)
}

/// `NAME 0 TYPE 0`, four bytes of length, and so many bytes.
fn attribute_length(bytes: &[u8]) -> Option<usize> {
    let end_of = |from: usize| Some(from + bytes.get(from..)?.iter().position(|&byte| byte == 0)? + 1);
    let value = end_of(end_of(0)?)? + 4;
    let length = bytes.get(value - 4..value)?.first_chunk()?;
    value.checked_add(usize::try_from(i32::from_le_bytes(*length)).ok()?)
}

fn name(attribute: &[u8]) -> &[u8] {
    attribute.split(|&byte| byte == 0).next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::film::LayeredImage;

    fn image() -> LayeredImage {
        let mut image = LayeredImage::new(3, 40).unwrap();
        image.set_rgb(&vec![[0.25, 0.5, 0.75]; 120]).unwrap();
        for (index, name) in ["seed", "scene", "estimator", "sampler", "lights", "heuristic"].into_iter().enumerate() {
            image.set_attribute(name, index as f64).unwrap();
        }
        image
    }

    #[test]
    fn attributes_are_in_one_order_and_the_image_is_the_same() {
        let first = image().encode_exr().unwrap();
        let found: Vec<Vec<u8>> = attributes(&first).unwrap().into_iter().map(|one| name(one).to_vec()).collect();
        assert!(found.is_sorted() && found.len() > 10 && found.contains(&b"channels".to_vec()), "{found:?}");
        assert_eq!(LayeredImage::decode_exr(&first, Path::new("a")).unwrap(), image());
        // In a hash map's order two of these would hardly ever be the same.
        (0..20).for_each(|_| assert!(image().encode_exr().unwrap() == first));
    }

    #[test]
    fn what_is_no_such_file_is_left_alone() {
        let whole = image().encode_exr().unwrap();
        let header = START + attributes(&whole).unwrap().concat().len();
        for length in 0..=header {
            let mut cut = whole[..length].to_vec();
            sort_attributes(&mut cut);
            assert!(cut == whole[..length], "{length}");
        }
        let mut other = b"no image at all".to_vec();
        sort_attributes(&mut other);
        assert_eq!(other, b"no image at all");
        // A length below zero, and one beyond the file.
        for length in [-1i32, i32::MAX] {
            let mut bytes = [&MAGIC[..], &[2, 0, 0, 0], b"name\0type\0", &length.to_le_bytes(), b"1234\0"].concat();
            let before = bytes.clone();
            sort_attributes(&mut bytes);
            assert_eq!(bytes, before);
        }
    }
}
