//! Formulas and steps as text: as they are written in the language, with values for variables.

use std::fmt::Display;

use hrdsl_ir::{
    ArgPattern, EventPattern, Expr, Nanos, Program, Value,
    bdi::{
        Agent, AgentTerm, Assertion, BeliefAnnotation, BeliefId, BeliefLiteral, ContentId, ControlAct,
        GoalId, InternalAct, Performative, PlanContext, PlanStepKind,
    },
    expr::{BinaryOp, NumberFunction, OperatorSort, UnaryOp},
    list::ListFunction,
    value::seconds,
};

use crate::unify::{VariableSlot, eval, known};

/// A name with its arguments, as in the language: `shows(1, true)`; a name alone without arguments.
pub(crate) fn call<T: Display>(name: &str, args: impl IntoIterator<Item = T>) -> String {
    let args: Vec<String> = args.into_iter().map(|a| a.to_string()).collect();
    if args.is_empty() { name.to_owned() } else { format!("{name}({})", args.join(", ")) }
}

/// A time as it is written: `12.5 s`
#[must_use]
pub fn time(time: Nanos) -> String {
    format!("{} s", seconds(time))
}

/// `_` for what has no value.
pub(crate) fn slot(slot: &VariableSlot) -> String {
    slot.map_or_else(|| "_".to_owned(), |v| v.to_string())
}

/// A performative as it is written.
pub(crate) fn performative(p: Performative) -> &'static str {
    match p {
        Performative::Tell => "tell",
        Performative::Untell => "untell",
        Performative::Achieve => "achieve",
        Performative::Unachieve => "unachieve",
        Performative::AskOne => "askOne",
        Performative::AskAll => "askAll",
    }
}

/// What an expression stands in, which says whether it needs parentheses.
#[derive(Clone, Copy)]
enum ParenContext {
    Nothing,
    /// `&&`, `||`, `not`
    Logical,
    Other,
}

/// Names of one agent's program, and the values of one plan's variables.
pub(crate) struct FormulaPrinter<'a> {
    pub program: &'a Program,
    pub agent: &'a Agent,
    pub names: &'a [String],
    pub slots: &'a [VariableSlot],
}

/// A formula as it is written in the language.
#[must_use]
pub fn context(program: &Program, agent: &Agent, names: &[String], of: &PlanContext) -> String {
    FormulaPrinter { program, agent, names, slots: &[] }.context(of)
}

/// A step as it is written in the language; of a block its head.
#[must_use]
pub fn step(program: &Program, agent: &Agent, names: &[String], of: &PlanStepKind) -> String {
    FormulaPrinter { program, agent, names, slots: &[] }.step(of)
}

impl FormulaPrinter<'_> {
    fn belief(&self, id: BeliefId) -> &str {
        &self.agent.belief(id).name
    }

    fn goal(&self, id: GoalId, args: impl IntoIterator<Item = String>) -> String {
        call(&self.agent.goal(id).name, args)
    }

    fn event(&self, id: hrdsl_ir::EventId, args: impl IntoIterator<Item = String>) -> String {
        call(&self.program.event(id).name, args)
    }

    fn content(&self, id: ContentId, args: &[AgentTerm]) -> String {
        call(&self.program.content(id).name, args.iter().map(|t| self.term(t)))
    }

    pub fn step(&self, step: &PlanStepKind) -> String {
        let exprs = |all: &[Expr]| all.iter().map(|e| self.expr(e)).collect::<Vec<_>>();
        let terms = |all: &[AgentTerm]| all.iter().map(|t| self.term(t)).collect::<Vec<_>>();
        let time = |e: &Expr| self.seconds(e);
        let within = |e: &Option<Expr>| e.as_ref().map_or(String::new(), |e| format!(" within {}", time(e)));
        let comma = |e: &Option<Expr>| e.as_ref().map_or(String::new(), |e| format!(", {}", time(e)));
        match step {
            PlanStepKind::Do { event, args } => self.event(*event, exprs(args)),
            PlanStepKind::Achieve { goal, args, within: d } => {
                format!("!{}{}", self.goal(*goal, exprs(args)), within(d))
            }
            PlanStepKind::Spawn { goal, args } => format!("!!{}", self.goal(*goal, exprs(args))),
            PlanStepKind::Query(literal) => format!("?{}", self.literal(literal)),
            PlanStepKind::Test(condition @ (PlanContext::Unify(..) | PlanContext::Internal(_, _))) => {
                self.context(condition)
            }
            PlanStepKind::Test(condition) => format!("?({})", self.context(condition)),
            PlanStepKind::Add(a) => format!("+{}", self.assertion(a)),
            PlanStepKind::Remove(literal) => format!("-{}", self.literal(literal)),
            PlanStepKind::Replace(a) => format!("-+{}", self.assertion(a)),
            PlanStepKind::Abolish(literal) => format!(".abolish({})", self.literal(literal)),
            PlanStepKind::Await { events, within: d } => {
                let events: Vec<String> = events.iter().map(|e| self.pattern(e)).collect();
                format!("await {}{}", events.join(" | "), within(d))
            }
            PlanStepKind::Wait { seconds } => format!("wait {}", time(seconds)),
            PlanStepKind::If { condition, .. } => format!("if {}", self.context(condition)),
            PlanStepKind::While { condition, .. } => format!("while {}", self.context(condition)),
            PlanStepKind::For { condition, .. } => format!("for {}", self.context(condition)),
            PlanStepKind::Fork { .. } => "fork".to_owned(),
            PlanStepKind::Send { to, performative: p, content, args, annotations } => {
                let what = self.content(*content, args) + &self.told(annotations);
                match to {
                    Some(to) => format!(".send({}, {}, {what})", self.expr(to), performative(*p)),
                    None => format!(".broadcast({}, {what})", performative(*p)),
                }
            }
            PlanStepKind::Ask { to, content, args, within } => {
                format!(".ask({}, {}{})", self.expr(to), self.content(*content, args), comma(within))
            }
            PlanStepKind::AskAll { to, template, content, args, out, within } => {
                let (to, template) = (self.expr(to), self.expr(template));
                let content = self.content(*content, args);
                format!(".ask_all({to}, {template}, {content}, {}{})", self.term(out), comma(within))
            }
            PlanStepKind::Print { args } => call(".print", exprs(args)),
            PlanStepKind::Control { what, goal } => {
                let name = control(*what, goal.is_some());
                call(name, goal.iter().map(|(g, args)| self.goal(*g, terms(args))))
            }
            PlanStepKind::Fail => ".fail".to_owned(),
        }
    }

    fn annotated(&self, belief: BeliefId, of: Vec<(BeliefAnnotation, String)>) -> String {
        if of.is_empty() {
            return String::new();
        }
        let declared = self.agent.belief(belief);
        let one = |(what, text): (BeliefAnnotation, String)| match what {
            BeliefAnnotation::Source => format!("source({text})"),
            BeliefAnnotation::Declared(at) => format!("{}({text})", declared.annotation(at).name),
        };
        let all: Vec<String> = of.into_iter().map(one).collect();
        format!("[{}]", all.join(", "))
    }

    /// The annotations of what is told.
    fn told(&self, of: &[(String, Expr)]) -> String {
        let all: Vec<String> = of.iter().map(|(name, e)| format!("{name}({})", self.expr(e))).collect();
        if all.is_empty() { String::new() } else { format!("[{}]", all.join(", ")) }
    }

    fn literal(&self, l: &BeliefLiteral) -> String {
        let fact = call(self.belief(l.belief), l.args.iter().map(|t| self.term(t)));
        let annotations = l.annotations.iter().map(|(what, t)| (*what, self.term(t))).collect();
        fact + &self.annotated(l.belief, annotations)
    }

    fn assertion(&self, a: &Assertion) -> String {
        let fact = call(self.belief(a.belief), a.args.iter().map(|e| self.expr(e)));
        let annotations = a.annotations.iter().map(|(what, e)| (*what, self.expr(e))).collect();
        fact + &self.annotated(a.belief, annotations)
    }

    fn pattern(&self, pattern: &EventPattern) -> String {
        if pattern.args.iter().all(|a| *a == ArgPattern::Any) {
            return self.event(pattern.event, []);
        }
        self.event(pattern.event, pattern.args.iter().map(ToString::to_string).collect::<Vec<_>>())
    }

    fn seconds(&self, e: &Expr) -> String {
        match eval(e, self.slots).ok().and_then(Value::as_f64) {
            Some(s) => format!("{s} s"),
            None => self.expr(e),
        }
    }

    fn name(&self, var: u16) -> String {
        self.names.get(usize::from(var)).cloned().unwrap_or_else(|| format!("V{var}"))
    }

    fn term(&self, term: &AgentTerm) -> String {
        let known = match term {
            AgentTerm::Any => None,
            AgentTerm::Var(v) => self.slots.get(usize::from(*v)).copied().flatten(),
            AgentTerm::Expr(e) => eval(e, self.slots).ok(),
            AgentTerm::List(..) if self.slots.is_empty() => None,
            AgentTerm::List(..) => known(term, self.slots),
        };
        match (known, term) {
            (Some(v), _) => v.to_string(),
            (None, AgentTerm::Any) => "_".to_owned(),
            (None, AgentTerm::Var(v)) => self.name(*v),
            (None, AgentTerm::Expr(e)) => self.expr(e),
            (None, AgentTerm::List(items, rest)) => {
                let items: Vec<String> = items.iter().map(|t| self.term(t)).collect();
                let rest = rest.as_ref().map_or(String::new(), |r| format!(" | {}", self.term(r)));
                format!("[{}{rest}]", items.join(", "))
            }
        }
    }

    /// The value; if there is none, the expression.
    fn expr(&self, e: &Expr) -> String {
        eval(e, self.slots).map_or_else(|_| self.expression(e, ParenContext::Nothing), |v| v.to_string())
    }

    /// The expression as it stands, with the values of the variables that have one.
    fn expression(&self, e: &Expr, within: ParenContext) -> String {
        match e {
            Expr::Const(v) => v.to_string(),
            Expr::Var(v) => self
                .slots
                .get(usize::from(*v))
                .copied()
                .flatten()
                .map_or_else(|| self.name(*v), |v| v.to_string()),
            Expr::Unary(UnaryOp::Not, a) => format!("not {}", self.expression(a, ParenContext::Logical)),
            Expr::Unary(UnaryOp::Neg, a) => format!("-{}", self.expression(a, ParenContext::Other)),
            Expr::Binary(op, a, b) => self.binary(*op, [a, b], within),
            Expr::If(c, a, b) => {
                format!("if {} {{ {} }} else {{ {} }}", self.expr(c), self.expr(a), self.expr(b))
            }
            Expr::Call(f, args) => call(function(*f), args.iter().map(|a| self.expr(a))),
            Expr::List(items, rest) => {
                let items: Vec<String> = items.iter().map(|i| self.expr(i)).collect();
                let rest = rest.as_ref().map_or(String::new(), |r| format!(" | {}", self.expr(r)));
                format!("[{}{rest}]", items.join(", "))
            }
            // Automata alone have these.
            Expr::Element(_) | Expr::Apply(..) => String::new(),
        }
    }

    fn binary(&self, op: BinaryOp, operands: [&Expr; 2], within: ParenContext) -> String {
        let logical = op.sort() == OperatorSort::Logic;
        let compared = matches!(op.sort(), OperatorSort::Equality | OperatorSort::Order);
        let here = if logical { ParenContext::Logical } else { ParenContext::Other };
        let [a, b] = operands.map(|e| if compared { self.expr(e) } else { self.expression(e, here) });
        let text = format!("{a} {} {b}", operator(op));
        let parenthesised = match within {
            ParenContext::Nothing => false,
            ParenContext::Logical => !compared,
            ParenContext::Other => true,
        };
        if parenthesised { format!("({text})") } else { text }
    }

    pub fn context(&self, context: &PlanContext) -> String {
        self.formula(context, false)
    }

    fn formula(&self, context: &PlanContext, inner: bool) -> String {
        let joined = |all: &[PlanContext], by: &str| {
            let text = all.iter().map(|c| self.formula(c, true)).collect::<Vec<_>>().join(by);
            if inner && all.len() > 1 { format!("({text})") } else { text }
        };
        match context {
            PlanContext::True => "true".to_owned(),
            PlanContext::Belief(literal) => self.literal(literal),
            PlanContext::Not(inner) => format!("not {}", self.formula(inner, true)),
            PlanContext::And(all) => joined(all, " && "),
            PlanContext::Or(all) => joined(all, " || "),
            PlanContext::Test(e) => {
                self.expression(e, if inner { ParenContext::Logical } else { ParenContext::Nothing })
            }
            PlanContext::Unify(term, e) => format!("{} = {}", self.term(term), self.expr(e)),
            PlanContext::Internal(internal, _) => self.internal(internal),
        }
    }

    fn internal(&self, internal: &InternalAct) -> String {
        let args = |all: &[Expr], out: Option<&AgentTerm>| -> Vec<String> {
            let all = all.iter().map(|e| self.expr(e));
            all.chain(out.map(|t| self.term(t))).collect()
        };
        let goal =
            |g: &GoalId, a: &[AgentTerm]| [self.goal(*g, a.iter().map(|t| self.term(t)).collect::<Vec<_>>())];
        match internal {
            InternalAct::FindAll { template, formula, set, out } => {
                let name = if *set { ".setof" } else { ".findall" };
                call(name, [self.expr(template), self.context(formula), self.term(out)])
            }
            InternalAct::Count { formula, out } => call(".count", [self.context(formula), self.term(out)]),
            InternalAct::Member { element, list } => call(".member", [self.term(element), self.expr(list)]),
            InternalAct::Apply { function, args: a, out } => {
                call(&format!(".{}", list_function(*function)), args(a, Some(out)))
            }
            InternalAct::Holds { function, args: a } => {
                call(&format!(".{}", list_function(*function)), args(a, None))
            }
            InternalAct::Intend { goal: g, args } => call(".intend", goal(g, args)),
            InternalAct::Desire { goal: g, args } => call(".desire", goal(g, args)),
            InternalAct::Suspended { goal: g, args } => call(".suspended", goal(g, args)),
            InternalAct::Random { from, out } => {
                let from: Vec<String> = from.iter().map(|e| self.expr(e)).collect();
                call(".random", from.into_iter().chain([self.term(out)]))
            }
            InternalAct::Shuffle { list, out } => call(".shuffle", [self.expr(list), self.term(out)]),
            InternalAct::Time { out } => call(".time", [self.term(out)]),
            InternalAct::MyName { out } => call(".my_name", [self.term(out)]),
            InternalAct::AllNames { out } => call(".all_names", [self.term(out)]),
        }
    }
}

fn control(what: ControlAct, one: bool) -> &'static str {
    match (what, one) {
        (ControlAct::DropIntention, true) => ".drop_intention",
        (ControlAct::DropIntention, false) => ".drop_all_intentions",
        (ControlAct::DropDesire, true) => ".drop_desire",
        (ControlAct::DropDesire, false) => ".drop_all_desires",
        (ControlAct::DropEvent, true) => ".drop_event",
        (ControlAct::DropEvent, false) => ".drop_all_events",
        (ControlAct::SucceedGoal, _) => ".succeed_goal",
        (ControlAct::FailGoal, _) => ".fail_goal",
        (ControlAct::Suspend, _) => ".suspend",
        (ControlAct::Resume, _) => ".resume",
    }
}

fn function(f: NumberFunction) -> &'static str {
    match f {
        NumberFunction::Abs => "abs",
        NumberFunction::Min => "min",
        NumberFunction::Max => "max",
        NumberFunction::Norm => "norm",
    }
}

fn operator(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Add => "+",
        BinaryOp::Sub => "-",
        BinaryOp::Mul => "*",
        BinaryOp::Div => "/",
        BinaryOp::Rem => "%",
        BinaryOp::Eq => "==",
        BinaryOp::Ne => "!=",
        BinaryOp::Lt => "<",
        BinaryOp::Le => "<=",
        BinaryOp::Gt => ">",
        BinaryOp::Ge => ">=",
        BinaryOp::And => "&&",
        BinaryOp::Or => "||",
    }
}

/// Without its dot.
fn list_function(f: ListFunction) -> &'static str {
    match f {
        ListFunction::Length => "length",
        ListFunction::Concat => "concat",
        ListFunction::Nth => "nth",
        ListFunction::Reverse => "reverse",
        ListFunction::Sort => "sort",
        ListFunction::Min => "min",
        ListFunction::Max => "max",
        ListFunction::Delete => "delete",
        ListFunction::Union => "union",
        ListFunction::Intersection => "intersection",
        ListFunction::Difference => "difference",
        ListFunction::ToText => "string",
        ListFunction::Empty => "empty",
        ListFunction::Prefix => "prefix",
        ListFunction::Suffix => "suffix",
        ListFunction::Sublist => "sublist",
        ListFunction::Occurrences => "occurrences",
        ListFunction::Slice => "slice",
        ListFunction::Real(f) => f.name(),
    }
}
