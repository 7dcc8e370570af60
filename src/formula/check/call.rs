//! Checks calls of functions and curves.

use super::super::dimension::QuantityDimension;
use super::super::expression::{Expression, ExpressionNode};
use super::super::function::{FUNCTIONS, Function, Kind};
use super::super::nominal::NOMINAL;
use super::super::typed::Typed;
use super::{CheckedTree, Checker, QuantityType, reason};
use crate::likeness::remedy;

impl<'e> Checker<'_, 'e> {
    /// A call of whatever has this name.
    pub(super) fn call(&mut self, name: &'e str, parts: &'e [Expression], at: usize) -> CheckedTree {
        if name == NOMINAL {
            return self.no_nominal(parts, at);
        }
        let arguments: Vec<CheckedTree> = parts.iter().map(|part| self.check(part)).collect();
        if let Some(curve) = self.scope.curves.iter().position(|curve| curve.name == name) {
            return self.curve(curve, &arguments, at);
        }
        let Some(&(_, function, usage, kind)) = FUNCTIONS.iter().find(|(known, ..)| *known == name) else {
            let message = self.unknown_function(name);
            return self.fault(at, message);
        };
        let wanted = usage.matches(',').count() + 1;
        let variadic = matches!(function, Function::Min | Function::Max);
        if arguments.len() < wanted || (arguments.len() > wanted && !variadic) {
            let number = match wanted {
                _ if variadic => "two or more arguments".to_owned(),
                1 => "one argument".to_owned(),
                2 => "two arguments".to_owned(),
                _ => "three arguments".to_owned(),
            };
            return self.fault(at, format!("{name} takes {number}, here it has {}; write {usage}", arguments.len()));
        }
        if arguments.iter().any(|argument| argument.kind == QuantityType::Broken) {
            return CheckedTree::broken();
        }
        if kind == Kind::Whole && arguments[0].varies {
            return self.fault(at, format!("{name} jumps, so the root around it may not exist; keep the unknown out of it"));
        }
        let result = self.result(name, function, kind, &arguments, parts);
        if result == QuantityType::Broken {
            return CheckedTree::broken();
        }
        let need = match function {
            Function::Sqrt => Some(self.need(reason::ROOT, false)),
            Function::Ln | Function::Log10 | Function::Ln1p => Some(self.need(reason::LOGARITHM, true)),
            Function::Asin => Some(self.need(reason::ARC_SINE, false)),
            Function::Acos => Some(self.need(reason::ARC_COSINE, false)),
            Function::Exp | Function::ExpM1 => Some(self.need(reason::SIZE, false)),
            _ => None,
        };
        let keeps_whole = matches!(function, Function::Min | Function::Max | Function::Abs | Function::Clamp | Function::Default);
        let whole = kind == Kind::Whole || (keeps_whole && arguments.iter().all(|argument| argument.whole));
        let typed = Typed::Apply(function, arguments.iter().map(|argument| argument.typed.clone()).collect(), need);
        let of: Vec<&CheckedTree> = arguments.iter().collect();
        let checked = CheckedTree::new(typed, result, whole, &of);
        if function == Function::Default {
            let absent = arguments[1].absent.clone();
            return CheckedTree { absent, ..checked };
        }
        checked
    }

    /// A call of `nominal` that asks for nothing that there is.
    fn no_nominal(&mut self, parts: &'e [Expression], at: usize) -> CheckedTree {
        let message = match parts {
            [Expression { node: ExpressionNode::Name(name), span, .. }] => {
                if !self.slots.iter().any(|slot| slot.name == *name) {
                    let message = self.unknown_name(name);
                    return self.fault(span.start, message);
                }
                format!("{name} has no tolerance that nominal could leave out; write {name} itself")
            }
            _ => "nominal takes the name of an input with a tolerance; write nominal(NAME)".to_owned(),
        };
        self.fault(at, message)
    }

    /// What a function's value measures.
    fn result(&mut self, name: &str, function: Function, kind: Kind, arguments: &[CheckedTree], parts: &'e [Expression]) -> QuantityType {
        let at = parts[0].span.start;
        let plain = QuantityType::Of(QuantityDimension::NONE);
        match kind {
            Kind::Same | Kind::Direction => {
                let mut all = arguments[0].clone();
                for (argument, part) in arguments.iter().zip(parts).skip(1) {
                    let at = part.span.start;
                    let what = |a: &str, b: &str| format!("the arguments of {name} must measure the same; these are {a} and {b}");
                    all.kind = self.unified(&all, argument, at, what);
                    if all.kind == QuantityType::Broken {
                        return all.kind;
                    }
                }
                if function == Function::Atan2 { QuantityType::Of(QuantityDimension::ANGLE) } else { all.kind }
            }
            Kind::Root => match arguments[0].kind {
                QuantityType::Of(dimension) => dimension.power(0.5).map_or_else(
                    || {
                        self.fault(at, format!("the square root of {} is no quantity", self.words(arguments[0].kind)));
                        QuantityType::Broken
                    },
                    QuantityType::Of,
                ),
                other => other,
            },
            Kind::Plain | Kind::Whole | Kind::ToAngle => {
                let given = arguments[0].kind;
                let dimension = given.dimension().unwrap_or(QuantityDimension::NONE);
                if !dimension.is_none() {
                    let unit = dimension.in_base_units(self.scope.units.own());
                    self.fault(at, format!("{name} takes a plain number, not {}; divide it by 1[{unit}] or the like", self.words(given)));
                    return QuantityType::Broken;
                }
                if kind == Kind::ToAngle { QuantityType::Of(QuantityDimension::ANGLE) } else { plain }
            }
            Kind::OfAngle => match arguments[0].kind {
                QuantityType::Zero => plain,
                QuantityType::Of(QuantityDimension::ANGLE) => plain,
                given => {
                    let hint = match &parts[0].node {
                        ExpressionNode::Number(value, None) => format!("write {value}[deg]"),
                        _ if given == plain => "multiply it by 1[rad] if it is one".to_owned(),
                        _ => "divide it by what makes it one".to_owned(),
                    };
                    self.fault(at, format!("{name} takes an angle, not {}; {hint}", self.words(given)));
                    QuantityType::Broken
                }
            },
        }
    }

    fn curve(&mut self, number: usize, arguments: &[CheckedTree], at: usize) -> CheckedTree {
        let scope = self.scope;
        let curve = &scope.curves[number];
        let [argument] = arguments else {
            return self.fault(at, format!("the curve {} takes one argument, here it has {}", curve.name, arguments.len()));
        };
        let fits = match argument.kind {
            QuantityType::Broken => return CheckedTree::broken(),
            QuantityType::Zero => true,
            QuantityType::Of(dimension) => dimension == curve.x.dimension,
        };
        if !fits {
            let wanted = self.words(QuantityType::Of(curve.x.dimension));
            return self.fault(at, format!("the curve {} takes {wanted}, not {}", curve.name, self.words(argument.kind)));
        }
        let need = self.need(format!("{} beyond its ends", curve.name), false);
        CheckedTree::new(
            Typed::Curve(number, Box::new(argument.typed.clone()), need),
            QuantityType::Of(curve.y.dimension),
            false,
            &[argument],
        )
    }

    fn unknown_function(&self, name: &str) -> String {
        if name == "pi" || self.slots.iter().any(|slot| slot.name == name) {
            return format!("{name} is no function; write a product with \"*\"");
        }
        let curves = self.scope.curves.iter().map(|curve| curve.name.as_str());
        let known: Vec<&str> = FUNCTIONS.iter().map(|(function, ..)| *function).chain(["if", "root"]).chain(curves).collect();
        let all = || format!("functions are {}", known.join(", "));
        format!("unknown function \"{name}\"; {}", remedy(name, &known, all))
    }
}
