//! Soundness against exploration: each state that a random automaton comes to lies in what the fixpoint says of its
//! location, and each update that leaves its range there is told.

use std::collections::BTreeSet;

use hrdsl_source::{FileId, Span};
use hrdsl_syntax::ast::LocationKind;
use proptest::prelude::*;

use super::*;
use crate::{
    ActorId, Type, TypedLocation, TypedLvalue, Value,
    lint::{
        facts::ScenarioFacts,
        interval::tests::{VARS, condition, holds, number, run},
        overflow,
    },
    types::starting_var,
};

const LOCATIONS: u16 = 3;
const RANGE: std::ops::RangeInclusive<i64> = -2..=6;

fn edge() -> impl Strategy<Value = TypedEdge> {
    let updates = prop::collection::vec((0..VARS as u16, number()), 0..3);
    (0..LOCATIONS, 0..LOCATIONS, prop::option::of(condition()), updates).prop_map(
        |(from, to, guard, updates)| TypedEdge {
            from: LocationId(from),
            to: LocationId(to),
            selects: Vec::new(),
            clock_guard: Vec::new(),
            guard,
            sync: TypedSync::Internal,
            updates: updates.into_iter().map(assign).collect(),
            origin: Span::default(),
        },
    )
}

fn assign((own, value): (u16, TypedExpr)) -> TypedUpdate {
    TypedUpdate::Assign { place: TypedLvalue::slot(VariableRef::Own(own)), value }
}

fn automaton(mut edges: Vec<TypedEdge>) -> TypedAutomaton {
    let updates = edges.iter_mut().flat_map(|e| &mut e.updates);
    for (at, update) in updates.enumerate() {
        if let TypedUpdate::Assign { value: e, .. } = update {
            e.span = Span::new(FileId(0), at, at);
        }
    }
    let location = |i: u16| TypedLocation {
        name: format!("l{i}"),
        kind: LocationKind::Normal,
        invariant: Vec::new(),
        holds: None,
        stopped: Vec::new(),
        origin: Span::default(),
    };
    let ty = Type::Int { lo: *RANGE.start(), hi: *RANGE.end() };
    TypedAutomaton {
        name: "A".to_owned(),
        actor: Some(ActorId(0)),
        clocks: Vec::new(),
        vars: (0..VARS).map(|i| starting_var(&format!("v{i}"), ty, Value::Int(0))).collect(),
        locations: (0..LOCATIONS).map(location).collect(),
        initial: LocationId(0),
        edges,
        origin: Span::default(),
    }
}

type RandomState = (u16, Vec<i64>);

/// All states, and the updates that leave their range.
fn explore(a: &TypedAutomaton) -> (BTreeSet<RandomState>, BTreeSet<Span>) {
    let first = (0, vec![0; VARS]);
    let (mut seen, mut out) = (BTreeSet::from([first.clone()]), BTreeSet::new());
    let mut queue = vec![first];
    while let Some((at, values)) = queue.pop() {
        for edge in a.edges.iter().filter(|e| e.from.0 == at) {
            let open = |g: &TypedExpr| run(g, &values) == Some(Value::Bool(true));
            if !edge.guard.as_ref().is_none_or(open) {
                continue;
            }
            if let Some(after) = updated(edge, values.clone(), &mut out) {
                let state = (edge.to.0, after);
                if seen.insert(state.clone()) {
                    queue.push(state);
                }
            }
        }
    }
    (seen, out)
}

/// The variables after an edge; `None`: one has no value, or one outside of its range.
fn updated(edge: &TypedEdge, mut values: Vec<i64>, out: &mut BTreeSet<Span>) -> Option<Vec<i64>> {
    for update in &edge.updates {
        let TypedUpdate::Assign { place: TypedLvalue { slot: VariableRef::Own(i), .. }, value: e } = update
        else {
            continue;
        };
        let Some(Value::Int(n)) = run(e, &values) else { return None };
        if !RANGE.contains(&n) {
            // A constant outside of the range is told by the checker.
            out.extend(e.constant().is_none().then_some(e.span));
            return None;
        }
        values[usize::from(*i)] = n;
    }
    Some(values)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn what_an_automaton_does_is_foreseen(edges in prop::collection::vec(edge(), 1..8)) {
        let automaton = automaton(edges);
        let (states, out) = explore(&automaton);
        let scenario = Scenario { automata: vec![automaton], ..Scenario::default() };
        let facts = ScenarioFacts::of(&scenario);
        for (at, values) in &states {
            let known = facts.flows[0].states[usize::from(*at)].as_ref();
            let foreseen = known.is_some_and(|k| k.iter().zip(values).all(|(k, n)| holds(*k, Value::Int(*n))));
            prop_assert!(foreseen, "{values:?} in {at}, where only {known:?} is foreseen");
        }
        let mut issues = Vec::new();
        overflow::check(&scenario, &facts, &mut issues);
        let told: BTreeSet<Span> = issues.iter().map(|d| d.span()).collect();
        prop_assert!(out.is_subset(&told), "{out:?} leave their range, and {told:?} are told");
    }
}
