//! The models behind `results/calculix`: minutes and gigabytes each. Needs `ccx` on PATH.
//!
//! Usage: `cargo bench --bench calculix -- FOLDER [MODEL]`; the tables go to the folder, and what CalculiX reads and writes below it.

#[path = "../tests/it/pulleys.rs"]
mod pulleys;

use beltspace::pulley::calculix::{Job, Sweep};
use beltspace::pulley::response::{LONGEST, View, respond};
use beltspace::pulley::section::{Fineness, SectionKind, mesh};
use beltspace::pulley::turn::Turn;
use pulleys::{COARSE, calculix, job, shown, solved};
use std::path::PathBuf;
use std::time::Instant;

/// Milliseconds that harmonics take for the same pulley at the usual fineness, the best of several runs on one core: mesh,
/// answers to unit loads, load case.
fn milliseconds_of_harmonics(job: &Job) -> f64 {
    let mut table = vec![0.0; LONGEST];
    let mut run = || {
        let start = Instant::now();
        let mesh = mesh(job.kind, &job.dimensions, &Fineness::USUAL).expect("the section is possible");
        let length = respond(&mesh, job.kind, &job.dimensions, job.poisson, &Fineness::USUAL, &mut table);
        let summary = Turn::new(View::new(&table[..length]), job.case).summary(None, [None; 2]);
        assert!(summary.largest.stress > 0.0);
        1e3 * start.elapsed().as_secs_f64()
    };
    (0..7).map(|_| run()).fold(f64::INFINITY, f64::min)
}

fn main() {
    // Cargo adds options of its own.
    let mut words = std::env::args().skip(1).filter(|word| !word.starts_with("--"));
    let out = PathBuf::from(words.next().expect("a folder for the tables"));
    let only = words.next();
    let program = calculix();
    let sheet = Fineness { through: 2, straight: 1.0, bend: 0.4, held: 0.7, solid: 1.6, harmonics: 24, every: true };
    let models = [
        ("pressed-cup-coarse", job(SectionKind::PressedCup, COARSE, 50)),
        ("pressed-cup-usual", job(SectionKind::PressedCup, Fineness::USUAL, Job::USUAL_SECTORS)),
        ("machined", job(SectionKind::Machined, sheet, 36)),
        // More and so shorter sectors, for the narrow stress beside the bolt heads at Br; fewer nodes in the section make up for them.
        ("machined-90-sectors", job(SectionKind::Machined, Fineness { solid: 4.0, bend: 1.0, ..sheet }, 90)),
        ("welded-discs", job(SectionKind::WeldedDiscs, sheet, 60)),
        ("double-groove", job(SectionKind::DoubleGroove, Fineness { straight: 1.5, ..sheet }, 60)),
        ("pressed-cup", job(SectionKind::PressedCup, sheet, 68)),
    ];
    for (name, job) in models.into_iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name)) {
        let mesh = mesh(job.kind, &job.dimensions, &job.fineness).expect("the section is possible");
        let (section, nodes) = (mesh.nodes.len(), Sweep::new(&mesh, job.sectors).nodes());
        let (rows, seconds) = solved(&program, &job, &out.join(format!("{name}.run")));
        let harmonics = milliseconds_of_harmonics(&job);
        let times = format!(
            "section_nodes,nodes,ccx_s,ccx_processor_s,harmonics_ms\n{section},{nodes},{:.1},{:.1},{harmonics:.1}\n",
            seconds[0], seconds[1]
        );
        println!("{name}\n{times}{}", shown(&rows));
        std::fs::write(out.join(format!("{name}.csv")), shown(&rows)).expect("the table is written");
        std::fs::write(out.join(format!("{name}.time.csv")), times).expect("the times are written");
    }
}
