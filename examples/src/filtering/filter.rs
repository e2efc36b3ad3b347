//! Filters that are put together at run time.

use path_space_filter::{
    AlbedoDifference, AsStored, Averages, CellKey, Demodulated, HitDistance, JitteredHash, Modulation, NormalCone,
    PathFilter, PathSpaceFilter, SameVisibility, SimilarTime, Similarity, ViewCone,
};

use super::FilterVertex;

/// The weights that are wanted, as one. Vertices have to be alike in all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Alike {
    /// Normals.
    pub normals: Option<NormalCone>,
    /// Colours.
    pub albedo: Option<AlbedoDifference>,
    /// Directions to the camera.
    pub view: Option<ViewCone>,
    /// Distances of occluders.
    pub hit_distance: Option<HitDistance>,
    /// Points in time.
    pub time: Option<SimilarTime>,
    /// Which point lights are seen.
    pub visibility: bool,
}

/// What [`Alike`] looks at.
#[derive(Clone, Copy, Debug)]
pub struct Looks {
    normal: [f32; 3],
    albedo: [f32; 3],
    view: [f32; 3],
    hit_distance: f32,
    time: f32,
    visibility: u32,
}

/// 1 without the weight.
#[inline(always)]
fn optional<S: Similarity<FilterVertex>>(similarity: Option<S>, a: &S::Features, b: &S::Features) -> f32 {
    similarity.map_or(1.0, |similarity| similarity.weight(a, b))
}

impl Similarity<FilterVertex> for Alike {
    type Features = Looks;

    fn features(&self, vertex: &FilterVertex) -> Looks {
        Looks {
            normal: vertex.normal,
            albedo: vertex.albedo,
            view: vertex.view_direction,
            hit_distance: vertex.hit_distance,
            time: vertex.time,
            visibility: vertex.visibility,
        }
    }

    #[inline]
    fn weight(&self, a: &Looks, b: &Looks) -> f32 {
        let visibility = self.visibility.then_some(SameVisibility);
        optional(self.normals, &a.normal, &b.normal)
            * optional(self.albedo, &a.albedo, &b.albedo)
            * optional(self.view, &a.view, &b.view)
            * optional(self.hit_distance, &a.hit_distance, &b.hit_distance)
            * optional(self.time, &a.time, &b.time)
            * optional(visibility, &a.visibility, &b.visibility)
    }
}

/// Colours taken out of the average, or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyModulation {
    /// Not.
    AsStored,
    /// Taken out.
    Demodulated(Demodulated),
}

impl Modulation<FilterVertex> for AnyModulation {
    #[inline]
    fn demodulate(&self, vertex: &FilterVertex) -> [f32; 3] {
        match self {
            Self::AsStored => AsStored.demodulate(vertex),
            Self::Demodulated(by) => by.demodulate(vertex),
        }
    }

    #[inline]
    fn remodulate(&self, vertex: &FilterVertex, mean: [f32; 3]) -> [f32; 3] {
        match self {
            Self::AsStored => AsStored.remodulate(vertex, mean),
            Self::Demodulated(by) => by.remodulate(vertex, mean),
        }
    }
}

/// What else the key of a cell holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AlikeKey {
    /// Colours, in steps of 1/8.
    pub albedo: bool,
    /// Which point lights are seen.
    pub visibility: bool,
}

impl CellKey<FilterVertex> for AlikeKey {
    #[inline]
    fn key(&self, vertex: &FilterVertex) -> u32 {
        let steps = |a: f32| ((a * 8.0).round() as i32 & 0xff) as u32;
        let [r, g, b] = if self.albedo { vertex.albedo.map(steps) } else { [0; 3] };
        // Different lights hardly ever share a number, and do no harm if they do.
        let visibility = if self.visibility { vertex.visibility.wrapping_mul(0x9e37_79b1) } else { 0 };
        (r | g << 8 | b << 16).wrapping_add(visibility)
    }
}

/// One of the two implementations of path space filtering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyFilter {
    /// Equation 1.
    Search(PathSpaceFilter<Alike, path_space_filter::Ball, AnyModulation>),
    /// One average per hashed cell.
    Hash(JitteredHash<AlikeKey, AnyModulation>),
}

impl PathFilter<FilterVertex> for AnyFilter {
    fn average(&self, vertices: &[FilterVertex], batch: u64) -> Averages<[f32; 3]> {
        match self {
            Self::Search(filter) => filter.average(vertices, batch),
            Self::Hash(filter) => filter.average(vertices, batch),
        }
    }

    fn average_at(&self, queries: &[FilterVertex], vertices: &[FilterVertex], batch: u64) -> Vec<Option<[f32; 3]>> {
        match self {
            Self::Search(filter) => filter.average_at(queries, vertices, batch),
            Self::Hash(filter) => filter.average_at(queries, vertices, batch),
        }
    }

    fn bytes_per_vertex(&self) -> usize {
        match self {
            Self::Search(filter) => PathFilter::<FilterVertex>::bytes_per_vertex(filter),
            Self::Hash(filter) => PathFilter::<FilterVertex>::bytes_per_vertex(filter),
        }
    }
}
