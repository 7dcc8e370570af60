//! The list of the reducers that a study may ask for.

use super::reducer::{Put, Reducer, ReducerNeeds, ReducerResults, ReducerRoom};
use super::{Answers, FeasibleList, FeasibleSample, Histogram, Map, Top};
use crate::error::Result;
use crate::plan::Plan;
#[cfg(feature = "pictures")]
use crate::reading::Folder;
use crate::screen::{Block, SortedRow};
use crate::study::{Report, Study};
use crate::table::Table;
use serde::{Deserialize, Serialize};
#[cfg(feature = "pictures")]
use serde_json::Value;
use std::ops::Range;

/// The reducers of a study, those of each kind in the study's order; and what is asked of all of them, kind after kind.
macro_rules! reducers {
    ($($(#[$doc:meta])* $field:ident: $kind:ty,)*) => {
        /// What is kept of the feasible designs because `[report]` asks for it: of each kind of reducer those that the study has.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        pub struct Reported {
            $($(#[$doc])* pub $field: Vec<$kind>,)*
        }

        /// Where the reducers of each kind stand among all of a study, kind after kind.
        #[derive(Clone, Debug)]
        pub struct Places {
            $($(#[$doc])* pub $field: Range<usize>,)*
        }

        impl Reported {
            /// Those that a plan asks for, which have seen nothing; `ranges` has the range of every histogram.
            pub fn new(plan: &Plan, ranges: &[(f64, f64)]) -> Self {
                Self { $($field: <$kind>::asked(plan, ranges),)* }
            }

            /// Is nothing asked for?
            pub fn is_empty(&self) -> bool {
                true $(&& self.$field.is_empty())*
            }

            /// What a report needs, kind after kind.
            pub fn needs(report: &Report) -> Vec<ReducerNeeds> {
                [$(<$kind>::needs(report),)*].into_iter().flatten().collect()
            }

            /// Takes in a block.
            pub fn absorb(&mut self, block: &Block<'_>) {
                $(self.$field.iter_mut().for_each(|it| it.absorb(block));)*
            }

            /// Takes in designs of a row in their order.
            pub fn absorb_row(&mut self, row: &mut SortedRow<'_>) {
                $(self.$field.iter_mut().for_each(|it| it.absorb_row(row));)*
            }

            /// Ends rows that came in their order.
            pub fn end_rows(&mut self) {
                $(self.$field.iter_mut().for_each(Reducer::end_rows);)*
            }

            /// Takes in a block of designs that were counted elsewhere.
            pub fn absorb_counted(&mut self, block: &Block<'_>) {
                $(self.$field.iter_mut().for_each(|it| it.absorb_counted(block));)*
            }

            /// Takes in what was made of other designs.
            pub fn merge(&mut self, other: Self) {
                $(self.$field.iter_mut().zip(other.$field).for_each(|(it, other)| it.merge(other));)*
            }

            /// What a checkpoint keeps.
            #[must_use]
            pub fn state(&self) -> Self {
                Self { $($field: self.$field.iter().map(Reducer::state).collect(),)* }
            }

            /// What cannot be what those that were `asked` for keep of at most `met` designs, all below `designs`.
            pub fn misfit(&self, asked: &Self, met: u64, designs: u64) -> Option<&'static str> {
                $(
                    let (own, asked_for) = (&self.$field, &asked.$field);
                    if own.len() != asked_for.len() || !own.iter().zip(asked_for).all(|(it, asked)| it.fits(asked, met, designs)) {
                        return Some(<$kind>::STATE);
                    }
                )*
                None
            }

            /// Numbers that a copy takes.
            pub fn size(&self) -> u64 {
                [$(self.$field.iter().map(Reducer::size).sum::<u64>(),)*].into_iter().sum()
            }

            /// Counts that a device makes, for one after the other.
            pub fn count_words(&self) -> Vec<usize> {
                let mut words = Vec::new();
                $(words.extend(self.$field.iter().map(Reducer::count_words));)*
                words
            }

            /// Takes in such counts.
            pub fn add_counts(&mut self, counts: &[Vec<u32>]) {
                let mut counts = counts.iter();
                $(self.$field.iter_mut().zip(&mut counts).for_each(|(it, counts)| it.add_counts(counts));)*
            }

            /// Tells a device what a design must reach to be handed over.
            pub fn tell(&mut self, answers: &mut Answers) {
                $(self.$field.iter_mut().for_each(|it| it.tell(answers));)*
            }

            /// What two count differently of the same designs.
            pub fn miscounts(&self, other: &Self) -> Option<(&'static str, u64, u64)> {
                None$(.or_else(|| self.$field.iter().zip(&other.$field).find_map(|(it, other)| it.miscounts(other))))*
            }

            /// A design that is missing here, by those that have taken in more.
            pub fn lacks(&self, fuller: &Self) -> Option<(&'static str, u64)> {
                None$(.or_else(|| self.$field.iter().zip(&fuller.$field).find_map(|(it, fuller)| it.lacks(fuller))))*
            }

            /// Where those of each kind stand among all.
            pub fn places(&self) -> Places {
                let mut all = 0;
                let mut next = |count: usize| {
                    all += count;
                    all - count..all
                };
                Places { $($field: next(self.$field.len()),)* }
            }

            /// Designs that each names.
            pub fn designs(&self) -> Vec<Vec<u64>> {
                let mut designs = Vec::new();
                $(designs.extend(self.$field.iter().map(Reducer::designs));)*
                designs
            }

            /// How many of `feasible` designs each must name, where that is known.
            pub fn designs_of(&self, feasible: u64) -> Vec<Option<u64>> {
                let mut designs = Vec::new();
                $(designs.extend(self.$field.iter().map(|it| it.designs_of(feasible)));)*
                designs
            }

            /// Whose designs are drawn behind the front?
            pub fn behind_the_front(&self) -> Vec<bool> {
                let mut behind = Vec::new();
                $(behind.extend(self.$field.iter().map(Reducer::is_behind_the_front));)*
                behind
            }

            /// Every file that the reducers of a study may write.
            pub fn files(study: &Study) -> Vec<String> {
                [$(<$kind>::files(study),)*].concat()
            }

            /// May a reducer write a file of this name for some study?
            pub fn is_file(name: &str) -> bool {
                [$(<$kind>::is_file(name),)*].contains(&true)
            }

            /// Writes the files of all. `table` makes the table of the designs of one, by its place among all.
            ///
            /// # Errors
            /// Those of `put`, and of the writers of tables.
            pub fn write(&self, plan: &Plan, threads: usize, table: &dyn Fn(usize) -> Table, put: &mut Put<'_>) -> Result<()> {
                let mut all = 0..;
                $(
                    for ((number, it), place) in self.$field.iter().enumerate().zip(&mut all) {
                        it.write(&ReducerResults { plan, number, threads, table: &|| table(place) }, put)?;
                    }
                )*
                Ok(())
            }

            /// Adds to the data of the page what their files say.
            ///
            /// # Errors
            /// [`Error::Request`](crate::error::Error::Request) where a file is missing or says other than the study.
            #[cfg(feature = "pictures")]
            pub fn page(folder: &Folder<'_>, data: &mut serde_json::Map<String, Value>) -> Result<()> {
                $(<$kind>::page(folder, data)?;)*
                Ok(())
            }

            /// What all take.
            pub fn room(plan: &Plan) -> ReducerRoom {
                ReducerRoom::default()$(.and(<$kind>::room(plan)))*
            }
        }
    };
}

reducers! {
    /// The best by one quantity, if the study asks for them.
    top: Top,
    /// Histograms.
    histograms: Histogram,
    /// Maps.
    maps: Map,
    /// A sample of the feasible designs, if the study asks for one.
    samples: FeasibleSample,
    /// Every feasible design, if the study asks for them.
    all_feasible: FeasibleList,
}
