//! What the viewer is told of requirements: found in their expressions, whatever the signals are called.
#![allow(clippy::disallowed_methods, reason = "tests write files and start the binary")]

mod support;

use std::{fs, path::Path};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_runtime::{
    recording,
    viewer::{
        ViewDocument,
        document::{SignalKind, SignalTrack, ViewEnd},
        replay::{WrittenUnits, replay},
        requirement::{
            LimitRelation, MeasureAxis, MeasureKind, ObligationOutcome, ViewCondition, ViewMeasure,
            ViewRequirement, ViewVerdict,
        },
    },
};
use support::{expect_code, hrdsl_in};

/// Something is set to where a box stands, which is thrown over.
const SHOVE: &str = r#"scenario shove

actor cat   : environment
actor cell  : environment
actor robot : system

event tipped, gone, lost from cell to robot
event begun        from robot

world {
  body floor: fixed box(8 m, 8 m, 10 cm) at (0 m, 0 m, -5 cm)
  body box: dynamic box(20 cm, 20 cm, 60 cm) at (0 m, 0 m, 30 cm) mass 10 kg
  body cat: kinematic box(20 cm, 20 cm, 20 cm) at (-60 cm, 0 m, 45 cm)
  body mark: fixed sphere(2 cm) at (1 m, 0 m, 0 m) ghost

  signal here : length to robot = box.x
  signal there: length to robot = box.y
  signal a    : length to robot = delta(here, 1 s)
  signal b    : length to robot = delta(there, 1 s)
  signal along: length to robot = delta(here, 500 ms)
  on rising(tilt(box) > 30 deg) emit tipped
  on rising(tilt(box) > 60 deg && here > 5 cm) emit gone
  on rising(abs(here - 1 cm) > 2 cm && norm((a, b)) < 1 cm, 1 s) emit lost
}

require Way     safety     "it stays"      globally norm((a, b)) < 3 cm
require Along   safety     "along x"       globally abs(along) < 20 cm
require Fall    safety     "it stands"     never tipped
require Gone    safety     "it is there"   never gone
require Tilt    safety     "upright"       globally tilt(box) < 20 deg
require Lowest  safety     "not too low"   globally box.z > 25 cm
require Near    safety     "far from it"   globally min(range(box, mark), distance(box, mark)) > 50 cm
require Sum     safety     "any number"    globally here + there < 2 m
require Lost    safety     "not for long"  never lost
require Tidy    safety     "at its place"  never begun while max(abs(box.x - 1 m), abs(box.z - 30 cm)) > 40 cm
require Settles functional "it lies down"  begun causes rising(abs(along) < 1 mm) within 20 s
require Calm    safety     "slow, or up"   formula always (abs(along) < 30 mm or historically[0 s, 100 ms] tilt(box) < 0.1 rad)
require Asked   functional "formula, time" formula always (begun implies eventually[0 s, 9 s] tipped)
require Begun   functional "it begins"     begun causes gone within 10 s

suite once by random { stimuli shove; length 1..1; tests 1 }
stimulus shove by cat { hold 500 ms; cat.move_to((-12 cm, 0 m, 45 cm), 0 s); hold 3 s }

system robot {
  run "python3 idle.py"
  limit 10 s
}
"#;

const IDLE: &str = "import hrdsl\nnode = hrdsl.Node(\"idle\")\nnode.emit(\"begun\")\nnode.sleep(6.0)\n";

fn recorded(folder: &Path) -> (ViewDocument, recording::RecordingFile) {
    fs::write(folder.join("shove.hri"), SHOVE).unwrap();
    fs::write(folder.join("idle.py"), IDLE).unwrap();
    expect_code(&hrdsl_in(folder, "sim shove.hri --replays all --exit-zero -o out"), 0);
    let file = recording::read(&fs::read(folder.join("out/replays/shove.once.t001.mcap")).unwrap()).unwrap();
    let program = compile(InputFile { name: "shove.hri", text: SHOVE }, &[]).program.expect("it compiles");
    let units = WrittenUnits::of([SHOVE]);
    (replay(&program, &file, &units).unwrap(), file)
}

fn requirement<'d>(document: &'d ViewDocument, id: &str) -> &'d ViewRequirement {
    document.requirements.iter().find(|requirement| requirement.id == id).unwrap()
}

fn only<'d>(document: &'d ViewDocument, id: &str) -> &'d ViewMeasure {
    let [measure] = &requirement(document, id).measures[..] else {
        panic!("{id}: {:?}", requirement(document, id).measures)
    };
    measure
}

/// The times and values of a signal.
fn values(document: &ViewDocument, name: &str) -> Vec<(i64, f64)> {
    let of: &SignalTrack = document.signals.iter().find(|signal| signal.name == name).expect(name);
    let (mut time, mut value) = (0, 0);
    let step = |(t, v): (&i64, &Option<i64>)| {
        time += t;
        value += v.unwrap_or(0);
        (time, value as f64 * of.scale.unwrap_or(1.0))
    };
    of.t.iter().zip(&of.v).map(step).collect()
}

#[test]
fn what_a_requirement_judges_is_found_in_its_expression() {
    let folder = tempfile::tempdir().unwrap();
    let (document, file) = recorded(folder.path());
    let body = |name: &str| document.scene.bodies.iter().position(|body| body.name == name).unwrap();
    let way = only(&document, "Way");
    assert_eq!((way.kind, &way.bodies[..], way.within), (MeasureKind::Way, &[body("box")][..], Some(1.0)));
    assert_eq!(way.axes, [MeasureAxis::X, MeasureAxis::Y]);
    assert_eq!((way.name.as_str(), way.relation, way.limit), ("norm((a, b))", LimitRelation::Below, 0.03));
    assert_eq!(requirement(&document, "Way").signals, ["a", "b"]);
    let along = only(&document, "Along");
    assert_eq!(
        (along.kind, along.within, &along.axes[..]),
        (MeasureKind::Way, Some(0.5), &[MeasureAxis::X][..])
    );
    let fall = only(&document, "Fall");
    assert_eq!(
        (fall.kind, fall.tells.as_deref(), fall.unit.as_deref()),
        (MeasureKind::Tilt, Some("tipped"), Some("rad"))
    );
    assert!((fall.limit - 30_f64.to_radians()).abs() < 1e-9 && fall.relation == LimitRelation::AtMost);
    assert_eq!(requirement(&document, "Fall").events, ["tipped"]);
    several_comparisons_are_told_of_one_by_one(&document, body("box"));
    what_became_of_formulas_is_told(&document);
    assert_eq!(only(&document, "Tilt").kind, MeasureKind::Tilt);
    assert_eq!(
        (only(&document, "Lowest").kind, only(&document, "Lowest").limit),
        (MeasureKind::Height, 0.25)
    );
    let near: Vec<MeasureKind> = requirement(&document, "Near").measures.iter().map(|m| m.kind).collect();
    assert!(near.contains(&MeasureKind::Range) && near.contains(&MeasureKind::Distance), "{near:?}");
    let sum = only(&document, "Sum");
    assert_eq!(
        (sum.kind, sum.name.as_str(), &sum.bodies[..]),
        (MeasureKind::Signal, "here + there", &[body("box")][..])
    );
    let begun = requirement(&document, "Begun");
    assert_eq!(
        (&begun.events[..], begun.signals.len(), begun.measures.len()),
        (&["begun".to_owned(), "gone".to_owned()][..], 0, 0)
    );
    the_values_are_those_of_the_signals(&document);
    a_blow_of_one_step_is_recorded(&file, body("box"), body("cat"));
    what_is_cut_is_shown_as_far_as_it_goes(folder.path(), &document);
    a_requirement_of_today_asks_an_older_recording(&file);
}

fn the_values_are_those_of_the_signals(document: &ViewDocument) {
    let (a, b) = (values(document, "a"), values(document, "b"));
    let at =
        |of: &[(i64, f64)], time: i64| of.iter().rev().find(|(t, _)| *t <= time).map_or(0.0, |(_, v)| *v);
    let way = values(document, "norm((a, b))");
    assert!(way.len() > 10, "it was thrown over");
    for (time, value) in &way {
        assert!((value - at(&a, *time).hypot(at(&b, *time))).abs() < 3e-4, "{time}: {value}");
    }
    let violated = &requirement(document, "Way").violations;
    let first = i64::try_from(violated[0].t).unwrap();
    assert!(at(&way, first) >= 0.03 && at(&way, first - 1) < 0.03, "the limit is crossed at the violation");
}

/// What is set to where something stands strikes it in one step, which the recording has, and for no longer.
fn a_blow_of_one_step_is_recorded(file: &recording::RecordingFile, one: usize, other: usize) {
    let contact = file.picture.contacts.iter().find(|contact| {
        let bodies = contact.bodies.map(|body| usize::from(body.0));
        bodies.contains(&one) && bodies.contains(&other)
    });
    let frames = &contact.expect("the blow").frames;
    let force = |force: [i64; 3]| force.iter().map(|x| *x as f64 / 100.0).map(|x| x * x).sum::<f64>().sqrt();
    let hardest = frames.iter().map(|frame| force(frame.force)).fold(0.0, f64::max);
    assert!(hardest > 500.0, "{frames:?}");
    assert!(
        frames.windows(2).any(|pair| pair[1].force == [0; 3] && pair[1].time - pair[0].time <= 20_000_000)
    );
}

fn any(of: impl IntoIterator<Item = usize>) -> ViewCondition {
    ViewCondition::Any { of: of.into_iter().map(|measure| ViewCondition::Measure { measure }).collect() }
}

/// Of several comparisons each is a measure with its own limit, in the unit in which it is written, and the condition says how they make it up.
fn several_comparisons_are_told_of_one_by_one(document: &ViewDocument, tossed: usize) {
    let found = |id: &str| -> Vec<(MeasureKind, LimitRelation, String)> {
        let of = &requirement(document, id).measures;
        let shown = |measure: &ViewMeasure| {
            let unit = measure.shown.as_ref().expect("the scenario writes it with a unit");
            format!("{:.3} {}", measure.limit / unit.size, unit.symbol)
        };
        of.iter().map(|measure| (measure.kind, measure.relation, shown(measure))).collect()
    };
    let is = |kind, relation, limit: &str| (kind, relation, limit.to_owned());
    let (most, least) = (LimitRelation::AtMost, LimitRelation::AtLeast);
    assert_eq!(
        found("Gone"),
        [is(MeasureKind::Tilt, most, "60.000 deg"), is(MeasureKind::Coordinate, most, "5.000 cm")]
    );
    let told = |event: &str, held, of| ViewCondition::Told { event: event.to_owned(), held, of: vec![of] };
    assert_eq!(requirement(document, "Gone").condition, Some(told("gone", None, any([0, 1]))));
    assert_eq!(
        found("Lost"),
        [is(MeasureKind::Way, least, "1.000 cm"), is(MeasureKind::Offset, most, "2.000 cm")]
    );
    assert_eq!(requirement(document, "Lost").condition, Some(told("lost", Some(1.0), any([1, 0]))));
    let tidy = requirement(document, "Tidy");
    let places = tidy.measures.iter().map(|m| (&m.bodies[..], &m.axes[..], &m.place[..]));
    let (x, z) = ([MeasureAxis::X], [MeasureAxis::Z]);
    assert_eq!(
        places.collect::<Vec<_>>(),
        [(&[tossed][..], &x[..], &[1.0][..]), (&[tossed][..], &z[..], &[0.3][..])]
    );
    assert_eq!((&tidy.at[..], requirement(document, "Way").at.len()), (&["begun".to_owned()][..], 0));
    assert!(matches!(&tidy.condition, Some(ViewCondition::All { of }) if of.len() == 2));
    let settles = requirement(document, "Settles");
    assert!(settles.meets && !tidy.meets);
    assert_eq!(found("Settles"), [is(MeasureKind::Way, LimitRelation::Below, "1.000 mm")]);
}

/// A formula has spans in which it is violated, obligations, and truths of what it asks of other moments.
fn what_became_of_formulas_is_told(document: &ViewDocument) {
    let calm = requirement(document, "Calm");
    let [violation] = &calm.violations[..] else { panic!("{:?}", calm.violations) };
    let upright = "historically[0 s, 100 ms] tilt(box) < 0.1 rad";
    let upright = document.signals.iter().find(|signal| signal.name == upright).expect("its truth");
    assert_eq!(upright.kind, SignalKind::Bool);
    let along = values(document, "abs(along)");
    let fast = |time: u64| {
        let time = i64::try_from(time).unwrap();
        along.iter().rev().find(|(t, _)| *t <= time).unwrap().1 >= 0.03
    };
    let until = violation.until.expect("it ends");
    assert!(fast(violation.t) && fast(until - 1) && !fast(until), "{violation:?}");
    assert!(violation.text.starts_with("It does not hold from 7.7"), "{}", violation.text);
    let Some(ViewCondition::Any { of }) = &calm.condition else { panic!("{:?}", calm.condition) };
    assert!(matches!(&of[1], ViewCondition::Window { signal: Some(name), .. } if *name == upright.name));
    let asked = requirement(document, "Asked");
    let [obligation] = &asked.obligations[..] else { panic!("{:?}", asked.obligations) };
    let tipped = document.events.iter().find(|event| event.name == "tipped").unwrap();
    assert_eq!(
        (obligation.outcome, obligation.until, obligation.deadline, obligation.trigger.as_deref()),
        (ObligationOutcome::Met, Some(tipped.t), Some(9_000), Some("begun"))
    );
    assert_eq!(
        (&asked.triggers[..], &asked.events[..]),
        (&[0][..], &["begun", "tipped"].map(str::to_owned)[..])
    );
}

/// Wherever a recording is cut, of either form, what is there is shown, nothing is said to be kept, and what is missing is named.
fn what_is_cut_is_shown_as_far_as_it_goes(folder: &Path, whole: &ViewDocument) {
    let packed = fs::read(folder.join("out/replays/shove.once.t001.mcap")).unwrap();
    let text = fs::read_to_string(folder.join("out/traces/shove.once.t001.jsonl")).unwrap();
    let program = compile(InputFile { name: "shove.hri", text: SHOVE }, &[]).program.unwrap();
    let open = |part: usize, is_text: bool| {
        let file = if is_text {
            let text = text[..text.len() * part / 40].to_owned();
            recording::RecordingFile { text, ..recording::RecordingFile::default() }
        } else {
            recording::read(&packed[..packed.len() * part / 40]).map_err(|error| error.to_string())?
        };
        replay(&program, &file, &WrittenUnits::of([SHOVE]))
    };
    let (mut shown, mut broken) = (0, 0);
    for (part, is_text) in (1..40).flat_map(|part| [(part, false), (part, true)]) {
        let document = match open(part, is_text) {
            Ok(document) => document,
            Err(why) => {
                assert!(!why.is_empty());
                continue;
            }
        };
        shown += 1;
        // Behind the last of the data there is a list of them only.
        if document.notes.is_empty() {
            assert!(document == *whole, "{part}: nothing is said to be missing");
            continue;
        }
        let is_advised =
            document.notes.iter().any(|note| note.contains("`hrdsl sim --replays all` records one"));
        assert_eq!(is_advised, is_text, "{part}: a picture that is cut off was recorded");
        assert!(document.end <= whole.end && document.events.len() <= whole.events.len());
        // What is cut behind the last step lacks a part of the picture only, and is judged as it was.
        if document.ended != ViewEnd::Error {
            assert_eq!(document.end, whole.end, "{part}");
            continue;
        }
        broken += 1;
        for requirement in &document.requirements {
            let told = (&requirement.id, requirement.verdict);
            let is_judged = matches!(requirement.verdict, ViewVerdict::Pass | ViewVerdict::Vacuous);
            assert!(!is_judged, "{part}: {told:?}");
            let is_known = requirement.violations.iter().all(|violation| violation.t <= document.end);
            assert!(is_known, "{part}: {told:?}");
        }
    }
    assert!(broken > 10 && broken < shown, "{shown} of 78 could be shown, {broken} of them in part");
}

/// Of bodies and signals that a recording does not have nothing is drawn, and the rest is as it was.
fn a_requirement_of_today_asks_an_older_recording(file: &recording::RecordingFile) {
    let text = SHOVE
        .replace("  body mark:", "  body later: fixed sphere(2 cm) at (2 m, 0 m, 0 m) ghost\n  body mark:");
    let text =
        text.replace("min(range(box, mark), distance(box, mark)) > 50 cm", "range(box, later) > 50 cm");
    let program = compile(InputFile { name: "shove.hri", text: &text }, &[]).program.expect("it compiles");
    let document = replay(&program, file, &WrittenUnits::default()).unwrap();
    assert!(document.notes.iter().any(|note| note.contains("changed since")), "{:?}", document.notes);
    let near = only(&document, "Near");
    assert!(near.bodies.len() < 2, "there was no such body: {near:?}");
    assert!(document.signals.iter().all(|signal| signal.name != near.name));
    assert_eq!(only(&document, "Tilt").bodies.len(), 1);
}
