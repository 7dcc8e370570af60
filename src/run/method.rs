//! The choice between judging every design and bounding boxes of them.

use super::{Engine, Judging};
use crate::bounds::{YieldBounds, refusal};
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::sweep::costs::{Speed, span, why_every_design};

/// The chosen method, and why it was chosen.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// Judge boxes of designs by bounds, rather than every design one by one?
    pub bounds: bool,
    /// If bounds were not asked for: how fast single designs are judged, so that bounds are given up if they are slower.
    pub leaves: Option<Speed>,
    /// The reason, for people.
    pub why: String,
}

impl Chosen {
    /// The engine to choose a device for. Bounds that are given up can be followed by a device, if one is likely to be taken.
    pub fn engine(&self, asked: Engine, on_a_device: bool) -> Engine {
        if self.bounds && (self.leaves.is_none() || !on_a_device) { Engine::Cpu } else { asked }
    }
}

/// Chooses the method, and finds out whether yields can be proven, if that is asked. `speed` measures how fast this many threads judge designs.
///
/// # Errors
/// [`Error::Request`] if the method that was asked for cannot be used, or if the yields of the study cannot be proven.
pub fn choose(
    plan: &Plan,
    method: Judging,
    engine: Engine,
    adapter: Option<&str>,
    threads: usize,
    speed: impl FnOnce() -> Speed,
) -> Result<Chosen> {
    YieldBounds::asked(&plan.study).map_err(|problem| Error::Request(problem.to_string()))?;
    let exhaustive = |why: String| Ok(Chosen { bounds: false, leaves: None, why });
    let wants_a_gpu = engine == Engine::Gpu || adapter.is_some();
    match method {
        Judging::Exhaustive => exhaustive("asked for".to_owned()),
        Judging::Bounds if wants_a_gpu => {
            let what = adapter.map_or("--engine gpu".to_owned(), |name| format!("--adapter {name}"));
            Err(Error::Request(format!("--method bounds judges on the CPU, but {what} was asked for; leave one of them out")))
        }
        Judging::Bounds => match refusal(plan) {
            Some(why) => {
                Err(Error::Request(format!("--method bounds cannot serve this study: {why}; use --method exhaustive, or change the study")))
            }
            None => Ok(Chosen { bounds: true, leaves: None, why: "asked for".to_owned() }),
        },
        Judging::Auto if wants_a_gpu => exhaustive("a GPU was asked for, and bounds are computed on the CPU".to_owned()),
        Judging::Auto => {
            let speed = speed();
            let seconds = speed.of(plan.designs(), threads);
            match why_every_design(plan, seconds) {
                Some(why) => exhaustive(why),
                None => {
                    let why = format!("judging every design would take about {}", span(seconds));
                    Ok(Chosen { bounds: true, leaves: Some(speed), why })
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    fn grid(levels: &str) -> Plan {
        let text = include_str!("../../studies/metal-grid.toml").replace("count = 37", &format!("count = {levels}"));
        Plan::new(Study::parse_in(&text, "grid.toml", ".".as_ref()).expect("the study is right"))
    }

    #[test]
    fn auto_takes_bounds_where_every_design_takes_long_and_no_gpu_is_asked_for() {
        // So many designs that a thread judges per second.
        let speed = || Speed { seconds: 1e-8, measured: true };
        let auto = |levels, engine, adapter| choose(&grid(levels), Judging::Auto, engine, adapter, 2, speed).expect("auto serves all");
        let chosen = auto("560", Engine::Auto, None);
        assert!(chosen.bounds && chosen.why == "judging every design would take about 90 min", "{}", chosen.why);
        assert_eq!(chosen.leaves, Some(speed()));
        for chosen in [auto("37", Engine::Auto, None), auto("560", Engine::Gpu, None), auto("560", Engine::Auto, Some("any"))] {
            assert!(!chosen.bounds && chosen.leaves.is_none(), "{}", chosen.why);
        }
    }
}
