//! Which vertices are filtered.

use core::f32::consts::PI;

use scene_core::{ScatterSample, TransportMode, Vertex};

/// Why there is no such selection.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SelectionError {
    /// Not a roughness.
    #[error("a least roughness of {0}: it lies in [0, 0.5]")]
    Roughness(f32),
    /// No vertex.
    #[error("filter at least one vertex of a path")]
    Vertices,
}

/// At which vertices of an eye path the filter takes over: at the first ones that are sufficiently diffuse.
///
/// ```text
/// roughness of a direction = 1/2 sqrt(|cos| / (pi p))
/// ```
/// **Symbols.** `p`: density by solid angle with which the surface samples the direction. In the mirror direction of a microfacet distribution of width `alpha`
/// this is `alpha`, seen along the normal; on a diffuse surface it is 1/2 everywhere; see [`Sharpness`](crate::estimators::Sharpness), which asks the same of photons.
///
/// A vertex is sufficiently diffuse if the mirror direction is not sharper than the threshold. Where a path leaves such a vertex by a Dirac delta or in a direction that
/// is sharper (the coat of plastic), what it finds there is not the vertex's, and the next vertex may be selected in its place. Where a path enters a participating medium
/// the boundary is selected, however smooth: what comes out of the medium varies slowly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    min_roughness: f32,
    vertices: u32,
}

impl Selection {
    /// Vertices of at least this roughness, and so many on a path; after a sharp bounce at one of them there may be another one in its place.
    ///
    /// # Errors
    /// If the roughness does not lie in [0, 0.5], or there is no vertex.
    pub fn new(min_roughness: f32, vertices: u32) -> Result<Self, SelectionError> {
        if !(0.0..=0.5).contains(&min_roughness) {
            return Err(SelectionError::Roughness(min_roughness));
        }
        if vertices == 0 {
            return Err(SelectionError::Vertices);
        }
        Ok(Self { min_roughness, vertices })
    }

    /// How many on a path.
    pub fn vertices(&self) -> u32 {
        self.vertices
    }

    /// Whether a vertex is sufficiently diffuse.
    pub fn selects<V: Vertex>(&self, vertex: &V) -> bool {
        if !vertex.is_connectible() {
            return false;
        }
        if vertex.lambertian().is_some() {
            return true;
        }
        let (wo, normal) = (vertex.wo(), vertex.shading_normal());
        let mirrored = normal * (2.0 * normal.dot(wo)) - wo;
        let pdf = vertex.pdf_solid_angle(mirrored, TransportMode::Radiance);
        !self.is_sharp(pdf, normal.dot(wo))
    }

    /// Whether a path leaves a vertex too sharply to be averaged there.
    pub fn is_left_sharply<V: Vertex>(&self, vertex: &V, sample: &ScatterSample<V::Spectrum>) -> bool {
        let cosine = || vertex.shading_normal().dot(sample.wi);
        sample.is_specular || vertex.lambertian().is_none() && self.is_sharp(sample.pdf_solid_angle, cosine())
    }

    fn is_sharp(&self, pdf_solid_angle: f32, cosine: f32) -> bool {
        0.5 * (cosine.abs() / (PI * pdf_solid_angle)).sqrt() < self.min_roughness
    }
}

impl Default for Selection {
    /// The first vertex of at least roughness 0.05.
    fn default() -> Self {
        Self { min_roughness: 0.05, vertices: 1 }
    }
}
