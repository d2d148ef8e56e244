//! What formulas are made of: atoms and numbers, with the names, types and units of a scenario.

use hrdsl_ir::{Program, Type, Unit, Value, formula::MetricFormula, world::SignalId};
use hrdsl_source::Enumeration;

use super::{
    error::{FormulaError, TextRange},
    names::{Named, resolve},
    tree::{Comparator, FormulaTree, TermFunction, TermOperator, TreeKind},
};
use crate::atom::{AtomSource, NumberOperator, NumberTerm};

pub(super) type Checked<T> = Result<T, FormulaError>;

/// What is known of a formula so far.
pub(super) struct FormulaChecker<'a> {
    pub program: &'a Program,
    pub text: &'a str,
    pub signals: Vec<SignalId>,
    pub atoms: Vec<AtomSource>,
    /// As they are written.
    pub texts: Vec<String>,
    /// Those of the comparisons so far.
    pub units: Vec<Unit>,
}

/// What an operand of a comparison is.
enum Operand {
    Number(NumberTerm, OperandUnit),
    Truth,
    Choice(usize, Enumeration),
}

/// A bare zero has every unit.
#[derive(Clone, Copy, PartialEq)]
enum OperandUnit {
    Any,
    Of(Unit),
}

impl FormulaChecker<'_> {
    pub fn shown(&self, range: &TextRange) -> &str {
        self.text.get(range.clone()).unwrap_or_default()
    }

    fn atom(&mut self, atom: AtomSource, tree: &FormulaTree) -> MetricFormula {
        let known = self.atoms.iter().position(|a| *a == atom);
        MetricFormula::Atom(known.unwrap_or_else(|| {
            self.atoms.push(atom);
            self.texts.push(self.shown(&tree.range).split_whitespace().collect::<Vec<_>>().join(" "));
            self.atoms.len() - 1
        }))
    }

    fn slot(&mut self, signal: SignalId) -> usize {
        let known = self.signals.iter().position(|s| *s == signal);
        known.unwrap_or_else(|| {
            self.signals.push(signal);
            self.signals.len() - 1
        })
    }

    /// A name that stands alone: an event, a signal that is true or false, `true`, `false`.
    pub fn named(&mut self, tree: &FormulaTree) -> Checked<MetricFormula> {
        match self.shown(&tree.range) {
            "true" => return Ok(MetricFormula::Constant(true)),
            "false" => return Ok(MetricFormula::Constant(false)),
            _ => {}
        }
        match resolve(self.program, self.text, tree)? {
            Named::Event(pattern) => Ok(self.atom(AtomSource::Happens(pattern), tree)),
            Named::Signal(signal, Type::Bool) => {
                let slot = self.slot(signal);
                Ok(self.atom(AtomSource::Truth(slot), tree))
            }
            Named::Signal(_, ty) => {
                let shown = self.shown(&tree.range);
                let help = match ty {
                    Type::Enum(of) => format!("compare it with one of its values: {}", of.listed()),
                    Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Text | Type::List(_) => {
                        format!("compare it, as in `{shown} < 3`, with a unit if it has one")
                    }
                };
                let message = format!("`{shown}` is neither true nor false");
                Err(FormulaError::new(&tree.range, message).help(help))
            }
        }
    }

    pub fn comparison(
        &mut self,
        tree: &FormulaTree,
        comparator: Comparator,
        a: &FormulaTree,
        b: &FormulaTree,
    ) -> Checked<MetricFormula> {
        let equality = match comparator {
            Comparator::Equal => Some(false),
            Comparator::Unequal => Some(true),
            Comparator::Less | Comparator::AtMost | Comparator::Greater | Comparator::AtLeast => None,
        };
        match (self.operand(a)?, equality) {
            (Operand::Number(left, left_unit), _) => {
                let (right, right_unit) = self.number(b)?;
                let unit = self.same_unit(tree, (a, left_unit), (b, right_unit))?;
                self.units.push(unit);
                Ok(self.atom(compared(comparator, left, right), tree))
            }
            (Operand::Choice(signal, of), Some(negated)) => {
                let name = self.shown(&b.range);
                let Some(value) = of.symbol(name).map(Value::Symbol) else {
                    let message = format!("`{name}` is no value of `{}`", self.shown(&a.range));
                    return Err(
                        FormulaError::new(&b.range, message).help(format!("its values are {}", of.listed()))
                    );
                };
                Ok(self.atom(AtomSource::Is { signal, value, negated }, tree))
            }
            (Operand::Choice(..), None) => {
                let message = format!("`{}` has no order", self.shown(&a.range));
                Err(FormulaError::new(&tree.range, message).help("compare it with `==` or `!=`"))
            }
            (Operand::Truth, _) => {
                let shown = self.shown(&a.range);
                let message = format!("`{shown}` is true or false, and not compared");
                Err(FormulaError::new(&tree.range, message)
                    .help(format!("write `{shown}`, or `not {shown}`")))
            }
        }
    }

    fn same_unit(
        &self,
        tree: &FormulaTree,
        (a, left): (&FormulaTree, OperandUnit),
        (b, right): (&FormulaTree, OperandUnit),
    ) -> Checked<Unit> {
        match (left, right) {
            (OperandUnit::Any, OperandUnit::Any) => Ok(Unit::None),
            (OperandUnit::Of(unit), OperandUnit::Any) | (OperandUnit::Any, OperandUnit::Of(unit)) => Ok(unit),
            (OperandUnit::Of(left), OperandUnit::Of(right)) if left == right => Ok(left),
            (OperandUnit::Of(left), OperandUnit::Of(right)) => {
                let (a, b) = (self.shown(&a.range), self.shown(&b.range));
                let message = format!("`{a}` {}, and `{b}` {}", measured(left), measured(right));
                let (bare, unit) = if left == Unit::None { (a, right) } else { (b, left) };
                let error = FormulaError::new(&tree.range, message);
                if (left == Unit::None) == (right == Unit::None) {
                    return Err(error.help("both sides need the same unit"));
                }
                Err(error.help(format!("give `{bare}` a unit, as in `{bare} {}`", unit.symbol())))
            }
        }
    }

    fn number(&mut self, tree: &FormulaTree) -> Checked<(NumberTerm, OperandUnit)> {
        match self.operand(tree)? {
            Operand::Number(term, unit) => Ok((term, unit)),
            Operand::Truth | Operand::Choice(..) => {
                let message = format!("`{}` is no number", self.shown(&tree.range));
                Err(FormulaError::new(&tree.range, message))
            }
        }
    }

    fn operand(&mut self, tree: &FormulaTree) -> Checked<Operand> {
        Ok(match &tree.kind {
            TreeKind::Number(number, unit) => {
                let of = match unit {
                    Some(unit) => OperandUnit::Of(unit.si),
                    None if *number == 0.0 => OperandUnit::Any,
                    None => OperandUnit::Of(Unit::None),
                };
                let number = unit.map_or(*number, |unit| unit.to_si(*number));
                Operand::Number(NumberTerm::Constant(number), of)
            }
            TreeKind::Negative(a) => {
                let (term, unit) = self.number(a)?;
                Operand::Number(NumberTerm::Negative(Box::new(term)), unit)
            }
            TreeKind::Function(function, operands) => self.function(tree, *function, operands)?,
            TreeKind::Arithmetic(operator, a, b) => self.arithmetic(tree, *operator, a, b)?,
            TreeKind::Name | TreeKind::Applied { .. } => match resolve(self.program, self.text, tree)? {
                Named::Signal(signal, ty) => {
                    let slot = self.slot(signal);
                    match ty {
                        Type::Bool => Operand::Truth,
                        Type::Enum(of) => Operand::Choice(slot, of),
                        Type::Float(unit) => Operand::Number(NumberTerm::Signal(slot), OperandUnit::Of(unit)),
                        Type::Int { .. } | Type::Text | Type::List(_) => {
                            Operand::Number(NumberTerm::Signal(slot), OperandUnit::Of(Unit::None))
                        }
                    }
                }
                Named::Event(_) => {
                    let message = format!("`{}` is an event, and has no value", self.shown(&tree.range));
                    return Err(FormulaError::new(&tree.range, message));
                }
            },
            TreeKind::Not(_)
            | TreeKind::Junction(..)
            | TreeKind::Prefix(..)
            | TreeKind::Infix(..)
            | TreeKind::Comparison(..) => {
                let message = format!("`{}` holds or not, and is no number", self.shown(&tree.range));
                return Err(FormulaError::new(&tree.range, message));
            }
        })
    }

    fn function(
        &mut self,
        tree: &FormulaTree,
        function: TermFunction,
        operands: &[FormulaTree],
    ) -> Checked<Operand> {
        let operator = match (function, operands) {
            (TermFunction::Abs, [a]) => {
                let (term, unit) = self.number(a)?;
                return Ok(Operand::Number(NumberTerm::Absolute(Box::new(term)), unit));
            }
            (TermFunction::Abs, _) => {
                return Err(FormulaError::new(&tree.range, "`abs` has one argument"));
            }
            (TermFunction::Min, _) => NumberOperator::Min,
            (TermFunction::Max, _) => NumberOperator::Max,
        };
        let [first, others @ ..] = operands else {
            return Err(FormulaError::new(&tree.range, "it has at least one argument"));
        };
        let (mut term, mut unit) = self.number(first)?;
        for other in others {
            let (next, of) = self.number(other)?;
            unit = OperandUnit::Of(self.same_unit(tree, (first, unit), (other, of))?);
            term = NumberTerm::Binary(operator, Box::new(term), Box::new(next));
        }
        Ok(Operand::Number(term, unit))
    }

    fn arithmetic(
        &mut self,
        tree: &FormulaTree,
        operator: TermOperator,
        a: &FormulaTree,
        b: &FormulaTree,
    ) -> Checked<Operand> {
        let ((left, left_unit), (right, right_unit)) = (self.number(a)?, self.number(b)?);
        let bare = |unit| matches!(unit, OperandUnit::Any | OperandUnit::Of(Unit::None));
        let (operator, unit) = match operator {
            TermOperator::Add | TermOperator::Subtract => {
                let operator = if operator == TermOperator::Add {
                    NumberOperator::Add
                } else {
                    NumberOperator::Subtract
                };
                (operator, OperandUnit::Of(self.same_unit(tree, (a, left_unit), (b, right_unit))?))
            }
            TermOperator::Multiply if bare(left_unit) => (NumberOperator::Multiply, right_unit),
            TermOperator::Multiply if bare(right_unit) => (NumberOperator::Multiply, left_unit),
            TermOperator::Divide if bare(right_unit) => (NumberOperator::Divide, left_unit),
            TermOperator::Divide if left_unit == right_unit => {
                (NumberOperator::Divide, OperandUnit::Of(Unit::None))
            }
            TermOperator::Multiply | TermOperator::Divide => {
                let message = format!("the unit of `{}` is none that is known here", self.shown(&tree.range));
                return Err(FormulaError::new(&tree.range, message)
                    .help("declare a signal of this value in the scenario, and name it here"));
            }
        };
        Ok(Operand::Number(NumberTerm::Binary(operator, Box::new(left), Box::new(right)), unit))
    }
}

fn compared(comparator: Comparator, left: NumberTerm, right: NumberTerm) -> AtomSource {
    match comparator {
        Comparator::Less => AtomSource::Less { least: left, most: right, strict: true },
        Comparator::AtMost => AtomSource::Less { least: left, most: right, strict: false },
        Comparator::Greater => AtomSource::Less { least: right, most: left, strict: true },
        Comparator::AtLeast => AtomSource::Less { least: right, most: left, strict: false },
        Comparator::Equal => AtomSource::Equal { left, right, negated: false },
        Comparator::Unequal => AtomSource::Equal { left, right, negated: true },
    }
}

fn measured(unit: Unit) -> String {
    if unit == Unit::None { "has no unit".to_owned() } else { format!("is in {}", unit.symbol()) }
}
