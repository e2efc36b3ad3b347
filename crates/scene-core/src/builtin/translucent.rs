//! A translucent object that is lit from behind.

use std::sync::Arc;

use glam::Affine3A;

use super::SceneBuilder;
use super::blob::whole_blob;
use super::form::{Form, v};
use crate::material::{Distribution, Material};
use crate::medium::Medium;
use crate::reference::{Light, SceneDescription, Shape};
use crate::traits::Rgb;

/// The blob of [`blob`](super::blob()) of a waxy material on a round pedestal, lit by a large rectangular light
/// behind it, in metres: a rough dielectric, filled with a medium of which light crosses the fingers, and red light
/// the body.
///
/// The mean free path is 25 mm, and 50 mm until the direction is forgotten; a part of `1/e` is left after 0.43 m of
/// red, 0.21 m of green, 0.13 m of blue light. A weak sky fills the shadows. The boundary has a roughness of 0.3, so
/// that paths that leave can be connected to the light.
///
/// It stands in for the translucent statuette of Keller, Dahm and Binder 2014, "Path Space Filtering", figure 6.
pub fn translucent_blob() -> SceneDescription {
    let mut b = SceneBuilder::new("translucent-blob");
    let floor = b.diffuse(0.34, 0.33, 0.32);
    let stone = b.diffuse(0.22, 0.22, 0.23);
    let dark = b.diffuse(0.0, 0.0, 0.0);
    b.quad(floor, v(-4.0, -0.30, -4.0), v(0.0, 0.0, 8.0), v(8.0, 0.0, 0.0));
    let pedestal = [[0.0, -0.301], [0.80, -0.301], [0.80, -0.02], [0.78, 0.0], [0.0, 0.0]];
    b.form(stone, &Form::lathe(&pedestal, 96));
    let wax = b.material(wax());
    b.place(Shape::Mesh(Arc::new(whole_blob())), wax, Affine3A::IDENTITY);
    // Above the image, behind the object.
    b.quad(dark, v(-2.2, 1.55, -2.0), v(3.6, 0.0, 0.0), v(0.0, 1.7, 1.1)).emit(Rgb::new(5.0, 4.75, 4.35));
    b.light(Light::Constant { radiance: Rgb::new(0.25, 0.29, 0.35) });
    b.look(v(0.55, 1.25, 2.85), v(0.02, 0.56, 0.0), 42.0, 640, 480);
    b.finish()
}

fn wax() -> Material {
    let medium = Medium::new(Rgb::new(0.09, 0.36, 0.96), Rgb::splat(40.0), 0.5);
    let boundary = Material::RoughDielectric {
        int_ior: 1.35,
        ext_ior: 1.0,
        specular_reflectance: 1.0.into(),
        specular_transmittance: 1.0.into(),
        distribution: Distribution::Ggx,
        alpha: [0.3; 2],
    };
    boundary.filled_with(medium.expect("finite coefficients that are not negative"))
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::reference::ReferenceScene;

    #[test]
    fn the_blob_is_closed_and_holds_the_medium() {
        let mesh = whole_blob();
        let mut edges = HashMap::new();
        for &[i, j, k] in mesh.triangles() {
            for edge in [(i, j), (j, k), (k, i)] {
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        assert!(edges.iter().all(|(&(i, j), &count)| count == 1 && edges.get(&(j, i)) == Some(&1)));
        assert!(ReferenceScene::new(translucent_blob()).unwrap().has_media());
        assert!(!ReferenceScene::new(super::super::blob()).unwrap().has_media());
    }
}
