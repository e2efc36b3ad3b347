//! From a binary hierarchy to one of four children a node and four primitives a leaf, at the least expected cost.
//!
//! With `A` the surface area of a box, the expected cost of a ray is proportional to the sum of `A c_node` over nodes and
//! `A c_pack` over leaves (the surface area heuristic). The cheapest collapse is found exactly, by dynamic programming: let
//! `C(n, i)` be the least cost of the primitives under the binary node `n` as a forest of at most `i` trees. Then
//!
//! ```text
//! S(n, i) = min over 0 < k < i of C(left, k) + C(right, i - k)
//! C(n, 1) = min(A c_pack if n has at most four primitives, A c_node + S(n, 4))
//! C(n, i) = min(C(n, i - 1), S(n, i))
//! ```
//!
//! Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.1.

use arrayvec::ArrayVec;
use obvhs::bvh2::Bvh2;

/// Children of a node at most.
pub(super) const WIDTH: usize = 4;
/// Primitives of a leaf at most.
pub(super) const LANES: usize = 4;
/// Cost of a node and of a leaf: the instructions they take are about the same.
const NODE_COST: f32 = 1.0;
const PACK_COST: f32 = 1.0;

/// What is known of one binary node.
#[derive(Clone, Copy)]
struct Entry {
    /// `C(n, i)` for `i` from 1 to 4.
    cost: [f32; WIDTH],
    /// For `i` from 2 to 4 the `k` of `S(n, i)`.
    split: [u8; WIDTH],
    /// Number of primitives, saturating at one more than a leaf holds.
    primitives: u8,
    is_leaf: bool,
}

/// The cheapest collapse of a binary hierarchy.
pub(super) struct Collapse<'b> {
    binary: &'b Bvh2,
    entries: Vec<Entry>,
}

impl<'b> Collapse<'b> {
    pub(super) fn new(binary: &'b Bvh2) -> Self {
        let unknown = Entry { cost: [f32::INFINITY; WIDTH], split: [0; WIDTH], primitives: 0, is_leaf: false };
        let mut collapse = Self { binary, entries: vec![unknown; binary.nodes.len()] };
        // Children first: the reverse of an order in which parents come first.
        let mut order = Vec::with_capacity(binary.nodes.len());
        let mut open = vec![0];
        while let Some(node) = open.pop() {
            order.push(node);
            if let Some([left, right]) = collapse.halves(node) {
                open.extend([left, right]);
            }
        }
        for &node in order.iter().rev() {
            collapse.entries[node] = collapse.entry(node);
        }
        collapse
    }

    fn halves(&self, node: usize) -> Option<[usize; 2]> {
        let node = &self.binary.nodes[node];
        let first = node.first_index as usize;
        (node.prim_count == 0).then_some([first, first + 1])
    }

    fn entry(&self, node: usize) -> Entry {
        let area = self.binary.nodes[node].aabb().half_area();
        let Some(halves) = self.halves(node) else {
            let primitives = self.binary.nodes[node].prim_count.min(LANES as u32 + 1) as u8;
            return Entry { cost: [area * PACK_COST; WIDTH], split: [0; WIDTH], primitives, is_leaf: true };
        };
        let [left, right] = halves.map(|half| &self.entries[half]);
        let (mut cost, mut split) = ([f32::INFINITY; WIDTH], [0; WIDTH]);
        for i in 1..WIDTH {
            for k in 0..i {
                let sum = left.cost[k] + right.cost[i - 1 - k];
                if sum < cost[i] || k == 0 {
                    (cost[i], split[i]) = (sum, k as u8 + 1);
                }
            }
        }
        let primitives = (left.primitives + right.primitives).min(LANES as u8 + 1);
        let (as_leaf, as_node) = (area * PACK_COST, area * NODE_COST + cost[WIDTH - 1]);
        let is_leaf = primitives as usize <= LANES && as_leaf <= as_node;
        cost[0] = if is_leaf { as_leaf } else { as_node };
        for i in 1..WIDTH {
            if cost[i - 1] <= cost[i] {
                (cost[i], split[i]) = (cost[i - 1], 0);
            }
        }
        // The split into four is needed for the node itself, even if fewer trees are as cheap.
        Entry { cost, split, primitives, is_leaf }
    }

    /// Whether the primitives under a binary node make one leaf.
    pub(super) fn is_leaf(&self, node: usize) -> bool {
        self.entries[node].is_leaf
    }

    /// The binary nodes that become the children of the node that stands for `node`.
    pub(super) fn children(&self, node: usize) -> ArrayVec<usize, WIDTH> {
        let mut children = ArrayVec::new();
        if let Some(halves) = self.halves(node) {
            let left = self.widest_split(halves);
            self.forest(halves[0], left, &mut children);
            self.forest(halves[1], WIDTH - left, &mut children);
        }
        children
    }

    /// The `k` of `S(n, 4)`.
    fn widest_split(&self, halves: [usize; 2]) -> usize {
        let [left, right] = halves.map(|half| self.entries[half].cost);
        let cost = |k: usize| left[k - 1] + right[WIDTH - k - 1];
        (1..WIDTH).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(1)
    }

    /// The roots of the cheapest forest of at most `trees` trees.
    fn forest(&self, node: usize, trees: usize, roots: &mut ArrayVec<usize, WIDTH>) {
        let entry = &self.entries[node];
        let trees = (1..trees).rev().find(|&i| entry.split[i] > 0).map_or(1, |i| i + 1);
        match self.halves(node) {
            Some([left, right]) if trees > 1 => {
                let k = usize::from(entry.split[trees - 1]);
                self.forest(left, k, roots);
                self.forest(right, trees - k, roots);
            }
            _ => roots.push(node),
        }
    }

    /// Appends the primitives under a binary node.
    pub(super) fn primitives(&self, node: usize) -> Vec<u32> {
        let mut primitives = Vec::new();
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            match self.halves(node) {
                Some(halves) => open.extend(halves),
                None => {
                    let node = &self.binary.nodes[node];
                    let first = node.first_index as usize;
                    primitives.extend(&self.binary.primitive_indices[first..first + node.prim_count as usize]);
                }
            }
        }
        primitives
    }
}
