//! Bindings: interfaces of ROS, their fields, and what can be said of them.

use hrdsl_ir::{binding::MessageScalar, device::CommandParam};
use hrdsl_messages::{MessageFault, UnknownInterface};
use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use super::names::{replace, with_nearest};
use crate::noun::Noun;

/// HR0805: a definition with a fault, or a workspace.
pub(crate) fn fault(fault: &MessageFault) -> Diagnostic {
    let message = fault.kind.to_string();
    let error =
        Diagnostic::error(DiagnosticCode::BAD_DEFINITION, fault.span, message).help(fault.help.clone());
    match fault.first {
        Some(first) => error.label(first, "the first is here"),
        None => error,
    }
}

/// HR0101
pub(crate) fn unknown_interface(unknown: &UnknownInterface, span: Span) -> Diagnostic {
    let error = Diagnostic::error(DiagnosticCode::UNKNOWN_NAME, span, unknown.to_string());
    match &unknown.nearest {
        Some(near) => replace(error.help(format!("did you mean `{near}`?")), &unknown.written, near),
        None => error.help("name the workspace that defines it: `messages \"PATH\"`"),
    }
}

/// HR0101
pub(crate) fn unknown_field<'n>(
    field: &str,
    of: &str,
    span: Span,
    known: impl IntoIterator<Item = &'n str>,
) -> Diagnostic {
    let of = if of.is_empty() { "the message".to_owned() } else { format!("`{of}`") };
    let message = format!("{of} has no field `{field}`");
    with_nearest(Diagnostic::error(DiagnosticCode::UNKNOWN_NAME, span, message), Noun::Field, field, known)
}

/// HR0201: a field that is a message itself.
pub(crate) fn several_values(field: &str, parts: &[String], span: Span) -> Diagnostic {
    let message = format!("`{field}` holds several values");
    let error = Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message);
    match parts.first() {
        Some(part) => error.help(format!("name one of them, such as `{field}.{part}`")),
        None => error,
    }
}

/// HR0201: an array or a sequence, which is given one value.
pub(crate) fn not_one_value(field: &str, span: Span) -> Diagnostic {
    let message = format!("`{field}` holds a row of values");
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message).help(format!(
        "write all of them, as `{field} = [a, b]`, or name one, counted from 0: `{field}[0] = a`"
    ))
}

/// HR0201: the same, which a rule reads.
pub(crate) fn unread_sequence(field: &str, span: Span) -> Diagnostic {
    let message = format!("`{field}` holds a row of values");
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message)
        .help(format!("name one, counted from 0: `{field}[0]`; `length({field})` says how many there are"))
}

/// HR0201
pub(crate) fn unread_time(field: &str, span: Span) -> Diagnostic {
    let message = format!("`{field}` is a time, which rules cannot read");
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message)
        .help("a rule is carried out at the time at which the message is published")
}

/// HR0201
pub(crate) fn no_sequence(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, "only a row of values has a length")
        .help("name a field of the message with an array or a sequence: `length(ranges) > 3`")
}

/// HR0201: a value that a field cannot hold.
pub(crate) fn does_not_fit(value: &str, field: MessageScalar, span: Span) -> Diagnostic {
    let holds = match field {
        MessageScalar::Bool => "true or false",
        MessageScalar::Int { .. } => "a whole number",
        MessageScalar::Float => "a number",
        MessageScalar::Text => "text",
        MessageScalar::Time => "a time, which is set by itself in the header",
        MessageScalar::Heading => "an orientation: an angle about the vertical, or the name of a body",
    };
    let message = format!("the field holds {holds}, but this is {value}");
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message)
}

/// HR0201: an argument of a command that takes several numbers.
pub(crate) fn other_argument(param: &CommandParam, span: Span) -> Diagnostic {
    let message = format!("`{}` takes {}", param.name, param.ty);
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message)
        .help("name a field with a sequence of numbers, or write them: `[a, b]`, `(x, y, z)`")
}

/// HR0806
fn bad_binding(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_BINDING, span, message).help(help)
}

/// HR0806
pub(crate) fn bad_name(name: &str, wild: bool, span: Span) -> Diagnostic {
    let help = if wild {
        "write it from the root, as `/arm/joint/command`; one `*` may stand for a part that varies"
    } else {
        "write it from the root, as `/human_signals`"
    };
    bad_binding(span, format!("`{name}` is no name of a topic, service or action"), help)
}

/// HR0806
pub(crate) fn never_published(span: Span) -> Diagnostic {
    let help = "give it a rate, as `in at 10 Hz`, or let a field speak of an event, or make it `latched`";
    bad_binding(span, "nothing makes a message of this topic", help)
}

/// HR0806
pub(crate) fn held_for_how_long(span: Span) -> Diagnostic {
    let help = "write for how long, as `held(leg_request, 5 s)`";
    bad_binding(span, "an event is over at once, but messages go at a rate", help)
}

/// HR0806
pub(crate) fn no_event(span: Span) -> Diagnostic {
    bad_binding(span, "`held` needs an event", "write `held(leg_request, 5 s)`")
}

/// HR0806
pub(crate) fn no_fields(span: Span) -> Diagnostic {
    let help = "write what a message means: `emit decided(true) when data == 1`";
    bad_binding(span, "the programs make these messages: their fields are given no values", help)
}

/// HR0806
pub(crate) fn no_rules(span: Span) -> Diagnostic {
    let help = "write what its fields hold: `data = held(leg_request, 5 s)`";
    bad_binding(span, "the programs hear these messages, and do not make them", help)
}

/// HR0806
pub(crate) fn too_large(span: Span) -> Diagnostic {
    bad_binding(span, "the message holds more than 100000 values", "bind a smaller one")
}

/// HR0806
pub(crate) fn no_way_to_drive(device: &str, interface: &str, ways: &str, span: Span) -> Diagnostic {
    let message = format!("messages of the type `{interface}` drive no {device}");
    bad_binding(span, message, format!("{ways}; for others, write a rule: `move_joints robot.arm(position)`"))
}

/// HR0806
pub(crate) fn no_source(device: &str, interface: &str, ways: &str, span: Span) -> Diagnostic {
    let message = format!("a message of the type `{interface}` holds nothing that comes from this {device}");
    bad_binding(span, message, format!("{ways}; in others, give values to the fields one by one"))
}

/// HR0806
pub(crate) fn no_wildcard(span: Span) -> Diagnostic {
    let help = "write `*` in the topic where the joint's name stands: `/arm/*_controller/command`";
    bad_binding(span, "one number drives one joint, and the topic does not say which", help)
}

/// HR0806
pub(crate) fn no_joints(span: Span) -> Diagnostic {
    let help = "write it in a topic that drives an arm or comes from one, or in a group";
    bad_binding(span, "only an arm has joints to be named", help)
}

/// HR0806
pub(crate) fn joints_only(span: Span) -> Diagnostic {
    let help = "write what the programs call its joints: `\"shoulder\" = shoulder_flexor`";
    bad_binding(span, "a group has nothing but the names of joints", help)
}

/// HR0806
pub(crate) fn bad_joint_text(span: Span) -> Diagnostic {
    bad_binding(
        span,
        "a joint's name has a character at least, and no `/`",
        "write the name that the programs use",
    )
}

/// HR0105
pub(crate) fn joints_missing(joints: &[&str], span: Span) -> Diagnostic {
    let all: Vec<String> = joints.iter().map(|joint| format!("`{joint}`")).collect();
    let message = format!("the programs' names of these joints are missing: {}", all.join(", "));
    let first = joints.first().copied().unwrap_or_default();
    super::names::missing(span, message, format!("name all joints, or none: `\"NAME\" = {first}`"))
}

/// HR0102
pub(crate) fn joint_named_twice(joint: &str, span: Span, first: Span) -> Diagnostic {
    let message = format!("the joint `{joint}` has a name already");
    Diagnostic::error(DiagnosticCode::DUPLICATE_NAME, span, message)
        .help("give it one name")
        .label(first, "it is named here first")
}

/// HR0806
pub(crate) fn no_condition(span: Span) -> Diagnostic {
    let help = "a `when` belongs to a field of an answer, where it speaks of the request or the goal; write `if C { a } else { b }`";
    bad_binding(span, "no message is answered here", help)
}

/// HR0806
pub(crate) fn no_postures(span: Span) -> Diagnostic {
    let help = "declare them beside the arm, or in the world: `posture home: robot.arm at [0 deg, 90 deg]`";
    bad_binding(span, "this device has no postures", help)
}

/// HR0201: a message in a message, which is neither a body nor written out.
pub(crate) fn no_whole(field: &str, parts: &[String], body: bool, span: Span) -> Diagnostic {
    let message = format!("`{field}` holds several values");
    let error = Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, message);
    match (parts.first(), body) {
        (Some(part), true) => {
            error.help(format!("name a body, as `{field} = robot.palm`, or one value: `{field}.{part} = …`"))
        }
        (Some(part), false) => error.help(format!("name one of them, such as `{field}.{part}`")),
        (None, _) => error,
    }
}

/// HR0806
pub(crate) fn no_parameters(span: Span) -> Diagnostic {
    let help = "hand it over behind the command: `--ros-args -p NAME:=VALUE`, or `--params-file FILE`";
    bad_binding(span, "in ROS 2 each node has parameters of its own", help)
}

/// HR0201
pub(crate) fn no_posture_name(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, "a posture is named by a text")
        .help("name a field with text, or write it: `posture(\"home\")`")
}
