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
    Actor, ActorId, Event, EventId, Expr, Parameter, Program, Role, Span, Type, Value,
    bdi::{
        Agent, AgentTerm, Assertion, BeliefDecl, BeliefId, BeliefLiteral, ContentId, GoalDecl, GoalId,
        MessageContent, MessageSubject, Performative, Plan, PlanContext, PlanStep, PlanStepKind, PlanTrigger,
        TriggerOn,
    },
    expr::BinaryOp,
};

pub fn step(kind: PlanStepKind) -> PlanStep {
    PlanStep { kind, origin: Default::default() }
}

fn belief(name: &str, params: usize) -> BeliefDecl {
    let param = Parameter { name: "n".into(), ty: Type::Int { lo: 0, hi: 4 } };
    BeliefDecl {
        negates: None,
        name: name.into(),
        params: vec![param; params],
        annotations: vec![],
        percept: None,
        origin: Default::default(),
    }
}

pub fn holds(belief: u16, args: Vec<AgentTerm>) -> PlanContext {
    PlanContext::Belief(BeliefLiteral {
        origin: Span::default(),
        belief: BeliefId(belief),
        args,
        annotations: vec![],
    })
}

pub fn plan(
    label: &str,
    on: TriggerOn,
    args: Vec<AgentTerm>,
    context: PlanContext,
    body: Vec<PlanStepKind>,
) -> Plan {
    Plan {
        label: label.into(),
        atomic: false,
        trigger: PlanTrigger {
            name: Span::default(),
            origin: Span::default(),
            on,
            args,
            annotations: vec![],
        },
        context,
        body: body.into_iter().map(step).collect(),
        vars: vec!["N".into(), "M".into()],
        origin: Default::default(),
    }
}

fn agent(name: &str, actor: u16, beliefs: Vec<BeliefDecl>, goals: &[(&str, u16)], plans: Vec<Plan>) -> Agent {
    let goal = |(name, arity): &(&str, u16)| GoalDecl { name: (*name).into(), arity: *arity, params: None };
    Agent {
        name: name.into(),
        actor: ActorId(actor),
        beliefs,
        goals: goals.iter().map(goal).collect(),
        rules: vec![],
        jason: false,
        initial_beliefs: vec![],
        initial_goals: vec![],
        plans,
        origin: Default::default(),
    }
}

fn wait() -> PlanStepKind {
    PlanStepKind::Wait { seconds: Expr::float(1.0) }
}

fn int(n: i64) -> AgentTerm {
    AgentTerm::Expr(Expr::Const(Value::Int(n)))
}

fn human() -> Agent {
    let (table, leg) = (GoalId(0), GoalId(1));
    let achieve = |goal, args| PlanStepKind::Achieve { goal, args, within: None };
    let wanted = PlanContext::And(vec![
        holds(0, vec![AgentTerm::Var(0)]),
        PlanContext::Test(Expr::binary(BinaryOp::Gt, Expr::Var(0), Expr::int(0))),
        PlanContext::Not(Box::new(holds(2, vec![]))),
    ]);
    let tell = PlanStepKind::Send {
        to: Some(Expr::Var(1)),
        performative: Performative::Tell,
        content: ContentId(0),
        args: vec![AgentTerm::Var(0)],
        annotations: vec![],
    };
    let sulk = PlanStepKind::If {
        condition: holds(2, vec![]),
        then: vec![step(PlanStepKind::Spawn { goal: leg, args: vec![Expr::int(2)] })],
        otherwise: vec![],
    };
    let tired = PlanStepKind::Add(Assertion { belief: BeliefId(2), args: vec![], annotations: vec![] });
    let mut mood = plan("sit#1", TriggerOn::Perceived(EventId(0)), vec![], PlanContext::True, vec![sulk]);
    // The step within the block has site 1; `+tired` comes after it.
    mood.body.push(step(tired));
    let near = || holds(1, vec![AgentTerm::Any]);
    let on_leg = TriggerOn::GoalAdded(leg);
    let plans = vec![
        plan(
            "table#1",
            TriggerOn::GoalAdded(table),
            vec![],
            wanted,
            vec![achieve(leg, vec![Expr::int(1)]), tell, achieve(table, vec![])],
        ),
        plan("table#2", TriggerOn::GoalAdded(table), vec![], PlanContext::True, vec![]),
        plan("leg#1", on_leg, vec![int(1)], near(), vec![wait()]),
        plan("leg#2", on_leg, vec![int(2)], PlanContext::Or(vec![near(), holds(2, vec![])]), vec![wait()]),
        plan("leg#3", on_leg, vec![AgentTerm::Any], PlanContext::True, vec![PlanStepKind::Fail]),
        mood,
    ];
    let beliefs = vec![belief("wants", 1), belief("near", 1), belief("tired", 0)];
    agent("Human", 0, beliefs, &[("table", 0), ("leg", 1)], plans)
}

pub fn program() -> Program {
    let seen = plan(
        "seen#1",
        TriggerOn::BeliefAdded(BeliefId(0)),
        vec![AgentTerm::Any],
        PlanContext::True,
        vec![wait()],
    );
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
        contents: vec![MessageContent {
            name: "seen".into(),
            of: vec![None, Some(MessageSubject::Belief(BeliefId(0)))],
        }],
        ..Program::default()
    }
}
