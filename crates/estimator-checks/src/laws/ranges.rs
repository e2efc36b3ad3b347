//! The laws of the trait of `range-search`: `RangeIndex`.
//!
//! ```
//! use estimator_checks::Outcome;
//! use estimator_checks::laws::ranges::{check_index, point_sets};
//! use range_search::HashGrid;
//!
//! for (name, points) in point_sets() {
//!     let grid = HashGrid::build(&points, |p| *p, 0.1)?;
//!     Outcome::of_laws(name, check_index(&grid, &points)).expect_pass();
//! }
//! # Ok::<(), range_search::BuildError>(())
//! ```

pub use range_search::check::{check_index, check_query, point_sets};
