//! Colour scales: from numbers to colours, with round numbers beside them.

use super::canvas::Rgb;

/// A linear scale between two numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColourScale {
    pub low: f64,
    pub high: f64,
    map: fn(f64) -> Rgb,
}

impl ColourScale {
    /// From 0 to `high`, dark to bright (viridis).
    pub(crate) fn sequential(high: f64) -> Self {
        Self { low: 0.0, high, map: |x| colorous::VIRIDIS.eval_continuous(x).into() }
    }

    /// From `-extent` to `extent`: blue below zero, white at zero, red above.
    pub(crate) fn diverging(extent: f64) -> Self {
        Self { low: -extent, high: extent, map: |x| colorous::RED_BLUE.eval_continuous(1.0 - x).into() }
    }

    /// From 0 to `high`, white to a light blue on which lines can be seen.
    pub(crate) fn pale(high: f64) -> Self {
        Self { low: 0.0, high, map: |x| colorous::BLUES.eval_continuous(0.08 + 0.5 * x).into() }
    }

    /// The colour of a number; what lies beyond an end has the end's colour.
    pub(crate) fn colour(&self, value: f64) -> Rgb {
        (self.map)(self.position(value))
    }

    /// Where a number stands on the scale, 0 to 1.
    pub(crate) fn position(&self, value: f64) -> f64 {
        if self.high > self.low { ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0) } else { 0.5 }
    }

    /// Round numbers on the scale, with at most so many steps between them.
    pub(crate) fn ticks(&self, most_steps: usize) -> Vec<f64> {
        let step = round_step((self.high - self.low) / most_steps.max(1) as f64);
        let (first, last) = ((self.low / step - 1e-9).ceil() as i64, (self.high / step + 1e-9).floor() as i64);
        (first..=last).map(|i| i as f64 * step).collect()
    }
}

/// The next number that is 1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten.
pub(crate) fn round_up(value: f64) -> f64 {
    round_to(value, &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0])
}

fn round_step(value: f64) -> f64 {
    round_to(value, &[1.0, 2.0, 5.0, 10.0])
}

fn round_to(value: f64, mantissas: &[f64]) -> f64 {
    if value.is_nan() || value <= 0.0 || value.is_infinite() {
        return 1.0;
    }
    let power = 10f64.powf(value.log10().floor());
    let fits = |m: &&f64| **m * power >= value * (1.0 - 1e-9);
    mantissas.iter().find(fits).unwrap_or(&10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_on_the_scale() {
        assert_eq!(ColourScale::sequential(100.0).ticks(7), [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
        assert_eq!(ColourScale::diverging(15.0).ticks(7), [-15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0]);
        for high in [1e-6, 0.3, 7.0, 1234.0, 9.99e7] {
            let ticks = ColourScale::sequential(high).ticks(7);
            assert!((3..=8).contains(&ticks.len()), "{high}: {ticks:?}");
            assert!(ColourScale::sequential(high).ticks(1).len() <= 2);
        }
    }

    #[test]
    fn colours_end_where_the_scale_ends() {
        let scale = ColourScale::sequential(10.0);
        assert_eq!(scale.colour(99.0), scale.colour(10.0));
        assert_eq!(scale.colour(-1.0), scale.colour(0.0));
        assert_ne!(scale.colour(0.0), scale.colour(10.0));
    }

    #[test]
    fn fewer_is_blue_and_more_is_red() {
        let scale = ColourScale::diverging(1.0);
        assert!(scale.colour(-0.8).2 > scale.colour(-0.8).0);
        assert!(scale.colour(0.8).0 > scale.colour(0.8).2);
    }

    #[test]
    fn rounding_up_never_rounds_down() {
        for value in [0.011, 0.5, 1.0, 6.3, 99.0, 101.0, 8e8] {
            let up = round_up(value);
            assert!(up >= value && up <= 1.6 * value, "{value} -> {up}");
        }
    }
}
