//! The standard map against maps that keep photons where the camera looks.

use photon_map::{Bound, KeepAll, PhotonMap};
use qmc_sampling::Replications;
use scene_core::PowerChoice;

use super::places::{Look, Places};
use super::top_view::top_view;
use super::{Traced, Tracer, limits, storing};
use crate::distributed::Ranks;
use crate::estimators::{Importance, ImportonGuidance, ImportonTracing, PhotonTracing};
use crate::experiments::{Context, Report, Row, Setup};
use crate::photons::{GuideName, PhotonSettings};
use crate::program::Failure;

/// What is compared.
pub(super) struct Comparison<'a> {
    pub(super) context: &'a Context,
    pub(super) setup: &'a Setup,
    pub(super) places: &'a Places<'a>,
    /// Photons in memory.
    pub(super) stored: usize,
    /// Radii to look with; each map gets the one that is best for it.
    pub(super) radii: &'a [f32],
    pub(super) trials: u64,
    /// Among them what is guided, if anything is.
    pub(super) settings: PhotonSettings,
    /// Prefix of the pictures.
    pub(super) figure: &'a str,
}

/// The trials of one kind of map.
#[derive(Default)]
pub(super) struct Measured {
    pub(super) error: Replications,
    /// Seconds per query.
    pub(super) query: Replications,
    /// Share of the photons in the box of what is seen.
    pub(super) share: Replications,
    /// Error with the radius that is best for the first map.
    pub(super) same_radius: Replications,
    paths: Replications,
    stored: Replications,
    pub(super) seconds: Replications,
    rays: Replications,
    radius: Replications,
    /// Photons per query.
    pub(super) found: Replications,
    /// Seconds and photons of the fastest query whose error is not larger than that of the first map; with the best
    /// radius, if all are larger.
    pub(super) same_error_query: Replications,
    pub(super) same_error_found: Replications,
    best: Option<Best>,
    values: Vec<Replications>,
}

/// How the first map was looked at in the last trial.
#[derive(Clone, Copy)]
struct Best {
    radius: f32,
    error: f64,
}

/// The maps: standard, by importance with as many photons, with a tenth of them, and with a tenth and a cutoff; then of
/// guided paths, and of guided paths with as many photons by importance, if these are asked for.
pub(super) struct Compared {
    pub(super) standard: Measured,
    pub(super) importance: Measured,
    pub(super) tenth: Measured,
    pub(super) cutoff: Measured,
    pub(super) guided: Measured,
    pub(super) guided_importance: Measured,
}

impl Comparison<'_> {
    /// Measures all of them, and adds their rows.
    pub(super) fn run(&self, report: &mut Report) -> Result<Compared, Failure> {
        let mut standard = Measured::default();
        let [mut importance, mut tenth, mut cutoff, mut guided, mut guided_importance] =
            std::array::from_fn(|_| Measured::default());
        let floor = Bound::Floor(self.settings.deposition_floor);
        let progress = self.context.progress(self.trials);
        for trial in 0..self.trials {
            let tracer = |what: &str| Tracer::new(self.setup, &self.settings, self.context.seed_of(what, trial));
            let maps = tracer("standard")?;
            let traced = maps.until(&maps.light, &storing(KeepAll)?, self.stored);
            self.take(&mut standard, traced, "standard", trial, None)?;
            let first = standard.best;
            for (measured, what, stored, bound) in [
                (&mut importance, "importance", self.stored, floor),
                (&mut tenth, "tenth", self.stored / 10, floor),
                (&mut cutoff, "cutoff", self.stored / 10, Bound::Cutoff(CUTOFF)),
            ] {
                let tracer = tracer(what)?;
                let deposition = self.importance(&tracer, bound)?;
                if trial == 0 && what == "importance" {
                    let positions = deposition.map.importons().photons().iter().map(|photon| photon.position());
                    let picture = top_view(&self.setup.scene, positions)?;
                    self.context.save_picture(&format!("{}-importons", self.figure), &picture, 0.0)?;
                }
                let traced = tracer.until(&tracer.light, &storing(deposition)?, stored);
                self.take(measured, traced, what, trial, first)?;
            }
            if self.settings.guide != GuideName::None {
                let maps = tracer("guided")?;
                let traced = maps.until(&self.guided(&maps)?, &storing(KeepAll)?, self.stored);
                self.take(&mut guided, traced, "guided", trial, first)?;
                let maps = tracer("guided-importance")?;
                let storing = storing(self.importance(&maps, floor)?)?;
                let traced = maps.until(&self.guided(&maps)?, &storing, self.stored);
                self.take(&mut guided_importance, traced, "guided-importance", trial, first)?;
            }
            progress.add(1);
        }
        progress.finish();
        for (measured, what) in [
            (&standard, "standard"),
            (&importance, "importance"),
            (&tenth, "tenth"),
            (&cutoff, "tenth, cutoff"),
            (&guided, "guided"),
            (&guided_importance, "guided, importance"),
        ] {
            if measured.best.is_some() {
                report.rows.push(self.row(measured, what));
            }
        }
        Ok(Compared { standard, importance, tenth, cutoff, guided, guided_importance })
    }

    /// Where photons are kept.
    fn importance(&self, tracer: &Tracer<'_>, bound: Bound) -> Result<Importance, Failure> {
        let importons = self.settings.importon_tracing(&self.setup.scene, limits())?;
        Ok(ImportonTracing { bound, ..importons }.trace(&tracer.context(), &Ranks::default())?.0)
    }

    /// Light paths that importons guide, as the settings say.
    fn guided(&self, tracer: &Tracer<'_>) -> Result<PhotonTracing<PowerChoice, ImportonGuidance>, Failure> {
        let guidance = self.settings.guidance(&self.setup.scene, limits())?.ok_or("nothing is guided")?;
        let (guidance, _) = guidance.trace(&tracer.context(), &tracer.light.choice, &Ranks::default())?;
        Ok(tracer.light.clone().guided(guidance))
    }

    /// Takes in a map.
    fn take(
        &self,
        measured: &mut Measured,
        traced: Traced,
        what: &str,
        trial: u64,
        first: Option<Best>,
    ) -> Result<(), Failure> {
        let mut photons = traced.photons.global;
        let paths = photons.paths();
        photons.append(traced.photons.caustic);
        // Both kinds are of the same paths.
        photons = recounted(photons, paths);
        let positions = || photons.as_slice().iter().map(|photon| photon.position());
        measured.share.push(self.places.share(positions()));
        if trial == 0 {
            let picture = top_view(&self.setup.scene, positions())?;
            self.context.save_picture(&format!("{}-{what}", self.figure), &picture, 0.0)?;
        }
        measured.stored.push(photons.len() as f64);
        let middle = self.radii[self.radii.len() / 2];
        let map = PhotonMap::par_build(photons, middle)?;
        let looks: Vec<Look> =
            self.radii.iter().map(|&radius| self.places.look(&map, radius)).collect::<std::result::Result<_, _>>()?;
        let Some(best) = (0..looks.len()).min_by(|&a, &b| looks[a].error.total_cmp(&looks[b].error)) else {
            return Err("no radius to look with".into());
        };
        measured.best = Some(Best { radius: self.radii[best], error: looks[best].error });
        let first = first.unwrap_or(Best { radius: self.radii[best], error: looks[best].error });
        let same_radius = self.radii.iter().position(|&radius| radius == first.radius).unwrap_or(best);
        measured.same_radius.push(looks[same_radius].error);
        let fastest = looks.iter().filter(|look| look.error <= first.error);
        let fastest = fastest.min_by(|a, b| a.photons.total_cmp(&b.photons)).unwrap_or(&looks[best]);
        measured.same_error_query.push(fastest.seconds);
        measured.same_error_found.push(fastest.photons);
        let look = &looks[best];
        measured.values.resize(look.values.len(), Replications::new());
        measured.values.iter_mut().zip(&look.values).for_each(|(moments, &value)| moments.push(value));
        for (moments, value) in [
            (&mut measured.error, look.error),
            (&mut measured.query, look.seconds),
            (&mut measured.found, look.photons),
            (&mut measured.radius, f64::from(self.radii[best])),
            (&mut measured.paths, traced.paths as f64),
            (&mut measured.seconds, traced.seconds),
            (&mut measured.rays, traced.rays.total() as f64),
        ] {
            moments.push(value);
        }
        Ok(())
    }

    fn row(&self, measured: &Measured, what: &str) -> Row {
        let params = [
            ("map", what.into()),
            ("photons", measured.stored.mean().round().into()),
            ("paths", measured.paths.mean().round().into()),
            ("radius", measured.radius.mean().into()),
            ("photons per query", measured.found.mean().into()),
            ("microseconds per query", (1e6 * measured.query.mean()).into()),
            ("share in the seen room", measured.share.mean().into()),
            ("rel. MSE at the standard map's radius", measured.same_radius.mean().into()),
        ];
        let variance = measured.values.iter().map(Replications::variance).sum::<f64>();
        Row {
            seconds: measured.seconds.mean(),
            rays: measured.rays.mean().round() as u64,
            variance: variance / measured.values.len().max(1) as f64,
            rel_mse: measured.error.mean(),
            ..Row::new(self.setup.scene.name(), "photon-map", params)
        }
    }
}

/// Below it nothing is kept, with a cutoff.
const CUTOFF: f64 = 0.05;

/// The same photons, of so many paths.
fn recounted(photons: photon_map::Photons<[f32; 3]>, paths: u64) -> photon_map::Photons<[f32; 3]> {
    let mut counted = photon_map::Photons::with_capacity(photons.len());
    photons.as_slice().iter().for_each(|photon| counted.store(photon.unpack()));
    counted.add_paths(paths);
    counted
}
