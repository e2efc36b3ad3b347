//! Bad and odd input.

use qmc_sampling::{Independent, SamplerFamily};
use scene_core::builtin::SceneBuilder;
use scene_core::glam::Vec3A;
use scene_core::material::{Material, MaterialError};
use scene_core::medium::Medium;
use scene_core::reference::Light;
use scene_core::{Ray, ReferenceScene, Rgb, Scene, Vertex};

use super::{ball, down, path};

fn milk(sigma_s: f32) -> Medium<Rgb> {
    Medium::new(Rgb::ZERO, Rgb::splat(sigma_s), 0.3).unwrap()
}

#[test]
fn only_dielectrics_hold_media() {
    let refused = |material: Material| match material.filled_with(milk(1.0)).compile().unwrap_err() {
        MaterialError::Nesting { outer: "filled", inner, .. } => inner,
        other => panic!("{other}"),
    };
    assert_eq!(refused(Material::diffuse(0.5)), "diffuse");
    let thin = Material::ThinDielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: 1.0.into(),
        specular_transmittance: 1.0.into(),
    };
    assert_eq!(refused(thin), "thindielectric");
    assert_eq!(refused(Material::glass(1.5).filled_with(milk(2.0))), "dielectric");
    let sides =
        Material::TwoSided { front: Box::new(Material::diffuse(0.5)), back: Some(Box::new(Material::diffuse(0.1))) };
    assert_eq!(refused(sides), "diffuse");
    assert!(Material::glass(1.5).filled_with(milk(1.0)).two_sided().compile().is_err());
    assert!(Material::glass(f32::NAN).filled_with(milk(1.0)).compile().unwrap_err().to_string().contains("int_ior"));
    // Wrappers around the boundary, and inside of the filling, are fine.
    let masked = Material::Mask { opacity: 0.5.into(), inner: Box::new(Material::glass(1.5).filled_with(milk(1.0))) };
    assert!(masked.compile().unwrap().interior().is_some());
    let masked = Material::Mask { opacity: 0.5.into(), inner: Box::new(Material::glass(1.5)) }.filled_with(milk(1.0));
    assert_eq!(masked.compile().unwrap().interior(), Some(&milk(1.0)));
}

#[test]
fn boundaries_know_their_sides_and_others_change_nothing() {
    let scene = ball(1.5, milk(1.0));
    assert!(scene.has_media());
    let vertex = scene.intersect(&down(1.0)).unwrap();
    assert_eq!(vertex.medium(-Vec3A::Z, None), Some(milk(1.0)));
    assert_eq!(vertex.medium(Vec3A::Z, Some(milk(1.0))), None);
    let mut b = SceneBuilder::new("grey");
    let grey = b.diffuse(0.5, 0.5, 0.5);
    b.sphere(grey, Vec3A::ZERO, 1.0);
    let plain = ReferenceScene::new(b.finish()).unwrap();
    assert!(!plain.has_media());
    let vertex = plain.intersect(&down(1.0)).unwrap();
    for current in [None, Some(milk(3.0))] {
        assert_eq!(vertex.medium(-Vec3A::Z, current), current);
    }
}

/// A medium below a plane has no end: it ends at the bounding sphere.
#[test]
fn open_surfaces_end_at_the_bounding_sphere() {
    let mut b = SceneBuilder::new("open");
    let open = b.material(Material::glass(1.0).filled_with(milk(3.0)));
    b.quad(open, Vec3A::new(-2.0, -2.0, 0.0), Vec3A::X * 4.0, Vec3A::Y * 4.0);
    b.light(Light::Constant { radiance: Rgb::ONE });
    let scene = ReferenceScene::new(b.finish()).unwrap();
    let family = Independent::new(7);
    for index in 0..200 {
        // Without absorption nothing is lost.
        let end = path(&scene, down(0.7), &mut family.sampler(0, index)).unwrap();
        assert!((end.throughput[0] - 1.0).abs() < 1e-3, "{:?}", end.throughput);
    }
}

#[test]
fn walks_end_whatever_they_are_given() {
    let scene = ball(1.5, milk(1.0));
    let family = Independent::new(9);
    let walk = |medium: &Medium<Rgb>, ray: Ray, throughput: Rgb, index| {
        medium.walk(&scene, ray, throughput, &mut family.sampler(1, index))
    };
    let inside = Ray::new(Vec3A::ZERO, Vec3A::X);
    for index in 0..50 {
        // So dense that it never gets anywhere.
        assert!(walk(&milk(1e30), inside, Rgb::ONE, index).is_none());
        // Nothing there.
        let exit = walk(&milk(0.0), inside, Rgb::ONE, index).unwrap();
        assert!(exit.vertex.is_some() && exit.throughput == Rgb::ONE && exit.scatterings == 0);
        for bad in [Rgb::splat(f32::NAN), Rgb::splat(f32::INFINITY), Rgb::ZERO] {
            let exit = walk(&milk(50.0), inside, bad, index);
            assert!(exit.is_none_or(|exit| !(exit.throughput[0] > 0.0 && exit.throughput[0].is_finite())));
        }
        for ray in [Ray::new(Vec3A::NAN, Vec3A::X), Ray::new(Vec3A::splat(1e30), Vec3A::X)] {
            let exit = walk(&milk(5.0), ray, Rgb::ONE, index).unwrap();
            assert!(exit.vertex.is_none());
        }
    }
}
