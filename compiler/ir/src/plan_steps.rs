//! What a step of a plan is asked by who cares for one kind of steps, or for two that are alike.

use crate::{
    EventId, EventPattern,
    bdi::{Assertion, BeliefLiteral, GoalId, PlanStepKind},
};

impl<E> PlanStepKind<E> {
    /// The stimulus or event that it does.
    #[must_use]
    pub fn as_do(&self) -> Option<(EventId, &[E])> {
        if let PlanStepKind::Do { event, args } = self { Some((*event, args)) } else { None }
    }

    /// The goal that it achieves before the plan goes on.
    #[must_use]
    pub fn as_achieve(&self) -> Option<(GoalId, &[E])> {
        if let PlanStepKind::Achieve { goal, args, .. } = self { Some((*goal, args)) } else { None }
    }

    /// The goal that it adopts, whether the plan waits for it or not.
    #[must_use]
    pub fn as_adoption(&self) -> Option<(GoalId, &[E])> {
        let spawned =
            if let PlanStepKind::Spawn { goal, args } = self { Some((*goal, &args[..])) } else { None };
        self.as_achieve().or(spawned)
    }

    /// What it asks the belief base.
    #[must_use]
    pub fn as_query(&self) -> Option<&BeliefLiteral<E>> {
        if let PlanStepKind::Query(literal) = self { Some(literal) } else { None }
    }

    /// What it adds to the beliefs, be it in the place of others.
    #[must_use]
    pub fn as_assertion(&self) -> Option<&Assertion<E>> {
        if let PlanStepKind::Add(made) | PlanStepKind::Replace(made) = self { Some(made) } else { None }
    }

    /// What it takes from the beliefs, one or all of them.
    #[must_use]
    pub fn as_removal(&self) -> Option<&BeliefLiteral<E>> {
        if let PlanStepKind::Remove(gone) | PlanStepKind::Abolish(gone) = self { Some(gone) } else { None }
    }

    /// The events of which it awaits one.
    #[must_use]
    pub fn as_await(&self) -> Option<&[EventPattern]> {
        if let PlanStepKind::Await { events, .. } = self { Some(events) } else { None }
    }
}
