//! Axes: from values to fractions of the length, ticks and their labels.

/// A linear or a logarithmic axis with `low < high`.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Values at the ends; for a logarithmic axis their decimal logarithms.
    low: f64,
    high: f64,
    logarithmic: bool,
}

/// A place on an axis with a line of the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Part of the axis before the place, from 0 to 1.
    pub fraction: f64,
    /// Label of the place; empty for a line without a number.
    pub label: String,
}

impl Axis {
    /// Linear; equal ends are moved apart.
    pub fn linear((low, high): (f64, f64)) -> Self {
        if high - low > 1e-12 * high.abs().max(low.abs()) {
            Self { low, high, logarithmic: false }
        } else {
            let apart = |end: f64| 0.5 * if end == 0.0 { 1e-3 } else { end.abs() };
            Self { low: low - apart(low), high: high + apart(high), logarithmic: false }
        }
    }

    /// Logarithmic, over whole decades. Ends that are not positive are replaced.
    pub fn logarithmic((low, high): (f64, f64)) -> Self {
        let high = if high > 0.0 && high.is_finite() { high.log10() } else { 0.0 };
        let low = if low > 0.0 { low.log10() } else { high - 1.0 };
        // A value that is a power of ten but for round-off starts no new decade.
        let (low, high) = ((low + 1e-6).floor(), (high - 1e-6).ceil());
        Self { low: low.min(high - 1.0), high: high.max(low + 1.0), logarithmic: true }
    }

    /// Place of a value along the axis, 0 at its beginning; `None` if it has none.
    pub fn fraction(&self, value: f64) -> Option<f64> {
        let value = if self.logarithmic { value.log10() } else { value };
        let fraction = (value - self.low) / (self.high - self.low);
        (fraction.is_finite() && (-0.01..=1.01).contains(&fraction)).then_some(fraction)
    }

    /// Length of a unit, or of a decade, as a fraction of the axis.
    pub fn unit(&self) -> f64 {
        1.0 / (self.high - self.low)
    }

    /// Stretches a linear axis around its middle until a unit is this fraction of it.
    pub fn with_unit(self, unit: f64) -> Self {
        let (middle, half) = (0.5 * (self.low + self.high), 0.5 / unit);
        Self { low: middle - half, high: middle + half, ..self }
    }

    /// Grid lines with at most `most` labels.
    pub fn ticks(&self, most: usize) -> Vec<Tick> {
        if self.logarithmic { self.decades(most) } else { self.round_numbers(most) }
    }

    /// A line for every decade (or every few, if there are too many), and for 2, 3 ... 9 if there are few.
    fn decades(&self, most: usize) -> Vec<Tick> {
        let count = self.high - self.low;
        let strides = [1.0, 2.0, 3.0, 4.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
        let stride = strides.into_iter().find(|stride| count / stride < most as f64).unwrap_or(500.0);
        // Lines in every decade unless they would be a grey area.
        let lines = if count <= 40.0 { 1.0 } else { stride };
        let mut ticks = Vec::new();
        let mut exponent = (self.low / lines).ceil() * lines;
        while exponent <= self.high {
            let label = if exponent % stride == 0.0 { power_of_ten(exponent as i32) } else { String::new() };
            ticks.push(Tick { fraction: (exponent - self.low) * self.unit(), label });
            if count <= 2.0 && exponent < self.high {
                ticks.extend((2..10).map(|k| {
                    let place = exponent + f64::from(k).log10();
                    Tick { fraction: (place - self.low) * self.unit(), label: String::new() }
                }));
            }
            exponent += lines;
        }
        ticks
    }

    /// Multiples of 1, 2 or 5 times a power of ten.
    fn round_numbers(&self, most: usize) -> Vec<Tick> {
        let length = self.high - self.low;
        let least = length / most.max(1) as f64;
        let power = 10.0_f64.powf(least.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= least).unwrap_or(power);
        // An end that is a round number but for round-off is one.
        let first = (self.low / step - 1e-6).ceil();
        let count = ((self.high / step + 1e-6).floor() - first).max(0.0) as usize;
        let values: Vec<f64> = (0..=count.min(1000)).map(|k| (first + k as f64) * step).collect();
        let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let tick = |value: &f64| Tick { fraction: (value - self.low) / length, label: label(*value, step, largest) };
        values.iter().map(tick).collect()
    }
}

/// A multiple of `step` with the digits that tell it from its neighbours.
fn label(value: f64, step: f64, largest: f64) -> String {
    // The first digit of a step is 1, 2 or 5; the shift keeps 1e-3 = 0.001 from being taken for 0.0009.
    let step_power = (step.log10() + 1e-9).floor();
    if (value / step).round() == 0.0 {
        return "0".into();
    }
    if (1e-3..1e5).contains(&largest) {
        return format!("{value:.*}", (-step_power).clamp(0.0, 14.0) as usize);
    }
    let digits = (value.abs().log10() + 1e-9).floor() - step_power;
    let text = format!("{value:.*e}", digits.clamp(0.0, 14.0) as usize);
    text.replace("e0", "")
}

/// `10⁻³` for -3.
pub fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = exponent
        .to_string()
        .chars()
        .map(|symbol| match symbol.to_digit(10) {
            Some(digit) => DIGITS[digit as usize],
            None => '⁻',
        })
        .collect::<String>();
    format!("10{raised}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: Axis, most: usize) -> Vec<String> {
        axis.ticks(most).into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn round_numbers_are_labelled_with_few_digits() {
        assert_eq!(labels(Axis::linear((-0.1, 1.03)), 6), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(Axis::linear((0.0, 1000.0)), 5), ["0", "200", "400", "600", "800", "1000"]);
        assert_eq!(labels(Axis::linear((1e6, 1.41e6)), 5), ["1.0e6", "1.1e6", "1.2e6", "1.3e6", "1.4e6"]);
        assert_eq!(labels(Axis::linear((1.000_01, 1.000_031)), 4), ["1.00001", "1.00002", "1.00003"]);
        assert_eq!(labels(Axis::linear((0.0, 4.1e-7)), 5), ["0", "1e-7", "2e-7", "3e-7", "4e-7"]);
    }

    #[test]
    fn decades_are_whole_and_thinned() {
        assert_eq!(labels(Axis::logarithmic((2e-3, 0.5)), 9), ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(labels(Axis::logarithmic((1e-3, 0.1)), 9), ["10⁻³", "10⁻²", "10⁻¹"]);
        assert_eq!(
            labels(Axis::logarithmic((1e-16, 1.0)), 9),
            ["10⁻¹⁶", "10⁻¹⁴", "10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"]
        );
        assert!(labels(Axis::logarithmic((1e-300, 1e300)), 9).len() <= 9);
        assert_eq!(Axis::logarithmic((0.0, 0.0)).ticks(9).iter().filter(|tick| !tick.label.is_empty()).count(), 2);
    }

    #[test]
    fn fractions_are_linear_in_the_value_or_its_logarithm() {
        assert_eq!(Axis::linear((2.0, 6.0)).fraction(3.0), Some(0.25));
        let axis = Axis::logarithmic((1e-4, 1.0));
        assert!((axis.fraction(1e-3).unwrap() - 0.25).abs() < 1e-12);
        for outside in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-6, 1e3] {
            assert_eq!(axis.fraction(outside), None);
        }
        assert!(Axis::linear((3.0, 3.0)).fraction(3.0).is_some_and(|middle| (0.2..0.8).contains(&middle)));
    }
}
