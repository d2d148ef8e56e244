//! Event patterns as receiving edges: who takes part in which events, the first of several rules alone.

use hrdsl_ir::{
    ArgPattern, EventId, EventPattern, Expr, Program, Type, Value,
    expr::{BinaryOp, UnaryOp},
    ta::ReceiveArg,
};

/// The receiving half of an edge.
pub(super) struct ReceptionHalf {
    /// The rule that it is for.
    pub rule: usize,
    pub event: EventId,
    pub args: Vec<ReceiveArg>,
    pub guard: Option<Expr>,
}

/// One way of receiving for each event and each of the rules, which are tried in order: an event belongs to the first that
/// has a pattern for it. `binders` is the slot of an edge's first binder.
///
/// # Errors
/// Patterns that tell apart numbers of infinite types in more than one way.
pub(super) fn receptions(
    program: &Program,
    rules: &[&[EventPattern]],
    binders: u16,
) -> Result<Vec<ReceptionHalf>, String> {
    let mut events: Vec<EventId> = rules.iter().flat_map(|r| r.iter().map(|p| p.event)).collect();
    events.sort_unstable();
    events.dedup();
    let mut all = Vec::new();
    for event in events {
        of_event(program, rules, event, binders, &mut all)?;
    }
    // In the order of the rules, so that the edges stand as in the monitor.
    all.sort_by_key(|r: &ReceptionHalf| r.rule);
    Ok(all)
}

/// What a pattern wants of the arguments: which, and what each must be.
type RequiredArguments = Vec<(usize, Value)>;

fn wanted(pattern: &EventPattern) -> RequiredArguments {
    let numbered = pattern.args.iter().enumerate();
    numbered
        .filter_map(|(i, a)| match a {
            ArgPattern::Is(v) => Some((i, *v)),
            ArgPattern::Any => None,
        })
        .collect()
}

fn of_event(
    program: &Program,
    rules: &[&[EventPattern]],
    event: EventId,
    binders: u16,
    out: &mut Vec<ReceptionHalf>,
) -> Result<(), String> {
    let params = &program.event(event).params;
    let of_rule = |r: &&[EventPattern]| -> Vec<RequiredArguments> {
        r.iter().filter(|p| p.event == event).map(wanted).collect()
    };
    let conditions: Vec<Vec<RequiredArguments>> = rules.iter().map(of_rule).collect();
    let mut told: Vec<usize> = conditions.iter().flatten().flatten().map(|(i, _)| *i).collect();
    told.sort_unstable();
    told.dedup();
    let finite = |i: &usize| match params[*i].ty {
        Type::Bool | Type::Int { .. } | Type::Enum(_) => true,
        Type::Float(_) | Type::Text | Type::List(_) => false,
    };
    let named: Vec<(usize, &Vec<RequiredArguments>)> =
        conditions.iter().enumerate().filter(|(_, c)| !c.is_empty()).collect();
    // A single pattern needs no condition.
    if let [(rule, alternatives)] = named.as_slice()
        && let [only] = alternatives.as_slice()
    {
        let arg = |i: usize| {
            only.iter().find(|(at, _)| *at == i).map_or(ArgPattern::Any, |(_, v)| ArgPattern::Is(*v))
        };
        let args = (0..params.len()).map(|i| ReceiveArg::Match(arg(i))).collect();
        out.push(ReceptionHalf { rule: *rule, event, args, guard: None });
        return Ok(());
    }
    if !told.iter().all(finite) {
        return Err(format!(
            "it tells apart arguments of `{}` that have infinitely many values",
            program.event(event).name
        ));
    }
    let slot = |i: usize| {
        let at = told.iter().position(|t| *t == i).unwrap_or(0);
        binders.saturating_add(u16::try_from(at).unwrap_or(u16::MAX))
    };
    let args: Vec<ReceiveArg> = (0..params.len())
        .map(|i| if told.contains(&i) { ReceiveArg::Bind } else { ReceiveArg::Match(ArgPattern::Any) })
        .collect();
    let mut earlier: Vec<Expr> = Vec::new();
    for (rule, alternatives) in named {
        let here = any_of(alternatives.iter().map(|w| all_of(w.iter().map(|(i, v)| equal(slot(*i), *v)))));
        let all = here == Expr::bool(true);
        let not_before = earlier.iter().map(|e| Expr::Unary(UnaryOp::Not, Box::new(e.clone())));
        let guard = all_of(not_before.chain((!all).then(|| here.clone())));
        let guard = (guard != Expr::bool(true)).then_some(guard);
        out.push(ReceptionHalf { rule, event, args: args.clone(), guard });
        if all {
            // Nothing is left for later rules.
            break;
        }
        earlier.push(here);
    }
    Ok(())
}

fn equal(slot: u16, value: Value) -> Expr {
    Expr::binary(BinaryOp::Eq, Expr::Var(slot), Expr::Const(value))
}

fn all_of(parts: impl Iterator<Item = Expr>) -> Expr {
    parts.reduce(|a, b| Expr::binary(BinaryOp::And, a, b)).unwrap_or(Expr::bool(true))
}

/// The first that always holds makes the whole so.
fn any_of(parts: impl Iterator<Item = Expr>) -> Expr {
    let parts: Vec<Expr> = parts.collect();
    if parts.contains(&Expr::bool(true)) {
        return Expr::bool(true);
    }
    parts.into_iter().reduce(|a, b| Expr::binary(BinaryOp::Or, a, b)).unwrap_or(Expr::bool(false))
}
