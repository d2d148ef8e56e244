//! The reasoning cycle: one event, then one step of one intention.

use std::collections::{BTreeSet, VecDeque};

use hrdsl_ir::{
    EventId, Nanos, Program, Span, Value,
    bdi::{Agent, AgentId, BeliefId, Fact, TriggerOn},
};

use crate::{
    Action, ActionToken, Cause, LogEntry, Logged, Malformed,
    belief::{BeliefBase, typed},
    check,
    event::{Args, Event, Ground},
    intention::{Pool, State, Timer},
    log::{Describe, Log},
    plan::Library,
    select::Selector,
};

/// Cycles at one instant after which an agent is taken to be in a livelock, unless
/// [`Machine::set_cycle_limit`] says otherwise.
pub const CYCLE_LIMIT: u64 = 1_000_000;

/// Plans of one intention that may wait for each other.
const MAX_HEIGHT: usize = 100_000;

/// How an agent stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It has something to reason about: it is to be [`run`](Machine::run).
    Ready,
    /// All its intentions wait: for a time, an event, or the end of an action.
    Waiting,
    /// It has no intention left; only an event can start it again.
    Idle,
    /// It did not come to rest within the bounded number of cycles at one instant, and stays so.
    Livelock,
    /// The program cannot be run: see [`Machine::fault`].
    Malformed,
}

/// One running agent.
///
/// After each batch of [`perceive`](Self::perceive) and [`stimulus_done`](Self::stimulus_done) the harness calls
/// [`run`](Self::run) at the same time; it calls `run` at [`next_wake`](Self::next_wake) at the latest. Times never go back.
#[derive(Debug)]
pub struct Machine<'p> {
    pub(crate) program: &'p Program,
    pub(crate) agent: Option<&'p Agent>,
    pub(crate) library: Library<'p>,
    pub(crate) beliefs: BeliefBase,
    pub(crate) pool: Pool<'p>,
    pub(crate) selector: Selector,
    pub(crate) log: Log,
    pub(crate) now: Nanos,
    /// Counts timers and actions.
    pub(crate) serial: u64,
    pub(crate) timers: BTreeSet<Timer>,
    /// The intentions that `await`, in the order in which they began to.
    pub(crate) awaiting: Vec<u32>,
    events: VecDeque<Event>,
    inbox: VecDeque<(EventId, Ground)>,
    ready: VecDeque<u32>,
    /// Cycles at the instant `now`.
    cycles: u64,
    cycle_limit: u64,
    livelock: bool,
    fault: Option<Malformed>,
}

impl<'p> Machine<'p> {
    /// The agent at time 0: its initial beliefs, then the chosen facts, then its initial goals, each giving an event.
    /// A fact that does not fit its declaration is left out and logged; a program that cannot be run gives a machine
    /// that does nothing, with [`Status::Malformed`].
    #[must_use]
    pub fn new(program: &'p Program, agent: AgentId, chosen: &[Fact]) -> Self {
        let checked = check::agent(program, agent);
        let mut machine = Self {
            program,
            agent: checked.as_ref().ok().copied(),
            library: Library::default(),
            beliefs: BeliefBase::default(),
            pool: Pool::default(),
            selector: Selector::default(),
            log: Log { detailed: true, ..Log::default() },
            now: 0,
            serial: 0,
            timers: BTreeSet::new(),
            awaiting: Vec::new(),
            events: VecDeque::new(),
            inbox: VecDeque::new(),
            ready: VecDeque::new(),
            cycles: 0,
            cycle_limit: CYCLE_LIMIT,
            livelock: false,
            fault: None,
        };
        match checked {
            Ok(agent) => machine.start(agent, chosen),
            Err(fault) => machine.fault = Some(fault),
        }
        machine
    }

    fn start(&mut self, agent: &'p Agent, chosen: &[Fact]) {
        self.library = Library::new(self.program, agent);
        self.beliefs = BeliefBase::new(agent);
        self.log.selections = vec![0; agent.plans.len()];
        for fact in agent.initial_beliefs.iter().chain(chosen) {
            let declared = agent.beliefs.get(fact.belief.0 as usize);
            match declared.and_then(|b| typed(&b.params, Ground::from_slice(&fact.args))) {
                Some(args) => self.believe(fact.belief, &args),
                None => self.log.enter(0, 0, Logged::Refused { belief: fact.belief }),
            }
        }
        for (goal, args) in &agent.initial_goals {
            let args = args.iter().map(|v| Some(*v)).collect();
            self.post(TriggerOn::GoalAdded(*goal), args, None, agent.origin);
        }
    }

    /// An event of another actor reaches the agent: it resumes every `await` that it matches and triggers the plans
    /// that are relevant to it, when the agent is next [`run`](Self::run).
    pub fn perceive(&mut self, event: EventId, args: &[Value], now: Nanos) {
        self.advance(now);
        self.inbox.push_back((event, Ground::from_slice(args)));
    }

    /// The action is finished, and its intention goes on when the agent is next [`run`](Self::run). A token that is
    /// not of an action in progress has no effect.
    pub fn stimulus_done(&mut self, token: ActionToken, now: Nanos) {
        self.advance(now);
        let (place, serial) = token.parts();
        let acting = self.pool.get(place).map(|i| i.state);
        if matches!(acting, Some(State::Acting(current)) if current == serial) {
            self.resume(place);
        }
    }

    /// Runs reasoning cycles until everything waits or is done, taking in what was perceived, then what is due by now;
    /// an event that comes together with the end of an `await` wins. Appends what the agent does to `out`.
    pub fn run(&mut self, now: Nanos, out: &mut Vec<Action>) {
        self.settle(now, out);
        while !self.halted() && self.expire() {
            self.settle(now, out);
        }
    }

    /// As [`run`](Self::run), but nothing that is due by now expires yet: for a harness in which other actors may still
    /// make events at this instant.
    pub fn settle(&mut self, now: Nanos, out: &mut Vec<Action>) {
        self.advance(now);
        while !self.halted() {
            if self.events.is_empty() && self.ready.is_empty() {
                let Some((event, args)) = self.inbox.pop_front() else { return };
                self.take_in(event, &args);
                continue;
            }
            if self.cycles >= self.cycle_limit {
                self.livelock = true;
                self.log.enter(self.now, 0, Logged::Livelock);
                return;
            }
            self.cycles += 1;
            self.cycle(out);
        }
    }

    /// The earliest time at which a `wait` or an `await` is over.
    #[must_use]
    pub fn next_wake(&self) -> Option<Nanos> {
        if self.halted() { None } else { self.timers.first().map(|t| t.due) }
    }

    #[must_use]
    pub fn status(&self) -> Status {
        if self.fault.is_some() {
            Status::Malformed
        } else if self.livelock {
            Status::Livelock
        } else if !(self.events.is_empty() && self.ready.is_empty() && self.inbox.is_empty()) {
            Status::Ready
        } else if self.pool.is_empty() {
            Status::Idle
        } else {
            Status::Waiting
        }
    }

    /// Why the program cannot be run.
    #[must_use]
    pub fn fault(&self) -> Option<&Malformed> {
        self.fault.as_ref()
    }

    /// What was decided so far, or since [`take_log`](Self::take_log).
    #[must_use]
    pub fn log(&self) -> &[LogEntry] {
        &self.log.entries
    }

    /// Hands the log over and begins a new one, for a run that must not grow.
    pub fn take_log(&mut self) -> Vec<LogEntry> {
        std::mem::take(&mut self.log.entries)
    }

    /// Whether selections are logged; otherwise failures only. They are, unless this says no.
    pub fn log_selections(&mut self, yes: bool) {
        self.log.detailed = yes;
    }

    /// How often each plan was selected, by its place in the agent's plan library.
    #[must_use]
    pub fn selections(&self) -> &[u64] {
        &self.log.selections
    }

    /// An entry of this agent's log in a line of text, with names.
    #[must_use]
    pub fn describe(&self, entry: &LogEntry) -> String {
        self.agent
            .map_or_else(String::new, |agent| Describe { agent, events: &self.program.events }.entry(entry))
    }

    /// All that the agent believes now: by the order of declarations, then oldest first.
    pub fn beliefs(&self) -> impl Iterator<Item = Fact> {
        self.beliefs.facts()
    }

    /// How many plans the highest intention holds.
    #[must_use]
    pub fn height(&self) -> usize {
        self.pool.height()
    }

    /// How many cycles at one instant are taken for a livelock ([`CYCLE_LIMIT`]).
    pub fn set_cycle_limit(&mut self, cycles: u64) {
        self.cycle_limit = cycles;
    }

    fn halted(&self) -> bool {
        self.livelock || self.fault.is_some()
    }

    fn advance(&mut self, now: Nanos) {
        if now > self.now {
            self.now = now;
            self.cycles = 0;
        }
    }

    fn take_in(&mut self, event: EventId, args: &[Value]) {
        for place in std::mem::take(&mut self.awaiting) {
            let State::Awaiting { events, timer } = self.pool.at(place).state else { continue };
            if !events.iter().any(|pattern| pattern.matches(event, args)) {
                self.awaiting.push(place);
                continue;
            }
            if let Some(timer) = timer {
                self.timers.remove(&timer);
            }
            self.resume(place);
        }
        self.announce(TriggerOn::Perceived(event), args);
    }

    /// Ends what is due; `false` if nothing is.
    fn expire(&mut self) -> bool {
        let mut any = false;
        while let Some(timer) = self.timers.first().copied().filter(|t| t.due <= self.now) {
            any = true;
            self.timers.remove(&timer);
            match self.pool.at(timer.of).state {
                State::Awaiting { .. } => {
                    self.awaiting.retain(|place| *place != timer.of);
                    self.fail(timer.of, Cause::TimedOut);
                }
                // INVARIANT: only these two have timers.
                State::Sleeping | State::Free | State::Ready | State::Posted | State::Acting(_) => {
                    self.resume(timer.of);
                }
            }
        }
        any
    }

    fn cycle(&mut self, out: &mut Vec<Action>) {
        if let Some(event) = self.events.pop_front() {
            self.deliberate(&event);
        }
        if let Some(place) = self.ready.pop_front() {
            self.step(place, out);
        }
    }

    /// Finds a plan for an event and puts it on the event's intention, or on one of its own.
    fn deliberate(&mut self, event: &Event) {
        let plan = self.select(event.on, &event.args, event.of);
        match (plan, event.on) {
            (Some(plan), _) => {
                let place = event.of.unwrap_or_else(|| self.pool.adopt());
                self.enter(place, plan, event.on, &event.args);
            }
            (None, TriggerOn::GoalAdded(goal)) => {
                let place = event.of.unwrap_or_else(|| self.pool.adopt());
                self.fail_to_adopt(place, goal, event);
            }
            (None, TriggerOn::TestAdded(belief)) => {
                if let Some(place) = event.of {
                    self.fail(place, Cause::NoAnswer(belief));
                }
            }
            (
                None,
                TriggerOn::BeliefAdded(_)
                | TriggerOn::BeliefRemoved(_)
                | TriggerOn::Perceived(_)
                | TriggerOn::GoalFailed(_),
            ) => {
                let what = Logged::Unhandled { on: event.on, args: event.args.clone() };
                self.log.enter(self.now, 0, what);
            }
        }
    }

    /// The first applicable plan; what went wrong on the way is logged.
    pub(crate) fn select(&mut self, on: TriggerOn, args: &Args, of: Option<u32>) -> Option<u16> {
        let plan = self.selector.select(&self.library, &self.beliefs, on, args);
        for (plan, error) in std::mem::take(&mut self.selector.faults) {
            let number = of.map_or(0, |place| self.pool.at(place).number);
            let origin = self.library.plan(plan).origin;
            self.log.enter(self.now, number, Logged::Fault { plan, error, origin });
        }
        plan
    }

    /// Puts the plan just selected on top of an intention.
    pub(crate) fn enter(&mut self, place: u32, plan: u16, on: TriggerOn, args: &Args) {
        let intention = self.pool.at(place);
        let is_goal = matches!(on, TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_));
        if let Some(top) = intention.frames.last().filter(|_| is_goal) {
            let finished = usize::from(top.next) == self.library.plan(top.plan).body.len();
            if finished && self.library.leaves_early(top.plan) {
                intention.pop();
            }
        }
        self.log.selections[plan as usize] += 1;
        if self.log.detailed {
            let what = Logged::Selected { on, args: args.clone(), plan };
            self.log.enter(self.now, intention.number, what);
        }
        intention.push(plan, args, &self.selector.slots);
        if intention.frames.len() > MAX_HEIGHT {
            self.fail(place, Cause::TooDeep);
        } else {
            self.resume(place);
        }
    }

    /// The intention's turn comes again.
    pub(crate) fn make_ready(&mut self, place: u32) {
        self.pool.at(place).state = State::Ready;
        self.ready.push_back(place);
    }

    /// Posts an event of a goal or test for an intention, or for a new one.
    pub(crate) fn post(&mut self, on: TriggerOn, args: Args, of: Option<u32>, origin: Span) {
        if let Some(place) = of {
            self.pool.at(place).state = State::Posted;
        }
        self.events.push_back(Event { on, args, of, origin });
    }

    /// Posts an event that matters only if a plan is relevant to it.
    pub(crate) fn announce(&mut self, on: TriggerOn, args: &[Value]) {
        if !self.library.relevant(on).is_empty() {
            self.post(on, args.iter().map(|v| Some(*v)).collect(), None, self.agent_origin());
        }
    }

    /// Adds a belief.
    pub(crate) fn believe(&mut self, belief: BeliefId, args: &[Value]) {
        if self.beliefs.of_mut(belief).insert(args) {
            self.announce(TriggerOn::BeliefAdded(belief), args);
        }
    }

    pub(crate) fn next_serial(&mut self) -> u64 {
        self.serial += 1;
        self.serial
    }

    pub(crate) fn agent_origin(&self) -> Span {
        self.agent.map_or_else(Span::default, |a| a.origin)
    }
}
