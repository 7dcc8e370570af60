//! Work without the interpreter lock, during which signals are looked at and progress is told.

use beltspace::Control;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// How often signals are looked at.
const OFTEN: Duration = Duration::from_millis(50);

/// Does the work on a thread of its own and waits for it. A signal such as Ctrl-C calls `stop` and is raised once the work has ended;
/// `tell` is called every 50 ms, and what it raises ends the work likewise.
pub fn supervised<R: Send>(
    py: Python<'_>,
    stop: impl Fn(),
    mut tell: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce() -> R + Send,
) -> PyResult<R> {
    std::thread::scope(|scope| {
        let (done, mut waiting) = channel::<()>();
        let worker = scope.spawn(move || {
            let result = work();
            // Only the wait below listens, and it may have ended.
            let _ = done.send(());
            result
        });
        let mut raised = None;
        while !has_ended(py, &mut waiting) {
            if let Err(error) = py.check_signals().and_then(|()| tell(py)) {
                stop();
                raised = Some(error);
                break;
            }
        }
        let ended = py.detach(|| worker.join());
        match (raised, ended) {
            (Some(error), _) => Err(error),
            (None, Ok(result)) => Ok(result),
            (None, Err(_)) => {
                Err(PyRuntimeError::new_err("beltspace has a bug: a thread panicked; its message is above, please report it"))
            }
        }
    })
}

/// Waits a while; true once the work is done.
fn has_ended(py: Python<'_>, waiting: &mut Receiver<()>) -> bool {
    // Taken along as a whole: two threads may not share it.
    py.detach(move || !matches!(waiting.recv_timeout(OFTEN), Err(RecvTimeoutError::Timeout)))
}

/// What is being done: its name, and how far it is.
pub fn stage(control: &Control, designs: u64) -> (String, u64, u64) {
    let read = |number: &AtomicU64| number.load(Ordering::Relaxed);
    let (done, reported) = (read(&control.done).min(designs), read(&control.reported));
    if done >= designs && reported > 0 {
        ("certifying what is reported".to_owned(), read(&control.certified).min(reported), reported)
    } else if let Some(what) = control.settled_for() {
        (format!("settling by bounds: {what}"), done, designs)
    } else if done > 0 {
        ("judging designs".to_owned(), done, designs)
    } else {
        let sample = read(&control.sample);
        ("judging a sample".to_owned(), read(&control.sampled).min(sample), sample)
    }
}
