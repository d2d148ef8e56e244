//! What a program does with which belief, goal and action, and where.

use hrdsl_source::Span;
use indexmap::IndexMap;

use super::{
    ast::{
        Adding, ItemKind, Key, Literal, Op, Plan, Program, Step, StepKind, Term, TermKind, TriggerKind,
        each_step, each_term,
    },
    term::{atom, message, performative},
};

/// What is done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum What {
    /// Held at the start.
    Initial,
    /// The head of a rule.
    Rule,
    /// `+b`, with where it puts it.
    Added(Adding),
    /// `-+b`
    Replaced,
    /// `-b`; `true`: with a source.
    Removed(bool),
    /// A context, a query; `true`: with open places.
    Tested(bool),
    /// `.wait`
    Waited,
    /// The trigger of a plan.
    Trigger(TriggerKind),
    /// A goal that is adopted.
    Adopted,
    /// Told, asked to be achieved; to one that is known, or to anybody.
    Sent { to: Option<String>, goal: bool, told: bool },
}

/// One place.
#[derive(Clone, Debug)]
pub struct Mention {
    pub key: Key,
    pub negated: bool,
    pub what: What,
    pub span: Span,
}

/// What declarations are about: a column of [`Survey::hints`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sort {
    Belief,
    Goal,
    Action,
}

/// All places of a program, in the order of the text.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    pub beliefs: Vec<Mention>,
    pub goals: Vec<Mention>,
    /// The actions of the environment, with the first place of each.
    pub actions: IndexMap<Key, Span>,
    /// What the arguments of beliefs, goals and actions are called: the first variable at each place.
    pub hints: IndexMap<(Sort, Key), Vec<Option<String>>>,
}

/// Looks at a program.
pub fn survey(program: &Program) -> Survey {
    let mut survey = Survey::default();
    for item in &program.items {
        match &item.kind {
            ItemKind::Belief(b) => survey.belief(b, What::Initial),
            ItemKind::Rule { head, body } => {
                survey.belief(head, What::Rule);
                survey.formula(body, false);
            }
            ItemKind::Goal(goal) => survey.goal_term(goal, What::Adopted),
            ItemKind::Plan(plan) => survey.plan(plan),
            ItemKind::Skipped(_) => {}
        }
    }
    survey
}

impl Survey {
    pub fn belief(&mut self, of: &Literal, what: What) {
        let (key, negated, span) = (of.key(), of.negated, of.span);
        self.hint(Sort::Belief, of);
        self.beliefs.push(Mention { key, negated, what, span });
    }

    fn hint(&mut self, sort: Sort, of: &Literal) {
        let hints = self.hints.entry((sort, of.key())).or_insert_with(|| vec![None; of.args.len()]);
        for (hint, arg) in hints.iter_mut().zip(&of.args) {
            if let (None, TermKind::Var { name, .. }) = (&hint, &arg.kind) {
                *hint = Some(name.clone());
            }
        }
    }

    pub fn goal(&mut self, of: &Literal, what: What) {
        self.hint(Sort::Goal, of);
        self.goals.push(Mention { key: of.key(), negated: false, what, span: of.span });
    }

    fn goal_term(&mut self, of: &Term, what: What) {
        if let TermKind::Literal(l) = &of.kind {
            self.goal(l, what);
        }
    }

    fn belief_term(&mut self, of: &Term, what: What) {
        if let TermKind::Literal(l) = &of.kind {
            self.belief(l, what);
        }
    }

    fn plan(&mut self, plan: &Plan) {
        let kind = plan.trigger.kind;
        if kind.is_goal() {
            self.goal_term(&plan.trigger.of, What::Trigger(kind));
        } else {
            self.belief_term(&plan.trigger.of, What::Trigger(kind));
        }
        if let Some(context) = &plan.context {
            self.formula(context, false);
        }
        each_step(&plan.body, &mut |step| self.step(step));
    }

    fn step(&mut self, step: &Step) {
        match &step.kind {
            StepKind::Achieve(t) | StepKind::Spawn(t) => self.goal_term(t, What::Adopted),
            StepKind::Query(t) | StepKind::Formula(t) => self.formula(t, false),
            StepKind::Add(t, adding) => self.belief_term(t, What::Added(*adding)),
            StepKind::Remove(t) => {
                let with_source = matches!(&t.kind, TermKind::Literal(l) if !l.annotations.is_empty());
                self.belief_term(t, What::Removed(with_source));
            }
            StepKind::Replace(t) => self.belief_term(t, What::Replaced),
            StepKind::Action(action) if action.is_internal() => self.internal(action),
            StepKind::Action(action) => {
                self.hint(Sort::Action, action);
                self.actions.entry(action.key()).or_insert(action.span);
            }
            StepKind::If { condition, .. }
            | StepKind::While { condition, .. }
            | StepKind::For { condition, .. } => {
                self.formula(condition, false);
            }
            StepKind::Fork { .. } | StepKind::Block(_) => {}
        }
    }

    fn formula(&mut self, of: &Term, waits: bool) {
        match &of.kind {
            TermKind::Literal(l) if l.is_internal() => self.internal(l),
            TermKind::Literal(l) => {
                let mut open = false;
                l.args
                    .iter()
                    .for_each(|a| each_term(a, &mut |t| open |= matches!(t.kind, TermKind::Var { .. })));
                self.belief(l, if waits { What::Waited } else { What::Tested(open) });
            }
            TermKind::Not(inner) => self.formula(inner, waits),
            TermKind::Binary { op: Op::And | Op::Or, left, right } => {
                self.formula(left, waits);
                self.formula(right, waits);
            }
            TermKind::Trigger(t) if waits => self.belief_term(&t.of, What::Waited),
            TermKind::Trigger(_)
            | TermKind::Binary { .. }
            | TermKind::Int(_)
            | TermKind::Float(_)
            | TermKind::Text(_)
            | TermKind::Bool(_)
            | TermKind::Any
            | TermKind::Var { .. }
            | TermKind::List { .. }
            | TermKind::Neg(_)
            | TermKind::Body(_)
            | TermKind::Plan => {}
        }
    }

    fn internal(&mut self, of: &Literal) {
        match (of.functor.as_str(), of.args.as_slice()) {
            (".send" | ".broadcast", _) => {
                let Ok(message) = message(of) else { return };
                let goal = performative(message.performative) == Some(true);
                let told = matches!(message.performative, "tell" | "achieve");
                let to = message.to.and_then(atom).map(str::to_owned);
                let what = What::Sent { to, goal, told };
                if goal {
                    self.goal_term(message.content, what)
                } else {
                    self.belief_term(message.content, what)
                }
            }
            (".findall" | ".setof", [_, formula, _]) | (".count", [formula, _]) => {
                self.formula(formula, false)
            }
            (".wait", [what, ..]) => self.formula(what, true),
            (".abolish", [belief]) => self.belief_term(belief, What::Removed(true)),
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
