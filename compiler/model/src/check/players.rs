//! Agents and automata before anything of them is checked.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, NameSyntax};

use crate::check::{
    checker::{Checker, NOBODY},
    state::names::DeclaredPlayer,
    template::CheckerPhase,
};
use crate::{LocationId, TypedAgent, TypedAutomaton, noun::Noun, report::names};

impl<'a> Checker<'a> {
    /// An agent that has nothing yet.
    pub(in crate::check) fn push_agent(
        &mut self,
        agent: &DeclaredPlayer<'a, ast::AgentSyntax>,
        name: &NameSyntax,
        span: Span,
    ) {
        let plays = &agent.syntax.plays;
        let jason = match &agent.syntax.annotation {
            Some(name) if name.text == "jason" => true,
            Some(name) => {
                self.report(names::unknown(Noun::Annotation, &name.text, name.span, ["jason"]));
                false
            }
            None => false,
        };
        let actor = self.as_instance(agent.given.clone(), None, |c| c.actor(plays)).unwrap_or(NOBODY);
        self.s.agents.push(TypedAgent {
            name: name.text.clone(),
            actor,
            jason,
            beliefs: Vec::new(),
            goals: Vec::new(),
            rules: Vec::new(),
            initial_beliefs: Vec::new(),
            initial_goals: Vec::new(),
            plans: Vec::new(),
            origin: span,
        });
    }

    /// An automaton that has nothing yet.
    pub(in crate::check) fn push_automaton(
        &mut self,
        automaton: &DeclaredPlayer<'a, ast::AutomatonSyntax>,
        name: &NameSyntax,
        span: Span,
    ) {
        let plays = automaton.syntax.plays.as_ref();
        let actor = plays.map(|plays| {
            self.as_instance(automaton.given.clone(), None, |c| c.actor(plays)).unwrap_or(NOBODY)
        });
        self.s.automata.push(TypedAutomaton {
            name: name.text.clone(),
            actor,
            clocks: Vec::new(),
            vars: Vec::new(),
            locations: Vec::new(),
            initial: LocationId(0),
            edges: Vec::new(),
            origin: span,
        });
    }
}
