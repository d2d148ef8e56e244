//! A small program for tests, as if it were written so:
//!
//! ```text
//! agent Human {
//!   plan +!table when wants(N) && N > 0 && not tired { !leg(1); .send(Robot, tell, seen(N)); !table }
//!   plan +!table { }
//!   plan +!leg(1) when near(_) { wait 1 s }
//!   plan +!leg(2) when near(_) || tired { wait 1 s }
//!   plan +!leg(_) { .fail }
//!   plan on discarded { +tired; if tired { !!leg(2) } }
//! }
//! agent Robot {
//!   plan +seen(_) { wait 1 s }
//! }
//! ```

use hrdsl_ir::{
    Actor, ActorId, Event, EventId, Expr, Param, Program, Role, Span, Type, Value,
    bdi::{
        Agent, Assertion, Belief, BeliefId, Content, ContentId, Context, Goal, GoalId, Literal, Performative,
        Plan, Step, StepKind, Subject, Term, Trigger, TriggerOn,
    },
    expr::BinaryOp,
};

pub fn step(kind: StepKind) -> Step {
    Step { kind, origin: Default::default() }
}

fn belief(name: &str, params: usize) -> Belief {
    let param = Param { name: "n".into(), ty: Type::Int { lo: 0, hi: 4 } };
    Belief {
        negates: None,
        name: name.into(),
        params: vec![param; params],
        annotations: vec![],
        percept: None,
        origin: Default::default(),
    }
}

pub fn holds(belief: u16, args: Vec<Term>) -> Context {
    Context::Belief(Literal { origin: Span::default(), belief: BeliefId(belief), args, annotations: vec![] })
}

pub fn plan(label: &str, on: TriggerOn, args: Vec<Term>, context: Context, body: Vec<StepKind>) -> Plan {
    Plan {
        label: label.into(),
        atomic: false,
        trigger: Trigger { name: Span::default(), origin: Span::default(), on, args, annotations: vec![] },
        context,
        body: body.into_iter().map(step).collect(),
        vars: vec!["N".into(), "M".into()],
        origin: Default::default(),
    }
}

fn agent(name: &str, actor: u16, beliefs: Vec<Belief>, goals: &[(&str, u16)], plans: Vec<Plan>) -> Agent {
    let goal = |(name, arity): &(&str, u16)| Goal { name: (*name).into(), arity: *arity, params: None };
    Agent {
        name: name.into(),
        actor: ActorId(actor),
        beliefs,
        goals: goals.iter().map(goal).collect(),
        rules: vec![],
        initial_beliefs: vec![],
        initial_goals: vec![],
        plans,
        origin: Default::default(),
    }
}

fn wait() -> StepKind {
    StepKind::Wait { seconds: Expr::float(1.0) }
}

fn int(n: i64) -> Term {
    Term::Expr(Expr::Const(Value::Int(n)))
}

fn human() -> Agent {
    let (table, leg) = (GoalId(0), GoalId(1));
    let achieve = |goal, args| StepKind::Achieve { goal, args, within: None };
    let wanted = Context::And(vec![
        holds(0, vec![Term::Var(0)]),
        Context::Test(Expr::binary(BinaryOp::Gt, Expr::Var(0), Expr::int(0))),
        Context::Not(Box::new(holds(2, vec![]))),
    ]);
    let tell = StepKind::Send {
        to: Some(Expr::Var(1)),
        performative: Performative::Tell,
        content: ContentId(0),
        args: vec![Term::Var(0)],
    };
    let sulk = StepKind::If {
        condition: holds(2, vec![]),
        then: vec![step(StepKind::Spawn { goal: leg, args: vec![Expr::int(2)] })],
        otherwise: vec![],
    };
    let tired = StepKind::Add(Assertion { belief: BeliefId(2), args: vec![], annotations: vec![] });
    let mut mood = plan("sit#1", TriggerOn::Perceived(EventId(0)), vec![], Context::True, vec![sulk]);
    // The step within the block has site 1; `+tired` comes after it.
    mood.body.push(step(tired));
    let near = || holds(1, vec![Term::Any]);
    let on_leg = TriggerOn::GoalAdded(leg);
    let plans = vec![
        plan(
            "table#1",
            TriggerOn::GoalAdded(table),
            vec![],
            wanted,
            vec![achieve(leg, vec![Expr::int(1)]), tell, achieve(table, vec![])],
        ),
        plan("table#2", TriggerOn::GoalAdded(table), vec![], Context::True, vec![]),
        plan("leg#1", on_leg, vec![int(1)], near(), vec![wait()]),
        plan("leg#2", on_leg, vec![int(2)], Context::Or(vec![near(), holds(2, vec![])]), vec![wait()]),
        plan("leg#3", on_leg, vec![Term::Any], Context::True, vec![StepKind::Fail]),
        mood,
    ];
    let beliefs = vec![belief("wants", 1), belief("near", 1), belief("tired", 0)];
    agent("Human", 0, beliefs, &[("table", 0), ("leg", 1)], plans)
}

pub fn program() -> Program {
    let seen =
        plan("seen#1", TriggerOn::BeliefAdded(BeliefId(0)), vec![Term::Any], Context::True, vec![wait()]);
    let robot = agent("Robot", 1, vec![belief("seen", 1)], &[], vec![seen]);
    let actor = |name: &str, role| Actor { name: name.into(), role, origin: Default::default() };
    let discarded = Event {
        name: "discarded".into(),
        params: vec![],
        from: ActorId(1),
        to: vec![],
        stimulus: None,
        origin: Default::default(),
    };
    Program {
        name: "table".into(),
        actors: vec![actor("person", Role::Environment), actor("robot", Role::System)],
        events: vec![discarded],
        agents: vec![human(), robot],
        contents: vec![Content { name: "seen".into(), of: vec![None, Some(Subject::Belief(BeliefId(0)))] }],
        ..Program::default()
    }
}
