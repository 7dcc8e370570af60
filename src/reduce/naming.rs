//! Names of the files that reducers write: after a quantity, numbered where it comes again.

use crate::models::is_name;
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

/// Is this the name of such a file: the prefix, what may be the name of a quantity, perhaps numbered, and one of the extensions?
///
/// Quantities may be those of any model, also of one that this program does not know.
pub fn is_named(name: &str, prefix: &str, extensions: &[&str]) -> bool {
    let Some((stem, extension)) = name.rsplit_once('.') else { return false };
    let number = |text: &str| !text.is_empty() && text.bytes().all(|it| it.is_ascii_digit());
    let quantity = |name: &str| is_name(name) || name.rsplit_once('-').is_some_and(|(name, text)| number(text) && is_name(name));
    extensions.contains(&extension) && stem.strip_prefix(prefix).is_some_and(quantity)
}
