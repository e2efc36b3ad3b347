//! Vertices.

use estimator_checks::Report;
use estimator_checks::laws::scene::{VertexLaws, check_vertex};
use scene_core::builtin::{SceneBuilder, cornell_box};
use scene_core::glam::Vec3A;
use scene_core::material::{Distribution, Material, conductors};
use scene_core::{ReferenceScene, Rgb, ScatterSample, TransportMode, Vertex};

use crate::liar::{LiarScene, VertexLie as Lie, middle};
use crate::{SUITE, broken_exactly, rejects};

/// A sphere, seen a little from the side.
fn ball(material: Material) -> ReferenceScene {
    let mut b = SceneBuilder::new("ball");
    let material = b.material(material);
    b.sphere(material, Vec3A::new(0.5, -0.4, 0.2), 1.0);
    b.look(Vec3A::new(0.0, 0.0, 4.0), Vec3A::ZERO, 40.0, 8, 8);
    ReferenceScene::new(b.finish()).unwrap()
}

fn materials() -> Vec<(&'static str, Material)> {
    let (eta, k) = conductors::named("Au").unwrap();
    let (distribution, specular_reflectance) = (Distribution::Ggx, 1.0.into());
    let conductor = Material::RoughConductor { eta, k, specular_reflectance, distribution, alpha: [0.3; 2] };
    let glass = Material::RoughDielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: 1.0.into(),
        specular_transmittance: 1.0.into(),
        distribution,
        alpha: [0.4; 2],
    };
    let smooth = Material::glass(1.5);
    let plastic = Material::RoughPlastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: 0.6.into(),
        specular_reflectance: 1.0.into(),
        nonlinear: true,
        distribution: Distribution::Beckmann,
        alpha: 0.2,
    };
    let mask = Material::Mask { opacity: 0.4.into(), inner: Box::new(Material::diffuse(0.8).two_sided()) };
    vec![
        ("diffuse", Material::diffuse(Rgb::new(0.7, 0.5, 0.2))),
        ("rough conductor", conductor),
        ("rough dielectric", glass),
        ("dielectric", smooth),
        ("rough plastic", plastic),
        ("mask", mask),
    ]
}

#[test]
fn vertices_keep_their_laws() {
    for (name, material) in materials() {
        let scene = ball(material);
        let report = check_vertex(SUITE.check(&format!("vertex: {name}")), &middle(&scene)).expect_pass();
        // Smooth glass has nothing for statistics but its energy.
        assert_eq!(report.outcomes.len(), if name == "dielectric" { 4 } else { 8 }, "{report}");
    }
}

/// From inside of glass radiance is scaled up: `eta` undoes it.
#[test]
fn radiance_that_leaves_glass_is_not_light_made() {
    let (_, material) = materials().swap_remove(2);
    let scene = ball(material);
    let vertex = middle(&scene);
    let inside = vertex.reversed((vertex.wo() - 4.0 * vertex.point().normal).normalize());
    assert!(inside.wo().dot(inside.point().normal) < 0.0);
    check_vertex(SUITE.check("vertex: inside of glass"), &inside).expect_pass();
    let lobes = (0..50).filter_map(|k| inside.sample([k as f32 / 50.0, 0.3, 0.4], TransportMode::Radiance));
    let scaled = |sample: ScatterSample<Rgb>| sample.eta < 1.0 && sample.throughput[0] > 1.5;
    assert!(lobes.into_iter().any(scaled));
}

fn run(lie: Lie) -> Report {
    let mut scene = LiarScene::new(cornell_box());
    scene.vertex_lie = lie;
    let laws = VertexLaws::new().samples(20_000);
    laws.run(SUITE.twin(&format!("vertex: {lie:?}")), &middle(&scene))
}

#[test]
fn vertices_that_lie_are_rejected() {
    run(Lie::Nothing).expect_pass();
    for (lie, law) in [
        (Lie::NegativeBelow, "eval is finite and not negative"),
        (Lie::NanAlongTheNormal, "eval is finite and not negative"),
        (Lie::NegativeDensity, "pdf is finite and not negative"),
        (Lie::NoDensityAtSomeDirections, "where eval is positive, so is pdf"),
        (Lie::DeltasOnly, "eval is zero where a vertex is not connectible"),
        (Lie::EvalPdfDiffers, "eval_pdf is eval and pdf"),
        (Lie::Dice, "the same direction gives the same values"),
        (Lie::DensityOfSamples, "pdf is the density of the sample"),
        (Lie::ThroughputOfSamples, "throughput times density is eval"),
        (Lie::LongDirections, "samples have unit length"),
        (Lie::NegativeThroughput, "throughput is finite and not negative"),
        (Lie::NoEta, "eta is finite and positive"),
        (Lie::NotAdjoint, "adjoint: radiance from wi to wo is what importance sees from wo to wi"),
        (Lie::LongNormal, "normals have unit length"),
        (Lie::LongWo, "wo has unit length"),
        (Lie::BrightAlbedo, "albedo lies in [0, 1]"),
        (Lie::NegativeEmission, "emitted radiance is finite and not negative"),
        (Lie::ReversedForgets, "reversed is the same point seen from wi"),
        (Lie::OtherConstant, "lambertian is the constant that eval is made of"),
        (Lie::RaysGoBack, "a ray leaves the point in its direction"),
    ] {
        assert_eq!(broken_exactly(run(lie)), law, "{lie:?}");
    }
    rejects(run(Lie::OtherDistribution), "shape");
    rejects(run(Lie::Absorbs), "albedo");
    rejects(run(Lie::MakesLight), "energy");
}

#[test]
fn the_adjoint_law_may_be_left_out() {
    let mut scene = LiarScene::new(cornell_box());
    scene.vertex_lie = Lie::NotAdjoint;
    let laws = VertexLaws::new().samples(20_000).without_adjoint();
    let report = laws.run(SUITE.twin("vertex: not adjoint, and does not have to be"), &middle(&scene));
    assert!(report.outcomes[0].passed(), "{report}");
}
