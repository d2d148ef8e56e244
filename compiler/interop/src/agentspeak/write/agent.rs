//! One agent's members: facts, rules, goals, plans.

use hrdsl_source::Span;
use indexmap::{IndexMap, IndexSet};

use super::{
    clause::{
        ATOM, BindingMode, ClauseContext, ClauseFailure, ClauseFragment, ClauseResult, ClauseTranslator,
        PredicateUsage,
    },
    modes::TranslatedRules,
    steps::block,
    wanted::WantedArguments,
};
use crate::agentspeak::{
    alternatives::AlternativeSort,
    ast::{
        AgentSpeakItem, AgentSpeakItemKind, AgentSpeakLiteral, AgentSpeakPlan, AgentSpeakProgram,
        AgentSpeakTerm, AgentSpeakTriggerKind, PredicateIndicator, TermKind,
    },
    names::{ident, unused},
    system::AgentSpeakAgent,
    term::{literal, valued},
};

/// What is to be written of an agent.
pub struct TranslatedAgent {
    pub name: String,
    /// The initial beliefs of each name.
    pub facts: IndexMap<PredicateIndicator, Vec<String>>,
    /// Comments on those that are left out.
    pub no_facts: String,
    pub rules: String,
    /// Rules that stand before all facts of their name.
    pub early_rules: String,
    pub goals: String,
    pub plans: String,
    pub used: PredicateUsage,
    pub left_out: Vec<(Span, String)>,
    pub remarks: Vec<(Span, String)>,
    /// Plans for goals that need an argument which is open somewhere, with their goals.
    pub needing: Vec<(Span, PredicateIndicator)>,
    labels: IndexSet<String>,
}

/// Writes the members of an agent.
pub fn agent(
    cx: &ClauseContext<'_>,
    entry: &AgentSpeakAgent,
    program: &AgentSpeakProgram,
    rules: &TranslatedRules,
) -> TranslatedAgent {
    let mut agent = TranslatedAgent {
        name: entry.name.clone(),
        facts: IndexMap::new(),
        no_facts: String::new(),
        rules: String::new(),
        early_rules: String::new(),
        goals: String::new(),
        plans: String::new(),
        used: PredicateUsage::default(),
        left_out: Vec::new(),
        remarks: Vec::new(),
        needing: Vec::new(),
        labels: IndexSet::new(),
    };
    for belief in &entry.beliefs {
        agent.fact(cx, belief, belief.span);
    }
    for item in &program.items {
        agent.item(cx, item, rules);
    }
    for goal in &entry.goals {
        agent.goal(cx, goal, goal.span);
    }
    agent
}

impl TranslatedAgent {
    fn item(&mut self, cx: &ClauseContext<'_>, item: &AgentSpeakItem, rules: &TranslatedRules) {
        match &item.kind {
            AgentSpeakItemKind::Belief(belief) if !rules.contains_key(&item.span) => {
                self.fact(cx, belief, item.span)
            }
            AgentSpeakItemKind::Belief(_) | AgentSpeakItemKind::Rule { .. } => match rules.get(&item.span) {
                Some(Ok((text, used))) => {
                    let head = match &item.kind {
                        AgentSpeakItemKind::Belief(head) | AgentSpeakItemKind::Rule { head, .. } => {
                            Some(head)
                        }
                        AgentSpeakItemKind::Goal(_)
                        | AgentSpeakItemKind::Plan(_)
                        | AgentSpeakItemKind::Skipped(_)
                        | AgentSpeakItemKind::Broken(_) => None,
                    };
                    let facts_before = head.is_some_and(|h| self.facts.contains_key(&h.key()));
                    let rules = if facts_before { &mut self.rules } else { &mut self.early_rules };
                    *rules += &format!("{text}\n");
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
            AgentSpeakItemKind::Goal(goal) => match literal(goal) {
                Ok(of) => self.goal(cx, of, item.span),
                Err(reason) => {
                    let comment = self.leave(cx, item.span, &reason);
                    self.goals += &comment;
                }
            },
            AgentSpeakItemKind::Plan(plan) => self.plan(cx, plan, item.span),
            AgentSpeakItemKind::Broken(message) => {
                let comment = self.leave(cx, item.span, message);
                self.plans += &comment;
            }
            AgentSpeakItemKind::Skipped(message) => self.remarks.push((item.span, message.clone())),
        }
    }

    /// A comment on what is left out.
    fn leave(&mut self, cx: &ClauseContext<'_>, span: Span, reason: &str) -> String {
        self.left_out.push((span, reason.to_owned()));
        cx.system.comment(span, reason) + "\n"
    }

    /// Writes something alone; if it cannot be written, nothing of it stays.
    fn alone(
        &mut self,
        cx: &ClauseContext<'_>,
        span: Span,
        write: impl FnOnce(&mut ClauseTranslator<'_>) -> ClauseResult<String>,
    ) -> Result<String, String> {
        if let Some(reason) = cx.left_out.get(&span) {
            return Err(self.leave(cx, span, reason));
        }
        let name = self.name.clone();
        let mut clause = ClauseTranslator::new(cx, &name, self.used.clone());
        let written = write(&mut clause);
        match written.and_then(|text| clause.asks_nothing_first().map(|()| text)) {
            Ok(text) => {
                self.used = clause.used;
                self.remarks.extend(clause.remarks);
                Ok(text)
            }
            Err(stop) => Err(self.leave(cx, span, &stop.reason())),
        }
    }

    fn fact(&mut self, cx: &ClauseContext<'_>, belief: &AgentSpeakLiteral, span: Span) {
        match self.alone(cx, span, |c| c.belief(belief, BindingMode::Value)) {
            Ok(text) => self.facts.entry(belief.key()).or_default().push(text),
            Err(comment) => self.no_facts += &comment,
        }
    }

    fn goal(&mut self, cx: &ClauseContext<'_>, goal: &AgentSpeakLiteral, span: Span) {
        match self.alone(cx, span, |c| c.goal(goal, BindingMode::Value)) {
            Ok(text) => {
                self.used.adopted.insert(goal.key());
                self.goals += &format!("goal !{text}\n");
            }
            Err(comment) => self.goals += &comment,
        }
    }

    fn plan(&mut self, cx: &ClauseContext<'_>, plan: &AgentSpeakPlan, span: Span) {
        let mut left_out = Vec::new();
        let label = self.label(plan);
        let written = self.alone(cx, span, |c| {
            let head = head(c, plan)?;
            let mut lines = c.steps(&plan.body, &mut left_out);
            c.close(plan, &mut lines);
            Ok(format!("plan {label}{head} {}\n", block(&lines)))
        });
        self.look_for_needs(cx, plan, span, written.as_ref().map_or(usize::MAX, |_| left_out.len()));
        match written {
            Ok(text) => {
                self.plans += &text;
                self.left_out.extend(left_out);
                if let Ok(of) = literal(&plan.trigger.of) {
                    match plan.trigger.kind {
                        AgentSpeakTriggerKind::Achieve => self.used.planned.insert(of.key()),
                        // What can fail must have a plan to fail in.
                        AgentSpeakTriggerKind::Failed => self.used.adopted.insert(of.key()),
                        AgentSpeakTriggerKind::Added
                        | AgentSpeakTriggerKind::Removed
                        | AgentSpeakTriggerKind::Test
                        | AgentSpeakTriggerKind::TestFailed
                        | AgentSpeakTriggerKind::State => false,
                    };
                }
                self.label_remarks(plan);
            }
            Err(comment) => self.plans += &comment,
        }
    }

    /// Whether more of the plan could be written, if its arguments had values from the start.
    fn look_for_needs(&mut self, cx: &ClauseContext<'_>, plan: &AgentSpeakPlan, span: Span, without: usize) {
        let Ok(of) = literal(&plan.trigger.of) else { return };
        let is_wanted = cx.wanted.get(&of.key()).is_some_and(|all| all.values().any(|a| a.needed.is_none()));
        if without == 0 || !plan.trigger.kind.is_goal() || !is_wanted || cx.left_out.contains_key(&span) {
            return;
        }
        let wanted = WantedArguments::new();
        let given = ClauseContext { wanted: &wanted, ..*cx };
        let name = self.name.clone();
        let mut clause = ClauseTranslator::new(&given, &name, self.used.clone());
        let mut left_out = Vec::new();
        if head(&mut clause, plan).is_ok() {
            clause.steps(&plan.body, &mut left_out);
            if left_out.len() < without {
                self.needing.push((span, of.key()));
            }
        }
    }

    /// `@label[atomic]`, once.
    fn label(&mut self, plan: &AgentSpeakPlan) -> String {
        let is_atomic = |t: &AgentSpeakTerm| matches!(&t.kind, TermKind::Literal(l) if l.functor == "atomic" && l.args.is_empty());
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

    fn label_remarks(&mut self, plan: &AgentSpeakPlan) {
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
fn head(clause: &mut ClauseTranslator<'_>, plan: &AgentSpeakPlan) -> ClauseResult<String> {
    let of = literal(&plan.trigger.of)?;
    let trigger = if plan.trigger.kind.is_goal() {
        let plain = failure(clause, plan.trigger.kind, of);
        let text = clause.goal(&plain, BindingMode::Pattern)?;
        clause.open(of);
        text
    } else {
        // A trigger is matched with what happened; that a rule needs a value there does not matter.
        let inputs = IndexMap::new();
        let cx = ClauseContext { inputs: &inputs, ..*clause.cx };
        let mut own = ClauseTranslator::new(&cx, clause.agent, clause.used.clone());
        let text = own.belief(of, BindingMode::Pattern)?;
        clause.used = own.used;
        clause.remarks.extend(own.remarks);
        // The same once more, so that the variables have their values and names here.
        for arg in &of.args {
            clause.values(arg, BindingMode::Pattern)?;
        }
        for annotation in &of.annotations {
            if let Some((name, value)) = valued(annotation) {
                if name == "source" {
                    clause.part(value, BindingMode::Pattern, &AlternativeSort::Atom)?;
                } else {
                    clause.values(value, BindingMode::Pattern)?;
                }
            }
        }
        text
    };
    let sign = plan.trigger.kind.sign();
    let first = std::mem::take(&mut clause.first);
    let mut parts: Vec<ClauseFragment> =
        first.into_iter().map(|text| ClauseFragment::new(text, ATOM)).collect();
    if let Some(context) = &plan.context
        && !matches!(context.kind, TermKind::Bool(true))
    {
        parts.push(clause.formula(context).map_err(unbound)?);
    }
    let context =
        if parts.is_empty() { String::new() } else { format!(" when {}", ClauseFragment::all(parts).text) };
    Ok(format!("{sign}{trigger}{context}"))
}

/// A failure plan's annotations say how it failed: a scenario has one sort of failure.
fn failure(
    clause: &mut ClauseTranslator<'_>,
    kind: AgentSpeakTriggerKind,
    of: &AgentSpeakLiteral,
) -> AgentSpeakLiteral {
    let keep = |t: &AgentSpeakTerm| matches!(valued(t), Some(("source", _)));
    if kind == AgentSpeakTriggerKind::Failed
        && let Some(annotation) = of.annotations.iter().find(|t| !keep(t))
    {
        let message = "the plan is for failures of all sorts: hrdsl does not tell them apart".to_owned();
        clause.remarks.push((annotation.span, message));
        let annotations = of.annotations.iter().filter(|t| keep(t)).cloned().collect();
        return AgentSpeakLiteral { annotations, ..of.clone() };
    }
    of.clone()
}

fn unbound(stop: ClauseFailure) -> ClauseFailure {
    match stop {
        ClauseFailure::Unbound(name) if name != "_" => {
            ClauseFailure::Other(format!("`{name}` has no value here, and one is needed"))
        }
        other => other,
    }
}
