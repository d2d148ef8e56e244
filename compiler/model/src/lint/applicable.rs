//! Whether a step of a plan always finds an applicable plan, or a fact: tried in all worlds that differ in what the
//! contexts ask. A world is made up as it is asked about; where there are too many the answer is yes, so that nothing is
//! said that is not known.

use std::cmp::Ordering;

use super::{
    agent_facts::{AgentFacts, HeldBeliefs, change, is_quiet},
    plan_terms::{alternatives, same_value},
    simple::{is_simple, is_simple_literal, is_simple_step},
    triggers::matched,
};
use crate::{
    BeliefId, BinaryOp, GoalId, TriggerOn, Type, TypedContext, TypedExpr, TypedExprKind, TypedPlan,
    TypedTerm, UnaryOp, Value, VariableRef, expr::ComparisonOp,
};

/// Steps of the search.
const BUDGET: u32 = 20_000;
/// Steps of a plan that are looked into.
const LONG: usize = 200;
/// A range with more values is not tried value by value.
const LARGE: i64 = 16;

/// A value, or what is known of it by name only.
#[derive(Clone, Debug, PartialEq)]
enum SymbolicTerm {
    Value(Value),
    Named(String),
}

impl SymbolicTerm {
    fn text(&self) -> String {
        match self {
            SymbolicTerm::Value(value) => value.to_string(),
            SymbolicTerm::Named(name) => name.clone(),
        }
    }
}

/// A question that a world answers.
#[derive(Clone, Debug, PartialEq)]
enum ContextQuestion {
    /// Whether such a fact is held; `None`: with any value.
    Held(String, Vec<Option<String>>),
    /// Whether a condition is true.
    Holds(String),
    /// How a value compares with a number: less, equal, more.
    Against(String, f64),
    /// How two values compare.
    Between(String, String),
    /// Which of these values something has.
    Which(String, Vec<Value>),
}

impl ContextQuestion {
    fn answers(&self) -> usize {
        match self {
            ContextQuestion::Held(..) | ContextQuestion::Holds(_) => 2,
            ContextQuestion::Against(..) | ContextQuestion::Between(..) => 3,
            ContextQuestion::Which(_, values) => values.len(),
        }
    }
}

/// What has been answered so far.
#[derive(Default)]
struct PossibleWorld {
    known: Vec<(ContextQuestion, usize)>,
    budget: u32,
}

/// The answer, or the question that must be answered first.
type AskedLiteral<T> = Result<T, ContextQuestion>;

const ORDERS: [Ordering; 3] = [Ordering::Less, Ordering::Equal, Ordering::Greater];

impl PossibleWorld {
    fn ask(&self, question: ContextQuestion) -> AskedLiteral<usize> {
        let known = self.known.iter().find(|(q, _)| *q == question).map(|(_, answer)| *answer);
        known.ok_or(question)
    }

    fn which(&self, name: String, ty: Type) -> AskedLiteral<SymbolicTerm> {
        let values: Vec<Value> = match ty {
            Type::Bool => vec![Value::Bool(false), Value::Bool(true)],
            Type::Int { lo, hi } if hi.saturating_sub(lo) < LARGE => (lo..=hi).map(Value::Int).collect(),
            Type::Enum(of) => of.values().iter().map(|v| Value::Symbol(*v)).collect(),
            Type::Int { .. } | Type::Float(_) | Type::Text | Type::List(_) => {
                return Ok(SymbolicTerm::Named(name));
            }
        };
        let answer = self.ask(ContextQuestion::Which(name, values.clone()))?;
        Ok(SymbolicTerm::Value(values[answer]))
    }

    /// Whether a fact is held; what follows from the other answers is not asked.
    fn held(&self, belief: &str, args: &[Option<String>]) -> AskedLiteral<bool> {
        let covers = |general: &[Option<String>], special: &[Option<String>]| {
            general.iter().zip(special).all(|(g, s)| g.is_none() || g == s)
        };
        for (question, answer) in &self.known {
            if let ContextQuestion::Held(name, known) = question
                && name == belief
            {
                match answer {
                    0 if covers(known, args) => return Ok(false),
                    0 => {}
                    _ if covers(args, known) => return Ok(true),
                    _ => {}
                }
            }
        }
        Ok(self.ask(ContextQuestion::Held(belief.to_owned(), args.to_vec()))? == 1)
    }

    fn compare(&self, a: &SymbolicTerm, b: &SymbolicTerm) -> AskedLiteral<Ordering> {
        match (a, b) {
            (SymbolicTerm::Value(a), SymbolicTerm::Value(b)) => Ok(order(*a, *b)),
            (SymbolicTerm::Named(a), SymbolicTerm::Named(b)) if a == b => Ok(Ordering::Equal),
            (SymbolicTerm::Named(a), SymbolicTerm::Named(b)) if a > b => Ok(self.between(b, a)?.reverse()),
            (SymbolicTerm::Named(a), SymbolicTerm::Named(b)) => self.between(a, b),
            (SymbolicTerm::Named(a), SymbolicTerm::Value(b)) => self.against(a, *b),
            (SymbolicTerm::Value(a), SymbolicTerm::Named(b)) => Ok(self.against(b, *a)?.reverse()),
        }
    }

    fn between(&self, a: &str, b: &str) -> AskedLiteral<Ordering> {
        Ok(ORDERS[self.ask(ContextQuestion::Between(a.to_owned(), b.to_owned()))?])
    }

    fn against(&self, name: &str, value: Value) -> AskedLiteral<Ordering> {
        let Some(number) = value.as_f64() else {
            let same =
                self.ask(ContextQuestion::Holds(name.to_owned()))? == usize::from(value == Value::Bool(true));
            return Ok(if same { Ordering::Equal } else { Ordering::Less });
        };
        for (question, answer) in &self.known {
            if let ContextQuestion::Against(known, bound) = question
                && known == name
            {
                match ORDERS[*answer] {
                    Ordering::Less if *bound <= number => return Ok(Ordering::Less),
                    Ordering::Greater if *bound >= number => return Ok(Ordering::Greater),
                    Ordering::Equal => return Ok(bound.total_cmp(&number)),
                    Ordering::Less | Ordering::Greater => {}
                }
            }
        }
        Ok(ORDERS[self.ask(ContextQuestion::Against(name.to_owned(), number))?])
    }
}

fn order(a: Value, b: Value) -> Ordering {
    match (a.as_f64(), b.as_f64()) {
        (Some(x), Some(y)) => x.total_cmp(&y),
        (Some(_) | None, _) if same_value(a, b) => Ordering::Equal,
        (Some(_) | None, _) => Ordering::Less,
    }
}

/// Whether something is so in every world.
fn always(is_so: &dyn Fn(&PossibleWorld) -> AskedLiteral<bool>, world: &mut PossibleWorld) -> bool {
    if world.budget == 0 {
        return true;
    }
    world.budget -= 1;
    match is_so(world) {
        Ok(answer) => answer,
        Err(question) => (0..question.answers()).all(|answer| {
            world.known.push((question.clone(), answer));
            let so = always(is_so, world);
            world.known.pop();
            so
        }),
    }
}

/// Whether an achieve or query step has a plan or fact whenever it is reached.
pub(crate) fn never_stuck(facts: &AgentFacts<'_>, plan: &TypedPlan, at: usize) -> bool {
    let asks = &plan.body[at].kind;
    let answers =
        asks.as_achieve().is_none_or(|(goal, _)| facts.plans(TriggerOn::GoalAdded(goal)).all(is_simple))
            && asks.as_query().is_none_or(is_simple_literal);
    if at > LONG || !facts.work(1) {
        return true;
    }
    if !answers || !is_simple(plan) || !plan.body[..at].iter().all(is_simple_step) {
        return true;
    }
    let is_so = |world: &PossibleWorld| {
        if !facts.work(1 + at) {
            return Ok(true);
        }
        let mut here = ContextPlace::enter(facts, plan, world);
        if !here.selected(plan, at)? {
            // This plan is not the one that runs in such a world.
            return Ok(true);
        }
        here.facts_since(plan, at)?;
        let step = &plan.body[at].kind;
        if let Some((goal, args)) = step.as_achieve() {
            let args: Vec<SymbolicTerm> = args.iter().map(|e| here.sym(e)).collect::<AskedLiteral<_>>()?;
            return here.has_plan(goal, &args);
        }
        step.as_query().map_or(Ok(true), |l| here.literal(l.belief, &l.args))
    };
    always(&is_so, &mut PossibleWorld { known: Vec::new(), budget: BUDGET })
}

/// A plan at a moment in a world.
struct ContextPlace<'a> {
    facts: &'a AgentFacts<'a>,
    world: &'a PossibleWorld,
    /// Its name for what its variables stand for.
    name: String,
    vars: Vec<Option<SymbolicTerm>>,
    /// Beliefs that have changed since are called by another name.
    past: Vec<BeliefId>,
    /// Facts that its own steps have added.
    added: Vec<(BeliefId, Vec<SymbolicTerm>)>,
}

impl<'a> ContextPlace<'a> {
    fn enter(facts: &'a AgentFacts<'a>, plan: &TypedPlan, world: &'a PossibleWorld) -> Self {
        let vars = vec![None; plan.vars.len()];
        Self { facts, world, name: plan.label.clone(), vars, past: Vec::new(), added: Vec::new() }
    }

    /// Binds the variables of a plan that runs; `false` if it does not. Until step `at`, beliefs may change.
    fn selected(&mut self, plan: &TypedPlan, at: usize) -> AskedLiteral<bool> {
        self.head(plan)?;
        self.past = changed(self.facts, plan, at);
        let holds = self.formula(&plan.context)?;
        self.past.clear();
        Ok(holds)
    }

    fn head(&mut self, plan: &TypedPlan) -> AskedLiteral<()> {
        let params = matched(self.facts.scenario, self.facts.agent, plan.trigger.on);
        for (i, arg) in plan.trigger.args.iter().enumerate() {
            if let TypedTerm::Var(var) = arg
                && self.vars[usize::from(*var)].is_none()
            {
                let name = format!("{}.{i}", self.name);
                let value = match params.get(i) {
                    Some(param) => self.world.which(name, param.ty)?,
                    None => SymbolicTerm::Named(name),
                };
                self.vars[usize::from(*var)] = Some(value);
            }
        }
        Ok(())
    }

    /// What the plan's own steps before `at` have added, and what its queries have found.
    fn facts_since(&mut self, plan: &TypedPlan, at: usize) -> AskedLiteral<()> {
        for step in &plan.body[..at] {
            if let Some(literal) = step.kind.as_query() {
                for var in super::plan_terms::vars_of(&literal.args) {
                    let name = format!("{}.{var}", self.name);
                    self.vars[usize::from(var)].get_or_insert(SymbolicTerm::Named(name));
                }
            } else if let Some(made) = step.kind.as_assertion() {
                let args: Vec<SymbolicTerm> =
                    made.args.iter().map(|e| self.sym(e)).collect::<AskedLiteral<_>>()?;
                self.added.push((made.belief, args));
            } else if let Some(gone) = step.kind.as_removal() {
                self.added.retain(|(b, _)| *b != gone.belief);
            } else if !is_quiet(step) {
                // Time may pass.
                self.added.clear();
            }
        }
        Ok(())
    }

    /// Whether some plan for the goal is applicable.
    fn has_plan(&self, goal: GoalId, args: &[SymbolicTerm]) -> AskedLiteral<bool> {
        for plan in self.facts.plans(TriggerOn::GoalAdded(goal)) {
            if !self.facts.work(1) {
                return Ok(true);
            }
            let mut callee = ContextPlace {
                name: format!("{}.{}", self.name, plan.label),
                vars: vec![None; plan.vars.len()],
                past: Vec::new(),
                added: self.added.clone(),
                ..*self
            };
            if callee.matches(&plan.trigger.args, args)? && callee.formula(&plan.context)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn matches(&mut self, args: &[TypedTerm], values: &[SymbolicTerm]) -> AskedLiteral<bool> {
        for (arg, value) in args.iter().zip(values) {
            let wanted = match arg {
                TypedTerm::Any | TypedTerm::List(..) => continue,
                TypedTerm::Var(var) => match &self.vars[usize::from(*var)] {
                    Some(known) => known.clone(),
                    None => {
                        self.vars[usize::from(*var)] = Some(value.clone());
                        continue;
                    }
                },
                TypedTerm::Expr(e) => self.sym(e)?,
            };
            if self.world.compare(&wanted, value)? != Ordering::Equal {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn formula(&mut self, context: &TypedContext) -> AskedLiteral<bool> {
        let Some(all) = alternatives(context) else { return Ok(true) };
        for parts in all {
            let before = self.vars.clone();
            if self.conjunction(&parts)? {
                return Ok(true);
            }
            self.vars = before;
        }
        Ok(false)
    }

    fn conjunction(&mut self, parts: &[&TypedContext]) -> AskedLiteral<bool> {
        for part in parts {
            let holds = match part {
                TypedContext::Belief(l) => self.literal(l.belief, &l.args)?,
                TypedContext::Not(inner) => {
                    let before = self.vars.clone();
                    let holds = self.formula(inner)?;
                    self.vars = before;
                    !holds
                }
                TypedContext::Test(e) => self.test(e)?,
                TypedContext::True | TypedContext::And(_) | TypedContext::Or(_) => self.formula(part)?,
                // Not simple.
                TypedContext::Unify(..) | TypedContext::Internal(..) => true,
            };
            if !holds {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn literal(&mut self, belief: BeliefId, args: &[TypedTerm]) -> AskedLiteral<bool> {
        let known: Vec<Option<SymbolicTerm>> =
            args.iter().map(|arg| self.known(arg)).collect::<AskedLiteral<_>>()?;
        let now = self.belief_name(belief);
        for (b, fact) in &self.added {
            if *b == belief && known.iter().zip(fact).all(|(k, f)| k.as_ref().is_none_or(|k| k == f)) {
                let fact = fact.clone();
                return self.matches(args, &fact);
            }
        }
        let open = |except: Option<usize>| {
            known.iter().enumerate().all(|(i, k)| k.is_none() || Some(i) == except) && distinct(args)
        };
        let params = &self.facts.belief(belief).params;
        let fact = |world: &PossibleWorld, name: &str| -> AskedLiteral<Vec<SymbolicTerm>> {
            let values = params.iter().enumerate();
            values.map(|(i, p)| world.which(format!("{name}.{i}"), p.ty)).collect()
        };
        match self.facts.held(belief) {
            HeldBeliefs::One => {
                let fact = fact(self.world, &now)?;
                self.matches(args, &fact)
            }
            HeldBeliefs::OnePer(at) if known.get(usize::from(at)).is_some_and(Option::is_some) => {
                let per = known[usize::from(at)].as_ref().map(SymbolicTerm::text).unwrap_or_default();
                let mut fact = fact(self.world, &format!("{now}({per})"))?;
                fact[usize::from(at)] = known[usize::from(at)].clone().unwrap_or(SymbolicTerm::Named(per));
                self.matches(args, &fact)
            }
            HeldBeliefs::Some | HeldBeliefs::OnePer(_) if open(None) => {
                self.name_open(args, &now);
                Ok(true)
            }
            HeldBeliefs::Some | HeldBeliefs::OnePer(_) | HeldBeliefs::Unknown => {
                let texts: Vec<Option<String>> =
                    known.iter().map(|k| k.as_ref().map(SymbolicTerm::text)).collect();
                let held = self.world.held(&now, &texts)?;
                if held {
                    let shown: Vec<&str> = texts.iter().map(|t| t.as_deref().unwrap_or("_")).collect();
                    self.name_open(args, &format!("{now}({})", shown.join(",")));
                }
                Ok(held)
            }
        }
    }

    /// What a belief is called in the questions: by another name before a change that may come.
    fn belief_name(&self, belief: BeliefId) -> String {
        let name = &self.facts.belief(belief).name;
        if self.past.contains(&belief) { format!("{name}'") } else { name.clone() }
    }

    fn known(&self, arg: &TypedTerm) -> AskedLiteral<Option<SymbolicTerm>> {
        match arg {
            TypedTerm::Any | TypedTerm::List(..) => Ok(None),
            TypedTerm::Var(var) => Ok(self.vars[usize::from(*var)].clone()),
            TypedTerm::Expr(e) => self.sym(e).map(Some),
        }
    }

    /// Gives the open variables of a literal names.
    fn name_open(&mut self, args: &[TypedTerm], fact: &str) {
        for (i, arg) in args.iter().enumerate() {
            if let TypedTerm::Var(var) = arg {
                self.vars[usize::from(*var)]
                    .get_or_insert_with(|| SymbolicTerm::Named(format!("{fact}.{i}")));
            }
        }
    }

    fn test(&self, e: &TypedExpr) -> AskedLiteral<bool> {
        if let TypedExprKind::Binary(op, a, b) = &e.kind {
            if *op == BinaryOp::And {
                return Ok(self.test(a)? && self.test(b)?);
            }
            if *op == BinaryOp::Or {
                return Ok(self.test(a)? || self.test(b)?);
            }
            if let Some(op) = ComparisonOp::of(*op) {
                let order = self.world.compare(&self.sym(a)?, &self.sym(b)?)?;
                return Ok(match op {
                    ComparisonOp::Lt => order.is_lt(),
                    ComparisonOp::Le => order.is_le(),
                    ComparisonOp::Gt => order.is_gt(),
                    ComparisonOp::Ge => order.is_ge(),
                    ComparisonOp::Eq => order.is_eq(),
                    ComparisonOp::Ne => order.is_ne(),
                });
            }
        }
        if let TypedExprKind::Unary(UnaryOp::Not, a) = &e.kind {
            return Ok(!self.test(a)?);
        }
        match self.sym(e)? {
            SymbolicTerm::Value(value) => Ok(value == Value::Bool(true)),
            SymbolicTerm::Named(name) => Ok(self.world.ask(ContextQuestion::Holds(name))? == 1),
        }
    }

    /// The value of an expression, or a name that is the same for the same expression over the same values.
    fn sym(&self, e: &TypedExpr) -> AskedLiteral<SymbolicTerm> {
        let value = |leaf| match leaf {
            VariableRef::Local(var) => match &self.vars[usize::from(var)] {
                Some(SymbolicTerm::Value(value)) => Some(*value),
                Some(SymbolicTerm::Named(_)) | None => None,
            },
            VariableRef::Own(_) | VariableRef::Shared(_) | VariableRef::Signal(_) => None,
        };
        if let Some(value) = e.value_with(&value) {
            return Ok(SymbolicTerm::Value(value));
        }
        let of = match &e.kind {
            TypedExprKind::Unary(op, _) => format!("{op:?}"),
            TypedExprKind::Binary(op, ..) => format!("{op:?}"),
            TypedExprKind::If(..) => "if".to_owned(),
            TypedExprKind::Call(f, _) => format!("{f:?}"),
            TypedExprKind::List(..) => "list".to_owned(),
            TypedExprKind::Leaf(VariableRef::Local(var)) => {
                let known = self.vars[usize::from(*var)].clone();
                return Ok(known.unwrap_or_else(|| SymbolicTerm::Named(format!("{}.{var}", self.name))));
            }
            // No agent reads these: they are told apart by what they are.
            TypedExprKind::Const(_)
            | TypedExprKind::Leaf(_)
            | TypedExprKind::Term(_)
            | TypedExprKind::Element(_)
            | TypedExprKind::Apply(..)
            | TypedExprKind::Error => return Ok(SymbolicTerm::Named(format!("{:?}", e.kind))),
        };
        let operands = e.operands().into_iter();
        let parts: Vec<String> = operands.map(|p| Ok(self.sym(p)?.text())).collect::<AskedLiteral<_>>()?;
        Ok(SymbolicTerm::Named(format!("{of}({})", parts.join(", "))))
    }
}

/// No variable comes twice.
fn distinct(args: &[TypedTerm]) -> bool {
    let vars: Vec<u16> = super::plan_terms::vars_of(args);
    vars.iter().enumerate().all(|(i, var)| !vars[..i].contains(var))
}

/// The beliefs that may have changed between the selection of the plan and its step `at`.
fn changed(facts: &AgentFacts<'_>, plan: &TypedPlan, at: usize) -> Vec<BeliefId> {
    let mut all: Vec<BeliefId> = Vec::new();
    for step in &plan.body[..at] {
        let by_facts = |belief| facts.plans(TriggerOn::TestAdded(belief)).next().is_none();
        if let Some(changed) = change(step) {
            all.push(changed.belief());
        } else if !is_quiet(step) && !step.kind.as_query().is_some_and(|l| by_facts(l.belief)) {
            return facts.changed().collect();
        }
    }
    all
}
