//! Watches bounds at work: do they settle designs faster than judging each would?

use super::Control;
use super::costs::{Forecast, Pace};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A range that is counted takes at most this fraction of the time that judging every design would take.
const CHUNK: f64 = 0.05;
/// A trial of histograms and maps takes at most this fraction of it.
const TRIAL: f64 = 0.04;
/// How often the watch is looked at where nobody reports progress.
pub const OFTEN: Duration = Duration::from_millis(10);
/// And how often a thread tells of the boxes that it counts.
const SELDOM: Duration = Duration::from_millis(1);

/// When bounds are left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leaving {
    /// When judging the rest one by one is expected to be faster.
    WhereTheyDoNotPay,
    /// When they have settled this fraction of their work, whatever time that took.
    #[cfg(feature = "testing")]
    After(f64),
}

/// One run of bounds and those who watch it.
pub struct Watch<'a> {
    control: &'a Control,
    leaving: Option<Leaving>,
    /// Seconds that judging a design takes, all threads at work.
    seconds: f64,
    /// Designs of a search, and of the count.
    search: u64,
    count: u64,
    searches: u64,
    counts: u64,
    start: Instant,
    /// Designs settled so far, over all passes: the bits of an f64, as they may be more than a u64 holds.
    settled: AtomicU64,
    stop: AtomicBool,
    /// Until how many seconds after the start a trial may take, as the bits of an f64, and whether it is over.
    trial: AtomicU64,
    trial_is_over: AtomicBool,
    pace: Mutex<(Pace, Option<Counting>)>,
    left: Mutex<Option<Forecast>>,
}

/// Tells a watch what one thread settles, not more often than it is worth.
pub struct Teller<'w> {
    watch: &'w Watch<'w>,
    untold: Cell<u64>,
    told: Cell<Instant>,
}

impl<'w> Teller<'w> {
    /// For one thread.
    pub fn new(watch: &'w Watch<'w>) -> Self {
        Self { watch, untold: Cell::new(0), told: Cell::new(Instant::now()) }
    }

    /// Counts designs that were settled.
    pub fn settle(&self, designs: u64) {
        self.untold.set(self.untold.get() + designs);
        #[cfg(feature = "testing")]
        let is_at_once = matches!(self.watch.leaving, Some(Leaving::After(_)));
        #[cfg(not(feature = "testing"))]
        let is_at_once = false;
        if is_at_once || self.told.get().elapsed() >= SELDOM {
            self.tell();
        }
    }

    /// Tells what is not told yet.
    pub fn tell(&self) {
        self.watch.settle(self.untold.take());
        self.told.set(Instant::now());
    }
}

/// Since when is it counted, and what had been settled.
#[derive(Clone, Copy, Debug)]
struct Counting {
    since: f64,
    before: f64,
}

#[allow(clippy::cast_precision_loss, reason = "estimates")]
impl<'a> Watch<'a> {
    /// Over so many searches, and counts after them; `leaving` says when bounds are left, and how many seconds a design takes that is judged,
    /// all threads at work.
    pub fn new(
        control: &'a Control,
        leaving: Option<(Leaving, f64)>,
        (search, searches): (u64, usize),
        (count, counts): (u64, usize),
    ) -> Self {
        Self {
            control,
            leaving: leaving.map(|it| it.0),
            seconds: leaving.map_or(f64::INFINITY, |it| it.1),
            search,
            count,
            searches: searches as u64,
            counts: counts as u64,
            start: Instant::now(),
            settled: AtomicU64::new(0),
            stop: AtomicBool::new(false),
            trial: AtomicU64::new(f64::INFINITY.to_bits()),
            trial_is_over: AtomicBool::new(false),
            pace: Mutex::default(),
            left: Mutex::default(),
        }
    }

    /// What ends the work: a request from outside, or that bounds do not pay.
    pub fn stop(&self) -> &AtomicBool {
        if self.leaving.is_some() { &self.stop } else { &self.control.stop }
    }

    /// May bounds be left?
    pub fn may_leave(&self) -> bool {
        self.leaving.is_some()
    }

    /// The forecast at which bounds were left.
    pub fn left(&self) -> Option<Forecast> {
        *self.left.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Seconds since bounds began.
    pub fn spent(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Designs of all searches.
    fn searches(&self) -> f64 {
        self.search as f64 * self.searches as f64
    }

    /// Seconds that a range should take at most: what is counted of it is lost where bounds are left.
    pub fn chunk(&self) -> f64 {
        match self.leaving {
            Some(Leaving::WhereTheyDoNotPay) => CHUNK * self.seconds * self.count as f64,
            #[cfg(feature = "testing")]
            Some(Leaving::After(_)) => f64::INFINITY,
            None => f64::INFINITY,
        }
    }

    /// Counts designs that were settled in one pass.
    pub fn settle(&self, designs: u64) {
        let more = |bits: u64| Some((f64::from_bits(bits) + designs as f64).to_bits());
        // It never refuses.
        let _ = self.settled.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more);
        self.look();
    }

    /// From now on it is counted.
    pub fn counts(&self) {
        // What a search settles in another way counts for it all the same.
        let before = self.searches();
        self.settled.store(before.to_bits(), Ordering::Relaxed);
        let mut pace = self.pace.lock().unwrap_or_else(PoisonError::into_inner);
        *pace = (Pace::default(), Some(Counting { since: self.spent(), before }));
    }

    /// Begins a trial, if bounds are left where they do not pay: seconds that judging every design takes.
    pub fn begin_trial(&self) -> Option<f64> {
        let judging = self.seconds * self.count as f64;
        matches!(self.leaving, Some(Leaving::WhereTheyDoNotPay)).then(|| {
            self.trial.store((self.spent() + TRIAL * judging).to_bits(), Ordering::Relaxed);
            judging
        })
    }

    /// Is set when a trial has taken too long, or all is stopped.
    pub fn trial_is_over(&self) -> &AtomicBool {
        &self.trial_is_over
    }

    /// Looks whether a trial has taken too long.
    pub fn look_at_trial(&self) {
        let is_late = self.spent() > f64::from_bits(self.trial.load(Ordering::Relaxed));
        if is_late || self.control.stop.load(Ordering::Relaxed) {
            self.trial_is_over.store(true, Ordering::Relaxed);
        }
    }

    /// Looks how bounds get on, and stops them if they do not pay.
    pub fn look(&self) {
        let settled = f64::from_bits(self.settled.load(Ordering::Relaxed));
        let all = (self.searches() + self.count as f64 * self.counts as f64).max(1.0);
        self.control.done.fetch_max(((settled / all) * self.search as f64) as u64, Ordering::Relaxed);
        let Some(leaving) = self.leaving else { return };
        if self.control.stop.load(Ordering::Relaxed) {
            self.stop.store(true, Ordering::Relaxed);
        }
        let pace = match leaving {
            // Whoever looks at the same time looks for all.
            Leaving::WhereTheyDoNotPay => self.pace.try_lock().ok(),
            // But one who is held up then would let the others settle all the rest.
            #[cfg(feature = "testing")]
            Leaving::After(_) => self.pace.lock().ok(),
        };
        let Some(mut pace) = pace else { return };
        let (pace, counting) = &mut *pace;
        let spent = self.spent();
        let begin = counting.map_or((0.0, 0.0), |it| (it.since, it.before));
        let (time, own) = (spent - begin.0, (settled - begin.1).max(0.0));
        pace.note(time, own);
        let rest = all - settled;
        let whole = self.seconds * self.count as f64;
        let judged = if counting.is_some() { own / self.counts as f64 } else { 0.0 };
        let judging = self.seconds * (self.count as f64 - judged);
        let forecast = Forecast { spent, settled: settled / all, bounds: pace.rest(time, own, rest, whole), judging };
        let leaves = rest > 0.0
            && match leaving {
                Leaving::WhereTheyDoNotPay => forecast.is_poor(whole, counting.map(|it| it.since)),
                #[cfg(feature = "testing")]
                Leaving::After(share) => forecast.settled >= share,
            };
        if leaves && !self.stop.swap(true, Ordering::Relaxed) {
            *self.left.lock().unwrap_or_else(PoisonError::into_inner) = Some(forecast);
        }
    }
}
