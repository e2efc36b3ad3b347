//! Numbers, vectors and colours in attribute values.

/// The parts of a list separated by commas, white space or both.
pub(super) fn tokens(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|token| !token.is_empty())
}

/// A finite number.
pub(super) fn float(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a finite number")),
    }
}

pub(super) fn integer(text: &str) -> Result<i64, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is not an integer"))
}

pub(super) fn boolean(text: &str) -> Result<bool, String> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(format!("`{text}` is neither true nor false")),
    }
}

/// Numbers, at most `limit` of them.
pub(super) fn floats(text: &str, limit: usize) -> Result<Vec<f64>, String> {
    let values = tokens(text).take(limit + 1).map(float).collect::<Result<Vec<_>, _>>()?;
    if values.len() > limit {
        return Err(format!("more than {limit} numbers"));
    }
    Ok(values)
}

/// Three numbers, or one that stands for all three.
pub(super) fn triple(text: &str) -> Result<[f64; 3], String> {
    match floats(text, 3)?[..] {
        [value] => Ok([value; 3]),
        [x, y, z] => Ok([x, y, z]),
        _ => Err(format!("`{text}` is not one or three numbers")),
    }
}

/// Linear RGB: one or three linear numbers, or an sRGB coded `#rrggbb`.
pub(super) fn rgb(text: &str) -> Result<[f32; 3], String> {
    match text.trim().strip_prefix('#') {
        Some(digits) => hex(digits),
        None => Ok(triple(text)?.map(|value| value as f32)),
    }
}

/// Linear RGB of sRGB coded numbers in `[0, 1]`, or of `#rrggbb`.
pub(super) fn srgb(text: &str) -> Result<[f32; 3], String> {
    match text.trim().strip_prefix('#') {
        Some(digits) => hex(digits),
        None => Ok(triple(text)?.map(srgb_to_linear)),
    }
}

fn hex(digits: &str) -> Result<[f32; 3], String> {
    let invalid = || format!("`#{digits}` is not a colour of the form #rrggbb");
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return Err(invalid());
    }
    let packed = u32::from_str_radix(digits, 16).map_err(|_| invalid())?;
    Ok([16, 8, 0].map(|shift| srgb_to_linear(f64::from((packed >> shift) & 255) / 255.0)))
}

fn srgb_to_linear(value: f64) -> f32 {
    let linear = if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) };
    linear as f32
}

/// Pairs `wavelength:value`, in nanometres and ascending.
pub(super) fn spectrum(text: &str) -> Result<Vec<(f64, f64)>, String> {
    let pairs = tokens(text)
        .map(|token| {
            let (wavelength, value) =
                token.split_once(':').ok_or_else(|| format!("`{token}` is not of the form wavelength:value"))?;
            Ok((float(wavelength)?, float(value)?))
        })
        .collect::<Result<Vec<_>, String>>()?;
    ascending(pairs)
}

/// Checks that wavelengths ascend and that there are at least two.
pub(super) fn ascending(pairs: Vec<(f64, f64)>) -> Result<Vec<(f64, f64)>, String> {
    if pairs.len() < 2 {
        return Err("a spectrum needs at least two wavelengths".into());
    }
    match pairs.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
        Some(pair) => Err(format!("the wavelengths {} and {} do not ascend", pair[0].0, pair[1].0)),
        None => Ok(pairs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        assert_eq!(float(" -1.5e-008 "), Ok(-1.5e-8));
        for bad in ["", "1x", "nan", "inf", "1e999", "1 2"] {
            assert!(float(bad).is_err(), "{bad}");
        }
        assert_eq!(boolean("TRUE"), Ok(true));
        assert!(boolean("1").is_err());
        assert_eq!(triple("1, 2 3"), Ok([1.0, 2.0, 3.0]));
        assert_eq!(triple("2"), Ok([2.0; 3]));
        assert!(triple("1 2").is_err() && triple("").is_err() && triple("1 2 3 4").is_err());
    }

    #[test]
    fn colours() {
        assert_eq!(rgb("0.5"), Ok([0.5; 3]));
        let [r, g, b] = rgb("#ff8000").unwrap();
        assert!((r - 1.0).abs() < 1e-6 && (g - 0.215_86).abs() < 1e-5 && b == 0.0);
        assert!((srgb("0.5").unwrap()[1] - 0.214_041).abs() < 1e-6);
        for bad in ["#ff80", "#ff80zz", "#+f8000", "ff8000", "#\u{e9}\u{e9}\u{e9}"] {
            assert!(rgb(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn spectra_ascend() {
        assert_eq!(spectrum("400:0.1, 700:2"), Ok(vec![(400.0, 0.1), (700.0, 2.0)]));
        for bad in ["400", "400:1", "500:1 400:1", "400:1 400:1", "400:a 500:1"] {
            assert!(spectrum(bad).is_err(), "{bad}");
        }
    }
}
