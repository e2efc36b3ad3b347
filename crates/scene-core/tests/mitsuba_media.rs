//! Participating media in Mitsuba's XML.
#![cfg(feature = "mitsuba")]
#![allow(clippy::unwrap_used)]

mod mitsuba_support;

use mitsuba_support::{error, import, load};
use scene_core::material::Material;
use scene_core::medium::Medium;
use scene_core::{ReferenceScene, Rgb};

fn close(a: Rgb, b: [f32; 3]) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() < 1e-5)
}

/// Boundary and medium of the only material.
fn filled(content: &str) -> (Material, Medium<Rgb>) {
    let mut materials = load(content).materials;
    match (materials.pop(), materials.is_empty()) {
        (Some(Material::Filled { medium, boundary }), true) => (*boundary, medium),
        other => panic!("{other:?}"),
    }
}

#[test]
fn homogeneous_interiors_of_dielectrics_are_read() {
    let (boundary, medium) = filled(
        r#"<shape type="sphere"><bsdf type="dielectric"/>
        <medium type="homogeneous" name="interior">
            <rgb name="albedo" value="0.9 0.5 0"/><float name="sigma_t" value="2"/><float name="scale" value="3"/>
            <phase type="hg"><float name="g" value="-0.25"/></phase>
        </medium></shape>"#,
    );
    assert!(matches!(boundary, Material::Dielectric { .. }));
    assert!(close(medium.sigma_s(), [5.4, 3.0, 0.0]) && close(medium.sigma_a(), [0.6, 3.0, 6.0]));
    assert_eq!(medium.phase().mean_cosine(), -0.25);
}

#[test]
fn defaults_are_those_of_mitsuba() {
    let medium = |inside: &str| {
        let content = format!(
            r#"<shape type="sphere"><bsdf type="roughdielectric"/>
            <medium type="homogeneous" name="interior">{inside}</medium></shape>"#
        );
        filled(&content).1
    };
    let plain = medium("");
    assert!(close(plain.sigma_s(), [0.75; 3]) && close(plain.sigma_a(), [0.25; 3]));
    assert_eq!(plain.phase().mean_cosine(), 0.0);
    assert_eq!(medium(r#"<phase type="isotropic"/>"#).phase().mean_cosine(), 0.0);
    assert_eq!(medium(r#"<phase type="hg"/>"#).phase().mean_cosine(), 0.8);
}

#[test]
fn null_boundaries_do_not_refract() {
    let (boundary, _) =
        filled(r#"<shape type="cube"><bsdf type="null"/><medium type="homogeneous" name="interior"/></shape>"#);
    assert!(matches!(boundary, Material::Dielectric { int_ior: 1.0, ext_ior: 1.0, .. }), "{boundary:?}");
}

#[test]
fn shared_objects_are_combined() {
    let scene = load(
        r#"<bsdf type="dielectric" id="glass"/>
        <medium type="homogeneous" id="milk"/>
        <shape type="sphere"><ref id="glass"/><ref id="milk" name="interior"/></shape>
        <shape type="sphere"><ref id="glass"/><ref id="milk" name="interior"/></shape>
        <shape type="cube"><ref id="glass"/></shape>"#,
    );
    let ids: Vec<u32> = scene.instances.iter().map(|instance| instance.material.0).collect();
    assert_eq!((ids, scene.materials.len()), (vec![0, 0, 1], 2));
    assert!(ReferenceScene::new(scene).unwrap().has_media());
}

#[test]
fn other_media_are_passed_over_with_a_warning() {
    for (content, message) in [
        (
            r#"<shape type="cube"><bsdf type="plastic"/><medium type="homogeneous" name="interior"/></shape>"#,
            ":3: ignored: the interior medium `homogeneous`",
        ),
        (
            r#"<shape type="cube"><bsdf type="dielectric"/><medium type="heterogeneous" name="interior"/></shape>"#,
            ":3: ignored: the interior medium `heterogeneous`",
        ),
        (
            r#"<shape type="cube"><bsdf type="dielectric"/><medium type="homogeneous" name="exterior"/></shape>"#,
            ":3: ignored: the exterior medium `homogeneous`",
        ),
    ] {
        let scene = import(content, &[]).unwrap();
        assert!(scene.warnings.len() == 1 && scene.warnings[0].ends_with(message), "{:?}", scene.warnings);
        assert!(!ReferenceScene::new(scene).unwrap().has_media());
    }
}

#[test]
fn bad_media_are_errors_that_name_the_value() {
    let message = |inside: &str| {
        let medium = format!(r#"<medium type="homogeneous" name="interior">{inside}</medium>"#);
        error(&format!(r#"<shape type="cube"><bsdf type="dielectric"/>{medium}</shape>"#), &[])
    };
    for (inside, expected) in [
        (r#"<float name="albedo" value="1.5"/>"#, "the albedo of a medium is 1.5"),
        (r#"<float name="sigma_t" value="-2"/>"#, "sigma_t of a medium is -2"),
        (r#"<float name="scale" value="-1"/>"#, "sigma_t of a medium is -1"),
        (r#"<phase type="hg"><float name="g" value="1"/></phase>"#, "g of a phase function is 1"),
        (r#"<phase type="rayleigh"/>"#, "unknown phase plugin `rayleigh`"),
        (r#"<phase type="hg"/><phase type="hg"/>"#, "at most one phase function"),
        (r#"<volume type="constvolume" name="albedo"/>"#, "a volume stands where a texture is expected"),
    ] {
        let message = message(inside);
        assert!(message.starts_with(":3: ") && message.contains(expected), "{message}");
    }
}
