//! Random trees that measure what they are asked to, with numbers in them that matter among the values of a few designs.

use super::measure::{ANGLE, PLAIN, Powers, bracket, fraction, is_small, of_name, product, quotient};
use super::tree::{Named, Tree};
use super::walk::{Held, Numbers, Walker, constant};
use crate::random::Random;

/// A name that formulas may read.
#[derive(Clone, Debug)]
pub struct Readable {
    pub name: String,
    pub powers: Powers,
    pub whole: bool,
    /// The words that it may be: then it can be compared only.
    pub words: Vec<String>,
    /// May it have no value?
    pub may_lack: bool,
}

/// Grows trees.
pub struct Grower<'g> {
    pub random: &'g mut Random,
    pub known: Vec<Readable>,
    pub walker: &'g Walker,
    /// The numbers of a few designs.
    pub samples: &'g [Numbers],
}

const SIGNS: [&str; 4] = ["<", "<=", ">", ">="];

impl Grower<'_> {
    /// What a tree comes to in a design, if it has a value there.
    fn value(&mut self, tree: &Tree) -> Option<f64> {
        if !constants_are_good(tree) {
            return None;
        }
        let start = self.random.below(self.samples.len());
        let named = Named { name: String::new(), tree: tree.clone() };
        (0..6).find_map(|at| match self.walker.formula(&named, &self.samples[(start + at) % self.samples.len()]).held {
            Held::Value(value) if value.is_finite() => Some(value),
            _ => None,
        })
    }

    /// A number in some unit that is about this large in SI units.
    pub fn number(&mut self, powers: Powers, si: f64) -> Tree {
        let bracket = bracket(powers, |limit| self.random.below(limit));
        let value = bracket.as_ref().map_or(si, |it| it.measured.of_si(si));
        let digits = self.random.below(4);
        let rounded: f64 = format!("{:.digits$e}", value.abs()).parse().expect("a number was printed");
        let rounded = if rounded.is_finite() && (1e-150..1e150).contains(&rounded) { rounded } else { 1.0 };
        let number = Tree::Number(rounded, bracket);
        if value < 0.0 { Tree::Negative(Box::new(number)) } else { number }
    }

    /// A number of about the size of what a tree comes to.
    fn near(&mut self, powers: Powers, tree: &Tree) -> Tree {
        let value = self.value(tree).filter(|it| *it != 0.0).unwrap_or(1.0);
        let factor = if self.random.chance(0.3) { 1.0 } else { self.random.between(0.3, 1.7) };
        self.number(powers, value * factor)
    }

    /// A positive number of about the size of what a tree comes to.
    fn size(&mut self, powers: Powers, tree: &Tree) -> Tree {
        match self.near(powers, tree) {
            Tree::Negative(of) => *of,
            other => other,
        }
    }

    fn named(&mut self, good: impl Fn(&Readable) -> bool) -> Option<Readable> {
        let good: Vec<&Readable> = self.known.iter().filter(|it| it.words.is_empty() && good(it)).collect();
        // What stands last was made last, and is there to be read.
        let late = self.random.chance(0.5) && good.len() > 4;
        let from = if late { good.len() - 4 } else { 0 };
        (!good.is_empty()).then(|| good[self.random.whole(from, good.len() - 1)].clone())
    }

    /// The powers of some name.
    fn some_powers(&mut self) -> Powers {
        self.named(|_| true).map_or(PLAIN, |it| it.powers)
    }

    fn leaf(&mut self, powers: Powers) -> Tree {
        if self.random.chance(0.06) && powers == PLAIN {
            return Tree::Pi;
        }
        // What may have no value is rare, and matters.
        if let Some(lacking) = self.named(|it| it.may_lack && is_small(quotient(powers, it.powers))).filter(|_| self.random.chance(0.3)) {
            let rest = quotient(powers, lacking.powers);
            let name = Tree::Name(lacking.name);
            return if rest == PLAIN { name } else { Tree::binary('*', name, self.number(rest, 1.0)) };
        }
        match self.named(|it| it.powers == powers) {
            Some(found) if self.random.chance(0.7) => Tree::Name(found.name),
            _ => match self.named(|it| is_small(quotient(powers, it.powers))) {
                Some(other) if other.powers != powers => {
                    let rest = quotient(powers, other.powers);
                    let size = self.random.log_between(0.1, 10.0);
                    Tree::binary('*', Tree::Name(other.name), self.number(rest, size))
                }
                _ => {
                    let size = self.random.log_between(0.05, 20.0);
                    self.number(powers, size)
                }
            },
        }
    }

    /// A plain number of about 1 in some designs.
    fn ratio(&mut self, depth: usize) -> Tree {
        let powers = self.some_powers();
        let above = self.tree(powers, depth.saturating_sub(1));
        let below = self.near(powers, &above);
        Tree::binary('/', above, below)
    }

    /// A plain number that is whole, made such as the language can tell.
    pub fn whole(&mut self, depth: usize) -> Tree {
        if let Some(found) = self.named(|it| it.whole && it.powers == PLAIN).filter(|_| self.random.chance(0.35)) {
            return Tree::Name(found.name);
        }
        if depth == 0 {
            return Tree::Number(self.random.below(12) as f64, None);
        }
        match self.random.below(8) {
            0 => Tree::binary(self.random.pick(&['+', '-', '*']), self.whole(depth - 1), self.whole(depth - 1)),
            1 => Tree::Call(self.random.pick(&["min", "max"]), vec![self.whole(depth - 1), self.whole(depth - 1)]),
            _ => {
                let factor = Tree::Number(self.random.whole(2, 9) as f64, None);
                // A quotient of what is made of whole numbers comes out just below or above a whole one now and then.
                let of = match self.named(|it| it.powers != PLAIN) {
                    Some(name) if self.random.chance(0.5) => {
                        let parts = self.random.whole(3, 50) as f64;
                        let of = Tree::Name(name.name);
                        let si = self.value(&of).filter(|it| it.abs() > 1e-100).unwrap_or(1.0).abs();
                        let bracket = bracket(name.powers, |limit| self.random.below(limit));
                        let part = bracket.as_ref().map_or(si, |it| it.measured.of_si(si)) / parts;
                        Tree::binary('/', of, Tree::Number(part, bracket))
                    }
                    _ => Tree::binary('*', factor, self.ratio(depth)),
                };
                Tree::Call(self.random.pick(&["round", "floor", "ceil"]), vec![of])
            }
        }
    }

    /// A tree that measures this.
    pub fn tree(&mut self, powers: Powers, depth: usize) -> Tree {
        if depth == 0 {
            return self.leaf(powers);
        }
        let d = depth - 1;
        if powers == PLAIN && self.random.chance(0.4) {
            return self.plain(d);
        }
        if powers == ANGLE && self.random.chance(0.5) {
            return self.angle(d);
        }
        match self.random.below(26) {
            0..=2 => {
                let left = self.tree(powers, d);
                let right = if self.random.chance(0.5) { self.near(powers, &left) } else { self.tree(powers, d) };
                Tree::binary(self.random.pick(&['+', '-']), left, right)
            }
            3 | 4 => {
                let other = if self.random.chance(0.4) { PLAIN } else { self.some_powers() };
                let rest = quotient(powers, other);
                if !is_small(rest) {
                    return self.leaf(powers);
                }
                let parts = [self.tree(other, d), self.tree(rest, d)];
                Tree::Binary('*', Box::new(parts))
            }
            5..=7 => {
                let other = if self.random.chance(0.4) { PLAIN } else { self.some_powers() };
                let above = product(powers, other);
                if !is_small(above) {
                    return self.leaf(powers);
                }
                let (above, below) = (self.tree(above, d), self.tree(other, d));
                if below.is_constant() && constant(&below).is_none_or(|it| it == 0.0) {
                    return self.leaf(powers);
                }
                Tree::binary('/', above, below)
            }
            8 | 9 => self.power(powers, d),
            10..=12 => self.choice(powers, d),
            13 => {
                let parts: Vec<Tree> = (0..self.random.whole(2, 3)).map(|_| self.tree(powers, d)).collect();
                Tree::Call(self.random.pick(&["min", "max"]), parts)
            }
            14 => {
                let of = self.tree(powers, d);
                let value = self.value(&of).filter(|it| *it != 0.0).unwrap_or(1.0).abs();
                let (low, high) = (self.number(powers, value * 0.6), self.number(powers, value * 1.3));
                Tree::Call("clamp", vec![of, low, high])
            }
            15 => {
                let of = self.tree(powers, d);
                let middle = self.near(powers, &of);
                Tree::Call("abs", vec![Tree::binary('-', of, middle)])
            }
            16 => {
                let left = self.tree(powers, d);
                let right = self.near(powers, &left);
                Tree::Call("hypot", vec![left, right])
            }
            17 => Tree::Negative(Box::new(self.tree(powers, d))),
            18 | 19 => {
                let of = match self.named(|it| it.may_lack && it.powers == powers) {
                    Some(lacking) => Tree::Name(lacking.name),
                    None => self.tree(powers, d),
                };
                let other = if self.random.chance(0.5) { self.near(powers, &of) } else { self.tree(powers, d) };
                Tree::Call("default", vec![of, other])
            }
            20 if is_small(product(powers, powers)) => {
                let of = self.tree(product(powers, powers), d);
                Tree::Call("sqrt", vec![of])
            }
            21 => self.root(powers, d),
            22 | 23 => self.curve(powers, d),
            _ => {
                let factor = if self.random.chance(0.6) { self.plain(d) } else { self.ratio(d) };
                Tree::binary('*', self.tree(powers, d), factor)
            }
        }
    }

    fn power(&mut self, powers: Powers, depth: usize) -> Tree {
        let by = [(2, 1), (3, 1), (-1, 1), (-2, 1), (1, 2), (3, 2), (-1, 2), (8, 1), (-3, 1), (0, 1), (10, 1), (-9, 1), (1, 3), (7, 4)];
        let (above, below) = by[self.random.below(by.len())];
        let exponent = |above: i8, below: i8| {
            let number = |it: i8| Tree::Number(f64::from(it.abs()), None);
            let value = match below {
                1 => number(above),
                // As a fraction where it has no exact decimals, and now and then elsewhere.
                3 => Tree::binary('/', number(above), number(below)),
                _ => Tree::Number(f64::from(above.abs()) / f64::from(below), None),
            };
            if above < 0 { Tree::Negative(Box::new(value)) } else { value }
        };
        if powers == PLAIN {
            let base = self.ratio(depth);
            if self.random.chance(0.3) {
                let variable = self.ratio(depth);
                return Tree::binary('^', base, variable);
            }
            return Tree::binary('^', base, exponent(above, below));
        }
        match (above != 0).then(|| fraction(powers, below, above)).flatten() {
            Some(of) if is_small(of) => Tree::binary('^', self.tree(of, depth), exponent(above, below)),
            _ => self.leaf(powers),
        }
    }

    fn choice(&mut self, powers: Powers, depth: usize) -> Tree {
        let branches = |grower: &mut Self| [grower.tree(powers, depth), grower.tree(powers, depth)];
        let words: Vec<Readable> = self.known.iter().filter(|it| !it.words.is_empty()).cloned().collect();
        if !words.is_empty() && self.random.chance(0.4) {
            let of = words[self.random.below(words.len())].clone();
            let word = of.words[self.random.below(of.words.len())].clone();
            return Tree::IfWord(of.name, word, Box::new(branches(self)));
        }
        if self.random.chance(0.25) {
            let left = self.whole(depth);
            let right = match self.value(&left) {
                Some(value) if self.random.chance(0.7) && (0.0..1e6).contains(&value) => Tree::Number(value, None),
                _ => self.whole(depth),
            };
            let [then, otherwise] = branches(self);
            return Tree::If("==", Box::new([left, right, then, otherwise]));
        }
        let other = self.some_powers();
        let left = self.tree(other, depth.min(1));
        let right = match self.random.below(5) {
            0 => Tree::Number(0.0, None),
            1 => self.tree(other, depth.min(1)),
            _ => self.near(other, &left),
        };
        let [then, otherwise] = branches(self);
        Tree::If(self.random.pick(&SIGNS), Box::new([left, right, then, otherwise]))
    }

    fn curve(&mut self, powers: Powers, depth: usize) -> Tree {
        let curves = &self.walker.curves;
        let same: Vec<usize> = (0..curves.len()).filter(|&it| of_name(&curves[it].y).powers == powers).collect();
        if same.is_empty() && curves.is_empty() {
            return self.leaf(powers);
        }
        let curve = &curves[if same.is_empty() { self.random.below(curves.len()) } else { same[self.random.below(same.len())] }];
        let (x, y) = (of_name(&curve.x), of_name(&curve.y));
        let (first, last) = (x.to_si(curve.points[0].0), x.to_si(curve.points[curve.points.len() - 1].0));
        let at = if self.random.chance(0.2) {
            self.tree(x.powers, depth)
        } else {
            // Somewhere on the curve, and now and then beyond.
            let (of, middle, half) = (self.ratio(depth), (first + last) / 2.0, (last - first) / 2.0);
            let bounded = Tree::Call("tanh", vec![Tree::binary('-', of, Tree::Number(1.0, None))]);
            let reach = self.random.between(0.3, 1.6);
            let (half, middle) = (self.number(x.powers, half * reach), self.number(x.powers, middle));
            Tree::binary('+', middle, Tree::binary('*', half, bounded))
        };
        if at.is_constant() {
            return self.leaf(powers);
        }
        let value = Tree::Curve(curve.name.clone(), Box::new(at));
        let rest = quotient(powers, y.powers);
        if rest == PLAIN {
            value
        } else if is_small(rest) {
            let size = self.random.log_between(0.1, 10.0);
            Tree::binary('*', value, self.number(rest, size))
        } else {
            self.leaf(powers)
        }
    }

    fn root(&mut self, powers: Powers, depth: usize) -> Tree {
        let goal = self.tree(powers, depth.min(1));
        let mut nested = !is_small(product(powers, product(powers, powers)));
        goal.visit(&mut |part| nested |= matches!(part, Tree::Root(_)));
        if nested {
            return self.leaf(powers);
        }
        let size = self.size(powers, &goal);
        let scaled = || Tree::binary('/', Tree::Unknown, size.clone());
        let upper = Tree::binary('*', Tree::Number(self.random.pick(&[1.0, 2.0, 4.0, 9.0]), None), size.clone());
        let plain = |tree: Tree| Tree::binary('/', tree, size.clone());
        let body = match self.random.below(5) {
            0 => {
                let square = Tree::binary('^', size.clone(), Tree::Number(2.0, None));
                let cube = Tree::binary('^', Tree::Unknown, Tree::Number(3.0, None));
                let all = Tree::binary('+', cube, Tree::binary('*', square.clone(), Tree::Unknown));
                Tree::binary('-', all, Tree::binary('*', square, goal))
            }
            1 => {
                let grown = Tree::Call("exp_m1", vec![scaled()]);
                Tree::binary('-', Tree::binary('+', grown, scaled()), plain(goal))
            }
            2 => {
                let flat = Tree::Call("tanh", vec![scaled()]);
                Tree::binary('-', Tree::binary('+', flat, scaled()), plain(goal))
            }
            3 => {
                let bent = Tree::Call("max", vec![Tree::Unknown, Tree::binary('*', Tree::Number(2.0, None), Tree::Unknown)]);
                Tree::binary('-', Tree::binary('+', bent, Tree::Unknown), goal)
            }
            _ => {
                let turned = Tree::binary('/', Tree::Call("atan", vec![scaled()]), self.number(ANGLE, 1.0));
                Tree::binary('-', Tree::binary('+', turned, scaled()), plain(goal))
            }
        };
        Tree::Root(Box::new([Tree::Number(0.0, None), upper, body]))
    }

    fn plain(&mut self, depth: usize) -> Tree {
        let function = self.random.pick(&[
            "exp", "ln", "log10", "exp_m1", "ln_1p", "tanh", "sin", "cos", "tan", "round", "floor", "ceil", "ln", "log10", "ln_1p", "exp",
        ]);
        let of = match function {
            "sin" | "cos" | "tan" => self.tree(ANGLE, depth),
            "round" | "floor" | "ceil" => return self.whole(depth + 1),
            // Beyond what an exponent may be, now and then.
            "exp" | "exp_m1" if self.random.chance(0.1) => Tree::binary('*', Tree::Number(600.0, None), self.ratio(depth)),
            "ln" | "ln_1p" | "log10" if self.random.chance(0.3) => {
                let least = Tree::Number(self.random.pick(&[0.3, 0.5, 0.7, 1.2]), None);
                Tree::binary('-', self.ratio(depth), least)
            }
            _ => self.ratio(depth),
        };
        Tree::Call(function, vec![of])
    }

    fn angle(&mut self, depth: usize) -> Tree {
        match self.random.below(5) {
            0 => {
                let powers = self.some_powers();
                let parts = vec![self.tree(powers, depth), self.tree(powers, depth)];
                Tree::Call("atan2", parts)
            }
            1 | 2 => {
                let of = if self.random.chance(0.5) { self.ratio(depth) } else { Tree::Call("tanh", vec![self.ratio(depth)]) };
                Tree::Call(self.random.pick(&["asin", "acos", "atan"]), vec![of])
            }
            _ => {
                let size = self.random.between(0.1, 2.0);
                let unit = self.number(ANGLE, size);
                Tree::binary('*', self.ratio(depth), unit)
            }
        }
    }
}

/// Has every part of numbers alone a value? The language refuses others.
pub fn constants_are_good(tree: &Tree) -> bool {
    if tree.is_constant() && !tree.parts().is_empty() {
        return constant(tree).is_some() && tree.parts().into_iter().all(constants_are_good);
    }
    let divides_by_zero = matches!(tree, Tree::Binary('/', parts) if parts[1].is_constant() && constant(&parts[1]) == Some(0.0));
    !divides_by_zero && tree.parts().into_iter().all(constants_are_good)
}
