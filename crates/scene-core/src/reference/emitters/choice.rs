//! Choosing an emitter without looking at the lit point: uniformly, or by power.

use qmc_sampling::warp::PiecewiseConstant1d;

use crate::ray::SurfacePoint;
use crate::traits::{ChosenEmitter, Emitter, EmitterChoice, EmitterId, Spectrum};

/// Every emitter with the same probability `1 / n`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UniformChoice {
    count: u32,
}

impl UniformChoice {
    /// Chooses among the first `count` emitters.
    pub fn new(count: usize) -> Self {
        Self { count: u32::try_from(count).unwrap_or(u32::MAX) }
    }
}

impl EmitterChoice for UniformChoice {
    #[inline]
    fn choose(&self, _from: Option<&SurfacePoint>, u: f32) -> Option<ChosenEmitter> {
        let last = self.count.checked_sub(1)?;
        let index = ((f64::from(u) * f64::from(self.count)) as u32).min(last);
        Some(ChosenEmitter { id: EmitterId(index), probability: 1.0 / self.count as f32 })
    }

    #[inline]
    fn probability(&self, _from: Option<&SurfacePoint>, id: EmitterId) -> f32 {
        if id.0 < self.count { 1.0 / self.count as f32 } else { 0.0 }
    }
}

/// Emitters with probability proportional to the luminance of their power.
///
/// Emitters without power are never chosen; if none has power, nothing is.
#[derive(Clone, Debug)]
pub struct PowerChoice {
    table: Option<PiecewiseConstant1d>,
}

impl PowerChoice {
    /// Chooses among `emitters`, in their order.
    pub fn new<E: Emitter>(emitters: &[E]) -> Self {
        let powers: Vec<f32> = emitters
            .iter()
            .map(|emitter| {
                let power = emitter.power().luminance();
                if power.is_finite() { power.max(0.0) } else { 0.0 }
            })
            .collect();
        Self { table: PiecewiseConstant1d::new(&powers).ok().filter(|_| powers.iter().any(|&p| p > 0.0)) }
    }
}

impl EmitterChoice for PowerChoice {
    #[inline]
    fn choose(&self, _from: Option<&SurfacePoint>, u: f32) -> Option<ChosenEmitter> {
        let table = self.table.as_ref()?;
        let (index, probability, _) = table.choose(u);
        Some(ChosenEmitter { id: EmitterId(index as u32), probability })
    }

    #[inline]
    fn probability(&self, _from: Option<&SurfacePoint>, id: EmitterId) -> f32 {
        self.table.as_ref().filter(|table| id.index() < table.len()).map_or(0.0, |table| table.probability(id.index()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::emitters::{PointEmitter, ReferenceEmitter};
    use crate::traits::Rgb;
    use glam::Vec3A;

    fn points(intensities: &[f32]) -> Vec<ReferenceEmitter> {
        let point = |&i: &f32| ReferenceEmitter::Point(PointEmitter::new(Vec3A::ZERO, Rgb::splat(i)));
        intensities.iter().map(point).collect()
    }

    #[test]
    fn power_decides() {
        let choice = PowerChoice::new(&points(&[1.0, 0.0, 3.0]));
        assert!((choice.probability(None, EmitterId(0)) - 0.25).abs() < 1e-6);
        assert_eq!(choice.probability(None, EmitterId(1)), 0.0);
        assert_eq!(choice.probability(None, EmitterId(7)), 0.0);
        for k in 0..1000 {
            let chosen = choice.choose(None, k as f32 / 1000.0).unwrap();
            assert_eq!(chosen.probability, choice.probability(None, chosen.id));
            assert_eq!(chosen.id.0, if k < 250 { 0 } else { 2 });
        }
    }

    #[test]
    fn no_emitter_no_choice() {
        assert_eq!(PowerChoice::new(&points(&[])).choose(None, 0.5), None);
        assert_eq!(PowerChoice::new(&points(&[0.0])).choose(None, 0.5), None);
        assert_eq!(PowerChoice::new(&points(&[f32::NAN, f32::INFINITY])).choose(None, 0.5), None);
        assert_eq!(UniformChoice::new(0).choose(None, 0.5), None);
        assert_eq!(UniformChoice::new(3).choose(None, 0.99999994).unwrap().id, EmitterId(2));
    }
}
