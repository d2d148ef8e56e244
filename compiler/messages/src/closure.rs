//! What a set of interfaces needs: every message, each after those that it holds.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::Span;

use crate::{
    checksum::{sum, summed_text},
    fault::{MessageFault, MessageFaultKind},
    implied::ActionInterfaces,
    known::{KnownAction, KnownMessage},
    library::MessageLibrary,
    name::{InterfaceName, RosVersion},
    table::{ActionRow, InterfaceTable, MessageRow, ServedAction, ServiceRow},
};

impl MessageLibrary {
    /// The table of all that these messages, services and actions need.
    ///
    /// # Errors
    /// What is wrong with any of them.
    pub fn closure(&self, names: &[InterfaceName]) -> Result<InterfaceTable, Vec<MessageFault>> {
        let mut closure = InterfaceClosure::new(self);
        let names: BTreeSet<&InterfaceName> = names.iter().collect();
        for name in names {
            closure.add(name, Span::default());
        }
        if closure.faults.is_empty() { Ok(closure.table()) } else { Err(closure.faults) }
    }

    /// A message and all that it holds, in the order in which the full text of ROS 1 has them: each where it is first met,
    /// from the fields of the first on down.
    #[must_use]
    pub fn held_by(&self, name: &InterfaceName) -> Vec<&InterfaceName> {
        let mut seen = BTreeSet::from([name]);
        let mut all = Vec::new();
        let mut waiting: Vec<&InterfaceName> = self.held_directly(name);
        while let Some(held) = waiting.pop() {
            if seen.insert(held) {
                all.push(held);
                waiting.extend(self.held_directly(held));
            }
        }
        all
    }

    /// What a message holds itself, the last first.
    fn held_directly(&self, name: &InterfaceName) -> Vec<&InterfaceName> {
        let mut held: Vec<&InterfaceName> =
            self.message(name).map(|m| m.definition.embedded().collect()).unwrap_or_default();
        held.reverse();
        held
    }

    /// The text of a message with those of all that it holds, as ROS 1 sends it when a connection begins.
    #[must_use]
    pub fn full_text(&self, name: &InterfaceName) -> Option<String> {
        let mut text = self.message(name)?.definition.text.clone();
        for held in self.held_by(name) {
            let written = held.written(self.version());
            let inner = &self.message(held)?.definition.text;
            text += &format!("\n{}\nMSG: {written}\n{inner}", "=".repeat(80));
        }
        Some(text)
    }
}

struct InterfaceClosure<'l> {
    library: &'l MessageLibrary,
    /// Each after those that it holds.
    ordered: Vec<(&'l InterfaceName, &'l KnownMessage)>,
    seen: BTreeSet<&'l InterfaceName>,
    services: BTreeSet<&'l InterfaceName>,
    actions: BTreeMap<&'l InterfaceName, &'l KnownAction>,
    faults: Vec<MessageFault>,
}

impl<'l> InterfaceClosure<'l> {
    fn new(library: &'l MessageLibrary) -> Self {
        Self {
            library,
            ordered: Vec::new(),
            seen: BTreeSet::new(),
            services: BTreeSet::new(),
            actions: BTreeMap::new(),
            faults: Vec::new(),
        }
    }

    fn add(&mut self, name: &InterfaceName, asked_at: Span) {
        // Services that an action implies are of its space, and so are the messages of both.
        if !(self.action(name) || self.service(name) || self.message(name)) {
            let kind = MessageFaultKind::UnknownType(name.written(self.library.version()));
            let help = format!("name the workspace that holds the package `{}`", name.package);
            self.faults.push(kind.at(asked_at, help));
        }
    }

    fn service(&mut self, name: &InterfaceName) -> bool {
        let Some((name, service)) = self.library.services_from(name) else { return false };
        if self.services.insert(name) {
            self.message(&service.request);
            self.message(&service.response);
        }
        true
    }

    fn action(&mut self, name: &InterfaceName) -> bool {
        let Some((name, action)) = self.library.actions_from(name) else { return false };
        if self.actions.insert(name, action).is_none() {
            let parts = [&action.goal, &action.result, &action.feedback];
            let wire = match &action.interfaces {
                ActionInterfaces::Ros1 { action, cancel, status, .. } => vec![action, cancel, status],
                ActionInterfaces::Ros2 { send_goal, get_result, feedback_message, cancel, status } => {
                    vec![send_goal, get_result, feedback_message, cancel, status]
                }
            };
            for part in parts.into_iter().chain(wire) {
                self.add(part, action.span);
            }
        }
        true
    }

    /// Adds a message behind all that it holds. Without a recursion: a chain may be as long as the library, if it is at fault.
    fn message(&mut self, name: &InterfaceName) -> bool {
        let Some((name, _)) = self.library.messages_from(name) else { return false };
        let mut waiting = vec![(name, false)];
        while let Some((name, is_entered)) = waiting.pop() {
            let Some(message) = self.library.message(name) else { continue };
            if is_entered {
                self.ordered.push((name, message));
            } else if self.seen.insert(name) {
                self.faults.extend(message.faults.iter().cloned());
                waiting.push((name, true));
                waiting.extend(self.library.held_directly(name).into_iter().map(|held| (held, false)));
            }
        }
        true
    }

    fn table(self) -> InterfaceTable {
        let version = self.library.version();
        let texts = match version {
            RosVersion::Ros1 => self.summed_texts(),
            RosVersion::Ros2 => BTreeMap::new(),
        };
        let sums: BTreeMap<&InterfaceName, String> = texts.iter().map(|(n, t)| (*n, sum(&[t]))).collect();
        let messages = self.ordered.iter().map(|(name, message)| {
            let held = self.library.held_by(name).into_iter().map(|held| held.written(version)).collect();
            MessageRow::new(&message.definition, version, held, sums.get(name).cloned())
        });
        let services = self.library.services().filter(|(name, _)| self.services.contains(name));
        let services = services.map(|(name, service)| {
            let both = texts.get(&service.request).zip(texts.get(&service.response));
            let md5 = both.map(|(request, response)| sum(&[request, response]));
            ServiceRow {
                name: name.written(version),
                request: service.request.written(version),
                response: service.response.written(version),
                md5,
            }
        });
        let actions = self.actions.iter().map(|(name, action)| ActionRow {
            name: name.written(version),
            goal: action.goal.written(version),
            result: action.result.written(version),
            feedback: action.feedback.written(version),
            served: ServedAction::new(&action.interfaces),
        });
        InterfaceTable {
            version: InterfaceTable::VERSION,
            ros: match version {
                RosVersion::Ros1 => 1,
                RosVersion::Ros2 => 2,
            },
            messages: messages.collect(),
            services: services.collect(),
            actions: actions.collect(),
        }
    }

    /// The text that is summed, of each message.
    fn summed_texts(&self) -> BTreeMap<&'l InterfaceName, String> {
        let mut texts = BTreeMap::new();
        let mut sums: BTreeMap<&InterfaceName, String> = BTreeMap::new();
        for (name, message) in &self.ordered {
            // What it holds came before it; without a fault, all of it is known.
            let text = summed_text(&message.definition, |held| sums.get(held).map(String::as_str))
                .unwrap_or_default();
            sums.insert(name, sum(&[&text]));
            texts.insert(*name, text);
        }
        texts
    }
}
