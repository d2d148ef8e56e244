//! What a step of a plan is asked by who cares for one kind of steps, or for two that are alike.

use crate::{
    EventId, EventPattern,
    bdi::{Assertion, BeliefLiteral, GoalId, PlanContext, PlanStep, PlanStepKind},
};

/// Calls `f` with each step, those within blocks too, in the order of the text.
pub fn each_step<'p, E>(steps: &'p [PlanStep<E>], f: &mut dyn FnMut(&'p PlanStep<E>)) {
    for step in steps {
        f(step);
        step.blocks().into_iter().for_each(|block| each_step(block, f));
    }
}

/// A step that has other steps in it.
#[derive(Clone, Copy, Debug)]
pub enum PlanBlock<'s, E> {
    If { condition: &'s PlanContext<E>, then: &'s [PlanStep<E>], otherwise: &'s [PlanStep<E>] },
    While { condition: &'s PlanContext<E>, body: &'s [PlanStep<E>] },
    For { condition: &'s PlanContext<E>, body: &'s [PlanStep<E>] },
    Fork { branches: &'s [Vec<PlanStep<E>>], all: bool },
}

impl<'s, E> PlanBlock<'s, E> {
    /// The steps within it.
    #[must_use]
    pub fn bodies(self) -> Vec<&'s [PlanStep<E>]> {
        match self {
            PlanBlock::If { then, otherwise, .. } => vec![then, otherwise],
            PlanBlock::While { body, .. } | PlanBlock::For { body, .. } => vec![body],
            PlanBlock::Fork { branches, .. } => branches.iter().map(Vec::as_slice).collect(),
        }
    }

    /// The formula that says whether, or how often, they are done.
    #[must_use]
    pub fn condition(self) -> Option<&'s PlanContext<E>> {
        match self {
            PlanBlock::If { condition, .. }
            | PlanBlock::While { condition, .. }
            | PlanBlock::For { condition, .. } => Some(condition),
            PlanBlock::Fork { .. } => None,
        }
    }
}

impl<E> PlanStepKind<E> {
    /// The block that it is, if there are steps in it.
    #[must_use]
    pub fn as_block(&self) -> Option<PlanBlock<'_, E>> {
        Some(match self {
            PlanStepKind::If { condition, then, otherwise } => PlanBlock::If { condition, then, otherwise },
            PlanStepKind::While { condition, body } => PlanBlock::While { condition, body },
            PlanStepKind::For { condition, body } => PlanBlock::For { condition, body },
            PlanStepKind::Fork { branches, all } => PlanBlock::Fork { branches, all: *all },
            PlanStepKind::Do { .. }
            | PlanStepKind::Achieve { .. }
            | PlanStepKind::Spawn { .. }
            | PlanStepKind::Query(_)
            | PlanStepKind::Test(_)
            | PlanStepKind::Add(_)
            | PlanStepKind::Remove(_)
            | PlanStepKind::Replace(_)
            | PlanStepKind::Abolish(_)
            | PlanStepKind::Await { .. }
            | PlanStepKind::Wait { .. }
            | PlanStepKind::Send { .. }
            | PlanStepKind::Ask { .. }
            | PlanStepKind::AskAll { .. }
            | PlanStepKind::Print { .. }
            | PlanStepKind::Control { .. }
            | PlanStepKind::Fail => return None,
        })
    }

    /// The formula that it tests.
    #[must_use]
    pub fn as_test(&self) -> Option<&PlanContext<E>> {
        if let PlanStepKind::Test(condition) = self { Some(condition) } else { None }
    }

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
