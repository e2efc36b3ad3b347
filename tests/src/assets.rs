//! Scene files beside the workspace, where they have been downloaded.
#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};

use lichtwerk::program::load_description;
use scene_core::SceneDescription;

/// The file of this name below `../shared/assets`; nothing, and a message, where it is absent.
pub fn asset(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets").join(name);
    if !path.exists() {
        println!("skipped: there is no {}", path.display());
        return None;
    }
    Some(path)
}

/// The interior `modern-hall`.
///
/// # Panics
/// If it is there and cannot be loaded.
pub fn modern_hall() -> Option<SceneDescription> {
    let path = asset("modern-hall/scene_mi3.xml")?;
    Some(load_description(&path.to_string_lossy(), &[]).expect("a scene that is known to load"))
}
