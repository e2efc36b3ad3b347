//! What can go wrong with image files.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// An image file cannot be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImageFileError {
    /// The operating system refused.
    #[error("{}: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// The contents are truncated or contradict themselves.
    #[error("{}: not a valid OpenEXR file: {reason}", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The contents use a feature that is not supported.
    #[error("{}: unsupported OpenEXR feature: {reason}", .path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// The feature.
        reason: String,
    },
    /// The image cannot be encoded.
    #[error("cannot encode the image: {0}")]
    Encode(String),
}

impl ImageFileError {
    pub(super) fn io(path: &Path, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    pub(super) fn invalid(path: &Path, reason: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), reason: reason.into() }
    }

    pub(super) fn unsupported(path: &Path, reason: impl Into<String>) -> Self {
        Self::Unsupported { path: path.to_owned(), reason: reason.into() }
    }
}
