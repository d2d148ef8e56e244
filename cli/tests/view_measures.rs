//! What the viewer is told of requirements: found in their expressions, whatever the signals are called.
#![allow(clippy::disallowed_methods, reason = "tests write files and start the binary")]

mod support;

use std::{fs, path::Path};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_runtime::{
    recording,
    viewer::{
        ViewDocument,
        document::SignalTrack,
        replay::replay,
        requirement::{LimitRelation, MeasureAxis, MeasureKind, ViewMeasure, ViewRequirement},
    },
};
use support::{expect_code, hrdsl_in};

/// Something is set to where a box stands, which is thrown over.
const SHOVE: &str = r#"scenario shove

actor cat   : environment
actor cell  : environment
actor robot : system

event tipped, gone from cell to robot
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
}

require Way     safety     "it stays"      globally norm((a, b)) < 3 cm
require Along   safety     "along x"       globally abs(along) < 20 cm
require Fall    safety     "it stands"     never tipped
require Gone    safety     "it is there"   never gone
require Tilt    safety     "upright"       globally tilt(box) < 20 deg
require Lowest  safety     "not too low"   globally box.z > 25 cm
require Near    safety     "far from it"   globally min(range(box, mark), distance(box, mark)) > 50 cm
require Sum     safety     "any number"    globally here + there < 2 m
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
    (replay(&program, &file).unwrap(), file)
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
    assert_eq!((way.name.as_str(), way.relation, way.limit), ("norm((a, b))", LimitRelation::AtMost, 0.03));
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
    assert_eq!(requirement(&document, "Gone").measures, [], "either part of its condition would keep it");
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
