//! Figure 4: a room that is lit by a slit.

use super::comparison::Comparison;
use super::places::Places;
use super::{at_least, at_most, reported};
use crate::experiments::{Context, Ratio, Report, Setup, ratio_of_means};
use crate::photons::{PhotonSettings, Radius};
use crate::program::Failure;

/// In `door-slit`, the lamp in the one room, the camera in the other: where photons lie with and without importance,
/// and what they are worth. Importance shines through the wall, so some photons are kept on its wrong side: the paper's
/// figures 4c and 4d.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(context.threads).build()?;
    pool.install(|| {
        let setup = Setup::builtin(context, "door-slit", context.effort([40, 30], [80, 60]))?;
        let places = Places::new(&setup, context.effort(1024, 16384), context.seed_of("truth", 0))?;
        let settings = PhotonSettings {
            gather_rays: 0,
            importons: 100_000,
            importon_radius: Radius::Absolute(0.1),
            deposition_floor: 1e-3,
            ..PhotonSettings::default()
        };
        let comparison = Comparison {
            context,
            setup: &setup,
            places: &places,
            stored: context.effort(200_000, 2_000_000),
            radii: &[0.02, 0.03, 0.045, 0.065, 0.1, 0.15, 0.2, 0.3, 0.45],
            trials: context.effort(2, 4),
            settings,
            figure: "figure-4",
        };
        let all = comparison.run(&mut report)?;
        let share = |measured: &super::comparison::Measured| {
            let ci95 = measured.share.confidence_interval(0.95);
            Ratio { value: measured.share.mean(), ci95 }
        };
        report.claims.push(at_most("share-of-standard-photons-in-the-dark-room", share(&all.standard), 0.5));
        let claim = at_least("share-of-photons-by-importance-in-the-dark-room", share(&all.importance), 0.5);
        report.claims.push(claim.because(
            "Most lie on the door's leaf and on the edge of its frame, which are bright, and which the camera sees or importance reaches through the wall.",
        ));
        report.claims.push(reported("share-with-cutoff", share(&all.cutoff)));
        let ratio = ratio_of_means(&all.standard.error, &all.importance.error);
        report.claims.push(at_least("error-at-same-memory-standard-over-importance", ratio, 1.0));
        let ratio = ratio_of_means(&all.tenth.error, &all.standard.error);
        report.claims.push(reported("error-with-a-tenth-of-the-photons-over-standard", ratio));
        let ratio = ratio_of_means(&all.cutoff.error, &all.tenth.error);
        report.claims.push(reported("error-with-cutoff-over-floor", ratio));
        let noise = places.noise();
        report.claims.push(reported("error-of-the-truth", Ratio { value: noise, ci95: [noise; 2] }));
        Ok(report)
    })
}
