//! Sweeps and certifies a study with the chosen engine and method.

use super::Engine;
use super::device::{Trusted, supports_histograms, sweep_on_device};
use super::method::Chosen;
use crate::checkpoint::Checkpoint;
use crate::error::Result;
use crate::export::{Certified, MethodRecord};
use crate::plan::Plan;
use crate::reduce::Reduction;
use crate::screen::{Control, JudgedDesigns, Tables, Tally};
use crate::sweep::costs::span;
use crate::sweep::{DeviceRecord, Leaving, OnDevice, Rule, Settings, Settler, Swept, sweep, sweep_auto, sweep_by_bounds};
use crate::table::short;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// What judges the designs.
#[derive(Debug)]
pub enum How<'a> {
    /// The CPU, in f64.
    Cpu,
    /// A device. `true`: it was not asked for by name, so the CPU takes over if it cannot serve the study.
    Device(&'a OnDevice, bool),
    /// Bounds; with a rule that says when to give them up.
    Bounds(Option<Rule<'a>>),
}

impl<'a> How<'a> {
    /// With the chosen method and device, if any; `asked` and `adapter` are what the user said.
    pub fn new(method: &Chosen, device: Option<&'a Trusted>, asked: Engine, adapter: Option<&str>) -> Self {
        match device {
            _ if method.bounds => {
                let device = device.map(Trusted::on);
                Self::Bounds(method.leaves.map(|speed| Rule { speed, device, leaving: Leaving::WhereTheyDoNotPay }))
            }
            Some(device) => Self::Device(device.on(), asked == Engine::Auto && adapter.is_none()),
            None => Self::Cpu,
        }
    }
}

/// A study that has been judged.
#[derive(Debug)]
pub struct Judged<'p> {
    /// How long it took to judge the designs.
    pub time: Duration,
    /// Designs judged by this run; those of its checkpoint do not count.
    pub designs: u64,
    /// What is reported; `None` for a shard.
    pub certified: Option<Certified<'p>>,
    /// The work of a device, if one judged designs.
    pub did: Option<DeviceRecord>,
    /// What settled the designs.
    pub settler: Settler,
}

/// How designs were judged, for `run.json`.
pub fn record_of(why: String, settler: Settler) -> MethodRecord {
    let record = |name, certificate, left, why| MethodRecord { name, why, certificate, left };
    match settler {
        Settler::EveryDesign => record("exhaustive", None, None, why),
        Settler::Tried(_) => record("exhaustive", None, None, format!("{why}; bounds would take longer for its histograms and maps")),
        Settler::Bounds(certificate) => record("bounds", Some(certificate), None, why),
        Settler::Both(left) => {
            let (spent, share, judging) = (left.forecast.spent, 100.0 * left.forecast.settled, left.forecast.judging);
            let expected =
                if left.forecast.bounds.is_finite() { format!("another {}", span(left.forecast.bounds)) } else { "no end".to_owned() };
            let why = format!(
                "{why}; after {} bounds had done {} % of their work and expected {expected}, judging the rest one by one takes {}",
                span(spent),
                short((share * 10.0).round() / 10.0),
                span(judging),
            );
            record("bounds, then exhaustive", None, Some(left), why)
        }
    }
}

/// Sweeps the study and, if it is `whole`, certifies what is to be reported; the result of a shard is its checkpoint. `remark` is told when
/// the CPU takes over from a device that was not asked for by name.
///
/// # Errors
/// As [`sweep`](crate::sweep::sweep()); [`Error::Disagreement`](crate::error::Error::Disagreement) if the f64 reference disagrees with the
/// sweep.
pub fn judge<'p>(
    plan: &'p Plan,
    settings: &Settings,
    checkpoint: Option<&mut Checkpoint>,
    control: &Control,
    whole: bool,
    how: How<'_>,
    remark: &mut dyn FnMut(&str),
) -> Result<Judged<'p>> {
    let mut tables = Tables::new(plan);
    let start = Instant::now();
    // With a slow model the sample can be most of the work: a shard skips it unless it needs it.
    let sampled = whole || plan.shards_sample();
    let (tally, judged) = if sampled {
        Tally::with_judged(plan, &tables, settings.threads, control)?
    } else {
        (Tally::empty(plan), JudgedDesigns::default())
    };
    let sampling = start.elapsed();
    control.done.store(0, Ordering::Relaxed);
    let reduction = Reduction::new(plan, &tally.histogram_ranges(plan));
    let how = match how {
        How::Device(_, true) => match supports_histograms(plan, &reduction.histogram_ranges()) {
            Ok(()) => how,
            Err(error) => {
                remark(&format!("{error}; the CPU judges the designs"));
                How::Cpu
            }
        },
        how => how,
    };
    // The sweep need not judge again what the sample has judged; the time that took is part of its own.
    let takes_over = matches!(how, How::Cpu) && !judged.is_empty();
    if takes_over {
        tables.take_over(judged);
    }
    let (mut did, mut settler) = (None, Settler::EveryDesign);
    let Swept { state, designs, time } = match how {
        How::Cpu => {
            let swept = sweep(plan, &tables, &reduction, settings, checkpoint, control)?;
            let share = if takes_over { swept.designs as f64 / plan.designs() as f64 } else { 0.0 };
            Swept { time: sampling.mul_f64(share) + swept.time, ..swept }
        }
        How::Device(on, _) => {
            let (swept, record) = sweep_on_device(plan, &tables, &reduction, settings, checkpoint, control, on)?;
            did = Some(record);
            swept
        }
        How::Bounds(None) => {
            let (swept, found) = sweep_by_bounds(plan, &tables, &reduction, settings, checkpoint, control)?;
            settler = Settler::Bounds(found);
            swept
        }
        How::Bounds(Some(rule)) => {
            let done = sweep_auto(plan, &tables, &reduction, settings, checkpoint, control, &rule)?;
            (settler, did) = (done.settler, done.device);
            done.swept
        }
    };
    let certified = whole.then(|| Certified::certify(plan, state, tally, settings.threads, control)).transpose()?;
    Ok(Judged { time, designs, certified, did, settler })
}
