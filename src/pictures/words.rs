//! Words on a sheet: their style, their estimated width, their line breaks.

use super::colours::INK;
use super::sheet::{Area, Drawn, UNIT};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A sans-serif text style, `size` in pixels.
pub(super) fn text(size: i32, colour: RGBColor, h: HPos, v: VPos) -> TextStyle<'static> {
    // The SVG backend divides sizes by 1.24.
    let font = FontDesc::new(FontFamily::SansSerif, f64::from(size * UNIT) * 1.24, FontStyle::Normal);
    let style = TextStyle::from(font).pos(Pos::new(h, v));
    TextStyle { color: colour.to_backend_color(), ..style }
}

/// Draws lines of text below each other, centred on `x`, the first with its top at `top`.
pub(super) fn centred_lines(area: &Area<'_>, lines: &[String], (x, top): (i32, i32), size: i32) -> Drawn {
    let style = text(size, INK, HPos::Center, VPos::Top);
    for (i, line) in lines.iter().enumerate() {
        area.draw_text(line, &style, (x, top + i as i32 * line_height(size)))?;
    }
    Ok(())
}

/// As [`centred_lines`], but turned to read upwards: the first line furthest left, at `left`.
pub(super) fn upward_lines(area: &Area<'_>, lines: &[String], (left, y): (i32, i32), size: i32) -> Drawn {
    let style = text(size, INK, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
    for (i, line) in lines.iter().enumerate() {
        area.draw_text(line, &style, (left + i as i32 * line_height(size), y))?;
    }
    Ok(())
}

/// Distance of lines of text of a size in pixels, in units of paper.
pub(super) fn line_height(size: i32) -> i32 {
    size * UNIT * 13 / 10
}

/// Estimated width of a text of a size in pixels, in units of paper. Rather too wide: the reader's sans-serif font is unknown, and DejaVu
/// Sans is one of the widest.
pub(super) fn text_width(text: &str, size: i32) -> i32 {
    let thousandths: i32 = text.chars().map(character_width).sum();
    thousandths * size * UNIT / 1000
}

fn character_width(c: char) -> i32 {
    match c {
        'i' | 'j' | 'l' | ' ' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 330,
        'f' | 't' | 'r' | 's' | 'I' | '(' | ')' | '[' | ']' | '/' | '-' => 420,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '→' | '←' | '−' | '×' | '+' | '=' => 880,
        c if c.is_uppercase() => 730,
        // Han, kana and hangul fill a whole square.
        c if c >= '\u{2e80}' => 1000,
        _ => 640,
    }
}

/// One line of text that XML allows: control characters and line breaks become spaces.
pub(super) fn clean(text: &str) -> String {
    let printable = |c: char| match c {
        '\u{fffe}' | '\u{ffff}' => ' ',
        c if c.is_control() => ' ',
        c => c,
    };
    let spaced: String = text.chars().map(printable).collect();
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Breaks a clean text between words, and inside a word that is too long, so that each line fits into
/// `room` units of paper.
pub(super) fn wrap(text: &str, size: i32, room: i32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split(' ') {
        let longer = match line.is_empty() {
            true => word.to_owned(),
            false => format!("{line} {word}"),
        };
        if text_width(&longer, size) <= room {
            line = longer;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        for c in word.chars() {
            if !line.is_empty() && text_width(&format!("{line}{c}"), size) > room {
                lines.push(std::mem::take(&mut line));
            }
            line.push(c);
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

/// A clean text cut to fit into `room` units of paper.
pub(super) fn shortened(text: &str, size: i32, room: i32) -> String {
    match &wrap(text, size, room - text_width("…", size))[..] {
        [first, _, ..] => format!("{first}…"),
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_wraps_between_words_and_inside_long_ones() {
        assert_eq!(wrap("one two", 10, 10_000), ["one two"]);
        assert_eq!(wrap("one two three", 10, 45 * UNIT), ["one two", "three"]);
        assert!(wrap("x".repeat(50).as_str(), 10, 100 * UNIT).len() > 2);
        assert_eq!(wrap("", 10, 100), Vec::<String>::new());
        assert_eq!(wrap("ab", 10, 0), ["a", "b"]);
    }

    #[test]
    fn long_text_is_shortened_visibly() {
        assert_eq!(shortened("short", 10, 100 * UNIT), "short");
        let long = shortened(&"word ".repeat(40), 10, 100 * UNIT);
        assert!(long.ends_with('…') && text_width(&long, 10) <= 100 * UNIT);
    }

    #[test]
    fn clean_text_is_one_printable_line() {
        assert_eq!(clean(" a\n\tb\u{0}c \u{ffff}"), "a b c");
    }
}
