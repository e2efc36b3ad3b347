//! Which of the processes this is.

use super::Ranks;

/// Why a process cannot find the others.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The program cannot talk to others.
    #[error(
        "one of {0} processes, which would all render the same: build with '--features mpi' to let them share the work, \
         or give each its --shard"
    )]
    Feature(usize),
    /// The launcher and the library do not understand each other.
    #[error("started as one of {launched} processes, but Open MPI finds {found}: use the mpirun of that library")]
    Launcher {
        /// As many as the launcher says.
        launched: usize,
        /// As many as the library says.
        found: usize,
    },
    /// The library.
    #[error("Open MPI cannot be used: {0}")]
    Library(&'static str),
}

/// Number of this process among those that a launcher (mpirun, srun) started, from 0; nothing if no launcher did.
pub fn launched_rank() -> Option<usize> {
    first_number(["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"], |name| std::env::var(name).ok())
}

/// The number of processes that a launcher started, if it tells.
fn launched_size() -> Option<usize> {
    first_number(["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"], |name| std::env::var(name).ok())
}

fn first_number<const N: usize>(names: [&str; N], value: impl Fn(&str) -> Option<String>) -> Option<usize> {
    names.iter().find_map(|name| value(name)?.parse().ok())
}

/// Finds the other processes, if a launcher started several. Once per process.
///
/// # Errors
/// [`StartError`]. Without the feature `mpi` several processes are one too many, unless each has been told its part.
pub fn start(has_part: bool) -> Result<Ranks, StartError> {
    if launched_rank().is_none() {
        return Ok(Ranks::default());
    }
    #[cfg(feature = "mpi")]
    {
        let _ = has_part;
        super::mpi::start(launched_size().unwrap_or(1))
    }
    #[cfg(not(feature = "mpi"))]
    {
        match launched_size() {
            Some(size) if size > 1 && !has_part => Err(StartError::Feature(size)),
            _ => Ok(Ranks::default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn launchers_are_recognised() {
        let under = |set: &'static [(&'static str, &'static str)]| {
            first_number(["A", "B"], |name| Some(set.iter().find(|(key, _)| *key == name)?.1.to_owned()))
        };
        assert_eq!(under(&[("B", "3")]), Some(3));
        assert_eq!(under(&[("B", "3"), ("A", "0")]), Some(0));
        assert_eq!(under(&[("A", "many"), ("B", "2")]), Some(2));
        assert_eq!(under(&[]), None);
    }
}
