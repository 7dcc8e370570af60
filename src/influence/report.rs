//! Everything that is known of what matters, method by method.

use super::results::InfluenceReport;
use super::subject::{InfluenceOver, InfluenceSubject};
use crate::error::{Error, Result};

impl InfluenceSubject {
    /// Looks at it on `threads` threads.
    ///
    /// # Errors
    /// [`Error::Request`] if a quantity that the user named has no answer.
    pub fn report(&self, threads: usize) -> Result<InfluenceReport> {
        let mut report = InfluenceReport::new(self);
        if let Some(limit) = self.grid_limit() {
            self.on_grid(limit, threads, &mut report)?;
        }
        if self.is_drawn() {
            self.by_draws(threads, &mut report)?;
        }
        if self.is_screened() {
            self.by_walks(threads, &mut report)?;
        }
        if self.over == InfluenceOver::Uncertainty {
            self.tornado(threads, &mut report)?;
        }
        if self.is_chosen
            && let Some(refused) = report.quantities.iter().find(|it| it.has_no_answer())
        {
            return Err(Error::Request(refused.refusal(self.over)));
        }
        Ok(report)
    }
}
