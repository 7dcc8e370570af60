//! CSV files that a study or a model names.

use super::table::{Lines, shortened};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Largest CSV file that is read, in bytes.
const MOST_CSV_BYTES: u64 = 1 << 26;

/// The text of a CSV file that a study or a model (`whose` says which) names.
pub(super) fn csv_text(folder: &Path, name: &str, whose: &str) -> Result<String, String> {
    let path = folder.join(name);
    let name = shortened(name);
    let unreadable = |error: std::io::Error| format!("cannot read \"{name}\": {error}; paths are relative to the folder of the {whose}");
    let file = std::fs::metadata(&path).map_err(unreadable)?;
    if !file.is_file() {
        return Err(format!("\"{name}\" is not a file; name a CSV file"));
    }
    let large = |bytes: u64| Err(format!("\"{name}\" has {bytes} bytes, at most {MOST_CSV_BYTES} are read; split it"));
    if file.len() > MOST_CSV_BYTES {
        return large(file.len());
    }
    // The file may grow while it is read.
    let mut bytes = Vec::new();
    File::open(&path).and_then(|file| file.take(MOST_CSV_BYTES + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
    if bytes.len() as u64 > MOST_CSV_BYTES {
        return large(bytes.len() as u64);
    }
    let text = String::from_utf8(bytes).map_err(|_| format!("\"{name}\" is not UTF-8 text; save it in the encoding UTF-8"))?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// How such a text is read: lines that start with `#` are comments, blank lines are skipped, and spaces around a value do not count.
pub(super) fn csv_builder() -> csv::ReaderBuilder {
    let mut builder = csv::ReaderBuilder::new();
    builder.trim(csv::Trim::All).comment(Some(b'#'));
    builder
}

/// Line number of a record, which starts after blank lines and comments that the reader has skipped.
pub(super) fn record_line(lines: &Lines<'_>, text: &str, record: &csv::StringRecord) -> usize {
    let start = record.position().map_or(0, |position| usize::try_from(position.byte()).unwrap_or(0)).min(text.len());
    let mut at = start;
    loop {
        at += text.as_bytes()[at..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
        if text.as_bytes().get(at) != Some(&b'#') {
            return lines.index(at) + 1;
        }
        at += text.as_bytes()[at..].iter().take_while(|byte| **byte != b'\n').count();
    }
}
