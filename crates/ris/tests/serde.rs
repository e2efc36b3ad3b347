//! Budgets and costs in files.
#![allow(clippy::unwrap_used)]

use ris::{Budget, CostModel};

#[test]
fn what_is_written_is_read() {
    let (budget, cost) = (Budget::new(15.75, 2.5), CostModel::new(1.0, 20.0).unwrap());
    assert_eq!(serde_json::to_string(&budget).unwrap(), r#"{"candidates":15.75,"samples":2.5}"#);
    assert_eq!(serde_json::from_str::<Budget>(&serde_json::to_string(&budget).unwrap()).unwrap(), budget);
    assert_eq!(serde_json::from_str::<CostModel>(&serde_json::to_string(&cost).unwrap()).unwrap(), cost);
}

#[test]
fn what_is_written_by_hand_is_checked() {
    // As everywhere, what is below one is one.
    let budget: Budget = serde_json::from_str(r#"{"candidates":-3,"samples":1e9}"#).unwrap();
    assert_eq!(budget, Budget::new(1.0, 16_777_216.0));
    assert!(serde_json::from_str::<Budget>(r#"{"candidates":4}"#).is_err());
    let free = serde_json::from_str::<CostModel>(r#"{"candidate":0,"sample":1}"#).unwrap_err();
    assert!(free.to_string().contains("a candidate cannot cost 0"), "{free}");
}
