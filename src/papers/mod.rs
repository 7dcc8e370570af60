//! The three papers that the models come from, computed again: their tables and figures, as far as possible, and for each number whether it
//! agrees and why.
//!
//! [`reproduce()`] evaluates the [`models`](crate::models) with the papers' data. Values that had to be chosen or calibrated because a paper
//! does not print them are marked as such. If a model has no answer because the printed numbers are out of its range, or looks at more than
//! the paper does, the printed equation itself is evaluated. What a comparison rests on ([`Basis`]) decides what it is worth that its numbers
//! meet: an identity is no agreement. A [`Comparison`] without a reason is refused.

mod comparison;
mod cvt;
mod evaluated;
mod pulley;
mod readme;
mod timing;

pub use comparison::{Basis, Comparison, Printed, Verdict, check};

use evaluated::Inputs;

use crate::error::{Error, Result};
use crate::files::{Claim, is_there, read_at_most, replace};
use crate::table::{Data, Table, TableColumn, csv_text};
use std::path::Path;

/// Name of the page that a reproduction is read from.
pub const PAGE: &str = "README.md";
/// Name of the table of all comparisons, whose presence makes a folder a reproduction.
pub const MARK: &str = "comparison.csv";
/// Most bytes of it.
const MOST_BYTES: u64 = 1 << 24;

/// One of the papers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Paper {
    /// Rubber and metal V-belt variators.
    Cvt,
    /// Incomplete meshing of a timing belt.
    TimingBelt,
    /// Design and analysis of V-belt pulleys.
    Pulley,
}

impl Paper {
    /// All of them, in the order in which they are shown.
    pub const ALL: [Self; 3] = [Self::Cvt, Self::TimingBelt, Self::Pulley];

    /// A short heading.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cvt => "V-belt variator",
            Self::TimingBelt => "Timing belt",
            Self::Pulley => "V-belt pulley",
        }
    }

    /// Word for tables and file names.
    pub fn key(self) -> &'static str {
        match self {
            Self::Cvt => "cvt",
            Self::TimingBelt => "timing",
            Self::Pulley => "pulley",
        }
    }

    /// Authors and title.
    pub fn citation(self) -> &'static str {
        match self {
            Self::Cvt => {
                "H. S. Kim, K. W. Kim: Comparison of Speed Ratio-Torque Load-Axial Force Characteristics and Their Performance for \
                 Automotive Rubber and Metal V-Belt CVT"
            }
            Self::TimingBelt => {
                "H. S. Kim, C. K. Yeo, I. H. Lee: Force Distribution of Incomplete Meshing Teeth in Timing Belt Drive - on the OHC Drive \
                 Timing Belt System"
            }
            Self::Pulley => "K.-S. Lee, J. H. Hong, J. H. Son, S. H. Lee: Development of V Belt Pulley Design/Analysis System",
        }
    }
}

/// A figure, drawn again from the models.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Name of its files, without `.svg` and `.csv`.
    pub id: &'static str,
    /// What it shows.
    pub title: String,
    /// What it shows, and what in it is not from the paper.
    pub caption: String,
    /// The paper.
    pub group: Paper,
    /// The picture, one self-contained SVG text in the paper's axes.
    pub svg: String,
    /// What is drawn, as numbers.
    pub table: Table,
}

impl Figure {
    /// Name of the picture's file.
    pub fn svg_name(&self) -> String {
        format!("{}.svg", self.id)
    }

    /// Name of the file of its numbers.
    pub fn csv_name(&self) -> String {
        format!("{}.csv", self.id)
    }
}

/// A table, computed again.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperTable {
    /// Name of its file, without `.csv`.
    pub id: &'static str,
    /// What it holds.
    pub title: String,
    /// What it shows, and what in it is not from the paper.
    pub caption: String,
    /// The paper.
    pub group: Paper,
    /// Its cells.
    pub table: Table,
}

impl PaperTable {
    /// Name of its file.
    pub fn csv_name(&self) -> String {
        format!("{}.csv", self.id)
    }
}

/// Something in a paper that cannot be computed again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lost {
    /// The paper.
    pub group: Paper,
    /// What it is.
    pub what: &'static str,
    /// Why not.
    pub why: &'static str,
}

/// An equation or number that is read differently than printed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Repair {
    /// The paper.
    pub group: Paper,
    /// Where it stands.
    pub at: &'static str,
    /// What is printed, what it is read as, and why.
    pub words: &'static str,
}

/// Everything that is computed again of the three papers.
#[derive(Clone, Debug, PartialEq)]
pub struct Reproduction {
    /// The figures, paper by paper.
    pub figures: Vec<Figure>,
    /// The tables, paper by paper.
    pub tables: Vec<PaperTable>,
    /// Every number and statement that can be compared, paper by paper.
    pub comparisons: Vec<Comparison>,
    /// What is read differently than printed.
    pub repairs: Vec<Repair>,
    /// What cannot be computed again.
    pub lost: Vec<Lost>,
}

/// Computes the figures, tables and comparisons of all papers: a few seconds, most of them for the pulleys' finite elements.
///
/// # Errors
/// [`Error::Disagreement`] if a comparison gives no reason, or its verdict does not follow from its numbers ([`check`]).
pub fn reproduce() -> Result<Reproduction> {
    let mut all = Reproduction { figures: Vec::new(), tables: Vec::new(), comparisons: Vec::new(), repairs: Vec::new(), lost: Vec::new() };
    for of_one in [cvt::reproduce(), timing::reproduce(), pulley::reproduce()] {
        all.figures.extend(of_one.figures);
        all.tables.extend(of_one.tables);
        all.comparisons.extend(of_one.comparisons);
        all.repairs.extend(of_one.repairs);
        all.lost.extend(of_one.lost);
    }
    check(&all.comparisons).map_err(Error::Disagreement)?;
    Ok(all)
}

impl Reproduction {
    /// Number of comparisons with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.comparisons.iter().filter(|row| row.verdict == verdict).count()
    }

    /// How many comparisons there are of each kind, in a sentence.
    pub fn summary(&self) -> String {
        let [meeting, missing] = [Verdict::ReadingMeets, Verdict::ReadingMisses].map(|verdict| self.count(verdict));
        format!(
            "{} comparisons: {} agree and {} differ; {} are identities and count as no agreement; {} agree because a value was fitted to them; \
             {} are one of several readings ({meeting} meet the print, {missing} miss it); {} are inputs used as printed; {} have no printed \
             counterpart",
            self.comparisons.len(),
            self.count(Verdict::Agrees),
            self.count(Verdict::Differs),
            self.count(Verdict::Identity),
            self.count(Verdict::Fitted),
            meeting + missing,
            self.count(Verdict::Input),
            self.count(Verdict::NotPrinted),
        )
    }

    /// The files of the reproduction by name, in the order in which they are written; [`MARK`] last.
    pub fn files(&self) -> Vec<(String, Vec<u8>)> {
        let mut files = Vec::new();
        for figure in &self.figures {
            files.push((figure.svg_name(), figure.svg.clone().into_bytes()));
            files.push((figure.csv_name(), csv_text(&figure.table)));
        }
        for table in &self.tables {
            files.push((table.csv_name(), csv_text(&table.table)));
        }
        files.push((PAGE.to_owned(), readme::page(self).into_bytes()));
        files.push((MARK.to_owned(), csv_text(&comparison::table(&self.comparisons))));
        files
    }

    /// Files of a folder that writing there would replace, in the order of their writing.
    pub fn in_the_way(&self, folder: &Path) -> Vec<String> {
        let names = self.files().into_iter().map(|(name, _)| name);
        names.filter(|name| is_there(&folder.join(name))).collect()
    }

    /// Is there a reproduction in a folder, of this version or an older one?
    pub fn is_in(folder: &Path) -> bool {
        let header = csv_text(&comparison::table(&[]));
        read_at_most(&folder.join(MARK), MOST_BYTES).is_ok_and(|bytes| bytes.starts_with(&header))
    }

    /// Writes all files into a directory that this process has claimed. Each is either complete or not there, and [`MARK`] comes last.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, directory: &Claim) -> Result<()> {
        self.files().iter().try_for_each(|(name, bytes)| replace(&directory.path().join(name), bytes))
    }
}

/// A column of numbers.
fn numbers(name: &str, unit: &str, description: &str, values: impl IntoIterator<Item = Option<f64>>) -> TableColumn {
    TableColumn { unit: unit.to_owned(), ..TableColumn::new(name, "paper", description, Data::Number(values.into_iter().collect())) }
}

/// A column of words.
fn words<'a>(name: &str, description: &str, values: impl IntoIterator<Item = &'a str>) -> TableColumn {
    TableColumn::new(name, "paper", description, Data::Text(values.into_iter().map(str::to_owned).collect()))
}
