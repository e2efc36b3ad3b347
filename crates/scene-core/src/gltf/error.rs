//! What can be wrong with a glTF asset.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;

/// Where something stands: the file, and the element of its JSON, such as `` materials[2] `Glass` ``.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: Arc<Path>,
    /// The element: a list and the position in it, and its name if it has one.
    pub element: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file.display(), self.element)
    }
}

/// Why an asset cannot be imported.
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
    /// The file is no glTF 2.0: its binary container or its JSON is broken, or of another version.
    #[error("{}: {message}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// The asset cannot be shown without an extension that is not known here.
    #[error("{}: requires the extension `{name}`, which is not supported", path.display())]
    RequiredExtension {
        /// The file.
        path: PathBuf,
        /// The extension.
        name: String,
    },
    /// An element that makes no sense.
    #[error("{place}: {message}")]
    Invalid {
        /// Where.
        place: Place,
        /// What is wrong.
        message: String,
    },
    /// A feature that has no equivalent here.
    #[error("{place}: {what} is not supported")]
    Unsupported {
        /// Where.
        place: Place,
        /// Which feature.
        what: String,
    },
    /// A buffer or image that cannot be used, named by the asset at `place`.
    #[error("{}: {message} (named at {place})", path.display())]
    Data {
        /// The file.
        path: PathBuf,
        /// Where the asset names it.
        place: Place,
        /// What is wrong with it.
        message: String,
    },
}

/// Shorthand of the importer's functions.
pub(super) type Result<T> = std::result::Result<T, ImportError>;

impl Place {
    /// An element of a list of the document.
    pub(super) fn new(file: &Arc<Path>, list: &str, index: usize, name: Option<&str>) -> Self {
        let name = name.map_or_else(String::new, |name| format!(" `{name}`"));
        Self { file: file.clone(), element: format!("{list}[{index}]{name}") }
    }

    /// A part of this element.
    pub(super) fn part(&self, part: impl fmt::Display) -> Self {
        Self { file: self.file.clone(), element: format!("{}, {part}", self.element) }
    }

    pub(super) fn invalid(&self, message: impl Into<String>) -> ImportError {
        ImportError::Invalid { place: self.clone(), message: message.into() }
    }

    pub(super) fn unsupported(&self, what: impl Into<String>) -> ImportError {
        ImportError::Unsupported { place: self.clone(), what: what.into() }
    }

    pub(super) fn data(&self, path: &Path, message: impl ToString) -> ImportError {
        ImportError::Data { path: path.to_path_buf(), place: self.clone(), message: message.to_string() }
    }
}
