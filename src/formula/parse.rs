//! From text to expression, by how tightly operators bind.

use super::expression::{ComparisonSign, Expression, ExpressionNode, NEGATIVE, Operator};
use super::problem::{Fault, FormulaProblem};
use super::token::{Placed, Token, tokens};

/// Longest formula, in bytes.
pub const MOST_BYTES: usize = 4000;
/// How deep expressions may lie inside one another. A sum of many terms is as deep as it is long.
pub const MOST_DEPTH: usize = 100;
/// How deep parentheses and arguments may lie inside one another: what is written of the deepest expression is read back.
const MOST_OPEN: usize = 3 * MOST_DEPTH;
/// Most arguments of a function.
const MOST_ARGUMENTS: usize = 50;

impl Expression {
    /// Reads a formula. What its names, functions and units mean is not asked yet.
    ///
    /// # Errors
    /// The first place that no formula can have; the problem's formula is 0, without a name.
    pub fn parse(text: &str) -> Result<Self, FormulaProblem> {
        parse(text).map_err(|fault| FormulaProblem::new(0, "", text, fault))
    }
}

/// Reads a formula.
pub(super) fn parse(text: &str) -> Result<Expression, Fault> {
    if text.len() > MOST_BYTES {
        return Err(Fault::new(
            MOST_BYTES,
            format!("a formula may have {MOST_BYTES} bytes, this one has {}; make several of it", text.len()),
        ));
    }
    let tokens = tokens(text)?;
    let mut parser = Parser { tokens: &tokens, at: 0, open: 0 };
    if *parser.peek() == Token::End {
        return Err(Fault::new(0, "the formula is empty"));
    }
    let expression = parser.expression(0)?;
    match parser.peek() {
        Token::End => Ok(expression),
        _ => Err(parser.misplaced()),
    }
}

struct Parser<'p, 't> {
    tokens: &'p [Placed<'t>],
    at: usize,
    /// How many expressions are being read.
    open: usize,
}

impl<'t> Parser<'_, 't> {
    fn peek(&self) -> &Token<'t> {
        &self.tokens[self.at].0
    }

    fn start(&self) -> usize {
        self.tokens[self.at].1.start
    }

    /// Where the token before ends.
    fn end(&self) -> usize {
        self.at.checked_sub(1).map_or(0, |before| self.tokens[before].1.end)
    }

    fn advance(&mut self) -> Token<'t> {
        let token = self.peek().clone();
        // The end stays.
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }

    fn takes(&mut self, sign: &str) -> bool {
        let there = matches!(self.peek(), Token::Sign(it) if *it == sign);
        if there {
            self.advance();
        }
        there
    }

    /// What to say of a token after a complete expression.
    fn misplaced(&self) -> Fault {
        let message = match self.peek() {
            Token::Sign(")") => "a parenthesis is closed that was never opened".to_owned(),
            Token::Sign(",") => "a comma separates arguments of a function only; write decimals with a point".to_owned(),
            Token::Sign("(") => "an operator is missing in front of \"(\"; write a product with \"*\"".to_owned(),
            Token::Sign(sign @ ("<" | "<=" | ">" | ">=" | "==")) => {
                format!("\"{sign}\" compares, which only the first argument of if(...) does; write if(a {sign} b, x, y)")
            }
            Token::Unit(unit) => format!("[{unit}] stands behind no number; write 1[{unit}] * (...)"),
            Token::End => "the formula ends here, but something is not closed; add \")\"".to_owned(),
            other => format!("an operator is missing in front of {}", shown(other)),
        };
        Fault::new(self.start(), message)
    }

    fn too_deep(&self) -> Fault {
        let message = format!("more than {MOST_DEPTH} operations lie inside one another or in a row; give a part a formula of its own");
        Fault::new(self.start(), message)
    }

    fn made(&self, node: ExpressionNode, start: usize) -> Result<Expression, Fault> {
        let expression = Expression::new(node, start..self.end());
        if expression.depth > MOST_DEPTH { Err(self.too_deep()) } else { Ok(expression) }
    }

    /// An expression whose operators bind at least as tightly as `least`.
    fn expression(&mut self, least: u8) -> Result<Expression, Fault> {
        if self.open >= MOST_OPEN {
            return Err(self.too_deep());
        }
        self.open += 1;
        let start = self.start();
        let mut left = self.operand()?;
        loop {
            let operator = match self.peek() {
                Token::Sign("+") => Operator::Add,
                Token::Sign("-") => Operator::Subtract,
                Token::Sign("*") => Operator::Multiply,
                Token::Sign("/") => Operator::Divide,
                Token::Sign("^") => Operator::Power,
                _ => break,
            };
            let (before, behind) = operator.binding();
            if before < least {
                break;
            }
            self.advance();
            let right = self.expression(behind)?;
            left = self.made(ExpressionNode::Binary(operator, Box::new(left), Box::new(right)), start)?;
        }
        self.open -= 1;
        Ok(left)
    }

    /// What stands on either side of an operator.
    fn operand(&mut self) -> Result<Expression, Fault> {
        let start = self.start();
        match self.advance() {
            Token::Number(value) => {
                let unit = match *self.peek() {
                    Token::Unit(unit) => {
                        self.advance();
                        Some(unit.to_owned())
                    }
                    _ => None,
                };
                self.made(ExpressionNode::Number(value, unit), start)
            }
            Token::Name(name) if self.takes("(") => self.call(name, start),
            Token::Name(name) => self.made(ExpressionNode::Name(name.to_owned()), start),
            Token::Word(word) => self.made(ExpressionNode::Word(word.to_owned()), start),
            Token::Sign("-") => {
                let of = self.expression(NEGATIVE)?;
                self.made(ExpressionNode::Negative(Box::new(of)), start)
            }
            Token::Sign("(") => {
                let inner = self.expression(0)?;
                if self.takes(")") { Ok(inner) } else { Err(self.unclosed()) }
            }
            Token::Unit(unit) => Err(Fault::new(start, format!("[{unit}] stands behind no number; write 1[{unit}]"))),
            Token::End => Err(Fault::new(start, "the formula ends where a value should stand")),
            token @ Token::Sign(_) => Err(Fault::new(start, format!("a value should stand in front of {}", shown(&token)))),
        }
    }

    /// What to say where a parenthesis should be closed.
    fn unclosed(&self) -> Fault {
        match self.peek() {
            Token::Sign(",") => Fault::new(self.start(), "a comma separates arguments of a function only; write decimals with a point"),
            _ => self.misplaced(),
        }
    }

    /// A function's arguments, behind its opening parenthesis.
    fn call(&mut self, name: &str, start: usize) -> Result<Expression, Fault> {
        match name {
            "if" => {
                let left = self.expression(0)?;
                let comparison = match self.peek() {
                    Token::Sign("<") => ComparisonSign::Less,
                    Token::Sign("<=") => ComparisonSign::AtMost,
                    Token::Sign(">") => ComparisonSign::Greater,
                    Token::Sign(">=") => ComparisonSign::AtLeast,
                    Token::Sign("==") => ComparisonSign::Equal,
                    _ => return Err(Fault::new(self.start(), "the first argument of if(...) compares; write if(a < b, x, y)")),
                };
                self.advance();
                let right = self.expression(0)?;
                let [then, otherwise] = self.rest("if(a < b, x, y)")?;
                self.made(ExpressionNode::If(comparison, Box::new([left, right, then, otherwise])), start)
            }
            "root" => {
                const EXAMPLE: &str = "root(r, from, to, expression)";
                let at = self.start();
                let Token::Name(unknown) = self.advance() else {
                    return Err(Fault::new(at, format!("the first argument of root is a name for the unknown; write {EXAMPLE}")));
                };
                let rest = self.arguments(EXAMPLE)?;
                let first = if self.takes(",") { Some(Box::new(self.expression(0)?)) } else { None };
                let [] = self.rest(EXAMPLE)?;
                self.made(ExpressionNode::Root(unknown.to_owned(), Box::new(rest), first), start)
            }
            _ => {
                let mut arguments = Vec::new();
                if self.takes(")") {
                    return self.made(ExpressionNode::Call(name.to_owned(), arguments), start);
                }
                loop {
                    if arguments.len() == MOST_ARGUMENTS {
                        return Err(Fault::new(self.start(), format!("a function has at most {MOST_ARGUMENTS} arguments")));
                    }
                    arguments.push(self.expression(0)?);
                    if self.takes(")") {
                        return self.made(ExpressionNode::Call(name.to_owned(), arguments), start);
                    }
                    if !self.takes(",") {
                        return Err(self.misplaced());
                    }
                }
            }
        }
    }

    /// So many arguments, each after a comma.
    fn arguments<const N: usize>(&mut self, example: &str) -> Result<[Expression; N], Fault> {
        let mut rest = Vec::with_capacity(N);
        for _ in 0..N {
            if !self.takes(",") {
                return Err(match self.peek() {
                    Token::Sign(")") => Fault::new(self.start(), format!("an argument is missing; write {example}")),
                    _ => self.misplaced(),
                });
            }
            rest.push(self.expression(0)?);
        }
        rest.try_into().map_err(|_| self.misplaced())
    }

    /// The remaining arguments, each after a comma, and the closing parenthesis.
    fn rest<const N: usize>(&mut self, example: &str) -> Result<[Expression; N], Fault> {
        let rest = self.arguments(example)?;
        match self.peek() {
            Token::Sign(",") => Err(Fault::new(self.start(), format!("this argument is one too many; write {example}"))),
            Token::Sign(")") => {
                self.advance();
                Ok(rest)
            }
            _ => Err(self.misplaced()),
        }
    }
}

/// A token as a person knows it.
fn shown(token: &Token<'_>) -> String {
    match token {
        Token::Number(value) => format!("{value}"),
        Token::Unit(unit) => format!("[{unit}]"),
        Token::Name(name) => format!("\"{name}\""),
        Token::Word(word) => format!("'{word}'"),
        Token::Sign(sign) => format!("\"{sign}\""),
        Token::End => "the end".to_owned(),
    }
}
