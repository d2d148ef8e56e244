//! Who of a system's programs is told what: the topics, services and actions that are open, and the calls under way.
//!
//! The graph decides who gets a message, in which order, and nothing else. Messages are delivered to subscribers in the order in
//! which those opened their ports, which is the same in every run.

use std::collections::{BTreeMap, VecDeque};

use hrdsl_ir::Nanos;

use super::{
    history::GraphHistory,
    seam::{CanceledGoals, SystemArrival},
};
use crate::{
    log::LogRecord,
    port::{
        AwaitedPort, GoalEnd, MessageText, PortDeclaration, PortHistory, PortKind, PortListing,
        QosDurability, QosPolicy,
    },
    said::{MessagePart, SaidHistory, SaidRecorder},
};

/// A program may have so many ports open, and so many calls under way.
const MOST: usize = 10_000;

/// A program of the system, by its place.
pub(super) type ProgramIndex = usize;

/// Something for a program's mailbox.
#[derive(Debug, PartialEq)]
pub(super) struct GraphDelivery {
    pub to: ProgramIndex,
    pub arrival: SystemArrival,
    /// At most so many messages of this port wait there.
    pub depth: usize,
}

struct OpenPort {
    program: ProgramIndex,
    declared: PortDeclaration,
    /// A publisher's last messages, for those who subscribe later.
    kept: VecDeque<MessageText>,
}

/// A request or goal that has no answer yet.
struct OpenCall {
    client: ProgramIndex,
    /// The client's number for it.
    call: u64,
    server: ProgramIndex,
    server_port: u64,
    /// Of a goal: how the server and its client get on; `None`: it asks a service.
    goal: Option<OpenGoal>,
}

/// What has been said of a goal.
#[derive(Clone, Copy, Default)]
struct OpenGoal {
    accepted: bool,
    /// So many requests to cancel it have no answer.
    cancels: usize,
}

/// The ports of all programs, in the order in which they were opened.
#[derive(Default)]
pub(super) struct MessageGraph {
    ports: Vec<OpenPort>,
    /// By the number that the server knows a call by.
    calls: BTreeMap<u64, OpenCall>,
    made: u64,
    /// Programs that are to be told of the next change.
    watchers: Vec<ProgramIndex>,
    history: GraphHistory,
    recorder: Option<SaidRecorder>,
    /// The place behind the programs: what is sent from there, the scenario says.
    outside: ProgramIndex,
}

/// What a request does to others; or why it makes no sense.
pub(super) type GraphOutcome = Result<Vec<GraphDelivery>, String>;

impl MessageGraph {
    /// A program opens a port.
    pub fn open(&mut self, program: ProgramIndex, declared: PortDeclaration) -> GraphOutcome {
        if self.port(program, declared.port).is_ok() {
            return Err(format!("the port {} is open already", declared.port));
        }
        if self.ports.iter().filter(|p| p.program == program).count() >= MOST {
            return Err(format!("more than {MOST} ports are open"));
        }
        if let Some(other) = self.at(&declared).find(|p| p.declared.type_name != declared.type_name) {
            let (sort, name) = (declared.kind.sort(), &declared.name);
            let (is, given) = (&other.declared.type_name, &declared.type_name);
            return Err(format!("the {sort} `{name}` is of type `{is}`, not `{given}`"));
        }
        let serves = matches!(declared.kind, PortKind::Server | PortKind::ActionServer);
        if serves && self.at(&declared).any(|p| p.declared.kind == declared.kind) {
            return Err(format!("the {} `{}` has a server already", declared.kind.sort(), declared.name));
        }
        let mut out = self.changed();
        for other in self.at(&declared) {
            if let Some(policy) = misfit(&declared, &other.declared) {
                for (to, port) in [(program, declared.port), (other.program, other.declared.port)] {
                    out.push(told(to, SystemArrival::Incompatible { port, policy }));
                }
            } else if declared.kind == PortKind::Subscriber
                && declared.qos.durability != Some(QosDurability::Volatile)
            {
                let old = other.kept.iter().skip(other.kept.len().saturating_sub(declared.depth.max(1)));
                out.extend(old.map(|message| message_to(program, &declared, message.clone())));
            }
        }
        self.history.opened(program, &declared);
        self.ports.push(OpenPort { program, declared, kept: VecDeque::new() });
        Ok(out)
    }

    /// A program closes a port; calls that wait for its server fail.
    pub fn close(&mut self, program: ProgramIndex, port: u64) -> GraphOutcome {
        let at = self.ports.iter().position(|p| p.program == program && p.declared.port == port);
        let closed = self.ports.remove(at.ok_or_else(|| no_port(port))?);
        let mut out = self.changed();
        let (name, sort) = (closed.declared.name, closed.declared.kind.sort());
        out.extend(self.fail(&format!("the server of the {sort} `{name}` has gone"), |call| {
            call.server == program && call.server_port == port
        }));
        Ok(out)
    }

    /// A program has ended. Its calls stay open: what is answered later reaches nobody, which is no fault of the server's.
    pub fn leave(&mut self, program: ProgramIndex) -> Vec<GraphDelivery> {
        let mine: Vec<u64> =
            self.ports.iter().filter(|p| p.program == program).map(|p| p.declared.port).collect();
        let mut out: Vec<GraphDelivery> =
            mine.into_iter().flat_map(|port| self.close(program, port).unwrap_or_default()).collect();
        self.watchers.retain(|watcher| *watcher != program);
        self.history.left(program);
        out.retain(|delivery| delivery.to != program);
        out
    }

    /// What is open; the program is told of the next change.
    pub fn watch(&mut self, program: ProgramIndex, names: &[String]) -> Vec<PortListing> {
        if !self.watchers.contains(&program) {
            self.watchers.push(program);
        }
        let listing = |p: &OpenPort| PortListing {
            kind: p.declared.kind,
            name: p.declared.name.clone(),
            type_name: p.declared.type_name.clone(),
            program: names.get(p.program).cloned().unwrap_or_default(),
        };
        self.ports.iter().map(listing).collect()
    }

    /// A program waits until somebody is there.
    pub fn await_port(&mut self, program: ProgramIndex, awaited: AwaitedPort, now: Nanos) {
        self.history.awaited(program, awaited, now);
    }

    /// From now on, what is said is written down. The programs are those before this place.
    pub fn write_down(&mut self, programs: ProgramIndex) {
        (self.recorder, self.outside) = (Some(SaidRecorder::default()), programs);
    }

    /// It is this time now.
    pub fn goes_on(&mut self, now: Nanos) {
        if let Some(recorder) = &mut self.recorder {
            recorder.now = now;
        }
    }

    pub fn logged(&mut self, program: &str, record: &LogRecord) {
        if let Some(recorder) = &mut self.recorder {
            recorder.logged(program, record);
        }
    }

    /// What was written down.
    pub fn said(&self) -> SaidHistory {
        self.recorder.as_ref().map(SaidRecorder::history).unwrap_or_default()
    }

    /// What was open in the whole run that ends now.
    pub fn history(&self, names: &[String], end: Nanos) -> PortHistory {
        self.history.told(names, end)
    }

    pub fn publish(&mut self, program: ProgramIndex, port: u64, message: &MessageText) -> GraphOutcome {
        let at = self.port(program, port)?;
        let publisher = self.of_kind(at, PortKind::Publisher)?.clone();
        if let Some(recorder) = &mut self.recorder {
            recorder.sent(&publisher, program < self.outside, MessagePart::Message, message);
        }
        if let Some(own) = self.ports.get_mut(at).filter(|p| p.declared.kept > 0) {
            own.kept.push_back(message.clone());
            if own.kept.len() > own.declared.kept {
                own.kept.pop_front();
            }
        }
        let hears = |p: &&OpenPort| {
            p.declared.kind == PortKind::Subscriber && publisher.qos.lacks(p.declared.qos).is_none()
        };
        let to = |p: &OpenPort| message_to(p.program, &p.declared, message.clone());
        Ok(self.at(&publisher).filter(hears).map(to).collect())
    }

    /// Whether something of this sort is open at a name.
    pub fn has(&self, name: &str, sort: &str) -> bool {
        self.ports.iter().any(|p| p.declared.name == name && p.declared.kind.sort() == sort)
    }

    /// Whether anybody subscribes to the topic of a publisher.
    pub fn has_subscriber(&self, program: ProgramIndex, port: u64) -> bool {
        let own = self.port(program, port).ok().and_then(|at| self.ports.get(at));
        own.is_some_and(|own| self.at(&own.declared).any(|p| p.declared.kind == PortKind::Subscriber))
    }

    /// A request of a service, or the goal of an action.
    pub fn call(
        &mut self,
        program: ProgramIndex,
        port: u64,
        call: u64,
        message: MessageText,
    ) -> GraphOutcome {
        let at = self.port(program, port)?;
        let client = self.ports.get(at).map(|p| p.declared.clone()).ok_or_else(|| no_port(port))?;
        let wanted = match client.kind {
            PortKind::Client => PortKind::Server,
            PortKind::ActionClient => PortKind::ActionServer,
            PortKind::Publisher | PortKind::Subscriber | PortKind::Server | PortKind::ActionServer => {
                return Err(format!("the port {port} is {}, which calls nobody", client.kind.noun()));
            }
        };
        if self.calls.values().filter(|c| c.client == program).count() >= MOST {
            return Err(format!("more than {MOST} calls are under way"));
        }
        if self.calls.values().any(|c| c.client == program && c.call == call) {
            return Err(format!("the call {call} is under way already"));
        }
        let found = self.at(&client).find(|p| p.declared.kind == wanted);
        let Some((server, server_port)) = found.map(|p| (p.program, p.declared.port)) else {
            let why = format!("the {} `{}` has no server", client.kind.sort(), client.name);
            return Ok(vec![told(program, SystemArrival::Answered { call, answer: Err(why) })]);
        };
        if let Some(recorder) = &mut self.recorder {
            recorder.sent(&client, program < self.outside, MessagePart::Request, &message);
        }
        self.made += 1;
        let id = self.made;
        let goal = (wanted == PortKind::ActionServer).then(OpenGoal::default);
        self.calls.insert(id, OpenCall { client: program, call, server, server_port, goal });
        Ok(vec![told(server, SystemArrival::Called { port: server_port, call: id, message })])
    }

    /// A server answers a call.
    pub fn respond(
        &mut self,
        program: ProgramIndex,
        call: u64,
        answer: Result<MessageText, String>,
    ) -> GraphOutcome {
        self.say(program, call, MessagePart::Answer, || match &answer {
            Ok(message) => message.clone(),
            Err(why) => format!("no answer: {why}").into(),
        });
        let open = self.served(program, call)?;
        let out = told(open.client, SystemArrival::Answered { call: open.call, answer });
        self.calls.remove(&call);
        Ok(vec![out])
    }

    /// A server of actions takes a goal on.
    pub fn accept(&mut self, program: ProgramIndex, call: u64, text: String) -> GraphOutcome {
        let (client, number, goal) = self.goal(program, call)?;
        if std::mem::replace(&mut goal.accepted, true) {
            return Err(format!("the goal {call} was accepted before"));
        }
        Ok(vec![told(client, SystemArrival::Accepted { call: number, text })])
    }

    /// It says how far a goal has come.
    pub fn feedback(&mut self, program: ProgramIndex, call: u64, message: MessageText) -> GraphOutcome {
        let (client, number, _) = self.goal(program, call)?;
        self.say(program, call, MessagePart::Feedback, || message.clone());
        Ok(vec![told(client, SystemArrival::Feedback { call: number, message })])
    }

    /// It says whether it will cancel a goal.
    pub fn answer_cancel(
        &mut self,
        program: ProgramIndex,
        call: u64,
        granted: bool,
        text: String,
    ) -> GraphOutcome {
        let (client, number, goal) = self.goal(program, call)?;
        goal.cancels =
            goal.cancels.checked_sub(1).ok_or_else(|| format!("nobody asks to cancel the goal {call}"))?;
        Ok(vec![told(client, SystemArrival::CancelAnswered { call: number, granted, text })])
    }

    /// It ends a goal.
    pub fn finish(
        &mut self,
        program: ProgramIndex,
        call: u64,
        end: GoalEnd,
        (message, text): (MessageText, String),
    ) -> GraphOutcome {
        let (client, number, _) = self.goal(program, call)?;
        self.say(program, call, MessagePart::Answer, || format!("{}: {message}", end.word()).into());
        self.calls.remove(&call);
        Ok(vec![told(client, SystemArrival::Finished { call: number, end, message, text })])
    }

    /// A client wants goals to end. That there is none is no mistake: it may have ended just before.
    pub fn cancel(&mut self, program: ProgramIndex, which: CanceledGoals) -> GraphOutcome {
        let server = match which {
            CanceledGoals::Own(_) => None,
            CanceledGoals::AllAt(port) => {
                let client = self.of_kind(self.port(program, port)?, PortKind::ActionClient)?;
                let server = self.at(client).find(|p| p.declared.kind == PortKind::ActionServer);
                Some(server.map(|p| (p.program, p.declared.port)))
            }
        };
        let is_meant = |open: &OpenCall| match (which, server) {
            (CanceledGoals::Own(call), _) => open.client == program && open.call == call,
            (CanceledGoals::AllAt(_), server) => server == Some(Some((open.server, open.server_port))),
        };
        let mut out = Vec::new();
        for (id, open) in self.calls.iter_mut().filter(|(_, open)| is_meant(open)) {
            let Some(goal) = &mut open.goal else {
                return Err(format!("the call {} asks a service, which cannot be canceled", open.call));
            };
            goal.cancels += 1;
            out.push(told(open.server, SystemArrival::Canceled { port: open.server_port, call: *id }));
        }
        Ok(out)
    }

    /// Writes down what a server says about a call, if somebody asks for that.
    fn say(
        &mut self,
        program: ProgramIndex,
        call: u64,
        part: MessagePart,
        message: impl FnOnce() -> MessageText,
    ) {
        let Some(recorder) = &mut self.recorder else { return };
        let Some(open) = self.calls.get(&call).filter(|open| open.server == program) else { return };
        let is_server = |p: &&OpenPort| p.program == program && p.declared.port == open.server_port;
        if let Some(server) = self.ports.iter().find(is_server) {
            recorder.sent(&server.declared, program < self.outside, part, &message());
        }
    }

    // ── what is there ──

    fn port(&self, program: ProgramIndex, port: u64) -> Result<usize, String> {
        let is = |p: &OpenPort| p.program == program && p.declared.port == port;
        self.ports.iter().position(is).ok_or_else(|| no_port(port))
    }

    fn of_kind(&self, at: usize, kind: PortKind) -> Result<&PortDeclaration, String> {
        let declared = self.ports.get(at).map(|p| &p.declared);
        let fits = declared.filter(|d| d.kind == kind);
        fits.ok_or_else(|| match declared {
            Some(d) => format!("the port {} is {}, not {}", d.port, d.kind.noun(), kind.noun()),
            None => "no such port".to_owned(),
        })
    }

    /// The ports at the same name of the same sort.
    fn at<'g>(&'g self, declared: &'g PortDeclaration) -> impl Iterator<Item = &'g OpenPort> {
        let sort = declared.kind.sort();
        self.ports.iter().filter(move |p| p.declared.name == declared.name && p.declared.kind.sort() == sort)
    }

    fn served(&self, program: ProgramIndex, call: u64) -> Result<&OpenCall, String> {
        let own = self.calls.get(&call).filter(|c| c.server == program);
        own.ok_or_else(|| format!("there is no call {call} to answer"))
    }

    /// A goal that a program serves, with its client and the client's number for it.
    fn goal(
        &mut self,
        program: ProgramIndex,
        call: u64,
    ) -> Result<(ProgramIndex, u64, &mut OpenGoal), String> {
        self.served(program, call)?;
        let goal = self.calls.get_mut(&call).and_then(|c| Some((c.client, c.call, c.goal.as_mut()?)));
        goal.ok_or_else(|| format!("the call {call} asks a service, and is no goal"))
    }

    fn fail(&mut self, why: &str, which: impl Fn(&OpenCall) -> bool) -> Vec<GraphDelivery> {
        let gone: Vec<u64> = self.calls.iter().filter(|(_, c)| which(c)).map(|(id, _)| *id).collect();
        let ended = |id: u64| {
            let call = self.calls.remove(&id)?;
            let answer = Err(why.to_owned());
            Some(told(call.client, SystemArrival::Answered { call: call.call, answer }))
        };
        gone.into_iter().filter_map(ended).collect()
    }

    fn changed(&mut self) -> Vec<GraphDelivery> {
        std::mem::take(&mut self.watchers).into_iter().map(|to| told(to, SystemArrival::Changed)).collect()
    }
}

/// Why nothing passes between two ports of a topic, if one publishes and the other subscribes.
fn misfit(a: &PortDeclaration, b: &PortDeclaration) -> Option<QosPolicy> {
    match (a.kind, b.kind) {
        (PortKind::Publisher, PortKind::Subscriber) => a.qos.lacks(b.qos),
        (PortKind::Subscriber, PortKind::Publisher) => b.qos.lacks(a.qos),
        _ => None,
    }
}

fn no_port(port: u64) -> String {
    format!("no port {port} is open")
}

fn told(to: ProgramIndex, arrival: SystemArrival) -> GraphDelivery {
    GraphDelivery { to, arrival, depth: usize::MAX }
}

fn message_to(to: ProgramIndex, subscriber: &PortDeclaration, message: MessageText) -> GraphDelivery {
    let arrival = SystemArrival::Message { port: subscriber.port, message };
    GraphDelivery { to, arrival, depth: subscriber.depth.max(1) }
}
