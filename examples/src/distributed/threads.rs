//! Ranks that are threads, for tests.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Barrier, Mutex};

use super::{Link, Portable, Ranks};

/// What all threads share: channels from each to each, and a place to meet.
struct Hall {
    barrier: Barrier,
    table: Mutex<Vec<Vec<u8>>>,
}

struct Thread {
    rank: usize,
    largest: usize,
    hall: Arc<Hall>,
    to: Vec<Mutex<Sender<Vec<u8>>>>,
    from: Vec<Mutex<Receiver<Vec<u8>>>>,
}

/// Runs `work` at so many ranks; each call of their link may move `largest` bytes at most, but for the 16 and 9 that
/// announce more.
pub(super) fn run<R: Send>(size: usize, largest: usize, work: impl Fn(&Ranks) -> R + Sync) -> Vec<R> {
    let hall = Arc::new(Hall { barrier: Barrier::new(size), table: Mutex::new(vec![Vec::new(); size]) });
    let (mut to, mut from): (Vec<Vec<_>>, Vec<Vec<_>>) =
        ((0..size).map(|_| Vec::new()).collect(), (0..size).map(|_| Vec::new()).collect());
    for sender in &mut to {
        for receiver in &mut from {
            let (a, b) = channel();
            sender.push(Mutex::new(a));
            receiver.push(Mutex::new(b));
        }
    }
    let threads = to.into_iter().zip(from).enumerate();
    let threads = threads.map(|(rank, (to, from))| Thread { rank, largest, hall: Arc::clone(&hall), to, from });
    let threads: Vec<Thread> = threads.collect();
    let work = &work;
    std::thread::scope(|scope| {
        let start = |thread| scope.spawn(move || work(&Ranks::over(thread)));
        let running: Vec<_> = threads.into_iter().map(start).collect();
        running.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

impl Link for Thread {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn largest(&self) -> usize {
        self.largest
    }

    fn send(&self, to: usize, bytes: &[u8]) {
        assert!(bytes.len() <= self.largest.max(9));
        self.to[to].lock().unwrap().send(bytes.to_vec()).unwrap();
    }

    fn receive(&self, from: usize, bytes: &mut [u8]) {
        bytes.copy_from_slice(&self.from[from].lock().unwrap().recv().unwrap());
    }

    fn all_gather(&self, own: &[u8], lengths: &[usize]) -> Vec<u8> {
        assert_eq!(own.len(), lengths[self.rank]);
        let announces = lengths.iter().all(|length| *length == 16);
        // Messages of errors are short.
        assert!(announces || own.len() <= self.largest.max(4096));
        self.hall.table.lock().unwrap()[self.rank] = own.to_vec();
        self.hall.barrier.wait();
        let all = self.hall.table.lock().unwrap().clone();
        self.hall.barrier.wait();
        assert!(all.iter().map(Vec::len).eq(lengths.iter().copied()));
        all.concat()
    }
}

/// Something to send.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Words(pub(super) Vec<u64>);

impl Words {
    /// Joins nothing.
    pub(super) const BAD: u64 = u64::MAX;
}

impl Portable for Words {
    const NAME: &'static str = "words";

    fn to_bytes(&self) -> Vec<u8> {
        self.0.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        Ok(Self(bytes.as_chunks().0.iter().map(|&word| u64::from_le_bytes(word)).collect()))
    }

    fn join(&mut self, behind: Self) -> Result<(), String> {
        if behind.0.contains(&Self::BAD) {
            return Err("bad".to_owned());
        }
        self.0.extend(behind.0);
        Ok(())
    }
}
