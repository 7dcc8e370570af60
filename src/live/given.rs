//! What a study gives every design, and how far each of it is varied: the ends of its sliders.

use crate::live::around::{GivenRange, PLACES, ScenarioEnd};
use crate::models::Input;
use crate::probability::Effect;
use crate::study::{Axis, Levels, Study, UncertainInput, entry_names};

/// Standard deviations by which a mean is moved at most.
const MOST_SDS: f64 = 6.0;
/// The least value of a logarithmic range is divided by this at most.
const FURTHEST_FACTOR: f64 = 10.0;
/// Whole numbers that are looked at on either side of the own one.
const NEIGHBOURS: f64 = (PLACES / 2) as f64;
/// Numbers that are looked at instead of a word.
const NUMBERS: u32 = 9;

/// What a study gives every design, as far as its sliders go.
#[derive(Debug)]
pub struct Given {
    /// The ends of what it says of loads and of uncertain inputs, the means of distributions, and the numbers that the file fixes.
    pub said: Vec<GivenRange>,
    /// Inputs that the file leaves at their defaults.
    pub defaults: Vec<GivenRange>,
}

/// As much of it as fits.
#[derive(Debug)]
pub struct GivenSlices {
    /// What is varied: the defaults last.
    pub ranges: Vec<GivenRange>,
    /// How many of these are defaults.
    pub defaults: usize,
    /// Is what the study says left out?
    pub is_left_out: bool,
}

impl Given {
    /// What the study says if so many slices fit, and its defaults if they do too.
    pub fn as_far_as(self, fits: impl Fn(usize) -> bool) -> GivenSlices {
        let Self { said, defaults } = self;
        let is_left_out = !said.is_empty() && !fits(said.len());
        if is_left_out {
            return GivenSlices { ranges: Vec::new(), defaults: 0, is_left_out };
        }
        let defaults = if fits(said.len() + defaults.len()) { defaults } else { Vec::new() };
        let of_defaults = defaults.len();
        GivenSlices { ranges: said.into_iter().chain(defaults).collect(), defaults: of_defaults, is_left_out }
    }
}

/// What a study gives every design.
pub fn given_ranges(study: &Study, text: &str) -> Given {
    let of_kind = |is_uncertain: bool, axes: &[Axis]| -> Vec<GivenRange> {
        let inputs = |axis: &Axis| (0..axis.inputs().len()).collect::<Vec<_>>();
        let each = axes.iter().enumerate().flat_map(|(number, axis)| inputs(axis).into_iter().map(move |column| (number, axis, column)));
        each.flat_map(|(number, axis, column)| over_scenarios(study, is_uncertain, (number, axis), column)).collect()
    };
    let loads = of_kind(false, study.operating()).into_iter().chain(of_kind(true, &study.uncertainty));
    let means = means(study);
    let said = entry_names(text, "fixed");
    let fixed = |is_said: bool| {
        let asked = fixed_inputs(study).filter(|&input| said.contains(&study.model.inputs[input].name) == is_said);
        asked.filter_map(|input| fixed_range(study, input)).map(GivenRange::Fixed).collect::<Vec<_>>()
    };
    Given { said: loads.chain(means).chain(fixed(true)).collect(), defaults: fixed(false) }
}

/// The least and the largest value of an input in the scenarios, as far as there is something to look at; of words each by itself.
fn over_scenarios(study: &Study, is_uncertain: bool, (number, axis): (usize, &Axis), column: usize) -> Vec<GivenRange> {
    let input = axis.inputs()[column];
    let described = &study.model.inputs[input];
    if described.is_enumeration() || axis.has_number(column, |it| described.word_for(it).is_some()) {
        let is_told = matches!(axis, Axis::Single { .. }) && (2..PLACES).contains(&axis.count());
        return is_told.then_some(GivenRange::Alone { is_uncertain, axis: number }).into_iter().collect();
    }
    let (least, largest) = axis.ends(column);
    let (low, high) = slider_ends(described, least, largest);
    // A logarithmic range cannot begin at zero.
    let low = if axis.is_logarithmic() { low.max(least / FURTHEST_FACTOR) } else { low };
    // An end of a list goes as far as the value next to it, which would be the end beyond. The levels of a range move with its end.
    let (mut after_least, mut before_largest) = (largest, least);
    for value in listed(axis, column) {
        if value > least {
            after_least = after_least.min(value);
        }
        if value < largest {
            before_largest = before_largest.max(value);
        }
    }
    let end = |is_largest: bool, from: f64, to: f64| {
        let own = if is_largest { largest } else { least };
        let (from, to) = if described.integer { neighbours(own, from, to) } else { (from, to) };
        ScenarioEnd { is_uncertain, axis: number, input, is_largest, from, to }
    };
    // A single value may be any.
    let ends =
        if least == largest { vec![end(true, low, high)] } else { vec![end(false, low, after_least), end(true, before_largest, high)] };
    ends.into_iter().filter(|it| it.from < it.to && (it.to - it.from).is_finite()).map(GivenRange::End).collect()
}

/// The whole numbers around one that are looked at: a formula that adds up over very many teeth takes time and memory.
fn neighbours(own: f64, low: f64, high: f64) -> (f64, f64) {
    (low.ceil().max(own - NEIGHBOURS), high.floor().min(own + NEIGHBOURS))
}

/// The means of the distributions. What is proven of a yield is proven of the distributions, not of the draws that are moved here.
fn means(study: &Study) -> Vec<GivenRange> {
    let Some(probability) = study.probability.as_ref().filter(|it| !it.enclosure) else { return Vec::new() };
    let range = |(drawn, it): (usize, &UncertainInput)| {
        let (mean, sd) = (it.mean(), it.distribution.sd());
        let valid = &study.model.inputs[it.input].valid;
        let (least, largest) = match it.effect {
            Effect::Is => (valid.low, valid.high),
            Effect::Times => (0.0, f64::INFINITY),
            Effect::Plus => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let (from, to) = ((mean - MOST_SDS * sd).max(least), (mean + MOST_SDS * sd).min(largest));
        (from < to && (to - from).is_finite()).then_some(GivenRange::Mean { drawn, from, to })
    };
    probability.inputs.iter().enumerate().filter_map(range).collect()
}

/// The values of an input, unless they are a range.
fn listed(axis: &Axis, column: usize) -> Vec<f64> {
    match axis {
        Axis::Joint { rows, .. } => rows.iter().map(|row| row[column]).collect(),
        Axis::Single { levels: Levels::List(values), .. } => values.clone(),
        Axis::Single { .. } => Vec::new(),
    }
}

/// The range of the slider of a fixed number; the words of an input that takes no numbers, and of one that has a word now some numbers.
fn fixed_range(study: &Study, input: usize) -> Option<Axis> {
    let (described, value) = (&study.model.inputs[input], study.fixed[input]);
    let (low, high) = ends_of_fixed(study, input);
    let words = described.words.iter().map(|it| it.1);
    if described.word_for(value).is_some() {
        let place = |at: u32| low + (high - low) * f64::from(at) / f64::from(NUMBERS - 1);
        // They are written out beside the words: four digits do.
        let short = |it: f64| if described.integer { it.round() } else { format!("{it:.3e}").parse().unwrap_or(it) };
        let mut numbers: Vec<f64> = (0..NUMBERS).map(place).map(short).collect();
        numbers.retain(|&it| !described.is_enumeration() && it.is_finite() && described.valid.contains(it));
        numbers.dedup();
        let levels: Vec<f64> = words.chain(numbers).collect();
        return (levels.len() > 1).then_some(Axis::Single { input, levels: Levels::List(levels) });
    }
    if !(high - low).is_finite() || !(low..=high).contains(&value) {
        return None;
    }
    let levels = if described.integer {
        let (from, to) = neighbours(value, low, high);
        Levels::Step { from, step: 1.0, count: (to - from).max(0.0) as u64 + 1, log: false }
    } else {
        Levels::Continuous { from: low, to: high, log: false }
    };
    (low < high && levels.count() > 1).then_some(Axis::Single { input, levels })
}

/// The inputs that have one value.
pub fn fixed_inputs(study: &Study) -> impl Iterator<Item = usize> {
    // A tolerance that is a part of the model has an input of its own.
    let is_drawn = |input: usize| {
        let name = &study.model.inputs[input].name;
        study.probability.as_ref().is_some_and(|it| it.inputs.iter().any(|it| it.input == input || it.name == *name))
    };
    let varies = |input: usize| {
        let mut axes = study.design.iter().chain(study.operating()).chain(&study.uncertainty);
        axes.any(|axis| axis.inputs().contains(&input))
    };
    let inputs = &study.model.inputs;
    (0..inputs.len()).filter(move |&input| !varies(input) && !is_drawn(input))
}

/// Between which ends the slider of such an input runs.
pub fn ends_of_fixed(study: &Study, input: usize) -> (f64, f64) {
    let (described, value) = (&study.model.inputs[input], study.fixed[input]);
    let centre = if described.word_for(value).is_some() { described.usual.0 } else { value };
    slider_ends(described, centre, centre)
}

/// Between which ends a slider runs: what the source covers and what the study says, within what the formula accepts.
pub fn slider_ends(input: &Input, least: f64, largest: f64) -> (f64, f64) {
    let width = if input.word_for(least).is_some() || input.word_for(largest).is_some() { 0.0 } else { largest - least };
    let (usual_low, usual_high) = if (input.usual.1 - input.usual.0).is_finite() {
        input.usual
    } else {
        // A variable of the study without a range of its own: as far again, and not through zero.
        let reach = if width > 0.0 { width } else { largest.abs() };
        let low = least - reach;
        (if least >= 0.0 { low.max(0.0) } else { low }, largest + reach)
    };
    let (mut low, mut high) = (usual_low.min(least), usual_high.max(largest));
    if width > 0.0 {
        (low, high) = (low.max(least - 2.0 * width), high.min(largest + 2.0 * width).max(largest));
    }
    let inside = |value: f64, towards: f64| if input.valid.contains(value) { value } else { towards };
    (inside(low, least.min(usual_low).max(low + 1e-3 * (high - low))), inside(high, largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_goes_as_far_as_the_slider_and_the_next_value() {
        let text = "model = \"metal-cvt\"\n[design]\nband_count = [6, 9]\n[operation]\nasked_Nm = [70, 150]\n[fixed]\nshare = 1.1\ntraction = 0.4\n\
                    [formulas]\ntorque_Nm = \"asked_Nm * share\"\n[objectives]\naxial_force_N = \"min\"\n";
        let study_of_text = |text: &str| Study::parse(text).unwrap_or_else(|errors| panic!("{errors}"));
        let study = study_of_text(text);
        let single = study_of_text(&text.replace("[70, 150]", "[150]"));
        let ends = |given: &[GivenRange]| -> Vec<(bool, f64, f64)> {
            given.iter().filter_map(|it| if let GivenRange::End(it) = it { Some((it.is_largest, it.from, it.to)) } else { None }).collect()
        };
        assert_eq!(ends(&given_ranges(&single, text).said), [(true, 0.0, 300.0)]);
        let given = given_ranges(&study, text);
        assert_eq!(ends(&given.said), [(false, 0.0, 150.0), (true, 70.0, 230.0)]);
        // The file fixes two numbers, of which one is an input of the formula alone.
        assert_eq!(given.said.len(), 4, "{given:?}");
        // With three cases the largest is at least the second.
        let three = study_of_text(&text.replace("[70, 150]", "[70, 120, 150]"));
        assert_eq!(ends(&given_ranges(&three, text).said), [(false, 0.0, 120.0), (true, 120.0, 230.0)]);
    }

    #[test]
    fn a_logarithmic_range_stays_above_zero_and_a_mean_goes_to_the_end_of_what_is_valid() {
        let text = "model = \"metal-cvt\"\n[design]\nband_count = [6, 9]\n[operation]\ndriver_speed_rpm = { from = 1000, to = 6000, count = 5, spacing = \"log\" }\n\
                    [uncertainty]\nfriction = { uniform = [0.01, 0.15] }\n[probability]\ndraws = 64\n[fixed]\ntraction = 0.4\n[constraints]\nslip_margin = { min = 0 }\n\
                    yield = { min = 0.5 }\n[objectives]\nyield = \"max\"\naxial_force_N = { goal = \"min\", over_draws = \"mean\" }\n";
        let study = Study::parse(text).unwrap_or_else(|errors| panic!("{errors}"));
        let given = given_ranges(&study, text);
        let least = given.said.iter().find_map(|it| match it {
            GivenRange::End(end) if !end.is_largest => Some(end.from),
            _ => None,
        });
        assert_eq!(least, Some(100.0), "{given:?}");
        let means: Vec<_> =
            given.said.iter().filter_map(|it| if let GivenRange::Mean { from, to, .. } = it { Some((*from, *to)) } else { None }).collect();
        // Six standard deviations of 0.14/sqrt(12) below 0.08 there is no friction.
        assert!(means.len() == 1 && means[0].0 == 0.0 && (means[0].1 - (0.08 + 6.0 * 0.14 / 12_f64.sqrt())).abs() < 1e-9, "{means:?}");
    }

    #[test]
    fn whole_numbers_and_what_the_file_leaves_out_have_slices_too() {
        let text = "model = \"metal-cvt\"\n[design]\nband_thickness_mm = [0.15, 0.2]\n[fixed]\nband_count = 9\n[objectives]\naxial_force_N = \"min\"\n";
        let study = Study::parse(text).unwrap_or_else(|errors| panic!("{errors}"));
        let given = given_ranges(&study, text);
        let band_count = study.model.input("band_count").expect("it is an input");
        let [GivenRange::Fixed(Axis::Single { input, levels: Levels::Step { from, step, count, .. } })] = &given.said[..] else {
            panic!("{given:?}")
        };
        assert!(*input == band_count && from.fract() == 0.0 && *step == 1.0 && *count > 9, "{given:?}");
        let named = |name: &str| given.defaults.iter().any(|it| matches!(it, GivenRange::Fixed(it) if it.name(&study.model) == name));
        assert!(named("friction") && named("elastic_modulus_MPa") && !named("band_count") && !named("band_thickness_mm"), "{given:?}");
    }
}
