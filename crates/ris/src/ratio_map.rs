//! The optimal number of candidates for each pixel: the lower image of Talbot, Cline and Egbert's figure 3.

use alloc::vec;
use alloc::vec::Vec;

use crate::{CostModel, Objective, VarianceModel};

/// A variance model for each pixel, and the map of the best `M` that follows.
///
/// Single pixels have few candidates and estimates of `e1`, `e2`, `e3` are noisy, so [`candidates`](Self::candidates) pools a square
/// of neighbours: what Talbot, Cline and Egbert 2005 section 4.3 warns of ("severe noise and artifacts") shows with radius zero.
///
/// Choosing `M` from candidates that the estimate also uses would bias it; take other random numbers for the map.
///
/// ```
/// use ris::{CostModel, Objective, RatioMap};
/// let mut map = RatioMap::<1>::new(4, 3);
/// for k in 0..100 {
///     let x = (k as f64 + 0.5) / 100.0;
///     map.pixel_mut(1, 2).unwrap().add([x * x], x, 1.0);
/// }
/// let m = map.candidates(0, CostModel::new(1.0, 10.0)?, Objective::NormOfParts);
/// assert!(m[2 * 4 + 1] > 1.0);
/// assert_eq!(m[0], 1.0); // nothing is known there
/// # Ok::<(), ris::CostError>(())
/// ```
#[derive(Clone, Debug)]
pub struct RatioMap<const C: usize> {
    width: usize,
    height: usize,
    models: Vec<VarianceModel<C>>,
}

impl<const C: usize> RatioMap<C> {
    /// Without candidates.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, models: vec![VarianceModel::new(); width * height] }
    }

    /// Width and height.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The model of a pixel; `None` outside of the map.
    pub fn pixel_mut(&mut self, x: usize, y: usize) -> Option<&mut VarianceModel<C>> {
        if x < self.width && y < self.height { self.models.get_mut(y * self.width + x) } else { None }
    }

    /// The model of the square of pixels up to `radius` around one; without candidates outside of the map.
    pub fn pooled(&self, x: usize, y: usize, radius: usize) -> VarianceModel<C> {
        let mut sum = VarianceModel::new();
        let range = |center: usize, len: usize| {
            center.saturating_sub(radius)..len.min(center.saturating_add(radius).saturating_add(1))
        };
        for row in range(y, self.height) {
            for column in range(x, self.width) {
                sum.merge(&self.models[row * self.width + column]);
            }
        }
        sum
    }

    /// The model of the whole image.
    pub fn total(&self) -> VarianceModel<C> {
        self.models.iter().fold(VarianceModel::new(), |mut sum, model| {
            sum.merge(model);
            sum
        })
    }

    /// [`optimal_candidates`](VarianceModel::optimal_candidates) of every pixel, row by row, from the square of pixels up to
    /// `radius` around it. Infinite where more candidates always help.
    pub fn candidates(&self, radius: usize, cost: CostModel, objective: Objective<C>) -> Vec<f64> {
        let pixels = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        pixels.map(|(x, y)| self.pooled(x, y, radius).optimal_candidates(cost, objective)).collect()
    }
}
