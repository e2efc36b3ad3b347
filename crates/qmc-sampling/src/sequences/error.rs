//! What can be wrong with the parameters of a sequence.
use core::fmt;

/// Why a sequence could not be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SequenceError {
    /// A base below two.
    BaseTooSmall(u32),
    /// A base that is no prime.
    NotPrime(u32),
    /// Zero, or more dimensions than there are numbers for.
    Dimensions {
        /// How many were asked for.
        asked: u32,
        /// How many there are.
        limit: u32,
    },
    /// A set of no points, or a grid with a side of zero.
    NoPoints,
    /// An image of more pixels than the sequence has points.
    ImageTooLarge {
        /// The width in pixels.
        width: u32,
        /// The height in pixels.
        height: u32,
    },
}

impl fmt::Display for SequenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BaseTooSmall(base) => write!(f, "base {base} is below 2"),
            Self::NotPrime(base) => write!(f, "base {base} is no prime"),
            Self::Dimensions { asked, limit } => write!(f, "{asked} dimensions, of 1 to {limit}"),
            Self::NoPoints => write!(f, "there are no points"),
            Self::ImageTooLarge { width, height } => {
                write!(f, "{width} x {height} pixels are too many for the sequence")
            }
        }
    }
}

impl core::error::Error for SequenceError {}
