//! What is done, by one process or by all together.

use scene_core::film::Film;
use serde::{Deserialize, Serialize};

use super::RenderArguments;
use super::attributes::{DETAILS, PATH_FILTER};
use super::parts::Part;
use crate::distributed::{Portable, Traffic};
use crate::output::{Checkpoint, CheckpointError, RenderStats, peak_bytes};
use crate::render::Rendering;

/// Samples, and what they took.
pub(super) struct Done {
    pub(super) checkpoint: Checkpoint,
    pub(super) cost: Cost,
}

/// What several processes do not have together, as a checkpoint says it, but each for itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Cost {
    pub(super) ranks: usize,
    pub(super) threads: usize,
    /// Samples per pixel of this run.
    pub(super) samples: u64,
    /// Of the slowest, with the runs before.
    pub(super) seconds: f64,
    pub(super) load_seconds: f64,
    /// Of the largest.
    pub(super) peak_bytes: u64,
}

impl Cost {
    fn join(&mut self, other: &Self) {
        self.ranks += other.ranks;
        self.threads += other.threads;
        self.samples += other.samples;
        self.seconds = self.seconds.max(other.seconds);
        self.load_seconds = self.load_seconds.max(other.load_seconds);
        self.peak_bytes = self.peak_bytes.max(other.peak_bytes);
    }
}

impl Done {
    /// By this process, with what was there before.
    pub(super) fn of(part: &Part, rendering: Rendering, load_seconds: f64) -> Result<Self, CheckpointError> {
        let Rendering { samples, threads, .. } = rendering;
        let checkpoint = part.with(rendering)?;
        let seconds = checkpoint.described.seconds;
        Ok(Self {
            checkpoint,
            cost: Cost { ranks: 1, threads, samples, seconds, load_seconds, peak_bytes: peak_bytes() },
        })
    }

    pub(super) fn film(&self) -> &Film {
        &self.checkpoint.film
    }

    pub(super) fn stats(&self, arguments: &RenderArguments, traffic: Traffic) -> RenderStats {
        let (width, height, described) = (self.film().width(), self.film().height(), &self.checkpoint.described);
        let Cost { ranks, threads, seconds, load_seconds, peak_bytes, .. } = self.cost;
        // As the image tells them.
        let setting = |key: &str| described.attributes.get(key).cloned();
        let name = |key: &str| setting(key).unwrap_or_default();
        RenderStats {
            scene: arguments.scene.clone(),
            estimator: name("estimator"),
            heuristic: name("heuristic"),
            lights: name("lights"),
            sampler: name("sampler"),
            seed: arguments.seed,
            max_depth: name("maxDepth").parse().unwrap_or(-1),
            path_filter: setting(PATH_FILTER),
            details: DETAILS.iter().filter_map(|key| Some(((*key).to_owned(), setting(key)?))).collect(),
            renderer: name("renderer"),
            width,
            height,
            spp: described.count(),
            ranks,
            threads,
            load_seconds,
            render_seconds: seconds,
            paths: described.count() * u64::from(width) * u64::from(height) + described.light_paths,
            closest_hit_rays: described.rays[0],
            visibility_rays: described.rays[1],
            peak_bytes,
            gathered_bytes: traffic.gathered,
            received_bytes: traffic.received,
        }
    }
}

/// Length of the text before the checkpoint.
type Head = u32;

impl Portable for Done {
    const NAME: &'static str = "samples";

    fn to_bytes(&self) -> Vec<u8> {
        let cost = serde_json::to_vec(&self.cost).expect("numbers are JSON");
        let mut bytes = (cost.len() as Head).to_le_bytes().to_vec();
        bytes.extend_from_slice(&cost);
        self.checkpoint.write_to(&mut bytes).expect("memory can be written");
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let (&head, rest) = bytes.split_first_chunk().ok_or("no head")?;
        let (cost, rest) = rest.split_at_checked(Head::from_le_bytes(head) as usize).ok_or("too short")?;
        let cost = serde_json::from_slice(cost).map_err(|error| error.to_string())?;
        Ok(Self { checkpoint: Checkpoint::read_from(rest)?, cost })
    }

    fn join(&mut self, behind: Self) -> Result<(), String> {
        self.checkpoint.absorb(&behind.checkpoint).map_err(|error| error.to_string())?;
        self.cost.join(&behind.cost);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Described;

    fn done(samples: [u64; 2], seconds: f64) -> Done {
        let mut film = Film::new(2, 1).unwrap();
        (samples[0]..samples[1]).for_each(|sample| film.pixel_mut(1, 0).add([0.1 * sample as f32; 3]));
        let described = Described { samples: vec![samples], rays: [3, 4], ..Described::default() };
        let cost =
            Cost { ranks: 1, threads: 2, samples: samples[1] - samples[0], seconds, load_seconds: 0.5, peak_bytes: 7 };
        Done { checkpoint: Checkpoint { described, film }, cost }
    }

    #[test]
    fn samples_travel_and_are_joined() {
        let mut whole = done([0, 3], 1.0);
        let bytes = done([3, 7], 2.0).to_bytes();
        whole.join(Done::from_bytes(&bytes).unwrap()).unwrap();
        assert_eq!(whole.checkpoint.film, done([0, 7], 0.0).checkpoint.film);
        assert_eq!(whole.checkpoint.described.rays, [6, 8]);
        let Cost { ranks, threads, samples, seconds, load_seconds, peak_bytes } = whole.cost;
        assert_eq!((ranks, threads, samples, peak_bytes), (2, 4, 7, 7));
        assert_eq!((seconds, load_seconds), (2.0, 0.5));
        assert!(whole.join(done([5, 9], 0.0)).unwrap_err().contains("samples 5 to 7 are in both"));
        for length in [0, 3, 10, bytes.len() - 1] {
            assert!(Done::from_bytes(&bytes[..length]).is_err(), "{length}");
        }
    }
}
