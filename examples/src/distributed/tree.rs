//! A sum over ranks.

use std::sync::atomic::Ordering;

use super::{Linked, Portable, Ranks, RanksError};

/// What a message announces: whether its sender has failed, and how many bytes follow.
const HEAD: usize = 9;

impl Ranks {
    /// What all ranks have, joined in the order of the ranks; at rank 0, nothing elsewhere.
    ///
    /// ```text
    /// step 1:  0 <- 1   2 <- 3   4 <- 5   6 <- 7
    /// step 2:  0 <- 2            4 <- 6
    /// step 3:  0 <- 4
    /// ```
    /// **Cost.** Each but rank 0 sends once; rank 0 receives and joins `ceil(log2 N)` times, one after the other, and no rank
    /// has more than two of them in memory.
    ///
    /// # Errors
    /// At rank 0: what cannot be joined.
    pub fn reduce<T: Portable>(&self, own: T) -> Result<Option<T>, RanksError> {
        let Some(linked) = &self.0 else { return Ok(Some(own)) };
        let (rank, size) = (linked.link.rank(), linked.link.size());
        let mut sum = Ok(own);
        let mut step = 1;
        while step < size {
            if !rank.is_multiple_of(2 * step) {
                linked.send(rank - step, &sum);
                return Ok(None);
            }
            if rank + step < size {
                let behind = linked.receive::<T>(rank + step);
                sum = sum.and_then(|mut sum| {
                    sum.join(behind?).map_err(|reason| format!("{}: {reason}", T::NAME))?;
                    Ok(sum)
                });
            }
            step *= 2;
        }
        sum.map(Some).map_err(RanksError::All)
    }
}

impl Linked {
    fn send<T: Portable>(&self, to: usize, what: &Result<T, String>) {
        let bytes = match what {
            Ok(what) => what.to_bytes(),
            Err(message) => message.clone().into_bytes(),
        };
        let mut head = [u8::from(what.is_err()); HEAD];
        head[1..].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.link.send(to, &head);
        bytes.chunks(self.link.largest()).for_each(|piece| self.link.send(to, piece));
    }

    fn receive<T: Portable>(&self, from: usize) -> Result<T, String> {
        let mut head = [0; HEAD];
        self.link.receive(from, &mut head);
        let [failed, length @ ..] = head;
        let mut bytes = vec![0; u64::from_le_bytes(length) as usize];
        bytes.chunks_mut(self.link.largest()).for_each(|piece| self.link.receive(from, piece));
        self.received.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        if failed == 0 {
            T::from_bytes(&bytes).map_err(|reason| format!("{} of rank {from}: {reason}", T::NAME))
        } else {
            Err(String::from_utf8_lossy(&bytes).into_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::threads::{Words, run};
    use super::*;

    #[test]
    fn all_are_joined_once_in_order() {
        for size in [1, 2, 3, 4, 5, 7, 8, 9, 13] {
            let reduced = run(size, 20, |ranks| ranks.reduce(Words(ranks.share(40).collect())));
            assert_eq!(reduced[0], Ok(Some(Words((0..40).collect()))), "{size}");
            assert!(reduced[1..].iter().all(|other| *other == Ok(None)), "{size}");
        }
    }

    #[test]
    fn each_but_the_first_sends_once() {
        let received = run(6, 1000, |ranks| {
            ranks.reduce(Words(vec![ranks.rank() as u64])).unwrap();
            ranks.traffic().received
        });
        // The first: of ranks 1, 2 and 3, 4 and 5.
        assert_eq!(received, [8 + 16 + 16, 0, 8, 0, 8, 0]);
    }

    #[test]
    fn what_cannot_be_joined_is_told_at_the_end() {
        let reduced = run(6, 100, |ranks| {
            let own = if ranks.rank() == 3 { vec![Words::BAD] } else { vec![0] };
            ranks.reduce(Words(own))
        });
        assert_eq!(reduced[0], Err(RanksError::All("words: bad".into())));
        assert!(reduced[1..].iter().all(|other| *other == Ok(None)));
    }
}
