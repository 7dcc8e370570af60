//! What CalculiX has printed into its `.dat` file.

use super::CalculixError;
use glam::DVec3;
use std::collections::HashMap;

/// Results of a static analysis.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// Displacements by node, from 0, mm.
    pub displacements: HashMap<usize, DVec3>,
    /// Reactions by node, from 0, N.
    pub reactions: HashMap<usize, DVec3>,
    /// Volume, mm^3.
    pub volume: Option<f64>,
}

impl Results {
    /// Reads the text of a `.dat` file.
    ///
    /// # Errors
    /// A line that is no result, or a file without displacements or reactions.
    pub fn new(text: &str) -> Result<Self, CalculixError> {
        enum FrdBlock {
            Displacements,
            Reactions,
            Volume,
            Other,
        }
        let mut results = Self::default();
        let mut block = FrdBlock::Other;
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
            if line.starts_with(|it: char| it.is_ascii_alphabetic()) {
                block = if line.starts_with("displacements") {
                    FrdBlock::Displacements
                } else if line.starts_with("forces") {
                    FrdBlock::Reactions
                } else if line.starts_with("total volume") {
                    FrdBlock::Volume
                } else {
                    FrdBlock::Other
                };
                continue;
            }
            let unreadable = || CalculixError::Unreadable { what: format!("no result of CalculiX: {line}") };
            let vector = || -> Option<(usize, DVec3)> {
                let mut words = line.split_whitespace();
                let node: usize = words.next()?.parse().ok()?;
                let [x, y, z] = [words.next()?, words.next()?, words.next()?].map(|word| word.parse().ok());
                Some((node.checked_sub(1)?, DVec3::new(x?, y?, z?)))
            };
            match block {
                FrdBlock::Displacements => {
                    let (node, value) = vector().ok_or_else(unreadable)?;
                    results.displacements.insert(node, value);
                }
                FrdBlock::Reactions => {
                    let (node, value) = vector().ok_or_else(unreadable)?;
                    results.reactions.insert(node, value);
                }
                FrdBlock::Volume => results.volume = Some(line.parse().map_err(|_| unreadable())?),
                FrdBlock::Other => (),
            }
        }
        if results.displacements.is_empty() || results.reactions.is_empty() {
            let what = "the results hold no displacements or no reactions: CalculiX has not finished".to_owned();
            return Err(CalculixError::Unreadable { what });
        }
        Ok(results)
    }
}
