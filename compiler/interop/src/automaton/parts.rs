//! What a formula is put together from before its states are known: memories of one bit, clocks, and what becomes of each part of the goal.

use hrdsl_ir::formula::{FormulaAtom, MetricFormula, PastWindow};

use super::{
    condition::{FALSE, MomentCondition, TRUE, all, any, not},
    data::{AutomatonObstacle, FormulaLetter, LetterKind},
};

/// One bit that is remembered from moment to moment.
#[derive(Clone, Debug)]
pub(super) struct MemoryBit {
    /// What a state is called after, in which it is set.
    pub name: String,
    pub initial: bool,
    pub next: MomentCondition,
    /// The clock that is read only as long as it is set.
    pub clock: Option<usize>,
    /// It says what became of a part of the goal.
    pub is_latch: bool,
}

/// A part of the goal that looks at the whole run.
#[derive(Clone, Debug)]
pub(super) struct GoalLeaf {
    /// It has failed, or come true, for good.
    pub failed: Option<usize>,
    pub met: Option<usize>,
    /// As long as one of these is set, the end would leave it open.
    pub pending: Vec<usize>,
    /// It is open as long as neither has happened.
    pub waits: bool,
    /// Once this is not set any more, nothing new is asked.
    pub only_during: Option<usize>,
}

#[derive(Clone, Debug)]
pub(super) enum GoalTree {
    And(Box<GoalTree>, Box<GoalTree>),
    Or(Box<GoalTree>, Box<GoalTree>),
    Leaf(GoalLeaf),
}

/// All of it, while it is put together.
#[derive(Debug)]
pub(super) struct AutomatonParts<'f> {
    pub atoms: &'f [FormulaAtom],
    pub letters: Vec<FormulaLetter>,
    pub bits: Vec<MemoryBit>,
    /// For each clock, when it is set to 0.
    pub resets: Vec<MomentCondition>,
    /// Operators that were met before.
    known: Vec<(MetricFormula, MomentCondition)>,
}

impl<'f> AutomatonParts<'f> {
    pub fn new(atoms: &'f [FormulaAtom]) -> Self {
        Self { atoms, letters: Vec::new(), bits: Vec::new(), resets: Vec::new(), known: Vec::new() }
    }

    pub fn text(&self, formula: &MetricFormula) -> String {
        if let Some((rising, of)) = edge(formula) {
            return format!("{}({})", if rising { "rising" } else { "falling" }, self.text(of));
        }
        formula.text(&|atom| self.atoms.get(atom).map_or_else(String::new, |a| a.text.clone()))
    }

    pub fn letter(&mut self, text: String, what: LetterKind) -> MomentCondition {
        let known = self.letters.iter().position(|letter| letter.what == what);
        MomentCondition::letter(known.unwrap_or_else(|| {
            self.letters.push(FormulaLetter { text, what });
            self.letters.len() - 1
        }))
    }

    pub fn atom(&mut self, atom: usize) -> MomentCondition {
        let text = self.text(&MetricFormula::Atom(atom));
        self.letter(text, LetterKind::Atom(atom))
    }

    /// The letter of an edge of what is made of atoms alone, and that itself.
    pub fn edge(&mut self, formula: &MetricFormula) -> Option<(bool, MomentCondition, MomentCondition)> {
        let (rising, of) = edge(formula)?;
        let of_letter = self.boolean(of)?;
        let text = self.text(formula);
        let of = of.clone();
        let what = if rising { LetterKind::Rising(of) } else { LetterKind::Falling(of) };
        Some((rising, self.letter(text, what), of_letter))
    }

    /// What is made of atoms alone.
    pub fn boolean(&mut self, formula: &MetricFormula) -> Option<MomentCondition> {
        Some(match formula {
            MetricFormula::Constant(truth) => MomentCondition::Constant(*truth),
            MetricFormula::Atom(atom) => self.atom(*atom),
            MetricFormula::Not(a) => not(self.boolean(a)?),
            MetricFormula::And(a, b) => all([self.boolean(a)?, self.boolean(b)?]),
            MetricFormula::Or(a, b) => any([self.boolean(a)?, self.boolean(b)?]),
            MetricFormula::Implies(a, b) => any([not(self.boolean(a)?), self.boolean(b)?]),
            MetricFormula::Once(..)
            | MetricFormula::Historically(..)
            | MetricFormula::Since(..)
            | MetricFormula::Eventually(..)
            | MetricFormula::Always(..)
            | MetricFormula::Until(..) => return None,
        })
    }

    pub fn bit(&mut self, name: String, initial: bool) -> usize {
        self.bits.push(MemoryBit { name, initial, next: FALSE, clock: None, is_latch: false });
        self.bits.len() - 1
    }

    /// A bit with a clock of its own.
    pub fn timed_bit(&mut self, name: String) -> (usize, usize) {
        let bit = self.bit(name, false);
        self.resets.push(FALSE);
        let clock = self.resets.len() - 1;
        if let Some(of) = self.bits.get_mut(bit) {
            of.clock = Some(clock);
        }
        (bit, clock)
    }

    pub fn becomes(&mut self, bit: usize, next: MomentCondition) {
        if let Some(of) = self.bits.get_mut(bit) {
            of.next = next;
        }
    }

    pub fn resets(&mut self, clock: usize, when: MomentCondition) {
        if let Some(of) = self.resets.get_mut(clock) {
            *of = when;
        }
    }

    /// Whether a formula holds now that does not look ahead.
    pub fn now(&mut self, formula: &MetricFormula) -> Result<MomentCondition, AutomatonObstacle> {
        if let Some((_, letter, _)) = self.edge(formula) {
            return Ok(letter);
        }
        match formula {
            MetricFormula::Constant(truth) => Ok(MomentCondition::Constant(*truth)),
            MetricFormula::Atom(atom) => Ok(self.atom(*atom)),
            MetricFormula::Not(a) => Ok(not(self.now(a)?)),
            MetricFormula::And(a, b) => Ok(all([self.now(a)?, self.now(b)?])),
            MetricFormula::Or(a, b) => Ok(any([self.now(a)?, self.now(b)?])),
            MetricFormula::Implies(a, b) => Ok(any([not(self.now(a)?), self.now(b)?])),
            MetricFormula::Once(..) | MetricFormula::Historically(..) | MetricFormula::Since(..) => {
                self.remembered(formula)
            }
            MetricFormula::Eventually(..) | MetricFormula::Always(..) | MetricFormula::Until(..) => Err(
                format!("`{}` looks ahead, and is asked by what looks back or waits.", self.text(formula)),
            ),
        }
    }

    fn remembered(&mut self, formula: &MetricFormula) -> Result<MomentCondition, AutomatonObstacle> {
        if let Some((_, known)) = self.known.iter().find(|(of, _)| of == formula) {
            return Ok(known.clone());
        }
        let text = self.text(formula);
        let condition = match formula {
            MetricFormula::Once(window, a) => {
                let (name, of) = (format!("after {}", self.text(a)), self.now(a)?);
                self.since(*window, None, of, (name, &text))?
            }
            MetricFormula::Historically(window, a) => {
                let (name, of) = (format!("after not {}", self.text(a)), not(self.now(a)?));
                not(self.since(*window, None, of, (name, &text))?)
            }
            MetricFormula::Since(window, a, b) => {
                let name = format!("{} since {}", self.text(a), self.text(b));
                let (holding, of) = (self.now(a)?, self.now(b)?);
                self.since(*window, Some(holding), of, (name, &text))?
            }
            MetricFormula::Constant(_)
            | MetricFormula::Atom(_)
            | MetricFormula::Not(_)
            | MetricFormula::And(..)
            | MetricFormula::Or(..)
            | MetricFormula::Implies(..)
            | MetricFormula::Eventually(..)
            | MetricFormula::Always(..)
            | MetricFormula::Until(..) => self.now(formula)?,
        };
        self.known.push((formula.clone(), condition.clone()));
        Ok(condition)
    }

    /// `of` was so long ago, and `holding` has held since; nothing has to hold for `once`.
    fn since(
        &mut self,
        window: PastWindow,
        holding: Option<MomentCondition>,
        of: MomentCondition,
        (name, text): (String, &str),
    ) -> Result<MomentCondition, AutomatonObstacle> {
        let holding = holding.unwrap_or(TRUE);
        match window.bounds() {
            (0, Some(0)) => Ok(of),
            (0, None) => {
                let bit = self.bit(name, false);
                let now = any([of, all([MomentCondition::Memory(bit), holding])]);
                self.becomes(bit, now.clone());
                Ok(now)
            }
            // The latest is the one that is in the window for longest.
            (0, Some(to)) => {
                let (bit, clock) = self.timed_bit(name);
                let still = [MomentCondition::Memory(bit), holding, MomentCondition::at_most(clock, to)];
                let now = any([of.clone(), all(still)]);
                self.becomes(bit, now.clone());
                self.resets(clock, of);
                Ok(now)
            }
            // The earliest is the one that is far enough away first.
            (from, None) => {
                let (bit, clock) = self.timed_bit(name);
                let goes_on = all([MomentCondition::Memory(bit), holding]);
                self.becomes(bit, any([goes_on.clone(), of.clone()]));
                self.resets(clock, all([of, not(goes_on.clone())]));
                Ok(all([goes_on, MomentCondition::at_least(clock, from)]))
            }
            (_, Some(_)) => Err(format!(
                "`{text}` looks at a window that has ended before now: each change in it and since would want a clock of its own."
            )),
        }
    }
}

/// Whether a formula is `rising(P)` or `falling(P)`, and the P.
fn edge(formula: &MetricFormula) -> Option<(bool, &MetricFormula)> {
    let MetricFormula::And(now, before) = formula else { return None };
    let MetricFormula::Once(PastWindow { from: 1, to: Some(1) }, before) = before.as_ref() else {
        return None;
    };
    match (now.as_ref(), before.as_ref()) {
        (now, MetricFormula::Not(opposite)) if opposite.as_ref() == now => Some((true, now)),
        (MetricFormula::Not(opposite), before) if opposite.as_ref() == before => Some((false, before)),
        _ => None,
    }
}
