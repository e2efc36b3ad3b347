//! Values of properties, from their elements.

use std::path::{Path, PathBuf};

use super::document::Value;
use super::error::{Place, Result};
use super::values;
use super::xml::find_file;

/// The attributes of an element, with parameters substituted.
pub(super) struct Attributes {
    pub(super) tag: String,
    pub(super) place: Place,
    pub(super) values: Vec<(String, String)>,
}

impl Attributes {
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.values.iter().find(|(other, _)| other == name).map(|(_, value)| value.as_str())
    }

    pub(super) fn required(&self, name: &str) -> Result<&str> {
        self.get(name).ok_or_else(|| self.place.invalid(format!("<{}> needs the attribute `{name}`", self.tag)))
    }

    /// `value="x y z"`, or `x`, `y` and `z` that default to `default`.
    pub(super) fn vector(&self, default: f64) -> std::result::Result<[f64; 3], String> {
        if let Some(text) = self.get("value") {
            return values::triple(text);
        }
        let component = |name| self.get(name).map_or(Ok(default), values::float);
        Ok([component("x")?, component("y")?, component("z")?])
    }
}

/// The value of an element that is neither an object nor a transform. `named_in` is the file it stands in.
pub(super) fn read(attributes: &Attributes, named_in: &Path, directories: &[PathBuf]) -> Result<Value> {
    let text = || attributes.required("value");
    let value = match attributes.tag.as_str() {
        "float" => values::float(text()?).map(Value::Float),
        "integer" => values::integer(text()?).map(Value::Integer),
        "boolean" => values::boolean(text()?).map(Value::Boolean),
        "string" => Ok(Value::String(text()?.to_owned())),
        "rgb" => values::rgb(text()?).map(Value::Rgb),
        "srgb" => values::srgb(text()?).map(Value::Rgb),
        "vector" | "point" => attributes.vector(0.0).map(Value::Vector),
        "spectrum" => match (attributes.get("filename"), attributes.get("value")) {
            (Some(name), _) => {
                let path = find_file(name, named_in, directories);
                return read_spectrum(&path, &attributes.place).map(Value::Spectrum);
            }
            (None, Some(text)) if text.contains(':') => values::spectrum(text).map(Value::Spectrum),
            (None, _) => values::float(text()?).map(Value::Uniform),
        },
        other => Err(format!("unexpected element <{other}>")),
    };
    value.map_err(|message| attributes.place.invalid(message))
}

/// A file of lines `wavelength value`, with comments from `#`.
fn read_spectrum(path: &Path, place: &Place) -> Result<Vec<(f64, f64)>> {
    let text = std::fs::read_to_string(path).map_err(|error| place.data(path, error.to_string()))?;
    let pairs = text
        .lines()
        .map(|line| line.split('#').next().unwrap_or_default())
        .filter(|line| !line.trim().is_empty())
        .map(|line| match values::floats(line, 2)?[..] {
            [wavelength, value] => Ok((wavelength, value)),
            _ => Err(format!("`{line}` is not a wavelength and a value")),
        })
        .collect::<std::result::Result<Vec<_>, String>>();
    pairs.and_then(values::ascending).map_err(|message| place.data(path, message))
}
