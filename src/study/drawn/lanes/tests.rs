//! A list and the drive's own loop have the same bits.

use super::*;
use crate::study::Study;

/// Designs of the blocks: enough for a list, also when half of them are left out, with idle lanes behind the last.
const COUNTS: [usize; 3] = [77, 301, 190];

/// Drives with their distributions, and can a list serve them?
pub(in crate::study::drawn) const STUDIES: [(&str, bool); 5] = [
    (
        r#"model = "metal-cvt"
        [design]
        strength_MPa = { from = 300, to = 700, count = 50 }
        band_thickness_mm = { from = 0.1, to = 0.3, count = 50 }
        groove_angle_deg = [20, 24]
        [operation]
        duty = { cases = [{ ratio = 0.5, share = 2 }, { ratio = 1, share = 5 }, { ratio = 2, share = 1 }], weight = "share" }
        torque_Nm = [60, 120]
        [uncertainty]
        friction = { normal = { mean = 0.09, sd = 0.01 }, from = 0.05, to = 0.14 }
        band_thickness_mm = { times = { normal = { mean = 1, sd = 0.05 } } }
        torque_Nm = { plus = { normal = { mean = 0, sd = 8 } } }
        [probability]
        draws = 300
        [constraints]
        slip_margin = { min = 0 }
        stress_margin = { min = 0, over_scenarios = "mean" }
        band_thickness_mm = { min = 0.12 }
        [objectives]
        yield = "max"
        axial_force_N = { goal = "min", over_draws = "worst" }
        max_stress_MPa = { goal = "min", over_draws = "mean", over_scenarios = "mean" }
        torque_capacity_Nm = { goal = "max", over_draws = "worst" }
        "#,
        true,
    ),
    (
        r#"model = "rubber-cvt"
        [design]
        belt_width_mm = { from = 35, to = 60, count = 50 }
        belt_thickness_mm = { from = 8, to = 12, count = 50 }
        [operation]
        ratio = [0.8, 1.4]
        [uncertainty]
        friction = { normal = { mean = 0.4, sd = 0.03 }, from = 0.3, to = 0.5 }
        belt_thickness_mm = { plus = { normal = { mean = 0, sd = 0.2 } } }
        [probability]
        draws = 200
        [constraints]
        slip_margin = { min = 0 }
        flank_pressure_MPa = { max = 3 }
        [objectives]
        yield = "max"
        axial_force_N = { goal = "min", over_draws = { quantile = 0.95 } }
        "#,
        true,
    ),
    (
        r#"model = "flat-belt"
        [formulas]
        spread_N = "shaft_load_N - 1.6 * tight_tension_N"
        [design]
        belt_width_mm = { from = 100, to = 200, count = 50 }
        tension_per_width_N_per_mm = { from = 8, to = 20, count = 50 }
        [operation]
        driver_speed_rpm = [1200, 2500]
        [uncertainty]
        friction = { normal = { mean = 0.6, sd = 0.1 }, from = 0.3, to = 0.9 }
        power_kW = { uniform = { from = 5, to = 25 } }
        tension_per_width_N_per_mm = { plus = { normal = { mean = 0, sd = 0.5 } } }
        [probability]
        draws = 150
        [constraints]
        slip_margin = { min = 0 }
        spread_N = { max = 300 }
        [objectives]
        yield = "max"
        shaft_load_N = { goal = "min", over_draws = { quantile = 0.5 } }
        "#,
        true,
    ),
    (
        // All that is judged hangs on what all designs share.
        r#"model = "metal-cvt"
        [design]
        strength_MPa = { from = 400, to = 900, count = 50 }
        [operation]
        ratio = [0.5, 1]
        [uncertainty]
        friction = { normal = { mean = 0.09, sd = 0.01 }, from = 0.05, to = 0.14 }
        [probability]
        draws = 150
        [constraints]
        axial_force_N = { max = 14700 }
        [objectives]
        yield = "max"
        "#,
        true,
    ),
    (
        // Tables would be written out.
        r#"model = "timing-belt"
        [design]
        tight_tension_N = { from = 120, to = 250, count = 50 }
        [operation]
        pulley_speed_rpm = [2000, 6000]
        [uncertainty]
        friction = { uniform = { from = 0.3, to = 0.55 } }
        [probability]
        draws = 20
        [constraints]
        peak_tooth_load_N = { max = 8 }
        [objectives]
        yield = "max"
        "#,
        false,
    ),
];

/// The results of all blocks, as bits, with the list or without, and was there a list.
fn results(study: &Study, kernel: &DrawnDrive, least: &[LeastCount], with_list: bool) -> (Vec<Vec<Vec<u64>>>, bool) {
    let base = &kernel.base;
    let fixed: Vec<f64> = base.inputs.iter().map(|it| input_to_si(it, it.default)).collect();
    let of_axes = study.design.iter().filter(|it| it.count() == 50).flat_map(|it| it.inputs()).copied();
    // Designs of a block have in common what the first stage reads.
    let varying: Vec<usize> = of_axes.filter(|&it| !kernel.depends().prepared.contains(it)).collect();
    assert!(!varying.is_empty(), "{:?}", study.design);
    let outputs: Vec<usize> =
        (0..kernel.statistics.len()).filter(|&it| !matches!(kernel.statistics[it].kind, StatisticKind::Confirmed(_))).collect();
    let conditions: Vec<usize> = (0..kernel.absentees().count()).collect();
    let absentees: Vec<usize> = kernel.absentees().collect();
    let wanted = outputs.iter().copied().chain(absentees).collect();
    let mut lanes = DrawnLanes::new(kernel, wanted);
    lanes.ask_for(least.to_vec());
    if !with_list {
        lanes.list = Some((varying.iter().copied().collect(), None));
    }
    let mut served = false;
    let blocks = COUNTS.iter().enumerate().map(|(block, &count)| {
        let padded = count.next_multiple_of(LANES);
        let mut inputs = fixed.clone();
        let angle = base.inputs.iter().position(|it| it.name == "groove_angle_deg").filter(|it| !varying.contains(it));
        angle.into_iter().for_each(|it| inputs[it] = input_to_si(&base.inputs[it], 20.0 + block as f64));
        let column = |(axis, &input): (usize, &usize)| {
            let (least, most) = study.design.iter().find(|it| it.inputs().contains(&input)).map(|it| it.ends(0)).expect("it has an axis");
            let share = |lane: usize| ((lane.min(count - 1) * (31 + 2 * axis) + 7 * block) % 101) as f64 / 100.0;
            (input, (0..padded).map(|lane| input_to_si(&base.inputs[input], least + (most - least) * share(lane))).collect())
        };
        let columns: Vec<(usize, Vec<f64>)> = varying.iter().enumerate().map(column).collect();
        let asked = Columns { count, varying: &columns, outputs: &outputs, conditions: &conditions };
        let mut results = vec![vec![0.0; padded]; outputs.len() + conditions.len()];
        lanes.run(kernel, &inputs, &asked, &mut results, &|_, _| None);
        served |= lanes.list.as_ref().is_some_and(|it| it.1.is_some());
        results.iter().map(|it| it[..count].iter().map(|it| it.to_bits()).collect()).collect()
    });
    (blocks.collect(), served)
}

#[test]
fn a_list_has_the_bits_of_the_drives_own_loop() {
    for (text, serves) in STUDIES {
        let study = Study::parse_in(text, "test.toml", ".".as_ref()).unwrap_or_else(|errors| panic!("{errors}"));
        let probability = study.probability.as_ref().expect("it has draws");
        let kernel = probability.drawn(None).expect("it can be drawn");
        let counted = (0..kernel.statistics.len()).find(|&it| kernel.statistics[it].kind == StatisticKind::Yield).expect("it is asked for");
        let draws = kernel.draws() as u64;
        let (plain, _) = results(&study, &kernel, &[], false);
        let mut counts: Vec<f64> = plain.iter().flat_map(|block| &block[0]).map(|it| f64::from_bits(*it)).collect();
        counts.sort_by(f64::total_cmp);
        assert!(counts.last().is_some_and(|it| *it > 0.0) && counts[0] < draws as f64, "{text}: {counts:?}");
        // About half of the designs are left out on the way.
        let middle = counts[counts.len() / 2] as u64;
        for least in [vec![], vec![LeastCount { statistic: counted, count: middle.max(1) }]] {
            let (own, _) = results(&study, &kernel, &least, false);
            let (listed, served) = results(&study, &kernel, &least, true);
            assert_eq!(served, serves, "{text}");
            for (block, (own, listed)) in own.iter().zip(&listed).enumerate() {
                for (result, (own, listed)) in own.iter().zip(listed).enumerate() {
                    let differs = own.iter().zip(listed).position(|(own, listed)| own != listed);
                    let told = |at: usize| format!("{} and {}", f64::from_bits(own[at]), f64::from_bits(listed[at]));
                    assert_eq!(differs.map(told), None, "result {result} of block {block}, least counts {least:?}: {text}");
                }
            }
        }
    }
}
