//! A film as bytes, so that a rendering can be continued, or put together from parts.

use std::io::{self, Read, Write};

use thiserror::Error;

use super::accumulation::check_size;
use super::splat::{SplatLayer, SplatPixel};
use super::sum::Sum;
use super::{Film, FilmError, Pixel};

/// Bytes that are no film.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FilmStateError {
    /// They cannot be read, or end too early.
    #[error("the stored film cannot be read: {0}")]
    Read(#[from] io::Error),
    /// They are something else.
    #[error("this is not a stored film")]
    Format,
    /// The size.
    #[error("stored film: {0}")]
    Film(#[from] FilmError),
    /// They were changed.
    #[error("the stored film is damaged")]
    Damaged,
}

const MAGIC: &[u8; 8] = b"LWFILM\x01\n";
/// The pixel's 13 sums of two parts, and three counts.
const PIXEL_WORDS: usize = 29;
const SPLAT_WORDS: usize = 12;

impl Film {
    /// Writes all sums, bit for bit: 232 bytes for each pixel, 96 more with splats, little endian, and a checksum (CRC-32).
    ///
    /// ```
    /// use scene_core::film::{Film, FilmStateError};
    ///
    /// let mut film = Film::new(3, 2)?;
    /// film.pixel_mut(1, 1).add([0.1, 0.2, 0.3]);
    /// let mut bytes = Vec::new();
    /// film.write_state(&mut bytes)?;
    /// assert_eq!(Film::read_state(&bytes[..])?, film);
    ///
    /// bytes[100] ^= 1;
    /// assert!(matches!(Film::read_state(&bytes[..]), Err(FilmStateError::Damaged)));
    /// # Ok::<(), FilmStateError>(())
    /// ```
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_state(&self, writer: impl Write) -> io::Result<()> {
        let mut out = Checked { inner: writer, checksum: crc32fast::Hasher::new() };
        out.write_all(MAGIC)?;
        out.write_all(&self.width().to_le_bytes())?;
        out.write_all(&self.height().to_le_bytes())?;
        let has_splats = !self.splats.pixels.is_empty();
        out.write_all(&u64::from(has_splats).to_le_bytes())?;
        out.write_all(&self.splats.rejected.to_le_bytes())?;
        for pixel in self.pixels() {
            out.words(&pixel.to_words())?;
        }
        for pixel in &self.splats.pixels {
            out.words(&pixel.to_words())?;
        }
        let Checked { mut inner, checksum } = out;
        inner.write_all(&checksum.finalize().to_le_bytes())
    }

    /// Reads what [`write_state`](Self::write_state) wrote.
    ///
    /// # Errors
    /// [`FilmStateError`]. Memory grows with the bytes that are there, whatever size they claim.
    pub fn read_state(reader: impl Read) -> Result<Self, FilmStateError> {
        let mut input = Checked { inner: reader, checksum: crc32fast::Hasher::new() };
        if input.bytes::<8>()? != *MAGIC {
            return Err(FilmStateError::Format);
        }
        let width = u32::from_le_bytes(input.bytes()?);
        let height = u32::from_le_bytes(input.bytes()?);
        let count = check_size(width, height)?;
        let has_splats = match u64::from_le_bytes(input.bytes()?) {
            0 => false,
            1 => true,
            _ => return Err(FilmStateError::Damaged),
        };
        let rejected = u64::from_le_bytes(input.bytes()?);
        let mut pixels = Vec::new();
        for _ in 0..count {
            pixels.push(Pixel::from_words(&input.read_words()?).ok_or(FilmStateError::Damaged)?);
        }
        let mut splats = SplatLayer { pixels: Vec::new(), rejected };
        for _ in 0..if has_splats { count } else { 0 } {
            splats.pixels.push(SplatPixel::from_words(&input.read_words()?).ok_or(FilmStateError::Damaged)?);
        }
        let checksum = input.checksum.clone().finalize();
        if u32::from_le_bytes(input.bytes()?) != checksum {
            return Err(FilmStateError::Damaged);
        }
        Ok(Self::from_parts(width, height, pixels, splats))
    }
}

/// A reader or writer that sums up what passes.
struct Checked<T> {
    inner: T,
    checksum: crc32fast::Hasher,
}

impl<W: Write> Checked<W> {
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.checksum.update(bytes);
        self.inner.write_all(bytes)
    }

    fn words<const N: usize>(&mut self, words: &[u64; N]) -> io::Result<()> {
        words.iter().try_for_each(|word| self.write_all(&word.to_le_bytes()))
    }
}

impl<R: Read> Checked<R> {
    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.inner.read_exact(&mut bytes)?;
        self.checksum.update(&bytes);
        Ok(bytes)
    }

    fn read_words<const N: usize>(&mut self) -> io::Result<[u64; N]> {
        let mut words = [0; N];
        for word in &mut words {
            *word = u64::from_le_bytes(self.bytes()?);
        }
        Ok(words)
    }
}

/// Two words for each sum, from the front.
fn put(words: &mut [u64], sums: &[Sum]) {
    for (words, sum) in words.chunks_exact_mut(2).zip(sums) {
        words.copy_from_slice(&sum.parts().map(f64::to_bits));
    }
}

fn take(words: &[u64], first: usize) -> Option<Sum> {
    Sum::from_parts([f64::from_bits(*words.get(2 * first)?), f64::from_bits(*words.get(2 * first + 1)?)])
}

fn take3(words: &[u64], first: usize) -> Option<[Sum; 3]> {
    Some([take(words, first)?, take(words, first + 1)?, take(words, first + 2)?])
}

impl Pixel {
    fn to_words(self) -> [u64; PIXEL_WORDS] {
        let mut words = [0; PIXEL_WORDS];
        for (k, sums) in [self.sum, self.sum_squares, self.albedo, self.normal].iter().enumerate() {
            put(&mut words[6 * k..6 * k + 6], sums);
        }
        put(&mut words[24..26], &[self.depth]);
        words[26..].copy_from_slice(&[self.samples, self.aov_samples, self.rejected]);
        words
    }

    fn from_words(words: &[u64; PIXEL_WORDS]) -> Option<Self> {
        Some(Self {
            sum: take3(words, 0)?,
            sum_squares: take3(words, 3)?,
            albedo: take3(words, 6)?,
            normal: take3(words, 9)?,
            depth: take(words, 12)?,
            samples: words[26],
            aov_samples: words[27],
            rejected: words[28],
        })
    }
}

impl SplatPixel {
    fn to_words(self) -> [u64; SPLAT_WORDS] {
        let mut words = [0; SPLAT_WORDS];
        put(&mut words[..6], &self.sum);
        put(&mut words[6..], &self.sum_squares);
        words
    }

    fn from_words(words: &[u64; SPLAT_WORDS]) -> Option<Self> {
        Some(Self { sum: take3(words, 0)?, sum_squares: take3(words, 3)? })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Filter, SplatBuffer};
    use super::*;
    use proptest::prelude::*;

    fn stored() -> (Film, Vec<u8>) {
        let mut film = Film::new(4, 3).unwrap();
        film.pixel_mut(2, 1).add([1.0, 0.1, 3e-7]);
        film.pixel_mut(2, 1).add([0.3, f32::NAN, 1.0]);
        film.pixel_mut(0, 2).add_aov([0.5; 3], [0.0, 0.6, 0.8], 2.5);
        let mut splats = SplatBuffer::new(4, 3, Filter::BOX);
        splats.add([1.5, 1.5], [0.7, 0.2, 0.1]);
        splats.add([f32::NAN, 0.0], [1.0; 3]);
        film.add_splats(&splats).unwrap();
        let mut bytes = Vec::new();
        film.write_state(&mut bytes).unwrap();
        (film, bytes)
    }

    #[test]
    fn every_sum_comes_back() {
        let (film, bytes) = stored();
        assert_eq!(bytes.len(), 8 + 8 + 16 + 12 * (232 + 96) + 4);
        let read = Film::read_state(&bytes[..]).unwrap();
        assert_eq!(read, film);
        assert_eq!(read.develop(7), film.develop(7));
        assert_eq!(read.rejected_samples(), 2);
    }

    #[test]
    fn a_huge_size_without_bytes_is_refused() {
        let (_, mut bytes) = stored();
        bytes[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(matches!(Film::read_state(&bytes[..]), Err(FilmStateError::Film(FilmError::TooLarge { .. }))));
        bytes[8..12].copy_from_slice(&10_000u32.to_le_bytes());
        assert!(matches!(Film::read_state(&bytes[..]), Err(FilmStateError::Read(_) | FilmStateError::Damaged)));
        assert!(matches!(Film::read_state(&b"something else"[..]), Err(FilmStateError::Format)));
    }

    proptest! {
        #[test]
        fn damage_is_found(at in any::<prop::sample::Index>(), flip in 1u8.., cut in any::<prop::sample::Index>()) {
            let (_, mut bytes) = stored();
            let end = cut.index(bytes.len());
            prop_assert!(Film::read_state(&bytes[..end]).is_err());
            let at = at.index(bytes.len());
            bytes[at] ^= flip;
            prop_assert!(Film::read_state(&bytes[..]).is_err());
        }
    }
}
