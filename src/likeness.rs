//! "Did you mean": finds the known name that is most like a wrong one.

/// The name most like `name`, if one is like enough.
pub fn closest<'n>(name: &str, names: &[&'n str]) -> Option<&'n str> {
    let name = name.to_lowercase();
    // No name is that long, and the distance takes quadratic time.
    if name.is_empty() || name.len() > 80 {
        return None;
    }
    let without_unit = names.iter().find(|known| known.to_lowercase().starts_with(&format!("{name}_")));
    let near = || names.iter().map(|known| (strsim::damerau_levenshtein(&name, &known.to_lowercase()), known)).min_by_key(|&(d, _)| d);
    let close = || near().filter(|&(distance, _)| distance <= (name.chars().count() / 3).max(1)).map(|(_, known)| known);
    without_unit.or_else(close).copied()
}

/// What to tell a person who wrote `name` where one of `names` should stand: the name that was meant, or `otherwise` where no name is like it.
pub fn remedy(name: &str, names: &[&str], otherwise: impl FnOnce() -> String) -> String {
    closest(name, names).map_or_else(otherwise, |close| format!("did you mean \"{close}\"?"))
}

#[cfg(test)]
mod tests {
    use super::{closest, remedy};

    #[test]
    fn a_slip_is_understood_and_another_word_is_not() {
        let names = ["band_count", "band_thickness_mm", "friction"];
        assert_eq!(closest("band_thickness", &names), Some("band_thickness_mm"), "the unit was left out");
        assert_eq!(closest("Frictoin", &names), Some("friction"));
        assert_eq!(closest("speed", &names), None);
        assert_eq!(closest("", &names), None);
        let told = |name: &str| remedy(name, &names, || "there are three".to_owned());
        assert_eq!((told("frction").as_str(), told("speed").as_str()), ("did you mean \"friction\"?", "there are three"));
    }
}
