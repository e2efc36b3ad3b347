//! Blocks of points that are near each other, and the hierarchy over them.

use core::time::Duration;

use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use super::{Bvh, MAX_DEPTH, Node};
use crate::ball::is_finite;
use crate::error::{BuildError, check_count};
use crate::lanes::{Lanes, WIDTH};

/// So many boxes in one place, to a millionth of the extent, are too many for obvhs.
const HEAP: usize = 256;

pub(super) fn build<P>(points: &[P], position: impl Fn(&P) -> [f32; 3]) -> Result<Bvh, BuildError> {
    check_count(points.len())?;
    let mut kept: Vec<(u32, [f32; 3])> =
        (0..).zip(points.iter().map(position)).filter(|(_, point)| is_finite(*point)).collect();
    let unit = Unit::new(&kept);
    sort_into_blocks(&mut kept);
    let leaves = leaves(&kept);
    let points_of_slots = Lanes::from_points(&kept);
    let nodes = hierarchy(&leaves, &unit);
    Ok(Bvh { nodes, points: points_of_slots, skipped: points.len() - kept.len() })
}

/// Halves the points along the longest axis again and again, at whole blocks. The points of a block are in the order of
/// their ids.
///
/// Blocks cut from a space-filling curve would be as good but for those that hold both ends of a jump: their boxes, as
/// large as the jump, meet most queries.
fn sort_into_blocks(points: &mut [(u32, [f32; 3])]) {
    let mut waiting = vec![points];
    while let Some(points) = waiting.pop() {
        if points.len() <= WIDTH {
            points.sort_unstable_by_key(|(id, _)| *id);
            continue;
        }
        let axis = longest_axis(points);
        let middle = (points.len() / 2).next_multiple_of(WIDTH);
        points.select_nth_unstable_by(middle, |a, b| a.1[axis].total_cmp(&b.1[axis]).then(a.0.cmp(&b.0)));
        let (left, right) = points.split_at_mut(middle);
        waiting.extend([right, left]);
    }
}

fn longest_axis(points: &[(u32, [f32; 3])]) -> usize {
    let (mut min, mut max) = (points[0].1, points[0].1);
    for (_, point) in points {
        for axis in 0..3 {
            min[axis] = min[axis].min(point[axis]);
            max[axis] = max[axis].max(point[axis]);
        }
    }
    // Differences may overflow.
    let extent = [0, 1, 2].map(|axis| f64::from(max[axis]) - f64::from(min[axis]));
    (1..3).fold(0, |longest, axis| if extent[axis] > extent[longest] { axis } else { longest })
}

/// A leaf for each block; blocks in one and the same place share one.
fn leaves(points: &[(u32, [f32; 3])]) -> Vec<Node> {
    let mut leaves: Vec<Node> = Vec::with_capacity(points.len().div_ceil(WIDTH));
    for (block, points) in (0..).zip(points.chunks(WIDTH)) {
        let mut node = Node { min: points[0].1, max: points[0].1, first: block, blocks: 1 };
        for (_, point) in points {
            node.include(*point, *point);
        }
        match leaves.last_mut() {
            Some(last) if node.min == node.max && (last.min, last.max) == (node.min, node.max) => last.blocks += 1,
            _ => leaves.push(node),
        }
    }
    leaves
}

impl Node {
    fn include(&mut self, min: [f32; 3], max: [f32; 3]) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(min[axis]);
            self.max[axis] = self.max[axis].max(max[axis]);
        }
    }
}

/// Maps the bounding box of the points to the unit cube: areas of boxes neither overflow nor underflow there.
struct Unit {
    min: [f64; 3],
    inverse: f64,
}

impl Unit {
    fn new(points: &[(u32, [f32; 3])]) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (_, point) in points {
            for axis in 0..3 {
                min[axis] = min[axis].min(f64::from(point[axis]));
                max[axis] = max[axis].max(f64::from(point[axis]));
            }
        }
        let extent = (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max);
        Self { min, inverse: if extent > 0.0 { 1.0 / extent } else { 0.0 } }
    }

    fn map(&self, point: [f32; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| (f64::from(point[axis]) - self.min[axis]) * self.inverse)
    }

    fn aabb(&self, node: &Node) -> Aabb {
        Aabb { min: self.map(node.min).map(|x| x as f32).into(), max: self.map(node.max).map(|x| x as f32).into() }
    }
}

fn hierarchy(leaves: &[Node], unit: &Unit) -> Vec<Node> {
    let Some(first) = leaves.first() else { return Vec::new() };
    if leaves.len() == 1 {
        return vec![*first];
    }
    let boxes: Vec<Aabb> = leaves.iter().map(|leaf| unit.aabb(leaf)).collect();
    let clustered = (!is_heap(&boxes)).then(|| {
        let parameters = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::fast_build() };
        build_bvh2(&boxes, parameters, &mut Duration::default())
    });
    clustered.and_then(|binary| adopt(&binary, leaves)).unwrap_or_else(|| balanced(leaves))
}

/// Whether so many boxes share a centre that obvhs takes quadratic time: their nearest neighbours are ties, of which each round
/// merges one.
fn is_heap(boxes: &[Aabb]) -> bool {
    let cell = |aabb: &Aabb| ((aabb.min + aabb.max) * 0.5e6).round().to_array().map(|x| x as i32);
    let mut cells: Vec<[i32; 3]> = boxes.iter().map(cell).collect();
    cells.sort_unstable();
    // Equal cells are neighbours: so many in a row are a heap.
    cells.windows(HEAP).any(|run| run[0] == run[HEAP - 1])
}

/// The hierarchy of obvhs, with the boxes of the points; nothing if it is too deep.
fn adopt(binary: &Bvh2, leaves: &[Node]) -> Option<Vec<Node>> {
    let mut nodes = vec![leaves[0]];
    // Node of obvhs, place of ours, depth.
    let mut waiting = vec![(0_usize, 0_usize, 0)];
    while let Some((from, to, depth)) = waiting.pop() {
        let node = binary.nodes.get(from)?;
        if depth >= MAX_DEPTH {
            return None;
        }
        if node.is_leaf() {
            nodes[to] = leaves[binary.primitive_indices[node.first_index as usize] as usize];
        } else {
            let children = nodes.len();
            nodes[to] = Node { first: children as u32, blocks: 0, ..leaves[0] };
            nodes.extend([leaves[0]; 2]);
            waiting.extend([0, 1].map(|child| (node.first_index as usize + child, children + child, depth + 1)));
        }
    }
    enclose(&mut nodes);
    Some(nodes)
}

/// Halves the sequence of the blocks again and again.
fn balanced(leaves: &[Node]) -> Vec<Node> {
    let mut nodes = vec![leaves[0]];
    let mut waiting = vec![(leaves, 0)];
    while let Some((leaves, to)) = waiting.pop() {
        if let [leaf] = leaves {
            nodes[to] = *leaf;
        } else {
            let children = nodes.len();
            nodes[to] = Node { first: children as u32, blocks: 0, ..leaves[0] };
            nodes.extend([leaves[0]; 2]);
            let (left, right) = leaves.split_at(leaves.len() / 2);
            waiting.extend([(left, children), (right, children + 1)]);
        }
    }
    enclose(&mut nodes);
    nodes
}

/// The boxes of inner nodes, from those of their children, which come after them.
fn enclose(nodes: &mut [Node]) {
    for node in (0..nodes.len()).rev() {
        if nodes[node].blocks == 0 {
            let child = nodes[node].first as usize;
            let (a, b) = (nodes[child], nodes[child + 1]);
            (nodes[node].min, nodes[node].max) = (a.min, a.max);
            nodes[node].include(b.min, b.max);
        }
    }
}
