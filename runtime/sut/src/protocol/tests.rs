//! Requests and replies, as they are written.

use hrdsl_ir::Symbol;

use super::*;

fn request(line: &str) -> ProgramRequest {
    match parse(line.as_bytes(), PROTOCOL_VERSION) {
        ProtocolLine::Request(request) => request,
        other => panic!("{line}: {other:?}"),
    }
}

#[test]
fn every_request_of_the_specification_is_understood() {
    assert_eq!(request(r#"{"request":"now"}"#), ProgramRequest::Now);
    let wait = |until, give_up| ProgramRequest::Wait { until, give_up };
    assert_eq!(request(r#"{"request":"wait"}"#), wait(None, None));
    assert_eq!(request(r#"{"request":"wait","until":7,"more":1}"#), wait(Some(7), None));
    assert_eq!(request(r#"{"until":null,"give_up":8,"request":"w\u0061it"}"#), wait(None, Some(8)));
    assert_eq!(request(r#"{"request":"sleep","seconds":2}"#), ProgramRequest::Sleep { seconds: 2.0 });
    assert_eq!(
        request(r#"{"request":"wait_for","events":["a","b"]}"#),
        ProgramRequest::WaitFor { events: vec!["a".into(), "b".into()], timeout: None }
    );
    assert_eq!(
        request(r#"{"request":"emit","event":"decided","args":{"ready":true,"n":3,"x":1.5}}"#),
        ProgramRequest::Emit {
            event: "decided".into(),
            args: BTreeMap::from([
                ("n".into(), ProtocolArgument::Scalar(Value::Int(3))),
                ("ready".into(), ProtocolArgument::Scalar(Value::Bool(true))),
                ("x".into(), ProtocolArgument::Scalar(Value::Float(1.5))),
            ])
        }
    );
    let ProgramRequest::Act { on, command, args, wait, call: None } =
        request(r#"{"request":"act","on":"robot.arm","do":"move_to","args":{"to":[0,1,2.5],"speed":0.2}}"#)
    else {
        panic!()
    };
    assert_eq!((on.as_str(), command.as_str(), wait), ("robot.arm", "move_to", true));
    assert_eq!(args["to"], ProtocolArgument::Numbers(vec![0.0, 1.0, 2.5]));
    assert_eq!(args["speed"], ProtocolArgument::Scalar(Value::Float(0.2)));
}

#[test]
fn what_is_told_without_a_reply_is_understood() {
    let edges = r#"[["A","go","B"]]"#;
    let line = format!(
        r#"{{"request":"machine","name":"M","states":["A","B"],"transitions":{edges},"outcomes":[]}}"#
    );
    let machine = ProgramRequest::Machine {
        name: "M".into(),
        states: vec!["A".into(), "B".into()],
        transitions: vec![("A".into(), "go".into(), "B".into())],
        outcomes: Vec::new(),
    };
    let begun =
        ProgramRequest::Transition { machine: "M".into(), label: None, outcome: None, next: "A".into() };
    let waits = ProgramRequest::Await {
        kind: WrittenPortKind::Client,
        name: "/plan".into(),
        type_name: None,
        give_up: Some(5),
    };
    for (line, expected) in [
        (line.as_str(), machine),
        (r#"{"request":"transition","machine":"M","next":"A"}"#, begun),
        (r#"{"request":"await","kind":"client","name":"/plan","give_up":5}"#, waits),
        (
            r#"{"request":"failed","node":"/brain","text":"no"}"#,
            ProgramRequest::Failed { text: "no".into(), node: "/brain".into() },
        ),
        (
            r#"{"request":"failed","text":"no"}"#,
            ProgramRequest::Failed { text: "no".into(), node: String::new() },
        ),
        (
            r#"{"request":"log","level":"warn","node":"/brain","text":"low"}"#,
            ProgramRequest::Log { level: WrittenLogLevel::Warn, node: "/brain".into(), text: "low".into() },
        ),
    ] {
        let found = request(line);
        assert!(found.is_one_way(), "{line}");
        assert_eq!(found, expected);
    }
    for wrong in [r#"{"request":"machine","name":"M"}"#, r#"{"request":"log","level":"loud","text":"a"}"#] {
        assert!(matches!(parse(wrong.as_bytes(), 2), ProtocolLine::Refused { waits: false, .. }), "{wrong}");
    }
}

#[test]
fn a_port_is_opened_with_a_reply_or_without() {
    let line = |more: &str| {
        format!(
            r#"{{"request":"open","port":1,"kind":"subscriber","name":"/a","type":"std_msgs/Int8"{more}}}"#
        )
    };
    assert!(!request(&line("")).is_one_way());
    assert!(!request(&line(r#","reply":true"#)).is_one_way());
    assert!(request(&line(r#","reply":false"#)).is_one_way());
    let waits = |line: &str, version| match parse(line.as_bytes(), version) {
        ProtocolLine::Refused { waits, .. } => waits,
        other => panic!("{line}: {other:?}"),
    };
    let nameless = r#"{"request":"open","port":1,"kind":"subscriber","name":"","type":"a/B","reply":false}"#;
    let without_kind = r#"{"request":"open","port":1,"name":"/a","type":"a/B","reply":false}"#;
    for wrong in [nameless, without_kind] {
        assert!(!waits(wrong, 2), "{wrong}");
        assert!(waits(&wrong.replace("false", "true"), 2), "{wrong}");
        assert!(waits(wrong, 1), "in version 1 all requests have replies: {wrong}");
    }
}

#[test]
fn parameters_are_asked_for_and_their_values_stay_text() {
    let get = request(r#"{"request":"get_parameter","name":"/a"}"#);
    let set = request(r#"{"request":"set_parameter","name":"/a","value": {"b": 1.50} }"#);
    let delete = request(r#"{"request":"delete_parameter","name":"/a"}"#);
    assert_eq!(get, ProgramRequest::GetParameter { name: "/a".into() });
    let (name, value) = ("/a".into(), r#"{"b": 1.50}"#.into());
    assert_eq!(set, ProgramRequest::Message(MessageRequest::SetParameter { name, value }));
    assert_eq!(delete, ProgramRequest::DeleteParameter { name: "/a".into() });
    assert!([get, set, delete].iter().all(|request| !request.is_one_way()));
    let wrong = parse(br#"{"request":"set_parameter","name":"/a"}"#, 2);
    assert!(matches!(wrong, ProtocolLine::Refused { waits: true, .. }), "{wrong:?}");
    let reply = HarnessReply { time: 5, answer: ReplyAnswer::Json("[1.50]".into()) };
    let line = ReplyLine { reply: &reply, refused: &[] };
    assert_eq!(serde_json::to_string(&line).unwrap(), r#"{"t":5,"value":[1.50]}"#);
}

#[test]
fn symbols_go_there_and_back_as_text() {
    let ProgramRequest::Emit { args, .. } =
        request(r#"{"request":"emit","event":"paced","args":{"pace":"fast","odd":"\u00e4 \"b\""}}"#)
    else {
        panic!()
    };
    assert_eq!(args["pace"], ProtocolArgument::Text("fast".into()));
    assert_eq!(args["odd"], ProtocolArgument::Text("ä \"b\"".into()));
    let symbol = Value::Symbol(Symbol::intern("fast"));
    let wire = |answer| {
        let reply = HarnessReply { time: 5, answer };
        serde_json::to_string(&ReplyLine { reply: &reply, refused: &[] }).unwrap()
    };
    assert_eq!(wire(ReplyAnswer::Value(symbol)), r#"{"t":5,"value":"fast"}"#);
    let event =
        ReplyAnswer::Event { name: "paced".into(), args: BTreeMap::from([("pace".into(), symbol)]), time: 4 };
    assert_eq!(wire(event), r#"{"t":5,"event":{"name":"paced","args":{"pace":"fast"},"time":4}}"#);
    // What is written as a value is read as the argument of the same name.
    let text = serde_json::to_string(&symbol).unwrap();
    assert_eq!(
        serde_json::from_str::<ProtocolArgument>(&text).unwrap(),
        ProtocolArgument::Text("fast".into())
    );
}

#[test]
fn arguments_are_shown_as_they_were_written() {
    let shown = |arg: ProtocolArgument| arg.to_string();
    assert_eq!(shown(ProtocolArgument::Text("fast".into())), "\"fast\"");
    assert_eq!(shown(ProtocolArgument::Scalar(Value::Int(3))), "3");
    assert_eq!(shown(ProtocolArgument::Numbers(vec![1.0, 2.5])), "[1.0, 2.5]");
}

#[test]
fn what_is_no_request_is_refused_or_rubbish() {
    for (line, refused) in [
        (r#"{"request":"fly"}"#, true),
        (r#"{"request":"sleep"}"#, true),
        (r#"{"request":"sleep","seconds":-1}"#, true),
        (r#"{"request":"sleep","seconds":"long"}"#, true),
        (r#"{"request":"hello","version":3,"name":"x"}"#, true),
        (r#"{"request":"wait"}"#, true),
        (r#"{"request":"publish","port":1,"message":2}"#, true),
        (r#"{"request":"wait_for","events":[]}"#, true),
        (r#"{"request":"wait_for","events":["a"],"timeout":-0.1}"#, true),
        (r#"{"request":"act","on":"a","do":"b","wait":false}"#, true),
        (r#"{"request":1}"#, false),
        ("{}", false),
        ("[]", false),
        (r#"["now"]"#, false),
        ("", false),
        ("Hello, world", false),
        ("\u{fffd}{", false),
    ] {
        match parse(line.as_bytes(), 1) {
            ProtocolLine::Refused { why, waits } => assert!(refused && waits, "{line}: {why}"),
            ProtocolLine::Rubbish(why) => assert!(!refused, "{line}: {why}"),
            ProtocolLine::Request(request) => panic!("{line}: {request:?}"),
        }
    }
}

#[test]
fn replies_are_written_as_specified() {
    let wire = |answer| {
        let reply = HarnessReply { time: 5, answer };
        serde_json::to_string(&ReplyLine { reply: &reply, refused: &[] }).unwrap()
    };
    assert_eq!(wire(ReplyAnswer::Ok), r#"{"t":5}"#);
    assert_eq!(wire(ReplyAnswer::TimedOut), r#"{"t":5,"event":null}"#);
    assert_eq!(wire(ReplyAnswer::Value(Value::Bool(true))), r#"{"t":5,"value":true}"#);
    let numbers = ReplyAnswer::Numbers(vec![0.5, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]);
    assert_eq!(wire(numbers), r#"{"t":5,"value":[0.5,"inf","-inf","nan"]}"#);
    assert_eq!(wire(ReplyAnswer::Acted(Ok(()))), r#"{"t":5,"ok":true}"#);
    assert_eq!(wire(ReplyAnswer::Acted(Err("far".into()))), r#"{"t":5,"ok":false,"error":"far"}"#);
    assert_eq!(
        wire(ReplyAnswer::Stop { reason: "it is late".into() }),
        r#"{"t":5,"stop":true,"reason":"it is late"}"#
    );
    assert_eq!(
        wire(ReplyAnswer::Error { error: "no".into(), help: Some("yes".into()) }),
        r#"{"t":5,"error":"no","help":"yes"}"#
    );
    assert_eq!(
        wire(ReplyAnswer::Event {
            name: "go".into(),
            args: BTreeMap::from([("far".into(), Value::Float(2.0))]),
            time: 4
        }),
        r#"{"t":5,"event":{"name":"go","args":{"far":2.0},"time":4}}"#
    );
}
