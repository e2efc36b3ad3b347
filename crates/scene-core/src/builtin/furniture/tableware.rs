//! Small things on desks and floors.

use core::f32::consts::PI;

use glam::Affine3A;

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, at, v};
use crate::builtin::variety::Variety;

/// A mug with a handle.
pub(crate) fn mug(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let wall = [
        [0.0, -0.001],
        [0.034, -0.001],
        [0.038, 0.004],
        [0.04, 0.09],
        [0.0385, 0.092],
        [0.037, 0.09],
        [0.035, 0.02],
        [0.0, 0.018],
    ];
    let arc: Vec<_> = (0..=12)
        .map(|i| (PI * i as f32 / 12.0).sin_cos())
        .map(|(s, c)| v(0.036 + 0.028 * s, 0.047 + 0.027 * c, 0.0))
        .collect();
    b.form(f.porcelain, &Form::lathe(&wall, 40).and(Form::tube(&arc, [0.0055; 2], 10)).moved(to));
    b.form(f.black, &Form::disk(v(0.0, 0.07, 0.0), glam::Vec3A::Y, 0.0362, 32).moved(to));
}

/// A cup on its saucer.
pub(crate) fn cup(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let saucer =
        [[0.0, -0.001], [0.03, -0.001], [0.045, 0.005], [0.068, 0.013], [0.067, 0.0145], [0.044, 0.0075], [0.0, 0.004]];
    let wall =
        [[0.0, 0.003], [0.022, 0.003], [0.03, 0.02], [0.038, 0.052], [0.0365, 0.053], [0.028, 0.022], [0.0, 0.01]];
    let arc: Vec<_> = (0..=10)
        .map(|i| (PI * i as f32 / 10.0).sin_cos())
        .map(|(s, c)| v(0.031 + 0.02 * s, 0.033 + 0.014 * c, 0.0))
        .collect();
    let parts = [Form::lathe(&saucer, 40), Form::lathe(&wall, 40), Form::tube(&arc, [0.0035; 2], 8)];
    b.form(f.porcelain, &Form::all(parts).moved(to));
}

/// A jug for coffee, of brushed metal.
pub(crate) fn jug(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let wall = [
        [0.0, -0.001],
        [0.062, -0.001],
        [0.066, 0.006],
        [0.064, 0.1],
        [0.052, 0.165],
        [0.036, 0.2],
        [0.036, 0.225],
        [0.03, 0.235],
        [0.0, 0.24],
    ];
    b.form(f.aluminium, &Form::lathe(&wall, 48).moved(to));
    let arc: Vec<_> = (0..=14)
        .map(|i| (PI * i as f32 / 14.0).sin_cos())
        .map(|(s, c)| v(0.04 + 0.065 * s, 0.13 + 0.075 * c, 0.0))
        .collect();
    b.form(f.black, &Form::tube(&arc, [0.009; 2], 10).moved(to));
}

/// Loose sheets of paper, slightly curled, in a heap.
pub(crate) fn papers(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, count: u32, seed: u32) {
    let mut variety = Variety::new(seed);
    let sheets = (0..count).map(|i| {
        let curl = variety.between(0.002, 0.012);
        let lift = 0.001 + 0.0012 * i as f32;
        let sheet = Form::patch(6, 6, |u, w| {
            v(0.21 * (u - 0.5), lift + curl * ((2.0 * u - 1.0) * (2.0 * w - 1.0)).powi(2), 0.297 * (0.5 - w))
        });
        sheet.moved(at(variety.between(-0.01, 0.01), 0.0, variety.between(-0.01, 0.01), variety.between(-9.0, 9.0)))
    });
    b.form(f.paper, &Form::all(sheets).moved(to));
}

/// A pad with a pen on it.
pub(crate) fn notepad(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    b.form(f.paper, &Form::rounded_box(v(0.0, 0.005, 0.0), v(0.105, 0.006, 0.148), 0.001, 1).moved(to));
    let (start, end) = (v(-0.03, 0.0155, 0.07), v(0.06, 0.0155, -0.04));
    b.form(f.covers[4], &Form::tube(&[start, start.lerp(end, 0.9), end], [0.0045, 0.002], 10).moved(to));
}

/// A beaker with pens.
pub(crate) fn pens(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let wall = [
        [0.0, -0.001],
        [0.038, -0.001],
        [0.04, 0.003],
        [0.04, 0.1],
        [0.0385, 0.101],
        [0.037, 0.1],
        [0.037, 0.006],
        [0.0, 0.005],
    ];
    b.form(f.aluminium, &Form::lathe(&wall, 32).moved(to));
    for (i, &material) in f.covers.iter().enumerate() {
        let (sin, cos) = (1.1 * i as f32).sin_cos();
        let (foot, tip) = (v(0.016 * cos, 0.008, 0.016 * sin), v(0.038 * cos, 0.145 + 0.006 * i as f32, 0.038 * sin));
        b.form(material, &Form::tube(&[foot, foot.lerp(tip, 0.92), tip], [0.0042, 0.0042], 10).moved(to));
    }
}

/// A waste-paper basket with crumpled paper.
pub(crate) fn basket(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    let wall = [
        [0.0, -0.001],
        [0.115, -0.001],
        [0.12, 0.004],
        [0.145, 0.3],
        [0.149, 0.305],
        [0.145, 0.31],
        [0.14, 0.305],
        [0.116, 0.008],
        [0.0, 0.006],
    ];
    b.form(f.black, &Form::lathe(&wall, 48).moved(to));
    let ball = |x: f32, z: f32, radius: f32| {
        Form::cushion(v(x, 0.0, z), glam::Vec3A::splat(radius), 0.9 * radius, 3, [1; 3])
            .warped(|p| p * (1.0 + 0.12 * (90.0 * p.x).sin() * (80.0 * p.y + 1.0).cos() * (85.0 * p.z).sin()))
            .moved(at(0.0, 0.16 + 0.5 * radius, 0.0, 0.0))
    };
    b.form(f.paper, &Form::all([ball(0.03, 0.02, 0.045), ball(-0.05, 0.03, 0.04), ball(0.0, -0.06, 0.042)]).moved(to));
}

/// Two letter trays, one above the other, with paper.
pub(crate) fn trays(b: &mut SceneBuilder, f: &Finishes, to: Affine3A) {
    for y in [0.0, 0.07] {
        let floor = Form::rounded_box(v(0.0, y + 0.003, 0.0), v(0.125, 0.003, 0.164), 0.002, 1);
        let side = |x: f32| Form::rounded_box(v(x, y + 0.025, 0.0), v(0.003, 0.026, 0.165), 0.002, 1);
        let back = Form::rounded_box(v(0.0, y + 0.025, -0.163), v(0.124, 0.025, 0.003), 0.002, 1);
        let posts = [-0.122, 0.122].map(|x| Form::tube(&[v(x, y, 0.1), v(x, y + 0.072, 0.1)], [0.005; 2], 8));
        b.form(f.grey, &Form::all([floor, side(0.124), side(-0.124), back]).and(Form::all(posts)).moved(to));
        papers(b, f, to * at(0.0, y + 0.006, 0.0, 0.0), 5, 3 + (100.0 * y) as u32);
    }
}
