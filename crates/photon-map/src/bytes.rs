//! Photons as bytes, for processes that trace a map together.

use thiserror::Error;

use crate::{Flux, PackedPhoton, Photons};

/// Flux as words of 32 bits.
///
/// Implemented for `f32`, `f64` and `[f32; 3]`.
///
/// **Law.** [`from_words`](Self::from_words) of what [`words`](Self::words) gives away, [`WORDS`](Self::WORDS) of them, is
/// the same flux, bit for bit.
pub trait FluxWords: Flux {
    /// How many.
    const WORDS: usize;
    /// Gives them away in order.
    fn words(self, give: impl FnMut(u32));
    /// Flux of as many words in the same order.
    #[must_use]
    fn from_words(take: impl FnMut() -> u32) -> Self;
}

impl FluxWords for f32 {
    const WORDS: usize = 1;

    fn words(self, mut give: impl FnMut(u32)) {
        give(self.to_bits());
    }

    fn from_words(mut take: impl FnMut() -> u32) -> Self {
        Self::from_bits(take())
    }
}

impl FluxWords for f64 {
    const WORDS: usize = 2;

    fn words(self, mut give: impl FnMut(u32)) {
        let bits = self.to_bits();
        give(bits as u32);
        give((bits >> 32) as u32);
    }

    fn from_words(mut take: impl FnMut() -> u32) -> Self {
        let low = u64::from(take());
        Self::from_bits(low | u64::from(take()) << 32)
    }
}

impl FluxWords for [f32; 3] {
    const WORDS: usize = 3;

    fn words(self, mut give: impl FnMut(u32)) {
        self.iter().for_each(|component| give(component.to_bits()));
    }

    fn from_words(mut take: impl FnMut() -> u32) -> Self {
        std::array::from_fn(|_| f32::from_bits(take()))
    }
}

/// Bytes that are no photons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PhotonBytesError {
    /// They end too early.
    #[error("{wanted} bytes of photons are wanted, and {found} are there")]
    Short {
        /// As many as their head announces.
        wanted: u64,
        /// As many as there are.
        found: usize,
    },
    /// They are something else.
    #[error("photon number {0} is none")]
    Photon(u64),
}

/// Numbers of photons, of paths and of refused photons.
const HEAD: usize = 24;

impl<F: FluxWords> Photons<F> {
    /// Bytes of a photon: 32 with RGB flux, 24 with one `f32`.
    const PHOTON_BYTES: usize = size_of::<u32>() * (PackedPhoton::<F>::OTHER_WORDS + F::WORDS);

    /// Appends all photons in order, little endian, to `bytes`: 24 bytes, and 32 for each photon with RGB flux. Nothing is
    /// rounded.
    ///
    /// # Example
    /// One process traces the paths 0 to 49, another one 50 to 99. Put together in the order of the paths, theirs are the
    /// photons that one process would have.
    /// ```
    /// use photon_map::{Photon, Photons};
    /// let traced = |x: f32| {
    ///     let mut photons = Photons::new();
    ///     photons.store(Photon::new([x, 0.1, 0.0], [0.6, 0.0, 0.8], [0.3, 0.2, 0.1_f32]).from_light(7));
    ///     photons.add_paths(50);
    ///     photons
    /// };
    /// let mut message = Vec::new();
    /// traced(2.0).write_bytes(&mut message);
    /// assert_eq!(message.len(), 24 + 32);
    ///
    /// let mut all = traced(1.0);
    /// all.append(Photons::read_bytes(&mut &message[..])?);
    /// assert_eq!((all.len(), all.paths()), (2, 100));
    /// assert_eq!(all.as_slice()[1], traced(2.0).as_slice()[0]);
    /// # Ok::<(), photon_map::PhotonBytesError>(())
    /// ```
    pub fn write_bytes(&self, bytes: &mut Vec<u8>) {
        bytes.reserve(HEAD + self.len() * Self::PHOTON_BYTES);
        for number in [self.len() as u64, self.paths(), self.refused()] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        for photon in self.as_slice() {
            photon.words(|word| bytes.extend_from_slice(&word.to_le_bytes()));
        }
    }

    /// Reads what [`write_bytes`](Self::write_bytes) wrote from the front of `bytes`, and leaves the rest in it.
    ///
    /// # Errors
    /// [`PhotonBytesError`]; `bytes` is then as it was. Memory grows with the bytes that are there, whatever number they
    /// claim.
    pub fn read_bytes(bytes: &mut &[u8]) -> Result<Self, PhotonBytesError> {
        let short = |wanted: u64| PhotonBytesError::Short { wanted, found: bytes.len() };
        let (head, body) = bytes.split_at_checked(HEAD).ok_or_else(|| short(HEAD as u64))?;
        let mut numbers = head.as_chunks().0.iter().map(|&number| u64::from_le_bytes(number));
        let [count, paths, refused] = std::array::from_fn(|_| numbers.next().unwrap_or(0));
        let length = count.saturating_mul(Self::PHOTON_BYTES as u64);
        let wanted = length.saturating_add(HEAD as u64);
        let (body, rest) = usize::try_from(length)
            .ok()
            .and_then(|length| body.split_at_checked(length))
            .ok_or_else(|| short(wanted))?;
        let photon = |(number, bytes): (u64, &[u8])| {
            let mut words = bytes.as_chunks().0.iter().map(|&word| u32::from_le_bytes(word));
            PackedPhoton::from_words(|| words.next().unwrap_or(0)).ok_or(PhotonBytesError::Photon(number))
        };
        let photons = (0..).zip(body.chunks_exact(Self::PHOTON_BYTES)).map(photon).collect::<Result<Vec<_>, _>>()?;
        *bytes = rest;
        Ok(Self::from_parts(photons, paths, refused))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Photon;
    use proptest::prelude::*;

    fn some<F: Flux>(flux: impl Fn(f32) -> F, count: u32) -> Photons<F> {
        let mut photons = Photons::new();
        for k in 0..count {
            let x = k as f32 + 0.1;
            let photon = Photon::new([x, -x, 1e-30], [x.sin(), x.cos(), 0.3], flux(x));
            let photon = Photon { primary: k % 2 == 0, caustic: k % 3 == 0, ..photon };
            photons.store(if k % 5 == 0 { photon } else { photon.from_light(k) });
        }
        photons.store(Photon::new([f32::NAN; 3], [1.0; 3], flux(0.0)));
        photons.add_paths(1 << 40);
        photons
    }

    fn round_trip<F: FluxWords + PartialEq + std::fmt::Debug>(photons: &Photons<F>, bytes_each: usize) {
        let mut bytes = Vec::new();
        photons.write_bytes(&mut bytes);
        assert_eq!(bytes.len(), 24 + bytes_each * photons.len());
        bytes.extend([1, 2, 3]);
        let mut rest = &bytes[..];
        let read = Photons::<F>::read_bytes(&mut rest).unwrap();
        assert_eq!(rest, [1, 2, 3]);
        assert_eq!(read.as_slice(), photons.as_slice());
        assert_eq!((read.paths(), read.refused()), (photons.paths(), photons.refused()));
    }

    #[test]
    fn nothing_is_rounded() {
        for count in [0, 1, 20] {
            round_trip(&some(|x| x / 3.0, count), 24);
            round_trip(&some(|x| f64::from(x) / 3.0, count), 28);
            round_trip(&some(|x| [x, x / 3.0, -0.0], count), 32);
        }
    }

    #[test]
    fn what_is_no_photon_is_named() {
        let mut bytes = Vec::new();
        some(|x| [x; 3], 3).write_bytes(&mut bytes);
        let read = |bytes: &[u8]| Photons::<[f32; 3]>::read_bytes(&mut &bytes[..]).map(|photons| photons.len());
        assert_eq!(read(&bytes[..10]), Err(PhotonBytesError::Short { wanted: 24, found: 10 }));
        assert_eq!(read(&bytes[..119]), Err(PhotonBytesError::Short { wanted: 120, found: 119 }));
        // A position that is not a number, a direction that is none.
        for (at, word) in [(24 + 32, f32::NAN.to_bits()), (24 + 32 + 12, 7)] {
            let mut bad = bytes.clone();
            bad[at..at + 4].copy_from_slice(&word.to_le_bytes());
            assert_eq!(read(&bad), Err(PhotonBytesError::Photon(1)));
        }
        bytes[..8].copy_from_slice(&u64::MAX.to_le_bytes());
        assert!(matches!(read(&bytes), Err(PhotonBytesError::Short { wanted: u64::MAX, .. })));
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200), count in 0..6_u64) {
            let mut bytes = bytes;
            if let Some(head) = bytes.get_mut(..8) {
                head.copy_from_slice(&count.to_le_bytes());
            }
            let mut rest = &bytes[..];
            if let Ok(photons) = Photons::<f32>::read_bytes(&mut rest) {
                prop_assert_eq!(photons.len() as u64, count);
                let mut again = Vec::new();
                photons.write_bytes(&mut again);
                prop_assert_eq!(&again[..], &bytes[..bytes.len() - rest.len()]);
            }
        }
    }
}
