//! Lamps. Each is one emitter, one-sided, that shines from inside of an opaque housing.

use core::f32::consts::PI;

use glam::{Affine3A, Quat, Vec3A};

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, at, v};
use crate::builtin::solids::superellipse;
use crate::reference::Shape;
use crate::traits::Rgb;

/// A disk of `radius` at the origin of `to` that shines to its +y.
fn glow(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, radius: f32, radiance: Rgb) {
    let turn = Affine3A::from_rotation_x(-0.5 * PI);
    b.place(Shape::Disk, f.lamp, to * turn * Affine3A::from_scale(glam::Vec3::splat(radius))).emit(radiance);
}

/// A trough of `length` that hangs from the ceiling, `drop` below it, and shines upwards. The origin is at the
/// ceiling.
pub(crate) fn pendant(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, length: f32, drop: f32, radiance: Rgb) {
    let x = 0.5 * length;
    let to_trough = to * at(0.0, -drop, 0.0, 0.0);
    let body = Form::cushion(Vec3A::ZERO, v(x, 0.022, 0.1), 0.018, 3, [1; 3]);
    let lip = |z: f32| Form::rounded_box(v(0.0, 0.028, z), v(x - 0.004, 0.03, 0.004), 0.003, 2);
    let end = |x: f32| Form::rounded_box(v(x, 0.028, 0.0), v(0.004, 0.0295, 0.095), 0.003, 2);
    b.form(f.aluminium, &Form::all([body, lip(0.092), lip(-0.092), end(x - 0.006), end(0.006 - x)]).moved(to_trough));
    let tray = Form::parallelogram(v(0.02 - x, 0.026, 0.075), v(length - 0.04, 0.0, 0.0), v(0.0, 0.0, -0.15));
    b.form(f.lamp, &tray.moved(to_trough)).emit(radiance);
    let cable = |x: f32| {
        Form::tube(&[v(x, 0.03 - drop, 0.0), v(x, 0.001, 0.0)], [0.0025; 2], 6)
            .and(Form::lathe(&[[0.004, -0.05], [0.03, -0.02], [0.035, 0.001]], 20).moved(at(x, 0.0, 0.0, 0.0)))
    };
    // The cables pass beside the emitter, at the ends.
    b.form(f.chrome, &cable(x - 0.012).and(cable(0.012 - x)).moved(to));
}

/// A lamp on a stand that shines to the ceiling from a bowl.
pub(crate) fn torchiere(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, radiance: Rgb) {
    let stand =
        [[0.0, -0.001], [0.15, -0.001], [0.15, 0.012], [0.13, 0.022], [0.02, 0.03], [0.013, 0.05], [0.013, 1.74]];
    b.form(f.chrome, &Form::lathe(&stand, 40).moved(to));
    let bowl = [
        [0.013, 1.73],
        [0.06, 1.74],
        [0.12, 1.765],
        [0.165, 1.80],
        [0.19, 1.845],
        [0.187, 1.846],
        [0.16, 1.806],
        [0.118, 1.772],
        [0.0, 1.75],
    ];
    b.form(f.aluminium, &Form::lathe(&bowl, 48).moved(to));
    glow(b, f, to * at(0.0, 1.79, 0.0, 0.0), 0.12, radiance);
}

/// A half cylinder on the wall behind it (z = 0) that shines up along the wall. The origin is its lower edge.
pub(crate) fn sconce(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, radiance: Rgb) {
    let rim = |radius: f32, height: f32| {
        move |u: f32| {
            let (sin, cos) = (PI * u).sin_cos();
            v(-radius * cos, height, radius * sin - 0.002)
        }
    };
    let (outer, inner) = (0.11, 0.106);
    let shell = Form::patch(24, 1, |u, w| rim(outer, 0.2 * (1.0 - w))(u));
    let lining = Form::patch(24, 1, |u, w| rim(inner, 0.2 * w)(u));
    let edge = Form::patch(24, 1, |u, w| rim(inner + (outer - inner) * w, 0.2)(1.0 - u));
    let bottom = Form::patch(24, 4, |u, w| rim(outer * (1.0 - w).max(1e-3), 0.0)(u));
    b.form(f.white, &Form::all([shell, lining, edge, bottom]).moved(to));
    let plate = Form::parallelogram(v(-0.085, 0.13, 0.05), v(0.17, 0.0, 0.0), v(0.0, 0.0, -0.045));
    b.form(f.lamp, &plate.moved(to)).emit(radiance);
}

/// A strip of `length` that shines up from behind a fascia.
pub(crate) fn cove(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, length: f32, radiance: Rgb) {
    let x = 0.5 * length;
    let fascia = Form::rounded_box(v(0.0, 0.03, 0.075), v(x + 0.01, 0.035, 0.006), 0.004, 2);
    b.form(f.wood, &fascia.moved(to));
    b.form(f.black, &Form::rounded_box(v(0.0, 0.005, 0.0), v(x, 0.008, 0.06), 0.002, 1).moved(to));
    let strip = Form::parallelogram(v(0.01 - x, 0.0145, 0.045), v(length - 0.02, 0.0, 0.0), v(0.0, 0.0, -0.09));
    b.form(f.lamp, &strip.moved(to)).emit(radiance);
}

/// A lamp with two arms that lights the desk in front of it.
pub(crate) fn desk_lamp(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, radiance: Rgb) {
    let base = Form::lathe(
        &[[0.0, -0.001], [0.085, -0.001], [0.085, 0.012], [0.07, 0.02], [0.012, 0.026], [0.012, 0.045], [0.0, 0.045]],
        40,
    );
    let (foot, elbow, head) = (v(0.0, 0.04, 0.0), v(0.0, 0.40, -0.13), v(0.0, 0.49, 0.2));
    let pair = |p: Vec3A, q: Vec3A| {
        Form::all([0.011, -0.011].map(|x| Form::tube(&[p + Vec3A::X * x, q + Vec3A::X * x], [0.005; 2], 10)))
    };
    let ball: Vec<_> = (0..=8).map(|i| (PI * i as f32 / 8.0).sin_cos()).map(|(s, c)| [0.019 * s, -0.019 * c]).collect();
    let joints = [foot, elbow, head].map(|p| Form::lathe(&ball, 14).moved(at(p.x, p.y, p.z, 0.0)));
    b.form(f.chrome, &Form::all([base, pair(foot, elbow), pair(elbow, head)]).and(Form::all(joints)).moved(to));
    let tilt = to * Affine3A::from_rotation_translation(Quat::from_rotation_x(-0.35), glam::vec3(0.0, 0.385, 0.25));
    let shade = [[0.0886, 0.0], [0.085, 0.02], [0.07, 0.07], [0.045, 0.105], [0.028, 0.12], [0.022, 0.15], [0.0, 0.15]];
    b.form(f.covers[0], &Form::lathe(&shade, 40).moved(tilt));
    glow(b, f, tilt * Affine3A::from_rotation_x(PI) * at(0.0, -0.06, 0.0, 0.0), 0.05, radiance);
}

/// A panel of `length` x `width` below the ceiling at y = 0 that shines down.
pub(crate) fn ceiling_panel(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, length: f32, width: f32, radiance: Rgb) {
    let (x, z) = (0.5 * length, 0.5 * width);
    let rail = |x: f32| Form::rounded_box(v(x, -0.028, 0.0), v(0.015, 0.03, z), 0.004, 1);
    let cross = |z: f32| Form::rounded_box(v(0.0, -0.028, z), v(x, 0.029, 0.015), 0.004, 1);
    let louvre = |i: u32| {
        let x = length * (i as f32 / 8.0 - 0.5);
        Form::cuboid(v(x, -0.044, 0.0), v(0.002, 0.013, z - 0.01))
    };
    let frame = Form::all([rail(x), rail(-x), cross(z - 0.012), cross(0.012 - z)]);
    b.form(f.aluminium, &frame.and(Form::all((1..8).map(louvre))).moved(to));
    let pane =
        Form::parallelogram(v(0.01 - x, -0.022, 0.01 - z), v(length - 0.02, 0.0, 0.0), v(0.0, 0.0, width - 0.02));
    b.form(f.lamp, &pane.moved(to)).emit(radiance);
}

/// A projector below the ceiling at y = 0.
pub(crate) fn projector(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let case = Form::cushion(v(0.0, -0.36, 0.0), v(0.18, 0.055, 0.15), 0.03, 4, [1; 3]);
    let pole = Form::tube(&[v(0.0, 0.001, 0.0), v(0.0, -0.32, 0.0)], [0.018; 2], 14);
    let plate = Form::plate(&superellipse(0.08, 0.08, 4.0, 40), -0.014, 0.001, 0.004, 2);
    b.form(f.white, &Form::all([case, pole, plate]).moved(to));
    let lens = Form::lathe(&[[0.045, 0.0], [0.042, 0.03], [0.034, 0.03], [0.03, 0.012], [0.0, 0.018]], 32);
    let forwards = Affine3A::from_rotation_translation(Quat::from_rotation_x(0.5 * PI), glam::vec3(0.07, -0.36, 0.14));
    b.form(f.black, &lens.moved(to * forwards));
}
