//! The parameter names of files older than version 2.

/// `toWorld` becomes `to_world`, `intIOR` becomes `int_ior`: an upper-case letter after a lower-case one gets an
/// underscore, and all letters become lower-case. Mitsuba does the same to files of a version below 2.0.
pub(super) fn snake_case(name: &str) -> String {
    let mut result = String::with_capacity(name.len() + 4);
    let mut after_lower = false;
    for c in name.chars() {
        if c.is_uppercase() && after_lower {
            result.push('_');
        }
        after_lower = c.is_lowercase();
        result.extend(c.to_lowercase());
    }
    result
}

/// The name in today's spelling of a parameter of `plugin` in a file older than version 2.
pub(super) fn upgrade(name: &str, plugin: &str) -> String {
    match (plugin, snake_case(name).as_str()) {
        ("diffuse", "diffuse_reflectance") => "reflectance".into(),
        (_, name) => name.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_snake_case() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("maxDepth", "max_depth"),
            ("diffuseReflectance", "diffuse_reflectance"),
            ("to_world", "to_world"),
            ("alphaU", "alpha_u"),
            ("", ""),
        ] {
            assert_eq!(snake_case(old), new);
        }
        assert_eq!(upgrade("diffuseReflectance", "diffuse"), "reflectance");
    }
}
