//! Importer for assets in glTF 2.0: `.gltf` (JSON with files or base64 beside it) and `.glb` (all in one).
//!
//! [`load`] reads a file and what it names into a [`SceneDescription`]. Meshes that several nodes show are kept once.
//!
//! # What is known
//! | glTF | here |
//! |---|---|
//! | nodes | matrices, or translation, rotation and scale; the default scene |
//! | primitives | triangles, strips, fans, with indices or without; positions, normals, one set of texture coordinates; sparse and quantised accessors |
//! | `pbrMetallicRoughness` | [`MetallicRoughness`](crate::material::Material::MetallicRoughness) with both textures, `KHR_materials_ior`, factors of `KHR_materials_specular` |
//! | `KHR_materials_transmission` | without thickness [`ThinDielectric`](crate::material::Material::ThinDielectric); with that of `KHR_materials_volume` a smooth or rough dielectric, filled with a medium that absorbs |
//! | `normalTexture` | [`TangentNormalMap`](crate::material::Material::TangentNormalMap); tangents are those of the texture coordinates |
//! | `emissiveFactor`, `emissiveTexture`, `KHR_materials_emissive_strength` | radiance on the front; a texture becomes a constant for each triangle |
//! | `alphaMode` | [`Mask`](crate::material::Material::Mask): the alpha as opacity, cut off for `MASK` |
//! | `doubleSided` | all opaque surfaces are [`TwoSided`](crate::material::Material::TwoSided): without it glTF would cull the back, which light cannot |
//! | textures | PNG and JPEG; wrapping, nearest or bilinear; `KHR_texture_transform`; colours are sRGB, everything else is linear |
//! | `KHR_lights_punctual` | point, spot and directional |
//! | cameras | the first perspective one |
//!
//! # Units and conventions
//! - **Light is radiometric.** Candela, lux and nits are taken as W/sr, W/m^2 and W/(m^2 sr), component by component, without the 683 lm/W
//!   between them: exposure is the viewer's.
//! - **Spots** fall off linearly in the angle between the cones; the specification recommends the square of a function that is
//!   linear in the cosine.
//! - **Length** is in metres, if the asset keeps to the specification.
//! - **Images** are 640 pixels wide and as high as the camera's aspect ratio says, 480 if it does not.
//! - **Panes** reflect and transmit with all interreflections inside of them, of which the specification takes the first.
//! - Occlusion textures are ignored silently: paths find out for themselves.
//!
//! # Defaults
//! - **No camera:** one of a vertical angle of 0.7 radians looks from the direction (0.5, 0.4, 1) at the middle of the scene's box and holds all of it.
//! - **No light** (neither punctual nor an emissive material without texture; emissive textures count as accents, as of displays and headlights): a
//!   constant environment of radiance 1. Both are warnings.
//!
//! # Errors and warnings
//! An extension that the asset requires and that is not known is an error; one that it uses is a warning. So is what is passed over:
//! animations, skins, morph targets, vertex colours, points and lines, other cameras, and every approximation above that changes the
//! picture. Both name the file and the element, such as `` materials[2] `Glass` ``; a warning comes once and counts the places. Bad input of any kind is an [`ImportError`],
//! never a panic. Triangles whose vertices are not finite are dropped and counted.

mod buffers;
mod cameras;
mod document;
mod emission;
mod error;
mod importer;
mod lights;
mod materials;
mod meshes;
mod nodes;
mod textures;
mod transmission;
mod uri;

pub use error::{ImportError, Place};

use std::path::Path;

use crate::reference::SceneDescription;
use buffers::Buffers;
use document::Source;
use importer::Importer;

/// Reads a `.gltf` or `.glb`; the content decides which, not the name. Buffers and images are looked for in its folder.
///
/// # Errors
/// See [`ImportError`].
pub fn load(path: &Path) -> Result<SceneDescription, ImportError> {
    let bytes = std::fs::read(path).map_err(|source| ImportError::Read { path: path.to_path_buf(), source })?;
    import(&bytes, path)
}

/// Reads an asset from memory. Files that it names are looked for in `directory`.
///
/// # Errors
/// See [`ImportError`]; places have the file name `directory/<bytes>`.
///
/// # Example
/// ```
/// use scene_core::gltf;
/// # fn main() -> Result<(), gltf::ImportError> {
/// let text = r#"{
///     "asset": { "version": "2.0" },
///     "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.8, "aspectRatio": 2, "znear": 0.1 } }],
///     "nodes": [{ "camera": 0, "translation": [0, 1, 5] }]
/// }"#;
/// let scene = gltf::load_slice(text.as_bytes(), ".".as_ref())?;
/// assert_eq!((scene.camera.width, scene.camera.height), (640, 320));
/// // An environment stands in for light, and a warning says so.
/// assert_eq!((scene.lights.len(), scene.warnings.len()), (1, 1));
///
/// let error = gltf::load_slice(text.replace("0.8", "-0.8").as_bytes(), ".".as_ref()).unwrap_err();
/// assert!(error.to_string().contains("cameras[0]: a camera of a yfov of -0.8"));
/// # Ok(())
/// # }
/// ```
pub fn load_slice(bytes: &[u8], directory: &Path) -> Result<SceneDescription, ImportError> {
    import(bytes, &directory.join("<bytes>"))
}

fn import(bytes: &[u8], path: &Path) -> Result<SceneDescription, ImportError> {
    let directory = path.parent().unwrap_or_else(|| Path::new(""));
    let mut source = Source::parse(bytes, path)?;
    let buffers = Buffers::read(&mut source, directory)?;
    Importer::new(&source, &buffers, directory).run()
}
