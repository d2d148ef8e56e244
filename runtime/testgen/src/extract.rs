//! From what happened in a model to an abstract test: the environment's stimuli, and what they waited for.
//!
//! A stimulus that followed an event which its actor's model waits for becomes "await that event, then the stimulus";
//! what is left of the time between becomes a wait. Where several actors do something, each gets a script of its own.

use std::{collections::BTreeMap, convert::Infallible};

use hrdsl_coverage::{CoverageCollector, TestCoverage};
use hrdsl_ir::{
    ActorId, EventId, EventPattern, Nanos, Program, Role, Value,
    bdi::{Agent, PlanStepKind, TriggerOn, each_step},
    event::{ArgPattern, StimulusStep},
    expr::Expr,
    suite::PlayerRef,
    ta::{ReceiveArg, SyncLabel},
    test::{TestScript, TestStep},
    value::nanos,
};
use hrdsl_trace::{Trace, TraceStepKind};

/// The groups of events that an actor's model waits for at once.
pub struct AwaitGroups {
    groups: Vec<AwaitGroup>,
    /// Whose stimuli take their time in the model: in an automaton's run they take none.
    timed: Vec<ActorId>,
}

struct AwaitGroup {
    actor: ActorId,
    events: Vec<EventPattern>,
    /// How long the model waits, if it says so with a constant.
    within: Option<Nanos>,
}

impl AwaitGroups {
    /// What the models that play environment actors wait for.
    #[must_use]
    pub fn of(program: &Program, players: &[PlayerRef]) -> Self {
        let (mut groups, mut timed) = (Vec::new(), Vec::new());
        for player in players {
            match player {
                PlayerRef::Agent(id) => {
                    let agent = &program.agents[id.0 as usize];
                    groups.extend(of_agent(program, agent));
                    timed.push(agent.actor);
                }
                PlayerRef::Automaton(id) => {
                    let automaton = &program.automata[id.0 as usize];
                    let Some(actor) = automaton.actor else { continue };
                    for location in 0..automaton.locations.len() {
                        let edges = automaton.edges.iter().filter(|e| e.from.0 as usize == location);
                        let events: Vec<EventPattern> = edges.filter_map(|e| received(&e.sync)).collect();
                        groups.push(AwaitGroup { actor, events, within: None });
                    }
                }
            }
        }
        // What an actor does itself is not awaited by a test.
        groups.retain_mut(|group: &mut AwaitGroup| {
            group.events.retain(|p| program.event(p.event).from != group.actor);
            program.actor(group.actor).role == Role::Environment
        });
        Self { groups, timed }
    }

    /// Those of one actor, with what only some events can be awaited of.
    fn of_actor(&self, actor: ActorId, awaited: impl Fn(EventId) -> bool) -> Vec<AwaitGroup> {
        let own = self.groups.iter().filter(|group| group.actor == actor);
        let awaited = own.map(|group| AwaitGroup {
            actor,
            events: group.events.iter().filter(|p| awaited(p.event)).cloned().collect(),
            within: group.within,
        });
        awaited.filter(|group| !group.events.is_empty()).collect()
    }
}

/// What an agent waits for: each `await`, then the events of plans for what it perceives.
fn of_agent(program: &Program, agent: &Agent) -> Vec<AwaitGroup> {
    let actor = agent.actor;
    let mut groups = Vec::new();
    for plan in &agent.plans {
        each_step(&plan.body, &mut |step| {
            if let PlanStepKind::Await { events, within } = &step.kind {
                let within = within.as_ref().and_then(constant);
                groups.push(AwaitGroup { actor, events: events.clone(), within });
            }
        });
    }
    let percept = |on: TriggerOn| match on {
        TriggerOn::Perceived(event) => Some(event),
        TriggerOn::BeliefAdded(b) => agent.beliefs.get(usize::from(b.0)).and_then(|b| b.percept),
        TriggerOn::BeliefRemoved(_)
        | TriggerOn::GoalAdded(_)
        | TriggerOn::GoalFailed(_)
        | TriggerOn::TestAdded(_)
        | TriggerOn::TestFailed(_) => None,
    };
    let perceived = agent.plans.iter().filter_map(|p| percept(p.trigger.on));
    groups.extend(perceived.map(|event| AwaitGroup {
        actor,
        events: vec![any(program, event)],
        within: None,
    }));
    groups
}

/// A time in seconds that does not depend on variables.
fn constant(seconds: &Expr) -> Option<Nanos> {
    seconds.eval(&|_| None).ok().and_then(Value::as_f64).map(nanos)
}

fn any(program: &Program, event: EventId) -> EventPattern {
    EventPattern { event, args: vec![ArgPattern::Any; program.event(event).params.len()] }
}

fn received(sync: &SyncLabel) -> Option<EventPattern> {
    let (event, args) = sync.as_receive()?;
    let args = args.iter().map(|a| match a {
        ReceiveArg::Match(pattern) => *pattern,
        ReceiveArg::Bind => ArgPattern::Any,
    });
    Some(EventPattern { event, args: args.collect() })
}

/// A stimulus of a trace.
struct DoneStimulus<'t> {
    /// Of its step in the trace.
    index: usize,
    time: Nanos,
    event: EventId,
    args: &'t [Value],
}

/// The test that stimulates what the trace shows: one script, or one for each actor that does something, if they are several.
/// `patience` bounds each await for which the model gives no time.
#[must_use]
pub fn scripts(program: &Program, awaits: &AwaitGroups, trace: &Trace, patience: Nanos) -> Vec<TestScript> {
    let mut done: BTreeMap<ActorId, Vec<DoneStimulus<'_>>> = BTreeMap::new();
    for (index, step) in trace.steps.iter().enumerate() {
        let TraceStepKind::Event { event, args } = &step.what else { continue };
        let declared = program.event(*event);
        if declared.is_stimulus() && program.actor(declared.from).role == Role::Environment {
            let stimulus = DoneStimulus { index, time: step.time, event: *event, args };
            done.entry(declared.from).or_default().push(stimulus);
        }
    }
    let is_system = |event: EventId| program.actor(program.event(event).from).role == Role::System;
    let alone = done.len() <= 1;
    let script = |(actor, done): (&ActorId, &Vec<DoneStimulus<'_>>)| {
        // What an actor who acts alone hears of the environment, it has done itself.
        let groups = awaits.of_actor(*actor, |event| !alone || is_system(event));
        let is_timed = awaits.timed.contains(actor);
        let steps = ScriptExtractor { program, trace, groups, patience, is_timed }.steps(done);
        TestScript { actor: Some(*actor).filter(|_| !alone), steps }
    };
    if done.is_empty() { TestScript::of_all(Vec::new()) } else { done.iter().map(script).collect() }
}

/// Whether the last stimulus of a trace comes later in a test than in the trace, since stimuli of its actor before it hold longer.
#[must_use]
pub fn is_late(program: &Program, trace: &Trace) -> bool {
    let mut free: BTreeMap<ActorId, Nanos> = BTreeMap::new();
    let mut late = false;
    for step in &trace.steps {
        let TraceStepKind::Event { event, args } = &step.what else { continue };
        let declared = program.event(*event);
        if !declared.is_stimulus() || program.actor(declared.from).role != Role::Environment {
            continue;
        }
        let free = free.entry(declared.from).or_default();
        late = *free > step.time;
        *free = step.time.max(*free) + held(program, *event, args, SampleEnd::Upper);
    }
    late
}

/// Makes the script of one actor.
struct ScriptExtractor<'a> {
    program: &'a Program,
    trace: &'a Trace,
    /// What its model waits for.
    groups: Vec<AwaitGroup>,
    patience: Nanos,
    /// Its stimuli take their time in the model.
    is_timed: bool,
}

impl ScriptExtractor<'_> {
    fn steps(&self, done: &[DoneStimulus<'_>]) -> Vec<TestStep> {
        let mut out = Vec::new();
        // When the script is free again, as far as the model's time goes, and the first trace step it has not looked at.
        let mut free: Nanos = 0;
        let mut looked = 0;
        for (at, stimulus) in done.iter().enumerate() {
            let (event, args) = (stimulus.event, stimulus.args);
            let between = self.trace.steps[looked..stimulus.index].iter().rev();
            if let Some((time, group)) = between.filter_map(|s| Some((s.time, self.group(&s.what)?))).next() {
                let within = group.within.unwrap_or(self.patience);
                out.push(TestStep::Await { events: group.events.clone(), within });
                free = free.max(time);
                looked = stimulus.index;
            }
            if stimulus.time > free {
                out.push(TestStep::Wait { time: stimulus.time - free });
            }
            let [shortest, longest] =
                [SampleEnd::Lower, SampleEnd::Upper].map(|end| self.held(stimulus, end));
            let next = done.get(at + 1).map(|next| next.time);
            let meanwhile =
                self.is_timed && next.is_some_and(|next| next < stimulus.time + shortest.min(longest));
            out.push(TestStep::Do { event, args: args.to_vec(), samples: Vec::new(), meanwhile });
            // A model's time that a sampled hold takes up is not waited a second time.
            free = stimulus.time + if meanwhile { 0 } else { longest };
        }
        out
    }

    /// The first group that waits for such an event.
    fn group(&self, what: &TraceStepKind) -> Option<&AwaitGroup> {
        let TraceStepKind::Event { event, args } = what else { return None };
        self.groups.iter().find(|group| group.events.iter().any(|p| p.matches(*event, args)))
    }

    fn held(&self, stimulus: &DoneStimulus<'_>, end: SampleEnd) -> Nanos {
        held(self.program, stimulus.event, stimulus.args, end)
    }
}

/// An end of the ranges that samples are drawn from.
#[derive(Clone, Copy)]
enum SampleEnd {
    Lower,
    Upper,
}

/// How long a stimulus holds: the sum of its holds, with its samples at this end of their ranges.
fn held(program: &Program, event: EventId, args: &[Value], end: SampleEnd) -> Nanos {
    let mut vars = args.to_vec();
    for sample in program.event(event).stimulus.iter().flat_map(|s| &s.samples) {
        let range = match end {
            SampleEnd::Lower => &sample.lo,
            SampleEnd::Upper => &sample.hi,
        };
        // A range without a value is found where it is drawn from.
        let Ok(value) = range.eval(&|i| vars.get(i as usize).copied()) else { return 0 };
        vars.push(value);
    }
    let eval = |e: &Expr| e.eval(&|i| vars.get(i as usize).copied()).ok();
    let hold = |step: &StimulusStep| match step {
        StimulusStep::Hold { seconds } => {
            nanos(eval(seconds).and_then(Value::as_f64).unwrap_or(0.0).max(0.0))
        }
        StimulusStep::Emit { .. } | StimulusStep::Act(_) | StimulusStep::If { .. } => 0,
    };
    taken(program, event, args).into_iter().map(hold).sum()
}

/// The steps that a stimulus takes with these arguments; a condition on samples counts as false.
pub fn taken<'p>(program: &'p Program, event: EventId, args: &[Value]) -> Vec<&'p StimulusStep> {
    let holds =
        |c: &Expr| Ok::<_, Infallible>(c.eval(&|i| args.get(i as usize).copied()) == Ok(Value::Bool(true)));
    let Some(stimulus) = &program.event(event).stimulus else { return Vec::new() };
    stimulus.taken(&holds).unwrap_or_else(|never| match never {})
}

/// The numbers of a trace, and the bins that it falls into.
#[must_use]
pub fn covered(program: &Program, trace: &Trace) -> TestCoverage {
    let mut collector = CoverageCollector::new(program);
    trace.replay(&mut collector);
    collector.finish()
}

/// Whether what happened keeps the scenario's assumptions.
#[must_use]
pub fn keeps_assumptions(program: &Program, trace: &Trace) -> bool {
    let events = trace.steps.iter().filter_map(|s| match &s.what {
        TraceStepKind::Event { event, args } => Some((s.time, *event, args.clone())),
        TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => None,
    });
    let events: Vec<_> = events.collect();
    hrdsl_coverage::assume::AssumptionChecker::allows(program, &events)
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Actor, Event, Span,
        bdi::{AgentId, BeliefDecl, BeliefId, Plan, PlanContext, PlanStep, PlanTrigger},
        expr::BinaryOp,
        value::SECOND,
    };

    use super::*;

    fn event(name: &str, from: u16) -> Event {
        Event {
            name: name.into(),
            params: vec![],
            from: ActorId(from),
            to: vec![],
            stimulus: None,
            origin: Span::default(),
        }
    }

    fn plan(on: TriggerOn, body: Vec<PlanStepKind>) -> Plan {
        Plan {
            label: "p".into(),
            atomic: false,
            trigger: PlanTrigger {
                name: Span::default(),
                origin: Span::default(),
                on,
                args: vec![],
                annotations: vec![],
            },
            context: PlanContext::True,
            body: steps_of(body),
            vars: vec![],
            origin: Span::default(),
        }
    }

    fn steps_of(body: Vec<PlanStepKind>) -> Vec<PlanStep> {
        body.into_iter().map(|kind| PlanStep { kind, origin: Span::default() }).collect()
    }

    fn awaits(event: u16, within: Option<Expr>) -> PlanStepKind {
        let events = vec![EventPattern { event: EventId(event), args: vec![] }];
        PlanStepKind::Await { events, within }
    }

    #[test]
    fn what_is_awaited_within_blocks_and_perceived_as_a_belief_makes_groups() {
        let sum = Expr::binary(BinaryOp::Add, Expr::float(1.5), Expr::float(2.0));
        let inner = vec![steps_of(vec![awaits(1, Some(Expr::Var(0)))]), steps_of(vec![awaits(0, None)])];
        let body = vec![awaits(0, Some(sum)), PlanStepKind::Fork { branches: inner, all: true }];
        let belief = |percept| BeliefDecl {
            negates: None,
            name: "b".into(),
            params: vec![],
            annotations: vec![],
            percept,
            origin: Span::default(),
        };
        let agent = Agent {
            name: "Human".into(),
            actor: ActorId(0),
            beliefs: vec![belief(None), belief(Some(EventId(1)))],
            goals: vec![],
            rules: vec![],
            jason: false,
            initial_beliefs: vec![],
            initial_goals: vec![],
            plans: vec![
                plan(TriggerOn::Perceived(EventId(0)), body),
                plan(TriggerOn::BeliefAdded(BeliefId(0)), vec![awaits(2, None)]),
                plan(TriggerOn::BeliefAdded(BeliefId(1)), vec![]),
            ],
            origin: Span::default(),
        };
        let actor = |name: &str, role| Actor { name: name.into(), role, origin: Span::default() };
        let program = Program {
            actors: vec![actor("person", Role::Environment), actor("robot", Role::System)],
            events: vec![event("offered", 1), event("released", 1), event("asked", 0)],
            agents: vec![agent],
            ..Program::default()
        };
        let groups =
            AwaitGroups::of(&program, &[PlayerRef::Agent(AgentId(0))]).of_actor(ActorId(0), |_| true);
        let found: Vec<(u16, Option<Nanos>)> =
            groups.iter().map(|g| (g.events[0].event.0, g.within)).collect();
        // What the person makes itself is not awaited by a test; a time that depends on a variable is not known.
        assert_eq!(found, [(0, Some(SECOND * 7 / 2)), (1, None), (0, None), (0, None), (1, None)]);
    }
}
