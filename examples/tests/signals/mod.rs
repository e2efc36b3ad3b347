//! Whether Ctrl-C can be tested here.

/// Whether this process, and so those it starts, ignores one of the signals that ask a program to end, as shells make their
/// background jobs do with SIGINT and `nohup` does with SIGHUP: then the program leaves all of them as they are, and there is
/// nothing to test. Says so.
pub(crate) fn interrupts_are_ignored() -> bool {
    const SIGNALS: [(u32, &str); 3] = [(1, "SIGHUP"), (2, "SIGINT"), (15, "SIGTERM")];
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap_or(0);
    let ignored = SIGNALS.iter().find(|(signal, _)| mask >> (signal - 1) & 1 == 1);
    if let Some((_, name)) = ignored {
        println!("skipped: {name} is ignored here");
    }
    ignored.is_some()
}
