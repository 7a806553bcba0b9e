//! Axes: from values to pixels, with round numbers.

use maud::{Markup, html};

use super::super::words::short_number;
use super::{Anchor, line, text, width_of};

/// One axis of a plot.
#[derive(Debug, Clone, Copy)]
pub(in crate::report) struct Axis {
    low: f64,
    high: f64,
    log: bool,
    /// Ticks between whole numbers would say nothing.
    whole: bool,
    /// A logarithmic axis whose lower end stands for 0.
    zero: bool,
    from: f64,
    to: f64,
}

impl Axis {
    /// A logarithmic axis for ratios: holds all of them, and 1.
    pub(super) fn ratios(values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let (low, high) = ends(values.filter(|v| *v > 0.0).chain([1.0]));
        let room = (high / low).powf(0.05).max(1.005);
        Self {
            low: low / room,
            high: high * room,
            log: true,
            whole: false,
            zero: false,
            from: pixels[0],
            to: pixels[1],
        }
    }

    /// Whichever scale suits the values: logarithmic if all are above 0 and span more than a factor of 20, or if they begin at 0
    /// and go on in leaps.
    pub(super) fn fitting(values: impl Iterator<Item = f64>, [from, to]: [f64; 2]) -> Self {
        let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        values.sort_unstable_by(f64::total_cmp);
        let whole = values.iter().all(|v| v.fract() == 0.0);
        let (low, high) = ends(values.iter().copied());
        let least = values.iter().copied().find(|v| *v > 0.0).unwrap_or(high);
        if low == 0.0 && high > 20.0 * least && leaps(&values) {
            return Self { low: least / 4.0, high: high * 1.1, log: true, whole, zero: true, from, to };
        }
        if low > 0.0 && high / low > 20.0 {
            let room = (high / low).powf(0.03);
            return Self { low: low / room, high: high * room, log: true, whole, zero: false, from, to };
        }
        let room = if high > low { 0.04 * (high - low) } else { 0.5 };
        Self { low: low - room, high: high + room, log: false, whole, zero: false, from, to }
    }

    /// Where a value stands, in pixels; what is beyond an end stands at it.
    pub(super) fn at(&self, value: f64) -> f64 {
        let share = if self.log {
            (value.max(f64::MIN_POSITIVE) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// Round numbers on the axis at even steps, as many as keep `room` pixels between them.
    pub(super) fn ticks(&self, room: f64) -> Vec<f64> {
        let wide = self.log && self.high / self.low > 8.0;
        let mut choices = if wide { self.powers() } else { self.steps() };
        if self.zero {
            choices.iter_mut().for_each(|c| c.insert(0, 0.0));
        }
        let apart = |ticks: &[f64]| ticks.windows(2).all(|w| (self.at(w[1]) - self.at(w[0])).abs() >= room);
        choices.into_iter().find(|c| c.len() > 1 && apart(c)).unwrap_or_default()
    }

    /// Multiples of a round step, the finest first.
    fn steps(&self) -> Vec<Vec<f64>> {
        let unit = 10f64.powf((self.high - self.low).log10().floor() - 1.0);
        let multiples = |part: f64| {
            let step = unit * part;
            let (first, last) = ((self.low / step - 1e-9).ceil() as i64, (self.high / step + 1e-9).floor() as i64);
            (first..=last).map(|i| i as f64 * step).collect()
        };
        let fine = |part: &f64| !self.whole || (unit * part) >= 1.0 - 1e-9;
        [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().filter(fine).map(multiples).collect()
    }

    /// Powers of ten with what is round between them, the finest first.
    fn powers(&self) -> Vec<Vec<f64>> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let low = if self.zero { 2.0 * self.low } else { self.low };
        let inside = |v: &f64| (low..=self.high).contains(v) && (!self.whole || *v >= 1.0);
        let times = |of: &[f64], each: usize| -> Vec<f64> {
            let powers = (first..=last).filter(|e| e.rem_euclid(each as i32) == 0);
            powers.flat_map(|e| of.iter().map(move |m| m * 10f64.powi(e))).filter(inside).collect()
        };
        vec![times(&[1.0, 2.0, 5.0], 1), times(&[1.0, 3.0], 1), times(&[1.0], 1), times(&[1.0], 2), times(&[1.0], 3)]
    }

    /// Ticks, grid lines from `top` to `bottom`, and numbers below; the axis runs to the right.
    pub(super) fn below(&self, top: f64, bottom: f64) -> Markup {
        let ticks = self.ticks(40.0);
        html! {
            @for tick in ticks {
                (line(grid(tick, self.log), [self.at(tick), top], [self.at(tick), bottom]))
                (text(self.at(tick), bottom + 16.0, Anchor::Middle, "tick", &short(tick)))
            }
        }
    }

    /// The same for an axis that runs upwards, its numbers to the left.
    pub(super) fn beside(&self, left: f64, right: f64) -> Markup {
        let ticks = self.ticks(28.0);
        html! {
            @for tick in ticks {
                (line(grid(tick, self.log), [left, self.at(tick)], [right, self.at(tick)]))
                (text(left - 7.0, self.at(tick) + 4.5, Anchor::End, "tick", &short(tick)))
            }
        }
    }

    /// How much room the numbers beside it need.
    pub(super) fn room_beside(&self) -> f64 {
        self.ticks(28.0).iter().map(|t| width_of(&short(*t))).fold(0.0, f64::max) + 10.0
    }
}

/// A number as short as it can be said, with a true minus.
pub(in crate::report) fn short(value: f64) -> String {
    short_number(value).replace('-', "−")
}

/// Whether one step between sorted values is about half of all their span.
fn leaps(values: &[f64]) -> bool {
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return false };
    values.windows(2).any(|w| w[1] - w[0] >= 0.45 * (last - first))
}

/// The line at ratio 1 says where the base is.
fn grid(tick: f64, log: bool) -> &'static str {
    if log && (tick - 1.0).abs() < 1e-9 { "even" } else { "grid" }
}

fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_apart_and_hold_the_base() {
        for values in [[0.8, 1.02], [0.97, 1.01], [0.2, 30.0], [0.999, 1.001], [1e-3, 5e4]] {
            let axis = Axis::ratios(values.into_iter(), [0.0, 300.0]);
            let ticks = axis.ticks(40.0);
            assert!((2..=8).contains(&ticks.len()) && ticks.contains(&1.0), "{values:?}: {ticks:?}");
            assert!(ticks.windows(2).all(|w| axis.at(w[1]) - axis.at(w[0]) >= 40.0));
        }
    }

    #[test]
    fn a_long_span_is_logarithmic_and_a_short_one_is_not() {
        assert!(Axis::fitting([100.0, 1e6].into_iter(), [0.0, 1.0]).log);
        assert!(!Axis::fitting((0..60).map(f64::from), [0.0, 1.0]).log);
        assert!(!Axis::fitting([1.0, 8.0].into_iter(), [0.0, 1.0]).log);
        let nothing = Axis::fitting(std::iter::empty(), [0.0, 1.0]);
        assert!(nothing.at(0.5).is_finite());
    }

    #[test]
    fn zero_has_a_place_on_an_axis_of_leaps() {
        let axis = Axis::fitting([0.0, 1.0, 4.0, 16.0, 64.0, 256.0].into_iter(), [0.0, 300.0]);
        let ticks = axis.ticks(40.0);
        assert!(axis.log && ticks[0] == 0.0 && axis.at(0.0) == 0.0 && axis.at(1.0) > 40.0, "{ticks:?}");
        assert!(ticks.windows(2).all(|w| axis.at(w[1]) - axis.at(w[0]) >= 40.0), "{ticks:?}");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.25, 7.0, 16_384.0, 1e6, -3.0, 0.1 + 0.2].map(short), ["0.25", "7", "16.384k", "1M", "−3", "0.3"]);
    }
}
