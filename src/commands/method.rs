//! The choice between judging every design and bounding boxes of them.

use crate::cli::{Engine, Method};
use crate::terminal::span;
use beltspace::bounds::refusal;
use beltspace::error::{Error, Result};
use beltspace::plan::Plan;

/// Seconds that judging every design may take before bounds are thought of.
const LONG: f64 = 60.0;

/// How designs are judged, and why.
pub struct Chosen {
    pub bounds: bool,
    pub why: String,
}

/// Chooses; what was asked for and cannot be is a wrong request.
#[allow(clippy::cast_precision_loss, reason = "an estimate")]
pub fn choose(plan: &Plan, method: Method, engine: Engine, adapter: Option<&str>, threads: usize) -> Result<Chosen> {
    let exhaustive = |why: String| Ok(Chosen { bounds: false, why });
    let wants_a_gpu = engine == Engine::Gpu || adapter.is_some();
    match method {
        Method::Exhaustive => exhaustive("asked for".to_owned()),
        Method::Bounds if wants_a_gpu => {
            let what = adapter.map_or("--engine gpu".to_owned(), |name| format!("--adapter {name}"));
            Err(Error::Request(format!("--method bounds judges on the processor, but {what} was asked for; leave one of them out")))
        }
        Method::Bounds => match refusal(plan) {
            Some(why) => {
                Err(Error::Request(format!("--method bounds cannot serve this study: {why}; use --method exhaustive, or change the study")))
            }
            None => Ok(Chosen { bounds: true, why: "asked for".to_owned() }),
        },
        Method::Auto if wants_a_gpu => exhaustive("a GPU was asked for, and bounds are found on the processor".to_owned()),
        Method::Auto => {
            let seconds = plan.seconds_per_design() * plan.designs() as f64 / threads as f64;
            match refusal(plan) {
                Some(why) => exhaustive(format!("bounds cannot serve the study: {why}")),
                None if seconds < LONG => exhaustive("the study is small enough to judge every design".to_owned()),
                None => Ok(Chosen { bounds: true, why: format!("judging every design would take about {}", span(seconds)) }),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use beltspace::study::Study;

    fn grid(levels: &str) -> Plan {
        let text = include_str!("../../studies/metal-grid.toml").replace("count = 37", &format!("count = {levels}"));
        Plan::new(Study::parse(&text, "grid.toml", ".".as_ref()).expect("the study is right"))
    }

    #[test]
    fn auto_takes_bounds_where_every_design_takes_long_and_no_gpu_is_asked_for() {
        let auto = |levels, engine, adapter| choose(&grid(levels), Method::Auto, engine, adapter, 2).expect("auto serves all");
        let chosen = auto("560", Engine::Auto, None);
        assert!(chosen.bounds && chosen.why.starts_with("judging every design would take about "), "{}", chosen.why);
        for chosen in [auto("37", Engine::Auto, None), auto("560", Engine::Gpu, None), auto("560", Engine::Auto, Some("any"))] {
            assert!(!chosen.bounds, "{}", chosen.why);
        }
    }
}
