//! The player of the system under test: answers the program's requests, and lets simulated time pass while one waits.

use std::collections::{BTreeMap, VecDeque};

use hrdsl_ir::{
    ActorId, EventId, Nanos, Param, Program, Type, Value,
    value::{nanos, seconds},
    world::GripperId,
};
use hrdsl_sim::{Command, CommandId};
use hrdsl_sut::{Answer, Arg, Process, Reply, Request, SutError};

use super::{Context, Fault, Message, Player, Stage};

/// How many events wait in the program's mailbox at most; the oldest are dropped, as in a ROS subscriber's queue.
const MAILBOX: usize = 1_000;
/// More requests at one instant are a program that never lets time pass.
const REQUESTS_AT_AN_INSTANT: usize = 100_000;

/// What the program did that no program should: the message, and its last output.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct SutFault {
    pub message: String,
    pub kind: SutFaultKind,
}

/// What a fault of the program says about another run of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SutFaultKind {
    /// It would happen again.
    Program,
    /// Wall time ended the run: it may be the machine's load.
    WallTime,
    /// The campaign was interrupted: it says nothing about the program.
    Interrupted,
}

impl From<SutError> for SutFault {
    fn from(error: SutError) -> Self {
        let kind = match &error {
            SutError::Overrun { overrun, .. } if overrun.is_of_wall_time() => SutFaultKind::WallTime,
            SutError::Stopped { .. } => SutFaultKind::Interrupted,
            SutError::Overrun { .. }
            | SutError::Absent { .. }
            | SutError::Exited { .. }
            | SutError::Rubbish { .. }
            | SutError::Environment { .. }
            | SutError::Io { .. } => SutFaultKind::Program,
        };
        Self { message: error.to_string(), kind }
    }
}

/// Plays the system actor by a running process.
pub struct ProgramPlayer<'p, 'r> {
    program: &'p Program,
    actors: [ActorId; 1],
    process: &'r mut Process,
    waits: Waits,
    mailbox: VecDeque<Mail>,
    /// How many requests the program has made at the instant at which it made the last.
    at_instant: (Nanos, usize),
}

struct Mail {
    event: EventId,
    args: Vec<Value>,
    time: Nanos,
}

/// What the program's last request waits for.
enum Waits {
    /// Nothing: it is the program's turn.
    No,
    Time(Nanos),
    Events {
        events: Vec<EventId>,
        until: Option<Nanos>,
    },
    Command {
        id: CommandId,
        confirm: Option<Confirm>,
    },
    /// It has come to its end.
    Ended,
}

/// What a gripper's sensor must say for its action to have succeeded.
#[derive(Clone, Copy)]
struct Confirm {
    gripper: GripperId,
    holds: bool,
}

impl<'p, 'r> ProgramPlayer<'p, 'r> {
    #[must_use]
    pub fn new(program: &'p Program, actor: ActorId, process: &'r mut Process) -> Self {
        Self {
            program,
            actors: [actor],
            process,
            waits: Waits::No,
            mailbox: VecDeque::new(),
            at_instant: (0, 0),
        }
    }

    fn reply(&mut self, now: Nanos, answer: Answer) -> Result<(), Fault> {
        self.waits = Waits::No;
        self.process.reply(&Reply { time: now, answer }).map_err(|e| Fault::System(e.into()))
    }

    /// Answers requests until one waits.
    fn serve(&mut self, cx: &mut Context<'_>) -> Result<(), Fault> {
        while matches!(self.waits, Waits::No) {
            let request = self.process.next().map_err(|e| Fault::System(e.into()))?;
            self.count(cx.now)?;
            let Some(answer) = self.answer(request, cx) else { continue };
            self.reply(cx.now, answer)?;
        }
        Ok(())
    }

    /// Counts a request at this instant: waits that end at once let no time pass either, so that the count goes on over
    /// them, and starts anew only when time has moved.
    fn count(&mut self, now: Nanos) -> Result<(), Fault> {
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
        Err(Fault::System(SutFault { message, kind: SutFaultKind::Program }))
    }

    /// The answer, or `None` if the request waits.
    fn answer(&mut self, request: Request, cx: &mut Context<'_>) -> Option<Answer> {
        match request {
            Request::Hello { .. } | Request::Now => Some(Answer::Ok),
            Request::Done => {
                self.waits = Waits::Ended;
                None
            }
            Request::Sleep { seconds } => {
                self.waits = Waits::Time(cx.now.saturating_add(nanos(seconds)));
                None
            }
            Request::Emit { event, args } => Some(match self.emission(&event, &args) {
                Ok((event, args)) => {
                    cx.out.push(Message::Event { event, args });
                    Answer::Ok
                }
                Err(answer) => answer,
            }),
            Request::WaitFor { events, timeout } => self.wait_for(&events, timeout, cx.now),
            Request::Drop { events } => Some(self.drop_mail(&events)),
            Request::Read { signal } => Some(self.read(&signal, cx.stage.as_deref_mut())),
            Request::Act { on, action, args, .. } => {
                let stage = cx.stage.as_deref_mut();
                match begin(stage, &on, &action, &args) {
                    Ok((id, confirm)) => {
                        self.waits = Waits::Command { id, confirm };
                        None
                    }
                    Err(answer) => Some(answer),
                }
            }
        }
    }

    fn wait_for(&mut self, names: &[String], timeout: Option<f64>, now: Nanos) -> Option<Answer> {
        let events = match self.audible(names) {
            Ok(events) => events,
            Err(answer) => return Some(answer),
        };
        if let Some(at) = self.mailbox.iter().position(|m| events.contains(&m.event)) {
            return self.mailbox.remove(at).map(|mail| self.event_answer(mail));
        }
        let until = timeout.map(|t| now.saturating_add(nanos(t)));
        self.waits = Waits::Events { events, until };
        None
    }

    fn drop_mail(&mut self, names: &[String]) -> Answer {
        match self.audible(names) {
            Ok(events) => {
                self.mailbox.retain(|m| !(names.is_empty() || events.contains(&m.event)));
                Answer::Ok
            }
            Err(answer) => answer,
        }
    }

    fn read(&self, name: &str, stage: Option<&mut Stage>) -> Answer {
        let readable = |s: &&hrdsl_ir::world::Signal| s.to.contains(&self.actors[0]);
        let found = self.program.signals.iter().zip(0u16..).find(|(s, _)| s.name == name && readable(s));
        match (found, stage) {
            (Some((_, index)), Some(stage)) => Answer::Value(stage.read(hrdsl_ir::world::SignalId(index))),
            (Some(_), None) => refuse("there is no world to read signals from", None),
            (None, _) => {
                let known = self.program.signals.iter().filter(readable).map(|s| s.name.as_str());
                refuse(format!("no signal `{name}` that this actor can read"), list("signals", known))
            }
        }
    }

    /// The ids of events that the program can hear.
    fn audible(&self, names: &[String]) -> Result<Vec<EventId>, Answer> {
        names.iter().map(|name| self.audible_event(name)).collect()
    }

    fn audible_event(&self, name: &str) -> Result<EventId, Answer> {
        let hears = |id: EventId| {
            super::is_perceived(self.program, self.actors[0], id)
                && self.program.event(id).from != self.actors[0]
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
    fn emission(&self, name: &str, args: &BTreeMap<String, Arg>) -> Result<(EventId, Vec<Value>), Answer> {
        let own = |e: &&hrdsl_ir::Event| e.from == self.actors[0] && !e.is_stimulus();
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

    fn event_answer(&self, mail: Mail) -> Answer {
        let event = self.program.event(mail.event);
        let args = event.params.iter().map(|p| p.name.clone()).zip(mail.args).collect();
        Answer::Event { name: event.name.clone(), args, time: mail.time }
    }

    /// The answer to the request that waits, if its time has come.
    fn due(&mut self, cx: &mut Context<'_>) -> Option<Answer> {
        match &self.waits {
            Waits::No | Waits::Ended => None,
            Waits::Time(until) => (*until <= cx.now).then_some(Answer::Ok),
            Waits::Events { until, .. } => {
                (cx.expire && until.is_some_and(|until| until <= cx.now)).then_some(Answer::TimedOut)
            }
            Waits::Command { id, confirm } => {
                let stage = cx.stage.as_deref_mut()?;
                let ended = stage.take_finished(*id)?.map_err(|e| e.to_string());
                Some(Answer::Acted(ended.and_then(|()| confirmed(stage, *confirm))))
            }
        }
    }
}

fn refuse(error: impl Into<String>, help: Option<String>) -> Answer {
    Answer::Error { error: error.into(), help }
}

fn list<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Option<String> {
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| format!("{what} it can use: {}", names.join(", ")))
}

fn argument(event: &str, param: &Param, given: Option<&Arg>) -> Result<Value, Answer> {
    let Some(given) = given else {
        return Err(refuse(format!("`{event}` needs the argument `{}`", param.name), None));
    };
    let value = match (param.ty, given) {
        (Type::Float(_), Arg::Scalar(Value::Int(n))) => Some(Value::Float(*n as f64)),
        (Type::Enum(e), Arg::Text(name)) => e.symbol(name).map(Value::Symbol),
        (
            Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_),
            Arg::Scalar(value),
        ) => Some(*value),
        (
            Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_),
            Arg::Text(_) | Arg::Numbers(_),
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

/// Whether the gripper holds something, or nothing, as it should.
fn confirmed(stage: &Stage, confirm: Option<Confirm>) -> Result<(), String> {
    let Some(Confirm { gripper, holds }) = confirm else { return Ok(()) };
    match (holds, stage.sim().holding(gripper).is_some()) {
        (true, false) => Err("the gripper closed on nothing".to_owned()),
        (false, true) => Err("the gripper still holds something".to_owned()),
        (true, true) | (false, false) => Ok(()),
    }
}

/// Starts what a device is told to do.
fn begin(
    stage: Option<&mut Stage>,
    on: &str,
    action: &str,
    args: &BTreeMap<String, Arg>,
) -> Result<(CommandId, Option<Confirm>), Answer> {
    let Some(stage) = stage else { return Err(refuse("there is no world to act in", None)) };
    let numbers = |name: &str| match args.get(name) {
        Some(Arg::Numbers(v)) => Ok(v.clone()),
        Some(Arg::Scalar(_) | Arg::Text(_)) | None => {
            Err(refuse(format!("`{action}` needs `{name}`, a list of numbers"), None))
        }
    };
    let speed = match args.get("speed") {
        Some(Arg::Scalar(v)) => v.as_f64(),
        Some(Arg::Numbers(_) | Arg::Text(_)) | None => None,
    };
    let command = match (stage.sim().arm_named(on), stage.sim().gripper_named(on), action) {
        (Some(arm), _, "move_to") => match numbers("to")?.as_slice() {
            [x, y, z] => Command::MoveTo { arm, target: [*x, *y, *z], max_speed: speed },
            _ => return Err(refuse("`move_to` needs `to` with x, y and z in metres", None)),
        },
        (Some(arm), _, "move_joints") => {
            Command::MoveJoints { arm, positions: numbers("to")?, max_speed: speed }
        }
        (None, Some(gripper), "close") => Command::Close { gripper },
        (None, Some(gripper), "open") => Command::Open { gripper },
        (None, None, _) => return Err(refuse(format!("the world has no arm or gripper `{on}`"), None)),
        (Some(_), _, _) => {
            let help = Some("an arm can move_to, move_joints".to_owned());
            return Err(refuse(format!("`{on}` cannot `{action}`"), help));
        }
        (None, Some(_), _) => {
            let help = Some("a gripper can open, close".to_owned());
            return Err(refuse(format!("`{on}` cannot `{action}`"), help));
        }
    };
    let confirm = match &command {
        Command::Close { gripper } => Some(Confirm { gripper: *gripper, holds: true }),
        Command::Open { gripper } => Some(Confirm { gripper: *gripper, holds: false }),
        Command::MoveTo { .. } | Command::MoveJoints { .. } => None,
    };
    let id = stage.command(command).map_err(|e| Answer::Acted(Err(e.to_string())))?;
    Ok((id, confirm))
}

impl Player for ProgramPlayer<'_, '_> {
    fn actors(&self) -> &[ActorId] {
        &self.actors
    }

    fn wake(&mut self, cx: &mut Context<'_>) -> Result<(), Fault> {
        if let Some(answer) = self.due(cx) {
            self.reply(cx.now, answer)?;
        }
        self.serve(cx)
    }

    fn hear(&mut self, event: EventId, args: &[Value], cx: &mut Context<'_>) -> Result<(), Fault> {
        let mail = Mail { event, args: args.to_vec(), time: cx.now };
        if let Waits::Events { events, .. } = &self.waits
            && events.contains(&event)
        {
            let answer = self.event_answer(mail);
            self.reply(cx.now, answer)?;
            return self.serve(cx);
        }
        if self.mailbox.len() == MAILBOX {
            self.mailbox.pop_front();
        }
        self.mailbox.push_back(mail);
        Ok(())
    }

    fn next_wake(&self) -> Option<Nanos> {
        match &self.waits {
            Waits::No => Some(0),
            Waits::Time(until) => Some(*until),
            Waits::Events { until, .. } => *until,
            Waits::Command { .. } | Waits::Ended => None,
        }
    }

    fn is_finished(&self) -> bool {
        matches!(self.waits, Waits::Ended)
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{Enumeration, Symbol, Unit};

    use super::*;

    fn given(ty: Type, arg: &str) -> Result<Value, String> {
        let param = Param { name: "p".into(), ty };
        let arg: Arg = serde_json::from_str(arg).unwrap();
        argument("e", &param, Some(&arg)).map_err(|answer| match answer {
            Answer::Error { error, .. } => error,
            other => panic!("{other:?}"),
        })
    }

    #[test]
    fn a_symbol_is_given_by_its_name() {
        let pace = Enumeration::intern("Pace", &["slow", "fast"]);
        let ty = Type::Enum(pace);
        let fast = Value::Symbol(Symbol::intern("fast"));
        assert_eq!(given(ty, "\"fast\""), Ok(fast));
        // What goes out comes in again.
        assert_eq!(given(ty, &serde_json::to_string(&fast).unwrap()), Ok(fast));
        for wrong in ["\"quick\"", "\"\"", "1", "true", "[1.0]"] {
            let must = "the name of a value of `Pace` (`slow`, `fast`)";
            assert_eq!(given(ty, wrong), Err(format!("`e`: `p` is {wrong}, but must be {must}")));
        }
    }

    #[test]
    fn text_is_no_other_value() {
        let (int, float) = (Type::Int { lo: 0, hi: 4 }, Type::Float(Unit::Metre));
        assert_eq!(given(Type::Bool, "true"), Ok(Value::Bool(true)));
        assert_eq!(given(int, "4"), Ok(Value::Int(4)));
        assert_eq!(given(float, "4"), Ok(Value::Float(4.0)));
        let error = |ty, arg| given(ty, arg).unwrap_err();
        assert_eq!(error(Type::Bool, "\"true\""), "`e`: `p` is \"true\", but must be a bool");
        assert_eq!(error(int, "\"1\""), "`e`: `p` is \"1\", but must be an integer of 0..4");
        assert_eq!(error(int, "5"), "`e`: `p` is 5, but must be an integer of 0..4");
        assert_eq!(error(float, "\"nan\""), "`e`: `p` is \"nan\", but must be a number");
        assert_eq!(error(float, "[0.5]"), "`e`: `p` is [0.5], but must be a number");
    }
}
