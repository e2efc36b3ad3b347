//! Light paths by the names of the command line: how many, who shares them, and what connections take of an edge.

use clap::{Args, ValueEnum};
use qmc_sampling::Interleaved;
use scene_core::Scene;
use scene_core::film::{LayeredImage, LayeredImageError};
use vpl_gi::{
    DiscontinuityBuffer, FinalGathering, Partition, PartitionError, PixelFeatures, Residual, RobustIgi, ShadowRays,
    TechniqueSet, Threshold,
};

use crate::render::Sharing;
use crate::values::whole;

/// The forms of [`Partition`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PartitionName {
    /// Connections take edges with a geometry term below the threshold.
    #[default]
    Hard,
    /// Connections take the geometry term up to the threshold.
    Soft,
    /// Connections take the share t / (t + G) of the geometry term G.
    Balance,
    /// Connections take edges longer than 1 / sqrt(t).
    Distance,
}

impl PartitionName {
    /// The partition with this threshold, in 1/length^2.
    ///
    /// # Errors
    /// If the threshold is negative or NaN.
    pub fn partition(self, threshold: f32) -> Result<Partition, PartitionError> {
        match self {
            Self::Hard => Partition::hard(threshold),
            Self::Soft => Partition::soft(threshold),
            Self::Balance => Partition::balance(threshold),
            Self::Distance => Partition::distance(threshold),
        }
    }
}

/// Settings of the estimators that connect eye paths to light paths.
#[derive(Clone, Debug, Args)]
#[command(
    next_help_heading = "Virtual point lights and bidirectional path tracing (robust-igi, instant-radiosity, bdpt)"
)]
pub struct LightPathSettings {
    /// Threshold of the geometry term: a number in units of 1/R^2, with the radius R of the scene; or `abs:T` in 1/length^2;
    /// `inf` is allowed [default: 100, and inf for instant-radiosity].
    #[arg(long, allow_negative_numbers = true, value_parser = parse_threshold)]
    pub threshold: Option<Threshold>,
    /// What of the light between two vertices connections carry, by the geometry term G and the threshold t. What instant-radiosity leaves is lost,
    /// with robust-igi scattered rays carry it.
    #[arg(long, value_enum, default_value_t)]
    pub partition: PartitionName,
    /// Light paths that a sample is connected to [default: 1 with bdpt, and 32 otherwise].
    #[arg(long, value_name = "COUNT", value_parser = whole::<u32>(1..=1 << 24, 32), hide_default_value = true,
        default_value_t = DEFAULT_LIGHT_PATHS, default_value_if("estimator", "bdpt", "1"))]
    pub light_paths: u32,
    /// Tile of pixels with different light paths, shared by all tiles; `none` gives every sample its own [default: none with bdpt,
    /// which is then the classical form, and 3x3 otherwise].
    #[arg(long, value_name = "TILE", value_parser = parse_interleave, hide_default_value = true,
        default_value = "3x3", default_value_if("estimator", "bdpt", "none"))]
    pub interleave: Interleave,
    /// Shadow rays: `all`, `sampled:N` by contribution, or `ordered:TOLERANCE`, the brightest first.
    #[arg(long, default_value = "all", value_parser = parse_shadow_rays)]
    pub shadow_rays: ShadowRays,
    /// Shadow rays per eye path (bdpt), for connections chosen by resampling [default: one for each connection].
    #[arg(long, value_name = "RAYS", value_parser = whole::<u32>(1..=1 << 10, 4))]
    pub resampled_connections: Option<u32>,
    /// Final gathering with this number of rays; 0 is none.
    #[arg(long, default_value_t = 0, value_parser = whole::<u32>(0..=1 << 16, 8))]
    pub gather: u32,
    /// Threshold the geometry term alone, as the paper does: glossy surfaces then show bright spots. Otherwise the peaks of
    /// scattering functions count as well.
    #[arg(long)]
    pub geometry_alone: bool,
    /// Do not connect light paths to the lens (bdpt): the techniques of Kollig and Keller 2004.
    #[arg(long)]
    pub without_lens: bool,
    /// Smooth the image over the tile where neighbours see about the same surface: the discontinuity buffer. Biased.
    #[arg(long)]
    pub discontinuity_buffer: bool,
}

const DEFAULT_LIGHT_PATHS: u32 = 32;
/// In units of 1/R^2.
const DEFAULT_THRESHOLD: f32 = 100.0;

/// The tile of `--interleave`, if there is one.
pub type Interleave = Option<Interleaved>;

impl Default for LightPathSettings {
    /// Those of virtual point lights; [`classical`](LightPathSettings::classical) ones are bidirectional path tracing's.
    fn default() -> Self {
        Self {
            threshold: None,
            partition: PartitionName::Hard,
            light_paths: DEFAULT_LIGHT_PATHS,
            interleave: Interleaved::new(3, 3).ok(),
            shadow_rays: ShadowRays::All,
            resampled_connections: None,
            gather: 0,
            geometry_alone: false,
            without_lens: false,
            discontinuity_buffer: false,
        }
    }
}

/// Applies the discontinuity buffer for tiles of these sides: to the image and with the auxiliary channels of first hits. Variances are not
/// known any more.
///
/// # Errors
/// If the image has no colours.
pub fn smooth(image: &mut LayeredImage, sides: [u32; 2]) -> Result<(), LayeredImageError> {
    let channel = |name: &str| image.channel(name).unwrap_or_default();
    let (albedo, normal) = (["Albedo.R", "Albedo.G", "Albedo.B"].map(channel), ["N.X", "N.Y", "N.Z"].map(channel));
    let depth = channel("Z");
    let at = |values: &[f32], pixel: usize| values.get(pixel).copied().unwrap_or(0.0);
    let features: Vec<PixelFeatures> = (0..image.pixel_count())
        .map(|pixel| PixelFeatures {
            albedo: albedo.map(|values| at(values, pixel)),
            normal: normal.map(|values| at(values, pixel)),
            depth: at(depth, pixel),
        })
        .collect();
    let size = [image.width(), image.height()];
    let smooth = DiscontinuityBuffer::new(sides).filter(size, &features, &image.rgb()?);
    let Some(smooth) = smooth else { return Ok(()) };
    image.set_rgb(&smooth)?;
    for name in ["Variance.R", "Variance.G", "Variance.B"] {
        image.set_channel(name, vec![f32::INFINITY; smooth.len()])?;
    }
    Ok(())
}

impl LightPathSettings {
    /// For each eye path one light path of its own, as Veach and Guibas have them: what the command line takes for `bdpt`.
    pub fn classical() -> Self {
        Self { light_paths: 1, interleave: None, ..Self::default() }
    }

    /// Light paths of a sample, and who shares them, in words.
    pub fn describe_paths(&self) -> String {
        let count = self.light_paths;
        let paths = if count == 1 { "1 light path".to_owned() } else { format!("{count} light paths") };
        match self.interleave.map(|tile| tile.sides()) {
            None => format!("{paths} of its own for each sample"),
            Some([x, y]) => format!("{paths} for each sample, shared by all tiles of {x}x{y} pixels"),
        }
    }

    /// Sides of the tile of the discontinuity buffer, if one is asked for and there is a tile.
    pub fn smoothing(&self) -> Option<[u32; 2]> {
        self.interleave.filter(|_| self.discontinuity_buffer).map(|tile| tile.sides())
    }

    /// Who shares light paths.
    pub fn sharing(&self) -> Sharing {
        self.interleave.map_or(Sharing::Independent, Sharing::Interleaved)
    }

    /// The techniques of bidirectional path tracing, for an image of this size.
    pub fn techniques(&self, [width, height]: [u32; 2]) -> TechniqueSet {
        if self.without_lens {
            return TechniqueSet::WithoutLens;
        }
        let different = match self.sharing() {
            Sharing::Independent => f64::from(width) * f64::from(height),
            Sharing::Interleaved(tile) => f64::from(tile.patterns()),
        };
        TechniqueSet::WithLens { light_paths: different * f64::from(self.light_paths) }
    }

    /// The partition of bidirectional path tracing and robust instant global illumination.
    ///
    /// # Errors
    /// If the threshold is negative or NaN.
    pub fn partition_of<S: Scene>(&self, scene: &S) -> Result<Partition, PartitionError> {
        self.partition_or(scene, DEFAULT_THRESHOLD)
    }

    fn partition_or<S: Scene>(&self, scene: &S, default: f32) -> Result<Partition, PartitionError> {
        let threshold = self.threshold.unwrap_or(Threshold::normalised(default));
        self.partition.partition(threshold.resolve(scene.bounding_sphere().1))
    }

    /// The robust estimator, with paths of any length.
    ///
    /// # Errors
    /// If the threshold is negative or NaN.
    pub fn robust<S: Scene>(&self, scene: &S, residual: Residual) -> Result<RobustIgi, PartitionError> {
        let default = if residual == Residual::Drop { f32::INFINITY } else { DEFAULT_THRESHOLD };
        let gathering = (self.gather > 0).then_some(FinalGathering { rays: self.gather });
        let shadow_rays = self.shadow_rays;
        Ok(RobustIgi {
            residual,
            shadow_rays,
            gathering,
            peaks: !self.geometry_alone,
            ..RobustIgi::new(self.partition_or(scene, default)?)
        })
    }
}

fn parse_threshold(text: &str) -> Result<Threshold, String> {
    let (number, make): (_, fn(f32) -> Threshold) = match text.strip_prefix("abs:") {
        Some(number) => (number, Threshold::Absolute),
        None => (text, Threshold::Normalised),
    };
    match number.parse::<f32>() {
        Ok(value) if value >= 0.0 => Ok(make(value)),
        _ => {
            Err("expected a number that is not negative, as in 100, 'inf', or 'abs:' and such a number, as in abs:0.5"
                .to_owned())
        }
    }
}

fn parse_interleave(text: &str) -> Result<Interleave, String> {
    if text == "none" {
        return Ok(None);
    }
    let sides = text.split_once(['x', 'X']).and_then(|(x, y)| Some((x.parse::<u32>().ok()?, y.parse::<u32>().ok()?)));
    match sides {
        Some((x, y)) if (1..=64).contains(&x) && (1..=64).contains(&y) => {
            Interleaved::new(x, y).map(Some).map_err(|error| error.to_string())
        }
        _ => Err("expected 'none' or COLUMNSxROWS, each from 1 to 64, as in 3x3".to_owned()),
    }
}

fn parse_shadow_rays(text: &str) -> Result<ShadowRays, String> {
    let reason = || {
        "expected 'all', 'sampled:N' with N at least 1, as in sampled:4, or 'ordered:TOLERANCE' with a tolerance from 0 to less than 1, as in ordered:0.1".to_owned()
    };
    match text.split_once(':') {
        None if text == "all" => Ok(ShadowRays::All),
        Some(("sampled", count)) => match count.parse::<u32>() {
            Ok(count @ 1..) => Ok(ShadowRays::Sampled { count }),
            _ => Err(reason()),
        },
        Some(("ordered", tolerance)) => match tolerance.parse::<f32>() {
            Ok(tolerance) if (0.0..1.0).contains(&tolerance) => Ok(ShadowRays::Ordered { tolerance, remainder: 1 }),
            _ => Err(reason()),
        },
        _ => Err(reason()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whoever asks for bidirectional path tracing gets the classical form; with anything else the numbers are shared.
    #[test]
    fn light_paths_are_shared_unless_they_are_bidirectional() {
        let parsed = |words: &[&str]| {
            let command =
                clap::Command::new("a").no_binary_name(true).arg(clap::Arg::new("estimator").long("estimator"));
            let matches = LightPathSettings::augment_args(command).try_get_matches_from(words).unwrap();
            let found = <LightPathSettings as clap::FromArgMatches>::from_arg_matches(&matches).unwrap();
            (found.light_paths, found.interleave.map(|tile| tile.sides()), found.describe_paths())
        };
        let usual = (32, Some([3, 3]), "32 light paths for each sample, shared by all tiles of 3x3 pixels".to_owned());
        assert_eq!(parsed(&[]), usual);
        assert_eq!(parsed(&["--estimator=robust-igi"]), usual);
        let classical = LightPathSettings::classical();
        assert_eq!((classical.light_paths, classical.interleave), (1, None));
        let text = "1 light path of its own for each sample".to_owned();
        assert_eq!(parsed(&["--estimator=bdpt"]), (1, None, text));
        let (count, tile, _) = parsed(&["--light-paths=8", "--estimator=bdpt", "--interleave=2x2"]);
        assert_eq!((count, tile), (8, Some([2, 2])));
    }

    #[test]
    fn names_are_parsed() {
        assert_eq!(parse_threshold("0.3"), Ok(Threshold::Normalised(0.3)));
        assert_eq!(parse_threshold("abs:2"), Ok(Threshold::Absolute(2.0)));
        assert_eq!(parse_threshold("inf"), Ok(Threshold::Normalised(f32::INFINITY)));
        for wrong in ["", "-1", "nan", "abs:", "abs:-1", "t"] {
            assert!(parse_threshold(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_interleave("none"), Ok(None));
        assert_eq!(parse_interleave("3x2").unwrap().map(|tile| tile.sides()), Some([3, 2]));
        for wrong in ["", "3", "0x3", "3x65", "x"] {
            assert!(parse_interleave(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_shadow_rays("sampled:8"), Ok(ShadowRays::Sampled { count: 8 }));
        assert_eq!(parse_shadow_rays("ordered:0.1"), Ok(ShadowRays::Ordered { tolerance: 0.1, remainder: 1 }));
        for wrong in ["", "some", "sampled:0", "sampled", "ordered:2", "ordered:-1", "ordered:nan", "all:1"] {
            assert!(parse_shadow_rays(wrong).is_err(), "{wrong}");
        }
    }
}
