//! Agreement with Mitsuba 3.9.1, whose values are in `data/bsdf_reference.csv`.

use std::collections::BTreeMap;

use scene_core::glam::Vec3A;
use scene_core::material::{CompiledMaterial, ShadingInput};
use scene_core::texture::{ImageTexture, Interpolation, Texture, Wrap};
use scene_core::{Frame, Rgb, TransportMode};

use crate::cases;

const REFERENCE: &str = include_str!("../data/bsdf_reference.csv");

struct Row {
    words: [&'static str; 2],
    numbers: Vec<f32>,
}

impl Row {
    fn mode(&self) -> TransportMode {
        if self.words[1] == "radiance" { TransportMode::Radiance } else { TransportMode::Importance }
    }

    fn vector(&self, at: usize) -> Vec3A {
        Vec3A::from_slice(&self.numbers[at..at + 3])
    }
}

fn rows(kind: &str) -> Vec<Row> {
    let parse = |line: &'static str| {
        let mut fields = line.split(',').skip(1);
        let words = [fields.next().unwrap(), fields.next().unwrap()];
        Row { words, numbers: fields.map(|f| f.parse().unwrap()).collect() }
    };
    REFERENCE.lines().filter(|line| line.split(',').next() == Some(kind)).map(parse).collect()
}

/// Relative, with an absolute floor that no image shows.
fn differs(a: f32, b: f32, relative: f32) -> bool {
    let error = (a - b).abs();
    error.is_nan() || error > relative * b.abs() + 2e-6
}

fn any_differs(a: Rgb, b: Rgb, relative: f32) -> bool {
    (0..3).any(|c| differs(a[c], b[c], relative))
}

/// The shading frame at the hit that the values are for. Unlike ours, Mitsuba's `flip_invalid_normals` mirrors a normal that
/// turns away from `wo` at the one that it replaces, which here is z.
fn local_frame(material: &CompiledMaterial, wo: Vec3A) -> Frame {
    let input = ShadingInput {
        uv: [0.3, 0.4],
        dpdu: Vec3A::X,
        dpdv: Vec3A::Y,
        shading_normal: Vec3A::Z,
        geometric_normal: Vec3A::Z,
    };
    let normal = material.shading_frame(&input).z;
    let is_invalid = wo.z * wo.dot(normal) < 0.0;
    Frame::from_z_and_tangent(if is_invalid { normal.with_x(-normal.x).with_y(-normal.y) } else { normal }, input.dpdu)
}

#[test]
fn values_and_densities() {
    let mut materials = BTreeMap::new();
    let mut failures = Vec::new();
    let rows = rows("value");
    assert!(rows.len() > 800);
    for row in rows {
        let material = materials.entry(row.words[0]).or_insert_with(|| cases::compiled(row.words[0]));
        let [wo, wi] = [row.vector(0), row.vector(3)];
        let frame = local_frame(material, wo);
        let [local_o, local_i] = [wo, wi].map(|w| frame.to_local(w));
        let (mut value, mut pdf) = material.resolve([0.3, 0.4]).eval_pdf(local_o, local_i, row.mode());
        if wi.z * local_i.z <= 0.0 {
            // Mitsuba's bump and normal maps pass nothing across the surface that they tilt. Ours let the frame decide.
            (value, pdf) = (Rgb::ZERO, 0.0);
        }
        // Beckmann's density is exact here, that of Mitsuba has the error of its masking approximation; the choice of
        // rough plastic's lobe hangs on the small difference of the tabulated transmittance from one.
        let tolerance = match row.words[0] {
            name if name.contains("beckmann") => 5e-3,
            name if name.contains("roughplastic") => 3e-3,
            _ => 1e-3,
        };
        if any_differs(value, Rgb(row.vector(6)), 1e-3) || differs(pdf, row.numbers[9], tolerance) {
            failures.push(format!(
                "{} {wo} {wi}: {value:?} {pdf} but Mitsuba has {} {}",
                row.words[0],
                row.vector(6),
                row.numbers[9]
            ));
        }
    }
    assert!(failures.is_empty(), "{} differ:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn dirac_deltas() {
    for row in rows("delta") {
        let material = cases::compiled(row.words[0]);
        let bsdf = material.resolve([0.3, 0.4]);
        let [wo, wi, weight] = [row.vector(0), row.vector(3), row.vector(6)];
        let (probability, eta) = (row.numbers[9], row.numbers[10]);
        let reflected = wo.z * wi.z > 0.0;
        // The lobe that Mitsuba chose has this range of the first number.
        let (inside, outside) = if reflected {
            (probability - 1e-4, probability + 1e-4)
        } else {
            (1.0 - probability + 1e-4, 1.0 - probability - 1e-4)
        };
        let sample = bsdf.sample(wo, [inside.clamp(0.0, 0.999_999), 0.3, 0.6], row.mode()).unwrap();
        assert!(sample.is_specular, "{} {wo}", row.words[0]);
        assert!((sample.wi - wi).length() < 1e-5, "{} {wo}: {} {wi}", row.words[0], sample.wi);
        assert!(!any_differs(sample.throughput, Rgb(weight), 1e-3), "{} {wo}: {:?} {weight}", row.words[0], sample);
        assert!((sample.eta - eta).abs() < 1e-5, "{} {wo}", row.words[0]);
        if (0.0..1.0).contains(&outside) {
            let other = bsdf.sample(wo, [outside, 0.3, 0.6], row.mode()).unwrap();
            assert!((other.wi - wi).length() > 1e-3, "{} {wo}: probability {probability}", row.words[0]);
        }
    }
}

#[test]
fn image_lookups() {
    let Texture::Image(image) =
        cases::image(5, 5, |x, y| [cases::height(x, y), cases::height(y, x), cases::height(x, y) * 0.5])
    else {
        unreachable!()
    };
    let rows = rows("texture");
    assert_eq!(rows.len(), 60);
    for row in rows {
        let wrap = match row.words[0] {
            "repeat" => Wrap::Repeat,
            "clamp" => Wrap::Clamp,
            _ => Wrap::Mirror,
        };
        let interpolation = if row.words[1] == "nearest" { Interpolation::Nearest } else { Interpolation::Bilinear };
        let uv_transform = [1.2, 0.3, 0.1, -0.4, 0.8, 0.2];
        let texture = Texture::from(ImageTexture { wrap, interpolation, uv_transform, ..(*image).clone() });
        let uv = [row.numbers[0], row.numbers[1]];
        let value = texture.eval(uv);
        assert!((value.0 - row.vector(2)).abs().max_element() < 1e-4, "{wrap:?} {interpolation:?} {uv:?}");
        let gradient = texture.gradient(uv);
        for axis in 0..2 {
            let error = (gradient[axis] - row.numbers[5 + axis]).abs();
            assert!(error < 1e-3, "{wrap:?} {interpolation:?} {uv:?}: {gradient:?} {:?}", &row.numbers[5..]);
        }
    }
}
