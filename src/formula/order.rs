//! In which order formulas are evaluated, and which read each other in a circle.

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
