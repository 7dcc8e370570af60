//! Everything that is known of what matters, method by method.

use super::results::InfluenceReport;
use super::subject::InfluenceSubject;
use crate::error::{Error, Result};
use crate::screen::Control;
use crate::study::InfluenceOver;

impl InfluenceSubject {
    /// Looks at it on `threads` threads.
    ///
    /// # Errors
    /// [`Error::Request`] if a quantity that the user named has no answer.
    pub fn report(&self, threads: usize) -> Result<InfluenceReport> {
        let report = self.look(threads, &Control::default())?;
        if self.is_chosen
            && let Some(refused) = report.quantities.iter().find(|it| it.has_no_answer())
        {
            return Err(Error::Request(refused.refusal(self.over)));
        }
        Ok(report)
    }

    /// The same for a result that is whole without it: a quantity without an answer says so. `control` counts the combinations as
    /// certified, and can stop it.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn look(&self, threads: usize, control: &Control) -> Result<InfluenceReport> {
        let mut report = InfluenceReport::new(self);
        if let Some(limit) = self.grid_limit() {
            self.on_grid(limit, threads, control, &mut report)?;
        }
        if self.is_drawn() {
            self.by_draws(threads, control, &mut report)?;
        }
        if self.is_screened() {
            self.by_walks(threads, control, &mut report)?;
        }
        if self.over == InfluenceOver::Uncertainty {
            self.tornado(threads, control, &mut report)?;
        }
        Ok(report)
    }
}
