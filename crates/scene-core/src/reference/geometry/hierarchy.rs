//! A bounding volume hierarchy four boxes wide.
//!
//! obvhs builds a binary hierarchy (PLOC with reinsertion, Meister and Bittner 2018 and 2017); [`Collapse`] makes nodes of
//! four boxes of it, stored axis by axis, so that one ray meets four boxes at once, and leaves of up to four primitives.
//!
//! Tried and found no faster, on the machine of `docs/performance.md`: eight boxes a node (in two vectors of four).

use core::ops::Range;
use core::time::Duration;

use glam::{Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use super::collapse::{Collapse, LANES, WIDTH};

/// Children waiting at most.
pub(super) const STACK_SIZE: usize = 64;
/// Nodes above each other at most: each leaves all its children but one waiting.
const MAX_DEPTH: usize = STACK_SIZE / (WIDTH - 1);

/// A child is an inner node, or a pack of primitives if the highest bit is set.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Child(pub(super) u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline(always)]
    pub(super) fn pack(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}

/// Four boxes: for each axis the lower and the upper planes. Two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Node {
    pub(super) planes: [[Vec4; 2]; 3],
    pub(super) children: [Child; WIDTH],
    /// One bit for each child.
    pub(super) occupied: u32,
}

impl Node {
    /// A node without children.
    const EMPTY: Self = Self { planes: [[Vec4::ZERO; 2]; 3], children: [Child(0); WIDTH], occupied: 0 };

    fn new(children: &[(Aabb, Child)]) -> Self {
        let mut node = Self::EMPTY;
        for (slot, (bounds, child)) in children.iter().enumerate() {
            for axis in 0..3 {
                node.planes[axis][0][slot] = bounds.min[axis];
                node.planes[axis][1][slot] = bounds.max[axis];
            }
            node.children[slot] = *child;
            node.occupied |= 1 << slot;
        }
        node
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

/// A hierarchy over boxes. Its leaves are packs of up to four of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hierarchy {
    pub(super) nodes: Vec<Node>,
    /// Where each pack starts in `order`, and where the last one ends.
    starts: Vec<u32>,
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
        let parameters = BvhBuildParams { max_prims_per_leaf: 1, ..preset };
        let binary = build_bvh2(boxes, parameters, &mut Duration::default());
        Self::collapse(&binary).unwrap_or_else(|| Self::balanced(boxes))
    }

    /// The boxes of a pack.
    #[inline]
    pub(crate) fn pack(&self, pack: usize) -> &[u32] {
        &self.order[self.starts[pack] as usize..self.starts[pack + 1] as usize]
    }

    /// The boxes of all packs, one pack after the other.
    pub(crate) fn packs(&self) -> impl Iterator<Item = &[u32]> {
        (1..self.starts.len()).map(|end| self.pack(end - 1))
    }

    /// Around all boxes; nothing if there are none.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        self.bounds
    }

    /// Adds a pack of primitives.
    fn add_pack(&mut self, primitives: &[u32]) -> Child {
        self.order.extend(primitives);
        self.starts.push(self.order.len() as u32);
        Child(Child::LEAF | (self.starts.len() - 2) as u32)
    }

    /// Makes wide nodes of a binary hierarchy; nothing if it is too deep for the stack.
    fn collapse(binary: &Bvh2) -> Option<Self> {
        let collapse = Collapse::new(binary);
        let bounds = *binary.nodes[0].aabb();
        let mut hierarchy = Self { nodes: vec![Node::EMPTY], starts: vec![0], order: Vec::new(), bounds: Some(bounds) };
        if collapse.is_leaf(0) {
            let child = hierarchy.add_pack(&collapse.primitives(0));
            hierarchy.nodes[0] = Node::new(&[(bounds, child)]);
            return Some(hierarchy);
        }
        // Wide node, the binary node that it stands for, depth.
        let mut open = vec![(0, 0, 1)];
        while let Some((wide, narrow, depth)) = open.pop() {
            if depth > MAX_DEPTH {
                return None;
            }
            let mut children = Vec::with_capacity(WIDTH);
            for narrow in collapse.children(narrow) {
                let child = if collapse.is_leaf(narrow) {
                    hierarchy.add_pack(&collapse.primitives(narrow))
                } else {
                    hierarchy.nodes.push(Node::EMPTY);
                    open.push((hierarchy.nodes.len() - 1, narrow, depth + 1));
                    Child(hierarchy.nodes.len() as u32 - 1)
                };
                children.push((*binary.nodes[narrow].aabb(), child));
            }
            hierarchy.nodes[wide] = Node::new(&children);
        }
        Some(hierarchy)
    }

    /// A hierarchy of logarithmic depth, whatever the boxes: halves along the longest axis of the centres. For
    /// degenerate input on which the binary hierarchy is a list.
    fn balanced(boxes: &[Aabb]) -> Self {
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let bounds_of = |range: &[u32]| {
            range
                .iter()
                .map(|&i| boxes[i as usize])
                .reduce(|a, b| Aabb { min: a.min.min(b.min), max: a.max.max(b.max) })
        };
        let bounds = bounds_of(&order);
        let mut hierarchy = Self { nodes: vec![Node::EMPTY], starts: vec![0], order: Vec::new(), bounds };
        let mut open = vec![(0, 0..order.len())];
        while let Some((wide, range)) = open.pop() {
            let mut children = Vec::with_capacity(WIDTH);
            for part in quarters(&mut order, range, boxes) {
                let Some(around) = bounds_of(&order[part.clone()]) else { continue };
                let child = if part.len() <= LANES {
                    hierarchy.add_pack(&order[part])
                } else {
                    hierarchy.nodes.push(Node::EMPTY);
                    open.push((hierarchy.nodes.len() - 1, part));
                    Child(hierarchy.nodes.len() as u32 - 1)
                };
                children.push((around, child));
            }
            hierarchy.nodes[wide] = Node::new(&children);
        }
        hierarchy
    }
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
    let cut = |k: usize| range.start + range.len() * k / WIDTH;
    (0..WIDTH).map(|k| cut(k)..cut(k + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;

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
        let (mut met, mut in_any_order): (Vec<u32>, Vec<u32>) = (Vec::new(), Vec::new());
        hierarchy.traverse(ray, ray.max_distance, |pack, limit| {
            met.extend(hierarchy.pack(pack));
            limit
        });
        let found = hierarchy.any(ray, ray.max_distance, |pack| {
            in_any_order.extend(hierarchy.pack(pack));
            false
        });
        met.sort_unstable();
        in_any_order.sort_unstable();
        assert!(!found && met == in_any_order);
        met
    }

    #[test]
    fn both_builders_meet_every_box_that_a_ray_meets() {
        let boxes = boxes(500);
        for hierarchy in [Hierarchy::new(&boxes), Hierarchy::balanced(&boxes)] {
            let mut all: Vec<u32> = hierarchy.packs().flatten().copied().collect();
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
        assert!(met(&hierarchy, &Ray::new(Vec3A::new(-3.0, 0.1, 0.0), Vec3A::X)).is_empty());
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
