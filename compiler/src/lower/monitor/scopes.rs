//! Scopes: when the part of a pattern is entered and left, and when what it finds counts.

use hrdsl_ir::monitor::{MonitorEdge, MonitorEffect, MonitorMargin, MonitorState, MonitorTrigger, StateId};
use hrdsl_model::{self as model, TypedOccurrence};
use hrdsl_syntax::RequirementScope;

use super::parts::{MonitorParts, PartEntry, PatternPart, edge, number};
use MonitorEffect::{Fail, ResetClock, Suspect};

/// What kind of part of a run a scope is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ScopeSort {
    /// All of it.
    Whole,
    /// One that counts from its beginning.
    Open,
    /// One that counts only if it ends.
    Closed,
}

/// The causes that open and close a scope.
pub(super) struct ScopeCauses {
    sort: ScopeSort,
    /// `None`: it is open from the start, and once only.
    opens: Option<Vec<MonitorTrigger>>,
    closes: Vec<MonitorTrigger>,
}

/// A monitor but for what it is called and what it reads.
pub(super) struct ScopedMachine {
    pub states: Vec<MonitorState>,
    pub initial: StateId,
    pub at_start: Vec<MonitorEffect>,
    pub edges: Vec<MonitorEdge>,
    pub margin: Option<MonitorMargin>,
}

impl MonitorParts<'_, '_> {
    pub fn scope(&mut self, scope: &RequirementScope<TypedOccurrence, model::TypedExpr>) -> ScopeCauses {
        let (sort, opens, closes) = match scope {
            RequirementScope::Whole => (ScopeSort::Whole, None, Vec::new()),
            RequirementScope::Before(end) => (ScopeSort::Closed, None, self.causes(end)),
            RequirementScope::After(start) => (ScopeSort::Open, Some(self.causes(start)), Vec::new()),
            RequirementScope::Between(start, end) => {
                (ScopeSort::Closed, Some(self.causes(start)), self.causes(end))
            }
            RequirementScope::AfterUntil(start, end) => {
                (ScopeSort::Open, Some(self.causes(start)), self.causes(end))
            }
            RequirementScope::While(condition) => {
                let (condition, _) = self.condition(condition);
                let becomes = |truth| vec![MonitorTrigger::Becomes { condition, truth, first: true }];
                (ScopeSort::Open, Some(becomes(true)), becomes(false))
            }
        };
        ScopeCauses { sort, opens, closes }
    }
}

impl ScopeCauses {
    pub fn sort(&self) -> ScopeSort {
        self.sort
    }

    /// The monitor that has the part in it.
    pub fn around(&self, part: PatternPart) -> ScopedMachine {
        match self.sort {
            ScopeSort::Whole => whole(part),
            ScopeSort::Open | ScopeSort::Closed => self.scoped(part),
        }
    }

    /// Its first state is outside.
    fn scoped(&self, part: PatternPart) -> ScopedMachine {
        let broken = number(part.states.len() + 1);
        let mut states = vec![MonitorState { name: "outside".to_owned(), pending: false, deadline: None }];
        let mut edges = Vec::new();
        let entries: Vec<PartEntry> = part.entries.into_iter().map(|e| self.entry(e, broken)).collect();
        for (on, entry) in self.opens.iter().flatten().flat_map(|on| entries.iter().map(move |e| (on, e))) {
            edges.push(edge(0, entry.to, on.clone(), entry.guard.clone(), &entry.effects));
        }
        // What ends the scope is not in it.
        for (inside, at) in part.states.iter().zip(1..) {
            edges.extend(self.closes.iter().map(|on| edge(at, 0, on.clone(), None, &inside.closing)));
        }
        edges.extend(part.edges.into_iter().map(|e| self.edge(e, broken)));
        states.extend(part.states.into_iter().map(|s| s.state));
        if self.sort == ScopeSort::Closed && edges.iter().any(|e| e.to.0 == broken) {
            states.push(MonitorState { name: "broken".to_owned(), pending: true, deadline: None });
            edges.extend(self.closes.iter().map(|on| edge(broken, 0, on.clone(), None, &[Fail])));
        }
        let inside = (1..number(states.len())).map(StateId).collect();
        let start = entries.last().filter(|_| self.opens.is_none());
        ScopedMachine {
            initial: StateId(start.map_or(0, |entry| entry.to)),
            at_start: start.map_or_else(Vec::new, |entry| at_start(&entry.effects)),
            states,
            edges,
            margin: part.margin.map(|margin| MonitorMargin { within: inside, ..margin }),
        }
    }

    fn entry(&self, entry: PartEntry, broken: u16) -> PartEntry {
        let (to, effects) = self.counted(entry.to + 1, entry.effects, broken);
        PartEntry { to, effects, ..entry }
    }

    fn edge(&self, edge: MonitorEdge, broken: u16) -> MonitorEdge {
        let (to, effects) = self.counted(edge.to.0 + 1, edge.effects, broken);
        MonitorEdge { from: StateId(edge.from.0 + 1), to: StateId(to), effects, ..edge }
    }

    /// Where an edge leads, and what it does: a failure in a part of a run that has yet to end is none before it does.
    fn counted(&self, to: u16, mut effects: Vec<MonitorEffect>, broken: u16) -> (u16, Vec<MonitorEffect>) {
        if self.sort == ScopeSort::Open || !effects.contains(&Fail) {
            return (to, effects);
        }
        for effect in &mut effects {
            if *effect == Fail {
                *effect = Suspect;
            }
        }
        (broken, effects)
    }
}

/// It begins by the last way in: nothing is measured yet.
fn whole(part: PatternPart) -> ScopedMachine {
    let start = part.entries.last();
    ScopedMachine {
        initial: StateId(start.map_or(0, |entry| entry.to)),
        at_start: start.map_or_else(Vec::new, |entry| at_start(&entry.effects)),
        states: part.states.into_iter().map(|s| s.state).collect(),
        edges: part.edges,
        margin: part.margin,
    }
}

/// The clock is zero anyway.
fn at_start(effects: &[MonitorEffect]) -> Vec<MonitorEffect> {
    effects.iter().copied().filter(|effect| *effect != ResetClock).collect()
}
