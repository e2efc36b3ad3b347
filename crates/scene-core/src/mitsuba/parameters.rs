//! `$name` in attribute values.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};

use super::error::{ImportError, Place, Result};

/// The values of parameters: those of the caller stand, those of `<default>` fill the gaps.
#[derive(Debug, Default)]
pub(super) struct Parameters {
    values: HashMap<String, String>,
    from_caller: Vec<String>,
    used: RefCell<HashSet<String>>,
}

impl Parameters {
    pub(super) fn new(parameters: &[(String, String)]) -> Self {
        Self {
            values: parameters.iter().cloned().collect(),
            from_caller: parameters.iter().map(|(name, _)| name.clone()).collect(),
            used: RefCell::default(),
        }
    }

    /// The value of a `<default>`, unless there is one already.
    pub(super) fn set_default(&mut self, name: &str, value: String) {
        self.values.entry(name.to_owned()).or_insert(value);
    }

    /// Replaces every `$name`. Where several names fit, the longest wins, so that `$ab` is not `$a` followed by a `b`.
    pub(super) fn substitute(&self, text: &str, place: &Place) -> Result<String> {
        let mut result = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            result.push_str(&rest[..dollar]);
            rest = &rest[dollar + 1..];
            let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-')).unwrap_or(rest.len());
            let found = (1..=end)
                .rev()
                .filter(|&length| rest.is_char_boundary(length))
                .find_map(|length| self.values.get_key_value(&rest[..length]));
            let Some((name, value)) = found else {
                return Err(ImportError::UndefinedParameter { place: place.clone(), name: rest[..end].to_owned() });
            };
            self.used.borrow_mut().insert(name.clone());
            result.push_str(value);
            rest = &rest[name.len()..];
        }
        result.push_str(rest);
        Ok(result)
    }

    /// Parameters of the caller's that the scene never asked for.
    pub(super) fn unused(&self) -> impl Iterator<Item = &str> {
        let used = self.used.borrow();
        self.from_caller.iter().filter(move |name| !used.contains(*name)).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn place() -> Place {
        Place { file: Path::new("scene.xml").into(), line: 3 }
    }

    #[test]
    fn the_longest_name_wins_and_the_caller_overrides() {
        let mut parameters = Parameters::new(&[("a".into(), "1".into()), ("z".into(), "9".into())]);
        parameters.set_default("a", "5".into());
        parameters.set_default("ab", "77".into());
        assert_eq!(parameters.substitute("0.$ab $a/$ac", &place()).unwrap(), "0.77 1/1c");
        assert_eq!(parameters.unused().collect::<Vec<_>>(), ["z"]);
    }

    #[test]
    fn undefined_names_are_errors_that_say_where() {
        let error = Parameters::default().substitute("x $größe", &place()).unwrap_err();
        assert!(error.to_string().starts_with("scene.xml:3: parameter `$größe`"), "{error}");
        assert!(Parameters::default().substitute("$", &place()).is_err());
    }
}
