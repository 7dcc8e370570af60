//! An early end by counts: a design whose yield can no longer reach what is asked is infeasible, whatever the draws that remain.

use super::drive::DrawnDrive;
use super::statistic::StatisticKind;
use super::tracks::Track;

/// The least count of a statistic without which a design is infeasible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeastCount {
    /// Number of the statistic.
    pub statistic: usize,
    /// The count.
    pub count: u64,
}

/// The least counts without which a design is infeasible, from the least values of outputs and whether these are themselves too little.
pub fn least_counts(kernel: &DrawnDrive, least: &[(usize, f64, bool)]) -> Vec<LeastCount> {
    let count = |&(statistic, value, strict): &(usize, f64, bool)| {
        let counts = matches!(kernel.statistics.get(statistic)?.kind, StatisticKind::Yield | StatisticKind::YieldOf(_));
        let count = least_count(kernel.draws() as u64, value, strict);
        (counts && count > 0).then_some(LeastCount { statistic, count })
    };
    least.iter().filter_map(count).collect()
}

/// The least of so many draws whose share is at least this value, or more than it; one more than there are if none is.
fn least_count(draws: u64, value: f64, strict: bool) -> u64 {
    let is_enough = |count: u64| {
        let share = count as f64 / draws as f64;
        share > value || (share == value && !strict)
    };
    // Shares rise with their counts: those that are too small come first.
    let (mut few, mut enough) = (0, draws + 1);
    while few < enough {
        let middle = (few + enough) / 2;
        if middle > draws || is_enough(middle) { enough = middle } else { few = middle + 1 }
    }
    few
}

/// Has a design too few of a count, even if all draws that remain were to count?
pub fn decided(least: &[LeastCount], tracks: &[Track], design: usize, remain: u64) -> bool {
    least.iter().any(|it| tracks[it.statistic].counts().is_some_and(|counts| counts[design] + remain < it.count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_count_is_the_first_whose_share_is_enough() {
        for draws in [1, 3, 7, 10, 1000, 4096] {
            let shares = [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.999, 1.0, 1.5, -1.0, 3.0 / 7.0, 0.1 + 0.2];
            for value in shares.into_iter().chain((0..=draws).map(|count| count as f64 / draws as f64)) {
                for strict in [false, true] {
                    let is_enough = |count: &u64| {
                        let share = *count as f64 / draws as f64;
                        if strict { share > value } else { share >= value }
                    };
                    let first = (0..=draws).find(is_enough).unwrap_or(draws + 1);
                    assert_eq!(least_count(draws, value, strict), first, "of {draws} draws {value}, {strict}");
                }
            }
        }
    }

    #[test]
    fn a_design_is_decided_as_soon_as_too_few_draws_remain() {
        let least = [LeastCount { statistic: 1, count: 90 }];
        let tracks = [Track::Idle, Track::Holding(vec![50, 49])];
        assert!(!decided(&least, &tracks, 0, 40));
        assert!(decided(&least, &tracks, 1, 40));
        assert!(decided(&least, &tracks, 0, 39));
    }
}
