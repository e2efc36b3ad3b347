//! Processes that render together, on one machine or many.
//!
//! - [`Ranks`]: the processes, and what they do together. One process is the case of one rank, and everything else in this
//!   crate is written for any number.
//! - [`Portable`]: what travels.
//! - [`Link`]: how bytes travel; by MPI with the feature `mpi`.
//! - [`start`]: finds out which process this is.
//!
//! Each rank renders its own samples (`lichtwerk render --shard`) and needs the others twice: for the light paths that all
//! samples share, of which it traces its part ([`Ranks::gather`]), and for the image ([`Ranks::reduce`]). Both give the same
//! bits as one process: light paths are put together in the order of their numbers, and the sums of a film are exact.

mod gather;
mod launch;
mod link;
#[cfg(feature = "mpi")]
mod mpi;
#[cfg(test)]
mod threads;
mod tree;

use std::fmt;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub use launch::{StartError, launched_rank, start};
pub use link::Link;

/// What ranks send each other.
pub trait Portable: Sized {
    /// What it is called in messages for the user.
    const NAME: &'static str;

    /// All of it, bit for bit.
    fn to_bytes(&self) -> Vec<u8>;

    /// What [`to_bytes`](Self::to_bytes) made bytes of.
    ///
    /// # Errors
    /// What is wrong with them.
    fn from_bytes(bytes: &[u8]) -> Result<Self, String>;

    /// Adds that of ranks behind.
    ///
    /// # Errors
    /// Why it does not fit.
    fn join(&mut self, behind: Self) -> Result<(), String>;
}

/// Why ranks cannot go on together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RanksError {
    /// All failed alike, or this is the only process.
    #[error("{0}")]
    All(String),
    /// Some failed.
    #[error("rank {rank}: {message}")]
    Rank {
        /// The first that did.
        rank: usize,
        /// What it said.
        message: String,
    },
    /// One waits for another thing than the others.
    #[error("the ranks do not do the same: they need the same program, arguments and files")]
    Apart,
}

/// The processes of this run.
///
/// All methods that return a [`RanksError`] are **collective**: every rank has to call them, in the same order. A rank that
/// fails calls [`agree`](Self::agree) with its error: the others learn of it wherever they wait, and all go on with an error.
///
/// ```
/// use lichtwerk::distributed::Ranks;
/// let alone = Ranks::default();
/// assert_eq!((alone.rank(), alone.size(), alone.share(100)), (0, 1, 0..100));
/// assert_eq!(alone.agree(Err::<(), _>("no scene")).unwrap_err().to_string(), "no scene");
/// ```
#[derive(Clone, Default)]
pub struct Ranks(Option<Arc<Linked>>);

struct Linked {
    link: Box<dyn Link>,
    /// Whether one failed, which all know.
    failed: AtomicBool,
    gathered: AtomicU64,
    received: AtomicU64,
}

impl fmt::Debug for Ranks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "rank {} of {}", self.rank(), self.size())
    }
}

/// Bytes that travelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Of everything that was [gathered](Ranks::gather): every rank has them all.
    pub gathered: u64,
    /// That this rank received to [reduce](Ranks::reduce) them.
    pub received: u64,
}

impl Ranks {
    /// Those that a link joins.
    pub fn over(link: impl Link + 'static) -> Self {
        let [gathered, received] = [0, 0].map(AtomicU64::new);
        Self(Some(Arc::new(Linked { link: Box::new(link), failed: AtomicBool::new(false), gathered, received })))
    }

    /// Number of this one, from 0.
    pub fn rank(&self) -> usize {
        self.0.as_ref().map_or(0, |linked| linked.link.rank())
    }

    /// How many there are.
    pub fn size(&self) -> usize {
        self.0.as_ref().map_or(1, |linked| linked.link.size())
    }

    /// Whether this is the one that talks to the user and writes the image.
    pub fn is_first(&self) -> bool {
        self.rank() == 0
    }

    /// Whether there are others.
    pub fn are_several(&self) -> bool {
        self.size() > 1
    }

    /// This rank's of so many things: a contiguous range. All ranks together have each once, in the order of the ranks.
    pub fn share(&self, all: u64) -> Range<u64> {
        share(self.rank() as u64, self.size() as u64, all)
    }

    /// Bytes so far.
    pub fn traffic(&self) -> Traffic {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        self.0.as_ref().map_or(Traffic::default(), |linked| Traffic {
            gathered: read(&linked.gathered),
            received: read(&linked.received),
        })
    }
}

/// Part number `part`, from 0, of so many equal ones.
pub(crate) fn share(part: u64, of: u64, all: u64) -> Range<u64> {
    let boundary = |k: u64| (u128::from(all) * u128::from(k) / u128::from(of)) as u64;
    boundary(part)..boundary(part + 1)
}
