//! Renderings, and parts of renderings, in files.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use scene_core::RayCounts;
use scene_core::film::{Film, FilmError, FilmStateError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{OutputError, write_atomically};

/// A checkpoint that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The operating system refused.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// The contents.
    #[error("{}: {reason}", .path.display())]
    Contents {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        reason: String,
    },
    /// It is of another rendering.
    #[error("the parts are of different renderings: '{}' and '{}'", plain(.one), plain(.other))]
    Different {
        /// A setting of one.
        one: String,
        /// And of the other.
        other: String,
    },
    /// Samples that are in both.
    #[error("samples {} to {} are in both parts", .0[0], .0[1])]
    Overlap([u64; 2]),
    /// Their sizes.
    #[error(transparent)]
    Film(#[from] FilmError),
}

/// What a checkpoint tells about its film.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Described {
    /// Everything that decides on the samples: lines of a setting each.
    pub rendering: Vec<String>,
    /// Samples per pixel of the whole rendering; zero if nobody knows.
    pub planned: u64,
    /// Those that are here: ranges from the first to before the last, in order, none next to another.
    pub samples: Vec<[u64; 2]>,
    /// Light paths so far.
    pub light_paths: u64,
    /// Rays that asked for the closest hit, and whether there is any.
    pub rays: [u64; 2],
    /// Time spent.
    pub seconds: f64,
    /// Attributes of the image.
    pub attributes: BTreeMap<String, String>,
    /// Sides of the tile of a discontinuity buffer, if it is to smooth the image.
    pub smoothing: Option<[u32; 2]>,
}

/// A rendering, or a part of it: the exact sums of its film, and what they are of.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// What it is.
    pub described: Described,
    /// Its sums.
    pub film: Film,
}

const MAGIC: &[u8; 24] = b"Lichtwerk checkpoint 01\n";
/// Descriptions are about a thousand bytes.
const MAX_DESCRIPTION: u64 = 1 << 20;

impl Described {
    /// Samples per pixel that are here.
    pub fn count(&self) -> u64 {
        self.samples.iter().map(|[first, last]| last - first).sum()
    }

    /// Rays so far.
    pub fn ray_counts(&self) -> RayCounts {
        RayCounts { closest_hit: self.rays[0], visibility: self.rays[1] }
    }

    /// That both are parts of one rendering.
    ///
    /// # Errors
    /// [`CheckpointError::Different`] with the first setting that differs.
    pub fn check_same(&self, other: &Self) -> Result<(), CheckpointError> {
        let plan = |described: &Self| format!("{} samples per pixel", described.planned);
        let lines = |described: &Self| [&described.rendering[..], &[plan(described)]].concat();
        let (one, other) = (lines(self), lines(other));
        let differs = one.iter().zip(&other).find(|(one, other)| one != other);
        match differs {
            Some((one, other)) => Err(CheckpointError::Different { one: one.clone(), other: other.clone() }),
            None if one.len() != other.len() => {
                Err(CheckpointError::Different { one: one.len().to_string(), other: other.len().to_string() })
            }
            None => Ok(()),
        }
    }
}

/// A setting as it was written for comparison, in less code: `size: Some( [ 48, 36, ], ),` is `size: 48, 36`.
fn plain(line: &str) -> String {
    let words = line.replace("Some(", " ").replace(['[', ']', '(', ')', '{', '}', '"'], " ");
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    words.replace(" ,", ",").replace(",,", ",").trim_end_matches([',', ' ']).to_owned()
}

impl Checkpoint {
    /// Adds another part of the same rendering. Sums are exact, so the order of the parts does not matter.
    ///
    /// # Errors
    /// If it is no part of it, or has samples that are here already.
    pub fn absorb(&mut self, other: &Self) -> Result<(), CheckpointError> {
        self.described.check_same(&other.described)?;
        let samples = union(&self.described.samples, &other.described.samples)?;
        self.film.merge(&other.film)?;
        let described = &mut self.described;
        described.samples = samples;
        described.light_paths += other.described.light_paths;
        described.seconds += other.described.seconds;
        described.rays = [0, 1].map(|k| described.rays[k] + other.described.rays[k]);
        Ok(())
    }

    /// Reads a file that [`write`](Self::write) wrote.
    ///
    /// # Errors
    /// If it cannot be read, or is something else, or damaged. Memory grows with the file, whatever it claims.
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        let file = File::open(path).map_err(|source| CheckpointError::Read { path: path.to_owned(), source })?;
        Self::read_from(BufReader::new(file))
            .map_err(|reason| CheckpointError::Contents { path: path.to_owned(), reason })
    }

    /// [`read`](Self::read) from anywhere.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn read_from(mut reader: impl Read) -> Result<Self, String> {
        let mut magic = [0; MAGIC.len()];
        let mut length = [0; 8];
        let head = reader.read_exact(&mut magic).and_then(|()| reader.read_exact(&mut length));
        if head.is_err() || magic != *MAGIC {
            return Err("this is not a checkpoint".to_owned());
        }
        let length = u64::from_le_bytes(length);
        if length > MAX_DESCRIPTION {
            return Err(format!("a description of {length} bytes"));
        }
        let mut text = Vec::new();
        reader.by_ref().take(length).read_to_end(&mut text).map_err(|error| error.to_string())?;
        let described: Described = serde_json::from_slice(&text).map_err(|error| error.to_string())?;
        let ordered = described.samples.windows(2).all(|pair| pair[0][1] < pair[1][0]);
        if !ordered || described.samples.iter().any(|[first, last]| first >= last) {
            return Err("its ranges of samples are none".to_owned());
        }
        let film = Film::read_state(reader).map_err(|error: FilmStateError| error.to_string())?;
        Ok(Self { described, film })
    }

    /// Writes it, [atomically](write_atomically).
    ///
    /// # Errors
    /// [`OutputError`], which names the file.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_atomically(path, |file| self.write_to(file))
    }

    /// [`write`](Self::write) to anywhere.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_to(&self, mut writer: impl Write) -> io::Result<()> {
        let text = serde_json::to_vec(&self.described)?;
        writer.write_all(MAGIC)?;
        writer.write_all(&(text.len() as u64).to_le_bytes())?;
        writer.write_all(&text)?;
        self.film.write_state(writer)
    }
}

/// Both ranges together; neighbours become one.
fn union(one: &[[u64; 2]], other: &[[u64; 2]]) -> Result<Vec<[u64; 2]>, CheckpointError> {
    let mut all: Vec<[u64; 2]> = one.iter().chain(other).copied().collect();
    all.sort_unstable();
    let mut united: Vec<[u64; 2]> = Vec::new();
    for range in all {
        match united.last_mut() {
            Some(last) if range[0] < last[1] => {
                return Err(CheckpointError::Overlap([range[0], last[1].min(range[1])]));
            }
            Some(last) if range[0] == last[1] => last[1] = range[1],
            _ => united.push(range),
        }
    }
    Ok(united)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(rendering: &[&str], samples: [u64; 2]) -> Checkpoint {
        let mut film = Film::new(2, 1).unwrap();
        for sample in samples[0]..samples[1] {
            film.pixel_mut(0, 0).add([0.1 * sample as f32, 1.0, 1e-3]);
        }
        let described = Described {
            rendering: rendering.iter().map(|&line| line.to_owned()).collect(),
            planned: 8,
            samples: vec![samples],
            light_paths: 3,
            rays: [5, 7],
            ..Described::default()
        };
        Checkpoint { described, film }
    }

    #[test]
    fn settings_are_named_without_code() {
        assert_eq!(plain("size: Some( [ 48, 36, ], ),"), "size: 48, 36");
        assert_eq!(plain("seed: 1,"), "seed: 1");
        assert_eq!(plain("4 samples per pixel"), "4 samples per pixel");
        assert_eq!(plain("estimator: Bdpt,"), "estimator: Bdpt");
    }

    #[test]
    fn parts_in_any_order_are_the_whole() {
        let whole = part(&["seed: 1"], [0, 8]);
        let mut parts = part(&["seed: 1"], [5, 8]);
        parts.absorb(&part(&["seed: 1"], [0, 2])).unwrap();
        assert_eq!((parts.described.samples.as_slice(), parts.described.count()), (&[[0, 2], [5, 8]][..], 5));
        parts.absorb(&part(&["seed: 1"], [2, 5])).unwrap();
        assert_eq!(parts.film, whole.film);
        assert_eq!(parts.described.samples, [[0, 8]]);
        assert_eq!((parts.described.light_paths, parts.described.rays), (9, [15, 21]));
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let mut one = part(&["seed: 1", "rough: 2"], [0, 4]);
        let error = one.absorb(&part(&["seed: 1", "rough: 3"], [4, 8])).unwrap_err().to_string();
        assert!(error.contains("'rough: 2'") && error.contains("'rough: 3'"), "{error}");
        let error = one.absorb(&part(&["seed: 1", "rough: 2"], [3, 5])).unwrap_err().to_string();
        assert!(error.contains("samples 3 to 4"), "{error}");
        let longer = Described { planned: 16, ..one.described.clone() };
        let error = one.described.check_same(&longer).unwrap_err().to_string();
        assert!(error.contains("'16 samples per pixel'"), "{error}");
    }

    #[test]
    fn files_come_back_and_damaged_ones_have_reasons() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        let checkpoint = part(&["seed: 1"], [0, 4]);
        checkpoint.write(&path).unwrap();
        assert_eq!(Checkpoint::read(&path).unwrap(), checkpoint);
        let bytes = std::fs::read(&path).unwrap();
        for end in [0, 20, 30, 40, 200, bytes.len() - 1] {
            assert!(Checkpoint::read_from(&bytes[..end]).is_err(), "cut to {end} bytes");
        }
        let mut long = bytes.clone();
        long[24..32].copy_from_slice(&u64::MAX.to_le_bytes());
        assert!(Checkpoint::read_from(&long[..]).unwrap_err().contains("description"));
        let missing = Checkpoint::read(&folder.path().join("b")).unwrap_err().to_string();
        assert!(missing.contains("cannot read"), "{missing}");
    }
}
