//! From a tree over the checker's expressions to the same tree over the Program's: [`bdi`](crate::bdi), [`ta`](crate::ta) and
//! [`event`](crate::event) say once what there is, whatever its expressions are.

use crate::{
    Expr,
    bdi::{Agent, Assertion, Context, Internal, Literal, Plan, Rule, Step, StepKind, Term, Trigger},
    event::{Event, Sample, Stimulus, StimulusStep},
    expr::{Index, Place},
    suite::{Choice, Condition, Method, Suite},
    ta::{Ask, ClockConstraint, Edge, Formula, Location, Measure, Statement, Sync, Time, TimeTerm, Update},
    world::{Point, WorldAction},
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

impl<E> Rule<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Rule {
        Rule {
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
            trigger: Trigger {
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

impl<E> Term<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Term {
        match self {
            Term::Any => Term::Any,
            Term::Var(i) => Term::Var(*i),
            Term::Expr(e) => Term::Expr(f(e)),
            Term::List(items, rest) => {
                Term::List(terms(items, f), rest.as_ref().map(|rest| Box::new(rest.lower(f))))
            }
        }
    }
}

fn terms<E>(ts: &[Term<E>], f: LowerExpr<'_, E>) -> Vec<Term> {
    ts.iter().map(|t| t.lower(f)).collect()
}

fn annotations<E>(
    of: &[(crate::bdi::Annotation, Term<E>)],
    f: LowerExpr<'_, E>,
) -> Vec<(crate::bdi::Annotation, Term)> {
    of.iter().map(|(a, t)| (*a, t.lower(f))).collect()
}

impl<E> Literal<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Literal {
        Literal {
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

impl<E> Context<E> {
    /// The formula over the Program's expressions.
    #[must_use]
    pub fn lower(&self, f: LowerExpr<'_, E>) -> Context {
        let each = |cs: &[Context<E>]| cs.iter().map(|c| c.lower(f)).collect();
        match self {
            Context::True => Context::True,
            Context::Belief(l) => Context::Belief(l.lower(f)),
            Context::Not(c) => Context::Not(Box::new(c.lower(f))),
            Context::And(cs) => Context::And(each(cs)),
            Context::Or(cs) => Context::Or(each(cs)),
            Context::Test(e) => Context::Test(f(e)),
            Context::Unify(term, e) => Context::Unify(term.lower(f), f(e)),
            Context::Internal(action, origin) => Context::Internal(Box::new(action.lower(f)), *origin),
        }
    }
}

impl<E> Internal<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Internal {
        match self {
            Internal::FindAll { template, formula, set, out } => Internal::FindAll {
                template: f(template),
                formula: formula.lower(f),
                set: *set,
                out: out.lower(f),
            },
            Internal::Count { formula, out } => {
                Internal::Count { formula: formula.lower(f), out: out.lower(f) }
            }
            Internal::Member { element, list } => {
                Internal::Member { element: element.lower(f), list: f(list) }
            }
            Internal::Apply { function, args, out } => {
                Internal::Apply { function: *function, args: all(args, f), out: out.lower(f) }
            }
            Internal::Holds { function, args } => Internal::Holds { function: *function, args: all(args, f) },
            Internal::Intend { goal, args } => Internal::Intend { goal: *goal, args: terms(args, f) },
            Internal::Desire { goal, args } => Internal::Desire { goal: *goal, args: terms(args, f) },
            Internal::Suspended { goal, args } => Internal::Suspended { goal: *goal, args: terms(args, f) },
            Internal::Random { from, out } => {
                Internal::Random { from: from.as_ref().map(f), out: out.lower(f) }
            }
            Internal::Shuffle { list, out } => Internal::Shuffle { list: f(list), out: out.lower(f) },
            Internal::Time { out } => Internal::Time { out: out.lower(f) },
            Internal::MyName { out } => Internal::MyName { out: out.lower(f) },
            Internal::AllNames { out } => Internal::AllNames { out: out.lower(f) },
        }
    }
}

fn steps<E>(of: &[Step<E>], f: LowerExpr<'_, E>) -> Vec<Step> {
    of.iter().map(|s| Step { kind: s.kind.lower(f), origin: s.origin }).collect()
}

impl<E> StepKind<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> StepKind {
        match self {
            StepKind::Do { event, args } => StepKind::Do { event: *event, args: all(args, f) },
            StepKind::Achieve { goal, args, within } => {
                StepKind::Achieve { goal: *goal, args: all(args, f), within: within.as_ref().map(f) }
            }
            StepKind::Spawn { goal, args } => StepKind::Spawn { goal: *goal, args: all(args, f) },
            StepKind::Query(l) => StepKind::Query(l.lower(f)),
            StepKind::Test(c) => StepKind::Test(c.lower(f)),
            StepKind::Add(a) => StepKind::Add(a.lower(f)),
            StepKind::Remove(l) => StepKind::Remove(l.lower(f)),
            StepKind::Replace(a) => StepKind::Replace(a.lower(f)),
            StepKind::Abolish(l) => StepKind::Abolish(l.lower(f)),
            StepKind::Await { events, within } => {
                StepKind::Await { events: events.clone(), within: within.as_ref().map(f) }
            }
            StepKind::Wait { seconds } => StepKind::Wait { seconds: f(seconds) },
            StepKind::If { condition, then, otherwise } => StepKind::If {
                condition: condition.lower(f),
                then: steps(then, f),
                otherwise: steps(otherwise, f),
            },
            StepKind::While { condition, body } => {
                StepKind::While { condition: condition.lower(f), body: steps(body, f) }
            }
            StepKind::For { condition, body } => {
                StepKind::For { condition: condition.lower(f), body: steps(body, f) }
            }
            StepKind::Fork { branches, all } => {
                StepKind::Fork { branches: branches.iter().map(|b| steps(b, f)).collect(), all: *all }
            }
            StepKind::Send { to, performative, content, args } => StepKind::Send {
                to: to.as_ref().map(f),
                performative: *performative,
                content: *content,
                args: terms(args, f),
            },
            StepKind::Ask { to, content, args, within } => StepKind::Ask {
                to: f(to),
                content: *content,
                args: terms(args, f),
                within: within.as_ref().map(f),
            },
            StepKind::AskAll { to, template, content, args, out, within } => StepKind::AskAll {
                to: f(to),
                template: f(template),
                content: *content,
                args: terms(args, f),
                out: out.lower(f),
                within: within.as_ref().map(f),
            },
            StepKind::Print { args } => StepKind::Print { args: all(args, f) },
            StepKind::Control { what, goal } => {
                StepKind::Control { what: *what, goal: goal.as_ref().map(|(g, args)| (*g, terms(args, f))) }
            }
            StepKind::Fail => StepKind::Fail,
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
        let sample = |s: &Sample<E>| Sample { name: s.name.clone(), ty: s.ty, lo: f(&s.lo), hi: f(&s.hi) };
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
                let to = Point { of: to.of, offset: to.offset.each_ref().map(f) };
                WorldAction::Move { body: *body, to, over: f(over) }
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
        }
    }
}

// ── suites ──

impl<E> Suite<E> {
    /// The suite over the Program's expressions.
    #[must_use]
    pub fn lower(&self, f: LowerExpr<'_, E>) -> Suite {
        Suite {
            name: self.name.clone(),
            method: self.method.lower(f),
            tests: self.tests,
            horizon: self.horizon,
            patience: self.patience,
            origin: self.origin,
        }
    }
}

impl<E> Method<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Method {
        match self {
            Method::Agents { players, choose, explore, stop_after, goals, minimise } => Method::Agents {
                players: players.clone(),
                choose: choose.iter().map(|c| c.lower(f)).collect(),
                explore: *explore,
                stop_after: *stop_after,
                goals: goals.clone(),
                minimise: *minimise,
            },
            Method::Search { network, goals, witness, delays } => {
                Method::Search { network: *network, goals: goals.clone(), witness: *witness, delays: *delays }
            }
            Method::Random { stimuli, awaits, length_lo, length_hi, pause_lo, pause_hi } => Method::Random {
                stimuli: stimuli.clone(),
                awaits: awaits.clone(),
                length_lo: *length_lo,
                length_hi: *length_hi,
                pause_lo: *pause_lo,
                pause_hi: *pause_hi,
            },
        }
    }
}

impl<E> Choice<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> Choice {
        let condition = |c: &Condition<E>| Condition {
            context: c.context.lower(f),
            vars: c.vars.clone(),
            origin: c.origin,
        };
        Choice {
            agent: self.agent,
            belief: self.belief,
            how: self.how,
            condition: self.condition.as_ref().map(condition),
        }
    }
}

// ── automata ──

/// Where the variables of an automaton, a function or a query lie.
pub trait Slots<E, V> {
    /// The expression over slots.
    fn expr(&self, e: &E) -> Expr;

    /// The slot of a variable.
    fn slot(&self, of: &V) -> u16;
}

fn exprs<E, V>(es: &[E], slots: &dyn Slots<E, V>) -> Vec<Expr> {
    es.iter().map(|e| slots.expr(e)).collect()
}

impl<E, V> Place<E, V> {
    /// The place among slots.
    #[must_use]
    pub fn lower(&self, slots: &dyn Slots<E, V>) -> Place {
        let index = |i: &Index<E>| Index { at: slots.expr(&i.at), count: i.count, stride: i.stride };
        Place { slot: slots.slot(&self.slot), indices: self.indices.iter().map(index).collect() }
    }
}

impl<E> Location<E> {
    /// The location over slots.
    #[must_use]
    pub fn lower<V>(&self, slots: &dyn Slots<E, V>) -> Location {
        Location {
            name: self.name.clone(),
            kind: self.kind,
            invariant: self.invariant.iter().map(|c| c.lower(slots)).collect(),
            holds: self.holds.as_ref().map(|e| slots.expr(e)),
            origin: self.origin,
        }
    }
}

impl<E> ClockConstraint<E> {
    fn lower<V>(&self, slots: &dyn Slots<E, V>) -> ClockConstraint {
        ClockConstraint { clock: self.clock, minus: self.minus, op: self.op, bound: self.bound.lower(slots) }
    }
}

impl<E> Time<E> {
    fn lower<V>(&self, slots: &dyn Slots<E, V>) -> Time {
        let term = |t: &TimeTerm<E>| TimeTerm { factor: t.factor, value: slots.expr(&t.value) };
        Time { nanos: self.nanos, terms: self.terms.iter().map(term).collect() }
    }
}

impl<E, V> Edge<E, V> {
    /// The edge over slots.
    #[must_use]
    pub fn lower(&self, slots: &dyn Slots<E, V>) -> Edge {
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

impl<E> Sync<E> {
    fn lower<V>(&self, slots: &dyn Slots<E, V>) -> Sync {
        match self {
            Sync::Internal => Sync::Internal,
            Sync::Send { event, args } => Sync::Send { event: *event, args: exprs(args, slots) },
            Sync::Receive { event, args } => Sync::Receive { event: *event, args: args.clone() },
            Sync::Offer { channel, args } => Sync::Offer { channel: *channel, args: exprs(args, slots) },
            Sync::Accept { channel, args } => Sync::Accept { channel: *channel, args: args.clone() },
            Sync::Join { channel } => Sync::Join { channel: *channel },
        }
    }
}

impl<E, V> Update<E, V> {
    fn lower(&self, slots: &dyn Slots<E, V>) -> Update {
        match self {
            Update::Assign { place, value } => {
                Update::Assign { place: place.lower(slots), value: slots.expr(value) }
            }
            Update::Reset { clock, from, to } => {
                Update::Reset { clock: *clock, from: *from, to: to.lower(slots) }
            }
            Update::Call { function, args } => Update::Call { function: *function, args: exprs(args, slots) },
        }
    }
}

impl<E, V> Statement<E, V> {
    /// The statement over slots.
    #[must_use]
    pub fn lower(&self, slots: &dyn Slots<E, V>) -> Statement {
        let block = |of: &[Statement<E, V>]| of.iter().map(|s| s.lower(slots)).collect();
        match self {
            Statement::Assign { place, value } => {
                Statement::Assign { place: place.lower(slots), value: slots.expr(value) }
            }
            Statement::Call { function, args } => {
                Statement::Call { function: *function, args: exprs(args, slots) }
            }
            Statement::If { condition, then, otherwise } => Statement::If {
                condition: slots.expr(condition),
                then: block(then),
                otherwise: block(otherwise),
            },
            Statement::While { condition, body } => {
                Statement::While { condition: slots.expr(condition), body: block(body) }
            }
            Statement::For { slot, lo, hi, body } => Statement::For {
                slot: slots.slot(slot),
                lo: slots.expr(lo),
                hi: slots.expr(hi),
                body: block(body),
            },
            Statement::Return(value) => Statement::Return(value.as_ref().map(|v| slots.expr(v))),
        }
    }
}

// ── queries ──

impl<E> Ask<E> {
    /// The question over slots.
    #[must_use]
    pub fn lower<V>(&self, slots: &dyn Slots<E, V>) -> Ask {
        let measures = |of: &[Measure<E>]| of.iter().map(|m| m.lower(slots)).collect();
        match self {
            Ask::Possibly(f) => Ask::Possibly(f.lower(slots)),
            Ask::Invariantly(f) => Ask::Invariantly(f.lower(slots)),
            Ask::PotentiallyAlways(f) => Ask::PotentiallyAlways(f.lower(slots)),
            Ask::Eventually(f) => Ask::Eventually(f.lower(slots)),
            Ask::LeadsTo(f, g) => Ask::LeadsTo(f.lower(slots), g.lower(slots)),
            Ask::Sup { of, when } => Ask::Sup { of: measures(of), when: when.lower(slots) },
            Ask::Inf { of, when } => Ask::Inf { of: measures(of), when: when.lower(slots) },
        }
    }
}

impl<E> Formula<E> {
    fn lower<V>(&self, slots: &dyn Slots<E, V>) -> Formula {
        let each = |fs: &[Formula<E>]| fs.iter().map(|f| f.lower(slots)).collect();
        match self {
            Formula::At { automaton, location } => Formula::At { automaton: *automaton, location: *location },
            Formula::Data(e) => Formula::Data(slots.expr(e)),
            Formula::Clock(c) => Formula::Clock(c.lower(slots)),
            Formula::Deadlock => Formula::Deadlock,
            Formula::Not(f) => Formula::Not(Box::new(f.lower(slots))),
            Formula::And(fs) => Formula::And(each(fs)),
            Formula::Or(fs) => Formula::Or(each(fs)),
        }
    }
}

impl<E> Measure<E> {
    fn lower<V>(&self, slots: &dyn Slots<E, V>) -> Measure {
        match self {
            Measure::Clock(clock) => Measure::Clock(*clock),
            Measure::Data(e) => Measure::Data(slots.expr(e)),
        }
    }
}
