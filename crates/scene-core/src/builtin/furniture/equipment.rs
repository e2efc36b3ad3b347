//! What stands on desks and needs electricity.

use core::f32::consts::FRAC_PI_2;

use glam::{Affine3A, Quat, Vec3A};

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, v};
use crate::builtin::solids::{rounded_path, superellipse};

/// A flat screen, switched off.
pub(crate) fn monitor(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let case = Form::rounded_box(v(0.0, 0.34, 0.0), v(0.30, 0.18, 0.014), 0.01, 2);
    let bulge = Form::cushion(v(0.0, 0.33, -0.025), v(0.16, 0.11, 0.03), 0.028, 3, [1; 3]);
    let neck = rounded_path(&[v(0.0, 0.30, -0.045), v(0.0, 0.16, -0.055), v(0.0, 0.008, -0.05)], 0.08, 6);
    let foot = Form::plate(&superellipse(0.13, 0.09, 3.0, 48), -0.001, 0.012, 0.005, 3);
    b.form(f.black, &Form::all([case, bulge, Form::tube(&neck, [0.02, 0.024], 14)]).moved(to));
    b.form(f.aluminium, &foot.moved(to));
    let screen = Form::rounded_box(v(0.0, 0.343, 0.0135), v(0.288, 0.164, 0.0015), 0.001, 1);
    b.form(f.screen, &screen.moved(to));
}

/// A keyboard with its keys.
pub(crate) fn keyboard(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let tilt = Affine3A::from_rotation_x(0.06);
    let case = Form::rounded_box(v(0.0, 0.011, 0.0), v(0.22, 0.009, 0.07), 0.006, 2);
    b.form(f.black, &case.moved(to * tilt));
    // Rows of keys, (number, width of the first and last one relative to the others).
    let rows = [(14, 1.0, 2.0), (14, 1.5, 1.5), (13, 1.8, 2.2), (12, 2.3, 2.7), (8, 1.5, 1.5)];
    let (pitch, inner) = (0.0255, 0.425f32);
    let mut keys = Form::default();
    for (row, &(count, first, last)) in rows.iter().enumerate() {
        let z = pitch * (row as f32 - 2.0);
        let widths: Vec<f32> = (0..count)
            .map(|i| match i {
                0 => first,
                i if i + 1 == count => last,
                3 if row == 4 => 6.5,
                _ => 1.0,
            })
            .collect();
        let unit = inner / widths.iter().sum::<f32>();
        let mut x = -0.5 * inner;
        for width in widths {
            let half = 0.5 * unit * width;
            let c = v(x + half, 0.0225, z);
            // Keys taper towards the top.
            let key = Form::cuboid(c, v(half - 0.0012, 0.0045, 0.5 * pitch - 0.0012))
                .warped(|p| p - (p - c) * v(0.0016 / half, 0.0, 0.12) * ((p.y - c.y) / 0.009 + 0.5));
            keys = keys.and(key);
            x += 2.0 * half;
        }
    }
    b.form(f.grey, &keys.moved(to * tilt));
}

/// A mouse on its mat.
pub(crate) fn mouse(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let mat = Form::plate(&superellipse(0.11, 0.09, 8.0, 64), -0.0005, 0.003, 0.0015, 2);
    b.form(f.covers[1], &mat.moved(to));
    let body = Form::cushion(v(0.0, 0.02, 0.0), v(0.03, 0.018, 0.055), 0.017, 4, [2, 1, 4])
        .warped(|p| v(p.x * (1.0 - 2.5 * p.z.abs()), p.y * (1.0 - 60.0 * p.z * p.z), p.z));
    let wheel = Form::lathe(&[[0.0, -0.003], [0.01, -0.003], [0.01, 0.003], [0.0, 0.003]], 20)
        .moved(Affine3A::from_rotation_translation(Quat::from_rotation_z(FRAC_PI_2), glam::vec3(0.0, 0.031, -0.03)));
    b.form(f.black, &body.and(wheel).moved(to));
}

/// A telephone with its receiver.
pub(crate) fn telephone(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let slope = |p: Vec3A| p + Vec3A::Y * (0.3 * (0.1 - p.z) * (p.y / 0.03).clamp(0.0, 1.0));
    let body = Form::cushion(v(0.0, 0.015, 0.0), v(0.095, 0.016, 0.1), 0.01, 2, [1, 1, 3]).warped(slope);
    let button = |i: u32| {
        let (x, z) = (0.005 + 0.026 * (i % 3) as f32, 0.024 * (i / 3) as f32 - 0.03);
        Form::cuboid(v(x, 0.031, z), v(0.009, 0.005, 0.007)).warped(slope)
    };
    let grip = rounded_path(
        &[v(-0.06, 0.075, -0.085), v(-0.06, 0.1, -0.04), v(-0.06, 0.09, 0.04), v(-0.06, 0.05, 0.085)],
        0.05,
        5,
    );
    let ends = [v(-0.06, 0.078, -0.07), v(-0.06, 0.056, 0.07)];
    let cups = ends.map(|p| Form::cushion(p, v(0.027, 0.018, 0.027), 0.017, 3, [1; 3]));
    let receiver = Form::tube(&grip, [0.015; 2], 10).and(Form::all(cups));
    b.form(f.black, &body.and(receiver).moved(to));
    b.form(f.grey, &Form::all((0..12).map(button)).moved(to));
}

/// A computer below a desk.
pub(crate) fn computer(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let case = Form::rounded_box(v(0.0, 0.209, 0.0), v(0.09, 0.21, 0.2), 0.008, 2);
    let front = Form::rounded_box(v(0.0, 0.209, 0.205), v(0.085, 0.2, 0.012), 0.006, 2);
    let fins =
        (0..12).map(|i| Form::rounded_box(v(0.0, 0.06 + 0.016 * i as f32, 0.217), v(0.07, 0.004, 0.004), 0.002, 1));
    b.form(f.black, &Form::all([case, front]).and(Form::all(fins)).moved(to));
}

/// A telephone for conferences: a body with three feet.
pub(crate) fn conference_phone(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let body =
        Form::lathe(&[[0.05, -0.001], [0.1, 0.01], [0.11, 0.022], [0.08, 0.045], [0.04, 0.055], [0.0, 0.056]], 48)
            .warped(|p| {
                let angle = p.z.atan2(p.x);
                let stretch = 1.0 + 0.35 * (1.5 * angle).cos().powi(2) * (p.x.hypot(p.z) / 0.1).min(1.2);
                v(p.x * stretch, p.y, p.z * stretch)
            });
    b.form(f.black, &body.moved(to));
}
