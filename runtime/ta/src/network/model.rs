//! A compiled network: the product of automata over one discrete vector and one set of clocks.
//!
//! The discrete vector holds, in this order: each automaton's location, the shared variables, each automaton's own
//! variables, the counters, what the limits have counted, and the histories that edge pairs and def-use pairs ask for.
//! Clocks are numbered from 1: the shared ones, then automaton by automaton. All constants are in the greatest unit of
//! time in which all of them are whole.

use hrdsl_ir::{
    EventId, Nanos, Program, Type, Value,
    ta::{AutomatonId, AutomatonVar, ChannelId, LocationId, LocationKind, Network, located_automaton},
};

use crate::network::{
    bounds::ExtrapolationBounds,
    by_location::LocationTable,
    code::{CodeEvalError, CodeLibrary, SyncMedium, VariablePlace, VariableScope},
    error::{EdgeName, ModelError, range_fault},
    number::NumberType,
    parts::{CompiledAutomaton, CompiledLocation, EventWatch, MultiwayChannel, stops_time},
    query::{EventCounter, EventLimit, GoalKind, ReachabilityGoal, StateFormula},
    width::BoundReach,
};
use crate::zone::constraint::DifferenceConstraint;

/// What a model keeps beside the state of its automata, and what it will be asked.
#[derive(Clone, Debug, Default)]
pub struct ObservationOptions {
    pub counters: Vec<EventCounter>,
    pub limits: Vec<EventLimit>,
    /// Each automaton's last edge is a part of the state.
    pub pairs: bool,
    /// The edge that last defined each variable is a part of the state.
    pub uses: bool,
    /// Their constants have a part in the bounds of extrapolation.
    pub formulas: Vec<hrdsl_ir::ta::QueryFormula>,
    /// Zones have all clocks, not only those that matter in their locations: then a clock's number is its index.
    pub all_clocks: bool,
    /// Times are counted in nanoseconds, not in the greatest unit in which all constants are whole.
    pub nanoseconds: bool,
    /// What is made of it that some variables leave their ranges.
    pub overflow: OverflowWatch,
}

/// Variables whose overflow is looked at in a way of its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OverflowWatch {
    /// By slot.
    pub slots: Vec<usize>,
    pub treatment: OverflowTreatment,
}

/// What the overflow of a variable means to a search. A fault it is in each case but one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OverflowTreatment {
    /// The search is for it, so that of two values the one nearer to it is better.
    #[default]
    Sought,
    /// A transition with one does not exist, so that of two values the one farther from it is better.
    Avoided,
}

/// How many bits the entries of matrices need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BoundWidth {
    Bits16,
    Bits32,
    Bits64,
}

/// The members with a location of each kind: in no other need it be looked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct MembersByTrait {
    pub committed: Vec<u16>,
    /// Urgent or committed.
    pub stop_time: Vec<u16>,
    /// With an edge that offers on an urgent channel.
    pub urgent_edges: Vec<u16>,
    /// With an invariant that has a part over variables.
    pub data_invariants: Vec<u16>,
}

impl MembersByTrait {
    pub(crate) fn of(members: &[CompiledAutomaton]) -> Self {
        let with = |is: fn(&CompiledLocation) -> bool| {
            let has = |m: &u16| members[usize::from(*m)].locations.iter().any(is);
            (0..members.len() as u16).filter(has).collect()
        };
        Self {
            committed: with(|l| l.kind == LocationKind::Committed),
            stop_time: with(|l| stops_time(l.kind)),
            urgent_edges: with(|l| !l.urgent.is_empty()),
            data_invariants: with(|l| l.holds.is_some() || !l.invariant.moving.is_empty()),
        }
    }
}

/// A network made ready to explore.
pub struct CompiledNetwork<'p> {
    pub(crate) program: &'p Program,
    pub(crate) name: String,
    pub(crate) members: Vec<CompiledAutomaton<'p>>,
    pub(crate) slots: Vec<&'p AutomatonVar>,
    /// How many of the slots are shared.
    pub(crate) shared: usize,
    pub(crate) counters: Vec<EventCounter>,
    pub(crate) limits: Vec<EventLimit>,
    /// Clocks and the reference clock.
    pub(crate) dim: usize,
    /// The clock numbers of the constraints count these.
    pub(crate) unit: Nanos,
    pub(crate) library: CodeLibrary,
    pub(crate) multiway: Vec<MultiwayChannel>,
    /// By event.
    pub(crate) watch: Vec<EventWatch>,
    pub(crate) extrapolation: ExtrapolationBounds,
    /// The clock part of the invariants, as far as it does not depend on variables.
    pub(crate) invariants: LocationTable<DifferenceConstraint>,
    pub(crate) with: MembersByTrait,
    pub(crate) reach: BoundReach,
    pub(crate) pairs: bool,
    pub(crate) uses: bool,
    pub(crate) overflow: OverflowWatch,
}

/// The network's slots by name, in the order in which [`StateFormula::Data`] numbers them: the shared variables, then
/// each automaton's own as `Automaton.variable`.
#[must_use]
pub fn slot_names(program: &Program, network: &Network) -> Vec<String> {
    let shared = program.shared.iter().map(|v| v.name.clone());
    let members = network.automata.iter().filter_map(|id| program.automata.get(usize::from(id.0)));
    shared.chain(members.flat_map(|a| a.vars.iter().map(|v| format!("{}.{}", a.name, v.name)))).collect()
}

impl<'p> CompiledNetwork<'p> {
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

    /// The discrete state at the start.
    pub(crate) fn initial(&self) -> Vec<i64> {
        let locations = self.members.iter().map(|m| i64::from(m.automaton.initial.0));
        let slots = self.slots.iter().map(|v| v.init);
        let mut all: Vec<i64> = locations.chain(slots).collect();
        all.resize(self.size(), 0);
        all
    }

    /// The numbers of a discrete state.
    pub(crate) fn size(&self) -> usize {
        self.last_definition_at(0) + if self.uses { self.slots.len() } else { 0 }
    }

    pub(crate) fn place(&self, state: &[i64], member: usize) -> &CompiledLocation {
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

    /// Where the number of a member's last edge is, if pairs are observed.
    pub(crate) fn last_edge_at(&self, member: usize) -> usize {
        self.limit_at(self.limits.len()) + member
    }

    /// Where the number of the edge that last defined a slot is, if uses are observed.
    pub(crate) fn last_definition_at(&self, slot: usize) -> usize {
        self.last_edge_at(if self.pairs { self.members.len() } else { 0 }) + slot
    }

    /// The clocks that stand still in a state, ascending.
    pub(crate) fn stopped(&self, state: &[i64]) -> Vec<u16> {
        let all = (0..self.members.len()).flat_map(|m| &self.place(state, m).stopped);
        let all: std::collections::BTreeSet<u16> = all.copied().collect();
        all.into_iter().collect()
    }

    /// Where a clock stands still: the clock's name, and the location's.
    fn stopwatch(&self) -> Option<(String, String)> {
        self.members.iter().find_map(|m| {
            let (at, place) = m.locations.iter().enumerate().find(|(_, l)| !l.stopped.is_empty())?;
            let clock = self.clock_name(usize::from(*place.stopped.first()?));
            Some((clock, format!("{}.{}", m.automaton.name, m.automaton.locations.get(at)?.name)))
        })
    }

    /// Clocks stand still in some location.
    pub(crate) fn stops(&self) -> bool {
        self.stopwatch().is_some()
    }

    /// Says that something cannot be asked where clocks stand still.
    ///
    /// # Errors
    /// They do.
    pub(crate) fn refuse_stopped(&self, what: &str) -> Result<(), ModelError> {
        let Some((clock, location)) = self.stopwatch() else { return Ok(()) };
        Err(ModelError::Question(format!(
            "{what} cannot be asked where clocks stand still, as `{clock}` does in `{location}`: zones say more than can happen there. \
             Ask of locations, variables and single clocks"
        )))
    }

    pub(crate) fn any_committed(&self, state: &[i64]) -> bool {
        self.with.committed.iter().any(|&m| self.is_committed(state, usize::from(m)))
    }

    /// The range of each number of a discrete state.
    pub(crate) fn ranges(&self) -> &[(i64, i64)] {
        &self.library.ranges
    }

    /// Whether a goal speaks of things that exist and that the counters can tell.
    pub(crate) fn check_goal(&self, goal: &ReachabilityGoal) -> Result<(), ModelError> {
        let edge =
            |member: usize, edge: usize| self.members.get(member).is_some_and(|m| edge < m.edges.len());
        let sound = match &goal.what {
            GoalKind::Edge { automaton, edge: e } => edge(*automaton, *e),
            GoalKind::Pair { automaton, first, second } => {
                self.pairs && edge(*automaton, *first) && edge(*automaton, *second)
            }
            GoalKind::Use { slot, definition, user } => {
                self.uses
                    && *slot < self.slots.len()
                    && definition.is_none_or(|(m, e)| edge(m, e))
                    && edge(user.0, user.1)
            }
            GoalKind::Location { automaton, location } => self.has_location(*automaton, *location),
            GoalKind::Condition(f) => return self.check_formula(f),
            GoalKind::Formula(_) => true,
        };
        if sound { Ok(()) } else { Err(unknown()) }
    }

    fn check_formula(&self, formula: &StateFormula) -> Result<(), ModelError> {
        match formula {
            StateFormula::And(fs) | StateFormula::Or(fs) => fs.iter().try_for_each(|f| self.check_formula(f)),
            StateFormula::Not(f) => self.check_formula(f),
            StateFormula::Clock(_) | StateFormula::Deadlock => {
                Err(ModelError::Question("a condition over clocks is asked as a formula".into()))
            }
            StateFormula::At { automaton, location } if self.has_location(*automaton, *location) => Ok(()),
            StateFormula::At { .. } => Err(unknown()),
            StateFormula::Data(e) => {
                let mut known = true;
                e.each_var(&mut |i| {
                    known &= usize::from(i) < self.slots.len()
                        || located_automaton(i, self.members.len()).is_some();
                });
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

    /// What the variables of a formula over the network are: its slots.
    pub(crate) fn slot_scope(&self) -> VariableScope {
        let at = |slot| VariablePlace::State(self.slot_at(slot) as u32);
        let vars = self.slots.iter().enumerate().map(|(i, v)| (at(i), NumberType::of(v))).collect();
        VariableScope::of_network(vars, self.members.len())
    }

    /// A slot as [`slot_names`] calls it.
    pub(crate) fn slot_name(&self, slot: usize) -> String {
        let name = &self.slots[slot].name;
        match self.members.iter().rfind(|m| m.base <= slot) {
            Some(owner) if slot >= self.shared => format!("{}.{name}", owner.automaton.name),
            Some(_) | None => name.clone(),
        }
    }

    pub(crate) fn edge_name(&self, member: usize, edge: usize) -> Box<EdgeName> {
        let a = self.members[member].automaton;
        EdgeName::of(a, &a.edges[edge])
    }

    /// How the overflow of the variable at this place of the state is treated, if that is in a way of its own.
    pub(crate) fn overflow_at(&self, place: u32) -> Option<OverflowTreatment> {
        let slot = (place as usize).checked_sub(self.members.len())?;
        self.overflow.slots.contains(&slot).then_some(self.overflow.treatment)
    }

    /// What the model's fault is called.
    pub(crate) fn fault(&self, member: usize, edge: usize, fault: CodeEvalError) -> ModelError {
        let name = self.edge_name(member, edge);
        match fault {
            CodeEvalError::Eval(error) => ModelError::Evaluation { edge: name, error },
            CodeEvalError::Range { at, value } => {
                let slot = (at as usize).saturating_sub(self.members.len());
                match self.slots.get(slot) {
                    Some(var) => range_fault(name, var, value),
                    None => ModelError::Evaluation { edge: name, error: hrdsl_ir::expr::EvalError::Type },
                }
            }
            CodeEvalError::Argument { of, parameter, value } => {
                let (event, parameter) = self.parameter(of, parameter);
                ModelError::Argument { edge: name, event, parameter, value }
            }
            CodeEvalError::Negative { clock } => {
                ModelError::NegativeClock { edge: name, clock: self.clock_name(usize::from(clock)) }
            }
        }
    }

    fn parameter(&self, of: SyncMedium, parameter: u16) -> (String, String) {
        let n = usize::from(parameter);
        match of {
            SyncMedium::Event(EventId(e)) => {
                let e = &self.program.events[usize::from(e)];
                (e.name.clone(), e.params.get(n).map_or(String::new(), |p| p.name.clone()))
            }
            SyncMedium::Channel(ChannelId(c)) => {
                let c = &self.program.channels[usize::from(c)];
                (c.name.clone(), c.params.get(n).map_or(String::new(), |p| p.name.clone()))
            }
        }
    }

    /// The name of a clock of the network.
    pub(crate) fn clock_name(&self, clock: usize) -> String {
        let shared = &self.program.clocks;
        if let Some(name) = clock.checked_sub(1).and_then(|c| shared.get(c)) {
            return name.clone();
        }
        let own = self.members.iter().rev().find(|m| m.first_clock <= clock);
        let name = own.and_then(|m| Some((m, m.automaton.clocks.get(clock - m.first_clock)?)));
        name.map_or(String::new(), |(m, c)| format!("{}.{c}", m.automaton.name))
    }

    /// The member that an automaton is.
    pub(crate) fn member_of(network: &Network, automaton: AutomatonId) -> Option<u16> {
        network.automata.iter().position(|a| *a == automaton).and_then(|n| u16::try_from(n).ok())
    }
}

fn unknown() -> ModelError {
    ModelError::Question(
        "a goal speaks of an automaton, location, edge, variable or counter that is not there".into(),
    )
}

/// The values of numbers, for people and traces.
pub(crate) fn values(model: &CompiledNetwork, medium: SyncMedium, numbers: &[i64]) -> Vec<Value> {
    let value = |ty: NumberType, n: i64| ty.value(n, &model.library.constants).unwrap_or(Value::Int(n));
    match medium {
        SyncMedium::Channel(ChannelId(c)) => {
            let params = &model.program.channels[usize::from(c)].params;
            params.iter().zip(numbers).map(|(p, &n)| value(NumberType::of(p), n)).collect()
        }
        SyncMedium::Event(e) => {
            let params = &model.program.event(e).params;
            let ty = |t: Type| match t {
                Type::Bool => NumberType::Bool,
                Type::Int { .. } => NumberType::Int,
                Type::Enum(e) => NumberType::Enum(e),
                Type::Float(_) | Type::Text | Type::List(_) => NumberType::Constant,
            };
            params.iter().zip(numbers).map(|(p, &n)| value(ty(p.ty), n)).collect()
        }
    }
}
