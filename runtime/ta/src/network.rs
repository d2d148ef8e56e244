//! A compiled network: the product of automata over one discrete vector and one set of clocks.
//!
//! The discrete vector holds, in this order: each automaton's location, the shared variables, each automaton's own
//! variables, the counters, what the limits have counted, and the histories that edge pairs and def-use pairs ask for.
//! Clocks are numbered from 1: the shared ones, then automaton by automaton. All constants are in the greatest unit of
//! time in which all of them are whole.

use hrdsl_ir::{
    EventId, Nanos, Program, Value,
    ta::{AutomatonId, ChannelId, ClockOp, LocationId, LocationKind, Network, Var},
};

use crate::{
    Counter, Limit, ModelError,
    code::{Code, Env, Fault, Library, Medium, Names, Reach, Ty},
    compile,
    dbm::Bound,
    error::EdgeName,
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

/// A time with variables: `units + Σ factor · value`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times {
    pub units: i64,
    pub terms: Vec<(i64, Code)>,
}

impl Times {
    pub(crate) fn eval(&self, env: &mut Env) -> Result<i64, Fault> {
        let mut sum = self.units;
        for (factor, value) in &self.terms {
            let n = value.eval(env)?.checked_mul(*factor).and_then(|n| sum.checked_add(n));
            sum = n.ok_or(Fault::Eval(hrdsl_ir::expr::EvalError::Overflow))?;
        }
        Ok(sum)
    }

    /// The least and greatest it can be.
    pub(crate) fn span(&self, library: &Library, locals: &[(i64, i64)]) -> (i64, i64) {
        self.terms.iter().fold((self.units, self.units), |(lo, hi), (factor, value)| {
            let (a, b, _) = value.span(library, locals);
            let (a, b) = (a.saturating_mul(*factor), b.saturating_mul(*factor));
            (lo.saturating_add(a.min(b)), hi.saturating_add(a.max(b)))
        })
    }
}

/// A constraint whose bound variables have a part in: `x_i - x_j op time`.
#[derive(Clone, Debug)]
pub(crate) struct Moving {
    pub i: u16,
    pub j: u16,
    pub op: ClockOp,
    pub time: Times,
    /// The least and greatest bound.
    pub span: (i64, i64),
}

/// A conjunction of constraints on clocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clocks {
    pub fixed: Vec<Constraint>,
    pub moving: Vec<Moving>,
}

impl Clocks {
    /// All constraints, with the bounds that they have now.
    pub(crate) fn eval(&self, env: &mut Env, out: &mut Vec<Constraint>) -> Result<(), Fault> {
        out.extend_from_slice(&self.fixed);
        for m in &self.moving {
            let n = m.time.eval(env)?;
            constraints(m.i, m.j, m.op, n, &mut |c| out.push(c));
        }
        Ok(())
    }
}

/// The bounds that say `x_i - x_j op n`.
pub(crate) fn constraints(i: u16, j: u16, op: ClockOp, n: i64, out: &mut dyn FnMut(Constraint)) {
    let upper = |bound| Constraint { i, j, bound };
    let lower = |bound| Constraint { i: j, j: i, bound };
    match op {
        ClockOp::Lt => out(upper(Bound::lt(n))),
        ClockOp::Le => out(upper(Bound::le(n))),
        ClockOp::Eq => {
            out(upper(Bound::le(n)));
            out(lower(Bound::le(-n)));
        }
        ClockOp::Ge => out(lower(Bound::le(-n))),
        ClockOp::Gt => out(lower(Bound::lt(-n))),
    }
}

/// One automaton of the network.
pub(crate) struct Member<'p> {
    pub automaton: &'p hrdsl_ir::ta::Automaton,
    /// The slot of its first own variable.
    pub base: usize,
    /// The number of its first own clock in the network.
    pub first_clock: usize,
    /// What its expressions call its variables.
    pub names: Names,
    pub locations: Vec<Spot>,
    pub edges: Vec<Arrow<'p>>,
}

/// A location.
pub(crate) struct Spot {
    pub kind: LocationKind,
    pub invariant: Clocks,
    pub holds: Option<Code>,
    /// Internal, sending and offering edges, in source order.
    pub active: Vec<u16>,
    /// Receiving and accepting edges, in source order.
    pub receiving: Vec<u16>,
    /// Edges of joint channels, in source order.
    pub joining: Vec<u16>,
    /// Edges that offer on an urgent channel.
    pub urgent: Vec<u16>,
}

/// An edge.
pub(crate) struct Arrow<'p> {
    pub edge: &'p hrdsl_ir::ta::Edge,
    /// Its number among all edges of the network, from 1.
    pub number: u32,
    pub guard: Clocks,
    pub data: Option<Code>,
    /// Ranges of the selects.
    pub selects: Vec<(i64, i64)>,
    /// Of the selects, then of what it binds.
    pub binders: Vec<Ty>,
    pub sync: Part,
    pub updates: Vec<Op>,
    /// The network's slots that it reads, each once.
    pub reads: Vec<u32>,
}

/// How an edge takes part.
pub(crate) enum Part {
    Internal,
    Out(Signal),
    In(Pattern),
    Join { channel: ChannelId, optional: bool },
}

/// What an edge sends or offers.
pub(crate) struct Signal {
    pub medium: Medium,
    pub args: Box<[Arg]>,
    /// The others take part if they can; otherwise exactly one takes part.
    pub broadcast: bool,
    pub partners: Vec<Partner>,
}

pub(crate) struct Arg {
    pub code: Code,
    /// The range that its parameter allows.
    pub range: (i64, i64),
}

/// An automaton that may take what an edge sends.
pub(crate) struct Partner {
    pub member: u16,
    /// By its location: the edges that may match.
    pub edges: Vec<Box<[u16]>>,
}

/// What a receiving edge takes.
pub(crate) struct Pattern {
    pub medium: Medium,
    /// The sender does not wait for it.
    pub broadcast: bool,
    /// For each argument: what it must be.
    pub wants: Vec<Option<i64>>,
    /// Arguments that are bound, in order.
    pub binds: Vec<u16>,
}

impl Pattern {
    pub(crate) fn matches(&self, args: &[i64]) -> bool {
        self.wants.iter().zip(args).all(|(want, n)| want.is_none_or(|w| w == *n))
    }
}

/// An update.
pub(crate) enum Op {
    Assign(Reach, Code),
    Reset { clock: u16, from: Option<u16>, to: Times },
    Call(u32, Box<[Code]>),
}

/// A joint channel.
pub(crate) struct Joint {
    pub channel: ChannelId,
    pub urgent: bool,
    /// Index in the network; whether it may stay away.
    pub parties: Vec<(u16, bool)>,
}

/// What counts an event.
#[derive(Default)]
pub(crate) struct Watch {
    /// Counter, patterns.
    pub counters: Vec<(usize, Vec<Vec<Option<i64>>>)>,
    pub limits: Vec<(usize, Vec<Vec<Option<i64>>>)>,
}

/// What a model keeps beside the state of its automata, and what it will be asked.
#[derive(Clone, Debug, Default)]
pub struct Observe {
    pub counters: Vec<Counter>,
    pub limits: Vec<Limit>,
    /// Each automaton's last edge is a part of the state.
    pub pairs: bool,
    /// The edge that last defined each variable is a part of the state.
    pub uses: bool,
    /// Their constants have a part in the bounds of extrapolation.
    pub formulas: Vec<hrdsl_ir::ta::Formula>,
    /// Zones have all clocks, not only those that matter in their locations: then a clock's number is its index.
    pub all_clocks: bool,
}

/// How many bits the entries of matrices need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Width {
    Bits16,
    Bits32,
    Bits64,
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
    pub(crate) library: Library,
    pub(crate) joints: Vec<Joint>,
    /// By event.
    pub(crate) watch: Vec<Watch>,
    /// By channel: whether it is urgent.
    pub(crate) urgent: Vec<bool>,
    pub(crate) extrapolation: Extrapolation,
    pub(crate) width: Width,
    pub(crate) pairs: bool,
    pub(crate) uses: bool,
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
    pub fn new(program: &'p Program, network: &'p Network, observe: &Observe) -> Result<Self, ModelError> {
        compile::model(program, network, observe)
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

    pub(crate) fn place(&self, state: &[i64], member: usize) -> &Spot {
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

    pub(crate) fn any_committed(&self, state: &[i64]) -> bool {
        (0..self.members.len()).any(|m| self.place(state, m).kind == LocationKind::Committed)
    }

    /// The range of each number of a discrete state.
    pub(crate) fn ranges(&self) -> &[(i64, i64)] {
        &self.library.ranges
    }

    /// Whether a goal speaks of things that exist and that the counters can tell.
    pub(crate) fn check_goal(&self, goal: &Goal) -> Result<(), ModelError> {
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

    /// What the variables of a formula over the network are: its slots.
    pub(crate) fn slot_scope(&self) -> Names {
        let at = |slot| crate::code::At::State(self.slot_at(slot) as u32);
        let vars = self.slots.iter().enumerate().map(|(i, v)| (at(i), Ty::of(v))).collect();
        Names { vars, member: None }
    }

    pub(crate) fn edge_name(&self, member: usize, edge: usize) -> Box<EdgeName> {
        let a = self.members[member].automaton;
        EdgeName::of(a, &a.edges[edge])
    }

    /// What the model's fault is called.
    pub(crate) fn fault(&self, member: usize, edge: usize, fault: Fault) -> ModelError {
        let name = self.edge_name(member, edge);
        match fault {
            Fault::Eval(error) => ModelError::Evaluation { edge: name, error },
            Fault::Range { at, value } => {
                let slot = (at as usize).saturating_sub(self.members.len());
                match self.slots.get(slot) {
                    Some(var) => crate::semantics::range_fault(name, var, value),
                    None => ModelError::Evaluation { edge: name, error: hrdsl_ir::expr::EvalError::Type },
                }
            }
            Fault::Argument { of, parameter, value } => {
                let (event, parameter) = self.parameter(of, parameter);
                ModelError::Argument { edge: name, event, parameter, value }
            }
            Fault::Negative { clock } => {
                ModelError::NegativeClock { edge: name, clock: self.clock_name(usize::from(clock)) }
            }
        }
    }

    fn parameter(&self, of: Medium, parameter: u16) -> (String, String) {
        let n = usize::from(parameter);
        match of {
            Medium::Event(EventId(e)) => {
                let e = &self.program.events[usize::from(e)];
                (e.name.clone(), e.params.get(n).map_or(String::new(), |p| p.name.clone()))
            }
            Medium::Channel(ChannelId(c)) => {
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
