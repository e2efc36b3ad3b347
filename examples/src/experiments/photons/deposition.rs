//! Figures 1 and 2: photons are kept in the room that the camera sees.

use super::comparison::Comparison;
use super::places::Places;
use super::{at_least, at_most, reported};
use crate::experiments::{Context, Ratio, Report, Setup, ratio_of_means};
use crate::photons::{GuideName, PhotonSettings, Radius};
use crate::program::Failure;

/// In `rooms`, a hundred rooms with a lamp each: error of the indirect light that diffuse surfaces in the camera's room
/// scatter, from a standard map and from maps that keep photons by importance, each with the fixed radius that is best
/// for it. In the quick form the same for maps of light paths that importons guide, alone and together with deposition: a query
/// for importons at each vertex takes hours for the photons of the full one.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(context.threads).build()?;
    pool.install(|| {
        let setup = Setup::builtin(context, "rooms", context.effort([40, 30], [80, 60]))?;
        let places = Places::new(&setup, context.effort(192, 4096), context.seed_of("truth", 0))?;
        let settings = PhotonSettings {
            gather_rays: 0,
            importons: 40_000,
            importon_radius: Radius::Absolute(0.4),
            deposition_floor: 1e-3,
            guide: context.effort(GuideName::Both, GuideName::None),
            ..PhotonSettings::default()
        };
        for &(stored, trials) in context.effort(&[(150_000, 2)][..], &[(600_000, 4), (6_000_000, 2)]) {
            let comparison = Comparison {
                context,
                setup: &setup,
                places: &places,
                stored,
                radii: &[0.025, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.56],
                trials,
                settings: settings.clone(),
                figure: "figure-2",
            };
            let all = comparison.run(&mut report)?;
            let id = |what: &str| format!("{stored}-{what}");
            let ratio = ratio_of_means(&all.standard.error, &all.importance.error);
            report.claims.push(at_least(id("error-at-same-memory-standard-over-importance"), ratio, 10.0).because(
                "Fifty times as many photons in the seen room allow a smaller radius, and of both errors the best sum is \
                 a power of their number: 2/3 where bias grows as the radius squared, 1/2 where it grows as the radius \
                 (edges, corners), that is 13 and 7.",
            ));
            let ratio = ratio_of_means(&all.standard.same_radius, &all.importance.same_radius);
            report.claims.push(reported(id("the-same-at-the-standard-maps-radius"), ratio));
            let ratio = ratio_of_means(&all.tenth.error, &all.standard.error);
            report.claims.push(at_most(id("error-with-a-tenth-of-the-photons-over-standard"), ratio, 1.0));
            let ratio = ratio_of_means(&all.standard.found, &all.tenth.same_error_found);
            report.claims.push(at_least(id("photons-per-query-at-no-larger-error-standard-over-a-tenth"), ratio, 1.0));
            let ratio = ratio_of_means(&all.standard.query, &all.tenth.same_error_query);
            report.claims.push(
                at_least(id("query-time-at-no-larger-error-standard-over-a-tenth"), ratio, 1.0)
                    .because("Times are noisy; photons per query are what repeats."),
            );
            let ratio = ratio_of_means(&all.cutoff.error, &all.tenth.error);
            report.claims.push(reported(id("error-with-cutoff-over-floor"), ratio));
            if settings.guide == GuideName::None {
                continue;
            }
            for (what, measured) in [("guided", &all.guided), ("guided-importance", &all.guided_importance)] {
                let ratio = ratio_of_means(&all.standard.error, &measured.error);
                report.claims.push(reported(id(&format!("error-at-same-memory-standard-over-{what}")), ratio));
                let ratio = ratio_of_means(&measured.error, &all.importance.error);
                report.claims.push(reported(id(&format!("error-at-same-memory-{what}-over-importance")), ratio));
            }
            let ratio = ratio_of_means(&all.importance.seconds, &all.guided_importance.seconds);
            report.claims.push(reported(id("tracing-time-importance-over-guided-importance"), ratio));
        }
        let noise = places.noise();
        report.claims.push(reported("error-of-the-truth", Ratio { value: noise, ci95: [noise; 2] }));
        Ok(report)
    })
}
