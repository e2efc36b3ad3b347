//! Pixels as text: half floats in base64.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use half::f16;

/// Numbers as little-endian half floats in base64.
///
/// Halves have three digits, from 6e-8 to 65504: numbers beyond are cut off there, since an infinity would be taken for a broken pixel.
/// What is not finite stays so.
pub(super) fn encode(values: &[f32]) -> String {
    let half = |value: f32| {
        let cut = if value.is_finite() { value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()) } else { value };
        f16::from_f32(cut).to_le_bytes()
    };
    STANDARD.encode(values.iter().copied().flat_map(half).collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(text: &str) -> Vec<f32> {
        let bytes = STANDARD.decode(text).unwrap();
        bytes.chunks_exact(2).map(|pair| f16::from_le_bytes([pair[0], pair[1]]).to_f32()).collect()
    }

    #[test]
    fn numbers_return_with_three_digits() {
        let values: Vec<f32> = (-13..16).flat_map(|power| [1.0, -1.37].map(|x: f32| x * 2f32.powi(power))).collect();
        for (found, value) in decode(&encode(&values)).into_iter().zip(&values) {
            assert!((found - value).abs() <= value.abs() / 2048.0, "{value} became {found}");
        }
    }

    #[test]
    fn the_ends_of_the_range_are_kept_apart_from_what_is_broken() {
        let found = decode(&encode(&[0.0, 1e9, -1e9, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e-9]));
        assert_eq!(&found[..5], &[0.0, 65504.0, -65504.0, f32::INFINITY, f32::NEG_INFINITY]);
        assert!(found[5].is_nan() && found[6] == 0.0);
        assert_eq!(encode(&[]), "");
    }
}
