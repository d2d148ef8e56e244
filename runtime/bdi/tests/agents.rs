//! The reasoning cycle, by small agents and the decisions they must take.

mod build;

use build::*;
use hrdsl_bdi::{Cause, Logged, Machine, Malformed, Status};
use hrdsl_ir::{
    ArgPattern, Enumeration, EventPattern, Expr, Type, Unit, Value,
    bdi::{AgentId, BeliefId, Context, Fact, StepKind, Term},
    expr::BinaryOp,
    value::SECOND,
};

const TRUE: Context = Context::True;

// ── plans and goals ──

#[test]
fn a_loop_counts() {
    let mut s = Scene::new();
    let (had, count, say) = (s.belief("had", 1), s.goal("count", 0), s.event("say", 1));
    s.plan(
        GoalAdded(count),
        [],
        all([holds(had, [v(0)]), lt(x(0), i(3))]),
        [act(say, [plus1(x(0))]), replace(had, [plus1(x(0))]), achieve(count, [])],
    );
    s.plan(GoalAdded(count), [], TRUE, []);
    s.believe(had, [0]);
    s.start(count, []);
    s.tells(
        "0 #1 +!count by count#1
         0 do say 1
         0 #1 +!count by count#1
         0 do say 2
         0 #1 +!count by count#1
         0 do say 3
         0 #1 +!count by count#2
         Idle",
    );
}

#[test]
fn the_first_applicable_plan_is_taken_and_arguments_are_matched() {
    let mut s = Scene::new();
    let (b, g, say) = (s.belief("b", 0), s.goal("g", 2), s.event("say", 1));
    s.plan(GoalAdded(g), [v(0), v(0)], TRUE, [act(say, [i(1)])]);
    s.plan(GoalAdded(g), [n(1), Term::Any], holds(b, []), [act(say, [i(2)])]);
    s.plan(GoalAdded(g), [n(1), v(0)], TRUE, [act(say, [x(0)])]);
    s.plan(GoalAdded(g), [v(0), v(1)], TRUE, [act(say, [i(4)])]);
    for args in [[7, 7], [1, 3], [2, 3]] {
        s.start(g, args);
    }
    // One event, then one step, in each cycle: the first intention acts before the second is adopted.
    s.tells(
        "0 #1 +!g(7, 7) by g#1
         0 #2 +!g(1, 3) by g#3
         0 #3 +!g(2, 3) by g#4
         0 do say 1
         0 do say 3
         0 do say 4
         Idle",
    );
}

#[test]
fn a_sub_goal_is_achieved_before_the_plan_goes_on() {
    let mut s = Scene::new();
    let (a, b, say) = (s.goal("a", 0), s.goal("b", 1), s.event("say", 1));
    s.plan(GoalAdded(a), [], TRUE, [achieve(b, [i(1)]), act(say, [i(9)]), achieve(b, [i(2)])]);
    s.plan(GoalAdded(b), [v(0)], TRUE, [act(say, [x(0)])]);
    s.start(a, []);
    s.tells(
        "0 #1 +!a by a#1
         0 #1 +!b(1) by b#2
         0 do say 1
         0 do say 9
         0 #1 +!b(2) by b#2
         0 do say 2
         Idle",
    );
}

#[test]
fn variables_belong_to_one_execution_of_a_plan() {
    let mut s = Scene::new();
    let (down, say) = (s.goal("down", 1), s.event("say", 1));
    s.plan(GoalAdded(down), [v(0)], lt(x(0), i(3)), [achieve(down, [plus1(x(0))]), act(say, [x(0)])]);
    s.plan(GoalAdded(down), [v(0)], TRUE, []);
    s.start(down, [1]);
    s.tells(
        "0 #1 +!down(1) by down#1
         0 #1 +!down(2) by down#1
         0 #1 +!down(3) by down#2
         0 do say 2
         0 do say 1
         Idle",
    );
}

#[test]
fn a_goal_of_its_own_does_not_hold_up_the_plan() {
    let mut s = Scene::new();
    let (a, b, say) = (s.goal("a", 0), s.goal("b", 1), s.event("say", 1));
    s.plan(GoalAdded(a), [], TRUE, [spawn(b, [i(5)]), act(say, [i(1)]), act(say, [i(2)])]);
    s.plan(GoalAdded(b), [v(0)], TRUE, [wait(1.0), act(say, [x(0)])]);
    s.start(a, []);
    s.tells(
        "0 #1 +!a by a#1
         0 #2 +!b(5) by b#2
         0 do say 1
         0 do say 2
         1 do say 5
         Idle",
    );
}

#[test]
fn recursion_at_the_end_of_a_plan_takes_no_memory() {
    let mut s = Scene::new();
    let (l, say) = (s.goal("loop", 1), s.event("say", 1));
    s.plan(GoalAdded(l), [v(0)], TRUE, [act(say, [x(0)]), achieve(l, [plus1(x(0))])]);
    s.start(l, [0]);
    let (mut m, mut out) = (s.machine(), vec![]);
    m.log_selections(false);
    for turn in 0..5_000 {
        m.run(turn, &mut out);
        assert_eq!(m.height(), 1);
        m.stimulus_done(out.pop().unwrap().token, turn);
    }
    assert_eq!(m.selections(), [5_000]);
    assert!(m.log().is_empty());
}

#[test]
fn goals_without_end_are_told_from_a_livelock() {
    let mut s = Scene::new();
    let (down, say) = (s.goal("down", 0), s.event("say", 0));
    s.plan(GoalAdded(down), [], TRUE, [achieve(down, []), act(say, [])]);
    s.start(down, []);
    let mut m = s.machine();
    m.log_selections(false);
    m.run(0, &mut vec![]);
    assert_eq!(m.status(), Status::Idle);
    assert!(matches!(&m.log()[1].what, Logged::Dropped(f) if f.cause == Cause::TooDeep));
}

// ── failure ──

#[test]
fn a_failure_plan_takes_the_place_of_its_goal() {
    let mut s = Scene::new();
    let (b, a, g, say) = (s.belief("b", 0), s.goal("a", 0), s.goal("g", 1), s.event("say", 1));
    s.plan(GoalAdded(a), [], TRUE, [achieve(g, [i(4)]), act(say, [i(2)])]);
    s.plan(GoalAdded(g), [v(0)], TRUE, [query(b, []), act(say, [i(99)])]);
    s.plan(GoalFailed(g), [v(0)], TRUE, [act(say, [x(0)])]);
    s.start(a, []);
    s.tells(
        "0 #1 +!a by a#1
         0 #1 +!g(4) by g#2
         0 #1 failed !g(4) in g#2: no belief answers b
         0 #1 -!g(4) by g#3
         0 do say 4
         0 do say 2
         Idle",
    );
}

#[test]
fn a_failure_unwinds_to_the_innermost_goal_with_an_applicable_failure_plan() {
    let mut s = Scene::new();
    let (b, say) = (s.belief("b", 0), s.event("say", 1));
    let (top, mid, low) = (s.goal("top", 0), s.goal("mid", 0), s.goal("low", 0));
    s.plan(GoalAdded(top), [], TRUE, [achieve(mid, []), act(say, [i(99)])]);
    s.plan(GoalAdded(mid), [], TRUE, [achieve(low, []), act(say, [i(98)])]);
    s.plan(GoalAdded(low), [], TRUE, [query(b, [])]);
    s.plan(GoalFailed(mid), [], holds(b, []), [act(say, [i(97)])]);
    s.plan(GoalFailed(top), [], TRUE, [act(say, [i(1)])]);
    s.start(top, []);
    s.tells(
        "0 #1 +!top by top#1
         0 #1 +!mid by mid#2
         0 #1 +!low by low#3
         0 #1 failed !low in low#3: no belief answers b
         0 #1 -!top by top#5
         0 do say 1
         Idle",
    );
}

#[test]
fn a_failure_plan_that_fails_passes_the_failure_on_below() {
    let mut s = Scene::new();
    let (b, say) = (s.belief("b", 0), s.event("say", 1));
    let (top, low) = (s.goal("top", 0), s.goal("low", 0));
    s.plan(GoalAdded(top), [], TRUE, [achieve(low, []), act(say, [i(99)])]);
    s.plan(GoalAdded(low), [], TRUE, [query(b, [])]);
    s.plan(GoalFailed(low), [], TRUE, [act(say, [i(1)]), query(b, [])]);
    s.plan(GoalFailed(top), [], TRUE, [act(say, [i(2)])]);
    s.start(top, []);
    s.tells(
        "0 #1 +!top by top#1
         0 #1 +!low by low#2
         0 #1 failed !low in low#2: no belief answers b
         0 #1 -!low by low#3
         0 do say 1
         0 #1 failed !low in low#3: no belief answers b
         0 #1 -!top by top#4
         0 do say 2
         Idle",
    );
}

#[test]
fn a_failure_below_the_last_step_still_finds_the_failure_plan() {
    let mut s = Scene::new();
    let (a, g, say) = (s.goal("a", 1), s.goal("g", 0), s.event("say", 1));
    s.plan(GoalAdded(a), [v(0)], TRUE, [achieve(g, [])]);
    s.plan(GoalFailed(a), [v(0)], TRUE, [act(say, [x(0)])]);
    s.start(a, [3]);
    s.tells(
        "0 #1 +!a(3) by a#1
         0 #1 failed !g in a#1: no plan is relevant
         0 #1 -!a(3) by a#2
         0 do say 3
         Idle",
    );
}

#[test]
fn a_goal_without_an_applicable_plan_fails_itself_first() {
    let mut s = Scene::new();
    let (b, a, g) = (s.belief("b", 0), s.goal("a", 0), s.goal("g", 1));
    let say = s.event("say", 1);
    s.plan(GoalAdded(a), [], TRUE, [achieve(g, [i(6)]), act(say, [i(1)])]);
    s.plan(GoalAdded(g), [v(0)], holds(b, []), []);
    s.plan(GoalFailed(g), [v(0)], TRUE, [act(say, [x(0)])]);
    s.plan(GoalFailed(a), [], TRUE, [act(say, [i(99)])]);
    s.start(a, []);
    s.tells(
        "0 #1 +!a by a#1
         0 #1 failed !g(6) in a#1: no plan is applicable
         0 #1 -!g(6) by g#3
         0 do say 6
         0 do say 1
         Idle",
    );
}

#[test]
fn without_a_failure_plan_the_intention_is_dropped_and_the_rest_go_on() {
    let mut s = Scene::new();
    let (b, a, g, say) = (s.belief("b", 0), s.goal("a", 1), s.goal("g", 0), s.event("say", 1));
    s.plan(GoalAdded(a), [n(1)], TRUE, [achieve(g, []), act(say, [i(99)])]);
    s.plan(GoalAdded(a), [v(0)], TRUE, [act(say, [x(0)])]);
    s.plan(GoalAdded(g), [], TRUE, [act(say, [i(0)]), query(b, [])]);
    s.start(a, [1]);
    s.start(a, [2]);
    s.tells(
        "0 #1 +!a(1) by a#1
         0 #2 +!a(2) by a#2
         0 #1 +!g by g#3
         0 do say 2
         0 do say 0
         0 #1 failed !g in g#3: no belief answers b
         0 #1 dropped !g in g#3: no belief answers b
         Idle",
    );
    let (mut m, mut out) = (s.machine(), vec![]);
    m.run(0, &mut out);
    out.iter().for_each(|a| m.stimulus_done(a.token, 0));
    m.run(0, &mut vec![]);
    let Some(Logged::Dropped(failure)) = m.log().last().map(|e| &e.what) else { panic!("not dropped") };
    assert_eq!(
        (failure.plan, failure.origin.start),
        (Some(2), 301),
        "the query, second step of the third plan"
    );
}

#[test]
fn a_goal_of_its_own_that_finds_no_plan_is_traced_to_the_step_that_made_it() {
    let mut s = Scene::new();
    let (a, g) = (s.goal("a", 0), s.goal("g", 0));
    s.plan(GoalAdded(a), [], TRUE, [wait(0.0), spawn(g, [])]);
    s.start(a, []);
    s.tells(
        "0 #1 +!a by a#1
         0 #2 failed !g: no plan is relevant
         0 #2 dropped !g: no plan is relevant
         Idle",
    );
    let mut m = s.machine();
    m.run(0, &mut vec![]);
    assert!(matches!(&m.log()[2].what, Logged::Dropped(f) if f.origin.start == 101));
}

#[test]
fn an_expression_without_a_value_fails_its_step() {
    let mut s = Scene::new();
    let (a, say) = (s.goal("a", 1), s.event("say", 1));
    s.plan(GoalAdded(a), [v(0)], TRUE, [act(say, [op(Div, i(6), x(0))])]);
    s.plan(GoalFailed(a), [n(0)], TRUE, [act(say, [x(3)])]);
    s.start(a, [2]);
    s.start(a, [0]);
    s.tells(
        "0 #1 +!a(2) by a#1
         0 #2 +!a(0) by a#1
         0 #2 failed !a(0) in a#1: division by zero
         0 #2 -!a(0) by a#2
         0 #2 failed !a(0) in a#2: variable 3 has no value
         0 #2 dropped !a(0) in a#2: variable 3 has no value
         0 do say 3
         Idle",
    );
}

// ── contexts ──

fn scene_of_contexts(context: impl Fn(BeliefId, BeliefId) -> Context) -> Scene {
    let mut s = Scene::new();
    let (p, q, g, say) = (s.belief("p", 1), s.belief("q", 2), s.goal("g", 0), s.event("say", 2));
    for n in [3, 1, 2] {
        s.believe(p, [n]);
    }
    for (a, b) in [(1, 1), (3, 2), (1, 5), (2, 7)] {
        s.believe(q, [a, b]);
    }
    s.plan(GoalAdded(g), [], context(p, q), [act(say, [x(0), x(1)])]);
    s.plan(GoalAdded(g), [], TRUE, [act(say, [i(0), i(0)])]);
    s.start(g, []);
    s
}

fn says(context: impl Fn(BeliefId, BeliefId) -> Context) -> String {
    let told = scene_of_contexts(context).play();
    told.iter().find_map(|l| l.strip_prefix("0 do say ")).unwrap().to_owned()
}

#[test]
fn a_context_is_searched_depth_first_over_the_oldest_beliefs_first() {
    assert_eq!(says(|p, q| all([holds(p, [v(0)]), holds(q, [v(0), v(1)])])), "3 2");
    assert_eq!(says(|p, q| all([holds(q, [v(0), v(1)]), holds(p, [v(0)])])), "1 1");
}

#[test]
fn a_context_tracks_back_when_a_later_condition_fails() {
    assert_eq!(says(|p, q| all([holds(p, [v(0)]), holds(q, [v(0), v(1)]), lt(i(2), x(1))])), "1 5");
    assert_eq!(says(|p, q| all([holds(p, [v(0)]), holds(q, [v(0), v(1)]), lt(i(5), x(1))])), "2 7");
    assert_eq!(says(|p, q| all([holds(p, [v(0)]), holds(q, [v(0), v(1)]), lt(i(7), x(1))])), "0 0");
    // Also into a conjunction inside a disjunction.
    let inner = |p, q| Context::Or(vec![all([holds(p, [v(0)]), holds(q, [v(0), v(1)])])]);
    assert_eq!(says(|p, q| all([inner(p, q), lt(i(2), x(1))])), "1 5");
}

#[test]
fn alternatives_of_a_context_are_tried_in_order() {
    let either = |_: BeliefId, q: BeliefId| {
        Context::Or(vec![all([holds(q, [v(0), v(1)]), lt(i(9), x(1))]), holds(q, [n(2), v(1)])])
    };
    assert_eq!(
        says(|p, q| all([either(p, q), holds(p, [v(0)])])),
        "3 7",
        "the first choice's bindings are gone"
    );
}

#[test]
fn negation_as_failure_binds_nothing() {
    assert_eq!(
        says(|p, q| all([not(holds(q, [v(0), n(9)])), holds(p, [v(0)]), holds(q, [v(0), v(1)])])),
        "3 2"
    );
    assert_eq!(
        says(|p, q| all([holds(p, [v(0)]), not(holds(q, [v(0), n(2)])), holds(q, [v(0), v(1)])])),
        "1 1"
    );
    assert_eq!(says(|p, q| all([not(holds(p, [Term::Any])), holds(q, [v(0), v(1)])])), "0 0");
}

#[test]
fn a_literal_may_compute_with_what_is_bound_before() {
    let next = Term::Expr(plus1(x(0)));
    assert_eq!(says(|p, q| all([holds(p, [v(0)]), holds(p, [next.clone()]), holds(q, [v(0), v(1)])])), "1 1");
    assert_eq!(says(|_, q| all([holds(q, [v(0), next.clone()]), holds(q, [Term::Any, v(1)])])), "0 0");
}

#[test]
fn an_unbound_comparison_is_never_true() {
    let fault = |context: fn(BeliefId, BeliefId) -> Context| {
        scene_of_contexts(context).tells(
            "0 g#1 not tried: variable 2 has no value
             0 #1 +!g by g#2
             0 do say 0 0
             Idle",
        );
    };
    fault(|_, _| lt(x(2), i(3)));
    fault(|_, _| not(lt(x(2), i(3))));
    fault(|p, _| not(holds(p, [Term::Expr(plus1(x(2)))])));
    fault(|p, _| all([holds(p, [v(0)]), Context::Or(vec![lt(x(2), i(3)), Context::True])]));
    // Even where no belief is there to be compared with.
    let mut s = Scene::new();
    let (none, g) = (s.belief("none", 1), s.goal("g", 0));
    s.plan(GoalAdded(g), [], not(holds(none, [Term::Expr(plus1(x(0)))])), []);
    s.start(g, []);
    s.tells(
        "0 g#1 not tried: variable 0 has no value
         0 #1 failed !g: no plan is applicable
         0 #1 dropped !g: no plan is applicable
         Idle",
    );
}

// ── beliefs ──

#[test]
fn initial_beliefs_then_chosen_ones_then_goals_give_events() {
    let mut s = Scene::new();
    let (b, g) = (s.belief("b", 1), s.goal("g", 0));
    s.plan(BeliefAdded(b), [v(0)], TRUE, []);
    s.plan(GoalAdded(g), [], TRUE, []);
    s.start(g, []);
    s.chosen = vec![fact(b, [2]), fact(b, [1])];
    s.believe(b, [1]);
    s.tells(
        "0 #1 +b(1) by b#1
         0 #2 +b(2) by b#1
         0 #3 +!g by g#2
         Idle",
    );
}

#[test]
fn only_a_real_change_of_the_base_gives_an_event() {
    let mut s = Scene::new();
    let (b, g) = (s.belief("b", 1), s.goal("g", 0));
    s.plan(BeliefAdded(b), [v(0)], TRUE, []);
    s.plan(BeliefRemoved(b), [v(0)], TRUE, []);
    s.plan(
        GoalAdded(g),
        [],
        TRUE,
        [add(b, [i(1)]), add(b, [i(1)]), remove(b, [n(1)]), remove(b, [n(1)]), add(b, [i(2)])],
    );
    s.start(g, []);
    s.tells(
        "0 #1 +!g by g#3
         0 #2 +b(1) by b#1
         0 #3 -b(1) by b#2
         0 #4 +b(2) by b#1
         Idle",
    );
}

#[test]
fn replacing_removes_all_and_adds() {
    let mut s = Scene::new();
    let (b, g) = (s.belief("b", 1), s.goal("g", 0));
    s.plan(BeliefRemoved(b), [v(0)], TRUE, []);
    s.plan(GoalAdded(g), [], TRUE, [replace(b, [i(2)]), replace(b, [i(2)]), replace(b, [i(4)])]);
    s.plan(BeliefAdded(b), [n(4)], TRUE, []);
    for n in [1, 2, 3] {
        s.believe(b, [n]);
    }
    s.start(g, []);
    s.tells(
        "0 +b(1) ignored
         0 +b(2) ignored
         0 +b(3) ignored
         0 #1 +!g by g#2
         0 #2 -b(1) by b#1
         0 #3 -b(3) by b#1
         0 #4 -b(2) by b#1
         0 #5 +b(4) by b#3
         Idle",
    );
    let mut m = s.machine();
    m.run(0, &mut vec![]);
    assert_eq!(m.beliefs().collect::<Vec<_>>(), [fact(b, [4])]);
}

#[test]
fn removing_takes_the_oldest_match_and_binds() {
    let mut s = Scene::new();
    let (q, g, say) = (s.belief("q", 2), s.goal("g", 0), s.event("say", 1));
    for (a, b) in [(1, 5), (2, 6), (2, 7)] {
        s.believe(q, [a, b]);
    }
    s.plan(
        GoalAdded(g),
        [],
        TRUE,
        [
            remove(q, [n(2), v(0)]),
            act(say, [x(0)]),
            remove(q, [n(3), Term::Any]),
            query(q, [n(2), v(1)]),
            act(say, [x(1)]),
        ],
    );
    s.start(g, []);
    s.tells(
        "0 #1 +!g by g#1
         0 do say 6
         0 do say 7
         Idle",
    );
}

#[test]
fn values_outside_a_declaration_are_refused() {
    let mut s = Scene::new();
    let (b, g) = (s.belief_of("b", &[Type::Int { lo: 0, hi: 4 }]), s.goal("g", 1));
    s.plan(GoalAdded(g), [v(0)], TRUE, [add(b, [x(0)])]);
    s.chosen = vec![fact(b, [5]), fact(b, [1, 2])];
    s.start(g, [5]);
    s.tells(
        "0 refused b
         0 refused b
         0 #1 +!g(5) by g#1
         0 #1 failed !g(5) in g#1: value out of range
         0 #1 dropped !g(5) in g#1: value out of range
         Idle",
    );
}

#[test]
fn an_integer_serves_where_a_float_is_due() {
    let mut s = Scene::new();
    let (far, g) = (s.belief_of("far", &[Type::Float(Unit::Metre)]), s.goal("g", 0));
    s.plan(GoalAdded(g), [], holds(far, [n(2)]), [replace(far, [i(3)])]);
    s.believe(far, [2]);
    s.start(g, []);
    let mut m = s.machine();
    m.run(0, &mut vec![]);
    assert_eq!(m.beliefs().next().unwrap().args, [Value::Float(3.0)]);
}

// ── symbols ──

fn pace() -> Type {
    Type::Enum(Enumeration::intern("Pace", &["slow", "normal", "fast"]))
}

#[test]
fn an_agent_believes_compares_and_says_symbols() {
    let mut s = Scene::new();
    let (likes, g) = (s.belief_of("likes", &[pace()]), s.goal("g", 0));
    let (asked, say) = (s.event_of("asked", &[pace()]), s.event_of("say", &[pace()]));
    // On what it likes it agrees; if asked for `normal`, it changes its mind; else it says what it likes.
    s.plan(Perceived(asked), [v(0)], holds(likes, [v(0)]), [act(say, [x(0)])]);
    let normal = Context::Test(op(BinaryOp::Eq, x(0), is("normal")));
    let changes = [replace(likes, [x(0)]), query(likes, [v(1)]), act(say, [x(1)])];
    s.plan(Perceived(asked), [v(0)], normal, changes);
    let other = all([holds(likes, [v(1)]), Context::Test(op(BinaryOp::Ne, x(0), x(1)))]);
    s.plan(Perceived(asked), [v(0)], other, [act(say, [x(1)])]);
    s.plan(GoalAdded(g), [], holds(likes, [named("fast")]), []);
    s.agent().initial_beliefs.push(Fact { belief: likes, args: vec![symbol("slow")] });
    for (second, name) in [(1, "slow"), (2, "fast"), (3, "normal"), (4, "normal")] {
        s.inputs.push((second * SECOND, asked, vec![symbol(name)]));
    }
    s.start(g, []);
    s.tells(
        "0 #1 failed !g: no plan is applicable
         0 #1 dropped !g: no plan is applicable
         1 #2 on asked(slow) by asked#1
         1 do say slow
         2 #3 on asked(fast) by asked#3
         2 do say slow
         3 #4 on asked(normal) by asked#2
         3 do say normal
         4 #5 on asked(normal) by asked#1
         4 do say normal
         Idle",
    );
    let mut m = s.machine();
    m.run(0, &mut vec![]);
    assert_eq!(m.beliefs().map(|f| f.args).collect::<Vec<_>>(), [[symbol("slow")]]);
}

#[test]
fn a_wait_is_for_one_symbol() {
    let mut s = Scene::new();
    let (g, asked, say) = (s.goal("g", 0), s.event_of("asked", &[pace()]), s.event("say", 1));
    let args = vec![ArgPattern::Is(symbol("fast"))];
    let wait = StepKind::Await { events: vec![EventPattern { event: asked, args }], within: None };
    s.plan(GoalAdded(g), [], TRUE, [wait, act(say, [i(1)])]);
    s.inputs.push((SECOND, asked, vec![symbol("slow")]));
    s.inputs.push((2 * SECOND, asked, vec![symbol("fast")]));
    s.start(g, []);
    s.tells(
        "0 #1 +!g by g#1
         2 do say 1
         Idle",
    );
}

#[test]
fn symbols_of_another_enumeration_are_refused() {
    let mut s = Scene::new();
    let (likes, g) = (s.belief_of("likes", &[pace()]), s.goal("g", 0));
    s.plan(GoalAdded(g), [], TRUE, [add(likes, [is("left")])]);
    s.chosen = vec![Fact { belief: likes, args: vec![symbol("right")] }, fact(likes, [1])];
    s.start(g, []);
    s.tells(
        "0 refused likes
         0 refused likes
         0 #1 +!g by g#1
         0 #1 failed !g in g#1: value out of range
         0 #1 dropped !g in g#1: value out of range
         Idle",
    );
}

// ── test goals ──

#[test]
fn a_query_binds_from_the_oldest_belief() {
    let mut s = Scene::new();
    let (q, g, say) = (s.belief("q", 2), s.goal("g", 0), s.event("say", 2));
    for (a, b) in [(1, 5), (2, 6), (2, 7)] {
        s.believe(q, [a, b]);
    }
    s.plan(GoalAdded(g), [], TRUE, [query(q, [v(0), n(6)]), query(q, [v(0), v(1)]), act(say, [x(0), x(1)])]);
    s.start(g, []);
    s.tells(
        "0 #1 +!g by g#1
         0 do say 2 6
         Idle",
    );
}

#[test]
fn a_query_without_an_answer_asks_the_plans() {
    let mut s = Scene::new();
    let (q, r, g, say) = (s.belief("q", 2), s.belief("r", 1), s.goal("g", 0), s.event("say", 2));
    let sub = s.goal("sub", 0);
    s.believe(r, [8]);
    s.plan(GoalAdded(g), [], TRUE, [query(q, [n(3), v(0)]), act(say, [i(3), x(0)])]);
    // The answer is what the trigger's variables are at the end, also when the last step is a goal.
    let body = [act(say, [i(0), x(0)]), query(r, [v(1)]), achieve(sub, [])];
    s.plan(TestAdded(q), [v(0), v(1)], TRUE, body);
    s.plan(GoalAdded(sub), [], TRUE, []);
    s.start(g, []);
    s.tells(
        "0 #1 +!g by g#1
         0 #1 +?q(3, _) by q#2
         0 do say 0 3
         0 #1 +!sub by sub#3
         0 do say 3 8
         Idle",
    );
}

#[test]
fn a_test_plan_may_add_the_belief_instead() {
    let mut s = Scene::new();
    let (q, g, say) = (s.belief("q", 2), s.goal("g", 0), s.event("say", 2));
    s.plan(GoalAdded(g), [], TRUE, [query(q, [n(3), v(0)]), act(say, [i(3), x(0)])]);
    s.plan(TestAdded(q), [v(0), Term::Any], TRUE, [add(q, [x(0), i(8)])]);
    s.start(g, []);
    s.tells(
        "0 #1 +!g by g#1
         0 #1 +?q(3, _) by q#2
         0 do say 3 8
         Idle",
    );
}

#[test]
fn a_test_plan_without_an_answer_fails_the_query() {
    let mut s = Scene::new();
    let (q, g) = (s.belief("q", 1), s.goal("g", 1));
    s.plan(GoalAdded(g), [n(1)], TRUE, [query(q, [v(0)])]);
    s.plan(GoalAdded(g), [n(2)], TRUE, [query(q, [v(0)])]);
    s.plan(GoalAdded(g), [n(3)], TRUE, [query(q, [n(7)])]);
    s.plan(GoalFailed(g), [Term::Any], TRUE, []);
    // Leaves the question open; later it is not applicable.
    s.plan(TestAdded(q), [v(0)], not(holds(q, [n(0)])), [add(q, [i(0)]), remove(q, [n(0)])]);
    s.start(g, [1]);
    s.tells(
        "0 #1 +!g(1) by g#1
         0 #1 +?q(_) by q#5
         0 #1 failed !g(1) in g#1: no belief answers q
         0 #1 -!g(1) by g#4
         Idle",
    );
    s.agent().initial_goals.clear();
    s.believe(q, [0]);
    s.start(g, [3]);
    s.tells(
        "0 #1 +!g(3) by g#3
         0 #1 failed !g(3) in g#3: no belief answers q
         0 #1 -!g(3) by g#4
         Idle",
    );
}

// ── time, actions and perception ──

#[test]
fn a_stimulus_holds_its_intention_and_no_other() {
    let mut s = Scene::new();
    let (g, speak, say) = (s.goal("g", 1), s.stimulus("speak", 5), s.event("say", 1));
    s.plan(GoalAdded(g), [n(1)], TRUE, [act(speak, []), act(say, [i(1)])]);
    s.plan(GoalAdded(g), [v(0)], TRUE, [wait(2.0), act(say, [x(0)])]);
    s.start(g, [1]);
    s.start(g, [2]);
    s.tells(
        "0 #1 +!g(1) by g#1
         0 #2 +!g(2) by g#2
         0 do speak
         2 do say 2
         5 do say 1
         Idle",
    );
}

#[test]
fn an_action_is_done_once() {
    let mut s = Scene::new();
    let (g, say) = (s.goal("g", 0), s.event("say", 1));
    s.plan(GoalAdded(g), [], TRUE, [act(say, [i(1)]), act(say, [i(2)])]);
    s.start(g, []);
    let (mut m, mut out) = (s.machine(), vec![]);
    m.run(0, &mut out);
    let first = out[0].token;
    assert_eq!(m.status(), Status::Waiting);
    m.stimulus_done(first, 0);
    m.stimulus_done(first, 0);
    assert_eq!(m.status(), Status::Ready);
    m.run(0, &mut out);
    m.stimulus_done(first, 0);
    m.run(0, &mut out);
    assert_eq!((out.len(), m.status()), (2, Status::Waiting));
    m.stimulus_done(out[1].token, 0);
    assert_eq!(m.status(), Status::Idle);
}

#[test]
fn intentions_take_turns() {
    let mut s = Scene::new();
    let (b, g) = (s.belief("b", 1), s.goal("g", 1));
    let steps =
        || [add(b, [op(Add, x(0), i(1))]), add(b, [op(Add, x(0), i(2))]), add(b, [op(Add, x(0), i(3))])];
    s.plan(GoalAdded(g), [v(0)], TRUE, steps());
    s.start(g, [10]);
    s.start(g, [20]);
    let mut m = s.machine();
    m.run(0, &mut vec![]);
    let order: Vec<i64> = m.beliefs().filter_map(|f| f.args[0].as_int()).collect();
    // The second is adopted in the second cycle, when the first has gone to the end of the queue.
    assert_eq!(order, [11, 12, 21, 13, 22, 23]);
}

#[test]
fn events_are_handled_in_the_order_they_came() {
    let mut s = Scene::new();
    let (a, b, e) = (s.goal("a", 0), s.goal("b", 0), s.event("e", 1));
    s.plan(GoalAdded(a), [], TRUE, [wait(1.0), achieve(b, [])]);
    s.plan(GoalAdded(b), [], TRUE, []);
    s.plan(Perceived(e), [v(0)], TRUE, []);
    s.start(a, []);
    for n in [1, 2] {
        s.input(1, e, [n]);
    }
    s.tells(
        "0 #1 +!a by a#1
         1 #2 on e(1) by e#3
         1 #3 on e(2) by e#3
         1 #1 +!b by b#2
         Idle",
    );
}

#[test]
fn an_event_without_a_relevant_plan_is_ignored_and_one_without_an_applicable_plan_is_logged() {
    let mut s = Scene::new();
    let (b, e, f) = (s.belief("b", 0), s.event("e", 1), s.event("f", 0));
    s.plan(Perceived(e), [n(1)], TRUE, []);
    s.plan(Perceived(e), [v(0)], holds(b, []), []);
    s.input(1, e, [1]);
    s.input(2, e, [2]);
    s.input(3, f, []);
    s.tells(
        "1 #1 on e(1) by e#1
         2 on e(2) ignored
         Idle",
    );
}

#[test]
fn an_await_goes_on_at_the_first_matching_event() {
    let mut s = Scene::new();
    let (g, e, say) = (s.goal("g", 0), s.event("e", 2), s.event("say", 1));
    s.plan(GoalAdded(g), [], TRUE, [wait_for(e, [Some(1), None], Some(30)), act(say, [i(1)])]);
    s.start(g, []);
    s.input(1, e, [2, 2]);
    s.input(2, e, [1, 7]);
    s.input(3, e, [1, 8]);
    s.tells(
        "0 #1 +!g by g#1
         2 do say 1
         Idle",
    );
}

#[test]
fn an_await_takes_any_of_its_events() {
    let mut s = Scene::new();
    let (g, e, f, say) = (s.goal("g", 0), s.event("e", 0), s.event("f", 0), s.event("say", 0));
    let events = [e, f].map(|event| EventPattern { event, args: vec![] }).to_vec();
    s.plan(GoalAdded(g), [], TRUE, [StepKind::Await { events, within: None }, act(say, [])]);
    s.start(g, []);
    s.input(4, f, []);
    s.tells(
        "0 #1 +!g by g#1
         4 do say
         Idle",
    );
}

#[test]
fn an_await_fails_when_its_time_is_over() {
    let mut s = Scene::new();
    let (g, e, say) = (s.goal("g", 0), s.event("e", 0), s.event("say", 0));
    s.plan(GoalAdded(g), [], TRUE, [wait_for(e, [], Some(3))]);
    s.plan(GoalFailed(g), [], TRUE, [act(say, [])]);
    s.start(g, []);
    s.input(4, e, []);
    s.tells(
        "0 #1 +!g by g#1
         3 #1 failed !g in g#1: the time is over
         3 #1 -!g by g#2
         3 do say
         Idle",
    );
}

#[test]
fn an_event_wins_over_a_timeout_of_the_same_instant() {
    let mut s = Scene::new();
    let (g, e, say) = (s.goal("g", 0), s.event("e", 0), s.event("say", 0));
    s.plan(GoalAdded(g), [], TRUE, [wait_for(e, [], Some(3)), act(say, [])]);
    s.start(g, []);
    s.input(3, e, []);
    s.tells(
        "0 #1 +!g by g#1
         3 do say
         Idle",
    );
}

#[test]
fn settling_leaves_the_timeout_to_a_later_event_of_the_instant() {
    let mut s = Scene::new();
    let (g, e, say) = (s.goal("g", 0), s.event("e", 0), s.event("say", 0));
    s.plan(GoalAdded(g), [], TRUE, [wait_for(e, [], Some(3)), act(say, [])]);
    s.start(g, []);
    let (mut m, mut out) = (s.machine(), vec![]);
    m.run(0, &mut out);
    assert_eq!(m.next_wake(), Some(3 * SECOND));
    m.settle(3 * SECOND, &mut out);
    m.perceive(e, &[], 3 * SECOND);
    m.run(3 * SECOND, &mut out);
    assert_eq!((out.len(), m.next_wake()), (1, None));
}

#[test]
fn what_happened_before_an_await_does_not_count() {
    let mut s = Scene::new();
    let (g, e, speak) = (s.goal("g", 0), s.event("e", 0), s.stimulus("speak", 5));
    s.plan(GoalAdded(g), [], TRUE, [act(speak, []), wait_for(e, [], None)]);
    s.start(g, []);
    s.input(4, e, []);
    s.tells(
        "0 #1 +!g by g#1
         0 do speak
         Waiting",
    );
}

#[test]
fn an_event_at_the_end_of_a_stimulus_meets_the_await_behind_it() {
    let mut s = Scene::new();
    let (g, e, speak) = (s.goal("g", 0), s.event("e", 0), s.stimulus("speak", 5));
    s.plan(GoalAdded(g), [], TRUE, [act(speak, []), wait_for(e, [], Some(9))]);
    s.start(g, []);
    s.input(5, e, []);
    s.tells(
        "0 #1 +!g by g#1
         0 do speak
         Idle",
    );
}

#[test]
fn events_that_come_together_meet_one_await_after_the_other() {
    let mut s = Scene::new();
    let (g, e, say) = (s.goal("g", 0), s.event("e", 1), s.event("say", 0));
    s.plan(
        GoalAdded(g),
        [],
        TRUE,
        [wait_for(e, [Some(1)], None), wait_for(e, [Some(2)], None), act(say, [])],
    );
    s.start(g, []);
    s.input(1, e, [1]);
    s.input(1, e, [2]);
    s.tells(
        "0 #1 +!g by g#1
         1 do say
         Idle",
    );
}

#[test]
fn one_event_resumes_all_that_await_it_in_the_order_they_began_and_triggers_plans() {
    let mut s = Scene::new();
    let (g, e, say) = (s.goal("g", 1), s.event("e", 0), s.event("say", 1));
    s.plan(GoalAdded(g), [n(1)], TRUE, [wait(1.0), wait_for(e, [], Some(60)), act(say, [i(1)])]);
    s.plan(GoalAdded(g), [v(0)], TRUE, [wait_for(e, [], None), act(say, [x(0)])]);
    s.plan(Perceived(e), [], TRUE, [act(say, [i(9)])]);
    for n in [1, 2, 3] {
        s.start(g, [n]);
    }
    s.input(2, e, []);
    s.tells(
        "0 #1 +!g(1) by g#1
         0 #2 +!g(2) by g#2
         0 #3 +!g(3) by g#2
         2 #4 on e by e#3
         2 do say 2
         2 do say 3
         2 do say 1
         2 do say 9
         Idle",
    );
}

#[test]
fn waits_end_in_order_of_time_then_of_their_beginning() {
    let mut s = Scene::new();
    let (g, say) = (s.goal("g", 1), s.event("say", 1));
    let time = Expr::If(Box::new(op(Lt, x(0), i(3))), Box::new(i(2)), Box::new(Expr::float(0.5)));
    s.plan(GoalAdded(g), [v(0)], TRUE, [StepKind::Wait { seconds: time }, act(say, [x(0)])]);
    for n in [1, 2, 3] {
        s.start(g, [n]);
    }
    s.tells(
        "0 #1 +!g(1) by g#1
         0 #2 +!g(2) by g#1
         0 #3 +!g(3) by g#1
         0.5 do say 3
         2 do say 1
         2 do say 2
         Idle",
    );
}

#[test]
fn nobody_waits_for_less_than_nothing() {
    let mut s = Scene::new();
    let g = s.goal("g", 0);
    s.plan(GoalAdded(g), [], TRUE, [wait(-1.0)]);
    s.plan(GoalFailed(g), [], TRUE, [wait(f64::NAN)]);
    s.start(g, []);
    s.tells(
        "0 #1 +!g by g#1
         0 #1 failed !g in g#1: not a time to wait
         0 #1 -!g by g#2
         0 #1 failed !g in g#2: not a time to wait
         0 #1 dropped !g in g#2: not a time to wait
         Idle",
    );
}

#[test]
fn a_livelock_is_told() {
    let spin = |step: fn(hrdsl_ir::EventId) -> StepKind| {
        let mut s = Scene::new();
        let (g, say) = (s.goal("g", 0), s.event("say", 0));
        s.plan(GoalAdded(g), [], TRUE, [step(say), achieve(g, [])]);
        s.start(g, []);
        s.cycle_limit = 100;
        let told = s.play();
        assert_eq!(told[told.len() - 2..], ["0 livelock", "Livelock"]);
    };
    spin(|_| wait(0.0));
    // Even if the harness runs the agent again and again at the same instant.
    spin(|say| act(say, []));
}

#[test]
fn a_program_with_loose_ends_is_refused() {
    let mut s = Scene::new();
    let g = s.goal("g", 0);
    let fault = |s: &Scene| {
        let (mut m, mut out) = (s.machine(), vec![]);
        m.run(0, &mut out);
        assert_eq!((m.status(), out.len(), m.next_wake()), (Status::Malformed, 0, None));
        m.fault().unwrap().clone()
    };
    let plan = |what| Malformed::Plan { label: "g#1".into(), what };
    s.plan(GoalAdded(g), [v(0)], TRUE, []);
    assert_eq!(fault(&s), plan("trigger"));
    s.agent().plans.clear();
    s.plan(GoalAdded(g), [], lt(x(17), i(0)), []);
    assert_eq!(fault(&s), plan("context"));
    s.agent().plans.clear();
    s.plan(GoalAdded(g), [], TRUE, [query(BeliefId(4), [])]);
    assert_eq!(fault(&s), plan("step"));
    s.agent().plans.clear();
    s.start(g, [1]);
    assert_eq!(fault(&s), Malformed::InitialGoal { index: 0 });
    let machine = Machine::new(&s.program, AgentId(9), &[]);
    assert_eq!(machine.fault(), Some(&Malformed::NoSuchAgent));
}

// ── a whole person ──

/// The person who asks for table legs, is offered one, and shows or does not show that they are ready for it.
fn person(wants: i64, bored_at: Option<i64>) -> Scene {
    let mut s = Scene::new();
    let (wanted, had, bored) = (s.belief("wants", 1), s.belief("had", 1), s.belief("gets_bored", 1));
    let (table, offered) = (s.goal("table", 0), s.goal("offered", 1));
    let (ask, ready, leave) = (s.stimulus("ask_leg", 5), s.stimulus("say_ready", 3), s.stimulus("leave", 0));
    let (offer, released) = (s.event("handover_offered", 0), s.event("released", 0));
    s.plan(
        GoalAdded(table),
        [],
        all([holds(had, [v(0)]), holds(wanted, [v(1)]), lt(x(0), x(1))]),
        [act(ask, []), achieve(offered, [plus1(x(0))]), replace(had, [plus1(x(0))]), achieve(table, [])],
    );
    s.plan(GoalAdded(table), [], TRUE, []);
    s.plan(GoalAdded(offered), [v(0)], holds(bored, [v(0)]), [act(leave, [])]);
    s.plan(
        GoalAdded(offered),
        [Term::Any],
        TRUE,
        [wait_for(offer, [], Some(30)), act(ready, []), wait_for(released, [], Some(60))],
    );
    s.plan(GoalFailed(offered), [Term::Any], TRUE, [act(leave, [])]);
    s.believe(had, [0]);
    s.chosen.push(fact(wanted, [wants]));
    s.chosen.extend(bored_at.map(|leg| fact(bored, [leg])));
    s.start(table, []);
    s.input(20, offer, []);
    s.input(30, released, []);
    s
}

#[test]
fn a_person_takes_a_leg_and_leaves_when_the_next_is_not_offered() {
    person(2, None).tells(
        "0 #1 +!table by table#1
         0 do ask_leg
         5 #1 +!offered(1) by offered#4
         20 do say_ready
         30 #1 +!table by table#1
         30 do ask_leg
         35 #1 +!offered(2) by offered#4
         65 #1 failed !offered(2) in offered#4: the time is over
         65 #1 -!offered(2) by offered#5
         65 do leave
         65 #1 +!table by table#2
         Idle",
    );
}

#[test]
fn a_bored_person_leaves() {
    person(1, Some(1)).tells(
        "0 #1 +!table by table#1
         0 do ask_leg
         5 #1 +!offered(1) by offered#3
         5 do leave
         5 #1 +!table by table#2
         Idle",
    );
    person(0, None).tells("0 #1 +!table by table#2\nIdle");
}

#[test]
fn the_same_scene_always_plays_the_same() {
    assert_eq!(person(4, Some(3)).play(), person(4, Some(3)).play());
}
