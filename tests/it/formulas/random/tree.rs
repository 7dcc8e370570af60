//! Formulas as trees, and their text. Nothing here reads a text.

use super::measure::Bracket;
use std::fmt::{self, Display, Formatter};

/// A formula or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    Number(f64, Option<Bracket>),
    Pi,
    Name(String),
    /// The unknown of the root around it.
    Unknown,
    Negative(Box<Tree>),
    /// `+`, `-`, `*`, `/` or `^`.
    Binary(char, Box<[Tree; 2]>),
    /// Compared left and right, then the two branches.
    If(&'static str, Box<[Tree; 4]>),
    /// A name compared with one of its words.
    IfWord(String, String, Box<[Tree; 2]>),
    Call(&'static str, Vec<Tree>),
    Curve(String, Box<Tree>),
    /// From, to, and the expression.
    Root(Box<[Tree; 3]>),
}

/// A formula and its name.
#[derive(Clone, Debug)]
pub struct Named {
    pub name: String,
    pub tree: Tree,
}

/// A curve as its file has it.
#[derive(Clone, Debug)]
pub struct Curve {
    pub name: String,
    pub x: String,
    pub y: String,
    pub points: Vec<(f64, f64)>,
}

/// What the unknown of every root is called.
pub const UNKNOWN: &str = "it";

impl Tree {
    pub fn name(name: &str) -> Self {
        Self::Name(name.to_owned())
    }

    pub fn binary(operator: char, left: Self, right: Self) -> Self {
        Self::Binary(operator, Box::new([left, right]))
    }

    pub fn parts(&self) -> Vec<&Self> {
        match self {
            Self::Number(..) | Self::Pi | Self::Name(_) | Self::Unknown => Vec::new(),
            Self::Negative(of) | Self::Curve(_, of) => vec![of],
            Self::Binary(_, parts) | Self::IfWord(_, _, parts) => parts.iter().collect(),
            Self::If(_, parts) => parts.iter().collect(),
            Self::Call(_, parts) => parts.iter().collect(),
            Self::Root(parts) => parts.iter().collect(),
        }
    }

    /// This part and all within it.
    pub fn visit<'t>(&'t self, seen: &mut impl FnMut(&'t Self)) {
        seen(self);
        self.parts().into_iter().for_each(|part| part.visit(seen));
    }

    /// The names that it reads, each once.
    pub fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        self.visit(&mut |part| {
            if let Self::Name(name) | Self::IfWord(name, ..) = part
                && !names.contains(&name.as_str())
            {
                names.push(name);
            }
        });
        names
    }

    /// Is it the same whatever names stand for? A root never counts as that, and no curve is asked at a number.
    pub fn is_constant(&self) -> bool {
        let mut constant = true;
        let varies = |part: &Self| matches!(part, Self::Name(_) | Self::IfWord(..) | Self::Unknown | Self::Root(_) | Self::Curve(..));
        self.visit(&mut |part| constant &= !varies(part));
        constant
    }

    /// How tightly it holds together: a sum, a product, a minus sign, a power, all else.
    fn tightness(&self) -> u8 {
        match self {
            Self::Binary('+' | '-', _) => 1,
            Self::Binary('*' | '/', _) => 2,
            Self::Negative(_) => 3,
            Self::Binary(..) => 4,
            _ => 5,
        }
    }

    fn write(&self, out: &mut Formatter<'_>, least: u8) -> fmt::Result {
        if self.tightness() < least {
            write!(out, "(")?;
            self.write(out, 0)?;
            return write!(out, ")");
        }
        match self {
            Self::Number(value, bracket) => {
                if *value == 0.0 || (1e-4..1e7).contains(value) {
                    write!(out, "{value}")?
                } else {
                    write!(out, "{value:e}")?
                }
                bracket.as_ref().map_or(Ok(()), |it| write!(out, "[{}]", it.text))
            }
            Self::Pi => write!(out, "pi"),
            Self::Name(name) => write!(out, "{name}"),
            Self::Unknown => write!(out, "{UNKNOWN}"),
            Self::Negative(of) => {
                write!(out, "-")?;
                of.write(out, 3)
            }
            Self::Binary(operator, parts) => {
                // Of operators in a row the left one goes first, but for powers.
                let (left, right) = match operator {
                    '+' | '-' => (1, 2),
                    '*' | '/' => (2, 3),
                    _ => (5, 3),
                };
                parts[0].write(out, left)?;
                if *operator == '^' {
                    write!(out, "^")?
                } else {
                    write!(out, " {operator} ")?
                }
                parts[1].write(out, right)
            }
            Self::If(sign, parts) => write!(out, "if({} {sign} {}, {}, {})", parts[0], parts[1], parts[2], parts[3]),
            Self::IfWord(name, word, parts) => write!(out, "if({name} == '{word}', {}, {})", parts[0], parts[1]),
            Self::Call(function, parts) => {
                let parts: Vec<String> = parts.iter().map(Self::to_string).collect();
                write!(out, "{function}({})", parts.join(", "))
            }
            Self::Curve(name, of) => write!(out, "{name}({of})"),
            Self::Root(parts) => write!(out, "root({UNKNOWN}, {}, {}, {})", parts[0], parts[1], parts[2]),
        }
    }
}

impl Display for Tree {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        self.write(out, 0)
    }
}

#[test]
fn texts_have_the_parentheses_that_they_need() {
    let [a, b, c] = ["a", "b", "c"].map(Tree::name);
    let binary = |operator, x: &Tree, y: &Tree| Tree::binary(operator, x.clone(), y.clone());
    let negative = |of: &Tree| Tree::Negative(Box::new(of.clone()));
    let cases = [
        (binary('-', &a, &binary('-', &b, &c)), "a - (b - c)"),
        (binary('-', &binary('-', &a, &b), &c), "a - b - c"),
        (binary('/', &a, &binary('*', &b, &c)), "a / (b * c)"),
        (binary('^', &binary('^', &a, &b), &c), "(a^b)^c"),
        (binary('^', &a, &binary('^', &b, &c)), "a^b^c"),
        (negative(&binary('^', &a, &b)), "-a^b"),
        (binary('^', &negative(&a), &b), "(-a)^b"),
        (binary('^', &a, &negative(&b)), "a^-b"),
        (binary('*', &negative(&a), &negative(&b)), "-a * -b"),
        (negative(&binary('+', &a, &b)), "-(a + b)"),
    ];
    for (tree, text) in cases {
        assert_eq!(tree.to_string(), text);
    }
}
