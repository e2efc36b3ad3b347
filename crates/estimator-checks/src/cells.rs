//! Cells for a histogram: a regular grid, refined where a pilot sample is dense.

use crate::quadrature::Rectangle;

/// A cell with a larger share of the pilot sample is split.
const LARGEST_SHARE: f64 = 0.02;

/// A cell with fewer pilot samples is not split, because their median says little.
const FEWEST: usize = 16;

/// A regular grid over the unit square whose heavy cells are split at the medians of a pilot sample, axis by axis.
///
/// A lobe narrower than a cell of the grid would otherwise be one count, which no test can judge.
pub(crate) struct Cells {
    shape: [usize; 2],
    roots: Vec<Node>,
    leaves: Vec<Rectangle>,
}

enum Node {
    Leaf(usize),
    Split { axis: usize, at: f64, halves: Box<[Node; 2]> },
}

impl Cells {
    /// Splits the cells of a grid until none that is wider than `resolution` holds much of the pilot sample.
    pub(crate) fn new(dimensions: usize, shape: [usize; 2], pilot: &[[f64; 2]], resolution: f64) -> Self {
        let shape = if dimensions == 1 { [shape[0] * shape[1], 1] } else { shape };
        let mut cells = Self { shape, roots: Vec::new(), leaves: Vec::new() };
        let count = shape[0] * shape[1];
        let mut inside = vec![Vec::new(); count];
        pilot.iter().for_each(|&at| inside[cells.root(at)].push(at));
        let limit = ((LARGEST_SHARE * pilot.len() as f64) as usize).max(FEWEST);
        for (index, mut samples) in inside.into_iter().enumerate() {
            let rectangle = Rectangle::cell(index, shape);
            let splitter = Splitter { axes: dimensions, limit, resolution };
            let node = splitter.split(rectangle, &mut samples, 0, &mut cells.leaves);
            cells.roots.push(node);
        }
        cells
    }

    pub(crate) fn leaves(&self) -> &[Rectangle] {
        &self.leaves
    }

    /// The cell that holds a point.
    pub(crate) fn locate(&self, point: [f64; 2]) -> usize {
        let mut node = &self.roots[self.root(point)];
        loop {
            match node {
                Node::Leaf(index) => return *index,
                Node::Split { axis, at, halves } => node = &halves[usize::from(point[*axis] >= *at)],
            }
        }
    }

    fn root(&self, [u, v]: [f64; 2]) -> usize {
        let [rows, columns] = self.shape;
        let row = ((u * rows as f64) as usize).min(rows - 1);
        let column = ((v * columns as f64) as usize).min(columns - 1);
        row * columns + column
    }
}

struct Splitter {
    axes: usize,
    limit: usize,
    resolution: f64,
}

impl Splitter {
    fn split(&self, cell: Rectangle, samples: &mut [[f64; 2]], first: usize, leaves: &mut Vec<Rectangle>) -> Node {
        let axis = (samples.len() > self.limit)
            .then(|| (0..self.axes).map(|i| (first + i) % self.axes).find_map(|axis| self.median(cell, samples, axis)))
            .flatten();
        let Some((axis, at)) = axis else {
            leaves.push(cell);
            return Node::Leaf(leaves.len() - 1);
        };
        let middle = samples.partition_point(|sample| sample[axis] < at);
        let (below, above) = samples.split_at_mut(middle);
        let (mut low, mut high) = (cell, cell);
        low.high[axis] = at;
        high.low[axis] = at;
        let halves = [self.split(low, below, axis + 1, leaves), self.split(high, above, axis + 1, leaves)];
        Node::Split { axis, at, halves: Box::new(halves) }
    }

    /// Sorts the samples along an axis; their median, if it leaves two halves of sufficient width.
    fn median(&self, cell: Rectangle, samples: &mut [[f64; 2]], axis: usize) -> Option<(usize, f64)> {
        samples.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
        let at = samples[samples.len() / 2][axis];
        let wide = at - cell.low[axis] >= self.resolution && cell.high[axis] - at >= self.resolution;
        wide.then_some((axis, at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Uniforms;

    fn area(rectangle: &Rectangle) -> f64 {
        (rectangle.high[0] - rectangle.low[0]) * (rectangle.high[1] - rectangle.low[1])
    }

    #[test]
    fn the_leaves_partition_the_square() {
        let mut uniforms = Uniforms::named("pilot");
        let pilot: Vec<[f64; 2]> = (0..5000).map(|_| uniforms.array().map(|u: f64| 0.3 + 0.001 * u * u)).collect();
        let cells = Cells::new(2, [4, 8], &pilot, 1e-6);
        assert!(cells.leaves().len() > 32 + 50, "{}", cells.leaves().len());
        assert!((cells.leaves().iter().map(area).sum::<f64>() - 1.0).abs() < 1e-12);
        let mut counts = vec![0; cells.leaves().len()];
        for &at in &pilot {
            let leaf = cells.locate(at);
            counts[leaf] += 1;
            let Rectangle { low, high } = cells.leaves()[leaf];
            assert!((0..2).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis]));
        }
        assert!(counts.iter().all(|&count| count <= 100));
    }

    #[test]
    fn a_spread_or_a_degenerate_pilot_keeps_the_grid() {
        let mut uniforms = Uniforms::named("spread");
        let pilot: Vec<[f64; 2]> = (0..5000).map(|_| uniforms.array()).collect();
        assert_eq!(Cells::new(2, [16, 16], &pilot, 1e-5).leaves().len(), 256);
        assert_eq!(Cells::new(2, [2, 2], &[[0.5, 1.0]; 1000], 1e-5).leaves().len(), 4);
        let line = Cells::new(1, [3, 4], &[], 1e-5);
        assert_eq!((line.leaves().len(), line.locate([1.0, 0.5])), (12, 11));
    }
}
