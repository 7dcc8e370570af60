//! Distributions, draws and statements about them: against SciPy, closed forms and simulations.

/// How often intervals hold the yield of what was chosen as best.
mod coverage;
/// Distributions against SciPy and identities, and the messages of wrong ones.
mod distributions;
/// Draws: their distributions, correlations, and what they depend on.
mod draws;
/// Proven bounds of yields against closed forms and draws.
mod enclosure;
/// The numbers of SciPy.
mod golden;
/// Statistics and confidence intervals against SciPy, closed forms and simulations.
mod statistics;
