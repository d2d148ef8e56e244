//! What a suite by search asks for by name: violations, triggers and queries.

use hrdsl_ir::value::nanos;
use hrdsl_syntax::ast::{self, NameSyntax, SuiteMember, SuiteMemberKind, SuiteSetting};

use super::{phase::TestingPhase, suite::SuiteMembers};
use crate::check::template::CheckerPhase;
use crate::{
    BoundaryStep, Dimension, NetworkId, QueryId, RequirementId, TypedAutomaton, TypedQueryKind,
    TypedSearchGoal,
    noun::Noun,
    report::{coverage::bad_suite, types},
};

/// More different witnesses of one goal are not looked for.
const MOST_DIVERSE: i64 = 16;

/// What else a suite can reach each of.
const OTHERS: [&str; 10] =
    ["value", "pair", "use", "combination", "location", "edge", "plan", "context", "message", "path"];

impl TestingPhase<'_, '_> {
    /// `pair`, `use`, `value`, `bound`
    pub(super) fn reach_each_of_network(&mut self, word: &NameSyntax, said: &mut SuiteMembers) {
        let goals = [
            TypedSearchGoal::Pairs,
            TypedSearchGoal::Uses,
            TypedSearchGoal::Values,
            TypedSearchGoal::Bounds(BoundaryStep::default()),
        ];
        let words = ["pair", "use", "value", "bound", "location", "edge", "bin of …", "combination of …"];
        let found = self.choice(Noun::SearchReach, word, &words);
        said.goals.extend(found.and_then(|i| goals.get(i)).cloned());
    }

    /// `reach each bound by D`
    pub(super) fn reach_each_by(
        &mut self,
        what: &NameSyntax,
        step: &ast::ExprSyntax,
        by_search: bool,
        said: &mut SuiteMembers,
    ) {
        let noun = if by_search { Noun::SearchReach } else { Noun::Reach };
        if OTHERS.contains(&what.text.as_str()) {
            let message = format!("only bounds have a step: `reach each {}` has none", what.text);
            self.report(bad_suite(
                what.span.to(step.span),
                message,
                format!("write `reach each {}`, or `reach each bound by …`", what.text),
            ));
            return;
        }
        let known = self.choice(noun, what, &["bound"]).is_some();
        let Some(by) = self.time(step, "the step beside a bound", true).map(nanos) else { return };
        if by == 0 {
            self.report(types::must_be("the step beside a bound", "at least 1 ns", step.span));
        } else if known {
            let step = BoundaryStep { by: Some(by) };
            if by_search {
                said.goals.push(TypedSearchGoal::Bounds(step));
            } else {
                said.bounds = Some(step);
            }
        }
    }

    /// `diverse 3`
    pub(super) fn diverse(&mut self, value: &ast::ExprSyntax) -> Option<u32> {
        let count = self.count(value, "the number of witnesses of a goal", 1)?;
        if count > MOST_DIVERSE {
            let rule = format!("1 to {MOST_DIVERSE}");
            self.report(types::must_be("the number of witnesses of a goal", &rule, value.span));
            return None;
        }
        u32::try_from(count).ok()
    }

    /// `boundary 0.25`
    pub(super) fn share(&mut self, value: &ast::ExprSyntax) -> Option<f64> {
        let share = self.quantity_of(value, Dimension::NUMBER)?;
        if (0.0..=1.0).contains(&share) {
            return Some(share);
        }
        self.report(types::must_be("the share of pauses at a bound", "0 to 1", value.span));
        None
    }

    /// A share of the pauses can be put at a bound only if a pause can be of several lengths.
    pub(super) fn boundary_of(
        &mut self,
        share: Option<f64>,
        pause: (f64, f64),
        suite: &ast::SuiteSyntax,
    ) -> Option<f64> {
        let share = share?;
        if pause.0 >= pause.1 {
            let is_it = |m: &&SuiteMember| {
                matches!(m.kind, SuiteMemberKind::Setting { what: SuiteSetting::Boundary, .. })
            };
            let at = suite.members.iter().find(is_it).map_or(suite.name.span, |m| m.span);
            let message = format!("a pause is always {} s here: it has no range, and so no bounds", pause.0);
            self.report(bad_suite(at, message, "give it one, as in `pause 0 s .. 10 s`, or remove this"));
            return None;
        }
        Some(share)
    }

    /// Who asks for bounds has a network in which a clock is compared with a time.
    pub(super) fn bounded(&mut self, network: NetworkId, suite: &ast::SuiteSyntax) {
        let asks = |m: &&SuiteMember| {
            let (SuiteMemberKind::ReachEach(what) | SuiteMemberKind::ReachEachBy { what, .. }) = &m.kind
            else {
                return false;
            };
            what.text == "bound"
        };
        let Some(at) = suite.members.iter().find(asks).map(|m| m.span) else { return };
        let network = &self.s.networks[usize::from(network.0)];
        let compares = |automaton: &TypedAutomaton| {
            automaton.edges.iter().any(|e| !e.clock_guard.is_empty())
                || automaton.locations.iter().any(|l| !l.invariant.is_empty())
        };
        if self.s.members(network).any(compares) || !self.s.requirements.is_empty() {
            return;
        }
        let message =
            format!("no automaton of `{}` compares a clock with a time: there is no bound", network.name);
        self.report(bad_suite(at, message, "remove it, or say in the model how long something takes"));
    }

    /// `violation of R1, R2`, `trigger of R1`
    pub(super) fn reach_of(&mut self, what: &NameSyntax, list: &[NameSyntax], said: &mut SuiteMembers) {
        let what = self.choice(Noun::ReachOf, what, &["violation", "trigger"]);
        for name in list {
            if self.requirements.get(&name.text).is_none() {
                let all = self.near_of(&[Noun::Requirement]);
                self.unknown(Noun::Requirement, name, &all, None);
                continue;
            }
            self.refer(name, self.requirements.span_of(&name.text));
            // One with a diagnostic is in no list.
            let Some(at) = self.s.requirements.iter().position(|r| r.name == name.text) else { continue };
            if self.s.requirements[at].reads_the_world() {
                let message =
                    format!("`{}` reads signals of the world, which a network does not have", name.text);
                self.report(bad_suite(name.span, message, "remove it: `hrdsl sim` judges it in every run"));
                continue;
            }
            let id = RequirementId(u16::try_from(at).unwrap_or(u16::MAX));
            match what {
                Some(0) => said.goals.push(TypedSearchGoal::Violation(id)),
                Some(_) => said.goals.push(TypedSearchGoal::Trigger(id)),
                None => {}
            }
        }
    }

    pub(super) fn reach_query(&mut self, name: &NameSyntax) -> Option<TypedSearchGoal> {
        if self.networks.queries.get(&name.text).is_none() {
            let all = self.near_of(&[Noun::Query]);
            self.unknown(Noun::Query, name, &all, None);
            return None;
        }
        self.refer(name, self.networks.queries.span_of(&name.text));
        let at = self.s.queries.iter().position(|q| q.name == name.text)?;
        match &self.s.queries[at].ask {
            TypedQueryKind::Possibly(f) if f.asks_deadlock() => {
                let message = format!("`{}` asks for a deadlock, which is nothing to do", name.text);
                self.report(bad_suite(name.span, message, "`hrdsl prove` answers it"));
                None
            }
            TypedQueryKind::Possibly(_) => {
                Some(TypedSearchGoal::Query(QueryId(u16::try_from(at).unwrap_or(u16::MAX))))
            }
            TypedQueryKind::Invariantly(_)
            | TypedQueryKind::PotentiallyAlways(_)
            | TypedQueryKind::Eventually(_)
            | TypedQueryKind::LeadsTo(..)
            | TypedQueryKind::Sup { .. }
            | TypedQueryKind::Inf { .. } => {
                let message = format!("`{}` does not ask `E<>`: a test cannot reach it", name.text);
                self.report(bad_suite(name.span, message, "`hrdsl prove` answers it"));
                None
            }
        }
    }

    /// The queries that a suite reaches are about its network.
    pub(super) fn of_network(
        &mut self,
        network: NetworkId,
        goals: &[TypedSearchGoal],
        suite: &ast::SuiteSyntax,
    ) -> NetworkId {
        for goal in goals {
            let TypedSearchGoal::Query(id) = goal else { continue };
            let query = &self.s.queries[usize::from(id.0)];
            if query.network == network {
                continue;
            }
            let (name, of) = (query.name.clone(), usize::from(query.network.0));
            let message = format!("the query `{name}` is about another network than this suite");
            let help = format!("make a suite `by search of {}`", self.s.networks[of].name);
            self.report(bad_suite(suite.name.span, message, help));
        }
        network
    }
}
