//! Photon maps by the names of the command line: how many photons, which are kept, how far to look for them.

use std::sync::OnceLock;

use clap::{Args, ValueEnum};
use photon_map::{
    Bound, BoundError, CausticRule, CausticRuleError, DensityEstimation, Gather, GatherError, GuidanceError, Guide,
    Kernel, MapPartition, PartitionError, ProgressiveError, ProgressiveRadius,
};
use scene_core::{EmitterChoice, RussianRoulette, Scene};

use crate::estimators::{
    DirectLight, GuidanceTracing, ImportonTracing, PhotonEye, PhotonMapping, PhotonTracing, ProgressivePhotons,
    Sharpness, Unguided, VirtualLights, WithCaustics,
};
use crate::render::Shared;
use crate::values::{real, real_where, whole};

/// How the photons of a map are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DepositionName {
    /// Every photon is kept.
    #[default]
    All,
    /// Photons are kept where eye paths ask for them.
    Importance,
}

/// What importons guide of light paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum GuideName {
    /// Nothing: emitters and materials sample by themselves.
    #[default]
    None,
    /// The directions in which surfaces scatter light.
    Scattering,
    /// The emitters that paths begin at, and the directions in which they emit.
    Emission,
    /// Both.
    Both,
}

/// The forms of [`MapPartition`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PartitionVariant {
    /// One random number decides about ratio and importance.
    OneNumber,
    /// A random number for each.
    TwoNumbers,
    /// The first paths fill both maps, the others the caustic map alone.
    #[default]
    Trajectories,
}

/// The forms of [`Kernel`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum KernelName {
    /// All photons alike.
    Constant,
    /// Linear in the distance.
    Cone,
    /// Linear in the squared distance.
    #[default]
    Epanechnikov,
}

impl KernelName {
    /// The kernel.
    pub const fn kernel(self) -> Kernel {
        match self {
            Self::Constant => Kernel::Constant,
            Self::Cone => Kernel::CONE,
            Self::Epanechnikov => Kernel::Epanechnikov,
        }
    }
}

/// A radius, positive and finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// In units of the scene's radius.
    Relative(f32),
    /// In units of length.
    Absolute(f32),
}

impl Radius {
    /// In units of length, for a scene of this radius.
    pub fn resolve(self, scene_radius: f32) -> f32 {
        match self {
            Self::Relative(radius) => radius * scene_radius,
            Self::Absolute(radius) => radius,
        }
    }
}

/// Settings of photon maps.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Photon maps (photon-map, sppm, robust-igi --caustics)")]
pub struct PhotonSettings {
    /// Light paths: of the maps of photon-map, of each pass (one sample per pixel) otherwise.
    #[arg(long, default_value_t = DEFAULT_PATHS, value_parser = whole::<u64>(1..=1 << 32, DEFAULT_PATHS))]
    pub photons: u64,
    /// Radius of density estimation: a number in units of the scene's radius, or `abs:R` in units of length. With
    /// --nearest the largest
    /// one, with sppm the first one.
    #[arg(long, default_value = "0.01", value_parser = parse_radius)]
    pub photon_radius: Radius,
    /// The same for the caustic map.
    #[arg(long, default_value = "0.004", value_parser = parse_radius)]
    pub caustic_radius: Radius,
    /// Look as far as this number of photons [default: the radius is fixed].
    #[arg(long, value_name = "COUNT", value_parser = whole::<u32>(2..=1 << 20, 50))]
    pub nearest: Option<u32>,
    /// How photons at a distance count.
    #[arg(long, value_enum, default_value_t)]
    pub kernel: KernelName,
    /// Part of the photons that are not caustic which is kept (photon-map): with 0.05, and 20 times as many --photons, the
    /// caustic map grows by 20 and the global map stays as large.
    #[arg(long, default_value_t = 1.0, value_parser = real::<f64>(LEAST_SHARE..=1.0, 0.05))]
    pub global_ratio: f64,
    /// How the part that the global map keeps is chosen.
    #[arg(long, value_enum, default_value_t)]
    pub partition_variant: PartitionVariant,
    /// Bounces up to this roughness are sharp: eye paths follow them, and photons after them are caustic. 0: mirrors
    /// and glass alone; diffuse is 0.5.
    #[arg(long, default_value_t = DEFAULT_ROUGHNESS, value_parser = real::<f32>(0.0..=0.45, DEFAULT_ROUGHNESS))]
    pub caustic_roughness: f32,
    /// Rays of final gathering at each eye vertex (photon-map); 0 looks at the global map directly.
    #[arg(long, default_value_t = DEFAULT_RAYS, value_parser = whole::<u32>(0..=1 << 16, DEFAULT_RAYS))]
    pub gather_rays: u32,
    /// Which photons are kept (photon-map).
    #[arg(long, value_enum, default_value_t)]
    pub deposition: DepositionName,
    /// Which choices of light paths prefer what importons ask for, whatever photons are kept (photon-map).
    #[arg(long, value_enum, default_value_t)]
    pub guide: GuideName,
    /// The share of emitters and directions that --guide chooses: less than 1, so that all light is found.
    #[arg(long, default_value_t = DEFAULT_GUIDE_SHARE, value_parser = real_where::<f64>("a number from 0 to less than 1", DEFAULT_GUIDE_SHARE, |share| (0.0..1.0).contains(share)))]
    pub guide_share: f64,
    /// Paths from the sensor for --deposition importance and for --guide.
    #[arg(long, default_value_t = DEFAULT_IMPORTONS, value_parser = whole::<u64>(1..=1 << 32, DEFAULT_IMPORTONS))]
    pub importons: u64,
    /// Radius in which importons (what paths from the sensor leave, as paths from lights leave photons) are looked for: as --photon-radius.
    #[arg(long, default_value = "0.03", value_parser = parse_radius)]
    pub importon_radius: Radius,
    /// The least probability to keep a photon, epsilon of Keller and Wald 2000: unbiased if it is positive.
    #[arg(long, default_value_t = DEFAULT_FLOOR, value_parser = real::<f64>(LEAST_SHARE..=1.0, DEFAULT_FLOOR))]
    pub deposition_floor: f64,
    /// Keep nothing below that probability: biased.
    #[arg(long)]
    pub deposition_cutoff: bool,
    /// By how little the radius shrinks (sppm): variance falls as n^-alpha, bias as n^(alpha-1).
    #[arg(long, default_value_t = DEFAULT_ALPHA, value_parser = real_where::<f64>("a number between 0 and 1", 0.7, |alpha| *alpha > 0.0 && *alpha < 1.0))]
    pub alpha: f64,
    /// Find caustics by a photon map, with robust-igi: eye paths then end at mirrors and glass.
    #[arg(long)]
    pub caustics: bool,
}

const DEFAULT_PATHS: u64 = 200_000;
const DEFAULT_ROUGHNESS: f32 = 0.1;
const DEFAULT_RAYS: u32 = 8;
const DEFAULT_IMPORTONS: u64 = 100_000;
const DEFAULT_FLOOR: f64 = 0.01;
const DEFAULT_GUIDE_SHARE: f64 = 0.5;
const DEFAULT_ALPHA: f64 = 2.0 / 3.0;
/// Smaller parts of the photons than this are taken for a mistake.
const LEAST_SHARE: f64 = 1e-12;
/// Part of the queries of test paths where photons are not kept for certain.
const QUANTILE: f64 = 0.05;
/// Paths whose queries give the scale of importance.
const TEST_PATHS: u64 = 4096;

impl Default for PhotonSettings {
    fn default() -> Self {
        Self {
            photons: DEFAULT_PATHS,
            photon_radius: Radius::Relative(0.01),
            caustic_radius: Radius::Relative(0.004),
            nearest: None,
            kernel: KernelName::Epanechnikov,
            global_ratio: 1.0,
            partition_variant: PartitionVariant::Trajectories,
            caustic_roughness: DEFAULT_ROUGHNESS,
            gather_rays: DEFAULT_RAYS,
            deposition: DepositionName::All,
            guide: GuideName::None,
            guide_share: DEFAULT_GUIDE_SHARE,
            importons: DEFAULT_IMPORTONS,
            importon_radius: Radius::Relative(0.03),
            deposition_floor: DEFAULT_FLOOR,
            deposition_cutoff: false,
            alpha: DEFAULT_ALPHA,
            caustics: false,
        }
    }
}

/// Why settings are no photon maps.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PhotonError {
    /// A radius, or a number of photons.
    #[error(transparent)]
    Gather(#[from] GatherError),
    /// The ratio of the maps.
    #[error(transparent)]
    Partition(#[from] PartitionError),
    /// The threshold of sharp bounces.
    #[error(transparent)]
    Roughness(#[from] CausticRuleError),
    /// The floor or cutoff of deposition.
    #[error(transparent)]
    Bound(#[from] BoundError),
    /// The share that is guided.
    #[error(transparent)]
    Guide(#[from] GuidanceError),
    /// How the radius shrinks.
    #[error(transparent)]
    Progressive(#[from] ProgressiveError),
}

/// What eye and light paths share with those of other estimators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathLimits {
    /// Segments of a whole path.
    pub max_depth: u32,
    /// How eye paths end by chance.
    pub roulette: RussianRoulette,
}

impl PhotonSettings {
    /// Which bounces are sharp.
    ///
    /// # Errors
    /// If the threshold is negative or NaN.
    pub fn sharpness(&self) -> Result<Sharpness, CausticRuleError> {
        let rule = match self.caustic_roughness {
            0.0 => CausticRule::SPECULAR,
            roughness => CausticRule::new(roughness)?,
        };
        Ok(Sharpness { rule })
    }

    /// How photons are looked at within a radius.
    ///
    /// # Errors
    /// If the radius is out of range, or the number of photons below two.
    pub fn estimation<S: Scene>(&self, scene: &S, radius: Radius) -> Result<DensityEstimation, GatherError> {
        let radius = radius.resolve(scene.bounding_sphere().1);
        let gather = match self.nearest {
            Some(count) => Gather::nearest(count as usize, radius)?,
            None => Gather::within(radius)?,
        };
        Ok(DensityEstimation { gather, kernel: self.kernel.kernel() })
    }

    /// How photons are shared out between the maps.
    ///
    /// # Errors
    /// If the ratio is out of range, or leaves no path for the global map.
    pub fn partition(&self) -> Result<MapPartition, PartitionError> {
        match self.partition_variant {
            PartitionVariant::OneNumber => MapPartition::one_number(self.global_ratio),
            PartitionVariant::TwoNumbers => MapPartition::two_numbers(self.global_ratio),
            PartitionVariant::Trajectories => MapPartition::trajectories(self.global_ratio, self.photons),
        }
    }

    /// Paths from the sensor that say where photons are wanted.
    ///
    /// # Errors
    /// If the radius, the bound or the threshold is out of range.
    pub fn importon_tracing<S: Scene>(&self, scene: &S, limits: PathLimits) -> Result<ImportonTracing, PhotonError> {
        let radius = self.importon_radius.resolve(scene.bounding_sphere().1);
        let bound = if self.deposition_cutoff {
            Bound::Cutoff(self.deposition_floor)
        } else {
            Bound::Floor(self.deposition_floor)
        };
        Ok(ImportonTracing {
            paths: self.importons,
            test_paths: TEST_PATHS,
            quantile: QUANTILE,
            bound: bound.validate()?,
            estimation: DensityEstimation { gather: Gather::within(radius)?, kernel: Kernel::Constant },
            sharpness: self.sharpness()?,
            bounces: u32::from(self.gather_rays > 0),
            max_length: limits.max_depth,
        })
    }

    /// Paths from the sensor that say where light paths go; nothing if none are to.
    ///
    /// # Errors
    /// As for [`importon_tracing`](Self::importon_tracing), or if the share is out of range.
    pub fn guidance<S: Scene>(&self, scene: &S, limits: PathLimits) -> Result<Option<GuidanceTracing>, PhotonError> {
        let guide = Guide::new(self.guide_share)?;
        let (scattering, emission) = match self.guide {
            GuideName::None => return Ok(None),
            GuideName::Scattering => (true, false),
            GuideName::Emission => (false, true),
            GuideName::Both => (true, true),
        };
        Ok(Some(GuidanceTracing { importons: self.importon_tracing(scene, limits)?, guide, scattering, emission }))
    }

    /// Light paths.
    ///
    /// # Errors
    /// If the threshold of sharp bounces is out of range.
    pub fn tracing<C>(&self, choice: C, limits: PathLimits) -> Result<PhotonTracing<C>, PhotonError> {
        Ok(PhotonTracing {
            choice,
            // The camera's ray is a segment, too.
            max_length: limits.max_depth.saturating_sub(1),
            roulette: RussianRoulette::LocalAlbedo { from_length: 0 },
            sharpness: self.sharpness()?,
            guidance: Unguided,
        })
    }

    fn eye<D>(&self, direct: D, gather: u32, limits: PathLimits) -> Result<PhotonEye<D>, PhotonError> {
        let PathLimits { max_depth, roulette } = limits;
        Ok(PhotonEye { direct, gather, sharpness: self.sharpness()?, max_depth, roulette })
    }

    /// Photon mapping.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn mapping<S: Scene, D: DirectLight, C: EmitterChoice>(
        &self,
        scene: &S,
        direct: D,
        choice: C,
        limits: PathLimits,
    ) -> Result<PhotonMapping<D, C>, PhotonError> {
        let importons = match self.deposition {
            DepositionName::All => None,
            DepositionName::Importance => Some(self.importon_tracing(scene, limits)?),
        };
        Ok(PhotonMapping {
            eye: self.eye(direct, self.gather_rays, limits)?,
            light: self.tracing(choice, limits)?,
            paths: self.photons,
            partition: self.partition()?,
            importons,
            guidance: self.guidance(scene, limits)?,
            global: self.estimation(scene, self.photon_radius)?,
            caustic: self.estimation(scene, self.caustic_radius)?,
            maps: OnceLock::new(),
        })
    }

    /// Progressive photon mapping.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn progressive<S: Scene, D: DirectLight, C: EmitterChoice>(
        &self,
        scene: &S,
        direct: D,
        choice: C,
        limits: PathLimits,
    ) -> Result<ProgressivePhotons<D, C>, PhotonError> {
        Ok(ProgressivePhotons {
            eye: self.eye(direct, 0, limits)?,
            light: self.tracing(choice, limits)?,
            paths: self.photons,
            radius: self.first_radius(scene, self.photon_radius)?,
            kernel: self.kernel.kernel(),
        })
    }

    /// A caustic map for robust instant global illumination.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn complement<S: Scene, C: EmitterChoice + Clone>(
        &self,
        scene: &S,
        camera: Shared<VirtualLights<'static, C>>,
        limits: PathLimits,
    ) -> Result<WithCaustics<C>, PhotonError> {
        let light = self.tracing(camera.estimator.light.choice.clone(), limits)?;
        let radius = self.first_radius(scene, self.caustic_radius)?;
        Ok(WithCaustics { camera, light, paths: self.photons, radius, kernel: self.kernel.kernel() })
    }

    fn first_radius<S: Scene>(&self, scene: &S, radius: Radius) -> Result<ProgressiveRadius, PhotonError> {
        let radius = radius.resolve(scene.bounding_sphere().1);
        Gather::within(radius)?;
        Ok(ProgressiveRadius::new(radius, self.alpha)?)
    }
}

fn parse_radius(text: &str) -> Result<Radius, String> {
    let (number, make): (_, fn(f32) -> Radius) = match text.strip_prefix("abs:") {
        Some(number) => (number, Radius::Absolute),
        None => (text, Radius::Relative),
    };
    match number.parse::<f32>() {
        Ok(radius) if radius > 0.0 && radius.is_finite() => Ok(make(radius)),
        _ => Err("expected a positive number, as in 0.01, or 'abs:' and such a number, as in abs:0.5".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_parsed() {
        assert_eq!(parse_radius("0.02"), Ok(Radius::Relative(0.02)));
        assert_eq!(parse_radius("abs:0.5"), Ok(Radius::Absolute(0.5)));
        for wrong in ["", "0", "-1", "nan", "inf", "abs:", "abs:0", "r"] {
            assert!(parse_radius(wrong).is_err(), "{wrong}");
        }
        let parse = |option: &str, value: &str| {
            let command = PhotonSettings::augment_args(clap::Command::new("photons")).no_binary_name(true);
            command.try_get_matches_from([format!("--{option}={value}")]).map(drop)
        };
        for wrong in ["0", "1.5", "nan", "-1", ""] {
            for option in ["global-ratio", "deposition-floor", "alpha"] {
                assert!(parse(option, wrong).is_err(), "--{option}={wrong}");
            }
        }
        assert!(parse("alpha", "1").is_err() && parse("global-ratio", "1").is_ok());
        assert!(["0", "0.99"].iter().all(|right| parse("guide-share", right).is_ok()));
        assert!(["1", "-0.1", "nan", ""].iter().all(|wrong| parse("guide-share", wrong).is_err()));
        assert!(parse("caustic-roughness", "0.5").is_err() && parse("caustic-roughness", "-0").is_ok());
    }

    #[test]
    fn impossible_settings_are_refused_with_a_reason() {
        let few = PhotonSettings { photons: 10, global_ratio: 0.05, ..PhotonSettings::default() };
        assert!(matches!(few.partition(), Err(PartitionError::NoPath { .. })));
        let negative = PhotonSettings { caustic_roughness: -1.0, ..PhotonSettings::default() };
        assert!(negative.sharpness().is_err());
        let mirrors = PhotonSettings { caustic_roughness: 0.0, ..PhotonSettings::default() };
        assert_eq!(mirrors.sharpness().map(|sharpness| sharpness.rule), Ok(CausticRule::SPECULAR));
    }
}
