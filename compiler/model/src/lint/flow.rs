//! The values that an automaton's own variables can have in each location: a fixpoint of intervals over its edges.

use std::{collections::VecDeque, rc::Rc};

use crate::{
    Channel, ChannelKind, ClockOp, EventId, FunctionId, LocationId, ReceiveArg, Scenario, TypedAutomaton,
    TypedClockConstraint, TypedEdge, TypedEvent, TypedExpr, TypedExprKind, TypedSync, TypedUpdate,
    VariableRef, interval::ValueInterval, leaves, lint::interval::IntervalEnv,
};

/// After so many visits of a location what still grows is taken to reach the end of its range.
const PATIENCE: u32 = 6;
/// And after so many, all variables are.
const END: u32 = 24;

/// The declared ranges that all automata see.
struct VarRanges {
    /// Any automaton may set a shared variable at any time.
    shared: Vec<ValueInterval>,
    /// By event.
    params: Vec<Vec<ValueInterval>>,
    /// By function: the variables that it may assign.
    assigns: Vec<Vec<VariableRef>>,
    /// By channel.
    channels: Vec<Vec<ValueInterval>>,
    /// By channel: it is a broadcast.
    broadcasts: Vec<bool>,
    /// How many clocks are shared: those come first.
    clocks: usize,
}

/// What is known about one automaton.
pub(crate) struct ValueFlow {
    ranges: Rc<VarRanges>,
    own: Vec<ValueInterval>,
    /// By location: what holds of the variables there.
    holds: Vec<Option<TypedExpr>>,
    /// By location; `None`: no edge reaches it.
    states: Vec<Option<Vec<ValueInterval>>>,
    /// The edges out of each location.
    pub out: Vec<Vec<usize>>,
}

/// The flows of all automata.
pub(crate) fn flows(scenario: &Scenario) -> Vec<ValueFlow> {
    let of_event = |e: &TypedEvent| e.params.iter().map(|p| ValueInterval::of(p.ty)).collect();
    let of_channel = |c: &Channel| c.params.iter().map(|p| ValueInterval::of(p.ty())).collect();
    let ranges = Rc::new(VarRanges {
        shared: scenario.shared.iter().map(|v| ValueInterval::of(v.ty())).collect(),
        params: scenario.events.iter().map(of_event).collect(),
        assigns: scenario.effects.iter().map(|f| f.assigns.clone()).collect(),
        channels: scenario.channels.iter().map(of_channel).collect(),
        broadcasts: scenario.channels.iter().map(|c| c.kind == ChannelKind::Broadcast).collect(),
        clocks: scenario.clocks.len(),
    });
    scenario.automata.iter().map(|a| ValueFlow::of(a, Rc::clone(&ranges))).collect()
}

impl ValueFlow {
    fn of(automaton: &TypedAutomaton, ranges: Rc<VarRanges>) -> Self {
        let own = automaton.vars.iter().map(|v| ValueInterval::of(v.ty())).collect();
        let mut out = vec![Vec::new(); automaton.locations.len()];
        for (i, edge) in automaton.edges.iter().enumerate() {
            if let Some(edges) = out.get_mut(at(edge.from)) {
                edges.push(i);
            }
        }
        let states = vec![None; automaton.locations.len()];
        let holds = automaton.locations.iter().map(|l| l.holds.clone()).collect();
        let mut flow = Self { ranges, own, holds, states, out };
        flow.grow(automaton);
        flow.shrink(automaton);
        flow.shrink(automaton);
        flow
    }

    /// From the initial values up, until nothing changes.
    fn grow(&mut self, automaton: &TypedAutomaton) {
        let first = at(automaton.initial);
        let Some(state) = self.states.get_mut(first) else { return };
        *state = Some(initial(automaton));
        let mut visits = vec![0u32; self.states.len()];
        let mut waiting = vec![false; self.states.len()];
        let mut queue = VecDeque::from([first]);
        while let Some(from) = queue.pop_front() {
            waiting[from] = false;
            for i in self.out[from].clone() {
                let edge = &automaton.edges[i];
                let Some(after) = self.after(edge) else { continue };
                let to = at(edge.to);
                if self.widen(to, after, &mut visits) && !std::mem::replace(&mut waiting[to], true) {
                    queue.push_back(to);
                }
            }
        }
    }

    /// Joins a state into a location's; whether that changed it.
    fn widen(&mut self, to: usize, after: Vec<ValueInterval>, visits: &mut [u32]) -> bool {
        let Some(known) = &mut self.states[to] else {
            self.states[to] = Some(after);
            return true;
        };
        let mut changed = false;
        let count = visits[to];
        for ((old, new), range) in known.iter_mut().zip(after).zip(&self.own) {
            if new.within(*old) && count < END {
                continue;
            }
            let joined = old.join(new);
            let wider = ValueInterval {
                lo: if joined.lo < old.lo { range.lo } else { old.lo },
                hi: if joined.hi > old.hi { range.hi } else { old.hi },
            };
            let next = if count >= END {
                *range
            } else if count >= PATIENCE {
                wider
            } else {
                joined
            };
            changed |= next != *old;
            *old = next;
        }
        visits[to] += u32::from(changed);
        changed
    }

    /// One step down: what the edges bring, where they were taken to bring more.
    fn shrink(&mut self, automaton: &TypedAutomaton) {
        let mut next: Vec<Option<Vec<ValueInterval>>> = vec![None; self.states.len()];
        if let Some(state) = next.get_mut(at(automaton.initial)) {
            *state = Some(initial(automaton));
        }
        for edge in &automaton.edges {
            let Some(after) = self.after(edge) else { continue };
            let Some(state) = next.get_mut(at(edge.to)) else { continue };
            match state {
                None => *state = Some(after),
                Some(known) => known.iter_mut().zip(after).for_each(|(old, new)| *old = old.join(new)),
            }
        }
        self.states = next;
    }

    pub fn reached(&self, location: LocationId) -> bool {
        self.states.get(at(location)).is_some_and(Option::is_some)
    }

    /// What is known when an edge is taken; `None`: its source is not reached, or its guard is never true there.
    pub fn taken(&self, edge: &TypedEdge) -> Option<IntervalEnv<'_>> {
        let own = self.states.get(at(edge.from))?.as_ref()?;
        if contradictory(&edge.clock_guard) {
            return None;
        }
        let mut env = IntervalEnv::new(own, &self.ranges.shared, self.locals(edge));
        let holds = self.holds.get(at(edge.from)).and_then(Option::as_ref);
        let possible = holds.into_iter().chain(&edge.guard).all(|g| env.assume(g, true));
        possible.then_some(env)
    }

    /// The selects, then what the event or channel binds.
    fn locals(&self, edge: &TypedEdge) -> Vec<ValueInterval> {
        let mut locals: Vec<ValueInterval> = edge.selects.iter().map(|p| ValueInterval::of(p.ty())).collect();
        let (args, params) = match &edge.sync {
            TypedSync::Receive { event, args } => (args, self.params(*event)),
            TypedSync::Accept { channel, args } => {
                (args, self.ranges.channels.get(usize::from(channel.0)).map_or(&[][..], Vec::as_slice))
            }
            TypedSync::Internal
            | TypedSync::Send { .. }
            | TypedSync::Offer { .. }
            | TypedSync::Join { .. } => return locals,
        };
        let bound = args.iter().zip(params).filter(|(a, _)| **a == ReceiveArg::Bind);
        locals.extend(bound.map(|(_, range)| *range));
        locals
    }

    /// Whether an edge only follows another automaton, which need not wait for it.
    pub fn only_hears(&self, edge: &TypedEdge) -> bool {
        match &edge.sync {
            TypedSync::Receive { .. } => true,
            TypedSync::Accept { channel, .. } => {
                self.ranges.broadcasts.get(usize::from(channel.0)).copied().unwrap_or(false)
            }
            TypedSync::Internal
            | TypedSync::Send { .. }
            | TypedSync::Offer { .. }
            | TypedSync::Join { .. } => false,
        }
    }

    /// Whether no other automaton sets the clocks of a bound.
    pub fn is_own(&self, bound: &TypedClockConstraint) -> bool {
        bound.clocks().all(|c| usize::from(c.0) >= self.ranges.clocks)
    }

    /// The ranges of an event's parameters.
    pub fn params(&self, event: EventId) -> &[ValueInterval] {
        self.ranges.params.get(usize::from(event.0)).map_or(&[], Vec::as_slice)
    }

    /// The variable that an update sets, its new value, and its range.
    pub fn set_by<'e>(&self, update: &'e TypedUpdate) -> Option<(VariableRef, &'e TypedExpr, ValueInterval)> {
        match update {
            TypedUpdate::Assign { place, value } if place.indices.is_empty() => {
                Some((place.slot, value, self.range_of(place.slot)))
            }
            TypedUpdate::Assign { .. } | TypedUpdate::Call { .. } | TypedUpdate::Reset { .. } => None,
        }
    }

    /// What an update may set besides [`Self::set_by`]: of elements and in functions any value.
    pub fn disturb(&self, env: &mut IntervalEnv<'_>, update: &TypedUpdate) {
        let mut set: Vec<VariableRef> = Vec::new();
        let mut called = |e: &TypedExpr| {
            e.each(&mut |part| {
                if let TypedExprKind::Apply(f, ..) = part.kind {
                    set.extend(self.assigned_by(f));
                }
            });
        };
        match update {
            TypedUpdate::Assign { place, value } => {
                called(value);
                if !place.indices.is_empty() {
                    set.extend(leaves(place));
                }
            }
            TypedUpdate::Call { function: f, args } => {
                args.iter().for_each(called);
                set.extend(self.assigned_by(*f));
            }
            TypedUpdate::Reset { .. } => {}
        }
        for leaf in set {
            env.assign(leaf, self.range_of(leaf));
        }
    }

    /// The declared range of a variable.
    fn range_of(&self, leaf: VariableRef) -> ValueInterval {
        let range = match leaf {
            VariableRef::Own(i) => self.own.get(usize::from(i)),
            VariableRef::Shared(i) => self.ranges.shared.get(usize::from(i)),
            VariableRef::Local(_) | VariableRef::Signal(_) => None,
        };
        range.copied().unwrap_or(ValueInterval::ALL)
    }

    fn assigned_by(&self, function: FunctionId) -> &[VariableRef] {
        self.ranges.assigns.get(usize::from(function.0)).map_or(&[], Vec::as_slice)
    }

    /// The variables after an edge; a value outside of its range does not get there.
    fn after(&self, edge: &TypedEdge) -> Option<Vec<ValueInterval>> {
        let mut env = self.taken(edge)?;
        for update in &edge.updates {
            self.disturb(&mut env, update);
            if let Some((leaf, e, range)) = self.set_by(update) {
                env.assign(leaf, env.eval(e).meet(range)?);
            }
        }
        let mut after = env.own.to_vec();
        for (leaf, known) in &env.less {
            if let VariableRef::Own(i) = leaf
                && let Some(slot) = after.get_mut(usize::from(*i))
            {
                *slot = *known;
            }
        }
        Some(after)
    }
}

fn initial(automaton: &TypedAutomaton) -> Vec<ValueInterval> {
    automaton.vars.iter().map(|v| v.value(v.init).map_or(ValueInterval::ALL, ValueInterval::value)).collect()
}

fn at(location: LocationId) -> usize {
    usize::from(location.0)
}

/// Whether a clock would have to be above and below something at once.
fn contradictory(guard: &[TypedClockConstraint]) -> bool {
    guard.iter().any(|low| guard.iter().any(|high| clash(low, high)))
}

/// Whether the first demands more than the second allows, of the same clock or difference of clocks; of bounds with
/// variables that is not known.
pub(crate) fn clash(low: &TypedClockConstraint, high: &TypedClockConstraint) -> bool {
    let open_below = match low.op {
        ClockOp::Ge | ClockOp::Eq => false,
        ClockOp::Gt => true,
        ClockOp::Lt | ClockOp::Le => return false,
    };
    let open_above = match high.op {
        ClockOp::Le | ClockOp::Eq => false,
        ClockOp::Lt => true,
        ClockOp::Gt | ClockOp::Ge => return false,
    };
    let Some((lower, upper)) = low.bound.fixed().zip(high.bound.fixed()) else { return false };
    let same = (low.clock, low.minus) == (high.clock, high.minus);
    same && (lower > upper || lower >= upper && (open_below || open_above))
}

#[cfg(test)]
mod tests;
