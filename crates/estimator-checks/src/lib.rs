#![doc = include_str!("../README.md")]
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod bins;
mod blocks;
mod cells;
mod chi_square;
mod correlation;
mod distributions;
mod domain;
mod heuristic;
mod kolmogorov_smirnov;
pub mod laws;
mod mean;
mod moments;
mod multiple;
mod normalisation;
mod outcome;
mod pearson;
mod quadrature;
mod replicates;
mod resampling;
mod sampling;
mod seed;
mod slope;
mod suite;
mod verdict;

pub use mis_heuristics;
#[cfg(feature = "path-space-filter")]
pub use path_space_filter;
#[cfg(feature = "photon-map")]
pub use photon_map;
#[cfg(feature = "qmc-sampling")]
pub use qmc_sampling;
pub use rand_pcg;
#[cfg(feature = "range-search")]
pub use range_search;
#[cfg(feature = "scene-core")]
pub use scene_core;
#[cfg(feature = "vpl-gi")]
pub use vpl_gi;

pub use blocks::{BatchMeans, BlockError};
pub use chi_square::{ChiSquare, Missing};
pub use correlation::{serially_uncorrelated, uncorrelated};
pub use domain::{Coordinates, Disk, Domain, DomainError, Hemisphere, Interval, IntoPoint, Sphere, Square};
pub use heuristic::{HeuristicLaws, check_heuristic};
pub use kolmogorov_smirnov::{kolmogorov_smirnov, kolmogorov_smirnov_two_sample};
pub use mean::{Truth, mean_is, mean_is_known_variance, same_mean, same_mean_within, variance_ratio_is};
pub use moments::Moments;
pub use multiple::{bonferroni, holm, holm_adjusted};
pub use normalisation::{Normalisation, Total};
pub use outcome::{Outcome, Report};
pub use pearson::chi_square_counts;
pub use quadrature::Integral;
pub use replicates::randomised_mean_is;
pub use resampling::{check_resampling_weights, check_source};
pub use sampling::{Sampled, SamplingCheck, check_sampling};
pub use seed::{Uniforms, rng, seed};
pub use slope::{LogLogFit, log_log_fit, slope_at_most, slope_is};
pub use suite::{Check, FALSE_POSITIVE_RATE, Suite, SuiteError, assert_shares};
pub use verdict::{Undecided, Verdict, Violation};
