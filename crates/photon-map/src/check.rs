//! Tests the laws of [`Deposition`] and [`Flux`] on anybody's implementation. No chance is involved: a counterexample
//! is a proof.
//!
//! ```
//! use photon_map::check::{check_deposition, check_flux, check_positive};
//! let near_the_eye = |x: [f32; 3], _wi: [f32; 3]| if x[0] < 1.0 { 1.0 } else { 0.25 };
//! let places = [([0.0; 3], [0.0, 0.0, 1.0]), ([7.0, 0.0, 1.0], [0.6, 0.0, 0.8])];
//! check_deposition(&near_the_eye, places)?;
//! check_positive(&near_the_eye, places)?; // unbiased
//!
//! let far_from_it = |x: [f32; 3], _wi: [f32; 3]| f64::from(x[0]);
//! assert!(check_deposition(&far_from_it, places).is_err()); // 7 is no probability
//!
//! check_flux(&[[1.0_f32, 0.5, 0.0], [3.0, 2.0, 1e-3]], |flux| flux.map(f64::from), 1e-6)?;
//! # Ok::<(), photon_map::check::Violation>(())
//! ```

pub use range_search::check::Violation;
use range_search::check::hold;

use crate::deposition::LEAST;
use crate::{Deposition, Flux};

/// Where a photon arrives, and where it came from.
pub type Place = ([f32; 3], [f32; 3]);

/// Places at which rules have broken: on the axes, at the origin with both of its signs, huge, tiny and subnormal.
pub fn places() -> Vec<Place> {
    let axes = (0..6).map(|i| {
        let mut direction = [0.0; 3];
        direction[i / 2] = if i % 2 == 0 { 1.0 } else { -1.0 };
        direction
    });
    let directions: Vec<[f32; 3]> = axes.chain([[0.6, -0.48, 0.64]]).collect();
    let positions = [0.0, -0.0, 1.0, -1e-3, 1e18, -1e30, 1e-30, 1e-42, f32::MAX];
    let positions = positions.into_iter().flat_map(|x| [[x; 3], [x, 0.25, -0.5]]);
    positions.flat_map(|position| directions.iter().map(move |&direction| (position, direction))).collect()
}

/// Places that are none: nothing is asked of an answer but that it is one and does not change.
fn nonsense() -> impl Iterator<Item = Place> {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let up = [0.0, 0.0, 1.0];
    let directions = bad.into_iter().chain([0.0]).map(|x| ([0.0; 3], [x; 3]));
    bad.into_iter().map(move |x| ([x, 0.0, 1.0], up)).chain(directions)
}

/// Checks the laws of a deposition at some places, those of [`places`] among them.
///
/// ```text
/// (1)  0 <= p(x, wi) <= 1      for finite x and directions wi; NaN is none
/// (2)  p(x, wi) is a function: the same when asked again, after other places, in another order
/// ```
///
/// Places that are not finite get no panic, and the same answer again. Whether the deposition is unbiased is another
/// question: [`check_positive`].
///
/// **Cost.** Two questions for each place.
///
/// # Errors
/// The first law that is broken.
pub fn check_deposition(deposition: &impl Deposition, own: impl IntoIterator<Item = Place>) -> Result<(), Violation> {
    let mut asked: Vec<Place> = own.into_iter().chain(places()).collect();
    let finite = asked.len();
    asked.extend(nonsense());
    let ask = |(position, wi): &Place| deposition.probability(*position, *wi);
    let answers: Vec<f64> = asked.iter().map(ask).collect();
    for (place, answer) in asked.iter().zip(&answers).take(finite) {
        let shown = || format!("p = {answer} at {place:?}");
        hold("a probability lies in [0, 1]", (0.0..=1.0).contains(answer), shown)?;
    }
    for (place, first) in asked.iter().zip(&answers).rev() {
        let again = ask(place);
        let shown = || format!("p = {first} at {place:?}, and {again} the second time");
        // All NaNs are one answer.
        let same = first.to_bits() == again.to_bits() || first.is_nan() && again.is_nan();
        hold("the same place and direction give the same answer", same, shown)?;
    }
    Ok(())
}

/// Checks that a deposition is unbiased at some places, those of [`places`] among them: that photons have a chance there.
///
/// ```text
/// p(x, wi) >= 2^-53        the least that random numbers can decide; what is below counts as zero
/// ```
///
/// A rule with a cutoff is rejected where it cuts off; so is a floor that is forgotten, or too low.
///
/// **Cost.** A question for each place.
///
/// # Errors
/// The first place at which light is lost.
pub fn check_positive(deposition: &impl Deposition, own: impl IntoIterator<Item = Place>) -> Result<(), Violation> {
    for (position, wi) in own.into_iter().chain(places()) {
        let p = deposition.probability(position, wi);
        let shown = || format!("p = {p:e} at {position:?} from {wi:?}");
        // NaN counts as one.
        hold("photons are kept everywhere with a probability of at least 2^-53", p >= LEAST || p.is_nan(), shown)?;
    }
    Ok(())
}

/// Factors that flux is scaled by: powers of two and others, down to a photon's share and up to the worth of a rare one.
const FACTORS: [f64; 8] = [0.0, 1.0, 2.0, 0.5, 3.7, 1e-6, 1e4, 1.0 / 3.0];

/// Checks the laws of a flux on samples, which had better differ in all components.
///
/// ```text
/// (1)  c(ZERO) = 0
/// (2)  c(a + b) = c(a) + c(b)
/// (3)  c(a scale k) = k c(a),      a scale 1 is a, bit for bit
/// (4)  a.is_finite()  <=>  all c(a) are finite
/// ```
///
/// **Symbols.** `c`: `components`, the amounts that a flux carries, as numbers. Since numbers add up and multiply as the
/// laws of [`Flux`] ask for, so does a flux that does to its components what it should.
///
/// (2) and (3) hold within `round_off` times the largest component that takes part: 1e-6 for `f32`. (4) is asked of the
/// samples, which may be infinite or NaN, of their sums, and of samples times numbers that are too large or none.
///
/// **Cost.** The square of the number of samples.
///
/// # Errors
/// The first law that is broken.
pub fn check_flux<F: Flux, C: AsRef<[f64]>>(
    samples: &[F],
    components: impl Fn(F) -> C,
    round_off: f64,
) -> Result<(), Violation> {
    let amounts = |flux: F| components(flux).as_ref().to_vec();
    let zero = amounts(F::ZERO);
    hold("ZERO is nothing", zero.iter().all(|&c| c == 0.0), || format!("{zero:?}"))?;
    check_finite(F::ZERO, &zero)?;
    for &a in samples {
        let of_a = amounts(a);
        check_finite(a, &of_a)?;
        check_scale(a, &of_a, amounts, round_off)?;
        for &b in samples.iter().chain([&F::ZERO]) {
            let of_b = amounts(b);
            let expected: Vec<f64> = of_a.iter().zip(&of_b).map(|(a, b)| a + b).collect();
            for (sum, order) in [(a.add(b), "a + b"), (b.add(a), "b + a")] {
                let of_sum = amounts(sum);
                check_finite(sum, &of_sum)?;
                let near = is_near(&of_sum, &expected, round_off * largest(&of_a).max(largest(&of_b)));
                hold("add adds all components", near, || format!("{order} = {of_sum:?}, a = {of_a:?}, b = {of_b:?}"))?;
            }
        }
    }
    Ok(())
}

fn check_scale<F: Flux>(a: F, of_a: &[f64], amounts: impl Fn(F) -> Vec<f64>, round_off: f64) -> Result<(), Violation> {
    let one = amounts(a.scale(1.0));
    let same = one.iter().zip(of_a).all(|(x, y)| x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan());
    hold("scale(1) changes no bit", same && one.len() == of_a.len(), || format!("{of_a:?} became {one:?}"))?;
    for factor in FACTORS {
        let scaled = amounts(a.scale(factor));
        let expected: Vec<f64> = of_a.iter().map(|c| factor * c).collect();
        let near = is_near(&scaled, &expected, round_off * largest(&expected));
        hold("scale multiplies all components", near, || format!("{of_a:?} times {factor} = {scaled:?}"))?;
    }
    // The last one is too much for the largest component alone, if that is an f32.
    for factor in [f64::INFINITY, f64::NAN, 2.0 * f64::from(f32::MAX) / largest(of_a)] {
        let scaled = a.scale(factor);
        check_finite(scaled, &amounts(scaled))?;
    }
    Ok(())
}

fn check_finite<F: Flux>(flux: F, amounts: &[f64]) -> Result<(), Violation> {
    let finite = amounts.iter().all(|c| c.is_finite());
    let shown = || format!("is_finite is {} for {amounts:?}", !finite);
    hold("a flux is finite if all components are, and only then", flux.is_finite() == finite, shown)
}

/// The largest magnitude; NaN is none.
fn largest(amounts: &[f64]) -> f64 {
    amounts.iter().fold(0.0, |largest, c| largest.max(c.abs()))
}

/// Whether numbers are as near as that, where they are finite.
fn is_near(found: &[f64], expected: &[f64], distance: f64) -> bool {
    let near = |(x, y): (&f64, &f64)| !y.is_finite() || !distance.is_finite() || (x - y).abs() <= distance;
    found.len() == expected.len() && found.iter().zip(expected).all(near)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::{
        Bound, DensityEstimation, DepositionExt, Gather, ImportanceMap, ImportanceScale, ImportonDeposition, KeepAll,
        Kernel, Photon, PhotonMap, Photons,
    };

    const UP: [f32; 3] = [0.0, 0.0, 1.0];

    fn own() -> impl Iterator<Item = Place> + Clone {
        (0..40).map(|i| ([i as f32 * 0.05 - 1.0, 0.3, 0.0], UP))
    }

    fn importance() -> ImportanceMap {
        let mut importons = Photons::new();
        (0..20).for_each(|i| importons.store(Photon::new([i as f32 * 0.05, 0.3, 0.0], UP, 1.0)));
        importons.add_paths(20);
        let estimation = DensityEstimation { gather: Gather::within(0.2).unwrap(), kernel: Kernel::CONE };
        ImportanceMap::new(PhotonMap::build(importons, 0.2).unwrap(), estimation)
    }

    #[test]
    fn the_depositions_of_this_crate_keep_the_laws() {
        let importance = importance();
        let scale = ImportanceScale::new(0.2).unwrap();
        let by_importance = |bound| ImportonDeposition::new(&importance, scale, bound).unwrap();
        let (floor, cutoff) = (by_importance(Bound::Floor(0.01)), by_importance(Bound::Cutoff(0.5)));
        check_deposition(&KeepAll, own()).unwrap();
        check_deposition(&floor, own()).unwrap();
        check_deposition(&cutoff, own()).unwrap();
        let facing = |photon: [f32; 3], importon: [f32; 3]| f64::from(photon[2] * importon[2]).max(0.0);
        let directed = ImportonDeposition::with_directions(&importance, scale, Bound::Floor(0.1), facing).unwrap();
        check_deposition(&directed.and(floor), own()).unwrap();

        check_positive(&KeepAll, own()).unwrap();
        check_positive(&directed.and(floor), own()).unwrap();
        check_positive(&cutoff, own()).unwrap_err();
    }

    fn broken(deposition: &impl Deposition) -> &'static str {
        check_deposition(deposition, own()).unwrap_err().law
    }

    #[test]
    fn depositions_that_lie_are_rejected() {
        let range = "a probability lies in [0, 1]";
        assert_eq!(broken(&|x: [f32; 3], _: [f32; 3]| 0.5 + f64::from(x[0].clamp(0.0, 1.0))), range);
        assert_eq!(broken(&|x: [f32; 3], _: [f32; 3]| f64::from(x[0].clamp(-1.0, 1.0))), range);
        // A share of the distance from the eye, which is at the origin.
        let share = |x: [f32; 3], _: [f32; 3]| f64::from(x[0].abs()) / f64::from(x.map(f32::abs).iter().sum::<f32>());
        assert_eq!(broken(&share), range);
        // A number of its own, and the number of the question.
        let same = "the same place and direction give the same answer";
        let (state, count) = (Cell::new(0.5_f64), Cell::new(0_u32));
        let dice = |_: [f32; 3], _: [f32; 3]| {
            state.set((state.get() * 997.0 + 0.1).fract());
            state.get()
        };
        assert_eq!(broken(&dice), same);
        let thins_out = |_: [f32; 3], _: [f32; 3]| {
            count.set(count.get() + 1);
            if count.get() < 100 { 1.0 } else { 0.5 }
        };
        assert_eq!(broken(&thins_out), same);
    }

    #[test]
    fn depositions_that_lose_light_are_rejected() {
        check_positive(&|x: [f32; 3], _: [f32; 3]| if x[0] < 0.5 { 1.0 } else { 0.0 }, own()).unwrap_err();
        check_positive(&|_: [f32; 3], wi: [f32; 3]| f64::from(wi[2].max(0.0)), own()).unwrap_err();
        check_positive(&|_: [f32; 3], _: [f32; 3]| 1e-17, own()).unwrap_err();
        check_positive(&|_: [f32; 3], _: [f32; 3]| -0.5, own()).unwrap_err();
    }

    const RGB: [[f32; 3]; 5] =
        [[1.0, 0.5, 0.25], [0.0, 3e4, 1e-5], [7.1, 0.3, 0.9], [1.0, f32::NAN, 0.0], [0.0, 0.0, f32::INFINITY]];

    #[test]
    fn the_fluxes_of_this_crate_keep_the_laws() {
        check_flux(&RGB, |flux| flux.map(f64::from), 1e-6).unwrap();
        check_flux(&[1.0_f32, 0.3, 1e20, f32::NAN], |flux| [f64::from(flux)], 1e-6).unwrap();
        check_flux(&[1.0_f64, 0.3, 1e200, f64::INFINITY], |flux| [flux], 1e-15).unwrap();
    }

    /// The kinds of fluxes that lie.
    const ZERO_IS_NOT: u8 = 1;
    const FORGETS_TO_ADD: u8 = 2;
    const ADDS_ONE_WAY: u8 = 3;
    const SATURATES: u8 = 4;
    const FORGETS_TO_SCALE: u8 = 5;
    const DOES_NOT_SCALE: u8 = 6;
    const ROUNDS: u8 = 7;
    const ALWAYS_FINITE: u8 = 8;
    const LOOKS_AT_THE_FIRST: u8 = 9;
    const NEVER_FINITE: u8 = 10;

    #[derive(Clone, Copy)]
    struct Liar<const KIND: u8>([f32; 3]);

    impl<const KIND: u8> Flux for Liar<KIND> {
        const ZERO: Self = Self([0.0, 0.0, if KIND == ZERO_IS_NOT { 1e-10 } else { 0.0 }]);

        fn add(self, other: Self) -> Self {
            let mut sum = Flux::add(self.0, other.0);
            match KIND {
                FORGETS_TO_ADD => sum[2] = self.0[2],
                ADDS_ONE_WAY => sum[1] = self.0[1] + other.0[1] * 1.001,
                SATURATES => sum = sum.map(|c| c.min(1e3)),
                _ => {}
            }
            Self(sum)
        }

        fn scale(self, factor: f64) -> Self {
            let mut scaled = self.0.scale(factor);
            match KIND {
                FORGETS_TO_SCALE => scaled[1] = self.0[1],
                DOES_NOT_SCALE => scaled = self.0,
                ROUNDS => scaled = scaled.map(|c| f32::from_bits(c.to_bits() & !1)),
                _ => {}
            }
            Self(scaled)
        }

        fn is_finite(self) -> bool {
            match KIND {
                ALWAYS_FINITE => true,
                LOOKS_AT_THE_FIRST => self.0[0].is_finite(),
                NEVER_FINITE => false,
                _ => Flux::is_finite(self.0),
            }
        }
    }

    fn law_of<const KIND: u8>() -> &'static str {
        let samples = RGB.map(Liar::<KIND>);
        check_flux(&samples, |flux| flux.0.map(f64::from), 1e-6).err().map_or("", |violation| violation.law)
    }

    #[test]
    fn fluxes_that_lie_are_rejected() {
        assert_eq!(law_of::<0>(), "");
        assert_eq!(law_of::<ZERO_IS_NOT>(), "ZERO is nothing");
        let add = "add adds all components";
        assert_eq!([law_of::<FORGETS_TO_ADD>(), law_of::<ADDS_ONE_WAY>(), law_of::<SATURATES>()], [add; 3]);
        let scale = "scale multiplies all components";
        assert_eq!([law_of::<FORGETS_TO_SCALE>(), law_of::<DOES_NOT_SCALE>()], [scale; 2]);
        assert_eq!(law_of::<ROUNDS>(), "scale(1) changes no bit");
        let finite = "a flux is finite if all components are, and only then";
        assert_eq!([law_of::<ALWAYS_FINITE>(), law_of::<LOOKS_AT_THE_FIRST>(), law_of::<NEVER_FINITE>()], [finite; 3]);
    }
}
