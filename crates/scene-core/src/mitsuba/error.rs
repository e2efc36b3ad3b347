//! What can be wrong with a scene file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;

/// Where something stands: file and line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: Arc<Path>,
    /// The line, counted from one.
    pub line: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file.display(), self.line)
    }
}

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
    /// The file is not well-formed XML.
    #[error("{place}: {message}")]
    Xml {
        /// Where.
        place: Place,
        /// What the parser says.
        message: String,
    },
    /// Something is well-formed and yet makes no sense: a bad number, a missing attribute, a transform without inverse.
    #[error("{place}: {message}")]
    Invalid {
        /// Where.
        place: Place,
        /// What is wrong.
        message: String,
    },
    /// A plugin that the importer does not know.
    #[error("{place}: unknown {kind} plugin `{plugin}`")]
    UnknownPlugin {
        /// Where.
        place: Place,
        /// The element: `bsdf`, `shape`, ..
        kind: &'static str,
        /// Its `type`.
        plugin: String,
    },
    /// A feature of a known plugin that has no equivalent here.
    #[error("{place}: {what} is not supported")]
    Unsupported {
        /// Where.
        place: Place,
        /// Which feature.
        what: String,
    },
    /// A `$name` without `<default>` and without a value from the caller.
    #[error("{place}: parameter `${name}` has no value; give it one or add a <default>")]
    UndefinedParameter {
        /// Where.
        place: Place,
        /// Its name.
        name: String,
    },
    /// A `ref` to an id that no object has.
    #[error("{place}: nothing has the id `{id}`")]
    UnresolvedReference {
        /// Where.
        place: Place,
        /// The id.
        id: String,
    },
    /// A file that includes itself, directly or through others.
    #[error("{place}: files include each other in a cycle: {}", chain.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(" -> "))]
    IncludeCycle {
        /// Where the cycle closes.
        place: Place,
        /// The files, from the outermost to the one that repeats.
        chain: Vec<PathBuf>,
    },
    /// A mesh, texture or spectrum file that cannot be used, named by the scene at `place`.
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
    #[error("{}: the scene has no sensor", path.display())]
    NoSensor {
        /// The file.
        path: PathBuf,
    },
}

/// Shorthand of the importer's functions.
pub(super) type Result<T> = std::result::Result<T, ImportError>;

impl Place {
    pub(super) fn invalid(&self, message: impl Into<String>) -> ImportError {
        ImportError::Invalid { place: self.clone(), message: message.into() }
    }

    pub(super) fn unsupported(&self, what: impl Into<String>) -> ImportError {
        ImportError::Unsupported { place: self.clone(), what: what.into() }
    }

    pub(super) fn data(&self, path: &Path, message: impl Into<String>) -> ImportError {
        ImportError::Data { path: path.to_path_buf(), place: self.clone(), message: message.into() }
    }
}
