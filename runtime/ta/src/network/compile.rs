//! From a program's network to a [`CompiledNetwork`]: names become places in the state, patterns become numbers, times become units.

use hrdsl_ir::expr::Lvalue;
use hrdsl_ir::{
    ArgPattern, EventPattern, Expr, Nanos, Program, Type,
    ta::{
        Automaton, AutomatonFunction, AutomatonId, AutomatonVar, ChannelId, ChannelKind, ClockConstraint,
        ClockId, Edge, EdgeAssignment, FunctionStatement, Network, QueryFormula, ReceiveArg, SyncLabel,
        TimeSum,
    },
    value::SECOND,
};

use crate::{
    network::{
        bounds::ExtrapolationBounds,
        code::{
            CodeLibrary, CompiledExpr, CompiledFunction, CompiledLvalue, CompiledStatement, SyncMedium,
            VariablePlace, VariableScope,
        },
        error::ModelError,
        model::{CompiledNetwork, ObservationOptions},
        number::{NumberType, gcd},
        parts::{
            ClockConstraints, CompiledAutomaton, CompiledEdge, CompiledLocation, EdgeOutput, EdgeSync,
            EdgeUpdate, EventWatch, InputPartner, InputPattern, MultiwayChannel, OutputArgument,
            ParametricConstraint, TimeExpr,
        },
        well_formed,
        width::width,
    },
    zone::constraint::constraints,
};

/// The greatest constant, in units.
const FAR: u64 = 1 << 50;
/// A number that no argument has.
const NEVER: i64 = i64::MIN;

struct NetworkCompiler<'p, 'n> {
    program: &'p Program,
    network: &'n Network,
    unit: Nanos,
    library: CodeLibrary,
}

type ModelResult<T> = std::result::Result<T, ModelError>;

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
        reach: reach?,
        pairs: observe.pairs,
        uses: observe.uses,
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

fn malformed(automaton: &str, what: &str) -> ModelError {
    ModelError::Malformed { automaton: automaton.to_owned(), what: what.to_owned() }
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

    // ── Functions ──

    fn functions(&mut self, network: &Network, members: &[CompiledAutomaton]) -> ModelResult<()> {
        // In two passes, all signatures before any body: functions may call each other in circles.
        let shared: Vec<(VariablePlace, NumberType)> = self
            .program
            .shared
            .iter()
            .enumerate()
            .map(|(i, v)| (VariablePlace::State((members.len() + i) as u32), NumberType::of(v)))
            .collect();
        let mut todo: Vec<(&AutomatonFunction, VariableScope)> = Vec::new();
        for (f, id) in self.program.functions.iter().zip((0..).map(hrdsl_ir::ta::FunctionId)) {
            let owner = f.owner.map(|a| CompiledNetwork::member_of(network, a));
            let (member, vars) = match owner {
                None => (None, shared.clone()),
                // Of an automaton that is not in this network: nobody can call it.
                Some(None) => continue,
                Some(Some(m)) => (Some(m), members[usize::from(m)].names.vars.clone()),
            };
            self.library.numbers.push((id, member, todo.len() as u32));
            let range = |v: &AutomatonVar| (v.lo, v.hi);
            self.library.routines.push(CompiledFunction {
                params: f.params.iter().map(range).collect(),
                types: f.params.iter().map(NumberType::of).collect(),
                frame: f.params.iter().chain(&f.locals).map(range).collect(),
                inits: f.locals.iter().map(|v| v.init).collect(),
                result: f.result.as_ref().map(|v| (NumberType::of(v), v.lo, v.hi)),
                body: Box::default(),
            });
            let frame = f.params.iter().chain(&f.locals).enumerate();
            let locals = frame.map(|(i, v)| (VariablePlace::Local(i as u32), NumberType::of(v)));
            todo.push((f, VariableScope::own(vars.into_iter().chain(locals).collect(), member)));
        }
        for (n, (f, names)) in todo.iter().enumerate() {
            let first = names.vars.len() - f.params.len() - f.locals.len();
            let body = self.body(names, f, first, &f.body);
            let fault = || malformed(&f.name, "a function uses an unknown variable or function");
            self.library.routines[n].body = body.ok_or_else(fault)?;
        }
        Ok(())
    }

    fn body(
        &self,
        names: &VariableScope,
        f: &AutomatonFunction,
        first: usize,
        body: &[FunctionStatement],
    ) -> Option<Box<[CompiledStatement]>> {
        body.iter().map(|s| self.statement(names, f, first, s)).collect()
    }

    fn statement(
        &self,
        names: &VariableScope,
        f: &AutomatonFunction,
        first: usize,
        s: &FunctionStatement,
    ) -> Option<CompiledStatement> {
        let lib = &self.library;
        Some(match s {
            FunctionStatement::Assign { place, value } => {
                let (reach, value) = self.assignment(names, place, value)?;
                CompiledStatement::Assign(reach, value)
            }
            FunctionStatement::Call { function, args } => {
                let routine = lib.routine(*function, names.member)?;
                CompiledStatement::Call(routine, lib.arguments(names, routine, args)?)
            }
            FunctionStatement::If { condition, then, otherwise } => CompiledStatement::If(
                lib.compile(names, condition, NumberType::Bool),
                self.body(names, f, first, then)?,
                self.body(names, f, first, otherwise)?,
            ),
            FunctionStatement::While { condition, body } => CompiledStatement::While(
                lib.compile(names, condition, NumberType::Bool),
                self.body(names, f, first, body)?,
            ),
            FunctionStatement::For { slot, lo, hi, body } => {
                let local = usize::from(*slot).checked_sub(first)?;
                names.vars.get(usize::from(*slot))?;
                let (lo, hi) =
                    (lib.compile(names, lo, NumberType::Int), lib.compile(names, hi, NumberType::Int));
                CompiledStatement::For(local as u32, lo, hi, self.body(names, f, first, body)?)
            }
            FunctionStatement::Return(value) => {
                let ty = f.result.as_ref().map(NumberType::of);
                let code = |e| ty.map(|ty| lib.compile(names, e, ty));
                CompiledStatement::Return(match value {
                    None => None,
                    Some(e) => Some(code(e)?),
                })
            }
        })
    }

    fn assignment(
        &self,
        names: &VariableScope,
        place: &Lvalue,
        value: &Expr,
    ) -> Option<(CompiledLvalue, CompiledExpr)> {
        let reach = self.library.reach(names, place)?;
        let ty = names.vars.get(usize::from(place.slot))?.1;
        Some((reach, self.library.compile(names, value, ty)))
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

    fn clock(&self, clock: ClockId, first: usize) -> u16 {
        let shared = self.program.clocks.len();
        let n = usize::from(clock.0);
        // Clock 0 of a zone is the constant zero.
        (if n < shared { n + 1 } else { first + n - shared }) as u16
    }

    fn times(
        &self,
        automaton: &Automaton,
        names: &VariableScope,
        locals: &[(i64, i64)],
        time: &TimeSum,
    ) -> ModelResult<TimeExpr> {
        let far = || ModelError::Constants { automaton: automaton.name.clone() };
        let mut terms = Vec::new();
        // Without remainder: the unit divides all constants and factors, so that no bound is rounded.
        let mut units = time.nanos / self.unit;
        for t in &time.terms {
            let factor = t.factor / self.unit;
            let code = self.library.compile(names, &t.value, NumberType::Int);
            if let CompiledExpr::Const(n) = code {
                units = n.checked_mul(factor).and_then(|n| units.checked_add(n)).ok_or_else(far)?;
            } else {
                terms.push((factor, code));
            }
        }
        let times = TimeExpr { units, terms };
        let (lo, hi) = times.span(&self.library, locals);
        if lo.unsigned_abs() > FAR || hi.unsigned_abs() > FAR { Err(far()) } else { Ok(times) }
    }

    fn clocks(
        &self,
        automaton: &Automaton,
        names: &VariableScope,
        first: usize,
        locals: &[(i64, i64)],
        constraints_of: &[ClockConstraint],
    ) -> ModelResult<ClockConstraints> {
        let mut out = ClockConstraints::default();
        for c in constraints_of {
            let (i, j) = (self.clock(c.clock, first), c.minus.map_or(0, |m| self.clock(m, first)));
            let time = self.times(automaton, names, locals, &c.bound)?;
            if time.terms.is_empty() {
                constraints(i, j, c.op, time.units, &mut |c| out.fixed.push(c));
            } else {
                let span = time.span(&self.library, locals);
                out.moving.push(ParametricConstraint { i, j, op: c.op, time, span });
            }
        }
        Ok(out)
    }

    // ── Synchronisation ──

    /// Types and ranges of what it carries.
    fn params(&self, medium: SyncMedium) -> Option<Vec<(NumberType, i64, i64)>> {
        let finite = |v: &AutomatonVar| (NumberType::of(v), v.lo, v.hi);
        match medium {
            SyncMedium::Channel(ChannelId(c)) => {
                Some(self.program.channels.get(usize::from(c))?.params.iter().map(finite).collect())
            }
            SyncMedium::Event(e) => {
                let event = self.program.events.get(usize::from(e.0))?;
                let ty = |ty: Type| match ty {
                    Type::Bool => (NumberType::Bool, 0, 1),
                    Type::Int { lo, hi } => (NumberType::Int, lo, hi),
                    Type::Enum(e) => (NumberType::Enum(e), 0, e.values().len() as i64 - 1),
                    Type::Float(_) | Type::Text | Type::List(_) => (NumberType::Constant, 0, i64::MAX),
                };
                Some(event.params.iter().map(|p| ty(p.ty)).collect())
            }
        }
    }

    fn want(&mut self, ty: NumberType, pattern: &ArgPattern) -> Option<i64> {
        match (pattern, ty) {
            (ArgPattern::Any, _) => None,
            (ArgPattern::Is(v), NumberType::Constant) => Some(self.library.constant(*v)),
            (ArgPattern::Is(v), NumberType::Bool | NumberType::Int | NumberType::Enum(_)) => {
                // A value that the parameter cannot have is a pattern that nothing matches, and no fault.
                Some(ty.number(*v).unwrap_or(NEVER))
            }
        }
    }

    /// What an edge receives over a medium. `None`: there is no such medium.
    fn received(
        &mut self,
        medium: SyncMedium,
        args: &[ReceiveArg],
        binders: &mut Vec<NumberType>,
        locals: &mut Vec<(i64, i64)>,
    ) -> Option<EdgeSync> {
        let params = self.params(medium)?;
        Some(EdgeSync::In(self.pattern(medium, args, &params, binders, locals)))
    }

    fn pattern(
        &mut self,
        medium: SyncMedium,
        args: &[ReceiveArg],
        params: &[(NumberType, i64, i64)],
        binders: &mut Vec<NumberType>,
        locals: &mut Vec<(i64, i64)>,
    ) -> InputPattern {
        let (mut wants, mut binds) = (Vec::new(), Vec::new());
        for (i, (arg, &(ty, lo, hi))) in args.iter().zip(params).enumerate() {
            wants.push(match arg {
                ReceiveArg::Match(pattern) => self.want(ty, pattern),
                ReceiveArg::Bind => {
                    binds.push(i as u16);
                    binders.push(ty);
                    locals.push((lo, hi));
                    None
                }
            });
        }
        InputPattern { medium, broadcast: self.broadcast(medium), wants, binds }
    }

    fn signal(
        &mut self,
        automaton: &Automaton,
        names: &VariableScope,
        medium: SyncMedium,
        args: &[Expr],
    ) -> ModelResult<EdgeSync> {
        let unknown = || malformed(&automaton.name, "an edge sends something unknown");
        let params = self.params(medium).ok_or_else(unknown)?;
        let mut all = Vec::new();
        for (arg, (ty, lo, hi)) in args.iter().zip(params) {
            all.push(OutputArgument { code: self.argument(automaton, names, arg, ty)?, range: (lo, hi) });
        }
        let broadcast = self.broadcast(medium);
        Ok(EdgeSync::Out(EdgeOutput { medium, args: all.into(), broadcast, partners: Vec::new() }))
    }

    fn broadcast(&self, medium: SyncMedium) -> bool {
        match medium {
            SyncMedium::Event(_) => true,
            SyncMedium::Channel(ChannelId(c)) => {
                self.program.channels.get(usize::from(c)).is_some_and(|c| c.kind == ChannelKind::Broadcast)
            }
        }
    }

    fn argument(
        &mut self,
        automaton: &Automaton,
        names: &VariableScope,
        arg: &Expr,
        ty: NumberType,
    ) -> ModelResult<CompiledExpr> {
        match ty {
            NumberType::Constant => {
                let value = arg.eval(&|_| None);
                let what = "an argument that is a float, a string or a list must be a constant";
                Ok(CompiledExpr::Const(
                    self.library.constant(value.map_err(|_| malformed(&automaton.name, what))?),
                ))
            }
            NumberType::Enum(to) => Ok(match self.library.typed(names, arg, Some(to)) {
                // A symbol that the parameter does not know is a fault of its own.
                Some((code, NumberType::Enum(from))) if from != to => {
                    let index = |s: &hrdsl_ir::Symbol| to.index_of(*s).map_or(-1, |n| n as i64);
                    CompiledExpr::Convert(Box::new(code), from, from.values().iter().map(index).collect())
                }
                Some(_) | None => self.library.compile(names, arg, ty),
            }),
            NumberType::Bool | NumberType::Int => Ok(self.library.compile(names, arg, ty)),
        }
    }

    fn watch(&mut self, observe: &ObservationOptions) -> Vec<EventWatch> {
        let mut all: Vec<EventWatch> = self.program.events.iter().map(|_| EventWatch::default()).collect();
        for (i, c) in observe.counters.iter().enumerate() {
            for (event, patterns) in self.patterns(&c.patterns) {
                all[event].counters.push((i, patterns));
            }
        }
        for (i, l) in observe.limits.iter().enumerate() {
            for (event, patterns) in self.patterns(&l.patterns) {
                all[event].limits.push((i, patterns));
            }
        }
        all
    }

    /// By event, what the patterns want of its arguments.
    fn patterns(&mut self, patterns: &[EventPattern]) -> Vec<(usize, Vec<Vec<Option<i64>>>)> {
        let mut all: Vec<(usize, Vec<Vec<Option<i64>>>)> = Vec::new();
        for p in patterns {
            let event = usize::from(p.event.0);
            let Some(params) = self.params(SyncMedium::Event(p.event)) else { continue };
            if params.len() != p.args.len() {
                continue;
            }
            let wants = p.args.iter().zip(&params).map(|(a, param)| self.want(param.0, a)).collect();
            match all.iter_mut().find(|a| a.0 == event) {
                Some(known) => known.1.push(wants),
                None => all.push((event, vec![wants])),
            }
        }
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

fn multiway_channels(program: &Program, network: &Network) -> Vec<MultiwayChannel> {
    let mut all = Vec::new();
    for (i, c) in program.channels.iter().enumerate() {
        if let ChannelKind::MultiWay(participants) = &c.kind {
            let member = |a: AutomatonId| CompiledNetwork::member_of(network, a);
            let there = participants.iter().filter_map(|p| member(p.automaton).map(|m| (m, p.optional)));
            all.push(MultiwayChannel {
                channel: ChannelId(i as u16),
                urgent: c.urgent,
                participants: there.collect(),
            });
        }
    }
    all
}

/// Finds for each edge that sends or offers the edges that may match.
fn partners(members: &mut [CompiledAutomaton]) {
    let mut found: Vec<(usize, usize, Vec<InputPartner>)> = Vec::new();
    for (m, member) in members.iter().enumerate() {
        for (e, arrow) in member.edges.iter().enumerate() {
            let EdgeSync::Out(signal) = &arrow.sync else { continue };
            let others = members.iter().enumerate().filter(|(n, _)| *n != m);
            let all = others.filter_map(|(n, other)| partner(n, other, signal)).collect();
            found.push((m, e, all));
        }
    }
    for (m, e, all) in found {
        if let EdgeSync::Out(signal) = &mut members[m].edges[e].sync {
            signal.partners = all;
        }
    }
}

fn partner(n: usize, other: &CompiledAutomaton, signal: &EdgeOutput) -> Option<InputPartner> {
    let may = |e: &u16| match &other.edges[usize::from(*e)].sync {
        EdgeSync::In(p) if p.medium == signal.medium => p
            .wants
            .iter()
            .zip(&signal.args)
            // Only constants are told apart here; what else is sent is compared when it is.
            .all(|(want, arg)| want.is_none_or(|w| arg.code.constant().is_none_or(|n| n == w))),
        EdgeSync::In(_) | EdgeSync::Internal | EdgeSync::Out(_) | EdgeSync::Join { .. } => false,
    };
    let edges: Vec<Box<[u16]>> =
        other.locations.iter().map(|l| l.receiving.iter().copied().filter(may).collect()).collect();
    edges.iter().any(|e| !e.is_empty()).then_some(InputPartner { member: n as u16, edges })
}
