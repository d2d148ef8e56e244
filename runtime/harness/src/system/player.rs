//! The player of the system actor: answers what its programs ask, lets time pass while they wait, and carries their messages.

use std::collections::{BTreeMap, VecDeque};

use hrdsl_ir::{ActorId, EventId, Nanos, Program, Value, binding::MiddlewareBinding};
use hrdsl_trace::{MachineDeclaration, MachineStep};

use super::{
    binding::{BindingFault, BindingNode, BindingOutcome},
    graph::{GraphDelivery, GraphOutcome, MessageGraph, ProgramIndex},
    mailbox::HeardEvent,
    parameters::ParameterTree,
    program::{RequestWait, ServedProgram},
    seam::{CallRequest, PlanForm, RequestTicket, SystemActor, SystemAnswer, SystemRequest},
    vocabulary::{ActorVocabulary, refuse},
};
use crate::{
    argument::SystemArgument,
    command::{CommandRequest, NotBegun},
    fault::SystemFault,
    log::SystemLog,
    message::PlayerMessage,
    player::{ActorPlayer, HarnessError, PlayerContext},
    port::{PortDeclaration, PortHistory},
    said::SaidHistory,
    stage::WorldStage,
    world::{CommandId, PlannedTrajectory},
};

/// Plays the system actor by its programs, each a [`SystemActor`].
///
/// At one instant they are served in the order in which they are given, each until it waits; then again from the first, until all
/// of them wait.
pub struct SystemPlayer<'p, S> {
    vocabulary: ActorVocabulary<'p>,
    actors: [ActorId; 1],
    programs: Vec<ServedProgram<S>>,
    graph: MessageGraph,
    binding: Option<BindingNode<'p>>,
    parameters: ParameterTree,
    /// Why not all of the binding's parameters could be set.
    wrong: Option<String>,
    log: SystemLog,
    begun: bool,
    now: Nanos,
}

/// What a request comes to at once.
enum RequestResponse {
    Answer(SystemAnswer),
    Wait(RequestWait),
    End,
}

impl<'p, S: SystemActor> SystemPlayer<'p, S> {
    /// One program.
    #[must_use]
    pub fn new(program: &'p Program, actor: ActorId, system: S) -> Self {
        Self::of_programs(program, actor, [(program.actor(actor).name.clone(), system)])
    }

    /// Several, each with its name.
    #[must_use]
    pub fn of_programs(
        program: &'p Program,
        actor: ActorId,
        programs: impl IntoIterator<Item = (String, S)>,
    ) -> Self {
        Self {
            vocabulary: ActorVocabulary { program, actor },
            actors: [actor],
            programs: programs.into_iter().map(|(name, system)| ServedProgram::new(name, system)).collect(),
            graph: MessageGraph::default(),
            binding: None,
            parameters: ParameterTree::default(),
            wrong: None,
            log: SystemLog::default(),
            begun: false,
            now: 0,
        }
    }

    /// The same, where the scenario takes part in what the programs say to each other.
    #[must_use]
    pub fn with_binding(mut self, binding: Option<&'p MiddlewareBinding>) -> Self {
        let node = self.programs.len();
        for (name, value) in binding.iter().flat_map(|b| &b.parameters) {
            self.wrong = self.wrong.or(self.parameters.set(name, value).err());
        }
        self.binding = binding.map(|b| BindingNode::new(self.vocabulary.program, b, node));
        self
    }

    /// The same, with what the programs say written down, to be looked at.
    #[must_use]
    pub fn writing_down(mut self) -> Self {
        self.graph.write_down(self.programs.len());
        self
    }

    /// Takes requests for as long as somebody makes some.
    fn serve(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        let mut asked = true;
        while asked {
            asked = false;
            for index in 0..self.programs.len() {
                while let Some((ticket, request)) = self.next_request(index, cx.now)? {
                    asked = true;
                    self.take(index, ticket, request, cx).map_err(|e| self.named(index, e))?;
                }
            }
        }
        Ok(())
    }

    fn next_request(
        &mut self,
        index: ProgramIndex,
        now: Nanos,
    ) -> Result<Option<(RequestTicket, SystemRequest)>, HarnessError> {
        let program = &mut self.programs[index];
        if program.ended || !program.system.is_ready() {
            return Ok(None);
        }
        let asked = program.system.next(now).map_err(HarnessError::System);
        asked.map_err(|e| self.named(index, e))
    }

    /// Of several programs it is said which one.
    fn named(&self, index: ProgramIndex, error: HarnessError) -> HarnessError {
        match error {
            HarnessError::System(SystemFault { message, kind }) if self.programs.len() > 1 => {
                let message = format!("program `{}`: {message}", self.programs[index].name);
                HarnessError::System(SystemFault { message, kind })
            }
            HarnessError::System(_)
            | HarnessError::Model(_)
            | HarnessError::World(_)
            | HarnessError::Internal(_) => error,
        }
    }

    fn take(
        &mut self,
        index: ProgramIndex,
        ticket: RequestTicket,
        request: SystemRequest,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        self.programs[index].count(cx.now)?;
        match self.response(index, request, cx)? {
            RequestResponse::Answer(answer) => self.programs[index].answer(ticket, cx.now, answer),
            RequestResponse::Wait(wait) => self.programs[index].wait(ticket, wait, &self.vocabulary, cx.now),
            RequestResponse::End => {
                self.programs[index].ended = true;
                let told = self.graph.leave(index);
                self.deliver(told, cx).map(drop)
            }
        }
    }

    fn response(
        &mut self,
        index: ProgramIndex,
        request: SystemRequest,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<RequestResponse, HarnessError> {
        use RequestResponse::{Answer, End, Wait};
        Ok(match request {
            SystemRequest::Now => Answer(SystemAnswer::Ok),
            SystemRequest::Done => End,
            SystemRequest::Sleep { time } => Wait(RequestWait::Time(cx.now.saturating_add(time))),
            SystemRequest::Wait { until, give_up } => Wait(RequestWait::Arrivals { until, give_up }),
            SystemRequest::WaitFor { events, timeout } => self.wait_for(index, &events, timeout, cx.now),
            SystemRequest::Drop { events } => Answer(self.drop_mail(index, &events)),
            SystemRequest::Read { signal } => Answer(self.vocabulary.read(&signal, cx.stage.as_deref_mut())),
            SystemRequest::Emit { event, args } => Answer(self.emitted(&event, &args, cx)),
            SystemRequest::Command(request) => match begin(&request, cx) {
                Ok(id) => Wait(RequestWait::Command(id)),
                Err(answer) => Answer(answer),
            },
            SystemRequest::Begin { call, command } => {
                let begun = begin(&command, cx).map(|id| self.programs[index].began(id, call));
                Answer(begun.map_or_else(|answer| answer, |()| SystemAnswer::Ok))
            }
            SystemRequest::State { device, what } => {
                Answer(asked(cx, |stage| stage.state(&device, &what).map(SystemAnswer::Numbers)))
            }
            SystemRequest::Plan { device, wanted, form } => {
                Answer(asked(cx, |stage| stage.plan(&device, &wanted).map(|way| told_trajectory(way, form))))
            }
            SystemRequest::Machine(step) => Answer(self.machine(index, step, cx)),
            SystemRequest::List => Answer(self.listed(index)),
            SystemRequest::Parameter(request) => Answer(self.parameters.answer(request)),
            SystemRequest::Log(record) => {
                self.graph.logged(&self.programs[index].name, &record);
                self.log.add(cx.now, &self.programs[index].name, record);
                Answer(SystemAnswer::Ok)
            }
            SystemRequest::Await(awaited) => {
                self.graph.await_port(index, awaited, cx.now);
                Answer(SystemAnswer::Ok)
            }
            SystemRequest::Open(declared) => {
                let opened = self.opened(index, declared);
                Answer(self.told(opened, cx)?)
            }
            SystemRequest::Close { port } => {
                self.programs[index].mailbox.forget_port(port);
                let closed = self.graph.close(index, port);
                Answer(self.told(closed, cx)?)
            }
            SystemRequest::Publish { port, message } => {
                let published = self.graph.publish(index, port, &message);
                Answer(self.told(published, cx)?)
            }
            SystemRequest::Call(request) => {
                let called = self.called(index, request);
                Answer(self.told(called, cx)?)
            }
        })
    }

    fn emitted(
        &self,
        event: &str,
        args: &BTreeMap<String, SystemArgument>,
        cx: &mut PlayerContext<'_, '_>,
    ) -> SystemAnswer {
        match self.vocabulary.emission(event, args) {
            Ok((event, args)) => {
                cx.out.push(PlayerMessage::Event { event, args });
                SystemAnswer::Ok
            }
            Err(answer) => answer,
        }
    }

    fn listed(&mut self, index: ProgramIndex) -> SystemAnswer {
        let names = self.names();
        SystemAnswer::Listed(self.graph.watch(index, &names))
    }

    /// Writes down what a state machine does, and then makes happen what that means. Of several programs, the machine is called
    /// by its program first.
    fn machine(
        &self,
        index: ProgramIndex,
        mut step: MachineStep,
        cx: &mut PlayerContext<'_, '_>,
    ) -> SystemAnswer {
        if let Some(program) = self.programs.get(index).filter(|_| self.programs.len() > 1) {
            let (MachineStep::Declared(MachineDeclaration { machine, .. })
            | MachineStep::Begun { machine, .. }
            | MachineStep::Moved { machine, .. }) = &mut step;
            *machine = format!("{}/{machine}", program.name);
        }
        let mut meant = Vec::new();
        if let MachineStep::Moved { edge, .. } = &step {
            let events = self.binding.iter().flat_map(|binding| binding.transition(&edge.from, &edge.to));
            meant.extend(events.map(|(event, args)| PlayerMessage::Event { event, args }));
        }
        cx.out.push(PlayerMessage::Machine(step));
        cx.out.extend(meant);
        SystemAnswer::Ok
    }

    fn names(&self) -> Vec<String> {
        self.programs.iter().map(|p| p.name.clone()).collect()
    }

    fn opened(&mut self, index: ProgramIndex, declared: PortDeclaration) -> GraphOutcome {
        if let Some(binding) = &self.binding {
            binding.refuses(&declared, &self.graph)?;
        }
        let mut out = self.graph.open(index, declared.clone())?;
        if let Some(binding) = &mut self.binding {
            out.extend(binding.opened(&declared, &mut self.graph).map_err(BindingFault::text)?);
        }
        Ok(out)
    }

    fn called(&mut self, index: ProgramIndex, request: CallRequest) -> GraphOutcome {
        match request {
            CallRequest::Begin { port, call, message } => self.graph.call(index, port, call, message),
            CallRequest::Respond { call, answer } => self.graph.respond(index, call, answer),
            CallRequest::Accept { call, text } => self.graph.accept(index, call, text),
            CallRequest::Feedback { call, message } => self.graph.feedback(index, call, message),
            CallRequest::AnswerCancel { call, granted, text } => {
                self.graph.answer_cancel(index, call, granted, text)
            }
            CallRequest::Finish { call, end, message, text } => {
                self.graph.finish(index, call, end, (message, text))
            }
            CallRequest::Cancel(which) => self.graph.cancel(index, which),
        }
    }

    /// Carries out what a request does to others.
    fn told(
        &mut self,
        outcome: GraphOutcome,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<SystemAnswer, HarnessError> {
        let deliveries = match outcome {
            Ok(deliveries) => deliveries,
            Err(why) => return Ok(refuse(why, None)),
        };
        Ok(match self.deliver(deliveries, cx)? {
            Ok(()) => SystemAnswer::Ok,
            Err(why) => refuse(why, None),
        })
    }

    /// Hands everything on, to the programs and to the scenario; what makes no sense to the scenario is the inner error.
    fn deliver(
        &mut self,
        deliveries: Vec<GraphDelivery>,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<Result<(), String>, HarnessError> {
        let mut waiting = VecDeque::from(deliveries);
        let mut wrong = Ok(());
        while let Some(GraphDelivery { to, arrival, depth }) = waiting.pop_front() {
            match &mut self.binding {
                Some(binding) if binding.node() == to => match binding.take(arrival, &mut self.graph, cx) {
                    Ok(more) => waiting.extend(more),
                    Err(BindingFault::Message(why)) => wrong = Err(why),
                    Err(BindingFault::Scenario(why)) => return Err(scenario_fault(&why)),
                },
                _ => {
                    let delivered = self.programs[to].deliver(arrival, depth, &self.vocabulary, cx.now);
                    delivered.map_err(|e| self.named(to, e))?;
                }
            }
        }
        Ok(wrong)
    }

    /// Lets the scenario's own node do something; what it cannot do is a fault of the scenario.
    fn bound(
        &mut self,
        cx: &mut PlayerContext<'_, '_>,
        act: impl FnOnce(&mut BindingNode<'p>, &mut MessageGraph, &mut PlayerContext<'_, '_>) -> BindingOutcome,
    ) -> Result<(), HarnessError> {
        let Some(binding) = &mut self.binding else { return Ok(()) };
        let outcome = act(binding, &mut self.graph, cx);
        let told = match outcome {
            Ok(deliveries) => self.deliver(deliveries, cx)?,
            Err(fault) => Err(fault.text()),
        };
        told.map_err(|why| scenario_fault(&why))
    }

    fn wait_for(
        &mut self,
        index: ProgramIndex,
        names: &[String],
        timeout: Option<Nanos>,
        now: Nanos,
    ) -> RequestResponse {
        let events = match self.vocabulary.audible(names) {
            Ok(events) => events,
            Err(answer) => return RequestResponse::Answer(answer),
        };
        match self.programs[index].mailbox.take_event(&events) {
            Some(heard) => RequestResponse::Answer(self.vocabulary.event_answer(heard)),
            None => {
                let until = timeout.map(|t| now.saturating_add(t));
                RequestResponse::Wait(RequestWait::Events { events, until })
            }
        }
    }

    fn drop_mail(&mut self, index: ProgramIndex, names: &[String]) -> SystemAnswer {
        match self.vocabulary.audible(names) {
            Ok(events) => {
                self.programs[index].mailbox.forget(&events);
                SystemAnswer::Ok
            }
            Err(answer) => answer,
        }
    }
}

fn scenario_fault(why: &str) -> HarnessError {
    HarnessError::Model(format!("the binding: {why}"))
}

fn begin(request: &CommandRequest, cx: &mut PlayerContext<'_, '_>) -> Result<CommandId, SystemAnswer> {
    let Some(stage) = cx.stage.as_deref_mut() else {
        return Err(refuse("there is no world to act in", None));
    };
    stage.command(request).map_err(said)
}

/// Asks the world for numbers.
fn asked(
    cx: &mut PlayerContext<'_, '_>,
    ask: impl FnOnce(&WorldStage<'_>) -> Result<SystemAnswer, NotBegun>,
) -> SystemAnswer {
    match cx.stage.as_deref() {
        Some(stage) => ask(stage).unwrap_or_else(said),
        None => refuse("there is no world with devices", None),
    }
}

fn told_trajectory(way: PlannedTrajectory, form: PlanForm) -> SystemAnswer {
    let PlannedTrajectory { mut corners, points } = way;
    match form {
        PlanForm::End => SystemAnswer::Numbers(corners.pop().unwrap_or_default()),
        PlanForm::Corners => SystemAnswer::Numbers(corners.concat()),
        PlanForm::Timed => SystemAnswer::Way(points),
    }
}

fn said(why: NotBegun) -> SystemAnswer {
    match why {
        NotBegun::Refused { error, help } => refuse(error, help),
        NotBegun::Failed(why) => SystemAnswer::Ended(Err(why)),
    }
}

impl<S: SystemActor> ActorPlayer for SystemPlayer<'_, S> {
    fn actors(&self) -> &[ActorId] {
        &self.actors
    }

    fn wake(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        self.now = cx.now;
        self.graph.goes_on(cx.now);
        if let Some(why) = self.wrong.take() {
            return Err(scenario_fault(&why));
        }
        if std::mem::replace(&mut self.begun, true) {
            self.bound(cx, BindingNode::wake)?;
        } else {
            self.bound(cx, BindingNode::begin)?;
        }
        for index in 0..self.programs.len() {
            self.programs[index].wake(&self.vocabulary, cx).map_err(|e| self.named(index, e))?;
            self.serve(cx)?;
        }
        Ok(())
    }

    fn hear(
        &mut self,
        event: EventId,
        args: &[Value],
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        self.now = cx.now;
        self.graph.goes_on(cx.now);
        self.bound(cx, |binding, graph, cx| binding.hear(event, args, graph, cx))?;
        for index in 0..self.programs.len() {
            let heard = HeardEvent { event, args: args.to_vec(), time: cx.now };
            let told = self.programs[index].hear(heard, &self.vocabulary, cx);
            told.map_err(|e| self.named(index, e))?;
            self.serve(cx)?;
        }
        Ok(())
    }

    fn next_wake(&self) -> Option<Nanos> {
        let bound = self.binding.as_ref().and_then(|b| b.next_wake(self.now, &self.graph));
        self.programs.iter().filter_map(ServedProgram::next_wake).chain(bound).min()
    }

    fn is_finished(&self) -> bool {
        self.programs.iter().all(|p| p.ended)
    }

    fn log(&self) -> SystemLog {
        self.log.clone()
    }

    fn said(&self) -> SaidHistory {
        self.graph.said()
    }

    fn ports(&self, end: Nanos) -> PortHistory {
        self.graph.history(&self.names(), end)
    }
}
