//! The operating cases of a drive, one after the other.

use super::super::axis::Axis;
use super::super::spectrum::Spectrum;

/// Every combination of the operation axes, the last axis fastest.
#[derive(Clone, Debug)]
pub struct OperatingCases {
    /// Inputs that they set.
    pub inputs: Vec<usize>,
    /// Of each case: the values of these inputs, in their units.
    pub rows: Vec<Vec<f64>>,
    /// Weights, where an axis has some.
    pub weights: Option<CaseWeights>,
}

/// The weights of the cases of a spectrum.
#[derive(Clone, Debug)]
pub struct CaseWeights {
    /// Of each case: which of the sums it belongs to, and its weight.
    pub places: Vec<(usize, f64)>,
    /// Number of sums: combinations of the other axes.
    pub sums: usize,
    /// Sum of the weights.
    pub total: f64,
}

impl OperatingCases {
    /// Of these axes; without any there is one case.
    pub fn new(axes: &[Axis], spectrum: Option<&Spectrum>) -> Self {
        let inputs: Vec<usize> = axes.iter().flat_map(Axis::inputs).copied().collect();
        let count: u64 = axes.iter().map(Axis::count).product();
        let digits = |mut case: u64| {
            let mut digits: Vec<u64> = axes
                .iter()
                .rev()
                .map(|axis| {
                    let digit = case % axis.count();
                    case /= axis.count();
                    digit
                })
                .collect();
            digits.reverse();
            digits
        };
        let row = |case: u64| -> Vec<f64> {
            let values =
                axes.iter().zip(digits(case)).flat_map(|(axis, digit)| (0..axis.inputs().len()).map(move |it| axis.value(it, digit)));
            values.collect()
        };
        let weights = spectrum.map(|spectrum| {
            let place = |case: u64| {
                let digits = digits(case);
                let others = axes.iter().zip(&digits).enumerate().filter(|(axis, _)| *axis != spectrum.axis);
                let sum = others.fold(0, |sum, (_, (axis, digit))| sum * axis.count() + digit);
                (sum as usize, spectrum.weights[digits[spectrum.axis] as usize])
            };
            let sums = count / axes[spectrum.axis].count();
            CaseWeights { places: (0..count).map(place).collect(), sums: sums as usize, total: spectrum.total() }
        });
        Self { inputs, rows: (0..count).map(row).collect(), weights }
    }
}
