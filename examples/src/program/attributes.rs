//! What an image tells about its making.

use std::collections::BTreeMap;

use scene_core::ReferenceScene;
use scene_core::film::Filter;

use super::filtered;
use super::render::{EstimatorName, RenderSettings};
use crate::values::name_of;

/// The attribute that tells which path space filter an image has, with its settings.
pub(super) const PATH_FILTER: &str = "pathFilter";

/// Attributes that `--stats` has under keys of their own.
pub(super) const NAMED: [&str; 9] =
    ["scene", "estimator", "heuristic", "lights", "sampler", "seed", "maxDepth", "renderer", PATH_FILTER];

/// Attributes with settings that only some estimators have, or that few renderings change.
pub(super) const DETAILS: [&str; 7] =
    ["rrDepth", "reconstruction", "aoDistance", "lightPaths", "resampling", "lightPhotons", "photons"];

/// All of them, by name.
pub(super) fn attributes(scene: &ReferenceScene, settings: &RenderSettings) -> BTreeMap<String, String> {
    let filter = settings.path_filter.map(|name| (PATH_FILTER, filtered::describe(name, &settings.path_filtering())));
    let texts = [
        ("scene", scene.name().to_owned()),
        ("estimator", name_of(settings.estimator)),
        ("heuristic", name_of(settings.heuristic)),
        ("lights", name_of(settings.lights)),
        ("sampler", name_of(settings.sampler)),
        ("seed", settings.seed.to_string()),
        ("maxDepth", settings.max_depth_text()),
        ("renderer", concat!("Lichtwerk ", env!("CARGO_PKG_VERSION")).to_owned()),
    ];
    texts.into_iter().chain(filter).chain(details(settings)).map(|(key, text)| (key.to_owned(), text)).collect()
}

/// The settings that have an effect on this image, among those of [`DETAILS`].
fn details(settings: &RenderSettings) -> impl Iterator<Item = (&'static str, String)> {
    let estimator = settings.estimator;
    let occlusion = estimator == EstimatorName::Ao;
    let maps = matches!(estimator, EstimatorName::PhotonMap | EstimatorName::Sppm);
    let complement = estimator == EstimatorName::RobustIgi && settings.photons.caustics;
    let resamples = match estimator {
        EstimatorName::RestirDirect => true,
        EstimatorName::Path | EstimatorName::Direct => !settings.is_plain() && !settings.selects_by_photons(),
        EstimatorName::PhotonMap | EstimatorName::Sppm => !settings.direct_settings().is_plain(),
        _ => false,
    };
    let detail = |applies: bool, name, text: &dyn Fn() -> String| applies.then(|| (name, text()));
    [
        detail(!occlusion, "rrDepth", &|| settings.rr_depth.to_string()),
        detail(settings.filter != Filter::BOX, "reconstruction", &|| format!("{:?}", settings.filter)),
        detail(occlusion, "aoDistance", &|| settings.ao_distance.to_string()),
        detail(estimator.connects_light_paths(), "lightPaths", &|| format!("{:?}", settings.light_paths)),
        detail(resamples, "resampling", &|| format!("{:?}", settings.direct_settings())),
        detail(settings.selects_by_photons(), "lightPhotons", &|| format!("{:?}", settings.light_photons)),
        detail(maps || complement, "photons", &|| format!("{:?}", settings.photons)),
    ]
    .into_iter()
    .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choices::LightSelection;
    use crate::render::Budget;
    use crate::resampling::DirectName;

    fn details_of(change: impl FnOnce(&mut RenderSettings)) -> Vec<&'static str> {
        let mut settings = RenderSettings::new(Budget::Samples(1));
        change(&mut settings);
        details(&settings).map(|(name, _)| name).collect()
    }

    #[test]
    fn only_what_has_an_effect_is_told() {
        let of = |estimator| details_of(|settings| settings.estimator = estimator);
        assert_eq!(of(EstimatorName::Path), ["rrDepth"]);
        assert_eq!(of(EstimatorName::Ao), ["aoDistance"]);
        assert_eq!(of(EstimatorName::Bdpt), ["rrDepth", "lightPaths"]);
        assert_eq!(of(EstimatorName::RestirDirect), ["rrDepth", "resampling"]);
        assert_eq!(of(EstimatorName::Sppm), ["rrDepth", "photons"]);
        assert_eq!(details_of(|s| s.filter = Filter::TENT), ["rrDepth", "reconstruction"]);
        assert_eq!(details_of(|s| s.lights = LightSelection::Ris), ["rrDepth", "resampling"]);
        assert_eq!(details_of(|s| s.resampling.direct = DirectName::Ris), ["rrDepth", "resampling"]);
        assert_eq!(details_of(|s| s.lights = LightSelection::Photons), ["rrDepth", "lightPhotons"]);
        let caustics = details_of(|s| (s.estimator, s.photons.caustics) = (EstimatorName::RobustIgi, true));
        assert_eq!(caustics, ["rrDepth", "lightPaths", "photons"]);
    }

    #[test]
    fn forms_of_one_estimator_are_told_apart() {
        let of = |light_paths| {
            let mut settings = RenderSettings::new(Budget::Samples(1));
            (settings.estimator, settings.light_paths.light_paths) = (EstimatorName::Bdpt, light_paths);
            details(&settings).collect::<Vec<_>>()
        };
        assert!(of(1) != of(32) && of(32) == of(32));
        assert!(of(8)[1].1.contains("light_paths: 8"), "{:?}", of(8));
    }
}
