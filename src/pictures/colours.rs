//! Colours that can be printed and that colour-blind readers can distinguish.

use plotters::style::RGBColor;

/// Text.
pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
/// Secondary text and axes.
pub(super) const GREY: RGBColor = RGBColor(110, 110, 110);
/// Grid lines.
pub(super) const GRID: RGBColor = RGBColor(228, 228, 228);
/// Ground of cells without a value; no colour of the map is neutral.
pub(super) const ABSENT: RGBColor = RGBColor(236, 236, 236);
/// Hatching of cells without a value.
pub(super) const HATCH: RGBColor = RGBColor(170, 170, 170);

/// Main colour of data.
pub(super) const BLUE: RGBColor = RGBColor(0, 114, 178);
/// The main colour, lighter.
pub(super) const LIGHT_BLUE: RGBColor = RGBColor(158, 202, 225);
/// Data in the background: darker than the grid, lighter than everything else.
pub(super) const SAMPLE: RGBColor = RGBColor(190, 190, 190);
/// Highlighted data.
pub(super) const VERMILION: RGBColor = RGBColor(213, 94, 0);

/// Colours of several lines: the palette of Okabe and Ito without its yellow, which is invisible on white.
pub(super) const LINES: [RGBColor; 7] =
    [BLUE, VERMILION, RGBColor(0, 158, 115), RGBColor(204, 121, 167), RGBColor(0, 0, 0), RGBColor(230, 159, 0), RGBColor(86, 180, 233)];

/// Every 17th of the 256 colours of viridis (Smith and van der Walt, public domain): even steps
/// look even, lightness rises throughout, so it survives a black-and-white printer.
const ANCHORS: [RGBColor; 16] = [
    RGBColor(68, 1, 84),
    RGBColor(72, 26, 108),
    RGBColor(71, 47, 125),
    RGBColor(65, 68, 135),
    RGBColor(57, 86, 140),
    RGBColor(49, 104, 142),
    RGBColor(42, 120, 142),
    RGBColor(35, 136, 142),
    RGBColor(31, 152, 139),
    RGBColor(34, 168, 132),
    RGBColor(53, 183, 121),
    RGBColor(84, 197, 104),
    RGBColor(122, 209, 81),
    RGBColor(165, 219, 54),
    RGBColor(210, 226, 27),
    RGBColor(253, 231, 37),
];

/// Steps of the colour map: with "absent" 128 palette entries, seven bits per cell. This limits the file of a map of pure noise, and the
/// steps are still invisible.
pub(super) const STEPS: usize = 127;

/// Colour of one step, 0 (lowest value) to `STEPS - 1` (highest).
pub(super) fn step_colour(step: usize) -> RGBColor {
    let place = step.min(STEPS - 1) * (ANCHORS.len() - 1);
    let (anchor, rest) = (place / (STEPS - 1), place % (STEPS - 1));
    let from = ANCHORS[anchor];
    let to = ANCHORS[(anchor + 1).min(ANCHORS.len() - 1)];
    let mix = |a: u8, b: u8| {
        let sum = usize::from(a) * (STEPS - 1 - rest) + usize::from(b) * rest;
        ((sum + (STEPS - 1) / 2) / (STEPS - 1)) as u8
    };
    RGBColor(mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}

/// Step of a value between the lowest and the highest one; the middle if they are equal.
pub(super) fn step_of(value: f64, low: f64, high: f64) -> usize {
    let share = if high > low { (value - low) / (high - low) } else { 0.5 };
    (share.clamp(0.0, 1.0) * (STEPS - 1) as f64).round() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_runs_from_end_to_end_and_gets_lighter() {
        assert_eq!(step_colour(0), ANCHORS[0]);
        assert_eq!(step_colour(STEPS - 1), ANCHORS[15]);
        let lightness = |c: RGBColor| 2126 * u32::from(c.0) + 7152 * u32::from(c.1) + 722 * u32::from(c.2);
        let steps: Vec<u32> = (0..STEPS).map(|s| lightness(step_colour(s))).collect();
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn values_outside_take_the_end_colours() {
        assert_eq!(step_of(-1.0, 0.0, 1.0), 0);
        assert_eq!(step_of(2.0, 0.0, 1.0), STEPS - 1);
        assert_eq!(step_of(3.0, 3.0, 3.0), (STEPS - 1) / 2);
    }
}
