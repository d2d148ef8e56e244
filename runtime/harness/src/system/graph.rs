//! Who of a system's programs is told what: the topics, services and actions that are open, and the calls under way.
//!
//! The graph decides who gets a message, in which order, and nothing else. Messages are delivered to subscribers in the order in
//! which those opened their ports, which is the same in every run.

use std::collections::BTreeMap;

use super::{
    port::{GoalEnd, MessageText, PortDeclaration, PortKind, PortListing},
    seam::SystemArrival,
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
    /// A latched publisher's last message.
    last: Option<MessageText>,
}

/// A request or goal that has no answer yet.
struct OpenCall {
    client: ProgramIndex,
    /// The client's number for it.
    call: u64,
    server: ProgramIndex,
    server_port: u64,
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
        if declared.kind == PortKind::Subscriber {
            for message in self.at(&declared).filter_map(|p| p.last.clone()) {
                out.push(message_to(program, &declared, message));
            }
        }
        self.ports.push(OpenPort { program, declared, last: None });
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

    /// A program has ended.
    pub fn leave(&mut self, program: ProgramIndex) -> Vec<GraphDelivery> {
        let mine: Vec<u64> =
            self.ports.iter().filter(|p| p.program == program).map(|p| p.declared.port).collect();
        let mut out: Vec<GraphDelivery> =
            mine.into_iter().flat_map(|port| self.close(program, port).unwrap_or_default()).collect();
        self.calls.retain(|_, call| call.client != program);
        self.watchers.retain(|watcher| *watcher != program);
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

    pub fn publish(&mut self, program: ProgramIndex, port: u64, message: &MessageText) -> GraphOutcome {
        let at = self.port(program, port)?;
        let publisher = self.of_kind(at, PortKind::Publisher)?.clone();
        if let Some(own) = self.ports.get_mut(at).filter(|p| p.declared.latched) {
            own.last = Some(message.clone());
        }
        let hears = |p: &&OpenPort| p.declared.kind == PortKind::Subscriber;
        let to = |p: &OpenPort| message_to(p.program, &p.declared, message.clone());
        Ok(self.at(&publisher).filter(hears).map(to).collect())
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
                return Err(format!("the port {port} is a {}, which calls nobody", client.kind));
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
        self.made += 1;
        let id = self.made;
        self.calls.insert(id, OpenCall { client: program, call, server, server_port });
        Ok(vec![told(server, SystemArrival::Called { port: server_port, call: id, message })])
    }

    /// A server answers a call.
    pub fn respond(
        &mut self,
        program: ProgramIndex,
        call: u64,
        answer: Result<MessageText, String>,
    ) -> GraphOutcome {
        let open = self.served(program, call)?;
        let out = told(open.client, SystemArrival::Answered { call: open.call, answer });
        self.calls.remove(&call);
        Ok(vec![out])
    }

    /// A server of actions says how far a goal has come.
    pub fn feedback(&mut self, program: ProgramIndex, call: u64, message: MessageText) -> GraphOutcome {
        let open = self.served(program, call)?;
        Ok(vec![told(open.client, SystemArrival::Feedback { call: open.call, message })])
    }

    /// A server of actions ends a goal.
    pub fn finish(
        &mut self,
        program: ProgramIndex,
        call: u64,
        end: GoalEnd,
        message: MessageText,
    ) -> GraphOutcome {
        let open = self.served(program, call)?;
        let out = told(open.client, SystemArrival::Finished { call: open.call, end, message });
        self.calls.remove(&call);
        Ok(vec![out])
    }

    /// A client wants its goal to end.
    pub fn cancel(&mut self, program: ProgramIndex, call: u64) -> GraphOutcome {
        let found = self.calls.iter().find(|(_, c)| c.client == program && c.call == call);
        // It may have ended just before: that is no mistake of the client.
        let Some((id, open)) = found else { return Ok(Vec::new()) };
        Ok(vec![told(open.server, SystemArrival::Canceled { port: open.server_port, call: *id })])
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
            Some(d) => format!("the port {} is a {}, not a {kind}", d.port, d.kind),
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
