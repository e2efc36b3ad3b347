//! The laws of the traits of `photon-map`: `Deposition` and `Flux`.
//!
//! ```
//! use estimator_checks::Outcome;
//! use estimator_checks::laws::photons::{check_deposition, check_flux};
//!
//! let near_the_eye = |x: [f32; 3], _wi: [f32; 3]| if x[0] < 1.0 { 1.0 } else { 0.25 };
//! Outcome::of_laws("near the eye", check_deposition(&near_the_eye, [])).expect_pass();
//! let colours = [[1.0_f32, 0.5, 0.0], [3.0, 2.0, 1e-3]];
//! Outcome::of_laws("colours", check_flux(&colours, |flux| flux.map(f64::from), 1e-6)).expect_pass();
//! ```

pub use photon_map::check::{Place, check_deposition, check_flux, check_positive, places};
