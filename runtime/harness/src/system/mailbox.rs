//! What has arrived for a program and was neither taken nor dropped, in the order in which it arrived.

use std::collections::{BTreeMap, VecDeque};

use hrdsl_ir::{EventId, Nanos, Value};

use super::seam::SystemArrival;

/// So many events wait at most; of more, the oldest are lost, as in the queue of a ROS subscriber.
const EVENTS: usize = 1_000;

/// An event that the program heard.
pub(super) struct HeardEvent {
    pub event: EventId,
    pub args: Vec<Value>,
    pub time: Nanos,
}

/// Something in a mailbox.
pub(super) enum MailItem {
    Event(HeardEvent),
    Other(SystemArrival),
}

#[derive(Default)]
pub(super) struct ProgramMailbox {
    items: VecDeque<MailItem>,
    events: usize,
    /// How many messages wait for each port.
    messages: BTreeMap<u64, usize>,
}

impl ProgramMailbox {
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    pub fn push_event(&mut self, event: HeardEvent) {
        if self.events == EVENTS {
            self.remove_first(|item| matches!(item, MailItem::Event(_)));
        }
        self.events += 1;
        self.items.push_back(MailItem::Event(event));
    }

    /// Puts it in; of messages to a port, `depth` are kept.
    pub fn push(&mut self, arrival: SystemArrival, depth: usize) {
        if let SystemArrival::Message { port, .. } = arrival {
            if self.messages.get(&port).is_some_and(|waiting| *waiting >= depth) {
                self.remove_first(|item| {
                    matches!(item, MailItem::Other(SystemArrival::Message { port: of, .. }) if *of == port)
                });
            }
            *self.messages.entry(port).or_default() += 1;
        }
        self.items.push_back(MailItem::Other(arrival));
    }

    /// The first of these events.
    pub fn take_event(&mut self, events: &[EventId]) -> Option<HeardEvent> {
        let wanted = |item: &MailItem| matches!(item, MailItem::Event(e) if events.contains(&e.event));
        match self.remove_first(wanted)? {
            MailItem::Event(event) => Some(event),
            MailItem::Other(_) => None,
        }
    }

    /// Everything.
    pub fn take_all(&mut self) -> impl Iterator<Item = MailItem> {
        (self.events, self.messages) = (0, BTreeMap::new());
        std::mem::take(&mut self.items).into_iter()
    }

    /// Forgets these events; none named: all events.
    pub fn forget(&mut self, events: &[EventId]) {
        let stays = |item: &MailItem| match item {
            MailItem::Event(e) => !(events.is_empty() || events.contains(&e.event)),
            MailItem::Other(_) => true,
        };
        self.items.retain(stays);
        self.events = self.items.iter().filter(|item| matches!(item, MailItem::Event(_))).count();
    }

    /// Forgets what waits for a port that is closed.
    pub fn forget_port(&mut self, port: u64) {
        let of = |item: &MailItem| matches!(item, MailItem::Other(SystemArrival::Message { port: p, .. }) if *p == port);
        self.items.retain(|item| !of(item));
        self.messages.remove(&port);
    }

    fn remove_first(&mut self, which: impl Fn(&MailItem) -> bool) -> Option<MailItem> {
        let at = self.items.iter().position(which)?;
        let item = self.items.remove(at)?;
        match &item {
            MailItem::Event(_) => self.events -= 1,
            MailItem::Other(SystemArrival::Message { port, .. }) => {
                if let Some(waiting) = self.messages.get_mut(port) {
                    *waiting -= 1;
                }
            }
            MailItem::Other(_) => {}
        }
        Some(item)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(port: u64, text: &str) -> SystemArrival {
        SystemArrival::Message { port, message: text.into() }
    }

    fn heard(event: u16, time: Nanos) -> HeardEvent {
        HeardEvent { event: EventId(event), args: Vec::new(), time }
    }

    fn shown(mailbox: &mut ProgramMailbox) -> Vec<String> {
        let show = |item| match item {
            MailItem::Event(e) => format!("{}@{}", e.event.0, e.time),
            MailItem::Other(SystemArrival::Message { port, message }) => format!("{port}:{message}"),
            MailItem::Other(other) => format!("{other:?}"),
        };
        mailbox.take_all().map(show).collect()
    }

    #[test]
    fn of_a_port_the_newest_are_kept() {
        let mut mailbox = ProgramMailbox::default();
        for (i, port) in [1, 2, 1, 1, 2].into_iter().enumerate() {
            mailbox.push(message(port, &i.to_string()), if port == 1 { 2 } else { 9 });
        }
        assert_eq!(shown(&mut mailbox), ["2:1", "1:2", "1:3", "2:4"]);
        mailbox.push(message(1, "again"), 1);
        mailbox.push(message(1, "last"), 1);
        assert_eq!(shown(&mut mailbox), ["1:last"]);
    }

    #[test]
    fn events_are_taken_by_name_dropped_and_lost_beyond_a_thousand() {
        let mut mailbox = ProgramMailbox::default();
        (0..1_002).for_each(|i| mailbox.push_event(heard(u16::from(i % 2 == 0), i)));
        assert_eq!(mailbox.take_event(&[EventId(1)]).map(|e| e.time), Some(2));
        assert_eq!(mailbox.take_event(&[EventId(7)]).map(|e| e.time), None);
        mailbox.push(message(3, "m"), 1);
        mailbox.forget(&[EventId(1)]);
        assert_eq!(mailbox.take_event(&[EventId(0), EventId(1)]).map(|e| e.time), Some(3));
        mailbox.forget(&[]);
        assert_eq!(shown(&mut mailbox), ["3:m"]);
        mailbox.push(message(3, "m"), 1);
        mailbox.forget_port(3);
        assert!(mailbox.is_empty());
    }
}
