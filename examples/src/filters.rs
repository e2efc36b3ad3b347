//! Settings of path space filtering.

use clap::{Args, ValueEnum};
use path_space_filter::{
    AlbedoDifference, Demodulated, HitDistance, JitteredHash, NormalCone, PathSpaceFilter, Radius, RadiusError, Search,
    SimilarTime, SimilarityError, ViewCone,
};
use scene_core::Sensor;

use crate::filtering::{Alike, AlikeKey, AnyFilter, AnyModulation, Selection, SelectionError, samples_in_memory};
use crate::values::{not_negative, real, real_where, whole};

/// The implementations of path space filtering.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PathFilterName {
    /// Path space filtering by range search.
    Psf,
    /// Path space filtering by jittered spatial hashing.
    PsfHash,
}

/// How neighbours are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SearchName {
    /// Hash grids.
    #[default]
    Grid,
    /// A k-d tree.
    KdTree,
    /// A bounding volume hierarchy.
    Hierarchy,
    /// Divide and conquer, all queries at once.
    DivideAndConquer,
}

/// Why a filter cannot be put together.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The radius.
    #[error("--filter-radius, --filter-exponent: {0}")]
    Radius(#[from] RadiusError),
    /// A weight.
    #[error("weights of the path space filter: {0}")]
    Similarity(#[from] SimilarityError),
    /// The vertices.
    #[error("vertices of the path space filter: {0}")]
    Selection(#[from] SelectionError),
    /// An estimator that tells nobody what it finds.
    #[error(
        "--filter psf and psf-hash work with path, direct, ao, robust-igi (without --caustics), instant-radiosity and photon-map"
    )]
    Estimator,
    /// A setting that this filter does not know.
    #[error("{0}")]
    Setting(&'static str),
    /// An image that cannot be continued from there.
    #[error("a rendering cannot begin after {first} samples per pixel, which is no multiple of --filter-batch {batch}")]
    Continue {
        /// Samples so far.
        first: u64,
        /// Samples of a batch.
        batch: u64,
    },
}

/// Settings of path space filtering: `--filter psf` and `--filter psf-hash`.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Path space filter")]
pub struct FilterSettings {
    /// Side of the square of pixels that is as large as the disk which is averaged over, in the first batch.
    #[arg(long, value_name = "PIXELS", default_value_t = 3.0, value_parser = not_negative(3.0))]
    pub filter_radius: f32,
    /// Radius of that disk in units of the scene, everywhere the same, in place of pixels.
    #[arg(long, value_name = "LENGTH", conflicts_with = "filter_radius", value_parser = not_negative(0.1))]
    pub filter_length: Option<f32>,
    /// How fast the radius shrinks: with this power of the number of the batch.
    #[arg(long, value_name = "ALPHA", default_value_t = 0.25, value_parser = real_where::<f32>("a number between 0 and 1", 0.25, |alpha| *alpha > 0.0 && *alpha < 1.0))]
    pub filter_exponent: f32,
    /// How often averages are averaged.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = whole::<u32>(0..=1 << 10, 2))]
    pub filter_iterations: u32,
    /// Samples per pixel that are averaged together [default: as many as the memory holds, up to 16].
    #[arg(long, value_name = "SPP", value_parser = whole::<u64>(1..=4096, 16))]
    pub filter_batch: Option<u64>,
    /// Memory for a batch, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 1024, value_parser = whole::<u64>(0..=1 << 32, 1024))]
    pub filter_memory: u64,
    /// Least cosine between normals that are alike; -1 is any. With psf-hash any value above -1 rounds the components of normals to halves.
    #[arg(long, value_name = "COSINE", default_value_t = 0.95, allow_negative_numbers = true, value_parser = cosine())]
    pub filter_normals: f32,
    /// Largest distance between albedos in RGB that are alike, 0 to 1.7 [default: any, since colours are taken out of the average].
    #[arg(long, value_name = "DIFFERENCE", value_parser = not_negative(0.1))]
    pub filter_albedo: Option<f32>,
    /// Average contributions as they are, colours included.
    #[arg(long)]
    pub filter_as_stored: bool,
    /// Least cosine between directions to the camera that are alike [default: any].
    #[arg(long, value_name = "COSINE", allow_negative_numbers = true, value_parser = cosine())]
    pub filter_view: Option<f32>,
    /// Largest difference between the lengths of rays into the hemisphere that are alike, in units of the scene [default: any].
    #[arg(long, value_name = "LENGTH", value_parser = not_negative(0.1))]
    pub filter_hit_distance: Option<f32>,
    /// Largest difference in time of vertices that are alike: [`View::time`](crate::filtering::View::time). One image has one time.
    #[arg(skip)]
    pub filter_time: Option<f32>,
    /// Only vertices that see the same point lights are alike; takes a visibility ray for each.
    #[arg(long)]
    pub filter_visibility: bool,
    /// Least roughness of the surfaces at which paths are averaged: 0.5 is diffuse.
    #[arg(long, value_name = "ROUGHNESS", default_value_t = 0.05, value_parser = real::<f32>(0.0..=0.5, 0.05))]
    pub filter_roughness: f32,
    /// Vertices of a path that are averaged, at most.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = whole::<u32>(1..=1 << 16, 2))]
    pub filter_vertices: u32,
    /// More camera samples for each sample, without light paths of their own: anti-aliasing by averages of others.
    #[arg(long, value_name = "COUNT", default_value_t = 0, value_parser = whole::<u32>(0..=1 << 16, 3))]
    pub filter_extra: u32,
    /// How neighbours are found.
    #[arg(long, value_enum, value_name = "SEARCH", default_value_t)]
    pub filter_search: SearchName,
}

/// Least cosines between directions that are alike.
fn cosine() -> impl Fn(&str) -> Result<f32, String> + Clone + Send + Sync + 'static {
    real_where("a cosine from -1 to less than 1", 0.95, |cosine| (-1.0..1.0).contains(cosine))
}

/// Samples per pixel of a batch, unless told otherwise.
const USUAL_BATCH: u64 = 16;

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            filter_radius: 3.0,
            filter_length: None,
            filter_exponent: Radius::EXPONENT,
            filter_iterations: 1,
            filter_batch: None,
            filter_memory: 1024,
            filter_normals: 0.95,
            filter_albedo: None,
            filter_as_stored: false,
            filter_view: None,
            filter_hit_distance: None,
            filter_time: None,
            filter_visibility: false,
            filter_roughness: 0.05,
            filter_vertices: 1,
            filter_extra: 0,
            filter_search: SearchName::Grid,
        }
    }
}

impl FilterSettings {
    /// At which vertices.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn selection(&self) -> Result<Selection, FilterError> {
        Ok(Selection::new(self.filter_roughness, self.filter_vertices)?)
    }

    /// How far.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn radius(&self, sensor: &impl Sensor) -> Result<Radius, FilterError> {
        let radius = match self.filter_length {
            Some(length) => Radius::absolute(length)?,
            None => Radius::pixels(self.filter_radius, pixel_solid_angle(sensor))?,
        };
        Ok(radius.with_exponent(self.filter_exponent)?)
    }

    /// Which vertices are alike.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn alike(&self) -> Result<Alike, FilterError> {
        Ok(Alike {
            normals: (self.filter_normals > -1.0).then(|| NormalCone::new(self.filter_normals)).transpose()?,
            albedo: self.filter_albedo.map(AlbedoDifference::new).transpose()?,
            view: self.filter_view.map(ViewCone::new).transpose()?,
            hit_distance: self.filter_hit_distance.map(HitDistance::new).transpose()?,
            time: self.filter_time.map(SimilarTime::new).transpose()?,
            visibility: self.filter_visibility,
        })
    }

    /// The filter.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn filter(&self, name: PathFilterName, sensor: &impl Sensor) -> Result<AnyFilter, FilterError> {
        let (radius, alike) = (self.radius(sensor)?, self.alike()?);
        if self.filter_extra > 0 && self.filter_hit_distance.is_some() {
            return Err(FilterError::Setting(
                "--filter-extra samples have no ray for --filter-hit-distance to compare",
            ));
        }
        if name == PathFilterName::PsfHash
            && (alike.view.is_some() || alike.hit_distance.is_some() || alike.time.is_some())
        {
            return Err(FilterError::Setting(
                "--filter-view, --filter-hit-distance and --filter-time are for psf, not for psf-hash",
            ));
        }
        let modulation = match self.filter_as_stored {
            true => AnyModulation::AsStored,
            false => AnyModulation::Demodulated(Demodulated::default()),
        };
        Ok(match name {
            PathFilterName::Psf => AnyFilter::Search(
                PathSpaceFilter::new(radius)
                    .similarity(alike)
                    .modulation(modulation)
                    .iterations(self.filter_iterations)
                    .search(self.search()),
            ),
            PathFilterName::PsfHash => AnyFilter::Hash(
                JitteredHash::new(radius)
                    .key(AlikeKey { albedo: self.filter_albedo.is_some(), visibility: self.filter_visibility })
                    .modulation(modulation)
                    .normal_steps(if alike.normals.is_some() { 2 } else { 0 })
                    .iterations(self.filter_iterations),
            ),
        })
    }

    /// Samples per pixel of a batch.
    pub fn batch(&self, filter: &AnyFilter, pixels: u64) -> u64 {
        let memory = self.filter_memory.saturating_mul(1 << 20);
        self.filter_batch
            .unwrap_or_else(|| samples_in_memory(memory, pixels, self.filter_vertices, filter).min(USUAL_BATCH))
    }

    fn search(&self) -> Search {
        match self.filter_search {
            SearchName::Grid => Search::Grid,
            SearchName::KdTree => Search::KdTree,
            SearchName::Hierarchy => Search::Hierarchy,
            SearchName::DivideAndConquer => Search::DivideAndConquer,
        }
    }
}

/// Solid angle of the pixel in the middle of the image, in sr.
pub fn pixel_solid_angle(sensor: &impl Sensor) -> f32 {
    let [width, height] = sensor.resolution();
    let (x, y) = (0.5 * width as f32, 0.5 * height as f32);
    let towards = |dx: f32, dy: f32| sensor.sample_ray([x + dx, y + dy], [0.5; 2]).ray.direction;
    (towards(0.5, 0.0) - towards(-0.5, 0.0)).cross(towards(0.0, 0.5) - towards(0.0, -0.5)).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene_core::{ReferenceScene, Scene, builtin};

    #[test]
    fn pixels_fill_the_angle_of_view() {
        let scene = ReferenceScene::new(builtin::cornell_box()).unwrap();
        let sensor = scene.sensor();
        let [width, height] = sensor.resolution();
        let corner = |x: f32, y: f32| sensor.sample_ray([x, y], [0.5; 2]).ray.direction;
        let across = corner(width as f32, 0.5 * height as f32) - corner(0.0, 0.5 * height as f32);
        // A square image: about the solid angle of the square, which is a little less than that of as many pixels of the middle.
        let ratio = pixel_solid_angle(sensor) * (width * height) as f32 / across.length_squared();
        assert!((1.0..1.3).contains(&ratio), "{ratio}");
    }

    #[test]
    fn settings_out_of_range_name_themselves() {
        let scene = ReferenceScene::new(builtin::cornell_box()).unwrap();
        let error = |settings: FilterSettings| {
            let selection = settings.selection().map(|_| ());
            let filter = settings.filter(PathFilterName::Psf, scene.sensor()).map(|_| ());
            selection.and(filter).unwrap_err().to_string()
        };
        let usual = FilterSettings::default;
        assert!(error(FilterSettings { filter_radius: -2.0, ..usual() }).contains("--filter-radius"));
        assert!(error(FilterSettings { filter_exponent: 1.5, ..usual() }).contains("1.5"));
        assert!(error(FilterSettings { filter_normals: 2.0, ..usual() }).contains('2'));
        assert!(error(FilterSettings { filter_roughness: 0.7, ..usual() }).contains("0.7"));
        assert!(error(FilterSettings { filter_vertices: 0, ..usual() }).contains("at least one"));
        assert!(usual().filter(PathFilterName::PsfHash, scene.sensor()).is_ok());
    }
}
