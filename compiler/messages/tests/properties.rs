//! What holds of every definition: written and read it is the same; and whatever is read, nothing panics.

use hrdsl_messages::{
    DefinitionText, ElementCount, FieldElement, InterfaceDefinition, InterfaceName, InterfaceSpace,
    MessageDefinition, MessageField, MessageFieldType, MessageLibraryBuilder, MessageValue, PrimitiveType,
    RosVersion, parse_definition,
};
use hrdsl_source::{FileId, SourceFiles, Span};
use proptest::{collection::vec, prelude::*, sample::select};

fn version() -> impl Strategy<Value = RosVersion> {
    select(vec![RosVersion::Ros1, RosVersion::Ros2])
}

fn value(of: PrimitiveType, version: RosVersion) -> BoxedStrategy<MessageValue> {
    if let Some((least, greatest)) = of.range(version) {
        return (least..=greatest).prop_map(MessageValue::Integer).boxed();
    }
    match of {
        PrimitiveType::Bool => any::<bool>().prop_map(MessageValue::Bool).boxed(),
        PrimitiveType::Float32 => any::<f32>()
            .prop_filter("NaN is not itself", |x| !x.is_nan())
            .prop_map(|x| MessageValue::Float(x.into()))
            .boxed(),
        PrimitiveType::Float64 => any::<f64>()
            .prop_filter("NaN is not itself", |x| !x.is_nan())
            .prop_map(MessageValue::Float)
            .boxed(),
        _ => "[ -~äπ]{0,12}".prop_map(|text| MessageValue::Text(text.trim().to_owned())).boxed(),
    }
}

fn primitive(version: RosVersion) -> impl Strategy<Value = PrimitiveType> {
    let all = PrimitiveType::ALL.into_iter().filter(|t| t.is_in(version)).collect::<Vec<_>>();
    select(all)
}

fn field_type(version: RosVersion) -> impl Strategy<Value = MessageFieldType> {
    let message = select(vec!["Pose", "Point", "LaserScan"])
        .prop_map(|n| FieldElement::Message(InterfaceName::message("a_msgs", n)));
    let element = match version {
        RosVersion::Ros1 => {
            prop_oneof![primitive(version).prop_map(FieldElement::Primitive), message].boxed()
        }
        RosVersion::Ros2 => prop_oneof![
            primitive(version).prop_map(FieldElement::Primitive),
            (select(vec![PrimitiveType::String, PrimitiveType::WideString]), 12u32..)
                .prop_map(|(of, most)| FieldElement::BoundedText(of, most)),
            message
        ]
        .boxed(),
    };
    let count = match version {
        RosVersion::Ros1 => prop_oneof![
            Just(ElementCount::One),
            Just(ElementCount::Any),
            (1u32..).prop_map(ElementCount::Exactly)
        ]
        .boxed(),
        RosVersion::Ros2 => prop_oneof![
            Just(ElementCount::One),
            Just(ElementCount::Any),
            (1u32..5).prop_map(ElementCount::Exactly),
            (1u32..5).prop_map(ElementCount::AtMost)
        ]
        .boxed(),
    };
    (element, count).prop_map(|(element, count)| MessageFieldType { element, count })
}

/// A default of a type of ROS 2.
fn default(of: &MessageFieldType) -> BoxedStrategy<Option<MessageValue>> {
    let (FieldElement::Primitive(primitive) | FieldElement::BoundedText(primitive, _)) = of.element else {
        return Just(None).boxed();
    };
    let one = value(primitive, RosVersion::Ros2);
    let many = match of.count {
        ElementCount::One => return proptest::option::of(one).boxed(),
        ElementCount::Any => 0..=4,
        ElementCount::Exactly(n) => n as usize..=n as usize,
        ElementCount::AtMost(n) => 0..=n as usize,
    };
    proptest::option::of(vec(one, many).prop_map(MessageValue::List)).boxed()
}

fn typed_default(version: RosVersion) -> impl Strategy<Value = (MessageFieldType, Option<MessageValue>)> {
    field_type(version).prop_flat_map(move |of| {
        let default = if version == RosVersion::Ros2 { default(&of) } else { Just(None).boxed() };
        (Just(of), default)
    })
}

fn constant(version: RosVersion) -> impl Strategy<Value = (PrimitiveType, MessageValue)> {
    let fits = |of: &PrimitiveType| !matches!(of, PrimitiveType::Time | PrimitiveType::Duration);
    primitive(version).prop_filter("a constant", fits).prop_flat_map(move |of| (Just(of), value(of, version)))
}

fn definition() -> impl Strategy<Value = (RosVersion, MessageDefinition)> {
    let members = |version| (Just(version), vec(typed_default(version), 0..6), vec(constant(version), 0..6));
    version().prop_flat_map(members).prop_map(|(version, fields, constants)| {
        let span = Span::default();
        let field =
            |(n, (of, default))| MessageField { name: format!("f{n}"), of, default, span, type_span: span };
        let constant =
            |(n, (of, value)): (usize, (PrimitiveType, MessageValue))| hrdsl_messages::MessageConstant {
                name: format!("C{n}"),
                of,
                written: value.written(version),
                value,
                span,
            };
        let message = MessageDefinition {
            name: InterfaceName::message("a_msgs", "Thing"),
            constants: constants.into_iter().enumerate().map(constant).collect(),
            fields: fields.into_iter().enumerate().map(field).collect(),
            text: String::new(),
            span,
        };
        (version, message)
    })
}

/// Without what depends on the text that it was read from.
fn without_places(mut message: MessageDefinition) -> MessageDefinition {
    message.text.clear();
    message.span = Span::default();
    message.fields.iter_mut().for_each(|f| (f.span, f.type_span) = (Span::default(), Span::default()));
    message.constants.iter_mut().for_each(|c| c.span = Span::default());
    message
}

fn source(version: RosVersion, text: &str) -> DefinitionText<'_> {
    DefinitionText { version, package: "a_msgs", name: "Thing", file: FileId(0), start: 0, text }
}

proptest! {
    #[test]
    fn what_is_written_reads_as_the_same((version, message) in definition()) {
        let text = message.written(version);
        let (read, faults) = parse_definition(source(version, &text), InterfaceSpace::Msg);
        prop_assert!(faults.is_empty(), "{text}\n{faults:?}");
        let InterfaceDefinition::Message(read) = read else { panic!("a message is asked for") };
        prop_assert_eq!(without_places(read), message, "{}", text);
    }

    #[test]
    fn any_text_is_read_without_a_panic(version in version(), text in ".{0,300}") {
        for space in InterfaceSpace::ALL {
            let (definition, faults) = parse_definition(source(version, &text), space);
            for fault in faults {
                prop_assert!(text.get(fault.span.range()).is_some(), "{fault:?}");
                prop_assert!(!fault.help.is_empty() && !fault.kind.to_string().is_empty());
            }
            // What was understood is understood again.
            let written = definition.written(version);
            let (again, faults) = parse_definition(source(version, &written), space);
            prop_assert!(faults.is_empty(), "{written}\n{faults:?}");
            prop_assert_eq!(again.written(version), written);
        }
    }

    /// Lines made of the pieces that lines are made of.
    #[test]
    fn nearly_right_text_is_read_without_a_panic(
        version in version(),
        pieces in vec(select(vec![
            "int32", "string", "wstring", "bool", "float32", "time", "Header", "Thing", "a_msgs/Thing", "/", "[", "]", "[]", "[3]",
            "<=", "<=5", "=", "x", "X", "5", "-", "0x", "1e3", "\"", "'", "\\", "#", ",", " ", " ", "\n", "\n", "\r\n", "---", "\t", "ä",
            "\u{feff}",
        ]), 0..60),
    ) {
        let text = pieces.concat();
        for space in InterfaceSpace::ALL {
            let (definition, faults) = parse_definition(source(version, &text), space);
            for fault in faults {
                prop_assert!(text.get(fault.span.range()).is_some(), "{fault:?}");
            }
            let written = definition.written(version);
            let (again, faults) = parse_definition(source(version, &written), space);
            prop_assert!(faults.is_empty(), "{text}\n{written}\n{faults:?}");
            prop_assert_eq!(again.written(version), written);
        }
    }

    #[test]
    fn any_bytes_make_a_library_without_a_panic(version in version(), bytes in vec(any::<u8>(), 0..300)) {
        let text = String::from_utf8_lossy(&bytes);
        let mut files = SourceFiles::default();
        let library = MessageLibraryBuilder::new(version, &mut files).package("a_msgs", "a", &text).finish();
        let names: Vec<InterfaceName> = library.messages().map(|(name, _)| name.clone()).collect();
        let _ = library.closure(&names);
    }

    /// Messages that hold each other at random: what is not in a cycle has a table, and what is has none.
    #[test]
    fn cycles_are_found(version in version(), holds in vec(vec(0usize..6, 0..3), 6)) {
        let mut text = String::new();
        for (n, held) in holds.iter().enumerate() {
            text += &format!("== msg/M{n}.msg\n");
            text.extend(held.iter().enumerate().map(|(f, m)| format!("M{m}[] f{f}\n")));
        }
        let reaches = |from: usize| {
            let mut seen = vec![false; 6];
            let mut next: Vec<usize> = holds[from].clone();
            while let Some(n) = next.pop() {
                if !std::mem::replace(&mut seen[n], true) {
                    next.extend(&holds[n]);
                }
            }
            seen
        };
        let mut files = SourceFiles::default();
        let library = MessageLibraryBuilder::new(version, &mut files).package("a_msgs", "a", &text).finish();
        for n in 0..6 {
            let name = InterfaceName::message("a_msgs", format!("M{n}"));
            let is_cyclic = reaches(n)[n];
            let said = library.message(&name).unwrap().faults.iter().any(|f| f.kind.word() == "recursive-message");
            prop_assert_eq!(said, is_cyclic, "M{}\n{}", n, text);
            let holds_one = (0..6).any(|m| (m == n || reaches(n)[m]) && reaches(m)[m]);
            prop_assert_eq!(library.closure(&[name]).is_err(), holds_one);
        }
    }
}
