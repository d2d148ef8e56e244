//! A compiled network: the product of automata over one discrete vector and one set of clocks.
//!
//! The discrete vector holds, in this order: each automaton's location, the shared variables, each automaton's own
//! variables, the counters, and what the limits have counted. Clocks are numbered from 1, automaton by automaton. All
//! constants are in the greatest unit of time in which all of them are whole.

use hrdsl_ir::{
    Nanos, Program, Value,
    ta::{
        Automaton, ClockConstraint, ClockId, ClockOp, LocationId, LocationKind, Network, Sync, Update, Var,
    },
    value::SECOND,
};

use crate::{
    Counter, Limit, ModelError, check,
    dbm::Bound,
    extrapolation::Extrapolation,
    query::{Goal, GoalKind, StateFormula},
};

/// `x_i - x_j ≺ bound`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Constraint {
    pub i: u16,
    pub j: u16,
    pub bound: Bound,
}

impl Constraint {
    /// What holds exactly where this does not.
    pub(crate) fn negated(self) -> Self {
        Self { i: self.j, j: self.i, bound: self.bound.negated() }
    }
}

/// One automaton of the network.
pub(crate) struct Member<'p> {
    pub automaton: &'p Automaton,
    /// The slot of its first own variable.
    pub base: usize,
    pub locations: Vec<Place>,
    pub edges: Vec<Arrow<'p>>,
}

pub(crate) struct Place {
    pub kind: LocationKind,
    pub invariant: Vec<Constraint>,
    /// Internal and sending edges, in source order.
    pub active: Vec<u16>,
    /// Receiving edges, in source order.
    pub receiving: Vec<u16>,
}

pub(crate) struct Arrow<'p> {
    pub edge: &'p hrdsl_ir::ta::Edge,
    pub guard: Vec<Constraint>,
    /// Clocks of the network.
    pub resets: Vec<u16>,
}

/// Where a number of the discrete vector lies in the packed form.
#[derive(Clone, Copy)]
struct Field {
    word: usize,
    shift: u32,
    mask: u64,
    lo: i64,
}

/// A network made ready to explore.
pub struct Model<'p> {
    pub(crate) program: &'p Program,
    pub(crate) name: &'p str,
    pub(crate) members: Vec<Member<'p>>,
    pub(crate) slots: Vec<&'p Var>,
    /// How many of the slots are shared.
    pub(crate) shared: usize,
    pub(crate) counters: Vec<Counter>,
    pub(crate) limits: Vec<Limit>,
    /// Clocks and the reference clock.
    pub(crate) dim: usize,
    /// The clock numbers of the constraints count these.
    pub(crate) unit: Nanos,
    pub(crate) extrapolation: Extrapolation,
    fields: Vec<Field>,
    words: usize,
}

/// The network's slots by name, in the order in which [`StateFormula::Data`] numbers them: the shared variables, then
/// each automaton's own as `Automaton.variable`.
#[must_use]
pub fn slot_names(program: &Program, network: &Network) -> Vec<String> {
    let shared = program.shared.iter().map(|v| v.name.clone());
    let members = network.automata.iter().filter_map(|id| program.automata.get(usize::from(id.0)));
    shared.chain(members.flat_map(|a| a.vars.iter().map(|v| format!("{}.{}", a.name, v.name)))).collect()
}

impl<'p> Model<'p> {
    /// Compiles a network, with what observes and restricts it.
    ///
    /// # Errors
    /// If the program is malformed or its constants are too far apart.
    pub fn new(
        program: &'p Program,
        network: &'p Network,
        counters: &[Counter],
        limits: &[Limit],
    ) -> Result<Self, ModelError> {
        let automata: Vec<&Automaton> =
            network.automata.iter().map(|&id| check::automaton(program, id)).collect::<Result<_, _>>()?;
        if counters.iter().any(|c| c.cap < 0) || limits.iter().any(|l| l.at_most < 0) {
            return Err(ModelError::Question("a counter's cap or a limit is negative".into()));
        }
        let unit = unit(&automata);
        let mut slots: Vec<&Var> = program.shared.iter().collect();
        let (mut members, mut dim) = (Vec::new(), 1);
        for automaton in automata {
            members.push(member(automaton, slots.len(), dim, unit)?);
            slots.extend(&automaton.vars);
            dim += automaton.clocks.len();
        }
        if dim > usize::from(u16::MAX) {
            return Err(ModelError::Question("too many clocks".into()));
        }
        let (fields, words) = pack_layout(&members, &slots, counters, limits);
        Ok(Self {
            program,
            name: &network.name,
            extrapolation: Extrapolation::new(&members, dim),
            members,
            shared: program.shared.len(),
            slots,
            counters: counters.to_vec(),
            limits: limits.to_vec(),
            dim,
            unit,
            fields,
            words,
        })
    }

    /// The unit of time, in nanoseconds, that divides all constants.
    #[must_use]
    pub fn unit(&self) -> Nanos {
        self.unit
    }

    /// The number of clocks.
    #[must_use]
    pub fn clocks(&self) -> usize {
        self.dim - 1
    }

    pub(crate) fn initial(&self) -> Vec<i64> {
        let locations = self.members.iter().map(|m| i64::from(m.automaton.initial.0));
        let slots = self.slots.iter().map(|v| v.init);
        let zeros = std::iter::repeat_n(0, self.counters.len() + self.limits.len());
        locations.chain(slots).chain(zeros).collect()
    }

    pub(crate) fn place(&self, state: &[i64], member: usize) -> &Place {
        // INVARIANT: the vector's first numbers are indices of locations.
        &self.members[member].locations[state[member] as usize]
    }

    pub(crate) fn slot_at(&self, slot: usize) -> usize {
        self.members.len() + slot
    }

    pub(crate) fn counter_at(&self, counter: usize) -> usize {
        self.members.len() + self.slots.len() + counter
    }

    pub(crate) fn limit_at(&self, limit: usize) -> usize {
        self.counter_at(self.counters.len()) + limit
    }

    pub(crate) fn any_committed(&self, state: &[i64]) -> bool {
        (0..self.members.len()).any(|m| self.place(state, m).kind == LocationKind::Committed)
    }

    /// Whether time may pass: no location is urgent or committed.
    pub(crate) fn may_delay(&self, state: &[i64]) -> bool {
        (0..self.members.len()).all(|m| self.place(state, m).kind == LocationKind::Normal)
    }

    pub(crate) fn invariant<'s>(&'s self, state: &'s [i64]) -> impl Iterator<Item = Constraint> + 's {
        (0..self.members.len()).flat_map(|m| self.place(state, m).invariant.iter().copied())
    }

    /// The vector in few words, to store and compare.
    pub(crate) fn pack(&self, state: &[i64], out: &mut Vec<u64>) {
        out.clear();
        out.resize(self.words, 0);
        for (f, &n) in self.fields.iter().zip(state) {
            out[f.word] |= (n.wrapping_sub(f.lo) as u64 & f.mask) << f.shift;
        }
    }

    pub(crate) fn unpack(&self, packed: &[u64], out: &mut Vec<i64>) {
        out.clear();
        out.extend(
            self.fields.iter().map(|f| f.lo.wrapping_add(((packed[f.word] >> f.shift) & f.mask) as i64)),
        );
    }

    /// Whether a goal speaks of things that exist and that the counters can tell.
    pub(crate) fn check_goal(&self, goal: &Goal) -> Result<(), ModelError> {
        let sound = match &goal.what {
            GoalKind::Edge { automaton, edge } => {
                self.members.get(*automaton).is_some_and(|m| *edge < m.edges.len())
            }
            GoalKind::Location { automaton, location } => self.has_location(*automaton, *location),
            GoalKind::Condition(f) => return self.check_formula(f),
        };
        if sound { Ok(()) } else { Err(unknown()) }
    }

    fn check_formula(&self, formula: &StateFormula) -> Result<(), ModelError> {
        match formula {
            StateFormula::And(fs) | StateFormula::Or(fs) => fs.iter().try_for_each(|f| self.check_formula(f)),
            StateFormula::Not(f) => self.check_formula(f),
            StateFormula::Clock(_) | StateFormula::Deadlock => Ok(()),
            StateFormula::At { automaton, location } if self.has_location(*automaton, *location) => Ok(()),
            StateFormula::At { .. } => Err(unknown()),
            StateFormula::Data(e) => {
                let mut known = true;
                e.each_var(&mut |i| known &= usize::from(i) < self.slots.len());
                if known { Ok(()) } else { Err(unknown()) }
            }
            StateFormula::CounterIn { counter, lo, hi } => {
                let cap = self.counters.get(*counter).ok_or_else(unknown)?.cap;
                // A counter at its cap means "at least cap": an upper bound there could not be judged.
                if *lo > cap || hi.is_some_and(|hi| hi >= cap && *lo <= hi) {
                    return Err(ModelError::Question(format!(
                        "counter {counter} stops at {cap}: too early to tell {lo}..{}",
                        hi.map_or(String::new(), |n| n.to_string())
                    )));
                }
                Ok(())
            }
        }
    }

    fn has_location(&self, automaton: usize, location: LocationId) -> bool {
        self.members.get(automaton).is_some_and(|m| usize::from(location.0) < m.locations.len())
    }

    /// A slot's number as the value that expressions see.
    pub(crate) fn slot_value(&self, state: &[i64], slot: usize) -> Option<Value> {
        self.slots[slot].value(state[self.slot_at(slot)])
    }
}

fn unknown() -> ModelError {
    ModelError::Question(
        "a goal speaks of an automaton, location, edge, variable or counter that is not there".into(),
    )
}

/// The greatest common divisor of all constants; a second if there are none.
fn unit(automata: &[&Automaton]) -> Nanos {
    let gcd = |mut a: u64, mut b: u64| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let invariants = automata.iter().flat_map(|a| a.locations.iter().flat_map(|l| &l.invariant));
    let guards = automata.iter().flat_map(|a| a.edges.iter().flat_map(|e| &e.clock_guard));
    let all = invariants.chain(guards).map(|c| c.bound.nanos.unsigned_abs()).fold(0, gcd);
    i64::try_from(all).ok().filter(|&n| n > 0).unwrap_or(SECOND)
}

fn member<'p>(
    automaton: &'p Automaton,
    base: usize,
    first_clock: usize,
    unit: Nanos,
) -> Result<Member<'p>, ModelError> {
    let compile = |cs: &[ClockConstraint]| -> Result<Vec<Constraint>, ModelError> {
        let mut out = Vec::new();
        for c in cs {
            if (c.bound.nanos / unit).unsigned_abs() > 1 << 50 {
                return Err(ModelError::Constants { automaton: automaton.name.clone() });
            }
            constraint(c, first_clock, unit, &mut out);
        }
        Ok(out)
    };
    let mut locations = Vec::new();
    for l in &automaton.locations {
        let invariant = compile(&l.invariant)?;
        locations.push(Place { kind: l.kind, invariant, active: Vec::new(), receiving: Vec::new() });
    }
    let mut edges = Vec::new();
    for (i, edge) in automaton.edges.iter().enumerate() {
        let Ok(index) = u16::try_from(i) else {
            let what = "too many edges".to_owned();
            return Err(ModelError::Malformed { automaton: automaton.name.clone(), what });
        };
        let place = &mut locations[usize::from(edge.from.0)];
        match edge.sync {
            Sync::Internal | Sync::Send { .. } => place.active.push(index),
            Sync::Receive { .. } => place.receiving.push(index),
            Sync::Offer { .. } | Sync::Accept { .. } | Sync::Join { .. } => {}
        }
        let resets = edge.updates.iter().filter_map(|u| match u {
            Update::Assign { .. } | Update::Call { .. } => None,
            Update::Reset { clock, .. } => Some(clock_at(*clock, first_clock)),
        });
        edges.push(Arrow { edge, guard: compile(&edge.clock_guard)?, resets: resets.collect() });
    }
    Ok(Member { automaton, base, locations, edges })
}

fn clock_at(clock: ClockId, first: usize) -> u16 {
    clock.0.saturating_add(u16::try_from(first).unwrap_or(u16::MAX))
}

fn constraint(c: &ClockConstraint, first: usize, unit: Nanos, out: &mut Vec<Constraint>) {
    let (i, j) = (clock_at(c.clock, first), c.minus.map_or(0, |m| clock_at(m, first)));
    let n = c.bound.nanos / unit;
    let upper = |bound| Constraint { i, j, bound };
    let lower = |bound| Constraint { i: j, j: i, bound };
    match c.op {
        ClockOp::Lt => out.push(upper(Bound::lt(n))),
        ClockOp::Le => out.push(upper(Bound::le(n))),
        ClockOp::Eq => out.extend([upper(Bound::le(n)), lower(Bound::le(-n))]),
        ClockOp::Ge => out.push(lower(Bound::le(-n))),
        ClockOp::Gt => out.push(lower(Bound::lt(-n))),
    }
}

/// Places each number of the vector in as few bits as its range needs, none across two words.
fn pack_layout(
    members: &[Member],
    slots: &[&Var],
    counters: &[Counter],
    limits: &[Limit],
) -> (Vec<Field>, usize) {
    let locations = members.iter().map(|m| (0, m.locations.len() as i64 - 1));
    let variables = slots.iter().map(|v| (v.lo, v.hi));
    let observers = counters.iter().map(|c| (0, c.cap)).chain(limits.iter().map(|l| (0, l.at_most)));
    let (mut word, mut used, mut fields) = (0, 0, Vec::new());
    for (lo, hi) in locations.chain(variables).chain(observers) {
        let width = 64 - (hi.wrapping_sub(lo) as u64).leading_zeros();
        if used + width > 64 {
            (word, used) = (word + 1, 0);
        }
        let mask = if width == 64 { u64::MAX } else { (1 << width) - 1 };
        // A number of one value only takes no bits; its shift must still be a legal one.
        fields.push(Field { word, shift: used.min(63), mask, lo });
        used += width;
    }
    (fields, word + 1)
}
