//! Names of the files that reducers write: after a quantity, numbered where it comes again.

use crate::models;
use std::collections::BTreeSet;

/// The names, each made another one by a number where it was there before.
pub fn numbered(names: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let unique = |name: String| {
        let candidates = std::iter::once(name.clone()).chain((2..).map(|n| format!("{name}-{n}")));
        candidates.into_iter().find(|name| taken.insert(name.clone())).expect("numbers do not run out")
    };
    names.into_iter().map(unique).collect()
}

/// Is this the name of such a file: the prefix, the name of a quantity of some model or one of `others`, perhaps numbered, and one of
/// the extensions?
pub fn is_named(name: &str, prefix: &str, others: &[&str], extensions: &[&str]) -> bool {
    let Some((stem, extension)) = name.rsplit_once('.') else { return false };
    let known = |name: &str| {
        others.contains(&name) || models::all().iter().any(|model| model.input(name).is_some() || model.output(name).is_some())
    };
    let number = |text: &str| !text.is_empty() && text.bytes().all(|it| it.is_ascii_digit());
    let quantity = |name: &str| known(name) || name.rsplit_once('-').is_some_and(|(name, text)| number(text) && known(name));
    extensions.contains(&extension) && stem.strip_prefix(prefix).is_some_and(quantity)
}
