//! What names in a formula stand for: signals and events of the scenario.

use hrdsl_ir::{ArgPattern, Event, EventId, EventPattern, Program, Type, Value, world::SignalId};
use hrdsl_source::nearest;

use super::{
    error::{FormulaError, TextRange},
    tree::{FormulaTree, TreeKind},
};

pub(crate) enum Named {
    Signal(SignalId, Type),
    Event(EventPattern),
}

/// What `released`, `decided(true)` or `distance(a, b)` is.
pub(crate) fn resolve(program: &Program, text: &str, tree: &FormulaTree) -> Result<Named, FormulaError> {
    let shown = text.get(tree.range.clone()).unwrap_or_default();
    let part = |range: &TextRange| text.get(range.clone()).unwrap_or_default();
    let (name, inside) = if let TreeKind::Applied { name, inside } = &tree.kind {
        (part(name), Some(part(inside)))
    } else {
        (shown, None)
    };
    let event = (0_u16..).zip(&program.events).find(|(_, event)| event.name == name);
    if let Some((index, event)) = event {
        return pattern(EventId(index), event, inside, tree).map(Named::Event);
    }
    let wanted = without_blanks(shown);
    let signal = (0_u16..).zip(&program.signals).find(|(_, signal)| without_blanks(&signal.name) == wanted);
    if let Some((index, signal)) = signal {
        return Ok(Named::Signal(SignalId(index), signal.ty));
    }
    let names = program.signals.iter().map(|s| s.name.as_str());
    let near = nearest(shown, names.chain(program.events.iter().map(|e| e.name.as_str())));
    let error = FormulaError::new(&tree.range, format!("no signal or event is called `{shown}`"));
    Err(match near {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None if program.signals.is_empty() => error.help("the scenario has no signals, only events"),
        None => {
            let known: Vec<String> =
                program.signals.iter().take(8).map(|s| format!("`{}`", s.name)).collect();
            error.help(format!(
                "signals of the scenario: {}; a measurement becomes one when a requirement or `signal` names it",
                known.join(", ")
            ))
        }
    })
}

fn without_blanks(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

fn pattern(
    index: EventId,
    event: &Event,
    inside: Option<&str>,
    tree: &FormulaTree,
) -> Result<EventPattern, FormulaError> {
    let given: Vec<&str> = match inside {
        None => Vec::new(),
        Some(inside) if inside.trim().is_empty() => Vec::new(),
        Some(inside) => inside.split(',').map(str::trim).collect(),
    };
    let name = &event.name;
    if given.len() != event.params.len() {
        let wanted = match event.params.len() {
            0 => format!("`{name}`"),
            n => format!("`{name}({})`", vec!["_"; n].join(", ")),
        };
        let message =
            format!("`{name}` has {} parameters, and {} are given", event.params.len(), given.len());
        return Err(FormulaError::new(&tree.range, message).help(format!("{wanted} is any of them")));
    }
    let mut args = Vec::new();
    for (text, parameter) in given.into_iter().zip(&event.params) {
        if text == "_" {
            args.push(ArgPattern::Any);
            continue;
        }
        let Some(value) = value(parameter.ty, text) else {
            let message = format!("`{text}` is no value of `{}`", parameter.name);
            let help = match parameter.ty {
                Type::Enum(of) => format!("its values are {}", of.listed()),
                Type::Bool => "it is `true`, `false` or `_`".to_owned(),
                Type::Int { lo, hi } => format!("it is a whole number from {lo} to {hi}, or `_`"),
                Type::Float(_) | Type::Text | Type::List(_) => "`_` is any value".to_owned(),
            };
            return Err(FormulaError::new(&tree.range, message).help(help));
        };
        args.push(ArgPattern::Is(value));
    }
    Ok(EventPattern { event: index, args })
}

/// A value of an argument. Decimal numbers are not asked for: what is measured is hardly ever exactly something.
fn value(ty: Type, text: &str) -> Option<Value> {
    let value = match ty {
        Type::Bool => Value::Bool(text.parse().ok()?),
        Type::Int { .. } => Value::Int(text.parse().ok()?),
        Type::Enum(of) => Value::Symbol(of.symbol(text)?),
        Type::Float(_) | Type::Text | Type::List(_) => return None,
    };
    ty.admits(value).then_some(value)
}
