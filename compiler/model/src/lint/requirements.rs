//! HR0603: two requirements that no run can meet both.

use hrdsl_source::{Diagnostic, DiagnosticCode};
use hrdsl_syntax::RequirementPattern;

use super::{
    facts::{ScenarioFacts, WantedFact},
    plan_terms::same,
};
use crate::{
    ArgPattern, BinaryOp, Scenario, TypedExpr, TypedExprKind, TypedOccurrence, TypedPattern, UnaryOp,
    expr::ComparisonOp,
};

/// Beyond so many pairs nothing is said.
const PAIRS: usize = 1 << 16;

pub(crate) fn contradicting<'a>(
    scenario: &'a Scenario,
    facts: &'a ScenarioFacts<'a>,
    issues: &mut Vec<Diagnostic>,
) {
    let all = &scenario.requirements;
    if all.len().saturating_mul(all.len()) > PAIRS {
        return;
    }
    for (i, later) in all.iter().enumerate() {
        // What nothing triggers is said already.
        let vain = |i: usize| facts.untested(i).is_some();
        let clash = all[..i].iter().enumerate().find_map(|(j, earlier)| {
            let clash = clash(facts, &earlier.pattern, &later.pattern)?;
            (!vain(i) && !vain(j)).then_some((earlier, clash))
        });
        let Some((earlier, clash)) = clash else { continue };
        let message =
            format!("the requirements `{}` and `{}` contradict each other", earlier.name, later.name);
        let issue = Diagnostic::warning(DiagnosticCode::CONTRADICTING_REQUIREMENTS, later.text, message);
        let (here, there) = clash.told();
        issues.push(
            issue.here(here).label(earlier.text, there).help("change one of them: no run can meet both"),
        );
    }
}

/// How two requirements contradict each other.
#[derive(Clone, Copy)]
enum RequirementClash {
    /// The first wants what the second forbids.
    WantedFirst,
    ForbiddenFirst,
    Conditions,
    /// The answers of one come too early for the other.
    Times,
}

impl RequirementClash {
    /// What is said at the second, and at the first.
    fn told(self) -> (&'static str, &'static str) {
        let (wants, forbids) = ("this wants an event", "this forbids it");
        match self {
            RequirementClash::WantedFirst => (forbids, wants),
            RequirementClash::ForbiddenFirst => (wants, forbids),
            RequirementClash::Times => ("no answer has the time of both", "this answer"),
            RequirementClash::Conditions => ("never true together with the other", "this condition"),
        }
    }
}

fn clash(facts: &ScenarioFacts<'_>, first: &TypedPattern, second: &TypedPattern) -> Option<RequirementClash> {
    let (once, twice) = (first.sometime(), second.sometime());
    let pairs = [(first.always(), second.always()), (first.always(), twice), (once, second.always())];
    if pairs.iter().any(|(a, b)| a.zip(*b).is_some_and(|(a, b)| exclude(a, b))) {
        return Some(RequirementClash::Conditions);
    }
    if too_early(first, second) || too_early(second, first) {
        return Some(RequirementClash::Times);
    }
    if too_often(first, second) || forbids(facts, first, second) {
        return Some(RequirementClash::WantedFirst);
    }
    let forbidden_first = too_often(second, first) || forbids(facts, second, first);
    forbidden_first.then_some(RequirementClash::ForbiddenFirst)
}

/// Whether what the second says of its scope is said of that of the first, too.
fn says_of_the_same(wants: &TypedPattern, bans: &TypedPattern) -> bool {
    bans.scope.is_whole() || (bans.scope == wants.scope && wants.scope.condition().is_none())
}

/// Whether `wants` has events happen more often than `caps` lets them, in whatever run there is the scope of the first.
fn too_often(wants: &TypedPattern, caps: &TypedPattern) -> bool {
    let (Some(least), Some(most)) = (wants.at_least(), caps.at_most()) else { return false };
    says_of_the_same(wants, caps)
        && covers(most.events, least.events)
        && least.count.map_or(1, |n| *n) > most.count.map_or(0, |n| *n)
}

/// Whether each answer that `late` has time for is too early for `early`, after the first trigger of both.
fn too_early(early: &TypedPattern, late: &TypedPattern) -> bool {
    let (
        RequirementPattern::Causes { trigger, response, not_before: Some(not_before), .. },
        RequirementPattern::Causes { trigger: other, response: answer, within: Some(within), .. },
    ) = (&early.pattern, &late.pattern)
    else {
        return false;
    };
    let whole = early.scope.is_whole() && late.scope.is_whole();
    whole && within < not_before && trigger == other && covers(response, answer)
}

/// Whether every answer that `wants` asks for is forbidden by `ban` from its trigger on, in whatever run triggers both.
fn forbids(facts: &ScenarioFacts<'_>, wants: &TypedPattern, ban: &TypedPattern) -> bool {
    let (Some(wanted), Some(banned)) = (wants.demands(), ban.bans()) else { return false };
    // Whatever lifts the ban may come before the answer, unless nobody makes it or it is forbidden itself: of `precedes` it is allowed even then.
    let lifts = |p: &&TypedOccurrence| {
        let in_vain = p.as_event().is_some_and(|p| facts.in_vain(&[WantedFact::of(p)]));
        !in_vain && (banned.from.is_none() || !covers(banned.events, std::slice::from_ref(p)))
    };
    let lifted = banned.until.iter().any(|p| lifts(&p));
    let both_begin =
        banned.from.is_none_or(|from| covers(from, wanted.trigger) || covers(wanted.trigger, from));
    says_of_the_same(wants, ban) && !lifted && covers(banned.events, wanted.response) && both_begin
}

/// Whether each event that fits one of `some` fits one of `all`.
pub(super) fn covers(all: &[TypedOccurrence], some: &[TypedOccurrence]) -> bool {
    let within = |p: &TypedOccurrence, q: &TypedOccurrence| match (p, q) {
        (TypedOccurrence::Event(p), TypedOccurrence::Event(q)) => {
            p.event == q.event && p.args.iter().zip(&q.args).all(|(p, q)| *p == ArgPattern::Any || p == q)
        }
        (
            TypedOccurrence::Edge { rising, condition },
            TypedOccurrence::Edge { rising: other, condition: of },
        ) => rising == other && same(condition, of),
        (TypedOccurrence::Event(_) | TypedOccurrence::Edge { .. }, _) => false,
    };
    some.iter().all(|q| all.iter().any(|p| within(p, q)))
}

// ── conditions ──

/// Whether two conditions that must hold always are never true together.
fn exclude(a: &TypedExpr, b: &TypedExpr) -> bool {
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    conjuncts(a, &mut ours);
    conjuncts(b, &mut theirs);
    ours.iter().any(|a| theirs.iter().any(|b| opposite(a, b) || opposite(b, a) || apart(a, b)))
}

fn conjuncts<'a>(e: &'a TypedExpr, all: &mut Vec<&'a TypedExpr>) {
    if let TypedExprKind::Binary(BinaryOp::And, a, b) = &e.kind {
        conjuncts(a, all);
        conjuncts(b, all);
    } else {
        all.push(e);
    }
}

/// `not a` and `a`.
fn opposite(a: &TypedExpr, b: &TypedExpr) -> bool {
    matches!(&a.kind, TypedExprKind::Unary(UnaryOp::Not, inner) if same(inner, b))
}

/// Whether two comparisons of the same value with constants leave it no number.
fn apart(a: &TypedExpr, b: &TypedExpr) -> bool {
    let (Some((x, ours)), Some((y, theirs))) = (bounds(a), bounds(b)) else { return false };
    same(x, y) && (ours.is_below(&theirs) || theirs.is_below(&ours))
}

/// Numbers between two, each with whether it is left out.
struct TimeBounds {
    lo: (f64, bool),
    hi: (f64, bool),
}

impl TimeBounds {
    fn is_below(&self, other: &TimeBounds) -> bool {
        let ((hi, open), (lo, other_open)) = (self.hi, other.lo);
        hi < lo || (hi == lo && (open || other_open))
    }
}

/// `x < 5` as x and its bounds.
fn bounds(e: &TypedExpr) -> Option<(&TypedExpr, TimeBounds)> {
    let TypedExprKind::Binary(op, a, b) = &e.kind else { return None };
    let number = |e: &TypedExpr| e.constant().and_then(|v| v.as_f64());
    let (x, limit, turned) = match (number(a), number(b)) {
        (None, Some(limit)) => (a, limit, false),
        (Some(limit), None) => (b, limit, true),
        (None, None) | (Some(_), Some(_)) => return None,
    };
    let none = f64::INFINITY;
    let op = ComparisonOp::of(*op)?;
    let bounds = match if turned { op.mirrored() } else { op } {
        ComparisonOp::Lt => TimeBounds { lo: (-none, false), hi: (limit, true) },
        ComparisonOp::Le => TimeBounds { lo: (-none, false), hi: (limit, false) },
        ComparisonOp::Gt => TimeBounds { lo: (limit, true), hi: (none, false) },
        ComparisonOp::Ge => TimeBounds { lo: (limit, false), hi: (none, false) },
        ComparisonOp::Eq => TimeBounds { lo: (limit, false), hi: (limit, false) },
        ComparisonOp::Ne => return None,
    };
    Some((x, bounds))
}
