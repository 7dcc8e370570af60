//! Pulleys of the four section types as jobs for CalculiX, and how it is run.

use beltspace::models::find;
use beltspace::pulley::calculix::{ComparedQuantity, Job, compare, export};
use beltspace::pulley::section::{Fineness, SectionKind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// One element through the sheet, as in the smallest of the reference models.
pub const COARSE: Fineness = Fineness { through: 1, straight: 2.0, bend: 1.2, held: 2.0, solid: 2.5, harmonics: 24, every: false };

/// The preset of a type under the paper's loads.
pub fn job(kind: SectionKind, fineness: Fineness, sectors: usize) -> Job {
    let model = find("pulley").expect("there is such a model");
    let mut inputs = model.preset(kind.name()).expect("every type has a preset");
    inputs[model.input("friction_direction_deg").expect("it is an input")] = 45.0;
    let design = model.pulley_of(&inputs).expect("it is a pulley");
    // The deck's density is in t/mm^3.
    let density = design.density * 1e-12;
    Job { kind, dimensions: design.dimensions, fineness, case: design.case, poisson: design.poisson, density, sectors }
}

/// Where CalculiX is.
///
/// # Panics
/// If it is not on PATH.
pub fn calculix() -> PathBuf {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).map(|directory| directory.join("ccx")).find(|program| program.is_file());
    found.expect("ccx is on PATH (Debian package calculix-ccx)")
}

/// Exports, solves and compares; also returns the seconds that CalculiX took, and its CPU seconds.
pub fn solved(program: &Path, job: &Job, directory: &Path) -> (Vec<ComparedQuantity>, [f64; 2]) {
    export(job, directory).expect("the deck is written");
    let start = Instant::now();
    // The last lines are the shell's, with the CPU time of its children.
    let mut run = Command::new("sh");
    run.args(["-c", "\"$0\" -i pulley || exit 1; times"]).arg(program).current_dir(directory).env("OMP_NUM_THREADS", "2");
    let run = run.output().expect("the shell runs");
    let seconds = start.elapsed().as_secs_f64();
    let text = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{text}");
    let part = |word: &str| -> Option<f64> {
        let (minutes, seconds) = word.trim_end_matches('s').split_once('m')?;
        Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?)
    };
    let used = text.lines().last().unwrap_or_default().split_whitespace().filter_map(part).sum();
    (compare(directory).expect("the results are complete"), [seconds, used])
}

pub fn shown(rows: &[ComparedQuantity]) -> String {
    let mut text =
        "quantity,unit,harmonics,harmonics_same_section,calculix,difference_percent,difference_same_section_percent\n".to_owned();
    for row in rows {
        let numbers = [row.harmonic, row.same_section, row.calculix].map(|it| format!("{it:.6}"));
        let differences = [row.difference(), row.difference_on_same_section()].map(|it| format!("{it:.3}"));
        text += &format!("{},{},{},{}\n", row.quantity, row.unit, numbers.join(","), differences.join(","));
    }
    text
}
