//! A shrub of small leaves in a corner.

use core::f32::consts::{PI, TAU};

use glam::{Affine3A, Mat3A, Vec3A};

use super::SceneBuilder;
use super::finish::tiles;
use super::form::{Form, v};
use super::variety::Variety;
use crate::material::Material;
use crate::reference::{Light, SceneDescription};
use crate::traits::Rgb;

/// Twigs, and leaves on each.
const TWIGS: u32 = 90;
const LEAVES: u32 = 36;
/// Where the twigs start, and how far they reach along x, y, z.
const ROOT: Vec3A = v(-0.05, 0.30, -0.10);
const REACH: Vec3A = v(0.78, 1.02, 0.70);

/// A shrub of 3240 diffuse leaves, 4 to 9 cm long, in a pot in the corner of a white and a terracotta wall, lit by a
/// rectangular light and a weak sky, in metres.
///
/// Hardly a point of the leaves sees the whole light, and no two neighbouring leaves face the same way; the walls
/// send much of the light that they get into the shrub and back.
///
/// It stands in for the foliage of Keller, Dahm and Binder 2014, "Path Space Filtering", figure 6.
pub fn foliage() -> SceneDescription {
    let mut b = SceneBuilder::new("foliage");
    let white = b.diffuse(0.76, 0.75, 0.72);
    let terracotta = b.diffuse(0.64, 0.34, 0.22);
    let slabs = tiles(Rgb::new(0.52, 0.48, 0.42), Rgb::new(0.44, 0.40, 0.35), 4.0, 4.0);
    let slabs = b.material(Material::diffuse(slabs).two_sided());
    b.quad(slabs, v(-1.1, 0.0, -1.0), v(0.0, 0.0, 4.0), v(4.0, 0.0, 0.0));
    b.quad(white, v(-1.1, 0.0, -1.0), v(4.0, 0.0, 0.0), v(0.0, 2.6, 0.0));
    b.quad(terracotta, v(-1.1, 0.0, 3.0), v(0.0, 0.0, -4.0), v(0.0, 2.6, 0.0));
    shrub(&mut b);
    let dark = b.diffuse(0.0, 0.0, 0.0);
    b.quad(dark, v(1.5, 2.3, 0.5), v(0.0, 0.5, 0.9), v(-0.9, 0.0, 0.3)).emit(Rgb::new(62.0, 57.0, 48.0));
    b.light(Light::Constant { radiance: Rgb::new(0.16, 0.20, 0.27) });
    b.look(v(1.55, 1.45, 2.75), v(-0.08, 0.80, -0.05), 40.0, 640, 480);
    b.finish()
}

fn shrub(b: &mut SceneBuilder) {
    let clay = b.diffuse(0.36, 0.17, 0.11);
    let bark = b.diffuse(0.16, 0.11, 0.07);
    let greens = [[0.10, 0.30, 0.05], [0.17, 0.38, 0.07], [0.28, 0.40, 0.09], [0.07, 0.22, 0.07]];
    let pot =
        [[0.0, 0.0], [0.15, 0.0], [0.20, 0.26], [0.225, 0.26], [0.225, 0.30], [0.195, 0.30], [0.19, 0.27], [0.0, 0.27]];
    b.form(clay, &Form::lathe(&pot, 64).moved(Affine3A::from_translation(v(ROOT.x, 0.001, ROOT.z).into())));
    let mut variety = Variety::new(29);
    let mut leaves = greens.map(|_| Form::default());
    let mut wood = Form::default();
    for i in 0..TWIGS {
        let twig = twig(i, &mut variety);
        for _ in 0..LEAVES {
            let place = leaf_place(&twig, &mut variety);
            let size = variety.between(0.045, 0.09);
            let tint = variety.index(greens.len());
            leaves[tint] = core::mem::take(&mut leaves[tint]).and(leaf(size).moved(place));
        }
        wood = wood.and(Form::tube(&twig, [0.006, 0.0015], 5));
    }
    b.form(bark, &wood);
    for (form, [red, green, blue]) in leaves.iter().zip(greens) {
        let material = b.diffuse(red, green, blue);
        b.form(material, form);
    }
}

/// A curve from the root to the hull of the shrub: it starts upwards and bends outwards.
fn twig(i: u32, variety: &mut Variety) -> Vec<Vec3A> {
    // Even over the part of the sphere above -20 degrees.
    let height = 1.0 - 1.34 * (i as f32 + 0.5) / TWIGS as f32;
    let turn = TAU * 0.618_034 * i as f32 + variety.between(-0.2, 0.2);
    let flat = (1.0 - height * height).sqrt();
    let direction = v(flat * turn.cos(), height.max(-0.15), flat * turn.sin());
    let end = ROOT + REACH * direction * variety.between(0.72, 1.0) + v(0.0, 0.12, 0.0);
    let bend = ROOT + v(0.0, 0.35 * variety.between(0.8, 1.3), 0.0) + 0.2 * REACH * direction;
    let count = 10;
    (0..=count).map(|k| k as f32 / count as f32).map(|t| ROOT.lerp(bend, t).lerp(bend.lerp(end, t), t)).collect()
}

/// Somewhere along the outer part of a twig, pointing away from it and more up than down.
fn leaf_place(twig: &[Vec3A], variety: &mut Variety) -> Affine3A {
    let last = twig.len() - 1;
    let t = variety.between(0.25, 1.0).sqrt() * last as f32;
    let k = (t as usize).min(last - 1);
    let at = twig[k].lerp(twig[k + 1], t - k as f32);
    let along = (twig[k + 1] - twig[k]).normalize_or(Vec3A::Y);
    let random = |variety: &mut Variety| {
        let (z, (sin, cos)) = (variety.between(-1.0, 1.0), (TAU * variety.unit()).sin_cos());
        v((1.0 - z * z).sqrt() * cos, z, (1.0 - z * z).sqrt() * sin)
    };
    let z = (0.5 * along + random(variety)).normalize_or(along);
    let up = Vec3A::Y + 0.8 * random(variety);
    let x = up.cross(z).normalize_or(z.any_orthonormal_vector());
    Affine3A { matrix3: Mat3A::from_cols(x, z.cross(x), z), translation: at }
}

/// A leaf of `length` from the origin along +z, folded along its midrib and bent down towards its tip.
fn leaf(length: f32) -> Form {
    Form::patch(2, 4, |u, t| {
        let across = (2.0 * u - 1.0) * 0.27 * length * (PI * (0.03 + 0.94 * t.powf(0.8))).sin();
        v(-across, 0.35 * across.abs() - 0.25 * length * t * t, length * t)
    })
}

#[cfg(test)]
mod tests {
    use super::super::form::tests::normals_agree;
    use super::*;
    use crate::ray::Ray;
    use crate::reference::ReferenceScene;
    use crate::traits::{Scene, Vertex};

    #[test]
    fn leaves_face_upwards_and_stay_in_the_corner() {
        assert!(normals_agree(&leaf(0.06)));
        let mut variety = Variety::new(1);
        let (mut upwards, mut outside) = (0, 0);
        for i in 0..TWIGS {
            let twig = twig(i, &mut variety);
            assert!(twig.iter().all(|p| p.is_finite()));
            for _ in 0..LEAVES {
                let place = leaf_place(&twig, &mut variety);
                upwards += u32::from(place.matrix3.y_axis.y > 0.0);
                let tip = place.transform_point3a(v(0.0, 0.0, 0.09));
                outside += u32::from(tip.x < -1.09 || tip.z < -0.99 || tip.y < 0.01);
            }
        }
        assert_eq!(outside, 0);
        assert!(upwards > TWIGS * LEAVES * 9 / 10, "{upwards}");
    }

    #[test]
    fn gaps_let_light_through() {
        let scene = ReferenceScene::new(foliage()).unwrap();
        let (mut leaves, count) = (0, 4000);
        for i in 0..count {
            let x = -0.5 + 0.9 * (i as f32 * 0.618_034).fract();
            let y = 0.6 + 0.6 * (i as f32 * 0.754_878).fract();
            let hit = scene.intersect(&Ray::new(v(x, y, 2.0), -Vec3A::Z)).unwrap();
            leaves += u32::from(hit.point().position.z > -0.99);
        }
        let share = leaves as f32 / count as f32;
        assert!((0.7..0.99).contains(&share), "{share}");
    }
}
