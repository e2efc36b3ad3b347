//! Sequences and families in files.
#![allow(clippy::unwrap_used)]

use qmc_sampling::sampler::{PaddedLattice, ZSobol};
use qmc_sampling::sequences::{DigitScramble, Faure, Hammersley, MultiJittered, Stratified, VanDerCorput};
use qmc_sampling::sobol::{Randomisation, Sobol};
use qmc_sampling::{Independent, Interleaved, OwenSobol, Replications};

macro_rules! read {
    ($type:ty, $text:expr) => {
        serde_json::from_str::<$type>($text).map_err(|error| error.to_string())
    };
}

macro_rules! is_read_as_written {
    ($type:ty, $value:expr) => {{
        let value: $type = $value;
        assert_eq!(read!($type, &serde_json::to_string(&value).unwrap()), Ok(value));
    }};
}

#[test]
fn what_is_written_is_read() {
    is_read_as_written!(Interleaved, Interleaved::new(3, 2).unwrap());
    is_read_as_written!(Stratified, Stratified::jittered(4, 3, 9).unwrap());
    is_read_as_written!(MultiJittered, MultiJittered::new(4, 3, 9).unwrap());
    is_read_as_written!(Faure, Faure::new(5).unwrap().scrambled(DigitScramble::Owen(7)));
    is_read_as_written!(VanDerCorput, VanDerCorput::new(3).unwrap());
    is_read_as_written!(Hammersley, Hammersley::new(12).unwrap());
    is_read_as_written!(ZSobol, ZSobol::new(640, 480, 16, 1).unwrap());
    is_read_as_written!(Sobol, Sobol::new(Randomisation::Owen(3)));
    is_read_as_written!(OwenSobol, OwenSobol::new(4));
    is_read_as_written!(Independent, Independent::new(5));
    is_read_as_written!(PaddedLattice, PaddedLattice::new(6));
    let mut replications = Replications::new();
    [1.0, 2.0, 4.0].into_iter().for_each(|value| replications.push(value));
    is_read_as_written!(Replications, replications);
}

/// Sides of zero would be divided by, bases of one never end.
#[test]
fn what_is_written_by_hand_is_checked() {
    assert!(read!(Interleaved, r#"{"columns":0,"rows":3}"#).is_err());
    assert!(read!(Interleaved, r#"{"columns":65536,"rows":65536}"#).is_err());
    assert!(read!(Stratified, r#"{"grid":{"columns":2,"rows":0},"jitter":true,"seed":1}"#).is_err());
    assert!(read!(MultiJittered, r#"{"grid":{"columns":0,"rows":1},"seed":1}"#).is_err());
    assert!(read!(VanDerCorput, r#"{"base":1,"scramble":"None"}"#).is_err());
    assert!(read!(Hammersley, r#"{"points":0}"#).is_err());
    // The base follows from the dimensions.
    assert_eq!(read!(Faure, r#"{"base":1,"dimensions":3,"scramble":"None"}"#), Ok(Faure::new(3).unwrap()));
    assert!(read!(Faure, r#"{"base":2,"dimensions":0,"scramble":"None"}"#).is_err());
    let z_sobol =
        |paths: u32| read!(ZSobol, &format!(r#"{{"size":[8,8],"log2_paths":{paths},"log2_points":0,"seed":1}}"#));
    assert_eq!(z_sobol(4), Ok(ZSobol::new(8, 8, 16, 1).unwrap()));
    assert!(z_sobol(32).is_err() && z_sobol(31).is_ok());
    assert!(read!(Replications, r#"{"count":18446744073709551615,"mean":0.0,"squares":0.0}"#).is_err());
    assert!(read!(Replications, r#"{"count":2,"mean":0.0,"squares":-1.0}"#).is_err());
}
