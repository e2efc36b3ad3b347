//! What can be wrong with a scene in LuxCore's format.

use std::path::{Path, PathBuf};

use thiserror::Error;

pub use crate::mitsuba::Place;

/// Why a scene cannot be imported.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// A file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// A line that is no property, or a property whose value makes no sense.
    #[error("{place}: {message}")]
    Invalid {
        /// Where.
        place: Place,
        /// What is wrong.
        message: String,
    },
    /// A type of material, camera, light or texture that the importer does not know.
    #[error("{place}: unknown type of {kind} `{name}`")]
    UnknownType {
        /// Where.
        place: Place,
        /// Material, camera, ..
        kind: &'static str,
        /// The type.
        name: String,
    },
    /// A feature that has no equivalent here.
    #[error("{place}: {what} is not supported")]
    Unsupported {
        /// Where.
        place: Place,
        /// Which feature.
        what: String,
    },
    /// A name that nothing has.
    #[error("{place}: there is no {kind} `{name}`")]
    Undefined {
        /// Where it is named.
        place: Place,
        /// What it should be.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A property that must be there and is not.
    #[error("{place}: the {kind} `{name}` has no `{property}`")]
    Missing {
        /// Where the first of its properties stands.
        place: Place,
        /// Object, material, ..
        kind: &'static str,
        /// Its name.
        name: String,
        /// What is missing.
        property: &'static str,
    },
    /// A mesh file that cannot be used, named by the scene at `place`.
    #[error("{}: {message} (named at {place})", path.display())]
    Data {
        /// The file.
        path: PathBuf,
        /// Where the scene names it.
        place: Place,
        /// What is wrong with it.
        message: String,
    },
    /// A scene without a camera.
    #[error("{}: the scene has no camera", path.display())]
    NoCamera {
        /// The file.
        path: PathBuf,
    },
}

/// Shorthand of the importer's functions.
pub(super) type Result<T> = std::result::Result<T, ImportError>;

pub(super) fn invalid(place: &Place, message: impl Into<String>) -> ImportError {
    ImportError::Invalid { place: place.clone(), message: message.into() }
}

pub(super) fn unsupported(place: &Place, what: impl Into<String>) -> ImportError {
    ImportError::Unsupported { place: place.clone(), what: what.into() }
}

pub(super) fn data(path: &Path, place: &Place, message: impl ToString) -> ImportError {
    ImportError::Data { path: path.to_path_buf(), place: place.clone(), message: message.to_string() }
}
