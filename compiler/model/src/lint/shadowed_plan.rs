//! HR0407: whenever a plan could be selected, an earlier one is.

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::{
    agent_facts::{agents, literals},
    dead_plan::never_runs,
    facts::ScenarioFacts,
    plan_terms::{
        PlanTerm, TermImage, VarRenaming, alternatives, bound_before, is_total, more_general, of_args,
        same_expr,
    },
};
use crate::{Scenario, TypedContext, TypedPlan, TypedTerm, Value, VariableRef};

/// So many plans for the same goal or event are compared with each that follows.
const COMPARED: usize = 100;

pub(crate) fn check<'a>(scenario: &'a Scenario, all: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario, all) {
        for later in &facts.agent.plans {
            if never_runs(&facts, later) {
                continue;
            }
            let earlier = facts
                .plans(later.trigger.on)
                .take(COMPARED)
                .take_while(|earlier| !std::ptr::eq(*earlier, later));
            let mut looked_at =
                earlier.take_while(|earlier| facts.work(1 + literals(&earlier.context).len()));
            let earlier = looked_at.find(|earlier| shadows(earlier, later));
            issues.extend(earlier.map(|earlier| shadowed(earlier, later)));
        }
    }
}

fn shadowed(earlier: &TypedPlan, later: &TypedPlan) -> Diagnostic {
    let alike = shadows(later, earlier);
    let help = if alike {
        "give one of them a context that tells them apart, or remove one"
    } else {
        "put this plan before the other: of the plans that fit, the first in the text is taken"
    };
    Diagnostic::warning(
        DiagnosticCode::SHADOWED_PLAN,
        later.trigger.origin,
        "this plan never runs: an earlier one is always taken",
    )
    .label(earlier.trigger.origin, "this plan fits whenever that one does")
    .help(help)
}

/// Whether the earlier plan is applicable whenever the later one is.
pub(crate) fn shadows(earlier: &TypedPlan, later: &TypedPlan) -> bool {
    if earlier.trigger.on != later.trigger.on || !earlier.trigger.annotations.is_empty() {
        return false;
    }
    let mut renaming = VarRenaming::new();
    if !more_general(&of_args(&earlier.trigger.args), &of_args(&later.trigger.args), &mut renaming) {
        return false;
    }
    let (Some(ours), Some(theirs)) = (alternatives(&earlier.context), alternatives(&later.context)) else {
        return false;
    };
    theirs.iter().all(|theirs| {
        let theirs = ContextConjunction::of(later, theirs);
        ours.iter().any(|ours| {
            let ours = ContextConjunction::of(earlier, ours);
            let positive: Vec<usize> = ours.positive().collect();
            implied(&ours, &theirs, &positive, renaming.clone(), &mut TRIES.clone())
        })
    })
}

/// A conjunction, each part with the variables that have a value before it.
struct ContextConjunction<'a> {
    parts: Vec<(&'a TypedContext, Vec<u16>)>,
}

impl<'a> ContextConjunction<'a> {
    fn of(plan: &TypedPlan, parts: &[&'a TypedContext]) -> Self {
        let bound = bound_before(plan, parts);
        Self { parts: parts.iter().copied().zip(bound).collect() }
    }

    fn positive(&self) -> impl Iterator<Item = usize> {
        (0..self.parts.len()).filter(|i| matches!(self.parts[*i].0, TypedContext::Belief(..)))
    }
}

/// How many pairs of literals are tried: there are exponentially many ways to match one conjunction with another.
const TRIES: usize = 2_000;

/// Whether each part of `ours` follows from a part of `theirs`. First the literals in turn, each of which may follow
/// from several and so give its variables a meaning; then the rest.
fn implied(
    ours: &ContextConjunction<'_>,
    theirs: &ContextConjunction<'_>,
    open: &[usize],
    renaming: VarRenaming,
    tries: &mut usize,
) -> bool {
    let Some((first, open)) = open.split_first() else {
        return ours.parts.iter().all(|part| match part.0 {
            TypedContext::Belief(..) => true,
            TypedContext::Not(_) | TypedContext::Test(_) => {
                theirs.parts.iter().any(|t| follows(part, t, &renaming)) || is_true(part.0, &renaming)
            }
            TypedContext::True
            | TypedContext::And(_)
            | TypedContext::Or(_)
            | TypedContext::Unify(..)
            | TypedContext::Internal(..) => false,
        });
    };
    let TypedContext::Belief(ours_first) = ours.parts[*first].0 else { return false };
    if !ours_first.annotations.is_empty() {
        return false;
    }
    theirs.parts.iter().any(|(their, _)| {
        let Some(left) = tries.checked_sub(1) else { return false };
        *tries = left;
        let mut renaming = renaming.clone();
        matches!(their, TypedContext::Belief(special) if special.belief == ours_first.belief
            && more_general(&of_args(&ours_first.args), &of_args(&special.args), &mut renaming))
            && implied(ours, theirs, open, renaming, tries)
    })
}

/// A test of values that the other plan's head fixes.
fn is_true(test: &TypedContext, renaming: &VarRenaming) -> bool {
    let TypedContext::Test(e) = test else { return false };
    let value = |leaf| match leaf {
        VariableRef::Local(var) => match renaming.get(&var) {
            Some(TermImage::Const(value)) => Some(*value),
            Some(TermImage::Var(_) | TermImage::Unnamed) | None => None,
        },
        VariableRef::Own(_) | VariableRef::Shared(_) | VariableRef::Signal(_) => None,
    };
    e.value_with(&value) == Some(Value::Bool(true))
}

/// Whether a negation or test is the same as the other plan's.
fn follows(
    ours: &(&TypedContext, Vec<u16>),
    theirs: &(&TypedContext, Vec<u16>),
    renaming: &VarRenaming,
) -> bool {
    let mut pairs = PlanPairs { renaming, bound: (&ours.1, &theirs.1), own: Vec::new() };
    pairs.same(ours.0, theirs.0)
}

/// Which variables of two formulas are the same.
struct PlanPairs<'a> {
    renaming: &'a VarRenaming,
    /// What has a value before the formula: ours, theirs.
    bound: (&'a [u16], &'a [u16]),
    /// Variables that only the formula itself knows.
    own: Vec<(u16, u16)>,
}

impl PlanPairs<'_> {
    fn var(&mut self, ours: u16, theirs: u16) -> bool {
        match (self.bound.0.contains(&ours), self.bound.1.contains(&theirs)) {
            (true, true) => self.renaming.get(&ours) == Some(&TermImage::Var(theirs)),
            (false, false) => {
                if !self.own.iter().any(|(a, b)| *a == ours || *b == theirs) {
                    self.own.push((ours, theirs));
                }
                self.own.contains(&(ours, theirs))
            }
            (true, false) | (false, true) => false,
        }
    }

    fn same(&mut self, ours: &TypedContext, theirs: &TypedContext) -> bool {
        match (ours, theirs) {
            (TypedContext::True, TypedContext::True) => true,
            (TypedContext::Belief(a), TypedContext::Belief(b)) => {
                a.belief == b.belief
                    && a.annotations.is_empty()
                    && b.annotations.is_empty()
                    && a.args.iter().zip(&b.args).all(|(a, b)| self.same_arg(a, b))
            }
            (TypedContext::Not(a), TypedContext::Not(b)) => self.same(a, b),
            (TypedContext::And(a), TypedContext::And(b)) | (TypedContext::Or(a), TypedContext::Or(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| self.same(a, b))
            }
            (TypedContext::Test(a), TypedContext::Test(b)) => {
                is_total(a) && same_expr(a, b, &mut |a, b| self.var(a, b))
            }
            (
                TypedContext::True
                | TypedContext::Belief(..)
                | TypedContext::Not(_)
                | TypedContext::And(_)
                | TypedContext::Or(_)
                | TypedContext::Test(_)
                | TypedContext::Unify(..)
                | TypedContext::Internal(..),
                _,
            ) => false,
        }
    }

    fn same_arg(&mut self, ours: &TypedTerm, theirs: &TypedTerm) -> bool {
        match (PlanTerm::of_arg(ours), PlanTerm::of_arg(theirs)) {
            (PlanTerm::Any, PlanTerm::Any) => true,
            (PlanTerm::Var(a), PlanTerm::Var(b)) => self.var(a, b),
            (PlanTerm::Var(a), PlanTerm::Const(b)) => {
                self.bound.0.contains(&a) && self.renaming.get(&a) == Some(&TermImage::Const(b))
            }
            (PlanTerm::Const(a), PlanTerm::Const(b)) => super::plan_terms::same_value(a, b),
            (PlanTerm::Other(a), PlanTerm::Other(b)) => {
                is_total(a) && same_expr(a, b, &mut |a, b| self.var(a, b))
            }
            (
                PlanTerm::Any | PlanTerm::Var(_) | PlanTerm::Const(_) | PlanTerm::Other(_) | PlanTerm::Part,
                _,
            ) => false,
        }
    }
}
