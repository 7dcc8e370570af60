//! A tornado: each factor alone from one end to the other, the others in the middle.

use super::results::{InfluenceReport, TornadoBar, TornadoReport};
use super::subject::InfluenceSubject;
use crate::error::Result;
use crate::screen::Control;

impl InfluenceSubject {
    /// Every quantity at both ends of every factor.
    pub(super) fn tornado(&self, threads: usize, control: &Control, report: &mut InfluenceReport) -> Result<()> {
        let places = |place: f64| self.factors.iter().map(|it| Ok(it.at(place)?.drawn)).collect::<Result<Vec<f64>>>();
        let (low, middle, high) = (places(0.0)?, places(0.5)?, places(1.0)?);
        // The middle, then of each factor its low and its high end.
        let mut columns: Vec<Vec<f64>> = middle.iter().map(|&it| vec![it; 2 * self.factors.len() + 1]).collect();
        for (factor, column) in columns.iter_mut().enumerate() {
            (column[2 * factor + 1], column[2 * factor + 2]) = (low[factor], high[factor]);
        }
        let values = self.at_drawn(&columns, threads, control)?;
        let model = &self.base.model;
        let present = |value: f64| value.is_finite().then_some(value);
        for (quantity, values) in report.quantities.iter_mut().zip(values) {
            let bar = |(factor, it): (usize, &super::InputFactor)| TornadoBar {
                name: it.name.clone(),
                low: it.told(low[factor], model),
                high: it.told(high[factor], model),
                at_low: present(values[2 * factor + 1]),
                at_high: present(values[2 * factor + 2]),
            };
            let bars = self.factors.iter().enumerate().map(bar).collect();
            quantity.tornado = Some(TornadoReport { middle: present(values[0]), bars });
        }
        Ok(())
    }
}
