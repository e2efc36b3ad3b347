//! The laws of `path-space-filter`, on its own types and on types that break one law each.

use estimator_checks::Outcome;
use estimator_checks::laws::path_space::{
    check_attenuate, check_contribution, check_kernel, check_modulation, check_similarity,
};
use path_space_filter::{
    AsStored, Attenuate, Ball, Contribution, Demodulated, Epanechnikov, Gaussian, Kernel, Modulation, NormalCone,
    Poly6, Vertex,
};

use crate::broken;

const RGB: [[f32; 3]; 5] =
    [[1.0, 0.5, 0.25], [0.1, 3e4, 1e-5], [7.1, 0.3, 0.9], [1.0, f32::NAN, 0.0], [0.0, 0.0, f32::INFINITY]];

#[test]
fn contributions_keep_their_laws() {
    check_contribution("rgb", &RGB, |c| c.map(f64::from), 1e-6).expect_pass();
    check_contribution("f32", &[1.0_f32, 0.3, 1e20, f32::NAN], |c| [f64::from(c)], 1e-6).expect_pass();
    check_contribution("f64", &[[1.0_f64, 0.3], [1e200, f64::INFINITY]], |c| c, 1e-14).expect_pass();
    check_attenuate("rgb", &RGB[..3], |c| c.map(f64::from), 1e-6).expect_pass();
    check_attenuate("f32", &[1.0_f32, 0.3, 1e20], |c| [f64::from(c)], 1e-6).expect_pass();
}

const NARROW_SUM: u8 = 1;
const FORGETS_THE_WEIGHT: u8 = 2;
const COUNTS_NOTHING: u8 = 3;
const LOOKS_AT_THE_FIRST: u8 = 4;
const FORGETS_TO_MULTIPLY: u8 = 5;
const FORGETS_TO_ADD: u8 = 6;

#[derive(Clone, Copy)]
struct Liar<const KIND: u8>([f32; 3]);

impl<const KIND: u8> Contribution for Liar<KIND> {
    type Sum = [f64; 3];
    const NOTHING: [f64; 3] = [0.0; 3];
    fn add(self, weight: f32, sum: &mut [f64; 3]) {
        match KIND {
            FORGETS_THE_WEIGHT if weight > 0.0 => sum[2] += f64::from(self.0[2] * (1.0 - weight)),
            COUNTS_NOTHING if weight == 0.0 => sum[1] += 1e-3,
            _ => {}
        }
        self.0.add(weight, sum);
        if KIND == NARROW_SUM {
            *sum = sum.map(|x| f64::from(x as f32));
        }
    }
    fn mean(sum: &[f64; 3], weights: f64) -> Self {
        Self(Contribution::mean(sum, weights))
    }
    fn is_finite(self) -> bool {
        if KIND == LOOKS_AT_THE_FIRST { self.0[0].is_finite() } else { Contribution::is_finite(self.0) }
    }
}

impl<const KIND: u8> Attenuate for Liar<KIND> {
    fn times(self, factor: Self) -> Self {
        let mut product = self.0.times(factor.0);
        if KIND == FORGETS_TO_MULTIPLY {
            product[2] = self.0[2];
        }
        Self(product)
    }
    fn plus(self, other: Self) -> Self {
        let mut sum = self.0.plus(other.0);
        if KIND == FORGETS_TO_ADD {
            sum[0] = self.0[0];
        }
        Self(sum)
    }
}

#[test]
fn contributions_that_lie_are_rejected() {
    fn check<const KIND: u8>() -> Outcome {
        check_contribution("liar", &RGB.map(Liar::<KIND>), |c| c.0.map(f64::from), 1e-6)
    }
    check::<0>().expect_pass();
    assert_eq!(broken(check::<NARROW_SUM>()), "the mean of equal contributions is one of them, bit for bit");
    assert_eq!(broken(check::<FORGETS_THE_WEIGHT>()), "the mean is linear in contributions and weights");
    assert_eq!(broken(check::<COUNTS_NOTHING>()), "a contribution of weight zero changes nothing");
    let finite = "a contribution is finite if all components are, and only then";
    assert_eq!(broken(check::<LOOKS_AT_THE_FIRST>()), finite);

    fn attenuate<const KIND: u8>() -> Outcome {
        let samples = [RGB[0], RGB[1], RGB[2]].map(Liar::<KIND>);
        check_attenuate("liar", &samples, |c| c.0.map(f64::from), 1e-6)
    }
    attenuate::<0>().expect_pass();
    assert_eq!(broken(attenuate::<FORGETS_TO_MULTIPLY>()), "times multiplies all components");
    assert_eq!(broken(attenuate::<FORGETS_TO_ADD>()), "plus adds all components");
}

struct Of<F>(F);

impl<F: Fn(f32) -> f32> Kernel for Of<F> {
    fn weight(&self, t_squared: f32) -> f32 {
        (self.0)(t_squared)
    }
}

#[test]
fn kernels() {
    check_kernel("ball", &Ball).expect_pass();
    check_kernel("Epanechnikov", &Epanechnikov).expect_pass();
    check_kernel("poly6", &Poly6).expect_pass();
    check_kernel("Gaussian", &Gaussian).expect_pass();
    assert_eq!(broken(check_kernel("half", &Of(|_| 0.5))), "the weight in the centre is one");
    let range = "the weight is finite and not negative";
    assert_eq!(broken(check_kernel("beyond", &Of(|t| 1.0 - t))), range);
    assert_eq!(broken(check_kernel("root", &Of(|t: f32| (1.0 - t).sqrt()))), range);
    let count = std::cell::Cell::new(0.0);
    let counting = |t: f32| {
        count.set(count.get() + 1.0);
        if t == 0.0 { 1.0 } else { 1.0 / count.get() }
    };
    assert_eq!(broken(check_kernel("counting", &Of(counting))), "the same distance gives the same weight");
}

/// Multiplies by what it divided by, but for a floor that it knows at one end only.
struct Forgetful;

impl Modulation<Vertex<[f32; 3]>> for Forgetful {
    fn demodulate(&self, vertex: &Vertex<[f32; 3]>) -> [f32; 3] {
        [0, 1, 2].map(|i| vertex.contribution[i] / vertex.albedo[i].max(0.1))
    }
    fn remodulate(&self, vertex: &Vertex<[f32; 3]>, mean: [f32; 3]) -> [f32; 3] {
        [0, 1, 2].map(|i| mean[i] * vertex.albedo[i])
    }
}

#[test]
fn modulations_and_similarities() {
    let vertex =
        |albedo: [f32; 3], normal| Vertex { albedo, normal, contribution: [0.3, 2.0, 0.0], ..Vertex::default() };
    let vertices = [vertex([0.5, 0.2, 1.0], [0.0, 0.0, 1.0]), vertex([0.0, 0.05, 0.7], [0.0, 1.0, 0.0])];
    check_modulation("stored", &AsStored, &vertices, |c| c.map(f64::from), 1e-6).expect_pass();
    check_modulation("albedo", &Demodulated::default(), &vertices, |c| c.map(f64::from), 1e-6).expect_pass();
    let law = broken(check_modulation("forgetful", &Forgetful, &vertices, |c| c.map(f64::from), 1e-6));
    assert_eq!(law, "what is demodulated and remodulated is the contribution");

    Outcome::of_laws("cone", check_similarity(&NormalCone::PAPER, &vertices)).expect_pass();
    let none = |_: &Vertex<[f32; 3]>, _: &Vertex<[f32; 3]>| 0.0;
    let law = broken(Outcome::of_laws("nothing is similar", check_similarity(&none, &vertices)));
    assert_eq!(law, "the weight of a vertex with itself is positive");
    let negative = |_: &Vertex<[f32; 3]>, _: &Vertex<[f32; 3]>| -1.0;
    let law = broken(Outcome::of_laws("less than nothing", check_similarity(&negative, &vertices)));
    assert_eq!(law, "weights are finite and not negative");
}
