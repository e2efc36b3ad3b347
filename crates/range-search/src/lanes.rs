//! Points as structure of arrays, and the loop that all indices but the k-d tree spend their time in.

use core::ops::{ControlFlow, Range};

use crate::ball::{Ball, distance_squared};

/// Points of a block.
pub(crate) const WIDTH: usize = 8;
/// Blocks tested between two looks at the results.
const BATCH: usize = 32;

/// Eight points and their ids in two cache lines, coordinates axis by axis.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Block {
    x: [f32; WIDTH],
    y: [f32; WIDTH],
    z: [f32; WIDTH],
    ids: [u32; WIDTH],
}

impl Block {
    /// Points that no ball contains.
    const EMPTY: Self = Self { x: [f32::NAN; WIDTH], y: [f32::NAN; WIDTH], z: [f32::NAN; WIDTH], ids: [0; WIDTH] };
}

/// Points in slots, blocks of structure of arrays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lanes {
    blocks: Vec<Block>,
    len: usize,
}

impl Lanes {
    /// So many points that nothing finds.
    pub(crate) fn new(len: usize) -> Self {
        Self { blocks: vec![Block::EMPTY; len.div_ceil(WIDTH)], len }
    }

    /// Points with their ids, in this order.
    pub(crate) fn from_points(points: &[(u32, [f32; 3])]) -> Self {
        let mut lanes = Self::new(points.len());
        for (slot, (id, point)) in points.iter().enumerate() {
            lanes.set(slot, *id, *point);
        }
        lanes
    }

    /// Number of points.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub(crate) fn position(&self, slot: usize) -> [f32; 3] {
        let (block, lane) = (&self.blocks[slot / WIDTH], slot % WIDTH);
        [block.x[lane], block.y[lane], block.z[lane]]
    }

    #[inline(always)]
    pub(crate) fn id(&self, slot: usize) -> u32 {
        self.blocks[slot / WIDTH].ids[slot % WIDTH]
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, slot: usize, id: u32, [x, y, z]: [f32; 3]) {
        let (block, lane) = (&mut self.blocks[slot / WIDTH], slot % WIDTH);
        (block.x[lane], block.y[lane], block.z[lane], block.ids[lane]) = (x, y, z, id);
    }

    /// Bytes on the heap.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Block>() * self.blocks.capacity()
    }

    /// Calls `f` with id and squared distance of the points in the ball, in the order in which `ranges` tells the slots.
    #[inline(always)]
    pub(crate) fn scan<B>(
        &self,
        ball: &Ball,
        ranges: impl IntoIterator<Item = Range<usize>>,
        mut f: impl FnMut(usize, f32) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let mut batch = Batch::new();
        for slots in ranges {
            for block in slots.start / WIDTH..slots.end.div_ceil(WIDTH) {
                if batch.len == BATCH {
                    batch.visit(&self.blocks, ball, &mut f)?;
                }
                batch.push(block, &slots);
            }
        }
        batch.visit(&self.blocks, ball, &mut f)
    }
}

/// Blocks to test together. Waiting for many at once hides their latency, and leaves few branches that are hard to predict.
struct Batch {
    len: usize,
    blocks: [u32; BATCH],
    /// Which points of a block are meant, as bits: the first and the last block of a range may hold others.
    meant: [u8; BATCH],
    /// All bits of a lane are set if its point is in the ball.
    inside: [[u32; WIDTH]; BATCH],
    distances: [[f32; WIDTH]; BATCH],
}

impl Batch {
    #[inline(always)]
    fn new() -> Self {
        let distances = [[0.0; WIDTH]; BATCH];
        Self { len: 0, blocks: [0; BATCH], meant: [0; BATCH], inside: [[0; WIDTH]; BATCH], distances }
    }

    /// Adds a block that meets a range of slots.
    #[inline(always)]
    fn push(&mut self, block: usize, slots: &Range<usize>) {
        let before = slots.start.saturating_sub(block * WIDTH) as u32;
        let after = ((block + 1) * WIDTH).saturating_sub(slots.end) as u32;
        self.blocks[self.len] = block as u32;
        self.meant[self.len] = ((0xff << before) & (0xff_u32 >> after)) as u8;
        self.len += 1;
    }

    /// Tests all blocks, calls `f` with what is in the ball, and forgets the blocks.
    #[inline(always)]
    fn visit<B>(
        &mut self,
        blocks: &[Block],
        ball: &Ball,
        f: &mut impl FnMut(usize, f32) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let len = core::mem::take(&mut self.len).min(BATCH);
        self.test(len, blocks, ball);
        for first in (0..len).step_by(WIDTH) {
            let mut found = 0;
            for block in first..(first + WIDTH).min(len) {
                found |= u64::from(bits(&self.inside[block]) & self.meant[block]) << (WIDTH * (block - first));
            }
            // One branch that is hard to predict for 64 points.
            while found != 0 {
                let lane = found.trailing_zeros() as usize;
                let (block, lane) = (first + lane / WIDTH, lane % WIDTH);
                f(blocks[self.blocks[block] as usize].ids[lane] as usize, self.distances[block][lane])?;
                found &= found - 1;
            }
        }
        ControlFlow::Continue(())
    }

    /// Without branches, and in a form that compilers turn into vector instructions, four lanes wide even if all they know is SSE2.
    #[inline(always)]
    fn test(&mut self, len: usize, blocks: &[Block], ball: &Ball) {
        let results = self.inside.iter_mut().zip(&mut self.distances);
        for (&block, (inside, distances)) in self.blocks[..len].iter().zip(results) {
            let block = &blocks[block as usize];
            for lane in 0..WIDTH {
                distances[lane] = distance_squared([block.x[lane], block.y[lane], block.z[lane]], ball.center);
            }
            for (inside, distance_squared) in inside.iter_mut().zip(&*distances) {
                *inside = if *distance_squared <= ball.radius_squared { u32::MAX } else { 0 };
            }
        }
    }
}

/// One bit of each lane.
#[inline(always)]
fn bits(lanes: &[u32; WIDTH]) -> u8 {
    const BIT: [u32; WIDTH] = [1, 2, 4, 8, 16, 32, 64, 128];
    lanes.iter().zip(BIT).fold(0, |bits, (lane, bit)| bits | (lane & bit)) as u8
}
