//! Axes that begin and end at round numbers.

use crate::PlotError;

/// Range of an axis and distance between its ticks, all multiples of 1, 2 or 5 times a power of ten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    step: f64,
}

/// Most intervals of an axis before it is extended to round ends.
const INTERVALS: f64 = 8.0;

impl Axis {
    /// Smallest round range that contains finite `values`; `None` if there are none or their range overflows.
    pub(crate) fn around(values: impl Iterator<Item = f64>) -> Option<Self> {
        Self::with_intervals(values, INTERVALS)
    }

    /// The same; the error says what is too large for an axis.
    pub(crate) fn of(
        quantity: &'static str,
        values: impl Iterator<Item = f64> + Clone,
    ) -> Result<Self, PlotError> {
        Self::few(quantity, INTERVALS, values)
    }

    /// The same with fewer intervals, for a small panel.
    pub(crate) fn few(
        quantity: &'static str,
        intervals: f64,
        values: impl Iterator<Item = f64> + Clone,
    ) -> Result<Self, PlotError> {
        Self::with_intervals(values.clone(), intervals).ok_or_else(|| PlotError::span(quantity, values))
    }

    /// The same with at most so many intervals before it is extended to round ends: fewer for a small panel.
    fn with_intervals(values: impl Iterator<Item = f64>, intervals: f64) -> Option<Self> {
        let (min, max) = range(values)?;
        let magnitude = min.abs().max(max.abs());
        // Constant values have no range: it becomes a tenth of their size, or one unit around zero.
        let (min, max) = if max - min > 1e-9 * magnitude {
            (min, max)
        } else {
            let half = if magnitude > 0.0 { 0.1 * magnitude } else { 1.0 };
            (min - half, max + half)
        };
        let step = round_up((max - min) / intervals);
        // A value on a tick up to rounding needs no further interval.
        let slack = 1e-9;
        let axis =
            Self { low: (min / step + slack).floor() * step, high: (max / step - slack).ceil() * step, step };
        (step > 0.0 && (axis.high - axis.low).is_finite()).then_some(axis)
    }

    /// Position of a value between the ends: 0 at the low end, 1 at the high end.
    pub(crate) fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Ticks with their labels, with a true minus sign.
    pub(crate) fn labels(&self) -> Vec<(f64, String)> {
        self.ticks().into_iter().map(|tick| (tick, self.label(tick).replace('-', "−"))).collect()
    }

    /// Low and high end.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Ticks from the low end to the high one.
    fn ticks(&self) -> Vec<f64> {
        let tick = |i: u32| self.low + f64::from(i) * self.step;
        let tick = |i: u32| if tick(i).abs() < 1e-6 * self.step { 0.0 } else { tick(i) };
        (0..100).map(tick).take_while(|tick| *tick <= self.high + 0.5 * self.step).collect()
    }

    /// Number at a tick, with as many decimals as the step needs.
    fn label(&self, tick: f64) -> String {
        if self.step < 1e-4 || self.low.abs().max(self.high.abs()) >= 1e7 {
            return if tick == 0.0 { "0".to_owned() } else { format!("{tick:.3e}") };
        }
        let decimals = (0..4).find(|d| 10_f64.powi(-d) <= self.step * (1.0 + 1e-9)).unwrap_or(4);
        format!("{tick:.0$}", usize::try_from(decimals).unwrap_or(0))
    }
}

/// Least and largest of the values; `None` if there are none, or if they lie further apart than a number reaches.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (min, max) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| (min.min(v), max.max(v)));
    (max - min).is_finite().then_some((min, max))
}

/// Smallest of 1, 2, 5 times a power of ten that is at least `value`.
fn round_up(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|m| m * power)
        .find(|s| *s >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: &[f64]) -> Vec<String> {
        let axis = Axis::around(values.iter().copied()).unwrap();
        axis.ticks().into_iter().map(|tick| axis.label(tick)).collect()
    }

    #[test]
    fn ends_and_steps_are_round() {
        assert_eq!(labels(&[0.0, 35.0]), ["0", "5", "10", "15", "20", "25", "30", "35"]);
        assert_eq!(labels(&[-130.0, 2410.0]), ["-500", "0", "500", "1000", "1500", "2000", "2500"]);
        assert_eq!(labels(&[0.12, 0.58]), ["0.1", "0.2", "0.3", "0.4", "0.5", "0.6"]);
    }

    #[test]
    fn small_panels_get_fewer_ticks() {
        let axis = Axis::with_intervals([-3.0, 35.0].into_iter(), 4.0).unwrap();
        let labels: Vec<_> = axis.labels().into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["−10", "0", "10", "20", "30", "40"]);
        assert_eq!((axis.share(15.0), axis.ends()), (0.5, [-10.0, 40.0]));
    }

    #[test]
    fn constants_get_a_range() {
        assert_eq!(labels(&[0.0, 0.0]).first().map(String::as_str), Some("-1.0"));
        let axis = Axis::around([200.0, 200.0].into_iter()).unwrap();
        assert!(axis.low < 200.0 && axis.high > 200.0);
    }

    #[test]
    fn covers_values_of_any_size_with_few_ticks() {
        for exponent in -30..30 {
            for (min, max) in [(0.0, 1.0), (-0.3, 7.7), (0.999, 1.0), (3.0, 9.999_999)] {
                let scale = 10_f64.powi(exponent);
                let axis = Axis::around([min * scale, max * scale].into_iter()).unwrap();
                let within = 1e-8 * axis.step;
                assert!(axis.low <= min * scale + within && axis.high >= max * scale - within);
                let ticks = axis.ticks();
                assert!((4..=11).contains(&ticks.len()), "{} ticks from {min} to {max}", ticks.len());
                let last = ticks.last().unwrap();
                assert!((last - axis.high).abs() < 1e-6 * axis.step);
            }
        }
    }

    #[test]
    fn nothing_and_too_much_have_no_axis() {
        assert_eq!(Axis::around(std::iter::empty()), None);
        assert_eq!(Axis::around([-1e308, 1e308].into_iter()), None);
    }
}
