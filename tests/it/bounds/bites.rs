//! The comparisons of these tests notice wrong results.

use super::ways::{difference, unaccounted, whole};
use crate::pipeline::parse;
use crate::pipeline::runs::Pipeline;
use beltspace::plan::Plan;
use beltspace::reduce::State;

const STUDY: &str = r#"model = "pulley-load"
[design]
mean_radius_mm  = { from = 40, to = 80, count = 21 }
slack_tension_N = { from = 100, to = 900, count = 33 }
[operation]
power_kW = [2, 3]
[constraints]
friction_margin = { min = 0 }
[objectives]
resultant_force_N = "min"
mean_radius_mm = "min"
[report]
top = { by = "resultant_force_N", count = 5 }
sample = 7
histograms = [{ of = "resultant_force_N", bins = 5 }]
maps = [{ x = "mean_radius_mm", y = "slack_tension_N", value = "resultant_force_N" }]
"#;

#[test]
fn a_wrong_count_a_lost_point_and_another_extreme_are_noticed() {
    let plan = Plan::new(parse(STUDY));
    let pipeline = Pipeline::new(&plan, STUDY);
    let (good, _) = whole(&pipeline, 1).expect("bounds serve it");
    assert_eq!(difference(&good, &good), None);
    assert!(good.front.len() >= 2 && good.feasible < plan.designs());
    let objection = |spoil: &dyn Fn(&mut State)| {
        let mut other = good.clone();
        spoil(&mut other);
        assert!(difference(&other, &good).is_some(), "it must object whichever comes first");
        difference(&good, &other).expect("it must object")
    };
    assert!(objection(&|state| state.feasible += 1).contains("designs are feasible"));
    let dimensions = good.front.keys.len() / good.front.len();
    let lost = objection(&|state| {
        state.front.indices.pop();
        state.front.keys.truncate(state.front.indices.len() * dimensions);
    });
    assert!(lost.contains("lost Some"), "{lost}");
    assert!(objection(&|state| state.front.keys[0] = state.front.keys[0].next_up()).contains("the front"));
    assert!(objection(&|state| state.front.indices[0] += 1).contains("the front"));
    for at in 0..2 {
        let moved = |state: &mut State| state.extremes.least[at].as_mut().expect("something is feasible").index += 1;
        assert!(objection(&moved).contains("the extremes"));
        let moved = |state: &mut State| state.extremes.largest[at] = None;
        assert!(objection(&moved).contains("the extremes"));
    }
    assert!(objection(&|state| state.reported.top.clear()).contains("the best"));
    assert!(objection(&|state| state.reported.histograms[0].above += 1).contains("histograms"));
    assert!(objection(&|state| state.reported.maps.clear()).contains("maps"));
    assert!(objection(&|state| state.reported.samples.clear()).contains("the sample"));
}

#[test]
fn a_certificate_that_does_not_add_up_is_noticed() {
    let plan = Plan::new(parse(STUDY));
    let pipeline = Pipeline::new(&plan, STUDY);
    let (_, good) = whole(&pipeline, 1).expect("bounds serve it");
    let designs = plan.designs();
    assert_eq!(unaccounted(&plan, &good, designs, designs), None);
    let mut more = good.clone();
    more.count.evaluated += 1;
    assert!(unaccounted(&plan, &more, designs, designs).is_some_and(|it| it.starts_with("the count settled")));
    for at in 0..good.searches.len() {
        let mut less = good.clone();
        less.searches[at].1.evaluated -= 1;
        assert!(unaccounted(&plan, &less, designs, designs).is_some_and(|it| it.starts_with("the search for")));
    }
    let mut less = good.clone();
    less.tallies[0].1.evaluated += 1;
    assert!(unaccounted(&plan, &less, designs, designs).is_some_and(|it| it.starts_with("the histogram of resultant_force_N settled")));
    less.tallies.clear();
    assert!(unaccounted(&plan, &less, designs, designs).is_some_and(|it| it.contains("tallies")));
    let mut fewer = good.clone();
    fewer.searches.pop();
    assert!(unaccounted(&plan, &fewer, designs, designs).is_some_and(|it| it.contains("searches")));
    assert!(unaccounted(&plan, &good, designs - 1, designs).is_some() && unaccounted(&plan, &good, designs, designs + 1).is_some());
}
