//! Points as structure of arrays, and the loop that all indices but the k-d tree spend their time in.

use core::ops::{ControlFlow, Range};

use crate::ball::{Ball, distance_squared};

/// Points tested between two looks at the results: one bit each.
pub(crate) const BLOCK: usize = 64;
/// Points tested at once.
const WIDTH: usize = 16;

/// Coordinates axis by axis. [`BLOCK`] points that nothing finds follow the last one, so that blocks can be read whole.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lanes {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl Lanes {
    /// So many points that nothing finds.
    pub(crate) fn new(len: usize) -> Self {
        let empty = || vec![f32::NAN; len + BLOCK];
        Self { x: empty(), y: empty(), z: empty() }
    }

    /// The points, in their order.
    pub(crate) fn from_points(points: impl ExactSizeIterator<Item = [f32; 3]>) -> Self {
        let mut lanes = Self::new(points.len());
        for (slot, point) in points.enumerate() {
            lanes.set(slot, point);
        }
        lanes
    }

    #[inline(always)]
    pub(crate) fn get(&self, slot: usize) -> [f32; 3] {
        [self.x[slot], self.y[slot], self.z[slot]]
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, slot: usize, [x, y, z]: [f32; 3]) {
        self.x[slot] = x;
        self.y[slot] = y;
        self.z[slot] = z;
    }

    /// Bytes on the heap.
    pub(crate) fn bytes(&self) -> usize {
        3 * size_of::<f32>() * self.x.capacity()
    }

    /// Calls `f` with slot and squared distance of the points in the ball, in ascending order of slots.
    #[inline(always)]
    pub(crate) fn scan<B>(
        &self,
        slots: Range<usize>,
        ball: &Ball,
        mut f: impl FnMut(usize, f32) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let mut distances = [0.0; BLOCK];
        for start in slots.clone().step_by(BLOCK) {
            let count = (slots.end - start).min(BLOCK);
            let mut found = self.test(start, count, ball, &mut distances);
            // One branch that is hard to predict for a block, not one for a point.
            while found != 0 {
                let lane = found.trailing_zeros() as usize;
                f(start + lane, distances[lane])?;
                found &= found - 1;
            }
        }
        ControlFlow::Continue(())
    }

    /// Which of up to [`BLOCK`] points are in the ball, as bits, and their squared distances.
    #[inline(always)]
    pub(crate) fn test(&self, start: usize, count: usize, ball: &Ball, distances: &mut [f32; BLOCK]) -> u64 {
        let block = start..start + BLOCK;
        let (Some(x), Some(y), Some(z)) =
            (self.x[block.clone()].first_chunk(), self.y[block.clone()].first_chunk(), self.z[block].first_chunk())
        else {
            return 0;
        };
        // What follows the last point is tested in vain.
        test_block(x, y, z, count, ball, distances) & (u64::MAX >> (BLOCK - count))
    }
}

/// The test itself, without branches, in a form that compilers turn into vector instructions: eight bytes of zeros and ones
/// become bits by a multiplication, which moves them all into the highest byte.
#[inline(always)]
fn test_block(
    x: &[f32; BLOCK],
    y: &[f32; BLOCK],
    z: &[f32; BLOCK],
    count: usize,
    ball: &Ball,
    distances: &mut [f32; BLOCK],
) -> u64 {
    let mut inside = [0; BLOCK];
    for group in 0..count.div_ceil(WIDTH).min(BLOCK / WIDTH) {
        for lane in group * WIDTH..(group + 1) * WIDTH {
            distances[lane] = distance_squared([x[lane], y[lane], z[lane]], ball.center);
            inside[lane] = u8::from(distances[lane] <= ball.radius_squared);
        }
    }
    let mut bits = 0;
    for (eight, bytes) in inside.as_chunks().0.iter().enumerate() {
        bits |= (u64::from_le_bytes(*bytes).wrapping_mul(0x0102_0408_1020_4080) >> 56) << (8 * eight);
    }
    bits
}
