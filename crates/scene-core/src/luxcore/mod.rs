//! Importer for scenes in LuxCore's text format: properties, a line each, and meshes in PLY files.
//!
//! [`load`] reads a file that by convention ends in `.scn`, and the meshes that it names, into a [`SceneDescription`].
//! Meshes that many objects share are kept once, whether they emit or not.
//!
//! # What is known
//! | property | values |
//! |---|---|
//! | `scene.camera` | `perspective`, by `lookat`, `up`, `fieldofview`, `screenwindow`, `lensradius`, `focaldistance` |
//! | `scene.objects.NAME` | `ply`, `material`, `transformation` (a 4 x 4 matrix, column by column) |
//! | `scene.materials.NAME` | `matte`, `mirror`, `glass` with constant colours, and their `emission` |
//! | `scene.lights.NAME` | `constantinfinite` |
//!
//! # Conventions
//! As in LuxCore 2.10 (`slg/materials/material.cpp`, `slg/lights/trianglelight.cpp`, `slg/cameras/perspective.cpp`):
//!
//! - **Emission** is diffuse, on the outer side of the mesh. With `gain`, `power` (W), `efficiency` (lm/W; also spelled `efficency`) and the
//!   colour `C` of luminance `Y`, and `n = 1 / Y` if `normalizebycolor` is set (the default), else `n = 1`:
//!
//!   ```text
//!   L = gain C power efficiency n / (pi area)       if power efficiency n is positive and finite; area: of the whole mesh in the world
//!   L = gain C                                      otherwise; times 1 / Y if gain.normalizebycolor is set
//!   ```
//!
//!   `importance`, `id` and `directlightsampling` change no picture.
//! - **Camera.** The angle `fieldofview` belongs to half a screen of 1: the horizontal angle of view is
//!   `2 atan(tan(fieldofview / 2) w)`, where `w` is half of the width of the `screenwindow`. The size of the image stands in another file: it is
//!   640 pixels wide here, and as high as the window says (480 without one).
//! - **Matte** surfaces and mirrors have two sides. Meshes without normals are flat.
//!
//! # Errors and warnings
//! As those of the importer for Mitsuba's format: an unknown type of camera, material or light is an error, and so is what has no equivalent
//! and would give another picture (textures, `emission.theta` below 90 degrees, ..); an unknown property is a warning that names file, line and
//! property, once for all objects that have it. Bad input of any kind is an [`ImportError`], never a panic.

mod camera;
mod error;
mod importer;
mod materials;
mod properties;

pub use error::{ImportError, Place};

use std::path::Path;

use crate::reference::SceneDescription;
use importer::Importer;
use properties::Document;

/// Reads a scene file. Meshes are looked for in its folder.
///
/// # Errors
/// See [`ImportError`].
pub fn load(path: &Path) -> Result<SceneDescription, ImportError> {
    let text = std::fs::read(path).map_err(|source| ImportError::Read { path: path.to_path_buf(), source })?;
    // Comments may be in any encoding; what matters is ASCII.
    import(&String::from_utf8_lossy(&text), path)
}

/// Reads a scene from text. Meshes are looked for in `directory`.
///
/// # Errors
/// See [`ImportError`]; places in the text have the file name `directory/<text>`.
///
/// # Example
/// ```
/// use scene_core::luxcore;
/// # fn main() -> Result<(), luxcore::ImportError> {
/// let text = r#"
/// scene.camera.lookat.orig = 0 -5 1
/// scene.camera.lookat.target = 0 0 1
/// scene.camera.screenwindow = -1 1 -0.5 0.5
/// scene.lights.sky.type = "constantinfinite"
/// scene.lights.sky.gain = 2 2 2
/// "#;
/// let scene = luxcore::load_str(text, ".".as_ref())?;
/// assert_eq!((scene.camera.width, scene.camera.height, scene.lights.len()), (640, 320, 1));
///
/// let error = luxcore::load_str(&text.replace("constantinfinite", "sky9"), ".".as_ref()).unwrap_err();
/// assert!(error.to_string().ends_with(":5: unknown type of light `sky9`"));
/// # Ok(())
/// # }
/// ```
pub fn load_str(text: &str, directory: &Path) -> Result<SceneDescription, ImportError> {
    import(text, &directory.join("<text>"))
}

fn import(text: &str, path: &Path) -> Result<SceneDescription, ImportError> {
    let document = Document::parse(text, path)?;
    let directory = path.parent().unwrap_or_else(|| Path::new(""));
    Importer::new(&document, directory).run(path)
}
