//! Tests as text in the language, to be read, edited, committed and run again.

use std::fmt::Write as _;

use hrdsl_ir::{
    EventPattern, Nanos, Program, Type, Unit, Value,
    event::ArgPattern,
    test::{Test, TestScript, TestStep},
};
use hrdsl_trace::decimal;

/// A file of tests.
#[must_use]
pub fn write(program: &Program, tests: &[Test]) -> String {
    let mut out = format!("// Tests of the scenario `{}`.\n", program.name);
    for test in tests {
        out.push('\n');
        write_test(&mut out, program, test);
    }
    out
}

fn write_test(out: &mut String, program: &Program, test: &Test) {
    let prefix = format!("{}.", program.name);
    let name = test.name.strip_prefix(&prefix).unwrap_or(&test.name);
    let _ = writeln!(out, "test {name} {{");
    let _ = writeln!(out, "  seed {}", test.seed);
    let _ = writeln!(out, "  method {}", test.provenance.method.word());
    for line in &test.provenance.because {
        let _ = writeln!(out, "  because {}", quoted(line));
    }
    for bin in &test.provenance.predicts {
        let _ = writeln!(out, "  predicts {}", quoted(bin.as_str()));
    }
    for script in &test.scripts {
        let name = script.actor.map(|actor| &program.actor(actor).name);
        if let Some(name) = name {
            let _ = writeln!(out, "  {name} {{");
        }
        let indent = if name.is_some() { "    " } else { "  " };
        for step in &script.steps {
            let _ = writeln!(out, "{indent}{}", step_text(program, step));
        }
        if name.is_some() {
            out.push_str("  }\n");
        }
    }
    out.push_str("}\n");
}

/// All steps of a test, each after the name of its actor where actors have scripts of their own: `person: ask_leg`.
#[must_use]
pub fn step_lines(program: &Program, test: &Test) -> Vec<String> {
    let of = |script: &TestScript| {
        let whose = script.actor.map_or_else(String::new, |actor| format!("{}: ", program.actor(actor).name));
        let lines = script.steps.iter().map(|step| format!("{whose}{}", step_text(program, step)));
        lines.collect::<Vec<_>>()
    };
    test.scripts.iter().flat_map(of).collect()
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

/// One step as it is written.
pub(crate) fn step_text(program: &Program, step: &TestStep) -> String {
    match step {
        TestStep::Do { event, args, samples, meanwhile } => {
            let declared = program.event(*event);
            let args = declared.params.iter().zip(args).map(|(p, v)| (p.name.as_str(), value_text(p.ty, *v)));
            let mut text = if *meanwhile { "meanwhile ".to_owned() } else { String::new() };
            text.push_str(&call(&declared.name, args));
            let names = declared.stimulus.iter().flat_map(|s| &s.samples);
            let with: Vec<String> =
                names.zip(samples).map(|(s, v)| format!("{} = {}", s.name, value_text(s.ty, *v))).collect();
            if !with.is_empty() {
                let _ = write!(text, " with {}", with.join(", "));
            }
            text
        }
        TestStep::Await { events, within } => {
            let events: Vec<String> = events.iter().map(|e| pattern_text(program, e)).collect();
            format!("await {} within {}", events.join(" | "), time_text(*within))
        }
        TestStep::Wait { time } => format!("wait {}", time_text(*time)),
    }
}

fn call<'p>(name: &str, args: impl Iterator<Item = (&'p str, String)>) -> String {
    let parts: Vec<ArgumentLeaf> = args.map(|(name, text)| ArgumentLeaf { path: path(name), text }).collect();
    if parts.is_empty() { name.to_owned() } else { format!("{name}({})", grouped(&parts, 0).join(", ")) }
}

/// An argument that is a number, a bool or a symbol: by itself, or a part of a record or an array.
struct ArgumentLeaf<'p> {
    path: Vec<&'p str>,
    text: String,
}

/// The names from the argument down to the part: `path[0].x` is `path`, `0`, `x`.
fn path(name: &str) -> Vec<&str> {
    name.split(['.', '[']).map(|n| n.strip_suffix(']').unwrap_or(n)).collect()
}

/// The arguments as they were before records and arrays were taken apart: consecutive parts of one name, at this depth,
/// make one tuple.
fn grouped(parts: &[ArgumentLeaf], depth: usize) -> Vec<String> {
    let is_inner = |p: &ArgumentLeaf| p.path.len() > depth + 1;
    let groups = parts.chunk_by(|a, b| is_inner(a) && is_inner(b) && a.path.get(depth) == b.path.get(depth));
    let text = |group: &[ArgumentLeaf]| match group {
        [whole] if !is_inner(whole) => whole.text.clone(),
        inner => format!("({})", grouped(inner, depth + 1).join(", ")),
    };
    groups.map(text).collect()
}

fn pattern_text(program: &Program, pattern: &EventPattern) -> String {
    let declared = program.event(pattern.event);
    let text = |a: &ArgPattern, ty: Type| match a {
        ArgPattern::Any => "_".to_owned(),
        ArgPattern::Is(v) => value_text(ty, *v),
    };
    let args = pattern.args.iter().zip(&declared.params).map(|(a, p)| (p.name.as_str(), text(a, p.ty)));
    call(&declared.name, args)
}

fn value_text(ty: Type, value: Value) -> String {
    match (ty, value) {
        (Type::Float(unit), Value::Float(x)) if unit != Unit::None => format!("{x:?} {}", unit.symbol()),
        (Type::Float(_), Value::Float(x)) => format!("{x:?}"),
        (
            Type::Float(_) | Type::Bool | Type::Int { .. } | Type::Enum(_) | Type::Text | Type::List(_),
            value,
        ) => value.to_string(),
    }
}

pub(crate) fn time_text(time: Nanos) -> String {
    format!("{} s", decimal::seconds(time))
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{ActorId, Enumeration, Event, EventId, Parameter, Span, Symbol};

    use super::*;

    const METRE: Type = Type::Float(Unit::Metre);

    fn program(params: &[(&str, Type)]) -> Program {
        let param = |(name, ty): &(&str, Type)| Parameter { name: (*name).to_owned(), ty: *ty };
        let event = Event {
            name: "go".into(),
            params: params.iter().map(param).collect(),
            from: ActorId(0),
            to: Vec::new(),
            stimulus: None,
            origin: Span::default(),
        };
        Program { events: vec![event], ..Program::default() }
    }

    /// The call with the numbers 1, 2, 3… as arguments.
    fn written(names: &[&str]) -> String {
        let params: Vec<(&str, Type)> = names.iter().map(|n| (*n, METRE)).collect();
        let args = (1..=names.len()).map(|n| Value::Float(n as f64)).collect();
        let step = TestStep::Do { event: EventId(0), args, samples: Vec::new(), meanwhile: false };
        step_text(&program(&params), &step)
    }

    #[test]
    fn records_and_arrays_are_tuples() {
        assert_eq!(written(&[]), "go");
        assert_eq!(written(&["x", "y"]), "go(1.0 m, 2.0 m)");
        assert_eq!(written(&["to.x", "to.y"]), "go((1.0 m, 2.0 m))");
        assert_eq!(written(&["a[0]", "a[1]", "speed"]), "go((1.0 m, 2.0 m), 3.0 m)");
        assert_eq!(written(&["a[0][0]", "a[0][1]", "a[1][0]"]), "go(((1.0 m, 2.0 m), (3.0 m)))");
        let path = ["path[0].x", "path[0].y", "path[1].x", "path[1].y"];
        assert_eq!(written(&path), "go(((1.0 m, 2.0 m), (3.0 m, 4.0 m)))");
        assert_eq!(
            written(&["who", "from.at.x", "from.at.y", "from.up", "to.x"]),
            "go(1.0 m, ((2.0 m, 3.0 m), 4.0 m), (5.0 m))"
        );
        // Names that only begin alike are not one argument.
        assert_eq!(written(&["a.x", "ab.x", "a2"]), "go((1.0 m), (2.0 m), 3.0 m)");
    }

    #[test]
    fn names_that_no_record_has_do_no_harm() {
        for odd in
            [vec!["a", "a.x"], vec!["a.x", "a"], vec!["a", "a"], vec![".", "[", "]"], vec!["a..b", "a."]]
        {
            let text = written(&odd);
            assert_eq!(text.matches(" m").count(), odd.len(), "{text}");
        }
    }

    #[test]
    fn symbols_and_patterns_are_written_by_name() {
        let pace = Type::Enum(Enumeration::intern("Pace", &["slow", "fast"]));
        let push = Type::Float(Unit::MetrePerSecondSquared);
        let program = program(&[("how.pace", pace), ("how.push", push), ("on", Type::Bool)]);
        let fast = Value::Symbol(Symbol::intern("fast"));
        let args = vec![fast, Value::Float(-0.5), Value::Bool(true)];
        let step = TestStep::Do { event: EventId(0), args, samples: Vec::new(), meanwhile: true };
        assert_eq!(step_text(&program, &step), "meanwhile go((fast, -0.5 m/s^2), true)");
        let args = vec![ArgPattern::Is(fast), ArgPattern::Any, ArgPattern::Any];
        let step = TestStep::Await { events: vec![EventPattern { event: EventId(0), args }], within: 0 };
        assert_eq!(step_text(&program, &step), "await go((fast, _), _) within 0 s");
    }
}
