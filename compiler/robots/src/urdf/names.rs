//! Names of links and joints: each there once, and found by those who name it.

use std::collections::BTreeMap;

use hrdsl_source::{Span, nearest};

use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace, say},
    xml::{XmlAttribute, XmlElement},
};

/// A name, and where it stands.
#[derive(Clone, Debug)]
pub(crate) struct PlacedName {
    pub name: String,
    pub place: RobotPlace,
}

impl PlacedName {
    pub fn of(element: &XmlElement, attribute: &XmlAttribute) -> Self {
        Self { name: attribute.value.clone(), place: element.place_of(attribute) }
    }
}

/// Numbers of links or joints, by their names.
pub(crate) type NumberOf = BTreeMap<String, (usize, Span)>;

/// The numbers of what has names, each of which must be there once.
pub(crate) fn numbered<'a>(
    all: impl Iterator<Item = (&'a str, RobotPlace)>,
    what: &'static str,
    faults: &mut Vec<RobotFault>,
) -> NumberOf {
    let mut numbers = NumberOf::new();
    for (at, (name, place)) in all.enumerate() {
        if let Some((_, first)) = numbers.get(name) {
            let kind = RobotFaultKind::DuplicateName { what, name: name.to_owned() };
            say(faults, kind.at(place, "give one of them another name").clashes(*first));
        } else {
            numbers.insert(name.to_owned(), (at, place.span));
        }
    }
    numbers
}

/// The number of what a name stands for, or a fault with the nearest name.
pub(crate) fn number_of(
    wanted: &PlacedName,
    what: &'static str,
    numbers: &NumberOf,
) -> Result<usize, RobotFault> {
    numbers.get(&wanted.name).map(|(at, _)| *at).ok_or_else(|| {
        let near = nearest(&wanted.name, numbers.keys().map(String::as_str));
        let help = match near {
            Some(near) => format!("write `{near}`"),
            None => format!("declare it: `<{what} name=\"{}\" …>`", wanted.name),
        };
        let kind = RobotFaultKind::UnknownName { what, name: wanted.name.clone() };
        kind.at(wanted.place, help)
    })
}
