//! Logarithmic axes.

/// A logarithmic axis: a range of numbers over a range of the drawing.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogAxis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl LogAxis {
    /// An axis from `from` to `to` that has room for all `values` and some more. Values that are not positive and finite are passed
    /// over; without any, the axis is one decade around 1.
    pub(super) fn around(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let logs = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        // A third of a decade at least, or a flat line would fill the plot with its noise.
        let room = (0.06 * (high - low)).max(0.17 - 0.5 * (high - low));
        Self { low: low - room, high: high + room, from, to }
    }

    /// Where a number is; numbers beyond the ends are put there.
    pub(super) fn place(&self, value: f64) -> f64 {
        let share = (value.log10() - self.low) / (self.high - self.low);
        self.from + (self.to - self.from) * share.clamp(0.0, 1.0)
    }

    /// The numbers to be written at the axis: powers of ten, and two and five times those where there is room.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let within = |multiples: &[f64], every: i32| -> Vec<f64> {
            let decades = self.low.floor() as i32..=self.high.ceil() as i32;
            let all = decades.filter(|decade| decade.rem_euclid(every) == 0);
            let all = all.flat_map(|decade| multiples.iter().map(move |multiple| multiple * 10f64.powi(decade)));
            all.filter(|tick| (self.low..=self.high).contains(&tick.log10())).collect()
        };
        match self.high - self.low {
            decades if decades < 0.9 => within(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0], 1),
            decades if decades < 2.5 => within(&[1.0, 2.0, 5.0], 1),
            decades => within(&[1.0], (decades / 7.0).ceil() as i32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_room_for_their_values_and_ticks() {
        for values in [vec![1.0, 100.0], vec![3e-7, 2e-3], vec![5.0], vec![0.2, 0.21], vec![]] {
            let axis = LogAxis::around(values.iter().copied(), 0.0, 100.0);
            for &value in &values {
                assert!((1.0..=99.0).contains(&axis.place(value)), "{values:?}");
            }
            let ticks = axis.ticks();
            assert!((1..=9).contains(&ticks.len()), "{values:?}: {ticks:?}");
            assert!(ticks.is_sorted_by(|a, b| axis.place(*a) < axis.place(*b)), "{values:?}: {ticks:?}");
        }
        let axis = LogAxis::around([1.0, 10.0].into_iter(), 0.0, 100.0);
        assert!((axis.place(10f64.sqrt()) - 50.0).abs() < 1e-9);
        assert_eq!((axis.place(0.0), axis.place(f64::INFINITY)), (0.0, 100.0));
    }
}
