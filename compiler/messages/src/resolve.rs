//! What can be wrong between messages: types that nobody defines, messages that contain themselves, and too much of either.

use std::collections::{BTreeMap, VecDeque};

use crate::{
    definition::{ElementCount, FieldElement, MessageDefinition, MessageField},
    fault::{MessageFault, MessageFaultKind},
    guess::nearest_type,
    known::KnownMessage,
    limits::{MOST_DEPTH, MOST_FAULTS, MOST_FIXED_VALUES},
    name::{InterfaceName, RosVersion},
};

/// How many unknown types of a library get the nearest name told: each is compared with all that are known.
const MOST_COMPARED: usize = 1000;
/// How many steps are spent to find the ways by which messages contain themselves.
const MOST_STEPS: usize = 1_000_000;

/// Adds to each message what is wrong with it in the company of the others.
pub(crate) fn check(version: RosVersion, messages: &mut BTreeMap<InterfaceName, KnownMessage>) {
    let mut found: Vec<(InterfaceName, MessageFault)> = unknown_types(version, messages);
    let order = MessageOrder::new(messages);
    found.extend(order.measured(messages));
    found.extend(order.recursive(version, messages));
    for (name, fault) in found {
        if let Some(message) = messages.get_mut(&name) {
            message.faults.push(fault);
        }
    }
}

fn unknown_types(
    version: RosVersion,
    messages: &BTreeMap<InterfaceName, KnownMessage>,
) -> Vec<(InterfaceName, MessageFault)> {
    let mut found = Vec::new();
    for (name, message) in messages {
        let unknown = message.definition.fields.iter().filter_map(|field| Some((field, field.of.message()?)));
        let unknown = unknown.filter(|(_, held)| !messages.contains_key(held));
        for (field, held) in unknown.take(MOST_FAULTS) {
            let near = if found.len() < MOST_COMPARED {
                nearest_type(held, &name.package, version, messages)
            } else {
                None
            };
            let help = match near {
                Some(near) => format!("write `{near}`"),
                None => {
                    format!("name the workspace that holds the package `{}`, or fix the name", held.package)
                }
            };
            // As it is written there: without the package that it is of anyway.
            let written =
                if held.package == name.package { held.name.clone() } else { held.in_field(version) };
            let kind = MessageFaultKind::UnknownType(written);
            found.push((name.clone(), kind.at(field.type_span, help)));
        }
    }
    found
}

/// The messages by number, those first that are made of primitive types alone.
struct MessageOrder<'m> {
    names: Vec<&'m InterfaceName>,
    /// What each holds, of what is known.
    holds: Vec<Vec<usize>>,
    /// Each after all that it holds.
    ordered: Vec<usize>,
    /// What holds itself, or something that does.
    rest: Vec<usize>,
}

impl<'m> MessageOrder<'m> {
    fn new(messages: &'m BTreeMap<InterfaceName, KnownMessage>) -> Self {
        let names: Vec<&InterfaceName> = messages.keys().collect();
        let number = |name: &InterfaceName| names.binary_search(&name).ok();
        let holds: Vec<Vec<usize>> =
            messages.values().map(|m| m.definition.embedded().filter_map(number).collect()).collect();
        let mut held_by = vec![Vec::new(); names.len()];
        for (holder, held) in holds.iter().enumerate() {
            for one in held {
                held_by.get_mut(*one).into_iter().for_each(|by: &mut Vec<usize>| by.push(holder));
            }
        }
        let mut missing: Vec<usize> = holds.iter().map(Vec::len).collect();
        let mut next: VecDeque<usize> = (0..names.len()).filter(|i| missing.get(*i) == Some(&0)).collect();
        let mut ordered = Vec::new();
        while let Some(one) = next.pop_front() {
            ordered.push(one);
            for holder in held_by.get(one).into_iter().flatten() {
                if let Some(missing) = missing.get_mut(*holder) {
                    *missing -= 1;
                    if *missing == 0 {
                        next.push_back(*holder);
                    }
                }
            }
        }
        let rest = (0..names.len()).filter(|i| missing.get(*i).is_some_and(|m| *m > 0)).collect();
        Self { names, holds, ordered, rest }
    }

    /// Messages that are too deep or too large. Said of the first that is, and not of those that hold it.
    fn measured(
        &self,
        messages: &BTreeMap<InterfaceName, KnownMessage>,
    ) -> Vec<(InterfaceName, MessageFault)> {
        let mut sizes: BTreeMap<&InterfaceName, (u32, u64)> = BTreeMap::new();
        let mut found = Vec::new();
        for name in self.ordered.iter().filter_map(|i| self.names.get(*i).copied()) {
            let Some(KnownMessage { definition, .. }) = messages.get(name) else { continue };
            let held = definition.embedded().filter_map(|held| sizes.get(held).copied());
            let (depth, most) = held.fold((0, 0), |(d, v), (depth, values)| (d.max(depth), v.max(values)));
            let (depth, values) = (depth + 1, fixed_values(definition, &sizes));
            sizes.insert(name, (depth, values));
            let (what, limit, help) = if depth == MOST_DEPTH + 1 {
                (
                    "messages within messages",
                    MOST_DEPTH.into(),
                    "put its fields into the message that holds it",
                )
            } else if values > MOST_FIXED_VALUES && most <= MOST_FIXED_VALUES {
                ("values in arrays of a fixed size", MOST_FIXED_VALUES, "write `[]` for an array of any size")
            } else {
                continue;
            };
            let fault = MessageFaultKind::TooMuch { what, limit }.at(definition.span, help);
            found.push((name.clone(), fault));
        }
        found
    }

    /// Messages that contain themselves, each with a shortest way.
    fn recursive(
        &self,
        version: RosVersion,
        messages: &BTreeMap<InterfaceName, KnownMessage>,
    ) -> Vec<(InterfaceName, MessageFault)> {
        let mut found = Vec::new();
        let mut steps = 0;
        for &start in &self.rest {
            let way =
                if steps < MOST_STEPS { self.way_back(start, &mut steps) } else { Some(vec![start, start]) };
            let Some(way) = way else { continue };
            let names: Vec<&InterfaceName> = way.iter().filter_map(|i| self.names.get(*i).copied()).collect();
            let (Some(name), Some(second)) = (names.first(), names.get(1)) else { continue };
            let Some(KnownMessage { definition, .. }) = messages.get(*name) else { continue };
            let field = definition.fields.iter().find(|f| f.of.message() == Some(*second));
            let span = field.map_or(definition.span, |f| f.type_span);
            let words: Vec<String> = names.iter().map(|n| format!("`{}`", n.in_field(version))).collect();
            let help = format!(
                "take the field out, or hold a number that names the message: {}",
                words.join(" holds ")
            );
            found.push((
                (*name).clone(),
                MessageFaultKind::RecursiveMessage(name.in_field(version)).at(span, help),
            ));
        }
        found
    }

    /// From a message by what it holds to itself; `None` if it does not contain itself.
    fn way_back(&self, start: usize, steps: &mut usize) -> Option<Vec<usize>> {
        let mut came_from: BTreeMap<usize, usize> = BTreeMap::new();
        let mut next = VecDeque::from([start]);
        while let Some(at) = next.pop_front() {
            for &held in self.holds.get(at).into_iter().flatten() {
                *steps += 1;
                if held == start {
                    let mut way = vec![start, at];
                    while let Some(before) =
                        way.last().filter(|i| **i != start).and_then(|i| came_from.get(i))
                    {
                        way.push(*before);
                    }
                    way.dedup();
                    way.reverse();
                    // A message that holds itself directly is its own beginning and end.
                    return Some(if way.len() == 1 { vec![start, start] } else { way });
                }
                if self.rest.binary_search(&held).is_ok() && !came_from.contains_key(&held) {
                    came_from.insert(held, at);
                    next.push_back(held);
                }
            }
        }
        None
    }
}

/// How many values a message holds before anything is put into its sequences.
fn fixed_values(message: &MessageDefinition, sizes: &BTreeMap<&InterfaceName, (u32, u64)>) -> u64 {
    let of_field = |field: &MessageField| {
        let one = match &field.of.element {
            FieldElement::Primitive(_) | FieldElement::BoundedText(..) => 1,
            FieldElement::Message(name) => sizes.get(name).map_or(1, |(_, values)| *values),
        };
        match field.of.count {
            ElementCount::One => one,
            ElementCount::Exactly(number) => one.saturating_mul(number.into()),
            ElementCount::Any | ElementCount::AtMost(_) => 1,
        }
    };
    message.fields.iter().map(of_field).fold(1, u64::saturating_add)
}
