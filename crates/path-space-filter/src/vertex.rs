//! Vertices of paths, as the filter sees them.

use crate::Contribution;

/// A vertex of a light transport path that was selected for filtering: where it is, and the contribution of the path segment towards it.
///
/// That is all that equation 1 needs; similarity weights ask for more ([`HasNormal`], [`HasAlbedo`], ..), each for what it looks at. Implement these
/// for the vertices of your renderer, or use [`Vertex`].
///
/// A path may have several such vertices: each is one of the batch, with the part of the contribution that arrives there and not at a later one.
/// They may come from several cameras, frames or points in time.
///
/// Dyn compatible: `&dyn PathVertex<Contribution = C>`.
pub trait PathVertex {
    /// What is averaged.
    type Contribution: Contribution;

    /// Where the vertex is. If a coordinate is not finite, the vertex averages nothing and keeps its contribution.
    fn position(&self) -> [f32; 3];

    /// What arrives at the vertex from the lights, by all techniques but photon mapping: density estimates are averages already
    /// (section 2.3 of the paper). It keeps to itself, and nobody averages it, if it is not finite.
    fn contribution(&self) -> Self::Contribution;

    /// Length of the path from the camera to the vertex, for radii that grow with it. 1 if there are none such.
    fn path_length(&self) -> f32 {
        1.0
    }
}

// Its docs say so.
const _: Option<&dyn PathVertex<Contribution = f32>> = None;

/// Vertices with a unit normal.
pub trait HasNormal {
    /// The normal, of length one.
    fn normal(&self) -> [f32; 3];
}

/// Vertices with a colour.
pub trait HasAlbedo {
    /// Albedo, or the local throughput `f cos / p` of the scattering sample, which is the albedo on diffuse surfaces with cosine-distributed samples.
    fn albedo(&self) -> [f32; 3];
}

/// Vertices that know from where they are seen.
pub trait HasViewDirection {
    /// Unit direction to where the camera path came from.
    fn view_direction(&self) -> [f32; 3];
}

/// Vertices that know which point lights they see.
pub trait HasVisibility {
    /// One bit for each of up to 32 point lights: whether the shadow ray was free.
    fn visibility(&self) -> u32;
}

/// Vertices that shot a ray into the hemisphere.
pub trait HasHitDistance {
    /// How far it went; infinity if it left the scene.
    fn hit_distance(&self) -> f32;
}

/// Vertices in time.
pub trait HasTime {
    /// The point in time.
    fn time(&self) -> f32;
}

/// Vertices on objects.
pub trait HasObject {
    /// Number of the object.
    fn object(&self) -> u32;
}

/// Vertices seen through a pixel.
pub trait HasPixel {
    /// Column and row.
    fn pixel(&self) -> [u32; 2];
}

/// A vertex with everything that a weight of this crate may look at. What a renderer does not have stays at its default.
///
/// The image is formed of `attenuation * average + unfiltered`, which stay with the caller:
/// [`PathSample`](crate::PathSample) keeps all three together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Vertex<C> {
    /// Where it is.
    pub position: [f32; 3],
    /// Unit normal.
    pub normal: [f32; 3],
    /// Albedo or local throughput.
    pub albedo: [f32; 3],
    /// Unit direction to the camera's side.
    pub view_direction: [f32; 3],
    /// Column and row of the pixel.
    pub pixel: [u32; 2],
    /// Length of the camera path.
    pub path_length: f32,
    /// Length of a ray into the hemisphere.
    pub hit_distance: f32,
    /// Point in time.
    pub time: f32,
    /// Number of the object.
    pub object: u32,
    /// One bit for each point light.
    pub visibility: u32,
    /// What arrives from the lights.
    pub contribution: C,
}

impl<C: Contribution> PathVertex for Vertex<C> {
    type Contribution = C;

    #[inline]
    fn position(&self) -> [f32; 3] {
        self.position
    }

    #[inline]
    fn contribution(&self) -> C {
        self.contribution
    }

    #[inline]
    fn path_length(&self) -> f32 {
        self.path_length
    }
}

macro_rules! features {
    ($($feature:ident, $field:ident: $type:ty;)*) => {
        $(impl<C> $feature for Vertex<C> {
            #[inline]
            fn $field(&self) -> $type {
                self.$field
            }
        })*
    };
}

features! {
    HasNormal, normal: [f32; 3];
    HasAlbedo, albedo: [f32; 3];
    HasViewDirection, view_direction: [f32; 3];
    HasVisibility, visibility: u32;
    HasHitDistance, hit_distance: f32;
    HasTime, time: f32;
    HasObject, object: u32;
    HasPixel, pixel: [u32; 2];
}
