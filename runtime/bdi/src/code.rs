//! Plans as lines of code: blocks become jumps.

use hrdsl_ir::{
    Expr, PlanBlock, Span,
    bdi::{AgentTerm, InternalAct, PlanContext, PlanStep, PlanStepKind},
};

/// What one line does.
#[derive(Clone, Debug)]
pub(crate) enum PlanOp<'p> {
    /// A step without blocks.
    Plain(&'p PlanStepKind),
    /// `if`: to the line if the condition has no answer
    Branch {
        condition: &'p PlanContext,
        otherwise: u16,
    },
    Jump(u16),
    /// `while`, before the first time: these variables are open again each time, if they are now
    Enter(Box<[u16]>),
    /// `while`: to the line behind if the condition has no answer
    While {
        condition: &'p PlanContext,
        end: u16,
    },
    /// `for`: all answers are taken
    For {
        condition: &'p PlanContext,
        variables: Box<[u16]>,
    },
    /// The next answer, or to the line behind.
    Next {
        end: u16,
    },
    /// Where branches begin, and where it goes on.
    Fork {
        branches: Box<[u16]>,
        all: bool,
        end: u16,
    },
    /// The end of a branch.
    Join,
}

/// One line of a plan's body.
#[derive(Clone, Debug)]
pub(crate) struct PlanLine<'p> {
    pub op: PlanOp<'p>,
    /// The line after it, jumps followed.
    pub after: u16,
    /// The place of the step in the body, with the steps of its blocks counted through.
    pub site: u16,
    pub origin: Span,
}

/// The body as lines; `None` if there are more than can be counted.
pub(crate) fn compile(body: &[PlanStep]) -> Option<Vec<PlanLine<'_>>> {
    let mut code = PlanCompiler { lines: Vec::new(), site: 0 };
    code.steps(body);
    let mut lines = code.lines;
    if lines.len() >= usize::from(u16::MAX) {
        return None;
    }
    for at in 0..lines.len() as u16 {
        lines[usize::from(at)].after = settle(&lines, at + 1);
    }
    Some(lines)
}

struct PlanCompiler<'p> {
    lines: Vec<PlanLine<'p>>,
    site: u16,
}

impl<'p> PlanCompiler<'p> {
    fn here(&self) -> u16 {
        u16::try_from(self.lines.len()).unwrap_or(u16::MAX)
    }

    fn line(&mut self, op: PlanOp<'p>, site: u16, origin: Span) -> usize {
        self.lines.push(PlanLine { op, after: 0, site, origin });
        self.lines.len() - 1
    }

    fn steps(&mut self, steps: &'p [PlanStep]) {
        steps.iter().for_each(|step| self.step(step));
    }

    fn step(&mut self, step: &'p PlanStep) {
        let (site, origin) = (self.site, step.origin);
        self.site = self.site.saturating_add(1);
        match step.kind.as_block() {
            Some(PlanBlock::If { condition, then, otherwise }) => {
                let test = self.line(PlanOp::Branch { condition, otherwise: 0 }, site, origin);
                self.steps(then);
                let skip = (!otherwise.is_empty()).then(|| self.line(PlanOp::Jump(0), site, origin));
                self.lines[test].op = PlanOp::Branch { condition, otherwise: self.here() };
                self.steps(otherwise);
                if let Some(skip) = skip {
                    self.lines[skip].op = PlanOp::Jump(self.here());
                }
            }
            Some(PlanBlock::While { condition, body }) => {
                self.line(PlanOp::Enter(variables(condition, body)), site, origin);
                let test = self.line(PlanOp::While { condition, end: 0 }, site, origin);
                self.steps(body);
                self.line(PlanOp::Jump(test as u16), site, origin);
                self.lines[test].op = PlanOp::While { condition, end: self.here() };
            }
            Some(PlanBlock::For { condition, body }) => {
                let variables = variables(condition, body);
                self.line(PlanOp::For { condition, variables }, site, origin);
                let next = self.line(PlanOp::Next { end: 0 }, site, origin);
                self.steps(body);
                self.line(PlanOp::Jump(next as u16), site, origin);
                self.lines[next].op = PlanOp::Next { end: self.here() };
            }
            Some(PlanBlock::Fork { branches, all }) => {
                let fork = self.line(PlanOp::Join, site, origin);
                let mut starts = Vec::new();
                for branch in branches {
                    starts.push(self.here());
                    self.steps(branch);
                    self.line(PlanOp::Join, site, origin);
                }
                let end = self.here();
                self.lines[fork].op = PlanOp::Fork { branches: starts.into(), all, end };
            }
            None => {
                self.line(PlanOp::Plain(&step.kind), site, origin);
            }
        }
    }
}

/// The line that is executed next at this one: jumps are followed.
pub(crate) fn settle(code: &[PlanLine], mut at: u16) -> u16 {
    while let Some(PlanLine { op: PlanOp::Jump(to), .. }) = code.get(usize::from(at)) {
        at = *to;
    }
    at
}

/// All variables that a loop's condition or body has.
fn variables(condition: &PlanContext, body: &[PlanStep]) -> Box<[u16]> {
    let mut found = Vec::new();
    let mut add = |v: u16| {
        if !found.contains(&v) {
            found.push(v);
        }
    };
    each_in_context(condition, &mut add);
    hrdsl_ir::bdi::each_step(body, &mut |step| each_in_step(&step.kind, &mut add));
    found.sort_unstable();
    found.into()
}

fn each_in_terms(terms: &[AgentTerm], f: &mut dyn FnMut(u16)) {
    terms.iter().for_each(|t| each_in_term(t, f));
}

/// Calls `f` with each variable of a term.
pub(crate) fn each_in_term(term: &AgentTerm, f: &mut dyn FnMut(u16)) {
    match term {
        AgentTerm::Any => {}
        AgentTerm::Var(v) => f(*v),
        AgentTerm::Expr(e) => e.each_var(f),
        AgentTerm::List(items, rest) => {
            each_in_terms(items, f);
            rest.iter().for_each(|r| each_in_term(r, f));
        }
    }
}

/// Calls `f` with each variable of a formula, also of those that are open outside.
pub(crate) fn each_in_context(context: &PlanContext, f: &mut dyn FnMut(u16)) {
    match context {
        PlanContext::True => {}
        PlanContext::Belief(literal) => {
            each_in_terms(&literal.args, f);
            literal.annotations.iter().for_each(|(_, t)| each_in_term(t, f));
        }
        PlanContext::Not(inner) => each_in_context(inner, f),
        PlanContext::And(all) | PlanContext::Or(all) => all.iter().for_each(|c| each_in_context(c, f)),
        PlanContext::Test(e) => e.each_var(f),
        PlanContext::Unify(term, e) => {
            each_in_term(term, f);
            e.each_var(f);
        }
        PlanContext::Internal(internal, _) => each_in_internal(internal, f),
    }
}

fn each_in_internal(internal: &InternalAct, f: &mut dyn FnMut(u16)) {
    match internal {
        InternalAct::FindAll { template, formula, out, .. } => {
            template.each_var(f);
            each_in_context(formula, f);
            each_in_term(out, f);
        }
        InternalAct::Count { formula, out } => {
            each_in_context(formula, f);
            each_in_term(out, f);
        }
        InternalAct::Member { element, list } => {
            each_in_term(element, f);
            list.each_var(f);
        }
        InternalAct::Apply { args, out, .. } => {
            args.iter().for_each(|a| a.each_var(f));
            each_in_term(out, f);
        }
        InternalAct::Holds { args, .. } => args.iter().for_each(|a| a.each_var(f)),
        InternalAct::Intend { args, .. }
        | InternalAct::Desire { args, .. }
        | InternalAct::Suspended { args, .. } => {
            each_in_terms(args, f);
        }
        InternalAct::Random { from, out } => {
            from.iter().for_each(|e| e.each_var(f));
            each_in_term(out, f);
        }
        InternalAct::Shuffle { list, out } => {
            list.each_var(f);
            each_in_term(out, f);
        }
        InternalAct::Time { out } | InternalAct::MyName { out } | InternalAct::AllNames { out } => {
            each_in_term(out, f)
        }
    }
}

/// Calls `f` with each variable of a step, but not of the steps in its blocks.
pub(crate) fn each_in_step(step: &PlanStepKind, f: &mut dyn FnMut(u16)) {
    let exprs = |all: &[Expr], f: &mut dyn FnMut(u16)| all.iter().for_each(|e| e.each_var(f));
    match step {
        PlanStepKind::Do { args, .. } | PlanStepKind::Spawn { args, .. } | PlanStepKind::Print { args } => {
            exprs(args, f)
        }
        PlanStepKind::Achieve { args, within, .. } => {
            exprs(args, f);
            within.iter().for_each(|e| e.each_var(f));
        }
        PlanStepKind::Query(literal) | PlanStepKind::Remove(literal) | PlanStepKind::Abolish(literal) => {
            each_in_terms(&literal.args, f);
            literal.annotations.iter().for_each(|(_, t)| each_in_term(t, f));
        }
        PlanStepKind::Add(assertion) | PlanStepKind::Replace(assertion) => {
            exprs(&assertion.args, f);
            assertion.annotations.iter().for_each(|(_, e)| e.each_var(f));
        }
        PlanStepKind::Test(condition)
        | PlanStepKind::If { condition, .. }
        | PlanStepKind::While { condition, .. }
        | PlanStepKind::For { condition, .. } => each_in_context(condition, f),
        PlanStepKind::Await { within, .. } => within.iter().for_each(|e| e.each_var(f)),
        PlanStepKind::Wait { seconds } => seconds.each_var(f),
        PlanStepKind::Send { to, args, annotations, .. } => {
            to.iter().for_each(|e| e.each_var(f));
            each_in_terms(args, f);
            annotations.iter().for_each(|(_, e)| e.each_var(f));
        }
        PlanStepKind::Ask { to, args, within, .. } => {
            to.each_var(f);
            each_in_terms(args, f);
            within.iter().for_each(|e| e.each_var(f));
        }
        PlanStepKind::AskAll { to, template, args, out, within, .. } => {
            to.each_var(f);
            template.each_var(f);
            each_in_terms(args, f);
            each_in_term(out, f);
            within.iter().for_each(|e| e.each_var(f));
        }
        PlanStepKind::Control { goal, .. } => goal.iter().for_each(|(_, args)| each_in_terms(args, f)),
        PlanStepKind::Fork { .. } | PlanStepKind::Fail => {}
    }
}
