//! Work without the interpreter lock, during which signals are looked at and progress is told.

use beltspace::Control;
use pyo3::exceptions::PyRuntimeError;
use pyo3::ffi;
use pyo3::prelude::*;
use std::marker::PhantomData;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::ThreadId;
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
            (None, Err(_)) => Err(panicked()),
        }
    })
}

/// Does work that nothing can stop, and that soon ends by itself, on a thread of its own. A signal is raised at once, and the thread is
/// left to end.
pub fn left_alone<R: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> R + Send + 'static) -> PyResult<R> {
    let (done, mut waiting) = channel();
    std::thread::spawn(move || {
        // Nobody listens where a signal came first.
        let _ = done.send(work());
    });
    loop {
        match waited(py, &mut waiting) {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => return Err(panicked()),
        }
    }
}

fn panicked() -> PyErr {
    PyRuntimeError::new_err("beltspace has a bug: a thread panicked; its message is above, please report it")
}

/// Waits a while; true once the work is done.
fn has_ended(py: Python<'_>, waiting: &mut Receiver<()>) -> bool {
    !matches!(waited(py, waiting), Err(RecvTimeoutError::Timeout))
}

/// Waits a while, without the interpreter.
fn waited<R: Send>(py: Python<'_>, waiting: &mut Receiver<R>) -> Result<R, RecvTimeoutError> {
    // Taken along as a whole: two threads may not share it.
    py.detach(move || waiting.recv_timeout(OFTEN))
}

/// Python's main thread, once it has been seen: no other one may look at signals.
static MAIN: OnceLock<ThreadId> = OnceLock::new();

/// Remembers this thread if it is Python's main thread.
pub fn note_main_thread(py: Python<'_>) -> PyResult<()> {
    if MAIN.get().is_none() {
        let threading = py.import("threading")?;
        if threading.call_method0("current_thread")?.is(&threading.call_method0("main_thread")?) {
            MAIN.get_or_init(|| std::thread::current().id());
        }
    }
    Ok(())
}

/// Is this the main thread, as far as is known?
pub fn is_main_thread() -> bool {
    MAIN.get() == Some(&std::thread::current().id())
}

/// The interpreter, taken from within a call of which it is not known whether the caller has it.
///
/// pyo3 cannot be asked for it: where one of our own methods is further up on this thread, pyo3 believes that the thread still has the
/// interpreter, though whoever was called from there may have let go of it.
pub struct Interpreter {
    state: ffi::PyGILState_STATE,
    /// It is given back on the same thread.
    here: PhantomData<*const ()>,
}

impl Interpreter {
    pub fn take() -> Self {
        // SAFETY: this may be called on any thread, with the interpreter or without it; `drop` is the other half.
        Self { state: unsafe { ffi::PyGILState_Ensure() }, here: PhantomData }
    }

    pub fn python(&self) -> Python<'_> {
        // SAFETY: it was taken, and is held as long as what is returned.
        unsafe { Python::assume_attached() }
    }
}

impl Drop for Interpreter {
    fn drop(&mut self) {
        // SAFETY: taken on this thread, in `take`.
        unsafe { ffi::PyGILState_Release(self.state) }
    }
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
