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

    #[inline(always)]
    fn set(&mut self, lane: usize, id: u32, [x, y, z]: [f32; 3]) {
        (self.x[lane], self.y[lane], self.z[lane], self.ids[lane]) = (x, y, z, id);
    }

    /// Sets all bits of the lanes whose points are in the ball. Without branches, and in a form that compilers turn into vector
    /// instructions, four lanes wide even if all they know is SSE2.
    #[inline(always)]
    #[expect(
        clippy::needless_range_loop,
        reason = "over three arrays and a fourth, and only so it becomes vector instructions"
    )]
    fn test(&self, ball: &Ball, inside: &mut [u32; WIDTH], distances: &mut [f32; WIDTH]) {
        for lane in 0..WIDTH {
            distances[lane] = distance_squared([self.x[lane], self.y[lane], self.z[lane]], ball.center);
        }
        for lane in 0..WIDTH {
            inside[lane] = if distances[lane] <= ball.radius_squared { u32::MAX } else { 0 };
        }
    }
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
    pub(crate) fn set(&mut self, slot: usize, id: u32, point: [f32; 3]) {
        self.blocks[slot / WIDTH].set(slot % WIDTH, id, point);
    }

    /// Makes ids of the slots.
    pub(crate) fn number(&mut self) {
        let ids = self.blocks.iter_mut().flat_map(|block| &mut block.ids);
        ids.take(self.len).zip(0..).for_each(|(id, slot)| *id = slot);
    }

    /// Fills all slots, so many at a time on each thread, with ids and points that begin at a slot.
    #[cfg(feature = "rayon")]
    pub(crate) fn par_fill<I: Iterator<Item = (u32, [f32; 3])>>(
        &mut self,
        slots: usize,
        points: impl Fn(usize) -> I + Sync,
    ) {
        use rayon::prelude::*;
        let len = self.len;
        let blocks = slots.div_ceil(WIDTH);
        self.blocks.par_chunks_mut(blocks).enumerate().for_each(|(chunk, blocks_of_chunk)| {
            let first = chunk * blocks * WIDTH;
            let count = (len - first).min(blocks * WIDTH);
            for (slot, (id, point)) in points(first).take(count).enumerate() {
                blocks_of_chunk[slot / WIDTH].set(slot % WIDTH, id, point);
            }
        });
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

    #[inline(always)]
    fn test(&mut self, len: usize, blocks: &[Block], ball: &Ball) {
        let results = self.inside.iter_mut().zip(&mut self.distances);
        for (&block, (inside, distances)) in self.blocks[..len].iter().zip(results) {
            blocks[block as usize].test(ball, inside, distances);
        }
    }
}

/// Points around a few queries, copied together so that each of these tests them in one go.
#[derive(Default)]
pub(crate) struct Candidates {
    /// Slots take the place of ids.
    blocks: Vec<Block>,
    inside: Vec<[u32; WIDTH]>,
    distances: Vec<[f32; WIDTH]>,
    found_slots: Vec<u32>,
    found_distances: Vec<f32>,
}

impl Candidates {
    /// Copies points.
    pub(crate) fn gather(&mut self, lanes: &Lanes, ranges: impl Iterator<Item = Range<usize>> + Clone) {
        let len: usize = ranges.clone().map(|slots| slots.len()).sum();
        self.blocks.clear();
        self.blocks.resize(len.div_ceil(WIDTH), Block::EMPTY);
        for (place, slot) in ranges.flatten().enumerate() {
            self.blocks[place / WIDTH].set(place % WIDTH, slot as u32, lanes.position(slot));
        }
        self.inside.resize(self.blocks.len(), [0; WIDTH]);
        self.distances.resize(self.blocks.len(), [0.0; WIDTH]);
        self.found_slots.resize(self.blocks.len() * WIDTH, 0);
        self.found_distances.resize(self.blocks.len() * WIDTH, 0.0);
    }

    /// Slots and squared distances of the candidates in the ball.
    #[inline(always)]
    pub(crate) fn find(&mut self, ball: &Ball) -> (&[u32], &[f32]) {
        for (block, (inside, distances)) in self.blocks.iter().zip(self.inside.iter_mut().zip(&mut self.distances)) {
            block.test(ball, inside, distances);
        }
        let batches = self.blocks.chunks(WIDTH).zip(self.inside.chunks(WIDTH)).zip(self.distances.chunks(WIDTH));
        let mut count = 0;
        for ((blocks, inside), distances) in batches {
            // Empty places are never inside.
            let mut found = (0_u32..)
                .zip(inside)
                .fold(0, |found, (block, inside)| found | (u64::from(bits(inside)) << (8 * block)));
            while found != 0 {
                let lane = found.trailing_zeros() as usize;
                let (block, lane) = (lane / WIDTH, lane % WIDTH);
                self.found_slots[count] = blocks[block].ids[lane];
                self.found_distances[count] = distances[block][lane];
                count += 1;
                found &= found - 1;
            }
        }
        (&self.found_slots[..count], &self.found_distances[..count])
    }
}

/// One bit of each lane.
#[inline(always)]
fn bits(lanes: &[u32; WIDTH]) -> u8 {
    const BIT: [u32; WIDTH] = [1, 2, 4, 8, 16, 32, 64, 128];
    lanes.iter().zip(BIT).fold(0, |bits, (lane, bit)| bits | (lane & bit)) as u8
}
