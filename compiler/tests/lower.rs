//! What small scenarios become, concern by concern.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{
    ActorId, ArgPattern, EventId, EventPattern, Expr, List, Program, Span, Symbol, Type, Unit, Value,
    bdi::{
        AgentTerm, Assertion, BeliefAnnotation, BeliefId, BeliefLiteral, ContentId, ControlAct, GoalId,
        InitialFact, InternalAct, MessageSubject, Performative, PlanContext, PlanStep, PlanStepKind,
        TriggerOn,
    },
    binding::{MessageEffect, MessageRead, TextOperand, place_text},
    coverage::{BinCondition, CoverpointId, CrossId},
    event::StimulusStep,
    expr::{BinaryOp, NumberFunction, UnaryOp},
    list::ListFunction,
    monitor::{MonitorEffect, MonitorTrigger},
    suite::{ChoiceKind, ExploreMode, ModelGoal, SearchGoal, SuiteMethod},
    ta::{
        AutomatonId, ChannelId, ChannelKind, ChannelParticipant, ClockConstraint, ClockId, ClockOp,
        EdgeAssignment, LocationKind, NetworkId, ReceiveArg, SyncLabel, TimeSum, TimeTerm,
    },
    test::TestStep,
    value::SECOND,
    world::{
        Axis, BodyId, BodyRef, BodyShape, CurrentId, GripperId, RuleTrigger, SignalId, SignalTerm as Measure,
        WorldAction,
    },
};

const ACTORS: &str = "actor person : environment\nactor robot : system\n";

fn program(text: &str) -> Program {
    let text = format!("scenario small\n{ACTORS}{text}");
    let c = compile(InputFile { name: "small.hri", text: &text }, &[]);
    let errors = c.diagnostics.iter().filter(|d| d.is_error());
    let said: Vec<String> = errors.map(|d| format!("{} {}", c.files.place(d.span()), d.message)).collect();
    assert_eq!(said, Vec::<String>::new());
    without_places(&c.program.unwrap())
}

/// The program with no span in it, so that it can be compared with what is written here.
fn without_places(program: &Program) -> Program {
    fn erase(value: &mut serde_json::Value) {
        if value.get("file").is_some() && value.get("start").is_some() {
            *value = serde_json::to_value(Span::default()).unwrap();
        }
        match value {
            serde_json::Value::Array(all) => all.iter_mut().for_each(erase),
            serde_json::Value::Object(all) => all.values_mut().for_each(erase),
            _ => {}
        }
    }
    let mut value = serde_json::to_value(program).unwrap();
    erase(&mut value);
    serde_json::from_value(value).unwrap()
}

fn op(op: BinaryOp, a: Expr, b: Expr) -> Expr {
    Expr::binary(op, a, b)
}

fn not(e: Expr) -> Expr {
    Expr::Unary(UnaryOp::Not, Box::new(e))
}

fn pattern(event: u16, args: &[ArgPattern]) -> EventPattern {
    EventPattern { event: EventId(event), args: args.to_vec() }
}

const TRUE: ArgPattern = ArgPattern::Is(Value::Bool(true));

#[test]
fn vocabulary_with_units_and_constants() {
    let p = program(
        "const N = 2 * 3\nconst D = N * 10 cm\nevent e(n: 0..N, d: length, ok: bool) from robot to person\n\
         stimulus s(ok: bool) by person {\n  sample a in if ok { 10 cm .. D } else { 0 m .. 1 m }\n  sample n in 1 .. 4\n\
           emit t(ok, a)\n  hold n * 1 s\n  if ok { hold 500 ms }\n}\nevent t(ok: bool, d: length) from person",
    );
    assert_eq!((p.name.as_str(), p.actors.len()), ("small", 2));
    let types: Vec<Type> = p.events[0].params.iter().map(|p| p.ty).collect();
    assert_eq!(types, [Type::Int { lo: 0, hi: 6 }, Type::Float(Unit::Metre), Type::Bool]);
    assert_eq!((p.events[0].from, p.events[0].to.clone()), (ActorId(1), vec![ActorId(0)]));
    let s = p.event(p.event_named("s").unwrap()).stimulus.clone().unwrap();
    // Parameter 0, then the samples 1 and 2.
    assert_eq!(
        s.samples[0].lo,
        Expr::If(Expr::Var(0).into(), Expr::float(0.1).into(), Expr::float(0.0).into())
    );
    assert_eq!(s.samples[0].ty, Type::Float(Unit::Metre));
    let Expr::If(_, hi, _) = &s.samples[0].hi else { panic!() };
    assert!((hi.eval(&|_| None).unwrap().as_f64().unwrap() - 0.6).abs() < 1e-12);
    assert_eq!(s.samples[1].ty, Type::Int { lo: 1, hi: 4 });
    let emit = StimulusStep::Emit { event: EventId(2), args: vec![Expr::Var(0), Expr::Var(1)] };
    let hold = StimulusStep::Hold { seconds: op(BinaryOp::Mul, Expr::Var(2), Expr::float(1.0)) };
    let half = vec![StimulusStep::Hold { seconds: Expr::float(0.5) }];
    let choice = StimulusStep::If { condition: Expr::Var(0), then: half, otherwise: Vec::new() };
    assert_eq!(s.steps, [emit, hold, choice]);
}

#[test]
fn agents_number_variables_in_the_order_of_their_places() {
    let p = program(
        "event asked(ok: bool) from robot\nstimulus s(n: 0..9) by person { hold 1 s }\n\
         agent A plays person {\n  belief had(n: 0..4) = had(0)\n  belief wants(n: 0..4)\n  belief away\n  goal !go(3)\n\
           plan +!go(L) when had(N) && not away && (wants(L) || wants(3)) && N < L { s(N + L); !go(N); ?wants(M); -had(_); -+had(M) }\n\
           plan @no -!go(_) { await asked(true) | asked within 2 s; wait 500 ms; !!go(1) }\n\
           plan on asked(X) when X { +away }\n}",
    );
    let a = &p.agents[0];
    assert_eq!(
        a.initial_beliefs,
        [InitialFact { belief: BeliefId(0), args: vec![Value::Int(0)], annotations: vec![] }]
    );
    assert_eq!(a.initial_goals, [(GoalId(0), vec![Value::Int(3)])]);
    let go = &a.plans[0];
    assert_eq!((go.label.as_str(), go.trigger.on), ("go#1", TriggerOn::GoalAdded(GoalId(0))));
    assert_eq!(go.vars, ["L", "N", "M"]);
    assert_eq!(go.trigger.args, [AgentTerm::Var(0)]);
    let literal =
        |b, args| BeliefLiteral { origin: Span::default(), belief: BeliefId(b), args, annotations: vec![] };
    let belief = |b, arg| PlanContext::Belief(literal(b, vec![arg]));
    let away = PlanContext::Belief(literal(2, vec![]));
    let either =
        PlanContext::Or(vec![belief(1, AgentTerm::Var(0)), belief(1, AgentTerm::Expr(Expr::int(3)))]);
    let less = PlanContext::Test(op(BinaryOp::Lt, Expr::Var(1), Expr::Var(0)));
    assert_eq!(
        go.context,
        PlanContext::And(vec![belief(0, AgentTerm::Var(1)), PlanContext::Not(Box::new(away)), either, less])
    );
    let steps: Vec<&PlanStepKind> = go.body.iter().map(|s| &s.kind).collect();
    let sum = op(BinaryOp::Add, Expr::Var(1), Expr::Var(0));
    assert_eq!(steps[0], &PlanStepKind::Do { event: EventId(1), args: vec![sum] });
    assert_eq!(steps[1], &PlanStepKind::Achieve { goal: GoalId(0), args: vec![Expr::Var(1)], within: None });
    assert_eq!(steps[2], &PlanStepKind::Query(literal(1, vec![AgentTerm::Var(2)])));
    assert_eq!(steps[3], &PlanStepKind::Remove(literal(0, vec![AgentTerm::Any])));
    assert_eq!(
        steps[4],
        &PlanStepKind::Replace(Assertion {
            belief: BeliefId(0),
            args: vec![Expr::Var(2)],
            annotations: vec![]
        })
    );
    let no = &a.plans[1];
    assert_eq!((no.label.as_str(), no.trigger.on), ("no", TriggerOn::GoalFailed(GoalId(0))));
    let events = vec![pattern(0, &[TRUE]), pattern(0, &[ArgPattern::Any])];
    assert_eq!(no.body[0].kind, PlanStepKind::Await { events, within: Some(Expr::float(2.0)) });
    assert_eq!(no.body[1].kind, PlanStepKind::Wait { seconds: Expr::float(0.5) });
    assert_eq!(no.body[2].kind, PlanStepKind::Spawn { goal: GoalId(0), args: vec![Expr::int(1)] });
    assert_eq!(a.plans[2].trigger.on, TriggerOn::Perceived(EventId(0)));
    assert_eq!(a.plans[2].context, PlanContext::Test(Expr::Var(0)));
}

/// The agents of a scenario with these members of the first, beside one that takes messages.
fn agents(members: &str) -> Program {
    program(&format!(
        "agent A plays person {{\n  belief b(n: 0..9) [sure: 0..100] = b(1), ~b(2), b(3)[source(R), sure(4)]\n  goal !go\n{members}\n}}\n\
         agent R plays robot {{\n  belief b(n: 0..9)\n  belief c(s: string, l: [int])\n  plan +!help(_) {{ }}\n}}\n"
    ))
}

/// The steps of the plan for `+!go`.
fn steps(body: &str) -> Vec<PlanStepKind> {
    let p = agents(&format!("  plan +!go {{ {body} }}\n  plan +!sub(_) {{ }}\n  plan -!go {{ }}"));
    p.agents[0].plans[0].body.iter().map(|s| s.kind.clone()).collect()
}

fn held(args: Vec<AgentTerm>) -> BeliefLiteral {
    BeliefLiteral { origin: Span::default(), belief: BeliefId(0), args, annotations: vec![] }
}

fn symbol(name: &str) -> Expr {
    Expr::Const(Value::Symbol(Symbol::intern(name)))
}

#[test]
fn beliefs_have_annotations_negations_percepts_and_rules() {
    let p = agents(
        "  belief light(ok: bool) on seen\n  belief near(n: 0..9)\n  rule near(N) when b(N)[sure(S)] && S > 2\n  rule near(7)\n\
           goal give(n: 0..9, who: agent)\n  plan @x[atomic] +!give(N, R)[source(S)] when ~b(N) { b2(S == R) }\n\
           plan -?near(N) { }\n  plan +!go { !give(1, R) }\n}\nevent seen(ok: bool) from robot\nevent b2(ok: bool) from person\nagent X plays person {",
    );
    let a = &p.agents[0];
    let names: Vec<&str> = a.beliefs.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["b", "light", "near", "~b"]);
    assert_eq!((a.beliefs[1].percept, a.beliefs[0].percept), (Some(EventId(0)), None));
    assert_eq!(a.beliefs[3].annotations, a.beliefs[0].annotations);
    assert_eq!(a.beliefs[0].annotations[0].name, "sure");
    let fact = |belief, n, annotations| InitialFact {
        belief: BeliefId(belief),
        args: vec![Value::Int(n)],
        annotations,
    };
    let sourced = vec![
        (BeliefAnnotation::Source, Value::Symbol(Symbol::intern("R"))),
        (BeliefAnnotation::Declared(0), Value::Int(4)),
    ];
    assert_eq!(a.initial_beliefs, [fact(0, 1, vec![]), fact(3, 2, vec![]), fact(0, 3, sourced)]);
    let rule = &a.rules[0];
    assert_eq!(
        (rule.belief, &rule.args, &rule.vars[..]),
        (BeliefId(2), &vec![AgentTerm::Var(0)], &["N".into(), "S".into()][..])
    );
    let sure = BeliefLiteral {
        annotations: vec![(BeliefAnnotation::Declared(0), AgentTerm::Var(1))],
        ..held(vec![AgentTerm::Var(0)])
    };
    let more = PlanContext::Test(op(BinaryOp::Gt, Expr::Var(1), Expr::int(2)));
    assert_eq!(rule.body, PlanContext::And(vec![PlanContext::Belief(sure), more]));
    assert_eq!(
        (&a.rules[1].args, &a.rules[1].body),
        (&vec![AgentTerm::Expr(Expr::int(7))], &PlanContext::True)
    );
    let Some(params) = &a.goals[0].params else { panic!() };
    assert_eq!((a.goals[0].arity, params[0].ty), (2, Type::Int { lo: 0, hi: 9 }));
    let Type::Enum(agent) = params[1].ty else { panic!() };
    let names: Vec<&str> = agent.values().iter().map(|v| v.name()).collect();
    assert_eq!((agent.name(), &names[..]), ("agent", &["A", "X", "R", "self", "percept"][..]));
    assert_eq!((a.goals[1].arity, &a.goals[1].params), (0, &None));
    let give = &a.plans[0];
    assert!(give.atomic && !a.plans[1].atomic);
    assert_eq!(give.trigger.annotations, [(BeliefAnnotation::Source, AgentTerm::Var(1))]);
    // `R` is the agent.
    assert_eq!(give.trigger.args, [AgentTerm::Var(0), AgentTerm::Expr(symbol("R"))]);
    assert_eq!(a.plans[1].trigger.on, TriggerOn::TestFailed(BeliefId(2)));
}

#[test]
fn blocks_keep_their_steps() {
    let any = || PlanContext::Belief(held(vec![AgentTerm::Any]));
    let print =
        |n: i64| PlanStep { kind: PlanStepKind::Print { args: vec![Expr::int(n)] }, origin: Span::default() };
    let got = steps(
        "if b(_) { .print(1) } else if b(_) { .print(2) } while b(_) { .print(3) } for b(_) { .print(4) }\n\
         fork { .print(5) } and { .print(6) }; fork { .print(7) } or { }",
    );
    let inner = PlanStepKind::If { condition: any(), then: vec![print(2)], otherwise: vec![] };
    let inner = PlanStep { kind: inner, origin: Span::default() };
    let want = vec![
        PlanStepKind::If { condition: any(), then: vec![print(1)], otherwise: vec![inner] },
        PlanStepKind::While { condition: any(), body: vec![print(3)] },
        PlanStepKind::For { condition: any(), body: vec![print(4)] },
        PlanStepKind::Fork { branches: vec![vec![print(5)], vec![print(6)]], all: true },
        PlanStepKind::Fork { branches: vec![vec![print(7)], vec![]], all: false },
    ];
    assert_eq!(got, want);
}

#[test]
fn formulas_match_lists_and_ask() {
    let got = steps(
        "?([H, _ | T] = [1, 2, 3] && X = H + 1 && not b(X)); .count(b(_), N); .findall([M, N], b(M), L);\n\
         .setof(M, b(M), K); .member(E0, K); .nth(0, [1], E)",
    );
    let list = Expr::Const(Value::List(List::of(&[Value::Int(1), Value::Int(2), Value::Int(3)])));
    let pattern = AgentTerm::List(vec![AgentTerm::Var(0), AgentTerm::Any], Some(Box::new(AgentTerm::Var(1))));
    let absent = PlanContext::Not(Box::new(PlanContext::Belief(held(vec![AgentTerm::Var(2)]))));
    let sum = op(BinaryOp::Add, Expr::Var(0), Expr::int(1));
    let first = vec![PlanContext::Unify(pattern, list), PlanContext::Unify(AgentTerm::Var(2), sum), absent];
    assert_eq!(got[0], PlanStepKind::Test(PlanContext::And(first)));
    let asks = |i: InternalAct| PlanStepKind::Test(PlanContext::Internal(Box::new(i), Span::default()));
    let formula = |arg| PlanContext::Belief(held(vec![arg]));
    assert_eq!(got[1], asks(InternalAct::Count { formula: formula(AgentTerm::Any), out: AgentTerm::Var(3) }));
    let template = Expr::List(vec![Expr::Var(4), Expr::Var(3)], None);
    let all = InternalAct::FindAll {
        template,
        formula: formula(AgentTerm::Var(4)),
        set: false,
        out: AgentTerm::Var(5),
    };
    assert_eq!(got[2], asks(all));
    // The variable of the formula is open again.
    let set = InternalAct::FindAll {
        template: Expr::Var(4),
        formula: formula(AgentTerm::Var(4)),
        set: true,
        out: AgentTerm::Var(6),
    };
    assert_eq!(got[3], asks(set));
    assert_eq!(got[4], asks(InternalAct::Member { element: AgentTerm::Var(7), list: Expr::Var(6) }));
    let one = Expr::Const(Value::List(List::of(&[Value::Int(1)])));
    let nth = InternalAct::Apply {
        function: ListFunction::Nth,
        args: vec![Expr::int(0), one],
        out: AgentTerm::Var(8),
    };
    assert_eq!(got[5], asks(nth));
}

#[test]
fn messages_are_about_what_each_agent_has() {
    let p = agents(
        "  plan +!go {\n    .send(R, tell, b(1)); .send(R, untell, b(_)); .broadcast(achieve, help(2));\n\
             .ask(R, b(X), 5 s); .ask_all(R, S, c(S, _), L); .send(R, tell, ~b(X)); .print(L)\n  }\n  plan -!go { }",
    );
    let names: Vec<&str> = p.contents.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["b", "help", "c", "~b"]);
    let belief = |id| Some(MessageSubject::Belief(BeliefId(id)));
    assert_eq!(p.contents[0].of, [belief(0), belief(0)]);
    assert_eq!(p.contents[1].of, [None, Some(MessageSubject::Goal(GoalId(0)))]);
    assert_eq!(p.contents[2].of, [None, belief(1)]);
    assert_eq!(p.contents[3].of, [belief(1), belief(2)]);
    let body: Vec<&PlanStepKind> = p.agents[0].plans[0].body.iter().map(|s| &s.kind).collect();
    let to = || Some(symbol("R"));
    let send = |to, performative, content, arg| PlanStepKind::Send {
        to,
        performative,
        content: ContentId(content),
        args: vec![arg],
        annotations: vec![],
    };
    let one = || AgentTerm::Expr(Expr::int(1));
    assert_eq!(body[0], &send(to(), Performative::Tell, 0, one()));
    assert_eq!(body[1], &send(to(), Performative::Untell, 0, AgentTerm::Any));
    assert_eq!(body[2], &send(None, Performative::Achieve, 1, AgentTerm::Expr(Expr::int(2))));
    let ask = PlanStepKind::Ask {
        to: symbol("R"),
        content: ContentId(0),
        args: vec![AgentTerm::Var(0)],
        within: Some(Expr::float(5.0)),
    };
    assert_eq!(body[3], &ask);
    let all = PlanStepKind::AskAll {
        to: symbol("R"),
        template: Expr::Var(1),
        content: ContentId(2),
        args: vec![AgentTerm::Var(1), AgentTerm::Any],
        out: AgentTerm::Var(2),
        within: None,
    };
    assert_eq!(body[4], &all);
    assert_eq!(body[5], &send(to(), Performative::Tell, 3, AgentTerm::Expr(Expr::Var(0))));
}

#[test]
fn goals_are_bounded_dropped_and_suspended() {
    let got = steps(
        "!sub(1) within 2 s; .drop_intention(sub(_)); .drop_desire(sub); .drop_all_events; .suspend; .resume(sub(2));\n\
         .fail_goal(go); .abolish(b(_)); +b(1)[sure(9)]; -b(_)[source(_)]; .fail",
    );
    let within = Some(Expr::float(2.0));
    assert_eq!(got[0], PlanStepKind::Achieve { goal: GoalId(1), args: vec![Expr::int(1)], within });
    let control = |what, goal| PlanStepKind::Control { what, goal };
    let sub = |arg| Some((GoalId(1), vec![arg]));
    assert_eq!(got[1], control(ControlAct::DropIntention, sub(AgentTerm::Any)));
    assert_eq!(got[2], control(ControlAct::DropDesire, sub(AgentTerm::Any)));
    assert_eq!(got[3], control(ControlAct::DropEvent, None));
    assert_eq!(got[4], control(ControlAct::Suspend, None));
    assert_eq!(got[5], control(ControlAct::Resume, sub(AgentTerm::Expr(Expr::int(2)))));
    assert_eq!(got[6], control(ControlAct::FailGoal, Some((GoalId(0), vec![]))));
    assert_eq!(got[7], PlanStepKind::Abolish(held(vec![AgentTerm::Any])));
    let annotations = vec![(BeliefAnnotation::Declared(0), Expr::int(9))];
    assert_eq!(
        got[8],
        PlanStepKind::Add(Assertion { belief: BeliefId(0), args: vec![Expr::int(1)], annotations })
    );
    let any = vec![(BeliefAnnotation::Source, AgentTerm::Any)];
    assert_eq!(
        got[9],
        PlanStepKind::Remove(BeliefLiteral { annotations: any, ..held(vec![AgentTerm::Any]) })
    );
    assert_eq!(got[10], PlanStepKind::Fail);
}

#[test]
fn suites_by_agents_reach_and_stop() {
    let p = program(
        "event e from person\nagent A plays person { goal !g  plan +!g { e } }\ncover c = count(e) bins no = 0, some = 1..\n\
         cross x = c { bin \"some\" when c.some }\n\
         suite s by agents A { explore wise(3)\n stop after 20\n minimise\n reach each plan\n reach each context\n reach each edge\n\
           reach each message\n reach each path\n reach each bin of x }\nsuite t by agents A { explore pairwise }\nsuite u by agents A { explore learn }",
    );
    let SuiteMethod::Agents { explore, stop_after, goals, minimise, .. } = &p.suites[0].method else {
        panic!()
    };
    assert_eq!((*explore, *stop_after, *minimise), (ExploreMode::Wise(3), Some(20), true));
    use ModelGoal::{Bins, Contexts, Edges, Messages, Paths, Plans};
    assert_eq!(goals[..], [Plans, Contexts, Edges, Messages, Paths, Bins(CrossId(0))]);
    let explore = |i: usize| match &p.suites[i].method {
        SuiteMethod::Agents { explore, .. } => *explore,
        SuiteMethod::Search { .. } | SuiteMethod::Random { .. } => panic!(),
    };
    assert_eq!((explore(1), explore(2)), (ExploreMode::Wise(2), ExploreMode::Learn));
}

#[test]
fn automata_count_slots_from_shared_to_binders() {
    let p = program(
        "event got(n: 0..3, ok: bool) from robot\nvar s: bool = true\nvar r: -2..-1\n\
         automaton A plays person {\n  clock x, y\n  var v: 0..3 = 1\n  location a { invariant x <= 3 s && 4 s > y }\n\
           init urgent location b\n  a -> b select k: 0..5 when x >= 1 s && v < k && x - y < 2 s && s && 2 s == y on got(n, true) do v = n + k; s = false; x = 0\n\
           b -> a on got(v, _) do v -= 1\n}\n\
         automaton R plays robot { init committed location a\n a -> a do got(2, false) }\nnetwork n = A | R",
    );
    assert_eq!((p.shared[0].is_bool, p.shared[0].init, p.shared[1].init), (true, 1, -1));
    let a = &p.automata[0];
    assert_eq!((a.initial.0, a.locations[1].kind), (1, LocationKind::Urgent));
    let bound =
        |c: &hrdsl_ir::ta::ClockConstraint| (c.clock.0, c.minus.map(|m| m.0), c.op, c.bound.nanos / SECOND);
    let invariant: Vec<_> = a.locations[0].invariant.iter().map(bound).collect();
    assert_eq!(invariant, [(0, None, ClockOp::Le, 3), (1, None, ClockOp::Lt, 4)]);
    let e = &a.edges[0];
    let guard: Vec<_> = e.clock_guard.iter().map(bound).collect();
    assert_eq!(guard, [(0, None, ClockOp::Ge, 1), (0, Some(1), ClockOp::Lt, 2), (1, None, ClockOp::Eq, 2)]);
    // s 0, r 1, v 2, k 3, n 4
    let less = op(BinaryOp::Lt, Expr::Var(2), Expr::Var(3));
    assert_eq!(e.guard, Some(op(BinaryOp::And, less, Expr::Var(0))));
    assert_eq!((e.selects[0].lo, e.selects[0].hi, e.selects[0].is_bool), (0, 5, false));
    assert_eq!(
        e.sync,
        SyncLabel::Receive { event: EventId(0), args: vec![ReceiveArg::Bind, ReceiveArg::Match(TRUE)] }
    );
    let sum = op(BinaryOp::Add, Expr::Var(4), Expr::Var(3));
    assert_eq!(e.updates[0], EdgeAssignment::Assign { place: hrdsl_ir::expr::Lvalue::slot(2), value: sum });
    assert_eq!(
        e.updates[1],
        EdgeAssignment::Assign { place: hrdsl_ir::expr::Lvalue::slot(0), value: Expr::bool(false) }
    );
    assert!(matches!(e.updates[2], EdgeAssignment::Reset { clock, .. } if clock.0 == 0));
    // A variable in `on` is compared.
    let e = &a.edges[1];
    let any = ReceiveArg::Match(ArgPattern::Any);
    assert_eq!(e.sync, SyncLabel::Receive { event: EventId(0), args: vec![ReceiveArg::Bind, any] });
    assert_eq!(e.guard, Some(op(BinaryOp::Eq, Expr::Var(3), Expr::Var(2))));
    assert_eq!(
        e.updates,
        [EdgeAssignment::Assign {
            place: hrdsl_ir::expr::Lvalue::slot(2),
            value: op(BinaryOp::Sub, Expr::Var(2), Expr::int(1))
        }]
    );
    let send = SyncLabel::Send { event: EventId(0), args: vec![Expr::int(2), Expr::bool(false)] };
    assert_eq!(p.automata[1].edges[0].sync, send);
    assert_eq!(p.networks[0].automata.len(), 2);
}

#[test]
fn what_a_stimulus_emits_follows_through_committed_locations() {
    let p = program(
        "event e from person\nevent f(ok: bool, n: 0..3) from person\nstimulus plain by person { hold 1 s }\n\
         stimulus one by person { hold 1 s; emit e }\n\
         stimulus two(ok: bool) by person { emit e; if ok { emit f(ok, 2) } else { hold 1 s } }\n\
         automaton A plays person {\n  clock x\n  var v: 0..3\n  init location a\n  location b\n\
           a -> b when x >= 1 s do plain; x = 0\n  a -> b when x >= 1 s do one; x = 0\n  a -> a do two(true)\n\
           a -> b do two(false)\n  b -> a select k: bool do two(k); v = 3\n}",
    );
    let a = &p.automata[0];
    let names: Vec<&str> = a.locations.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "a.b~1", "a.a~1", "a.a~2", "a.b~2", "b.a~1", "b.a~2"]);
    assert!(a.locations[2..].iter().all(|l| l.kind == LocationKind::Committed));
    let edge = |i: usize| {
        let e = &a.edges[i];
        let event = match &e.sync {
            SyncLabel::Send { event, .. } => p.event(*event).name.as_str(),
            SyncLabel::Offer { .. }
            | SyncLabel::Accept { .. }
            | SyncLabel::Join { .. }
            | SyncLabel::Internal
            | SyncLabel::Receive { .. } => "-",
        };
        (e.from.0, event, e.to.0, e.clock_guard.len(), e.updates.len())
    };
    assert_eq!(edge(0), (0, "plain", 1, 1, 1));
    // Guard and updates are on the first edge.
    assert_eq!([edge(1), edge(2)], [(0, "one", 2, 1, 1), (2, "e", 1, 0, 0)]);
    assert_eq!([edge(3), edge(4), edge(5)], [(0, "two", 3, 0, 0), (3, "e", 4, 0, 0), (4, "f", 0, 0, 0)]);
    // `two(false)` does not emit `f`.
    assert_eq!([edge(6), edge(7)], [(0, "two", 5, 0, 0), (5, "e", 1, 0, 0)]);
    // `two(k)`: the argument is kept until the end of the chain; v 0, kept 1, k 2.
    assert_eq!(a.vars.len(), 2);
    assert!(a.vars[1].is_bool && a.vars[1].name.contains('~'));
    assert_eq!([edge(8), edge(9)], [(1, "two", 6, 0, 2), (6, "e", 7, 0, 0)]);
    assert_eq!([edge(10), edge(11)], [(7, "f", 0, 0, 1), (7, "-", 0, 0, 1)]);
    assert_eq!(
        a.edges[8].updates[0],
        EdgeAssignment::Assign { place: hrdsl_ir::expr::Lvalue::slot(1), value: Expr::Var(2) }
    );
    assert_eq!(a.edges[10].guard, Some(Expr::Var(1)));
    assert_eq!(a.edges[11].guard, Some(not(Expr::Var(1))));
    assert_eq!(
        a.edges[10].updates,
        [EdgeAssignment::Assign { place: hrdsl_ir::expr::Lvalue::slot(1), value: Expr::bool(false) }]
    );
    let sent = SyncLabel::Send { event: EventId(1), args: vec![Expr::Var(1), Expr::int(2)] };
    assert_eq!(a.edges[10].sync, sent);
}

const WORLD: &str = "part hands {\n  body palm: kinematic box(1 cm, 2 cm, 3 cm) at (1 m, 0 m, 0 m) rotated (0 deg, 90 deg, 0 deg)\n\
    body tip: dynamic capsule(1 cm, 5 cm) at (2 m, 0 m, 0 m) mass 100 g\n\
    joint j: palm -> tip at (1 m, 1 m, 0 m) axis (0, 2, 0) limits -90 deg .. 90 deg\n\
    arm reach_: j tip tip tool (1 cm, 0 m, 0 m) speed 1 rad/s\n  gripper grip: palm tool (0 m, 0 m, 0 m) reach 4 cm delay 500 ms\n}\n\
  world {\n  part robot = hands at (0 m, 0 m, 1 m) rotated (0 deg, 0 deg, 90 deg)\n\
    body cup: dynamic sphere(5 cm) at (0 m, 0 m, 0 m) mass 1 kg graspable\n  body mug: dynamic sphere(5 cm) at (1 m, 0 m, 0 m) mass 1 kg graspable\n\
    current drink in cup, mug by robot.grip\n\
    signal near: bool to robot = distance(robot.palm, drink) < 5 cm && abs(drink.z) < 1 m\n\
    signal close: bool to robot = near && holds(robot.grip)\n  signal high: length to robot = cup.z\n\
    on read when range(robot.palm, cup) < 2 m && near emit said(close, high)\n  on close robot.grip emit closed\n}\n\
  event read from robot\nevent said(ok: bool, z: length) from person\nevent closed from robot\n";

#[test]
fn worlds_have_their_parts_in_place() {
    let p = program(&format!(
        "{WORLD}stimulus s(d: length) by person {{\n  robot.palm.move_to(drink + (d, 0 m, 1 cm), 2 s)\n\
           robot.palm.move_to((1 m, 0 m, d), 1 s)\n  robot.palm.move_to(cup, 1 s)\n\
           robot.palm.look_at(drink, 1 cm, d, 90 deg)\n  robot.grip.grasp()\n  robot.grip.let_go()\n}}"
    ));
    let w = p.world.as_ref().unwrap();
    assert_eq!((w.step, w.sample, w.gravity), (SECOND / 100, SECOND / 20, [0.0, 0.0, -9.81]));
    let palm = &w.bodies[0];
    assert_eq!((palm.name.as_str(), palm.position), ("robot.palm", [0.0, 1.0, 1.0]));
    let quarter = std::f64::consts::FRAC_PI_2;
    assert_eq!(palm.rotation, [0.0, quarter, quarter]);
    assert_eq!(palm.shape, BodyShape::Box { size: [0.01, 0.02, 0.03] });
    let j = &w.joints[0];
    assert_eq!((j.name.as_str(), j.anchor, j.axis), ("robot.j", [-1.0, 1.0, 1.0], [-1.0, 0.0, 0.0]));
    assert_eq!((j.lo, j.hi, w.arms[0].max_speed), (-quarter, quarter, 1.0));
    assert_eq!(w.grippers[0].holds, [BodyId(2), BodyId(3)]);
    assert_eq!((w.grippers[0].delay, w.currents[0].of.len()), (SECOND / 2, 2));

    let (palm, drink) = (BodyRef::Body(BodyId(0)), BodyRef::Current(CurrentId(0)));
    let cup = BodyRef::Body(BodyId(2));
    let near = &p.signals[0];
    assert_eq!(near.terms, [Measure::Distance(palm, drink), Measure::Coordinate(drink, Axis::Z)]);
    let close = op(BinaryOp::Lt, Expr::Var(0), Expr::float(0.05));
    let low = op(BinaryOp::Lt, Expr::Call(NumberFunction::Abs, vec![Expr::Var(1)]), Expr::float(1.0));
    assert_eq!(near.value, op(BinaryOp::And, close, low));
    // An earlier signal is put in.
    assert_eq!(p.signals[1].terms.len(), 3);
    assert_eq!(p.signals[1].value, op(BinaryOp::And, near.value.clone(), Expr::Var(2)));
    assert_eq!(p.signals[3].name, "range(robot.palm, cup)");
    assert!(p.signals.iter().all(|s| !s.recorded));
    let rule = &w.rules[0];
    assert_eq!(rule.signals, [SignalId(3), SignalId(0), SignalId(1), SignalId(2)]);
    let ranged = op(BinaryOp::Lt, Expr::Var(0), Expr::float(2.0));
    assert_eq!(rule.guard, Some(op(BinaryOp::And, ranged, Expr::Var(1))));
    assert_eq!(rule.args, [Expr::Var(2), Expr::Var(3)]);
    let RuleTrigger::Commanded { device, command } = w.rules[1].on else { panic!("{:?}", w.rules[1].on) };
    assert_eq!(
        (w.device(device).name.as_str(), w.command(device, command).name.as_str()),
        ("robot.grip", "close")
    );

    let steps = p.event(p.event_named("s").unwrap()).stimulus.clone().unwrap().steps;
    let acts: Vec<WorldAction> =
        steps.into_iter().map(|s| if let StimulusStep::Act(a) = s { a } else { panic!("{s:?}") }).collect();
    let WorldAction::Move { body: BodyId(0), to, over } = &acts[0] else { panic!() };
    assert_eq!((to.of, over), (Some(drink), &Expr::float(2.0)));
    assert_eq!(to.offset, [Expr::Var(0), Expr::float(0.0), Expr::float(0.01)]);
    let WorldAction::Move { to, .. } = &acts[1] else { panic!() };
    assert_eq!((to.of, &to.offset[2]), (None, &Expr::Var(0)));
    let WorldAction::Move { to, .. } = &acts[2] else { panic!() };
    assert_eq!((to.of, &to.offset[2]), (Some(cup), &Expr::float(0.0)));
    let WorldAction::Look { at, angle, .. } = &acts[3] else { panic!() };
    assert_eq!((*at, angle), (drink, &Expr::float(quarter)));
    assert_eq!(acts[4], WorldAction::Grasp { gripper: GripperId(0) });
    assert_eq!(acts[5], WorldAction::LetGo { gripper: GripperId(0) });
}

/// `(from, to, on, guard, effects)` of each edge; events by name.
fn edges(p: &Program, monitor: usize) -> Vec<(u16, u16, String, bool, Vec<MonitorEffect>)> {
    let on = |on: &MonitorTrigger| match on {
        MonitorTrigger::Event(patterns) => {
            patterns.iter().map(|e| p.event(e.event).name.clone()).collect::<Vec<_>>().join("|")
        }
        MonitorTrigger::Becomes { .. } | MonitorTrigger::Sample => "sample".to_owned(),
        MonitorTrigger::Deadline => "deadline".to_owned(),
    };
    p.monitors[monitor]
        .edges
        .iter()
        .map(|e| (e.from.0, e.to.0, on(&e.on), e.guard.is_some(), e.effects.clone()))
        .collect()
}

#[test]
#[expect(clippy::too_many_lines, reason = "a flat list of expectations")]
fn patterns_become_monitors() {
    use MonitorEffect::{Discharge, Fail, ResetClock, Trigger};
    let p = program(&format!(
        "{WORLD}event t(ok: bool) from robot\nevent r from robot\n\
         require A functional \"title\" after t(_):\n  (r or read) within 10 s\nrequire B functional t(true) causes r\n\
         require C safety t forbids r or read until said\nrequire D safety never r while distance(robot.palm, cup) < 5 cm\n\
         require E safety globally joint_speed(robot.reach_) < 0.25 rad/s && speed(cup) <= 1 m/s\n\
         require F safety never r\nrequire G safety globally near\n\
         require H safety never r while not (cup.z > 5 cm || 3 m <= high)\n\
         assume at most 4 t within 300 s"
    ));
    let e = |from, to, on: &str, guard, effects: &[MonitorEffect]| {
        (from, to, on.to_owned(), guard, effects.to_vec())
    };
    let a = &p.monitors[0];
    assert_eq!((a.title.as_str(), a.text.as_str()), ("title", "after t(_): (r or read) within 10 s"));
    assert_eq!((a.states[1].pending, a.states[1].deadline), (true, Some(10 * SECOND)));
    assert_eq!(
        edges(&p, 0),
        [
            e(0, 1, "t", false, &[Trigger, ResetClock]),
            e(1, 0, "r|read", false, &[Discharge]),
            e(1, 1, "t", false, &[Trigger]),
            e(1, 0, "deadline", false, &[Fail]),
        ]
    );
    assert_eq!((edges(&p, 1).len(), p.monitors[1].states[1].deadline), (3, None));
    assert_eq!(p.monitors[1].edges[0].on, MonitorTrigger::Event(vec![pattern(3, &[TRUE])]));
    assert_eq!(
        edges(&p, 2),
        [
            e(0, 1, "t", false, &[Trigger]),
            e(1, 1, "r|read", false, &[Fail]),
            e(1, 0, "said", false, &[Discharge]),
            e(1, 1, "t", false, &[Trigger]),
        ]
    );
    assert!(p.monitors[2].states.iter().all(|s| !s.pending));

    assert_eq!(
        edges(&p, 3),
        [e(0, 0, "r", true, &[Trigger, Fail]), e(0, 0, "r", false, &[Trigger, Discharge])]
    );
    let d = &p.monitors[3];
    let margin = d.margin.as_ref().unwrap();
    assert_eq!(margin.value, op(BinaryOp::Sub, Expr::Var(0), Expr::float(0.05)));
    assert_eq!((margin.unit, margin.at.len()), (Unit::Metre, 1));
    let read = &p.signals[usize::from(d.signals[0].0)];
    assert_eq!((read.name.as_str(), read.recorded), ("distance(robot.palm, cup)", true));
    assert_eq!(d.edges[0].guard, Some(op(BinaryOp::Lt, Expr::Var(0), Expr::float(0.05))));

    assert_eq!(
        edges(&p, 4),
        [
            e(0, 2, "sample", true, &[Trigger, Fail]),
            e(0, 1, "sample", true, &[Trigger]),
            e(1, 2, "sample", true, &[Fail]),
            e(2, 1, "sample", true, &[]),
        ]
    );
    // The units differ: there is no one margin.
    assert_eq!((p.monitors[4].signals.len(), p.monitors[4].margin.as_ref()), (2, None));
    assert_eq!(edges(&p, 5), [e(0, 0, "r", false, &[Trigger, Fail])]);
    let g = &p.monitors[6];
    assert_eq!((g.signals.as_slice(), g.margin.as_ref()), (&[SignalId(0)][..], None));
    assert!(p.signals[0].recorded && !p.signals[1].recorded);
    assert_eq!(g.edges[0].guard, Some(not(Expr::Var(0))));
    // Never while not (z > c or d <= high): safe by the larger of z - c and high - d.
    let h = &p.monitors[7];
    assert_eq!(h.signals, [SignalId(2)], "`cup.z` is just what the signal `high` measures");
    let above = op(BinaryOp::Sub, Expr::Var(0), Expr::float(0.05));
    let far = op(BinaryOp::Sub, Expr::Var(0), Expr::float(3.0));
    assert_eq!(h.margin.as_ref().unwrap().value, Expr::Call(NumberFunction::Max, vec![above, far]));
    let assumed = &p.assumptions[0];
    assert_eq!((assumed.at_most, assumed.within), (4, Some(300 * SECOND)));
    assert_eq!(assumed.text, "assume at most 4 t within 300 s");
}

#[test]
#[expect(clippy::too_many_lines, reason = "a flat list of expectations")]
fn coverage_suites_and_tests() {
    let p = program(
        "event e from person\nevent m(ok: bool) from robot\nstimulus s(ok: bool) by person {\n  sample a in 1 m .. 2 m\n  emit e\n}\n\
         agent A plays person { belief b(n: 0..3, ok: bool) }\nautomaton R plays robot { init location a }\nnetwork net = R\n\
         cover c = count(m(true) or e) bins none = 0, few = 1..3, many = 4..\n\
         cross x = c { bin \"some\" when not c.none && (c.few || c.many)\n ignore when c.many }\n\
         suite g by agents A, R { choose one b of A per ok\n choose any b of A where b(N, true) && not b(N, false)\n explore random }\n\
         suite h by search of net { reach each bin of x\n reach each location\n reach each edge\n tests 7 }\n\
         suite r by random { stimuli s\n await m\n length 2..4\n pause 1 s .. 2 s }\n\
         test h.t1 {\n seed 17\n method search\n because \"it\"\n predicts \"x.some\"\n s(true)\n s(false) with a = 150 cm\n await m(true) | e within 3 s\n wait 1 s\n}\n\
         test t2 { s(true) }\nsystem robot { run \"python3 'my robot.py'\"\n coverage \"a.py\", \"b.py\"\n limit 60 s }",
    );
    let c = &p.coverage.points[0];
    assert_eq!(c.count, [pattern(1, &[TRUE]), pattern(0, &[])]);
    let bins: Vec<(i64, Option<i64>)> = c.bins.iter().map(|b| (b.lo, b.hi)).collect();
    assert_eq!(bins, [(0, Some(0)), (1, Some(3)), (4, None)]);
    let at = |bin| BinCondition::In { point: CoverpointId(0), bin };
    let x = &p.coverage.crosses[0];
    let some =
        BinCondition::And(vec![BinCondition::Not(Box::new(at(0))), BinCondition::Or(vec![at(1), at(2)])]);
    assert_eq!((&x.bins[0].when, x.ignore.as_slice()), (&some, &[at(2)][..]));

    let by_agents = &p.suites[0].method;
    assert!(matches!(by_agents, SuiteMethod::Agents { stop_after: None, minimise: false, .. }));
    let SuiteMethod::Agents { players, choose, explore, goals, .. } = by_agents else { panic!() };
    assert_eq!((goals.as_slice(), players.len(), *explore), (&[][..], 2, ExploreMode::Random));
    assert_eq!((choose[0].how, choose[1].how), (ChoiceKind::OnePer(1), ChoiceKind::Any));
    let held = |holds| {
        let args = vec![AgentTerm::Var(0), AgentTerm::Expr(Expr::Const(Value::Bool(holds)))];
        PlanContext::Belief(BeliefLiteral {
            origin: Span::default(),
            belief: BeliefId(0),
            args,
            annotations: vec![],
        })
    };
    let only_true = PlanContext::And(vec![held(true), PlanContext::Not(Box::new(held(false)))]);
    let condition = choose[1].condition.as_ref().unwrap();
    assert_eq!((&condition.context, condition.vars.as_slice()), (&only_true, &["N".to_owned()][..]));
    assert_eq!(choose[0].condition, None);
    assert_eq!(
        (p.suites[0].settings.tests, p.suites[0].settings.horizon, p.suites[0].settings.patience),
        (100, 300 * SECOND, 60 * SECOND)
    );
    let SuiteMethod::Search { network: NetworkId(0), goals, .. } = &p.suites[1].method else { panic!() };
    assert_eq!(goals[..], [SearchGoal::Bins(CrossId(0)), SearchGoal::Locations, SearchGoal::Edges]);
    assert_eq!(p.suites[1].settings.tests, 7);
    assert_eq!(
        p.suites[2].method,
        SuiteMethod::Random {
            stimuli: vec![EventId(2)],
            awaits: vec![pattern(1, &[ArgPattern::Any])],
            length_lo: 2,
            length_hi: 4,
            pause_lo: SECOND,
            pause_hi: 2 * SECOND,
            boundary: None,
        }
    );

    let t = &p.tests[0];
    assert_eq!((t.name.as_str(), t.seed, t.provenance.suite.as_str()), ("small.h.t1", 17, "h"));
    assert_eq!(
        (t.provenance.method.word(), t.provenance.predicts.as_slice()),
        ("search", &[hrdsl_ir::coverage::BinName::new("x", "some")][..])
    );
    let args = |b| vec![Value::Bool(b)];
    let steps = &t.scripts[0].steps;
    let done = |args, samples| TestStep::Do { event: EventId(2), args, samples, meanwhile: false };
    assert_eq!(steps[0], done(args(true), vec![]));
    let samples = vec![Value::Float(1.5)];
    assert_eq!(steps[1], done(args(false), samples));
    let events = vec![pattern(1, &[TRUE]), pattern(0, &[])];
    assert_eq!(steps[2], TestStep::Await { events, within: 3 * SECOND });
    assert_eq!(steps[3], TestStep::Wait { time: SECOND });
    assert_eq!((p.tests[1].name.as_str(), p.tests[1].provenance.method.word()), ("small.t2", "hand"));

    let system = &p.systems[0];
    assert_eq!(system.programs[0].run, ["python3", "my robot.py"]);
    assert_eq!((system.coverage().len(), system.limit, system.budget), (2, 60 * SECOND, 10 * SECOND));
}

#[test]
fn constants_fold_as_the_run_time_evaluates() {
    // Folded at compile time, and the same with a variable in place of one operand, evaluated.
    let values = ["0", "1", "-3", "7", "0.5", "-2.5"];
    let operators = ["+", "-", "*", "/", "%", "<", "<=", ">", ">=", "==", "!="];
    let mut compared = 0;
    for a in values {
        for b in values {
            for o in operators {
                let result = if ["<", "<=", ">", ">=", "==", "!="].contains(&o) { "bool" } else { "float" };
                let stimulus = |x: &str| {
                    let hold = if result == "bool" {
                        format!("if {x} {o} ({b}) {{ hold 1 s }}")
                    } else {
                        format!("hold ({x} {o} ({b})) * 1 s")
                    };
                    format!("stimulus s(x: float) by person {{ {hold} }}")
                };
                let with = |x: &str| {
                    let text = format!("scenario fold\n{ACTORS}{}", stimulus(x));
                    let c = compile(InputFile { name: "fold.hri", text: &text }, &[]);
                    let steps = c.program?.events[0].stimulus.clone()?.steps;
                    let e = match steps.into_iter().next()? {
                        StimulusStep::Hold { seconds } => seconds,
                        StimulusStep::If { condition, .. } => condition,
                        StimulusStep::Emit { .. } | StimulusStep::Act(_) => return None,
                    };
                    let whole = !a.contains('.');
                    let x = if whole { Value::Int(a.parse().ok()?) } else { Value::Float(a.parse().ok()?) };
                    e.eval(&|_| Some(x)).ok()
                };
                let (folded, evaluated) = (with(&format!("({a})")), with("x"));
                assert_eq!(folded, evaluated, "{a} {o} {b}");
                compared += usize::from(folded.is_some());
            }
        }
    }
    // All but the divisions by zero have a value.
    assert_eq!(compared, values.len() * (values.len() * operators.len() - 2));
}

/// Expressions over the vectors `v` and `w` and the number `k`, each with what f64 makes of them.
type Formula = (&'static str, fn([f64; 3], [f64; 3], f64) -> f64);

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn vectors_fold_as_the_run_time_evaluates_and_as_f64() {
    let formulas: [Formula; 8] = [
        ("norm(v - w) / 1 m", |v, w, _| length([v[0] - w[0], v[1] - w[1], v[2] - w[2]])),
        ("norm(v + k * w) / 1 m", |v, w, k| length([v[0] + k * w[0], v[1] + k * w[1], v[2] + k * w[2]])),
        ("norm(-v / 4) / 1 m", |v, _, _| length(v.map(|x| -x / 4.0))),
        ("norm(if k < 1 { v } else { w }) / 1 m", |v, w, k| length(if k < 1.0 { v } else { w })),
        ("norm((v.x, w[1], v.z)) / 1 m", |v, w, _| length([v[0], w[1], v[2]])),
        ("(v.x * w.x + v.y * w.y + v.z * w.z) / (1 m * 1 m)", |v, w, _| {
            v[0] * w[0] + v[1] * w[1] + v[2] * w[2]
        }),
        ("if v == w { 1 } else { 2 } * k", |v, w, k| if v == w { k } else { 2.0 * k }),
        ("if (v, w) != (w, v) && norm(w) > 1 m { k } else { -k }", |v, w, k| {
            if v != w && length(w) > 1.0 { k } else { -k }
        }),
    ];
    let points = [
        ([3.0, 4.0, 0.0], [0.5, -1.25, 2.0], 0.5),
        ([0.0, 0.0, 0.0], [0.125, 0.0, -0.5], 2.0),
        ([1.0, 2.5, -3.0], [1.0, 2.5, -3.0], 1.5),
    ];
    let hold = |text: String| {
        let p = program(&text);
        let steps = p.events[0].stimulus.clone().unwrap().steps;
        let Some(StimulusStep::Hold { seconds }) = steps.into_iter().next() else { panic!("{text}") };
        seconds
    };
    let written = |v: [f64; 3]| format!("({:?} m, {:?} m, {:?} m)", v[0], v[1], v[2]);
    for (formula, f64) in formulas {
        let read = hold(format!(
            "stimulus s(v: length[3], w: length[3], k: float) by person {{ hold ({formula}) * 1 s }}"
        ));
        for (v, w, k) in points {
            let values: Vec<f64> = v.into_iter().chain(w).chain([k]).collect();
            let evaluated =
                read.eval(&|i| Some(Value::Float(values[usize::from(i)]))).unwrap().as_f64().unwrap();
            let constants = format!("const v = {}\nconst w = {}\nconst k = {k:?}\n", written(v), written(w));
            let folded = hold(format!("{constants}stimulus s by person {{ hold ({formula}) * 1 s }}"));
            assert_eq!(folded, Expr::float(evaluated), "{formula} at {v:?} {w:?} {k}");
            let want = f64(v, w, k);
            assert!((evaluated - want).abs() <= 1e-12 * want.abs(), "{formula}: {evaluated}, not {want}");
        }
    }
}

#[test]
fn symbols_fold_as_the_run_time_evaluates() {
    let orders = "enum Order { feed, clean, rest }\nrecord Job { what: Order, times: 0..3 }\n";
    for value in ["feed", "clean", "rest"] {
        for condition in
            ["o == clean", "clean != o", "(o, 2) == (Order.clean, 2)", "Job(o, 1) != Job(clean, 1)"]
        {
            let fold = |text: String| {
                let steps = program(&text).events[0].stimulus.clone().unwrap().steps;
                let Some(StimulusStep::If { condition, .. }) = steps.into_iter().next() else {
                    panic!("{text}")
                };
                let value = Value::Symbol(hrdsl_ir::Symbol::intern(value));
                condition.eval(&|_| Some(value)).unwrap()
            };
            let folded = fold(format!(
                "{orders}const o = Order.{value}\nstimulus s by person {{ if {condition} {{ hold 1 s }} }}"
            ));
            let read =
                fold(format!("{orders}stimulus s(o: Order) by person {{ if {condition} {{ hold 1 s }} }}"));
            assert_eq!(folded, read, "{value} {condition}");
            let is = condition.contains("==") == (value == "clean");
            assert_eq!(read, Value::Bool(is), "{value} {condition}");
        }
    }
}

/// `nanos + factor · value`
fn time(seconds: i64, terms: &[(i64, Expr)]) -> TimeSum {
    let term = |(factor, value): &(i64, Expr)| TimeTerm { factor: factor * SECOND, value: value.clone() };
    TimeSum { nanos: seconds * SECOND, terms: terms.iter().map(term).collect() }
}

fn constraint(clock: u16, minus: Option<u16>, op: ClockOp, bound: TimeSum) -> ClockConstraint {
    ClockConstraint { clock: ClockId(clock), minus: minus.map(ClockId), op, bound }
}

#[test]
fn channels_are_offered_accepted_and_joined() {
    let p = program(
        "record Pos { x: 0..3, y: bool }\nenum Way { left, right }\nvar n: 0..4\n\
         channel take(fork: 0..4, way: Way), go : urgent\nchannel at(p: Pos) : broadcast\nchannel all : joint B | A?\n\
         automaton A {\n  var v: 0..4\n  init location a\n  a -> a select s: 0..4 on take(v + 1, w) when w == left\n\
           a -> a do take(n, right)\n  a -> a on all\n  a -> a on at\n a -> a on at((x, true)) do v = x\n a -> a on go }\n\
         automaton B { init location a\n a -> a do at((n, false))\n a -> a on all\n a -> a on take(3, right)\n a -> a select v2: 0..4 do take(v2, left) }\n\
         network net = A | B",
    );
    let channels: Vec<_> = p.channels.iter().map(|c| (c.name.as_str(), c.urgent, c.kind.clone())).collect();
    let participant = |a, optional| ChannelParticipant { automaton: AutomatonId(a), optional };
    assert_eq!(
        channels,
        [
            ("take", true, ChannelKind::Binary),
            ("go", true, ChannelKind::Binary),
            ("at", false, ChannelKind::Broadcast),
            ("all", false, ChannelKind::MultiWay(vec![participant(1, false), participant(0, true)])),
        ]
    );
    let params = |i: usize| -> Vec<(&str, i64, i64, bool)> {
        let params = &p.channels[i].params;
        params.iter().map(|v| (v.name.as_str(), v.lo, v.hi, v.enumeration.is_some())).collect()
    };
    assert_eq!(params(0), [("fork", 0, 4, false), ("way", 0, 1, true)]);
    assert_eq!(params(2), [("p.x", 0, 3, false), ("p.y", 0, 1, false)]);
    assert_eq!((p.automata[0].actor, p.actors.len()), (None, 2));
    let bind = ReceiveArg::Bind;
    let any = ReceiveArg::Match(ArgPattern::Any);
    let take = ChannelId(0);
    let e = &p.automata[0].edges;
    // n 0, v 1, s 2, the first argument 3, w 4
    assert_eq!(e[0].sync, SyncLabel::Accept { channel: take, args: vec![bind, bind] });
    let first = op(BinaryOp::Eq, Expr::Var(3), op(BinaryOp::Add, Expr::Var(1), Expr::int(1)));
    let left = op(BinaryOp::Eq, Expr::Var(4), symbol("left"));
    assert_eq!(e[0].guard, Some(op(BinaryOp::And, first, left)));
    assert_eq!(e[1].sync, SyncLabel::Offer { channel: take, args: vec![Expr::Var(0), symbol("right")] });
    assert_eq!(e[2].sync, SyncLabel::Join { channel: ChannelId(3) });
    assert_eq!(e[3].sync, SyncLabel::Accept { channel: ChannelId(2), args: vec![any, any] });
    assert_eq!(
        e[4].sync,
        SyncLabel::Accept { channel: ChannelId(2), args: vec![bind, ReceiveArg::Match(TRUE)] }
    );
    assert_eq!(e[5].sync, SyncLabel::Accept { channel: ChannelId(1), args: vec![] });
    let e = &p.automata[1].edges;
    assert_eq!(
        e[0].sync,
        SyncLabel::Offer { channel: ChannelId(2), args: vec![Expr::Var(0), Expr::bool(false)] }
    );
    let right = ReceiveArg::Match(ArgPattern::Is(Value::Symbol(Symbol::intern("right"))));
    let three = ReceiveArg::Match(ArgPattern::Is(Value::Int(3)));
    assert_eq!(e[2].sync, SyncLabel::Accept { channel: take, args: vec![three, right] });
}

#[test]
#[expect(clippy::too_many_lines, reason = "a flat list of expectations")]
fn clocks_are_shared_compared_and_set() {
    let p = program(
        "var total: clock\nvar lap: clock[2]\nvar n: 0..4\nvar b: bool\nconst I = 1\n\
         automaton A {\n  clock x, y\n  var v: 0..4\n\
           init location a { invariant x >= 1 s && total < n * 2 s - 1 s && v < 3 && b && x - lap[I] == y_ }\n\
           location b_\n\
           a -> b_ when x < y && 3 s <= y - x && x <= total + v * 1 s && y > (if b { 2 s } else { n * 3 s }) && v > 0 do x = 3 s; y = n * 1 s; x = y; lap[0] = total + 2 s - v * 500 ms; x += 1 s; y -= 2 s; x = 0\n\
           b_ -> a when x - 1 s == total && -y >= -4 s && x > n * (v * 1 s + 2 s) && (n + 1) * 4 s / 2 > y }\n\
         const y_ = 2 s\nnetwork net = A",
    );
    assert_eq!(p.clocks, ["total", "lap[0]", "lap[1]"]);
    // total 0, lap 1 and 2, x 3, y 4; n 0, b 1, v 2
    let (n, b, v) = (Expr::Var(0), Expr::Var(1), Expr::Var(2));
    let a = &p.automata[0];
    assert_eq!(
        a.locations[0].invariant,
        [
            constraint(3, None, ClockOp::Ge, time(1, &[])),
            constraint(0, None, ClockOp::Lt, time(-1, &[(2, n.clone())])),
            constraint(3, Some(2), ClockOp::Eq, time(2, &[])),
        ]
    );
    let less = op(BinaryOp::Lt, v.clone(), Expr::int(3));
    assert_eq!(a.locations[0].holds, Some(op(BinaryOp::And, less, b.clone())));
    assert_eq!(a.locations[1].holds, None);
    let choice = |x, y| Expr::If(b.clone().into(), Box::new(x), Box::new(y));
    let e = &a.edges[0];
    assert_eq!(
        e.clock_guard,
        [
            constraint(3, Some(4), ClockOp::Lt, time(0, &[])),
            constraint(4, Some(3), ClockOp::Ge, time(3, &[])),
            constraint(3, Some(0), ClockOp::Le, time(0, &[(1, v.clone())])),
            constraint(
                4,
                None,
                ClockOp::Gt,
                time(0, &[(2, choice(Expr::int(1), Expr::int(0))), (3, choice(Expr::int(0), n.clone()))])
            ),
        ]
    );
    assert_eq!(e.guard, Some(op(BinaryOp::Gt, v.clone(), Expr::int(0))));
    let set = |clock, from: Option<u16>, to| EdgeAssignment::Reset {
        clock: ClockId(clock),
        from: from.map(ClockId),
        to,
    };
    let half = TimeTerm { factor: -SECOND / 2, value: v.clone() };
    assert_eq!(
        e.updates,
        [
            set(3, None, time(3, &[])),
            set(4, None, time(0, &[(1, n.clone())])),
            set(3, Some(4), time(0, &[])),
            set(1, Some(0), TimeSum { nanos: 2 * SECOND, terms: vec![half] }),
            set(3, Some(3), time(1, &[])),
            set(4, Some(4), time(-2, &[])),
            EdgeAssignment::zero(ClockId(3)),
        ]
    );
    let product = op(BinaryOp::Mul, n.clone(), v);
    let more = op(BinaryOp::Add, n.clone(), Expr::int(1));
    assert_eq!(
        a.edges[1].clock_guard,
        [
            constraint(3, Some(0), ClockOp::Eq, time(1, &[])),
            constraint(4, None, ClockOp::Le, time(4, &[])),
            constraint(3, None, ClockOp::Gt, time(0, &[(1, product), (2, n)])),
            constraint(4, None, ClockOp::Lt, time(0, &[(2, more)])),
        ]
    );
}

#[test]
fn texts_of_messages_are_compared_where_they_are_read() {
    let p = program(
        r#"
event decided(same: bool) from robot
system robot {
  program brain { run "python3 robot.py" }
  ros1 {
    topic "/said" : diagnostic_msgs/KeyValue out {
      emit decided(key == value) when value != "go" and (if key == "a" { value } else { "b" }) == "c"
    }
  }
}
"#,
    );
    let rules = &p.systems[0].binding.as_ref().unwrap().outputs[0].rules;
    let MessageEffect::Emit { args, .. } = &rules.rules[0].effect else { panic!("{rules:?}") };
    let guard = rules.rules[0].guard.as_ref().unwrap();
    let text = |e: &Expr| {
        let Expr::Var(at) = e else { panic!("{e:?}") };
        let read = &rules.reads[usize::from(*at)];
        let MessageRead { path, length: false, ty: Type::Text, same_as: Some(other) } = read else {
            panic!("{read:?}")
        };
        match other {
            TextOperand::Literal(text) => format!("{} == {text:?}", place_text(path)),
            TextOperand::Place(other) => format!("{} == {}", place_text(path), place_text(other)),
        }
    };
    assert_eq!(text(&args[0]), "key == value");
    let Expr::Binary(BinaryOp::And, other, chosen) = guard else { panic!("{guard:?}") };
    let Expr::Unary(UnaryOp::Not, same) = &**other else { panic!("{other:?}") };
    assert_eq!(text(same), "value == \"go\"");
    let Expr::If(condition, then, otherwise) = &**chosen else { panic!("{chosen:?}") };
    assert_eq!((text(condition), text(then)), ("key == \"a\"".into(), "value == \"c\"".into()));
    assert_eq!(**otherwise, Expr::bool(false));
}
