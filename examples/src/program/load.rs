//! From a name or a file to a scene.

use std::path::Path;

use scene_core::builtin::Builtin;
use scene_core::{SceneDescription, gltf, luxcore, mitsuba};

/// Why there is no scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Neither a builtin name nor a file.
    #[error("'{name}' is neither a builtin scene (see 'lichtwerk list') nor a file{}", hint(.name))]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// A file of another kind.
    #[error(
        "{0}: unknown kind of scene file; Mitsuba 3 XML (.xml), LuxCore properties (.scn) and glTF 2.0 (.gltf, .glb) can be read"
    )]
    Kind(String),
    /// Parameters for something that has none.
    #[error("'{0}' takes no parameters (-D); only Mitsuba 3 XML does")]
    Parameters(String),
    /// The importer for Mitsuba's format.
    #[error(transparent)]
    Import(#[from] mitsuba::ImportError),
    /// The importer for LuxCore's format.
    #[error(transparent)]
    LuxCore(#[from] luxcore::ImportError),
    /// The importer for glTF.
    #[error(transparent)]
    Gltf(#[from] gltf::ImportError),
}

/// The description of a builtin scene or of a file.
///
/// # Errors
/// No such scene, or the importer's error.
pub fn load_description(scene: &str, definitions: &[(String, String)]) -> Result<SceneDescription, LoadError> {
    if let Some(builtin) = Builtin::named(scene) {
        return if definitions.is_empty() {
            Ok(builtin.description())
        } else {
            Err(LoadError::Parameters(scene.to_owned()))
        };
    }
    let path = Path::new(scene);
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("xml") => Ok(mitsuba::load(path, definitions)?),
        Some("scn" | "gltf" | "glb") if !definitions.is_empty() => Err(LoadError::Parameters(scene.to_owned())),
        Some("scn") => Ok(luxcore::load(path)?),
        Some("gltf" | "glb") => Ok(gltf::load(path)?),
        _ if path.exists() => Err(LoadError::Kind(scene.to_owned())),
        _ => Err(LoadError::Unknown { name: scene.to_owned() }),
    }
}

/// The builtin scene that was probably meant: the shortest that begins so, or the most similar one.
fn hint(name: &str) -> String {
    let name = name.to_ascii_lowercase();
    let names = || Builtin::ALL.iter().map(|builtin| builtin.name);
    let longer = names().filter(|builtin| !name.is_empty() && builtin.starts_with(&name)).min_by_key(|name| name.len());
    let similar = || {
        let likeness = |builtin: &str| strsim::jaro_winkler(&name, builtin);
        let best = names().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        best.filter(|best| likeness(best) > 0.8)
    };
    longer.or_else(similar).map(|meant| format!("; did you mean '{meant}'?")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_scene_is_named() {
        let message = |scene: &str| load_description(scene, &[]).unwrap_err().to_string();
        assert!(message("nowhere").ends_with("nor a file"));
        for (typo, meant) in
            [("ofice", "office"), ("Office", "office"), ("cornell", "cornell-box"), ("rooms-100", "rooms-1000")]
        {
            assert!(message(typo).ends_with(&format!("did you mean '{meant}'?")), "{}", message(typo));
        }
        assert!(message("nowhere.xml").contains("nowhere.xml"));
        assert!(message("nowhere.scn").contains("cannot read nowhere.scn"));
        assert!(load_description("nowhere.scn", &[("a".into(), "b".into())]).unwrap_err().to_string().contains("(-D)"));
        assert!(message("nowhere.GLB").contains("cannot read nowhere.GLB"));
        assert!(
            load_description("nowhere.gltf", &[("a".into(), "b".into())]).unwrap_err().to_string().contains("(-D)")
        );
        assert!(message("Cargo.toml").contains("Cargo.toml: unknown kind"));
        assert!(load_description("furnace", &[("a".into(), "b".into())]).is_err());
        assert!(load_description("furnace", &[]).is_ok());
    }
}
