//! Tests as text in the language, to be read, edited, committed and run again.

use std::fmt::Write as _;

use hrdsl_ir::{
    EventPattern, Nanos, Program, Type, Unit, Value,
    event::ArgPattern,
    test::{Test, TestStep},
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
    let _ = writeln!(out, "  method {}", test.provenance.method);
    for line in &test.provenance.because {
        let _ = writeln!(out, "  because {}", quoted(line));
    }
    for bin in &test.provenance.predicts {
        let _ = writeln!(out, "  predicts {}", quoted(bin));
    }
    for step in &test.steps {
        let _ = writeln!(out, "  {}", step_text(program, step));
    }
    out.push_str("}\n");
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

/// One step as it is written.
#[must_use]
pub fn step_text(program: &Program, step: &TestStep) -> String {
    match step {
        TestStep::Do { event, args, samples } => {
            let declared = program.event(*event);
            let args: Vec<String> =
                declared.params.iter().zip(args).map(|(p, v)| value_text(p.ty, *v)).collect();
            let mut text = call(&declared.name, &args);
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

fn call(name: &str, args: &[String]) -> String {
    if args.is_empty() { name.to_owned() } else { format!("{name}({})", args.join(", ")) }
}

fn pattern_text(program: &Program, pattern: &EventPattern) -> String {
    let declared = program.event(pattern.event);
    let arg = |(a, p): (&ArgPattern, &hrdsl_ir::Param)| match a {
        ArgPattern::Any => "_".to_owned(),
        ArgPattern::Is(v) => value_text(p.ty, *v),
    };
    let args: Vec<String> = pattern.args.iter().zip(&declared.params).map(arg).collect();
    call(&declared.name, &args)
}

fn value_text(ty: Type, value: Value) -> String {
    match (ty, value) {
        (Type::Float(unit), Value::Float(x)) if unit != Unit::None => format!("{x:?} {}", unit.symbol()),
        (Type::Float(_), Value::Float(x)) => format!("{x:?}"),
        (Type::Float(_) | Type::Bool | Type::Int { .. }, value) => value.to_string(),
    }
}

fn time_text(time: Nanos) -> String {
    format!("{} s", decimal::seconds(time))
}
