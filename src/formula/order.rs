//! What formulas read, in which order they are evaluated, and which read each other in a circle.

use super::check::SlotType;
use super::expression::Expression;
use std::collections::BTreeSet;

/// Numbers of formulas in order of dependence and then of the file, and every circle with its members in the order in which one reads
/// the next. Formulas of a circle, and those that need one, come last.
pub(super) fn order(reads: &[Vec<usize>]) -> (Vec<usize>, Vec<Vec<usize>>) {
    let mut open: Vec<usize> = reads.iter().map(Vec::len).collect();
    let mut readers = vec![Vec::new(); reads.len()];
    for (formula, read) in reads.iter().enumerate() {
        read.iter().for_each(|&read| readers[read].push(formula));
    }
    let mut ready: BTreeSet<usize> = (0..reads.len()).filter(|&formula| open[formula] == 0).collect();
    let mut order = Vec::new();
    while let Some(next) = ready.pop_first() {
        order.push(next);
        for &reader in &readers[next] {
            open[reader] -= 1;
            if open[reader] == 0 {
                ready.insert(reader);
            }
        }
    }
    let mut left: BTreeSet<usize> = (0..reads.len()).filter(|formula| !order.contains(formula)).collect();
    order.extend(&left);
    let mut circles = Vec::new();
    while let Some(start) = left.pop_first() {
        // Each that is left reads another that is left or was in a circle already: a walk along them comes back to where it was.
        let mut path = vec![start];
        while let Some(&next) = path.last().and_then(|&last| reads[last].iter().find(|&next| left.contains(next) || path.contains(next))) {
            if let Some(first) = path.iter().position(|&member| member == next) {
                circles.push(path[first..].to_vec());
                break;
            }
            left.remove(&next);
            path.push(next);
        }
    }
    (order, circles)
}

/// Slots that an expression reads, each once, in the order of the text.
pub(super) fn slots_read(expression: Option<&Expression>, slots: &[SlotType]) -> Vec<usize> {
    let mut read = Vec::new();
    for (name, _) in expression.map(Expression::names).unwrap_or_default() {
        let slot = slots.iter().position(|slot| slot.name == name);
        read.extend(slot.filter(|slot| !read.contains(slot)));
    }
    read
}

/// Where an expression reads a name.
pub(super) fn place_of(expression: Option<&Expression>, name: &str) -> usize {
    let names = expression.map(Expression::names).unwrap_or_default();
    names.iter().find(|(read, _)| *read == name).map_or(0, |&(_, at)| at)
}

/// The slots on the shortest way from a formula to an output.
pub(super) fn path_to_output(
    formula: usize,
    reads: &[Vec<usize>],
    giver: impl Fn(usize) -> Option<usize>,
    is_output: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let mut seen = BTreeSet::from([formula]);
    let mut open = std::collections::VecDeque::from([(formula, Vec::new())]);
    while let Some((formula, path)) = open.pop_front() {
        for &slot in &reads[formula] {
            let path = [&path[..], &[slot]].concat();
            match giver(slot) {
                None if is_output(slot) => return path,
                Some(next) if seen.insert(next) => open.push_back((next, path)),
                _ => {}
            }
        }
    }
    Vec::new()
}
