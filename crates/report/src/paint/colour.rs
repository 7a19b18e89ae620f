//! The colour map: from a number between zero and one to a colour.

use super::canvas::Colour;

/// Stops of the colour map, equally spaced: from light grey over gold and red to plum, darker at every stop, so that a body at
/// rest shows its shape and the order of values survives without colour.
const STOPS: [[f64; 3]; 6] = [
    [233.0, 237.0, 242.0],
    [250.0, 222.0, 150.0],
    [247.0, 172.0, 76.0],
    [226.0, 103.0, 60.0],
    [172.0, 42.0, 80.0],
    [88.0, 18.0, 84.0],
];

/// Values are rounded to this many levels, so that neighbours of nearly the same value share a colour.
const LEVELS: f64 = 64.0;

/// Colour of `value` (clamped to `0..=1`; not a number counts as zero) under `light` (one leaves it as it is).
pub fn colour(value: f64, light: f64) -> Colour {
    let value = if value.is_nan() { 0.0 } else { (value.clamp(0.0, 1.0) * LEVELS).round() / LEVELS };
    let place = value * (STOPS.len() - 1) as f64;
    let low = (place as usize).min(STOPS.len() - 2);
    let part = place - low as f64;
    std::array::from_fn(|i| {
        let plain = STOPS[low][i] + part * (STOPS[low + 1][i] - STOPS[low][i]);
        (plain * light).round().clamp(0.0, 255.0) as u8
    })
}

/// A colour as `#rrggbb`.
pub fn hex([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: f64, light: f64) -> String {
        hex(colour(value, light))
    }

    #[test]
    fn ends_levels_and_light() {
        assert_eq!(of(0.0, 1.0), "#e9edf2");
        assert_eq!([of(1.0, 1.0), of(7.0, 1.0)], ["#581254", "#581254"]);
        assert_eq!([of(f64::NAN, 1.0), of(-1.0, 1.0)], ["#e9edf2", "#e9edf2"]);
        assert_eq!(of(0.5, 1.0), of(0.503, 1.0));
        assert_eq!(of(0.5, 0.0), "#000000");
    }

    #[test]
    fn every_stop_is_darker_than_the_one_before() {
        let luminance = |stop: &[f64; 3]| 0.2126 * stop[0] + 0.7152 * stop[1] + 0.0722 * stop[2];
        assert!(STOPS.windows(2).all(|pair| luminance(&pair[1]) < luminance(&pair[0])));
    }
}
