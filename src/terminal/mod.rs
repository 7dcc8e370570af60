//! Output for people: text on standard output, progress and errors on standard error.

mod fill;
mod grid;
pub mod progress;
pub mod report;

use beltspace::error::{Error, Result};
pub use beltspace::sweep::costs::span;
pub use beltspace::table::{counted, grouped, short};
use console::Style;
use fill::filled;
pub use grid::TextGrid;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;

/// Prints to standard output. It is no error if the reader has closed it.
pub fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(harmless(text, true).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::io(Path::new("standard output"))(error)),
        _ => Ok(()),
    }
}

/// Prints an error to standard error.
pub fn report_error(error: &Error) {
    let style = Style::new().for_stderr().red().bold();
    // If even this cannot be written, nothing is left to do.
    let _ = writeln!(std::io::stderr(), "{} {}", style.apply_to("error:"), harmless(&error.to_string(), false));
}

/// Prints a remark to standard error, as wide as the terminal is if it is one.
pub fn remark(kind: &str, text: &str) {
    let style = Style::new().for_stderr().yellow().bold();
    let line = format!("{} {}", style.apply_to(format!("{kind}:")), harmless(text, false));
    let line = if std::io::stderr().is_terminal() { filled(&line, usize::from(console::Term::stderr().size().1)) } else { line };
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Text from a file, such as a title, on one line, with the characters that control a terminal escaped.
pub fn told(text: &str) -> String {
    harmless(text, false).replace('\n', "\\n").replace('\t', "\\t")
}

/// Text with the characters that control a terminal escaped, except line ends, tabs and, if asked for, this program's bold and colours.
fn harmless(text: &str, styled: bool) -> String {
    let mut shown = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(next) = rest.chars().next() {
        let style = if styled { style_at(rest) } else { 0 };
        let (head, tail) = rest.split_at(style.max(next.len_utf8()));
        match next {
            _ if style > 0 => shown.push_str(head),
            '\n' | '\t' => shown.push(next),
            // Besides control characters, these change the direction of the text or end the line.
            '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => shown.extend(next.escape_unicode()),
            next if next.is_control() => shown.extend(next.escape_default()),
            next => shown.push(next),
        }
        rest = tail;
    }
    shown
}

/// Length in bytes of the escape sequence for bold, colour or the like that a text begins with; 0 if there is none.
fn style_at(text: &str) -> usize {
    let Some(code) = text.strip_prefix("\u{1b}[") else { return 0 };
    let digits = code.bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b';').count();
    if code[digits..].starts_with('m') { 2 + digits + 1 } else { 0 }
}

/// Bold, if standard output is a terminal.
pub fn bold(text: &str) -> String {
    Style::new().bold().apply_to(text).to_string()
}

/// Dim, if standard output is a terminal.
pub fn dim(text: &str) -> String {
    Style::new().dim().apply_to(text).to_string()
}

/// Width of standard output in characters, if it is a terminal.
pub fn width() -> Option<usize> {
    std::io::stdout().is_terminal().then(|| usize::from(console::Term::stdout().size().1))
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

/// A path as a shell reads it back as one word.
pub fn quoted(path: &Path) -> String {
    let mut text = path.display().to_string();
    // A name that begins with a dash would be read as an option.
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

/// The command that is running, as a shell reads it; a long one is cut off.
pub fn command_line() -> String {
    const MOST: usize = 200;
    let words = beltspace::program::words().into_iter().skip(1).map(|word| quoted_word(&word.to_string_lossy()));
    let line = std::iter::once("beltspace".to_owned()).chain(words).collect::<Vec<_>>().join(" ");
    if line.chars().count() > MOST { line.chars().take(MOST).chain(" ...".chars()).collect() } else { line }
}

/// Prints text for people: on a terminal, lines that are wider than it are broken between words.
pub fn tell(text: &str) -> Result<()> {
    match width() {
        Some(width) => print(&filled(text, width)),
        None => print(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(grouped(20_615_771), "20 615 771");
        assert_eq!(grouped(1827), "1827");
        assert_eq!([0, 1, 20_000].map(|it| counted(it, "design")), ["0 designs", "1 design", "20 000 designs"]);
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
    fn what_a_terminal_would_obey_is_shown() {
        assert_eq!(
            told("\u{1b}[31mred\u{7}\0x\r\ny\tz \u{202e}\u{9b}K grün"),
            "\\u{1b}[31mred\\u{7}\\u{0}x\\r\\ny\\tz \\u{202e}\\u{9b}K grün"
        );
        // The program's own bold passes; sequences that move the cursor or query the terminal do not, nor one that is cut off.
        assert_eq!(harmless("\u{1b}[1mTitle\u{1b}[0m\n\u{1b}[2J\u{1b}[", true), "\u{1b}[1mTitle\u{1b}[0m\n\\u{1b}[2J\\u{1b}[");
        assert_eq!(harmless("\u{1b}[1m", false), "\\u{1b}[1m");
    }
}
