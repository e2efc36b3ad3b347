//! Smooth noise for rugged shapes.

use glam::Vec3A;

/// Gradients: the middles of a cube's edges.
const GRADIENTS: [[f32; 3]; 12] = [
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [-1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, -1.0, 1.0],
    [0.0, 1.0, -1.0],
    [0.0, -1.0, -1.0],
];

/// Gradient noise (Perlin 2002, "Improving Noise"), between about -1 and 1 and twice differentiable, with lattice points
/// hashed by the finaliser of MurmurHash3 (Appleby 2008) in place of his table. The same on every machine.
pub(crate) fn noise(p: Vec3A, seed: u32) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let [x, y, z] = cell.to_array().map(|c| c as i32 as u32);
    let corner = |i: u32| {
        let bits = [i & 1, i >> 1 & 1, i >> 2];
        let hash = hash([x, y, z], bits, seed);
        let offset = f - Vec3A::from(bits.map(|bit| bit as f32));
        Vec3A::from(GRADIENTS[(hash % 12) as usize]).dot(offset)
    };
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |i: u32| lerp(corner(i), corner(i + 1), fade.x);
    lerp(lerp(row(0), row(2), fade.y), lerp(row(4), row(6), fade.y), fade.z)
}

fn hash(cell: [u32; 3], bits: [u32; 3], seed: u32) -> u32 {
    let mut h = seed.wrapping_mul(0x85eb_ca6b);
    for k in 0..3 {
        h = (h ^ cell[k].wrapping_add(bits[k])).wrapping_mul(0x9e37_79b1);
        h = (h ^ h >> 16).wrapping_mul(0xc2b2_ae35);
        h ^= h >> 13;
    }
    h
}

/// Sum of `octaves` of noise, each of twice the frequency and half the height of the one before; between about -1 and 1.
pub(crate) fn fractal_noise(p: Vec3A, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut scale) = (0.0, 1.0);
    for octave in 0..octaves {
        sum += 0.5 * scale * noise(p / scale, seed.wrapping_add(octave));
        scale *= 0.5;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_bounded_and_zero_on_average() {
        let (mut sum, mut squares, mut largest) = (0.0, 0.0, 0.0f32);
        let count = 20_000;
        for i in 0..count {
            let p = Vec3A::new(0.731 * i as f32, 0.417 * i as f32, -0.193 * i as f32);
            let value = noise(p % 100.0, 3);
            // Its gradient is at most of the order of 2 to 3.
            assert!((noise(p % 100.0 + Vec3A::splat(1e-3), 3) - value).abs() < 1e-2);
            (sum, squares) = (sum + value, squares + value * value);
            largest = largest.max(value.abs());
        }
        assert!((sum / count as f32).abs() < 0.02 && (0.2..0.35).contains(&(squares / count as f32).sqrt()));
        assert!((0.7..1.1).contains(&largest), "{largest}");
        // At lattice points it vanishes, from either side.
        assert_eq!(noise(Vec3A::new(-3.0, 2.0, 7.0), 1), 0.0);
        assert!(noise(Vec3A::new(-3.0, 2.0, 7.0) - 1e-4, 1).abs() < 1e-3);
        assert_ne!(noise(Vec3A::splat(0.5), 1), noise(Vec3A::splat(0.5), 2));
        assert!(fractal_noise(Vec3A::splat(0.3), 5, 1).abs() < 1.0);
    }
}
