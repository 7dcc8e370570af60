//! Studies that suit bounds, larger than the random ones.

use super::{guarded, plain_difference};
use crate::pipeline::runs::{Pipeline, differing_file};
use crate::pipeline::{full, parse};
use beltspace::bounds::{Certificate, refusal};
use beltspace::plan::Plan;
use std::path::Path;

/// A study of the repository.
fn shipped(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = ["studies", "benches/studies"].map(|folder| root.join(folder).join(name)).into_iter().find(|path| path.exists());
    let path = path.unwrap_or_else(|| panic!("there is no study {name}"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A study with some text replaced.
fn changed(study: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(study.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "the study has no {from}");
        text.replace(from, to)
    })
}

/// Compares both methods, files included; says what settled the designs.
fn compare(text: &str, least: u64) -> Certificate {
    let plan = Plan::new(parse(text));
    assert_eq!(refusal(&plan), None, "{text}");
    assert!(plan.designs() >= least, "{} designs", plan.designs());
    let pipeline = Pipeline::new(&plan, text);
    let mut certificate = None;
    let result = guarded(|| {
        let (state, found) = plain_difference(&pipeline)?.ok_or("the front is over the budget")?;
        let folder = tempfile::tempdir().expect("a folder can be made");
        let (state_by_bounds, _) = super::ways::whole_shared(&pipeline, 3)?;
        let expected = pipeline.write(state, 1, &folder.path().join("expected"));
        let written = pipeline.write(state_by_bounds, 2, &folder.path().join("found"));
        certificate = Some(found);
        differing_file(&expected, &written).map_or(Ok(()), |name| Err(format!("{name} differs")))
    });
    result.unwrap_or_else(|problem| panic!("{problem}\n{text}"));
    certificate.expect("it was made")
}

/// Bounds evaluate only few designs of a large study.
fn pays(certificate: &Certificate, designs: u64) {
    let looks = certificate.boxes() + certificate.evaluations();
    assert!(looks < designs, "{looks} looks at {designs} designs");
}

#[test]
fn the_plain_grid_on_fewer_and_on_all_levels() {
    let text = shipped("metal-grid.toml");
    let levels = |count: u32| changed(&text, &[("count = 37", &format!("count = {count}"))]);
    let certificate = compare(&levels(13), 300_000);
    assert!(certificate.count.designs() == 13u64.pow(4) * 11);
    if full() {
        let certificate = compare(&text, 20_000_000);
        pays(&certificate, 37u64.pow(4) * 11);
    }
}

/// Where bounds settle little, designs are judged once for all that is sought, and only what is left is looked at again.
#[test]
fn searches_and_counts_share_what_is_judged() {
    let shared = |text: &str| {
        compare(text, 200_000);
        let plan = Plan::new(parse(text));
        super::ways::whole_shared(&Pipeline::new(&plan, text), 2).expect("it ends").1
    };
    let eight = shared(&changed(&shipped("eight-axes.toml"), &[("count = 6", "count = 5")]));
    let looks: Vec<u64> = eight.searches.iter().map(|(_, it)| it.evaluations).collect();
    // The front is searched first, and for itself.
    assert!(looks[1] >= 450_000 && looks[2..].iter().all(|&it| it == 0), "{looks:?}");
    assert_eq!((eight.count.boxes, eight.count.evaluations), (0, 0));
    let grid = changed(&shipped("metal-grid.toml"), &[("count = 37", "count = 14"), ("max = 30000", "max = 10000")]);
    let left = shared(&grid);
    let boxes: Vec<u64> = left.searches.iter().map(|(_, it)| it.boxes).collect();
    assert!(boxes[1] > 2 * boxes[3] && boxes[3] > 0, "{boxes:?}");
    assert!(left.count.boxes > 0 && left.count.boxes < boxes[1] && left.count.evaluated > left.count.designs() / 2, "{:?}", left.count);
    // What nothing but every design tells is judged too.
    let tallied = shared(&(grid + "[report]\nhistograms = [{ of = \"torque_capacity_Nm\", from = 10, to = 200, bins = 30 }]\n"));
    assert_eq!((tallied.tallies[0].1.boxes, tallied.tallies[0].1.evaluated), (0, 14u64.pow(4) * 11));
}

/// A histogram and the cells of a map, each counted as pairs of two groups of axes.
#[test]
fn bins_and_cells_of_the_plain_grid() {
    let levels = [
        ("0.12, count = 37", "0.12, count = 61"),
        ("30, count = 37", "30, count = 3"),
        ("2.0, count = 37", "2.0, count = 61"),
        ("0.4, count = 37", "0.4, count = 2"),
    ];
    let report = "[report]\nhistograms = [{ of = \"torque_capacity_Nm\", from = 10, to = 200, bins = 3 }]\n\
                  maps = [{ x = \"groove_angle_deg\", y = \"band_thickness_mm\", best = \"share\" }]\n";
    let certificate = compare(&(changed(&shipped("metal-grid.toml"), &levels) + report), 200_000);
    let pairs: Vec<_> = certificate.tallies.iter().map(|(name, it)| (name.as_str(), it.pairs > 0)).collect();
    assert_eq!(pairs, [("histogram of torque_capacity_Nm", true), ("map of feasible_share", true)], "{certificate:?}");
}

#[test]
fn the_belt_of_one_hundred_and_fifty_newton_metres() {
    let text = shipped("metal-cvt-traction.toml");
    let edits: &[_] = if full() { &[] } else { &[("count = 61", "count = 13"), ("count = 31", "count = 5"), ("count = 7", "count = 3")] };
    compare(&changed(&text, edits), 50_000);
}

/// Clamped by a force that does not know the friction: a root within the boxes, and an input by a formula.
#[test]
fn the_same_belt_under_a_clamping_force() {
    let text = shipped("metal-cvt.toml");
    let fewer = [("count = 61", "count = 13"), ("count = 31", "count = 3"), ("count = 7", "count = 3"), ("step = 0.005", "step = 0.02")];
    compare(&changed(&text, &fewer), 10_000);
    let text = shipped("rubber-cvt.toml");
    let fewer =
        [("count = 41", "count = 6"), ("step = 0.5 }", "step = 5 }"), ("step = 0.15 }", "step = 1.5 }"), ("step = 50 }", "step = 100 }")];
    compare(&changed(&text, &fewer), 2_000);
}

#[test]
fn the_rubber_belt_in_three_load_cases() {
    let text = shipped("rubber-cvt-traction.toml");
    let edits: &[_] = match full() {
        true => &[],
        false => {
            &[("count = 41", "count = 11"), ("step = 0.05 }", "step = 0.2 }"), ("step = 0.5 }", "step = 2 }"), ("count = 21", "count = 6")]
        }
    };
    compare(&changed(&text, edits), 10_000);
}

#[test]
fn the_accessory_pulley_with_scenarios() {
    let text = shipped("pulley-load.toml");
    let edits: &[_] = if full() { &[] } else { &[("step = 10 }", "step = 40 }"), ("step = 0.5 }", "step = 1 }")] };
    compare(&changed(&text, edits), 20_000);
}

/// The camshaft drive with one belt: cases of designs are no grid.
#[test]
fn the_camshaft_drive_of_twenty_teeth() {
    let text = shipped("timing-design.toml");
    let start = text.find("cases = [").expect("there are cases");
    let end = start + text[start..].find("\n]").expect("they end") + 2;
    let grid = format!("{}teeth_in_mesh = [20, 18]{}", &text[..start], &text[end..]);
    let edits: &[_] = match full() {
        true => &[("step = 5 }", "step = 10 }"), ("step = 4 }", "step = 8 }")],
        false => &[("step = 5 }", "step = 25 }"), ("step = 4 }", "step = 40 }"), ("step = 0.5 }", "step = 1 }")],
    };
    compare(&changed(&grid, edits), 500);
}

/// Studies that once gave a wrong result, reduced to what the failure needed.
const FOUND: [(&str, &str); 2] = [
    (
        "a chain began at a number of one axis that nothing else reads, and so was in no table",
        "model = \"rubber-cvt\"\n[design]\nelastic_modulus_MPa = { from = 631, to = 2012, count = 720 }\n\
         belt_width_mm = { from = 27.7, to = 95.1, count = 178 }\n[fixed]\nbelt_length_mm = 1220\ncentre_distance_mm = 281\n\
         [constraints]\ntorque_capacity_Nm = { above = 0 }\n[objectives]\nelastic_modulus_MPa = \"min\"\n",
    ),
    (
        "the walk along a timing belt counted teeth that only the other pulley has",
        "model = \"timing-belt\"\n[design]\nteeth_in_mesh = [18, 20]\nslack_tension_N = 100\ntight_tension_N = 200\n\
         [fixed]\npulley_speed_rpm = 6000\nfriction = 0.3\npitch_mass_g = 0.37\n[constraints]\nincomplete_teeth = { min = 0 }\n\
         [objectives]\nleast_tooth_load_N = \"max\"\n",
    ),
];

#[test]
fn what_once_differed_no_longer_does() {
    let differs = |(what, text): &(&str, &str)| {
        let plan = Plan::new(parse(text));
        let result = guarded(|| plain_difference(&Pipeline::new(&plan, text)).map(|_| ()));
        result.err().map(|problem| format!("{what}: {problem}\n{text}"))
    };
    let differing: Vec<String> = FOUND.iter().filter_map(differs).collect();
    assert!(differing.is_empty(), "{}", differing.join("\n"));
}
