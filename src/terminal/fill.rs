//! Text broken to lines that fit a width.

use console::measure_text_width;

/// Breaks what is too wide between words; the rest of a line is indented as its beginning is. A line with a word that does not fit in any
/// way, such as a path, stays whole: it can be copied.
pub fn filled(text: &str, width: usize) -> String {
    let mut filled = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let (body, end) = line.strip_suffix('\n').map_or((line, ""), |body| (body, "\n"));
        let plain = console::strip_ansi_codes(body);
        let indent = plain.len() - plain.trim_start().len();
        let longest = plain.split_whitespace().map(measure_text_width).max().unwrap_or(0);
        if measure_text_width(body) <= width || indent + longest > width {
            filled.push_str(body);
        } else {
            // Spaces inside a line may be columns: they are kept where it is not broken.
            for (at, piece) in pieces(body, width, indent, |cut| cut.rfind(' ')).into_iter().enumerate() {
                if at > 0 {
                    filled.push('\n');
                    filled.extend(std::iter::repeat_n(' ', indent));
                }
                filled.push_str(piece);
            }
        }
        filled.push_str(end);
    }
    filled
}

/// Cuts text into pieces of `width` at most, those after the first of `indent` less; `last` finds the last place to break in a beginning
/// of it, where a space is dropped and anything else kept.
fn pieces(text: &str, width: usize, indent: usize, last: impl Fn(&str) -> Option<usize>) -> Vec<&str> {
    let mut pieces = Vec::new();
    let mut rest = text;
    let mut room = width;
    while measure_text_width(rest) > room {
        // The longest beginning that fits, with the character behind it, which may be the space to break at.
        let mut end = 0;
        let mut in_style = false;
        for (at, next) in rest.char_indices() {
            end = at;
            // A sequence that is cut would count as letters.
            in_style |= next == '\u{1b}';
            if in_style {
                in_style = next != 'm';
                continue;
            }
            if measure_text_width(&rest[..at + next.len_utf8()]) > room {
                break;
            }
        }
        let next = rest[end..].chars().next().map_or(0, char::len_utf8);
        // A break inside the indentation would leave an empty line.
        let begin = rest.len() - rest.trim_start().len();
        let cut = if rest[end..].starts_with(' ') { Some(end) } else { last(&rest[..end]) }.filter(|&it| it > begin);
        let Some(cut) = cut.or_else(|| rest[end + next..].find(' ').map(|it| end + next + it)) else { break };
        pieces.push(rest[..cut].trim_end());
        rest = rest[cut..].trim_start();
        room = width - indent;
    }
    pieces.push(rest);
    pieces
}

/// The lines of a cell of a table that is `width` wide. It breaks between words and, if asked for, behind the underscores of names; what
/// the whole cell is styled by styles each line.
pub fn cell_lines(cell: &str, width: usize, in_names: bool) -> Vec<String> {
    let (before, plain, after) = style_of(cell);
    let mut lines: Vec<String> = Vec::new();
    for piece in breakable(plain, in_names) {
        match lines.last_mut() {
            Some(line) if measure_text_width(line) + measure_text_width(piece.trim_end()) <= width => line.push_str(piece),
            _ => lines.push(piece.to_owned()),
        }
    }
    lines.iter().map(|line| format!("{before}{}{after}", line.trim_end())).collect()
}

/// The least width that a cell can be broken to.
pub fn least_width(cell: &str, in_names: bool) -> usize {
    let (_, plain, _) = style_of(cell);
    breakable(plain, in_names).map(|it| measure_text_width(it.trim_end())).max().unwrap_or(0)
}

/// Pieces of a cell between which it may be broken: words with the spaces behind them, and parts of names. A number with its unit is one.
fn breakable(text: &str, in_names: bool) -> impl Iterator<Item = &str> {
    let is_number = !text.chars().any(char::is_alphabetic) || text.replace(' ', "").parse::<f64>().is_ok();
    text.split_inclusive(move |it: char| !is_number && (it == ' ' || (in_names && it == '_')))
}

/// Escape sequences at both ends of a cell, and what is between them. Where there are others inside, the cell is taken as it is.
fn style_of(cell: &str) -> (&str, &str, &str) {
    let found = cell.strip_prefix("\u{1b}[").and_then(|rest| {
        let begin = rest.find('m')? + 3;
        let inner = cell[begin..].strip_suffix("\u{1b}[0m")?;
        (!inner.contains('\u{1b}')).then_some((&cell[..begin], inner, "\u{1b}[0m"))
    });
    found.unwrap_or(("", cell, ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_words_and_paths_are_not() {
        assert_eq!(filled("one two three\n", 9), "one two\nthree\n");
        assert_eq!(filled("  one two three\nfour", 9), "  one two\n  three\nfour");
        assert_eq!(filled("a b c", 5), "a b c");
        assert_eq!(filled("result /a/long/path", 11), "result /a/long/path");
        assert_eq!(filled("\u{1b}[1mone two\u{1b}[0m three", 7), "\u{1b}[1mone two\u{1b}[0m\nthree");
        // In every width, no line is wider, and no word is lost.
        let text = "Angle between the two flanks of a pulley: µ and ° count once each";
        for width in 7..80 {
            let broken = filled(text, width);
            assert!(broken.lines().all(|line| measure_text_width(line) <= width), "{width}: {broken}");
            assert_eq!(broken.split_whitespace().collect::<Vec<_>>(), text.split_whitespace().collect::<Vec<_>>());
        }
    }

    #[test]
    fn cells_are_broken_between_words_and_names_if_need_be() {
        assert_eq!(cell_lines("error median", 8, false), ["error", "median"]);
        assert_eq!(cell_lines("driver_axial_force_N", 13, true), ["driver_axial_", "force_N"]);
        assert_eq!(cell_lines("driver_axial_force_N", 13, false), ["driver_axial_force_N"]);
        assert_eq!(cell_lines("\u{1b}[1ma bc\u{1b}[0m", 2, false), ["\u{1b}[1ma\u{1b}[0m", "\u{1b}[1mbc\u{1b}[0m"]);
        assert_eq!((least_width("12 345", true), least_width("5.0 %", true), least_width("a_bcd ef", true)), (6, 5, 3));
    }
}
