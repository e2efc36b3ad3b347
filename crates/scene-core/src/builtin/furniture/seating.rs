//! Chairs.

use core::f32::consts::FRAC_PI_2;

use glam::{Affine3A, Quat, Vec3A};

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, at, v};
use crate::builtin::solids::rounded_path;

/// A swivel chair on five castors, with arm rests.
pub(crate) fn office_chair(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let around = |i: u32| at(0.0, 0.0, 0.0, 72.0 * i as f32 + 20.0);
    let leg = Form::tube(&[v(0.0, 0.10, 0.02), v(0.0, 0.095, 0.14), v(0.0, 0.065, 0.31)], [0.026, 0.017], 12);
    let wheel = [[0.0, -0.02], [0.02, -0.02], [0.026, -0.015], [0.026, -0.006], [0.018, 0.0]];
    let wheel: Vec<_> = wheel.iter().copied().chain(wheel.iter().rev().skip(1).map(|&[r, x]| [r, -x])).collect();
    let sideways =
        Affine3A::from_rotation_translation(Quat::from_rotation_z(FRAC_PI_2), glam::vec3(0.0, 0.0255, 0.305));
    let castor = Form::lathe(&wheel, 14).moved(sideways);
    b.form(f.chrome, &Form::all((0..5).map(|i| leg.clone().moved(around(i)))).moved(to));
    let lift = Form::lathe(
        &[[0.0, 0.06], [0.036, 0.06], [0.036, 0.13], [0.026, 0.14], [0.026, 0.28], [0.015, 0.28], [0.015, 0.4]],
        24,
    );
    b.form(f.chrome, &lift.moved(to));

    let arm = |side: f32| {
        let path = rounded_path(
            &[v(side * 0.2, 0.4, -0.02), v(side * 0.29, 0.4, -0.02), v(side * 0.29, 0.66, -0.02)],
            0.05,
            6,
        );
        Form::tube(&path, [0.014; 2], 10).and(Form::rounded_box(
            v(side * 0.29, 0.665, 0.01),
            v(0.035, 0.014, 0.125),
            0.012,
            2,
        ))
    };
    let spine = rounded_path(&[v(0.0, 0.4, -0.1), v(0.0, 0.4, -0.27), v(0.0, 0.8, -0.315)], 0.08, 8);
    let mechanism = Form::rounded_box(v(0.0, 0.4, -0.02), v(0.09, 0.025, 0.13), 0.012, 2);
    let plastic = (0..5).map(|i| castor.clone().moved(around(i))).chain([mechanism, arm(1.0), arm(-1.0)]);
    b.form(f.black, &Form::all(plastic).and(Form::tube(&spine, [0.022; 2], 10)).moved(to));

    // The seat falls off in front, and is a little hollow.
    let seat = Form::cushion(v(0.0, 0.465, 0.0), v(0.245, 0.045, 0.24), 0.04, 3, [6, 1, 6])
        .warped(|p| p - Vec3A::Y * (2.0 * (p.z - 0.1).max(0.0).powi(2) + 0.012 * (1.0 - 16.0 * p.x * p.x).max(0.0)));
    let back = Form::cushion(v(0.0, 0.0, 0.0), v(0.225, 0.29, 0.028), 0.025, 3, [6, 6, 1])
        .warped(|p| p + Vec3A::Z * (0.9 * p.x * p.x + 0.035 * (7.0 * (p.y + 0.29)).sin()));
    let lean = Affine3A::from_rotation_translation(Quat::from_rotation_x(-0.12), glam::vec3(0.0, 0.84, -0.27));
    b.form(f.fabric, &seat.and(back.moved(lean)).moved(to));
}

/// A cantilever chair: a bent steel tube, an upholstered seat and back.
pub(crate) fn cantilever_chair(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let half = [
        v(0.225, 0.86, -0.265),
        v(0.225, 0.45, -0.20),
        v(0.225, 0.45, 0.22),
        v(0.225, 0.011, 0.25),
        v(0.225, 0.011, -0.24),
    ];
    let mirrored = half.iter().rev().map(|p| v(-p.x, p.y, p.z));
    let corners: Vec<_> = half.iter().copied().chain(mirrored).collect();
    b.form(f.chrome, &Form::tube(&rounded_path(&corners, 0.07, 5), [0.0115; 2], 8).moved(to));
    let seat = Form::cushion(v(0.0, 0.465, 0.0), v(0.215, 0.028, 0.215), 0.024, 2, [5, 1, 5])
        .warped(|p| p - Vec3A::Y * 0.018 * (1.0 - 20.0 * p.x * p.x).max(0.0));
    let back = Form::cushion(Vec3A::ZERO, v(0.213, 0.17, 0.02), 0.018, 2, [5, 4, 1])
        .warped(|p| p - Vec3A::Z * (0.045 - 1.0 * p.x * p.x));
    let lean = Affine3A::from_rotation_translation(Quat::from_rotation_x(-0.155), glam::vec3(0.0, 0.72, -0.24));
    b.form(f.fabric, &seat.and(back.moved(lean)).moved(to));
    let pad = |x: f32| Form::rounded_box(v(x, 0.655, -0.02), v(0.022, 0.012, 0.15), 0.01, 1);
    let post = |x: f32| Form::tube(&[v(x, 0.45, 0.1), v(x, 0.655, 0.1)], [0.009; 2], 8);
    let rest = |x: f32| Form::tube(&[v(x, 0.655, -0.16), v(x, 0.655, -0.232)], [0.009; 2], 8);
    b.form(f.black, &Form::all([0.225, -0.225].map(|x| pad(x).and(post(x)).and(rest(x)))).moved(to));
}
