//! Small agent programs by hand, and a harness of one agent that tells what happened line by line.

use std::collections::BTreeMap;

use hrdsl_bdi::{Action, ActionToken, Machine, Status};
use hrdsl_ir::{
    Actor, ActorId, ArgPattern, Event, EventId, EventPattern, Expr, Nanos, Param, Program, Role, Span,
    Symbol, Type, Value,
    bdi::{
        Agent, AgentId, Belief, BeliefId, Context, Fact, Goal, GoalId, Plan, Step, StepKind, Term, Trigger,
        TriggerOn,
    },
    expr::BinaryOp,
    value::{SECOND, seconds},
};

pub use BinaryOp::{Add, Div, Lt};
pub use StepKind::{Achieve, Query, Remove, Spawn};
pub use TriggerOn::{BeliefAdded, BeliefRemoved, GoalAdded, GoalFailed, Perceived, TestAdded};

/// A variable as a term, and as an expression.
pub fn v(var: u16) -> Term {
    Term::Var(var)
}
pub fn x(var: u16) -> Expr {
    Expr::Var(var)
}
/// An integer as a term, and as an expression.
pub fn n(value: i64) -> Term {
    Term::Expr(Expr::int(value))
}
pub fn i(value: i64) -> Expr {
    Expr::int(value)
}
/// A symbol as a value, as a term, and as an expression.
pub fn symbol(name: &str) -> Value {
    Value::Symbol(Symbol::intern(name))
}
pub fn named(name: &str) -> Term {
    Term::Expr(is(name))
}
pub fn is(name: &str) -> Expr {
    Expr::Const(symbol(name))
}
pub fn op(op: BinaryOp, a: Expr, b: Expr) -> Expr {
    Expr::binary(op, a, b)
}
pub fn plus1(e: Expr) -> Expr {
    op(Add, e, i(1))
}
pub fn holds<const N: usize>(belief: BeliefId, args: [Term; N]) -> Context {
    Context::Belief { belief, args: args.to_vec() }
}
pub fn not(context: Context) -> Context {
    Context::Not(Box::new(context))
}
pub fn all<const N: usize>(contexts: [Context; N]) -> Context {
    Context::And(contexts.to_vec())
}
pub fn lt(a: Expr, b: Expr) -> Context {
    Context::Test(op(Lt, a, b))
}
pub fn act<const N: usize>(event: EventId, args: [Expr; N]) -> StepKind {
    StepKind::Do { event, args: args.to_vec() }
}
pub fn achieve<const N: usize>(goal: GoalId, args: [Expr; N]) -> StepKind {
    Achieve { goal, args: args.to_vec() }
}
pub fn spawn<const N: usize>(goal: GoalId, args: [Expr; N]) -> StepKind {
    Spawn { goal, args: args.to_vec() }
}
pub fn query<const N: usize>(belief: BeliefId, args: [Term; N]) -> StepKind {
    Query { belief, args: args.to_vec() }
}
pub fn add<const N: usize>(belief: BeliefId, args: [Expr; N]) -> StepKind {
    StepKind::Add { belief, args: args.to_vec() }
}
pub fn remove<const N: usize>(belief: BeliefId, args: [Term; N]) -> StepKind {
    Remove { belief, args: args.to_vec() }
}
pub fn replace<const N: usize>(belief: BeliefId, args: [Expr; N]) -> StepKind {
    StepKind::Replace { belief, args: args.to_vec() }
}
pub fn wait(seconds: f64) -> StepKind {
    StepKind::Wait { seconds: Expr::float(seconds) }
}
/// `await event(args)`; an argument that is `None` may be anything.
pub fn wait_for<const N: usize>(event: EventId, args: [Option<i64>; N], within: Option<i64>) -> StepKind {
    let args = args.iter().map(|a| a.map_or(ArgPattern::Any, |n| ArgPattern::Is(Value::Int(n)))).collect();
    StepKind::Await { events: vec![EventPattern { event, args }], within: within.map(|s| s * SECOND) }
}
pub fn fact<const N: usize>(belief: BeliefId, args: [i64; N]) -> Fact {
    Fact { belief, args: args.iter().map(|n| Value::Int(*n)).collect() }
}

/// A program of one agent, and what the harness knows about it.
pub struct Scene {
    pub program: Program,
    pub chosen: Vec<Fact>,
    /// How long stimuli hold; others are done at once.
    holds: BTreeMap<EventId, Nanos>,
    pub inputs: Vec<(Nanos, EventId, Vec<Value>)>,
    pub cycle_limit: u64,
}

impl Scene {
    pub fn new() -> Self {
        let actor =
            |name: &str| Actor { name: name.into(), role: Role::Environment, origin: Span::default() };
        let agent = Agent {
            name: "Me".into(),
            actor: ActorId(0),
            beliefs: vec![],
            goals: vec![],
            initial_beliefs: vec![],
            initial_goals: vec![],
            plans: vec![],
            origin: Span::default(),
        };
        let program =
            Program { actors: vec![actor("me"), actor("other")], agents: vec![agent], ..Program::default() };
        Self { program, chosen: vec![], holds: BTreeMap::new(), inputs: vec![], cycle_limit: 1_000_000 }
    }

    pub fn agent(&mut self) -> &mut Agent {
        &mut self.program.agents[0]
    }

    /// A belief with arguments of -999..=999.
    pub fn belief(&mut self, name: &str, arity: usize) -> BeliefId {
        self.belief_of(name, &vec![Type::Int { lo: -999, hi: 999 }; arity])
    }

    pub fn belief_of(&mut self, name: &str, types: &[Type]) -> BeliefId {
        let params = types.iter().map(|ty| Param { name: "p".into(), ty: *ty }).collect();
        let beliefs = &mut self.agent().beliefs;
        beliefs.push(Belief { name: name.into(), params, origin: Span::default() });
        BeliefId(beliefs.len() as u16 - 1)
    }

    pub fn goal(&mut self, name: &str, arity: u16) -> GoalId {
        self.agent().goals.push(Goal { name: name.into(), arity });
        GoalId(self.agent().goals.len() as u16 - 1)
    }

    pub fn event(&mut self, name: &str, arity: usize) -> EventId {
        self.event_of(name, &vec![Type::Int { lo: -999_999, hi: 999_999 }; arity])
    }

    pub fn event_of(&mut self, name: &str, types: &[Type]) -> EventId {
        self.program.events.push(Event {
            name: name.into(),
            params: types.iter().map(|ty| Param { name: "p".into(), ty: *ty }).collect(),
            from: ActorId(0),
            to: vec![],
            stimulus: None,
            origin: Span::default(),
        });
        EventId(self.program.events.len() as u16 - 1)
    }

    /// An event that takes its doer this many seconds.
    pub fn stimulus(&mut self, name: &str, holds: i64) -> EventId {
        let event = self.event(name, 0);
        self.holds.insert(event, holds * SECOND);
        event
    }

    /// A plan labelled with the trigger's name and the plan's number; step `s` of plan `p` has its origin at `100 p + s`.
    pub fn plan<const A: usize, const B: usize>(
        &mut self,
        on: TriggerOn,
        args: [Term; A],
        context: Context,
        body: [StepKind; B],
    ) {
        let number = self.agent().plans.len() + 1;
        let name = match on {
            BeliefAdded(b) | BeliefRemoved(b) | TestAdded(b) => {
                self.agent().beliefs[b.0 as usize].name.clone()
            }
            GoalAdded(g) | GoalFailed(g) => self.agent().goals[g.0 as usize].name.clone(),
            Perceived(e) => self.program.event(e).name.clone(),
        };
        let origin = |at: usize| Span { start: at as u32, end: at as u32 + 1, ..Span::default() };
        let body = body.into_iter().enumerate();
        let plan = Plan {
            label: format!("{name}#{number}"),
            trigger: Trigger { on, args: args.to_vec() },
            context,
            body: body.map(|(s, kind)| Step { kind, origin: origin(100 * number + s) }).collect(),
            vars: (0..4).map(|v| format!("V{v}")).collect(),
            origin: origin(100 * number + 99),
        };
        self.agent().plans.push(plan);
    }

    pub fn start<const N: usize>(&mut self, goal: GoalId, args: [i64; N]) {
        let args = args.iter().map(|n| Value::Int(*n)).collect();
        self.agent().initial_goals.push((goal, args));
    }

    pub fn believe<const N: usize>(&mut self, belief: BeliefId, args: [i64; N]) {
        self.agent().initial_beliefs.push(fact(belief, args));
    }

    /// The agent perceives the event at this second.
    pub fn input<const N: usize>(&mut self, second: i64, event: EventId, args: [i64; N]) {
        let args = args.iter().map(|n| Value::Int(*n)).collect();
        self.inputs.push((second * SECOND, event, args));
    }

    pub fn machine(&self) -> Machine<'_> {
        let mut machine = Machine::new(&self.program, AgentId(0), &self.chosen);
        machine.set_cycle_limit(self.cycle_limit);
        machine
    }

    /// Runs the agent until nothing is left to happen. Each line is a time in seconds and a decision or an action; the
    /// last is how the agent stands.
    pub fn play(&self) -> Vec<String> {
        let mut machine = self.machine();
        let mut lines = vec![];
        let mut inputs = self.inputs.clone();
        inputs.sort_by_key(|(time, ..)| *time);
        inputs.reverse();
        let mut acting: Vec<(Nanos, ActionToken)> = vec![];
        let mut now = 0;
        loop {
            while let Some((_, event, args)) = inputs.pop_if(|(time, ..)| *time == now) {
                machine.perceive(event, &args, now);
            }
            for (_, token) in acting.extract_if(.., |(time, _)| *time == now) {
                machine.stimulus_done(token, now);
            }
            let mut out = vec![];
            machine.run(now, &mut out);
            self.tell(&mut machine, now, &out, &mut lines);
            acting.extend(out.iter().map(|a| (now + self.holds.get(&a.event).unwrap_or(&0), a.token)));
            let next = acting.iter().map(|(time, _)| *time).min();
            let next = [next, machine.next_wake(), inputs.last().map(|i| i.0)].into_iter().flatten().min();
            match next {
                Some(next) if machine.status() != Status::Livelock => now = next,
                Some(_) | None => break,
            }
        }
        lines.push(format!("{:?}", machine.status()));
        lines
    }

    fn tell(&self, machine: &mut Machine, now: Nanos, out: &[Action], lines: &mut Vec<String>) {
        for entry in machine.take_log() {
            lines.push(format!("{} {}", seconds(entry.time), machine.describe(&entry)));
        }
        for action in out {
            let args: Vec<String> = action.args.iter().map(|a| a.to_string()).collect();
            let name = &self.program.event(action.event).name;
            lines.push(format!("{} do {name} {}", seconds(now), args.join(" ")).trim_end().to_owned());
        }
    }

    /// Asserts what [`play`](Self::play) tells, one line for each, indentation aside.
    #[track_caller]
    pub fn tells(&self, expected: &str) {
        let expected: Vec<&str> = expected.lines().map(str::trim).filter(|l| !l.is_empty()).collect();
        let found = self.play();
        assert!(found == expected, "\nexpected:\n{}\nfound:\n{}", expected.join("\n"), found.join("\n"));
    }
}
