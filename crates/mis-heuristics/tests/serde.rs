//! Heuristics in files.
#![allow(clippy::unwrap_used)]

use mis_heuristics::{Cutoff, Power};

#[test]
fn what_is_written_is_read() {
    for power in [Power::ONE, Power::TWO, Power::new(3.5).unwrap(), Power::new(7.0).unwrap()] {
        let text = serde_json::to_string(&power).unwrap();
        assert_eq!(serde_json::from_str::<Power>(&text).unwrap(), power, "{text}");
    }
    let cutoff = Cutoff::new(0.25).unwrap();
    assert_eq!(serde_json::to_string(&cutoff).unwrap(), "0.25");
    assert_eq!(serde_json::from_str::<Cutoff>("0.25").unwrap(), cutoff);
}

#[test]
fn what_is_no_parameter_is_refused() {
    assert!(serde_json::from_str::<Power>("0.5").unwrap_err().to_string().contains("not 0.5"));
    assert!(serde_json::from_str::<Cutoff>("-1").unwrap_err().to_string().contains("not -1"));
    assert!(serde_json::from_str::<Power>("null").is_err());
}
