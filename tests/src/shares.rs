//! How the statistical suites of the workspace share out its false-positive rate.

use estimator_checks::assert_shares;

/// Every suite of the workspace with its share of [`FALSE_POSITIVE_RATE`](estimator_checks::FALSE_POSITIVE_RATE).
///
/// Each package writes its share beside its tests; this table repeats them, so that their sum is checked when it is
/// compiled. A test compares it with the sources.
pub const SHARES: [(&str, f64); 25] = [
    ("estimator-checks laws", 6e-8),
    ("lichtwerk foreign scene", 1e-8),
    ("mis-heuristics", 1e-8),
    ("path-space-filter", 2e-8),
    ("photon-map", 5e-8),
    ("qmc-sampling", 1e-7),
    ("ris", 5e-8),
    ("scene-core closed forms", 8e-8),
    ("scene-core emitters", 1e-7),
    ("scene-core foreign scene", 1e-8),
    ("scene-core materials", 1e-7),
    ("scene-core media", 2e-8),
    ("scene-core vertices", 1e-8),
    ("vpl-gi", 4e-9),
    ("vpl-gi bidirectional", 1e-8),
    ("vpl-gi caustics", 1e-9),
    ("workspace bidirectional", 5e-9),
    ("workspace estimators", 1.3e-7),
    ("workspace filters", 7e-8),
    ("workspace laws", 1e-8),
    ("workspace photon lights", 2e-8),
    ("workspace photon maps", 2e-8),
    ("workspace resampling", 5e-8),
    ("workspace samplers", 1e-8),
    ("workspace virtual lights", 3e-8),
];

const fn rates<const N: usize>(table: &[(&str, f64); N]) -> [f64; N] {
    let mut rates = [0.0; N];
    let mut i = 0;
    while i < N {
        rates[i] = table[i].1;
        i += 1;
    }
    rates
}

const _: () = assert_shares(&rates(&SHARES));
