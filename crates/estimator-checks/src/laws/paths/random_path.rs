//! Paths of all kinds, at random, without a scene.

use mis_heuristics::Densities;
use scene_core::glam::Vec3A;
use vpl_gi::PathTechniques;

use crate::seed::Uniforms;

/// Decimal digits of the smallest and the largest density, over one.
const DIGITS: f64 = 20.0;
/// Decimal digits of the smallest and the largest size, over one.
const SIZES: f32 = 3.0;

/// What a path is, in numbers.
#[derive(Clone, Debug)]
pub(super) struct RandomPath {
    positions: Vec<Option<Vec3A>>,
    /// Of the last edge, if it leads to infinity.
    towards: Vec3A,
    geometry: Vec<f32>,
    specular: Vec<bool>,
    connect: Vec<bool>,
    hit: bool,
    densities: Vec<f64>,
}

impl RandomPath {
    /// A path of `l` segments that some technique can generate.
    pub(super) fn new(l: usize, uniforms: &mut Uniforms) -> Self {
        // Of all sizes, so that some of them are beyond any threshold.
        let side = 10.0_f32.powf(SIZES * (2.0 * uniforms.next_f32() - 1.0));
        let point = |uniforms: &mut Uniforms| Vec3A::from(uniforms.array::<3>().map(|u| side * u as f32));
        let chance = |uniforms: &mut Uniforms, probability: f64| uniforms.next_f64() < probability;
        let mut positions: Vec<Option<Vec3A>> = (0..=l).map(|_| Some(point(uniforms))).collect();
        if chance(uniforms, 0.2) {
            positions[l] = None;
        }
        let specular: Vec<bool> = (0..=l).map(|k| chance(uniforms, 0.3) && k > 0 && k < l).collect();
        let (with_lens, is_seen) = (l > 1 && chance(uniforms, 0.5), chance(uniforms, 0.8));
        let longest = if chance(uniforms, 0.8) { l } else { (uniforms.next_f64() * l as f64) as usize };
        let can_connect = |k: usize| {
            let in_set = if k == 0 { with_lens && is_seen } else { true };
            in_set && !specular[k] && !specular[k + 1] && l - k - 1 <= longest
        };
        let connect: Vec<bool> = (0..l).map(can_connect).collect();
        let hit = l == 1 || !connect.contains(&true) || chance(uniforms, 0.7);
        let geometry = (0..l).map(|k| {
            let cosines = uniforms.next_f32() * uniforms.next_f32();
            // The lens has no normal.
            match (positions[k], positions[k + 1]) {
                (Some(x), Some(y)) if k > 0 => cosines / x.distance_squared(y),
                _ => 0.0,
            }
        });
        let geometry = geometry.collect();
        let techniques = l + usize::from(with_lens);
        let densities = (0..techniques).map(|i| {
            let density = 10.0_f64.powf(DIGITS * (2.0 * uniforms.next_f64() - 1.0));
            let possible = if i == 0 { hit } else { connect[l - i] };
            if possible { density } else { 0.0 }
        });
        let densities = densities.collect();
        let towards = (point(uniforms) / side - Vec3A::splat(0.5)).try_normalize().unwrap_or(Vec3A::Z);
        Self { positions, towards, geometry, specular, connect, hit, densities }
    }

    /// The same path, as `technique` generates it.
    pub(super) fn generated_by(&self, technique: usize) -> Self {
        let own = self.densities[technique];
        Self { densities: self.densities.iter().map(|density| density / own).collect(), ..self.clone() }
    }

    /// Techniques that can generate it.
    pub(super) fn possible(&self) -> impl Iterator<Item = usize> {
        (0..self.densities.len()).filter(|&i| self.densities[i] > 0.0)
    }
}

impl PathTechniques for RandomPath {
    fn segments(&self) -> usize {
        self.geometry.len()
    }
    fn densities(&self) -> impl Densities<f64> {
        self.densities.as_slice()
    }
    fn geometry_term(&self, k: usize) -> f32 {
        self.geometry[k]
    }
    fn position(&self, k: usize) -> Option<Vec3A> {
        self.positions[k]
    }
    fn direction(&self, k: usize) -> Vec3A {
        match (self.positions[k], self.positions[k + 1]) {
            (Some(x), Some(y)) => (y - x).normalize_or_zero(),
            _ => self.towards,
        }
    }
    fn is_specular(&self, k: usize) -> bool {
        self.specular[k]
    }
    fn can_connect(&self, k: usize) -> bool {
        self.connect[k]
    }
    fn can_hit(&self) -> bool {
        self.hit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::paths::{check_path, check_same_path};

    #[test]
    fn random_paths_keep_the_laws_of_paths() {
        let mut uniforms = Uniforms::named("random paths");
        for index in 0..2000 {
            let path = RandomPath::new(1 + index % 6, &mut uniforms);
            let possible: Vec<usize> = path.possible().collect();
            for &i in &possible {
                let (by_i, by_first) = (path.generated_by(i), path.generated_by(possible[0]));
                check_path("path", i, &by_i).expect_pass();
                check_same_path("path", (possible[0], &by_first), (i, &by_i), 1e-6).expect_pass();
            }
        }
    }
}
