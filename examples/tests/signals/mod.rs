//! Whether Ctrl-C can be tested here.

/// Whether this process, and so those it starts, ignores SIGINT, as shells make their background jobs do: then the
/// program leaves it ignored too, and there is nothing to test. Says so.
pub(crate) fn interrupts_are_ignored() -> bool {
    const SIGINT: u32 = 2;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    let ignored = mask.is_some_and(|mask| mask >> (SIGINT - 1) & 1 == 1);
    if ignored {
        println!("skipped: SIGINT is ignored here, as in background jobs of a shell");
    }
    ignored
}
