//! How an agent stands: what it intends, what each intention waits for, what it believes.

use hrdsl_ir::Span;
use rustc_hash::FxHashMap;
use serde::Serialize;

use crate::{
    belief::FactAnnotations,
    cycle::AgentMachine,
    event::{EventArguments, QueuedEvent},
    intention::{Intention, IntentionState, IntentionTimer},
    log::{LogEntry, LogItem},
    show::{self, call},
};

/// An intention, to be read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct IntentionSummary {
    /// As in the log; 0: it has no plan yet.
    pub intention: u32,
    /// Its plans with the arguments of what they were selected for, the lowest first: `leg#2(1)`. Of many the lowest and the
    /// highest, and between them how many more there are: `(90 more)`.
    pub plans: Vec<String>,
    /// `await released within 90 s, until 95 s`
    pub waits: String,
    pub suspended: bool,
    /// Where the step stands that it does or waits for; until its event has a plan, the step that made the event; `None`: it has no plan yet.
    #[serde(skip)]
    pub origin: Option<Span>,
}

/// So many plans are told at each end of a stack.
const TOLD: usize = 8;

impl AgentMachine<'_> {
    /// The event that an entry is about, if it is about the choice of a plan.
    pub fn event_of(&self, entry: &LogEntry) -> Option<String> {
        let (LogItem::Selected { on, args, .. }
        | LogItem::Tried { on, args, .. }
        | LogItem::Unhandled { on, args, .. }) = &entry.what
        else {
            return None;
        };
        Some(self.names().on(*on, args))
    }

    /// Where the plan or step stands that an entry is about, if it is about one.
    pub fn origin_in(&self, entry: &LogEntry) -> Option<Span> {
        match &entry.what {
            LogItem::Failed(failure) => Some(failure.origin),
            LogItem::Fault { origin, .. } | LogItem::Unhandled { origin, .. } => Some(*origin),
            LogItem::Selected { plan, .. } | LogItem::Tried { plan, .. } => {
                Some(self.mind.library.plan(*plan).origin)
            }
            LogItem::Step { plan, line, .. } => self.mind.library.origin_at(*plan, *line),
            LogItem::FaultyAnswer { .. }
            | LogItem::Finished
            | LogItem::Dropped
            | LogItem::Added { .. }
            | LogItem::Left { .. }
            | LogItem::Taken { .. }
            | LogItem::StillHeld { .. }
            | LogItem::Refused { .. }
            | LogItem::Perceived { .. }
            | LogItem::Heard { .. }
            | LogItem::Asked { .. }
            | LogItem::Answered { .. }
            | LogItem::Printed(_)
            | LogItem::Livelock
            | LogItem::Endless
            | LogItem::Overfull(_) => None,
        }
    }

    /// What it intends, in the order of adoption.
    pub fn standing(&self) -> Vec<IntentionSummary> {
        let places = self.mind.pool.in_order();
        let posted: FxHashMap<u32, &QueuedEvent> =
            self.mind.events.iter().filter_map(|e| Some((e.of?, e))).collect();
        let stands = |place| self.stands(self.mind.pool.see(place), posted.get(&place).copied());
        places.into_iter().map(stands).collect()
    }

    /// With the event whose plan it waits for.
    fn stands(&self, intention: &Intention, posted: Option<&QueuedEvent>) -> IntentionSummary {
        let plan = |frame: &crate::intention::PlanFrame| {
            let label = &self.mind.library.plan(frame.plan).label;
            let args = intention.args(*frame).iter();
            call(label, args.map(|a| a.map_or_else(|| "_".to_owned(), |v| v.to_string())))
        };
        let mut waits = self.waits(intention, posted);
        if let Some(due) = intention.deadlines.iter().map(|d| d.timer.due).min() {
            waits += &format!(", deadline {}", show::time(due));
        }
        let (count, frames) = (intention.frames.len(), &intention.frames);
        let plans = if count > 2 * TOLD + 1 {
            let more = format!("({} more)", count - 2 * TOLD);
            let (lowest, highest) = (&frames[..TOLD], &frames[count - TOLD..]);
            lowest.iter().map(plan).chain([more]).chain(highest.iter().map(plan)).collect()
        } else {
            frames.iter().map(plan).collect()
        };
        let origin = frames.last().and_then(|top| self.mind.library.origin_at(top.plan, top.at));
        IntentionSummary { intention: intention.number, plans, waits, suspended: intention.suspended, origin }
    }

    fn waits(&self, intention: &Intention, posted: Option<&QueuedEvent>) -> String {
        let until = |timer: Option<IntentionTimer>| {
            timer.map_or_else(String::new, |t| format!(", until {}", show::time(t.due)))
        };
        match intention.state {
            IntentionState::Free | IntentionState::Ready | IntentionState::Held => "for its turn".to_owned(),
            IntentionState::Posted => match posted.map(|e| self.names().on(e.on, &e.args)) {
                Some(event) => format!("for a plan for {event}"),
                None => "for a plan".to_owned(),
            },
            IntentionState::Acting(_) => format!("for the end of {}", self.step_of(intention)),
            IntentionState::Sleeping(timer) => self.step_of(intention) + &until(Some(timer)),
            IntentionState::Awaiting { timer, .. } | IntentionState::Asking { timer, .. } => {
                self.step_of(intention) + &until(timer)
            }
            IntentionState::Forked { left, all } => {
                let which = if all { "all" } else { "the first" };
                format!("for {which} of its branches ({left} not finished)")
            }
        }
    }

    /// The step that the top plan is at.
    fn step_of(&self, intention: &Intention) -> String {
        let top = intention.top();
        self.names().line(top.plan, top.at, intention.vars())
    }

    /// What it believes, in the order of declarations, then oldest first: `wants(2)[source(self)]`.
    pub fn believed(&self) -> Vec<String> {
        let names = self.names();
        let text = |fact: hrdsl_ir::bdi::InitialFact| {
            let args: EventArguments = fact.args.iter().map(|v| Some(*v)).collect();
            names.fact(fact.belief, &args, &FactAnnotations::from_slice(&fact.annotations))
        };
        self.mind.beliefs.facts().map(text).collect()
    }
}
