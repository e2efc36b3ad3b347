//! `lichtwerk list`.

use clap::ValueEnum;
use scene_core::builtin::Builtin;

use super::render::{EstimatorName, FilterName};
use super::{Failure, print};
use crate::choices::{AnyHeuristic, LightSelection};
use crate::experiments::EXPERIMENTS;
use crate::samplers::SamplerName;

/// Lists what can be named on the command line.
pub(super) fn run() -> Result<(), Failure> {
    let mut text = String::from("scenes (or a file: Mitsuba 3 .xml, glTF 2.0 .gltf and .glb, LuxCore .scn)\n");
    for builtin in Builtin::ALL {
        text += &format!("  {:<14} {}\n", builtin.name, builtin.about);
    }
    section::<EstimatorName>(&mut text, "estimators (--estimator)");
    section::<AnyHeuristic>(&mut text, "heuristics (--heuristic)");
    section::<LightSelection>(&mut text, "light selection (--lights)");
    section::<SamplerName>(&mut text, "samplers (--sampler)");
    section::<FilterName>(&mut text, "filters (--filter)");
    text += "\nexperiments (lichtwerk experiment NAME)\n";
    for experiment in EXPERIMENTS {
        text += &format!("  {:<14} {}\n", experiment.name, experiment.about);
    }
    print(text.trim_end())
}

fn section<V: ValueEnum>(text: &mut String, title: &str) {
    *text += &format!("\n{title}\n");
    for value in V::value_variants().iter().filter_map(ValueEnum::to_possible_value) {
        let help = value.get_help().map(ToString::to_string).unwrap_or_default();
        *text += &format!("  {:<14} {help}\n", value.get_name());
    }
}
