//! Boxes that wait to be looked at, most promising first.
//!
//! Most boxes of a search are settled by designs that others hold: the sooner those are found, the fewer boxes are cut and the fewer designs
//! judged. Where two objectives share factors, the product of both tells how close to the ideal a box may come.

use super::axes::Spans;
use super::open::Open;
use std::sync::Arc;

/// A box that waits.
#[derive(Clone, Debug)]
pub struct Waiting {
    /// Its designs.
    pub spans: Spans,
    /// What some of them may violate.
    pub open: Vec<Open>,
    /// Per target: the scenarios in which it may be worst.
    pub covers: Vec<Arc<[Spans]>>,
    /// The largest product of both objectives that its designs may have, over the least with which one fits between the front's points in
    /// the middle of its range; infinite if unknown.
    pub surplus: f64,
}

/// Boxes that wait, most promising first: what they hold makes short work of the others.
#[derive(Debug)]
pub struct Queue {
    /// By how promising they are.
    levels: Vec<Vec<Waiting>>,
    count: usize,
}

/// Of a queue: surpluses are told apart by powers of two of what they are more or less than one.
const LEVELS: usize = 49;
/// From here on.
const ALIKE: f64 = 1e-6;
/// Boxes that wait beyond which those with few designs, of little promise, are looked at first: they are soon gone.
const MOST_WAITING: usize = 1 << 20;

impl Queue {
    /// An empty one.
    pub fn new() -> Self {
        Self { levels: (0..LEVELS).map(|_| Vec::new()).collect(), count: 0 }
    }

    /// Adds a box.
    pub fn push(&mut self, waiting: Waiting) {
        let more = waiting.surplus.clamp(0.0, 16.0) - 1.0;
        let middle = (LEVELS / 2) as f64;
        let level = middle - (1.0 + more.abs() / ALIKE).log2().copysign(more);
        // What is not a number, and may be anything, is cast to the first.
        self.levels[level as usize].push(waiting);
        self.count += 1;
    }

    /// Does no box wait any more?
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The next batch: of equal promise the newest, which have the fewest designs.
    pub fn pop(&mut self, most: usize) -> Vec<Waiting> {
        let mut batch = Vec::new();
        let mut take = |level: &mut Vec<Waiting>| {
            let kept = level.len().saturating_sub(most - batch.len());
            batch.extend(level.drain(kept..));
        };
        if self.count > MOST_WAITING {
            self.levels.iter_mut().rev().for_each(&mut take)
        } else {
            self.levels.iter_mut().for_each(&mut take)
        }
        self.count -= batch.len();
        batch
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::axes::{AXES, Span};

    fn waiting(number: u32, surplus: f64) -> Waiting {
        Waiting { spans: Spans([Span::at(number); AXES]), open: Vec::new(), covers: Vec::new(), surplus }
    }

    fn numbers(batch: &[Waiting]) -> Vec<u32> {
        batch.iter().map(|it| it.spans[0].low).collect()
    }

    #[test]
    fn the_most_promising_come_first_and_each_once() {
        let mut queue = Queue::new();
        for (number, surplus) in [1.0 - 1e-3, 1.2, 0.0, f64::INFINITY, 1.0, 0.5, 1.0 + 1e-4, f64::NAN].into_iter().enumerate() {
            queue.push(waiting(number as u32, surplus));
        }
        // Beyond a point nobody tells two surpluses apart.
        let first = numbers(&queue.pop(2));
        assert!(first.contains(&3) && first.contains(&7), "{first:?}");
        assert_eq!([queue.pop(1), queue.pop(1), queue.pop(1)].map(|it| numbers(&it)), [[1], [6], [4]]);
        assert_eq!(numbers(&queue.pop(9)), [0, 5, 2]);
        assert!(queue.is_empty() && queue.pop(1).is_empty());
    }

    #[test]
    fn of_equal_promise_the_newest_come_first() {
        let mut queue = Queue::new();
        (0..5).for_each(|number| queue.push(waiting(number, 1.1)));
        assert_eq!([numbers(&queue.pop(2)), numbers(&queue.pop(3))], [vec![3, 4], vec![0, 1, 2]]);
    }
}
