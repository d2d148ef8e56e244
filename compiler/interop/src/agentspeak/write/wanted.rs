//! Goals that give values: which of their arguments are open where they are adopted, and what their plans do about that.

use hrdsl_source::Span;
use indexmap::IndexMap;

use super::{
    clause::{BindingMode, ClauseFailure, ClauseResult, ClauseTranslator, PredicateUsage},
    steps::PlanBodyLine,
};
use crate::agentspeak::ast::{
    AgentSpeakLiteral, AgentSpeakPlan, AgentSpeakTerm, PredicateIndicator, TermKind, has_any, variables,
};

/// By goal and argument: how it is open.
pub type WantedArguments = IndexMap<PredicateIndicator, IndexMap<usize, WantedArgument>>;

/// An argument that is open where the goal is adopted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WantedArgument {
    /// The value is taken: not only `_` stands there.
    pub taken: bool,
    /// A plan needs it from the start, so that it must have a value: the plan's place.
    pub needed: Option<Span>,
}

/// Enters what the clauses of an agent want; `false` if that was known.
pub fn enlarge(
    wanted: &mut WantedArguments,
    used: &PredicateUsage,
    needing: &[(Span, PredicateIndicator)],
) -> bool {
    let before = wanted.clone();
    for (key, argument, taken) in &used.wanted {
        wanted.entry(key.clone()).or_default().entry(*argument).or_default().taken |= taken;
    }
    for (plan, key) in needing {
        for argument in wanted.entry(key.clone()).or_default().values_mut() {
            argument.needed = argument.needed.or(Some(*plan));
        }
    }
    *wanted != before
}

impl ClauseTranslator<'_> {
    /// `g(…)`, which is waited for: what has no value gets one.
    pub fn achieved(&mut self, of: &AgentSpeakLiteral) -> ClauseResult<String> {
        let key = of.key();
        let open: Vec<bool> = of.args.iter().map(|a| self.is_open(a)).collect();
        let mut args: Vec<Vec<String>> = Vec::new();
        // What is computed needs its values first.
        for (arg, open) in of.args.iter().zip(&open) {
            args.push(if *open { Vec::new() } else { self.values(arg, BindingMode::Value)? });
        }
        for (i, arg) in of.args.iter().enumerate().filter(|(i, _)| open[*i]) {
            let known = self.cx.wanted.get(&key).and_then(|all| all.get(&i));
            if let Some(plan) = known.and_then(|k| k.needed) {
                let (what, line) =
                    (self.cx.system.files.text(arg.span), self.cx.system.files.position(plan).line);
                return Err(ClauseFailure::Other(format!(
                    "`{what}` has no value here, and the plan in line {line} for the goal needs one"
                )));
            }
            self.used.wanted.insert((key.clone(), i, !matches!(arg.kind, TermKind::Any)));
            args[i] = self.values(arg, BindingMode::Pattern)?;
        }
        self.goal_with(of, &args.concat(), BindingMode::Value)
    }

    fn is_open(&self, of: &AgentSpeakTerm) -> bool {
        match &of.kind {
            TermKind::Any => true,
            TermKind::Var { name, .. } => !self.bound.contains(name),
            _ => false,
        }
    }

    /// In a plan for a goal: the variables of arguments that are open somewhere have no value at first.
    pub fn open(&mut self, of: &AgentSpeakLiteral) {
        let Some(wanted) = self.cx.wanted.get(&of.key()) else { return };
        let open = |i: usize| wanted.get(&i).filter(|w| w.needed.is_none());
        let mut given = Vec::new();
        for (_, arg) in of.args.iter().enumerate().filter(|(i, _)| open(*i).is_none()) {
            given.extend(variables(arg));
        }
        for (i, arg) in of.args.iter().enumerate() {
            let Some(wanted) = open(i) else { continue };
            for name in variables(arg).into_iter().filter(|n| !given.contains(n)) {
                self.bound.remove(&name);
                *self.owed.entry(name).or_default() |= wanted.taken;
            }
            if has_any(arg) && wanted.taken {
                self.owed.insert("_".to_owned(), true);
            }
        }
    }

    /// At the end of a plan: without a value that is taken it fails.
    pub fn close(&mut self, plan: &AgentSpeakPlan, lines: &mut Vec<PlanBodyLine>) {
        let fails = |l: &PlanBodyLine| matches!(l, PlanBodyLine::Step(text) if text == ".fail");
        if lines.iter().rev().find(|l| matches!(l, PlanBodyLine::Step(_))).is_some_and(fails) {
            return;
        }
        let Some(name) =
            self.owed.iter().find(|(n, taken)| **taken && !self.bound.contains(*n)).map(|(n, _)| n)
        else {
            return;
        };
        let message = format!(
            "this plan gives `{name}` no value: in Jason the variable that is wanted stays without one, here the plan fails"
        );
        self.remarks.push((plan.trigger.of.span, message));
        lines.push(PlanBodyLine::Step(".fail".to_owned()));
    }
}
