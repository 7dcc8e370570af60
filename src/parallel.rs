//! Work on several threads. Where the system grants fewer than were asked for, the caller does the rest of the work itself.

use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, Scope, ScopedJoinHandle};

/// Does `work` on every part, each on a thread of its own, the last on the caller's; results in the order of the parts.
///
/// # Panics
/// If `work` does.
pub fn on_threads<T: Send, R: Send>(parts: impl IntoIterator<Item = T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    // A thread that cannot be started would take its part along, so each waits to be fetched.
    let parts: Vec<Mutex<Option<T>>> = parts.into_iter().map(|part| Mutex::new(Some(part))).collect();
    let fetch = |part: &Mutex<Option<T>>| part.lock().unwrap_or_else(PoisonError::into_inner).take();
    let Some((last, others)) = parts.split_last() else { return Vec::new() };
    std::thread::scope(|scope| {
        let (work, fetch) = (&work, &fetch);
        let started: Vec<_> = others.iter().map(|part| start(scope, move || fetch(part).map(work))).collect();
        let own = fetch(last).map(work);
        let ends = started.into_iter().zip(others).map(|(thread, part)| match thread {
            Some(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            None => fetch(part).map(work),
        });
        let results: Vec<Option<R>> = ends.collect();
        results.into_iter().chain([own]).map(|result| result.expect("every part is fetched once")).collect()
    })
}

/// Does `work` on every part, on so many threads, each of which takes the next part when it is done with one: some may take far longer than
/// others. `begin` makes what a thread keeps from part to part. Results in the order of the parts.
///
/// # Panics
/// If `begin` or `work` does.
pub fn one_after_another<T: Send, S, R: Send>(
    parts: Vec<T>,
    threads: usize,
    begin: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, T) -> R + Sync,
) -> Vec<R> {
    let threads = threads.clamp(1, parts.len().max(1));
    let waiting = Mutex::new(parts.into_iter().enumerate());
    let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
    let done = on_threads(0..threads, |_| {
        let mut state = begin();
        std::iter::from_fn(next).map(|(number, part)| (number, work(&mut state, part))).collect::<Vec<_>>()
    });
    let mut done: Vec<(usize, R)> = done.into_iter().flatten().collect();
    done.sort_unstable_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Does the caller's `work` while `beside` runs on a thread of its own, and waits for both. `work` is told whether there was a thread for
/// `beside`: where there is none, `beside` is not run.
///
/// # Panics
/// If `work` or `beside` does. Then `beside` must end all the same: whoever panics waits for it.
pub fn with_beside<R>(beside: impl FnOnce() + Send, work: impl FnOnce(bool) -> R) -> R {
    std::thread::scope(|scope| {
        let runs = start(scope, beside).is_some();
        work(runs)
    })
}

/// Does `work` beside what the caller does until the scope ends; `None` if there is no thread for it.
fn start<'scope, R: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    work: impl FnOnce() -> R + Send + 'scope,
) -> Option<ScopedJoinHandle<'scope, R>> {
    Builder::new().spawn_scoped(scope, work).ok()
}

/// How many threads can be had now, of the number asked for; the caller's own counts as one.
pub fn to_be_had(threads: usize) -> usize {
    let all_tried = Mutex::new(());
    let held = all_tried.lock().unwrap_or_else(PoisonError::into_inner);
    let started = std::thread::scope(|scope| {
        let wait = || drop(all_tried.lock().unwrap_or_else(PoisonError::into_inner));
        let mut started = 1;
        while started < threads && start(scope, wait).is_some() {
            started += 1;
        }
        drop(held);
        started
    });
    started.min(threads)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn every_part_is_done_once_in_order_and_on_a_thread_of_its_own() {
        let barrier = Barrier::new(4);
        let done = on_threads(0..4, |part| {
            // All of them at the same time.
            barrier.wait();
            (part, std::thread::current().id())
        });
        assert_eq!(done.iter().map(|it| it.0).collect::<Vec<_>>(), [0, 1, 2, 3]);
        assert_eq!(done.iter().map(|it| it.1).collect::<HashSet<_>>().len(), 4);
        assert_eq!(done[3].1, std::thread::current().id(), "the last one is the caller's");
        assert!(on_threads(Vec::<u8>::new(), |part| part).is_empty());
        assert_eq!([0, 1, 3].map(to_be_had), [0, 1, 3]);
    }

    #[test]
    fn a_thread_that_is_done_takes_the_next_part_and_keeps_what_it_has() {
        let begun = AtomicUsize::new(0);
        // The first part waits for the last, so that the other thread does all between.
        let last = Barrier::new(2);
        let begin = || {
            begun.fetch_add(1, Ordering::Relaxed);
            0
        };
        let done = one_after_another((0..50).collect(), 2, begin, |before: &mut u32, part| {
            *before += 1;
            if part == 0 || part == 49 {
                last.wait();
            }
            (part, *before)
        });
        assert_eq!(done.iter().map(|it| it.0).collect::<Vec<_>>(), (0..50).collect::<Vec<_>>());
        assert_eq!((done[0].1, done[49].1, begun.into_inner()), (1, 49, 2));
        assert!(one_after_another(Vec::<u8>::new(), 3, || (), |(), part| part).is_empty());
        assert_eq!(one_after_another(vec![7], 0, || (), |(), part| part), [7]);
    }

    #[test]
    fn two_things_are_done_at_the_same_time() {
        let (there, back) = (Barrier::new(2), Barrier::new(2));
        let meet = || {
            there.wait();
            back.wait();
        };
        let done = with_beside(meet, |runs| {
            meet();
            runs
        });
        assert!(done);
    }

    #[test]
    fn a_panic_is_the_callers() {
        let panicked = std::panic::catch_unwind(|| on_threads(0..3, |part| assert_ne!(part, 1, "as it happens")));
        assert!(panicked.is_err());
    }
}
