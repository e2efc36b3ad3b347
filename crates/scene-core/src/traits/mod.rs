//! The renderer-neutral traits that estimators are written against.

mod emitter;
mod scene;
mod sensor;
mod spectrum;
mod vertex;

pub use emitter::{ChosenEmitter, DirectSample, EmissionSample, Emitter, EmitterChoice, EmitterId};
pub use scene::{Scene, Sharpness};
pub use sensor::{Sensor, SensorConnection, SensorRay};
pub use spectrum::{Rgb, Spectrum};
pub use vertex::{ScatterSample, TransportMode, Vertex};
