//! What people see: text on standard output, progress and errors on standard error.

pub mod progress;
pub mod report;

use beltspace::error::{Error, Result};
use console::Style;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;

/// Prints to standard output. A reader that has gone away is no error.
pub fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::io(Path::new("standard output"))(error)),
        _ => Ok(()),
    }
}

/// Prints an error to standard error.
pub fn report_error(error: &Error) {
    let style = Style::new().for_stderr().red().bold();
    // Nothing is left to do if even this cannot be written.
    let _ = writeln!(std::io::stderr(), "{} {error}", style.apply_to("error:"));
}

/// Prints a remark to standard error.
pub fn remark(kind: &str, text: &str) {
    let style = Style::new().for_stderr().yellow().bold();
    let _ = writeln!(std::io::stderr(), "{} {text}", style.apply_to(format!("{kind}:")));
}

/// Bold, where standard output is a terminal.
pub fn bold(text: &str) -> String {
    Style::new().bold().apply_to(text).to_string()
}

/// Dim, where standard output is a terminal.
pub fn dim(text: &str) -> String {
    Style::new().dim().apply_to(text).to_string()
}

/// Columns of standard output if it is a terminal.
pub fn width() -> Option<usize> {
    std::io::stdout().is_terminal().then(|| usize::from(console::Term::stdout().size().1))
}

/// A large number with thin groups of three: 20 615 771.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) && digits.len() > 4 {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A rate or a size in three digits: 1.23e9 becomes `1.23 G`.
pub fn scaled(value: f64) -> String {
    let prefixes = [(1e12, " T"), (1e9, " G"), (1e6, " M"), (1e3, " k")];
    let (divide, prefix) = prefixes.into_iter().find(|(limit, _)| value >= *limit).unwrap_or((1.0, " "));
    let value = value / divide;
    let digits = if value >= 100.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.digits$}{prefix}")
}

/// A time span for people.
pub fn span(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.0} days", s / 86_400.0),
    }
}

/// A number with at most six significant digits.
pub fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    beltspace::export::plain(rounded)
}

/// A path as a shell reads it back as one word.
pub fn quoted(path: &Path) -> String {
    let mut text = path.display().to_string();
    // What begins with a dash would be read as an option.
    if text.starts_with('-') {
        text.insert_str(0, "./");
    }
    quoted_word(&text)
}

/// Text as a shell reads it back as one word.
pub fn quoted_word(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/.-_:+=,@%".contains(c) || (cfg!(windows) && c == '\\');
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else if cfg!(windows) {
        format!("\"{text}\"")
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

/// Text in columns, each as wide as its widest cell; the last one runs free.
#[derive(Debug, Default)]
pub struct Grid {
    rows: Vec<Vec<String>>,
}

impl Grid {
    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// The rows as lines, indented. In a column of numbers they stand at the right.
    pub fn indented(&self, indent: usize) -> String {
        let is_number = |cell: &str| cell.replace(' ', "").parse::<f64>().is_ok();
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.rows.iter().filter_map(|row| row.get(column)).map(|cell| console::measure_text_width(cell)).max().unwrap_or(0)
        };
        let widths: Vec<_> = (0..columns).map(width).collect();
        let of_numbers = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column)).filter(|cell| !cell.is_empty());
            2 * cells.clone().filter(|cell| is_number(cell)).count() > cells.count()
        };
        let of_numbers: Vec<_> = (0..columns).map(of_numbers).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = " ".repeat(indent);
            for (at, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                let padding = " ".repeat(width - console::measure_text_width(cell));
                let number = of_numbers[at] && is_number(cell);
                let cell = if number { format!("{padding}{cell}") } else { format!("{cell}{padding}") };
                line.push_str(&cell);
                if at + 1 < row.len() {
                    line.push_str("  ");
                }
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(grouped(20_615_771), "20 615 771");
        assert_eq!(grouped(1827), "1827");
        assert_eq!(scaled(1.2345e9), "1.23 G");
        assert_eq!(scaled(42.0), "42.0 ");
        assert_eq!(short(0.1 + 0.2), "0.3");
        assert_eq!(short(15_779.612_3), "15779.6");
        assert_eq!(span(0.25), "250 ms");
        assert_eq!(span(5400.0), "90 min");
    }

    #[cfg(unix)]
    #[test]
    fn a_path_with_spaces_is_quoted() {
        assert_eq!(quoted(Path::new("results/my-study_2")), "results/my-study_2");
        assert_eq!(quoted(Path::new("it's here")), r"'it'\''s here'");
    }

    #[test]
    fn a_grid_lines_up() {
        let mut grid = Grid::default();
        grid.row(["a", "10", "x"].map(str::to_owned));
        grid.row(["bbb", "5", "y"].map(str::to_owned));
        assert_eq!(grid.indented(1), " a    10  x\n bbb   5  y\n");
        let mut mixed = Grid::default();
        mixed.row(["what", "12 345"].map(str::to_owned));
        mixed.row(["time", "about 3 s"].map(str::to_owned));
        assert_eq!(mixed.indented(0), "what  12 345\ntime  about 3 s\n");
    }
}
