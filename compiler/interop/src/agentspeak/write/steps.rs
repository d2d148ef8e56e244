//! The steps of a plan.

use super::{
    super::{
        ast::{Step, StepKind, Term, TermKind},
        term::literal,
        types::Ty,
    },
    clause::{Clause, Stop, Want, Written, call},
};

/// A line of a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Line {
    Step(String),
    Comment(String),
}

/// Lines in braces.
pub fn block(lines: &[Line]) -> String {
    let short = lines.len() <= 3
        && lines.iter().all(|l| matches!(l, Line::Step(text) if !text.contains('\n')))
        && lines.iter().map(|l| if let Line::Step(t) = l { t.len() } else { 0 }).sum::<usize>() < 70;
    let last = lines.iter().rposition(|l| matches!(l, Line::Step(_)));
    let mut parts = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        match line {
            Line::Step(text) if Some(i) == last => parts.push(text.clone()),
            Line::Step(text) => parts.push(format!("{text};")),
            Line::Comment(text) => parts.push(text.clone()),
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

impl Clause<'_> {
    /// A body; what cannot be carried over is a comment, and goes into `out`.
    pub fn steps(&mut self, steps: &[Step], out: &mut Vec<(hrdsl_source::Span, String)>) -> Vec<Line> {
        let mut lines = Vec::new();
        for step in steps {
            if let StepKind::Block(inner) = &step.kind {
                lines.extend(self.steps(inner, out));
                continue;
            }
            let before = (self.bound.clone(), self.used.clone(), self.remarks.len(), out.len());
            let written = match self.cx.left_out.get(&step.span) {
                Some(reason) => Err(Stop::Other(reason.clone())),
                None => self.step(step, out),
            };
            match written {
                Ok(texts) => lines.extend(texts.into_iter().map(Line::Step)),
                Err(stop) => {
                    self.remarks.truncate(before.2);
                    out.truncate(before.3);
                    (self.bound, self.used) = (before.0, before.1);
                    if let Some(failing) = self.never(step, &stop) {
                        lines.push(Line::Step(failing));
                        continue;
                    }
                    lines.push(Line::Comment(self.cx.system.comment(step.span, &stop.reason())));
                    out.push((step.span, stop.reason()));
                }
            }
        }
        lines
    }

    /// A comparison with a variable that has no value is never true: the step fails.
    fn never(&mut self, step: &Step, stop: &Stop) -> Option<String> {
        let (StepKind::Formula(of) | StepKind::Query(of)) = &step.kind else { return None };
        let (TermKind::Binary { op, .. }, Stop::Unbound(name)) = (&of.kind, stop) else { return None };
        if !op.is_relation() {
            return None;
        }
        let message =
            format!("`{name}` has no value here, so the comparison is never true, and the step always fails");
        self.remarks.push((step.span, message));
        Some(".fail".to_owned())
    }

    fn step(&mut self, step: &Step, out: &mut Vec<(hrdsl_source::Span, String)>) -> Written<Vec<String>> {
        let one = |text: String| Ok(vec![text]);
        match &step.kind {
            StepKind::Achieve(of) | StepKind::Spawn(of) => {
                let goal = literal(of)?;
                let text = self.goal(goal, Want::Value).map_err(|stop| match stop {
                    Stop::Unbound(name) if name != "_" => Stop::Other(format!(
                        "`{name}` has no value here, and a goal gives none back: use a test goal, `?{}(…)`",
                        goal.functor
                    )),
                    other => other,
                })?;
                self.used.adopted.insert(goal.key());
                let sign = if matches!(step.kind, StepKind::Achieve(_)) { "!" } else { "!!" };
                one(format!("{sign}{text}"))
            }
            StepKind::Query(of) => match &of.kind {
                TermKind::Literal(l) if !l.is_internal() => {
                    let text = self.belief(l, Want::Pattern)?;
                    one(format!("?{text}"))
                }
                _ => self.test(of),
            },
            StepKind::Formula(of) => self.test(of),
            StepKind::Add(of, _) => {
                let text = self.held(of, Want::Value)?;
                one(format!("+{text}"))
            }
            StepKind::Replace(of) => {
                let text = self.held(of, Want::Value)?;
                one(format!("-+{text}"))
            }
            StepKind::Remove(of) => {
                let before = self.bound.clone();
                let text = self.held(of, Want::Pattern);
                self.bound = before;
                one(format!("-{}", text?))
            }
            StepKind::Action(action) if action.is_internal() => self.internal_step(action, step.span, out),
            StepKind::Action(action) => {
                let key = action.key();
                let args = self.action_args(&action.args)?;
                let name = self.cx.names.actions.get(&(self.agent.to_owned(), key.clone())).cloned();
                self.used.actions.insert(key);
                if !action.annotations.is_empty() {
                    self.remarks.push((action.span, "an action's annotations are dropped".to_owned()));
                }
                one(call(&name.ok_or_else(|| Stop::from("the action has no name"))?, &args))
            }
            StepKind::If { condition, then, otherwise } => one(self.choice(condition, then, otherwise, out)?),
            StepKind::While { condition, body } | StepKind::For { condition, body } => {
                let word = if matches!(step.kind, StepKind::While { .. }) { "while" } else { "for" };
                let before = self.bound.clone();
                let condition = self.formula(condition).map(|c| c.text);
                let body = if condition.is_ok() { self.steps(body, out) } else { Vec::new() };
                self.bound = before;
                one(format!("{word} {} {}", condition?, block(&body)))
            }
            StepKind::Fork { branches, all } => one(self.fork(branches.iter().map(Vec::as_slice), *all, out)),
            // What is in it stands for itself.
            StepKind::Block(_) => Ok(Vec::new()),
        }
    }

    /// The arguments of an action of the environment: a stimulus has no strings and lists.
    fn action_args(&mut self, terms: &[Term]) -> Written<Vec<String>> {
        let mut args = Vec::new();
        for term in terms {
            let leaves = self.cx.types.leaves(self.type_of(term)?);
            for (value, leaf) in self.values(term, Want::Value)?.into_iter().zip(leaves) {
                if self.cx.types.is_for_agents(leaf) {
                    let message =
                        "only agents know strings and lists: this argument of the action is dropped";
                    self.remarks.push((term.span, message.to_owned()));
                } else {
                    args.push(value);
                }
            }
        }
        Ok(args)
    }

    fn choice(
        &mut self,
        condition: &Term,
        then: &[Step],
        otherwise: &[Step],
        out: &mut Vec<(hrdsl_source::Span, String)>,
    ) -> Written<String> {
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
        let otherwise = match otherwise {
            [] => String::new(),
            [Step { kind: StepKind::If { condition, then, otherwise }, .. }] => {
                format!(" else {}", self.choice(condition, then, otherwise, out)?)
            }
            steps => format!(" else {}", block(&self.steps(steps, out))),
        };
        self.bound = self.bound.intersection(&after).cloned().collect();
        Ok(format!("if {condition} {then}{otherwise}"))
    }

    pub fn fork<'s>(
        &mut self,
        branches: impl Iterator<Item = &'s [Step]>,
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
    fn test(&mut self, of: &Term) -> Written<Vec<String>> {
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
    fn held(&mut self, of: &Term, want: Want) -> Written<String> {
        let TermKind::Var { .. } = &of.kind else { return self.belief(literal(of)?, want) };
        let id = self.type_of(of)?;
        let Ty::Struct(functor, args) = self.cx.types.get(id).clone() else {
            return Err("this is no belief".into());
        };
        let key = (functor, args.len());
        let values = self.values(of, Want::Value)?;
        self.used.beliefs.insert(key.clone());
        Ok(call(&self.cx.names.beliefs[&key], &values))
    }
}
