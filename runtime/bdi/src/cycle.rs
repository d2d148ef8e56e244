//! The reasoning cycle: one event, then one step of one intention.

use std::{
    collections::{BTreeSet, VecDeque},
    sync::Arc,
};

use hrdsl_ir::{
    EventId, Nanos, Program, Span, Value,
    bdi::{AgentId, BeliefId, InitialFact, TriggerOn, source_percept},
    list::same,
};

use crate::{
    belief::{FactAnnotations, GroundArguments, from, sourced, typed},
    check::{self, MalformedAgentError},
    dice::AgentRng,
    event::{ActionToken, AgentAction, IncomingItem, OutgoingMail, QueuedEvent, SpeechAct},
    holding::HoldingKind,
    intention::{IntentionState, IntentionTimer, NO_PLAN},
    log::{FailureCause, LogDetail, LogEntry, LogItem, ReasoningLog},
    measure::AgentCounts,
    mind::{AgentIdentity, MentalState, PeerTable},
    query::QuerySolver,
    repeat::RepetitionDetector,
};

/// Cycles of one agent at one instant after which the run is taken to be endless.
pub const CYCLE_LIMIT: u64 = 1_000_000;

/// Plans of one intention that may wait for each other.
const MAX_HEIGHT: usize = 10_000_000;

/// How an agent, or all agents of a run, stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunStatus {
    /// It has something to reason about: it is to be run.
    Ready,
    /// All its intentions wait: for a time, an event, or the end of an action.
    Waiting,
    /// It has no intention left; only an event can start it again.
    Idle,
    /// At one instant its state repeated, and so it would for ever.
    Livelock,
    /// It did not come to rest within the bounded number of cycles at one instant.
    Endless,
    /// It held more of this at once than [an agent may](HoldingKind::most).
    Overfull(HoldingKind),
    /// The program cannot be run.
    Malformed,
}

/// One running agent.
#[derive(Debug)]
pub(crate) struct AgentMachine<'p> {
    pub mind: MentalState<'p>,
    pub solver: QuerySolver<'p>,
    pub dice: AgentRng,
    pub log: ReasoningLog,
    pub measured: Option<Box<AgentCounts>>,
    /// Counts timers, actions and questions.
    pub serial: u64,
    pub timers: BTreeSet<IntentionTimer>,
    /// The intentions that `await`, in the order in which they began to.
    pub awaiting: Vec<u32>,
    pub inbox: VecDeque<IncomingItem>,
    pub outbox: Vec<OutgoingMail>,
    pub actions: Vec<AgentAction>,
    pub ready: VecDeque<u32>,
    /// In an agent as in Jason: the atomic intention, beside which nothing else goes on while it is atomic.
    pub exclusive: Option<u32>,
    /// The plan that is begun takes the place of an atomic one that failed.
    pub stays_atomic: bool,
    /// Cycles at the instant `now`.
    pub cycles: u64,
    pub cycle_limit: u64,
    pub repetition: RepetitionDetector,
    /// The intention whose step changes goals, and how often such steps ended what they were part of.
    pub acting: Option<u32>,
    pub touched: u64,
    /// The plan of the last step.
    pub working: u16,
    /// Values of the answers that one `for` found.
    pub found: usize,
    /// It will never run again.
    pub halted: Option<RunStatus>,
    pub fault: Option<MalformedAgentError>,
}

impl<'p> AgentMachine<'p> {
    /// The agent at time 0: its initial beliefs, then the chosen facts, then its initial goals, each giving an event.
    /// A fact that does not fit its declaration is left out and logged; a program that cannot be run gives a machine
    /// that does nothing, with [`RunStatus::Malformed`].
    pub fn new(
        program: &'p Program,
        id: AgentId,
        chosen: &[InitialFact],
        place: u16,
        peers: &Arc<PeerTable>,
        seed: u64,
        detail: LogDetail,
    ) -> Self {
        let checked = check::agent(program, id);
        let agent = checked.as_ref().ok().copied();
        let me =
            AgentIdentity { name: peers.agents[usize::from(place)].0, place, id, peers: Arc::clone(peers) };
        let mut machine = Self {
            mind: MentalState::new(program, agent, me),
            solver: QuerySolver::default(),
            dice: AgentRng::new(seed, u64::from(id.0) + 1),
            log: ReasoningLog { detail, ..ReasoningLog::default() },
            measured: None,
            serial: 0,
            timers: BTreeSet::new(),
            awaiting: Vec::new(),
            inbox: VecDeque::new(),
            outbox: Vec::new(),
            actions: Vec::new(),
            ready: VecDeque::new(),
            exclusive: None,
            stays_atomic: false,
            cycles: 0,
            cycle_limit: CYCLE_LIMIT,
            repetition: RepetitionDetector::default(),
            acting: None,
            touched: 0,
            working: NO_PLAN,
            found: 0,
            halted: None,
            fault: None,
        };
        match checked {
            Ok(_) => machine.start(chosen),
            Err(fault) => (machine.fault, machine.halted) = (Some(fault), Some(RunStatus::Malformed)),
        }
        machine
    }

    fn start(&mut self, chosen: &[InitialFact]) {
        let agent = self.mind.agent;
        let mut facts: Vec<&InitialFact> = agent.initial_beliefs.iter().chain(chosen).collect();
        if agent.jason {
            // The first of the text is asked first, and its event comes last.
            facts.reverse();
        }
        for fact in facts {
            let declared = agent.beliefs.get(usize::from(fact.belief.0));
            match declared.and_then(|b| typed(&b.params, GroundArguments::from_slice(&fact.args))) {
                Some(args) => {
                    let annotations = sourced(FactAnnotations::from_slice(&fact.annotations));
                    self.believe(fact.belief, &args, annotations);
                }
                None => self.enter(0, LogItem::Refused { belief: fact.belief, args: fact.args.clone() }),
            }
        }
        self.mind.beliefs.begin();
        for (goal, args) in &agent.initial_goals {
            let args = args.iter().map(|v| Some(*v)).collect();
            self.post(QueuedEvent::new(TriggerOn::GoalAdded(*goal), args));
        }
    }

    // ── From outside ──

    pub fn perceive(&mut self, event: EventId, args: &[Value]) {
        self.inbox.push_back(IncomingItem::Perceived { event, args: GroundArguments::from_slice(args) });
    }

    pub fn receive(&mut self, from: u16, speech: SpeechAct) {
        self.inbox.push_back(IncomingItem::Heard { from, speech });
    }

    /// The action is finished. A token that is not of an action in progress has no effect.
    pub fn action_done(&mut self, token: ActionToken) {
        let (place, serial) = token.parts();
        let acting = self.mind.pool.get(place).map(|i| i.state);
        if matches!(acting, Some(IntentionState::Acting(current)) if current == serial) {
            self.resume(place);
        }
    }

    /// Runs reasoning cycles until everything waits or is done, taking in what was perceived and heard.
    pub fn settle(&mut self) {
        self.repetition.forget();
        let mut done = 0;
        while self.halted.is_none() && !self.is_overfull() {
            if !self.has_turn() {
                let Some(incoming) = self.inbox.pop_front() else { return };
                self.take_in(incoming);
                continue;
            }
            if self.cycles >= self.cycle_limit {
                self.halted = Some(RunStatus::Endless);
                self.enter(0, LogItem::Endless);
                return;
            }
            self.cycles += 1;
            self.cycle();
            done += 1;
            if !self.repetition.is_idle(done) && self.repeats(done) {
                self.halted = Some(RunStatus::Livelock);
                self.enter(0, LogItem::Livelock);
                return;
            }
        }
    }

    /// Whether the state after so many cycles of settling is one that it was in before.
    fn repeats(&mut self, done: u64) -> bool {
        let mut repetition = std::mem::take(&mut self.repetition);
        let repeats = repetition.seen(done, self);
        self.repetition = repetition;
        repeats
    }

    /// Time has passed to `now`.
    pub fn advance(&mut self, now: Nanos) {
        if now > self.mind.now {
            self.mind.now = now;
            self.cycles = 0;
        }
    }

    pub fn next_wake(&self) -> Option<Nanos> {
        if self.halted.is_some() { None } else { self.timers.first().map(|t| t.due) }
    }

    pub fn has_work(&self) -> bool {
        self.halted.is_none() && (self.has_turn() || !self.inbox.is_empty())
    }

    pub fn status(&self) -> RunStatus {
        if let Some(halted) = self.halted {
            halted
        } else if self.has_work() {
            RunStatus::Ready
        } else if self.mind.pool.is_empty() {
            RunStatus::Idle
        } else {
            RunStatus::Waiting
        }
    }

    // ── The cycle ──

    fn take_in(&mut self, incoming: IncomingItem) {
        match incoming {
            IncomingItem::Perceived { event, args } => self.notice(event, &args),
            IncomingItem::Heard { from, speech } => self.hear(from, speech),
        }
    }

    fn notice(&mut self, event: EventId, args: &[Value]) {
        self.entry(0, || LogItem::Perceived { event, args: args.to_vec() });
        for belief in self.mind.library.percepts(event).to_vec() {
            self.sense(belief, args);
        }
        for place in std::mem::take(&mut self.awaiting) {
            let IntentionState::Awaiting { events, timer } = self.mind.pool.see(place).state else {
                continue;
            };
            if !events.iter().any(|pattern| pattern.matches(event, args)) {
                self.awaiting.push(place);
                continue;
            }
            if let Some(timer) = timer {
                self.timers.remove(&timer);
            }
            self.resume(place);
        }
        self.announce(TriggerOn::Perceived(event), args, None, None);
    }

    /// A belief that holds the arguments of the latest event.
    fn sense(&mut self, belief: BeliefId, args: &[Value]) {
        let percept = Value::Symbol(source_percept());
        let rows = self.mind.beliefs.of(belief);
        let is_this = |row: usize| rows.row(row).iter().zip(args).all(|(a, b)| same(*a, *b));
        let old: Vec<usize> = rows.iter().filter(|row| !is_this(*row)).collect();
        for row in old {
            self.take(belief, row, percept);
        }
        self.believe(belief, args, from(percept));
    }

    /// Ends what is due; `false` if nothing is.
    pub fn expire(&mut self) -> bool {
        let mut any = false;
        while self.halted.is_none()
            && let Some(timer) = self.timers.first().copied().filter(|t| t.due <= self.mind.now)
        {
            any = true;
            self.timers.remove(&timer);
            let intention = self.mind.pool.at(timer.of);
            if let Some(at) = intention.deadlines.iter().position(|d| d.timer == timer) {
                let height = intention.deadlines[at].height;
                self.miss(timer.of, height);
                continue;
            }
            match intention.state {
                IntentionState::Awaiting { .. } => {
                    self.awaiting.retain(|place| *place != timer.of);
                    self.fail(timer.of, FailureCause::TimedOut);
                }
                IntentionState::Asking { .. } => self.fail(timer.of, FailureCause::TimedOut),
                // INVARIANT: only these have timers.
                IntentionState::Sleeping(_)
                | IntentionState::Free
                | IntentionState::Ready
                | IntentionState::Held
                | IntentionState::Posted
                | IntentionState::Acting(_)
                | IntentionState::Forked { .. } => self.resume(timer.of),
            }
        }
        any
    }

    fn cycle(&mut self) {
        let event = match self.exclusive {
            None => self.mind.events.pop_front(),
            Some(_) => self.exclusive_event(),
        };
        if let Some(event) = event {
            self.deliberate(&event);
        }
        let ready = match self.exclusive {
            None => self.ready.pop_front(),
            Some(_) if self.holder().is_none() => self.ready.pop_front(),
            Some(_) => self.own_ready().and_then(|at| self.ready.remove(at)),
        };
        if let Some(place) = ready {
            self.step(place);
        }
    }

    /// Finds a plan for an event and puts it on the event's intention, or on one of its own.
    fn deliberate(&mut self, event: &QueuedEvent) {
        if let (TriggerOn::BeliefAdded(_) | TriggerOn::BeliefRemoved(_), Some(place)) = (event.on, event.of)
            && self.mind.library.relevant(event.on).is_empty()
        {
            return self.resume(place);
        }
        let plan = self.select(event, event.of);
        match (plan, event.on) {
            (Some(plan), _) => self.adopt(plan, event),
            (None, on) => {
                let number = event.of.map_or(0, |place| self.mind.pool.see(place).number);
                let (args, origin) = (event.args.clone(), self.origin_of(event));
                self.enter(number, LogItem::Unhandled { on, args, origin });
                self.fail_by_itself(event);
            }
        }
    }

    /// Puts the plan just selected on the event's intention, or on one of its own.
    pub fn adopt(&mut self, plan: u16, event: &QueuedEvent) {
        let place = event.of.unwrap_or_else(|| self.mind.pool.adopt());
        if event.of.is_none() {
            self.mind.pool.at(place).reply = event.reply();
        }
        self.begin(place, plan, event);
    }

    /// Puts the plan just selected on top of an intention.
    pub fn begin(&mut self, place: u32, plan: u16, event: &QueuedEvent) {
        let intention = self.mind.pool.at(place);
        let is_goal = matches!(event.on, TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_));
        let height = intention.frames.len();
        let mut early = None;
        if let Some(top) = intention.frames.last().filter(|_| is_goal) {
            let finished = usize::from(top.next) == self.mind.library.code(top.plan).len();
            let timed = intention.deadlines.last().is_some_and(|d| d.height as usize == height);
            let gives = event.args.iter().chain(intention.args(*top)).any(Option::is_none);
            if finished && !timed && !gives && !top.branch && self.mind.library.leaves_early(top.plan) {
                early = Some(*top);
            }
        }
        if let Some(frame) = early {
            self.leave(place);
            self.measure(|m| m.completed[usize::from(frame.plan)] += 1);
        }
        self.put(place, plan, event, early.map(|f| [f.plan, f.under[0]]));
        let intention = self.mind.pool.see(place);
        if intention.frames.len() > MAX_HEIGHT {
            self.fail(place, FailureCause::TooDeep);
        } else if !intention.suspended && !self.mind.library.code(plan).is_empty() {
            // A body does not begin with the end of anything.
            self.make_ready(place);
        } else {
            self.resume(place);
        }
    }

    /// The frame of a plan whose variables the solver holds.
    #[inline]
    pub fn put(&mut self, place: u32, plan: u16, event: &QueuedEvent, under: Option<[u16; 2]>) {
        let selected = self.mind.library.plan(plan);
        let first = crate::code::settle(self.mind.library.code(plan), 0);
        let vars = &self.solver.slots[..selected.vars.len()];
        let fresh = self.mind.pool.count(place);
        self.mind.pool.push(place, plan, first, &event.args, vars);
        let atomic = selected.atomic || self.stays_atomic;
        if atomic {
            self.stays_atomic = false;
            if self.mind.agent.jason && self.holder().is_none() {
                self.exclusive = Some(place);
            }
        }
        let intention = self.mind.pool.at(place);
        intention.atomic += u32::from(atomic);
        let number = intention.number;
        if let Some(top) = intention.frames.last_mut() {
            top.atomic = atomic;
            top.under = under.unwrap_or(top.under);
            top.told = event.told;
        }
        if let Some(measured) = &mut self.measured {
            let under = intention.frames.last().map_or([NO_PLAN; 2], |f| f.under);
            measured.begin(plan, event.by, under);
        }
        if self.log.detail >= LogDetail::Steps {
            let (on, args, vars) = (event.on, event.args.clone(), vars.to_vec());
            self.enter(number, LogItem::Selected { on, args, plan, vars, fresh });
        }
    }

    /// The intention's turn comes again.
    #[inline]
    pub fn make_ready(&mut self, place: u32) {
        let intention = self.mind.pool.at(place);
        intention.state = IntentionState::Ready;
        if intention.atomic > 0 {
            self.ready.push_front(place);
        } else {
            self.ready.push_back(place);
        }
    }

    /// Posts an event, perhaps for an intention that waits for its plan.
    #[inline]
    pub fn post(&mut self, event: QueuedEvent) {
        let mut urgent = false;
        if let Some(place) = event.of {
            let intention = self.mind.pool.at(place);
            intention.state = IntentionState::Posted;
            urgent = intention.atomic > 0;
        }
        if urgent {
            self.mind.events.push_front(event);
        } else {
            self.mind.events.push_back(event);
        }
    }

    pub fn next_serial(&mut self) -> u64 {
        self.serial += 1;
        self.serial
    }

    /// The step that posted an event, or the agent.
    fn origin_of(&self, event: &QueuedEvent) -> Span {
        let step =
            event.by.and_then(|(plan, site)| self.mind.library.code(plan).iter().find(|l| l.site == site));
        step.map_or(self.mind.agent.origin, |l| l.origin)
    }

    // ── Log and measure ──

    pub fn enter(&mut self, intention: u32, what: LogItem) {
        let is_full = self.log.most.is_some_and(|most| self.log.entries.len() >= most);
        if is_full && !matches!(what, LogItem::Livelock | LogItem::Endless | LogItem::Overfull(_)) {
            self.log.left_out += 1;
            return;
        }
        let (time, round, cycle) = (self.mind.now, self.log.round, self.cycles);
        self.log.entries.push(LogEntry { time, round, cycle, intention, what });
    }

    /// Enters what is only wanted in detail.
    pub fn entry(&mut self, intention: u32, what: impl FnOnce() -> LogItem) {
        if self.log.detail >= LogDetail::Steps {
            self.enter(intention, what());
        }
    }

    pub fn entry_of(&mut self, place: u32, what: impl FnOnce() -> LogItem) {
        if self.log.detail >= LogDetail::Steps {
            let number = self.mind.pool.see(place).number;
            self.enter(number, what());
        }
    }

    pub fn measure(&mut self, f: impl FnOnce(&mut AgentCounts)) {
        if let Some(measured) = &mut self.measured {
            f(measured);
        }
    }
}
