//! Statistical tests for samplers, densities and estimators.
