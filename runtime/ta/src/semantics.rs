//! The discrete half of the transition relation: what may happen in a discrete state, and under which clock guards.
//!
//! Which transitions there are depends on the discrete state only; each carries the clock constraints under which it is
//! possible. So a transition is named by its number among those of its state, and a path by such numbers.
//!
//! A broadcast never waits for receivers: each other automaton with an enabled receiving edge takes part by one of them.
//! Where the receiver's edges have clock guards, it takes part where one of them holds and stays away where none does,
//! which is a union of zones: one transition for each part of it.

use hrdsl_ir::{
    EventId, Expr, Type, Value,
    expr::EvalError,
    ta::{LocationKind, ReceiveArg, Sync, Update, Var},
};
use smallvec::SmallVec;

use crate::{
    ModelError,
    error::EdgeName,
    network::{Constraint, Model},
    query::any_matches,
};

/// The values of an edge's selects, then of the parameters it binds.
pub type Binders = SmallVec<[Value; 2]>;

/// One automaton's part in a transition.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Move {
    /// Index in the network.
    pub automaton: usize,
    /// Index in the automaton.
    pub edge: usize,
    pub binders: Binders,
}

/// Something that may happen in a discrete state.
pub(crate) struct Candidate {
    pub event: Option<(EventId, Vec<Value>)>,
    /// The sender's first.
    pub moves: SmallVec<[Move; 2]>,
    pub guard: SmallVec<[Constraint; 4]>,
    pub resets: SmallVec<[u16; 4]>,
    /// The discrete state after it.
    pub target: Result<Vec<i64>, Box<ModelError>>,
}

/// What one automaton may do about an event.
enum Response {
    Take(Move),
    /// It stays away where these hold.
    Absent(SmallVec<[Constraint; 4]>),
    /// Its guard has no value.
    Fault(Move, Box<ModelError>),
}

/// All combinations of the selects' values, the first select slowest.
pub(crate) fn choices(selects: &[Var]) -> Vec<Binders> {
    let mut all = vec![Binders::new()];
    for s in selects {
        let mut longer = Vec::new();
        for chosen in &all {
            for value in (s.lo..=s.hi).filter_map(|n| s.value(n)) {
                let mut next = chosen.clone();
                next.push(value);
                longer.push(next);
            }
        }
        all = longer;
    }
    all
}

/// Binds an event's arguments to a receiving edge's parameters, if they match.
pub(crate) fn bind(pattern: &[ReceiveArg], args: &[Value], binders: &mut Binders) -> bool {
    for (p, &v) in pattern.iter().zip(args) {
        match p {
            ReceiveArg::Match(hrdsl_ir::ArgPattern::Any) => {}
            ReceiveArg::Match(hrdsl_ir::ArgPattern::Is(want)) if want.key() == v.key() => {}
            ReceiveArg::Match(hrdsl_ir::ArgPattern::Is(_)) => return false,
            ReceiveArg::Bind => binders.push(v),
        }
    }
    true
}

impl Model<'_> {
    /// All that may happen in a discrete state, in a fixed order: by sender, edge, selects, then the receivers' choices.
    pub(crate) fn candidates(&self, state: &[i64]) -> Vec<Candidate> {
        let mut out = Vec::new();
        let committed = self.any_committed(state);
        for m in 0..self.members.len() {
            for &e in &self.place(state, m).active {
                self.edge_candidates(state, committed, m, usize::from(e), &mut out);
            }
        }
        out
    }

    fn edge_candidates(
        &self,
        state: &[i64],
        committed: bool,
        member: usize,
        e: usize,
        out: &mut Vec<Candidate>,
    ) {
        let edge = self.members[member].edges[e].edge;
        for binders in choices(&edge.selects) {
            let step = Move { automaton: member, edge: e, binders };
            match self.guard(state, &step) {
                Ok(false) => continue,
                Ok(true) => {}
                Err(error) => {
                    out.push(self.faulty(smallvec::smallvec![step], None, error));
                    continue;
                }
            }
            match &edge.sync {
                Sync::Internal => self.push(state, committed, smallvec::smallvec![step], &[], None, out),
                Sync::Send { event, args } => match self.arguments(state, &step, *event, args) {
                    Ok(args) => self.broadcast(state, committed, step, (*event, args), out),
                    Err(error) => out.push(self.faulty(smallvec::smallvec![step], None, error)),
                },
                // INVARIANT: `active` has no receiving edges.
                Sync::Receive { .. } | Sync::Offer { .. } | Sync::Accept { .. } | Sync::Join { .. } => {}
            }
        }
    }

    fn broadcast(
        &self,
        state: &[i64],
        committed: bool,
        sender: Move,
        event: (EventId, Vec<Value>),
        out: &mut Vec<Candidate>,
    ) {
        let others = (0..self.members.len()).filter(|&m| m != sender.automaton);
        let options: Vec<Vec<Response>> =
            others.map(|m| self.responses(state, m, &event)).filter(|r| !r.is_empty()).collect();
        // An odometer over the receivers' options, the last receiver fastest.
        let mut at = vec![0; options.len()];
        loop {
            let mut moves: SmallVec<[Move; 2]> = smallvec::smallvec![sender.clone()];
            let mut absent: SmallVec<[Constraint; 4]> = SmallVec::new();
            let mut fault = None;
            for (responses, &i) in options.iter().zip(&at) {
                match &responses[i] {
                    Response::Take(m) => moves.push(m.clone()),
                    Response::Absent(cs) => absent.extend_from_slice(cs),
                    Response::Fault(m, error) => {
                        moves.push(m.clone());
                        fault = Some(error.clone());
                    }
                }
            }
            match fault {
                Some(error) => out.push(self.faulty(moves, Some(event.clone()), error)),
                None => self.push(state, committed, moves, &absent, Some(event.clone()), out),
            }
            let Some(next) = (0..at.len()).rev().find(|&i| at[i] + 1 < options[i].len()) else { return };
            at[next] += 1;
            at[next + 1..].fill(0);
        }
    }

    /// What an automaton may do about an event; nothing: it has no edge for it.
    fn responses(
        &self,
        state: &[i64],
        member: usize,
        (event, args): &(EventId, Vec<Value>),
    ) -> Vec<Response> {
        let mut out = Vec::new();
        let mut absent: Vec<SmallVec<[Constraint; 4]>> = vec![SmallVec::new()];
        for &e in &self.place(state, member).receiving {
            let arrow = &self.members[member].edges[usize::from(e)];
            let Sync::Receive { event: wanted, args: pattern } = &arrow.edge.sync else { continue };
            let mut bound = Binders::new();
            if wanted != event || !bind(pattern, args, &mut bound) {
                continue;
            }
            let before = out.len();
            for mut binders in choices(&arrow.edge.selects) {
                binders.extend_from_slice(&bound);
                let step = Move { automaton: member, edge: usize::from(e), binders };
                match self.guard(state, &step) {
                    Ok(false) => {}
                    Ok(true) => out.push(Response::Take(step)),
                    Err(error) => out.push(Response::Fault(step, error)),
                }
            }
            if out.len() > before {
                // To stay away, one of the constraints of each enabled edge must fail.
                absent = absent
                    .iter()
                    .flat_map(|cs| {
                        arrow.guard.iter().map(|c| {
                            let mut more = cs.clone();
                            more.push(c.negated());
                            more
                        })
                    })
                    .collect();
            }
        }
        if !out.is_empty() {
            out.extend(absent.into_iter().map(Response::Absent));
        }
        out
    }

    /// Adds a transition, unless a committed location or a limit forbids it.
    fn push(
        &self,
        state: &[i64],
        committed: bool,
        moves: SmallVec<[Move; 2]>,
        absent: &[Constraint],
        event: Option<(EventId, Vec<Value>)>,
        out: &mut Vec<Candidate>,
    ) {
        let leaves_committed =
            moves.iter().any(|m| self.place(state, m.automaton).kind == LocationKind::Committed);
        if committed && !leaves_committed {
            return;
        }
        let mut target = state.to_vec();
        if let Some((event, args)) = &event
            && !self.count(&mut target, *event, args)
        {
            return;
        }
        let mut guard = self.guards(&moves);
        guard.extend_from_slice(absent);
        let resets =
            moves.iter().flat_map(|m| &self.members[m.automaton].edges[m.edge].resets).copied().collect();
        let target = self.update(&mut target, &moves).map(|()| target);
        out.push(Candidate { event, moves, guard, resets, target });
    }

    /// Counts an event; `false`: a limit forbids it.
    fn count(&self, state: &mut [i64], event: EventId, args: &[Value]) -> bool {
        for (i, limit) in self.limits.iter().enumerate() {
            if any_matches(&limit.patterns, event, args) {
                let n = &mut state[self.limit_at(i)];
                if *n >= limit.at_most {
                    return false;
                }
                *n += 1;
            }
        }
        for (i, counter) in self.counters.iter().enumerate() {
            if any_matches(&counter.patterns, event, args) {
                let n = &mut state[self.counter_at(i)];
                *n = (*n + 1).min(counter.cap);
            }
        }
        true
    }

    fn guards(&self, moves: &[Move]) -> SmallVec<[Constraint; 4]> {
        moves.iter().flat_map(|m| &self.members[m.automaton].edges[m.edge].guard).copied().collect()
    }

    fn faulty(
        &self,
        moves: SmallVec<[Move; 2]>,
        event: Option<(EventId, Vec<Value>)>,
        error: Box<ModelError>,
    ) -> Candidate {
        let guard = self.guards(&moves);
        Candidate { event, moves, guard, resets: SmallVec::new(), target: Err(error) }
    }

    /// The moves' locations and updates, the sender's first.
    fn update(&self, state: &mut [i64], moves: &[Move]) -> Result<(), Box<ModelError>> {
        for m in moves {
            let edge = self.members[m.automaton].edges[m.edge].edge;
            state[m.automaton] = i64::from(edge.to.0);
            for u in &edge.updates {
                let Update::Assign { place, value } = u else { continue };
                let at = self.own_slot(m.automaton, usize::from(place.slot));
                let value = self.eval(state, m, value).and_then(|v| stored(self.slots[at], v));
                let n = value.map_err(|e| self.evaluation(m, e))?;
                let var = self.slots[at];
                if n < var.lo || n > var.hi {
                    return Err(Box::new(range_fault(self.edge_names(m), var, n)));
                }
                state[self.slot_at(at)] = n;
            }
        }
        Ok(())
    }

    fn arguments(
        &self,
        state: &[i64],
        step: &Move,
        event: EventId,
        args: &[Expr],
    ) -> Result<Vec<Value>, Box<ModelError>> {
        let values: Result<Vec<Value>, EvalError> = args.iter().map(|a| self.eval(state, step, a)).collect();
        let values = values.map_err(|e| self.evaluation(step, e))?;
        let declared = self.program.event(event);
        match argument_fault(declared, &values) {
            None => Ok(values),
            Some((parameter, value)) => {
                Err(Box::new(bad_argument(self.edge_names(step), &declared.name, parameter, value)))
            }
        }
    }

    fn guard(&self, state: &[i64], step: &Move) -> Result<bool, Box<ModelError>> {
        let Some(guard) = &self.members[step.automaton].edges[step.edge].edge.guard else { return Ok(true) };
        let value = self.eval(state, step, guard).and_then(|v| v.as_bool().ok_or(EvalError::Type));
        value.map_err(|e| self.evaluation(step, e))
    }

    fn eval(&self, state: &[i64], step: &Move, e: &Expr) -> Result<Value, EvalError> {
        let known = self.shared + self.members[step.automaton].automaton.vars.len();
        e.eval(&|i| {
            let i = usize::from(i);
            if i < known {
                self.slot_value(state, self.own_slot(step.automaton, i))
            } else {
                step.binders.get(i - known).copied()
            }
        })
    }

    /// The network's slot of what an automaton's expressions call `i`.
    fn own_slot(&self, member: usize, i: usize) -> usize {
        if i < self.shared { i } else { self.members[member].base + i - self.shared }
    }

    fn evaluation(&self, step: &Move, error: EvalError) -> Box<ModelError> {
        Box::new(ModelError::Evaluation { edge: self.edge_names(step), error })
    }

    fn edge_names(&self, step: &Move) -> Box<EdgeName> {
        let a = self.members[step.automaton].automaton;
        EdgeName::of(a, &a.edges[step.edge])
    }
}

/// The number that a variable keeps for a value.
pub(crate) fn stored(var: &Var, value: Value) -> Result<i64, EvalError> {
    var.number(value).ok_or(EvalError::Type)
}

pub(crate) fn range_fault(edge: Box<EdgeName>, var: &Var, value: i64) -> ModelError {
    ModelError::Range { edge, variable: var.name.clone(), value, lo: var.lo, hi: var.hi }
}

/// The first argument outside its parameter's range or enumeration, if any.
pub(crate) fn argument_fault<'e>(event: &'e hrdsl_ir::Event, args: &[Value]) -> Option<(&'e str, Value)> {
    event.params.iter().zip(args).find_map(|(p, v)| match (p.ty, v) {
        (Type::Int { lo, hi }, Value::Int(n)) if *n < lo || *n > hi => Some((p.name.as_str(), *v)),
        (Type::Enum(e), Value::Symbol(s)) if e.index_of(*s).is_none() => Some((p.name.as_str(), *v)),
        (Type::Int { .. } | Type::Bool | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_), _) => {
            None
        }
    })
}

pub(crate) fn bad_argument(edge: Box<EdgeName>, event: &str, parameter: &str, value: Value) -> ModelError {
    let (event, parameter) = (event.to_owned(), parameter.to_owned());
    ModelError::Argument { edge, event, parameter, value }
}
