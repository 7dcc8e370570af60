//! A study swept by bounds in every way that must not affect the result, compared with the sweep design by design.

use crate::pipeline::runs::{Pipeline, options};
use crate::random::Random;
use beltspace::bounds::Certificate;
use beltspace::checkpoint::Checkpoint;
use beltspace::error::{Error, Result as Outcome};
use beltspace::files::Claim;
use beltspace::plan::Plan;
use beltspace::reduce::{FeasibleSample, Reported, State, Top};
use beltspace::study::Best;
use beltspace::sweep::{Control, Settings, Swept, sweep, sweep_by_bounds};
use beltspace::tiles::Shard;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Most times that a run is stopped before it may end.
const STOPS: u32 = 4;

/// The first thing in which two states differ.
pub fn difference(expected: &State, found: &State) -> Option<String> {
    if expected.feasible != found.feasible {
        return Some(format!("{} designs are feasible, not {}", expected.feasible, found.feasible));
    }
    if expected.front != found.front {
        let (all, indices) = (&expected.front.indices, &found.front.indices);
        let lost = all.iter().find(|index| !indices.contains(index));
        let added = indices.iter().find(|index| !all.contains(index));
        return Some(format!("the front has {} points, not {}; lost {lost:?}, added {added:?}", all.len(), indices.len()));
    }
    if expected.extremes != found.extremes {
        return Some(format!("the extremes are {:?}, not {:?}", expected.extremes, found.extremes));
    }
    let best = |state: &State| state.reported.top.first().map(Top::indices);
    if best(expected) != best(found) {
        return Some(format!("the best are {:?}, not {:?}", best(expected), best(found)));
    }
    let (expected, found) = (&expected.reported, &found.reported);
    if expected.histograms != found.histograms {
        return Some(format!("the histograms are {:?}, not {:?}", expected.histograms, found.histograms));
    }
    if expected.samples != found.samples {
        let drawn = |it: &Reported| it.samples.iter().map(FeasibleSample::indices).collect::<Vec<_>>();
        return Some(format!("the sample is {:?}, not {:?}", drawn(expected), drawn(found)));
    }
    if expected.maps.len() != found.maps.len() {
        return Some(format!("there are {} maps, not {}", expected.maps.len(), found.maps.len()));
    }
    let differing = expected.maps.iter().zip(&found.maps).enumerate().find(|(_, (map, other))| map != other);
    differing.map(|(number, (map, other))| {
        let (width, height) = map.size();
        let cell = (0..width * height).find(|&cell| map.cell(cell) != other.cell(cell));
        let [own, other] = [map, other].map(|map| cell.and_then(|cell| map.cell(cell)));
        format!("of the maps number {number} has {own:?} in cell {cell:?}, not {other:?}")
    })
}

/// What a certificate does not account for.
pub fn unaccounted(plan: &Plan, certificate: &Certificate, counted: u64, searched: u64) -> Option<String> {
    let count = &certificate.count;
    let sum = count.infeasible + count.feasible + count.products + count.pairs + count.evaluated;
    if sum != counted {
        return Some(format!("the count settled {sum} of {counted} designs: {count:?}"));
    }
    for (what, it) in &certificate.searches {
        let sum = it.infeasible + it.beaten + it.pairs + it.evaluated;
        if sum != searched {
            return Some(format!("the search for {what} settled {sum} of {searched} designs: {it:?}"));
        }
    }
    for (what, it) in &certificate.tallies {
        let sum = it.infeasible + it.feasible + it.products + it.pairs + it.evaluated;
        if sum != counted {
            return Some(format!("the {what} settled {sum} of {counted} designs: {it:?}"));
        }
    }
    let report = &plan.study.report;
    let shares = report.maps.iter().filter(|map| map.value == Best::Share).count();
    if certificate.tallies.len() != report.histograms.len() + shares {
        return Some(format!("there are {} tallies", certificate.tallies.len()));
    }
    let objectives = plan.study.objectives.len();
    let asked = [objectives > 0, report.top.is_some(), report.sample.is_some()].map(usize::from);
    let best = asked.iter().sum::<usize>() + report.maps.len() - shares;
    let searches = 2 * objectives + best;
    (certificate.searches.len() != searches).then(|| format!("there are {} searches, not {searches}", certificate.searches.len()))
}

/// One run by bounds.
pub fn by_bounds(
    pipeline: &Pipeline<'_>,
    options: &Settings,
    checkpoint: Option<&mut Checkpoint>,
    control: &Control,
) -> Outcome<(Swept, Certificate)> {
    sweep_by_bounds(pipeline.plan, &pipeline.tables, &pipeline.reduction, options, checkpoint, control)
}

/// One run design by design.
pub fn one_by_one(pipeline: &Pipeline<'_>, options: &Settings, checkpoint: Option<&mut Checkpoint>, control: &Control) -> Outcome<Swept> {
    sweep(pipeline.plan, &pipeline.tables, &pipeline.reduction, options, checkpoint, control)
}

/// The whole study by bounds, its certificate checked: each search by itself.
pub fn whole(pipeline: &Pipeline<'_>, threads: usize) -> Result<(State, Certificate), String> {
    whole_by(pipeline, Settings { threads, shares_judged: false, ..Settings::default() })
}

/// The same, where a search judges designs for those that follow.
pub fn whole_shared(pipeline: &Pipeline<'_>, threads: usize) -> Result<(State, Certificate), String> {
    whole_by(pipeline, Settings { threads, ..Settings::default() })
}

fn whole_by(pipeline: &Pipeline<'_>, options: Settings) -> Result<(State, Certificate), String> {
    let (swept, certificate) = by_bounds(pipeline, &options, None, &Control::default()).map_err(|error| error.to_string())?;
    let designs = pipeline.plan.designs();
    match unaccounted(pipeline.plan, &certificate, designs, designs) {
        Some(problem) => Err(problem),
        None => Ok((swept.state, certificate)),
    }
}

/// Shards, some by bounds and some design by design, merged.
pub fn sharded(pipeline: &Pipeline<'_>, random: &mut Random, folder: &Path) -> State {
    pipeline.sharded_by(random, folder, |random, options, checkpoint| {
        let (shard, control) = (options.shard, Control::default());
        if random.chance(0.3) {
            one_by_one(pipeline, options, Some(checkpoint), &control).unwrap_or_else(|error| panic!("shard {shard}: {error}"));
            return;
        }
        let found = by_bounds(pipeline, options, Some(checkpoint), &control);
        let (swept, certificate) = found.unwrap_or_else(|error| panic!("shard {shard}: {error}"));
        let range = shard.range(pipeline.plan.designs());
        let problem = unaccounted(pipeline.plan, &certificate, swept.designs, range.end - range.start);
        assert_eq!(problem, None, "shard {shard}");
        // A shard reports only its own designs, as when it is judged design by design.
        let foreign = swept.state.front.indices.iter().find(|&&design| !range.contains(&pipeline.plan.position_of(design)));
        assert_eq!(foreign, None, "shard {shard}");
    })
}

/// A run that is stopped again and again and continues with the other method each time; returns how often it was stopped.
pub fn stopped(pipeline: &Pipeline<'_>, random: &mut Random, text: &str, usual: Duration, folder: &Path) -> Result<(State, u32), String> {
    let plan = pipeline.plan;
    let claim = Claim::new(folder, "a test").expect("nobody has it");
    let mut checkpoint = Checkpoint::create(&claim, &plan.study, text, Shard::WHOLE, plan.designs()).expect("a folder can be made");
    let mut bounds = random.chance(0.5);
    for stops in 0.. {
        let control = Control::default();
        let patience = usual.mul_f64(random.between(0.0, 0.6));
        let options = Settings { shard: Shard::WHOLE, ..options(random, 7.max(plan.designs() / 2000)) };
        let (done, until) = (std::sync::atomic::AtomicBool::new(false), Instant::now() + patience);
        let result = std::thread::scope(|scope| {
            if stops < STOPS {
                scope.spawn(|| {
                    while Instant::now() < until && !done.load(Ordering::Relaxed) {
                        std::thread::sleep(Duration::from_micros(50));
                    }
                    control.stop.store(true, Ordering::Relaxed);
                });
            }
            let result = if bounds {
                by_bounds(pipeline, &options, Some(&mut checkpoint), &control).map(|(swept, _)| swept)
            } else {
                one_by_one(pipeline, &options, Some(&mut checkpoint), &control)
            };
            done.store(true, Ordering::Relaxed);
            result
        });
        match result {
            Ok(swept) => return Ok((swept.state, stops)),
            Err(Error::Stopped { .. }) if stops < STOPS => {}
            Err(error) => return Err(format!("after {stops} stops, by {}: {error}", if bounds { "bounds" } else { "single designs" })),
        }
        drop(checkpoint);
        checkpoint = Checkpoint::open(&claim).expect("what was done is kept");
        checkpoint.saved().require(&plan.study, Shard::WHOLE).expect("it is of this study");
        bounds = !bounds;
    }
    unreachable!("the last run is not stopped")
}
