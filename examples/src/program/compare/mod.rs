//! `lichtwerk compare`.

mod entry;
mod measure;
mod page;
mod pictures;
mod reference;
#[cfg(test)]
mod stand_in;

use std::path::{Path, PathBuf};

use scene_core::{ReferenceScene, Scene, SceneDescription, Sensor};

use super::render::EstimatorName;
use super::{CompareArguments, Failure, RenderArguments, RenderSettings, print, render_to_image, report};
use crate::experiments::{Report, Row};
use crate::output::{Interrupt, check_writable, save_image, write_atomically, write_json};
use crate::render::{Budget, Observe};

use entry::Entry;
use measure::{Contestant, Measured, Plan};
use reference::{Key, Reference};

pub use entry::RenderOptions;

/// Samples of the reference for each sample of the budget.
const REFERENCE_FACTOR: u64 = 64;

/// Files in the folder.
struct Files {
    page: PathBuf,
    report: PathBuf,
    pictures: Vec<PathBuf>,
}

impl Files {
    /// Creates the folder and finds out whether the files can be written, before any work is done.
    fn prepare(folder: &Path, entries: &[Entry]) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder).map_err(|error| format!("cannot create {}: {error}", folder.display()))?;
        let pictures = entries.iter().map(|entry| folder.join(format!("{}.png", entry.file))).collect();
        let files = Self { page: folder.join("report.html"), report: folder.join("report.json"), pictures };
        [&files.page, &files.report].into_iter().chain(&files.pictures).try_for_each(|path| check_writable(path))?;
        Ok(files)
    }
}

/// Renders, measures, and writes what came of it.
pub(super) fn run(arguments: &CompareArguments) -> Result<(), Failure> {
    // Everything that can be wrong with the arguments is found before anything is rendered.
    let common = arguments.options.arguments(&arguments.scene)?;
    let entries = arguments.options.entries(&arguments.scene, &arguments.estimators)?;
    let description = common.description()?;
    let (scene, wishes) = common.build(description.clone())?;
    let base = common.settings(&scene, &wishes)?;
    let prepare = |entry: &Entry| -> Result<Contestant, Failure> {
        entry.arguments.check(&scene)?;
        if entry.arguments.estimator == EstimatorName::Ao && arguments.reference.is_none() {
            return Err("path tracing is no reference for occlusion: --reference names one".into());
        }
        Ok(Contestant { name: entry.text.clone(), settings: entry.arguments.settings(&scene, &wishes)? })
    };
    let named = |entry: &Entry| prepare(entry).map_err(|error| format!("entry '{}': {error}", entry.text).into());
    let contestants = entries.iter().map(named).collect::<Result<Vec<Contestant>, Failure>>()?;
    let folder = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(format!("compare-{}", scene.name())));
    let files = Files::prepare(&folder, &entries)?;

    // Another handler in the process keeps its Ctrl-C.
    let interrupt = Interrupt::install().unwrap_or_else(|_| Interrupt::inactive());
    let reference = find_reference(arguments, &description, &scene, &base, &interrupt)?;
    let plan = Plan {
        scene: &scene,
        reference: &reference.image,
        budgets: measure::budgets(base.budget),
        trials: arguments.trials,
        seed: base.seed,
    };
    let measured = plan.run(&contestants, &interrupt)?;
    if measured.iter().flatten().all(|measured| measured.errors.is_empty()) {
        return Err("interrupted before anything was measured".into());
    }
    let found = Found {
        arguments,
        common: &common,
        scene: &scene,
        reference: &reference,
        plan: &plan,
        entries: &entries,
        measured: &measured,
    };
    found.write(&files)?;
    if interrupt.is_requested() {
        report("interrupted: what was measured until then is in the page");
    }
    let origin = if reference.reused { "reused" } else { "rendered now" };
    print(&format!(
        "{}\nreference: {}, {origin}\nwritten to {}\n",
        found.report(),
        reference.about,
        files.page.display()
    ))
}

/// The user's reference, or the one of the cache.
fn find_reference(
    arguments: &CompareArguments,
    description: &SceneDescription,
    scene: &ReferenceScene,
    base: &RenderSettings,
    interrupt: &Interrupt,
) -> Result<Reference, Failure> {
    if let Some(path) = &arguments.reference {
        return reference::from_file(path, scene.sensor().resolution());
    }
    let budget = match (arguments.reference_spp, base.budget) {
        (Some(samples), _) => Budget::Samples(samples),
        (None, Budget::Samples(samples)) => Budget::Samples(samples.saturating_mul(REFERENCE_FACTOR)),
        (None, Budget::Seconds(seconds)) => Budget::Seconds(seconds * REFERENCE_FACTOR as f64),
    };
    // Plain path tracing, whatever the options for all entries are: only what makes another image is taken from them.
    let settings = RenderSettings {
        threads: base.threads,
        max_depth: base.max_depth,
        rr_depth: base.rr_depth,
        filter: base.filter,
        ..RenderSettings::new(budget)
    };
    let key = Key::new(description, &settings);
    let render = |settings: &RenderSettings, observe: Observe<'_>| render_to_image(scene, settings, observe);
    reference::cached(&arguments.cache, key, scene, &settings, interrupt, render)
}

/// All that is known in the end.
struct Found<'a> {
    arguments: &'a CompareArguments,
    common: &'a RenderArguments,
    scene: &'a ReferenceScene,
    reference: &'a Reference,
    plan: &'a Plan<'a>,
    entries: &'a [Entry],
    /// By entry and budget.
    measured: &'a [Vec<Measured>],
}

impl Found<'_> {
    fn write(&self, files: &Files) -> Result<(), Failure> {
        write_json(&files.report, &self.report())?;
        for (path, measured) in files.pictures.iter().zip(self.whole()) {
            if let Some(mean) = pictures::mean_image(measured) {
                save_image(path, &mean, self.common.exposure)?;
            }
        }
        let page = self.page()?.html();
        Ok(write_atomically(&files.page, |file| file.write_all(page.as_bytes()))?)
    }

    /// What was measured with the largest budget that anything was measured with.
    fn whole(&self) -> impl Iterator<Item = &Measured> {
        let level = self.level();
        self.measured.iter().map(move |of_entry| &of_entry[level])
    }

    /// Its number: the last one, unless it was interrupted before.
    fn level(&self) -> usize {
        let some = |level: &usize| self.measured.iter().any(|of_entry| !of_entry[*level].errors.is_empty());
        (0..self.plan.budgets.len()).rev().find(some).unwrap_or(0)
    }

    /// A row for each entry and budget.
    fn report(&self) -> Report {
        let mut rows = Vec::new();
        for (entry, of_entry) in self.entries.iter().zip(self.measured) {
            for (budget, measured) in self.plan.budgets.iter().zip(of_entry).filter(|(_, of)| !of.errors.is_empty()) {
                let samples = measured.samples.iter().sum::<f64>() / measured.samples.len() as f64;
                let params = [
                    ("budget", describe(*budget).into()),
                    ("spp", samples.into()),
                    ("trials", measured.errors.len().into()),
                    ("size", self.size().into()),
                ];
                rows.push(measured.trials.fill(Row::new(self.scene.name(), &entry.text, params)));
            }
        }
        let experiment = format!("compare-{}", self.scene.name());
        Report { experiment, seed: self.plan.seed, rows, ..Report::default() }
    }

    fn size(&self) -> String {
        let [width, height] = self.scene.sensor().resolution();
        format!("{width}x{height}")
    }
}

/// A budget in words.
fn describe(budget: Budget) -> String {
    match budget {
        Budget::Samples(1) => "1 sample per pixel".to_owned(),
        Budget::Samples(samples) => format!("{samples} samples per pixel"),
        Budget::Seconds(seconds) => format!("{seconds} s"),
    }
}
