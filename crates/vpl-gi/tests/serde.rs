//! Partitions in files.
#![allow(clippy::unwrap_used)]

use vpl_gi::{Partition, Threshold};

#[test]
fn what_is_written_is_read() {
    for new in [Partition::hard, Partition::soft, Partition::balance, Partition::distance] {
        let partition = new(0.25).unwrap();
        let text = serde_json::to_string(&partition).unwrap();
        assert_eq!(serde_json::from_str::<Partition>(&text).unwrap(), partition, "{text}");
    }
    assert_eq!(serde_json::to_string(&Partition::soft(0.25).unwrap()).unwrap(), r#"{"soft":0.25}"#);
    let threshold = Threshold::normalised(3.0);
    let text = serde_json::to_string(&threshold).unwrap();
    assert_eq!(serde_json::from_str::<Threshold>(&text).unwrap(), threshold, "{text}");
}

#[test]
fn what_is_no_threshold_is_refused() {
    let error = serde_json::from_str::<Partition>(r#"{"hard":-1}"#).unwrap_err();
    assert!(error.to_string().contains("-1"), "{error}");
    assert!(serde_json::from_str::<Partition>(r#"{"harder":1}"#).is_err());
    assert_eq!(serde_json::from_str::<Threshold>(r#"{"normalised":2}"#).unwrap(), Threshold::normalised(2.0));
    let error = serde_json::from_str::<Threshold>(r#"{"absolute":-2}"#).unwrap_err();
    assert!(error.to_string().contains("-2"), "{error}");
}
