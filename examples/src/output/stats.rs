//! What a render did, for scripts.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{OutputError, write_atomically};

/// What `--stats FILE.json` holds, under these very keys, so that scripts never parse what is printed for people: the settings that
/// the image has among its attributes, and what the rendering took.
///
/// ```
/// use lichtwerk::output::RenderStats;
///
/// let stats = RenderStats { scene: "cornell-box".into(), width: 320, height: 240, ..RenderStats::default() };
/// let json = serde_json::to_string(&stats)?;
/// assert!(json.contains(r#""closest_hit_rays":0"#));
/// assert_eq!(serde_json::from_str::<RenderStats>(&json)?, stats);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RenderStats {
    /// Name or file of the scene.
    pub scene: String,
    /// Name of the estimator.
    pub estimator: String,
    /// How next event estimation and scattering are combined.
    pub heuristic: String,
    /// How the emitter is chosen.
    pub lights: String,
    /// Where the random numbers come from.
    pub sampler: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Segments per path; -1 is unlimited.
    pub max_depth: i64,
    /// The path space filter with its settings; nothing without one.
    pub path_filter: Option<String>,
    /// What else the image has among its attributes: settings that only some estimators have, by name.
    pub details: BTreeMap<String, String>,
    /// Name and version of the program.
    pub renderer: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples per pixel.
    pub spp: u64,
    /// Number of processes that rendered.
    pub ranks: usize,
    /// Number of threads that rendered, in all processes.
    pub threads: usize,
    /// Wall time to load and build the scene, in seconds; of several processes, that of the slowest.
    pub load_seconds: f64,
    /// Wall time to render, in seconds; of several processes, that of the slowest.
    pub render_seconds: f64,
    /// Paths from the sensor and from emitters.
    pub paths: u64,
    /// Rays that asked for the closest hit.
    pub closest_hit_rays: u64,
    /// Rays that asked whether two points see each other.
    pub visibility_rays: u64,
    /// The most memory that a process had resident, in bytes; 0 where the system does not tell.
    pub peak_bytes: u64,
    /// Photons and importons that several processes traced together, in bytes: each process has them all.
    pub gathered_bytes: u64,
    /// Images that the first of several processes received, in bytes.
    pub received_bytes: u64,
}

/// The most memory that this process had resident so far, in bytes. Zero where the system does not tell: it is read
/// from `VmHWM` in `/proc/self/status`.
pub fn peak_bytes() -> u64 {
    std::fs::read_to_string("/proc/self/status").map_or(0, |status| high_water_mark(&status))
}

fn high_water_mark(status: &str) -> u64 {
    let kibibytes = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .and_then(|value| value.trim().strip_suffix("kB"))
        .and_then(|number| number.trim().parse::<u64>().ok());
    kibibytes.map_or(0, |kibibytes| kibibytes.saturating_mul(1024))
}

/// Writes anything as indented JSON, [atomically](write_atomically).
///
/// # Errors
/// [`OutputError`], which names the file. Numbers that are not finite become `null`.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), OutputError> {
    let mut json = serde_json::to_string_pretty(value).map_err(|error| OutputError::encode(path, error))?;
    json.push('\n');
    write_atomically(path, |file| file.write_all(json.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_are_the_documented_ones() {
        let json = serde_json::to_value(RenderStats::default()).unwrap();
        let mut keys: Vec<_> = json.as_object().unwrap().keys().cloned().collect();
        let mut documented = [
            "scene",
            "estimator",
            "heuristic",
            "lights",
            "sampler",
            "seed",
            "max_depth",
            "path_filter",
            "details",
            "renderer",
            "width",
            "height",
            "spp",
            "ranks",
            "threads",
            "load_seconds",
            "render_seconds",
            "paths",
            "closest_hit_rays",
            "visibility_rays",
            "peak_bytes",
            "gathered_bytes",
            "received_bytes",
        ];
        keys.sort();
        documented.sort();
        assert_eq!(keys, documented);
    }

    #[test]
    fn the_high_water_mark_is_parsed() {
        assert_eq!(high_water_mark("VmPeak:\t  10 kB\nVmHWM:\t   123 kB\nVmRSS:\t 7 kB\n"), 123 * 1024);
        for nonsense in ["", "VmHWM:", "VmHWM:\t-1 kB", "VmHWM: 5 MB"] {
            assert_eq!(high_water_mark(nonsense), 0);
        }
        assert!(!cfg!(target_os = "linux") || peak_bytes() > 100_000);
    }
}
