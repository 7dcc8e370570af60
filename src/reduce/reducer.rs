//! What every reducer that a study may ask for can do.
//!
//! A reducer keeps what one key of `[report]` asks for: it takes in blocks of judged designs, merges with one that took in others, is
//! kept in checkpoints, is written as files of the result and shown on the page. A new one is a type with this trait in a file of its
//! own, its key in the reader of studies, and a line in the list of reducers. Whatever sweeps, certifies, writes or shows goes through
//! the list and knows none of them by name.
//!
//! The Pareto front and the extremes of the objectives are no such reducers. Every engine is built around them: threads and devices drop
//! nearly every design by comparing it with the front known so far, bounds settle boxes by it, and both are there whatever the study
//! asks for besides.

use super::Answers;
use crate::error::Result;
use crate::plan::Plan;
#[cfg(feature = "pictures")]
use crate::reading::Folder;
use crate::screen::{Block, SortedRow};
use crate::study::{Report, Study};
use crate::table::Table;
#[cfg(feature = "pictures")]
use serde_json::{Map, Value};

/// What a reducer must be given of the feasible designs, which decides what can feed it. The text says what asks for it, for whoever
/// cannot: "feasible in `[report]` asks for every feasible design".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReducerNeeds {
    /// Designs that may be among the best by one quantity, or the first in some order: any engine may leave out what surely is neither, and
    /// bounds can search for them.
    Candidates,
    /// Counts of all feasible designs by bins or cells, or the best of each cell: bounds count and search box by box, and a device hands over
    /// both, where its kernel (`screen/gpu/kernel`) has the lines that count or choose for this reducer.
    Counts,
    /// Single feasible designs from everywhere: boxes of designs do not tell them, but a device hands them over.
    Designs(&'static str),
    /// Every feasible design itself, as a block: only what judges designs or rows one by one in f64 gives that. This is what a new reducer
    /// needs as long as no kernel knows of it; it is then refused to devices and bounds, and their automatic choice leaves it to the CPU.
    Blocks(&'static str),
}

impl ReducerNeeds {
    /// Why bounds, which settle boxes of designs whole, cannot feed it; `None` if they can.
    pub fn beyond_bounds(self) -> Option<&'static str> {
        match self {
            Self::Candidates | Self::Counts => None,
            Self::Designs(why) | Self::Blocks(why) => Some(why),
        }
    }

    /// Why a device, which hands over counts and candidates, cannot feed it; `None` if it can.
    pub fn beyond_devices(self) -> Option<&'static str> {
        match self {
            Self::Candidates | Self::Counts | Self::Designs(_) => None,
            Self::Blocks(why) => Some(why),
        }
    }
}

/// What reducers of one kind take, for the estimate before a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReducerRoom {
    /// Cells that are kept, saved and met.
    pub cells: u64,
    /// Tables of cells, which are made one after the other: cells and columns of each.
    pub tables: Vec<(u64, u64)>,
    /// Numbers that every thread has a copy of.
    pub bins: u64,
    /// Numbers in cells on the page.
    pub shown: u64,
    /// Designs that are listed with all columns.
    pub rows: u64,
    /// Of these, designs of which every thread keeps twice as many indices.
    pub indices: u64,
    /// Designs on the page.
    pub dots: u64,
    /// Bytes of packed numbers, at most.
    pub packed: u64,
    /// Files that may be large, and numbers in each.
    pub files: Vec<(String, u64)>,
    /// Tables of designs as text that may be large, and their rows.
    pub lists: Vec<(String, u64)>,
}

impl ReducerRoom {
    /// What both take.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        for (own, other) in [
            (&mut self.cells, other.cells),
            (&mut self.bins, other.bins),
            (&mut self.shown, other.shown),
            (&mut self.rows, other.rows),
            (&mut self.indices, other.indices),
            (&mut self.dots, other.dots),
            (&mut self.packed, other.packed),
        ] {
            *own = own.saturating_add(other);
        }
        self.tables.extend(other.tables);
        self.files.extend(other.files);
        self.lists.extend(other.lists);
        self
    }
}

/// What a reducer writes from.
pub struct ReducerResults<'a> {
    /// The study, laid out.
    pub plan: &'a Plan,
    /// Its number among those of its kind: its place in the study's list.
    pub number: usize,
    /// Threads that may be used.
    pub threads: usize,
    /// Makes the table of its [`Reducer::designs`], certified.
    pub table: &'a dyn Fn() -> Table,
}

/// Takes a file: its name and its bytes.
pub type Put<'a> = dyn FnMut(&str, Vec<u8>) -> Result<()> + 'a;

/// Keeps what one key of `[report]` asks for.
pub trait Reducer: Clone + Sized {
    /// Its state in words, for a state that cannot be one: "its ... cannot be of this study".
    const STATE: &'static str;

    /// All that a study asks for, in its order; they have seen nothing. `ranges` has the range of every histogram.
    fn asked(plan: &Plan, ranges: &[(f64, f64)]) -> Vec<Self>;

    /// What these need, if the report asks for any.
    fn needs(report: &Report) -> Option<ReducerNeeds>;

    /// Takes in a block. The order of blocks, and who takes in which, must not show in the end.
    fn absorb(&mut self, block: &Block<'_>);

    /// Takes in designs of a row in their order, which may tell at once what is kept of them. Counts may be put off to
    /// [`Reducer::end_rows`], which comes before anything else is asked.
    fn absorb_row(&mut self, row: &mut SortedRow<'_>) {
        self.absorb(&row.as_block());
    }

    /// Takes in what was put off of such rows.
    fn end_rows(&mut self) {}

    /// Takes in a block of designs that are counted elsewhere, by a device or by bounds, and may come more than once, see [`Reducer::add_counts`].
    fn absorb_counted(&mut self, block: &Block<'_>) {
        self.absorb(block);
    }

    /// Takes in what one of the same kind has kept of other designs, or of some of the same where it names designs.
    fn merge(&mut self, other: Self);

    /// What a checkpoint keeps.
    fn state(&self) -> Self {
        self.clone()
    }

    /// Can this be what one that was `asked` for keeps of at most `met` designs, all of them below `designs`? What was read from a
    /// checkpoint may have been changed.
    fn fits(&self, asked: &Self, met: u64, designs: u64) -> bool;

    /// Numbers that a copy takes: a thread is given a copy for so much more work at least.
    fn size(&self) -> u64 {
        0
    }

    /// Counts that the kernel of a device makes for it.
    fn count_words(&self) -> usize {
        0
    }

    /// Takes in such counts of designs that the device was sure of.
    fn add_counts(&mut self, _counts: &[u32]) {}

    /// Tells a device what a design must reach to be handed over.
    fn tell(&mut self, _answers: &mut Answers) {}

    /// What two count differently of the same designs: what is counted, this number, the other. Only what a device counts.
    fn miscounts(&self, _other: &Self) -> Option<(&'static str, u64, u64)> {
        None
    }

    /// A design that `fuller` names, which has taken in all that this has and more, and this does not, with what it belongs to.
    fn lacks(&self, _fuller: &Self) -> Option<(&'static str, u64)> {
        None
    }

    /// Designs that the result names, in the order of the table. They are computed again by the reference before anything is written.
    fn designs(&self) -> Vec<u64> {
        Vec::new()
    }

    /// How many of `feasible` designs must be named, if that is known.
    fn designs_of(&self, _feasible: u64) -> Option<u64> {
        None
    }

    /// Are its designs drawn behind the front?
    fn is_behind_the_front(&self) -> bool {
        false
    }

    /// Every file that these may write for a study.
    fn files(study: &Study) -> Vec<String>;

    /// May it write a file of this name for some study?
    fn is_file(name: &str) -> bool;

    /// Writes its files.
    ///
    /// # Errors
    /// Those of `put`, and of the writers of tables.
    fn write(&self, results: &ReducerResults<'_>, put: &mut Put<'_>) -> Result<()>;

    /// Adds to the data of the page what the files of these say.
    ///
    /// # Errors
    /// [`Error::Request`](crate::error::Error::Request) where a file is missing or says other than the study.
    #[cfg(feature = "pictures")]
    fn page(folder: &Folder<'_>, data: &mut Map<String, Value>) -> Result<()>;

    /// What these take.
    fn room(_plan: &Plan) -> ReducerRoom {
        ReducerRoom::default()
    }
}
