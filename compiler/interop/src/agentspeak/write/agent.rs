//! One agent's members: facts, rules, goals, plans.

use hrdsl_source::Span;
use indexmap::{IndexMap, IndexSet};

use super::{
    clause::{Clause, Context, Stop, Usage, Want, Written},
    modes::Rules,
    steps::block,
};
use crate::agentspeak::{
    ast::{Item, ItemKind, Key, Literal, Plan, Program, Term, TermKind, TriggerKind},
    names::{ident, unused},
    system::Entry,
    term::{literal, valued},
};

/// What is to be written of an agent.
pub struct Agent {
    pub name: String,
    /// The initial beliefs of each name.
    pub facts: IndexMap<Key, Vec<String>>,
    /// Comments on those that are left out.
    pub no_facts: String,
    pub rules: String,
    pub goals: String,
    pub plans: String,
    pub used: Usage,
    pub left_out: Vec<(Span, String)>,
    pub remarks: Vec<(Span, String)>,
    labels: IndexSet<String>,
}

/// Writes the members of an agent.
pub fn agent(cx: &Context<'_>, entry: &Entry, program: &Program, rules: Rules) -> Agent {
    let mut agent = Agent {
        name: entry.name.clone(),
        facts: IndexMap::new(),
        no_facts: String::new(),
        rules: String::new(),
        goals: String::new(),
        plans: String::new(),
        used: Usage::default(),
        left_out: Vec::new(),
        remarks: Vec::new(),
        labels: IndexSet::new(),
    };
    for belief in &entry.beliefs {
        agent.fact(cx, belief, belief.span);
    }
    for item in &program.items {
        agent.item(cx, item, &rules);
    }
    for goal in &entry.goals {
        agent.goal(cx, goal, goal.span);
    }
    agent
}

impl Agent {
    fn item(&mut self, cx: &Context<'_>, item: &Item, rules: &Rules) {
        match &item.kind {
            ItemKind::Belief(belief) if !rules.contains_key(&item.span) => self.fact(cx, belief, item.span),
            ItemKind::Belief(_) | ItemKind::Rule { .. } => match rules.get(&item.span) {
                Some(Ok((text, used))) => {
                    self.rules += &format!("{text}\n");
                    self.used.beliefs.extend(used.beliefs.iter().cloned());
                    self.used.annotations.extend(used.annotations.iter().cloned());
                    self.used.adopted.extend(used.adopted.iter().cloned());
                    self.used.between |= used.between;
                }
                Some(Err(reason)) => {
                    let comment = self.leave(cx, item.span, reason);
                    self.rules += &comment;
                }
                None => {}
            },
            ItemKind::Goal(goal) => match literal(goal) {
                Ok(of) => self.goal(cx, of, item.span),
                Err(reason) => {
                    let comment = self.leave(cx, item.span, &reason);
                    self.goals += &comment;
                }
            },
            ItemKind::Plan(plan) => self.plan(cx, plan, item.span),
            ItemKind::Skipped(message) => self.remarks.push((item.span, message.clone())),
        }
    }

    /// A comment on what is left out.
    fn leave(&mut self, cx: &Context<'_>, span: Span, reason: &str) -> String {
        self.left_out.push((span, reason.to_owned()));
        cx.system.comment(span, reason) + "\n"
    }

    /// Writes something alone; if it cannot be written, nothing of it stays.
    fn alone(
        &mut self,
        cx: &Context<'_>,
        span: Span,
        write: impl FnOnce(&mut Clause<'_>) -> Written<String>,
    ) -> Result<String, String> {
        if let Some(reason) = cx.left_out.get(&span) {
            return Err(self.leave(cx, span, reason));
        }
        let name = self.name.clone();
        let mut clause = Clause::new(cx, &name, self.used.clone());
        match write(&mut clause) {
            Ok(text) => {
                self.used = clause.used;
                self.remarks.extend(clause.remarks);
                Ok(text)
            }
            Err(stop) => Err(self.leave(cx, span, &stop.reason())),
        }
    }

    fn fact(&mut self, cx: &Context<'_>, belief: &Literal, span: Span) {
        match self.alone(cx, span, |c| c.belief(belief, Want::Value)) {
            Ok(text) => self.facts.entry(belief.key()).or_default().push(text),
            Err(comment) => self.no_facts += &comment,
        }
    }

    fn goal(&mut self, cx: &Context<'_>, goal: &Literal, span: Span) {
        match self.alone(cx, span, |c| c.goal(goal, Want::Value)) {
            Ok(text) => {
                self.used.adopted.insert(goal.key());
                self.goals += &format!("goal !{text}\n");
            }
            Err(comment) => self.goals += &comment,
        }
    }

    fn plan(&mut self, cx: &Context<'_>, plan: &Plan, span: Span) {
        let mut left_out = Vec::new();
        let label = self.label(plan);
        let written = self.alone(cx, span, |c| {
            let head = head(c, plan)?;
            let lines = c.steps(&plan.body, &mut left_out);
            Ok(format!("plan {label}{head} {}\n", block(&lines)))
        });
        match written {
            Ok(text) => {
                self.plans += &text;
                self.left_out.extend(left_out);
                if let Ok(of) = literal(&plan.trigger.of) {
                    match plan.trigger.kind {
                        TriggerKind::Achieve => self.used.planned.insert(of.key()),
                        // What can fail must have a plan to fail in.
                        TriggerKind::Failed => self.used.adopted.insert(of.key()),
                        TriggerKind::Added
                        | TriggerKind::Removed
                        | TriggerKind::Test
                        | TriggerKind::TestFailed
                        | TriggerKind::State => false,
                    };
                }
                self.label_remarks(plan);
            }
            Err(comment) => self.plans += &comment,
        }
    }

    /// `@label[atomic]`, once.
    fn label(&mut self, plan: &Plan) -> String {
        let is_atomic =
            |t: &Term| matches!(&t.kind, TermKind::Literal(l) if l.functor == "atomic" && l.args.is_empty());
        let atomic = if plan.annotations.iter().any(is_atomic) { "[atomic]" } else { "" };
        let wanted = match (&plan.label, atomic.is_empty()) {
            (Some(label), _) => ident(label),
            (None, false) => "atomic".to_owned(),
            (None, true) => return String::new(),
        };
        let name = unused(wanted, &self.labels);
        self.labels.insert(name.clone());
        format!("@{name}{atomic} ")
    }

    fn label_remarks(&mut self, plan: &Plan) {
        for annotation in &plan.annotations {
            let text = match &annotation.kind {
                TermKind::Literal(l) if l.functor != "atomic" => l.functor.clone(),
                _ => continue,
            };
            // Where a plan came from says nothing about what it does.
            if !matches!(text.as_str(), "source" | "url") {
                self.remarks.push((
                    annotation.span,
                    format!("the label's `{text}` is dropped: hrdsl knows `atomic` only"),
                ));
            }
        }
    }
}

/// The trigger and the context.
fn head(clause: &mut Clause<'_>, plan: &Plan) -> Written<String> {
    let of = literal(&plan.trigger.of)?;
    let trigger = if plan.trigger.kind.is_goal() {
        let plain = failure(clause, plan.trigger.kind, of);
        clause.goal(&plain, Want::Pattern)?
    } else {
        // A trigger is matched with what happened; that a rule needs a value there does not matter.
        let inputs = IndexMap::new();
        let cx = Context { inputs: &inputs, ..*clause.cx };
        let mut own = Clause::new(&cx, clause.agent, clause.used.clone());
        let text = own.belief(of, Want::Pattern)?;
        clause.used = own.used;
        clause.remarks.extend(own.remarks);
        // The same once more, so that the variables have their values and names here.
        for arg in &of.args {
            clause.values(arg, Want::Pattern)?;
        }
        for annotation in &of.annotations {
            if let Some((_, value)) = valued(annotation) {
                clause.values(value, Want::Pattern)?;
            }
        }
        text
    };
    let sign = plan.trigger.kind.sign();
    let context = match &plan.context {
        None => String::new(),
        Some(context) if matches!(context.kind, TermKind::Bool(true)) => String::new(),
        Some(context) => format!(" when {}", clause.formula(context).map_err(unbound)?.text),
    };
    Ok(format!("{sign}{trigger}{context}"))
}

/// A failure plan's annotations say how it failed: a scenario has one sort of failure.
fn failure(clause: &mut Clause<'_>, kind: TriggerKind, of: &Literal) -> Literal {
    let keep = |t: &Term| matches!(valued(t), Some(("source", _)));
    if kind == TriggerKind::Failed
        && let Some(annotation) = of.annotations.iter().find(|t| !keep(t))
    {
        let message = "the plan is for failures of all sorts: hrdsl does not tell them apart".to_owned();
        clause.remarks.push((annotation.span, message));
        let annotations = of.annotations.iter().filter(|t| keep(t)).cloned().collect();
        return Literal { annotations, ..of.clone() };
    }
    of.clone()
}

fn unbound(stop: Stop) -> Stop {
    match stop {
        Stop::Unbound(name) if name != "_" => Stop::Other(format!(
            "`{name}` has no value here: in Jason the comparison is never true, and the plan never selected; in hrdsl it is an error"
        )),
        other => other,
    }
}
