//! Neighbours in the neighbourhood of the pixel.

use super::mean::{Mean, Rule, over_squared};
use super::prepared::{Iterated, Prepared};
use crate::vertex::HasPixel;
use crate::{Contribution, Kernel, PathVertex, Similarity, parallel};

/// Why there is no such screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ScreenError {
    /// Not an image.
    #[error("a screen of {width} x {height} pixels: it has at least one, and less than 2^31")]
    Size {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
}

/// Looks for neighbours only as far as some pixels away, and among those within the radius.
///
/// For real time: no index over the vertices, coherent reads. Vertices that are neighbours in space but not on the screen (mirrored, seen by another camera, in front
/// of and behind a fence) are not found. Consistent, since the centre is in its own pixel.
///
/// **Source.** Section 2.2 of the paper; P. Gautron et al., *Path Space Similarity Determined by Fourier Histogram Descriptors*, SIGGRAPH 2014 talks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Screen {
    width: u32,
    height: u32,
    reach: u32,
}

/// The fields, before they are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    width: u32,
    height: u32,
    reach: u32,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Screen {
    type Error = ScreenError;

    fn try_from(Unchecked { width, height, reach }: Unchecked) -> Result<Self, ScreenError> {
        Self::new(width, height, reach)
    }
}

impl Screen {
    /// A screen whose pixels look `reach` pixels to each side: 1 is a window of 3 x 3.
    ///
    /// # Errors
    /// If the screen has no pixels, or too many.
    pub fn new(width: u32, height: u32, reach: u32) -> Result<Self, ScreenError> {
        let count = u64::from(width) * u64::from(height);
        if count == 0 || count >= 1 << 31 {
            return Err(ScreenError::Size { width, height });
        }
        Ok(Self { width, height, reach: reach.min(width.max(height)) })
    }

    /// Sorts vertices into pixels.
    pub(super) fn pixels<V: HasPixel>(&self, vertices: &[V]) -> Pixels {
        let (width, height) = (self.width, self.height);
        let place = |vertex: &V| {
            let [x, y] = vertex.pixel();
            (x < width && y < height).then(|| y as usize * width as usize + x as usize)
        };
        let places: Vec<Option<usize>> = vertices.iter().map(place).collect();
        let mut starts = vec![0_usize; width as usize * height as usize + 1];
        for place in places.iter().flatten() {
            starts[place + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut ids = vec![0_usize; starts[starts.len() - 1]];
        let mut next = starts.clone();
        for (id, place) in places.iter().enumerate() {
            if let Some(place) = place {
                ids[next[*place]] = id;
                next[*place] += 1;
            }
        }
        Pixels { screen: *self, starts, ids, places }
    }
}

/// Vertices by pixel.
pub(super) struct Pixels {
    screen: Screen,
    /// Where the vertices of each pixel start.
    starts: Vec<usize>,
    ids: Vec<usize>,
    /// The pixel of each vertex.
    places: Vec<Option<usize>>,
}

impl Pixels {
    pub(super) fn averages<V, C, S, K>(&self, prepared: &Prepared<S::Features, C>, rule: &Rule<'_, S, K>) -> Iterated<C>
    where
        V: PathVertex,
        C: Contribution + Send + Sync,
        S: Similarity<V> + Sync,
        S::Features: Clone + Send + Sync,
        K: Kernel + Sync,
    {
        let mean = |i: usize| {
            let (Some(place), true) = (self.places[i], prepared.takes_part(i)) else { return prepared.own(i, None) };
            let (center, features, radius) = (prepared.positions[i], &prepared.features[i], prepared.radii[i]);
            let over = over_squared(radius);
            let mut mean = Mean::new();
            for row in self.rows(place) {
                for &j in &self.ids[row] {
                    let distance_squared = range_search::distance_squared(prepared.positions[j], center);
                    // Not if either is NaN.
                    if radius >= 0.0 && distance_squared <= radius * radius {
                        let weight = rule.weight(features, &prepared.features[j], distance_squared * over, i == j);
                        mean.add(weight, prepared.values[j]);
                    }
                }
            }
            prepared.own(i, mean.finish())
        };
        parallel::map_range(prepared.values.len(), mean).into_iter().unzip()
    }

    /// The vertices of each row of the window around a pixel.
    fn rows(&self, place: usize) -> impl Iterator<Item = core::ops::Range<usize>> + '_ {
        let Screen { width, height, reach } = self.screen;
        let (width, height, reach) = (width as usize, height as usize, reach as usize);
        let (x, y) = (place % width, place / width);
        let columns = x.saturating_sub(reach)..(x + reach + 1).min(width);
        (y.saturating_sub(reach)..(y + reach + 1).min(height))
            .map(move |row| self.starts[row * width + columns.start]..self.starts[row * width + columns.end])
    }
}
