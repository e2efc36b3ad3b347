//! What furniture is made of.

use crate::material::{Distribution, Material, conductors};
use crate::reference::MaterialId;
use crate::texture::Texture;
use crate::traits::Rgb;

use super::SceneBuilder;

/// A diffuse base under a lacquer of roughness `alpha`, on both sides.
pub(crate) fn lacquer(base: impl Into<Texture>, alpha: f32) -> Material {
    let coat = Material::RoughPlastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: base.into(),
        specular_reflectance: 1.0.into(),
        nonlinear: true,
        distribution: Distribution::Ggx,
        alpha,
    };
    coat.two_sided()
}

/// A rough metal by its name in [`conductors`], on both sides.
pub(crate) fn metal(name: &str, alpha: f32) -> Material {
    let (eta, k) = conductors::named(name).unwrap_or((Rgb::ZERO, Rgb::ONE));
    let bare = Material::RoughConductor {
        eta,
        k,
        specular_reflectance: 1.0.into(),
        distribution: Distribution::Ggx,
        alpha: [alpha; 2],
    };
    bare.two_sided()
}

/// Two colours in rectangles, `columns` x `rows` pairs of them over the unit square.
pub(crate) fn tiles(color0: Rgb, color1: Rgb, columns: f32, rows: f32) -> Texture {
    Texture::Checkerboard { color0, color1, uv_transform: [columns, 0.0, 0.0, 0.0, rows, 0.0] }
}

/// The finishes that the pieces of furniture share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Finishes {
    /// Pale wood.
    pub(crate) wood: MaterialId,
    /// White lacquer.
    pub(crate) white: MaterialId,
    /// Black plastic.
    pub(crate) black: MaterialId,
    /// The glass of a screen that is off.
    pub(crate) screen: MaterialId,
    /// The slats of blinds.
    pub(crate) slat: MaterialId,
    /// Grey plastic.
    pub(crate) grey: MaterialId,
    /// Polished, slightly rough chrome.
    pub(crate) chrome: MaterialId,
    /// Brushed aluminium.
    pub(crate) aluminium: MaterialId,
    /// The upholstery of chairs.
    pub(crate) fabric: MaterialId,
    /// Paper.
    pub(crate) paper: MaterialId,
    /// Leaves.
    pub(crate) leaf: MaterialId,
    /// Clay, and earth.
    pub(crate) clay: MaterialId,
    /// Glazed porcelain.
    pub(crate) porcelain: MaterialId,
    /// What emitters reflect: nothing.
    pub(crate) lamp: MaterialId,
    /// Covers of books and binders.
    pub(crate) covers: [MaterialId; 6],
}

impl Finishes {
    /// Adds them to a scene, with the colour of the upholstery.
    pub(crate) fn new(b: &mut SceneBuilder, fabric: Rgb) -> Self {
        let covers = [
            [0.42, 0.09, 0.07],
            [0.08, 0.15, 0.34],
            [0.13, 0.29, 0.16],
            [0.62, 0.53, 0.36],
            [0.06, 0.06, 0.07],
            [0.55, 0.56, 0.57],
        ];
        Self {
            wood: b.material(lacquer(Rgb::new(0.52, 0.34, 0.19), 0.3)),
            white: b.material(lacquer(Rgb::new(0.72, 0.71, 0.68), 0.25)),
            black: b.material(lacquer(Rgb::splat(0.03), 0.25)),
            screen: b.material(lacquer(Rgb::splat(0.008), 0.15)),
            slat: b.diffuse(0.66, 0.64, 0.58),
            grey: b.diffuse(0.32, 0.33, 0.34),
            chrome: b.material(metal("Cr", 0.2)),
            aluminium: b.material(metal("Al", 0.3)),
            fabric: b.diffuse(fabric[0], fabric[1], fabric[2]),
            paper: b.diffuse(0.78, 0.77, 0.72),
            leaf: b.diffuse(0.10, 0.25, 0.06),
            clay: b.diffuse(0.38, 0.20, 0.13),
            porcelain: b.material(lacquer(Rgb::new(0.75, 0.75, 0.73), 0.12)),
            lamp: b.diffuse(0.0, 0.0, 0.0),
            covers: covers.map(|[r, g, blue]| b.diffuse(r, g, blue)),
        }
    }
}
