//! Settings, photons and what goes on later in files.
#![allow(clippy::unwrap_used)]

use photon_map::{
    Allocation, Bound, CausticRule, DensityEstimation, Estimate, Gather, Guide, ImportanceScale, Importon, Kernel,
    MapPartition, Photon, ProgressivePoint, ProgressiveRadius,
};
use proptest::prelude::*;

macro_rules! read {
    ($type:ty, $text:expr) => {
        serde_json::from_str::<$type>($text).map_err(|error| error.to_string())
    };
}

macro_rules! is_read_as_written {
    ($type:ty, $value:expr, $text:expr) => {{
        let value: $type = $value;
        let text = serde_json::to_string(&value).unwrap();
        assert_eq!(text, $text);
        assert_eq!(read!($type, &text), Ok(value));
    }};
}

macro_rules! is_refused {
    ($type:ty, $text:expr, $why:expr) => {{
        let error = read!($type, $text).unwrap_err();
        assert!(error.contains($why), "{}: {error}", $text);
    }};
}

#[test]
fn settings_are_read_as_written() {
    is_read_as_written!(Kernel, Kernel::Constant, r#""constant""#);
    is_read_as_written!(Kernel, Kernel::cone(1.5).unwrap(), r#"{"cone":1.5}"#);
    is_read_as_written!(Kernel, Kernel::Epanechnikov, r#""epanechnikov""#);
    is_read_as_written!(Gather, Gather::within(0.25).unwrap(), r#"{"within":0.25}"#);
    let nearest = Gather::nearest(50, 0.25).unwrap();
    is_read_as_written!(Gather, nearest, r#"{"nearest":{"count":50,"max_radius":0.25}}"#);
    let estimation = DensityEstimation { gather: Gather::within(2.0).unwrap(), kernel: Kernel::CONE };
    is_read_as_written!(DensityEstimation, estimation, r#"{"gather":{"within":2.0},"kernel":{"cone":1.0}}"#);
    is_read_as_written!(Bound, Bound::Floor(0.01), r#"{"floor":0.01}"#);
    is_read_as_written!(Bound, Bound::Cutoff(0.0), r#"{"cutoff":0.0}"#);
    is_read_as_written!(MapPartition, MapPartition::one_number(0.25).unwrap(), r#"{"one_number":0.25}"#);
    is_read_as_written!(MapPartition, MapPartition::two_numbers(0.1).unwrap(), r#"{"two_numbers":0.1}"#);
    let trajectories = MapPartition::trajectories(0.3, 1001).unwrap();
    is_read_as_written!(MapPartition, trajectories, r#"{"trajectories":{"ratio":0.3,"paths":1001}}"#);
    is_read_as_written!(CausticRule, CausticRule::SPECULAR, r#""specular""#);
    is_read_as_written!(CausticRule, CausticRule::new(0.0).unwrap(), r#"{"roughness":0.0}"#);
    is_read_as_written!(Allocation, Allocation::BrightestFirst, r#""brightest_first""#);
    is_read_as_written!(Allocation, Allocation::Proportional, r#""proportional""#);
    is_read_as_written!(Guide, Guide::new(0.5).unwrap(), r#"{"share":0.5}"#);
}

#[test]
fn results_and_records_are_read_as_written() {
    let scale = ImportanceScale::from_queries([4.0, 2.0, 0.0, 8.0], 0.0).unwrap();
    is_read_as_written!(ImportanceScale, scale, r#"{"scale":0.5,"empty_share":0.25}"#);
    let estimate = Estimate { value: [1.0, 0.5, 0.0], photons: 12, radius: 0.125 };
    is_read_as_written!(Estimate<[f32; 3]>, estimate, r#"{"value":[1.0,0.5,0.0],"photons":12,"radius":0.125}"#);
    let mut photon = Photon::new([1.0, 2.0, 3.0], [0.0, 0.0, 1.0], [2.0, 1.0, 0.5]).from_light(7);
    photon.caustic = true;
    let text = concat!(
        r#"{"position":[1.0,2.0,3.0],"wi":[0.0,0.0,1.0],"flux":[2.0,1.0,0.5],"light":7,"primary":false,"#,
        r#""caustic":true}"#,
    );
    is_read_as_written!(Photon<[f32; 3]>, photon, text);
    let text =
        r#"{"position":[0.0,0.0,0.0],"wi":[0.0,0.0,1.0],"flux":0.1,"light":null,"primary":false,"caustic":false}"#;
    is_read_as_written!(Importon, Photon::new([0.0; 3], [0.0, 0.0, 1.0], 0.1), text);
}

/// An iteration that is interrupted is the one that was not.
#[test]
fn what_shrinks_goes_on_from_a_file() {
    let mut radius = ProgressiveRadius::new(0.3, 0.7).unwrap();
    let mut point = ProgressivePoint::new(0.3, 0.7).unwrap();
    for found in 0..9 {
        // As numbers, as below.
        let [kept, kept_point] = [serde_json::to_value(radius).unwrap(), serde_json::to_value(point).unwrap()];
        assert_eq!(serde_json::from_value::<ProgressiveRadius>(kept).unwrap(), radius);
        assert_eq!(serde_json::from_value::<ProgressivePoint<[f32; 3]>>(kept_point).unwrap(), point);
        radius.advance();
        point.add(found, [0.1 * found as f32, 0.7, 0.0]);
    }
    let first = ProgressiveRadius::new(0.5, 0.75).unwrap();
    is_read_as_written!(ProgressiveRadius, first, r#"{"radius_squared":0.25,"iteration":1,"alpha":0.75}"#);
    let first = ProgressivePoint::new(0.5, 0.75).unwrap();
    is_read_as_written!(
        ProgressivePoint<f64>,
        first,
        r#"{"radius_squared":0.25,"photons":0.0,"alpha":0.75,"flux":0.0}"#
    );
}

#[test]
fn impossible_settings_are_refused() {
    is_refused!(Kernel, r#"{"cone":0.5}"#, "a cone needs a flatness of at least 1, not 0.5");
    is_refused!(Kernel, r#""box""#, "unknown variant");
    is_refused!(Gather, r#"{"within":0}"#, "not 0");
    is_refused!(Gather, r#"{"nearest":{"count":1,"max_radius":1}}"#, "at least 2 of them, not 1");
    is_refused!(Gather, r#"{"nearest":{"count":2,"max_radius":-1}}"#, "not -1");
    is_refused!(Gather, r#"{"nearest":{"count":2,"max_radius":1,"radius":2}}"#, "unknown field");
    is_refused!(DensityEstimation, r#"{"gather":{"within":-2},"kernel":"constant"}"#, "not -2");
    is_refused!(DensityEstimation, r#"{"gather":{"within":2}}"#, "missing field");
    is_refused!(Bound, r#"{"floor":0}"#, "lies in [2^-53, 1], not at 0");
    is_refused!(Bound, r#"{"cutoff":2}"#, "lies in [0, 1], not at 2");
    is_refused!(MapPartition, r#"{"one_number":0}"#, "not at 0");
    is_refused!(MapPartition, r#"{"two_numbers":1.5}"#, "not at 1.5");
    is_refused!(MapPartition, r#"{"trajectories":{"ratio":2,"paths":100}}"#, "not at 2");
    is_refused!(MapPartition, r#"{"trajectories":{"ratio":0.25,"paths":3}}"#, "less than one path");
    is_refused!(CausticRule, r#"{"roughness":-1}"#, "at least 0, not -1");
    // An infinite roughness, which JSON does not have: no other rule may come of it.
    let all = serde_json::to_string(&CausticRule::new(f32::INFINITY).unwrap()).unwrap();
    is_refused!(CausticRule, &all, "invalid type: null");
    is_refused!(Allocation, r#""darkest_first""#, "unknown variant");
    is_refused!(Guide, r#"{"share":1}"#, "lies in [0, 1), not at 1");
}

#[test]
fn impossible_results_and_records_are_refused() {
    is_refused!(ImportanceScale, r#"{"scale":0,"empty_share":0}"#, "positive and finite, not 0");
    is_refused!(ImportanceScale, r#"{"scale":1,"empty_share":1}"#, "lies in [0, 1), not at 1");
    is_refused!(ImportanceScale, r#"{"scale":1,"empty_share":-1}"#, "lies in [0, 1), not at -1");
    is_refused!(Estimate<f32>, r#"{"value":1.0,"photons":-1,"radius":0.1}"#, "invalid value");
    is_refused!(Photon<f32>, r#"{"position":[0,0,0],"wi":[0,0,1],"flux":1}"#, "missing field");

    let radius = |squared: &str, iteration: &str, alpha: &str| {
        format!(r#"{{"radius_squared":{squared},"iteration":{iteration},"alpha":{alpha}}}"#)
    };
    assert!(read!(ProgressiveRadius, &radius("1", "9007199254740992", "0.5")).is_ok());
    is_refused!(
        ProgressiveRadius,
        &radius("0", "1", "0.5"),
        "a squared radius is positive, and its root finite in single precision, not 0"
    );
    is_refused!(ProgressiveRadius, &radius("1e300", "1", "0.5"), "finite in single precision, not 1000");
    is_refused!(ProgressiveRadius, &radius("1", "0", "0.5"), "from 1 to 2^53, not 0");
    is_refused!(ProgressiveRadius, &radius("1", "18446744073709551615", "0.5"), "from 1 to 2^53, not 184");
    is_refused!(ProgressiveRadius, &radius("1", "1", "1"), "not at 1");

    let point = |squared: &str, photons: &str, alpha: &str, flux: &str| {
        format!(r#"{{"radius_squared":{squared},"photons":{photons},"alpha":{alpha},"flux":{flux}}}"#)
    };
    is_refused!(
        ProgressivePoint<f32>,
        &point("-4", "1", "0.5", "1"),
        "a squared radius is positive, and its root finite in single precision, not -4"
    );
    is_refused!(ProgressivePoint<f32>, &point("1", "-1", "0.5", "1"), "finite and not negative, not -1");
    is_refused!(ProgressivePoint<f32>, &point("1", "1", "0", "1"), "not at 0");
    // Read as an f64, it is too much for an f32.
    let far = serde_json::from_str(&point("1", "1", "0.5", "1e300")).unwrap();
    let error = serde_json::from_value::<ProgressivePoint<f32>>(far).unwrap_err();
    assert!(error.to_string().contains("the flux that a point has gathered is not finite"), "{error}");
}

proptest! {
    /// Kept is the inverse of the flatness, written is the inverse of that. As numbers: text is for serde_json to read, which is a unit in
    /// the last place off now and then without a feature that would hold for the whole build.
    #[test]
    fn every_cone_is_read_as_written(flatness in prop_oneof![1.0..2.0_f64, 1.0..1e300_f64]) {
        let kernel = Kernel::cone(flatness).unwrap();
        prop_assert_eq!(serde_json::from_value::<Kernel>(serde_json::to_value(kernel).unwrap()).unwrap(), kernel);
    }
}
