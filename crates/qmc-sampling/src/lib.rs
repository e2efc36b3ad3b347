//! Point sequences, samplers and warps for Monte Carlo and quasi-Monte Carlo integration.
