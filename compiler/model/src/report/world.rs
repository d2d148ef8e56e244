//! HR08xx: world and system.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use crate::noun::Noun;

/// HR0801
pub(crate) fn bad_world(span: Span, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::BAD_WORLD, span, message).help(help)
}

/// HR0801: two names of a description that are written alike.
pub(crate) fn unlike_names(
    noun: Noun,
    name: &str,
    first: &str,
    spelling: &str,
    span: Span,
    other: Span,
) -> Diagnostic {
    let message = format!("the {} `{first}` and `{name}` are both written `{spelling}`", noun.plural());
    bad_world(span, message, "rename one of them in the description").label(other, "the other one")
}

/// HR0201: a posture whose angles are no list.
pub(crate) fn no_angles(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, "a posture is a list of angles")
        .help("write the angle of each joint, from the base to the tip: `[0 deg, 90 deg]`")
}

/// HR0201: a point on the way of a posture that is not angles and a time.
pub(crate) fn no_point(span: Span) -> Diagnostic {
    Diagnostic::error(DiagnosticCode::TYPE_MISMATCH, span, "a point of a posture is angles and a time")
        .help("write the points in order of time: `[([0 deg, 90 deg], 1 s), ([30 deg, 90 deg], 2.5 s)]`")
}

/// The parts of the library, and the modules that they are in. A test compares them with the library.
pub const LIBRARY_PARTS: &[(&str, &str)] = &[
    ("adult", "std.person"),
    ("base", "std.robots.mobile"),
    ("bert2", "std.robots.bert2"),
    ("child", "std.person"),
    ("collision", "std.sensors"),
    ("door", "std.furniture"),
    ("drawer", "std.furniture"),
    ("gaze", "std.sensors"),
    ("knock", "std.sensors"),
    ("location", "std.sensors"),
    ("person", "std.person"),
    ("presence", "std.sensors"),
    ("pressure", "std.sensors"),
    ("proximity", "std.sensors"),
    ("speedometer", "std.sensors"),
    ("tiago", "std.robots.tiago"),
    ("turtlebot", "std.robots.mobile"),
    ("urg04lx", "std.sensors"),
    ("watched", "std.sensors"),
];

/// What to write for a part that is not there; `none`: no part is.
pub(crate) fn missing_part(issue: &mut Diagnostic, name: &str, none: bool) {
    if let Some((_, module)) = LIBRARY_PARTS.iter().find(|(part, _)| *part == name) {
        issue.help =
            Some(format!("`{name}` is in the library: write `use {module}` before the declarations"));
        issue.fixes.clear();
    } else if none {
        issue.help = Some(format!(
            "declare it, as `part {name} {{ … }}`, or take one of the library, such as `person` after `use std.person`"
        ));
    }
}
