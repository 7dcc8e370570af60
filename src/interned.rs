//! Names that live as long as the program.

use std::collections::HashSet;
use std::hash::Hash;
use std::sync::{LazyLock, Mutex, PoisonError};

/// What was kept so far. A name is kept once, however often a study is read again.
type KeptNames<T> = LazyLock<Mutex<HashSet<&'static T>>>;

fn kept<T: ?Sized + Eq + Hash>(all: &KeptNames<T>, wanted: &T, keep: impl FnOnce() -> &'static T) -> &'static T {
    let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = all.get(wanted) {
        return known;
    }
    let new = keep();
    all.insert(new);
    new
}

/// The same name, kept for good: the tables of models that come with the program hold such.
pub fn interned(name: &str) -> &'static str {
    static NAMES: KeptNames<str> = LazyLock::new(Mutex::default);
    kept(&NAMES, name, || Box::leak(name.into()))
}

/// The same list of names.
pub fn interned_list(names: &[&'static str]) -> &'static [&'static str] {
    static LISTS: KeptNames<[&'static str]> = LazyLock::new(Mutex::default);
    kept(&LISTS, names, || Box::leak(names.into()))
}
