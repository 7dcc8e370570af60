//! Lines of a kernel's text, broken where they are too wide.

use std::fmt::Write;

/// A line that is longer is cut into several.
const WIDE: usize = 110;

/// A line with the equation behind it, broken where it is too wide.
pub(super) fn put(text: &mut String, indent: &str, line: &str, equation: &str) {
    let line = if line.len() > WIDE { broken(line, indent.trim_start_matches('\n')) } else { line.to_owned() };
    let behind = if equation.is_empty() { String::new() } else { format!(" // {equation}") };
    writeln!(text, "{indent}{line}{behind}").expect("a text takes everything");
}

/// The outermost call of a long line with each of its arguments in a line of its own.
fn broken(line: &str, indent: &str) -> String {
    let Some(open) = line.find('(') else { return line.to_owned() };
    let Some(close) = line.rfind(')') else { return line.to_owned() };
    // Parentheses that only group have no arguments, and no comma may stand behind what they hold.
    if !line[..open].ends_with(|before: char| before.is_ascii_alphanumeric() || before == '_') {
        return line.to_owned();
    }
    let (mut depth, mut from, mut parts) = (0, open + 1, Vec::new());
    for (at, byte) in line.bytes().enumerate().take(close).skip(open + 1) {
        match byte {
            b'(' => depth += 1,
            b')' => depth -= 1,
            b',' if depth == 0 => {
                parts.push(line[from..at].trim());
                from = at + 1;
            }
            _ => {}
        }
    }
    parts.push(line[from..close].trim());
    let inner = format!("{indent}    ");
    let parts: String = parts
        .iter()
        .map(|part| {
            let part = if part.len() > WIDE { broken(part, &inner) } else { (*part).to_owned() };
            format!("{inner}{part},\n")
        })
        .collect();
    format!("{}(\n{parts}{indent}){}", &line[..open], &line[close + 1..])
}

#[cfg(test)]
mod tests {
    use super::broken;

    #[test]
    fn calls_are_broken_and_parentheses_that_group_are_not() {
        let long = format!("(2.0 * arc_sine({})) + n24", "max(n1, n2) + ".repeat(9) + "n3");
        assert_eq!(broken(&format!("({long})"), "    "), format!("({long})"));
        let call = format!("let n = select(n1, ({long}), n2 >= 0.0);");
        let lines = format!("let n = select(\n        n1,\n        ({long}),\n        n2 >= 0.0,\n    );");
        assert_eq!(broken(&call, "    "), lines);
    }
}
