//! Which cell a vertex falls into.

use crate::vertex::HasNormal;
use crate::{PathVertex, Radius};

/// What else keeps vertices apart. Closures `Fn(&V) -> u32` do.
///
/// Dyn compatible: `&dyn CellKey<V>`.
pub trait CellKey<V> {
    /// Vertices with different numbers share no cell.
    fn key(&self, vertex: &V) -> u32;
}

// Its docs say so.
const _: Option<&dyn CellKey<f32>> = None;

/// Nothing else keeps vertices apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "NoKeyName", into = "NoKeyName"))]
pub struct NoKey;

#[cfg(feature = "serde")]
by_name!(NoKeyName: NoKey);

impl<V> CellKey<V> for NoKey {
    #[inline(always)]
    fn key(&self, _: &V) -> u32 {
        0
    }
}

impl<V, F: Fn(&V) -> u32> CellKey<V> for F {
    #[inline(always)]
    fn key(&self, vertex: &V) -> u32 {
        self(vertex)
    }
}

/// A cell: never two of them for one key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Key {
    cell: [i32; 3],
    /// The level of the edge length, and the normal.
    surface: u32,
    other: u32,
}

impl Key {
    #[inline(always)]
    pub(super) fn hash(&self) -> u64 {
        let [x, y, z] = self.cell.map(|c| u64::from(c as u32));
        let a = mix(x | y << 32);
        let b = mix(a ^ (z | u64::from(self.surface) << 32));
        mix(b ^ u64::from(self.other))
    }
}

/// The finaliser of MurmurHash3 by D. Stafford's constants (variant 13): every bit of the input flips half of the output's.
#[inline(always)]
fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Rounds places and normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantizer {
    radius: Radius,
    /// Edge length of cells over the radius of the first batch.
    factor: f32,
    normal_steps: f32,
    seed: u64,
}

impl Quantizer {
    pub(super) fn new(radius: Radius, normal_steps: f32, batch: u64, iteration: u32) -> Self {
        let factor = std::f32::consts::PI.sqrt() * radius.shrinkage(batch);
        Self { radius, factor, normal_steps, seed: mix(batch ^ u64::from(iteration) << 48) }
    }

    /// The cell of vertex number `index`; none if it has no place, or no radius.
    pub(super) fn key<V: PathVertex + HasNormal>(&self, vertex: &V, index: usize, other: u32) -> Option<Key> {
        let radius = self.radius.at(1, vertex.path_length());
        if !(radius > 0.0 && radius.is_finite()) {
            return None;
        }
        // Levels by powers of two of the first batch's radius: they stay the same while it shrinks.
        let (level, edge) = if self.radius.is_absolute() {
            (0, radius * self.factor)
        } else {
            let level = radius.log2().round().clamp(-127.0, 127.0);
            (level as i32 as u32 & 0xff, level.exp2() * self.factor)
        };
        let place = self.jittered(vertex.position(), vertex.normal(), edge, index).map(|x| (x / edge).floor());
        // Cells further out than this would share numbers.
        let near = place.iter().all(|x| x.abs() < 2e9);
        let cell = place.map(|x| x as i32);
        near.then_some(Key { cell, surface: level << 24 | self.rounded(vertex.normal()), other })
    }

    /// Moves a place by up to half an edge: along the surface, or in all directions if there is no normal.
    #[inline(always)]
    fn jittered(&self, x: [f32; 3], normal: [f32; 3], edge: f32, index: usize) -> [f32; 3] {
        let bits = mix(self.seed ^ (index as u64) << 1);
        let number = |shift: u32| ((bits >> shift & 0x1f_ffff) as f32 / 2_097_152.0 - 0.5) * edge;
        let (u, v, w) = (number(0), number(21), number(42));
        match basis(normal) {
            Some((s, t)) => core::array::from_fn(|k| x[k] + u * s[k] + v * t[k]),
            None => [x[0] + u, x[1] + v, x[2] + w],
        }
    }

    /// The normal, in 24 bits.
    #[inline(always)]
    fn rounded(&self, normal: [f32; 3]) -> u32 {
        let [x, y, z] = normal.map(|n| ((n * self.normal_steps).round() as i32).clamp(-127, 127) as u32 & 0xff);
        x | y << 8 | z << 16
    }
}

/// Two directions that make a basis with a unit normal. After T. Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
#[inline(always)]
fn basis([x, y, z]: [f32; 3]) -> Option<([f32; 3], [f32; 3])> {
    let length = x * x + y * y + z * z;
    if !(length > 0.5 && length < 2.0) {
        return None;
    }
    let sign = 1.0_f32.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    Some(([1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]))
}
