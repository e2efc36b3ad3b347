//! Light selection by primary photons, as the command line has it.

use clap::{Args, ValueEnum};
use photon_map::{Allocation, GatherError, LightTableError, MapError, SelectionError};

use crate::values::{real, whole};

/// What shadow rays are shared out by, among the lights that contribute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ImportanceName {
    /// What the middle of the light would contribute if nothing was in between, and to an eighth the flux of the photons, in case the middle
    /// is dark. An evaluation per contributing light, if there are several.
    #[default]
    Contribution,
    /// The flux of the photons that were found: a rough estimate of the irradiance, shadows and all.
    Photons,
    /// The power of the light.
    Power,
}

/// How the shadow rays for contributing lights are shared out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum AllocationName {
    /// In proportion to importance.
    Proportional,
    /// One for each of the brightest lights, as far as there are enough; the rest in proportion.
    #[default]
    BrightestFirst,
}

impl AllocationName {
    /// The allocation.
    pub fn allocation(self) -> Allocation {
        match self {
            Self::Proportional => Allocation::Proportional,
            Self::BrightestFirst => Allocation::BrightestFirst,
        }
    }
}

/// Settings of `--lights photons`.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Light selection by photons (direct, path with --lights photons)")]
pub struct LightPhotonSettings {
    /// Photons that are traced before rendering [default: 100 per light, at least 50,000 and at most 4,000,000].
    #[arg(long, value_name = "COUNT", value_parser = whole::<u32>(1..=1 << 28, 50_000))]
    pub light_photons: Option<u32>,
    /// How many of the nearest photons within the radius tell which lights contribute, from 2; `all` of them are found sooner.
    #[arg(long, value_name = "COUNT", default_value = "all", value_parser = parse_nearest)]
    pub light_nearest: Nearest,
    /// How far photons are looked for, in units of the scene [default: as far as 32 photons reach where photons are usual; three times as far
    /// for a number of nearest ones].
    #[arg(long, value_name = "RADIUS", allow_negative_numbers = true, value_parser = real::<f32>(1e-12..=1e15, 0.5))]
    pub light_radius: Option<f32>,
    /// Shadow rays at each vertex for the lights that contribute.
    #[arg(long, value_name = "RAYS", default_value_t = 1, value_parser = whole::<u32>(1..=1 << 12, 1))]
    pub contributing_rays: u32,
    /// Shadow rays for all other lights. 0 is biased: light that the photons missed is lost.
    #[arg(long, value_name = "RAYS", default_value_t = 1, value_parser = whole::<u32>(0..=1 << 12, 1))]
    pub other_rays: u32,
    /// What shadow rays are shared out by, among the lights that contribute.
    #[arg(long, value_enum, default_value_t)]
    pub light_importance: ImportanceName,
    /// How they are shared out.
    #[arg(long, value_enum, default_value_t)]
    pub light_allocation: AllocationName,
}

/// The number of `--light-nearest`, unless it is `all`.
pub type Nearest = Option<usize>;

/// The usual number of photons within the radius that is measured.
const NEAREST: usize = 32;
const PHOTONS_PER_LIGHT: usize = 100;
const FEWEST_PHOTONS: usize = 50_000;
const MOST_PHOTONS: usize = 4_000_000;

impl Default for LightPhotonSettings {
    fn default() -> Self {
        Self {
            light_photons: None,
            light_nearest: None,
            light_radius: None,
            contributing_rays: 1,
            other_rays: 1,
            light_importance: ImportanceName::default(),
            light_allocation: AllocationName::default(),
        }
    }
}

impl LightPhotonSettings {
    /// How many photons are traced in a scene with so many lights.
    pub fn photons_for(&self, lights: usize) -> u32 {
        let default = lights.saturating_mul(PHOTONS_PER_LIGHT).clamp(FEWEST_PHOTONS, MOST_PHOTONS);
        self.light_photons.unwrap_or(default as u32)
    }

    /// The number of photons by which distances between them are measured.
    pub fn nearest_or_default(&self) -> usize {
        self.light_nearest.unwrap_or(NEAREST)
    }
}

/// Why lights cannot be selected by photons.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightPhotonsError {
    /// How far to look for photons.
    #[error(transparent)]
    Gather(#[from] GatherError),
    /// The map.
    #[error(transparent)]
    Map(#[from] MapError),
    /// The lights.
    #[error(transparent)]
    Lights(#[from] LightTableError),
    /// The shadow rays.
    #[error(transparent)]
    Rays(#[from] SelectionError),
    /// The other processes.
    #[error(transparent)]
    Ranks(#[from] crate::distributed::RanksError),
}

fn parse_nearest(text: &str) -> Result<Nearest, String> {
    match text.parse::<usize>() {
        Ok(count @ 2..=65_536) => Ok(Some(count)),
        _ if text == "all" => Ok(None),
        _ => Err("expected a whole number from 2 to 65536, as in 32, or `all`".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed() {
        assert_eq!((parse_nearest("all"), parse_nearest("2")), (Ok(None), Ok(Some(2))));
        assert!(["", "0", "1", "-3", "1.5", "65537", "ALL"].iter().all(|text| parse_nearest(text).is_err()));
    }

    #[test]
    fn photons_are_counted_per_light() {
        let settings = LightPhotonSettings::default();
        let counts = [1, 1000, 10_000, usize::MAX].map(|lights| settings.photons_for(lights));
        assert_eq!(counts, [50_000, 100_000, 1_000_000, 4_000_000]);
        assert_eq!(LightPhotonSettings { light_photons: Some(7), ..settings }.photons_for(1000), 7);
    }
}
