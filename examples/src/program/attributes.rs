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
pub(super) const DETAILS: [&str; 9] = [
    "rrDepth",
    "reconstruction",
    "aoDistance",
    "lightPaths",
    "resampling",
    "lightPhotons",
    "photons",
    "definitions",
    FRAME,
];

/// The attribute that tells which of several frames, of which eye, an image shows.
pub(super) const FRAME: &str = "frame";

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

/// Those of [`DETAILS`] that belong to this image: groups of settings, of which some at least have an effect on it.
fn details(settings: &RenderSettings) -> impl Iterator<Item = (&'static str, String)> {
    let estimator = settings.estimator;
    let occlusion = estimator == EstimatorName::Ao;
    let roulette = !occlusion && estimator != EstimatorName::RestirDirect;
    let maps = matches!(estimator, EstimatorName::PhotonMap | EstimatorName::Sppm);
    let complement = estimator == EstimatorName::RobustIgi && settings.photons.caustics;
    let resamples = match estimator {
        EstimatorName::RestirDirect => true,
        EstimatorName::Path | EstimatorName::Direct | EstimatorName::PhotonMap | EstimatorName::Sppm => {
            !settings.direct_settings().is_plain()
        }
        _ => false,
    };
    let definitions: Vec<String> = settings.definitions.iter().map(|(name, value)| format!("{name}={value}")).collect();
    let detail = |applies: bool, name, text: &dyn Fn() -> String| applies.then(|| (name, text()));
    [
        detail(roulette, "rrDepth", &|| settings.rr_depth.to_string()),
        detail(settings.filter != Filter::BOX, "reconstruction", &|| format!("{:?}", settings.filter)),
        detail(occlusion, "aoDistance", &|| settings.ao_distance.to_string()),
        detail(estimator.connects_light_paths(), "lightPaths", &|| format!("{:?}", settings.light_paths)),
        detail(resamples, "resampling", &|| format!("{:?}", settings.direct_settings())),
        detail(settings.selects_by_photons(), "lightPhotons", &|| format!("{:?}", settings.light_photons)),
        detail(maps || complement, "photons", &|| format!("{:?}", settings.photons)),
        detail(!definitions.is_empty(), "definitions", &|| definitions.join(", ")),
    ]
    .into_iter()
    .flatten()
}

/// The first setting in which two images differ, but for `except`, with what each of them says. `one` and `other` tell their attributes by
/// name.
///
/// Images of older versions, and of other programs, may lack any of them, and are held to what they tell. Of images that tell details, each
/// has all that belong to it.
pub(super) fn difference(
    one: impl Fn(&str) -> Option<String>,
    other: impl Fn(&str) -> Option<String>,
    except: &[&str],
) -> Option<(&'static str, [String; 2])> {
    let tells = |of: &dyn Fn(&str) -> Option<String>| DETAILS.iter().any(|key| of(key).is_some());
    let tell_details = tells(&one) && tells(&other);
    NAMED.iter().chain(&DETAILS).filter(|key| !except.contains(key)).find_map(|&key| {
        let texts = [one(key), other(key)];
        let may_be_missing = !tell_details || !(DETAILS.contains(&key) || key == PATH_FILTER);
        if texts[0] == texts[1] || (may_be_missing && texts.iter().any(Option::is_none)) {
            return None;
        }
        Some((key, texts.map(|text| text.unwrap_or_else(|| "none".to_owned()))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choices::LightSelection;
    use crate::render::Budget;
    use crate::resampling::{DirectName, ScatteringName};

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
        assert_eq!(of(EstimatorName::RestirDirect), ["resampling"]);
        assert_eq!(of(EstimatorName::Sppm), ["rrDepth", "photons"]);
        assert_eq!(details_of(|s| s.filter = Filter::TENT), ["rrDepth", "reconstruction"]);
        assert_eq!(details_of(|s| s.lights = LightSelection::Ris), ["rrDepth", "resampling"]);
        assert_eq!(details_of(|s| s.resampling.direct = DirectName::Ris), ["rrDepth", "resampling"]);
        assert_eq!(details_of(|s| s.lights = LightSelection::Photons), ["rrDepth", "lightPhotons"]);
        let both = |s: &mut RenderSettings| {
            (s.lights, s.resampling.bsdf_sampling) = (LightSelection::Photons, ScatteringName::Ris);
        };
        assert_eq!(details_of(both), ["rrDepth", "resampling", "lightPhotons"]);
        let defined = details_of(|s| s.definitions = vec![("depth".into(), "3".into())]);
        assert_eq!(defined, ["rrDepth", "definitions"]);
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

    #[test]
    fn images_are_held_to_what_they_tell() {
        let told = |texts: &'static [(&str, &str)]| {
            move |key: &str| texts.iter().find(|(name, _)| *name == key).map(|(_, text)| (*text).to_owned())
        };
        let differ = |one, other| difference(told(one), told(other), &["seed"]).map(|(key, _)| key);
        let old = &[("scene", "a"), ("seed", "1")][..];
        let path = &[("scene", "a"), ("seed", "2"), ("rrDepth", "5")][..];
        let filtered = &[("scene", "a"), ("rrDepth", "5"), (PATH_FILTER, "psf")][..];
        assert_eq!((differ(old, path), differ(old, filtered), differ(old, &[])), (None, None, None));
        assert_eq!(differ(path, filtered), Some(PATH_FILTER));
        assert_eq!(differ(filtered, path), Some(PATH_FILTER));
        assert_eq!(differ(old, &[("scene", "b")]), Some("scene"));
        assert_eq!(differ(path, &[("rrDepth", "6")]), Some("rrDepth"));
        assert_eq!(differ(path, &[("rrDepth", "5"), ("lightPaths", "8")]), Some("lightPaths"));
    }
}
