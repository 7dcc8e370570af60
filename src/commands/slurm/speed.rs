//! How long a design takes here.

use beltspace::models::Effort;
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::screen::{CpuEngine, Tables};
use std::time::{Duration, Instant};

/// Places of the study that are tried, and how long each of them.
const PLACES: u64 = 5;
const MOMENT: Duration = Duration::from_millis(200);
/// Seconds that a piece between two looks at the clock should take, and most designs of one: those of a sweep.
const PIECE: f64 = 0.1;
const LARGEST: u64 = 1 << 16;
/// Seconds above which a single design is not tried.
const LONGEST: f64 = 1.0;

/// Seconds that a processor takes for a design, and how that is known.
///
/// At each place designs are judged one after another, as a shard does: what neighbours share is most of the work of some models.
#[allow(clippy::cast_precision_loss, reason = "an estimate")]
pub fn seconds_per_design(plan: &Plan) -> (f64, &'static str) {
    let Effort { prepare, finish } = plan.effort();
    let told = plan.seconds_per_design();
    if prepare + finish > LONGEST {
        return (told, "by what the model usually takes");
    }
    let tables = Tables::new(plan);
    let reduction = Reduction::new(plan, &vec![(0.0, 1.0); plan.study.report.histograms.len()]);
    let mut reducers = reduction.start();
    let mut engine = CpuEngine::new(plan, &tables);
    let piece = ((PIECE / told) as u64).clamp(1, LARGEST);
    let places = PLACES.min(plan.designs());
    let edge = |place: u64| (u128::from(plan.designs()) * u128::from(place) / u128::from(places)) as u64;
    let mut sum = 0.0;
    for place in 0..places {
        let (first, last) = (edge(place), edge(place + 1));
        let (start, mut at) = (Instant::now(), first);
        while at < last && (at == first || start.elapsed() < MOMENT) {
            let end = last.min(at + piece);
            engine.screen(at..end, |block| reduction.absorb(&mut reducers, block));
            at = end;
        }
        sum += start.elapsed().as_secs_f64() / (at - first) as f64;
    }
    (sum / places as f64, "measured over a moment")
}

#[cfg(test)]
mod tests {
    use super::*;
    use beltspace::models::{Model, find};
    use beltspace::study::Study;

    #[test]
    fn a_design_that_takes_seconds_is_not_tried_and_a_fast_one_is_measured() {
        let model = find("pulley-load").expect("it is a model");
        let of = |effort: Effort| {
            let mut study = Study::parse(model.starter, "study.toml", ".".as_ref()).expect("the starter is right");
            study.model = Box::leak(Box::new(Model { effort, ..*model }));
            let plan = Plan::new(study);
            (seconds_per_design(&plan), plan.seconds_per_design())
        };
        let ((seconds, how), told) = of(Effort { prepare: 60.0, finish: 0.0 });
        assert_eq!((seconds, how), (told, "by what the model usually takes"));
        // It says that it is slow and is not: that is noticed.
        let ((seconds, how), told) = of(Effort { prepare: 1e-5, finish: 1e-5 });
        assert!(how == "measured over a moment" && seconds > 0.0 && seconds < told / 3.0, "{seconds} {told}");
    }
}
