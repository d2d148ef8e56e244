//! The internal actions: what their arguments must be. How they are written is in `write::internal`.

use hrdsl_ir::real::RealFunction;

use super::{
    ast::{AgentSpeakLiteral, AgentSpeakTerm, TermKind},
    infer::TypeInferrer,
    term::{AgentSpeakMessage, OmissionReason, atom, literal, message, performative},
    types::{AgentSpeakType, TyId},
};

/// The types of an internal action's arguments.
#[expect(clippy::too_many_lines, reason = "a flat match")]
pub fn infer(walk: &mut TypeInferrer, of: &AgentSpeakLiteral) -> Result<(), OmissionReason> {
    if of.negated {
        return Err("an internal action cannot be negated".to_owned());
    }
    let number = |walk: &mut TypeInferrer, t: &AgentSpeakTerm| {
        let number = walk.types.number(false);
        same(walk, t, number)
    };
    match (of.functor.as_str(), of.args.as_slice()) {
        (".print" | ".println", args) => args.iter().try_for_each(|a| printed(walk, a)),
        (".send" | ".broadcast", _) => sent(walk, &message(of)?),
        (".findall" | ".setof", [template, formula, list]) => {
            let of = walk.term(template)?;
            walk.formula(formula)?;
            let expected = walk.types.add(AgentSpeakType::List(of));
            same(walk, list, expected)
        }
        (".count", [formula, n]) => {
            walk.formula(formula)?;
            number(walk, n)
        }
        (".length", [list, n]) => {
            walk.term(list)?;
            number(walk, n)
        }
        (".member", [element, list]) | (".min" | ".max" | ".random", [list, element]) => {
            in_list(walk, element, list)
        }
        (".nth", [index, list, element]) => {
            number(walk, index)?;
            in_list(walk, element, list)
        }
        (".concat", [args @ .., result]) if args.len() > 1 => {
            let args = args.iter().map(|a| walk.term(a)).collect::<Result<Vec<TyId>, _>>()?;
            let result = walk.term(result)?;
            walk.types.concats.push((args, result));
            Ok(())
        }
        (".reverse", [a, b]) | (".prefix" | ".suffix" | ".sublist", [a, b]) => {
            let id = walk.term(a)?;
            same(walk, b, id)
        }
        (".sort" | ".shuffle", [a, b]) => lists(walk, &[a, b]),
        (".union" | ".intersection" | ".difference", [a, b, c]) => lists(walk, &[a, b, c]),
        (".delete", [element, a, b]) => {
            let id = walk.term(element)?;
            if let Some(other) = other_deletion(walk.types.get(id)) {
                return Err(other.to_owned());
            }
            in_list(walk, element, a)?;
            lists(walk, &[a, b])
        }
        (".substring", [part, whole, places @ ..]) if places.len() < 3 => {
            for t in [part, whole] {
                let text = walk.types.add(AgentSpeakType::Text);
                same(walk, t, text)?;
            }
            places.iter().try_for_each(|p| number(walk, p))
        }
        (".number" | ".string" | ".list" | ".atom" | ".structure" | ".literal" | ".ground", [term]) => {
            walk.term(term).map(|_| ())
        }
        (".empty", [list]) => walk.term(list).map(|_| ()),
        (".term2string", [value, text]) => {
            walk.term(value)?;
            let expected = walk.types.add(AgentSpeakType::Text);
            same(walk, text, expected)
        }
        (".random", [x]) => {
            let float = walk.types.number(true);
            same(walk, x, float)
        }
        (".range", [a, b, c]) => [a, b, c].into_iter().try_for_each(|t| number(walk, t)),
        (".my_name", [a]) => {
            let agent = walk.types.agent();
            same(walk, a, agent)
        }
        (".all_names", [list]) => {
            let agent = walk.types.agent();
            let expected = walk.types.add(AgentSpeakType::List(agent));
            same(walk, list, expected)
        }
        (".wait", args) => waited(walk, args),
        (
            ".intend" | ".desire" | ".suspended" | ".drop_intention" | ".drop_desire" | ".drop_event"
            | ".succeed_goal" | ".fail_goal" | ".suspend" | ".resume",
            [goal],
        ) => walk.goal(literal(goal)?),
        (".abolish", [belief]) => walk.belief(literal(belief)?),
        (".drop_all_intentions" | ".drop_all_desires" | ".drop_all_events" | ".suspend", [])
        | (".fail", _) => Ok(()),
        (".fork", [kind, bodies @ ..])
            if matches!(atom(kind), Some("and" | "or"))
                && bodies.len() > 1
                && bodies.iter().all(|b| matches!(b.kind, TermKind::Body(_))) =>
        {
            Ok(())
        }
        (name, args) => {
            Err(format!("hrdsl has no internal action like `{name}` with {} arguments", args.len()))
        }
    }
}

/// What `.delete` does in Jason where its first argument is not an element, but something of this type.
fn other_deletion(first: &AgentSpeakType) -> Option<&'static str> {
    if matches!(first, AgentSpeakType::Number { .. }) {
        return Some("with a number `.delete` takes away what is at that place");
    }
    let cuts =
        "with a string `.delete` takes away parts of a string: `.occurrences` finds them, `.slice` cuts";
    matches!(first, AgentSpeakType::Text).then_some(cuts)
}

/// Functions in expressions.
pub fn infer_function(walk: &mut TypeInferrer, of: &AgentSpeakLiteral) -> Result<TyId, OmissionReason> {
    match (of.functor.as_str(), of.args.as_slice()) {
        ("math.abs", [_]) | ("math.min" | "math.max", [_, _]) => {
            let number = walk.types.number(false);
            of.args.iter().try_for_each(|a| same(walk, a, number))?;
            Ok(number)
        }
        ("math.min" | "math.max", [list]) => {
            let number = walk.types.number(false);
            list_of(walk, list, number)?;
            Ok(number)
        }
        ("math.pi" | "math.e", []) => Ok(walk.types.number(true)),
        ("math.random", args) if args.len() < 2 => {
            let number = walk.types.number(false);
            of.args.iter().try_for_each(|a| same(walk, a, number))?;
            Ok(walk.types.number(true))
        }
        (name, [arg]) if real_function(name).is_some_and(|f| f != RealFunction::Power) => {
            let number = walk.types.number(false);
            let f = real_function(name);
            if f.is_some_and(RealFunction::is_of_list) {
                list_of(walk, arg, number)?;
            } else {
                same(walk, arg, number)?;
            }
            Ok(match f {
                Some(RealFunction::Sum) => number,
                f => walk.types.number(!f.is_some_and(RealFunction::is_whole)),
            })
        }
        (".length" | "math.length", [list]) => {
            walk.term(list)?;
            Ok(walk.types.number(false))
        }
        (".count", [formula]) => {
            walk.formula(formula)?;
            Ok(walk.types.number(false))
        }
        (name, _) => Err(format!("hrdsl has no function like `{name}`")),
    }
}

/// The function of numbers that one of Jason's is.
pub fn real_function(name: &str) -> Option<RealFunction> {
    let name = name.strip_prefix("math.")?;
    let name = if name == "average" { "mean" } else { name };
    RealFunction::ALL.into_iter().find(|f| f.name() == name)
}

fn list_of(walk: &mut TypeInferrer, list: &AgentSpeakTerm, element: TyId) -> Result<(), OmissionReason> {
    let expected = walk.types.add(AgentSpeakType::List(element));
    same(walk, list, expected)
}

fn same(walk: &mut TypeInferrer, of: &AgentSpeakTerm, expected: TyId) -> Result<(), OmissionReason> {
    let id = walk.term(of)?;
    walk.types.demand(id, expected)
}

fn in_list(
    walk: &mut TypeInferrer,
    element: &AgentSpeakTerm,
    list: &AgentSpeakTerm,
) -> Result<(), OmissionReason> {
    let of = walk.term(element)?;
    let expected = walk.types.add(AgentSpeakType::List(of));
    same(walk, list, expected)
}

fn lists(walk: &mut TypeInferrer, all: &[&AgentSpeakTerm]) -> Result<(), OmissionReason> {
    let of = walk.types.fresh();
    let expected = walk.types.add(AgentSpeakType::List(of));
    all.iter().try_for_each(|t| same(walk, t, expected))
}

/// What is printed has any type; atoms and structures are printed as text.
fn printed(walk: &mut TypeInferrer, of: &AgentSpeakTerm) -> Result<(), OmissionReason> {
    match &of.kind {
        TermKind::Literal(l) if !l.is_internal() => l.args.iter().try_for_each(|a| printed(walk, a)),
        TermKind::List { items, rest: None } => items.iter().try_for_each(|a| printed(walk, a)),
        _ => walk.term(of).map(|_| ()),
    }
}

fn sent(walk: &mut TypeInferrer, message: &AgentSpeakMessage<'_>) -> Result<(), OmissionReason> {
    if let Some(to) = message.to {
        match atom(to) {
            Some(name) if !walk.types.is_agent(name) => return Err(format!("no agent is called `{name}`")),
            Some(_) if matches!(to.kind, TermKind::Text(_)) => {}
            _ => {
                let id = walk.term(to)?;
                let mut expected = walk.types.agent();
                if matches!(walk.types.get(id), AgentSpeakType::List(_)) {
                    expected = walk.types.add(AgentSpeakType::List(expected));
                }
                walk.types.demand(id, expected)?;
            }
        }
    }
    if let Some(items) = message.each() {
        return items.iter().try_for_each(|item| said(walk, message, item));
    }
    said(walk, message, message.content)
}

/// One literal of what is sent.
fn said(
    walk: &mut TypeInferrer,
    message: &AgentSpeakMessage<'_>,
    content: &AgentSpeakTerm,
) -> Result<(), OmissionReason> {
    let content =
        literal(content).map_err(|_| "what the message says is known only when it runs".to_owned())?;
    if performative(message.performative) == Some(true) {
        return walk.goal(content);
    }
    walk.belief(content)?;
    if let Some(time) = message.rest.get(1) {
        let number = walk.types.number(false);
        same(walk, time, number)?;
    }
    match message.rest.first() {
        Some(answer) => answered(walk, message.performative, content, answer),
        None => Ok(()),
    }
}

/// The answer is the literal, with values; or a list of such.
fn answered(
    walk: &mut TypeInferrer,
    performative: &str,
    content: &AgentSpeakLiteral,
    answer: &AgentSpeakTerm,
) -> Result<(), OmissionReason> {
    let places = walk.types.belief(&content.key());
    let one = if places.is_empty() {
        let names = [content.functor.clone()].into_iter().collect();
        walk.types.add(AgentSpeakType::Atoms { names, agent: false })
    } else {
        walk.types.add(AgentSpeakType::Struct(content.functor.clone(), places))
    };
    if performative == "askAll" {
        let expected = walk.types.add(AgentSpeakType::List(one));
        return same(walk, answer, expected);
    }
    match &answer.kind {
        TermKind::Literal(l) => {
            // Who answered is no part of the value.
            let plain = AgentSpeakLiteral { annotations: Vec::new(), ..l.clone() };
            same(walk, &AgentSpeakTerm { kind: TermKind::Literal(plain), span: answer.span }, one)
        }
        _ => same(walk, answer, one),
    }
}

fn waited(walk: &mut TypeInferrer, args: &[AgentSpeakTerm]) -> Result<(), OmissionReason> {
    let Some((what, rest)) = args.split_first() else { return Err("`.wait` has no argument".to_owned()) };
    for time in rest {
        let number = walk.types.number(false);
        same(walk, time, number)?;
    }
    match &what.kind {
        TermKind::Trigger(t) if t.kind == super::ast::AgentSpeakTriggerKind::Added => {
            walk.belief(literal(&t.of)?)
        }
        TermKind::Trigger(_) | TermKind::Text(_) => {
            Err("hrdsl cannot wait for this; it waits for a time, a belief or an event".to_owned())
        }
        TermKind::Literal(l) if !l.is_internal() => walk.belief(l),
        TermKind::Not(_) => walk.formula(what),
        TermKind::Binary { op, .. } if !op.is_arithmetic() => walk.formula(what),
        _ => {
            let number = walk.types.number(false);
            same(walk, what, number)
        }
    }
}
