//! The job that a deck was made from, as its first lines state it.

use super::CalculixError;
use crate::pulley::section::{Dimensions, Fineness, SectionKind};
use crate::pulley::turn::Case;
use std::collections::HashMap;

/// A pulley and its loads, to be solved as a three-dimensional model. N, mm, MPa, s, t and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Job {
    /// Type of section.
    pub kind: SectionKind,
    /// Its dimensions.
    pub dimensions: Dimensions,
    /// How finely the section is meshed.
    pub fineness: Fineness,
    /// Loads. An open phase is taken as 0: the model has its bolts at one place.
    pub case: Case,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density, t/mm^3.
    pub density: f64,
    /// Sectors around the axis: quadratic elements of one sector each.
    pub sectors: usize,
}

/// Longest dimension of a section and shortest edge of an element, mm; largest number of a load or material.
const LONGEST: f64 = 1e4;
const SHORTEST_EDGE: f64 = 0.05;
const LARGEST: f64 = 1e15;

impl Job {
    /// Sectors that resolve the belt's load to about 0.1 %.
    pub const USUAL_SECTORS: usize = 68;

    /// Square of the angular speed, 1/s^2.
    pub fn speed_squared(&self) -> f64 {
        if self.density > 0.0 { self.case.spin / self.density } else { 0.0 }
    }

    /// All values by name, as the deck's first lines list them.
    pub fn entries(&self) -> Vec<(String, f64)> {
        let (case, mesh) = (&self.case, &self.fineness);
        let loads = [
            ("normal", case.normal),
            ("along", case.along),
            ("around", case.around),
            ("growth", case.growth),
            ("wrap", case.wrap),
            ("pressure", case.pressure),
            ("phase", case.phase.unwrap_or(0.0)),
            ("spin", case.spin),
        ];
        let lengths = [("straight", mesh.straight), ("bend", mesh.bend), ("held", mesh.held), ("solid", mesh.solid)];
        let counts = [("through", mesh.through), ("harmonics", mesh.harmonics), ("every", mesh.every.into()), ("sectors", self.sectors)];
        let material = [("modulus", case.modulus), ("poisson", self.poisson), ("density", self.density)];
        let group = |group: &'static str| move |(name, value): (&'static str, f64)| (format!("{group}.{name}"), value);
        let mut entries = Vec::new();
        entries.push(("section.type".to_owned(), (self.kind as usize + 1) as f64));
        entries.extend(self.dimensions.entries().into_iter().map(group("section")));
        entries.extend(loads.map(group("load")));
        entries.extend(material.map(group("material")));
        entries.extend(lengths.map(group("mesh")));
        entries.extend(counts.map(|(name, count)| (format!("mesh.{name}"), count as f64)));
        entries
    }

    /// Reads the first lines of a deck.
    ///
    /// # Errors
    /// An input that is missing, is not a number, or has a value that no export writes.
    pub fn from_deck(deck: &str) -> Result<Self, CalculixError> {
        let lines = deck.lines().take_while(|line| line.starts_with("**"));
        let pairs = lines.filter_map(|line| line.trim_start_matches('*').split_once('='));
        let values: HashMap<&str, &str> = pairs.map(|(name, value)| (name.trim(), value.trim())).collect();
        let get = |name: &str| -> Result<f64, CalculixError> {
            let missing = || CalculixError::Unreadable { what: format!("the deck's first lines do not say {name}") };
            values.get(name).and_then(|value| value.parse().ok()).ok_or_else(missing)
        };
        // The file may have been changed: values that no export writes could take all memory, or endless time.
        let within = |name: &str, (least, most): (f64, f64)| -> Result<f64, CalculixError> {
            let value = get(name)?;
            let what = || format!("the deck's first lines say {name} = {value:e}, and it is {least} to {most}; export the pulley again");
            if (least..=most).contains(&value) { Ok(value) } else { Err(CalculixError::Unreadable { what: what() }) }
        };
        let whole = |name: &str, range: (f64, f64)| -> Result<usize, CalculixError> {
            let value = within(name, range)?;
            let what = || format!("the deck's first lines say {name} = {value}, and it is a whole number; export the pulley again");
            if value.fract() == 0.0 { Ok(value as usize) } else { Err(CalculixError::Unreadable { what: what() }) }
        };
        let dimension = |name: &'static str| match name {
            "bolt_count" => whole("section.bolt_count", (1.0, 100.0)).map(|count| count as f64),
            "groove_count" => whole("section.groove_count", (1.0, 100.0)).map(|count| count as f64),
            _ => within(&format!("section.{name}"), (-LONGEST, LONGEST)),
        };
        let load = |name: &str| within(&format!("load.{name}"), (-LARGEST, LARGEST));
        let length = |name: &str| within(&format!("mesh.{name}"), (SHORTEST_EDGE, LONGEST));
        let kind = whole("section.type", (1.0, SectionKind::ALL.len() as f64))?;
        let unknown = || CalculixError::Unreadable { what: format!("there is no type {kind} of section") };
        Ok(Self {
            kind: *kind.checked_sub(1).and_then(|number| SectionKind::ALL.get(number)).ok_or_else(unknown)?,
            dimensions: Dimensions::from_entries(dimension)?,
            fineness: Fineness {
                through: whole("mesh.through", (1.0, 16.0))?,
                straight: length("straight")?,
                bend: length("bend")?,
                held: length("held")?,
                solid: length("solid")?,
                harmonics: whole("mesh.harmonics", (1.0, 200.0))?,
                every: whole("mesh.every", (0.0, 1.0))? == 1,
            },
            case: Case {
                normal: load("normal")?,
                along: load("along")?,
                around: load("around")?,
                growth: load("growth")?,
                wrap: load("wrap")?,
                pressure: load("pressure")?,
                phase: Some(load("phase")?),
                spin: load("spin")?,
                modulus: within("material.modulus", (f64::MIN_POSITIVE, LARGEST))?,
            },
            poisson: within("material.poisson", (0.0, 0.499))?,
            density: within("material.density", (0.0, LARGEST))?,
            sectors: whole("mesh.sectors", (8.0, 720.0))?,
        })
    }
}
