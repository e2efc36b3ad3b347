//! What the tests of the importer share.
#![allow(dead_code)]

use std::path::{Path, PathBuf};

use scene_core::mitsuba::{self, ImportError};
use scene_core::reference::SceneDescription;
use tempfile::TempDir;

/// A sensor, for scenes that are about something else.
pub(crate) const SENSOR: &str = r#"<sensor type="perspective"/>"#;

/// A scene of a current version, with a sensor in its second line and `content` from the third.
pub(crate) fn scene(content: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{SENSOR}\n{content}\n</scene>")
}

/// Imports `content`; `files` are written beside it.
pub(crate) fn import(content: &str, files: &[(&str, &[u8])]) -> Result<SceneDescription, ImportError> {
    let directory = folder(files);
    mitsuba::load_str(&scene(content), directory.path(), &[])
}

/// Imports what must be right, and give no warnings.
pub(crate) fn load(content: &str) -> SceneDescription {
    let scene = import(content, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.warnings, Vec::<String>::new());
    scene
}

/// The message about what must be wrong. Prefixes up to the file name are cut off.
pub(crate) fn error(content: &str, files: &[(&str, &[u8])]) -> String {
    let text = import(content, files).map(|_| ()).unwrap_err().to_string();
    text.rsplit_once("<text>").map_or(text.clone(), |(_, rest)| rest.to_owned())
}

/// A temporary directory with these files.
pub(crate) fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    for (name, content) in files {
        let path = directory.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    directory
}

/// The downloaded scenes, if they are there.
pub(crate) fn assets() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets");
    path.is_dir().then_some(path)
}
