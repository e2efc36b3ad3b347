//! A thousand lamps of very different power.

use glam::Vec3A;

use super::SceneBuilder;
use super::finish::{lacquer, metal, tiles};
use super::form::{Form, at, v};
use super::variety::Variety;
use crate::material::Material;
use crate::reference::SceneDescription;
use crate::traits::Rgb;

/// Number of balls, and of square lamps.
const LAMPS: [u32; 2] = [800, 200];
/// Half of the side of the field.
const FIELD: f32 = 14.0;
/// Least and largest power of a lamp, in W.
const POWER: [f32; 2] = [0.016, 16.0];

/// A wall, a hedge or a pillar: where it stands, half of its sides, how far it is turned (in degrees).
#[derive(Clone, Copy, Debug)]
struct Block {
    foot: Vec3A,
    half: Vec3A,
    degrees: f32,
}

impl Block {
    /// Whether a ball of radius `margin` around `p` touches it.
    fn is_near(&self, p: Vec3A, margin: f32) -> bool {
        let (sin, cos) = self.degrees.to_radians().sin_cos();
        let d = p - self.foot;
        // Back into its own coordinates; +z was turned towards +x.
        let local = v(cos * d.x - sin * d.z, d.y - self.half.y, sin * d.x + cos * d.z);
        (local.abs() - self.half).max_element() < margin
    }
}

/// A field of 28 x 28 m in the evening, in metres, with a thousand lamps among walls, hedges and pillars: 800 balls that float at
/// heights up to 4 m, and 200 squares that shine down. Their powers are spread over three decades, evenly by their logarithm,
/// in all colours.
///
/// So a tenth of the lamps give half of the light, each point sees some hundreds of lamps, and which of them matter differs from
/// place to place: a test of choosing lamps that needs no file.
pub fn lantern_field() -> SceneDescription {
    let mut b = SceneBuilder::new("lantern-field");
    let mut variety = Variety::new(29);
    let stones = tiles(Rgb::new(0.42, 0.40, 0.38), Rgb::new(0.36, 0.345, 0.33), 14.0, 14.0);
    let stones = b.material(Material::diffuse(stones).two_sided());
    b.form(stones, &Form::parallelogram(v(-FIELD, 0.0, FIELD), v(2.0 * FIELD, 0.0, 0.0), v(0.0, 0.0, -2.0 * FIELD)));
    let blocks = occluders(&mut b, &mut variety);
    let black = b.diffuse(0.0, 0.0, 0.0);
    let mut lamps = Vec::new();
    for i in 0..LAMPS[0] + LAMPS[1] {
        let power = POWER[0] * (POWER[1] / POWER[0]).powf(variety.unit());
        let size = variety.between(0.03, 0.10);
        let place = free_place(&blocks, &lamps, &mut variety);
        lamps.push(place);
        // Power is pi times radiance and area.
        let area = if i < LAMPS[0] { 4.0 * core::f32::consts::PI } else { 4.0 } * size * size;
        let radiance = color(&mut variety) * (power / (core::f32::consts::PI * area));
        if i < LAMPS[0] {
            b.sphere(black, place, size).emit(radiance);
        } else {
            let (x, z) = (v(2.0 * size, 0.0, 0.0), v(0.0, 0.0, 2.0 * size));
            b.quad(black, place - 0.5 * (x + z), x, z).emit(radiance);
        }
    }
    b.look(v(1.5, 2.1, 12.6), v(-0.6, 0.9, 0.0), 62.0, 640, 480);
    b.finish()
}

/// A colour of luminance one, from pale to saturated.
fn color(variety: &mut Variety) -> Rgb {
    let (hue, saturation) = (core::f32::consts::TAU * variety.unit(), variety.between(0.1, 0.75));
    let [r, g, b] = [0.0, 2.1, 4.2].map(|shift| 1.0 + saturation * (hue + shift).cos());
    Rgb::new(r, g, b) * (1.0 / (0.2126 * r + 0.7152 * g + 0.0722 * b))
}

/// A place for a lamp at least 0.2 m from all blocks and 0.35 m from the middle of other lamps, and not in front of the
/// camera.
fn free_place(blocks: &[Block], lamps: &[Vec3A], variety: &mut Variety) -> Vec3A {
    let draw = |variety: &mut Variety| {
        let side = FIELD - 0.5;
        let height = 0.3 + 3.7 * variety.unit() * variety.unit();
        v(variety.between(-side, side), height, variety.between(-side, side - 3.0))
    };
    // More than nine places in ten are free.
    let mut place = draw(variety);
    let is_taken = |p: Vec3A| {
        let is_near_lamp = || lamps.iter().any(|lamp| lamp.distance_squared(p) < 0.35 * 0.35);
        blocks.iter().any(|block| block.is_near(p, 0.2)) || is_near_lamp()
    };
    while is_taken(place) {
        place = draw(variety);
    }
    place
}

/// Walls and hedges in both directions, pillars, and a few polished blocks.
fn occluders(b: &mut SceneBuilder, variety: &mut Variety) -> Vec<Block> {
    let finishes = [
        (b.diffuse(0.62, 0.58, 0.52), 26, [1.6, 0.9, 0.14]),
        (b.diffuse(0.12, 0.26, 0.08), 22, [1.3, 0.5, 0.3]),
        (b.diffuse(0.70, 0.69, 0.66), 30, [0.16, 1.3, 0.16]),
        (b.material(lacquer(Rgb::new(0.35, 0.06, 0.05), 0.15)), 8, [0.45, 0.45, 0.45]),
        (b.material(metal("Al", 0.15)), 6, [0.5, 0.8, 0.06]),
    ];
    let mut blocks = Vec::new();
    for (material, count, [x, y, z]) in finishes {
        let mut form = Form::default();
        for _ in 0..count {
            let side = FIELD - 2.5;
            let (scale, degrees) = (variety.between(0.7, 1.3), variety.between(0.0, 180.0));
            let foot = v(variety.between(-side, side), -0.01, variety.between(-side, side - 3.5));
            let block = Block { foot, half: v(x, y, z) * scale, degrees };
            let to = at(foot.x, foot.y, foot.z, degrees);
            form = form.and(Form::cuboid(v(0.0, block.half.y, 0.0), block.half).moved(to));
            blocks.push(block);
        }
        b.form(material, &form);
    }
    blocks
}
