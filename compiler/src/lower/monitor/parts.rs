//! What monitors are made of: states, edges, ways in, and what they read.

use hrdsl_ir::{
    EventPattern, Expr, Nanos,
    monitor::{
        MonitorClockGuard, MonitorEdge, MonitorEffect, MonitorMargin, MonitorState, MonitorTrigger, StateId,
    },
    world::SignalId,
};
use hrdsl_model::{self as model, TypedOccurrence};

use crate::lower::world::{SignalReader, SignalTable};

/// What the requirement reads, while its monitor is made.
pub(super) struct MonitorParts<'s, 'a> {
    pub reader: SignalReader<'s, 'a>,
    pub conditions: Vec<Expr>,
}

impl<'s, 'a> MonitorParts<'s, 'a> {
    pub fn new(signals: &'s mut SignalTable<'a>) -> Self {
        Self { reader: SignalReader::new(signals), conditions: Vec::new() }
    }

    pub fn signals(self) -> Vec<SignalId> {
        self.reader.read()
    }

    /// A condition that is watched, with what it reads.
    pub fn condition(&mut self, e: &model::TypedExpr) -> (u16, Expr) {
        let e = self.reader.expr(e);
        let at = self.conditions.iter().position(|known| *known == e).unwrap_or_else(|| {
            self.conditions.push(e.clone());
            self.conditions.len() - 1
        });
        (u16::try_from(at).unwrap_or(u16::MAX), e)
    }

    /// The causes that any of these is: one for all events, one for each condition.
    pub fn causes(&mut self, any_of: &[TypedOccurrence]) -> Vec<MonitorTrigger> {
        let events = events(any_of);
        let mut causes = if events.is_empty() { Vec::new() } else { vec![MonitorTrigger::Event(events)] };
        for (rising, condition) in any_of.iter().filter_map(TypedOccurrence::as_edge) {
            let (condition, _) = self.condition(condition);
            causes.push(MonitorTrigger::Becomes { condition, truth: rising, first: false });
        }
        causes
    }
}

pub(super) fn events(any_of: &[TypedOccurrence]) -> Vec<EventPattern> {
    any_of.iter().filter_map(TypedOccurrence::as_event).cloned().collect()
}

/// The part of a monitor that its pattern decides.
#[derive(Default)]
pub(super) struct PatternPart {
    pub states: Vec<PartState>,
    pub edges: Vec<MonitorEdge>,
    /// The ways in, of which the first is gone whose guard holds; the last has none.
    pub entries: Vec<PartEntry>,
    pub margin: Option<MonitorMargin>,
}

pub(super) struct PartState {
    pub state: MonitorState,
    /// What the end of the scope does here.
    pub closing: Vec<MonitorEffect>,
}

/// A way in.
pub(super) struct PartEntry {
    pub guard: Option<Expr>,
    pub to: u16,
    pub effects: Vec<MonitorEffect>,
}

impl PatternPart {
    /// A state, and its number.
    pub fn state(&mut self, name: &str, closing: &[MonitorEffect]) -> u16 {
        let state = MonitorState { name: name.to_owned(), pending: false, deadline: None };
        self.states.push(PartState { state, closing: closing.to_vec() });
        number(self.states.len() - 1)
    }

    /// One in which something is pending.
    pub fn pending(&mut self, name: &str, deadline: Option<Nanos>, closing: &[MonitorEffect]) -> u16 {
        let at = self.state(name, closing);
        if let Some(made) = self.states.last_mut() {
            (made.state.pending, made.state.deadline) = (true, deadline);
        }
        at
    }

    /// An edge for each of the causes.
    pub fn edges(&mut self, from: u16, to: u16, on: &[MonitorTrigger], effects: &[MonitorEffect]) {
        self.timed(from, to, on, None, effects);
    }

    pub fn timed(
        &mut self,
        from: u16,
        to: u16,
        on: &[MonitorTrigger],
        clock: Option<MonitorClockGuard>,
        effects: &[MonitorEffect],
    ) {
        for on in on {
            let edge = edge(from, to, on.clone(), None, effects);
            self.edges.push(MonitorEdge { clock, ..edge });
        }
    }

    pub fn guarded(
        &mut self,
        from: u16,
        to: u16,
        on: &[MonitorTrigger],
        guard: &Expr,
        effects: &[MonitorEffect],
    ) {
        self.edges.extend(on.iter().map(|on| edge(from, to, on.clone(), Some(guard.clone()), effects)));
    }

    pub fn entry(&mut self, guard: Option<Expr>, to: u16, effects: &[MonitorEffect]) {
        self.entries.push(PartEntry { guard, to, effects: effects.to_vec() });
    }
}

pub(super) fn number(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

pub(super) fn edge(
    from: u16,
    to: u16,
    on: MonitorTrigger,
    guard: Option<Expr>,
    effects: &[MonitorEffect],
) -> MonitorEdge {
    MonitorEdge { from: StateId(from), to: StateId(to), on, guard, clock: None, effects: effects.to_vec() }
}
