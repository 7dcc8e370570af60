//! The search in a few scenarios against the whole sweep.

use super::search::{FrontSearch, JudgedRows, WorkingSet};
use super::table::{WorstTable, free_plan};
use super::{Live, LiveAnswer};
use crate::certify;
use crate::error::Error;
use crate::keys::KeyRule;
use crate::plan::Plan;
use crate::reduce::{Points, beats};
use crate::run::{Engine, Judging, Options};
use crate::screen::{Control, Tables};
use crate::study::Study;
use crate::table::Data;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

const BELT: &str = "model = \"metal-cvt\"\n[design]\ngroove_angle_deg = { from = 18, to = 30, count = 5 }\n\
    band_thickness_mm = { from = 0.1, to = 0.3, count = 9 }\nband_count = { from = 6, to = 14 }\ntraction = { from = 0.3, to = 0.5, count = 5 }\n\
    [operation]\nratio = { from = 0.5, to = 2, count = 13, spacing = \"log\" }\ntorque_Nm = [50, 150]\n\
    [uncertainty]\nfriction = { from = 0.065, to = 0.095, count = 4 }\n[fixed]\nstrength_MPa = 800\n[constraints]\nslip_margin = { min = 0 }\nstress_margin = { min = 0 }\n\
    [objectives]\naxial_force_N = \"min\"\nstress_margin = \"max\"\nslip_margin = \"max\"\n[report]\ncolumns = [\"max_stress_MPa\"]\n";

/// Variants of it: what is replaced by what.
const VARIANTS: [&[(&str, &str)]; 9] = [
    &[],
    &[("stress_margin = { min = 0 }", "stress_margin = { min = 0.1, max = 0.85 }")],
    &[("slip_margin = { min = 0 }\n", ""), ("slip_margin = \"max\"", "band_count = \"min\"")],
    &[("\"min\"\nstress", "{ goal = \"min\", resolution = 500 }\nstress"), ("slip_margin = { min = 0 }", "slip_margin = { above = 0.05 }")],
    // The worst of a quantity in the middle of an axis, and one that is an objective both ways round.
    &[("slip_margin = \"max\"", "thrust_ratio = \"max\""), ("stress_margin = \"max\"", "max_stress_MPa = \"min\"")],
    // Nothing is feasible; one scenario; the clamping force in place of the traction, so that roots are solved.
    &[("slip_margin = { min = 0 }", "slip_margin = { min = 9 }")],
    &[
        ("count = 13, spacing = \"log\"", "count = 1"),
        ("to = 2,", "to = 0.5,"),
        ("[50, 150]", "[150]"),
        ("to = 0.095, count = 4", "to = 0.065, count = 1"),
    ],
    &[("traction = { from = 0.3, to = 0.5, count = 5 }", "clamping_force_N = { from = 20000, to = 50000, count = 5 }")],
    // A force that follows from scenarios and numbers in part.
    &[
        ("traction = { from = 0.3, to = 0.5, count = 5 }", "reserve = { from = 1.3, to = 1.8, count = 5 }"),
        ("[constraints]", "[formulas]\nclamping_force_N = \"reserve * torque_Nm * (1 + ratio) / (4 * 0.08 * 47.9[mm])\"\n[constraints]"),
    ],
];

fn changed(edits: &[(&str, &str)]) -> String {
    edits.iter().fold(BELT.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    })
}

/// A column with the bits of its numbers.
type NamedBits = (String, Vec<Option<u64>>);

/// Designs and values of the whole sweep's front, as far as they are numbers.
fn swept(study: &Study) -> (Vec<u64>, Vec<NamedBits>) {
    let options = Options::default().engine(Engine::Cpu).judging(Judging::Exhaustive).threads(2);
    let front = study.sweep(options).expect("it is swept").front;
    let mut designs = Vec::new();
    let mut columns = Vec::new();
    for column in front.columns {
        match column.data {
            Data::Whole(values) if column.name == "design_index" => designs = values.into_iter().flatten().collect(),
            Data::Whole(values) => columns.push((column.name, values)),
            Data::Number(values) => columns.push((column.name, values.into_iter().map(|it| it.map(f64::to_bits)).collect())),
            Data::Text(_) => {}
        }
    }
    (designs, columns)
}

#[test]
fn the_front_found_in_a_few_scenarios_is_that_of_the_whole_sweep() {
    for edits in VARIANTS {
        let study = Study::parse(&changed(edits)).unwrap_or_else(|errors| panic!("{edits:?}: {errors}"));
        let (designs, columns) = swept(&study);
        let plan = Plan::new(study);
        let control = Control::default();
        let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
        let set = search.first_set(u64::MAX).expect("nobody stops it");
        let (rows, set, _) = search.exact(set, &mut |_, _, _, _| Ok(())).expect("it is found");
        assert_eq!(rows.iter().map(|row| row.index).collect::<Vec<_>>(), designs, "{edits:?}");
        assert_eq!(designs.is_empty(), edits.iter().any(|(_, to)| to.contains("min = 9")), "{edits:?}: {designs:?}");
        let certified = search.certified(&rows).expect("the reference agrees");
        for (at, column) in search.columns().iter().enumerate() {
            let value = |name: &str| columns.iter().find(|(other, _)| other == name).map(|(_, values)| values);
            // A design input has its column among the inputs.
            let Some(scenarios) = value(&format!("{}_scenario", column.name)) else { continue };
            let seen: Vec<_> = rows.iter().map(|row| row.columns[at].value.map(f64::to_bits)).collect();
            assert_eq!(Some(&seen), value(&column.name), "{edits:?} {}", column.name);
            let seen: Vec<_> = certified.iter().map(|row| row.columns[at].value.map(|_| row.columns[at].scenario)).collect();
            assert_eq!(&seen, scenarios, "{edits:?} {}", column.name);
        }
        // Most of the scenarios were not needed, where there are many.
        assert!(plan.scenarios() < 100 || set.count(plan.scenarios()) < 60, "{edits:?}: {}", set.count(plan.scenarios()));
    }
}

#[test]
fn a_column_of_the_report_without_a_value_takes_no_design_away() {
    // Where nothing is asked of the drive there is no clamping safety; the objective is a mean, or the worst.
    let shipped = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/studies/variator-pressure.toml")).expect("a study");
    for text in [shipped.clone(), shipped.replace(", over_scenarios = \"mean\"", "")] {
        let study = Study::parse(&text).unwrap_or_else(|errors| panic!("{errors}"));
        let (designs, columns) = swept(&study);
        let safety = &columns.iter().find(|(name, _)| name == "clamping_safety").expect("a column").1;
        assert!(designs.len() > 50 && study.report.columns.len() == 4, "{} {}", designs.len(), safety.len());
        let plan = Plan::new(study);
        let control = Control::default();
        let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
        let set = search.first_set(u64::MAX).expect("nobody stops it");
        let mut seen_early = 0;
        let found = search.exact(set, &mut |search, set, points, _| {
            seen_early += search.in_few(set, points)?.len();
            Ok(())
        });
        let (rows, ..) = found.expect("it is found");
        assert_eq!(rows.iter().map(|row| row.index).collect::<Vec<_>>(), designs);
        assert!(seen_early > 0, "the first idea has them too");
        search.certified(&rows).expect("the reference agrees");
    }
}

#[test]
fn a_working_set_that_lacks_what_matters_is_filled_up() {
    let study = Study::parse(BELT).expect("it is right");
    let plan = Plan::new(study.clone());
    let control = Control::default();
    let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
    // The mildest scenario alone: the front there is another one.
    let mildest = search.only(plan.scenarios() - 1);
    let (in_few, _) = search.coarse_grid(&mildest, plan.designs()).expect("nobody stops it");
    let (rows, set, _) = search.exact(mildest, &mut |_, _, _, _| Ok(())).expect("it is found");
    let designs: Vec<u64> = rows.iter().map(|row| row.index).collect();
    assert!(!designs.is_empty() && in_few.indices.len() != designs.len());
    assert_eq!(designs, swept(&study).0);
    assert!(set.count(plan.scenarios()) > 1);
}

#[test]
fn designs_that_turn_out_to_be_worse_leave_their_place_to_what_they_beat() {
    let mut alone = 0;
    for edits in VARIANTS {
        let study = Study::parse(&changed(edits)).expect("it is right");
        let designs = swept(&study).0;
        let plan = Plan::new(study);
        let control = Control::default();
        let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
        let whole = search.first_set(u64::MAX).expect("nobody stops it");
        let scenarios: Vec<u64> = (0..plan.scenarios()).filter(|&it| whole.beyond(&search.only(it)).is_some()).collect();
        for scenario in scenarios {
            let Some(set) = whole.beyond(&search.only(scenario)).filter(|it| it.count(plan.scenarios()) > 0) else { continue };
            let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
            let (rows, used, next) = search.exact(set.clone(), &mut |_, _, _, _| Ok(())).expect("it is found");
            assert_eq!(rows.iter().map(|row| row.index).collect::<Vec<_>>(), designs, "{edits:?} without {scenario}");
            // The search has noticed that a scenario is missing, but could do without it.
            alone += usize::from(used == set && next != set);
            assert!(next == used || next.beyond(&used).is_some() || next == WorkingSet::all(), "{edits:?} without {scenario}");
        }
    }
    assert!(alone > 0, "every missing scenario had to join");
}

#[test]
fn where_no_design_can_be_judged_in_time_a_search_begins_with_the_ends_of_the_scenario_axes() {
    // Levels enough that a single design over all scenarios takes longer than a first idea may.
    let dense = changed(&[("count = 13, spacing = \"log\"", "count = 9001"), ("to = 0.095, count = 4", "to = 0.095, count = 301")]);
    let plan = Plan::new(Study::parse(&dense).expect("it is right"));
    assert_eq!(super::coarse::seeds(&plan, 2), 0);
    let control = Control::default();
    let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
    let set = search.first_set(0).expect("nobody stops it");
    let inputs = |scenario: u64, name: &str| {
        let mut values = plan.study.fixed.clone();
        plan.space.scenarios.set(scenario, &mut values);
        values[plan.study.model.input(name).expect("an input")]
    };
    let chosen = set.chosen(&plan);
    let numbers: Vec<u64> =
        chosen.iter().map(|&(slow, fast)| plan.slow_scenarios.source_index(slow) + plan.fast_scenarios.source_index(fast)).collect();
    assert!((4..=24).contains(&numbers.len()), "{numbers:?}");
    for (name, end) in [("ratio", 0.5), ("ratio", 2.0), ("friction", 0.065), ("friction", 0.095), ("torque_Nm", 50.0), ("torque_Nm", 150.0)]
    {
        assert!(numbers.iter().any(|&it| inputs(it, name) == end), "{name} {end}");
    }
    // With few scenarios the same beginning leads to the same front.
    let study = Study::parse(BELT).expect("it is right");
    let plan = Plan::new(study.clone());
    let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
    let set = search.first_set(0).expect("nobody stops it");
    let (rows, ..) = search.exact(set, &mut |_, _, _, _| Ok(())).expect("it is found");
    assert_eq!(rows.iter().map(|row| row.index).collect::<Vec<_>>(), swept(&study).0);
}

#[test]
fn a_study_whose_designs_take_long_has_first_ideas_of_few_of_them_or_of_few_draws() {
    let first = |name: &str, sets: &[&str]| {
        let text = std::fs::read_to_string(format!("{}/studies/{name}.toml", env!("CARGO_MANIFEST_DIR"))).expect("a study");
        let live = Live::new(text, name.to_owned(), PathBuf::from("."), 2);
        let sets: Vec<String> = sets.iter().map(|&it| it.to_owned()).collect();
        let plan = Plan::new(live.study(&sets).expect("it is right").0);
        let control = Control::default();
        let mut found = None;
        let stopped = live.answer(&plan, &control, &mut |step| {
            let LiveAnswer::Coarse(front, after) = step else { panic!("{name} has no first idea") };
            assert!(!front.rows.is_empty() && after.as_secs_f64() > 0.0, "{name}");
            found = Some((front.looked_at, front.draws, front.columns.len()));
            control.stop.store(true, Ordering::Relaxed);
            Ok(())
        });
        assert!(matches!(stopped, Err(Error::Stopped { .. })), "{name}: {stopped:?}");
        (plan, found.expect("it was told"))
    };
    let (plan, (looked_at, draws, _)) = first("pulley-design", &[]);
    assert!((4..plan.designs() / 50).contains(&looked_at), "{looked_at}");
    assert_eq!(draws, None);
    // The last draws are far more than can be looked at while somebody waits for a first picture.
    let (plan, (_, draws, columns)) = first("push-belt-yield", &[]);
    let all = plan.study.probability.as_ref().expect("it is drawn").draws;
    assert!(draws.is_some_and(|draws| (256..all / 2).contains(&draws)), "{draws:?}");
    assert_eq!(columns, certify::columns(&plan.study).len());
}

#[test]
fn a_coarse_front_is_that_of_the_designs_that_were_looked_at() {
    let mut compared = 0;
    for edits in VARIANTS {
        let plan = Plan::new(Study::parse(&changed(edits)).expect("it is right"));
        let control = Control::default();
        let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
        let set = search.first_set(u64::MAX).expect("nobody stops it");
        let most = plan.designs() / 5;
        let (points, looked_at) = search.coarse(&set, most).expect("nobody stops it");
        // The rows of the table that is begun, spread over all: one of eight at most.
        let free = free_plan(&plan.study);
        let width = free.fast.count();
        if width > most {
            continue;
        }
        let rows = free.slow.coarse((most / width).min(free.slow.count().div_ceil(8)));
        let mut designs = Points::default();
        for row in &rows {
            for place in 0..width {
                designs.push(std::iter::empty(), free.slow.source_index(*row) + free.fast.source_index(place));
            }
        }
        assert_eq!(looked_at, designs.len() as u64, "{edits:?}");
        let mut feasible = search.in_few(&set, &designs).expect("nobody stops it");
        feasible.retain(|row| search.holds(row));
        let rules: Vec<KeyRule> = plan.study.objectives.iter().map(KeyRule::from).collect();
        let places = certify::objective_columns(&plan.study, search.columns());
        let key = |row: &certify::Row| -> Vec<f64> {
            rules.iter().zip(&places).map(|(rule, &place)| rule.key(row.columns[place].value.expect("it is feasible"))).collect()
        };
        let keys: Vec<(Vec<f64>, u64)> = feasible.iter().map(|row| (key(row), row.index)).collect();
        let is_beaten = |it: &&(Vec<f64>, u64)| keys.iter().any(|other| beats(&other.0, other.1, &it.0, it.1));
        let mut wanted: Vec<u64> = keys.iter().filter(|it| !is_beaten(it)).map(|it| it.1).collect();
        let mut found = points.indices;
        wanted.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, wanted, "{edits:?}");
        compared += usize::from(found.len() > 3 && found.len() < feasible.len());
        // Judged once each, the designs of a grid have the same best ones.
        let (points, of) = search.coarse_grid(&set, most).expect("nobody stops it");
        let few = search.in_few(&set, &points).expect("nobody stops it");
        assert_eq!(search.best_of_grid(&set, most).expect("nobody stops it"), (few, of), "{edits:?}");
    }
    assert!(compared > 0, "of each a few designs are left, or all of them");
}

#[test]
fn a_table_that_takes_scenarios_in_is_that_of_all_of_them() {
    let plan = Plan::new(Study::parse(BELT).expect("it is right"));
    let (control, stop) = (Control::default(), AtomicBool::new(false));
    let mut search = FrontSearch::new(&plan, 2, &control, JudgedRows::default());
    let all = search.first_set(u64::MAX).expect("nobody stops it");
    let free = free_plan(&plan.study);
    let tables = Tables::new(&free);
    let width = usize::try_from(free.fast.count()).expect("few");
    let whole = |set: &WorkingSet| {
        let begun = WorstTable::begin(&free, &tables, set, 3, 2, &stop).expect("nobody stops it");
        begun.finish(&free, &tables, 2, &stop).expect("nobody stops it")
    };
    let other = (0..plan.scenarios()).map(|it| search.only(it)).find(|it| all.beyond(it).is_some()).expect("it has scenarios");
    assert!(all.beyond(&WorkingSet::all()).is_none() && other.beyond(&all).is_none());
    let small = whole(&other);
    let new = small.lacks(&free, &all).expect("it has fewer scenarios");
    let (joined, wanted) = (small.joined_by(&free, &tables, &new, 2, &stop).expect("nobody stops it"), whole(&all));
    assert!(joined.serves(&free, &all) && joined.lacks(&free, &all).is_none());
    assert_eq!(joined.values(width), wanted.values(width));
    assert_ne!(joined.values(width), small.values(width), "the other scenarios are worse for some designs");
    // A search whose table lacks scenarios judges in these alone, the time of which says nothing of all.
    let (_, used, _) = search.exact(other.clone(), &mut |_, _, _, _| Ok(())).expect("it is found");
    let swept = search.times().swept;
    assert!(swept.is_some_and(|(_, scenarios)| scenarios == 1) && search.lacks(&used) == Some(0));
    let another = (0..plan.scenarios()).map(|it| search.only(it)).find(|it| used.beyond(it).is_none()).expect("not all are in it");
    let more = used.joined_by(&another);
    assert!(search.lacks(&more) == Some(1) && search.lacks(&WorkingSet::all()).is_none());
    search.exact(more.clone(), &mut |_, _, _, _| Ok(())).expect("it is found");
    assert!(search.times().swept == swept && search.lacks(&more) == Some(0));
    // One that is only begun may take them in as well.
    let begun = WorstTable::begin(&free, &tables, &other, 3, 2, &stop).expect("nobody stops it");
    let begun = begun.joined_by(&free, &tables, &new, 2, &stop).expect("nobody stops it");
    assert_eq!(begun.finish(&free, &tables, 2, &stop).expect("nobody stops it").values(width), wanted.values(width));
    // Another study's table does not.
    let another = free_plan(&Study::parse(&changed(&[("[50, 150]", "[50, 140]")])).expect("it is right"));
    assert!(small.lacks(&another, &all).is_none());
}

#[test]
fn what_was_judged_serves_again_where_only_bounds_differ() {
    let control = Control::default();
    let mut before = JudgedRows::default();
    for (edits, serves) in [
        (&[][..], false),
        (&[("stress_margin = { min = 0 }", "stress_margin = { min = 0.2 }")], true),
        (&[("slip_margin = { min = 0 }", "slip_margin = { min = 0.1 }")], true),
        (&[("[50, 150]", "[50, 140]")], false),
    ] {
        let study = Study::parse(&changed(edits)).expect("it is right");
        let designs = swept(&study).0;
        let plan = Plan::new(study);
        let mut search = FrontSearch::new(&plan, 2, &control, before);
        assert_eq!(search.judged().is_empty(), !serves, "{edits:?}");
        let set = search.first_set(u64::MAX).expect("nobody stops it");
        let (rows, ..) = search.exact(set, &mut |_, _, _, _| Ok(())).expect("it is found");
        assert_eq!(rows.iter().map(|row| row.index).collect::<Vec<_>>(), designs, "{edits:?}");
        assert!(!designs.is_empty(), "{edits:?}");
        before = search.judged();
    }
}

#[test]
fn an_answer_comes_in_steps_and_ends_when_it_is_stopped() {
    let live = Live::new(BELT.to_owned(), "study.toml".to_owned(), PathBuf::from("."), 2);
    let (study, text) = live.study(&["constraints.slip_margin.min=0.1".to_owned()]).expect("it is right");
    assert!(text.contains("slip_margin = { min = 0.1 }"));
    let plan = Plan::new(study.clone());
    let mut steps = Vec::new();
    live.answer(&plan, &Control::default(), &mut |step| {
        steps.push(match step {
            LiveAnswer::Coarse(..) => "coarse".to_owned(),
            LiveAnswer::Few(_) => "few".to_owned(),
            LiveAnswer::Exact(found) => format!("exact {}", found.rows.len()),
            LiveAnswer::Certified(found) => format!("certified {}", found.rows.len()),
            LiveAnswer::Counted(found) => format!("counted {:?}", found.feasible),
        });
        Ok(())
    })
    .expect("it is answered");
    let outcome = study.sweep(Options::default().engine(Engine::Cpu)).expect("it is swept");
    let (front, feasible) = (outcome.counts.front, outcome.counts.feasible);
    let wanted = [format!("exact {front}"), format!("certified {front}"), format!("counted Some({feasible})")];
    assert_eq!(steps[steps.len() - 3..], wanted, "{steps:?}");
    let control = Control::default();
    control.stop.store(true, Ordering::Relaxed);
    let stopped = live.answer(&plan, &control, &mut |_| panic!("it was stopped"));
    assert!(matches!(stopped, Err(Error::Stopped { .. })), "{stopped:?}");
    let none = Live::new(
        "model = \"metal-cvt\"\n[design]\nband_count = [6]\n[report]\ntop = { by = \"axial_force_N\", count = 1 }\n".to_owned(),
        "s".to_owned(),
        PathBuf::new(),
        1,
    );
    assert!(none.study(&[]).is_err_and(|error| error.to_string().contains("no objective")));
}

#[test]
fn a_map_that_no_longer_says_what_it_shows_does_not_stand_in_the_way() {
    let text = BELT.to_owned() + "maps = [{ x = \"traction\", y = \"groove_angle_deg\", value = \"axial_force_N\" }]\n";
    let live = Live::new(text, "belt.toml".to_owned(), PathBuf::from("."), 1);
    let (study, text) = live.study(&["objectives.axial_force_N=off".to_owned()]).expect("it can be asked");
    assert!(study.report.maps.is_empty() && !text.contains("maps"));
    assert_eq!(live.study(&[]).expect("as it is").0.report.maps.len(), 1);
    // What else is wrong is told as it is.
    let error = live.study(&["strength_MPa=-5".to_owned()]).expect_err("no such strength");
    assert!(error.to_string().contains("strength_MPa"), "{error}");
}
