//! The text of a formula in numbers, names and signs.

use super::problem::Fault;

/// A piece of the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'t> {
    Number(f64),
    /// What stands between brackets.
    Unit(&'t str),
    Name(&'t str),
    Word(&'t str),
    /// An operator, a comparison, a comma or a parenthesis.
    Sign(&'static str),
    End,
}

/// A token with the bytes that it takes.
pub(super) type Placed<'t> = (Token<'t>, std::ops::Range<usize>);

/// Longer ones first.
const SIGNS: [&str; 14] = ["<=", ">=", "==", "<", ">", "+", "-", "*", "/", "^", ",", "(", ")", "−"];

/// What people write that is none of ours, and what to write instead.
const OTHERS: [(&str, &str); 10] = [
    ("**", "a power is written with \"^\""),
    ("!=", "there is no \"!=\"; write if(a == b, y, x)"),
    ("&&", "there is no \"&&\"; put one if(...) into another"),
    ("||", "there is no \"||\"; put one if(...) into another"),
    ("=", "\"=\" compares nothing; write \"==\""),
    ("×", "a product is written with \"*\""),
    ("·", "a product is written with \"*\""),
    ("÷", "a quotient is written with \"/\""),
    ("%", "there is no \"%\" here; write 5[%], or divide by 100"),
    (";", "arguments are separated by commas"),
];

/// Splits a text; the last token is [`Token::End`].
pub(super) fn tokens(text: &str) -> Result<Vec<Placed<'_>>, Fault> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        let (token, length) = match first {
            '0'..='9' | '.' => number(rest, at)?,
            'a'..='z' | 'A'..='Z' | '_' => {
                let length = rest.find(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_')).unwrap_or(rest.len());
                (Token::Name(&rest[..length]), length)
            }
            '[' => match rest.find(']') {
                Some(end) => (Token::Unit(&rest[1..end]), end + 1),
                None => return Err(Fault::new(at, "a unit is not closed; add \"]\"")),
            },
            '\'' | '"' => match rest[1..].find(first) {
                Some(end) => (Token::Word(&rest[1..=end]), end + 2),
                None => return Err(Fault::new(at, format!("a word is not closed; add {first}"))),
            },
            _ => {
                let foreign = OTHERS.iter().find(|(sign, _)| rest.starts_with(sign) && !rest.starts_with("=="));
                if let Some((_, instead)) = foreign {
                    return Err(Fault::new(at, *instead));
                }
                match SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
                    // As word processors write it.
                    Some(&"−") => (Token::Sign("-"), "−".len()),
                    Some(sign) => (Token::Sign(sign), sign.len()),
                    None => return Err(Fault::new(at, format!("\"{}\" has no meaning in a formula", first.escape_debug()))),
                }
            }
        };
        tokens.push((token, at..at + length));
        at += length;
    }
    tokens.push((Token::End, text.len()..text.len()));
    Ok(tokens)
}

fn number(rest: &str, at: usize) -> Result<(Token<'_>, usize), Fault> {
    let bytes = rest.as_bytes();
    let digits = |from: usize| from + bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let last = digits(end + 1 + sign);
        // Without a digit it is a name that follows.
        if last > end + 1 + sign {
            end = last;
        }
    }
    let text = &rest[..end];
    let Ok(value) = text.parse::<f64>() else {
        return Err(Fault::new(at, format!("\"{text}\" is not a number")));
    };
    if !value.is_finite() {
        return Err(Fault::new(at, format!("{text} is too large; numbers go up to 1.8e308")));
    }
    match rest[end..].chars().next() {
        Some('_') => Err(Fault::new(at + end, "a number has digits only; leave out \"_\"")),
        Some('.') => Err(Fault::new(at + end, "a number has one point only")),
        Some(letter) if letter.is_alphabetic() || letter == '°' => {
            Err(Fault::new(at + end, format!("a letter follows the number {text}; write a unit as {text}[mm], and a product with \"*\"")))
        }
        _ => Ok((Token::Number(value), end)),
    }
}
