//! Windows at night, behind blinds.

use core::f32::consts::PI;

use glam::Affine3A;

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, v};

/// A window with two casements in a niche (0.2 m deep, from `-half[0]` to `half[0]`, `0` to `2 half[1]`) behind the
/// wall z = 0, with its sill.
pub(crate) fn window(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, half: [f32; 2]) {
    let ([x, y], z) = (half, -0.16);
    let post = |x: f32, width: f32| Form::rounded_box(v(x, y, z), v(width, y + 0.001, 0.03), 0.006, 2);
    let rail = |y: f32| Form::rounded_box(v(0.0, y, z - 0.002), v(x + 0.001, 0.031, 0.029), 0.006, 2);
    let frame = [post(0.03 - x, 0.031), post(x - 0.03, 0.031), post(0.0, 0.04), rail(0.03), rail(2.0 * y - 0.03)];
    b.form(f.white, &Form::all(frame).moved(to));
    let pane = |middle: f32| Form::cuboid(v(middle, y, z), v(0.5 * x - 0.02, y - 0.02, 0.004));
    b.form(f.screen, &pane(0.5 * x).and(pane(-0.5 * x)).moved(to));
    let sill = Form::rounded_box(v(0.0, 0.004, -0.04), v(x + 0.06, 0.016, 0.1), 0.008, 3);
    b.form(f.white, &sill.moved(to));
    let catch = Form::rounded_box(v(0.0, y, z + 0.032), v(0.012, 0.03, 0.008), 0.004, 2).and(Form::tube(
        &[v(0.0, y, z + 0.036), v(0.0, y, z + 0.055), v(0.0, y - 0.09, z + 0.058)],
        [0.007; 2],
        10,
    ));
    b.form(f.chrome, &catch.moved(to));
}

/// A blind of curved slats, half open, let down by `drop` from the top (y = 0) over a width of `2 x`.
pub(crate) fn blind(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, x: f32, drop: f32, tilt: f32) {
    let head = Form::rounded_box(v(0.0, -0.022, 0.0), v(x, 0.02, 0.026), 0.006, 2);
    let foot = Form::rounded_box(v(0.0, -drop, 0.0), v(x - 0.002, 0.008, 0.024), 0.006, 2);
    b.form(f.aluminium, &head.and(foot).moved(to));
    let count = ((drop - 0.07) / 0.032) as u32;
    let slat = |i: u32| {
        let y = -0.065 - 0.032 * i as f32;
        // An arc of 70 degrees, turned by `tilt`.
        Form::patch(1, 6, |u, w| {
            let (sin, cos) = ((w - 0.5) * 70.0 * PI / 180.0).sin_cos();
            let (depth, rise) = (-0.03 * sin, 0.03 * (cos - 0.9));
            let (st, ct) = tilt.sin_cos();
            v((2.0 * u - 1.0) * (x - 0.004), y + ct * rise + st * depth, ct * depth - st * rise)
        })
    };
    b.form(f.slat, &Form::all((0..count).map(slat)).moved(to));
    let cords = [-0.8, 0.0, 0.8].map(|s| Form::tube(&[v(s * x, -0.03, 0.024), v(s * x, -drop, 0.024)], [0.0012; 2], 5));
    b.form(f.paper, &Form::all(cords).moved(to));
}
