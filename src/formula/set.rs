//! A set of formulas that has been checked as a whole.

use super::check::{CheckedTree, Checker, QuantityType, SlotType};
use super::dimension::QuantityDimension;
use super::evaluate::{SlotValues, evaluate};
use super::expression::Expression;
use super::function::is_reserved;
use super::nominal::{nominal_of, own_name, with_nominal_names};
use super::order::{order, path_to_output, place_of, slots_read};
use super::parse::parse;
use super::problem::{Fault, FormulaProblem};
use super::scope::{MeasuredCurve, NameRole, Scope};
use super::typed::{Need, Typed};
use super::unit::QuantityUnit;
use super::written::{FormulaKind, WrittenFormula};
use crate::likeness::closest;
use crate::real::Real;
use std::collections::BTreeSet;

/// Most formulas of a set.
pub const MOST_FORMULAS: usize = 200;
/// Most roots in all formulas together.
pub const MOST_ROOTS: usize = 16;

/// A formula of a set.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StudyFormula {
    /// Its name.
    pub name: String,
    /// As it was written.
    pub text: String,
    /// What it is for.
    pub kind: FormulaKind,
    /// Its unit: that of the input which it gives, or what the end of its name says.
    pub measure: QuantityUnit,
    /// What it says; printed, it is the formula as a person writes it.
    pub expression: Expression,
    /// Where its value goes: the slot of the input that it gives, or one of its own.
    pub slot: usize,
    /// Does it give an input of the model?
    pub gives_input: bool,
    /// Slots that it reads itself.
    pub reads: Vec<usize>,
    /// Slots of all inputs, variables and outputs that it depends on, through other formulas too.
    pub depends_on: Vec<usize>,
    /// Does it depend on an output of the model, itself or through other formulas?
    pub reads_outputs: bool,
    /// Are all its values whole numbers?
    pub whole: bool,
    /// Slots of the names whose absence may make its value absent.
    pub absent_with: Vec<usize>,
    pub(super) typed: Typed,
    needs: Vec<Need>,
}

impl StudyFormula {
    /// The status of a design in which it has no value for this reason.
    fn status(&self, reason: &str) -> String {
        if self.kind == FormulaKind::Margin {
            format!("{}: {reason}", self.name)
        } else {
            format!("formula {}: {reason}", own_name(&self.name))
        }
    }
}

/// What must hold for a formula to have a value. A design that breaks it has the status `formula NAME: REASON`.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FormulaRequirement {
    /// Number of the formula, in the order given.
    pub formula: usize,
    /// The status.
    pub status: String,
    /// Must the margin be greater than zero, rather than at least zero?
    pub strict: bool,
}

/// Formulas that have been checked together, and can be evaluated over any number type.
///
/// Numbers are kept in slots: first the names of the scope, in their order, then the formulas that give no input, in theirs. A formula
/// that gives an input writes to that input's slot. All are in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Formulas {
    formulas: Vec<StudyFormula>,
    curves: Vec<MeasuredCurve>,
    order: Vec<usize>,
    requirements: Vec<FormulaRequirement>,
    /// Of each formula: its first requirement.
    first: Vec<usize>,
    slots: usize,
}

impl Formulas {
    /// Checks formulas, given by name and text, in the order of their file.
    ///
    /// # Errors
    /// Every problem that was found, in the order of the file.
    pub fn new(scope: &Scope, formulas: &[(String, String)]) -> Result<Self, Vec<FormulaProblem>> {
        let formulas: Vec<_> = formulas.iter().map(|(name, text)| WrittenFormula::new(name, text, FormulaKind::Quantity)).collect();
        Self::of(scope, &formulas)
    }

    /// Checks formulas of which it is said what they are for, in the order of their file. Margins come last.
    ///
    /// # Errors
    /// As [`Formulas::new`].
    pub fn of(scope: &Scope, formulas: &[WrittenFormula]) -> Result<Self, Vec<FormulaProblem>> {
        Builder { scope, sources: formulas, problems: Vec::new() }.build()
    }

    /// The formulas, in the order of the file.
    pub fn all(&self) -> &[StudyFormula] {
        &self.formulas
    }

    /// Number of the formula of that name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.formulas.iter().position(|formula| formula.name == name)
    }

    /// Numbers of the formulas in the order in which they are evaluated: by dependence, then as in the file.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// Numbers of the formulas that depend on no output, in order: they are evaluated before the model.
    pub fn before_model(&self) -> impl Iterator<Item = usize> {
        self.order.iter().copied().filter(|&formula| !self.formulas[formula].reads_outputs)
    }

    /// Numbers of the formulas that depend on outputs, in order: they are evaluated after the model.
    pub fn after_model(&self) -> impl Iterator<Item = usize> {
        self.order.iter().copied().filter(|&formula| self.formulas[formula].reads_outputs)
    }

    /// What must hold, in the order in which the formulas are evaluated: the first that is broken is the status.
    pub fn requirements(&self) -> &[FormulaRequirement] {
        &self.requirements
    }

    /// How many slots there are.
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// A formula and all that it depends on, in order.
    pub fn ancestors(&self, formula: usize) -> Vec<usize> {
        let mut found = vec![formula];
        for &other in self.order.iter().rev() {
            if other != formula && found.iter().any(|&it| self.formulas[it].reads.contains(&self.formulas[other].slot)) {
                found.push(other);
            }
        }
        found.sort_by_key(|it| self.order.iter().position(|other| other == it));
        found
    }

    /// A formula and all that depend on it, itself or through others.
    pub fn dependents(&self, formula: usize) -> Vec<usize> {
        let mut slots = vec![self.formulas[formula].slot];
        let mut found = vec![formula];
        for &other in &self.order {
            let it = &self.formulas[other];
            if other != formula && it.reads.iter().any(|slot| slots.contains(slot)) {
                slots.push(it.slot);
                found.push(other);
            }
        }
        found
    }

    /// Does any formula read this slot itself?
    pub fn is_read(&self, slot: usize) -> bool {
        self.formulas.iter().any(|formula| formula.reads.contains(&slot))
    }

    /// Evaluates a formula whose operands are in their slots: writes its value to its slot, whether it has one to `present` (at least
    /// zero if it has, `None` if it always has), and its requirements' margins to `margins`, which has one place for each of
    /// [`Formulas::requirements`].
    ///
    /// # Panics
    /// If `slots` or `present` is shorter than [`Formulas::slots`], or `margins` than [`Formulas::requirements`].
    pub fn evaluate<R: Real>(&self, formula: usize, slots: &mut [R], present: &mut [Option<R>], margins: &mut [R]) {
        let it = &self.formulas[formula];
        let first = self.first[formula];
        let around = SlotValues { slots, present, curves: &self.curves };
        let value = evaluate(&it.typed, &around, &mut margins[first..first + it.needs.len()]);
        slots[it.slot] = value.value;
        present[it.slot] = value.present;
    }

    /// Evaluates all formulas, in order. What outputs are must be known: where formulas give inputs, evaluate
    /// [`Formulas::before_model`] first, then the model, then [`Formulas::after_model`].
    ///
    /// # Panics
    /// As [`Formulas::evaluate`].
    pub fn evaluate_all<R: Real>(&self, slots: &mut [R], present: &mut [Option<R>], margins: &mut [R]) {
        for &formula in &self.order {
            self.evaluate(formula, slots, present, margins);
        }
    }
}

/// Checks a set.
struct Builder<'s> {
    scope: &'s Scope,
    sources: &'s [WrittenFormula],
    problems: Vec<FormulaProblem>,
}

/// Names and texts of formulas, and what is known of each before it is checked.
struct Heads {
    slots: Vec<SlotType>,
    measures: Vec<QuantityUnit>,
    /// Slot of each formula.
    of: Vec<usize>,
    gives_input: Vec<bool>,
}

impl<'s> Builder<'s> {
    fn add(&mut self, formula: usize, fault: Fault) {
        let WrittenFormula { name, text, .. } = &self.sources[formula];
        self.problems.push(FormulaProblem::new(formula, name, text, fault));
    }

    fn build(mut self) -> Result<Formulas, Vec<FormulaProblem>> {
        let sources = self.sources;
        if sources.len() > MOST_FORMULAS {
            let message = format!("there may be at most {MOST_FORMULAS} formulas, here are {}", sources.len());
            self.add(MOST_FORMULAS, Fault::new(0, message));
            return Err(self.problems);
        }
        self.check_curves();
        let mut heads = self.heads();
        let is_known = |name: &str| heads.slots.iter().any(|slot| slot.name == name);
        let expressions: Vec<Option<Expression>> = (0..sources.len())
            .map(|formula| parse(&sources[formula].text).map_err(|fault| self.add(formula, fault)).ok())
            .map(|parsed| parsed.map(|expression| with_nominal_names(&expression, &is_known)))
            .collect();
        let reads: Vec<Vec<usize>> = expressions.iter().map(|expression| slots_read(expression.as_ref(), &heads.slots)).collect();
        let giver = |slot: usize| heads.of.iter().position(|&own| own == slot);
        let formulas_read: Vec<Vec<usize>> = reads.iter().map(|slots| slots.iter().filter_map(|&slot| giver(slot)).collect()).collect();
        let (order, circles) = order(&formulas_read);
        for circle in &circles {
            self.circle(circle, expressions[circle[0]].as_ref());
        }
        let mut depends: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); sources.len()];
        for &formula in &order {
            let mut all = BTreeSet::new();
            for &slot in &reads[formula] {
                match giver(slot) {
                    Some(other) => all.extend(depends[other].clone()),
                    None => {
                        all.insert(slot);
                    }
                }
            }
            depends[formula] = all;
        }
        let is_output = |slot: usize| self.scope.names.get(slot).is_some_and(|name| name.role == NameRole::Output);
        let reads_outputs: Vec<bool> = depends.iter().map(|slots| slots.iter().any(|&slot| is_output(slot))).collect();
        let mut formulas: Vec<Option<StudyFormula>> = vec![None; sources.len()];
        let mut roots = 0;
        for &formula in &order {
            let Some(expression) = &expressions[formula] else { continue };
            if heads.gives_input[formula] && reads_outputs[formula] {
                let path = path_to_output(formula, &reads, giver, is_output);
                self.reads_output(formula, &path, &heads.slots, expression);
            }
            let mut checker = Checker::new(self.scope, &heads.slots);
            let checked = checker.check(expression);
            roots += checker.roots;
            let (mut faults, needs) = (checker.faults, checker.needs);
            if checker.roots > 0 && roots > MOST_ROOTS {
                faults.push(Fault::new(0, format!("there may be at most {MOST_ROOTS} roots in all formulas together")));
            }
            let fits = self.fit(formula, &checked, &heads);
            faults.extend(fits);
            faults.into_iter().for_each(|fault| self.add(formula, fault));
            let slot = heads.of[formula];
            let own = &mut heads.slots[slot];
            own.whole = checked.whole;
            own.absent.clone_from(&checked.absent);
            formulas[formula] = Some(StudyFormula {
                name: sources[formula].name.clone(),
                text: sources[formula].text.clone(),
                kind: sources[formula].kind,
                measure: heads.measures[formula],
                expression: expression.clone(),
                slot,
                gives_input: heads.gives_input[formula],
                reads: reads[formula].clone(),
                depends_on: depends[formula].iter().copied().collect(),
                reads_outputs: reads_outputs[formula],
                whole: checked.whole,
                absent_with: checked.absent,
                typed: checked.typed,
                needs,
            });
        }
        if !self.problems.is_empty() {
            self.problems.sort_by_key(|problem| (problem.formula, problem.at));
            return Err(self.problems);
        }
        let formulas: Vec<StudyFormula> = formulas.into_iter().flatten().collect();
        Ok(put_together(formulas, order, self.scope.curves.clone(), heads.slots.len()))
    }

    /// What each formula is before its text is read: name, slot and unit.
    fn heads(&mut self) -> Heads {
        let scope = self.scope;
        let slot = |name: &super::scope::ScopeName, slot: usize| SlotType {
            name: name.name.clone(),
            dimension: name.measure.dimension,
            whole: name.whole,
            words: name.words.clone(),
            only_words: name.only_words,
            absent: if name.may_be_absent { vec![slot] } else { Vec::new() },
        };
        let slots: Vec<SlotType> = scope.names.iter().enumerate().map(|(at, name)| slot(name, at)).collect();
        let mut heads = Heads { slots, measures: Vec::new(), of: Vec::new(), gives_input: Vec::new() };
        for (formula, WrittenFormula { name, kind, .. }) in self.sources.iter().enumerate() {
            let is_margin = *kind == FormulaKind::Margin;
            // What a formula gives before the tolerance of what it gives.
            let nominal = nominal_of(name).filter(|of| self.sources.iter().any(|other| other.name == *of));
            let known = scope.slot(name);
            let is_input = known.is_some_and(|slot| scope.names[slot].role == NameRole::Input);
            let fault = |builder: &mut Self, message: String| builder.add(formula, Fault::new(0, message));
            if is_margin || nominal.is_some() {
                // Its name is none that a formula could have.
            } else if let Some(message) = unfit_name(name) {
                fault(self, message);
            } else if self.sources[..formula].iter().any(|other| other.name == *name) {
                fault(self, format!("there are two formulas of the name {name}; keep one of the two"));
            } else if scope.curves.iter().any(|curve| curve.name == *name) {
                fault(self, format!("{name} is a curve already; choose another name"));
            }
            match known.map(|slot| scope.names[slot].role) {
                Some(NameRole::Output) => fault(self, format!("{name} is an output of the model already; choose another name")),
                Some(NameRole::Variable) => fault(self, format!("{name} is given as a variable already; drop it there, or here")),
                Some(NameRole::Input) | None => {}
            }
            if let Some(slot) = known.filter(|_| is_input) {
                let input = &mut heads.slots[slot];
                if input.only_words {
                    fault(self, format!("{name} takes words only, and a formula gives numbers"));
                }
                // A number that a formula gives is never a word.
                input.words.clear();
                heads.of.push(slot);
                heads.measures.push(scope.names[slot].measure);
            } else {
                let named = match nominal.map(|of| (of, scope.slot(of))) {
                    _ if is_margin => Ok(QuantityUnit::NONE),
                    Some((_, Some(slot))) => Ok(scope.names[slot].measure),
                    of => scope.units.of_name(of.map_or(name, |it| it.0)),
                };
                let measure = named.unwrap_or_else(|message| {
                    fault(self, message);
                    QuantityUnit::NONE
                });
                heads.of.push(heads.slots.len());
                heads.measures.push(measure);
                // Until it is checked it may be whole: of a circle nothing else is said.
                heads.slots.push(SlotType {
                    name: name.clone(),
                    dimension: measure.dimension,
                    whole: true,
                    words: Vec::new(),
                    only_words: false,
                    absent: Vec::new(),
                });
            }
            heads.gives_input.push(is_input);
        }
        heads
    }

    fn check_curves(&mut self) {
        let curves = &self.scope.curves;
        for (at, curve) in curves.iter().enumerate() {
            let twice = curves[..at].iter().any(|other| other.name == curve.name);
            let message = if twice {
                format!("there are two curves of the name {}; keep one of the two", curve.name)
            } else if self.scope.slot(&curve.name).is_some() {
                format!("{} is an input, output or variable already; choose another name for the curve", curve.name)
            } else if let Some(message) = unfit_name(&curve.name) {
                message
            } else {
                continue;
            };
            self.problems.push(FormulaProblem::new(self.sources.len(), &curve.name, "", Fault::new(0, message)));
        }
    }

    fn circle(&mut self, circle: &[usize], expression: Option<&Expression>) {
        let name = |formula: &usize| self.sources[*formula].name.as_str();
        let path: Vec<&str> = circle.iter().chain(&circle[..1]).map(name).collect();
        let at = place_of(expression, path[1]);
        let mut path: Vec<&str> = path.into_iter().map(own_name).collect();
        path.dedup();
        let message = match path[..] {
            [own] | [own, _] => format!("{own} reads itself"),
            _ => format!("these formulas read each other in a circle: {}", path.join(" -> ")),
        };
        self.add(circle[0], Fault::new(at, message));
    }

    fn reads_output(&mut self, formula: usize, path: &[usize], slots: &[SlotType], expression: &Expression) {
        let name = self.sources[formula].name.as_str();
        let first = path.first().map_or("", |&slot| slots[slot].name.as_str());
        let mut names: Vec<&str> = path.iter().map(|&slot| own_name(&slots[slot].name)).collect();
        names.dedup();
        names.retain(|it| *it != name);
        let output = names.last().copied().unwrap_or_default();
        let through = if names.len() > 1 { format!(" ({name} -> {})", names.join(" -> ")) } else { String::new() };
        let message = format!(
            "{name} is an input of the model, so it cannot depend on {output}, which is an output{through}: the model is evaluated once"
        );
        let at = place_of(Some(expression), first);
        self.add(formula, Fault::new(at, message));
    }

    /// Does the value fit what the formula's name says?
    fn fit(&self, formula: usize, checked: &CheckedTree, heads: &Heads) -> Option<Fault> {
        let WrittenFormula { name, kind, .. } = &self.sources[formula];
        if *kind == FormulaKind::Margin {
            return None;
        }
        let wanted = heads.measures[formula].dimension;
        let given = match checked.kind {
            QuantityType::Of(dimension) => dimension,
            QuantityType::Zero => wanted,
            QuantityType::Broken => return None,
        };
        let units = &self.scope.units;
        let own = own_name(name);
        if given != wanted {
            let (given, said) = (units.in_words(given), units.in_words(wanted));
            let hint = if wanted == QuantityDimension::NONE && !heads.gives_input[formula] && own == name {
                "; end the name in the unit, as belt_mass_kg does, or divide by one"
            } else {
                ""
            };
            return Some(Fault::new(0, format!("the formula gives {given}, but {own} is {said}{hint}")));
        }
        let must_be_whole = heads.gives_input[formula] && self.scope.names[heads.of[formula]].whole;
        if must_be_whole && !checked.whole {
            return Some(Fault::new(0, format!("{name} takes whole numbers; end the formula in round(...), floor(...) or ceil(...)")));
        }
        if *kind == FormulaKind::Whole && !checked.whole {
            let remedy = "end the formula in round(...), floor(...) or ceil(...), or drop integer";
            return Some(Fault::new(0, format!("{name} is said to be whole, but this may give other numbers; {remedy}")));
        }
        None
    }
}

/// The set with its requirements numbered.
fn put_together(formulas: Vec<StudyFormula>, order: Vec<usize>, curves: Vec<MeasuredCurve>, slots: usize) -> Formulas {
    let mut requirements = Vec::new();
    let mut first = vec![0; formulas.len()];
    for &formula in &order {
        first[formula] = requirements.len();
        let it = &formulas[formula];
        requirements.extend(it.needs.iter().map(|need| FormulaRequirement {
            formula,
            status: it.status(&need.reason),
            strict: need.strict,
        }));
    }
    Formulas { formulas, curves, order, requirements, first, slots }
}

/// Why this cannot be the name of a formula or curve.
fn unfit_name(name: &str) -> Option<String> {
    let is_name = name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
        && name.len() <= 80;
    if is_reserved(name) {
        Some(format!("{name} means something in every formula; choose another name"))
    } else if !is_name {
        Some(format!("\"{name}\" is no name; use up to 80 letters, digits and \"_\", a letter first"))
    } else {
        None
    }
}

/// The name most like `name` among what a set of formulas reads without knowing it: what a name that nothing reads was meant to be.
pub fn meant<'t>(name: &str, texts: impl IntoIterator<Item = &'t str>) -> Option<String> {
    let read: Vec<Expression> = texts.into_iter().filter_map(|text| parse(text).ok()).collect();
    let names: Vec<&str> = read.iter().flat_map(Expression::names).map(|(read, _)| read).filter(|read| *read != name).collect();
    closest(name, &names).map(str::to_owned)
}
