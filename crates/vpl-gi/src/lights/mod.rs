//! Virtual point lights: the vertices of light paths, laid out for the shading loop.

mod lanes;
mod trace;
mod vertex;

use glam::Vec3A;
use scene_core::{Scene, Spectrum, TransportMode, Vertex};

use crate::partition::peak;

pub use lanes::geometry_term;
pub(crate) use lanes::{LANES, Lanes};
pub(crate) use trace::{Edges, Start, add_start, light_of_start, light_of_vertex};
pub use trace::{LightTracing, photon_cloud};
pub(crate) use vertex::Towards;
pub use vertex::{LightKind, VirtualPointLight};

/// Virtual point lights, ready to light surfaces.
///
/// ```text
/// sum over lights j of  f_x(wo, w) G(x, y_j) V(x, y_j) I_j(-w),    E over light paths: the radiance that x reflects
/// ```
/// with `I_j` the radiance that leaves `y_j` over its density, and over the number `M` of light paths. Kollig and Keller's equation 1 has
/// neither the `1/M` nor the BSDF at `y_j`; both are in `I_j` here. Emission points are lights too, or direct light would be lost.
///
/// Positions and normals are kept as structure of arrays for the loop over geometry terms; what lights need beyond lies beside.
/// 24 bytes are read of every light, and 16 more (with RGB) of those that contribute, if they are diffuse.
#[derive(Clone, Debug)]
pub struct VirtualPointLights<V: Vertex> {
    lanes: Vec<Lanes>,
    /// `I` of diffuse lights; zero for others.
    intensities: Vec<V::Spectrum>,
    /// Whether a light's intensity is `I cos`.
    is_lambertian: Vec<bool>,
    lights: Vec<VirtualPointLight<V>>,
    /// Positions of those without a geometry term: Dirac emitters, and lights at infinity.
    remote: Vec<u32>,
    paths: u32,
    all_lambertian: bool,
    any_last_chance: bool,
    longest: u32,
}

impl<V: Vertex> VirtualPointLights<V> {
    /// No lights yet, from `paths` light paths: [`push`](Self::push) expects scales that are divided by this number.
    pub fn new(paths: u32) -> Self {
        Self {
            lanes: Vec::new(),
            intensities: Vec::new(),
            is_lambertian: Vec::new(),
            lights: Vec::new(),
            remote: Vec::new(),
            paths,
            all_lambertian: true,
            any_last_chance: false,
            longest: 0,
        }
    }

    /// Forgets all lights and keeps their memory.
    pub fn clear(&mut self, paths: u32) {
        self.lanes.clear();
        self.intensities.clear();
        self.is_lambertian.clear();
        self.lights.clear();
        self.remote.clear();
        (self.paths, self.all_lambertian, self.any_last_chance, self.longest) = (paths, true, false, 0);
    }

    /// Adds a light. Those that connections cannot reach (specular vertices) are kept, and never connected to.
    pub fn push<S: Scene<Spectrum = V::Spectrum>>(&mut self, scene: &S, light: VirtualPointLight<V>) {
        let index = self.lights.len();
        if index.is_multiple_of(LANES) {
            self.lanes.push(Lanes::EMPTY);
        }
        let lambertian = light.lambertian(scene);
        match light.point() {
            Some(point) if light.is_connectible() && !light.scale.is_black() => {
                // Diffuse lights shine to the side of this normal, others look for themselves.
                let normal = lambertian.map_or(point.normal, |(_, facing)| facing);
                self.lanes[index / LANES].set(index % LANES, point.position, normal);
                self.all_lambertian &= lambertian.is_some();
            }
            Some(_) => {}
            None => self.remote.push(index as u32),
        }
        self.any_last_chance |= light.is_last_chance;
        self.longest = self.longest.max(light.length);
        self.is_lambertian.push(lambertian.is_some());
        self.intensities.push(lambertian.map_or(V::Spectrum::ZERO, |(intensity, _)| intensity));
        self.lights.push(light);
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Number of light paths that they come from, `M`.
    pub fn paths(&self) -> u32 {
        self.paths
    }

    /// All of them. The vertices of one light path are neighbours, in its order.
    pub fn as_slice(&self) -> &[VirtualPointLight<V>] {
        &self.lights
    }

    /// Segments of the longest light path.
    pub(crate) fn longest(&self) -> u32 {
        self.longest
    }

    /// Whether all that have a geometry term are diffuse.
    #[inline]
    pub(crate) fn all_lambertian(&self) -> bool {
        self.all_lambertian
    }

    /// Whether connections must take all of any light's edge.
    #[inline]
    pub(crate) fn any_last_chance(&self) -> bool {
        self.any_last_chance
    }

    #[inline]
    pub(crate) fn lanes(&self) -> &[Lanes] {
        &self.lanes
    }

    /// The intensity of a light that is not remote, towards `-wi`.
    #[inline]
    pub(crate) fn intensity<S: Scene<Spectrum = V::Spectrum>>(
        &self,
        scene: &S,
        index: usize,
        wi: Vec3A,
    ) -> V::Spectrum {
        let light = &self.lights[index];
        if !self.is_lambertian[index] {
            return light.intensity(scene, wi);
        }
        let normal = match &light.kind {
            LightKind::Surface(vertex) => facing_normal(vertex),
            _ => light.point().map_or(Vec3A::ZERO, |point| point.normal),
        };
        self.intensities[index] * (-normal.dot(wi)).max(0.0)
    }

    /// How much a light that is no emitter peaks towards `-wi`: 1 for diffuse ones.
    #[inline]
    pub(crate) fn peak(&self, index: usize, wi: Vec3A) -> f32 {
        match &self.lights[index].kind {
            LightKind::Surface(vertex) if !self.is_lambertian[index] => {
                peak(vertex.pdf_solid_angle(-wi, TransportMode::Importance), vertex.shading_normal().dot(wi))
            }
            _ => 1.0,
        }
    }

    /// `I` of each light, zero for those that are not diffuse: as many as there are lights.
    #[inline]
    pub(crate) fn intensities(&self) -> &[V::Spectrum] {
        &self.intensities
    }

    #[inline]
    pub(crate) fn remote(&self) -> &[u32] {
        &self.remote
    }

    /// Bytes that they occupy, without what they point to.
    pub fn bytes(&self) -> usize {
        self.lanes.capacity() * size_of::<Lanes>()
            + self.intensities.capacity() * size_of::<V::Spectrum>()
            + self.is_lambertian.capacity()
            + self.lights.capacity() * size_of::<VirtualPointLight<V>>()
            + self.remote.capacity() * size_of::<u32>()
    }
}

impl<V: Vertex> Default for VirtualPointLights<V> {
    fn default() -> Self {
        Self::new(0)
    }
}

/// The normal of a vertex on the side that it is seen from.
#[inline]
pub(crate) fn facing_normal<V: Vertex>(vertex: &V) -> Vec3A {
    let normal = vertex.point().normal;
    normal * 1f32.copysign(normal.dot(vertex.wo()))
}
