//! How rays go through a [`Hierarchy`].
//!
//! Tried and found no faster, on the machine of `docs/performance.md`: putting
//! children on the stack without branches, in an order kept for each octant of directions. It is never mispredicted, but then
//! the processor must wait for each node before it can start on the next.

use arrayvec::ArrayVec;
use glam::{Vec3A, Vec4};

use super::hierarchy::{Child, Hierarchy, Node, STACK_SIZE};
use crate::ray::Ray;

/// `1 + 2 gamma_3`: makes the slab test conservative (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013).
const FAR_FACTOR: f32 = 1.0 + 6.0 * f32::EPSILON;

impl Hierarchy {
    /// Visits the packs that the ray meets before `limit`, about from near to far. `visit` gets a pack and the
    /// present limit, and returns the new one.
    #[inline(always)]
    pub(crate) fn traverse(&self, ray: &Ray, mut limit: f32, mut visit: impl FnMut(usize, f32) -> f32) {
        if self.nodes.is_empty() {
            return;
        }
        let ray = SlabRay::new(ray);
        let mut stack = ArrayVec::<(Child, f32), STACK_SIZE>::new();
        let mut current = Child(0);
        loop {
            if current.is_leaf() {
                limit = visit(current.pack(), limit);
            } else {
                let node = &self.nodes[current.0 as usize];
                let (mut met, t_near) = ray.meet(node, limit);
                // Go on with the nearest, keep the others.
                if met != 0 {
                    let t_near = t_near.to_array();
                    let slot = met.trailing_zeros() as usize & 3;
                    met &= met - 1;
                    let mut nearest = (node.children[slot], t_near[slot]);
                    while met != 0 {
                        let slot = met.trailing_zeros() as usize & 3;
                        met &= met - 1;
                        let other = (node.children[slot], t_near[slot]);
                        let closer = other.1 < nearest.1;
                        stack.push(if closer { nearest } else { other });
                        nearest = if closer { other } else { nearest };
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

    /// Whether `found` holds for any pack that the ray meets before `limit`.
    ///
    /// In no order: a ray that nothing blocks has to meet them all, and one that is blocked is so by whatever comes first. To sort costs
    /// more than it finds sooner, and so does any fixed order (large boxes first, small ones, leaves).
    #[inline(always)]
    pub(crate) fn any(&self, ray: &Ray, limit: f32, mut found: impl FnMut(usize) -> bool) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let ray = SlabRay::new(ray);
        let mut stack = ArrayVec::<Child, STACK_SIZE>::new();
        let mut current = Child(0);
        loop {
            if current.is_leaf() {
                if found(current.pack()) {
                    return true;
                }
            } else {
                let node = &self.nodes[current.0 as usize];
                let (mut met, _) = ray.meet(node, limit);
                // Go on with the first, keep the others.
                if met != 0 {
                    current = node.children[met.trailing_zeros() as usize & 3];
                    met &= met - 1;
                    while met != 0 {
                        stack.push(node.children[met.trailing_zeros() as usize & 3]);
                        met &= met - 1;
                    }
                    continue;
                }
            }
            let Some(child) = stack.pop() else { return false };
            current = child;
        }
    }
}

/// A ray as boxes meet it: each number in all lanes.
#[derive(Clone, Copy, Debug)]
struct SlabRay {
    origin: [Vec4; 3],
    inverse: [Vec4; 3],
}

impl SlabRay {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array().map(Vec4::splat),
            inverse: reciprocal(ray.direction).to_array().map(Vec4::splat),
        }
    }

    /// Which of the four boxes of a node it meets before `limit`, a bit for each, and where.
    #[inline(always)]
    fn meet(&self, node: &Node, limit: f32) -> (u32, Vec4) {
        let [x, y, z] =
            [0, 1, 2].map(|axis| node.planes[axis].map(|plane| (plane - self.origin[axis]) * self.inverse[axis]));
        let t_near = x[0].min(x[1]).max(y[0].min(y[1])).max(z[0].min(z[1]).max(Vec4::ZERO));
        let t_far = x[0].max(x[1]).min(y[0].max(y[1])).min(z[0].max(z[1])) * FAR_FACTOR;
        (t_near.cmple(t_far.min(Vec4::splat(limit))).bitmask() & node.occupied, t_near)
    }
}

/// `1 / x`, finite, with the sign of `x` where it is zero: so that `0 * (1 / 0)` is not NaN.
#[inline(always)]
pub(super) fn reciprocal(x: Vec3A) -> Vec3A {
    const TINY: Vec3A = Vec3A::splat(1e-20);
    1.0 / Vec3A::select(x.abs().cmplt(TINY), TINY.copysign(x), x)
}
