//! Desks, tables and drawers.

use glam::{Affine3A, Vec3A};

use crate::builtin::SceneBuilder;
use crate::builtin::finish::Finishes;
use crate::builtin::form::{Form, at, v};
use crate::builtin::solids::{rounded_path, superellipse};

/// Height of the tops of desks and tables.
pub(crate) const DESK_HEIGHT: f32 = 0.735;

/// A handle, a bow of tube, as wide as `width`, in front of the plane z = 0.
pub(crate) fn handle(width: f32) -> Form {
    let (x, out) = (0.5 * width, 0.028);
    let corners = [v(-x, 0.0, -0.002), v(-x, 0.0, out), v(x, 0.0, out), v(x, 0.0, -0.002)];
    Form::tube(&rounded_path(&corners, 0.016, 4), [0.005; 2], 8)
}

/// A desk of `width` x `depth`, the user in front of it at +z.
pub(crate) fn desk(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, width: f32, depth: f32) {
    let (x, z) = (0.5 * width, 0.5 * depth);
    let top = Form::rounded_box(v(0.0, DESK_HEIGHT - 0.0125, 0.0), v(x, 0.0125, z), 0.006, 2);
    b.form(f.wood, &top.moved(to));
    let side = |x: f32| {
        Form::rounded_box(v(x, 0.019, 0.0), v(0.03, 0.02, z - 0.06), 0.012, 2)
            .and(Form::rounded_box(v(x, 0.36, -0.12), v(0.028, 0.35, 0.045), 0.012, 2))
            .and(Form::rounded_box(v(x, 0.692, 0.0), v(0.025, 0.02, z - 0.09), 0.008, 2))
    };
    let beam = Form::rounded_box(v(0.0, 0.66, -0.12), v(x - 0.1, 0.025, 0.02), 0.008, 2);
    b.form(f.aluminium, &Form::all([side(x - 0.1), side(0.1 - x), beam]).moved(to));
    let panel = Form::rounded_box(v(0.0, 0.46, 0.06 - z), v(x - 0.13, 0.2, 0.008), 0.004, 1);
    let hook = |x: f32| Form::cuboid(v(x, 0.68, 0.06 - z), v(0.01, 0.04, 0.004));
    b.form(f.white, &Form::all([panel, hook(0.4), hook(-0.4)]).moved(to));
}

/// A chest of drawers of `width` x `height` x 0.55 m, on castors if it is to roll under a desk.
pub(crate) fn drawers(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, width: f32, height: f32, count: u32) {
    let (x, z) = (0.5 * width, 0.275);
    let foot = 0.05;
    let body = Form::rounded_box(v(0.0, 0.5 * (height + foot), 0.0), v(x, 0.5 * (height - foot), z), 0.006, 2);
    let pitch = (height - foot - 0.02) / count as f32;
    let y = |i: u32| foot + 0.01 + pitch * (i as f32 + 0.5);
    let fronts = (0..count)
        .map(|i| Form::rounded_box(v(0.0, y(i), z + 0.006), v(x - 0.004, 0.5 * pitch - 0.003, 0.009), 0.004, 2));
    b.form(f.white, &body.and(Form::all(fronts)).moved(to));
    let handles = (0..count).map(|i| handle(0.14).moved(at(0.0, y(i) + 0.25 * pitch, z + 0.014, 0.0)));
    b.form(f.chrome, &Form::all(handles).moved(to));
    let plinth = Form::cuboid(v(0.0, 0.5 * foot, 0.0), v(x - 0.03, 0.5 * foot + 0.002, z - 0.03));
    b.form(f.black, &plinth.moved(to));
}

/// A long table with a top in the shape of a boat, on two pedestals.
pub(crate) fn conference_table(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, length: f32, width: f32) {
    let outline = superellipse(0.5 * length, 0.5 * width, 4.0, 160);
    let top = Form::plate(&outline, DESK_HEIGHT - 0.035, DESK_HEIGHT, 0.014, 4);
    b.form(f.wood, &top.moved(to));
    // An inlay for cables along the middle.
    let inlay = Form::rounded_box(v(0.0, DESK_HEIGHT, 0.0), v(0.3 * length, 0.003, 0.07), 0.002, 2);
    let slots = (0..5).map(|i| {
        Form::rounded_box(v(0.12 * length * (i as f32 - 2.0), DESK_HEIGHT + 0.003, 0.0), v(0.11, 0.004, 0.05), 0.003, 2)
    });
    b.form(f.black, &inlay.and(Form::all(slots)).moved(to));
    let pedestal = |x: f32| {
        let foot = Form::plate(&superellipse(0.42, 0.34, 3.0, 64), -0.001, 0.03, 0.01, 3);
        let column =
            Form::lathe(&[[0.13, 0.02], [0.11, 0.06], [0.10, 0.2], [0.10, 0.6], [0.13, 0.68], [0.2, 0.705]], 48);
        foot.and(column).moved(at(x, 0.0, 0.0, 0.0))
    };
    b.form(f.aluminium, &pedestal(0.28 * length).and(pedestal(-0.28 * length)).moved(to));
    let beam = Form::rounded_box(v(0.0, 0.655, 0.0), v(0.26 * length, 0.04, 0.03), 0.01, 2);
    b.form(f.black, &beam.moved(to));
}

/// A low sideboard of `width` with doors, and a top of wood.
pub(crate) fn sideboard(b: &mut SceneBuilder, f: &Finishes, to: Affine3A, width: f32, doors: u32) {
    let x = 0.5 * width;
    b.form(f.white, &Form::rounded_box(v(0.0, 0.39, 0.0), v(x, 0.33, 0.21), 0.005, 2).moved(to));
    let top = Form::rounded_box(v(0.0, 0.733, 0.0), v(x + 0.015, 0.014, 0.225), 0.006, 2);
    b.form(f.wood, &top.moved(to));
    let pitch = width / doors as f32;
    let middle = |i: u32| pitch * (i as f32 + 0.5) - x;
    let door = |i: u32| Form::rounded_box(v(middle(i), 0.39, 0.215), v(0.5 * pitch - 0.004, 0.3175, 0.011), 0.005, 2);
    b.form(f.white, &Form::all((0..doors).map(door)).moved(to));
    let knob = |i: u32| {
        let inwards = if i.is_multiple_of(2) { 0.5 * pitch - 0.05 } else { 0.05 - 0.5 * pitch };
        handle(0.12).moved(Affine3A::from_rotation_z(core::f32::consts::FRAC_PI_2)).moved(at(
            middle(i) + inwards,
            0.55,
            0.225,
            0.0,
        ))
    };
    b.form(f.chrome, &Form::all((0..doors).map(knob)).moved(to));
    let plinth = Form::cuboid(v(0.0, 0.03, 0.0), Vec3A::new(x - 0.04, 0.032, 0.17));
    b.form(f.black, &plinth.moved(to));
}
