//! A furnished room.

use glam::Vec3A;

use super::SceneBuilder;
use super::finish::{lacquer, metal, tiles};
use crate::material::Material;
use crate::reference::SceneDescription;
use crate::traits::Rgb;

/// A living room in the evening, in metres: a ceiling panel, an uplight behind the sofa and a lamp on the sideboard;
/// wooden floor, lacquered table, glass and brass on it, books. Much of the light is indirect.
pub fn interior() -> SceneDescription {
    let mut b = SceneBuilder::new("interior");
    room(&mut b);
    lights(&mut b);
    furniture(&mut b);
    table_ware(&mut b);
    b.look(Vec3A::new(2.62, 1.5, -2.05), Vec3A::new(-0.55, 0.72, 0.75), 66.0, 640, 360);
    b.finish()
}

fn v(x: f32, y: f32, z: f32) -> Vec3A {
    Vec3A::new(x, y, z)
}

/// Walls, floor and ceiling: x from -3 to 3, y from 0 to 2.6, z from -2.4 to 2.2.
fn room(b: &mut SceneBuilder) {
    let wall = b.diffuse(0.74, 0.70, 0.62);
    let accent = b.diffuse(0.16, 0.30, 0.36);
    let ceiling = b.diffuse(0.82, 0.82, 0.80);
    let planks = tiles(Rgb::new(0.36, 0.20, 0.10), Rgb::new(0.27, 0.14, 0.065), 9.0, 2.0);
    let boards = b.material(lacquer(planks, 0.15));
    b.quad(boards, v(-3.0, 0.0, -2.4), v(0.0, 0.0, 4.6), v(6.0, 0.0, 0.0));
    b.quad(ceiling, v(-3.0, 2.6, -2.4), v(6.0, 0.0, 0.0), v(0.0, 0.0, 4.6));
    b.quad(accent, v(-3.0, 0.0, 2.2), v(0.0, 2.6, 0.0), v(6.0, 0.0, 0.0));
    b.quad(wall, v(-3.0, 0.0, -2.4), v(6.0, 0.0, 0.0), v(0.0, 2.6, 0.0));
    b.quad(wall, v(-3.0, 0.0, -2.4), v(0.0, 2.6, 0.0), v(0.0, 0.0, 4.6));
    b.quad(wall, v(3.0, 0.0, -2.4), v(0.0, 0.0, 4.6), v(0.0, 2.6, 0.0));
    // Skirting boards.
    let skirting = b.diffuse(0.8, 0.78, 0.74);
    b.cuboid(skirting, v(0.0, 0.04, 2.19), v(3.0, 0.04, 0.01), 0.0);
    b.cuboid(skirting, v(-2.99, 0.04, -0.1), v(0.01, 0.04, 2.3), 0.0);
}

fn lights(b: &mut SceneBuilder) {
    let dark = b.diffuse(0.02, 0.02, 0.02);
    let metal = b.material(metal("Al", 0.2));
    // A panel that hangs from the ceiling and shines down.
    b.cuboid(metal, v(-0.5, 2.53, -0.2), v(0.92, 0.02, 0.42), 0.0);
    b.quad(dark, v(-1.4, 2.505, -0.6), v(1.8, 0.0, 0.0), v(0.0, 0.0, 0.8));
    b.emit(Rgb::new(9.0, 7.7, 5.9));
    // An uplight in the corner: a stem and a bowl that hides the bulb.
    let base = v(-2.55, 0.0, 1.75);
    let bowl = b.diffuse(0.1, 0.09, 0.08);
    b.lathe(metal, base, &[[0.14, 0.0], [0.14, 0.02], [0.015, 0.03], [0.015, 1.7]], 48);
    b.lathe(bowl, base, &[[0.015, 1.7], [0.08, 1.72], [0.17, 1.78], [0.22, 1.87]], 48);
    b.sphere(dark, base + v(0.0, 1.86, 0.0), 0.12).emit(Rgb::new(44.0, 30.0, 17.0));
    // A glowing ball on the sideboard.
    b.sphere(dark, v(-2.68, 0.95, -0.6), 0.11).emit(Rgb::new(14.0, 8.2, 3.6));
}

fn furniture(b: &mut SceneBuilder) {
    let fabric = b.diffuse(0.44, 0.36, 0.28);
    let cushion = b.diffuse(0.62, 0.22, 0.10);
    let cushion_pale = b.diffuse(0.70, 0.62, 0.45);
    let rug = b.diffuse(0.50, 0.44, 0.40);
    let dark_wood = b.material(lacquer(Rgb::new(0.10, 0.05, 0.03), 0.1));
    let white = b.material(lacquer(Rgb::new(0.75, 0.75, 0.72), 0.08));
    b.cuboid(rug, v(-0.5, 0.008, 0.35), v(1.5, 0.008, 1.0), 0.0);
    // Sofa along the far wall.
    b.cuboid(fabric, v(-0.6, 0.24, 1.6), v(1.15, 0.16, 0.45), 0.0);
    b.cuboid(fabric, v(-0.6, 0.58, 2.0), v(1.15, 0.34, 0.12), 0.0);
    b.cuboid(fabric, v(-1.84, 0.36, 1.65), v(0.1, 0.28, 0.48), 0.0);
    b.cuboid(fabric, v(0.64, 0.36, 1.65), v(0.1, 0.28, 0.48), 0.0);
    for (x, angle, material) in [(-1.35, 0.3, cushion), (-0.95, -0.1, cushion_pale), (0.2, -0.35, cushion)] {
        b.cuboid(material, v(x, 0.58, 1.78), v(0.19, 0.18, 0.07), angle);
    }
    // Sideboard with doors along the left wall.
    b.cuboid(white, v(-2.72, 0.45, -0.5), v(0.26, 0.36, 0.85), 0.0);
    for z in [-1.05, -0.5, 0.05] {
        b.cuboid(white, v(-2.45, 0.45, z), v(0.012, 0.32, 0.265), 0.0);
    }
    // Table.
    b.cuboid(dark_wood, v(-0.5, 0.40, 0.35), v(0.62, 0.02, 0.36), 0.0);
    for (x, z) in [(-1.05, 0.06), (0.05, 0.06), (-1.05, 0.64), (0.05, 0.64)] {
        b.cuboid(dark_wood, v(x, 0.2, z), v(0.025, 0.19, 0.025), 0.0);
    }
    bookshelf(b, dark_wood);
    // A picture above the sofa.
    let frame = b.material(lacquer(Rgb::new(0.05, 0.05, 0.05), 0.2));
    let canvas = b.diffuse(0.72, 0.60, 0.30);
    let stroke = b.diffuse(0.10, 0.16, 0.45);
    b.cuboid(frame, v(-0.6, 1.62, 2.18), v(0.62, 0.4, 0.02), 0.0);
    b.cuboid(canvas, v(-0.6, 1.62, 2.155), v(0.57, 0.35, 0.008), 0.0);
    b.cuboid(stroke, v(-0.75, 1.56, 2.145), v(0.2, 0.2, 0.004), 0.0);
}

/// Shelves on the right part of the far wall, filled with books of varying size and colour.
fn bookshelf(b: &mut SceneBuilder, wood: crate::reference::MaterialId) {
    let covers = [[0.45, 0.08, 0.06], [0.08, 0.14, 0.32], [0.12, 0.28, 0.12], [0.62, 0.55, 0.40], [0.25, 0.22, 0.22]]
        .map(|[r, g, blue]| b.diffuse(r, g, blue));
    let (left, right, depth) = (1.15, 2.75, 0.15);
    let (middle, half_width) = (0.5 * (left + right), 0.5 * (right - left));
    for x in [left, right] {
        b.cuboid(wood, v(x, 1.0, 2.2 - depth), v(0.015, 1.0, depth), 0.0);
    }
    for level in 0..6 {
        let y = 0.05 + 0.38 * level as f32;
        b.cuboid(wood, v(middle, y, 2.2 - depth), v(half_width, 0.012, depth), 0.0);
        if level == 5 {
            break;
        }
        let (mut x, mut k) = (left + 0.03, level * 7);
        while x < right - 0.08 {
            let wiggle = |m: i32| ((k * m) % 11) as f32 / 11.0;
            let (half, height) = (0.012 + 0.014 * wiggle(3), 0.10 + 0.05 * wiggle(5));
            // Leave gaps here and there.
            if (k * 5) % 13 > 1 {
                let center = v(x + half, y + 0.012 + height, 2.2 - depth + 0.02);
                b.cuboid(covers[(k % 5) as usize], center, v(half, height, 0.09 + 0.02 * wiggle(7)), 0.0);
            }
            x += 2.0 * half + 0.003;
            k += 1;
        }
    }
}

fn table_ware(b: &mut SceneBuilder) {
    let brass = b.material(metal("Au", 0.12));
    let chrome = b.material(metal("Cr", 0.1));
    let porcelain = b.material(lacquer(Rgb::new(0.78, 0.78, 0.76), 0.05));
    let glass = b.material(Material::glass(1.5));
    b.sphere(glass, v(-0.25, 0.52, 0.30), 0.1);
    b.sphere(chrome, v(-0.82, 0.50, 0.52), 0.08);
    // A bowl and a vase.
    let bowl = [[0.05, 0.0], [0.06, 0.005], [0.13, 0.05], [0.17, 0.10], [0.165, 0.10], [0.125, 0.055], [0.004, 0.02]];
    b.lathe(brass, v(-0.62, 0.42, 0.16), &bowl, 64);
    let vase: Vec<[f32; 2]> = (0..=24)
        .map(|i| {
            let t = i as f32 / 24.0;
            [0.055 + 0.05 * (core::f32::consts::PI * (0.15 + 1.25 * t)).sin(), 0.34 * t]
        })
        .collect();
    b.lathe(porcelain, v(-2.7, 0.81, 0.1), &vase, 64);
}
