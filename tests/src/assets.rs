//! Scene files beside the workspace, where they have been downloaded.
#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lichtwerk::program::load_description;
use scene_core::texture::{ColorSpace, Image};
use scene_core::{SceneDescription, builtin};

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

/// The hall `many-lights`: 4501 balls that shine, in LuxCore's format.
///
/// # Panics
/// If it is there and cannot be loaded.
pub fn many_lights() -> Option<SceneDescription> {
    let path = asset("many-lights/scene.scn")?;
    Some(load_description(&path.to_string_lossy(), &[]).expect("a scene that is known to load"))
}

/// The builtin blob under the environment map `spiaggia_di_mondello_1k.hdr`, turned by `degrees` about the vertical.
///
/// # Panics
/// If the map is there and cannot be read.
pub fn blob_hdr(degrees: f32) -> Option<SceneDescription> {
    let path = asset("env/spiaggia_di_mondello_1k.hdr")?;
    let image = Image::open(&path, ColorSpace::Linear).expect("an image that is known to load");
    Some(builtin::blob_under(Arc::new(image), 1.0, degrees))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene_core::{ReferenceScene, Scene};

    #[test]
    fn the_blob_stands_under_the_photographed_sky() {
        let Some(description) = blob_hdr(90.0) else { return };
        let scene = ReferenceScene::new(description).expect("a builtin scene");
        assert!(scene.warnings().is_empty() && scene.environment().is_some() && scene.emitters().len() == 3);
    }
}
