//! Importer for scenes in Mitsuba 3's XML format.
//!
//! [`load`] reads a file and what it names (included files, meshes, textures) into a
//! [`SceneDescription`]. Conventions, defaults and corner cases are those of
//! Mitsuba 3.9, measured, so that the same file gives the same picture; files of versions below 2.0 with their
//! `toWorld` and `intIOR` are read as Mitsuba reads them.
//!
//! # What is known
//! | element | plugins |
//! |---|---|
//! | `shape` | `obj`, `ply`, `serialized`, `rectangle`, `cube`, `sphere`, `disk`, `cylinder` (tessellated), `shapegroup`, `instance` |
//! | `bsdf` | `diffuse`, `dielectric`, `thindielectric`, `roughdielectric`, `conductor`, `roughconductor`, `plastic`, `roughplastic`, `phong` (of Mitsuba 0.6), `mask`, `null`, `twosided`, `bumpmap`, `normalmap` |
//! | `texture`, `spectrum` | `bitmap`, `checkerboard`, `uniform`, `srgb`, `d65` |
//! | `medium`, `phase` | `homogeneous`, as the interior of a shape whose bsdf is `dielectric`, `roughdielectric` or `null`; `hg`, `isotropic` |
//! | `emitter` | `area`, `point`, `spot`, `directional`, `constant`, `envmap` |
//! | `sensor` | `perspective`, `thinlens` |
//! | `film`, `rfilter` | `hdrfilm`; `box`, `tent`, `gaussian` |
//! | `integrator` | any: only `max_depth` is taken |
//!
//! # Errors and warnings
//! An unknown plugin is an error, because the picture would be another one; it names file, line and plugin. An unknown
//! parameter is a warning with file, line and name in
//! [`SceneDescription::warnings`]. Bad input of any kind (a missing or truncated file, an
//! index out of range, a header that promises more than the file holds, a transform without inverse, files that
//! include each other) is an [`ImportError`], never a panic. Triangles with vertices that are not finite are dropped
//! and counted in a warning.
//!
//! # Differences from Mitsuba
//! - Spectra given by wavelength become RGB with the CIE 1931 observer at steps of 10 nm, within 2 % of Mitsuba's `scalar_rgb`.
//! - Participating media other than those in the table (in the air, inside other materials, of varying density) are passed over with a
//!   warning, as Mitsuba's `path` does silently. Shadow rays do not cross a `null` boundary: see [`medium`](crate::medium).
//! - Not supported, each an error: textured radiance of area and spot lights, textured roughness, spheres
//!   scaled unequally along their axes, crop windows, `principal_point_offset`.
//! - Accepted although Mitsuba 3 refuses them: unknown parameters, `<srgb>`, `#rrggbb` colours, polygons and negative
//!   indices in meshes, `lookAt`.

mod bsdfs;
mod document;
mod emitters;
mod error;
mod importer;
mod media;
mod names;
mod obj;
mod object;
mod parameters;
pub(crate) mod ply;
mod primitives;
mod property;
pub(crate) mod raw_mesh;
mod sensors;
mod serialized;
mod shapes;
mod spectra;
mod textures;
mod transforms;
mod values;
mod xml;

pub use error::{ImportError, Place};

use std::path::Path;

use crate::reference::SceneDescription;
use importer::Importer;
use xml::Reader;

/// Reads a scene file. `parameters` are values for its `$name`s; they override its `<default>`s.
///
/// # Errors
/// See [`ImportError`].
pub fn load(path: &Path, parameters: &[(String, String)]) -> Result<SceneDescription, ImportError> {
    let mut reader = Reader::new(parameters, None);
    reader.read_file(path, &[], None)?;
    import(reader, path)
}

/// Reads a scene from text. Files that it names are looked for in `directory`.
///
/// # Errors
/// See [`ImportError`]; places in the text have the file name `directory/<text>`.
///
/// # Example
/// ```
/// use scene_core::mitsuba;
/// # fn main() -> Result<(), mitsuba::ImportError> {
/// let text = r#"<scene version="3.0.0">
///     <default name="size" value="64"/>
///     <sensor type="perspective">
///         <film type="hdrfilm"><integer name="width" value="$size"/><integer name="height" value="$size"/></film>
///     </sensor>
///     <shape type="sphere"><emitter type="area"><rgb name="radiance" value="1, 2, 3"/></emitter></shape>
/// </scene>"#;
/// let scene = mitsuba::load_str(text, ".".as_ref(), &[("size".into(), "128".into())])?;
/// assert_eq!((scene.camera.width, scene.instances.len()), (128, 1));
///
/// let error = mitsuba::load_str(&text.replace("sphere", "teapot"), ".".as_ref(), &[]).unwrap_err();
/// assert!(error.to_string().ends_with(":6: unknown shape plugin `teapot`"));
/// # Ok(())
/// # }
/// ```
pub fn load_str(
    text: &str,
    directory: &Path,
    parameters: &[(String, String)],
) -> Result<SceneDescription, ImportError> {
    let path = directory.join("<text>");
    let mut reader = Reader::new(parameters, Some(directory));
    reader.read_text(text, &path, &[])?;
    import(reader, &path)
}

fn import(mut reader: Reader, path: &Path) -> Result<SceneDescription, ImportError> {
    reader.document.link()?;
    let mut importer = Importer::new(&reader.document, &reader.directories);
    for name in reader.parameters.unused() {
        importer.warn(format!("{}: the scene has no parameter `${name}`", path.display()));
    }
    importer.run(path)
}
