//! Items and contexts as text for people, in the language as far as possible.

use hrdsl_ir::{
    Expr, Program,
    bdi::{
        Agent, Annotation, Belief, BeliefId, ContentId, Context, GoalId, Internal, Literal, Performative,
        StepKind, Term, TriggerOn,
    },
    expr::{BinaryOp, Function, UnaryOp},
    list::ListFunction,
};

use super::universe::{Applicable, Item, sites};

/// What an item is called: `plan Human.leg#2 failed`, `edge Human.table#1 -> leg#2 (step 3)`.
#[must_use]
pub fn name(program: &Program, agent: &Agent, item: Item) -> String {
    let label = |plan: u16| agent.plans.get(usize::from(plan)).map_or("?", |p| &p.label);
    let owner = &agent.name;
    match item {
        Item::Selected(plan) => format!("plan {owner}.{}", label(plan)),
        Item::Completed(plan) => format!("plan {owner}.{} completed", label(plan)),
        Item::Failed(plan) => format!("plan {owner}.{} failed", label(plan)),
        Item::Context { plan, holds } => format!("context {owner}.{} {holds}", label(plan)),
        Item::Applicable { on, plans } => {
            let many = match plans {
                Applicable::None => "none",
                Applicable::One => "one",
                Applicable::Many => "many",
            };
            format!("applicable {owner}.{} {many}", trigger(program, agent, on))
        }
        Item::Message { plan, site } => {
            let what = message(program, agent, plan, site);
            format!("message {owner}.{}: {what} (step {})", label(plan), site + 1)
        }
        Item::Edge { plan, site, by } => {
            format!("edge {owner}.{} -> {} (step {})", label(plan), label(by), site + 1)
        }
        Item::Path([a, b, c]) => format!("path {owner}: {} > {} > {}", label(a), label(b), label(c)),
    }
}

/// `tell seen`
fn message(program: &Program, agent: &Agent, plan: u16, site: u16) -> String {
    let name = |content: ContentId| program.contents.get(usize::from(content.0)).map_or("?", |c| &c.name);
    let steps = agent.plans.get(usize::from(plan)).map(sites).unwrap_or_default();
    match steps.get(usize::from(site)).map(|s| &s.kind) {
        Some(StepKind::Send { performative, content, .. }) => {
            format!("{} {}", speech_act(*performative), name(*content))
        }
        Some(StepKind::Ask { content, .. }) => format!("ask {}", name(*content)),
        Some(StepKind::AskAll { content, .. }) => format!("ask_all {}", name(*content)),
        Some(_) | None => "?".to_owned(),
    }
}

fn speech_act(performative: Performative) -> &'static str {
    match performative {
        Performative::Tell => "tell",
        Performative::Untell => "untell",
        Performative::Achieve => "achieve",
        Performative::Unachieve => "unachieve",
        Performative::AskOne => "askOne",
        Performative::AskAll => "askAll",
    }
}

pub(super) fn belief(agent: &Agent, id: BeliefId) -> &str {
    agent.beliefs.get(usize::from(id.0)).map_or("?", |b| &b.name)
}

pub(super) fn goal(agent: &Agent, id: GoalId) -> &str {
    agent.goals.get(usize::from(id.0)).map_or("?", |g| &g.name)
}

/// A trigger without its arguments: `+!leg`, `on discarded`.
#[must_use]
pub fn trigger(program: &Program, agent: &Agent, on: TriggerOn) -> String {
    match on {
        TriggerOn::BeliefAdded(b) => format!("+{}", belief(agent, b)),
        TriggerOn::BeliefRemoved(b) => format!("-{}", belief(agent, b)),
        TriggerOn::GoalAdded(g) => format!("+!{}", goal(agent, g)),
        TriggerOn::GoalFailed(g) => format!("-!{}", goal(agent, g)),
        TriggerOn::TestAdded(b) => format!("+?{}", belief(agent, b)),
        TriggerOn::TestFailed(b) => format!("-?{}", belief(agent, b)),
        TriggerOn::Perceived(e) => {
            format!("on {}", program.events.get(usize::from(e.0)).map_or("?", |e| &e.name))
        }
    }
}

/// A context, or a part of one, with the names of its plan's variables.
#[must_use]
pub fn context(agent: &Agent, vars: &[String], context: &Context) -> String {
    Writer { agent, vars }.context(context, 0)
}

struct Writer<'a> {
    agent: &'a Agent,
    vars: &'a [String],
}

/// How strongly the operators of formulas bind.
const OR: u8 = 1;
const AND: u8 = 2;
const NOT: u8 = 3;

impl Writer<'_> {
    /// In parentheses if the surroundings bind more strongly.
    fn context(&self, context: &Context, around: u8) -> String {
        let joined = |all: &[Context], op: &str, level: u8| {
            let parts: Vec<String> = all.iter().map(|c| self.context(c, level + 1)).collect();
            parenthesised(parts.join(op), around > level)
        };
        match context {
            Context::True => "true".to_owned(),
            Context::Belief(literal) => self.literal(literal),
            Context::Not(inner) => format!("not {}", self.context(inner, NOT)),
            Context::And(all) => joined(all, " && ", AND),
            Context::Or(any) => joined(any, " || ", OR),
            Context::Test(e) => self.expr(e, if around == 0 { 0 } else { COMPARED }),
            Context::Unify(term, e) => {
                parenthesised(format!("{} = {}", self.term(term), self.expr(e, 0)), around >= NOT)
            }
            Context::Internal(internal) => self.internal(internal),
        }
    }

    fn literal(&self, literal: &Literal) -> String {
        let declared = self.agent.beliefs.get(usize::from(literal.belief.0));
        let name = declared.map_or("?", |b| &b.name);
        let mut text = self.call(name, &literal.args);
        if !literal.annotations.is_empty() {
            let one = |(a, t): &(Annotation, Term)| format!("{}({})", annotation(declared, *a), self.term(t));
            let all: Vec<String> = literal.annotations.iter().map(one).collect();
            text += &format!("[{}]", all.join(", "));
        }
        text
    }

    fn call(&self, name: &str, args: &[Term]) -> String {
        crate::show::call(name, args.iter().map(|t| self.term(t)))
    }

    fn term(&self, term: &Term) -> String {
        match term {
            Term::Any => "_".to_owned(),
            Term::Var(v) => self.var(*v),
            Term::Expr(e) => self.expr(e, 0),
            Term::List(elements, rest) => {
                let elements = elements.iter().map(|t| self.term(t)).collect();
                list(elements, rest.as_ref().map(|r| self.term(r)))
            }
        }
    }

    fn var(&self, v: u16) -> String {
        self.vars.get(usize::from(v)).map_or_else(|| "?".to_owned(), Clone::clone)
    }

    fn expr(&self, e: &Expr, around: u8) -> String {
        match e {
            Expr::Const(v) => v.to_string(),
            Expr::Var(v) => self.var(*v),
            Expr::Unary(UnaryOp::Not, a) => format!("!{}", self.expr(a, UNARY)),
            Expr::Unary(UnaryOp::Neg, a) => format!("-{}", self.expr(a, UNARY)),
            Expr::Binary(op, a, b) => {
                let (symbol, level) = operator(*op);
                let text = format!("{} {symbol} {}", self.expr(a, level), self.expr(b, level + 1));
                parenthesised(text, around > level)
            }
            Expr::If(c, a, b) => {
                format!("if {} {{ {} }} else {{ {} }}", self.expr(c, 0), self.expr(a, 0), self.expr(b, 0))
            }
            Expr::Call(f, args) => {
                let name = match f {
                    Function::Abs => "abs",
                    Function::Min => "min",
                    Function::Max => "max",
                    Function::Norm => "norm",
                };
                crate::show::call(name, args.iter().map(|a| self.expr(a, 0)))
            }
            Expr::List(elements, rest) => {
                let elements = elements.iter().map(|a| self.expr(a, 0)).collect();
                list(elements, rest.as_ref().map(|r| self.expr(r, 0)))
            }
        }
    }

    fn internal(&self, internal: &Internal) -> String {
        let e = |e: &Expr| self.expr(e, 0);
        let t = |t: &Term| self.term(t);
        let of = |name: &str, args: Vec<String>| crate::show::call(name, args);
        let about = |name: &str, id: GoalId, args: &[Term]| {
            format!("{name}({})", self.call(goal(self.agent, id), args))
        };
        match internal {
            Internal::FindAll { template, formula, set, out } => {
                let name = if *set { ".setof" } else { ".findall" };
                of(name, vec![e(template), self.context(formula, 0), t(out)])
            }
            Internal::Count { formula, out } => of(".count", vec![self.context(formula, 0), t(out)]),
            Internal::Member { element, list } => of(".member", vec![t(element), e(list)]),
            Internal::Apply { function, args, out } => {
                of(function_name(*function), args.iter().map(e).chain([t(out)]).collect())
            }
            Internal::Holds { function, args } => of(function_name(*function), args.iter().map(e).collect()),
            Internal::Intend { goal, args } => about(".intend", *goal, args),
            Internal::Desire { goal, args } => about(".desire", *goal, args),
            Internal::Suspended { goal, args } => about(".suspended", *goal, args),
            Internal::Random { from, out } => of(".random", from.iter().map(e).chain([t(out)]).collect()),
            Internal::Shuffle { list, out } => of(".shuffle", vec![e(list), t(out)]),
            Internal::Time { out } => of(".time", vec![t(out)]),
            Internal::MyName { out } => of(".my_name", vec![t(out)]),
            Internal::AllNames { out } => of(".all_names", vec![t(out)]),
        }
    }
}

fn annotation(declared: Option<&Belief>, annotation: Annotation) -> &str {
    match annotation {
        Annotation::Source => "source",
        Annotation::Declared(i) => {
            declared.and_then(|b| b.annotations.get(usize::from(i))).map_or("?", |p| &p.name)
        }
    }
}

fn parenthesised(text: String, yes: bool) -> String {
    if yes { format!("({text})") } else { text }
}

fn list(elements: Vec<String>, rest: Option<String>) -> String {
    let rest = rest.map(|r| format!(" | {r}")).unwrap_or_default();
    format!("[{}{rest}]", elements.join(", "))
}

/// How strongly the operators of expressions bind; the loosest is above [`NOT`].
const COMPARED: u8 = 6;
const UNARY: u8 = 9;

fn operator(op: BinaryOp) -> (&'static str, u8) {
    match op {
        BinaryOp::Or => ("||", 4),
        BinaryOp::And => ("&&", 5),
        BinaryOp::Eq => ("==", COMPARED),
        BinaryOp::Ne => ("!=", COMPARED),
        BinaryOp::Lt => ("<", COMPARED),
        BinaryOp::Le => ("<=", COMPARED),
        BinaryOp::Gt => (">", COMPARED),
        BinaryOp::Ge => (">=", COMPARED),
        BinaryOp::Add => ("+", 7),
        BinaryOp::Sub => ("-", 7),
        BinaryOp::Mul => ("*", 8),
        BinaryOp::Div => ("/", 8),
        BinaryOp::Rem => ("%", 8),
    }
}

fn function_name(function: ListFunction) -> &'static str {
    match function {
        ListFunction::Length => ".length",
        ListFunction::Concat => ".concat",
        ListFunction::Nth => ".nth",
        ListFunction::Reverse => ".reverse",
        ListFunction::Sort => ".sort",
        ListFunction::Min => ".min",
        ListFunction::Max => ".max",
        ListFunction::Delete => ".delete",
        ListFunction::Union => ".union",
        ListFunction::Intersection => ".intersection",
        ListFunction::Difference => ".difference",
        ListFunction::ToText => ".string",
        ListFunction::Empty => ".empty",
        ListFunction::Prefix => ".prefix",
        ListFunction::Suffix => ".suffix",
        ListFunction::Sublist => ".sublist",
    }
}

#[cfg(test)]
mod tests {
    use super::{super::fixture, *};

    fn written(parts: &Context) -> String {
        let program = fixture::program();
        let human = &program.agents[0];
        context(human, &human.plans[0].vars, parts)
    }

    #[test]
    fn contexts_are_written_as_in_the_language() {
        let program = fixture::program();
        let human = &program.agents[0];
        assert_eq!(written(&human.plans[0].context), "wants(N) && N > 0 && not tired");
        assert_eq!(written(&human.plans[3].context), "near(_) || tired");
        let either = human.plans[3].context.clone();
        assert_eq!(written(&Context::Not(Box::new(either.clone()))), "not (near(_) || tired)");
        assert_eq!(
            written(&Context::And(vec![either, fixture::holds(2, vec![])])),
            "(near(_) || tired) && tired"
        );
        let sum = |a, b| Expr::binary(BinaryOp::Add, a, b);
        let product = Expr::binary(BinaryOp::Mul, sum(Expr::Var(0), Expr::int(1)), Expr::Var(1));
        let e = Expr::binary(BinaryOp::Le, product, sum(Expr::Var(0), sum(Expr::Var(1), Expr::float(2.5))));
        assert_eq!(written(&Context::Test(e.clone())), "(N + 1) * M <= N + (M + 2.5)");
        assert_eq!(
            written(&Context::Not(Box::new(Context::Test(Expr::binary(BinaryOp::Or, e.clone(), e))))),
            "not ((N + 1) * M <= N + (M + 2.5) || (N + 1) * M <= N + (M + 2.5))"
        );
    }

    #[test]
    fn annotations_lists_and_internal_actions_are_written() {
        let source = Term::Expr(Expr::Const(hrdsl_ir::Value::Symbol(hrdsl_ir::Symbol::intern("percept"))));
        let literal = Literal {
            belief: BeliefId(0),
            args: vec![Term::List(vec![Term::Var(0)], Some(Box::new(Term::Any)))],
            annotations: vec![(Annotation::Source, source)],
        };
        assert_eq!(written(&Context::Belief(literal)), "wants([N | _])[source(percept)]");
        let count = Internal::Count { formula: fixture::holds(1, vec![Term::Any]), out: Term::Var(1) };
        assert_eq!(written(&Context::Internal(Box::new(count))), ".count(near(_), M)");
        let intend = Internal::Intend { goal: GoalId(1), args: vec![Term::Any] };
        assert_eq!(written(&Context::Internal(Box::new(intend))), ".intend(leg(_))");
        let unify = Context::Unify(Term::Var(0), Expr::binary(BinaryOp::Sub, Expr::Var(1), Expr::int(1)));
        assert_eq!(written(&unify), "N = M - 1");
    }
}
