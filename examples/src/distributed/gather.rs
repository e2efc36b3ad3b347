//! What all ranks learn of each other.

use std::fmt::Display;
use std::ops::Range;
use std::sync::atomic::Ordering;

use super::{Linked, Portable, Ranks, RanksError};

/// What a rank has come to a meeting for. All bring one of these before anything else travels, so that nobody waits for a rank
/// that will not come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Purpose {
    kind: u64,
    /// Bytes that it has.
    length: u64,
}

const FAILED: u64 = 0;
const AGREED: u64 = 1;
const PURPOSE_BYTES: usize = 16;
/// The user reads a line, not a book.
const MESSAGE_BYTES: usize = 4096;

impl Purpose {
    /// To gather things of that name.
    fn gather(name: &str, length: usize) -> Self {
        // FNV-1a: the same in every process.
        let hash = name
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
        Self { kind: hash | 1 << 63, length: length as u64 }
    }

    fn to_bytes(self) -> [u8; PURPOSE_BYTES] {
        (u128::from(self.kind) << 64 | u128::from(self.length)).to_le_bytes()
    }

    fn from_bytes(bytes: [u8; PURPOSE_BYTES]) -> Self {
        let both = u128::from_le_bytes(bytes);
        Self { kind: (both >> 64) as u64, length: both as u64 }
    }
}

impl Ranks {
    /// Goes on if all ranks have come so far without an error.
    ///
    /// # Errors
    /// That of the first rank that has one; the same at every rank. Once it has been told, all others are.
    pub fn agree<T, E: Display>(&self, own: Result<T, E>) -> Result<T, RanksError> {
        let Some(linked) = &self.0 else { return own.map_err(|error| RanksError::All(error.to_string())) };
        if linked.failed.load(Ordering::Relaxed) {
            return own.map_err(|error| RanksError::All(error.to_string()));
        }
        match own {
            Ok(value) => linked.meet(Purpose { kind: AGREED, length: 0 }, b"").map(|_| value),
            Err(error) => {
                let message = error.to_string();
                let bytes = &message.as_bytes()[..message.len().min(MESSAGE_BYTES)];
                let purpose = Purpose { kind: FAILED, length: bytes.len() as u64 };
                Err(linked.meet(purpose, bytes).map_or_else(|error| error, |_| RanksError::All(message)))
            }
        }
    }

    /// Whether it is so at one rank or more.
    ///
    /// # Errors
    /// If a rank has failed.
    pub fn any(&self, own: bool) -> Result<bool, RanksError> {
        let Some(linked) = &self.0 else { return Ok(own) };
        Ok(linked.all_gather("work", &[u8::from(own)])?.contains(&vec![1]))
    }

    /// What all ranks have, in the order of the ranks.
    ///
    /// **Cost.** Every rank sends its part to all, and has all in memory twice for a moment. In rounds, if that is more than the
    /// link may move at once.
    ///
    /// # Errors
    /// If a rank has failed.
    pub fn gather<T: Portable>(&self, own: T) -> Result<T, RanksError> {
        let Some(linked) = &self.0 else { return Ok(own) };
        let bytes = own.to_bytes();
        drop(own);
        let parts = linked.all_gather(T::NAME, &bytes)?;
        drop(bytes);
        linked.gathered.fetch_add(parts.iter().map(|part| part.len() as u64).sum(), Ordering::Relaxed);
        let mut all: Option<T> = None;
        for (rank, part) in parts.into_iter().enumerate() {
            let read = T::from_bytes(&part).and_then(|part| match &mut all {
                None => {
                    all = Some(part);
                    Ok(())
                }
                Some(all) => all.join(part),
            });
            read.map_err(|reason| RanksError::Rank { rank, message: format!("{}: {reason}", T::NAME) })?;
        }
        all.ok_or(RanksError::Apart)
    }
}

impl Linked {
    /// The bytes of each rank.
    fn all_gather(&self, name: &str, own: &[u8]) -> Result<Vec<Vec<u8>>, RanksError> {
        let lengths = self.meet(Purpose::gather(name, own.len()), b"")?;
        let mut parts: Vec<Vec<u8>> = lengths.iter().map(|&length| Vec::with_capacity(length)).collect();
        for piece in pieces(&lengths, self.link.largest()) {
            let within = |length: usize| piece.start.min(length)..piece.end.min(length);
            let lengths: Vec<usize> = lengths.iter().map(|&length| within(length).len()).collect();
            let bytes = self.link.all_gather(&own[within(own.len())], &lengths);
            let mut rest = &bytes[..];
            for (part, length) in parts.iter_mut().zip(lengths) {
                let (head, tail) = rest.split_at(length);
                part.extend_from_slice(head);
                rest = tail;
            }
        }
        Ok(parts)
    }

    /// Comes together with the others, and finds out how many bytes each has.
    fn meet(&self, own: Purpose, message: &[u8]) -> Result<Vec<usize>, RanksError> {
        let bytes = self.link.all_gather(&own.to_bytes(), &vec![PURPOSE_BYTES; self.link.size()]);
        let purposes: Vec<Purpose> = bytes.as_chunks().0.iter().map(|&bytes| Purpose::from_bytes(bytes)).collect();
        let lengths = purposes.iter().map(|purpose| purpose.length as usize);
        if purposes.iter().any(|purpose| purpose.kind == FAILED) {
            let lengths: Vec<usize> = lengths
                .zip(&purposes)
                .map(|(length, purpose)| if purpose.kind == FAILED { length } else { 0 })
                .collect();
            let text = self.link.all_gather(message, &lengths);
            self.failed.store(true, Ordering::Relaxed);
            return Err(what_failed(&purposes, &text));
        }
        if purposes.iter().any(|purpose| purpose.kind != own.kind) {
            self.failed.store(true, Ordering::Relaxed);
            return Err(RanksError::Apart);
        }
        Ok(lengths.collect())
    }
}

/// The error of the ranks that failed, whose messages follow each other.
fn what_failed(purposes: &[Purpose], mut text: &[u8]) -> RanksError {
    let mut messages = Vec::new();
    for (rank, purpose) in purposes.iter().enumerate().filter(|(_, purpose)| purpose.kind == FAILED) {
        let (message, rest) = text.split_at((purpose.length as usize).min(text.len()));
        messages.push((rank, String::from_utf8_lossy(message).into_owned()));
        text = rest;
    }
    let (rank, message) = messages.first().cloned().unwrap_or_default();
    if messages.len() == purposes.len() && messages.iter().all(|(_, other)| *other == message) {
        RanksError::All(message)
    } else {
        RanksError::Rank { rank, message }
    }
}

/// Ranges of bytes, the same ones of every rank, of which those of all ranks together are at most `largest`.
fn pieces(lengths: &[usize], largest: usize) -> Vec<Range<usize>> {
    let longest = lengths.iter().copied().max().unwrap_or(0);
    let step = (largest / lengths.len().max(1)).max(1);
    (0..longest).step_by(step).map(|start| start..longest.min(start.saturating_add(step))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::threads::{Words, run};
    use super::*;

    #[test]
    fn all_have_everything_in_order() {
        for (size, largest) in [(1, 100), (2, 7), (3, 1000), (5, 1), (8, 64)] {
            let gathered = run(size, largest, |ranks| {
                let share = ranks.share(1000);
                ranks.gather(Words(share.map(|k| k * k).collect())).map(|words| (words, ranks.traffic()))
            });
            for all in gathered {
                let (Words(words), traffic) = all.unwrap();
                assert_eq!(words, (0..1000).map(|k| k * k).collect::<Vec<u64>>());
                assert_eq!(traffic.gathered, 8000);
            }
        }
    }

    #[test]
    fn some_have_nothing() {
        let gathered = run(4, 100, |ranks| {
            let any = [false, true].map(|own| ranks.any(own && ranks.rank() == 2));
            (any, ranks.gather(Words(if ranks.rank() == 2 { vec![7] } else { Vec::new() })))
        });
        for (any, words) in gathered {
            assert_eq!(any, [Ok(false), Ok(true)]);
            assert_eq!(words, Ok(Words(vec![7])));
        }
    }

    #[test]
    fn ranges_are_as_large_as_they_may_be() {
        assert_eq!(pieces(&[5, 0, 12], 15), [0..5, 5..10, 10..12]);
        assert!(pieces(&[5, 4], 1000).iter().eq([&(0..5)]));
        assert_eq!(pieces(&[2, 2], 1), [0..1, 1..2]);
        assert_eq!(pieces(&[0, 0], 10), []);
        assert_eq!(pieces(&[3_000_000_000], 1 << 30).len(), 3);
    }

    #[test]
    fn the_error_of_one_is_that_of_all_wherever_they_wait() {
        let failed = Err(RanksError::Rank { rank: 1, message: "disk full".into() });
        let results = run(3, 100, |ranks| match ranks.rank() {
            0 => ranks.gather(Words(vec![1])).map(|_| ()),
            1 => ranks.agree(Err::<(), _>("disk full")),
            _ => ranks.agree(Ok::<_, String>(())),
        });
        assert_eq!(results, [(); 3].map(|()| failed.clone()));

        // Nobody waits once it is known.
        let results = run(2, 100, |ranks| {
            let _ = ranks.agree(if ranks.rank() == 1 { Err("disk full") } else { Ok(()) });
            if ranks.rank() == 0 { ranks.agree(Err::<(), _>("the same again")) } else { Ok(()) }
        });
        assert_eq!(results, [Err(RanksError::All("the same again".into())), Ok(())]);
    }

    #[test]
    fn an_error_of_all_has_no_rank() {
        let results = run(3, 100, |ranks| ranks.agree(Err::<(), _>("no scene")));
        assert_eq!(results, [(); 3].map(|()| Err(RanksError::All("no scene".into()))));
        let results = run(2, 100, |ranks| ranks.agree(Err::<(), _>(format!("no scene {}", ranks.rank()))));
        assert_eq!(results[1], Err(RanksError::Rank { rank: 0, message: "no scene 0".into() }));
        let long = run(2, 100, |ranks| ranks.agree(Err::<(), _>("\u{e4}".repeat(5000))));
        assert!(matches!(&long[0], Err(RanksError::All(message)) if message.len() == MESSAGE_BYTES));
    }

    #[test]
    fn ranks_that_do_different_things_notice() {
        let results =
            run(
                2,
                100,
                |ranks| if ranks.is_first() { ranks.agree(Ok::<_, String>(())) } else { ranks.any(true).map(|_| ()) },
            );
        assert_eq!(results, [Err(RanksError::Apart), Err(RanksError::Apart)]);
    }
}
