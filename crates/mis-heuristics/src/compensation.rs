//! MIS compensation of a tabulated density.

use crate::Float;

/// Why a table cannot be compensated. The table is left as it was.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CompensationError {
    /// The two tables differ in length, or are empty.
    Lengths {
        /// Cells of the table.
        masses: usize,
        /// Cells of the other techniques.
        others: usize,
    },
    /// A cell is negative, infinite or NaN.
    Cell {
        /// Which cell.
        cell: usize,
        /// The offending value.
        mass: f64,
    },
    /// A table has no mass, or its sum is not finite.
    Sum(f64),
    /// The amount is negative, infinite or NaN.
    Amount(f64),
    /// So much is subtracted that nothing is left.
    NothingLeft,
}

impl core::fmt::Display for CompensationError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Lengths { masses, others } => {
                write!(f, "the tables have {masses} and {others} cells; they need equally many, at least one")
            }
            Self::Cell { cell, mass } => write!(f, "cell {cell} has the mass {mass}"),
            Self::Sum(sum) => write!(f, "the masses sum to {sum}, which is not a positive, finite number"),
            Self::Amount(amount) => write!(f, "cannot subtract the amount {amount}"),
            Self::NothingLeft => write!(f, "nothing is left of the table after the subtraction"),
        }
    }
}

impl core::error::Error for CompensationError {}

/// Sharpens a tabulated density by what the other techniques sample anyway, in place.
///
/// ```text
/// q'_i = max(0, q_i - a u_i) / sum_j max(0, q_j - a u_j)
/// ```
///
/// **Symbols.** `q_i`: the probability of cell `i` if the table alone were to follow the integrand; `u_i`: the
/// probability of that cell under the
/// other techniques together; both are normalised here. `a`: amount. If the table takes the fraction `c` of all
/// samples, the
/// mixture `c q' + (1-c) u` follows the integrand best for `a = 1 - c`. For an environment map, of which a surface
/// sees one half,
/// `u` is the solid angle of the cells and `a = 2 (1 - c)`: the mean is subtracted for `c = 1/2`.
///
/// **Assumptions.** For combination with the **balance heuristic** (the power heuristic over-compensates). Masses are
/// probabilities per cell, that is
/// density times measure of the cell (luminance times solid angle).
///
/// **Unbiased** as long as the other techniques really reach the cells that become zero: a cell of positive mass
/// becomes zero only where `u_i > 0`.
///
/// **Cost.** Three passes over the table, once.
///
/// **Source.** O. Karlík, M. Šik, P. Vévoda, T. Skřivan, J. Křivánek, "MIS Compensation: Optimizing Sampling
/// Techniques in Multiple Importance
/// Sampling", 2019.
///
/// # Errors
/// [`CompensationError`]; the table is left as it was. Amounts below one never leave nothing.
///
/// # Example
/// ```
/// use mis_heuristics::compensate;
/// let mut sky = [1.0, 1.0, 1.0, 5.0]; // luminance times solid angle
/// compensate(&mut sky, &[1.0; 4], 0.5)?;
/// assert_eq!(sky, [0.0, 0.0, 0.0, 1.0]); // the BSDF takes care of the dim cells
/// # Ok::<(), mis_heuristics::CompensationError>(())
/// ```
pub fn compensate<F: Float>(masses: &mut [F], others: &[F], amount: f64) -> Result<(), CompensationError> {
    if masses.len() != others.len() || masses.is_empty() {
        return Err(CompensationError::Lengths { masses: masses.len(), others: others.len() });
    }
    if !(0.0..f64::INFINITY).contains(&amount) {
        return Err(CompensationError::Amount(amount));
    }
    let (sum, sum_others) = (checked_sum(masses)?, checked_sum(others)?);
    let sharpened = |mass: F, other: F| (mass.to_f64() / sum - amount * (other.to_f64() / sum_others)).positive_part();

    let left: f64 = masses.iter().zip(others).map(|(&mass, &other)| sharpened(mass, other)).sum();
    // Rounding errors of a table that is subtracted from itself are nothing, too.
    if left <= 1e-12 {
        return Err(CompensationError::NothingLeft);
    }
    for (mass, &other) in masses.iter_mut().zip(others) {
        *mass = F::from_f64(sharpened(*mass, other) / left);
    }
    Ok(())
}

fn checked_sum<F: Float>(masses: &[F]) -> Result<f64, CompensationError> {
    let mut sum = 0.0;
    for (cell, mass) in masses.iter().map(|mass| mass.to_f64()).enumerate() {
        if !(0.0..f64::INFINITY).contains(&mass) {
            return Err(CompensationError::Cell { cell, mass });
        }
        sum += mass;
    }
    if sum > 0.0 && sum < f64::INFINITY { Ok(sum) } else { Err(CompensationError::Sum(sum)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_tables_are_refused_and_left_alone() {
        let table = [1.0_f32, 2.0];
        let refuse = |mut masses: [f32; 2], others: &[f32], amount| {
            let before = masses;
            let error = compensate(&mut masses, others, amount).unwrap_err();
            assert!(masses.iter().zip(&before).all(|(a, b)| a.to_bits() == b.to_bits()));
            error
        };
        assert_eq!(refuse(table, &[1.0], 0.5), CompensationError::Lengths { masses: 2, others: 1 });
        assert_eq!(refuse([1.0, -1.0], &table, 0.5), CompensationError::Cell { cell: 1, mass: -1.0 });
        assert!(matches!(refuse(table, &[f32::NAN, 1.0], 0.5), CompensationError::Cell { cell: 0, .. }));
        assert_eq!(refuse([0.0; 2], &table, 0.5), CompensationError::Sum(0.0));
        assert_eq!(refuse(table, &table, -0.5), CompensationError::Amount(-0.5));
        assert_eq!(refuse(table, &table, 1.0), CompensationError::NothingLeft);
        assert!(compensate(&mut [] as &mut [f64], &[], 0.5).is_err());
    }

    #[test]
    fn mixture_follows_the_integrand_where_nothing_is_clipped() {
        let (f, u, c) = ([0.3_f64, 0.4, 0.2, 0.1], [0.25_f64; 4], 0.75);
        let mut q = f;
        compensate(&mut q, &u, 1.0 - c).unwrap();
        for i in 0..4 {
            assert!((c * q[i] + (1.0 - c) * u[i] - f[i]).abs() < 1e-15);
        }
    }

    #[test]
    fn clipped_cells_are_covered_and_the_sum_is_one() {
        let mut q = [0.1_f64, 0.0, 5.0, 0.2, 0.1];
        compensate(&mut q, &[1.0, 1.0, 1.0, 1.0, 0.0], 0.9).unwrap();
        assert!((q.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert_eq!([q[0], q[1], q[3]], [0.0; 3]);
        assert!(q[4] > 0.0, "no other technique reaches the last cell");
    }

    #[test]
    fn nothing_subtracted_only_normalises() {
        let mut q = [1.0_f32, 3.0];
        compensate(&mut q, &[1.0, 1.0], 0.0).unwrap();
        assert_eq!(q, [0.25, 0.75]);
    }
}
