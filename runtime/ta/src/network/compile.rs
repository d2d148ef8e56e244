//! From a program's network to a [`CompiledNetwork`]: names become places in the state, patterns become numbers, times become units.

use hrdsl_ir::{
    Nanos, Program,
    ta::{
        Automaton, AutomatonVar, ChannelKind, ClockConstraint, Edge, EdgeAssignment, Network, QueryFormula,
        SyncLabel, TimeSum,
    },
    value::SECOND,
};

use crate::network::{
    bounds::ExtrapolationBounds,
    by_location::LocationTable,
    code::{CodeLibrary, SyncMedium, VariablePlace, VariableScope},
    compiler::{ModelResult, NetworkCompiler, malformed},
    error::ModelError,
    model::{CompiledNetwork, MembersByTrait, ObservationOptions},
    number::{NumberType, gcd},
    parts::{
        ClockConstraints, CompiledAutomaton, CompiledEdge, CompiledLocation, EdgeSync, EdgeUpdate, TimeExpr,
    },
    signals::{multiway_channels, partners},
    well_formed,
    width::width,
};

impl<'p> CompiledNetwork<'p> {
    /// Compiles a network, with what observes and restricts it.
    ///
    /// # Errors
    /// If the program is malformed or its constants are too far apart.
    pub fn new(program: &'p Program, network: &Network, observe: &ObservationOptions) -> ModelResult<Self> {
        compiled(program, network, observe)
    }
}

fn compiled<'p>(
    program: &'p Program,
    network: &Network,
    observe: &ObservationOptions,
) -> ModelResult<CompiledNetwork<'p>> {
    let automata: Vec<&Automaton> =
        network.automata.iter().map(|&id| well_formed::automaton(program, id)).collect::<ModelResult<_>>()?;
    if observe.counters.iter().any(|c| c.cap < 0) || observe.limits.iter().any(|l| l.at_most < 0) {
        return Err(ModelError::Question("a counter's cap or a limit is negative".into()));
    }
    let slots: Vec<&AutomatonVar> =
        program.shared.iter().chain(automata.iter().flat_map(|a| &a.vars)).collect();
    // The order of what follows matters: members give names to variables, functions are compiled over those names and may call each
    // other, edges call functions, and partners and extrapolation look at compiled edges.
    let library = CodeLibrary { ranges: ranges(&automata, &slots, observe), ..CodeLibrary::default() };
    let unit = if observe.nanoseconds { 1 } else { unit(&automata, &observe.formulas) };
    let mut compiler = NetworkCompiler { program, network, unit, library };
    let mut members = compiler.members(network, &automata)?;
    compiler.functions(network, &members)?;
    for m in 0..members.len() {
        compiler.member(&mut members, m)?;
    }
    partners(&mut members);
    let dim = 1 + program.clocks.len() + automata.iter().map(|a| a.clocks.len()).sum::<usize>();
    if dim > usize::from(u16::MAX) || slots.len() > usize::from(u16::MAX) {
        return Err(ModelError::Question("too many clocks or variables".into()));
    }
    let formulas = compiler.formula_clocks(observe, &slots, members.len())?;
    let extrapolation = ExtrapolationBounds::new(
        &members,
        program.clocks.len(),
        dim,
        &formulas,
        observe.all_clocks,
        &compiler.library,
    )?;
    let reach = width(&members, &formulas, dim, &compiler.library);
    let watch = compiler.watch(observe);
    Ok(CompiledNetwork {
        program,
        name: network.name.clone(),
        shared: program.shared.len(),
        slots,
        counters: observe.counters.clone(),
        limits: observe.limits.clone(),
        dim,
        unit,
        multiway: multiway_channels(program, network),
        watch,
        extrapolation,
        invariants: LocationTable::of(&members, |l| l.invariant.fixed.clone()),
        with: MembersByTrait::of(&members),
        reach: reach?,
        pairs: observe.pairs,
        uses: observe.uses,
        overflow: observe.overflow.clone(),
        members,
        library: compiler.library,
    })
}

/// Of each number of the discrete vector, in the order in which `CompiledNetwork` finds them: locations, variables, counters, limits, the
/// last edge of each member, the last definition of each variable. The two have to agree.
fn ranges(automata: &[&Automaton], slots: &[&AutomatonVar], observe: &ObservationOptions) -> Vec<(i64, i64)> {
    let mut all: Vec<(i64, i64)> = automata.iter().map(|a| (0, a.locations.len() as i64 - 1)).collect();
    all.extend(slots.iter().map(|v| (v.lo, v.hi)));
    all.extend(observe.counters.iter().map(|c| (0, c.cap)));
    all.extend(observe.limits.iter().map(|l| (0, l.at_most)));
    let edges: i64 = automata.iter().map(|a| a.edges.len() as i64).sum();
    if observe.pairs {
        all.extend(automata.iter().map(|_| (0, edges)));
    }
    if observe.uses {
        all.extend(slots.iter().map(|_| (0, edges)));
    }
    all
}

/// The greatest common divisor of all constants; a second if there are none.
fn unit(automata: &[&Automaton], formulas: &[QueryFormula]) -> Nanos {
    let mut times: Vec<&TimeSum> = Vec::new();
    for a in automata {
        times.extend(a.locations.iter().flat_map(|l| &l.invariant).map(|c| &c.bound));
        for e in &a.edges {
            times.extend(e.clock_guard.iter().map(|c| &c.bound));
            times.extend(e.updates.iter().filter_map(|u| match u {
                EdgeAssignment::Reset { to, .. } => Some(to),
                EdgeAssignment::Assign { .. } | EdgeAssignment::Call { .. } => None,
            }));
        }
    }
    let mut clocks = Vec::new();
    formulas.iter().for_each(|f| clock_parts(f, &mut |c| clocks.push(c.bound.clone())));
    times.extend(&clocks);
    let numbers = times.iter().flat_map(|t| std::iter::once(t.nanos).chain(t.terms.iter().map(|t| t.factor)));
    let all = numbers.map(i64::unsigned_abs).fold(0, gcd);
    i64::try_from(all).ok().filter(|&n| n > 0).unwrap_or(SECOND)
}

/// The constraints on clocks in a formula.
fn clock_parts(formula: &QueryFormula, f: &mut dyn FnMut(&ClockConstraint)) {
    match formula {
        QueryFormula::At { .. } | QueryFormula::Data(_) | QueryFormula::Deadlock => {}
        QueryFormula::Clock(c) => f(c),
        QueryFormula::Not(a) => clock_parts(a, f),
        QueryFormula::And(all) | QueryFormula::Or(all) => all.iter().for_each(|a| clock_parts(a, f)),
    }
}

impl<'p> NetworkCompiler<'p, '_> {
    /// The members with their names, without locations and edges.
    fn members(
        &self,
        network: &Network,
        automata: &[&'p Automaton],
    ) -> ModelResult<Vec<CompiledAutomaton<'p>>> {
        let count = automata.len();
        let shared = self.program.shared.len();
        let (mut base, mut clock) = (shared, 1 + self.program.clocks.len());
        let mut members: Vec<CompiledAutomaton> = Vec::new();
        for (m, automaton) in automata.iter().enumerate() {
            if network.automata[..m].contains(&network.automata[m]) {
                return Err(malformed(&automaton.name, "it is in the network twice"));
            }
            let at = |slot: usize| VariablePlace::State((count + slot) as u32);
            let mut vars: Vec<(VariablePlace, NumberType)> =
                self.program.shared.iter().enumerate().map(|(i, v)| (at(i), NumberType::of(v))).collect();
            vars.extend(automaton.vars.iter().enumerate().map(|(i, v)| (at(base + i), NumberType::of(v))));
            members.push(CompiledAutomaton {
                automaton,
                base,
                first_clock: clock,
                names: VariableScope::own(vars, u16::try_from(m).ok()),
                locations: Vec::new(),
                edges: Vec::new(),
            });
            base += automaton.vars.len();
            clock += automaton.clocks.len();
        }
        Ok(members)
    }

    // ── Automata ──

    fn member(&mut self, members: &mut [CompiledAutomaton<'p>], m: usize) -> ModelResult<()> {
        let (automaton, first) = (members[m].automaton, members[m].first_clock);
        let names = members[m].names.clone();
        let mut locations = Vec::new();
        for l in &automaton.locations {
            locations.push(CompiledLocation {
                kind: l.kind,
                invariant: self.clocks(automaton, &names, first, &[], &l.invariant)?,
                holds: l.holds.as_ref().map(|e| self.library.compile(&names, e, NumberType::Bool)),
                stopped: l.stopped.iter().map(|c| self.clock(*c, first)).collect(),
                active: Vec::new(),
                receiving: Vec::new(),
                joining: Vec::new(),
                urgent: Vec::new(),
            });
        }
        let before: usize = members[..m].iter().map(|m| m.automaton.edges.len()).sum();
        let mut edges = Vec::new();
        for (i, edge) in automaton.edges.iter().enumerate() {
            let Ok(index) = u16::try_from(i) else {
                return Err(malformed(&automaton.name, "too many edges"));
            };
            let spot = &mut locations[usize::from(edge.from.0)];
            match &edge.sync {
                SyncLabel::Internal | SyncLabel::Send { .. } => spot.active.push(index),
                SyncLabel::Receive { .. } | SyncLabel::Accept { .. } => spot.receiving.push(index),
                SyncLabel::Join { .. } => spot.joining.push(index),
                SyncLabel::Offer { channel, .. } => {
                    spot.active.push(index);
                    if self.program.channels.get(usize::from(channel.0)).is_some_and(|c| c.urgent) {
                        spot.urgent.push(index);
                    }
                }
            }
            edges.push(self.edge(automaton, first, &names, edge, (before + i + 1) as u32)?);
        }
        members[m].locations = locations;
        members[m].edges = edges;
        Ok(())
    }

    fn edge(
        &mut self,
        automaton: &'p Automaton,
        first: usize,
        outer: &VariableScope,
        edge: &'p Edge,
        number: u32,
    ) -> ModelResult<CompiledEdge<'p>> {
        let unknown = || malformed(&automaton.name, "an edge uses something unknown");
        let mut names = outer.clone();
        let mut binders: Vec<NumberType> = edge.selects.iter().map(NumberType::of).collect();
        let mut locals: Vec<(i64, i64)> = edge.selects.iter().map(|v| (v.lo, v.hi)).collect();
        // What is received binds names that the rest of the edge uses, arguments that are sent use them: so the one comes before the names
        // are complete, the other after.
        let sync = match &edge.sync {
            SyncLabel::Internal => EdgeSync::Internal,
            SyncLabel::Join { channel } => {
                let Some(ChannelKind::MultiWay(participants)) =
                    self.program.channels.get(usize::from(channel.0)).map(|c| &c.kind)
                else {
                    return Err(unknown());
                };
                let id = self.network.automata[usize::from(outer.member.unwrap_or(0))];
                let participant = participants.iter().find(|p| p.automaton == id).ok_or_else(unknown)?;
                EdgeSync::Join { channel: *channel, optional: participant.optional }
            }
            SyncLabel::Receive { event, args } => self
                .received(SyncMedium::Event(*event), args, &mut binders, &mut locals)
                .ok_or_else(unknown)?,
            SyncLabel::Accept { channel, args } => self
                .received(SyncMedium::Channel(*channel), args, &mut binders, &mut locals)
                .ok_or_else(unknown)?,
            SyncLabel::Send { .. } | SyncLabel::Offer { .. } => EdgeSync::Internal,
        };
        names.vars.extend(binders.iter().enumerate().map(|(i, &ty)| (VariablePlace::Local(i as u32), ty)));
        let sync = match &edge.sync {
            SyncLabel::Send { event, args } => {
                self.signal(automaton, &names, SyncMedium::Event(*event), args)?
            }
            SyncLabel::Offer { channel, args } => {
                self.signal(automaton, &names, SyncMedium::Channel(*channel), args)?
            }
            SyncLabel::Internal
            | SyncLabel::Receive { .. }
            | SyncLabel::Accept { .. }
            | SyncLabel::Join { .. } => sync,
        };
        let guard = self.clocks(automaton, &names, first, &locals, &edge.clock_guard)?;
        let data = edge.guard.as_ref().map(|g| self.library.compile(&names, g, NumberType::Bool));
        let mut updates = Vec::new();
        for update in &edge.updates {
            updates.push(self.update(automaton, first, &names, &locals, update)?);
        }
        let selects = edge.selects.iter().map(|v| (v.lo, v.hi)).collect();
        let mut arrow =
            CompiledEdge { edge, number, guard, data, selects, binders, sync, updates, reads: Vec::new() };
        arrow.reads = self.reads(&arrow);
        Ok(arrow)
    }

    fn update(
        &self,
        automaton: &Automaton,
        first: usize,
        names: &VariableScope,
        locals: &[(i64, i64)],
        update: &EdgeAssignment,
    ) -> ModelResult<EdgeUpdate> {
        let unknown = || malformed(&automaton.name, "an edge uses something unknown");
        Ok(match update {
            EdgeAssignment::Assign { place, value } => {
                let (reach, value) = self.assignment(names, place, value).ok_or_else(unknown)?;
                if matches!(reach.base, VariablePlace::Local(_)) {
                    return Err(unknown());
                }
                EdgeUpdate::Assign(reach, value)
            }
            EdgeAssignment::Reset { clock, from, to } => EdgeUpdate::Reset {
                clock: self.clock(*clock, first),
                from: from.map(|c| self.clock(c, first)),
                to: self.times(automaton, names, locals, to)?,
            },
            EdgeAssignment::Call { function, args } => {
                let lib = &self.library;
                let routine = lib.routine(*function, names.member).ok_or_else(unknown)?;
                EdgeUpdate::Call(routine, lib.arguments(names, routine, args).ok_or_else(unknown)?)
            }
        })
    }

    /// The places of the state that an edge reads.
    fn reads(&self, arrow: &CompiledEdge) -> Vec<u32> {
        let lib = &self.library;
        let mut all = Vec::new();
        let mut note = |i: u32| all.push(i);
        let times =
            |t: &TimeExpr, note: &mut dyn FnMut(u32)| t.terms.iter().for_each(|t| t.1.each_var(lib, note));
        arrow.data.iter().for_each(|c| c.each_var(lib, &mut note));
        arrow.guard.moving.iter().for_each(|m| times(&m.time, &mut note));
        if let EdgeSync::Out(signal) = &arrow.sync {
            signal.args.iter().for_each(|a| a.code.each_var(lib, &mut note));
        }
        for u in &arrow.updates {
            match u {
                EdgeUpdate::Assign(reach, value) => {
                    value.each_var(lib, &mut note);
                    reach.indices.iter().for_each(|i| i.0.each_var(lib, &mut note));
                }
                EdgeUpdate::Reset { to, .. } => times(to, &mut note),
                EdgeUpdate::Call(routine, args) => {
                    args.iter().for_each(|a| a.each_var(lib, &mut note));
                    lib.each_read(*routine, &mut note);
                }
            }
        }
        all.sort_unstable();
        all.dedup();
        all
    }

    /// The constraints on clocks of the observed formulas, over the network's clocks.
    fn formula_clocks(
        &self,
        observe: &ObservationOptions,
        slots: &[&AutomatonVar],
        members: usize,
    ) -> ModelResult<ClockConstraints> {
        let vars = slots
            .iter()
            .enumerate()
            .map(|(i, v)| (VariablePlace::State((members + i) as u32), NumberType::of(v)));
        let names = VariableScope::of_network(vars.collect(), members);
        let mut all = ClockConstraints::default();
        let mut parts = Vec::new();
        observe.formulas.iter().for_each(|f| clock_parts(f, &mut |c| parts.push(c.clone())));
        let nobody = Automaton {
            name: "query".into(),
            actor: None,
            clocks: Vec::new(),
            vars: Vec::new(),
            locations: Vec::new(),
            initial: hrdsl_ir::ta::LocationId(0),
            edges: Vec::new(),
            origin: hrdsl_ir::Span::default(),
        };
        // The clocks of formulas are numbered as the network's are.
        let first = 1 + self.program.clocks.len();
        let found = self.clocks(&nobody, &names, first, &[], &parts)?;
        all.fixed.extend(found.fixed);
        all.moving.extend(found.moving);
        Ok(all)
    }
}
