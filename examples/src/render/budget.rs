//! When a rendering stops, and how it is cut into passes.

use std::ops::Range;

/// What a rendering may spend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Samples per pixel.
    Samples(u64),
    /// Seconds. At least one sample per pixel is taken.
    Seconds(f64),
}

/// Passes should take about this long: short enough for progress and Ctrl-C, long enough to keep all threads busy.
const PASS_SECONDS: f64 = 0.25;
/// Number of samples per pass at most.
pub(crate) const MAX_PASS: u64 = 64;

/// Cuts a budget into passes.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    budget: Budget,
    /// Samples per pixel that are not to be parted.
    batch: u64,
    /// Number of the first sample.
    first: u64,
    done: u64,
}

impl Schedule {
    pub(super) fn new(budget: Budget, batch: u64, first: u64) -> Self {
        Self { budget, batch: batch.max(1), first, done: 0 }
    }

    /// Samples per pixel so far, counting the pass that was handed out last.
    pub(super) fn done(&self) -> u64 {
        self.done
    }

    /// The samples of the next pass, given the time since the start; nothing if the budget is spent.
    pub(super) fn next_pass(&mut self, elapsed: f64) -> Option<Range<u64>> {
        let rate = if elapsed > 0.0 { self.done as f64 / elapsed } else { 0.0 };
        // Whole batches.
        let wanted = ((rate * PASS_SECONDS) as u64).clamp(1, MAX_PASS).next_multiple_of(self.batch);
        let count = match self.budget {
            Budget::Samples(total) => wanted.min(total.saturating_sub(self.done)),
            Budget::Seconds(limit) => {
                let remaining = rate * (limit - elapsed);
                match self.done {
                    0 => self.batch,
                    // Stop at the pass that comes closest to the limit.
                    _ if remaining < 0.5 * self.batch as f64 => 0,
                    _ => wanted.min(remaining.round().max(1.0) as u64).next_multiple_of(self.batch),
                }
            }
        };
        let start = self.first.saturating_add(self.done);
        self.done = self.done.saturating_add(count);
        (count > 0).then_some(start..start.saturating_add(count))
    }

    /// Part of the budget that is spent.
    pub(super) fn fraction(&self, elapsed: f64) -> f64 {
        let fraction = match self.budget {
            Budget::Samples(total) => self.done as f64 / total.max(1) as f64,
            Budget::Seconds(limit) => elapsed / limit.max(f64::MIN_POSITIVE),
        };
        fraction.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_cover_the_samples_once() {
        let mut schedule = Schedule::new(Budget::Samples(100), 1, 20);
        let (mut next, mut elapsed) = (20, 0.0);
        while let Some(pass) = schedule.next_pass(elapsed) {
            assert_eq!(pass.start, next);
            next = pass.end;
            elapsed += 0.01 * (pass.end - pass.start) as f64;
        }
        assert_eq!((next, schedule.done()), (120, 100));
        assert_eq!(schedule.fraction(0.0), 1.0);
    }

    #[test]
    fn time_is_kept_to_within_a_pass() {
        for limit in [0.0, 0.3, 5.0] {
            let mut schedule = Schedule::new(Budget::Seconds(limit), 1, 0);
            let mut elapsed = 0.0;
            while let Some(pass) = schedule.next_pass(elapsed) {
                elapsed += 0.02 * (pass.end - pass.start) as f64;
            }
            assert!(schedule.done() >= 1);
            assert!(elapsed <= limit + 0.02, "{elapsed} for {limit}");
            assert!(elapsed >= limit - 0.02, "{elapsed} for {limit}");
        }
    }

    #[test]
    fn batches_are_not_parted() {
        let mut schedule = Schedule::new(Budget::Samples(30), 8, 0);
        let mut passes = Vec::new();
        while let Some(pass) = schedule.next_pass(0.001 * passes.len() as f64) {
            passes.push(pass);
        }
        assert_eq!((passes[0].start, passes[passes.len() - 1].end), (0, 30));
        assert!(passes.iter().all(|pass| pass.start % 8 == 0));
    }

    #[test]
    fn no_samples_no_pass() {
        assert_eq!(Schedule::new(Budget::Samples(0), 1, 5).next_pass(0.0), None);
    }
}
