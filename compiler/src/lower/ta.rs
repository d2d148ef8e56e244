//! Automata: slots of variables, and what the stimulus of an edge emits.

use hrdsl_ir::{
    ArgPattern, EventId, Expr, Span, Type,
    expr::Place,
    ta::{
        Automaton, Channel, ChannelKind, ClockConstraint, Edge, Location, LocationId, LocationKind, Network,
        Party, ReceiveArg, Sync, Time, TimeTerm, Update, Var,
    },
};
use hrdsl_model::{self as model, Leaf, StimulusStep};
use hrdsl_syntax::ast;

use super::expr::{self, Source};

pub(crate) fn network(n: &model::Network) -> Network {
    let automata = n.automata.clone();
    Network { name: n.name.clone(), automata, origin: n.span }
}

pub(crate) fn var(v: &model::Var) -> Var {
    let init = match v.init {
        model::Value::Bool(b) => i64::from(b),
        model::Value::Int(n) => n,
        model::Value::Symbol(symbol) => match v.ty {
            model::Type::Enum(of) => of.index_of(symbol).map_or(0, |i| i as i64),
            model::Type::Bool
            | model::Type::Int { .. }
            | model::Type::Float(_)
            | model::Type::Text
            | model::Type::List(_) => 0,
        },
        model::Value::Float(_) | model::Value::Text(_) | model::Value::List(_) => 0,
    };
    Var { init, ..bounded(&v.name, v.ty) }
}

/// A variable over a finite type, starting with its first value.
pub(super) fn bounded(name: &str, ty: model::Type) -> Var {
    let (lo, hi, is_bool, enumeration) = match expr::ty(ty) {
        Type::Int { lo, hi } => (lo, hi, false, None),
        Type::Enum(e) => (0, e.values().len() as i64 - 1, false, Some(e)),
        // INVARIANT: the checker has ruled out what is not finite.
        Type::Bool | Type::Float(_) | Type::Text | Type::List(_) => (0, 1, true, None),
    };
    Var { name: name.to_owned(), lo, hi, init: lo, is_bool, enumeration }
}

pub(crate) fn channel(c: &model::Channel) -> Channel {
    let party = |p: &model::Party| Party { automaton: p.automaton, optional: p.optional };
    Channel {
        name: c.name.clone(),
        kind: match &c.kind {
            model::ChannelKind::HandShake => ChannelKind::HandShake,
            model::ChannelKind::Broadcast => ChannelKind::Broadcast,
            model::ChannelKind::Joint(parties) => ChannelKind::Joint(parties.iter().map(party).collect()),
        },
        urgent: c.urgent,
        params: c.params.iter().map(|p| bounded(&p.name, p.ty)).collect(),
        origin: c.span,
    }
}

pub(crate) fn automaton(a: &model::Automaton, scenario: &model::Scenario) -> Automaton {
    let shared = count(scenario.shared.len());
    // Nothing is bound in a location.
    let slots = Slots { shared, own: count(a.vars.len()) };
    let mut lowered = Automaton {
        name: a.name.clone(),
        actor: a.actor,
        clocks: a.clocks.clone(),
        vars: a.vars.iter().map(var).collect(),
        locations: a.locations.iter().map(|l| slots.location(l)).collect(),
        initial: a.initial,
        edges: Vec::new(),
        origin: a.span,
    };
    let plans: Vec<Option<Chain>> = a.edges.iter().map(|e| chain(e, a, scenario, &mut lowered)).collect();
    let slots = Slots { shared, own: count(lowered.vars.len()) };
    for (edge, plan) in a.edges.iter().zip(plans) {
        let first = slots.edge(edge);
        match plan {
            Some(plan) => slots.expand(first, &plan, &mut lowered),
            None => lowered.edges.push(first),
        }
    }
    lowered
}

pub(super) fn count(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

// ── what a stimulus emits ──

/// An event that a stimulus emits, if the conditions around it hold.
struct Emission<'a> {
    /// Each with whether it must hold.
    conditions: Vec<(&'a model::Expr, bool)>,
    event: EventId,
    args: &'a [model::Expr],
}

/// The events that follow the stimulus of an edge, each on an edge of its own.
struct Chain<'a> {
    emissions: Vec<Emission<'a>>,
    /// What stands for each parameter of the stimulus after the first edge.
    args: Vec<After>,
    /// The part of the generated locations' names before their number.
    stem: String,
}

/// An argument of the stimulus, when the stimulus has been sent.
enum After {
    Const(hrdsl_ir::Value),
    /// A generated variable of the automaton keeps it; by its place among the own variables.
    Kept(u16),
    /// Nothing that is emitted depends on it.
    Unused,
}

fn chain<'a>(
    edge: &'a model::Edge,
    a: &model::Automaton,
    scenario: &'a model::Scenario,
    lowered: &mut Automaton,
) -> Option<Chain<'a>> {
    let model::Sync::Send { event, args } = &edge.sync else { return None };
    let event = &scenario.events[usize::from(event.0)];
    let mut emissions = Vec::new();
    collect(&event.stimulus.as_ref()?.steps, &mut Vec::new(), &mut emissions);
    if emissions.is_empty() {
        return None;
    }
    let name = |l: model::LocationId| a.locations[usize::from(l.0)].name.as_str();
    let stem = format!("{}.{}~", name(edge.from), name(edge.to));
    let mut after = Vec::new();
    for (i, (arg, param)) in args.iter().zip(&event.params).enumerate() {
        after.push(match arg.constant() {
            Some(v) => After::Const(expr::value(v)),
            None if emissions.iter().any(|e| e.reads(count(i))) => {
                let kept = format!("{stem}{}.{}", lowered.vars.len(), param.name);
                lowered.vars.push(bounded(&kept, param.ty));
                After::Kept(count(lowered.vars.len() - 1))
            }
            None => After::Unused,
        });
    }
    Some(Chain { emissions, args: after, stem })
}

fn collect<'a>(
    steps: &'a [StimulusStep],
    conditions: &mut Vec<(&'a model::Expr, bool)>,
    emissions: &mut Vec<Emission<'a>>,
) {
    for step in steps {
        match step {
            StimulusStep::Emit { event, args } => {
                emissions.push(Emission { conditions: conditions.clone(), event: *event, args });
            }
            StimulusStep::If { condition, then, otherwise } => {
                for (steps, holds) in [(then, true), (otherwise, false)] {
                    conditions.push((condition, holds));
                    collect(steps, conditions, emissions);
                    conditions.pop();
                }
            }
            StimulusStep::Hold(_) | StimulusStep::Act(_) => {}
        }
    }
}

impl Emission<'_> {
    fn reads(&self, param: u16) -> bool {
        let mut found = false;
        for e in self.args.iter().chain(self.conditions.iter().map(|(c, _)| *c)) {
            e.each(&mut |e| found |= e.kind == model::ExprKind::Leaf(Leaf::Local(param)));
        }
        found
    }
}

// ── edges ──

/// Where variables are found: `Expr::Var` counts shared, own, then the edge's binders.
pub(super) struct Slots {
    pub shared: u16,
    pub own: u16,
}

impl Slots {
    pub(super) fn slot(&self, leaf: Leaf) -> u16 {
        match leaf {
            Leaf::Shared(i) => i,
            Leaf::Own(i) => self.shared + i,
            Leaf::Local(i) => self.shared + self.own + i,
            // INVARIANT: automata do not read signals.
            Leaf::Signal(_) => u16::MAX,
        }
    }

    pub(super) fn expr(&self, e: &model::Expr) -> Expr {
        expr::expr(e, &mut |source| self.read(&source))
    }

    pub(super) fn place(&self, place: &model::Place) -> Place {
        expr::place(place, &mut |source| self.read(&source))
    }

    fn read(&self, source: &Source) -> Expr {
        match source {
            Source::Leaf(leaf) => Expr::Var(self.slot(*leaf)),
            // INVARIANT: automata measure nothing.
            Source::Term(..) => Expr::bool(false),
        }
    }

    fn location(&self, l: &model::Location) -> Location {
        Location {
            name: l.name.clone(),
            kind: match l.kind {
                ast::LocationKind::Normal => LocationKind::Normal,
                ast::LocationKind::Urgent => LocationKind::Urgent,
                ast::LocationKind::Committed => LocationKind::Committed,
            },
            invariant: self.bounds(&l.invariant),
            holds: l.holds.as_ref().map(|e| self.expr(e)),
            origin: l.span,
        }
    }

    fn bounds(&self, cs: &[model::ClockConstraint]) -> Vec<ClockConstraint> {
        let bound = |c: &model::ClockConstraint| ClockConstraint {
            clock: c.clock,
            minus: c.minus,
            op: c.op,
            bound: self.time(&c.bound),
        };
        cs.iter().map(bound).collect()
    }

    fn time(&self, t: &model::Time) -> Time {
        let term =
            |(factor, value): &(i64, model::Expr)| TimeTerm { factor: *factor, value: self.expr(value) };
        Time { nanos: t.nanos, terms: t.terms.iter().map(term).collect() }
    }

    fn sync(&self, sync: &model::Sync) -> Sync {
        let received = |arg: &model::ReceiveArg| match arg {
            model::ReceiveArg::Any => ReceiveArg::Match(ArgPattern::Any),
            model::ReceiveArg::Is(v) => ReceiveArg::Match(ArgPattern::Is(expr::value(*v))),
            model::ReceiveArg::Bind => ReceiveArg::Bind,
        };
        let sent = |args: &[model::Expr]| args.iter().map(|a| self.expr(a)).collect();
        match sync {
            model::Sync::Internal => Sync::Internal,
            model::Sync::Send { event, args } => Sync::Send { event: *event, args: sent(args) },
            model::Sync::Receive { event, args } => {
                Sync::Receive { event: *event, args: args.iter().map(received).collect() }
            }
            model::Sync::Offer { channel, args } => Sync::Offer { channel: *channel, args: sent(args) },
            model::Sync::Accept { channel, args } => {
                Sync::Accept { channel: *channel, args: args.iter().map(received).collect() }
            }
            model::Sync::Join { channel } => Sync::Join { channel: *channel },
        }
    }

    fn edge(&self, e: &model::Edge) -> Edge {
        let update = |u: &model::Update| match u {
            model::Update::Shared(i, v) => {
                Update::Assign { place: Place::slot(self.slot(Leaf::Shared(*i))), value: self.expr(v) }
            }
            model::Update::Own(i, v) => {
                Update::Assign { place: Place::slot(self.slot(Leaf::Own(*i))), value: self.expr(v) }
            }
            model::Update::Element(place, v) => {
                Update::Assign { place: self.place(place), value: self.expr(v) }
            }
            model::Update::Call(function, args) => {
                Update::Call { function: *function, args: args.iter().map(|a| self.expr(a)).collect() }
            }
            model::Update::Reset { clock, from, to } => {
                Update::Reset { clock: *clock, from: *from, to: self.time(to) }
            }
        };
        Edge {
            from: e.from,
            to: e.to,
            selects: e.selects.iter().map(|s| bounded(&s.name, s.ty)).collect(),
            clock_guard: self.bounds(&e.clock_guard),
            guard: e.guard.as_ref().map(|g| self.expr(g)),
            sync: self.sync(&e.sync),
            updates: e.updates.iter().map(update).collect(),
            origin: e.span,
        }
    }

    /// An expression of the stimulus, after its edge.
    fn after(&self, e: &model::Expr, args: &[After]) -> Expr {
        expr::expr(e, &mut |source| match source {
            Source::Leaf(Leaf::Local(i)) => match args.get(usize::from(i)) {
                Some(After::Const(v)) => Expr::Const(*v),
                Some(After::Kept(own)) => Expr::Var(self.slot(Leaf::Own(*own))),
                Some(After::Unused) | None => Expr::bool(false),
            },
            Source::Leaf(Leaf::Own(_) | Leaf::Shared(_) | Leaf::Signal(_)) | Source::Term(..) => {
                Expr::bool(false)
            }
        })
    }

    /// The condition of an emission: `Ok` if it is known already.
    fn condition(&self, emission: &Emission<'_>, args: &[After]) -> Result<bool, Expr> {
        let mut left: Option<Expr> = None;
        for (condition, holds) in &emission.conditions {
            let e = self.after(condition, args);
            let e = if *holds { e } else { Expr::Unary(hrdsl_ir::expr::UnaryOp::Not, Box::new(e)) };
            match e.eval(&|_| None) {
                Ok(hrdsl_ir::Value::Bool(true)) => {}
                Ok(_) => return Ok(false),
                Err(_) => {
                    left = Some(match left {
                        Some(before) => Expr::binary(hrdsl_ir::expr::BinaryOp::And, before, e),
                        None => e,
                    });
                }
            }
        }
        left.map_or(Ok(true), Err)
    }

    /// The stimulus on the first edge, with its updates; then each event on an edge between committed locations.
    fn expand(&self, mut first: Edge, chain: &Chain<'_>, lowered: &mut Automaton) {
        let emissions: Vec<(&Emission<'_>, Option<Expr>)> = chain
            .emissions
            .iter()
            .filter_map(|e| match self.condition(e, &chain.args) {
                Ok(false) => None,
                Ok(true) => Some((e, None)),
                Err(guard) => Some((e, Some(guard))),
            })
            .collect();
        let (target, origin) = (first.to, first.origin);
        self.keep(&mut first, chain);
        if emissions.is_empty() {
            lowered.edges.push(first);
            return;
        }
        let stops: Vec<LocationId> =
            emissions.iter().map(|_| intermediate(lowered, &chain.stem, origin)).collect();
        first.to = stops[0];
        lowered.edges.push(first);
        for (i, (emission, guard)) in emissions.into_iter().enumerate() {
            let args = emission.args.iter().map(|a| self.after(a, &chain.args)).collect();
            let last = i + 1 == stops.len();
            let send = Edge {
                from: stops[i],
                to: if last { target } else { stops[i + 1] },
                selects: Vec::new(),
                clock_guard: Vec::new(),
                guard: guard.clone(),
                sync: Sync::Send { event: emission.event, args },
                updates: if last { self.forget(chain, lowered) } else { Vec::new() },
                origin,
            };
            let skip = guard.map(|g| Edge {
                guard: Some(Expr::Unary(hrdsl_ir::expr::UnaryOp::Not, Box::new(g))),
                sync: Sync::Internal,
                ..send.clone()
            });
            lowered.edges.push(send);
            lowered.edges.extend(skip);
        }
    }

    /// Keeps the stimulus's arguments for what it emits, before the updates change what they are made of.
    fn keep(&self, first: &mut Edge, chain: &Chain<'_>) {
        let Sync::Send { args, .. } = &first.sync else { return };
        let kept: Vec<Update> = args
            .iter()
            .zip(&chain.args)
            .filter_map(|(arg, after)| match after {
                After::Kept(own) => Some(Update::Assign {
                    place: Place::slot(self.slot(Leaf::Own(*own))),
                    value: arg.clone(),
                }),
                After::Const(_) | After::Unused => None,
            })
            .collect();
        first.updates.splice(0..0, kept);
    }

    /// Sets the kept arguments back, so that they do not multiply the states.
    fn forget(&self, chain: &Chain<'_>, lowered: &Automaton) -> Vec<Update> {
        let back = |own: u16| {
            let var = &lowered.vars[usize::from(own)];
            let value = Expr::Const(var.value(var.init).unwrap_or(hrdsl_ir::Value::Int(var.init)));
            Update::Assign { place: Place::slot(self.slot(Leaf::Own(own))), value }
        };
        let kept = |a: &After| if let After::Kept(own) = a { Some(*own) } else { None };
        chain.args.iter().filter_map(kept).map(back).collect()
    }
}

/// A new committed location; `~`, which no name in the source has, marks it as generated.
fn intermediate(lowered: &mut Automaton, stem: &str, origin: Span) -> LocationId {
    let taken = lowered.locations.iter().filter(|l| l.name.starts_with(stem)).count();
    lowered.locations.push(Location {
        name: format!("{stem}{}", taken + 1),
        kind: LocationKind::Committed,
        invariant: Vec::new(),
        holds: None,
        origin,
    });
    LocationId(count(lowered.locations.len() - 1))
}
