//! Small models, and what of the code does not conform to them.

mod common;

use common::{scenario, trace, verdict, verdict_with};
use hrdsl_conformance::{ConformanceOptions, system_models};
use hrdsl_ir::{Program, value::SECOND};
use hrdsl_results::{ConformanceOutcome, ConformanceVerdict, DepartureKind, RunEnd};

/// Gives between 2 s and 5 s after it was asked.
fn waiter() -> Program {
    scenario(
        "automaton Waiter plays sys { clock x\n init location idle\n location busy { invariant x <= 5 s }\n\
         idle -> busy on ask do x = 0\n busy -> idle when x >= 2 s do give }",
    )
}

fn sentence(verdict: &ConformanceVerdict) -> String {
    verdict.sentence().unwrap_or_else(|| "conforms".to_owned())
}

#[test]
fn what_the_model_does_conforms_with_its_bounds() {
    let waiter = waiter();
    for give in [3.0, 4.5, 6.0] {
        let verdict = verdict(&waiter, &[("ask", 1.0), ("give", give)], 20.0);
        assert_eq!(verdict.outcome, ConformanceOutcome::Conforms, "{give}: {}", sentence(&verdict));
    }
    assert_eq!(verdict(&waiter, &[], 20.0).outcome, ConformanceOutcome::Conforms);
    assert_eq!(
        verdict(&waiter, &[("ask", 1.0)], 5.0).outcome,
        ConformanceOutcome::Conforms,
        "there was still time"
    );
}

#[test]
fn who_comes_early_departs_at_the_event_and_is_told_the_window() {
    let found = verdict(&waiter(), &[("ask", 1.0), ("give", 2.5)], 20.0);
    assert_eq!(found.outcome, ConformanceOutcome::Departs);
    assert_eq!(
        sentence(&found),
        "Waiter: at 2.5 s give came; the model allows give from 3 s to 6 s, silence to 6 s, in Waiter.busy"
    );
    let departure = found.departure.unwrap();
    let edges: Vec<_> = departure.allowed[0].edges.iter().map(|e| e.name.as_str()).collect();
    assert_eq!((edges, departure.event.unwrap().step), (vec!["Waiter: busy -> idle"], 1));
}

#[test]
fn who_comes_late_departs_at_the_deadline() {
    let found = verdict(&waiter(), &[("ask", 1.0), ("give", 6.25)], 20.0);
    assert_eq!(
        sentence(&found),
        "Waiter: nothing came by 6 s, and give at 6.25 s; the model allows give from 3 s to 6 s, in Waiter.busy"
    );
}

#[test]
fn silence_departs_even_if_nothing_comes_any_more() {
    let found = verdict(&waiter(), &[("ask", 1.0)], 20.0);
    assert_eq!(
        sentence(&found),
        "Waiter: nothing came by 6 s; the model allows give from 3 s to 6 s, in Waiter.busy"
    );
    assert_eq!(found.departure.unwrap().kind, DepartureKind::Silence);
}

#[test]
fn a_run_at_rest_stays_silent_until_the_limit_of_its_system() {
    let text = "automaton Waiter plays sys { clock x\n init location idle\n location busy { invariant x <= 5 s }\n\
         idle -> busy on ask do x = 0\n busy -> idle when x >= 2 s do give }\n\
         system sys { run \"none\"\n limit 10 s }";
    let program = scenario(text);
    let short = trace(&program, &[("ask", 1.0)], 2.0);
    let of = |ended| verdict_with(&program, &short, ended, &ConformanceOptions::default());
    assert_eq!(
        sentence(&of(RunEnd::Quiescent)),
        "Waiter: nothing came by 6 s; the model allows give from 3 s to 6 s, in Waiter.busy"
    );
    assert_eq!(of(RunEnd::Limit).outcome, ConformanceOutcome::Conforms);
    assert_eq!(sentence(&of(RunEnd::Error)), "Waiter: the run broke off");
}

#[test]
fn another_event_departs_and_one_of_which_the_model_does_not_speak_does_not() {
    let program = scenario(
        "automaton Waiter plays sys { clock x\n init location idle\n location busy\n idle -> busy on ask\n\
         busy -> idle do give\n idle -> idle when x >= 100 s do drop }",
    );
    let found = verdict(&program, &[("ask", 1.0), ("other", 1.5), ("drop", 2.0)], 20.0);
    assert_eq!(
        sentence(&found),
        "Waiter: at 2 s drop came; the model allows give from 1 s on, drop from 100 s on, silence, in Waiter.busy"
            .replace(", drop from 100 s on", "")
    );
}

#[test]
fn arguments_are_a_part_of_the_event() {
    let program = scenario(
        "automaton Echo plays sys { var last: 0..9 = 0\n init location idle\n urgent location told\n\
         idle -> told on level(n) do last = n\n told -> idle do said(last) }",
    );
    let of = |n: &str| verdict(&program, &[("level 4", 1.0), (n, 1.0)], 3.0);
    assert_eq!(of("said 4").outcome, ConformanceOutcome::Conforms);
    let wrong = of("said 5").departure.unwrap();
    assert_eq!(wrong.allowed.iter().map(|a| a.event.as_str()).collect::<Vec<_>>(), ["said(n: 4)"]);
    let late = verdict(&program, &[("level 4", 1.0), ("said 4", 1.001)], 3.0);
    assert_eq!(late.departure.unwrap().time, 1.0, "an urgent location lets no time pass");
}

#[test]
fn inner_choices_are_all_kept_until_something_tells_them_apart() {
    let program = scenario(
        "automaton Chooser plays sys { clock x\n init location idle\n location soon { invariant x <= 2 s }\n\
         location later { invariant x <= 9 s }\n idle -> soon on ask do x = 0\n idle -> later on ask do x = 0\n\
         soon -> idle do give\n later -> idle when x >= 8 s do give\n later -> later when x >= 3 s do drop }",
    );
    let outcome = |events: &[(&str, f64)]| verdict(&program, events, 9.5).outcome;
    assert_eq!(outcome(&[("ask", 0.5), ("give", 1.5)]), ConformanceOutcome::Conforms);
    assert_eq!(outcome(&[("ask", 0.5), ("give", 9.0)]), ConformanceOutcome::Conforms);
    assert_eq!(
        outcome(&[("ask", 0.5), ("drop", 4.0), ("give", 5.0)]),
        ConformanceOutcome::Departs,
        "the drop has told that it was the later one"
    );
    let between = verdict(&program, &[("ask", 0.5), ("give", 5.0)], 9.5).departure.unwrap();
    assert_eq!(between.locations[0].name, "Chooser.later");
}

#[test]
fn silent_edges_happen_at_any_time_that_they_may() {
    let program = scenario(
        "automaton Two plays sys { clock x\n init location idle\n location first { invariant x <= 3 s }\n\
         location second { invariant x <= 4 s }\n idle -> first on ask do x = 0\n\
         first -> second when x >= 1 s do x = 0\n second -> idle when x >= 2 s do give }",
    );
    let outcome = |give: f64| verdict(&program, &[("ask", 0.0), ("give", give)], 20.0).outcome;
    assert_eq!(
        [2.9, 3.0, 5.0, 7.0].map(outcome),
        [
            ConformanceOutcome::Departs,
            ConformanceOutcome::Conforms,
            ConformanceOutcome::Conforms,
            ConformanceOutcome::Conforms
        ]
    );
    assert_eq!(verdict(&program, &[("ask", 0.0)], 20.0).departure.unwrap().time, 7.0);
}

#[test]
fn inputs_without_an_edge_are_ignored_and_those_that_break_an_invariant_refused() {
    let waiter = waiter();
    let twice = [("ask", 1.0), ("ask", 2.0), ("give", 4.0), ("stop", 5.0)];
    assert_eq!(verdict(&waiter, &twice, 9.0).outcome, ConformanceOutcome::Conforms);
    let program = scenario(
        "automaton Picky plays sys { clock x\n init location idle\n location busy { invariant x <= 5 s }\n\
         idle -> busy on ask\n busy -> idle do give }",
    );
    assert_eq!(verdict(&program, &[("ask", 4.0)], 4.5).outcome, ConformanceOutcome::Conforms);
    let refused = verdict(&program, &[("ask", 6.0)], 9.0);
    assert_eq!(refused.outcome, ConformanceOutcome::Inconclusive);
    assert!(sentence(&refused).contains("cannot take ask at 6 s"), "{}", sentence(&refused));
}

#[test]
fn a_latency_lets_outputs_be_seen_later_than_they_happened_and_after_inputs_that_came_later() {
    let program = scenario(
        "automaton Race plays sys { clock x\n init location idle { invariant x <= 5 s }\n location done\n\
         location stopped\n idle -> done when x >= 4 s do give\n idle -> stopped on stop }",
    );
    let of = |events: &[(&str, f64)], seconds: i64| {
        let options = ConformanceOptions { latency: seconds * SECOND, ..ConformanceOptions::default() };
        verdict_with(&program, &trace(&program, events, 20.0), RunEnd::Limit, &options)
    };
    let raced = [("stop", 4.5), ("give", 4.75)];
    assert_eq!(of(&raced, 0).outcome, ConformanceOutcome::Departs);
    assert_eq!(of(&raced, 1).outcome, ConformanceOutcome::Conforms);
    assert_eq!(of(&[("give", 6.5)], 1).departure.unwrap().time, 6.0, "a second later than the model");
    assert_eq!(of(&[("give", 6.5)], 2).outcome, ConformanceOutcome::Conforms);
    assert_eq!(
        of(&[("give", 3.5)], 2).outcome,
        ConformanceOutcome::Departs,
        "nothing is seen before it happens"
    );
}

#[test]
fn what_is_not_observed_contradicts_nothing_and_proves_nothing() {
    let waiter = waiter();
    let give = waiter.event_named("give").unwrap();
    let options = ConformanceOptions { unobserved: vec![give], ..ConformanceOptions::default() };
    let found = verdict_with(&waiter, &trace(&waiter, &[("ask", 1.0)], 20.0), RunEnd::Limit, &options);
    assert_eq!(sentence(&found), "Waiter: nothing contradicts it, but give is not observed");
}

#[test]
fn what_is_shared_with_other_actors_is_in_no_trace() {
    let program = scenario(
        "var free: bool = true\n\
         automaton Guest plays env { init location idle\n idle -> idle do ask; free = false }\n\
         automaton Waiter plays sys { init location idle\n idle -> idle when free do give }\n\
         network both = Guest | Waiter",
    );
    let found = verdict(&program, &[("give", 1.0)], 2.0);
    assert_eq!(
        sentence(&found),
        "Waiter: it shares the variable `free` with `Guest`, and no trace shows what that does to it"
    );
}

#[test]
fn automata_of_one_actor_are_one_model_with_those_that_only_they_speak_with() {
    let program = scenario(
        "channel go\n\
         automaton Ear plays sys { init location idle\n urgent location heard\n idle -> heard on ask\n\
         heard -> idle do go }\n\
         automaton Relay { clock x\n init location idle\n location run { invariant x <= 2 s }\n\
         idle -> run on go do x = 0\n run -> idle when x >= 2 s do done }\n channel done\n\
         automaton Mouth plays sys { init location idle\n urgent location told\n idle -> told on done\n\
         told -> idle do give }\n\
         automaton Guest plays env { init location idle\n idle -> idle do ask }\n\
         network all = Guest | Ear | Relay | Mouth",
    );
    let models = system_models(&program);
    assert_eq!(models.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["Ear | Relay | Mouth"]);
    let outcome = |give: f64| verdict(&program, &[("ask", 1.0), ("give", give)], 9.0).outcome;
    assert_eq!(outcome(3.0), ConformanceOutcome::Conforms);
    assert_eq!(outcome(2.5), ConformanceOutcome::Departs);
}

#[test]
fn a_fault_of_the_model_is_said_and_no_verdict_on_the_code() {
    let program = scenario(
        "automaton Counter plays sys { var n: 0..1 = 0\n init location idle\n idle -> idle on ask do n += 1 }",
    );
    let found = verdict(&program, &[("ask", 1.0), ("ask", 2.0)], 9.0);
    assert_eq!(found.outcome, ConformanceOutcome::Inconclusive);
    assert!(sentence(&found).contains("the model is at fault"), "{}", sentence(&found));
}
