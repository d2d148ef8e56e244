//! What a program does with which belief, goal and action, and where.

use hrdsl_source::Span;
use indexmap::IndexMap;

use super::{
    ast::{
        AgentSpeakFormula, AgentSpeakItemKind, AgentSpeakLiteral, AgentSpeakPlan, AgentSpeakProgram,
        AgentSpeakStep, AgentSpeakStepKind, AgentSpeakTerm, AgentSpeakTriggerKind, BeliefAddition,
        PredicateIndicator, TermKind, each_step, each_term,
    },
    term::{atom, message, performative},
};

/// What is done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OccurrenceKind {
    /// Held at the start.
    Initial,
    /// The head of a rule.
    Rule,
    /// `+b`, with where it puts it.
    Added(BeliefAddition),
    /// `-+b`
    Replaced,
    /// `-b`; `true`: with a source.
    Removed(bool),
    /// A context, a query; `true`: with open places.
    Tested(bool),
    /// `.wait`
    Waited,
    /// The trigger of a plan.
    Trigger(AgentSpeakTriggerKind),
    /// A goal that is adopted.
    Adopted,
    /// Told, asked to be achieved; to one that is known, or to anybody.
    Sent { to: Option<String>, goal: bool, told: bool },
}

/// One place.
#[derive(Clone, Debug)]
pub struct PredicateOccurrence {
    pub key: PredicateIndicator,
    pub negated: bool,
    pub what: OccurrenceKind,
    pub span: Span,
}

/// What declarations are about: a column of [`PredicateSurvey::hints`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PredicateKind {
    Belief,
    Goal,
    Action,
}

/// All places of a program, in the order of the text.
#[derive(Clone, Debug, Default)]
pub struct PredicateSurvey {
    pub beliefs: Vec<PredicateOccurrence>,
    pub goals: Vec<PredicateOccurrence>,
    /// The actions of the environment, with the first place of each.
    pub actions: IndexMap<PredicateIndicator, Span>,
    /// What the arguments of beliefs, goals and actions are called: the first variable at each place.
    pub hints: IndexMap<(PredicateKind, PredicateIndicator), Vec<Option<String>>>,
}

/// Looks at a program.
pub fn survey(program: &AgentSpeakProgram) -> PredicateSurvey {
    let mut survey = PredicateSurvey::default();
    for item in &program.items {
        match &item.kind {
            AgentSpeakItemKind::Belief(b) => survey.belief(b, OccurrenceKind::Initial),
            AgentSpeakItemKind::Rule { head, body } => {
                survey.belief(head, OccurrenceKind::Rule);
                survey.formula(body, false);
            }
            AgentSpeakItemKind::Goal(goal) => survey.goal_term(goal, OccurrenceKind::Adopted),
            AgentSpeakItemKind::Plan(plan) => survey.plan(plan),
            AgentSpeakItemKind::Skipped(_) | AgentSpeakItemKind::Broken(_) => {}
        }
    }
    survey
}

impl PredicateSurvey {
    pub fn belief(&mut self, of: &AgentSpeakLiteral, what: OccurrenceKind) {
        let (key, negated, span) = (of.key(), of.negated, of.span);
        self.hint(PredicateKind::Belief, of);
        self.beliefs.push(PredicateOccurrence { key, negated, what, span });
    }

    fn hint(&mut self, sort: PredicateKind, of: &AgentSpeakLiteral) {
        let hints = self.hints.entry((sort, of.key())).or_insert_with(|| vec![None; of.args.len()]);
        for (hint, arg) in hints.iter_mut().zip(&of.args) {
            if let (None, TermKind::Var { name, .. }) = (&hint, &arg.kind) {
                *hint = Some(name.clone());
            }
        }
    }

    pub fn goal(&mut self, of: &AgentSpeakLiteral, what: OccurrenceKind) {
        self.hint(PredicateKind::Goal, of);
        self.goals.push(PredicateOccurrence { key: of.key(), negated: false, what, span: of.span });
    }

    fn goal_term(&mut self, of: &AgentSpeakTerm, what: OccurrenceKind) {
        if let TermKind::Literal(l) = &of.kind {
            self.goal(l, what);
        }
    }

    fn belief_term(&mut self, of: &AgentSpeakTerm, what: OccurrenceKind) {
        if let TermKind::Literal(l) = &of.kind {
            self.belief(l, what);
        }
    }

    fn plan(&mut self, plan: &AgentSpeakPlan) {
        let kind = plan.trigger.kind;
        if kind.is_goal() {
            self.goal_term(&plan.trigger.of, OccurrenceKind::Trigger(kind));
        } else {
            self.belief_term(&plan.trigger.of, OccurrenceKind::Trigger(kind));
        }
        if let Some(context) = &plan.context {
            self.formula(context, false);
        }
        each_step(&plan.body, &mut |step| self.step(step));
    }

    fn step(&mut self, step: &AgentSpeakStep) {
        match &step.kind {
            AgentSpeakStepKind::Achieve(t) | AgentSpeakStepKind::Spawn(t) => {
                self.goal_term(t, OccurrenceKind::Adopted)
            }
            AgentSpeakStepKind::Query(t) | AgentSpeakStepKind::Formula(t) => self.formula(t, false),
            AgentSpeakStepKind::Add(t, adding) => self.belief_term(t, OccurrenceKind::Added(*adding)),
            AgentSpeakStepKind::Remove(t) => {
                let with_source = matches!(&t.kind, TermKind::Literal(l) if !l.annotations.is_empty());
                self.belief_term(t, OccurrenceKind::Removed(with_source));
            }
            AgentSpeakStepKind::Replace(t) => self.belief_term(t, OccurrenceKind::Replaced),
            AgentSpeakStepKind::Action(action) if action.is_internal() => self.internal(action),
            AgentSpeakStepKind::Action(action) => {
                self.hint(PredicateKind::Action, action);
                self.actions.entry(action.key()).or_insert(action.span);
            }
            AgentSpeakStepKind::If { condition, .. }
            | AgentSpeakStepKind::While { condition, .. }
            | AgentSpeakStepKind::For { condition, .. } => {
                self.formula(condition, false);
            }
            AgentSpeakStepKind::Fork { .. } | AgentSpeakStepKind::Block(_) => {}
        }
    }

    fn formula(&mut self, of: &AgentSpeakTerm, waits: bool) {
        if let (true, TermKind::Trigger(t)) = (waits, &of.kind) {
            self.belief_term(&t.of, OccurrenceKind::Waited);
        }
        match of.as_formula() {
            Some(AgentSpeakFormula::Literal(l)) if l.is_internal() => self.internal(l),
            Some(AgentSpeakFormula::Literal(l)) => {
                let mut open = false;
                l.args
                    .iter()
                    .for_each(|a| each_term(a, &mut |t| open |= matches!(t.kind, TermKind::Var { .. })));
                self.belief(l, if waits { OccurrenceKind::Waited } else { OccurrenceKind::Tested(open) });
            }
            Some(AgentSpeakFormula::Not(inner)) => self.formula(inner, waits),
            Some(AgentSpeakFormula::Connective { left, right, .. }) => {
                self.formula(left, waits);
                self.formula(right, waits);
            }
            Some(AgentSpeakFormula::Truth(_) | AgentSpeakFormula::Relation { .. }) | None => {}
        }
    }

    fn internal(&mut self, of: &AgentSpeakLiteral) {
        match (of.functor.as_str(), of.args.as_slice()) {
            (".send" | ".broadcast", _) => {
                let Ok(message) = message(of) else { return };
                let goal = performative(message.performative) == Some(true);
                let told = matches!(message.performative, "tell" | "achieve");
                let to = message.to.and_then(atom).map(str::to_owned);
                let what = OccurrenceKind::Sent { to, goal, told };
                for content in message.each().unwrap_or(std::slice::from_ref(message.content)) {
                    if goal {
                        self.goal_term(content, what.clone())
                    } else {
                        self.belief_term(content, what.clone())
                    }
                }
            }
            (".findall" | ".setof", [_, formula, _]) | (".count", [formula, _]) => {
                self.formula(formula, false)
            }
            (".wait", [what, ..]) => self.formula(what, true),
            (".abolish", [belief]) => self.belief_term(belief, OccurrenceKind::Removed(true)),
            (".fork", args) => {
                for arg in args {
                    if let TermKind::Body(body) = &arg.kind {
                        each_step(body, &mut |step| self.step(step));
                    }
                }
            }
            _ => {}
        }
    }
}
