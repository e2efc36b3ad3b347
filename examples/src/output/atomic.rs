//! Files that are never half written.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// A file cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The operating system refused.
    #[error("cannot write {}: {source}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// The name ends in nothing that tells a format.
    #[error("cannot write {}: the name must end in .exr or .png", .path.display())]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// The contents cannot be encoded.
    #[error("cannot write {}: {reason}", .path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        reason: String,
    },
}

impl OutputError {
    fn write(path: &Path, source: io::Error) -> Self {
        Self::Write { path: path.to_owned(), source }
    }

    pub(super) fn encode(path: &Path, reason: impl ToString) -> Self {
        Self::Encode { path: path.to_owned(), reason: reason.to_string() }
    }
}

/// Writes a file by way of a temporary one in the same folder, which replaces it in one step once it is complete and
/// on the disk. If anything fails, an existing file stays as it was and the temporary one is removed. A process that
/// is killed in between leaves the old file, and a hidden `.NAME.*.tmp` beside it.
///
/// An existing file keeps its permissions; a symbolic link stays one, the file that it points to is replaced. What is
/// not a regular file (`/dev/stdout`, a pipe) is written to directly.
///
/// # Errors
/// [`OutputError::Write`] with the path if the folder is missing or not writable, the disk is full, or `write` fails.
///
/// ```
/// use std::io::Write;
///
/// use lichtwerk::output::write_atomically;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("numbers.txt");
/// write_atomically(&path, |file| writeln!(file, "1 2 3"))?;
/// assert!(write_atomically(&path, |_| Err(std::io::Error::other("no more numbers"))).is_err());
/// assert_eq!(std::fs::read_to_string(&path)?, "1 2 3\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_atomically(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), OutputError> {
    write_or_replace(path, write).map_err(|source| OutputError::write(path, source))
}

/// Finds out whether [`write_atomically`] could write this file now, so that nobody renders for an hour in vain.
///
/// # Errors
/// [`OutputError::Write`] with the path, as for writing.
pub fn check_writable(path: &Path) -> Result<(), OutputError> {
    match Target::of(path) {
        Ok(Target::Device) => Ok(()),
        Ok(Target::File(target)) => temporary_beside(&target).map(drop),
        Err(source) => Err(source),
    }
    .map_err(|source| OutputError::write(path, source))
}

fn write_or_replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let target = match Target::of(path)? {
        Target::File(target) => target,
        Target::Device => {
            let mut file = fs::OpenOptions::new().write(true).open(path)?;
            write(&mut file)?;
            return file.flush();
        }
    };
    let mut temporary = temporary_beside(&target)?;
    let mut buffered = BufWriter::new(temporary.as_file_mut());
    write(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    temporary.as_file().sync_all()?;
    temporary.persist(&target).map_err(|error| error.error)?;
    Ok(())
}

/// What a path leads to.
enum Target {
    /// A regular file that exists or may come to be, with symbolic links resolved.
    File(PathBuf),
    /// Something that can be written to, but not replaced.
    Device,
}

impl Target {
    fn of(path: &Path) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory)),
            Ok(metadata) if !metadata.is_file() => Ok(Self::Device),
            Ok(metadata) if metadata.permissions().readonly() => Err(io::Error::from(io::ErrorKind::PermissionDenied)),
            Ok(_) => fs::canonicalize(path).map(Self::File),
            Err(error) if error.kind() == io::ErrorKind::NotFound && path.file_name().is_some() => {
                Ok(Self::File(path.to_owned()))
            }
            Err(error) => Err(error),
        }
    }
}

fn temporary_beside(target: &Path) -> io::Result<NamedTempFile> {
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let mut prefix = OsStr::new(".").to_owned();
    prefix.push(target.file_name().unwrap_or_default());
    prefix.push(".");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What any new file gets: the process' mask is applied to it.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let temporary = builder.tempfile_in(folder).map_err(without_path)?;
    if let Ok(metadata) = fs::metadata(target) {
        temporary.as_file().set_permissions(metadata.permissions())?;
    }
    Ok(temporary)
}

/// The bare reason: tempfile appends the path of the temporary file, which nobody asked for.
fn without_path(error: io::Error) -> io::Error {
    let message = error.to_string();
    match message.rsplit_once(" at path ") {
        Some((reason, _)) => io::Error::new(error.kind(), reason.to_owned()),
        None => error,
    }
}
