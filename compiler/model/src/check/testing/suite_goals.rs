//! What a suite by search asks for by name: violations, triggers and queries.

use hrdsl_syntax::ast::{self, NameSyntax};

use super::{phase::TestingPhase, suite::SuiteMembers};
use crate::check::template::CheckerPhase;
use crate::{
    NetworkId, QueryId, RequirementId, SearchGoal, TypedQueryKind, noun::Noun, report::coverage::bad_suite,
};

impl TestingPhase<'_, '_> {
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
                Some(0) => said.goals.push(SearchGoal::Violation(id)),
                Some(_) => said.goals.push(SearchGoal::Trigger(id)),
                None => {}
            }
        }
    }

    pub(super) fn reach_query(&mut self, name: &NameSyntax) -> Option<SearchGoal> {
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
                Some(SearchGoal::Query(QueryId(u16::try_from(at).unwrap_or(u16::MAX))))
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
        goals: &[SearchGoal],
        suite: &ast::SuiteSyntax,
    ) -> NetworkId {
        for goal in goals {
            let SearchGoal::Query(id) = goal else { continue };
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
