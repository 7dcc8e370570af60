//! Which scenarios a device looks at: of each row those that decide about its designs, which f64 finds on the host.

use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::screen::decisive::Decisive;
use crate::screen::tables::lane_list;
use crate::screen::{CpuEngine, Tables};
use std::ops::Range;

/// With fewer scenarios finding those that decide takes as long as looking at all.
const LEAST_SCENARIOS: u64 = 8;
/// Least rows that a thread is started for.
const LEAST_ROWS: u64 = 32;

/// Finds the scenarios that decide about the designs of rows.
#[derive(Debug)]
pub struct RowScenarios<'p> {
    scenarios: u32,
    /// An engine for each thread; none while nothing is known of any row.
    hosts: Vec<CpuEngine<'p>>,
}

impl<'p> RowScenarios<'p> {
    /// Does it pay for a plan to look for them?
    pub fn serve(plan: &Plan) -> bool {
        let worth = plan.scenarios() >= LEAST_SCENARIOS && Decisive::is_worth_it(plan.scenarios(), plan.fast.count());
        worth && lane_list(plan).is_some_and(|list| Decisive::new(plan, &list).is_some())
    }

    /// Of a plan that looks for them. Until it has hosts, every scenario decides.
    pub fn new(plan: &Plan) -> Self {
        Self { scenarios: u32::try_from(plan.scenarios()).expect("the layout is cut to 32-bit numbers"), hosts: Vec::new() }
    }

    /// From now on so many threads look.
    pub fn set_hosts(&mut self, plan: &'p Plan, tables: &'p Tables, threads: usize) {
        self.hosts = (0..threads.max(1)).map(|_| CpuEngine::new(plan, tables)).collect();
    }

    /// Most words for so many rows.
    pub fn words(plan: &Plan, rows: u64) -> u64 {
        1 + rows * (1 + plan.scenarios())
    }

    /// Where the scenarios of each row begin, and where the last ones end; then the scenarios.
    pub fn of_rows(&mut self, rows: Range<u64>) -> Vec<u32> {
        let count = rows.end - rows.start;
        let scenarios = self.scenarios;
        let shares = (count / LEAST_ROWS).clamp(1, self.hosts.len().max(1) as u64);
        let part = |number: u64| rows.start + count * number / shares..rows.start + count * (number + 1) / shares;
        let parts: Vec<Vec<Vec<u32>>> = if self.hosts.is_empty() {
            vec![rows.clone().map(|_| (0..scenarios).collect()).collect()]
        } else {
            on_threads(self.hosts.iter_mut().zip((0..shares).map(part)), |(host, rows)| {
                rows.map(|row| host.decisive_scenarios(row).unwrap_or_else(|| (0..scenarios).collect())).collect()
            })
        };
        let lists = parts.concat();
        let mut next = lists.len() as u32 + 1;
        let mut words = vec![next];
        words.extend(lists.iter().map(|list| {
            next += list.len() as u32;
            next
        }));
        words.extend(lists.into_iter().flatten());
        words
    }
}
