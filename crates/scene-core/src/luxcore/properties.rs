//! The file as properties, grouped by what they describe.

use std::cell::Cell;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use super::error::{ImportError, Place, Result, invalid};

/// A value and where it stands.
#[derive(Debug)]
pub(super) struct Property {
    /// The name below that of what it describes, `emission.gain` for example.
    pub(super) name: String,
    /// The text after the sign of equality.
    pub(super) value: String,
    pub(super) place: Place,
    used: Cell<bool>,
}

/// What has properties: an object, a material, the camera.
#[derive(Debug)]
pub(super) struct Group {
    /// `object`, `material`, ..
    pub(super) kind: &'static str,
    pub(super) name: String,
    /// Of its first property.
    pub(super) place: Place,
    properties: Vec<Property>,
}

/// All groups, each kind in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) groups: Vec<Group>,
    indices: HashMap<(&'static str, String), usize>,
    /// Properties of nothing that is known.
    pub(super) others: Vec<(String, Place)>,
}

/// Kinds with names, by their prefix; the camera has none.
const PREFIXES: [(&str, &str); 6] = [
    ("scene.objects.", "object"),
    ("scene.materials.", "material"),
    ("scene.lights.", "light"),
    ("scene.textures.", "texture"),
    ("scene.volumes.", "volume"),
    ("scene.shapes.", "shape"),
];

impl Document {
    /// Reads text. A property that is given again replaces the earlier one, as in LuxCore.
    pub(super) fn parse(text: &str, path: &Path) -> Result<Self> {
        let file: Arc<Path> = path.into();
        let mut document = Self::default();
        for (line, number) in text.lines().zip(1..) {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let place = Place { file: file.clone(), line: number };
            let Some((key, value)) = line.split_once('=') else {
                return Err(invalid(&place, "a line must be `name = value`"));
            };
            document.add(key.trim(), value.trim(), place)?;
        }
        Ok(document)
    }

    fn add(&mut self, key: &str, value: &str, place: Place) -> Result<()> {
        if key.is_empty() || value.is_empty() {
            return Err(invalid(&place, "a line must be `name = value`"));
        }
        let (kind, name, property) = if let Some(property) = key.strip_prefix("scene.camera.") {
            ("camera", "", property)
        } else {
            let found = PREFIXES.iter().find_map(|&(prefix, kind)| Some((kind, key.strip_prefix(prefix)?)));
            match found.map(|(kind, rest)| (kind, rest.split_once('.'))) {
                Some((kind, Some((name, property)))) => (kind, name, property),
                _ => {
                    self.others.push((key.to_owned(), place));
                    return Ok(());
                }
            }
        };
        let group = *self.indices.entry((kind, name.to_owned())).or_insert_with(|| {
            let group = Group { kind, name: name.to_owned(), place: place.clone(), properties: Vec::new() };
            self.groups.push(group);
            self.groups.len() - 1
        });
        let properties = &mut self.groups[group].properties;
        properties.retain(|other| other.name != property);
        let (name, value) = (property.to_owned(), value.to_owned());
        properties.push(Property { name, value, place, used: Cell::new(false) });
        Ok(())
    }

    /// The group of that kind and name.
    pub(super) fn group(&self, kind: &'static str, name: &str) -> Option<&Group> {
        self.indices.get(&(kind, name.to_owned())).map(|&index| &self.groups[index])
    }

    /// All groups of a kind.
    pub(super) fn all<'d>(&'d self, kind: &'static str) -> impl Iterator<Item = &'d Group> + 'd {
        self.groups.iter().filter(move |group| group.kind == kind)
    }
}

impl Group {
    /// The property, marked as used.
    pub(super) fn get(&self, name: &str) -> Option<&Property> {
        let found = self.properties.iter().find(|property| property.name == name)?;
        found.used.set(true);
        Some(found)
    }

    /// The property, which must be there.
    pub(super) fn require(&self, name: &'static str) -> Result<&Property> {
        self.get(name).ok_or_else(|| ImportError::Missing {
            place: self.place.clone(),
            kind: self.kind,
            name: self.name.clone(),
            property: name,
        })
    }

    /// A number, or `default`.
    pub(super) fn number(&self, name: &str, default: f64) -> Result<f64> {
        self.get(name).map_or(Ok(default), |property| Ok(property.numbers::<1>()?[0]))
    }

    /// Three numbers or one for all three; nothing if it is absent.
    pub(super) fn color(&self, name: &str) -> Result<Option<[f64; 3]>> {
        self.get(name).map(Property::color).transpose()
    }

    /// Whether it is true or not zero; `default` if it is absent.
    pub(super) fn flag(&self, name: &str, default: bool) -> Result<bool> {
        let Some(property) = self.get(name) else { return Ok(default) };
        match property.text() {
            "true" => Ok(true),
            "false" => Ok(false),
            _ => Ok(property.numbers::<1>()?[0] != 0.0),
        }
    }

    /// Marks properties as known that change nothing here.
    pub(super) fn ignore(&self, names: &[&str]) {
        for name in names {
            let _ = self.get(name);
        }
    }

    /// Properties that nothing asked for.
    pub(super) fn unused(&self) -> impl Iterator<Item = &Property> {
        self.properties.iter().filter(|property| !property.used.get())
    }
}

impl Property {
    /// The value without quotation marks.
    pub(super) fn text(&self) -> &str {
        self.value.trim_matches(['"', '\''])
    }

    /// The finite numbers of the value, separated by spaces, in quotation marks or not.
    fn all_numbers(&self) -> Result<Vec<f64>> {
        let words = self.value.split(|c: char| c.is_whitespace() || c == '"' || c == '\'').filter(|w| !w.is_empty());
        let number = |word: &str| word.parse::<f64>().ok().filter(|x| x.is_finite() && (*x as f32).is_finite());
        words
            .map(|word| {
                let message = || format!("`{}`: `{word}` is no finite number", self.name);
                number(word).ok_or_else(|| invalid(&self.place, message()))
            })
            .collect()
    }

    /// Exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N]> {
        let numbers = self.all_numbers()?;
        let count = numbers.len();
        let message = || format!("`{}` needs {N} numbers and has {count}", self.name);
        numbers.try_into().map_err(|_| invalid(&self.place, message()))
    }

    /// Three numbers, or one for all three.
    pub(super) fn color(&self) -> Result<[f64; 3]> {
        match self.all_numbers()?[..] {
            [grey] => Ok([grey; 3]),
            [r, g, b] => Ok([r, g, b]),
            ref other => {
                let message = format!("`{}` needs one number or three and has {}", self.name, other.len());
                Err(invalid(&self.place, message))
            }
        }
    }

    /// Whether the value is a name and no number.
    pub(super) fn is_name(&self) -> bool {
        self.text().split_whitespace().next().is_some_and(|word| word.parse::<f64>().is_err())
    }
}
