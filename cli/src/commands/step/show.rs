//! Where a walk is and what can happen there, for people.

use hrdsl_runtime::prove::{WalkOption, WalkSession};

use crate::edge_sources::EdgeSources;

/// The state of a walk and its options.
pub fn state(session: &WalkSession<'_>, sources: &EdgeSources<'_>) -> String {
    let (walk, state) = (&session.walk, session.state());
    let steps = session.steps();
    let after = match steps {
        0 => "at the start".to_owned(),
        1 => "after 1 transition".to_owned(),
        n => format!("after {n} transitions"),
    };
    let mut out = format!("{after}, {}\n", walk.time(state).during());
    let places = walk.automata().into_iter().zip(walk.locations(state));
    let places: Vec<String> = places.map(|(automaton, place)| format!("{automaton}.{place}")).collect();
    out += &format!("  in      {}\n", places.join("  "));
    let variables = walk.variables(state);
    if !variables.is_empty() {
        let all: Vec<String> = variables.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        out += &format!("  vars    {}\n", all.join(", "));
    }
    let clocks = walk.clocks(state);
    if !clocks.is_empty() {
        let all: Vec<String> = clocks.iter().map(|c| format!("{}: {}", c.name, c.range)).collect();
        out += &format!("  clocks  {}\n", all.join("; "));
    }
    let options = session.options();
    let number = options.len().to_string().len();
    let when = options.iter().map(|o| o.time.to_string().chars().count()).max().unwrap_or(0);
    for (n, option) in (1..).zip(&options) {
        out += &format!("  {n:>number$}  {:when$}  {}\n", option.time.to_string(), what(option));
        let mut told = option.told.clone();
        told.locate(&|origin| sources.at(origin));
        for line in told.edges() {
            out += &format!("  {:number$}  {:when$}    {line}\n", "", "");
        }
        if option.delay != option.time {
            out += &format!("  {:number$}  {:when$}    {} after the last\n", "", "", option.delay);
        }
    }
    if options.is_empty() {
        let end = if state.for_ever { "time can pass for ever" } else { "and time cannot pass for ever" };
        out += &format!("  nothing can happen, {end}\n");
    }
    out
}

/// What an option is.
pub fn what(option: &WalkOption) -> String {
    match &option.fault {
        Some(fault) => format!("fault of the model: {fault}"),
        None => option.told.summary(),
    }
}
