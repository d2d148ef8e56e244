//! Roles: who makes an event, and who perceives it.

use hrdsl_source::Span;
use hrdsl_syntax::ast::CallSyntax;

use crate::check::checker::{Checker, NOBODY};
use crate::{ActorId, EventId, Role, noun::Noun, report::roles};

impl Checker<'_> {
    /// Whether an event reaches an actor: one of another actor, addressed to it or to everybody. Automata of one actor
    /// also hear each other.
    pub(in crate::check) fn perceives(&mut self, actor: ActorId, event: EventId, span: Span, own_too: bool) {
        let e = &self.s.events[usize::from(event.0)];
        if actor == NOBODY || e.from == NOBODY {
            return;
        }
        let who = self.actor_name(actor);
        let noun = if e.stimulus.is_some() { Noun::Stimulus } else { Noun::Event };
        let issue = if e.from == actor {
            if own_too {
                return;
            }
            let help = format!("it is done by `{who}` itself, which only perceives what others do");
            roles::not_perceived(noun, &e.name, who, &help, span)
        } else if e.stimulus.is_some() && self.role_of(actor) == Role::System {
            let help = "a stimulus is an action of a test: the system only perceives the events it emits";
            roles::not_perceived(noun, &e.name, who, help, span)
        } else if !e.to.is_empty() && !e.to.contains(&actor) {
            let to: Vec<&str> = e.to.iter().map(|a| self.actor_name(*a)).collect();
            let help = format!("it is declared `to {}`", to.join(", "));
            roles::not_perceived(noun, &e.name, who, &help, span)
        } else {
            return;
        };
        self.report(issue);
    }

    pub(in crate::check) fn noun_of(&self, event: EventId) -> Noun {
        let stimulus = self.s.events[usize::from(event.0)].stimulus.is_some();
        if stimulus { Noun::Stimulus } else { Noun::Event }
    }

    /// Only the events of the actor that is played can be made.
    pub(in crate::check) fn owns(&mut self, actor: ActorId, event: EventId, call: &CallSyntax) {
        let from = self.s.events[usize::from(event.0)].from;
        if from != actor && from != NOBODY && actor != NOBODY {
            let (owner, player) = (self.actor_name(from), self.actor_name(actor));
            let issue = roles::not_its_event(&call.name.text, owner, player, call.name.span);
            self.report(issue);
        }
    }
}
