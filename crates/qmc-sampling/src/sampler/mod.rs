//! What a path consumes.
mod independent;
mod owen_sobol;

pub use independent::{Independent, IndependentSampler};
pub use owen_sobol::{OwenSobol, OwenSobolSampler};

/// What one path consumes. All numbers lie in `[0, 1)`, never 1.
///
/// Small and passed by value; cloning it replays the numbers.
///
/// # Laws
/// - Two samplers made alike hand out the same numbers.
/// - [`fork`](Sampler::fork) depends on what the sampler is and on `domain`, not on how many numbers were taken from it.
pub trait Sampler: Clone {
    /// The next number.
    fn next_1d(&mut self) -> f32;

    /// The next two numbers, stratified together where the sampler can.
    fn next_2d(&mut self) -> [f32; 2];

    /// A decorrelated sub-stream: one per bounce, per light, per lens.
    ///
    /// Streams of different domains, and the stream they were forked from, are independent; the same domain of the same
    /// sampler gives the same stream again.
    #[must_use]
    fn fork(&self, domain: u32) -> Self;
}

/// Hands out the sampler of path number `index` (0, 1, ..) of stream `stream` (a pixel, a light-path stream, ..).
/// Shared between threads by reference.
///
/// # Laws
/// - The samplers of one stream are stratified against each other over consecutive indices, where the family can.
/// - The samplers of different streams are independent, unless the family says how they are related.
pub trait SamplerFamily: Sync {
    /// What it hands out.
    type Sampler: Sampler;

    /// The sampler of path `index` of stream `stream`.
    fn sampler(&self, stream: u64, index: u64) -> Self::Sampler;
}
