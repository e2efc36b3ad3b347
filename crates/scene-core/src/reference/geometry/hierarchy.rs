//! A bounding volume hierarchy four boxes wide.
//!
//! obvhs builds a binary hierarchy (PLOC with reinsertion, Meister and Bittner 2018 and 2017); here pairs of its levels are
//! collapsed into nodes of four boxes, stored axis by axis, so that one ray meets four boxes at once. obvhs' own compressed
//! eight-wide nodes (CWBVH) are made for GPUs: with them, and triangles tested one edge after the other, a ray of the Cornell box took
//! 910 instructions for the closest hit and 1,050 for any, against 610 and 470 now (callgrind). They also drop boxes left before
//! t = 1e-4 whatever the unit of length, and overwrite stacks deeper than 32.

use core::ops::Range;
use core::time::Duration;

use arrayvec::ArrayVec;
use glam::{Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use crate::ray::Ray;

/// Nodes waiting at most.
const STACK_SIZE: usize = 64;
/// Primitives in a leaf at most.
const MAX_LEAF: u32 = 4;
/// `1 + 2 gamma_3`: makes the slab test conservative (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013).
const FAR_FACTOR: f32 = 1.0 + 6.0 * f32::EPSILON;

/// A child is an inner node, or a range of primitives if the highest bit is set: then come four bits for their number.
#[derive(Clone, Copy, Debug)]
struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const COUNT_SHIFT: u32 = 27;
    const FIRST_MASK: u32 = (1 << Self::COUNT_SHIFT) - 1;

    fn leaf(first: u32, count: u32) -> Self {
        Self(Self::LEAF | count << Self::COUNT_SHIFT | first)
    }

    #[inline(always)]
    fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline(always)]
    fn range(self) -> Range<usize> {
        let first = (self.0 & Self::FIRST_MASK) as usize;
        first..first + (self.0 >> Self::COUNT_SHIFT & 15) as usize
    }
}

/// Four boxes: for each axis the lower and the upper planes.
#[derive(Clone, Copy, Debug)]
struct Node {
    planes: [[Vec4; 2]; 3],
    children: [Child; 4],
}

impl Node {
    /// Boxes that no ray meets.
    const EMPTY: Self = Self { planes: [[Vec4::INFINITY, Vec4::NEG_INFINITY]; 3], children: [Child(0); 4] };

    fn set(&mut self, slot: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[axis][0][slot] = bounds.min[axis];
            self.planes[axis][1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }
}

/// Whether so many boxes share a centre (to a millionth of the largest coordinate) that PLOC takes quadratic time: the
/// nearest neighbours of boxes in one place are ties, of which each round merges one. 8,000 of them took 8 s.
fn is_heap(boxes: &[Aabb]) -> bool {
    const MANY: usize = 256;
    if boxes.len() < MANY {
        return false;
    }
    let magnitude = boxes.iter().map(|b| b.min.abs().max(b.max.abs()).max_element()).fold(f32::MIN_POSITIVE, f32::max);
    let cell = |b: &Aabb| ((b.min + b.max) * (0.5e6 / magnitude)).round().to_array().map(|x| x as i32);
    let mut cells: Vec<[i32; 3]> = boxes.iter().map(cell).collect();
    cells.sort_unstable();
    // Equal cells are neighbours: so many in a row are a heap.
    cells.windows(MANY).any(|run| run[0] == run[MANY - 1])
}

/// A hierarchy over boxes. Its leaves are ranges of positions in [`order`](Self::order).
#[derive(Clone, Debug, Default)]
pub(crate) struct Hierarchy {
    nodes: Vec<Node>,
    order: Vec<u32>,
    bounds: Option<Aabb>,
}

impl Hierarchy {
    /// Builds over boxes with finite coordinates.
    pub(crate) fn new(boxes: &[Aabb]) -> Self {
        if boxes.is_empty() {
            return Self::default();
        }
        if is_heap(boxes) {
            return Self::balanced(boxes);
        }
        // Reinsertion is superlinear: large scenes take the cheaper preset.
        let preset = if boxes.len() > 500_000 { BvhBuildParams::fast_build() } else { BvhBuildParams::medium_build() };
        // A node of four boxes costs about as much as one triangle.
        let parameters = BvhBuildParams { max_prims_per_leaf: MAX_LEAF, collapse_traversal_cost: 0.5, ..preset };
        let binary = build_bvh2(boxes, parameters, &mut Duration::default());
        let (hierarchy, depth) = Self::collapse(&binary);
        if 3 * depth < STACK_SIZE { hierarchy } else { Self::balanced(boxes) }
    }

    /// Positions of leaves to indices of boxes.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Around all boxes; nothing if there are none.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        self.bounds
    }

    /// Collapses levels of a binary hierarchy; also returns the depth.
    fn collapse(binary: &Bvh2) -> (Self, usize) {
        let root = &binary.nodes[0];
        let mut hierarchy =
            Self { nodes: Vec::new(), order: binary.primitive_indices.clone(), bounds: Some(*root.aabb()) };
        let mut deepest = 1;
        if root.prim_count > 0 {
            let mut node = Node::EMPTY;
            node.set(0, root.aabb(), Child::leaf(root.first_index, root.prim_count));
            hierarchy.nodes.push(node);
            return (hierarchy, deepest);
        }
        hierarchy.nodes.push(Node::EMPTY);
        // Wide node, the binary node that it stands for, depth.
        let mut open = vec![(0, 0, 1)];
        while let Some((wide, narrow, depth)) = open.pop() {
            deepest = deepest.max(depth);
            let first = binary.nodes[narrow].first_index as usize;
            let mut slots = vec![first, first + 1];
            // Open the largest inner box until there are four.
            while slots.len() < 4 {
                let inner = |&&slot: &&usize| binary.nodes[slot].prim_count == 0;
                let area = |slot: usize| binary.nodes[slot].aabb().half_area();
                let Some(&largest) = slots.iter().filter(inner).max_by(|&&a, &&b| area(a).total_cmp(&area(b))) else {
                    break;
                };
                slots.retain(|&slot| slot != largest);
                let first = binary.nodes[largest].first_index as usize;
                slots.extend([first, first + 1]);
            }
            for (slot, narrow) in slots.into_iter().enumerate() {
                let node = &binary.nodes[narrow];
                let child = if node.prim_count > 0 {
                    Child::leaf(node.first_index, node.prim_count)
                } else {
                    hierarchy.nodes.push(Node::EMPTY);
                    open.push((hierarchy.nodes.len() - 1, narrow, depth + 1));
                    Child(hierarchy.nodes.len() as u32 - 1)
                };
                hierarchy.nodes[wide].set(slot, node.aabb(), child);
            }
        }
        (hierarchy, deepest)
    }

    /// A hierarchy of logarithmic depth, whatever the boxes: halves along the longest axis of the centres. For
    /// degenerate input on which the binary hierarchy is a list.
    fn balanced(boxes: &[Aabb]) -> Self {
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut nodes = vec![Node::EMPTY];
        let bounds_of = |range: &[u32]| {
            range
                .iter()
                .map(|&i| boxes[i as usize])
                .reduce(|a, b| Aabb { min: a.min.min(b.min), max: a.max.max(b.max) })
        };
        let bounds = bounds_of(&order);
        let mut open = vec![(0, 0..order.len())];
        while let Some((wide, range)) = open.pop() {
            for (slot, part) in quarters(&mut order, range, boxes).into_iter().enumerate() {
                let Some(around) = bounds_of(&order[part.clone()]) else { continue };
                let child = if part.len() <= MAX_LEAF as usize {
                    Child::leaf(part.start as u32, part.len() as u32)
                } else {
                    nodes.push(Node::EMPTY);
                    open.push((nodes.len() - 1, part));
                    Child(nodes.len() as u32 - 1)
                };
                nodes[wide].set(slot, &around, child);
            }
        }
        Self { nodes, order, bounds }
    }

    /// Visits the leaves that the ray meets before `limit`, about from near to far. `visit` gets a range of positions and the
    /// present limit, and returns the new one; a negative limit ends the traversal.
    #[inline(always)]
    pub(crate) fn traverse(&self, ray: &Ray, mut limit: f32, mut visit: impl FnMut(Range<usize>, f32) -> f32) {
        if self.nodes.is_empty() {
            return;
        }
        let inverse = ray.direction.to_array().map(reciprocal);
        let origin = ray.origin.to_array().map(Vec4::splat);
        // Which plane of each axis the ray crosses first: the upper one for negative directions.
        let first = inverse.map(|x| usize::from(x < 0.0));
        let inverse = inverse.map(Vec4::splat);

        let mut stack = ArrayVec::<(Child, f32), STACK_SIZE>::new();
        let mut current = Child(0);
        loop {
            if current.is_leaf() {
                limit = visit(current.range(), limit);
            } else {
                // Meet four boxes.
                let node = &self.nodes[current.0 as usize];
                let enter = |axis: usize| (node.planes[axis][first[axis] & 1] - origin[axis]) * inverse[axis];
                let leave = |axis: usize| (node.planes[axis][first[axis] & 1 ^ 1] - origin[axis]) * inverse[axis];
                let t_near = enter(0).max(enter(1)).max(enter(2).max(Vec4::ZERO));
                let t_far = leave(0).min(leave(1)).min(leave(2)) * FAR_FACTOR;
                let mut met = t_near.cmple(t_far.min(Vec4::splat(limit))).bitmask();

                // Go on with the nearest, keep the others.
                if met != 0 {
                    let t_near = t_near.to_array();
                    let slot = met.trailing_zeros() as usize;
                    met &= met - 1;
                    let mut nearest = (node.children[slot], t_near[slot]);
                    while met != 0 {
                        let slot = met.trailing_zeros() as usize;
                        met &= met - 1;
                        let mut other = (node.children[slot], t_near[slot]);
                        if other.1 < nearest.1 {
                            core::mem::swap(&mut other, &mut nearest);
                        }
                        stack.push(other);
                    }
                    current = nearest.0;
                    continue;
                }
            }
            // Take the next that is not yet too far.
            loop {
                let Some((child, t)) = stack.pop() else { return };
                if t <= limit {
                    current = child;
                    break;
                }
            }
        }
    }
}

/// `1 / x`, finite, with the sign of `x` where it is zero: so that `0 * (1 / 0)` is not NaN.
#[inline(always)]
fn reciprocal(x: f32) -> f32 {
    1.0 / if x.abs() < 1e-20 { 1e-20f32.copysign(x) } else { x }
}

/// Sorts a range into four parts of about equal size by the centres along their longest axis.
fn quarters(order: &mut [u32], range: Range<usize>, boxes: &[Aabb]) -> Vec<Range<usize>> {
    let center = |i: u32| boxes[i as usize].min + boxes[i as usize].max;
    let part = &mut order[range.clone()];
    let (low, high) = part
        .iter()
        .fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(low, high), &i| (low.min(center(i)), high.max(center(i))));
    let extent = high - low;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    part.sort_by(|&a, &b| center(a)[axis].total_cmp(&center(b)[axis]));
    let cut = |k: usize| range.start + range.len() * k / 4;
    (0..4).map(|k| cut(k)..cut(k + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(count: usize) -> Vec<Aabb> {
        let at = |i: usize, k: f32| (i as f32 * k).sin();
        (0..count)
            .map(|i| {
                let p = Vec3A::new(at(i, 1.3), at(i, 2.7), at(i, 0.9));
                Aabb { min: p, max: p + Vec3A::splat(0.05) }
            })
            .collect()
    }

    fn met(hierarchy: &Hierarchy, ray: &Ray) -> Vec<u32> {
        let mut met = Vec::new();
        hierarchy.traverse(ray, ray.max_distance, |range, limit| {
            met.extend(range.map(|position| hierarchy.order()[position]));
            limit
        });
        met.sort_unstable();
        met
    }

    #[test]
    fn both_builders_meet_every_box_that_a_ray_meets() {
        let boxes = boxes(500);
        for hierarchy in [Hierarchy::new(&boxes), Hierarchy::balanced(&boxes)] {
            let mut all = hierarchy.order().to_vec();
            all.sort_unstable();
            assert!(all.iter().copied().eq(0..500));
            for (i, target) in boxes.iter().enumerate() {
                for direction in [Vec3A::X, -Vec3A::Z, Vec3A::new(0.3, -0.8, 0.1).normalize()] {
                    let ray = Ray::new(0.5 * (target.min + target.max) - direction * 3.0, direction);
                    assert!(met(&hierarchy, &ray).contains(&(i as u32)));
                    assert!(!met(&hierarchy, &ray.up_to(1.0)).contains(&(i as u32)));
                }
            }
        }
    }

    #[test]
    fn flat_boxes_are_met_from_any_side() {
        let flat = Aabb { min: Vec3A::new(-1.0, 0.0, -1.0), max: Vec3A::new(1.0, 0.0, 1.0) };
        let hierarchy = Hierarchy::new(&[flat]);
        for direction in [Vec3A::Y, -Vec3A::Y, Vec3A::new(0.3, -0.8, 0.1).normalize()] {
            assert_eq!(met(&hierarchy, &Ray::new(-direction, direction)), [0]);
        }
        // Beside the plane and parallel to it.
        assert_eq!(met(&hierarchy, &Ray::new(Vec3A::new(-3.0, 0.1, 0.0), Vec3A::X)), []);
    }

    #[test]
    fn lists_of_boxes_that_contain_each_other_do_not_overflow_the_stack() {
        let nested: Vec<Aabb> = (0..3000)
            .map(|i| {
                let size = 1.01f32.powi(i);
                Aabb { min: Vec3A::ZERO, max: Vec3A::splat(size) }
            })
            .collect();
        let hierarchy = Hierarchy::new(&nested);
        let ray = Ray::new(Vec3A::splat(-1.0), Vec3A::ONE.normalize());
        assert_eq!(met(&hierarchy, &ray).len(), 3000);
    }
}
