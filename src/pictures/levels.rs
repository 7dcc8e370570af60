//! Axes of maps: they count cells and label some of them with the value of their level.

use super::axis::PlotAxis;
use super::number;
use super::sheet::UNIT;

/// Horizontal axis over as many cells as there are levels, on `room` units of paper.
pub(super) fn across(levels: &[f64], room: i32) -> PlotAxis {
    // Only every n-th label fits; n depends on which ones are shown.
    let least = fitting_stride(levels, room, 24 * UNIT);
    let fits = |stride: &usize| every(levels, *stride).is_clear(room);
    let stride = (least..=levels.len()).find(fits).unwrap_or(levels.len());
    let nice = every(levels, nicest_stride(levels, stride));
    match nice.is_clear(room) {
        true => nice,
        false => every(levels, stride),
    }
}

/// Vertical axis over as many cells as there are levels, on `room` units of paper.
pub(super) fn upwards(levels: &[f64], room: i32) -> PlotAxis {
    let least = fitting_stride(levels, room, 26 * UNIT);
    every(levels, nicest_stride(levels, least))
}

/// Horizontal axis over cells whose levels have these texts.
pub(super) fn words_across(words: &[String], room: i32) -> PlotAxis {
    let clear = (1..=words.len()).map(|stride| every_word(words, stride)).find(|axis| axis.is_clear(room));
    clear.unwrap_or_else(|| every_word(words, words.len()))
}

/// Vertical axis over cells whose levels have these texts.
pub(super) fn words_upwards(words: &[String], room: i32) -> PlotAxis {
    every_word(words, (words.len() * (26 * UNIT) as usize).div_ceil(room.max(1) as usize))
}

/// The axis with a text in the middle of every `stride`-th cell.
fn every_word(words: &[String], stride: usize) -> PlotAxis {
    let ticks = words.iter().enumerate().step_by(stride.max(1)).map(|(i, word)| (i as f64 + 0.5, word.clone()));
    PlotAxis::with_ticks((0.0, words.len() as f64), ticks)
}

/// Least number of cells from one label to the next if labels need `spacing`.
fn fitting_stride(levels: &[f64], room: i32, spacing: i32) -> usize {
    (levels.len() * spacing as usize).div_ceil(room.max(1) as usize)
}

/// The axis with a label in the middle of every `stride`-th cell.
fn every(levels: &[f64], stride: usize) -> PlotAxis {
    let stride = stride.max(1);
    let chosen: Vec<f64> = levels.iter().copied().step_by(stride).collect();
    let places = (0..levels.len()).step_by(stride).map(|i| i as f64 + 0.5);
    let ticks = places.zip(number::levels(&chosen));
    PlotAxis::with_ticks((0.0, levels.len() as f64), ticks)
}

/// Of the strides from `least` to three times that, the one with the shortest labels: every fifth cell of 18, 18.2, ... is labelled 18,
/// 19, 20.
fn nicest_stride(levels: &[f64], least: usize) -> usize {
    let least = least.max(1);
    // Strides beyond the last cell would leave a single label.
    let most = (3 * least).min(levels.len().saturating_sub(1)).max(least);
    let cost = |stride: usize| {
        let axis = every(levels, stride);
        // Zeros at the end do not count: 1 200 is easier to read than 1 176.
        let length: usize = axis.ticks().map(|(_, label)| label.trim_end_matches(['0', '\u{a0}', ' ']).chars().count()).sum();
        // Tenths of a character on average; a stride twice as wide is worth half a character.
        length * 10 / axis.ticks().count().max(1) + stride * 5 / least
    };
    (least..=most).min_by_key(|&s| cost(s)).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &PlotAxis) -> Vec<&str> {
        axis.ticks().map(|(_, label)| label).collect()
    }

    #[test]
    fn labels_are_level_values_at_round_cells() {
        let levels: Vec<f64> = (0..61).map(|i| 18.0 + 0.2 * f64::from(i)).collect();
        let axis = upwards(&levels, 520 * UNIT);
        assert_eq!(labels(&axis)[..3], ["18", "19", "20"]);
        assert_eq!(axis.ticks().nth(1).expect("a second tick").0, 5.5);
        let decades: Vec<f64> = (0..22).map(|i| 10f64.powf(f64::from(i) / 7.0)).collect();
        assert_eq!(labels(&upwards(&decades, 150 * UNIT)), ["1", "10", "100", "1 000"]);
    }

    #[test]
    fn words_have_room_too() {
        let words: Vec<String> = (0..40).map(|i| format!("a-rather-long-word-{i}")).collect();
        let axis = words_across(&words, 600 * UNIT);
        assert!(axis.is_clear(600 * UNIT) && labels(&axis).len() > 1, "{:?}", labels(&axis));
        assert_eq!(labels(&words_upwards(&words[..4], 520 * UNIT)).len(), 4);
        assert!(labels(&words_upwards(&words, 520 * UNIT)).len() <= 20);
    }

    #[test]
    fn labels_side_by_side_never_touch() {
        for count in [1, 2, 3, 41, 2000] {
            let levels: Vec<f64> = (0..count).map(|i| 1e-7 * (1.0 + f64::from(i))).collect();
            let axis = across(&levels, 600 * UNIT);
            assert!(axis.is_clear(600 * UNIT) && axis.ticks().count() > 0);
        }
    }
}
