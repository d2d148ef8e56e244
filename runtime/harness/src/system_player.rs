//! The player of the system actor: answers what the system asks, and lets time pass while it waits.

use std::collections::{BTreeMap, VecDeque};

use hrdsl_ir::{
    ActorId, Event, EventId, Nanos, Parameter, Program, Type, Value,
    value::seconds,
    world::{Signal, SignalId},
};

use crate::{
    argument::SystemArgument,
    command::NotBegun,
    message::PlayerMessage,
    player::{ActorPlayer, HarnessError, PlayerContext, is_perceived},
    stage::WorldStage,
    system::{RequestTicket, SystemActor, SystemAnswer, SystemFault, SystemFaultKind, SystemRequest},
    world::CommandId,
};

/// How many events wait in the system's mailbox at most; the oldest are dropped, as in a ROS subscriber's queue.
const MAILBOX: usize = 1_000;
/// More requests at one instant are a system that never lets time pass.
const REQUESTS_AT_AN_INSTANT: usize = 100_000;

/// Plays the system actor by a [`SystemActor`].
pub struct SystemPlayer<'p, S> {
    program: &'p Program,
    actors: [ActorId; 1],
    system: S,
    /// Its open requests, in the order in which they were made.
    waits: Vec<(RequestTicket, RequestWait)>,
    mailbox: VecDeque<MailboxEvent>,
    /// How many requests it has made at the instant at which it made the last.
    at_instant: (Nanos, usize),
    /// It has come to its end.
    ended: bool,
}

struct MailboxEvent {
    event: EventId,
    args: Vec<Value>,
    time: Nanos,
}

/// What an open request waits for.
enum RequestWait {
    Time(Nanos),
    Events { events: Vec<EventId>, until: Option<Nanos> },
    Command(CommandId),
}

/// What a request comes to at once.
enum RequestResponse {
    Answer(SystemAnswer),
    Wait(RequestWait),
    End,
}

impl<'p, S: SystemActor> SystemPlayer<'p, S> {
    #[must_use]
    pub fn new(program: &'p Program, actor: ActorId, system: S) -> Self {
        Self {
            program,
            actors: [actor],
            system,
            waits: Vec::new(),
            mailbox: VecDeque::new(),
            at_instant: (0, 0),
            ended: false,
        }
    }

    fn answer(
        &mut self,
        ticket: RequestTicket,
        now: Nanos,
        answer: SystemAnswer,
    ) -> Result<(), HarnessError> {
        self.system.answer(ticket, now, answer).map_err(HarnessError::System)
    }

    /// Takes requests for as long as it makes some.
    fn serve(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        while !self.ended && self.system.is_ready() {
            let Some((ticket, request)) = self.system.next(cx.now).map_err(HarnessError::System)? else {
                break;
            };
            self.count(cx.now)?;
            match self.response(request, cx) {
                RequestResponse::Answer(answer) => self.answer(ticket, cx.now, answer)?,
                RequestResponse::Wait(wait) => self.waits.push((ticket, wait)),
                RequestResponse::End => self.ended = true,
            }
        }
        Ok(())
    }

    /// Counts a request at this instant: waits that end at once let no time pass either, so that the count goes on over
    /// them, and starts anew only when time has moved.
    fn count(&mut self, now: Nanos) -> Result<(), HarnessError> {
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

    fn response(&mut self, request: SystemRequest, cx: &mut PlayerContext<'_, '_>) -> RequestResponse {
        match request {
            SystemRequest::Now => RequestResponse::Answer(SystemAnswer::Ok),
            SystemRequest::Done => RequestResponse::End,
            SystemRequest::Sleep { time } => {
                RequestResponse::Wait(RequestWait::Time(cx.now.saturating_add(time)))
            }
            SystemRequest::Emit { event, args } => {
                RequestResponse::Answer(match self.emission(&event, &args) {
                    Ok((event, args)) => {
                        cx.out.push(PlayerMessage::Event { event, args });
                        SystemAnswer::Ok
                    }
                    Err(answer) => answer,
                })
            }
            SystemRequest::WaitFor { events, timeout } => self.wait_for(&events, timeout, cx.now),
            SystemRequest::Drop { events } => RequestResponse::Answer(self.drop_mail(&events)),
            SystemRequest::Read { signal } => {
                RequestResponse::Answer(self.read(&signal, cx.stage.as_deref_mut()))
            }
            SystemRequest::Command(request) => {
                let Some(stage) = cx.stage.as_deref_mut() else {
                    return RequestResponse::Answer(refuse("there is no world to act in", None));
                };
                match stage.command(&request) {
                    Ok(id) => RequestResponse::Wait(RequestWait::Command(id)),
                    Err(NotBegun::Refused { error, help }) => RequestResponse::Answer(refuse(error, help)),
                    Err(NotBegun::Failed(why)) => RequestResponse::Answer(SystemAnswer::Ended(Err(why))),
                }
            }
        }
    }

    fn wait_for(&mut self, names: &[String], timeout: Option<Nanos>, now: Nanos) -> RequestResponse {
        let events = match self.audible(names) {
            Ok(events) => events,
            Err(answer) => return RequestResponse::Answer(answer),
        };
        let at = self.mailbox.iter().position(|m| events.contains(&m.event));
        if let Some(mail) = at.and_then(|at| self.mailbox.remove(at)) {
            return RequestResponse::Answer(self.event_answer(mail));
        }
        let until = timeout.map(|t| now.saturating_add(t));
        RequestResponse::Wait(RequestWait::Events { events, until })
    }

    fn drop_mail(&mut self, names: &[String]) -> SystemAnswer {
        match self.audible(names) {
            Ok(events) => {
                self.mailbox.retain(|m| !(names.is_empty() || events.contains(&m.event)));
                SystemAnswer::Ok
            }
            Err(answer) => answer,
        }
    }

    fn read(&self, name: &str, stage: Option<&mut WorldStage<'_>>) -> SystemAnswer {
        let readable = |s: &&Signal| s.to.contains(&self.actors[0]);
        let found = self.program.signals.iter().zip(0u16..).find(|(s, _)| s.name == name && readable(s));
        match (found, stage) {
            (Some((_, index)), Some(stage)) => SystemAnswer::Value(stage.read(SignalId(index))),
            (Some(_), None) => refuse("there is no world to read signals from", None),
            (None, _) => {
                let known = self.program.signals.iter().filter(readable).map(|s| s.name.as_str());
                refuse(format!("no signal `{name}` that this actor can read"), list("signals", known))
            }
        }
    }

    /// The ids of events that the program can hear.
    fn audible(&self, names: &[String]) -> Result<Vec<EventId>, SystemAnswer> {
        names.iter().map(|name| self.audible_event(name)).collect()
    }

    fn audible_event(&self, name: &str) -> Result<EventId, SystemAnswer> {
        let hears = |id: EventId| {
            is_perceived(self.program, self.actors[0], id) && self.program.event(id).from != self.actors[0]
        };
        match self.program.event_named(name) {
            Some(id) if hears(id) => Ok(id),
            Some(_) | None => {
                let ids = (0u16..).map(EventId).take(self.program.events.len());
                let known = ids.filter(|id| hears(*id)).map(|id| self.program.event(id).name.as_str());
                Err(refuse(format!("no event `{name}` that this actor can hear"), list("events", known)))
            }
        }
    }

    /// The event and its arguments in order, if the program may make it.
    fn emission(
        &self,
        name: &str,
        args: &BTreeMap<String, SystemArgument>,
    ) -> Result<(EventId, Vec<Value>), SystemAnswer> {
        let own = |e: &&Event| e.from == self.actors[0] && !e.is_stimulus();
        let id = self.program.event_named(name).filter(|id| own(&self.program.event(*id)));
        let Some(id) = id else {
            let known = self.program.events.iter().filter(own).map(|e| e.name.as_str());
            return Err(refuse(format!("no event `{name}` that this actor makes"), list("events", known)));
        };
        let params = &self.program.event(id).params;
        if let Some(extra) = args.keys().find(|k| params.iter().all(|p| p.name != **k)) {
            let known = params.iter().map(|p| p.name.as_str());
            return Err(refuse(format!("`{name}` has no argument `{extra}`"), list("arguments", known)));
        }
        let values = params.iter().map(|p| argument(name, p, args.get(&p.name))).collect::<Result<_, _>>()?;
        Ok((id, values))
    }

    fn event_answer(&self, mail: MailboxEvent) -> SystemAnswer {
        let event = self.program.event(mail.event);
        let args = event.params.iter().map(|p| p.name.clone()).zip(mail.args).collect();
        SystemAnswer::Event { name: event.name.clone(), args, time: mail.time }
    }

    /// The answer to an open request, if its time has come.
    fn due(wait: &RequestWait, cx: &mut PlayerContext<'_, '_>) -> Option<SystemAnswer> {
        match wait {
            RequestWait::Time(until) => (*until <= cx.now).then_some(SystemAnswer::Ok),
            RequestWait::Events { until, .. } => {
                (cx.expire && until.is_some_and(|until| until <= cx.now)).then_some(SystemAnswer::TimedOut)
            }
            RequestWait::Command(id) => Some(SystemAnswer::Ended(cx.stage.as_deref_mut()?.take_ended(*id)?)),
        }
    }
}

fn refuse(error: impl Into<String>, help: Option<String>) -> SystemAnswer {
    SystemAnswer::Refused { error: error.into(), help }
}

fn list<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Option<String> {
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| format!("{what} it can use: {}", names.join(", ")))
}

fn argument(event: &str, param: &Parameter, given: Option<&SystemArgument>) -> Result<Value, SystemAnswer> {
    let Some(given) = given else {
        return Err(refuse(format!("`{event}` needs the argument `{}`", param.name), None));
    };
    let value = match (param.ty, given) {
        (Type::Float(_), SystemArgument::Scalar(Value::Int(n))) => Some(Value::Float(*n as f64)),
        (Type::Enum(e), SystemArgument::Text(name)) => e.symbol(name).map(Value::Symbol),
        (
            Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_),
            SystemArgument::Scalar(value),
        ) => Some(*value),
        (
            Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_),
            SystemArgument::Text(_) | SystemArgument::Numbers(_),
        ) => None,
    };
    value.filter(|v| param.ty.admits(*v)).ok_or_else(|| {
        let ty = match param.ty {
            Type::Bool => "a bool".to_owned(),
            Type::Int { lo, hi } => format!("an integer of {lo}..{hi}"),
            Type::Float(_) => "a number".to_owned(),
            Type::Enum(e) => format!("the name of a value of `{e}` ({})", e.listed()),
            // The checker lets no event have these.
            Type::Text => "a string".to_owned(),
            Type::List(_) => "a list".to_owned(),
        };
        refuse(format!("`{event}`: `{}` is {given}, but must be {ty}", param.name), None)
    })
}

impl<S: SystemActor> ActorPlayer for SystemPlayer<'_, S> {
    fn actors(&self) -> &[ActorId] {
        &self.actors
    }

    fn wake(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        let mut at = 0;
        while let Some((ticket, wait)) = self.waits.get(at) {
            let ticket = *ticket;
            match Self::due(wait, cx) {
                Some(answer) => {
                    self.waits.remove(at);
                    self.answer(ticket, cx.now, answer)?;
                }
                None => at += 1,
            }
        }
        self.serve(cx)
    }

    fn hear(
        &mut self,
        event: EventId,
        args: &[Value],
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        let mail = MailboxEvent { event, args: args.to_vec(), time: cx.now };
        let waits_for = |(_, wait): &(RequestTicket, RequestWait)| match wait {
            RequestWait::Events { events, .. } => events.contains(&event),
            RequestWait::Time(_) | RequestWait::Command(_) => false,
        };
        // Of several that wait for it, the one that has waited longest takes it.
        if let Some(at) = self.waits.iter().position(waits_for) {
            let (ticket, _) = self.waits.remove(at);
            let answer = self.event_answer(mail);
            self.answer(ticket, cx.now, answer)?;
            return self.serve(cx);
        }
        if self.mailbox.len() == MAILBOX {
            self.mailbox.pop_front();
        }
        self.mailbox.push_back(mail);
        Ok(())
    }

    fn next_wake(&self) -> Option<Nanos> {
        if self.ended {
            return None;
        }
        let until = |(_, wait): &(RequestTicket, RequestWait)| match wait {
            RequestWait::Time(until) => Some(*until),
            RequestWait::Events { until, .. } => *until,
            RequestWait::Command(_) => None,
        };
        let asks = self.system.is_ready().then_some(0);
        self.waits.iter().filter_map(until).chain(asks).min()
    }

    fn is_finished(&self) -> bool {
        self.ended
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{Enumeration, Symbol, Unit};

    use super::*;

    fn given(ty: Type, arg: SystemArgument) -> Result<Value, String> {
        let param = Parameter { name: "p".into(), ty };
        argument("e", &param, Some(&arg)).map_err(|answer| match answer {
            SystemAnswer::Refused { error, .. } => error,
            other => panic!("{other:?}"),
        })
    }

    fn text(text: &str) -> SystemArgument {
        SystemArgument::Text(text.into())
    }

    fn scalar(value: Value) -> SystemArgument {
        SystemArgument::Scalar(value)
    }

    #[test]
    fn a_symbol_is_given_by_its_name() {
        let pace = Enumeration::intern("Pace", &["slow", "fast"]);
        let ty = Type::Enum(pace);
        assert_eq!(given(ty, text("fast")), Ok(Value::Symbol(Symbol::intern("fast"))));
        let numbers = SystemArgument::Numbers(vec![1.5]);
        let wrong = [text("quick"), text(""), scalar(Value::Int(1)), scalar(Value::Bool(true)), numbers];
        for (wrong, shown) in wrong.into_iter().zip(["\"quick\"", "\"\"", "1", "true", "[1.5]"]) {
            let must = "the name of a value of `Pace` (`slow`, `fast`)";
            assert_eq!(given(ty, wrong), Err(format!("`e`: `p` is {shown}, but must be {must}")));
        }
    }

    #[test]
    fn text_is_no_other_value() {
        let (int, float) = (Type::Int { lo: 0, hi: 4 }, Type::Float(Unit::Metre));
        assert_eq!(given(Type::Bool, scalar(Value::Bool(true))), Ok(Value::Bool(true)));
        assert_eq!(given(int, scalar(Value::Int(4))), Ok(Value::Int(4)));
        assert_eq!(given(float, scalar(Value::Int(4))), Ok(Value::Float(4.0)));
        let error = |ty, arg| given(ty, arg).unwrap_err();
        assert_eq!(error(Type::Bool, text("true")), "`e`: `p` is \"true\", but must be a bool");
        assert_eq!(error(int, text("1")), "`e`: `p` is \"1\", but must be an integer of 0..4");
        assert_eq!(error(int, scalar(Value::Int(5))), "`e`: `p` is 5, but must be an integer of 0..4");
        assert_eq!(error(float, text("nan")), "`e`: `p` is \"nan\", but must be a number");
        assert_eq!(
            error(float, SystemArgument::Numbers(vec![0.5])),
            "`e`: `p` is [0.5], but must be a number"
        );
    }
}
