//! Bounds against single designs: what the formula itself computes never leaves them.

use super::axes::{AXES, Span};
use super::bounder::Wanted;
use super::box_columns::BoxColumns;
use super::open::over;
use super::*;
use crate::models::{Set, find, to_si};
use crate::sample::mix;
use crate::study::study_of;
use crate::tape::CHUNK;
use std::sync::atomic::AtomicU64;

/// Studies with scenarios, words, kinks and axes of all kinds.
const STUDIES: &[(&str, &str)] = &[
    (
        "metal-cvt",
        "[design]\ngroove_angle_deg = { from = 18, to = 30, count = 9 }\nband_thickness_mm = { from = 0.1, to = 0.4, count = 7 }\n\
         traction = [0.5, \"limit\", 0.3]\n[operation]\nratio = { from = 0.5, to = 2.0, count = 5, spacing = \"log\" }\ntorque_Nm = [50, 150]\n\
         [uncertainty]\nfriction = { from = 0.065, to = 0.095, count = 3 }\n[constraints]\nslip_margin = { min = 0 }\nstress_margin = { min = 0 }\n\
         [objectives]\naxial_force_N = \"min\"\nstress_margin = \"max\"\ntorque_capacity_Nm = \"max\"\n",
    ),
    (
        "timing-belt",
        "[design]\nteeth_in_mesh = { from = 10, to = 14 }\ntight_tension_N = { from = 100, to = 400, count = 6 }\n\
         slack_tension_N = [0, 20, 90]\n[operation]\npulley_speed_rpm = { from = 2000, to = 7000, count = 6 }\n[uncertainty]\nfriction = [0.3, 0.5]\n\
         [objectives]\nboundary_tooth = \"max\"\npeak_tooth_load_complete_N = \"min\"\nlift_speed_rpm = \"max\"\n",
    ),
    (
        "pulley-load",
        "[design]\nmean_radius_mm = { from = 30, to = 90, count = 8 }\nwrap_angle_deg = { from = 60, to = 200, count = 7 }\n\
         [operation]\ncases = [{ power_kW = 3, speed_rpm = 3000 }, { power_kW = 5, speed_rpm = 2000 }, { power_kW = 1, speed_rpm = 6000 }]\n\
         [objectives]\nfriction_used = \"min\"\nresultant_force_N = \"min\"\n",
    ),
];

fn plans() -> impl Iterator<Item = Plan> {
    STUDIES.iter().map(|(model, text)| Plan::new(study_of(&find(model).expect("it is a model"), text).expect("the study is right")))
}

/// A random box of designs; all scenarios.
fn a_box(layout: &BoundedStudy, seed: u64) -> Spans {
    let mut spans = layout.axes.whole();
    for axis in 0..layout.axes.designs {
        let count = layout.axes.all[axis].count();
        let (a, b) = (mix(seed * 64 + axis as u64) % count, mix(seed * 64 + 32 + axis as u64) % count);
        // Often narrow: there bounds are tight, and wrong ones show.
        let b = if seed.is_multiple_of(2) { b } else { (a + b % 2).min(count - 1) };
        spans[axis] = Span { low: a.min(b) as u32, high: a.max(b) as u32 };
    }
    spans
}

/// An output by the formula itself.
fn by_formula(plan: &Plan, design: u64, scenario: u64, output: usize) -> f64 {
    let model = &plan.study.model;
    let si = to_si(model, &plan.space.inputs(design, scenario));
    let outputs = model.kernel.outputs(&model.kernel.prepared(&si), &si, Set::one(output));
    model.outputs[output].unit.from_si(outputs[output])
}

/// How badly a design does at worst.
fn worst(plan: &Plan, design: u64, output: usize, higher_is_worse: bool) -> f64 {
    let each = (0..plan.scenarios()).map(|scenario| by_formula(plan, design, scenario, output));
    each.fold(f64::NEG_INFINITY, |worst, value| worst.max(if higher_is_worse { value } else { -value }))
}

/// How many worst values leave bounds that were moved inwards by this fraction of their size.
fn outside(inwards: f64) -> (u32, u32) {
    let (mut looked, mut out) = (0, 0);
    for plan in plans() {
        let layout = BoundedStudy::new(&plan).expect("bounds serve it");
        let mut bounder = Bounder::new(&layout.tape, &layout.axes);
        for seed in 0..120 {
            let spans = a_box(&layout, seed);
            for objective in &plan.study.objectives {
                let Quantity::Output(output) = objective.quantity else { continue };
                let higher_is_worse = objective.goal == Goal::Min;
                let asked = AskedNumber::new(&layout.tape, NumberSource::of(objective.quantity, &plan, &layout.tape), higher_is_worse);
                let bounds = bounder.bounds(&asked, &over(&spans, &layout.axes.whole(), &layout.axes), Wanted::Both);
                let (rows, places) = layout.axes.rows(&spans, plan.fast.count());
                let width = plan.fast.count();
                let positions = rows.iter().flat_map(|row| places.iter().map(move |place| row * width + place));
                for position in positions.step_by(3) {
                    let value = worst(&plan, plan.design_at(position), output, higher_is_worse);
                    let room = inwards * (bounds.most - bounds.least).abs();
                    looked += 1;
                    out += u32::from(bounds.finite && !(value >= bounds.least + room && value <= bounds.most - room));
                }
            }
        }
    }
    (looked, out)
}

#[test]
fn the_worst_of_a_design_never_leaves_the_bounds_of_its_box() {
    let (looked, out) = outside(0.0);
    assert!(looked > 3000 && out == 0, "{out} of {looked}");
    assert!(outside(0.2).1 > looked / 20, "bounds that are too narrow are noticed");
}

#[test]
fn columns_have_the_bits_of_the_formula() {
    for plan in plans() {
        let layout = BoundedStudy::new(&plan).expect("bounds serve it");
        let mut columns = BoxColumns::new(&layout.tape, &layout.axes);
        for seed in 0..60 {
            let spans = a_box(&layout, seed);
            let scenario = mix(seed) % plan.scenarios();
            let mut at = spans;
            for (axis, (_, stride)) in (layout.axes.designs..).zip(plan.space.scenarios.dimensions()) {
                at[axis] = Span::at((scenario / stride % layout.axes.all[axis].count()) as u32);
            }
            let varying: Vec<usize> = (0..layout.axes.designs).filter(|&axis| !spans[axis].is_single()).collect();
            let size = layout.axes.count(&spans);
            for output in plan.used_outputs().iter() {
                let node = layout.tape.outputs[output].expect("the plan asks for it");
                let needed = layout.tape.list.needed_by(&[node]);
                columns.enter(&needed, &at, &varying);
                for first in (0..size).step_by(CHUNK) {
                    let count = (size - first).min(CHUNK as u64) as usize;
                    columns.chunk(&needed, first, count);
                    for lane in (0..count).step_by(5) {
                        let levels: [u32; AXES] = columns.levels(first + lane as u64);
                        let strides = layout.axes.all[..layout.axes.designs].iter().zip(levels);
                        let design = strides.map(|(axis, level)| u64::from(level) * axis.stride).sum();
                        let expected = by_formula(&plan, design, scenario, output);
                        let found = plan.study.model.outputs[output].unit.from_si(columns.value(node).at(lane));
                        assert!(found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan(), "{found} {expected}");
                    }
                }
            }
        }
    }
}

#[test]
fn bounds_of_one_operation_in_two_units_are_not_mixed_up() {
    let plan = plans().nth(1).expect("the timing belt is the second");
    let layout = BoundedStudy::new(&plan).expect("bounds serve it");
    let mut bounder = Bounder::new(&layout.tape, &layout.axes);
    let speed = plan.study.objectives[2].quantity;
    let NumberSource::Node(node, Some(unit)) = NumberSource::of(speed, &plan, &layout.tape) else {
        panic!("a speed has a unit of its own")
    };
    let whole = layout.axes.whole();
    let mut most = |source| bounder.bounds(&AskedNumber::new(&layout.tape, source, true), &whole, Wanted::Most).most;
    let (own, si) = (most(NumberSource::Node(node, Some(unit))), most(NumberSource::Node(node, None)));
    assert!(own.is_finite() && (own / unit.from_si(si) - 1.0).abs() < 1e-12 && (own / si - 1.0).abs() > 1.0, "{own} {si}");
}

#[test]
fn searches_that_share_find_the_same_and_leave_nothing_out() {
    let grid = "[design]\nfriction = { from = 0.06, to = 0.12, count = 14 }\ngroove_angle_deg = { from = 18, to = 30, count = 14 }\n\
        ratio = { from = 0.5, to = 2, count = 14 }\nband_thickness_mm = { from = 0.1, to = 0.4, count = 14 }\nband_count = { from = 4, to = 14 }\n\
        [fixed]\ntraction = \"limit\"\n[constraints]\ncapacity_axial_force_N = { max = 10000 }\ntorque_capacity_Nm = { above = 0 }\n\
        [objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n";
    let grid = Plan::new(study_of(&find("metal-cvt").expect("it is a model"), grid).expect("the study is right"));
    let (mut left, mut counted, mut sampled) = (0, 0, 0);
    let plans: Vec<Plan> = plans().chain([grid]).collect();
    // With few boxes noted, what is left is dropped on the way.
    for (plan, most_boxes) in plans.iter().flat_map(|plan| [(plan, 1 << 10), (plan, 4)]) {
        let layout = BoundedStudy::new(plan).expect("bounds serve it");
        let (tables, stop) = (Tables::new(plan), AtomicBool::new(false));
        let reduction = Reduction::new(plan, &[]);
        let whole = 0..plan.designs();
        let told = AtomicU64::new(0);
        let tell = |designs| {
            told.fetch_add(designs, Ordering::Relaxed);
        };
        let job = SearchJob { plan, reduction: &reduction, range: &whole, stop: &stop, progress: &|_| () };
        let telling = SearchJob { progress: &tell, ..job };
        let mut workers = vec![layout.worker(plan, &tables, &stop), layout.worker(plan, &tables, &stop)];
        let mut every = reduction.start();
        CpuEngine::new(plan, &tables).screen(whole.clone(), |block| reduction.absorb(&mut every, block));
        let (mut found, mut shared) = (reduction.start(), Shared::new(plan));
        shared.most_boxes = most_boxes;
        let all = BoundedStudy::sought(plan).len() as u64 * plan.designs();
        for (done, sought) in (1..).zip(BoundedStudy::sought(plan)) {
            // What is lost of the rest is missed.
            if let Some(rest) = shared.rest.as_ref().filter(|rest| !rest.boxes.is_empty()) {
                let mut less = Shared::new(plan);
                less.rest = Some(rest.clone());
                let lost = less.rest.as_mut().and_then(|rest| rest.boxes.pop()).expect("there is one");
                let searched =
                    layout.search_sharing(job, sought, &mut less, &mut workers, &mut reduction.start()).expect("nobody stops it");
                // Pairs are those of the whole.
                let missed = if searched.pairs > 0 { 0 } else { layout.axes.count(&lost) };
                assert_eq!(searched.designs() + missed, plan.designs());
                left += u32::from(missed > 0);
            }
            let searched = layout.search_sharing(telling, sought, &mut shared, &mut workers, &mut found).expect("nobody stops it");
            assert_eq!(searched.designs(), plan.designs(), "{sought:?}");
            assert!(searched.counted.is_none_or(|counted| counted == every.feasible), "{searched:?}");
            let told = told.load(Ordering::Relaxed);
            assert!((done * plan.designs()..=all).contains(&told), "{told} of {all} designs told after {done} searches");
        }
        assert_eq!(told.load(Ordering::Relaxed), all, "every search tells of every design once");
        let mut feasible = 0;
        let positions = layout.sample_of_infeasible(&shared);
        CpuEngine::new(plan, &tables).screen_some(&positions, |block| feasible += block.feasible_count);
        assert_eq!(feasible, 0);
        sampled += positions.len();
        if let Some((feasible, settled)) = layout.count_rest(&shared, &whole, 2, &stop, &|_| ()) {
            assert_eq!((feasible, settled.designs()), (every.feasible, plan.designs()));
            counted += 1;
        }
        let (mut expected, mut found) = (every.state(), found.state());
        // Nothing is counted by a search.
        (expected.feasible, found.feasible) = (0, 0);
        assert_eq!((&expected.front, &expected.extremes), (&found.front, &found.extremes));
    }
    assert!(sampled > 50, "{sampled} designs are held to be infeasible");
    assert!(left >= 1 && counted >= 2, "something is left to {left} later searches, and to {counted} counts");
}

#[test]
fn all_but_a_part_of_a_box_is_every_other_design_once() {
    let plan = plans().next().expect("there is one");
    let layout = BoundedStudy::new(&plan).expect("bounds serve it");
    let positions = |spans: &Spans| -> Vec<u64> {
        let width = plan.fast.count();
        let (rows, places) = layout.axes.rows(spans, width);
        rows.iter().flat_map(|row| places.iter().map(move |place| row * width + place)).collect()
    };
    for seed in 0..200 {
        let spans = a_box(&layout, seed);
        let mut part = spans;
        for axis in 0..layout.axes.designs {
            let (low, count) = (spans[axis].low, spans[axis].count());
            let (a, b) = (mix(seed ^ axis as u64) % count, mix(seed ^ (99 + axis as u64)) % count);
            part[axis] = Span { low: low + a.min(b) as u32, high: low + a.max(b) as u32 };
        }
        let mut rest = shared::Rest::default();
        rest.add_all_but(&part, &spans, &layout.axes);
        let mut found: Vec<u64> = rest.boxes.iter().chain([&part]).flat_map(positions).collect();
        found.sort_unstable();
        let mut expected = positions(&spans);
        expected.sort_unstable();
        assert_eq!(found, expected);
    }
}

#[test]
fn a_search_by_pairs_counts_the_feasible_designs_on_its_way() {
    // Nothing that is asked for depends on the torque. The bound is on the very end that is sought.
    let text = "[design]\nfriction = { from = 0.06, to = 0.12, count = 23 }\ngroove_angle_deg = { from = 18, to = 30, count = 21 }\n\
        ratio = { from = 0.5, to = 2, count = 20 }\nband_thickness_mm = { from = 0.1, to = 0.4, count = 19 }\nband_count = { from = 4, to = 14 }\n\
        torque_Nm = [50, 70, 90]\n[fixed]\ntraction = \"limit\"\n\
        [constraints]\ncapacity_axial_force_N = { max = 30000 }\ntorque_capacity_Nm = { above = 0 }\n\
        [objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n";
    let plan = Plan::new(study_of(&find("metal-cvt").expect("it is a model"), text).expect("the study is right"));
    let layout = BoundedStudy::new(&plan).expect("bounds serve it");
    let (tables, stop) = (Tables::new(&plan), AtomicBool::new(false));
    let reduction = Reduction::new(&plan, &[]);
    let whole = 0..plan.designs();
    let job = SearchJob { plan: &plan, reduction: &reduction, range: &whole, stop: &stop, progress: &|_| () };
    let mut workers = vec![layout.worker(&plan, &tables, &stop), layout.worker(&plan, &tables, &stop)];
    let mut found = reduction.start();
    let sought = Sought::Extreme { objective: 1, largest: true };
    let searched = layout.search(job, sought, &mut workers, &mut found).expect("nobody stops it");
    let mut every = reduction.start();
    CpuEngine::new(&plan, &tables).screen(whole.clone(), |block| reduction.absorb(&mut every, block));
    assert!(every.feasible > 0 && every.feasible < plan.designs() && every.feasible.is_multiple_of(3), "{}", every.feasible);
    assert_eq!((searched.counted, searched.designs()), (Some(every.feasible), plan.designs()));
    assert_eq!(found.extremes.largest[1], every.extremes.largest[1]);
}
