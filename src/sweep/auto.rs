//! The sweep that begins by bounds and leaves them where they do not pay.
//!
//! What bounds have counted is done; what they have found of the front serves the rest as a front to compare with. Either way the result is
//! that of every design judged one by one.

use super::bounds::{Settling, settle};
use super::costs::{Forecast, Speed, why_every_design};
#[cfg(feature = "gpu")]
use super::gpu::go_on;
#[cfg(not(feature = "gpu"))]
use super::no_device::go_on;
use super::watch::Leaving;
use super::{Control, DeviceRecord, OnDevice, Settings, SweepJob, SweepWork, Swept, judge};
use crate::bounds::Certificate;
use crate::checkpoint::{Checkpoint, Progress};
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::reduce::{Reduction, State};
use crate::screen::Tables;
use serde_json::{Value, json};
use std::time::Instant;

/// How the method is chosen while the sweep runs.
#[derive(Clone, Copy, Debug)]
pub struct Rule<'d> {
    /// How fast designs are judged one by one.
    pub speed: Speed,
    /// The device that judges them, if it is not the CPU.
    pub device: Option<&'d OnDevice>,
    /// When bounds are left.
    pub leaving: Leaving,
}

/// What settled the designs.
#[derive(Clone, Debug)]
pub enum Settler {
    /// Each was judged: so little was left to do that bounds were not begun.
    EveryDesign,
    /// Each was judged: a trial forecast that bounds would take longer for histograms and maps alone.
    Tried(Forecast),
    /// Bounds.
    Bounds(Certificate),
    /// Bounds, and then each of the others was judged.
    Both(Left),
}

/// How bounds were left.
#[derive(Clone, Debug)]
pub struct Left {
    /// What they were at.
    pub at: String,
    /// What was forecast then.
    pub forecast: Forecast,
    /// Designs that they had counted; these are not judged again.
    pub counted: u64,
    /// Designs that were judged one by one afterwards.
    pub judged: u64,
}

impl Left {
    /// As it stands in `run.json`.
    pub fn to_json(&self) -> Value {
        let Forecast { spent, settled, bounds, judging } = self.forecast;
        json!({
            "at": self.at, "seconds": spent, "settled_share": settled, "designs_counted": self.counted, "designs_judged": self.judged,
            // There is no number for what would never end.
            "seconds_promised": if bounds.is_finite() { Some(bounds) } else { None }, "seconds_of_judging": judging,
        })
    }
}

/// What came of such a sweep.
#[derive(Debug)]
pub struct Auto {
    /// What it found.
    pub swept: Swept,
    /// How.
    pub settler: Settler,
    /// What a device did in it, if one judged designs.
    pub device: Option<DeviceRecord>,
}

/// Sweeps a plan by bounds as long as they pay, then design by design, on a device if there is one. With a checkpoint, starts from what it
/// holds, however that was made.
///
/// # Errors
/// As [`sweep`](super::sweep), [`sweep_by_bounds`](super::sweep_by_bounds) and [`sweep_on_device`](super::sweep_on_device).
pub fn sweep_auto(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    options: &Settings,
    checkpoint: Option<&mut Checkpoint>,
    control: &Control,
    rule: &Rule<'_>,
) -> Result<Auto> {
    let start = Instant::now();
    let job = SweepJob { plan, tables, reduction, options, control };
    let mut work = SweepWork::begin(job, checkpoint)?;
    let designs = work.todo.count();
    let done = |state: State, settler, device| Auto { swept: Swept { state, designs, time: start.elapsed() }, settler, device };
    let is_measured = rule.leaving == Leaving::WhereTheyDoNotPay;
    // Of a study that is resumed little may be left.
    if is_measured && why_every_design(plan, rule.speed.of(designs, options.threads)).is_some() {
        let (state, device) = judge_rest(job, work, rule.device)?;
        return Ok(done(state, Settler::EveryDesign, device));
    }
    let leaving = Some((rule.leaving, rule.speed.of(1, options.threads)));
    let remains = match settle(job, &mut work, leaving)? {
        Settling::Done(state, certificate) => return Ok(done(state, Settler::Bounds(certificate), None)),
        Settling::Tried(forecast) => {
            control.judges(work.done.count());
            let (state, device) = judge_rest(job, work, rule.device)?;
            return Ok(done(state, Settler::Tried(forecast), device));
        }
        Settling::Left(remains) => remains,
    };
    control.judges(work.done.count());
    let judged = work.todo.count();
    let (state, device) = judge_rest(job, work, rule.device)?;
    if let Some(found) = &remains.found {
        agree(found, &state)?;
    }
    let left = Left { at: remains.at, forecast: remains.forecast, counted: remains.counted, judged };
    Ok(done(state, Settler::Both(left), device))
}

/// Judges what is left to do.
fn judge_rest(job: SweepJob<'_>, mut work: SweepWork<'_>, device: Option<&OnDevice>) -> Result<(State, Option<DeviceRecord>)> {
    let progress = Progress { done: work.done, state: work.reducers.state() };
    let checkpoint = work.checkpoint;
    if let Some(on) = device {
        let (swept, record) = go_on(job, Some(progress), checkpoint, on)?;
        return Ok((swept.state, Some(record)));
    }
    Ok((judge(job, SweepWork::new(job, progress, checkpoint))?, None))
}

/// What bounds had found, if it was all that the result names, must be what is named in the end.
fn agree(found: &State, judged: &State) -> Result<()> {
    if !found.names_all_of(judged) {
        return Err(Error::Disagreement("designs judged one by one are better than what bounds found".to_owned()));
    }
    Ok(())
}
