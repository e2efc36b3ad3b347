//! Plants in pots.

use core::f32::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec3A};

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, v};
use crate::builtin::variety::Variety;

/// A leaf of `length` that starts upwards at the origin and arches towards +z until it hangs, `width` wide in the middle.
fn leaf(length: f32, width: f32, arch: f32) -> Form {
    Form::patch(2, 9, |u, t| {
        // The midrib is an arc that turns by `arch`; its halves are folded upwards a little.
        let angle = 0.25 + arch * t;
        let radius = length / arch;
        let rib = v(0.0, radius * (angle.sin() - 0.25f32.sin()), radius * (0.25f32.cos() - angle.cos()));
        let across = (2.0 * u - 1.0) * 0.5 * width * (PI * (0.06 + 0.93 * t.powf(0.8))).sin();
        let normal = v(0.0, angle.sin(), -angle.cos());
        rib + Vec3A::X * across + normal * (0.35 * across.abs())
    })
}

/// A pot of `radius` with earth in it, as high as `height`.
fn pot(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, radius: f32, height: f32) {
    let r = radius;
    let profile = [
        [0.0, -0.001],
        [0.72 * r, -0.001],
        [0.76 * r, 0.01],
        [0.93 * r, 0.82 * height],
        [0.95 * r, 0.84 * height],
        [r, 0.86 * height],
        [r, 0.985 * height],
        [0.97 * r, height],
        [0.92 * r, 0.985 * height],
        [0.89 * r, 0.86 * height],
        [0.0, 0.88 * height],
    ];
    b.form(f.clay, &Form::lathe(&profile, 48).moved(to));
}

/// A plant with `count` arching leaves up to `length` long in a pot.
pub(crate) fn plant(
    b: &mut SceneBuilder,
    f: &Finishes,
    to: Affine3A,
    pot_radius: f32,
    length: f32,
    count: u32,
    seed: u32,
) {
    let height = 1.7 * pot_radius;
    pot(b, f, to, pot_radius, height);
    let mut variety = Variety::new(seed);
    let leaves = (0..count).map(|i| {
        // Inner leaves are upright, outer ones hang.
        let outer = (i as f32 + 0.5) / count as f32;
        let turn = TAU * 0.618_034 * i as f32 + variety.between(-0.3, 0.3);
        let size = length * variety.between(0.75, 1.0) * (1.0 - 0.25 * outer);
        let start = 0.35 * pot_radius * outer;
        let to_leaf = Affine3A::from_rotation_translation(
            Quat::from_rotation_y(turn) * Quat::from_rotation_x(0.55 * outer - 0.2),
            glam::vec3(start * turn.sin(), 0.86 * height, start * turn.cos()),
        );
        leaf(size, 0.13 * size.max(0.2), 0.3 + 1.5 * outer * variety.between(0.8, 1.15)).moved(to_leaf)
    });
    b.form(f.leaf, &Form::all(leaves).moved(to));
}
