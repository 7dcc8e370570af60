//! Why draws fail: counted again, draw by draw.

use super::brute::Brute;
use beltspace::Study;
use beltspace::export::DrawnTally;
use beltspace::plan::Plan;
use beltspace::screen::Control;
use std::collections::BTreeMap;

/// Belts that slip, are too weak, or cannot be drawn at all, in two cases and at two levels.
const STUDY: &str = r#"model = "metal-cvt"
[design]
clamping_force_N = [16000, 20000, 30000]
[operation]
cases = [{ torque_Nm = 90, ratio = 0.5 }, { torque_Nm = 90, ratio = 2.0 }]
[uncertainty]
friction     = { normal = { mean = 0.08, sd = 0.03 } }
torque_Nm    = { times = { uniform = [0.9, 1.1] } }
strength_MPa = [650, 800]
[probability]
draws   = 170
confirm = 16
[constraints]
slip_margin   = { min = 0.1 }
stress_margin = { min = 0.05 }
axial_force_N = { max = 29000 }
yield         = { min = 0.1 }
[objectives]
clamping_force_N = "min"
"#;

/// The same with nothing but what a drive says of itself.
fn by_brute_force(study: &Study) -> (u64, BTreeMap<String, u64>, Vec<(u64, u64)>) {
    let plan = Plan::new(study.clone());
    let brute = Brute::new(study);
    let drive = &study.probability.as_ref().expect("there are distributions").drive;
    let (mut holding, mut statuses, mut constraints) = (0, BTreeMap::new(), vec![(0, 0); drive.constraints.len()]);
    for design in 0..plan.designs() {
        for draw in 0..brute.draws() {
            let levels: Vec<_> = (0..plan.scenarios()).map(|level| brute.drawn(&plan.space.inputs(design, level), draw)).collect();
            let mut reasons: Vec<String> = levels.iter().flatten().filter_map(|it| it.reason(&drive.model)).collect();
            reasons.sort();
            reasons.dedup();
            let violated = |number: usize| {
                let constraint = &drive.constraints[number];
                levels.iter().any(|cases| cases.iter().all(|it| it.value(constraint.quantity).is_some()) && !brute.keeps(constraint, cases))
            };
            let violated: Vec<usize> = (0..constraints.len()).filter(|it| violated(*it)).collect();
            holding += u64::from(levels.iter().all(|it| brute.holds(it)));
            for &number in &violated {
                constraints[number].0 += 1;
                constraints[number].1 += u64::from(reasons.is_empty() && violated.len() == 1);
            }
            reasons.into_iter().for_each(|it| *statuses.entry(it).or_default() += 1);
        }
    }
    (holding, statuses, constraints)
}

#[test]
fn draws_are_counted_by_what_they_fail_at() {
    let study = Study::parse(STUDY).expect("a study");
    let (holding, statuses, constraints) = by_brute_force(&study);
    assert!(holding > 30 && statuses.len() >= 2 && constraints.iter().all(|it| it.0 > 0), "{holding} {statuses:?} {constraints:?}");
    for threads in [1, 3] {
        let tally =
            DrawnTally::new(&Plan::new(study.clone()), threads, &Control::default()).expect("it is counted").expect("there are draws");
        assert_eq!((tally.sampled, tally.of, tally.holding), (510, 510, holding));
        let seen: BTreeMap<String, u64> = tally.statuses.iter().filter(|it| it.1 > 0).cloned().collect();
        assert_eq!((seen, &tally.constraints), (statuses.clone(), &constraints));
    }
    // Those of each design are together those of all.
    let plan = Plan::new(study);
    let each = (0..plan.designs()).map(|design| DrawnTally::of_design(&plan, design, 2, &Control::default()).expect("it is counted"));
    let each: Vec<DrawnTally> = each.map(|it| it.expect("there are draws")).collect();
    let total = |of: &dyn Fn(&DrawnTally) -> u64| each.iter().map(of).sum::<u64>();
    assert_eq!((total(&|it| it.of), total(&|it| it.sampled), total(&|it| it.holding)), (510, 510, holding));
    for (number, (violated, alone)) in constraints.into_iter().enumerate() {
        assert_eq!((total(&|it| it.constraints[number].0), total(&|it| it.constraints[number].1)), (violated, alone));
    }
}

#[test]
fn a_study_without_distributions_has_no_draws_to_count() {
    let study =
        Study::parse("model = \"metal-cvt\"\n[design]\nband_count = [8]\n[objectives]\naxial_force_N = \"min\"\n").expect("a study");
    assert_eq!(DrawnTally::new(&Plan::new(study), 1, &Control::default()).expect("nothing is to do"), None);
}
