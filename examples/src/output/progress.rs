//! How far the work is, for people.

use std::borrow::Cow;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A line on standard error with the share done, the rate and the time left. Nothing at all where standard error is
/// not a terminal. Shared by all threads.
///
/// ```
/// use lichtwerk::output::Progress;
///
/// let progress = Progress::counting(64, "samples");
/// (0..64).for_each(|_| progress.add(1));
/// progress.finish();
/// assert_eq!(progress.done(), 64);
/// ```
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    unit: Cow<'static, str>,
    done: AtomicU64,
    start: Instant,
    /// Whether the bar shows time instead of work.
    timed: bool,
}

impl Progress {
    /// For work that is over after `total` units.
    pub fn counting(total: u64, unit: impl Into<Cow<'static, str>>) -> Self {
        Self::new(total, "[{bar:30}] {percent:>3}%  {msg}, {eta} left", unit.into(), false)
    }

    /// For work that is over after some time.
    pub fn timed(limit: Duration, unit: impl Into<Cow<'static, str>>) -> Self {
        let milliseconds = u64::try_from(limit.as_millis()).unwrap_or(u64::MAX);
        Self::new(milliseconds, "[{bar:30}] {percent:>3}%  {msg}, {eta} left", unit.into(), true)
    }

    /// For nobody: another process shows its own.
    pub fn hidden(unit: impl Into<Cow<'static, str>>) -> Self {
        Self {
            bar: ProgressBar::hidden(),
            unit: unit.into(),
            done: AtomicU64::new(0),
            start: Instant::now(),
            timed: false,
        }
    }

    fn new(length: u64, template: &str, unit: Cow<'static, str>, timed: bool) -> Self {
        let visible = std::io::stderr().is_terminal();
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(length), target);
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, unit, done: AtomicU64::new(0), start: Instant::now(), timed }
    }

    /// Reports that much more work done.
    pub fn add(&self, units: u64) {
        let done = self.done.fetch_add(units, Ordering::Relaxed) + units;
        if self.bar.is_hidden() {
            return;
        }
        let seconds = self.start.elapsed().as_secs_f64();
        self.bar.set_message(format!("{} {}/s", human(done as f64 / seconds.max(1e-9)), self.unit));
        self.bar.set_position(if self.timed { (seconds * 1e3) as u64 } else { done });
    }

    /// Work reported so far.
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Hides the line while something else is printed.
    pub fn suspend<R>(&self, print: impl FnOnce() -> R) -> R {
        self.bar.suspend(print)
    }

    /// Removes the line.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Three significant digits, with a prefix for thousands.
fn human(number: f64) -> String {
    let (scaled, prefix) = match number {
        n if n >= 1e9 => (n / 1e9, "G"),
        n if n >= 1e6 => (n / 1e6, "M"),
        n if n >= 1e3 => (n / 1e3, "k"),
        n => (n, ""),
    };
    let digits = if scaled < 10.0 { 2 } else { usize::from(scaled < 100.0) };
    format!("{scaled:.digits$} {prefix}").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_have_three_digits() {
        for (number, text) in [(0.0, "0.00"), (5.0, "5.00"), (12.34, "12.3"), (999.0, "999"), (1.234e6, "1.23 M")] {
            assert_eq!(human(number), text);
        }
    }

    #[test]
    fn counts_from_all_threads() {
        let progress = Progress::timed(Duration::from_secs(1), "paths");
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..100).for_each(|_| progress.add(3)));
            }
        });
        progress.finish();
        assert_eq!(progress.done(), 1200);
    }
}
