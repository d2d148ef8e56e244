//! Tests of the recording format: what is written is read back, and what is wrong is said.

use hrdsl_ir::{
    Actor, ActorId, Enumeration, Event, EventId, Expr, Nanos, Parameter, Program, Role, Span, Symbol, Type,
    Unit, Value,
    world::{Signal, SignalId},
};
use proptest::prelude::*;

use crate::{
    MachineDeclaration, MachineEdge, MachineStep, RunEnd, Trace, TraceStep, TraceStepKind, decimal,
    parse::{LineProblem, OpenRecording, RecordingSummary, parse},
    print,
    record::{self, RecordingEnd, RecordingHeader},
    vocabulary,
};

fn event(name: &str, from: u16, params: &[(&str, Type)]) -> Event {
    let param = |(name, ty): &(&str, Type)| Parameter { name: (*name).to_owned(), ty: *ty };
    Event {
        name: name.to_owned(),
        params: params.iter().map(param).collect(),
        from: ActorId(from),
        to: Vec::new(),
        stimulus: None,
        origin: Span::default(),
    }
}

fn signal(name: &str, ty: Type) -> Signal {
    Signal {
        name: name.to_owned(),
        ty,
        to: Vec::new(),
        terms: Vec::new(),
        value: Expr::bool(true),
        recorded: true,
        origin: Span::default(),
    }
}

/// With names that look like other values.
fn pace() -> Type {
    Type::Enum(Enumeration::intern("Pace", &["slow", "fast", "nan", "true"]))
}

fn symbol(name: &str) -> Value {
    Value::Symbol(Symbol::intern(name))
}

pub(crate) fn program() -> Program {
    let actor = |name: &str, role| Actor { name: name.to_owned(), role, origin: Span::default() };
    let sensed =
        [("gaze", Type::Bool), ("legs", Type::Int { lo: 0, hi: 4 }), ("far", Type::Float(Unit::Metre))];
    let any = [("n", Type::Int { lo: i64::MIN, hi: i64::MAX })];
    Program {
        name: "handover".to_owned(),
        actors: vec![actor("person", Role::Environment), actor("robot", Role::System)],
        events: vec![
            event("leg_request", 0, &[]),
            event("decided", 1, &[("ready", Type::Bool)]),
            event("sensed", 0, &sensed),
            event("counted", 1, &any),
            event("paced", 1, &[("pace", pace()), ("far", Type::Float(Unit::Metre))]),
        ],
        signals: vec![
            signal("gaze", Type::Bool),
            signal("distance(person.hand, \"λ\")", Type::Float(Unit::Metre)),
            signal("legs", Type::Int { lo: 0, hi: 4 }),
            signal("pace", pace()),
        ],
        ..Program::default()
    }
}

const HEADER: &str = r#"{"hrdsl":"trace","version":1,"scenario":"handover"}"#;

fn fault(lines: &[&str]) -> (usize, String) {
    let error = parse(&program(), &(lines.join("\n") + "\n")).unwrap_err();
    (error.line, error.problem.to_string())
}

fn happens(time: Nanos, event: u16, args: Vec<Value>) -> TraceStep {
    TraceStep { time, what: TraceStepKind::Event { event: EventId(event), args } }
}

fn reads(time: Nanos, signal: u16, value: Value) -> TraceStep {
    TraceStep { time, what: TraceStepKind::Sample { signal: SignalId(signal), value } }
}

#[test]
fn a_recording_is_lines_of_names() {
    let args = vec![Value::Bool(false), Value::Int(3), Value::Float(1.0)];
    let trace = Trace {
        steps: vec![
            happens(0, 0, Vec::new()),
            happens(1_250_000_000, 1, vec![Value::Bool(true)]),
            happens(1_250_000_001, 2, args),
            reads(2_000_000_000, 1, Value::Float(-0.25)),
        ],
        end: 300_000_000_000,
    };
    let header = RecordingHeader {
        scenario: "handover".into(),
        vocabulary: Some("0123456789abcdef".into()),
        test: Some("t \"1\"".into()),
        seed: Some(u64::MAX),
    };
    let ending = RecordingEnd { kind: RunEnd::Error, error: Some("it \"fell\"\noff".into()) };
    let text = record::write(&program(), &header, &trace, &ending);
    let expected = [
        r#"{"hrdsl":"trace","version":2,"scenario":"handover","vocabulary":"0123456789abcdef","test":"t \"1\"","seed":18446744073709551615}"#,
        r#"{"t":0,"event":"leg_request"}"#,
        r#"{"t":1.25,"event":"decided","args":{"ready":true}}"#,
        r#"{"t":1.250000001,"event":"sensed","args":{"gaze":false,"legs":3,"far":1.0}}"#,
        r#"{"t":2,"signal":"distance(person.hand, \"λ\")","value":-0.25}"#,
        r#"{"end":300,"ended":"error","error":"it \"fell\"\noff"}"#,
        "",
    ];
    assert_eq!(text, expected.join("\n"));
    let recorded = RecordingSummary { header, end: trace.end, ending, steps: 4 };
    assert_eq!(parse(&program(), &text).unwrap(), (recorded, trace));
}

#[test]
fn recordings_of_other_programs_are_read() {
    let text = "{\"hrdsl\": \"trace\", \"version\": 1, \"scenario\": \"handover\", \"robot\": 7}\r\n\r\n\
        {\"args\": {\"far\": 2, \"gaze\": true, \"legs\": 0}, \"event\": \"sensed\", \"t\": 0.30000000000000004}\r\n\
        {\"t\": 3e-1, \"event\": \"leg_request\", \"args\": {}}\n{\"end\": 1.0}";
    let (recorded, trace) = parse(&program(), text).unwrap();
    assert_eq!((recorded.header.test, recorded.header.seed), (None, None));
    let args = vec![Value::Bool(true), Value::Int(0), Value::Float(2.0)];
    assert_eq!(trace.steps, [happens(300_000_000, 2, args), happens(300_000_000, 0, Vec::new())]);
    assert_eq!(trace.end, 1_000_000_000);
}

#[test]
fn faults_are_said_with_their_line() {
    let says = |line: &str, expected: &str| assert_eq!(fault(&[HEADER, line]), (2, expected.to_owned()));
    says(r#"{"t":0,"event":"decide"}"#, "unknown event `decide`; did you mean `decided`?");
    says(r#"{"t":0,"event":"fly"}"#, "unknown event `fly`");
    says(r#"{"t":0,"signal":"gazes","value":1}"#, "unknown signal `gazes`; did you mean `gaze`?");
    says(r#"{"t":0,"event":"decided"}"#, "event `decided` lacks the argument `ready`");
    let twice = r#"{"t":0,"event":"decided","args":{"ready":true,"ready":false}}"#;
    says(twice, "event `decided` has the argument `ready` twice");
    let unknown = r#"{"t":0,"event":"decided","args":{"redy":true}}"#;
    says(unknown, "event `decided` has no parameter `redy`; did you mean `ready`?");
    says(r#"{"t":0,"event":"decided","args":{"ready":1}}"#, "`ready` has to be true or false, not 1");
    says(r#"{"t":0,"signal":"legs","value":5}"#, "`legs` has to be a whole number in 0..4, not 5");
    says(r#"{"t":0,"signal":"legs","value":1.0}"#, "`legs` has to be a whole number in 0..4, not 1.0");
    let far = r#"{"t":0,"event":"sensed","args":{"gaze":true,"legs":1,"far":"near"}}"#;
    says(far, "`far` has to be a number (m), not \"near\"");
    says(r#"{"t":"1","event":"leg_request"}"#, "`\"1\"` is not a time in seconds, at least 0");
    says(r#"{"t":-1,"event":"leg_request"}"#, "`-1` is not a time in seconds, at least 0");
    says(r#"{"event":"leg_request"}"#, "the step lacks its time `t`");
    says(r#"{"t":1}"#, "the step has neither `event` nor `signal` nor `machine`");
    says(r#"{"t":1,"signal":"gaze"}"#, "the sample lacks its `value`");
    says(r#"{"t":1,"signal":"gaze","value":true,"args":{}}"#, "a sample has `t`, `signal` and `value` only");
    says(r#"{"t":1,"event":"leg_request","value":1}"#, "an event has `t`, `event` and `args` only");
    says(r#"{"end":1,"t":1}"#, "the last line has `end`, `ended` and `error` only");
    says(
        r#"{"t":1,"evnt":"x"}"#,
        "not a line of a recording: unknown field `evnt`, expected one of `t`, `event`, `args`, `signal`, `value`, `machine`, `states`, `transitions`, `outcomes`, `from`, `outcome`, `to`, `end`, `ended`, `error` (column 13)",
    );
}

#[test]
fn time_goes_forward_until_the_end() {
    let ask = |t: &str| format!(r#"{{"t":{t},"event":"leg_request"}}"#);
    let found = fault(&[HEADER, &ask("1.5"), "", &ask("1.499999999")]);
    assert_eq!(found, (4, "time goes backwards: 1.499999999 s after 1.5 s".to_owned()));
    assert_eq!(fault(&[HEADER, &ask("2"), r#"{"end":1}"#]).0, 3);
    assert_eq!(fault(&[HEADER, r#"{"end":1}"#, &ask("2")]), (3, LineProblem::AfterEnd.to_string()));
}

#[test]
fn a_file_cut_off_anywhere_is_noticed() {
    let trace = Trace { steps: vec![happens(5, 1, vec![Value::Bool(true)])], end: 25_000_000_000 };
    let header = RecordingHeader { scenario: "handover".into(), ..RecordingHeader::default() };
    let text = record::write(&program(), &header, &trace, &RecordingEnd::default());
    for cut in 0..text.len() - 1 {
        let error = parse(&program(), &text[..cut]);
        // Without its final line break it is still whole.
        let line = text[..cut].lines().count().max(1);
        let problem = if cut == 0 { LineProblem::NoHeader } else { LineProblem::Truncated };
        assert_eq!(error.map_err(|e| (e.line, e.problem)), Err((line, problem)), "cut at {cut}");
    }
    assert!(parse(&program(), text.trim_end()).is_ok());
}

#[test]
fn the_last_line_says_how_the_run_ended() {
    let ending = |last: &str| parse(&program(), &[HEADER, last].join("\n")).unwrap().0.ending;
    assert_eq!(ending(r#"{"end":1}"#), RecordingEnd::default());
    assert_eq!(ending(r#"{"end":1,"ended":"limit"}"#).kind, RunEnd::Limit);
    assert_eq!(ending(r#"{"end":1,"ended":"quiescent"}"#).kind, RunEnd::Quiescent);
    assert_eq!(ending(r#"{"end":1,"ended":"quiet"}"#).kind, RunEnd::Quiescent, "as it was said before");
    let error = ending(r#"{"end":1,"ended":"error","error":"gone"}"#);
    assert_eq!(error, RecordingEnd { kind: RunEnd::Error, error: Some("gone".into()) });
    let faults = [
        (
            r#"{"end":1,"ended":"over"}"#,
            "`over` is not how a run ends; that is `quiescent`, `limit` or `error`",
        ),
        (r#"{"end":1,"error":"gone"}"#, "a run has an `error` only if it `ended` in error"),
        (r#"{"end":1,"t":1}"#, "the last line has `end`, `ended` and `error` only"),
        (r#"{"t":1,"ended":"quiescent"}"#, "only the last line says how the run ended"),
    ];
    for (line, says) in faults {
        assert_eq!(fault(&[HEADER, line]), (2, says.to_owned()));
    }
}

#[test]
fn only_recordings_with_state_machines_are_of_version_3() {
    let begun = MachineStep::Begun { machine: "M".into(), state: "A".into() };
    let steps = vec![TraceStep { time: 0, what: TraceStepKind::Machine(Box::new(begun)) }];
    for (trace, version) in [(Trace::default(), 2), (Trace { steps, end: 1 }, 3)] {
        let text = record::write(&program(), &RecordingHeader::default(), &trace, &RecordingEnd::default());
        assert!(text.starts_with(&format!("{{\"hrdsl\":\"trace\",\"version\":{version},")), "{text}");
    }
}

#[test]
fn steps_of_state_machines_are_whole() {
    let whole = "a step of a state machine has `t`, `machine` and what it did only";
    let form = "a state machine has `states`, `transitions` and `outcomes`, or goes `from` a state by an `outcome` `to` another, \
                or begins with a state `to` which it goes";
    for (line, says) in [
        (r#"{"t":1,"machine":"M"}"#, form),
        (r#"{"t":1,"machine":"M","from":"A","to":"B"}"#, form),
        (r#"{"t":1,"machine":"M","states":[],"to":"B"}"#, form),
        (r#"{"t":1,"to":"B"}"#, whole),
        (r#"{"t":1,"machine":"M","to":"B","value":1}"#, whole),
        (r#"{"end":1,"machine":"M"}"#, "the last line has `end`, `ended` and `error` only"),
    ] {
        assert_eq!(fault(&[HEADER, line]), (2, says.to_owned()), "{line}");
    }
}

#[test]
fn a_line_that_is_no_text_is_named() {
    let read = |bytes: &[u8]| {
        let mut trace = Trace::default();
        let recording = OpenRecording::open(bytes).and_then(|r| r.replay(&program(), &mut trace));
        recording.unwrap_err().to_string()
    };
    let text = [HEADER.as_bytes(), b"\n\n{\"t\":\xff}\n"].concat();
    assert_eq!(read(&text), "line 3: the line is not text in UTF-8");
    let long = [HEADER.as_bytes(), b"\n", &vec![b' '; 17 << 20], b"{\"end\":1}"].concat();
    assert_eq!(read(&long), "line 2: the line is longer than 16 MiB");
}

#[test]
fn a_vocabulary_is_names_and_types_in_any_order() {
    let mut other = program();
    assert_eq!(
        vocabulary::listed(&other).lines().last(),
        Some("signal pace:enum slow|fast|nan|true"),
        "{}",
        vocabulary::listed(&other)
    );
    other.events.reverse();
    other.signals.reverse();
    other.name = "another".into();
    assert_eq!(vocabulary::digest(&program()), vocabulary::digest(&other));
    other.events.push(event("more", 1, &[]));
    assert_ne!(vocabulary::digest(&program()), vocabulary::digest(&other));
}

#[test]
fn headers_are_checked() {
    assert_eq!(fault(&[r#"{"end":1}"#]), (1, LineProblem::NoHeader.to_string()));
    assert_eq!(
        fault(&[r#"{"hrdsl":"report","version":1,"scenario":"s"}"#]).1,
        LineProblem::NoHeader.to_string()
    );
    for (version, says) in [(0, "version 0"), (4, "version 4; versions 1 to 3 can be read")] {
        let found = fault(&[&format!(r#"{{"hrdsl":"trace","version":{version},"scenario":"s"}}"#)]).1;
        assert!(found.contains(says), "{found}");
    }
    assert_eq!(fault(&["[1"]).0, 1);
}

#[test]
fn the_first_of_several_of_one_name_is_meant() {
    let mut program = program();
    program.events.push(event("leg_request", 1, &[]));
    program.signals.push(signal("gaze", Type::Bool));
    let lines = [
        HEADER,
        r#"{"t":0,"event":"leg_request"}"#,
        r#"{"t":0,"signal":"gaze","value":true}"#,
        r#"{"end":0}"#,
    ];
    let (_, trace) = parse(&program, &lines.join("\n")).unwrap();
    assert_eq!(trace.steps, [happens(0, 0, Vec::new()), reads(0, 0, Value::Bool(true))]);
}

#[test]
fn floats_that_are_no_json_numbers_are_kept() {
    for x in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let trace = Trace { steps: vec![reads(0, 1, Value::Float(x))], end: 0 };
        let text = record::write(&program(), &RecordingHeader::default(), &trace, &RecordingEnd::default());
        let (_, read) = parse(&program(), &text).unwrap();
        assert_eq!(format!("{trace:?}"), format!("{read:?}"));
    }
}

#[test]
fn symbols_are_names_and_read_by_their_type() {
    let trace = Trace {
        steps: vec![
            happens(0, 4, vec![symbol("nan"), Value::Float(f64::NAN)]),
            reads(1, 3, symbol("fast")),
            reads(2, 3, symbol("true")),
        ],
        end: 2,
    };
    let text = record::write(&program(), &RecordingHeader::default(), &trace, &RecordingEnd::default());
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[1], r#"{"t":0,"event":"paced","args":{"pace":"nan","far":"nan"}}"#);
    assert_eq!(lines[2], r#"{"t":0.000000001,"signal":"pace","value":"fast"}"#);
    let (_, read) = parse(&program(), &text).unwrap();
    assert_eq!(format!("{read:?}"), format!("{trace:?}"));
    assert!(print::line(&program(), &read.steps[0]).ends_with("paced(pace: nan, far: NaN m)"));
    assert!(print::line(&program(), &read.steps[1]).ends_with("pace = fast"));
}

#[test]
fn a_value_that_an_enumeration_lacks_is_refused_with_those_it_has() {
    for wrong in ["\"quick\"", "\"Fast\"", "true", "1", "null"] {
        let (line, says) = fault(&[HEADER, &format!(r#"{{"t":0,"signal":"pace","value":{wrong}}}"#)]);
        let expected = "the name of a value of `Pace` (`slow`, `fast`, `nan`, `true`)";
        let expected = match wrong {
            // Taken for a value that is left out.
            "null" => "the sample lacks its `value`".to_owned(),
            wrong => format!("`pace` has to be {expected}, not {wrong}"),
        };
        assert_eq!((line, says), (2, expected));
    }
}

#[test]
fn people_see_aligned_lines() {
    let shown = |step| print::line(&program(), &step);
    let decided = happens(12_500_000_000, 1, vec![Value::Bool(true)]);
    assert_eq!(shown(decided), "  12.500 s  robot   decided(ready: true)");
    assert_eq!(shown(happens(999_999_999, 0, Vec::new())), "   1.000 s  person  leg_request");
    let far = reads(300_000_000_000, 1, Value::Float(0.1 + 0.2));
    assert_eq!(shown(far), " 300.000 s  signal  distance(person.hand, \"λ\") = 0.3 m");
    assert_eq!(print::value(Value::Float(f64::NAN), Unit::Second), "NaN s");
    assert_eq!(print::value(Value::Float(1_234_567.0), Unit::None), "1234600");
}

#[test]
fn seconds_are_exact() {
    for (time, text) in [(0, "0"), (1, "0.000000001"), (1_500_000_000, "1.5"), (-10_000_000, "-0.01")] {
        assert_eq!((decimal::seconds(time).as_str(), decimal::nanos(text)), (text, Some(time)));
    }
    for (text, time) in [
        ("1e3", 1_000_000_000_000),
        ("12.5E-1", 1_250_000_000),
        ("0.0000000005", 1),
        ("0.00000000049999", 0),
        ("5e-10", 1),
        ("9e-11", 0),
        ("-5e-10", -1),
        ("0e99999", 0),
        ("1e-99999", 0),
        ("0.1e+1", 1_000_000_000),
    ] {
        assert_eq!(decimal::nanos(text), Some(time), "{text}");
    }
    for bad in
        ["", "-", "1.2.3", "x", "1e", "1e999999", "9223372036.854775808", ".5", "+1", "null", "1e99999999999"]
    {
        assert_eq!(decimal::nanos(bad), None, "{bad}");
    }
}

/// The recordings in the description of the format are recordings.
#[test]
fn the_specification_shows_real_recordings() {
    let spec = include_str!("../../../spec/traces.md");
    let blocks: Vec<&str> = spec
        .split("```json\n")
        .skip(1)
        .filter_map(|rest| rest.split_once("```").map(|(block, _)| block))
        .collect();
    assert!(!blocks.is_empty());
    for block in blocks {
        let (RecordingSummary { mut header, ending, .. }, trace) = parse(&program(), block).unwrap();
        assert_eq!(header.vocabulary.take().is_some(), header.test.is_some(), "those of tests have it");
        header.vocabulary = header.test.as_ref().map(|_| "45b92b0b4a1c8e6d".to_owned());
        assert_eq!(record::write(&program(), &header, &trace, &ending), block);
    }
}

fn floats() -> impl Strategy<Value = f64> {
    use prop::num::f64::{INFINITE, NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO | INFINITE
}

fn values(ty: Type) -> BoxedStrategy<Value> {
    match ty {
        Type::Bool => any::<bool>().prop_map(Value::Bool).boxed(),
        Type::Int { lo, hi } => (lo..=hi).prop_map(Value::Int).boxed(),
        Type::Float(_) => floats().prop_map(Value::Float).boxed(),
        Type::Enum(e) => prop::sample::select(e.values()).prop_map(Value::Symbol).boxed(),
        Type::Text | Type::List(_) => unreachable!("no event and no signal has these"),
    }
}

fn whats() -> BoxedStrategy<TraceStepKind> {
    let program = program();
    let of_event = (0u16..).zip(&program.events).map(|(id, event)| {
        let args: Vec<BoxedStrategy<Value>> = event.params.iter().map(|p| values(p.ty)).collect();
        args.prop_map(move |args| TraceStepKind::Event { event: EventId(id), args }).boxed()
    });
    let of_signal = (0u16..).zip(&program.signals).map(|(id, signal)| {
        values(signal.ty).prop_map(move |value| TraceStepKind::Sample { signal: SignalId(id), value }).boxed()
    });
    let of_machine = machine_steps().prop_map(|step| TraceStepKind::Machine(Box::new(step))).boxed();
    prop::strategy::Union::new(of_event.chain(of_signal).chain([of_machine])).boxed()
}

fn machine_steps() -> impl Strategy<Value = MachineStep> {
    let texts = || prop::collection::vec(any::<String>(), 0..3);
    let edge = || any::<[String; 3]>().prop_map(|[from, outcome, to]| MachineEdge { from, outcome, to });
    let declared = (any::<String>(), texts(), prop::collection::vec(edge(), 0..3), texts()).prop_map(
        |(machine, states, transitions, outcomes)| {
            MachineStep::Declared(MachineDeclaration { machine, states, transitions, outcomes })
        },
    );
    let begun = any::<[String; 2]>().prop_map(|[machine, state]| MachineStep::Begun { machine, state });
    let moved = (any::<String>(), edge()).prop_map(|(machine, edge)| MachineStep::Moved { machine, edge });
    prop_oneof![declared, begun, moved]
}

fn traces() -> impl Strategy<Value = Trace> {
    let gap = prop_oneof![Just(0), 0i64..3, Just(50_000_000), 0i64..100_000_000_000_000_000];
    (prop::collection::vec((gap, whats()), 0..30), 0i64..2_000_000_000).prop_map(|(gaps, rest)| {
        let mut time = 0;
        let steps = gaps
            .into_iter()
            .map(|(gap, what)| {
                time += gap;
                TraceStep { time, what }
            })
            .collect();
        Trace { steps, end: time + rest }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read_back(
        trace in traces(),
        scenario in any::<String>(),
        test in any::<Option<String>>(),
        seed in any::<Option<u64>>(),
        kind in prop::sample::select(&RunEnd::ALL[..]),
        error in any::<String>(),
    ) {
        let header = RecordingHeader { scenario, vocabulary: test.clone(), test, seed };
        let ending = RecordingEnd { kind, error: (kind == RunEnd::Error).then_some(error) };
        let text = record::write(&program(), &header, &trace, &ending);
        prop_assert_eq!(text.lines().count(), trace.steps.len() + 2);
        let (found, read) = parse(&program(), &text).unwrap();
        // The text once more, since equality of floats overlooks the sign of zero.
        prop_assert_eq!(record::write(&program(), &found.header, &read, &found.ending), text);
        prop_assert_eq!((found.steps, found.end), (trace.steps.len(), trace.end));
        prop_assert_eq!((found.header, found.ending, read), (header, ending, trace));
    }

    #[test]
    fn times_are_read_back(time in any::<i64>()) {
        prop_assert_eq!(decimal::nanos(&decimal::seconds(time)), Some(time));
    }

    /// A time that has gone through a binary float is still the same, for runs of up to a month.
    #[test]
    fn times_survive_floats(time in 0i64..2_600_000_000_000_000) {
        let float = format!("{}", time as f64 / 1e9);
        prop_assert_eq!(decimal::nanos(&float), Some(time));
    }

    #[test]
    fn rubbish_is_refused_without_a_crash(text in "([ -~\n]|\\{\"t\":|\"event\":|[0-9e.-]){0,60}") {
        let _ = decimal::nanos(&text);
        let with_header = format!("{HEADER}\n{text}");
        prop_assert!(parse(&program(), &text).is_err());
        let _ = parse(&program(), &with_header);
    }
}
