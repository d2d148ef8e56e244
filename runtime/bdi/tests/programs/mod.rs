//! Small programs for measurements and properties, made by hand: each the AgentSpeak program of the same name in
//! `benches/agentspeak`.

use hrdsl_ir::{
    Actor, ActorId, Expr, Program, Role, Span, Symbol, Value,
    bdi::{
        Agent, AgentId, AgentTerm, ContentId, GoalDecl, GoalId, InitialFact, MessageContent, MessageSubject,
        Performative, Plan, PlanContext, PlanStep, PlanStepKind, PlanTrigger, TriggerOn,
    },
    expr::BinaryOp,
};

pub fn var(v: u16) -> Expr {
    Expr::Var(v)
}

pub fn less(a: Expr, b: Expr) -> PlanContext {
    PlanContext::Test(Expr::binary(BinaryOp::Lt, a, b))
}

pub fn plus(a: Expr, n: i64) -> Expr {
    Expr::binary(BinaryOp::Add, a, Expr::int(n))
}

pub fn agent(name: &str) -> Agent {
    Agent {
        name: name.to_owned(),
        actor: ActorId(0),
        beliefs: Vec::new(),
        goals: Vec::new(),
        rules: Vec::new(),
        jason: false,
        initial_beliefs: Vec::new(),
        initial_goals: Vec::new(),
        plans: Vec::new(),
        origin: Span::default(),
    }
}

pub fn goal(name: &str, arity: u16) -> GoalDecl {
    GoalDecl { name: name.to_owned(), arity, params: None }
}

pub fn plan(
    on: TriggerOn,
    args: Vec<AgentTerm>,
    context: PlanContext,
    body: Vec<PlanStepKind>,
    vars: usize,
) -> Plan {
    Plan {
        label: format!("{on:?}"),
        atomic: false,
        trigger: PlanTrigger {
            name: Span::default(),
            origin: Span::default(),
            on,
            args,
            annotations: Vec::new(),
        },
        context,
        body: body.into_iter().map(|kind| PlanStep { kind, origin: Span::default() }).collect(),
        vars: (0..vars).map(|v| format!("V{v}")).collect(),
        origin: Span::default(),
    }
}

pub fn achieve(goal: u16, args: Vec<Expr>) -> PlanStepKind {
    PlanStepKind::Achieve { goal: GoalId(goal), args, within: None }
}

pub fn program(agents: Vec<Agent>) -> Program {
    let me = Actor { name: "me".to_owned(), role: Role::Environment, origin: Span::default() };
    Program { actors: vec![me], agents, ..Program::default() }
}

/// Each agent of the program once, with no more beliefs than its own.
pub fn all(program: &Program) -> Vec<(AgentId, Vec<InitialFact>)> {
    (0..program.agents.len() as u16).map(|id| (AgentId(id), Vec::new())).collect()
}

/// `+!count(N) : N < LIMIT <- !count(N + 1).`
pub fn counter(limit: i64) -> Agent {
    let mut agent = agent("counter");
    agent.goals.push(goal("count", 1));
    agent.initial_goals.push((GoalId(0), vec![Value::Int(0)]));
    let on = TriggerOn::GoalAdded(GoalId(0));
    let args = || vec![AgentTerm::Var(0)];
    let more = less(var(0), Expr::int(limit));
    agent.plans.push(plan(on, args(), more, vec![achieve(0, vec![plus(var(0), 1)])], 1));
    agent.plans.push(plan(on, args(), PlanContext::True, vec![], 1));
    agent
}

/// `+!deep(N) : N < LIMIT <- !deep(N + 1); !nothing.`
pub fn deep(limit: i64) -> Program {
    let mut agent = agent("deep");
    agent.goals = vec![goal("deep", 1), goal("nothing", 0)];
    agent.initial_goals.push((GoalId(0), vec![Value::Int(0)]));
    let on = TriggerOn::GoalAdded(GoalId(0));
    let body = vec![achieve(0, vec![plus(var(0), 1)]), achieve(1, vec![])];
    agent.plans.push(plan(on, vec![AgentTerm::Var(0)], less(var(0), Expr::int(limit)), body, 1));
    agent.plans.push(plan(on, vec![AgentTerm::Any], PlanContext::True, vec![], 0));
    agent.plans.push(plan(TriggerOn::GoalAdded(GoalId(1)), vec![], PlanContext::True, vec![], 0));
    program(vec![agent])
}

/// Two agents that send a number to and fro: `+!ball(N) : N < LIMIT <- .send(other, achieve, ball(N + 1)).`
pub fn messages(limit: i64) -> Program {
    let player = |name: &str, other: &str| {
        let mut agent = agent(name);
        agent.goals.push(goal("ball", 1));
        let send = PlanStepKind::Send {
            to: Some(Expr::Const(Value::Symbol(Symbol::intern(other)))),
            performative: Performative::Achieve,
            content: ContentId(0),
            args: vec![AgentTerm::Expr(plus(var(0), 1))],
            annotations: vec![],
        };
        let on = TriggerOn::GoalAdded(GoalId(0));
        agent.plans.push(plan(on, vec![AgentTerm::Var(0)], less(var(0), Expr::int(limit)), vec![send], 1));
        agent.plans.push(plan(on, vec![AgentTerm::Any], PlanContext::True, vec![], 0));
        agent
    };
    let mut program = program(vec![player("ping", "pong"), player("pong", "ping")]);
    program.agents[0].initial_goals.push((GoalId(0), vec![Value::Int(0)]));
    let subject = Some(MessageSubject::Goal(GoalId(0)));
    program.contents.push(MessageContent { name: "ball".to_owned(), of: vec![subject; 2] });
    program
}

/// So many agents that each count so far.
pub fn crowd(agents: usize, goals: i64) -> Program {
    program((0..agents).map(|n| Agent { name: format!("counter{n}"), ..counter(goals) }).collect())
}
