//! From a tree over the checker's expressions to the same tree over the Program's: [`bdi`](crate::bdi), [`ta`](crate::ta) and
//! [`event`](crate::event) say once what there is, whatever its expressions are.

use crate::{
    Expr,
    bdi::{
        Agent, AgentTerm, Assertion, BeliefLiteral, BeliefRule, InternalAct, Plan, PlanContext, PlanStep,
        PlanStepKind, PlanTrigger,
    },
    event::{Event, Stimulus, StimulusSample, StimulusStep},
    expr::{ArrayIndex, Lvalue},
    ta::{
        ClockConstraint, Edge, EdgeAssignment, FunctionStatement, Location, QueryFormula, QueryKind,
        QueryMeasure, SyncLabel, TimeSum, TimeTerm,
    },
    world::WorldAction,
};

/// What an expression becomes where all variables are of one place: an agent's plan, a stimulus.
pub type LowerExpr<'a, E> = &'a dyn Fn(&E) -> Expr;

fn all<E>(es: &[E], f: LowerExpr<'_, E>) -> Vec<Expr> {
    es.iter().map(f).collect()
}

// ── agents ──

impl<E> Agent<E> {
    /// The agent over the Program's expressions.
    #[must_use]
    pub fn lower(&self, f: LowerExpr<'_, E>) -> Agent {
        Agent {
            name: self.name.clone(),
            actor: self.actor,
            jason: self.jason,
            beliefs: self.beliefs.clone(),
            goals: self.goals.clone(),
            rules: self.rules.iter().map(|r| r.lower(f)).collect(),
            initial_beliefs: self.initial_beliefs.clone(),
            initial_goals: self.initial_goals.clone(),
            plans: self.plans.iter().map(|p| p.lower(f)).collect(),
            origin: self.origin,
        }
    }
}

impl<E> BeliefRule<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> BeliefRule {
        BeliefRule {
            belief: self.belief,
            args: terms(&self.args, f),
            body: self.body.lower(f),
            vars: self.vars.clone(),
            head: self.head,
            origin: self.origin,
        }
    }
}

impl<E> Plan<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Plan {
        Plan {
            label: self.label.clone(),
            atomic: self.atomic,
            trigger: PlanTrigger {
                on: self.trigger.on,
                args: terms(&self.trigger.args, f),
                annotations: annotations(&self.trigger.annotations, f),
                origin: self.trigger.origin,
                name: self.trigger.name,
            },
            context: self.context.lower(f),
            body: steps(&self.body, f),
            vars: self.vars.clone(),
            origin: self.origin,
        }
    }
}

impl<E> AgentTerm<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> AgentTerm {
        match self {
            AgentTerm::Any => AgentTerm::Any,
            AgentTerm::Var(i) => AgentTerm::Var(*i),
            AgentTerm::Expr(e) => AgentTerm::Expr(f(e)),
            AgentTerm::List(items, rest) => {
                AgentTerm::List(terms(items, f), rest.as_ref().map(|rest| Box::new(rest.lower(f))))
            }
        }
    }
}

fn terms<E>(ts: &[AgentTerm<E>], f: LowerExpr<'_, E>) -> Vec<AgentTerm> {
    ts.iter().map(|t| t.lower(f)).collect()
}

fn annotations<E>(
    of: &[(crate::bdi::BeliefAnnotation, AgentTerm<E>)],
    f: LowerExpr<'_, E>,
) -> Vec<(crate::bdi::BeliefAnnotation, AgentTerm)> {
    of.iter().map(|(a, t)| (*a, t.lower(f))).collect()
}

impl<E> BeliefLiteral<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> BeliefLiteral {
        BeliefLiteral {
            belief: self.belief,
            args: terms(&self.args, f),
            annotations: annotations(&self.annotations, f),
            origin: self.origin,
        }
    }
}

impl<E> Assertion<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Assertion {
        let annotations = self.annotations.iter().map(|(a, e)| (*a, f(e))).collect();
        Assertion { belief: self.belief, args: all(&self.args, f), annotations }
    }
}

impl<E> PlanContext<E> {
    /// The formula over the Program's expressions.
    #[must_use]
    pub fn lower(&self, f: LowerExpr<'_, E>) -> PlanContext {
        let each = |cs: &[PlanContext<E>]| cs.iter().map(|c| c.lower(f)).collect();
        match self {
            PlanContext::True => PlanContext::True,
            PlanContext::Belief(l) => PlanContext::Belief(l.lower(f)),
            PlanContext::Not(c) => PlanContext::Not(Box::new(c.lower(f))),
            PlanContext::And(cs) => PlanContext::And(each(cs)),
            PlanContext::Or(cs) => PlanContext::Or(each(cs)),
            PlanContext::Test(e) => PlanContext::Test(f(e)),
            PlanContext::Unify(term, e) => PlanContext::Unify(term.lower(f), f(e)),
            PlanContext::Internal(action, origin) => {
                PlanContext::Internal(Box::new(action.lower(f)), *origin)
            }
        }
    }
}

impl<E> InternalAct<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> InternalAct {
        match self {
            InternalAct::FindAll { template, formula, set, out } => InternalAct::FindAll {
                template: f(template),
                formula: formula.lower(f),
                set: *set,
                out: out.lower(f),
            },
            InternalAct::Count { formula, out } => {
                InternalAct::Count { formula: formula.lower(f), out: out.lower(f) }
            }
            InternalAct::Member { element, list } => {
                InternalAct::Member { element: element.lower(f), list: f(list) }
            }
            InternalAct::Apply { function, args, out } => {
                InternalAct::Apply { function: *function, args: all(args, f), out: out.lower(f) }
            }
            InternalAct::Holds { function, args } => {
                InternalAct::Holds { function: *function, args: all(args, f) }
            }
            InternalAct::Intend { goal, args } => InternalAct::Intend { goal: *goal, args: terms(args, f) },
            InternalAct::Desire { goal, args } => InternalAct::Desire { goal: *goal, args: terms(args, f) },
            InternalAct::Suspended { goal, args } => {
                InternalAct::Suspended { goal: *goal, args: terms(args, f) }
            }
            InternalAct::Random { from, out } => {
                InternalAct::Random { from: from.as_ref().map(f), out: out.lower(f) }
            }
            InternalAct::Shuffle { list, out } => InternalAct::Shuffle { list: f(list), out: out.lower(f) },
            InternalAct::Time { out } => InternalAct::Time { out: out.lower(f) },
            InternalAct::MyName { out } => InternalAct::MyName { out: out.lower(f) },
            InternalAct::AllNames { out } => InternalAct::AllNames { out: out.lower(f) },
        }
    }
}

fn steps<E>(of: &[PlanStep<E>], f: LowerExpr<'_, E>) -> Vec<PlanStep> {
    of.iter().map(|s| PlanStep { kind: s.kind.lower(f), origin: s.origin }).collect()
}

impl<E> PlanStepKind<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> PlanStepKind {
        match self {
            PlanStepKind::Do { event, args } => PlanStepKind::Do { event: *event, args: all(args, f) },
            PlanStepKind::Achieve { goal, args, within } => {
                PlanStepKind::Achieve { goal: *goal, args: all(args, f), within: within.as_ref().map(f) }
            }
            PlanStepKind::Spawn { goal, args } => PlanStepKind::Spawn { goal: *goal, args: all(args, f) },
            PlanStepKind::Query(l) => PlanStepKind::Query(l.lower(f)),
            PlanStepKind::Test(c) => PlanStepKind::Test(c.lower(f)),
            PlanStepKind::Add(a) => PlanStepKind::Add(a.lower(f)),
            PlanStepKind::Remove(l) => PlanStepKind::Remove(l.lower(f)),
            PlanStepKind::Replace(a) => PlanStepKind::Replace(a.lower(f)),
            PlanStepKind::Abolish(l) => PlanStepKind::Abolish(l.lower(f)),
            PlanStepKind::Await { events, within } => {
                PlanStepKind::Await { events: events.clone(), within: within.as_ref().map(f) }
            }
            PlanStepKind::Wait { seconds } => PlanStepKind::Wait { seconds: f(seconds) },
            PlanStepKind::If { condition, then, otherwise } => PlanStepKind::If {
                condition: condition.lower(f),
                then: steps(then, f),
                otherwise: steps(otherwise, f),
            },
            PlanStepKind::While { condition, body } => {
                PlanStepKind::While { condition: condition.lower(f), body: steps(body, f) }
            }
            PlanStepKind::For { condition, body } => {
                PlanStepKind::For { condition: condition.lower(f), body: steps(body, f) }
            }
            PlanStepKind::Fork { branches, all } => {
                PlanStepKind::Fork { branches: branches.iter().map(|b| steps(b, f)).collect(), all: *all }
            }
            PlanStepKind::Send { to, performative, content, args, annotations } => PlanStepKind::Send {
                to: to.as_ref().map(f),
                performative: *performative,
                content: *content,
                args: terms(args, f),
                annotations: annotations.iter().map(|(name, e)| (name.clone(), f(e))).collect(),
            },
            PlanStepKind::Ask { to, content, args, within } => PlanStepKind::Ask {
                to: f(to),
                content: *content,
                args: terms(args, f),
                within: within.as_ref().map(f),
            },
            PlanStepKind::AskAll { to, template, content, args, out, within } => PlanStepKind::AskAll {
                to: f(to),
                template: f(template),
                content: *content,
                args: terms(args, f),
                out: out.lower(f),
                within: within.as_ref().map(f),
            },
            PlanStepKind::Print { args } => PlanStepKind::Print { args: all(args, f) },
            PlanStepKind::Control { what, goal } => PlanStepKind::Control {
                what: *what,
                goal: goal.as_ref().map(|(g, args)| (*g, terms(args, f))),
            },
            PlanStepKind::Fail => PlanStepKind::Fail,
        }
    }
}

// ── stimuli ──

impl<E> Event<E> {
    /// The event over the Program's expressions.
    #[must_use]
    pub fn lower(&self, f: LowerExpr<'_, E>) -> Event {
        Event {
            name: self.name.clone(),
            params: self.params.clone(),
            from: self.from,
            to: self.to.clone(),
            stimulus: self.stimulus.as_ref().map(|s| s.lower(f)),
            origin: self.origin,
        }
    }
}

impl<E> Stimulus<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Stimulus {
        let sample = |s: &StimulusSample<E>| StimulusSample {
            name: s.name.clone(),
            ty: s.ty,
            lo: f(&s.lo),
            hi: f(&s.hi),
        };
        Stimulus { samples: self.samples.iter().map(sample).collect(), steps: stimulus_steps(&self.steps, f) }
    }
}

fn stimulus_steps<E>(steps: &[StimulusStep<E>], f: LowerExpr<'_, E>) -> Vec<StimulusStep> {
    let step = |s: &StimulusStep<E>| match s {
        StimulusStep::Emit { event, args } => StimulusStep::Emit { event: *event, args: all(args, f) },
        StimulusStep::Hold { seconds } => StimulusStep::Hold { seconds: f(seconds) },
        StimulusStep::Act(action) => StimulusStep::Act(action.lower(f)),
        StimulusStep::If { condition, then, otherwise } => StimulusStep::If {
            condition: f(condition),
            then: stimulus_steps(then, f),
            otherwise: stimulus_steps(otherwise, f),
        },
    };
    steps.iter().map(step).collect()
}

impl<E> WorldAction<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> WorldAction {
        match self {
            WorldAction::Move { body, to, over } => {
                WorldAction::Move { body: *body, to: to.lower(f), over: f(over) }
            }
            WorldAction::Look { body, at, offset, distance, angle } => WorldAction::Look {
                body: *body,
                at: *at,
                offset: f(offset),
                distance: f(distance),
                angle: f(angle),
            },
            WorldAction::Grasp { gripper } => WorldAction::Grasp { gripper: *gripper },
            WorldAction::LetGo { gripper } => WorldAction::LetGo { gripper: *gripper },
            WorldAction::Walk { figure, along, speed } => WorldAction::Walk {
                figure: *figure,
                along: along.iter().map(|point| point.lower(f)).collect(),
                speed: f(speed),
            },
            WorldAction::Turn { figure, to } => WorldAction::Turn { figure: *figure, to: to.lower(f) },
        }
    }
}

// ── automata ──

/// Where the variables of an automaton, a function or a query lie.
pub trait VariableSlots<E, V> {
    /// The expression over slots.
    fn expr(&self, e: &E) -> Expr;

    /// The slot of a variable.
    fn slot(&self, of: &V) -> u16;
}

fn exprs<E, V>(es: &[E], slots: &dyn VariableSlots<E, V>) -> Vec<Expr> {
    es.iter().map(|e| slots.expr(e)).collect()
}

impl<E, V> Lvalue<E, V> {
    /// The place among slots.
    #[must_use]
    pub fn lower(&self, slots: &dyn VariableSlots<E, V>) -> Lvalue {
        let index =
            |i: &ArrayIndex<E>| ArrayIndex { at: slots.expr(&i.at), count: i.count, stride: i.stride };
        Lvalue { slot: slots.slot(&self.slot), indices: self.indices.iter().map(index).collect() }
    }
}

impl<E> Location<E> {
    /// The location over slots.
    #[must_use]
    pub fn lower<V>(&self, slots: &dyn VariableSlots<E, V>) -> Location {
        Location {
            name: self.name.clone(),
            kind: self.kind,
            invariant: self.invariant.iter().map(|c| c.lower(slots)).collect(),
            holds: self.holds.as_ref().map(|e| slots.expr(e)),
            stopped: self.stopped.clone(),
            origin: self.origin,
        }
    }
}

impl<E> ClockConstraint<E> {
    fn lower<V>(&self, slots: &dyn VariableSlots<E, V>) -> ClockConstraint {
        ClockConstraint { clock: self.clock, minus: self.minus, op: self.op, bound: self.bound.lower(slots) }
    }
}

impl<E> TimeSum<E> {
    fn lower<V>(&self, slots: &dyn VariableSlots<E, V>) -> TimeSum {
        let term = |t: &TimeTerm<E>| TimeTerm { factor: t.factor, value: slots.expr(&t.value) };
        TimeSum { nanos: self.nanos, terms: self.terms.iter().map(term).collect() }
    }
}

impl<E, V> Edge<E, V> {
    /// The edge over slots.
    #[must_use]
    pub fn lower(&self, slots: &dyn VariableSlots<E, V>) -> Edge {
        Edge {
            from: self.from,
            to: self.to,
            selects: self.selects.clone(),
            clock_guard: self.clock_guard.iter().map(|c| c.lower(slots)).collect(),
            guard: self.guard.as_ref().map(|g| slots.expr(g)),
            sync: self.sync.lower(slots),
            updates: self.updates.iter().map(|u| u.lower(slots)).collect(),
            origin: self.origin,
        }
    }
}

impl<E> SyncLabel<E> {
    fn lower<V>(&self, slots: &dyn VariableSlots<E, V>) -> SyncLabel {
        match self {
            SyncLabel::Internal => SyncLabel::Internal,
            SyncLabel::Send { event, args } => SyncLabel::Send { event: *event, args: exprs(args, slots) },
            SyncLabel::Receive { event, args } => SyncLabel::Receive { event: *event, args: args.clone() },
            SyncLabel::Offer { channel, args } => {
                SyncLabel::Offer { channel: *channel, args: exprs(args, slots) }
            }
            SyncLabel::Accept { channel, args } => {
                SyncLabel::Accept { channel: *channel, args: args.clone() }
            }
            SyncLabel::Join { channel } => SyncLabel::Join { channel: *channel },
        }
    }
}

impl<E, V> EdgeAssignment<E, V> {
    fn lower(&self, slots: &dyn VariableSlots<E, V>) -> EdgeAssignment {
        match self {
            EdgeAssignment::Assign { place, value } => {
                EdgeAssignment::Assign { place: place.lower(slots), value: slots.expr(value) }
            }
            EdgeAssignment::Reset { clock, from, to } => {
                EdgeAssignment::Reset { clock: *clock, from: *from, to: to.lower(slots) }
            }
            EdgeAssignment::Call { function, args } => {
                EdgeAssignment::Call { function: *function, args: exprs(args, slots) }
            }
        }
    }
}

impl<E, V> FunctionStatement<E, V> {
    /// The statement over slots.
    #[must_use]
    pub fn lower(&self, slots: &dyn VariableSlots<E, V>) -> FunctionStatement {
        let block = |of: &[FunctionStatement<E, V>]| of.iter().map(|s| s.lower(slots)).collect();
        match self {
            FunctionStatement::Assign { place, value } => {
                FunctionStatement::Assign { place: place.lower(slots), value: slots.expr(value) }
            }
            FunctionStatement::Call { function, args } => {
                FunctionStatement::Call { function: *function, args: exprs(args, slots) }
            }
            FunctionStatement::If { condition, then, otherwise } => FunctionStatement::If {
                condition: slots.expr(condition),
                then: block(then),
                otherwise: block(otherwise),
            },
            FunctionStatement::While { condition, body } => {
                FunctionStatement::While { condition: slots.expr(condition), body: block(body) }
            }
            FunctionStatement::For { slot, lo, hi, body } => FunctionStatement::For {
                slot: slots.slot(slot),
                lo: slots.expr(lo),
                hi: slots.expr(hi),
                body: block(body),
            },
            FunctionStatement::Return(value) => {
                FunctionStatement::Return(value.as_ref().map(|v| slots.expr(v)))
            }
        }
    }
}

// ── queries ──

impl<E> QueryKind<E> {
    /// The question over slots.
    #[must_use]
    pub fn lower<V>(&self, slots: &dyn VariableSlots<E, V>) -> QueryKind {
        let measures = |of: &[QueryMeasure<E>]| of.iter().map(|m| m.lower(slots)).collect();
        match self {
            QueryKind::Possibly(f) => QueryKind::Possibly(f.lower(slots)),
            QueryKind::Invariantly(f) => QueryKind::Invariantly(f.lower(slots)),
            QueryKind::PotentiallyAlways(f) => QueryKind::PotentiallyAlways(f.lower(slots)),
            QueryKind::Eventually(f) => QueryKind::Eventually(f.lower(slots)),
            QueryKind::LeadsTo(f, g) => QueryKind::LeadsTo(f.lower(slots), g.lower(slots)),
            QueryKind::Sup { of, when } => QueryKind::Sup { of: measures(of), when: when.lower(slots) },
            QueryKind::Inf { of, when } => QueryKind::Inf { of: measures(of), when: when.lower(slots) },
        }
    }
}

impl<E> QueryFormula<E> {
    pub(crate) fn lower<V>(&self, slots: &dyn VariableSlots<E, V>) -> QueryFormula {
        let each = |fs: &[QueryFormula<E>]| fs.iter().map(|f| f.lower(slots)).collect();
        match self {
            QueryFormula::At { automaton, location } => {
                QueryFormula::At { automaton: *automaton, location: *location }
            }
            QueryFormula::Data(e) => QueryFormula::Data(slots.expr(e)),
            QueryFormula::Clock(c) => QueryFormula::Clock(c.lower(slots)),
            QueryFormula::Deadlock => QueryFormula::Deadlock,
            QueryFormula::Not(f) => QueryFormula::Not(Box::new(f.lower(slots))),
            QueryFormula::And(fs) => QueryFormula::And(each(fs)),
            QueryFormula::Or(fs) => QueryFormula::Or(each(fs)),
        }
    }
}

impl<E> QueryMeasure<E> {
    fn lower<V>(&self, slots: &dyn VariableSlots<E, V>) -> QueryMeasure {
        match self {
            QueryMeasure::Clock(clock) => QueryMeasure::Clock(*clock),
            QueryMeasure::Data(e) => QueryMeasure::Data(slots.expr(e)),
        }
    }
}
