//! Random automata and traces: the verdict is that of an evaluator that goes through all whole times, one after the other.
//!
//! Without strict bounds, and with events at whole times only, whole times tell all that real ones do (Henzinger, Manna, Pnueli 1992).

mod common;

use std::collections::BTreeSet;

use common::{scenario, trace, verdict_with};
use hrdsl_conformance::ConformanceOptions;
use hrdsl_ir::value::SECOND;
use hrdsl_results::{ConformanceOutcome, DepartureKind, RunEnd};
use proptest::prelude::*;

const INPUTS: [&str; 2] = ["ask", "stop"];
const OUTPUTS: [&str; 2] = ["give", "drop"];

#[derive(Clone, Copy, Debug)]
enum Label {
    Silent,
    In(usize),
    Out(usize),
}

#[derive(Clone, Debug)]
struct Arrow {
    from: usize,
    to: usize,
    label: Label,
    /// Bounds on each clock.
    least: [Option<i64>; 2],
    most: [Option<i64>; 2],
    resets: [bool; 2],
}

#[derive(Clone, Debug)]
struct Automaton {
    /// Whether time stands still in it, and the invariant of each clock.
    places: Vec<(bool, [Option<i64>; 2])>,
    arrows: Vec<Arrow>,
}

impl Automaton {
    fn text(&self) -> String {
        let mut text = "automaton M plays sys { clock x0, x1\n".to_owned();
        for (i, (urgent, invariant)) in self.places.iter().enumerate() {
            let init = if i == 0 { "init " } else { "" };
            let kind = if *urgent { "urgent " } else { "" };
            let bounds: Vec<String> =
                (0..2).filter_map(|c| invariant[c].map(|n| format!("x{c} <= {n} s"))).collect();
            let body = if bounds.is_empty() {
                String::new()
            } else {
                format!(" {{ invariant {} }}", bounds.join(" && "))
            };
            text += &format!("{init}{kind}location l{i}{body}\n");
        }
        for a in &self.arrows {
            let least = (0..2).filter_map(|c| a.least[c].map(|n| format!("x{c} >= {n} s")));
            let most = (0..2).filter_map(|c| a.most[c].map(|n| format!("x{c} <= {n} s")));
            let guard: Vec<String> = least.chain(most).collect();
            let when = if guard.is_empty() { String::new() } else { format!(" when {}", guard.join(" && ")) };
            let (on, sent) = match a.label {
                Label::Silent => (String::new(), None),
                Label::In(i) => (format!(" on {}", INPUTS[i]), None),
                Label::Out(o) => (String::new(), Some(OUTPUTS[o].to_owned())),
            };
            let resets = (0..2).filter(|&c| a.resets[c]).map(|c| format!("x{c} = 0"));
            let actions: Vec<String> = sent.into_iter().chain(resets).collect();
            let actions =
                if actions.is_empty() { String::new() } else { format!(" do {}", actions.join("; ")) };
            text += &format!("l{} -> l{}{on}{when}{actions}\n", a.from, a.to);
        }
        text + "}"
    }
}

/// A place, the clocks, and the ages of outputs that were not seen yet, the oldest first.
type State = (usize, [i64; 2], Vec<(usize, i64)>);

/// Clocks beyond it are not told apart.
const FAR: i64 = 20;

struct Evaluator<'a> {
    automaton: &'a Automaton,
    latency: i64,
}

#[derive(Debug, PartialEq)]
enum Outcome {
    Conforms,
    Late(i64),
    Wrong(usize),
    Refused,
}

impl Evaluator<'_> {
    fn holds(&self, place: usize, clocks: [i64; 2]) -> bool {
        (0..2).all(|c| self.automaton.places[place].1[c].is_none_or(|n| clocks[c] <= n))
    }

    fn open(&self, arrow: &Arrow, (place, clocks, _): &State) -> bool {
        let within = |c: usize| {
            arrow.least[c].is_none_or(|n| clocks[c] >= n) && arrow.most[c].is_none_or(|n| clocks[c] <= n)
        };
        arrow.from == *place && (0..2).all(within)
    }

    fn take(&self, arrow: &Arrow, state: &State) -> Option<State> {
        let mut clocks = state.1;
        (0..2).filter(|&c| arrow.resets[c]).for_each(|c| clocks[c] = 0);
        self.holds(arrow.to, clocks).then(|| (arrow.to, clocks, state.2.clone()))
    }

    /// All that happens at this instant without being seen.
    fn close(&self, states: &BTreeSet<State>) -> BTreeSet<State> {
        let mut all = states.clone();
        let mut next: Vec<State> = states.iter().cloned().collect();
        while let Some(state) = next.pop() {
            for arrow in self.automaton.arrows.iter().filter(|a| self.open(a, &state)) {
                let queued = match arrow.label {
                    Label::Silent => None,
                    // No trace here has more than five.
                    Label::Out(o) if self.latency > 0 && state.2.len() < 6 => Some(o),
                    Label::Out(_) | Label::In(_) => continue,
                };
                let Some(mut there) = self.take(arrow, &state) else { continue };
                there.2.extend(queued.map(|o| (o, 0)));
                if all.insert(there.clone()) {
                    next.push(there);
                }
            }
        }
        all
    }

    fn second(&self, states: &BTreeSet<State>) -> BTreeSet<State> {
        let later = |(place, clocks, queue): &State| {
            let clocks = clocks.map(|n| (n + 1).min(FAR));
            let queue: Vec<(usize, i64)> = queue.iter().map(|(o, age)| (*o, age + 1)).collect();
            let stays = !self.automaton.places[*place].0 && self.holds(*place, clocks);
            (stays && queue.iter().all(|(_, age)| *age <= self.latency)).then_some((*place, clocks, queue))
        };
        states.iter().filter_map(later).collect()
    }

    fn run(&self, events: &[(i64, Result<usize, usize>)], end: i64) -> Outcome {
        let mut now = 0;
        let mut states = self.close(&BTreeSet::from([(0, [0, 0], Vec::new())]));
        for (index, (time, event)) in events.iter().enumerate() {
            while now < *time {
                states = self.close(&self.second(&states));
                if states.is_empty() {
                    return Outcome::Late(now);
                }
                now += 1;
            }
            let mut next = BTreeSet::new();
            for state in &states {
                match event {
                    Ok(input) => {
                        let takes = |a: &&Arrow| matches!(a.label, Label::In(i) if i == *input);
                        let open: Vec<&Arrow> = self
                            .automaton
                            .arrows
                            .iter()
                            .filter(takes)
                            .filter(|a| self.open(a, state))
                            .collect();
                        next.extend(open.iter().filter_map(|a| self.take(a, state)));
                        if open.is_empty() {
                            next.insert(state.clone());
                        }
                    }
                    Err(output) if self.latency > 0 => {
                        if state.2.first().is_some_and(|(o, _)| o == output) {
                            next.insert((state.0, state.1, state.2[1..].to_vec()));
                        }
                    }
                    Err(output) => {
                        let makes = |a: &&Arrow| matches!(a.label, Label::Out(o) if o == *output);
                        let open = self.automaton.arrows.iter().filter(makes).filter(|a| self.open(a, state));
                        next.extend(open.filter_map(|a| self.take(a, state)));
                    }
                }
            }
            if next.is_empty() {
                return if event.is_ok() { Outcome::Refused } else { Outcome::Wrong(index) };
            }
            states = self.close(&next);
        }
        while now < end {
            states = self.close(&self.second(&states));
            if states.is_empty() {
                return Outcome::Late(now);
            }
            now += 1;
        }
        Outcome::Conforms
    }
}

fn bound() -> impl Strategy<Value = [Option<i64>; 2]> {
    let one = || prop_oneof![2 => Just(None), 1 => (0i64..6).prop_map(Some)];
    (one(), one()).prop_map(|(a, b)| [a, b])
}

fn arrow(places: usize) -> impl Strategy<Value = Arrow> {
    let label = prop_oneof![
        1 => Just(Label::Silent),
        2 => (0..2usize).prop_map(Label::In),
        3 => (0..2usize).prop_map(Label::Out),
    ];
    let resets = (any::<bool>(), any::<bool>()).prop_map(|(a, b)| [a, b]);
    (0..places, 0..places, label, bound(), bound(), resets).prop_map(
        |(from, to, label, least, most, resets)| {
            // The negation of a bound is strict, which whole times cannot tell: inputs have none.
            let bounded = !matches!(label, Label::In(_));
            let (least, most) = if bounded { (least, most) } else { ([None; 2], [None; 2]) };
            Arrow { from, to, label, least, most, resets }
        },
    )
}

fn automaton() -> impl Strategy<Value = Automaton> {
    (1..4usize).prop_flat_map(|count| {
        let place = (prop::bool::weighted(0.15), bound());
        (prop::collection::vec(place, count), prop::collection::vec(arrow(count), 1..7))
            .prop_map(|(places, arrows)| Automaton { places, arrows })
    })
}

/// Pauses, and inputs or outputs after them.
fn events() -> impl Strategy<Value = Vec<(i64, Result<usize, usize>)>> {
    let event = prop_oneof![(0..2usize).prop_map(Ok), (0..2usize).prop_map(Err)];
    prop::collection::vec((0i64..4, event), 0..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if std::env::var_os("HRDSL_CASES").is_some() { 10_000 } else { 500 }))]

    #[test]
    fn the_verdict_is_that_of_all_whole_times(automaton in automaton(), pauses in events(), rest in 0i64..6, latency in 0i64..3) {
        let mut now = 0;
        let events: Vec<(i64, Result<usize, usize>)> = pauses.iter().map(|(pause, event)| { now += pause; (now, *event) }).collect();
        let program = scenario(&automaton.text());
        // What no edge sends, or takes, the model does not speak of.
        let speaks = |event: &Result<usize, usize>| automaton.arrows.iter().any(|a| match (a.label, event) {
            (Label::In(i), Ok(n)) => i == *n,
            (Label::Out(o), Err(n)) => o == *n,
            (Label::In(_) | Label::Out(_) | Label::Silent, _) => false,
        });
        let spoken: Vec<(i64, Result<usize, usize>)> = events.iter().filter(|(_, e)| speaks(e)).copied().collect();
        let expected = Evaluator { automaton: &automaton, latency }.run(&spoken, now + rest);
        let named: Vec<(&str, f64)> = spoken.iter().map(|(t, e)| {
            (match e { Ok(i) => INPUTS[*i], Err(o) => OUTPUTS[*o] }, *t as f64)
        }).collect();
        let trace = trace(&program, &named, (now + rest) as f64);
        let options = ConformanceOptions { latency: latency * SECOND, ..ConformanceOptions::default() };
        let found = verdict_with(&program, &trace, RunEnd::Limit, &options);
        // Endless outputs at one instant are too many states, and are said to be.
        if found.why.as_ref().is_some_and(|why| why.contains("more than")) {
            return Ok(());
        }
        let what = match (found.outcome, &found.departure) {
            (ConformanceOutcome::Conforms, _) => Outcome::Conforms,
            (ConformanceOutcome::Departs, Some(d)) if d.kind == DepartureKind::Silence => Outcome::Late(d.time.round() as i64),
            (ConformanceOutcome::Departs, Some(d)) => Outcome::Wrong(d.event.as_ref().unwrap().step),
            (ConformanceOutcome::Departs | ConformanceOutcome::Inconclusive, _) => Outcome::Refused,
        };
        prop_assert_eq!(what, expected, "{}\n{:?}\n{:?}", automaton.text(), named, found);
    }
}
