//! Formulas as automata: what an automaton comes to on random traces is what the formula's monitor says, and what the definitions of `spec/metric.md` do.
//!
//! `HRDSL_SOAK=1 cargo test --workspace --test formula_automata` tries fifty times as many.

#![allow(clippy::disallowed_methods, reason = "the environment says how many traces are tried")]

#[path = "../../runtime/metric/tests/definition/mod.rs"]
#[allow(dead_code, reason = "another test asks it of single moments")]
mod definition;
#[path = "../../runtime/metric/tests/dice/mod.rs"]
mod dice;

use definition::{at, goal_bounds};
use dice::Dice;
use hrdsl_compiler::{InputFile, compile};
use hrdsl_interop::automaton::{FormulaAutomaton, GuardQuestion, GuardTest, LetterKind, automaton_of};
use hrdsl_ir::{Nanos, Program, Value, formula::MetricFormula, world::SignalId};
use hrdsl_metric::{CheckedFormula, MetricRunner, SignalPiece};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner};
use hrdsl_trace::{Trace, TraceObserver, TraceStep, TraceStepKind};

const SCENARIO: &str = "scenario many
actor robot : system
event a, b, c from robot
world {
  body one: fixed box(1 m, 1 m, 1 m) at (0 m, 0 m, 0 m)
  signal x: length to robot = one.x
  signal p: bool to robot = one.z > 0 m
  signal q: bool to robot = one.z > 1 m
}
";

/// What holds at a moment; some of it of what was before.
fn present(dice: &mut Dice, depth: usize) -> String {
    let atom = |dice: &mut Dice| {
        let atoms = ["a", "b", "c", "p", "q", "x < 2 m", "rising(p)", "falling(q)", "rising(x < 2 m)"];
        atoms[dice.below(atoms.len())].to_owned()
    };
    if depth == 0 {
        return atom(dice);
    }
    let one = present(dice, depth - 1);
    let to = dice.below(7);
    let past = match dice.below(3) {
        0 => String::new(),
        // A bound of the window that is the present alone is refused.
        _ => format!("[0 ns, {} ns]", to + 1),
    };
    match dice.below(8) {
        0 => format!("(not {one})"),
        1 => format!("({one} and {})", present(dice, depth - 1)),
        2 => format!("({one} or {})", present(dice, depth - 1)),
        3 => format!("(once{past} {one})"),
        4 => format!("(historically{past} {one})"),
        5 => format!("({one} since{past} {})", present(dice, depth - 1)),
        _ => atom(dice),
    }
}

/// What a window looks for.
fn target(dice: &mut Dice, wanted: bool) -> String {
    let plain = ["a", "b", "p", "not q", "(a or p)", "(x < 2 m and q)", "(not b)", "(p and not p)"];
    let changing = ["rising(p)", "(a or falling(q))", "(rising(p) and q)"];
    let opposite = ["not rising(p)", "(not falling(q) and p)"];
    match dice.below(4) {
        0 if wanted => changing[dice.below(changing.len())].to_owned(),
        0 => opposite[dice.below(opposite.len())].to_owned(),
        _ => plain[dice.below(plain.len())].to_owned(),
    }
}

fn ahead(dice: &mut Dice) -> String {
    let window = format!("[0 ns, {} ns]", 1 + dice.below(7));
    match dice.below(6) {
        0 | 1 => format!("(eventually{window} {})", target(dice, true)),
        2 => format!("(always{window} {})", target(dice, false)),
        3 => format!("(not (eventually{window} {}))", target(dice, true)),
        4 => format!(
            "({} until{window} {})",
            target(&mut Dice(dice.0), false).replace("rising", "").replace("falling", ""),
            target(dice, true)
        ),
        _ => format!("(not (p until{window} {}))", target(dice, true)),
    }
}

fn body(dice: &mut Dice) -> String {
    let depth = dice.below(3);
    let premise = present(dice, depth);
    match dice.below(6) {
        0 => premise,
        1 => format!("({premise} implies {})", present(dice, 1)),
        2 | 3 => format!("({premise} implies {})", ahead(dice)),
        4 => ahead(dice),
        _ => format!("({premise} implies ({} and ({} or {})))", ahead(dice), present(dice, 0), ahead(dice)),
    }
}

fn goal(dice: &mut Dice) -> String {
    match dice.below(10) {
        0 => body(dice),
        1 => format!("eventually {}", body(dice)),
        2 => format!("{} until {}", present(dice, 1), present(dice, 1)),
        3 => format!("not ({} until {})", present(dice, 1), present(dice, 1)),
        4 => format!("(always {}) and (eventually {})", body(dice), present(dice, 1)),
        5 => format!("(always {}) or ({} until {})", body(dice), present(dice, 0), present(dice, 1)),
        _ => format!("always {}", body(dice)),
    }
}

fn program(formulas: &[String]) -> Program {
    let mut text = SCENARIO.to_owned();
    for (number, formula) in formulas.iter().enumerate() {
        text += &format!("require R{number} functional formula {formula}\n");
    }
    let compiled = compile(InputFile { name: "many.hri", text: &text }, &[]);
    compiled.program.unwrap_or_else(|| panic!("{text}{:#?}", compiled.diagnostics))
}

fn trace(dice: &mut Dice, program: &Program) -> Trace {
    let signal = |name: &str| {
        let place = program.signals.iter().position(|s| s.name == name).unwrap();
        SignalId(u16::try_from(place).unwrap())
    };
    let sample = |dice: &mut Dice, name: &str| {
        let value = if name == "x" {
            Value::Float([0.0, 2.0, 3.0][dice.below(3)])
        } else {
            Value::Bool(dice.below(2) == 0)
        };
        TraceStepKind::Sample { signal: signal(name), value }
    };
    let (mut steps, mut time) = (Vec::new(), 0);
    let late = dice.below(8) == 0;
    for name in ["x", "p", "q"] {
        if !late || dice.below(2) == 0 {
            steps.push(TraceStep { time, what: sample(dice, name) });
        }
    }
    for _ in 0..dice.below(20) {
        time += [0, 0, 1, 1, 2, 3, 6][dice.below(7)];
        let what = if dice.below(2) == 0 {
            let event = program.event_named(["a", "b", "c"][dice.below(3)]).unwrap();
            TraceStepKind::Event { event, args: Vec::new() }
        } else {
            let name = ["x", "p", "q"][dice.below(3)];
            sample(dice, name)
        };
        steps.push(TraceStep { time, what });
    }
    Trace { steps, end: time + [0, 1, 2, 4][dice.below(4)] }
}

/// An automaton on a run, moment by moment, as its page says.
fn outcome_of(
    automaton: &FormulaAutomaton,
    atoms: &[Vec<SignalPiece>],
    (start, end): (Nanos, Nanos),
) -> MonitorOutcome {
    let holds = |formula: &MetricFormula, time: Nanos| at(formula, atoms, (start, end), (time, true)).holds();
    let mut state = 0;
    let mut zero = vec![start; automaton.clocks.len()];
    for now in start..=end {
        let letter = |letter: usize| match &automaton.letters[letter].what {
            LetterKind::Atom(atom) => holds(&MetricFormula::Atom(*atom), now),
            LetterKind::Rising(of) => now > start && holds(of, now) && !holds(of, now - 1),
            LetterKind::Falling(of) => now > start && !holds(of, now) && holds(of, now - 1),
        };
        let answers = |test: &GuardTest| {
            let answer = match test.of {
                GuardQuestion::Letter(of) => letter(of),
                GuardQuestion::AtLeast { clock, bound } => now - zero[clock] >= bound,
                GuardQuestion::AtMost { clock, bound } => now - zero[clock] <= bound,
            };
            answer == test.wanted
        };
        let leaving = automaton.edges.iter().filter(|edge| edge.from == state);
        let enabled: Vec<_> =
            leaving.filter(|edge| edge.guard.iter().any(|tests| tests.iter().all(answers))).collect();
        assert!(enabled.len() <= 1, "at {now} in {state}: {enabled:#?}\n{automaton:#?}");
        if let Some(edge) = enabled.first() {
            state = edge.to;
            edge.resets.iter().for_each(|clock| zero[*clock] = now);
        }
    }
    automaton.states[state].outcome
}

/// A line for each state, and for each edge.
fn drawn(automaton: &FormulaAutomaton) -> String {
    let states = automaton.states.iter().enumerate();
    let states = states.map(|(number, state)| format!("{number} {} ({})\n", state.name, state.outcome));
    let edges = automaton
        .edges
        .iter()
        .map(|edge| format!("{} -> {}: {} / {:?}\n", edge.from, edge.to, edge.text, edge.resets));
    states.chain(edges).collect()
}

#[test]
fn an_automaton_judges_as_its_formula_does() {
    let rounds = if std::env::var_os("HRDSL_SOAK").is_some() { 1_000 } else { 20 };
    let mut dice = Dice(3);
    let (mut met, mut automata, mut largest) = ([0_usize; 4], 0, 0);
    for _ in 0..rounds {
        let formulas: Vec<String> = (0..30).map(|_| goal(&mut dice)).collect();
        let program = program(&formulas);
        let found: Vec<_> =
            program.monitors.iter().map(|monitor| automaton_of(monitor.formula.as_ref().unwrap())).collect();
        automata += found.iter().filter(|a| a.is_ok()).count();
        for _ in 0..40 {
            let trace = trace(&mut dice, &program);
            let mut monitors = MonitorRunner::new(&program);
            trace.replay(&mut monitors);
            for (verdict, automaton) in monitors.verdicts().iter().zip(&found) {
                let Ok(automaton) = automaton else { continue };
                largest = largest.max(automaton.states.len());
                let monitor = &program.monitors[verdict.monitor];
                let checked = CheckedFormula::of_monitor(monitor).unwrap();
                let mut runner = MetricRunner::new(&checked).taping();
                trace.replay(&mut runner as &mut dyn TraceObserver);
                let shown = || format!("{}\n{trace:?}\n{}", monitor.text, drawn(automaton));
                let Some(tape) = runner.tape() else {
                    assert_eq!(verdict.outcome, MonitorOutcome::Vacuous, "{}", shown());
                    continue;
                };
                let span = (tape.start, tape.end);
                let outcome = outcome_of(automaton, &tape.atoms, span);
                assert_eq!(outcome, verdict.outcome, "{}", shown());
                let [lower, upper] =
                    [false, true].map(|upper| goal_bounds(&checked.goal, &tape.atoms, span, upper).holds());
                let defined = match outcome {
                    MonitorOutcome::Fail => !upper,
                    MonitorOutcome::Inconclusive => upper && !lower,
                    MonitorOutcome::Pass | MonitorOutcome::Vacuous => lower,
                };
                assert!(defined, "{lower} {upper} {outcome}: {}", shown());
                met[outcome as usize] += 1;
            }
        }
    }
    assert!(met.iter().all(|n| *n > 200), "{met:?}");
    assert!(automata > rounds * 15, "{automata} of {} formulas are automata", rounds * 30);
    println!(
        "{automata} automata of {} formulas, of {largest} states at most; verdicts {met:?}",
        rounds * 30
    );
}
