//! The tree with the names, types and units of a scenario.

use hrdsl_ir::{
    Nanos, Program, Unit,
    formula::{FutureWindow, MetricFormula, MetricGoal, PastWindow},
};

use super::{
    checked::CheckedFormula,
    error::FormulaError,
    terms::{Checked, FormulaChecker},
    tree::{FormulaTree, InfixWord, JunctionWord, PrefixWord, TreeKind, WindowTree},
};

/// The reach of a whole formula, some thirty years: what is longer is a slip, and times stay far from their end.
const FARTHEST: Nanos = 1_000_000_000_000_000_000;

pub(crate) fn check(
    program: &Program,
    text: &str,
    tree: &FormulaTree,
) -> Result<CheckedFormula, FormulaError> {
    let mut checker = FormulaChecker {
        program,
        text,
        signals: Vec::new(),
        atoms: Vec::new(),
        texts: Vec::new(),
        units: Vec::new(),
    };
    let goal = checker.goal(tree)?;
    checker.units.dedup();
    let unit = match checker.units.as_slice() {
        [unit] => Some(*unit),
        _ => None,
    };
    Ok(CheckedFormula { goal, atoms: checker.atoms, texts: checker.texts, signals: checker.signals, unit })
}

/// Whether an operator without a window that looks into the future is in it.
fn looks_to_the_end(tree: &FormulaTree) -> bool {
    match &tree.kind {
        TreeKind::Prefix(PrefixWord::Eventually | PrefixWord::Always, None, _)
        | TreeKind::Infix(InfixWord::Until, None, ..) => true,
        TreeKind::Not(a) | TreeKind::Prefix(_, _, a) => looks_to_the_end(a),
        TreeKind::Junction(_, a, b) | TreeKind::Infix(_, _, a, b) => {
            looks_to_the_end(a) || looks_to_the_end(b)
        }
        TreeKind::Number(..)
        | TreeKind::Name
        | TreeKind::Applied { .. }
        | TreeKind::Function(..)
        | TreeKind::Negative(_)
        | TreeKind::Arithmetic(..)
        | TreeKind::Comparison(..) => false,
    }
}

impl FormulaChecker<'_> {
    fn goal(&mut self, tree: &FormulaTree) -> Checked<MetricGoal> {
        if !looks_to_the_end(tree) {
            return Ok(MetricGoal::Now(self.formula(tree)?));
        }
        let two = |a, b| (Box::new(a), Box::new(b));
        match &tree.kind {
            TreeKind::Not(a) => Ok(self.goal(a)?.negated()),
            TreeKind::Junction(word, a, b) => {
                let (a, b) = (self.goal(a)?, self.goal(b)?);
                Ok(match word {
                    JunctionWord::And => {
                        let (a, b) = two(a, b);
                        MetricGoal::And(a, b)
                    }
                    JunctionWord::Or => {
                        let (a, b) = two(a, b);
                        MetricGoal::Or(a, b)
                    }
                    JunctionWord::Implies => {
                        let (a, b) = two(a.negated(), b);
                        MetricGoal::Or(a, b)
                    }
                })
            }
            TreeKind::Prefix(PrefixWord::Always, None, a) => Ok(MetricGoal::Always(self.formula(a)?)),
            TreeKind::Prefix(PrefixWord::Eventually, None, a) => Ok(MetricGoal::Eventually(self.formula(a)?)),
            TreeKind::Infix(InfixWord::Until, None, a, b) => {
                Ok(MetricGoal::Until(self.formula(a)?, self.formula(b)?))
            }
            TreeKind::Prefix(..)
            | TreeKind::Infix(..)
            | TreeKind::Number(..)
            | TreeKind::Name
            | TreeKind::Applied { .. }
            | TreeKind::Function(..)
            | TreeKind::Negative(_)
            | TreeKind::Arithmetic(..)
            | TreeKind::Comparison(..) => Ok(MetricGoal::Now(self.formula(tree)?)),
        }
    }

    fn formula(&mut self, tree: &FormulaTree) -> Checked<MetricFormula> {
        match &tree.kind {
            TreeKind::Not(a) => Ok(MetricFormula::Not(Box::new(self.formula(a)?))),
            TreeKind::Junction(word, a, b) => {
                let (a, b) = (Box::new(self.formula(a)?), Box::new(self.formula(b)?));
                Ok(match word {
                    JunctionWord::And => MetricFormula::And(a, b),
                    JunctionWord::Or => MetricFormula::Or(a, b),
                    JunctionWord::Implies => MetricFormula::Implies(a, b),
                })
            }
            TreeKind::Prefix(word, window, a) => self.prefix(tree, *word, window.as_ref(), a),
            TreeKind::Infix(InfixWord::Until, window, a, b) => {
                let window = self.future(tree, "until", window.as_ref())?;
                let (a, b) = (Box::new(self.formula(a)?), Box::new(self.formula(b)?));
                self.bounded(tree, MetricFormula::Until(window, a, b))
            }
            TreeKind::Infix(InfixWord::Since, window, a, b) => {
                let window = self.past(window.as_ref())?;
                Ok(MetricFormula::Since(window, Box::new(self.formula(a)?), Box::new(self.formula(b)?)))
            }
            TreeKind::Comparison(comparator, a, b) => self.comparison(tree, *comparator, a, b),
            TreeKind::Name | TreeKind::Applied { .. } => self.named(tree),
            TreeKind::Number(..)
            | TreeKind::Function(..)
            | TreeKind::Negative(_)
            | TreeKind::Arithmetic(..) => {
                let message =
                    format!("`{}` is a number, and neither true nor false", self.shown(&tree.range));
                Err(FormulaError::new(&tree.range, message).help("compare it, as in `x < 3`"))
            }
        }
    }

    fn prefix(
        &mut self,
        tree: &FormulaTree,
        word: PrefixWord,
        window: Option<&WindowTree>,
        of: &FormulaTree,
    ) -> Checked<MetricFormula> {
        Ok(match word {
            PrefixWord::Once => MetricFormula::Once(self.past(window)?, Box::new(self.formula(of)?)),
            PrefixWord::Historically => {
                MetricFormula::Historically(self.past(window)?, Box::new(self.formula(of)?))
            }
            PrefixWord::Eventually => {
                let window = self.future(tree, "eventually", window)?;
                let formula = MetricFormula::Eventually(window, Box::new(self.formula(of)?));
                return self.bounded(tree, formula);
            }
            PrefixWord::Always => {
                let window = self.future(tree, "always", window)?;
                let formula = MetricFormula::Always(window, Box::new(self.formula(of)?));
                return self.bounded(tree, formula);
            }
        })
    }

    fn bounded(&self, tree: &FormulaTree, formula: MetricFormula) -> Checked<MetricFormula> {
        if formula.horizon() > FARTHEST {
            return Err(FormulaError::new(&tree.range, "its windows look more than thirty years ahead"));
        }
        Ok(formula)
    }

    fn past(&self, window: Option<&WindowTree>) -> Checked<PastWindow> {
        let Some(window) = window else { return Ok(PastWindow::SINCE_START) };
        let (from, to) = self.bounds(window)?;
        PastWindow::new(from, Some(to)).ok_or_else(|| self.backwards(window))
    }

    fn future(&self, tree: &FormulaTree, word: &str, window: Option<&WindowTree>) -> Checked<FutureWindow> {
        let Some(window) = window else {
            return Err(FormulaError::new(
                &tree.range,
                format!(
                    "`{word}` without a window can stand outermost only, and this is asked of every moment"
                ),
            )
            .help(format!("say how far it looks, as in `{word}[0 s, 10 s]`")));
        };
        let (from, to) = self.bounds(window)?;
        FutureWindow::new(from, to).ok_or_else(|| self.backwards(window))
    }

    fn backwards(&self, window: &WindowTree) -> FormulaError {
        let shown = self.shown(&window.range);
        FormulaError::new(&window.range, format!("the window {shown} ends before it begins"))
            .help("write the nearer bound first")
    }

    fn bounds(&self, window: &WindowTree) -> Checked<(Nanos, Nanos)> {
        Ok((self.time(&window.from)?, self.time(&window.to)?))
    }

    fn time(&self, tree: &FormulaTree) -> Checked<Nanos> {
        let shown = self.shown(&tree.range);
        let wrong = |why: &str| {
            FormulaError::new(&tree.range, format!("`{shown}` is no bound of a window: {why}"))
                .help("bounds are times with units, as in `[0 s, 500 ms]`")
        };
        let TreeKind::Number(number, unit) = &tree.kind else { return Err(wrong("it is no number")) };
        match unit {
            Some(unit) if unit.si == Unit::Second => {
                let time = unit.to_si(*number) * 1e9;
                if time.round() > FARTHEST as f64 {
                    return Err(wrong("it is more than thirty years"));
                }
                if time > 0.0 && time.round() == 0.0 {
                    return Err(wrong("it is less than a nanosecond"));
                }
                Ok(time.round() as Nanos)
            }
            Some(_) => Err(wrong("it is no time")),
            None => Err(wrong("it has no unit")),
        }
    }
}
