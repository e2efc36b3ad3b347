//! Heuristics and partitions in files.
#![allow(clippy::unwrap_used)]

use mis_heuristics::{Cutoff, GeometryPartition, Power};

#[test]
fn what_is_written_is_read() {
    for power in [Power::ONE, Power::TWO, Power::new(3.5).unwrap(), Power::new(7.0).unwrap()] {
        let text = serde_json::to_string(&power).unwrap();
        assert_eq!(serde_json::from_str::<Power>(&text).unwrap(), power, "{text}");
    }
    let cutoff = Cutoff::new(0.25).unwrap();
    assert_eq!(serde_json::to_string(&cutoff).unwrap(), "0.25");
    assert_eq!(serde_json::from_str::<Cutoff>("0.25").unwrap(), cutoff);
    let (hard, soft) = (GeometryPartition::hard(0.5_f64).unwrap(), GeometryPartition::soft(0.25_f32).unwrap());
    assert_eq!(serde_json::to_string(&hard).unwrap(), r#"{"hard":0.5}"#);
    assert_eq!(serde_json::from_str::<GeometryPartition<f64>>(r#"{"hard":0.5}"#).unwrap(), hard);
    assert_eq!(serde_json::to_string(&soft).unwrap(), r#"{"soft":0.25}"#);
    assert_eq!(serde_json::from_str::<GeometryPartition<f32>>(r#"{"soft":0.25}"#).unwrap(), soft);
}

#[test]
fn what_is_no_parameter_is_refused() {
    assert!(serde_json::from_str::<Power>("0.5").unwrap_err().to_string().contains("not 0.5"));
    assert!(serde_json::from_str::<Cutoff>("-1").unwrap_err().to_string().contains("not -1"));
    assert!(serde_json::from_str::<Power>("null").is_err());
    for text in [r#"{"hard":-2}"#, r#"{"soft":-2}"#] {
        let error = serde_json::from_str::<GeometryPartition<f32>>(text).unwrap_err();
        assert!(error.to_string().contains("at least 0, not -2"), "{error}");
    }
    assert!(serde_json::from_str::<GeometryPartition<f32>>(r#"{"harder":1}"#).is_err());
}
