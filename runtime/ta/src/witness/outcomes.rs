//! What may happen next in the interpreter's state: each transition that is possible right now or later, or the fault that it is.

use std::ops::ControlFlow;

use hrdsl_ir::{
    Value,
    ta::{ChannelId, ChannelKind, ClockConstraint, LocationKind, SyncLabel},
};

use crate::{
    network::{code::SyncMedium, error::ModelError, selects::choices, semantics::AutomatonMove},
    witness::concrete::ConcreteInterpreter,
};

/// What is done with the outcome of each transition.
type OutcomeVisitor<'a, 'p> = dyn FnMut(Result<ConcreteInterpreter<'p>, ModelError>) -> ControlFlow<()> + 'a;

impl<'p> ConcreteInterpreter<'p> {
    /// Whether some transition is possible right now.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn can_move(&self) -> Result<bool, ModelError> {
        Ok(self.each_next(&mut |_| ControlFlow::Break(()))?.is_break())
    }

    /// Shows what each transition that is possible right now leads to, until it breaks off.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn each_next(
        &self,
        f: &mut dyn FnMut(ConcreteInterpreter<'p>) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, ModelError> {
        let mut fault = None;
        let flow = self.each_outcome(&mut |outcome| match outcome {
            Ok(next) => f(next),
            Err(error) => {
                fault = Some(error);
                ControlFlow::Break(())
            }
        });
        fault.map_or(Ok(flow), Err)
    }

    /// The faults of the model that are met by what may happen right now.
    pub(crate) fn faults(&self) -> Vec<ModelError> {
        let mut all = Vec::new();
        let _ = self.each_outcome(&mut |outcome| {
            all.extend(outcome.err());
            ControlFlow::Continue(())
        });
        all
    }

    /// Shows what each transition that is possible right now leads to, or the fault that it is, until it breaks off.
    fn each_outcome(&self, f: &mut OutcomeVisitor<'_, 'p>) -> ControlFlow<()> {
        let mut groups: Vec<Vec<Vec<AutomatonMove>>> = Vec::new();
        for (automaton, a) in self.members.iter().enumerate() {
            for (edge, e) in a.edges.iter().enumerate().filter(|(_, e)| e.from == self.location[automaton]) {
                // What takes something moves with whoever sends it, and binds the arguments then.
                if !starts(&e.sync) || self.must_wait(automaton, &e.sync) {
                    continue;
                }
                for binders in choices(&e.selects) {
                    let m = AutomatonMove { automaton, edge, binders };
                    match self.is_open(&m) {
                        Ok(true) => self.partners(&m, &mut groups, f)?,
                        Err(fault) if self.could_join(&e.sync) => f(Err(fault))?,
                        Ok(false) | Err(_) => {}
                    }
                }
            }
        }
        groups.iter().try_for_each(|group| self.each_combination(group, f))
    }

    /// Whether all that must take part in what an edge joins could, and committed locations let them: what else is wrong with it does not
    /// matter.
    fn could_join(&self, sync: &SyncLabel) -> bool {
        let SyncLabel::Join { channel } = sync else { return true };
        let Some(ChannelKind::MultiWay(participants)) = self.channel(*channel).map(|c| &c.kind) else {
            return true;
        };
        let mut committed = !self.any_committed();
        for p in participants {
            let Some(member) = self.member(p.automaton) else { continue };
            let moves = self.receptions(member, SyncMedium::Channel(*channel), &[], true);
            let could = moves.map_or(true, |moves| !moves.is_empty());
            if !could && !p.optional {
                return false;
            }
            committed |= could && self.kind(member) == LocationKind::Committed;
        }
        committed
    }

    /// A committed location of another automaton forbids what this one does alone.
    fn must_wait(&self, automaton: usize, sync: &SyncLabel) -> bool {
        matches!(sync, SyncLabel::Internal)
            && self.any_committed()
            && self.kind(automaton) != LocationKind::Committed
    }

    /// The transitions that an open edge starts: for each, what each automaton that takes part may do.
    fn partners(
        &self,
        m: &AutomatonMove,
        groups: &mut Vec<Vec<Vec<AutomatonMove>>>,
        f: &mut OutcomeVisitor<'_, 'p>,
    ) -> ControlFlow<()> {
        let hear = |medium: SyncMedium, args: &[Value], f: &mut OutcomeVisitor<'_, 'p>| {
            let mut all = vec![vec![m.clone()]];
            for o in self.others(m.automaton) {
                let moves = self.hearing(o, medium, args, f)?;
                if !moves.is_empty() {
                    all.push(moves);
                }
            }
            ControlFlow::Continue(all)
        };
        match &self.edge(m).sync {
            SyncLabel::Internal => groups.push(vec![vec![m.clone()]]),
            SyncLabel::Send { event, args } => match self.arguments(m, *event, args) {
                Ok(args) => groups.push(hear(SyncMedium::Event(*event), &args, f)?),
                Err(fault) => f(Err(fault))?,
            },
            SyncLabel::Offer { channel, args } => {
                let Some(declared) = self.channel(*channel) else { return ControlFlow::Continue(()) };
                let args = match self.offered(m, declared, args) {
                    Ok(args) => args,
                    Err(fault) => return f(Err(fault)),
                };
                let all = hear(SyncMedium::Channel(*channel), &args, f)?;
                match declared.kind {
                    ChannelKind::Broadcast => groups.push(all),
                    // One partner at a time: each of those that could accept is another transition.
                    ChannelKind::Binary | ChannelKind::MultiWay(_) => {
                        groups.extend(all.into_iter().skip(1).map(|moves| vec![vec![m.clone()], moves]));
                    }
                }
            }
            SyncLabel::Join { channel } => groups.extend(self.multiway(*channel, m, f)?),
            SyncLabel::Receive { .. } | SyncLabel::Accept { .. } => {}
        }
        ControlFlow::Continue(())
    }

    /// As [`receptions`](Self::receptions), with the clocks; a fault is shown.
    fn hearing(
        &self,
        member: usize,
        medium: SyncMedium,
        args: &[Value],
        f: &mut OutcomeVisitor<'_, 'p>,
    ) -> ControlFlow<(), Vec<AutomatonMove>> {
        match self.receptions(member, medium, args, true) {
            Ok(moves) => ControlFlow::Continue(moves),
            Err(fault) => {
                f(Err(fault))?;
                ControlFlow::Continue(Vec::new())
            }
        }
    }

    /// What each participant of a multi-way channel may do; nothing if a participant that must take part cannot, or if the given move is
    /// not the first participant's, which starts it.
    fn multiway(
        &self,
        id: ChannelId,
        first: &AutomatonMove,
        f: &mut OutcomeVisitor<'_, 'p>,
    ) -> ControlFlow<(), Option<Vec<Vec<AutomatonMove>>>> {
        let Some(ChannelKind::MultiWay(participants)) = self.channel(id).map(|c| &c.kind) else {
            return ControlFlow::Continue(None);
        };
        let (mut all, mut faults) = (Vec::new(), Vec::new());
        for p in participants {
            let Some(member) = self.member(p.automaton) else { continue };
            match self.receptions(member, SyncMedium::Channel(id), &[], true) {
                Ok(moves) if moves.is_empty() && !p.optional => return ControlFlow::Continue(None),
                Ok(moves) if moves.is_empty() => {}
                Ok(moves) => all.push(moves),
                Err(fault) => faults.push(fault),
            }
        }
        if !faults.is_empty() {
            if self.could_join(&SyncLabel::Join { channel: id }) {
                faults.into_iter().try_for_each(|fault| f(Err(fault)))?;
            }
            return ControlFlow::Continue(None);
        }
        // Every open edge of a participant is asked whether it starts this; only the first participant's do, or each combination would come
        // once for each of its parts.
        ControlFlow::Continue(all.first().is_some_and(|moves| moves.contains(first)).then_some(all))
    }

    /// Each choice of a move for each automaton.
    fn each_combination(
        &self,
        group: &[Vec<AutomatonMove>],
        f: &mut OutcomeVisitor<'_, 'p>,
    ) -> ControlFlow<()> {
        let takes_committed =
            group.iter().any(|moves| self.kind(moves[0].automaton) == LocationKind::Committed);
        // INVARIANT: a list of the group is of one automaton, and none is empty. One committed part lets all the others move with it.
        if self.any_committed() && !takes_committed {
            return ControlFlow::Continue(());
        }
        let mut at = vec![0; group.len()];
        loop {
            // Guards and arguments were worked out in the state before; updates go one after the other, in the order of the parts.
            let mut next = self.clone();
            let taken = group.iter().zip(&at).try_for_each(|(moves, &i)| next.take(&moves[i]));
            match taken.and_then(|()| next.broken_invariant()) {
                Ok(None) => f(Ok(next))?,
                // A transition into an invariant that does not hold is not there; it is no fault.
                Ok(Some(_)) => {}
                Err(fault) => f(Err(fault))?,
            }
            let Some(turn) = (0..at.len()).rev().find(|&i| at[i] + 1 < group[i].len()) else {
                return ControlFlow::Continue(());
            };
            at[turn] += 1;
            at[turn + 1..].fill(0);
        }
    }

    /// Whether some transition is possible now or after some delay.
    ///
    /// Between two neighbouring bounds of the clocks' constraints nothing changes, so it looks at each bound and half a tick to
    /// either side.
    ///
    /// # Errors
    /// If the model is at fault.
    pub(crate) fn can_ever_move(&self) -> Result<bool, ModelError> {
        if self.can_move()? {
            return Ok(true);
        }
        if !self.may_wait() {
            return Ok(false);
        }
        let finer = self.in_half_ticks();
        for later in finer.turns() {
            let mut then = finer.clone();
            then.advance(later);
            if then.broken_invariant()?.is_none() && then.can_move()? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The times from now on at which a constraint may change its value, in order.
    fn turns(&self) -> Vec<i128> {
        let mut times = Vec::new();
        for (member, a) in self.members.iter().enumerate() {
            let edges = a.edges.iter().filter(|e| e.from == self.location[member]);
            // Invariants of targets count, too: an edge may be open before the location that it leads to can be entered.
            let targets = edges.clone().flat_map(|e| &a.locations[usize::from(e.to.0)].invariant);
            let guards = edges.clone().flat_map(|e| e.clock_guard.iter().map(move |c| (e, c)));
            for c in targets.chain(&self.place(member).invariant) {
                self.note_turn(member, &[], c, &mut times);
            }
            for (e, c) in guards {
                for binders in choices(&e.selects) {
                    self.note_turn(member, &binders, c, &mut times);
                }
            }
        }
        times.retain(|t| *t > self.now);
        times.sort_unstable();
        times.dedup();
        times
    }

    fn note_turn(&self, member: usize, binders: &[Value], c: &ClockConstraint, times: &mut Vec<i128>) {
        // The difference of two clocks does not change with time. A bound without a value is a fault of its edge, which is met where the
        // edge is tried.
        if let (None, Ok(bound)) = (c.minus, self.span(member, binders, &c.bound)) {
            let at = self.zero_at(member, c.clock) + bound;
            times.extend([at - 1, at, at + 1]);
        }
    }
}

/// Whether such an edge can begin a transition.
fn starts(sync: &SyncLabel) -> bool {
    match sync {
        SyncLabel::Internal | SyncLabel::Send { .. } | SyncLabel::Offer { .. } | SyncLabel::Join { .. } => {
            true
        }
        SyncLabel::Receive { .. } | SyncLabel::Accept { .. } => false,
    }
}
