//! Assumptions with a window, exactly: `at most N e within D` as an automaton that forbids one event too many.
//!
//! It keeps the times since the last N such events as clocks, the newest first. If there were N and the oldest is not more
//! than D ago, the next one would lead to a location whose invariant never holds: the transition does not exist.

use hrdsl_ir::{
    ActorId, EventPattern, Expr, Nanos, Span,
    expr::{BinaryOp, Lvalue},
    monitor::Assumption,
    ta::{
        Automaton, AutomatonVar, ClockConstraint, ClockId, ClockOp, Edge, EdgeAssignment, Location,
        LocationId, LocationKind, SyncLabel, TimeSum,
    },
};

use super::{
    matching::{ReceptionHalf, receptions},
    observer::{ObservedNetwork, number},
};

/// So many clocks are still worth an exact search.
const MAX_KEPT: u32 = 16;

impl ObservedNetwork {
    /// Lets the network do nothing that breaks the assumption.
    ///
    /// # Errors
    /// Why this cannot be said of a network.
    pub fn restrict(&mut self, assumption: &Assumption, within: Nanos) -> Result<(), String> {
        if assumption.at_most > MAX_KEPT {
            return Err(format!("`{}` counts more than {MAX_KEPT} events", assumption.text));
        }
        let window = AssumptionWindow {
            shared: number(self.program.shared.len()),
            first: number(self.program.clocks.len()),
            kept: assumption.at_most as u16,
            within,
            origin: assumption.origin,
        };
        let patterns: &[EventPattern] = &assumption.events;
        let mut edges = Vec::new();
        for reception in receptions(&self.program, &[patterns], window.shared + 1)? {
            window.edges(&reception, &mut edges);
        }
        let actor = self.program.actors.first().map(|_| ActorId(0));
        self.push(window.automaton(assumption, actor, edges));
        Ok(())
    }
}

struct AssumptionWindow {
    /// The number of shared variables: the slot of the automaton's own.
    shared: u16,
    /// The automaton's first clock.
    first: u16,
    kept: u16,
    within: Nanos,
    origin: Span,
}

impl AssumptionWindow {
    fn automaton(&self, assumption: &Assumption, actor: Option<ActorId>, edges: Vec<Edge>) -> Automaton {
        let location = |name: &str, invariant| Location {
            name: name.to_owned(),
            kind: LocationKind::Normal,
            invariant,
            holds: None,
            stopped: Vec::new(),
            origin: self.origin,
        };
        let mut broken = location("broken", Vec::new());
        broken.holds = Some(Expr::bool(false));
        let hi = i64::from(self.kept);
        let seen =
            AutomatonVar { name: "seen".to_owned(), lo: 0, hi, init: 0, is_bool: false, enumeration: None };
        Automaton {
            name: assumption.text.clone(),
            actor,
            clocks: (0..self.kept).map(|i| format!("since{i}")).collect(),
            vars: vec![seen],
            locations: vec![location("counting", Vec::new()), broken],
            initial: LocationId(0),
            edges,
            origin: self.origin,
        }
    }

    fn edges(&self, reception: &ReceptionHalf, out: &mut Vec<Edge>) {
        let seen = Expr::Var(self.shared);
        let full = |op| Expr::binary(op, seen.clone(), Expr::int(i64::from(self.kept)));
        let seen_one = EdgeAssignment::Assign {
            place: Lvalue::slot(self.shared),
            value: Expr::binary(BinaryOp::Add, seen.clone(), Expr::int(1)),
        };
        if self.kept > 0 {
            let mut filling = self.shifted();
            filling.push(seen_one);
            out.push(self.edge(reception, full(BinaryOp::Lt), None, 0, filling));
            let again = self.shifted();
            out.push(self.edge(reception, full(BinaryOp::Eq), Some(ClockOp::Gt), 0, again));
        }
        let late = (self.kept > 0).then_some(ClockOp::Le);
        out.push(self.edge(reception, full(BinaryOp::Eq), late, 1, Vec::new()));
    }

    fn clock(&self, i: u16) -> ClockId {
        ClockId(self.first + i)
    }

    /// Each time takes the place of the next older one.
    fn shifted(&self) -> Vec<EdgeAssignment> {
        let older = (1..self.kept).rev().map(|i| EdgeAssignment::Reset {
            clock: self.clock(i),
            from: Some(self.clock(i - 1)),
            to: TimeSum::ZERO,
        });
        older.chain(std::iter::once(EdgeAssignment::zero(self.clock(0)))).collect()
    }

    /// `oldest`: how the time since the oldest event compares with the window.
    fn edge(
        &self,
        reception: &ReceptionHalf,
        seen: Expr,
        oldest: Option<ClockOp>,
        to: u16,
        updates: Vec<EdgeAssignment>,
    ) -> Edge {
        let bound = |op| ClockConstraint {
            clock: self.clock(self.kept - 1),
            minus: None,
            op,
            bound: TimeSum::constant(self.within),
        };
        let guard = match &reception.guard {
            Some(guard) => Expr::binary(BinaryOp::And, seen, guard.clone()),
            None => seen,
        };
        Edge {
            from: LocationId(0),
            to: LocationId(to),
            selects: Vec::new(),
            clock_guard: oldest.map(bound).into_iter().collect(),
            guard: Some(guard),
            sync: SyncLabel::Receive { event: reception.event, args: reception.args.clone() },
            updates,
            origin: self.origin,
        }
    }
}
