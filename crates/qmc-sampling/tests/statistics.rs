//! Statistical tests, over independent randomisations: means are unbiased, variances fall as they should.
use estimator_checks::{ChiSquare, Hemisphere, Sphere, Suite, Truth, randomised_mean_is, slope_is};
use qmc_sampling::sampler::{FromSequence, GlobalHalton, GlobalSobol, PaddedLattice, ZSobol};
use qmc_sampling::sequences::{
    CranleyPatterson, DigitScramble, Faure, Halton, Lattice, MultiJittered, Random, Stratified, VanDerCorput,
};
use qmc_sampling::sobol::{Randomisation, Sobol};
use qmc_sampling::{Independent, OwenSobol, Replications, Sampler, SamplerFamily, Sequence, warp};

static SUITE: Suite = Suite::with_share("qmc-sampling", 64, 1e-7);

/// Integrands over the unit cube, with their integrals.
type Integrand = (&'static str, fn([f64; 3]) -> f64, f64);

const INTEGRANDS: [Integrand; 3] = [
    ("smooth", |[x, y, z]| (x + 0.5) * (y + 0.5) * 3.0 * z * z, 1.0),
    // a quarter of a disk, with weight 2 z
    ("discontinuous", |[x, y, z]| if x * x + y * y < 1.0 { 2.0 * z } else { 0.0 }, core::f64::consts::FRAC_PI_4),
    // x^(-1/4), regular at the ends of the floats
    ("singular", |[x, y, z]| 0.75 * x.max(1e-12).powf(-0.25) * (y + z), 1.0),
];

/// The mean over 64 paths of one stream; the third number comes from a fork.
fn mean_over_paths(family: &impl SamplerFamily, f: fn([f64; 3]) -> f64) -> f64 {
    let paths = (0..64).map(|index| {
        let mut sampler = family.sampler(5, index);
        let [x, y] = sampler.next_2d().map(f64::from);
        f([x, y, f64::from(sampler.fork(1).next_1d())])
    });
    paths.sum::<f64>() / 64.0
}

fn mean_over_points(sequence: impl Sequence, n: u64, f: fn([f64; 3]) -> f64) -> f64 {
    (0..n).map(|i| f([0, 1, 2].map(|d| sequence.sample(i, d)))).sum::<f64>() / n as f64
}

#[test]
fn sampler_families_are_unbiased() {
    for (integrand, f, integral) in INTEGRANDS {
        let check = |family: &str, estimate: &dyn Fn(u64) -> f64| {
            // numbers are multiples of 2^-24, rounded down
            let truth = Truth { value: integral, error: 1e-6 };
            let check = SUITE.check(&format!("{family}, {integrand} integrand"));
            randomised_mean_is(check, 2000, truth, estimate).expect_pass();
        };
        check("independent", &|seed| mean_over_paths(&Independent::new(seed), f));
        check("owen-sobol", &|seed| mean_over_paths(&OwenSobol::new(seed), f));
        check("global sobol", &|seed| mean_over_paths(&GlobalSobol::new(8, 8, seed).unwrap(), f));
        check("global halton", &|seed| mean_over_paths(&GlobalHalton::new(8, 8, seed).unwrap(), f));
        check("z-sobol", &|seed| mean_over_paths(&ZSobol::new(8, 8, 64, seed).unwrap(), f));
        check("lattice", &|seed| mean_over_paths(&PaddedLattice::new(seed), f));
        check("shifted halton", &|seed| mean_over_paths(&FromSequence::new(Halton::default(), seed), f));
    }
}

#[test]
fn randomised_sequences_are_unbiased() {
    for (integrand, f, integral) in INTEGRANDS {
        let check = |sequence: &str, estimate: &dyn Fn(u64) -> f64| {
            let check = SUITE.check(&format!("{sequence}, {integrand} integrand"));
            randomised_mean_is(check, 1000, integral, estimate).expect_pass();
        };
        let sobol = |randomisation| mean_over_points(Sobol::new(randomisation), 64, f);
        check("sobol, digit shift", &|seed| sobol(Randomisation::DigitShift(seed)));
        check("sobol, owen", &|seed| sobol(Randomisation::Owen(seed)));
        check("sobol, nested uniform", &|seed| sobol(Randomisation::NestedUniform(seed)));
        check("halton, owen", &|seed| mean_over_points(Halton::new(DigitScramble::Owen(seed)), 60, f));
        check("halton, permuted", &|seed| mean_over_points(Halton::new(DigitScramble::Permuted(seed)), 60, f));
        check("faure, owen", &|seed| {
            mean_over_points(Faure::new(3).unwrap().scrambled(DigitScramble::Owen(seed)), 81, f)
        });
        check("lattice, shifted", &|seed| mean_over_points(Lattice::default().shifted(seed), 64, f));
        check("halton, rotated", &|seed| mean_over_points(CranleyPatterson::new(Halton::default(), seed), 60, f));
        check("jittered", &|seed| mean_over_points(Stratified::jittered(8, 8, seed).unwrap(), 64, f));
        check("multi-jittered", &|seed| mean_over_points(MultiJittered::new(8, 8, seed).unwrap(), 64, f));
        check("random", &|seed| mean_over_points(Random::new(seed), 64, f));
    }
}

/// Without randomisation the points at the origin make every mean too small.
#[test]
fn planted_bug_plain_points_are_biased() {
    let (_, f, integral) = INTEGRANDS[0];
    randomised_mean_is(SUITE.twin("plain sobol"), 100, integral, |_| mean_over_points(Sobol::default(), 64, f))
        .expect_reject();
    let forgotten = |seed| mean_over_points(VanDerCorputDiagonal(seed), 64, f);
    randomised_mean_is(SUITE.twin("one dimension used three times"), 1000, integral, forgotten).expect_reject();
}

#[derive(Clone, Copy)]
struct VanDerCorputDiagonal(u64);

impl Sequence for VanDerCorputDiagonal {
    fn dimensions(&self) -> u32 {
        3
    }

    fn sample(&self, index: u64, _: u32) -> f64 {
        VanDerCorput::new(2).expect("a base").scrambled(DigitScramble::Owen(self.0)).sample(index, 0)
    }
}

#[test]
fn warps_follow_their_densities() {
    let hemisphere = || ChiSquare::on(Hemisphere).samples(200_000);
    let run = |name: &str, sample: &dyn Fn([f64; 2]) -> [f64; 3], pdf: &dyn Fn([f64; 3]) -> f64| {
        hemisphere().run(SUITE.check(name), |[u, v, _]| Some(sample([u, v])), pdf).expect_pass();
    };
    run("uniform hemisphere", &warp::sample_uniform_hemisphere, &warp::pdf_uniform_hemisphere);
    run("cosine hemisphere", &warp::sample_cosine_hemisphere, &warp::pdf_cosine_hemisphere);
    run("power cosine hemisphere", &|u| warp::sample_power_cosine_hemisphere(u, 5.0), &|w| {
        warp::pdf_power_cosine_hemisphere(w, 5.0)
    });
    let sphere = ChiSquare::on(Sphere).samples(200_000);
    let sample = |[u, v, _]: [f64; 3]| Some(warp::sample_uniform_sphere([u, v]));
    sphere.run(SUITE.check("uniform sphere"), sample, |_| warp::pdf_uniform_sphere()).expect_pass();
    let forgotten = |[u, v, _]: [f64; 3]| Some(warp::sample_cosine_hemisphere([u, v]));
    hemisphere().run(SUITE.twin("cosine forgotten"), forgotten, warp::pdf_uniform_hemisphere).expect_reject();
}

/// Numbers of points and variances of means over that many.
fn variances(seed: u64, estimate: impl Fn(u64, u64) -> f64) -> Vec<(f64, f64)> {
    (3..=10)
        .map(|m| {
            let n = 1_u64 << m;
            let result = Replications::run(300, seed ^ n, |seed| estimate(seed, n));
            (n as f64, result.variance())
        })
        .collect()
}

/// In two dimensions the variance of a scrambled net is `n^-3 log n` on smooth integrands: -3 less a little.
#[test]
fn variances_fall_as_they_should() {
    let smooth: fn([f64; 3]) -> f64 = |[x, y, _]| (x + y).exp();
    let sobol = |randomisation: fn(u64) -> Randomisation| {
        move |seed, n| mean_over_points(Sobol::new(randomisation(seed)), n, smooth)
    };
    let about = |slope| Truth { value: slope, error: 0.25 };
    let owen = variances(1, sobol(Randomisation::Owen));
    slope_is(SUITE.check("slope of scrambled sobol"), &owen, about(-3.0)).expect_pass();
    let exact = variances(2, sobol(Randomisation::NestedUniform));
    slope_is(SUITE.check("slope of exactly scrambled sobol"), &exact, about(-3.0)).expect_pass();
    let shifted = variances(3, sobol(Randomisation::DigitShift));
    slope_is(SUITE.check("slope of shifted sobol"), &shifted, about(-2.0)).expect_pass();
    let random = variances(4, |seed, n| mean_over_points(Random::new(seed), n, smooth));
    slope_is(SUITE.check("slope of random points"), &random, -1.0).expect_pass();
    slope_is(SUITE.twin("random points are no net"), &random, about(-3.0)).expect_reject();
    slope_is(SUITE.twin("shifting is not scrambling"), &shifted, about(-3.0)).expect_reject();
    // The padded sampler, in single precision
    let padded = variances(5, |seed, n| {
        let paths = (0..n).map(|index| {
            let [x, y] = OwenSobol::new(seed).sampler(0, index).next_2d();
            smooth([f64::from(x), f64::from(y), 0.0])
        });
        paths.sum::<f64>() / n as f64
    });
    slope_is(SUITE.check("slope of the padded sampler"), &padded, about(-3.0)).expect_pass();
    for ((n, hashed), (_, exact)) in owen.iter().zip(&exact) {
        println!("{n:6} points: variance {hashed:.3e} hashed, {exact:.3e} exact");
    }
}
