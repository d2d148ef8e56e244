//! The steps of a plan.

use std::collections::BTreeSet;

use super::{
    super::{
        ast::{AgentSpeakStep, AgentSpeakStepKind, AgentSpeakTerm, TermKind, names_any},
        term::{literal, valued},
        types::AgentSpeakType,
    },
    clause::{BindingMode, ClauseFailure, ClauseResult, ClauseTranslator, call},
};

/// So many choices within each other have what comes after them in both branches: each doubles it.
const MOST_CONTINUED: usize = 5;

/// A line of a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlanBodyLine {
    Step(String),
    Comment(String),
}

/// Lines in braces.
pub fn block(lines: &[PlanBodyLine]) -> String {
    let short = lines.len() <= 3
        && lines.iter().all(|l| matches!(l, PlanBodyLine::Step(text) if !text.contains('\n')))
        && lines.iter().map(|l| if let PlanBodyLine::Step(t) = l { t.len() } else { 0 }).sum::<usize>() < 70;
    let last = lines.iter().rposition(|l| matches!(l, PlanBodyLine::Step(_)));
    let mut parts = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        match line {
            PlanBodyLine::Step(text) if Some(i) == last => parts.push(text.clone()),
            PlanBodyLine::Step(text) => parts.push(format!("{text};")),
            PlanBodyLine::Comment(text) => parts.push(text.clone()),
        }
    }
    if parts.is_empty() {
        "{ }".to_owned()
    } else if short {
        format!("{{ {} }}", parts.join(" "))
    } else {
        format!("{{\n{}\n}}", parts.join("\n"))
    }
}

/// What is asked first, as a step.
fn asked(text: String) -> String {
    if text.contains(" == ") && !text.starts_with('.') { format!("?({text})") } else { text }
}

impl ClauseTranslator<'_> {
    /// A body; what cannot be carried over is a comment, and goes into `out`.
    pub fn steps(
        &mut self,
        steps: &[AgentSpeakStep],
        out: &mut Vec<(hrdsl_source::Span, String)>,
    ) -> Vec<PlanBodyLine> {
        let mut lines = Vec::new();
        for (at, step) in steps.iter().enumerate() {
            if let AgentSpeakStepKind::Block(inner) = &step.kind {
                lines.extend(self.steps(inner, out));
                continue;
            }
            let before = (self.bound.clone(), self.used.clone(), self.remarks.len(), out.len());
            let written = match self.cx.left_out.get(&step.span) {
                Some(reason) => Err(ClauseFailure::Other(reason.clone())),
                None => self.before(step, &steps[at + 1..], out),
            };
            let first = std::mem::take(&mut self.first);
            match written {
                Ok((texts, is_end)) => {
                    lines.extend(first.into_iter().map(asked).map(PlanBodyLine::Step));
                    lines.extend(texts.into_iter().map(PlanBodyLine::Step));
                    if is_end {
                        break;
                    }
                }
                Err(stop) => {
                    self.remarks.truncate(before.2);
                    out.truncate(before.3);
                    (self.bound, self.used) = (before.0, before.1);
                    lines.push(PlanBodyLine::Comment(self.cx.system.comment(step.span, &stop.reason())));
                    out.push((step.span, stop.reason()));
                }
            }
        }
        lines
    }

    /// A step before others; `true`: they are in it. What one branch of a choice gives a value has it after the choice, if
    /// this branch was taken: then what comes after stands in both.
    fn before(
        &mut self,
        step: &AgentSpeakStep,
        rest: &[AgentSpeakStep],
        out: &mut Vec<(hrdsl_source::Span, String)>,
    ) -> ClauseResult<(Vec<String>, bool)> {
        let AgentSpeakStepKind::If { condition, then, otherwise } = &step.kind else {
            return Ok((self.step(step, out)?, false));
        };
        let before = (self.bound.clone(), self.used.clone(), self.remarks.len(), out.len());
        let (text, given) = self.choice(condition, then, otherwise, out)?;
        if self.continued >= MOST_CONTINUED || !names_any(rest, &given) {
            return Ok((vec![text], false));
        }
        self.remarks.truncate(before.2);
        out.truncate(before.3);
        (self.bound, self.used) = (before.0, before.1);
        self.first.clear();
        self.continued += 1;
        let both = self.choice(condition, &[then, rest].concat(), &[otherwise, rest].concat(), out);
        self.continued -= 1;
        Ok((vec![both?.0], true))
    }

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn step(
        &mut self,
        step: &AgentSpeakStep,
        out: &mut Vec<(hrdsl_source::Span, String)>,
    ) -> ClauseResult<Vec<String>> {
        let one = |text: String| Ok(vec![text]);
        match &step.kind {
            AgentSpeakStepKind::Achieve(of) | AgentSpeakStepKind::Spawn(of) => {
                let goal = literal(of)?;
                let sign = if matches!(step.kind, AgentSpeakStepKind::Achieve(_)) { "!" } else { "!!" };
                let text = if sign == "!" {
                    self.achieved(goal)?
                } else {
                    self.goal(goal, BindingMode::Value).map_err(|stop| match stop {
                        ClauseFailure::Unbound(name) if name != "_" => ClauseFailure::Other(format!(
                            "`{name}` has no value here, and nobody waits for the goal to give it one"
                        )),
                        other => other,
                    })?
                };
                self.used.adopted.insert(goal.key());
                let deadline = goal.annotations.iter().find_map(|a| match valued(a) {
                    Some(("hard_deadline", time)) if sign == "!" => Some(time),
                    Some(_) | None => None,
                });
                match deadline.map(|time| self.milliseconds(time)).transpose()? {
                    Some(time) => one(format!("{sign}{text} within {time}")),
                    None => one(format!("{sign}{text}")),
                }
            }
            AgentSpeakStepKind::Query(of) => match &of.kind {
                TermKind::Literal(l) if !l.is_internal() => {
                    let text = self.belief(l, BindingMode::Pattern)?;
                    one(format!("?{text}"))
                }
                _ => self.test(of),
            },
            AgentSpeakStepKind::Formula(of) => self.test(of),
            AgentSpeakStepKind::Add(of, _) => {
                let text = self.held(of, BindingMode::Value)?;
                one(format!("+{text}"))
            }
            AgentSpeakStepKind::Replace(of) => {
                let text = self.held(of, BindingMode::Value)?;
                one(format!("-+{text}"))
            }
            AgentSpeakStepKind::Remove(of) => {
                let text = self.held(of, BindingMode::Pattern)?;
                one(format!("-{text}"))
            }
            AgentSpeakStepKind::Action(action) if action.is_internal() => {
                self.internal_step(action, step.span, out)
            }
            AgentSpeakStepKind::Action(action) => {
                let key = action.key();
                let args = self.action_args(&action.args)?;
                let name = self.cx.names.actions.get(&(self.agent.to_owned(), key.clone())).cloned();
                self.used.actions.insert(key);
                if !action.annotations.is_empty() {
                    self.remarks.push((action.span, "an action's annotations are dropped".to_owned()));
                }
                one(call(&name.ok_or_else(|| ClauseFailure::from("the action has no name"))?, &args))
            }
            AgentSpeakStepKind::If { condition, then, otherwise } => {
                one(self.choice(condition, then, otherwise, out)?.0)
            }
            AgentSpeakStepKind::While { condition, body } | AgentSpeakStepKind::For { condition, body } => {
                let word =
                    if matches!(step.kind, AgentSpeakStepKind::While { .. }) { "while" } else { "for" };
                let before = self.bound.clone();
                let condition = self.formula(condition).map(|c| c.text);
                let body = if condition.is_ok() { self.steps(body, out) } else { Vec::new() };
                self.bound = before;
                one(format!("{word} {} {}", condition?, block(&body)))
            }
            AgentSpeakStepKind::Fork { branches, all } => {
                one(self.fork(branches.iter().map(Vec::as_slice), *all, out))
            }
            // What is in it stands for itself.
            AgentSpeakStepKind::Block(_) => Ok(Vec::new()),
        }
    }

    /// The arguments of an action of the environment: a stimulus has no lists, and of strings those that the programs have.
    fn action_args(&mut self, terms: &[AgentSpeakTerm]) -> ClauseResult<Vec<String>> {
        let mut args = Vec::new();
        for term in terms {
            let id = self.type_of(term)?;
            if self.cx.types.alternatives(id).is_some() {
                let message = "values of several types: the action has a tag and the parts of all of them";
                self.remarks.push((term.span, message.to_owned()));
            }
            let leaves = self.cx.types.leaves(id);
            for (value, leaf) in self.values(term, BindingMode::Value)?.into_iter().zip(leaves) {
                if let Some(texts) = self.cx.names.texts_of(self.cx.types, leaf) {
                    args.push(texts.expr(&value));
                    if !value.starts_with('"') {
                        let other = &texts.other;
                        let message =
                            format!("a string that stands nowhere in the programs becomes `{other}` here");
                        self.remarks.push((term.span, message));
                    }
                } else if self.cx.types.is_for_agents(leaf) {
                    let message = "only agents know lists, and strings that are computed: this argument of the action is dropped";
                    self.remarks.push((term.span, message.to_owned()));
                } else {
                    args.push(value);
                }
            }
        }
        Ok(args)
    }

    /// A choice, and which variables only one of its branches gives a value.
    fn choice(
        &mut self,
        condition: &AgentSpeakTerm,
        then: &[AgentSpeakStep],
        otherwise: &[AgentSpeakStep],
        out: &mut Vec<(hrdsl_source::Span, String)>,
    ) -> ClauseResult<(String, BTreeSet<String>)> {
        let before = self.bound.clone();
        let condition = match self.formula(condition) {
            Ok(piece) => piece.text,
            Err(stop) => {
                self.bound = before;
                return Err(stop);
            }
        };
        let then = block(&self.steps(then, out));
        let after = std::mem::replace(&mut self.bound, before);
        let mut inner = BTreeSet::new();
        let otherwise = match otherwise {
            [] => String::new(),
            [AgentSpeakStep { kind: AgentSpeakStepKind::If { condition, then, otherwise }, .. }] => {
                let (text, given) = self.choice(condition, then, otherwise, out)?;
                inner = given;
                format!(" else {text}")
            }
            steps => format!(" else {}", block(&self.steps(steps, out))),
        };
        let one: BTreeSet<String> = self.bound.symmetric_difference(&after).cloned().chain(inner).collect();
        self.bound = self.bound.intersection(&after).cloned().collect();
        Ok((format!("if {condition} {then}{otherwise}"), &one - &self.bound))
    }

    pub fn fork<'s>(
        &mut self,
        branches: impl Iterator<Item = &'s [AgentSpeakStep]>,
        all: bool,
        out: &mut Vec<(hrdsl_source::Span, String)>,
    ) -> String {
        let before = self.bound.clone();
        let mut blocks = Vec::new();
        for branch in branches {
            blocks.push(block(&self.steps(branch, out)));
            self.bound.clone_from(&before);
        }
        format!("fork {}", blocks.join(if all { " and " } else { " or " }))
    }

    /// A formula as a step.
    fn test(&mut self, of: &AgentSpeakTerm) -> ClauseResult<Vec<String>> {
        if matches!(of.kind, TermKind::Bool(true)) {
            return Ok(Vec::new());
        }
        let text = self.formula(of)?.text;
        let named = text.split_once(" = ").is_some_and(|(l, r)| {
            l.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
                && l != "_"
                && !r.contains(" && ")
                && !r.contains(" = ")
        });
        let plain = named && matches!(of.kind, TermKind::Binary { .. });
        Ok(vec![if plain { text } else { format!("?({text})") }])
    }

    /// The belief that is added or removed; a variable that holds a structure is the belief of that name.
    fn held(&mut self, of: &AgentSpeakTerm, want: BindingMode) -> ClauseResult<String> {
        let TermKind::Var { .. } = &of.kind else { return self.belief(literal(of)?, want) };
        let id = self.type_of(of)?;
        let AgentSpeakType::Struct(functor, args) = self.cx.types.get(id).clone() else {
            return Err("this is no belief".into());
        };
        let key = (functor, args.len());
        let values = self.values(of, BindingMode::Value)?;
        self.used.beliefs.insert(key.clone());
        Ok(call(&self.cx.names.beliefs[&key], &values))
    }
}
