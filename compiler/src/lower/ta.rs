//! Automata: slots of variables, and what the stimulus of an edge emits.

use hrdsl_ir::{
    EventId, Expr, Span,
    expr::Lvalue,
    lowering::{self, VariableSlots as _},
    ta::{
        Automaton, AutomatonFunction, AutomatonVar, Edge, EdgeAssignment, Location, LocationId, LocationKind,
        SyncLabel,
    },
};
use hrdsl_model::{self as model, TypedStimulusStep, VariableRef};

use super::expr::{self, LeafSource};

pub(crate) fn automaton(a: &model::TypedAutomaton, scenario: &model::Scenario) -> Automaton {
    let shared = count(scenario.shared.len());
    // Nothing is bound in a location.
    let slots = EdgeVariableSlots { shared, own: count(a.vars.len()) };
    let mut lowered = Automaton {
        name: a.name.clone(),
        actor: a.actor,
        clocks: a.clocks.clone(),
        vars: a.vars.clone(),
        locations: a.locations.iter().map(|l| l.lower(&slots)).collect(),
        initial: a.initial,
        edges: Vec::new(),
        origin: a.origin,
    };
    let plans: Vec<Option<EmissionChain>> =
        a.edges.iter().map(|e| chain(e, a, scenario, &mut lowered)).collect();
    let slots = EdgeVariableSlots { shared, own: count(lowered.vars.len()) };
    for (edge, plan) in a.edges.iter().zip(plans) {
        let first = edge.lower(&slots);
        match plan {
            Some(plan) => slots.expand(first, &plan, &mut lowered),
            None => lowered.edges.push(first),
        }
    }
    lowered
}

/// `automata` are lowered already: they may have variables that the source does not name.
pub(crate) fn function(
    f: &model::TypedFunction,
    scenario: &model::Scenario,
    automata: &[Automaton],
) -> AutomatonFunction {
    let own = f.owner.and_then(|a| automata.get(usize::from(a.0))).map_or(0, |a| count(a.vars.len()));
    let slots = EdgeVariableSlots { shared: count(scenario.shared.len()), own };
    AutomatonFunction {
        name: f.name.clone(),
        owner: f.owner,
        params: f.params.clone(),
        locals: f.locals.clone(),
        result: f.result.clone(),
        pure: f.pure,
        body: f.body.iter().map(|s| s.lower(&slots)).collect(),
        origin: f.origin,
    }
}

fn count(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

// ── what a stimulus emits ──

/// An event that a stimulus emits, if the conditions around it hold.
struct ConditionalEmission<'a> {
    /// Each with whether it must hold.
    conditions: Vec<(&'a model::TypedExpr, bool)>,
    event: EventId,
    args: &'a [model::TypedExpr],
}

/// The events that follow the stimulus of an edge, each on an edge of its own.
struct EmissionChain<'a> {
    emissions: Vec<ConditionalEmission<'a>>,
    /// What stands for each parameter of the stimulus after the first edge.
    args: Vec<RetainedArgument>,
    /// The part of the generated locations' names before their number.
    stem: String,
}

/// An argument of the stimulus, when the stimulus has been sent.
enum RetainedArgument {
    Const(hrdsl_ir::Value),
    /// A generated variable of the automaton keeps it; by its place among the own variables.
    Kept(u16),
    /// Nothing that is emitted depends on it.
    Unused,
}

fn chain<'a>(
    edge: &'a model::TypedEdge,
    a: &model::TypedAutomaton,
    scenario: &'a model::Scenario,
    lowered: &mut Automaton,
) -> Option<EmissionChain<'a>> {
    let model::TypedSync::Send { event, args } = &edge.sync else { return None };
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
            Some(v) => RetainedArgument::Const(v),
            None if emissions.iter().any(|e| e.reads(count(i))) => {
                let kept = format!("{stem}{}.{}", lowered.vars.len(), param.name);
                // INVARIANT: what an automaton sends and does not know beforehand is of a finite type.
                lowered.vars.extend(AutomatonVar::of_type(&kept, param.ty));
                RetainedArgument::Kept(count(lowered.vars.len() - 1))
            }
            None => RetainedArgument::Unused,
        });
    }
    Some(EmissionChain { emissions, args: after, stem })
}

fn collect<'a>(
    steps: &'a [TypedStimulusStep],
    conditions: &mut Vec<(&'a model::TypedExpr, bool)>,
    emissions: &mut Vec<ConditionalEmission<'a>>,
) {
    for step in steps {
        match step {
            TypedStimulusStep::Emit { event, args } => {
                emissions.push(ConditionalEmission { conditions: conditions.clone(), event: *event, args });
            }
            TypedStimulusStep::If { condition, then, otherwise } => {
                for (steps, holds) in [(then, true), (otherwise, false)] {
                    conditions.push((condition, holds));
                    collect(steps, conditions, emissions);
                    conditions.pop();
                }
            }
            TypedStimulusStep::Hold { .. } | TypedStimulusStep::Act(_) => {}
        }
    }
}

impl ConditionalEmission<'_> {
    fn reads(&self, param: u16) -> bool {
        let mut found = false;
        for e in self.args.iter().chain(self.conditions.iter().map(|(c, _)| *c)) {
            e.each(&mut |e| found |= e.kind == model::TypedExprKind::Leaf(VariableRef::Local(param)));
        }
        found
    }
}

// ── edges ──

/// Where variables are found: `Expr::Var` counts shared, own, then the edge's binders.
struct EdgeVariableSlots {
    shared: u16,
    own: u16,
}

impl lowering::VariableSlots<model::TypedExpr, VariableRef> for EdgeVariableSlots {
    fn expr(&self, e: &model::TypedExpr) -> Expr {
        expr::expr(e, &mut |source| match source {
            LeafSource::Leaf(leaf) => Expr::Var(self.slot(&leaf)),
            LeafSource::Term(..) => expr::ruled_out("measurement in an automaton"),
        })
    }

    fn slot(&self, of: &VariableRef) -> u16 {
        match of {
            VariableRef::Shared(i) => *i,
            VariableRef::Own(i) => self.shared + i,
            VariableRef::Local(i) => self.shared + self.own + i,
            VariableRef::Signal(_) => expr::ruled_out("signal in an automaton"),
        }
    }
}

impl EdgeVariableSlots {
    /// An expression of the stimulus, after its edge.
    fn after(&self, e: &model::TypedExpr, args: &[RetainedArgument]) -> Expr {
        expr::expr(e, &mut |source| match source {
            LeafSource::Leaf(VariableRef::Local(i)) => match args.get(usize::from(i)) {
                Some(RetainedArgument::Const(v)) => Expr::Const(*v),
                Some(RetainedArgument::Kept(own)) => Expr::Var(self.slot(&VariableRef::Own(*own))),
                Some(RetainedArgument::Unused) | None => {
                    expr::ruled_out("argument that is read and not kept")
                }
            },
            LeafSource::Leaf(VariableRef::Own(_) | VariableRef::Shared(_) | VariableRef::Signal(_))
            | LeafSource::Term(..) => expr::ruled_out("variable but locals into a stimulus"),
        })
    }

    /// The condition of an emission: `Ok` if it is known already.
    fn condition(&self, emission: &ConditionalEmission<'_>, args: &[RetainedArgument]) -> Result<bool, Expr> {
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
    fn expand(&self, mut first: Edge, chain: &EmissionChain<'_>, lowered: &mut Automaton) {
        let emissions: Vec<(&ConditionalEmission<'_>, Option<Expr>)> = chain
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
                sync: SyncLabel::Send { event: emission.event, args },
                updates: if last { self.forget(chain, lowered) } else { Vec::new() },
                origin,
            };
            let skip = guard.map(|g| Edge {
                guard: Some(Expr::Unary(hrdsl_ir::expr::UnaryOp::Not, Box::new(g))),
                sync: SyncLabel::Internal,
                ..send.clone()
            });
            lowered.edges.push(send);
            lowered.edges.extend(skip);
        }
    }

    /// Keeps the stimulus's arguments for what it emits, before the updates change what they are made of.
    fn keep(&self, first: &mut Edge, chain: &EmissionChain<'_>) {
        let SyncLabel::Send { args, .. } = &first.sync else { return };
        let kept: Vec<EdgeAssignment> = args
            .iter()
            .zip(&chain.args)
            .filter_map(|(arg, after)| match after {
                RetainedArgument::Kept(own) => Some(EdgeAssignment::Assign {
                    place: Lvalue::slot(self.slot(&VariableRef::Own(*own))),
                    value: arg.clone(),
                }),
                RetainedArgument::Const(_) | RetainedArgument::Unused => None,
            })
            .collect();
        first.updates.splice(0..0, kept);
    }

    /// Sets the kept arguments back, so that they do not multiply the states.
    fn forget(&self, chain: &EmissionChain<'_>, lowered: &Automaton) -> Vec<EdgeAssignment> {
        let back = |own: u16| {
            let var = &lowered.vars[usize::from(own)];
            let value = Expr::Const(var.value(var.init).unwrap_or(hrdsl_ir::Value::Int(var.init)));
            EdgeAssignment::Assign { place: Lvalue::slot(self.slot(&VariableRef::Own(own))), value }
        };
        let kept = |a: &RetainedArgument| if let RetainedArgument::Kept(own) = a { Some(*own) } else { None };
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
        stopped: Vec::new(),
        origin,
    });
    LocationId(count(lowered.locations.len() - 1))
}
