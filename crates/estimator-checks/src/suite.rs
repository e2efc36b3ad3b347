//! The false-positive rate of a suite, shared out over a counted registry of checks.

use std::fmt;
use std::sync::{Mutex, PoisonError};

use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng;

use crate::seed::{Uniforms, mix, seed};

/// The probability with which all statistical checks of a workspace together may fail although nothing is wrong.
pub const FALSE_POSITIVE_RATE: f64 = 1e-6;

/// Why a suite did not hand out a check.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SuiteError {
    /// More checks were asked for than the suite declares.
    Exhausted {
        /// The suite.
        suite: String,
        /// The name of the check that was one too many.
        test: String,
        /// How many checks the suite declares.
        declared: usize,
    },
    /// Two checks of a suite have the same name, and so would share a seed.
    NameTaken {
        /// The suite.
        suite: String,
        /// The name.
        test: String,
    },
    /// A significance level that is not strictly between zero and one.
    InvalidAlpha(f64),
}

impl fmt::Display for SuiteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exhausted { suite, test, declared } => write!(
                f,
                "suite '{suite}' declares {declared} statistical checks, '{test}' is one more: raise the declared number"
            ),
            Self::NameTaken { suite, test } => write!(f, "suite '{suite}' has two checks named '{test}'"),
            Self::InvalidAlpha(alpha) => write!(f, "significance level {alpha} is not between 0 and 1"),
        }
    }
}

impl std::error::Error for SuiteError {}

/// A registry of statistical checks that share one false-positive rate.
///
/// ```text
/// alpha = share / declared,     P(any of the declared checks fails by chance) <= declared * alpha = share
/// ```
///
/// - `share`: the part of [`FALSE_POSITIVE_RATE`] that belongs to this suite,
/// - `declared`: the number of statistical checks that the suite may perform,
/// - `alpha`: the significance level of each check (Bonferroni; no independence is assumed).
///
/// A suite is a `static` of a test binary. It counts the checks that are really performed, from any number of threads,
/// and refuses one more than declared: a new test cannot silently raise the rate. Fewer are fine, as when the test
/// runner filters. Test binaries are separate processes, so a workspace splits the rate between its suites:
/// see [`assert_shares`].
///
/// The rate is that of a *reseed*: seeds follow from the names, so that a given revision passes or fails repeatably.
///
/// ```
/// use estimator_checks::{Moments, Suite, mean_is};
///
/// static SUITE: Suite = Suite::new("my-renderer", 2);
///
/// let check = SUITE.check("uniform numbers have mean 1/2");
/// let mut uniforms = check.uniforms();
/// let moments: Moments = (0..10_000).map(|_| uniforms.next_f64()).collect();
/// mean_is(check, &moments, 0.5).expect_pass();
/// assert_eq!(SUITE.used(), 1);
/// ```
#[derive(Debug)]
pub struct Suite {
    name: &'static str,
    declared: usize,
    share: f64,
    seeds: Mutex<Vec<u64>>,
}

impl Suite {
    /// A suite that owns the whole [`FALSE_POSITIVE_RATE`]: the only one of its workspace.
    pub const fn new(name: &'static str, declared: usize) -> Self {
        Self::with_share(name, declared, FALSE_POSITIVE_RATE)
    }

    /// A suite that owns a share of the [`FALSE_POSITIVE_RATE`], see [`assert_shares`].
    ///
    /// # Panics
    /// If `declared` is zero, or the share is not positive or above the whole rate; in a `static`, at compile time.
    pub const fn with_share(name: &'static str, declared: usize, share: f64) -> Self {
        assert!(declared > 0, "a suite declares at least one check");
        assert!(share > 0.0 && share <= FALSE_POSITIVE_RATE, "a share lies in (0, FALSE_POSITIVE_RATE]");
        Self { name, declared, share, seeds: Mutex::new(Vec::new()) }
    }

    /// The significance level of each check.
    pub const fn alpha(&self) -> f64 {
        self.share / self.declared as f64
    }

    /// The number of checks declared.
    pub const fn declared(&self) -> usize {
        self.declared
    }

    /// The number of checks handed out so far in this process.
    pub fn used(&self) -> usize {
        self.seeds.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Registers a check: its level is the suite's, its seed follows from the names of suite and test.
    ///
    /// # Panics
    /// With the text of [`SuiteError`] where [`try_check`](Self::try_check) returns one.
    #[track_caller]
    pub fn check(&self, test: &str) -> Check {
        match self.try_check(test) {
            Ok(check) => check,
            Err(error) => panic!("{error}"),
        }
    }

    /// Registers a check.
    ///
    /// # Errors
    /// [`SuiteError::Exhausted`] if all declared checks are spent, [`SuiteError::NameTaken`] if the name was used.
    pub fn try_check(&self, test: &str) -> Result<Check, SuiteError> {
        let check = self.twin(test);
        let mut seeds = self.seeds.lock().unwrap_or_else(PoisonError::into_inner);
        if seeds.contains(&check.seed) {
            return Err(SuiteError::NameTaken { suite: self.name.into(), test: test.into() });
        }
        if seeds.len() >= self.declared {
            return Err(SuiteError::Exhausted { suite: self.name.into(), test: test.into(), declared: self.declared });
        }
        seeds.push(check.seed);
        Ok(check)
    }

    /// A check for the planted-bug twin of a test, at the same level.
    ///
    /// It is not counted: a check that must reject cannot raise a false alarm. Finish it with `expect_reject`.
    pub fn twin(&self, test: &str) -> Check {
        let test = format!("{}/{test}", self.name);
        Check { seed: seed(&test), test, alpha: self.alpha() }
    }
}

/// The right to one statistical decision: a name, a significance level, a seed.
///
/// The functions of this crate take it by value, so that one registration pays for one decision. It cannot be cloned.
///
/// ```
/// use estimator_checks::{Check, ChiSquare, Interval};
/// let check = Check::new("square root", 1e-6)?;
/// ChiSquare::on(Interval::UNIT).run(check, |[u, ..]: [f64; 3]| Some(u.sqrt()), |x| 2.0 * x).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
///
/// A second decision, or a second attempt after a rejection, would not be paid for:
///
/// ```compile_fail,E0382
/// use estimator_checks::{Check, ChiSquare, Interval};
/// let check = Check::new("square root", 1e-6)?;
/// ChiSquare::on(Interval::UNIT).run(check, |[u, ..]: [f64; 3]| Some(u.sqrt()), |x| 2.0 * x).expect_pass();
/// ChiSquare::on(Interval::UNIT).run(check, |[u, ..]: [f64; 3]| Some(u.sqrt()), |x| 2.0 * x).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[derive(Debug)]
#[must_use]
pub struct Check {
    test: String,
    alpha: f64,
    seed: u64,
}

impl Check {
    /// A check outside of any suite, for exploration.
    ///
    /// # Errors
    /// [`SuiteError::InvalidAlpha`] if `alpha` is not strictly between zero and one.
    ///
    /// ```
    /// use estimator_checks::Check;
    /// assert!(Check::new("a look", 0.01).is_ok());
    /// assert!(Check::new("a look", f64::NAN).is_err());
    /// ```
    pub fn new(test: &str, alpha: f64) -> Result<Self, SuiteError> {
        if !(alpha > 0.0 && alpha < 1.0) {
            return Err(SuiteError::InvalidAlpha(alpha));
        }
        Ok(Self { test: test.into(), alpha, seed: seed(test) })
    }

    /// The name of the test.
    pub fn test(&self) -> &str {
        &self.test
    }

    /// The significance level: the outcome is a rejection if the p-value is below.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// The seed, a hash of the name.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The generator of this check, for code that takes one of `rand` 0.10.
    pub fn rng(&self) -> Pcg64 {
        Pcg64::seed_from_u64(self.seed)
    }

    /// The uniform numbers of this check.
    pub fn uniforms(&self) -> Uniforms {
        Uniforms::new(self.seed)
    }

    /// As [`split`](Self::split), for a number of parts that is known at run time only.
    #[cfg(feature = "scene-core")]
    pub(crate) fn parts(&self, names: impl ExactSizeIterator<Item = String>) -> Vec<Check> {
        let alpha = self.alpha / names.len().max(1) as f64;
        let part =
            |name: String| Check { test: format!("{}: {name}", self.test), alpha, seed: mix(self.seed ^ seed(&name)) };
        names.map(part).collect()
    }

    /// Splits the check into `N` that share its level, each with a seed of its own.
    ///
    /// ```
    /// let [a, b] = estimator_checks::Check::new("both", 1e-3)?.split(["first", "second"]);
    /// assert_eq!(a.alpha(), 5e-4);
    /// assert_ne!(a.seed(), b.seed());
    /// # Ok::<(), estimator_checks::SuiteError>(())
    /// ```
    pub fn split<const N: usize>(self, parts: [&str; N]) -> [Check; N] {
        parts.map(|part| Check {
            test: format!("{}: {part}", self.test),
            alpha: self.alpha / N as f64,
            seed: mix(self.seed ^ seed(part)),
        })
    }
}

/// Asserts that the shares of a workspace's suites add up to at most [`FALSE_POSITIVE_RATE`]; meant for `const` context.
///
/// Keep one table of the shares, in the package that holds the workspace-wide tests. A crate that is tested on its own
/// writes its share as a literal; the table repeats it.
///
/// # Panics
/// If a share is not positive, or the sum is above the rate by more than round-off; in a `const`, at compile time.
///
/// ```
/// use estimator_checks::{Suite, assert_shares};
///
/// const SAMPLERS: f64 = 4e-7;
/// const INTEGRATORS: f64 = 6e-7;
/// const _: () = assert_shares(&[SAMPLERS, INTEGRATORS]);
///
/// static SUITE: Suite = Suite::with_share("samplers", 20, SAMPLERS);
/// assert!((SUITE.alpha() - 2e-8).abs() < 1e-20);
/// ```
///
/// ```compile_fail
/// const _: () = estimator_checks::assert_shares(&[6e-7, 6e-7]);
/// ```
pub const fn assert_shares(shares: &[f64]) {
    let mut sum = 0.0;
    let mut i = 0;
    while i < shares.len() {
        assert!(shares[i] > 0.0, "a share is positive");
        sum += shares[i];
        i += 1;
    }
    assert!(sum <= FALSE_POSITIVE_RATE * (1.0 + 1e-9), "the shares exceed the false-positive rate");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_one_check_too_many_and_a_name_twice() {
        static SUITE: Suite = Suite::new("tiny", 2);
        assert_eq!(SUITE.check("a").alpha(), 5e-7);
        assert!(matches!(SUITE.try_check("a"), Err(SuiteError::NameTaken { .. })));
        assert_eq!(SUITE.twin("b's planted bug").alpha(), 5e-7);
        let _ = SUITE.check("b");
        let error = SUITE.try_check("c").unwrap_err();
        assert!(error.to_string().contains("declares 2"), "{error}");
        assert_eq!(SUITE.used(), 2);
    }

    #[test]
    fn counts_across_threads() {
        static SUITE: Suite = Suite::new("threads", 8);
        let granted: usize = std::thread::scope(|scope| {
            let threads: Vec<_> =
                (0..16).map(|i| scope.spawn(move || usize::from(SUITE.try_check(&format!("t{i}")).is_ok()))).collect();
            threads.into_iter().map(|t| t.join().unwrap()).sum()
        });
        assert_eq!(granted, 8);
    }

    #[test]
    #[should_panic(expected = "exceed")]
    fn shares_beyond_the_rate_are_refused() {
        assert_shares(&[5e-7, 5.1e-7]);
    }

    #[test]
    fn shares_up_to_the_rate_are_accepted() {
        assert_shares(&[1e-7; 10]);
    }
}
