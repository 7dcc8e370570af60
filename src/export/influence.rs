//! Which input matters, for the design that a result names first.

use super::{Certified, Summary};
use crate::error::Result;
use crate::influence::{InfluenceReport, InfluenceSubject, brief};
use crate::screen::Control;
use crate::study::InfluenceOver;
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

/// Why there is nothing to look at.
const NO_DESIGN: &str = "no design is feasible, so there is none whose uncertainty could be looked at";

impl Certified<'_> {
    /// The design that the result names first: the knee, or without a front the first of the best.
    pub fn first_named(&self) -> Option<u64> {
        let knee = Summary::new(self).knee.map(|knee| self.front[knee.row].index);
        knee.or_else(|| self.state.reported.top.first()?.indices().first().copied())
    }

    /// What the study's report asks of the sensitivity; `None` if it asks for nothing, or there is no design to look at.
    pub(super) fn look_at_influence(&self, threads: usize, control: &Control) -> Result<Option<InfluenceReport>> {
        let study = &self.plan.study;
        let of_one_design = study.report.sensitivity.as_ref().is_some_and(|it| it.over == InfluenceOver::Uncertainty);
        let named = self.first_named();
        if of_one_design && named.is_none() {
            return Ok(None);
        }
        let Some(subject) = InfluenceSubject::of_report(study, named.unwrap_or(0))? else { return Ok(None) };
        control.reported.fetch_add(subject.work()?.combinations, Ordering::Relaxed);
        subject.look(threads, control).map(Some)
    }

    /// Why there are no files of the sensitivity, if the study asks for them.
    pub fn lacks_influence(&self) -> Option<&'static str> {
        (self.plan.study.report.sensitivity.is_some() && self.influence.is_none()).then_some(NO_DESIGN)
    }

    /// For `summary.json`; `None` if the study asks for nothing.
    pub(super) fn influence_in_brief(&self) -> Option<Value> {
        let spec = self.plan.study.report.sensitivity.as_ref()?;
        Some(self.influence.as_ref().map_or_else(|| json!({ "over": spec.over, "none": NO_DESIGN }), brief))
    }
}
