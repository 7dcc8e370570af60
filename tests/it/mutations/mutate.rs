//! Mangles bytes, tables, and JSON whose structure stays valid.

use crate::random::Random;
use serde_json::{Map, Value, json};

/// Numbers and words at the edges of what types hold.
const EXTREMES: [&str; 24] = [
    "0",
    "-0.0",
    "-1",
    "2",
    "1e308",
    "-1e308",
    "1e309",
    "5e-324",
    "1e18",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "nan",
    "inf",
    "-inf",
    "",
    "true",
    "\"\"",
    "[]",
    "{}",
    "0x7fffffffffffffff",
];
/// Bytes that mean something to one format or another.
const MARKS: &[u8] = b"\"'[]{}(),.;:=#\\/<>&\n\r\t \0-+eE0\xff\xc3\xef";

fn extreme(random: &mut Random) -> String {
    match random.below(EXTREMES.len() + 2) {
        0 => "9".repeat(random.whole(20, 2000)),
        1 => random.next().to_string(),
        other => EXTREMES[other - 2].to_owned(),
    }
}

/// One or two other numbers in place of those of a text, of which the rest stays.
pub fn numbers(random: &mut Random, whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..random.whole(1, 2) {
        number(random, &mut bytes);
    }
    bytes
}

/// One to four changes of a text or of a file of bytes; `other` is something to put pieces in from.
pub fn bytes(random: &mut Random, whole: &[u8], other: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..random.whole(1, 4) {
        let at = random.below(bytes.len() + 1);
        let most = 1 << random.below(10);
        let end = (at + random.below(most)).min(bytes.len());
        match random.below(10) {
            0 if !bytes.is_empty() => {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
            1 => bytes.insert(at, random.pick(MARKS)),
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let piece = bytes[at..end].to_vec();
                let most = 1 << random.below(8);
                let times = random.whole(1, most);
                bytes.splice(end..end, piece.repeat(times));
            }
            5 => {
                let from = random.below(other.len() + 1);
                let to = (from + random.below(200)).min(other.len());
                bytes.splice(at..end, other[from..to].iter().copied());
            }
            6 => {
                let mark = [random.pick(MARKS)];
                bytes.splice(at..at, mark.repeat(1 << random.below(14)));
            }
            _ => number(random, &mut bytes),
        }
        // Repeated insertions would only make the file large.
        bytes.truncate(1 << 21);
    }
    bytes
}

/// Another number in place of one of a text.
fn number(random: &mut Random, bytes: &mut Vec<u8>) {
    let digit = |byte: &u8| byte.is_ascii_digit();
    let starts: Vec<usize> = (0..bytes.len()).filter(|&at| digit(&bytes[at]) && (at == 0 || !digit(&bytes[at - 1]))).collect();
    if starts.is_empty() {
        return;
    }
    let start = random.pick(&starts);
    let length = bytes[start..].iter().take_while(|it| it.is_ascii_digit() || **it == b'.').count();
    let was: Option<f64> = std::str::from_utf8(&bytes[start..start + length]).ok().and_then(|it| it.parse().ok());
    let to = match (random.below(4), was) {
        // Near enough to mean something.
        (0, Some(was)) => (was + 1.0).to_string(),
        (1, Some(was)) => (was * random.pick(&[0.5, 0.9, 1.1, 10.0, 1e6])).to_string(),
        _ => extreme(random),
    };
    bytes.splice(start..start + length, to.into_bytes());
}

/// A table with cells, columns or rows changed.
pub fn table(random: &mut Random, text: &str) -> String {
    let mut rows: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
    for _ in 0..random.whole(1, 3) {
        let (row, other) = (random.below(rows.len()), random.below(rows.len()));
        let Some(column) = rows.get(row).map(|row| random.below(row.len())) else { break };
        let cell = rows[other].get(column).cloned();
        match random.below(8) {
            0 => rows.swap(row, other),
            1 => drop(rows.remove(row)),
            2 => rows.insert(row, rows[other].clone()),
            3 => rows.iter_mut().filter(|row| row.len() > column).for_each(|row| drop(row.remove(column))),
            4 => rows.iter_mut().filter(|row| row.len() > column).for_each(|row| row.insert(column, row[column].clone())),
            5 if cell.is_some() => rows[row].get_mut(column).into_iter().for_each(|it| *it = cell.clone().unwrap_or_default()),
            _ => rows[row].get_mut(column).into_iter().for_each(|it| *it = extreme(random)),
        }
        if rows.is_empty() {
            break;
        }
    }
    rows.into_iter().flat_map(|row| [row.join(","), "\n".to_owned()]).collect()
}

/// One to three changes of parts of a value.
pub fn json(random: &mut Random, whole: &mut Value) {
    for _ in 0..random.whole(1, 3) {
        let piece = part(random, whole).clone();
        let place = part(random, whole);
        match random.below(6) {
            0 => *place = piece,
            1 => change_list(random, place),
            2 => change_object(random, place),
            _ => *place = leaf(random, place),
        }
    }
}

/// Some part of a value, the deeper ones too.
fn part<'v>(random: &mut Random, value: &'v mut Value) -> &'v mut Value {
    let inside = match value {
        Value::Array(list) => list.len(),
        Value::Object(object) => object.len(),
        _ => 0,
    };
    if inside == 0 || random.chance(0.15) {
        return value;
    }
    let at = random.below(inside);
    let chosen = match value {
        Value::Array(list) => list.get_mut(at),
        Value::Object(object) => object.values_mut().nth(at),
        _ => None,
    };
    part(random, chosen.expect("it is one of those inside"))
}

fn leaf(random: &mut Random, was: &Value) -> Value {
    match random.below(8) {
        0 => Value::Null,
        1 => json!([]),
        2 => json!({}),
        3 => json!("x".repeat(1 << random.below(12))),
        4 => was.as_f64().map_or(json!(true), |it| json!(-it)),
        5 => was.as_u64().map_or(json!(1.5), |it| json!(it.wrapping_add(1))),
        _ => serde_json::from_str(&extreme(random)).unwrap_or(json!(u64::MAX)),
    }
}

fn change_list(random: &mut Random, place: &mut Value) {
    let Value::Array(list) = place else { return };
    let at = random.below(list.len());
    match random.below(4) {
        _ if list.is_empty() => {}
        0 => drop(list.remove(at)),
        1 => list.clear(),
        2 => list.insert(at, list[at].clone()),
        _ => {
            let one = list[at].clone();
            list.extend(std::iter::repeat_n(one, 1 << random.below(12)));
        }
    }
}

fn change_object(random: &mut Random, place: &mut Value) {
    let Value::Object(object) = place else { return };
    let name = object.keys().nth(random.below(object.len())).cloned();
    match (random.below(3), name) {
        (0, Some(name)) => drop(object.remove(&name)),
        (1, Some(name)) => drop(object.insert(format!("{name}_"), json!(1))),
        _ => *object = Map::new(),
    }
}
