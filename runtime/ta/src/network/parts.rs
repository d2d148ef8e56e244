//! What a compiled network consists of: its automata with their locations and edges, in numbers.

use hrdsl_ir::ta::{ChannelId, ClockOp, LocationKind};

use crate::{
    network::code::{
        CodeEvalContext, CodeEvalError, CodeLibrary, CompiledExpr, CompiledLvalue, SyncMedium, VariableScope,
    },
    network::number::NumberType,
    zone::constraint::{DifferenceConstraint, constraints},
};

/// A time with variables: `units + Σ factor · value`.
#[derive(Clone, Debug, Default)]
pub(crate) struct TimeExpr {
    pub units: i64,
    pub terms: Vec<(i64, CompiledExpr)>,
}

impl TimeExpr {
    pub(crate) fn eval(&self, env: &mut CodeEvalContext) -> Result<i64, CodeEvalError> {
        let mut sum = self.units;
        for (factor, value) in &self.terms {
            let n = value.eval(env)?.checked_mul(*factor).and_then(|n| sum.checked_add(n));
            sum = n.ok_or(CodeEvalError::Eval(hrdsl_ir::expr::EvalError::Overflow))?;
        }
        Ok(sum)
    }

    /// The least and greatest it can be.
    pub(crate) fn span(&self, library: &CodeLibrary, locals: &[(i64, i64)]) -> (i64, i64) {
        self.terms.iter().fold((self.units, self.units), |(lo, hi), (factor, value)| {
            let (a, b, _) = value.span(library, locals);
            let (a, b) = (a.saturating_mul(*factor), b.saturating_mul(*factor));
            (lo.saturating_add(a.min(b)), hi.saturating_add(a.max(b)))
        })
    }
}

/// A constraint whose bound variables have a part in: `x_i - x_j op time`.
#[derive(Clone, Debug)]
pub(crate) struct ParametricConstraint {
    pub i: u16,
    pub j: u16,
    pub op: ClockOp,
    pub time: TimeExpr,
    /// The least and greatest bound.
    pub span: (i64, i64),
}

/// A conjunction of constraints on clocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClockConstraints {
    pub fixed: Vec<DifferenceConstraint>,
    pub moving: Vec<ParametricConstraint>,
}

impl ClockConstraints {
    /// All constraints, with the bounds that they have now; with a fault, those that have one.
    pub(crate) fn eval(
        &self,
        env: &mut CodeEvalContext,
        out: &mut Vec<DifferenceConstraint>,
    ) -> Result<(), CodeEvalError> {
        out.extend_from_slice(&self.fixed);
        let mut result = Ok(());
        for m in &self.moving {
            match m.time.eval(env) {
                Ok(n) => constraints(m.i, m.j, m.op, n, &mut |c| out.push(c)),
                Err(fault) => result = result.and(Err(fault)),
            }
        }
        result
    }
}

/// One automaton of the network.
pub(crate) struct CompiledAutomaton<'p> {
    pub automaton: &'p hrdsl_ir::ta::Automaton,
    /// The slot of its first own variable.
    pub base: usize,
    /// The number of its first own clock in the network.
    pub first_clock: usize,
    /// What its expressions call its variables.
    pub names: VariableScope,
    pub locations: Vec<CompiledLocation>,
    pub edges: Vec<CompiledEdge<'p>>,
}

/// A location.
pub(crate) struct CompiledLocation {
    pub kind: LocationKind,
    pub invariant: ClockConstraints,
    pub holds: Option<CompiledExpr>,
    /// The network's clocks that stand still.
    pub stopped: Vec<u16>,
    /// Internal, sending and offering edges, in source order.
    pub active: Vec<u16>,
    /// Receiving and accepting edges, in source order.
    pub receiving: Vec<u16>,
    /// Edges of multi-way channels, in source order.
    pub joining: Vec<u16>,
    /// Edges that offer on an urgent channel.
    pub urgent: Vec<u16>,
}

/// An edge.
pub(crate) struct CompiledEdge<'p> {
    pub edge: &'p hrdsl_ir::ta::Edge,
    /// Its number among all edges of the network, from 1.
    pub number: u32,
    pub guard: ClockConstraints,
    pub data: Option<CompiledExpr>,
    /// Ranges of the selects.
    pub selects: Vec<(i64, i64)>,
    /// Of the selects, then of what it binds.
    pub binders: Vec<NumberType>,
    pub sync: EdgeSync,
    pub updates: Vec<EdgeUpdate>,
    /// The network's slots that it reads, each once.
    pub reads: Vec<u32>,
}

impl CompiledEdge<'_> {
    /// The ranges of what it selects and binds, as far as they are known.
    pub(crate) fn locals(&self, _: &CodeLibrary) -> Vec<(i64, i64)> {
        let mut all = self.selects.clone();
        all.extend(self.binders[self.selects.len()..].iter().map(|ty| match ty {
            NumberType::Bool => (0, 1),
            NumberType::Enum(e) => (0, e.values().len() as i64 - 1),
            NumberType::Int | NumberType::Constant => (i64::MIN, i64::MAX),
        }));
        all
    }

    pub(crate) fn from(&self) -> usize {
        usize::from(self.edge.from.0)
    }

    pub(crate) fn to(&self) -> usize {
        usize::from(self.edge.to.0)
    }
}

/// How an edge takes part.
pub(crate) enum EdgeSync {
    Internal,
    Out(EdgeOutput),
    In(InputPattern),
    Join { channel: ChannelId, optional: bool },
}

/// What an edge sends or offers.
pub(crate) struct EdgeOutput {
    pub medium: SyncMedium,
    pub args: Box<[OutputArgument]>,
    /// What it always sends, if all of it is constant and within its ranges.
    pub fixed: Option<Box<[i64]>>,
    /// The others take part if they can; otherwise exactly one takes part.
    pub broadcast: bool,
    pub partners: Vec<InputPartner>,
}

pub(crate) struct OutputArgument {
    pub code: CompiledExpr,
    /// The range that its parameter allows.
    pub range: (i64, i64),
}

impl OutputArgument {
    /// What it always is, if that is within its range.
    pub(crate) fn fixed(&self) -> Option<i64> {
        self.code.constant().filter(|n| (self.range.0..=self.range.1).contains(n))
    }
}

/// An automaton that may take what an edge sends.
pub(crate) struct InputPartner {
    pub member: u16,
    /// By its location: the edges that may match.
    pub edges: Vec<Box<[u16]>>,
}

/// What a receiving edge takes.
pub(crate) struct InputPattern {
    pub medium: SyncMedium,
    /// The sender does not wait for it.
    pub broadcast: bool,
    /// For each argument: what it must be.
    pub wants: Vec<Option<i64>>,
    /// Arguments that are bound, in order.
    pub binds: Vec<u16>,
}

impl InputPattern {
    pub(crate) fn matches(&self, args: &[i64]) -> bool {
        self.wants.iter().zip(args).all(|(want, n)| want.is_none_or(|w| w == *n))
    }
}

/// An update.
pub(crate) enum EdgeUpdate {
    Assign(CompiledLvalue, CompiledExpr),
    Reset { clock: u16, from: Option<u16>, to: TimeExpr },
    Call(u32, Box<[CompiledExpr]>),
}

/// A multi-way channel.
pub(crate) struct MultiwayChannel {
    pub channel: ChannelId,
    pub urgent: bool,
    /// Index in the network; whether it may stay away.
    pub participants: Vec<(u16, bool)>,
}

/// What counts an event.
#[derive(Default)]
pub(crate) struct EventWatch {
    /// Counter, patterns.
    pub counters: Vec<(usize, Vec<Vec<Option<i64>>>)>,
    pub limits: Vec<(usize, Vec<Vec<Option<i64>>>)>,
}

/// Whether time may not pass.
pub(crate) fn stops_time(kind: LocationKind) -> bool {
    kind != LocationKind::Normal
}
