//! One program of the system: what it waits for, and what has arrived for it.

use hrdsl_ir::{EventId, Nanos, value::seconds};

use super::{
    mailbox::{HeardEvent, MailItem, ProgramMailbox},
    seam::{RequestTicket, SystemActor, SystemAnswer, SystemArrival},
    vocabulary::ActorVocabulary,
};
use crate::{
    fault::{SystemFault, SystemFaultKind},
    player::{HarnessError, PlayerContext},
    world::CommandId,
};

/// More requests at one instant are a program that never lets time pass.
const REQUESTS_AT_AN_INSTANT: usize = 100_000;

/// A program with its open requests.
pub(super) struct ServedProgram<S> {
    pub name: String,
    pub system: S,
    /// In the order in which they were made.
    waits: Vec<(RequestTicket, RequestWait)>,
    pub mailbox: ProgramMailbox,
    /// Commands that it began, with its own numbers for them.
    commands: Vec<(CommandId, u64)>,
    /// How many requests it has made at the instant at which it made the last.
    at_instant: (Nanos, usize),
    /// It has come to its end.
    pub ended: bool,
}

/// What an open request waits for.
pub(super) enum RequestWait {
    Time(Nanos),
    Events { events: Vec<EventId>, until: Option<Nanos> },
    Command(CommandId),
    Arrivals { until: Option<Nanos>, give_up: Option<Nanos> },
}

impl<S: SystemActor> ServedProgram<S> {
    pub fn new(name: String, system: S) -> Self {
        Self {
            name,
            system,
            waits: Vec::new(),
            mailbox: ProgramMailbox::default(),
            commands: Vec::new(),
            at_instant: (0, 0),
            ended: false,
        }
    }

    pub fn answer(
        &mut self,
        ticket: RequestTicket,
        now: Nanos,
        answer: SystemAnswer,
    ) -> Result<(), HarnessError> {
        self.system.answer(ticket, now, answer).map_err(HarnessError::System)
    }

    /// A request that has no answer yet, unless it waits for what is there already.
    pub fn wait(
        &mut self,
        ticket: RequestTicket,
        wait: RequestWait,
        vocabulary: &ActorVocabulary<'_>,
        now: Nanos,
    ) -> Result<(), HarnessError> {
        if matches!(wait, RequestWait::Arrivals { .. }) && !self.mailbox.is_empty() {
            let answer = arrived(&mut self.mailbox, vocabulary, false);
            return self.answer(ticket, now, answer);
        }
        self.waits.push((ticket, wait));
        Ok(())
    }

    /// A command that it does not wait for.
    pub fn began(&mut self, command: CommandId, call: u64) {
        self.commands.push((command, call));
    }

    /// Counts a request at this instant: waits that end at once let no time pass either, so that the count goes on over
    /// them, and starts anew only when time has moved.
    pub fn count(&mut self, now: Nanos) -> Result<(), HarnessError> {
        let (instant, requests) = &mut self.at_instant;
        if *instant != now {
            (*instant, *requests) = (now, 0);
        }
        *requests += 1;
        if *requests <= REQUESTS_AT_AN_INSTANT {
            return Ok(());
        }
        let message = format!(
            "the program made {REQUESTS_AT_AN_INSTANT} requests without letting simulated time pass (at {} s)",
            seconds(now)
        );
        Err(HarnessError::System(SystemFault { message, kind: SystemFaultKind::Program }))
    }

    /// Answers the open requests whose time has come, and those that what has arrived answers.
    pub fn wake(
        &mut self,
        vocabulary: &ActorVocabulary<'_>,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        self.collect_ends(cx);
        let mut at = 0;
        while let Some((ticket, wait)) = self.waits.get(at) {
            let ticket = *ticket;
            match Self::due(wait, &mut self.mailbox, vocabulary, cx) {
                Some(answer) => {
                    self.waits.remove(at);
                    self.answer(ticket, cx.now, answer)?;
                }
                None => at += 1,
            }
        }
        Ok(())
    }

    /// Of commands that ended and that no request waits for.
    fn collect_ends(&mut self, cx: &mut PlayerContext<'_, '_>) {
        let Some(stage) = cx.stage.as_deref_mut() else { return };
        let mailbox = &mut self.mailbox;
        self.commands.retain(|(id, call)| match stage.take_ended(*id) {
            Some(how) => {
                mailbox.push(SystemArrival::Ended { call: *call, how }, usize::MAX);
                false
            }
            None => true,
        });
    }

    /// The answer to an open request, if its time has come.
    fn due(
        wait: &RequestWait,
        mailbox: &mut ProgramMailbox,
        vocabulary: &ActorVocabulary<'_>,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Option<SystemAnswer> {
        let is_over = |until: &Option<Nanos>| until.is_some_and(|until| until <= cx.now);
        match wait {
            RequestWait::Time(until) => (*until <= cx.now).then_some(SystemAnswer::Ok),
            RequestWait::Events { until, .. } => {
                (cx.expire && is_over(until)).then_some(SystemAnswer::TimedOut)
            }
            RequestWait::Command(id) => Some(SystemAnswer::Ended(cx.stage.as_deref_mut()?.take_ended(*id)?)),
            RequestWait::Arrivals { until, give_up } => {
                let gave_up = cx.expire && is_over(give_up);
                (!mailbox.is_empty() || is_over(until) || gave_up)
                    .then(|| arrived(mailbox, vocabulary, gave_up))
            }
        }
    }

    /// An event that it hears: it goes to whoever waits for it the longest, or into the mailbox.
    pub fn hear(
        &mut self,
        heard: HeardEvent,
        vocabulary: &ActorVocabulary<'_>,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        let waits_for = |(_, wait): &(RequestTicket, RequestWait)| match wait {
            RequestWait::Events { events, .. } => events.contains(&heard.event),
            RequestWait::Arrivals { .. } => true,
            RequestWait::Time(_) | RequestWait::Command(_) => false,
        };
        let Some(at) = self.waits.iter().position(waits_for) else {
            self.mailbox.push_event(heard);
            return Ok(());
        };
        let (ticket, wait) = self.waits.remove(at);
        let answer = if matches!(wait, RequestWait::Arrivals { .. }) {
            self.mailbox.push_event(heard);
            arrived(&mut self.mailbox, vocabulary, false)
        } else {
            vocabulary.event_answer(heard)
        };
        self.answer(ticket, cx.now, answer)
    }

    /// Something of another program's, or of its own.
    pub fn deliver(
        &mut self,
        arrival: SystemArrival,
        depth: usize,
        vocabulary: &ActorVocabulary<'_>,
        now: Nanos,
    ) -> Result<(), HarnessError> {
        if self.ended {
            return Ok(());
        }
        self.mailbox.push(arrival, depth);
        let waits = |(_, wait): &(RequestTicket, RequestWait)| matches!(wait, RequestWait::Arrivals { .. });
        let Some(at) = self.waits.iter().position(waits) else { return Ok(()) };
        let (ticket, _) = self.waits.remove(at);
        let answer = arrived(&mut self.mailbox, vocabulary, false);
        self.answer(ticket, now, answer)
    }

    pub fn next_wake(&self) -> Option<Nanos> {
        if self.ended {
            return None;
        }
        let until = |(_, wait): &(RequestTicket, RequestWait)| match wait {
            RequestWait::Time(until) => Some(*until),
            RequestWait::Events { until, .. } => *until,
            RequestWait::Command(_) => None,
            RequestWait::Arrivals { until, give_up } => until.iter().chain(give_up).min().copied(),
        };
        let asks = self.system.is_ready().then_some(0);
        self.waits.iter().filter_map(until).chain(asks).min()
    }
}

fn arrived(mailbox: &mut ProgramMailbox, vocabulary: &ActorVocabulary<'_>, gave_up: bool) -> SystemAnswer {
    let arrival = |item| match item {
        MailItem::Event(heard) => vocabulary.event_arrival(heard),
        MailItem::Other(arrival) => arrival,
    };
    let arrivals: Vec<SystemArrival> = mailbox.take_all().map(arrival).collect();
    // Whoever is told of something has not waited in vain.
    SystemAnswer::Arrived { gave_up: gave_up && arrivals.is_empty(), arrivals }
}
