//! The progress bar of a sweep, on standard error where that is a terminal.

use super::{scaled, span};
use beltspace::sweep::Control;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A bar that follows a sweep from a thread of its own.
pub struct Bar {
    finished: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Bar {
    /// Starts a bar over so many designs; nothing is shown when quiet or when standard error is no terminal.
    pub fn start(control: &Arc<Control>, designs: Range<u64>, quiet: bool) -> Self {
        let finished = Arc::new(AtomicBool::new(false));
        let total = designs.end - designs.start;
        let shown = !quiet && std::io::stderr().is_terminal();
        let thread = shown.then(|| {
            let (control, finished) = (Arc::clone(control), Arc::clone(&finished));
            std::thread::spawn(move || follow(&control, total, &finished))
        });
        Self { finished, thread }
    }

    /// Takes the bar away.
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
    // Since when designs have been judged, and how many a checkpoint had brought before: neither counts for the speed.
    let mut begun: Option<(Instant, u64)> = None;
    while !finished.load(Ordering::Relaxed) {
        let done = control.done.load(Ordering::Relaxed).min(total);
        if done != last && begun.is_none() {
            begun = Some((Instant::now(), done));
        }
        last = done;
        bar.set_position(done);
        let rate = begun.map_or(0.0, |(since, before)| (done - before) as f64 / since.elapsed().as_secs_f64().max(1e-3));
        bar.set_message(if control.stop.load(Ordering::Relaxed) {
            "stopping, keeping what is done ...".to_owned()
        } else if done == total {
            let [certified, reported] = [&control.certified, &control.reported].map(|it| it.load(Ordering::Relaxed));
            format!("certifying what is reported, {} % ...", 100 * certified / reported.max(1))
        } else if let Some(what) = control.settled_for() {
            format!("settled: {what}, {}", span(start.elapsed().as_secs_f64()))
        } else if rate > 0.0 {
            format!("{}designs/s, {} left", scaled(rate), span((total - done) as f64 / rate))
        } else {
            let [sampled, sample] = [&control.sampled, &control.sample].map(|it| it.load(Ordering::Relaxed));
            format!("looking at a sample, {} % ...", 100 * sampled / sample.max(1))
        });
        std::thread::sleep(Duration::from_millis(50));
    }
    bar.finish_and_clear();
}
