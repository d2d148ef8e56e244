//! Files of runs: what is written reads back, each message keeps to its schema, and the published schemas are those of the types.
#![allow(clippy::disallowed_methods, reason = "tests read the schema")]

use std::path::{Path, PathBuf};

use hrdsl_ir::{
    Program,
    shape::BodyShape,
    world::{Body, BodyId, BodyMotion, JointId},
};
use hrdsl_recording::{
    RecordingError, RecordingFile, RecordingForm, RunOnFile, export, is_export,
    message::{
        LineColumns, LinesFile, LinesMessage, RecordedLogLevel, RecordedLogLine, RecordedTopic, TopicPart,
        VerdictMessage,
    },
    read,
    scene::{RecordedBody, RecordedBodyKind, RecordedJoint, RecordedScene, RecordedShape},
    schema, write, write_as,
};
use hrdsl_trace::{
    Trace,
    picture::{
        BodyKeyframe, BodyKeyframes, ContactKeyframe, ContactKeyframes, JointKeyframe, JointKeyframes,
        WorldPicture,
    },
    record::{RecordingEnd, RecordingHeader},
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

#[test]
fn the_published_schemas_are_those_of_the_types() {
    let now = schema::published().unwrap();
    let path = root().join("spec/recording.schema.json");
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        std::fs::write(&path, &now).unwrap();
    }
    assert_eq!(now, std::fs::read_to_string(path).unwrap(), "update with HRDSL_UPDATE=1");
}

const AT_REST: [f64; 7] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

fn scene() -> RecordedScene {
    let body = |name: &str, kind, carrier| RecordedBody {
        name: name.to_owned(),
        kind,
        pose: [1.0, 0.5, 0.25, 0.0, 0.0, 0.6, 0.8],
        shapes: vec![
            RecordedShape::Box { size: [0.1, 0.2, 0.3], pose: AT_REST },
            RecordedShape::Capsule { radius: 0.05, length: 0.4, pose: AT_REST },
        ],
        carrier,
        ghost: false,
    };
    let bodies = vec![
        body("robot.base", RecordedBodyKind::Robot, None),
        body("robot.plate", RecordedBodyKind::Robot, Some(0)),
        body("cup", RecordedBodyKind::Thing, None),
    ];
    let limits = Some([-1.0, 1.0]);
    let joint = RecordedJoint { name: "robot.lift".to_owned(), unit: "m".to_owned(), limits, start: 0.0 };
    RecordedScene { bodies, joints: vec![joint], lasers: Vec::new() }
}

fn picture() -> WorldPicture {
    let frame = |time: i64| BodyKeyframe {
        time: time * 20_000_000,
        // Not so even that packing leaves nothing of it.
        place: [time * time % 1009 * 31 % 997, -time, time * 7919 % 10_007 * time % 89],
        turn: [0, 0, time % 100, 10_000],
    };
    let force = |time, force| ContactKeyframe { time, point: [1, -2, 3], force };
    WorldPicture {
        bodies: vec![
            BodyKeyframes { body: BodyId(0), frames: (0..20_000).map(frame).collect() },
            BodyKeyframes { body: BodyId(2), frames: vec![frame(3)] },
        ],
        joints: vec![JointKeyframes {
            joint: JointId(0),
            frames: vec![
                JointKeyframe { time: 5, position: 0 },
                JointKeyframe { time: 9_000, position: -1_234 },
            ],
        }],
        contacts: vec![ContactKeyframes {
            bodies: [BodyId(0), BodyId(2)],
            frames: vec![force(7, [1_250, 0, -1]), force(900, [0; 3])],
        }],
    }
}

fn topics() -> Vec<RecordedTopic> {
    let topic = |name: &str, outward, times: &[i64], texts: &[Option<&str>]| RecordedTopic {
        name: name.to_owned(),
        interface: "std_msgs/String".to_owned(),
        outward,
        part: if outward { TopicPart::Answer } else { TopicPart::Message },
        times: times.to_vec(),
        texts: texts.iter().map(|text| text.map(str::to_owned)).collect(),
    };
    vec![
        topic("/heard", false, &[5, 70, 1_000_000_000], &[Some("{\"data\":\"a\"}"), None]),
        topic("/said", true, &[], &[]),
    ]
}

fn lines() -> Vec<LinesMessage> {
    let files = vec![
        LinesFile { name: "robot.py".to_owned(), crc: Some(u32::MAX) },
        LinesFile { name: "fsm.py".to_owned(), crc: None },
    ];
    let main = LineColumns {
        thread: "MainThread".to_owned(),
        t: vec![0, 1_500_000_000, 0],
        file: vec![0, 1, -1],
        line: vec![12, -12, 40],
    };
    vec![LinesMessage { program: "robot".to_owned(), files, threads: vec![main], until: Some(7), unseen: 2 }]
}

fn file() -> (String, Vec<u8>) {
    let program = Program { name: "cup".to_owned(), ..Program::default() };
    let trace = Trace { end: 400_000_000_000, ..Trace::default() };
    let header = RecordingHeader { test: Some("cup.a.t001".to_owned()), ..RecordingHeader::of(&program) };
    let text = hrdsl_trace::record::write(&program, &header, &trace, &RecordingEnd::default());
    let log = [RecordedLogLine {
        time: 1_500_000_000,
        level: RecordedLogLevel::Warning,
        program: "/brain".to_owned(),
        text: "low \"battery\"".to_owned(),
    }];
    let verdicts = [VerdictMessage {
        requirement: "R1".to_owned(),
        verdict: "fail".to_owned(),
        failures: 1,
        violated: Some(2.5),
        margin: None,
        unit: None,
    }];
    let run = RunOnFile {
        trace: &trace,
        text: &text,
        scene: &scene(),
        picture: &picture(),
        log: &log,
        topics: &topics(),
        lines: &lines(),
        verdicts: &verdicts,
    };
    let bytes = write(&run).unwrap();
    assert_eq!(bytes, write(&run).unwrap(), "the same run gives the same bytes");
    let messages = write_as(&run, RecordingForm::Messages).unwrap();
    assert!(bytes.len() * 3 < messages.len() * 2, "columns take less: {} of {}", bytes.len(), messages.len());
    let (ours, theirs) = (read(&bytes).unwrap(), read(&messages).unwrap());
    assert_eq!(ours, theirs, "both forms read back to the same");
    assert_eq!(export(&program, &ours).unwrap(), messages, "byte for byte");
    assert!(is_export(&messages) && !is_export(&bytes) && !is_export(b"{}"));
    (text, bytes)
}

#[test]
fn what_is_written_reads_back() {
    let (text, bytes) = file();
    let found = read(&bytes).unwrap();
    assert_eq!(found.faults, Vec::<String>::new());
    assert_eq!(found.text, text, "the judged lines, byte for byte");
    assert_eq!(found.scene, Some(scene()));
    assert_eq!(found.picture, picture());
    assert_eq!(found.topics, topics());
    assert_eq!(found.lines, lines());
    let log: Vec<(i64, RecordedLogLevel, &str)> =
        found.log.iter().map(|entry| (entry.time, entry.level, entry.text.as_str())).collect();
    assert_eq!(log, [(1_500_000_000, RecordedLogLevel::Warning, "low \"battery\"")]);
}

#[test]
fn what_is_not_whole_is_not_exported() {
    let (_, bytes) = file();
    let program = Program { name: "cup".to_owned(), ..Program::default() };
    let cut = read(&bytes[..bytes.len() * 2 / 3]).unwrap();
    assert!(export(&program, &cut).unwrap_err().contains("only whole recordings"));
    let bare = RecordingFile { scene: None, ..read(&bytes).unwrap() };
    assert!(export(&program, &bare).unwrap_err().contains("no picture"));
}

#[test]
fn of_a_cut_file_the_rest_is_read_and_what_is_none_of_ours_is_refused() {
    let (_, bytes) = file();
    let found = read(&bytes[..bytes.len() * 2 / 3]).unwrap();
    let frames = |picture: &WorldPicture| picture.bodies[0].frames.len();
    let shown = frames(&found.picture);
    assert!(shown > 1_000 && shown < 20_000 && shown % 3_000 == 0, "whole minutes: {shown}");
    assert!(found.faults.iter().any(|fault| fault.contains("cut off")), "{:?}", found.faults);
    assert!(matches!(read(b"{\"hrdsl\":\"trace\"}"), Err(RecordingError::NotMcap)));
    assert!(matches!(read(&bytes[..20]), Err(RecordingError::NotOurs(_))));
}

#[test]
fn a_world_becomes_a_scene() {
    let mut world = hrdsl_ir::world::World {
        step: 5_000_000,
        sample: 50_000_000,
        gravity: [0.0, 0.0, -9.81],
        bodies: Vec::new(),
        joints: Vec::new(),
        arms: Vec::new(),
        grippers: Vec::new(),
        bases: Vec::new(),
        lasers: Vec::new(),
        figures: Vec::new(),
        devices: Vec::new(),
        device_kinds: Vec::new(),
        currents: Vec::new(),
        sensors: Vec::new(),
        rules: Vec::new(),
        origin: hrdsl_ir::Span::default(),
    };
    let body = |name: &str, motion, size| Body {
        name: name.to_owned(),
        motion,
        shape: BodyShape::Box { size },
        position: [0.1, 0.2, 0.3],
        rotation: [0.0, 0.0, std::f64::consts::PI],
        mass: 1.0,
        stiffness: None,
        ghost: false,
        solid: None,
    };
    world.bodies.push(body("floor", BodyMotion::Fixed, [6.0, 6.0, 0.1]));
    world.bodies.push(body("cup", BodyMotion::Dynamic, [0.1; 3]));
    world.bodies.push(body("person.hand", BodyMotion::Guided, [0.1; 3]));
    let scene = hrdsl_recording::scene::scene(&world);
    let kinds: Vec<RecordedBodyKind> = scene.bodies.iter().map(|body| body.kind).collect();
    assert_eq!(kinds, [RecordedBodyKind::Room, RecordedBodyKind::Thing, RecordedBodyKind::Person]);
    assert_eq!(scene.bodies[1].pose, [0.1, 0.2, 0.3, 0.0, 0.0, 1.0, 0.0]);
}
