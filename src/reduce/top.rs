//! The best K designs by one quantity.

use super::Answers;
use super::reducer::{Put, Reducer, ReducerNeeds, ReducerResults, ReducerRoom};
use crate::error::Result;
use crate::plan::Plan;
#[cfg(feature = "pictures")]
use crate::reading::{Folder, designs};
use crate::screen::{Block, SortedRow};
use crate::study::{Goal, Report, Study};
use crate::table::csv;
use serde::{Deserialize, Serialize};
#[cfg(feature = "pictures")]
use serde_json::{Map, Value, json};

/// Its file.
const FILE: &str = "top.csv";

/// The best designs so far.
///
/// Invariant: `best` holds at most `2 * count` designs, and once `count` have been seen, every design of the answer is among
/// them and none worse than `worst_kept` can be part of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Top {
    /// Where its values are among those of a block; none where it was read from a checkpoint.
    #[serde(skip)]
    column: Option<usize>,
    goal: Goal,
    count: usize,
    /// Key (less is better) and index.
    best: Vec<(f64, u64)>,
    worst_kept: f64,
}

impl PartialEq for Top {
    fn eq(&self, other: &Self) -> bool {
        (self.goal, self.count) == (other.goal, other.count) && self.sorted() == other.sorted()
    }
}

impl Top {
    /// Nothing seen yet; `count` is at least 1, and `column` where the values are among those of a block.
    pub fn new(goal: Goal, count: usize, column: usize) -> Self {
        Self { column: Some(column), goal, count, best: Vec::new(), worst_kept: f64::INFINITY }
    }

    /// Key (less is better) and index of the worst of the best K, once there are K.
    pub fn worst(&mut self) -> Option<(f64, u64)> {
        self.shrink();
        (self.best.len() == self.count).then(|| self.best[self.count - 1])
    }

    fn push(&mut self, key: f64, index: u64) {
        self.best.push((key, index));
        if self.best.len() >= 2 * self.count {
            self.shrink();
        }
    }

    fn shrink(&mut self) {
        self.best.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // The same design may come twice, when a comparison merges what it has merged before.
        self.best.dedup_by_key(|(_, index)| *index);
        self.best.truncate(self.count);
        if self.best.len() == self.count {
            self.worst_kept = self.best[self.count - 1].0;
        }
    }

    /// The design indices, best first, ties by index.
    pub fn indices(&self) -> Vec<u64> {
        self.sorted().into_iter().map(|(_, index)| index).collect()
    }

    fn sorted(&self) -> Vec<(f64, u64)> {
        let mut own = self.clone();
        own.shrink();
        own.best
    }
}

impl Reducer for Top {
    const STATE: &'static str = "list of the best";

    fn asked(plan: &Plan, _ranges: &[(f64, f64)]) -> Vec<Self> {
        let top = plan.study.report.top.iter();
        top.map(|top| Self::new(top.goal, top.count, plan.position(top.by, top.goal.worse()))).collect()
    }

    fn needs(report: &Report) -> Option<ReducerNeeds> {
        report.top.map(|_| ReducerNeeds::Candidates)
    }

    fn absorb(&mut self, block: &Block<'_>) {
        let values = block.column(self.column.expect("a list that takes in blocks was made for a plan"));
        for (lane, (&value, &alive)) in values.iter().zip(block.alive).enumerate() {
            let key = self.goal.key(value);
            if alive != 0 && key <= self.worst_kept {
                self.push(key, block.index(lane));
            }
        }
    }

    fn absorb_row(&mut self, row: &mut SortedRow<'_>) {
        let column = self.column.expect("a list that takes in rows was made for a plan");
        let Some((first, last)) = row.ends(column) else { return self.absorb(&row.as_block()) };
        let (first, last) = (self.goal.key(first), self.goal.key(last));
        if first.min(last) > self.worst_kept {
            return;
        }
        // From the better end on, as long as they may be among the best.
        for step in 0..row.count() {
            let place = if first <= last { step } else { row.count() - 1 - step };
            let key = self.goal.key(row.values(column)[place]);
            if key > self.worst_kept {
                break;
            }
            self.push(key, row.index(place));
        }
    }

    fn merge(&mut self, other: Self) {
        for (key, index) in other.best {
            self.push(key, index);
        }
    }

    fn fits(&self, asked: &Self, _met: u64, designs: u64) -> bool {
        let same = (self.goal, self.count) == (asked.goal, asked.count) && self.best.len() <= 2 * asked.count;
        same && self.best.iter().all(|&(key, index)| !key.is_nan() && index < designs)
    }

    fn tell(&mut self, answers: &mut Answers) {
        answers.top = self.worst();
    }

    fn lacks(&self, fuller: &Self) -> Option<(&'static str, u64)> {
        let have = self.indices();
        let missing = fuller.indices().into_iter().enumerate().find(|(place, index)| have.get(*place) != Some(index));
        missing.map(|(_, index)| ("top list", index))
    }

    fn designs(&self) -> Vec<u64> {
        self.indices()
    }

    fn files(study: &Study) -> Vec<String> {
        study.report.top.iter().map(|_| FILE.to_owned()).collect()
    }

    fn is_file(name: &str) -> bool {
        name == FILE
    }

    fn write(&self, results: &ReducerResults<'_>, put: &mut Put<'_>) -> Result<()> {
        put(FILE, csv::write(&(results.table)()))
    }

    #[cfg(feature = "pictures")]
    fn page(folder: &Folder<'_>, data: &mut Map<String, Value>) -> Result<()> {
        let study = &folder.plan.study;
        let mut list = Value::Null;
        if let Some(top) = study.report.top {
            list = designs::list(&folder.path.join(FILE), folder.plan, top.count as u64, false)?;
            (list["by"], list["goal"]) = (top.by.name(&study.model).into(), json!(top.goal));
        }
        data.insert("top".to_owned(), list);
        Ok(())
    }

    fn room(plan: &Plan) -> ReducerRoom {
        let Some(top) = plan.study.report.top else { return ReducerRoom::default() };
        let rows = (top.count as u64).min(plan.designs());
        ReducerRoom { rows, lists: vec![(FILE.to_owned(), rows)], ..ReducerRoom::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::mix;

    #[test]
    fn the_best_are_those_of_sorting_everything() {
        for (goal, count) in [(Goal::Min, 1), (Goal::Min, 7), (Goal::Max, 50), (Goal::Max, 2000)] {
            let value = |index: u64| (mix(index) % 60) as f64;
            let mut top = Top::new(goal, count, 0);
            for first in [600u64, 0, 900, 300] {
                let values = (first..first + 300).map(value).collect();
                let alive: Vec<u64> = (first..first + 300).map(|index| if index % 3 == 0 { 0 } else { u64::MAX }).collect();
                let offsets: Vec<u64> = (0..300).collect();
                top.absorb(&Block { row_index: first, offsets: &offsets, feasible_count: 200, alive: &alive, values: &[values] });
            }
            let mut all: Vec<u64> = (0..1200).filter(|index| index % 3 != 0).collect();
            let sign = if goal == Goal::Min { 1.0 } else { -1.0 };
            all.sort_by(|&a, &b| (sign * value(a)).total_cmp(&(sign * value(b))).then(a.cmp(&b)));
            all.truncate(count);
            assert_eq!(top.indices(), all);
        }
    }
}
