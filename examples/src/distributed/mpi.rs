//! Open MPI, by the safe part of rsmpi. Nothing else knows of it.

use std::sync::{Mutex, MutexGuard, PoisonError};

use mpi::Threading;
use mpi::datatype::PartitionMut;
use mpi::environment::Universe;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Source};

use super::{Link, Ranks, StartError};

/// Counts are `i32`: half as much leaves room for any sum of two.
const LARGEST: usize = 1 << 30;
/// What a process that panics ends all others with.
const PANICKED: i32 = 101;

/// All processes that `mpirun` started.
struct World {
    /// Ends MPI when it is dropped.
    _universe: Universe,
    /// Calls from one thread at a time.
    turn: Mutex<()>,
    rank: usize,
    size: usize,
}

/// Joins the others.
pub(super) fn start(launched: usize) -> Result<Ranks, StartError> {
    let (universe, threading) =
        mpi::initialize_with_threading(Threading::Serialized).ok_or(StartError::Library("it was started already"))?;
    let world = universe.world();
    let (rank, size) = (world.rank() as usize, world.size() as usize);
    if size < launched {
        return Err(StartError::Launcher { launched, found: size });
    }
    if threading < Threading::Serialized {
        return Err(StartError::Library("it was built without threads (MPI_THREAD_SERIALIZED)"));
    }
    Ok(Ranks::over(World { _universe: universe, turn: Mutex::new(()), rank, size }))
}

impl World {
    fn turn(&self) -> (SimpleCommunicator, MutexGuard<'_, ()>) {
        (SimpleCommunicator::world(), self.turn.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

fn count(bytes: usize) -> i32 {
    i32::try_from(bytes).expect("at most LARGEST bytes")
}

impl Link for World {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn largest(&self) -> usize {
        LARGEST
    }

    fn send(&self, to: usize, bytes: &[u8]) {
        let (world, _turn) = self.turn();
        world.process_at_rank(count(to)).send(bytes);
    }

    fn receive(&self, from: usize, bytes: &mut [u8]) {
        let (world, _turn) = self.turn();
        world.process_at_rank(count(from)).receive_into(bytes);
    }

    fn all_gather(&self, own: &[u8], lengths: &[usize]) -> Vec<u8> {
        let counts: Vec<i32> = lengths.iter().map(|&length| count(length)).collect();
        let starts: Vec<i32> = counts
            .iter()
            .scan(0, |end, &count| {
                let start = *end;
                *end += count;
                Some(start)
            })
            .collect();
        let mut all = vec![0; lengths.iter().sum()];
        let (world, _turn) = self.turn();
        world.all_gather_varcount_into(own, &mut PartitionMut::new(&mut all[..], counts, starts));
        all
    }
}

impl Drop for World {
    fn drop(&mut self) {
        // A process that panics would wait for the others at the end of MPI, and they for it.
        if std::thread::panicking() {
            self.turn().0.abort(PANICKED);
        }
    }
}
