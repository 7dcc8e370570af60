//! The progress bar of a sweep, on standard error if that is a terminal.

use super::{scaled, span};
use beltspace::sweep::Control;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A bar that shows the progress of a sweep, drawn by a thread of its own.
pub struct Bar {
    finished: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Bar {
    /// Starts a bar for this many designs; shows nothing when quiet or if standard error is no terminal.
    pub fn start(control: &Arc<Control>, designs: Range<u64>, quiet: bool) -> Self {
        let finished = Arc::new(AtomicBool::new(false));
        let total = designs.end - designs.start;
        let shown = !quiet && std::io::stderr().is_terminal();
        let start = || {
            let (control, finished) = (Arc::clone(control), Arc::clone(&finished));
            // If the thread cannot be started there is no bar, which is no reason to fail.
            std::thread::Builder::new().spawn(move || follow(&control, total, &finished)).ok()
        };
        Self { thread: if shown { start() } else { None }, finished }
    }

    /// Removes the bar.
    pub fn finish(mut self) {
        self.finished.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A bar that failed to draw is no reason to fail.
            let _ = thread.join();
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "rates for people")]
fn follow(control: &Control, total: u64, finished: &AtomicBool) {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr_with_hz(10));
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}").expect("the template is a constant");
    bar.set_style(style.progress_chars("█▉▊▋▌▍▎▏ "));
    let start = Instant::now();
    let mut last = 0;
    // When judging began, and how many designs came from a checkpoint: the speed counts neither the time before nor these designs.
    let mut begun: Option<(Instant, u64)> = None;
    while !finished.load(Ordering::Relaxed) {
        let done = control.done.load(Ordering::Relaxed).min(total);
        if done != last && begun.is_none() {
            begun = Some((Instant::now(), done));
        }
        // If bounds are given up, the designs that they settled count as brought.
        if done < last {
            begun = Some((Instant::now(), done));
        }
        last = done;
        bar.set_position(done);
        let rate = begun.map_or(0.0, |(since, before)| (done - before) as f64 / since.elapsed().as_secs_f64().max(1e-3));
        bar.set_message(message(control, done..total, rate, start.elapsed()));
        std::thread::sleep(Duration::from_millis(50));
    }
    bar.finish_and_clear();
}

/// The text beside the bar: `rate` is in designs per second.
#[allow(clippy::cast_precision_loss, reason = "times for people")]
fn message(control: &Control, rest: Range<u64>, rate: f64, elapsed: Duration) -> String {
    let percent = |part: &AtomicU64, of: &AtomicU64| 100 * part.load(Ordering::Relaxed) / of.load(Ordering::Relaxed).max(1);
    if control.stop.load(Ordering::Relaxed) {
        "stopping, saving the checkpoint ...".to_owned()
    } else if rest.is_empty() {
        format!("certifying what is reported, {} % ...", percent(&control.certified, &control.reported))
    } else if let Some(what) = control.settled_for() {
        format!("settled: {what}, {}", span(elapsed.as_secs_f64()))
    } else if rate > 0.0 {
        format!("{}designs/s, {} left", scaled(rate), span((rest.end - rest.start) as f64 / rate))
    } else {
        format!("judging a sample, {} % ...", percent(&control.sampled, &control.sample))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_says_what_is_done_and_how_long_it_takes() {
        let control = Control::default();
        let at = |done: u64, rate: f64| message(&control, done..1_000_000, rate, Duration::from_millis(16_900));
        control.sample.store(65_536, Ordering::Relaxed);
        control.sampled.store(16_384, Ordering::Relaxed);
        assert_eq!(at(0, 0.0), "judging a sample, 25 % ...");
        assert_eq!(at(400_000, 20_000.0), "20.0 kdesigns/s, 30.0 s left");
        *control.settling.lock().expect("nobody holds it") = Some("front, 1 of 11".to_owned());
        assert_eq!(at(400_000, 20_000.0), "settled: front, 1 of 11, 16.9 s");
        assert_eq!(at(1_000_000, 20_000.0), "certifying what is reported, 0 % ...");
        control.reported.store(8, Ordering::Relaxed);
        control.certified.store(2, Ordering::Relaxed);
        assert_eq!(at(1_000_000, 20_000.0), "certifying what is reported, 25 % ...");
        control.stop.store(true, Ordering::Relaxed);
        assert_eq!(at(400_000, 20_000.0), "stopping, saving the checkpoint ...");
    }
}
