//! Adaptive quadrature over rectangles, which finds the peaks that samples point at.

use std::collections::BinaryHeap;

use crate::verdict::Violation;

/// Kronrod's extension of the three-point Gauss rule on [-1, 1]: node, Kronrod weight, Gauss weight.
/// Source: Kronrod (1965); the constants to 17 digits satisfy the moment equations in the tests below.
const GAUSS_KRONROD: [[f64; 3]; 7] = [
    [-0.960_491_268_708_020_28, 0.104_656_226_026_467_27, 0.0],
    [-0.774_596_669_241_483_38, 0.268_488_089_868_333_44, 5.0 / 9.0],
    [-0.434_243_749_346_802_56, 0.401_397_414_775_962_22, 0.0],
    [0.0, 0.450_916_538_658_474_14, 8.0 / 9.0],
    [0.434_243_749_346_802_56, 0.401_397_414_775_962_22, 0.0],
    [0.774_596_669_241_483_38, 0.268_488_089_868_333_44, 5.0 / 9.0],
    [0.960_491_268_708_020_28, 0.104_656_226_026_467_27, 0.0],
];

/// The rule for the direction that a one-dimensional domain ignores.
const POINT: [[f64; 3]; 1] = [[0.0, 2.0, 2.0]];

/// A value beyond this multiple of all nodes is a peak that the nodes have missed.
const PEAK: f64 = 2.0;

/// Rectangles thinner than this are not split any more.
const THINNEST: f64 = 1e-13;

/// The result of a quadrature.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Integral {
    /// The integral.
    pub value: f64,
    /// An estimate of its error, usually far too large for smooth functions.
    pub error: f64,
    /// How often the function was evaluated.
    pub evaluations: usize,
    /// Whether the error is within the tolerance that was asked for.
    pub converged: bool,
}

/// A rectangle in parameter space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
}

impl Rectangle {
    /// The cell of a regular grid over the unit square.
    pub(crate) fn cell(index: usize, [rows, columns]: [usize; 2]) -> Self {
        let (row, column) = ((index / columns) as f64, (index % columns) as f64);
        let (rows, columns) = (rows as f64, columns as f64);
        Self { low: [row / rows, column / columns], high: [(row + 1.0) / rows, (column + 1.0) / columns] }
    }

    fn area(&self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    /// Whether a point is in the rectangle, or no farther from it than the rectangle is wide. Pieces shrink towards a
    /// peak like this, instead of ending beside it in a large one that sees nothing of the peak's slope.
    fn is_near(&self, point: [f64; 2]) -> bool {
        (0..2).all(|axis| {
            let width = self.high[axis] - self.low[axis];
            point[axis] >= self.low[axis] - width && point[axis] <= self.high[axis] + width
        })
    }

    fn halves(&self, axis: usize) -> [Self; 2] {
        let middle = 0.5 * (self.low[axis] + self.high[axis]);
        let (mut a, mut b) = (*self, *self);
        a.high[axis] = middle;
        b.low[axis] = middle;
        [a, b]
    }
}

/// A point where the function is known, with its value: it tells where to look for peaks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hint {
    pub(crate) at: [f64; 2],
    pub(crate) value: f64,
}

/// A rectangle with its integral; ordered by error.
struct Piece {
    rectangle: Rectangle,
    value: f64,
    error: f64,
    axis: usize,
    hints: Vec<Hint>,
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.error.total_cmp(&other.error)
    }
}

/// Integrates over rectangles, always splitting the one with the largest error.
///
/// ```text
/// I = sum_pieces K7 x K7,    error = sum_pieces max(|K7 x K7 - G3 x K7|, |K7 x K7 - K7 x G3|)
/// ```
///
/// The function is not negative. A piece with a nearby hint far above all its nodes has at least the error `hint * area`: it is split until it sees the peak.
/// The quadrature stops when the error is within `tolerance(I)`, or when `budget` evaluations are spent.
pub(crate) fn integrate(
    dimensions: usize,
    rectangles: impl IntoIterator<Item = Rectangle>,
    hints: &[Hint],
    f: &mut impl FnMut([f64; 2]) -> Result<f64, Violation>,
    tolerance: impl Fn(f64) -> f64,
    budget: usize,
) -> Result<Integral, Violation> {
    let mut pieces = BinaryHeap::new();
    let mut done = (0.0, 0.0);
    let mut evaluations = 0;
    let per_piece = if dimensions == 1 { GAUSS_KRONROD.len() } else { GAUSS_KRONROD.len().pow(2) };

    // Evaluate each rectangle once.
    for rectangle in rectangles {
        let mine = hints.iter().copied().filter(|hint| rectangle.is_near(hint.at)).collect();
        pieces.push(apply_rule(dimensions, rectangle, mine, f)?);
        evaluations += per_piece;
    }
    let sum = |pieces: &BinaryHeap<Piece>, done: (f64, f64)| {
        pieces.iter().fold(done, |(value, error), piece| (value + piece.value, error + piece.error))
    };
    let (mut value, mut error) = sum(&pieces, done);

    // Split the worst until the sum of the errors is tolerable.
    while error > tolerance(value) && evaluations + 2 * per_piece <= budget {
        let Some(worst) = pieces.pop() else { break };
        let axis = worst.axis;
        if worst.rectangle.high[axis] - worst.rectangle.low[axis] < THINNEST {
            done = (done.0 + worst.value, done.1);
            error -= worst.error;
            continue;
        }
        for half in worst.rectangle.halves(axis) {
            let mine = worst.hints.iter().copied().filter(|hint| half.is_near(hint.at)).collect();
            let piece = apply_rule(dimensions, half, mine, f)?;
            value += piece.value;
            error += piece.error;
            pieces.push(piece);
        }
        value -= worst.value;
        error -= worst.error;
        evaluations += 2 * per_piece;
        // The running sums drift when a huge first guess is taken back: renew them before they are believed.
        if error <= tolerance(value) {
            (value, error) = sum(&pieces, done);
        }
    }
    let (value, error) = sum(&pieces, done);
    Ok(Integral { value, error, evaluations, converged: error <= tolerance(value) })
}

fn apply_rule(
    dimensions: usize,
    rectangle: Rectangle,
    mut hints: Vec<Hint>,
    f: &mut impl FnMut([f64; 2]) -> Result<f64, Violation>,
) -> Result<Piece, Violation> {
    let Rectangle { low, high } = rectangle;
    let half = [0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])];
    let rule_v: &[[f64; 3]] = if dimensions == 1 { &POINT } else { &GAUSS_KRONROD };
    let (mut kk, mut gk, mut kg) = (0.0, 0.0, 0.0);
    let (mut largest, mut at_largest) = (0.0, low);
    for [x, kronrod_u, gauss_u] in GAUSS_KRONROD {
        for &[y, kronrod_v, gauss_v] in rule_v {
            let at = [low[0] + half[0] * (1.0 + x), low[1] + half[1] * (1.0 + y)];
            let value = f(at)?;
            kk += kronrod_u * kronrod_v * value;
            gk += gauss_u * kronrod_v * value;
            kg += kronrod_u * gauss_v * value;
            if value > largest {
                (largest, at_largest) = (value, at);
            }
        }
    }
    let scale = half[0] * half[1];
    let (error_u, error_v) = ((kk - gk).abs() * scale, (kk - kg).abs() * scale);
    let error = error_u.max(error_v);
    let axis = usize::from(error_v > error_u);
    let value = kk * scale;
    let highest = hints.iter().copied().max_by(|a, b| a.value.total_cmp(&b.value));
    // What one piece has seen, its halves must not forget.
    hints.push(Hint { at: at_largest, value: largest });
    match highest {
        Some(peak) if peak.value > PEAK * largest && peak.value * rectangle.area() > error => {
            let axis = if dimensions == 1 { 0 } else { narrow_axis(rectangle, peak, f)? };
            Ok(Piece { rectangle, value, error: peak.value * rectangle.area(), axis, hints })
        }
        _ => Ok(Piece { rectangle, value, error, axis, hints }),
    }
}

/// The axis along which the nodes miss a peak by more. A ridge must be split across, not along: halves without a hint
/// would lose it.
fn narrow_axis(
    Rectangle { low, high }: Rectangle,
    peak: Hint,
    f: &mut impl FnMut([f64; 2]) -> Result<f64, Violation>,
) -> Result<usize, Violation> {
    let mut largest = [0.0_f64; 2];
    for axis in [0, 1] {
        for [x, ..] in GAUSS_KRONROD {
            let mut at = peak.at;
            at[axis] = low[axis] + 0.5 * (high[axis] - low[axis]) * (1.0 + x);
            largest[axis] = largest[axis].max(f(at)?);
        }
    }
    let wider = usize::from(high[1] - low[1] > high[0] - low[0]);
    Ok(if largest[0] == largest[1] { wider } else { usize::from(largest[1] < largest[0]) })
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rectangle = Rectangle { low: [0.0, 0.0], high: [1.0, 1.0] };

    fn unit(dimensions: usize, hints: &[Hint], tolerance: f64, mut f: impl FnMut([f64; 2]) -> f64) -> Integral {
        integrate(dimensions, [UNIT], hints, &mut |x| Ok(f(x)), |_| tolerance, 5_000_000).unwrap()
    }

    #[test]
    fn the_rules_are_exact_for_polynomials() {
        for degree in 0..=11 {
            let moment = |column: usize| -> f64 { GAUSS_KRONROD.iter().map(|r| r[column] * r[0].powi(degree)).sum() };
            let exact = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
            assert!((moment(1) - exact).abs() < 1e-14, "Kronrod, degree {degree}");
            assert!(degree > 5 || (moment(2) - exact).abs() < 1e-14, "Gauss, degree {degree}");
        }
    }

    #[test]
    fn smooth_singular_and_discontinuous() {
        let product = unit(2, &[], 1e-9, |[x, y]| (3.0 * x).sin() * y.exp());
        let exact = (1.0 - 3.0_f64.cos()) / 3.0 * (1.0_f64.exp() - 1.0);
        assert!(product.converged && (product.value - exact).abs() < 1e-9);
        let singular = unit(1, &[], 1e-6, |[x, _]| 1.0 / x.sqrt());
        assert!(singular.converged && (singular.value - 2.0).abs() < 1e-5, "{singular:?}");
        let quarter_disk = unit(2, &[], 1e-4, |[x, y]| f64::from(x * x + y * y < 1.0));
        assert!(quarter_disk.converged && (quarter_disk.value - std::f64::consts::FRAC_PI_4).abs() < 1e-4);
    }

    #[test]
    fn hints_find_a_peak_that_no_node_sees() {
        let sigma = 1e-5_f64;
        let peak = |[x, y]: [f64; 2]| {
            (-0.5 * ((x - 0.3).powi(2) + (y - 0.7).powi(2)) / (sigma * sigma)).exp()
                / (std::f64::consts::TAU * sigma * sigma)
        };
        assert_eq!(unit(2, &[], 1e-4, peak).value, 0.0);
        let at = [0.3 + sigma, 0.7 - sigma];
        let found = unit(2, &[Hint { at, value: peak(at) }], 1e-4, peak);
        assert!(found.converged && (found.value - 1.0).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn the_budget_is_kept_and_errors_are_passed_on() {
        let rough = integrate(2, [UNIT], &[], &mut |[x, y]| Ok((1.0 / (x * y)).sin()), |_| 1e-12, 5_000).unwrap();
        assert!(!rough.converged && rough.evaluations <= 5_000);
        let violation = Violation::NotFinite { what: "density", at: "here".into() };
        let result = integrate(2, [UNIT], &[], &mut |_| Err(violation.clone()), |_| 1e-3, 1000);
        assert_eq!(result, Err(violation));
    }
}
