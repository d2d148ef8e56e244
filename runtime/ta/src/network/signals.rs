//! What edges send and receive, and what counters and limits watch of events.

use hrdsl_ir::{
    ArgPattern, EventPattern, Expr, Program, Type,
    ta::{Automaton, AutomatonId, AutomatonVar, ChannelId, ChannelKind, Network, ReceiveArg},
};

use crate::network::{
    code::{CompiledExpr, SyncMedium, VariableScope},
    compiler::{ModelResult, NetworkCompiler, malformed},
    model::{CompiledNetwork, ObservationOptions},
    number::NumberType,
    parts::{
        CompiledAutomaton, EdgeOutput, EdgeSync, EventWatch, InputPartner, InputPattern, MultiwayChannel,
        OutputArgument,
    },
};

/// A number that no argument has.
const NEVER: i64 = i64::MIN;

impl NetworkCompiler<'_, '_> {
    /// Types and ranges of what it carries.
    pub(super) fn params(&self, medium: SyncMedium) -> Option<Vec<(NumberType, i64, i64)>> {
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

    pub(super) fn want(&mut self, ty: NumberType, pattern: &ArgPattern) -> Option<i64> {
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
    pub(super) fn received(
        &mut self,
        medium: SyncMedium,
        args: &[ReceiveArg],
        binders: &mut Vec<NumberType>,
        locals: &mut Vec<(i64, i64)>,
    ) -> Option<EdgeSync> {
        let params = self.params(medium)?;
        Some(EdgeSync::In(self.pattern(medium, args, &params, binders, locals)))
    }

    pub(super) fn pattern(
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

    pub(super) fn signal(
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
        let fixed = all.iter().map(OutputArgument::fixed).collect();
        Ok(EdgeSync::Out(EdgeOutput { medium, args: all.into(), fixed, broadcast, partners: Vec::new() }))
    }

    pub(super) fn broadcast(&self, medium: SyncMedium) -> bool {
        match medium {
            SyncMedium::Event(_) => true,
            SyncMedium::Channel(ChannelId(c)) => {
                self.program.channels.get(usize::from(c)).is_some_and(|c| c.kind == ChannelKind::Broadcast)
            }
        }
    }

    pub(super) fn argument(
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

    pub(super) fn watch(&mut self, observe: &ObservationOptions) -> Vec<EventWatch> {
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
    pub(super) fn patterns(&mut self, patterns: &[EventPattern]) -> Vec<(usize, Vec<Vec<Option<i64>>>)> {
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
}

pub(super) fn multiway_channels(program: &Program, network: &Network) -> Vec<MultiwayChannel> {
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
pub(super) fn partners(members: &mut [CompiledAutomaton]) {
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
