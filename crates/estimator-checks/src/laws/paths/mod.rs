//! The laws of the traits of `vpl-gi`: `PathTechniques`, `PathHeuristic`, `ConnectionTests` and `CausticMap`.
//!
//! What an estimator shows to a heuristic is looked at by a [`CheckedHeuristic`] in that heuristic's place:
//!
//! ```
//! use estimator_checks::laws::paths::CheckedHeuristic;
//! use qmc_sampling::{Independent, SamplerFamily};
//! use scene_core::{ReferenceScene, RussianRoulette, Scene, Sensor, UniformChoice, builtin};
//! use vpl_gi::{Bidirectional, Classical, LightPaths, LightTracing, TechniqueSet};
//!
//! let scene = ReferenceScene::new(builtin::furnace_box(0.5, 1.0))?;
//! let (choice, roulette) = (UniformChoice::new(scene.emitters().len()), RussianRoulette::Never);
//! let estimator = Bidirectional {
//!     heuristic: CheckedHeuristic::new(Classical(mis_heuristics::Balance)),
//!     techniques: TechniqueSet::WithoutLens,
//!     tracing: LightTracing { choice, max_length: u32::MAX, roulette },
//!     max_depth: 4,
//!     roulette,
//! };
//! let (mut lights, samplers) = (LightPaths::new(&scene), Independent::new(1));
//! estimator.trace_light_paths(&scene, &mut lights, 1, |_| samplers.sampler(1, 0));
//! let ray = scene.sensor().sample_ray([10.0, 10.0], [0.5; 2]).ray;
//! estimator.radiance(&scene, &lights, ray, &mut samplers.sampler(0, 0), &mut ());
//! estimator.heuristic.outcome("balance in the furnace").expect_pass();
//! # Ok::<(), scene_core::SceneError>(())
//! ```

mod caustics;
mod connections;
mod heuristic;
mod random_path;
mod techniques;

pub use caustics::{CausticLaws, WithoutDeltas, caustic_by_brute_force};
pub use connections::check_connection_tests;
pub use heuristic::{CheckedHeuristic, check_path_heuristic};
pub use techniques::{check_path, check_same_path};
