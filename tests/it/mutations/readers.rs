//! The readers under test: each function takes something that may have been mangled, must end without a panic, and returns whether it was
//! understood. The fuzz targets call the same functions.

use beltspace::checkpoint::{Checkpoint, Saved};
use beltspace::directory::{self, Contents};
use beltspace::export::Certified;
use beltspace::merge::{check_set, merge};
use beltspace::models::evaluate;
use beltspace::names::CHECKPOINT;
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::report::{Request, of_result, study_of};
use beltspace::result_files::result_files;
use beltspace::screen::{Control, Tables, Tally};
use beltspace::study::{Study, Thresholds, read_model};
use beltspace::sweep::{Settings, sweep};
use std::path::Path;
use std::time::Duration;

/// Longest text of all errors of a study.
const MOST_SHOWN: usize = 1 << 18;

/// A study text.
pub fn study(text: &str, folder: &Path) -> bool {
    match Study::parse_in(text, "study.toml", folder) {
        Ok(study) => planned(study),
        Err(errors) => {
            assert!(errors.to_string().len() < MOST_SHOWN, "the errors fill the screen");
            return false;
        }
    }
    true
}

/// A table of values that a study names.
pub fn table(csv: &[u8], folder: &Path) -> bool {
    std::fs::write(folder.join("table.csv"), csv).expect("it can be written");
    let study_text = "model = \"metal-cvt\"\n[design]\nband_count = [8, 10]\n[operation]\ncases = { csv = \"table.csv\" }\n\
                      [objectives]\nslip_margin = \"max\"\n";
    study(study_text, folder)
}

/// The file of a model that a study names.
pub fn model(text: &[u8], folder: &Path) -> bool {
    let path = folder.join("brake.toml");
    std::fs::write(&path, text).expect("it can be written");
    if let Ok(model) = read_model(&path) {
        let _ = evaluate(&model, &model.defaults());
    }
    let study_text = "model = \"brake.toml\"\n[design]\nrows = [1, 2]\n[operation]\nspeed_rpm = [0, 900]\n[objectives]\nrows = \"max\"\n";
    study(study_text, folder)
}

/// A result directory.
pub fn result(folder: &Path) -> bool {
    if let Ok(contents) = Contents::of(folder) {
        let _ = contents.own_files();
    }
    let Ok(study) = study_of(folder) else { return false };
    let plan = Plan::new(study);
    let patience = Duration::from_millis(100);
    let request = Request { folder, plan: &plan, evaluate: "beltspace eval study.toml --design {design}", threads: 1, patience };
    match of_result(&request, &Control::default()) {
        Ok(_) => true,
        Err(error) => {
            assert!(error.to_string().len() < MOST_SHOWN, "the error fills the screen");
            false
        }
    }
}

/// A result directory with a checkpoint: merged as a shard, then taken up as a run that goes on.
pub fn checkpoint(folder: &Path) -> bool {
    let Ok(saved) = Saved::read(&folder.join(CHECKPOINT)) else {
        let _ = directory::claim(folder, "a test");
        return false;
    };
    let plan = Plan::new(saved.study().clone());
    let (text, shard) = (saved.study_text().to_owned(), saved.shard());
    if !is_small(&plan) {
        return true;
    }
    let tables = Tables::new(&plan);
    let tally = Tally::new(&plan, &tables, 1);
    let reduction = Reduction::new(&plan, &tally.histogram_ranges(&plan));
    let shards = vec![(folder.to_owned(), saved)];
    if check_set(&shards).is_ok()
        && let Ok(state) = merge(&plan, &reduction, shards)
    {
        let _ = Certified::certify(&plan, state, Tally::new(&plan, &tables, 1), 1, &Control::default());
    }
    let Ok(taken) = directory::claim(folder, "a test") else { return false };
    let Ok(mut checkpoint) = Checkpoint::open(&taken.claim) else { return false };
    if checkpoint.adopt(&plan.study, &text, shard).is_err() {
        return false;
    }
    let options = Settings { threads: 1, shard, ..Settings::default() };
    let Ok(swept) = sweep(&plan, &tables, &reduction, &options, Some(&mut checkpoint), &Control::default()) else { return false };
    if shard.of == 1 {
        let _ = Certified::certify(&plan, swept.state, tally, 1, &Control::default());
    }
    true
}

/// A study that was understood is described, planned and, if that takes a moment only, swept.
fn planned(study: Study) {
    let described = study.describe();
    let back = Study::from_description(&described).map(|back| back.hash());
    assert_eq!(back, Ok(study.hash()), "what a study describes is not the study");
    let _ = (study.remarks(), result_files(&study));
    let plan = Plan::new(study);
    let _ = (plan.inert_axes(), plan.effort(), plan.kept_scenarios());
    if !is_small(&plan) {
        return;
    }
    let tables = Tables::new(&plan);
    let tally = Tally::new(&plan, &tables, 1);
    let reduction = Reduction::new(&plan, &tally.histogram_ranges(&plan));
    let options = Settings { threads: 1, ..Settings::default() };
    if let Ok(swept) = sweep(&plan, &tables, &reduction, &options, None, &Control::default()) {
        let _ = Certified::certify(&plan, swept.state, tally, 1, &Control::default());
    }
}

/// Is it swept in a moment?
fn is_small(plan: &Plan) -> bool {
    let report = &plan.study.report;
    let cells = report.maps.iter().map(|map| plan.study.design[map.x].count().saturating_mul(plan.study.design[map.y].count()));
    let lines = report.maps.iter().flat_map(|map| &map.contours).map(|it| match &it.at {
        Thresholds::At(values) => values.len(),
        Thresholds::Changes => 10,
    });
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    let seconds = plan.seconds_per_design() * plan.designs() as f64;
    let work = plan.designs().saturating_mul(plan.scenarios());
    seconds < 0.05 && work < 500_000 && cells.fold(0, u64::saturating_add) < 100_000 && lines.sum::<usize>() < 30
}
