//! The truncated Gaussian of unit standard deviation: density and inverse of the cumulative distribution.
//!
//! ```text
//! g(t) = (exp(-t^2 / 2) - exp(-8)) / Z,   abs(t) <= 4
//! ```
//! Its cumulative distribution has no inverse in closed form. It is tabulated for `t >= 0` with the density linear
//! between the nodes, and inverted exactly there: the relative error of the density is below `h^2 / 8 = 8e-6`.

use std::sync::LazyLock;

/// Where the filter ends, in standard deviations.
pub(super) const CUTOFF: f64 = 4.0;

const CELLS: usize = 512;
const CELL_WIDTH: f64 = CUTOFF / CELLS as f64;

struct Table {
    /// Unnormalised density at the nodes.
    density: [f64; CELLS + 1],
    /// Probability of `abs(t)` up to each node; from 0 to 1.
    cumulative: [f64; CELLS + 1],
    /// Integral of the unnormalised density over `t >= 0`.
    mass: f64,
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    let density: [f64; CELLS + 1] = std::array::from_fn(|i| unnormalised(i as f64 * CELL_WIDTH));
    let mut cumulative = [0.0; CELLS + 1];
    for i in 0..CELLS {
        cumulative[i + 1] = cumulative[i] + 0.5 * (density[i] + density[i + 1]) * CELL_WIDTH;
    }
    let mass = cumulative[CELLS];
    Table { density, cumulative: cumulative.map(|c| c / mass), mass }
});

fn unnormalised(t: f64) -> f64 {
    ((-0.5 * t * t).exp() - (-0.5 * CUTOFF * CUTOFF).exp()).max(0.0)
}

/// Density at `t`.
pub(super) fn density(t: f32) -> f32 {
    (unnormalised(f64::from(t)) / (2.0 * TABLE.mass)) as f32
}

/// The point up to which the probability is `u`.
pub(super) fn sample(u: f32) -> f32 {
    let table = &*TABLE;
    let centred = 2.0 * f64::from(u) - 1.0;
    let probability = centred.abs();
    let cell = table.cumulative.partition_point(|&c| c <= probability).clamp(1, CELLS) - 1;
    // Solve  density_0 t + (density_1 - density_0) t^2 / (2 h) = remainder  in the form that does not cancel.
    let remainder = (probability - table.cumulative[cell]) * table.mass;
    let [low, high] = [table.density[cell], table.density[cell + 1]];
    let root = (low * low + 2.0 * (high - low) * remainder / CELL_WIDTH).max(0.0).sqrt();
    let step = if remainder > 0.0 { (2.0 * remainder / (low + root)).min(CELL_WIDTH) } else { 0.0 };
    (cell as f64 * CELL_WIDTH + step).copysign(centred) as f32
}
