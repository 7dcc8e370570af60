//! No type of the crate is named as another one: a name means one thing, whichever file it stands in.

use crate::shader_constants::{files, read};
use std::collections::BTreeMap;
use std::path::Path;

/// Types that a build without the GPU engine has in place of those with it, in files of this name.
const STAND_INS: [&str; 4] = ["DeviceRecord", "OnDevice", "Trusted", "Wrong"];
const STAND_IN_FILE: &str = "no_device.rs";

/// The types that a source defines. Aliases count where they stand alone; further in they are a trait's.
fn defined(source: &str) -> impl Iterator<Item = &str> {
    source.lines().filter_map(|line| {
        let mut words = line.split_whitespace().skip_while(|word| word.starts_with("pub") || word.ends_with(')') || *word == "unsafe");
        let (keyword, rest) = (words.next()?, words.next()?);
        let is_type = ["struct", "enum", "trait", "union"].contains(&keyword) || keyword == "type" && !line.starts_with(' ');
        let name = rest.split(|it: char| !it.is_alphanumeric() && it != '_').next()?;
        (is_type && name.starts_with(|it: char| it.is_ascii_uppercase())).then_some(name)
    })
}

/// Names that more than one type has, each with the files of its types.
fn repeated(sources: &[(String, String)]) -> BTreeMap<&str, Vec<&str>> {
    let mut places: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (path, source) in sources {
        for name in defined(source) {
            places.entry(name).or_default().push(path);
        }
    }
    places.retain(|_, files| files.len() > 1);
    places
}

#[test]
fn no_type_is_named_as_another() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let relative = |path: &Path| path.strip_prefix(root).expect("it is of the crate").to_string_lossy().into_owned();
    let sources: Vec<_> = files("src", "rs").iter().map(|path| (relative(path), read(path))).collect();
    let mut repeated = repeated(&sources);
    for name in STAND_INS {
        let files = repeated.remove(name).unwrap_or_else(|| panic!("{name} is no pair any more"));
        let stand_ins = files.iter().filter(|path| path.ends_with(STAND_IN_FILE)).count();
        assert_eq!((files.len(), stand_ins), (2, 1), "{name}: {files:?}");
    }
    assert!(repeated.is_empty(), "types of the same name: {repeated:#?}");
}

#[test]
fn types_of_the_same_name_are_noticed() {
    let sources = [
        ("a.rs", "/// struct Line\npub struct Axis;\nimpl T for Axis {\n    type Output = Self;\n}\nstruct Line(f64);"),
        ("b.rs", "mod tests {\n    pub(super) enum Axis<'a> {\n    }\n}\nimpl T for U {\n    type Output = Self;\n}"),
        ("c.rs", "type Place = (i32, i32);\npub type Sum<T> = Result<T, Axis>;\n// struct Sum"),
        ("d.rs", "pub(in crate::d) unsafe trait Place: Sized {}\nstructure Sum;\nunion Twice {\n}\nstruct Twice {\n}"),
    ];
    let sources = sources.map(|(path, source)| (path.to_owned(), source.to_owned()));
    let expected = [("Axis", vec!["a.rs", "b.rs"]), ("Place", vec!["c.rs", "d.rs"]), ("Twice", vec!["d.rs", "d.rs"])];
    assert_eq!(repeated(&sources), BTreeMap::from(expected));
}
