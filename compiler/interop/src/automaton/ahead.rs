//! What is asked of every moment as clauses, each of what is known at the moment and of at most one window that begins at it.

use hrdsl_ir::{
    Nanos,
    formula::{FutureWindow, MetricFormula},
};

use super::{
    condition::{MomentCondition, TRUE, all, any, not},
    data::AutomatonObstacle,
    parts::AutomatonParts,
};

/// One of these has to hold at the moment.
#[derive(Clone, Debug)]
pub(super) struct MomentClause<'f> {
    /// Each, or, if it is not wanted, its opposite.
    present: Vec<(&'f MetricFormula, bool)>,
    ahead: Vec<(&'f MetricFormula, bool)>,
}

/// So many clauses of one formula are looked at.
const MOST_CLAUSES: usize = 64;

/// The clauses that hold together where the formula holds, or, if it is not `wanted`, where it does not.
pub(super) fn clauses(
    formula: &MetricFormula,
    wanted: bool,
) -> Result<Vec<MomentClause<'_>>, AutomatonObstacle> {
    if !looks_ahead(formula) {
        return Ok(vec![MomentClause { present: vec![(formula, wanted)], ahead: Vec::new() }]);
    }
    let (a, b, together) = match formula {
        MetricFormula::Not(a) => return clauses(a, !wanted),
        MetricFormula::And(a, b) => ((a, wanted), b, wanted),
        MetricFormula::Or(a, b) => ((a, wanted), b, !wanted),
        MetricFormula::Implies(a, b) => ((a, !wanted), b, !wanted),
        MetricFormula::Constant(_)
        | MetricFormula::Atom(_)
        | MetricFormula::Once(..)
        | MetricFormula::Historically(..)
        | MetricFormula::Since(..)
        | MetricFormula::Eventually(..)
        | MetricFormula::Always(..)
        | MetricFormula::Until(..) => {
            return Ok(vec![MomentClause { present: Vec::new(), ahead: vec![(formula, wanted)] }]);
        }
    };
    let (mut left, right) = (clauses(a.0, a.1)?, clauses(b, wanted)?);
    if together {
        left.extend(right);
        return Ok(left);
    }
    if left.len() * right.len() > MOST_CLAUSES {
        return Err(format!("It is more than {MOST_CLAUSES} conditions that have to hold together."));
    }
    Ok(left.iter().flat_map(|a| right.iter().map(|b| a.or(b))).collect())
}

pub(super) fn looks_ahead(formula: &MetricFormula) -> bool {
    match formula {
        MetricFormula::Eventually(..) | MetricFormula::Always(..) | MetricFormula::Until(..) => true,
        MetricFormula::Constant(_)
        | MetricFormula::Atom(_)
        | MetricFormula::Not(_)
        | MetricFormula::And(..)
        | MetricFormula::Or(..)
        | MetricFormula::Implies(..)
        | MetricFormula::Once(..)
        | MetricFormula::Historically(..)
        | MetricFormula::Since(..) => formula.operands().into_iter().any(looks_ahead),
    }
}

impl<'f> MomentClause<'f> {
    fn or(&self, other: &Self) -> Self {
        let joined = |a: &[(&'f MetricFormula, bool)], b: &[(&'f MetricFormula, bool)]| [a, b].concat();
        Self { present: joined(&self.present, &other.present), ahead: joined(&self.ahead, &other.ahead) }
    }

    /// When it fails, if it is asked of the moments at which `asked` holds; and the bit that is set as long as a window is open.
    pub fn fails(
        &self,
        asked: MomentCondition,
        parts: &mut AutomatonParts<'_>,
    ) -> Result<(MomentCondition, Option<usize>), AutomatonObstacle> {
        let mut trigger = vec![asked];
        for (formula, wanted) in &self.present {
            let now = parts.now(formula)?;
            trigger.push(if *wanted { not(now) } else { now });
        }
        let trigger = all(trigger);
        match self.ahead.as_slice() {
            [] => Ok((trigger, None)),
            [(formula, wanted)] => open_window(formula, *wanted, trigger, parts),
            [(first, _), (second, _), ..] => Err(format!(
                "Of one moment either `{}` or `{}` is asked: both windows would have to be remembered for each such moment.",
                parts.text(first),
                parts.text(second)
            )),
        }
    }
}

/// A window from each moment at which `trigger` holds, as that something comes in it, or that it does not.
fn open_window(
    formula: &MetricFormula,
    wanted: bool,
    trigger: MomentCondition,
    parts: &mut AutomatonParts<'_>,
) -> Result<(MomentCondition, Option<usize>), AutomatonObstacle> {
    let text = parts.text(formula);
    let (window, of) = nested(formula);
    let (holding, target, comes) = match of {
        MetricFormula::Eventually(_, of) => (TRUE, (of.as_ref(), true), wanted),
        // `always` is that the opposite does not come.
        MetricFormula::Always(_, of) => (TRUE, (of.as_ref(), false), !wanted),
        MetricFormula::Until(_, holding, of) => {
            let holding = parts.boolean(holding).ok_or_else(|| {
                format!("`{text}` asks of moments to come what is no condition of such a moment alone.")
            })?;
            (holding, (of.as_ref(), true), wanted)
        }
        MetricFormula::Constant(_)
        | MetricFormula::Atom(_)
        | MetricFormula::Not(_)
        | MetricFormula::And(..)
        | MetricFormula::Or(..)
        | MetricFormula::Implies(..)
        | MetricFormula::Once(..)
        | MetricFormula::Historically(..)
        | MetricFormula::Since(..) => return Err(format!("`{text}` looks ahead inside what looks back.")),
    };
    if window.from > 0 {
        return Err(format!(
            "The window of `{text}` begins later than the moment that asks: each such moment would want a clock of its own."
        ));
    }
    let is_denied = !target.1;
    let (target, possible) = target_of(target.0, target.1, parts, &text)?;
    let name = parts.text(match of {
        MetricFormula::Eventually(_, of) | MetricFormula::Always(_, of) | MetricFormula::Until(_, _, of) => {
            of
        }
        other => other,
    });
    let (bit, clock) = parts.timed_bit(match (comes, is_denied) {
        (true, false) => format!("waiting for {name}"),
        (true, true) => format!("waiting for the end of {name}"),
        (false, false) => format!("no {name}"),
        (false, true) => format!("bound to {name}"),
    });
    let window = OpenWindow { to: window.to, bit, clock, trigger, holding, target, possible };
    Ok((if comes { window.reaching(parts) } else { window.avoiding(parts) }, Some(bit)))
}

/// One that looks into a window of its own kind looks as far as both.
fn nested(formula: &MetricFormula) -> (FutureWindow, &MetricFormula) {
    let further = |window: &FutureWindow, (inner, of)| {
        let FutureWindow { from, to } = inner;
        let (from, to) = (window.from.saturating_add(from), window.to.saturating_add(to));
        (FutureWindow { from, to }, of)
    };
    match formula {
        MetricFormula::Eventually(window, of) => match of.as_ref() {
            inner @ MetricFormula::Eventually(..) => further(window, nested(inner)),
            _ => (*window, formula),
        },
        MetricFormula::Always(window, of) => match of.as_ref() {
            inner @ MetricFormula::Always(..) => further(window, nested(inner)),
            _ => (*window, formula),
        },
        MetricFormula::Until(window, ..) => (*window, formula),
        _ => (FutureWindow { from: 0, to: 0 }, formula),
    }
}

/// What a window waits for, or for the opposite of, and whether it can hold at the moment after this one, whatever is true then.
fn target_of(
    formula: &MetricFormula,
    wanted: bool,
    parts: &mut AutomatonParts<'_>,
    text: &str,
) -> Result<(MomentCondition, MomentCondition), AutomatonObstacle> {
    if let Some((rising, letter, of)) = parts.edge(formula) {
        // What does not change now can change then.
        let possible = if rising { not(of) } else { of };
        return if wanted {
            Ok((letter, possible))
        } else {
            Err(format!("`{text}` asks of each moment to come that something changes at it."))
        };
    }
    let mut both = |a: &MetricFormula, b: &MetricFormula, a_wanted: bool, together: bool| {
        let ((a, possible), (b, other)) =
            (target_of(a, a_wanted, parts, text)?, target_of(b, wanted, parts, text)?);
        let joined = |a, b| if together { all([a, b]) } else { any([a, b]) };
        Ok((joined(a, b), joined(possible, other)))
    };
    match formula {
        MetricFormula::Constant(truth) => {
            let constant = MomentCondition::Constant(*truth == wanted);
            Ok((constant.clone(), constant))
        }
        MetricFormula::Atom(atom) => {
            let atom = parts.atom(*atom);
            Ok((if wanted { atom } else { not(atom) }, TRUE))
        }
        MetricFormula::Not(a) => target_of(a, !wanted, parts, text),
        MetricFormula::And(a, b) => both(a, b, wanted, wanted),
        MetricFormula::Or(a, b) => both(a, b, wanted, !wanted),
        MetricFormula::Implies(a, b) => both(a, b, !wanted, !wanted),
        MetricFormula::Once(..)
        | MetricFormula::Historically(..)
        | MetricFormula::Since(..)
        | MetricFormula::Eventually(..)
        | MetricFormula::Always(..)
        | MetricFormula::Until(..) => {
            Err(format!("`{text}` asks of moments to come what is no condition of such a moment alone."))
        }
    }
}

/// A window that begins now, and again with each moment that asks. Its bit is set as long as it is open.
struct OpenWindow {
    to: Nanos,
    bit: usize,
    clock: usize,
    trigger: MomentCondition,
    holding: MomentCondition,
    target: MomentCondition,
    possible: MomentCondition,
}

impl OpenWindow {
    /// No target can come any more in what is left of a window that began at the moment at which the clock was set to 0, or, if `anew`, begins now.
    fn is_over(&self, anew: bool) -> MomentCondition {
        let reads = |bound: Nanos| {
            if anew {
                MomentCondition::Constant(bound <= 0)
            } else {
                MomentCondition::at_least(self.clock, bound)
            }
        };
        // With one moment left, what can only change then must be ready to.
        let too_late = all([not(self.possible.clone()), reads(self.to.saturating_sub(1))]);
        any([reads(self.to), too_late])
    }

    /// The target comes in time, and up to then `holding` does hold: the first moment that asks is the one to serve.
    fn reaching(self, parts: &mut AutomatonParts<'_>) -> MomentCondition {
        let before = MomentCondition::Memory(self.bit);
        let open = all([any([before.clone(), self.trigger.clone()]), not(self.target.clone())]);
        let over =
            any([all([before.clone(), self.is_over(false)]), all([not(before.clone()), self.is_over(true)])]);
        let lost = any([not(self.holding.clone()), over]);
        parts.becomes(self.bit, all([open.clone(), not(lost.clone())]));
        parts.resets(self.clock, all([not(before), self.trigger]));
        all([open, lost])
    }

    /// The target does not come in time as long as `holding` does hold: the last moment that asks is bound for longest.
    fn avoiding(self, parts: &mut AutomatonParts<'_>) -> MomentCondition {
        let bound = any([MomentCondition::Memory(self.bit), self.trigger.clone()]);
        let again = all([self.trigger.clone(), self.is_over(true)]);
        let over = any([again, all([not(self.trigger.clone()), self.is_over(false)])]);
        let goes_on = all([bound.clone(), not(self.target.clone()), self.holding.clone(), not(over)]);
        parts.becomes(self.bit, goes_on);
        parts.resets(self.clock, self.trigger);
        all([bound, self.target])
    }
}
