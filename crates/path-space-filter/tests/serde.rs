//! Filters, vertices and batches in files.
#![allow(clippy::unwrap_used)]

use path_space_filter::{
    AlbedoDifference, AlbedoFalloff, And, AsStored, Ball, Batch, Batches, CieXyz, CosinePower, Demodulated,
    Epanechnikov, Everything, Gaussian, HitDistance, JitteredHash, NoKey, NormalCone, PathSample, PathSpaceFilter,
    Poly6, Radius, SameObject, SameVisibility, Screen, Search, SimilarTime, SimilarityExt, SwitchOff, Vertex, ViewCone,
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
fn choices_are_written_by_name() {
    is_read_as_written!(Ball, Ball, r#""ball""#);
    is_read_as_written!(Epanechnikov, Epanechnikov, r#""epanechnikov""#);
    is_read_as_written!(Poly6, Poly6, r#""poly6""#);
    is_read_as_written!(Gaussian, Gaussian, r#""gaussian""#);
    is_read_as_written!(AsStored, AsStored, r#""as_stored""#);
    is_read_as_written!(CieXyz, CieXyz, r#""cie_xyz""#);
    is_read_as_written!(NoKey, NoKey, r#""no_key""#);
    is_read_as_written!(Everything, Everything, r#""everything""#);
    is_read_as_written!(SameVisibility, SameVisibility, r#""same_visibility""#);
    is_read_as_written!(SameObject, SameObject, r#""same_object""#);
    is_read_as_written!(Search, Search::Grid, r#""grid""#);
    is_read_as_written!(Search, Search::DivideAndConquer, r#""divide_and_conquer""#);
    #[cfg(feature = "kiddo")]
    is_read_as_written!(Search, Search::KdTree, r#""kd_tree""#);
    #[cfg(feature = "obvhs")]
    is_read_as_written!(Search, Search::Hierarchy, r#""hierarchy""#);
    is_read_as_written!(Search, Search::BruteForce, r#""brute_force""#);
    is_refused!(Ball, r#""gaussian""#, "unknown variant");
    is_refused!(Ball, "null", "expected value");
    is_refused!(Search, r#""oracle""#, "unknown variant");
}

#[test]
fn weights_are_read_as_written() {
    is_read_as_written!(NormalCone, NormalCone::PAPER, r#"{"normal_cone":0.95}"#);
    is_read_as_written!(ViewCone, ViewCone::new(-1.0).unwrap(), r#"{"view_cone":-1.0}"#);
    is_read_as_written!(AlbedoDifference, AlbedoDifference::PAPER, r#"{"albedo_difference":0.05}"#);
    is_read_as_written!(HitDistance, HitDistance::new(0.3).unwrap(), r#"{"hit_distance":0.3}"#);
    is_read_as_written!(SimilarTime, SimilarTime::new(0.0).unwrap(), r#"{"similar_time":0.0}"#);
    is_read_as_written!(CosinePower, CosinePower::new(16.0).unwrap(), r#"{"cosine_power":16.0}"#);
    is_read_as_written!(AlbedoFalloff, AlbedoFalloff::new(0.1).unwrap(), r#"{"albedo_falloff":0.1}"#);
    let alike = NormalCone::PAPER.and(SameObject).and(SimilarTime::new(0.5).unwrap());
    let text = r#"[[{"normal_cone":0.95},"same_object"],{"similar_time":0.5}]"#;
    is_read_as_written!(And<And<NormalCone, SameObject>, SimilarTime>, alike, text);
    // Squares that are infinite, or zero.
    for threshold in [1e30, f32::MAX, f32::INFINITY, 1e-30, 0.0] {
        let weight = AlbedoDifference::new(threshold).unwrap();
        assert_eq!(read!(AlbedoDifference, &serde_json::to_string(&weight).unwrap()), Ok(weight), "{threshold}");
    }
}

#[test]
fn impossible_weights_are_refused() {
    is_refused!(NormalCone, r#"{"normal_cone":1}"#, "a least cosine of 1");
    is_refused!(ViewCone, r#"{"view_cone":-1.5}"#, "a least cosine of -1.5");
    is_refused!(NormalCone, r#"{"view_cone":0.5}"#, "unknown variant");
    is_refused!(AlbedoDifference, r#"{"albedo_difference":-1}"#, "a threshold of -1");
    is_refused!(HitDistance, r#"{"hit_distance":-2}"#, "a threshold of -2");
    is_refused!(SimilarTime, r#"{"similar_time":-3}"#, "a threshold of -3");
    is_refused!(CosinePower, r#"{"cosine_power":0}"#, "an exponent of 0");
    is_refused!(AlbedoFalloff, r#"{"albedo_falloff":-1}"#, "an exponent of -1");
    is_refused!(And<NormalCone, SameObject>, r#"[{"normal_cone":2},"same_object"]"#, "a least cosine of 2");
    // An infinite threshold, which JSON does not have.
    let all = serde_json::to_string(&HitDistance::new(f32::INFINITY).unwrap()).unwrap();
    is_refused!(HitDistance, &all, "invalid type: null");
}

#[test]
fn filters_are_read_as_written() {
    let radius = Radius::absolute(0.5).unwrap();
    is_read_as_written!(Radius, radius, r#"{"absolute":{"initial":0.5,"exponent":0.25}}"#);
    is_read_as_written!(Radius, radius.held(), r#"{"absolute":{"initial":0.5,"exponent":0.0}}"#);
    let pixels = Radius::of_distance(0.01).unwrap().with_exponent(0.75).unwrap();
    is_read_as_written!(Radius, pixels, r#"{"of_distance":{"factor":0.01,"exponent":0.75}}"#);
    is_read_as_written!(Demodulated, Demodulated::default(), r#"{"demodulated":0.01}"#);
    is_read_as_written!(Screen, Screen::new(64, 48, 5).unwrap(), r#"{"width":64,"height":48,"reach":5}"#);

    let filter = PathSpaceFilter::new(radius);
    let text = concat!(
        r#"{"radius":{"absolute":{"initial":0.5,"exponent":0.25}},"similarity":"everything","#,
        r#""kernel":"ball","modulation":"as_stored","iterations":1,"search":"grid"}"#,
    );
    is_read_as_written!(PathSpaceFilter, filter, text);
    let filter = filter.similarity(NormalCone::PAPER).kernel(Poly6).modulation(Demodulated::default());
    let filter = filter.iterations(3).search(Search::BruteForce);
    let text = concat!(
        r#"{"radius":{"absolute":{"initial":0.5,"exponent":0.25}},"similarity":{"normal_cone":0.95},"#,
        r#""kernel":"poly6","modulation":{"demodulated":0.01},"iterations":3,"search":"brute_force"}"#,
    );
    is_read_as_written!(PathSpaceFilter<NormalCone, Poly6, Demodulated>, filter, text);
    is_refused!(PathSpaceFilter, text, "unknown variant");
    let hash = JitteredHash::new(radius).modulation(Demodulated::default()).normal_steps(3);
    let text = concat!(
        r#"{"radius":{"absolute":{"initial":0.5,"exponent":0.25}},"key":"no_key","#,
        r#""modulation":{"demodulated":0.01},"iterations":1,"normal_steps":3}"#,
    );
    is_read_as_written!(JitteredHash<NoKey, Demodulated>, hash, text);
}

#[test]
fn impossible_filters_are_refused() {
    let radius = |exponent: &str| read!(Radius, &format!(r#"{{"absolute":{{"initial":1,"exponent":{exponent}}}}}"#));
    assert_eq!(radius("0.5"), Radius::absolute(1.0).unwrap().with_exponent(0.5).map_err(|error| error.to_string()));
    for bad in ["1", "-0.25"] {
        assert!(radius(bad).unwrap_err().contains("it lies in (0, 1)"));
    }
    is_refused!(Radius, r#"{"absolute":{"initial":-1,"exponent":0.25}}"#, "an initial radius of -1");
    is_refused!(Radius, r#"{"of_distance":{"factor":-1,"exponent":0.25}}"#, "an initial radius of -1");
    is_refused!(Radius, r#"{"absolute":{"initial":1}}"#, "missing field");
    is_refused!(Radius, "1", "expected value");
    is_refused!(Screen, r#"{"width":0,"height":48,"reach":5}"#, "a screen of 0 x 48 pixels");
    is_refused!(Screen, r#"{"width":65536,"height":65536,"reach":5}"#, "a screen of 65536 x 65536 pixels");
    let filter = concat!(
        r#"{"radius":{"absolute":{"initial":-1,"exponent":0.25}},"similarity":"everything","#,
        r#""kernel":"ball","modulation":"as_stored","iterations":1,"search":"grid"}"#,
    );
    is_refused!(PathSpaceFilter, filter, "an initial radius of -1");
    is_refused!(PathSpaceFilter, r#"{"raduis":1}"#, "unknown field");
}

/// What the setters bring into range they bring into range here, too.
#[test]
fn what_is_out_of_range_is_brought_into_it() {
    assert_eq!(read!(Demodulated, r#"{"demodulated":-1}"#), Ok(Demodulated::with_floor(-1.0)));
    assert_eq!(read!(Screen, r#"{"width":4,"height":6,"reach":1000}"#), Ok(Screen::new(4, 6, 6).unwrap()));
    let hash = concat!(
        r#"{"radius":{"absolute":{"initial":0.5,"exponent":0.25}},"key":"no_key","modulation":"as_stored","#,
        r#""iterations":1,"normal_steps":4000000000}"#,
    );
    assert_eq!(read!(JitteredHash, hash), Ok(JitteredHash::new(Radius::absolute(0.5).unwrap()).normal_steps(100)));
}

#[test]
fn vertices_are_read_as_written() {
    let vertex =
        Vertex { position: [0.5, 1.0, -2.0], hit_distance: 0.1, object: 7, contribution: 3.0_f32, ..Vertex::default() };
    let text = concat!(
        r#"{"position":[0.5,1.0,-2.0],"normal":[0.0,0.0,0.0],"albedo":[0.0,0.0,0.0],"#,
        r#""view_direction":[0.0,0.0,0.0],"pixel":[0,0],"path_length":0.0,"hit_distance":0.1,"time":0.0,"#,
        r#""object":7,"visibility":0,"contribution":3.0}"#,
    );
    is_read_as_written!(Vertex<f32>, vertex, text);
    let sample = PathSample { vertex: Some(vertex), attenuation: [1.0], unfiltered: [0.5] };
    let text = format!(r#"{{"vertex":{text},"attenuation":[1.0],"unfiltered":[0.5]}}"#);
    is_read_as_written!(PathSample<Vertex<f32>, [f32; 1]>, sample, text);
    is_refused!(Vertex<f32>, r#"{"position":[0,0]}"#, "an array of length 3");
    is_refused!(Vertex<f32>, r#"{"position":[0,0,0]}"#, "missing field");
    is_refused!(Vertex<f32>, r#"{"place":[0,0,0]}"#, "unknown field");
}

#[test]
fn batches_go_on_from_a_file() {
    let mut batches = Batches::new(3, 2).unwrap();
    is_read_as_written!(Batches, batches.clone(), r#"{"base":3,"exponent":2,"next_start":0}"#);
    let first = batches.next_batch();
    is_read_as_written!(Batch, first, r#"{"start":0,"len":9,"number":1}"#);
    is_read_as_written!(Batches, batches.clone(), r#"{"base":3,"exponent":2,"next_start":9}"#);
    let mut later = read!(Batches, &serde_json::to_string(&batches).unwrap()).unwrap();
    assert_eq!(later.next_batch(), batches.next_batch());
    is_read_as_written!(SwitchOff, SwitchOff::new(2), r#"{"threshold":2,"off":false}"#);

    is_refused!(Batches, r#"{"base":1,"exponent":2,"next_start":0}"#, "the base is at least 2");
    is_refused!(Batches, r#"{"base":2,"exponent":63,"next_start":0}"#, "does not fit 63 bits");
    is_refused!(Batches, r#"{"base":3,"exponent":2,"next_start":10}"#, "path number 10 is not the first one");
    is_refused!(Batches, r#"{"base":3,"exponent":2,"len":9,"next_start":9}"#, "unknown field");
}

proptest! {
    /// Kept is the square, written is its root. As numbers: text is for serde_json to read.
    #[test]
    fn every_threshold_is_read_as_written(threshold in prop_oneof![0.0..2.0_f32, 0.0..1e-20_f32, 1e-40..1e20_f32]) {
        let weight = AlbedoDifference::new(threshold).unwrap();
        let numbers = serde_json::to_value(weight).unwrap();
        prop_assert_eq!(serde_json::from_value::<AlbedoDifference>(numbers).unwrap(), weight);
    }
}
