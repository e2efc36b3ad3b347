//! How bytes travel.

/// Joins the processes of a run.
///
/// # Laws
/// - Messages from one rank to another arrive in the order in which they were sent, and are as long as the receiver expects.
/// - [`all_gather`](Self::all_gather) is called by all ranks, in the same order and with the same lengths.
/// - What cannot be delivered ends all processes.
pub trait Link: Send + Sync {
    /// Number of this process, from 0.
    fn rank(&self) -> usize;

    /// Number of processes.
    fn size(&self) -> usize;

    /// Bytes that a call may move at most: in a message, or of all ranks together.
    fn largest(&self) -> usize;

    /// Sends a message.
    fn send(&self, to: usize, bytes: &[u8]);

    /// Waits for a message, and fills `bytes` with it.
    fn receive(&self, from: usize, bytes: &mut [u8]);

    /// The bytes of all ranks one after the other; rank `k` has `lengths[k]`.
    fn all_gather(&self, own: &[u8], lengths: &[usize]) -> Vec<u8>;
}
