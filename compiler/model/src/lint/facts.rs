//! What several rules ask about a scenario: who makes an event, and who takes it.

use std::collections::BTreeSet;

use hrdsl_ir::world::RuleTrigger;
use hrdsl_source::Span;

use super::{
    agent_facts::all_steps,
    agent_index::{AgentIndex, AgentWork, indices},
    flow::{ValueFlow, flows},
};
use crate::{
    ArgPattern, EventId, EventPattern, ReceiveArg, Role, Scenario, TestStep, TriggerOn, TypedExpr,
    TypedMethod, TypedOccurrence, TypedStimulusStep, TypedSync, TypedTerm, Value,
};

/// So many different combinations of arguments are told apart; a maker beyond them counts as making any.
const MAKERS: usize = 64;

/// A constant argument in a form that has an order; `None` may be anything.
type FactKey = Option<(u8, u64)>;

/// An event with arguments that are constant or may be anything.
#[derive(Clone, Debug)]
pub(crate) struct WantedFact {
    pub event: EventId,
    args: Vec<FactKey>,
}

impl WantedFact {
    fn new(event: EventId, args: impl Iterator<Item = Option<Value>>) -> Self {
        Self { event, args: args.map(|v| v.map(Value::key)).collect() }
    }

    pub fn of(pattern: &EventPattern) -> Self {
        Self::new(
            pattern.event,
            pattern.args.iter().map(|a| match a {
                ArgPattern::Any => None,
                ArgPattern::Is(v) => Some(*v),
            }),
        )
    }
}

/// A place that goes on only when one of its events happens.
pub(crate) struct EventWait {
    pub span: Span,
    pub any_of: Vec<WantedFact>,
}

/// What is known about one event.
#[derive(Clone, Debug, Default)]
struct EventFacts {
    /// By arguments.
    makers: BTreeSet<Vec<FactKey>>,
    /// With any arguments.
    freely: bool,
    /// Something in the text reads it.
    read: bool,
    /// The code of a system actor perceives it.
    perceived: bool,
    /// A wait or a trigger of its own is said to be in vain.
    told: bool,
}

/// Answers that are worked out once for all rules.
pub(crate) struct ScenarioFacts<'a> {
    events: Vec<EventFacts>,
    pub waits: Vec<EventWait>,
    /// By requirement the lists of events without any of each of which it says nothing.
    needs: Vec<Vec<Vec<WantedFact>>>,
    /// There are suites or tests: what they do not use is not used.
    pub has_tests: bool,
    /// By automaton: the values of its variables.
    pub flows: Vec<ValueFlow>,
    /// By agent.
    pub agents: Vec<AgentIndex<'a>>,
    /// What the rules on plans may still look at.
    pub work: AgentWork,
}

impl<'a> ScenarioFacts<'a> {
    pub fn of(scenario: &'a Scenario) -> Self {
        let has_tests = !scenario.suites.is_empty() || !scenario.tests.is_empty();
        let events = vec![EventFacts::default(); scenario.events.len()];
        let mut facts = Self {
            events,
            waits: Vec::new(),
            needs: Vec::new(),
            has_tests,
            flows: flows(scenario),
            agents: indices(scenario),
            work: AgentWork::default(),
        };
        facts.declared(scenario);
        facts.agents(scenario);
        facts.automata(scenario);
        facts.judgement(scenario);
        facts.world(scenario);
        facts.suites(scenario);
        facts.tell();
        facts
    }

    /// Whether something makes the event, with whatever arguments.
    pub fn made(&self, event: EventId) -> bool {
        self.events.get(at(event)).is_none_or(|e| e.freely || !e.makers.is_empty())
    }

    /// Whether something in the text reads the event.
    pub fn read(&self, event: EventId) -> bool {
        self.events.get(at(event)).is_none_or(|e| e.read)
    }

    /// Whether the code of a system actor perceives the event.
    pub fn perceived(&self, event: EventId) -> bool {
        self.events.get(at(event)).is_some_and(|e| e.perceived)
    }

    /// Whether a rule about waits or triggers has said already that nobody makes it.
    pub fn told(&self, event: EventId) -> bool {
        self.events.get(at(event)).is_some_and(|e| e.told)
    }

    /// Whether nothing can ever make any of these.
    pub fn in_vain(&self, any_of: &[WantedFact]) -> bool {
        !any_of.is_empty() && !any_of.iter().any(|w| self.can_happen(w))
    }

    /// The events for want of which nothing can ever put a requirement to the test.
    pub fn untested(&self, requirement: usize) -> Option<&[WantedFact]> {
        let needs = self.needs.get(requirement)?;
        needs.iter().find(|any_of| self.in_vain(any_of)).map(Vec::as_slice)
    }

    fn can_happen(&self, wanted: &WantedFact) -> bool {
        let Some(e) = self.events.get(at(wanted.event)) else { return true };
        let fits = |makes: &Vec<FactKey>| {
            makes.iter().zip(&wanted.args).all(|(a, b)| a.is_none() || b.is_none() || a == b)
        };
        e.freely || e.makers.iter().any(fits)
    }

    // ── gathering ──

    fn makes(&mut self, event: EventId, args: impl Iterator<Item = Option<Value>>) {
        let Some(e) = self.events.get_mut(at(event)).filter(|e| !e.freely) else { return };
        let args: Vec<FactKey> = args.map(|v| v.map(Value::key)).collect();
        if args.iter().all(Option::is_none) || e.makers.len() == MAKERS {
            e.freely = true;
        } else {
            e.makers.insert(args);
        }
    }

    fn makes_exprs(&mut self, event: EventId, args: &[TypedExpr]) {
        self.makes(event, args.iter().map(TypedExpr::constant));
    }

    fn reads(&mut self, event: EventId) {
        if let Some(e) = self.events.get_mut(at(event)) {
            e.read = true;
        }
    }

    fn waits_for(&mut self, span: Span, any_of: Vec<WantedFact>) {
        any_of.iter().for_each(|w| self.reads(w.event));
        self.waits.push(EventWait { span, any_of });
    }

    fn declared(&mut self, scenario: &Scenario) {
        let mut modelled = vec![false; scenario.actors.len()];
        let players = scenario.agents.iter().map(|a| a.actor);
        for actor in players.chain(scenario.automata.iter().filter_map(|a| a.actor)) {
            if let Some(m) = modelled.get_mut(usize::from(actor.0)) {
                *m = true;
            }
        }
        let is_system = |i: usize| scenario.actors.get(i).is_some_and(|a| a.role == Role::System);
        let systems: Vec<usize> = (0..scenario.actors.len()).filter(|i| is_system(*i)).collect();
        for (i, event) in scenario.events.iter().enumerate() {
            let from = usize::from(event.from.0);
            if let Some(stimulus) = &event.stimulus {
                self.steps(&stimulus.steps);
                // Without suites and tests it waits to be used.
                self.events[i].freely = !self.has_tests;
                continue;
            }
            self.events[i].freely = is_system(from) && !modelled[from];
            self.events[i].perceived = systems.iter().any(|s| {
                *s != from && (event.to.is_empty() || event.to.iter().any(|a| usize::from(a.0) == *s))
            });
        }
    }

    fn steps(&mut self, steps: &[TypedStimulusStep]) {
        for step in steps {
            match step {
                TypedStimulusStep::Emit { event, args } => self.makes_exprs(*event, args),
                TypedStimulusStep::If { then, otherwise, .. } => {
                    self.steps(then);
                    self.steps(otherwise);
                }
                TypedStimulusStep::Hold { .. } | TypedStimulusStep::Act(_) => {}
            }
        }
    }

    fn agents(&mut self, scenario: &Scenario) {
        for (index, agent) in scenario.agents.iter().enumerate() {
            agent.beliefs.iter().filter_map(|b| b.percept).for_each(|event| self.reads(event));
            let places = scenario.places.agents.get(index);
            for (i, plan) in agent.plans.iter().enumerate() {
                if let TriggerOn::Perceived(event) = plan.trigger.on {
                    let span = places.and_then(|p| p.triggers.get(i)).copied().unwrap_or(plan.origin);
                    let args = plan.trigger.args.iter().map(|a| match a {
                        TypedTerm::Expr(e) => e.constant(),
                        TypedTerm::Any | TypedTerm::Var(_) | TypedTerm::List(..) => None,
                    });
                    self.waits_for(span, vec![WantedFact::new(event, args)]);
                }
                for step in all_steps(&plan.body) {
                    if let Some((event, args)) = step.kind.as_do() {
                        self.makes_exprs(event, args);
                    } else if let Some(events) = step.kind.as_await() {
                        self.waits_for(step.origin, events.iter().map(WantedFact::of).collect());
                    }
                }
            }
        }
    }

    fn automata(&mut self, scenario: &Scenario) {
        for (index, automaton) in scenario.automata.iter().enumerate() {
            let places = scenario.places.automata.get(index);
            for (i, edge) in automaton.edges.iter().enumerate() {
                match &edge.sync {
                    TypedSync::Internal
                    | TypedSync::Offer { .. }
                    | TypedSync::Accept { .. }
                    | TypedSync::Join { .. } => {}
                    TypedSync::Send { event, args } => self.makes_exprs(*event, args),
                    TypedSync::Receive { event, args } => {
                        let span = places.and_then(|p| p.waits.get(i)).copied().unwrap_or(edge.origin);
                        let args = args.iter().map(|a| match a {
                            ReceiveArg::Match(ArgPattern::Is(value)) => Some(*value),
                            ReceiveArg::Match(ArgPattern::Any) | ReceiveArg::Bind => None,
                        });
                        self.waits_for(span, vec![WantedFact::new(*event, args)]);
                    }
                }
            }
        }
    }

    fn judgement(&mut self, scenario: &Scenario) {
        for requirement in &scenario.requirements {
            let named = requirement.pattern.events().filter_map(TypedOccurrence::as_event);
            named.for_each(|p| self.reads(p.event));
            // What the world does is not known.
            let wanted = |list: &&[TypedOccurrence]| -> Option<Vec<WantedFact>> {
                list.iter().map(|o| o.as_event().map(WantedFact::of)).collect()
            };
            self.needs.push(requirement.pattern.needs().iter().filter_map(wanted).collect());
        }
        let counted = scenario.points.iter().flat_map(|p| &p.count);
        for pattern in scenario.assumptions.iter().flat_map(|a| &a.events).chain(counted) {
            self.reads(pattern.event);
        }
    }

    fn world(&mut self, scenario: &Scenario) {
        for rule in scenario.world.iter().flat_map(|w| &w.rules) {
            self.makes_exprs(rule.event, &rule.args);
            match &rule.on {
                RuleTrigger::Event(pattern) => self.waits_for(rule.origin, vec![WantedFact::of(pattern)]),
                RuleTrigger::Commanded { .. } | RuleTrigger::Edge { .. } => {}
            }
        }
    }

    fn suites(&mut self, scenario: &Scenario) {
        for (index, suite) in scenario.suites.iter().enumerate() {
            let TypedMethod::Random { stimuli, awaits, .. } = &suite.method else { continue };
            for stimulus in stimuli {
                self.makes(*stimulus, std::iter::empty());
            }
            let places = scenario.places.awaits.get(index);
            for (i, pattern) in awaits.iter().enumerate() {
                let span = places.and_then(|p| p.get(i)).copied().unwrap_or(suite.origin);
                self.waits_for(span, vec![WantedFact::of(pattern)]);
            }
        }
        for step in scenario.tests.iter().flat_map(|t| &t.scripts).flat_map(|script| &script.steps) {
            match step {
                TestStep::Do { event, args, .. } => self.makes(*event, args.iter().copied().map(Some)),
                TestStep::Await { events, .. } => events.iter().for_each(|p| self.reads(p.event)),
                TestStep::Wait { .. } => {}
            }
        }
    }

    /// Marks the events whose absence is said at a wait or a requirement; that of a stimulus is said at itself.
    fn tell(&mut self) {
        let all = self.waits.iter().map(|w| &w.any_of).chain(self.needs.iter().flatten());
        let told: Vec<EventId> =
            all.filter(|any_of| self.in_vain(any_of)).flatten().map(|w| w.event).collect();
        for event in told {
            if let Some(e) = self.events.get_mut(at(event)) {
                e.told = true;
            }
        }
    }
}

fn at(event: EventId) -> usize {
    usize::from(event.0)
}
