//! `hrdsl inspect`: how the agents of a suite reason, cycle by cycle.

mod beliefs;
pub mod reasoning;

use std::path::PathBuf;

use hrdsl_compiler::CompilationResult;
use hrdsl_ir::{
    Nanos, Program, Span,
    abstract_test::TestOrigin,
    bdi::{AgentId, InitialFact},
    suite::{PlayerRef, Suite, SuiteMethod},
    value::nanos,
};
use hrdsl_runtime::testgen::{
    self, GenerateOptions, generate_with, how_many_sets,
    model_run::{LogDetail, LogLine, ModelInspection, ModelRunOptions, inspect},
    seed_of,
};
use hrdsl_source::printable_line;
use serde::Serialize;

use self::reasoning::{ModelRunEnd, ReasoningFilter, ending, reasoning};
use crate::{color, exit::CommandExit, fault::CommandFault, input, terminal};

/// Show how the agents of a suite reason: what they take up, which plans they try and why, what they do.
///
/// The agents are run in virtual time with one set of beliefs, as `hrdsl gen` runs them. `hrdsl run` prints only what they
/// print and do.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl inspect scenario.hri
  hrdsl inspect scenario.hri bdi_tests --set 3
  hrdsl inspect scenario.hri bdi_tests.t017 --agent Human --until '20 s'
  hrdsl inspect scenario.hri --beliefs 'wants(2), shows(1, true, false, true)' --end
  hrdsl inspect scenario.hri bdi_tests.t017 --at '42.5 s'
  hrdsl inspect scenario.hri bdi_tests --json | jq -r 'select(.kind == \"failed\") | .text'")]
pub struct InspectArgs {
    /// The scenario.
    file: PathBuf,
    /// A suite by agents (`bdi_tests`), or a test that was generated from it (`bdi_tests.t017`).
    #[arg(value_name = "TEST|SUITE")]
    what: Option<String>,
    /// The beliefs of this generated test.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["what", "set", "beliefs"])]
    test: Option<String>,
    /// The suite's belief set of this number [default: 1].
    #[arg(long, value_name = "N", conflicts_with = "beliefs", value_parser = clap::value_parser!(u64).range(1..))]
    set: Option<u64>,
    /// These beliefs instead of a set, as the language writes them; `Agent.belief(…)` if several agents have it.
    #[arg(long, value_name = "LIST")]
    beliefs: Option<String>,
    /// Only this agent.
    #[arg(long, value_name = "NAME")]
    agent: Option<String>,
    /// Only from this time on, like `10 s` or `500 ms`.
    #[arg(long, value_name = "T", value_parser = time)]
    from: Option<Nanos>,
    /// Only up to this time.
    #[arg(long, value_name = "T", value_parser = time)]
    until: Option<Nanos>,
    /// What is done and believed, without the plans that were tried.
    #[arg(long, conflicts_with = "reasons")]
    steps: bool,
    /// Also each plan that was tried, and why it was not chosen: the default.
    #[arg(long)]
    reasons: bool,
    /// Of an agent that goes on and on at one instant, show all its cycles.
    #[arg(long)]
    all: bool,
    /// Only how the run ended: what is waited for, and what is believed.
    #[arg(long)]
    end: bool,
    /// Only how things stand at this time, after all that happens at it: what is waited for, and what is believed.
    #[arg(long, value_name = "T", value_parser = time, conflicts_with_all = ["end", "steps", "reasons", "all", "from", "until"])]
    at: Option<Nanos>,
    /// As with `hrdsl gen`: everything random comes from this.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// As with `hrdsl gen`: how many tests the suite has.
    #[arg(short = 'n', long, value_name = "N")]
    count: Option<u32>,
    /// As with `hrdsl gen`: of the tests only those that are needed.
    #[arg(long)]
    minimise: bool,
    /// Print the log as lines of JSON; with --end and --at, how things stand as JSON.
    #[arg(long)]
    json: bool,
}

/// A time: a number with `ms`, `s` or `min`; without, in seconds.
///
/// # Errors
/// What is no time, and how one is written.
pub fn time(text: &str) -> Result<Nanos, String> {
    let text = text.trim();
    let at = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let scale = match &text[at..] {
        "" | "s" => 1.0,
        "ms" => 0.001,
        "min" => 60.0,
        unit => return Err(format!("no unit `{unit}`: write it like `10 s`, `500 ms` or `2 min`")),
    };
    let number: f64 = text[..at].trim().parse().map_err(|_| "write it like `10 s`".to_owned())?;
    if !number.is_finite() || number < 0.0 {
        return Err("a time is 0 s or later".to_owned());
    }
    Ok(nanos(number * scale))
}

/// # Errors
/// A file, a suite, test, agent or belief that does not exist.
pub fn run(args: &InspectArgs) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let chosen = choose(args, &compilation, program)?;
    let picked = ReasoningFilter {
        agent: args.agent.as_deref(),
        from: args.from.unwrap_or(0),
        until: args.until.unwrap_or(Nanos::MAX),
        all: args.all,
    };
    if let Some(agent) = &args.agent {
        let names: Vec<&str> = chosen.agents(program).map(|(_, name)| name).collect();
        if !names.contains(&agent.as_str()) {
            return Err(format!("no agent `{agent}` in the suite; it has: {}", names.join(", ")));
        }
    }
    let only_standing = args.end || args.at.is_some();
    let detail = match (only_standing, args.steps) {
        (true, _) => LogDetail::Failures,
        (false, true) => LogDetail::Steps,
        (false, false) => LogDetail::Reasons,
    };
    let horizon = chosen.suite.settings.horizon;
    let stop = args.at.map_or(horizon, |at| at.min(horizon));
    let inspection = chosen.inspect_until(program, detail, stop);
    let place = |span: Span| compilation.files.place(span);
    let end = ModelRunEnd::of(&inspection, &picked, &place);
    let end = if stop < horizon { end.under_way() } else { end };
    match (args.json, only_standing) {
        (true, true) => terminal::print_data(&(json(&end)? + "\n"))?,
        (true, false) => terminal::print_data(&json_lines(&inspection, &picked, &place)?)?,
        (false, only_end) => {
            let color = color::stdout_has();
            let log = if only_end { String::new() } else { reasoning(&inspection, &picked, color, &place) };
            let text = format!("{}\n{log}{}", chosen.heading(program, color), ending(&end, color));
            terminal::print(&text)?;
        }
    }
    Ok(if end.is_regular() { CommandExit::Ok } else { CommandExit::Errors })
}

/// A run of a suite's agents.
pub struct InspectedRun<'p> {
    suite: &'p Suite,
    players: &'p [PlayerRef],
    /// `belief set 3`, `test bdi_tests.t017, belief set 3`
    which: String,
    facts: Vec<(AgentId, InitialFact)>,
    /// The facts, as they are written.
    text: Vec<String>,
    seed: u64,
}

impl<'p> InspectedRun<'p> {
    /// The run that a generated test came from; `None` if the suite is not by agents.
    #[must_use]
    pub fn of_test(suite: &'p Suite, test: &str, origin: &TestOrigin, seed: u64) -> Option<Self> {
        let SuiteMethod::Agents { players, .. } = &suite.method else { return None };
        Some(Self {
            suite,
            players,
            which: format!("test {test}, belief set {}", origin.number),
            facts: origin.beliefs.facts.clone(),
            text: origin.beliefs.text.clone(),
            seed: seed_of(seed, origin.number),
        })
    }

    #[must_use]
    pub fn inspect(&self, program: &Program, detail: LogDetail) -> ModelInspection {
        self.inspect_until(program, detail, self.suite.settings.horizon)
    }

    /// The run up to this time, with all that happens at it.
    fn inspect_until(&self, program: &Program, detail: LogDetail, until: Nanos) -> ModelInspection {
        inspect(program, self.players, &self.facts, &ModelRunOptions::new(self.seed, until, detail))
    }

    /// What is shown, in a few lines.
    #[must_use]
    pub fn heading(&self, program: &Program, color: bool) -> String {
        let name = |player: &PlayerRef| match player {
            PlayerRef::Agent(id) => program.agents[usize::from(id.0)].name.clone(),
            PlayerRef::Automaton(id) => program.automata[usize::from(id.0)].name.clone(),
        };
        let players: Vec<String> = self.players.iter().map(name).collect();
        let what = format!("{}, suite {}, {}", program.name, self.suite.name, self.which);
        let beliefs = if self.text.is_empty() { "nothing chosen".to_owned() } else { self.text.join(", ") };
        let bold = color::paint(color, color::TextStyle::Bold, &what);
        format!("{bold}\n  beliefs: {}\n  players: {}\n", printable_line(&beliefs), players.join(", "))
    }

    fn agents(&self, program: &'p Program) -> impl Iterator<Item = (AgentId, &'p str)> {
        self.players.iter().filter_map(|p| match p {
            PlayerRef::Agent(id) => Some((*id, program.agents[usize::from(id.0)].name.as_str())),
            PlayerRef::Automaton(_) => None,
        })
    }
}

fn choose<'p>(
    args: &InspectArgs,
    compilation: &CompilationResult,
    program: &'p Program,
) -> Result<InspectedRun<'p>, CommandFault> {
    let what = args.test.as_deref().or(args.what.as_deref());
    if let Some(test) = what.and_then(|name| test_of(program, name)) {
        if args.set.is_some() || args.beliefs.is_some() {
            return Err("a test has its beliefs: name its suite to choose others".to_owned());
        }
        return of_test(args, program, test);
    }
    if let Some(test) = &args.test {
        return Err(format!("no test `{test}`: write it like `SUITE.t001`; {}", listed(args, program)));
    }
    let suite = the_suite(args, program, what)?;
    let SuiteMethod::Agents { players, .. } = &suite.method else {
        return Err(format!("suite `{}` is not by agents; {}", suite.name, listed(args, program)));
    };
    if let Some(text) = &args.beliefs {
        let agents: Vec<AgentId> = players
            .iter()
            .filter_map(|p| match p {
                PlayerRef::Agent(id) => Some(*id),
                PlayerRef::Automaton(_) => None,
            })
            .collect();
        let facts = beliefs::facts(&args.file, compilation, program, &agents, text)?;
        let (which, text) = ("beliefs by hand".to_owned(), vec![text.trim().to_owned()]);
        return Ok(InspectedRun { suite, players, which, facts, text, seed: seed_of(args.seed, 1) });
    }
    let number = args.set.unwrap_or(1);
    let set = testgen::belief_set(program, suite, args.count, args.seed, number)?;
    let (which, seed) = (format!("belief set {number}"), seed_of(args.seed, number));
    Ok(InspectedRun { suite, players, which, facts: set.facts, text: set.text, seed })
}

/// The suite by agents of this name, or the only one.
fn the_suite<'p>(
    args: &InspectArgs,
    program: &'p Program,
    name: Option<&str>,
) -> Result<&'p Suite, CommandFault> {
    if let Some(name) = name {
        let found = program.suites.iter().find(|s| s.name == name);
        return found.ok_or_else(|| format!("no suite or test `{name}`; {}", listed(args, program)));
    }
    match by_agents(program).as_slice() {
        [one] => Ok(one),
        [] | [_, ..] => Err(listed(args, program)),
    }
}

fn by_agents(program: &Program) -> Vec<&Suite> {
    program.suites.iter().filter(|s| matches!(s.method, SuiteMethod::Agents { .. })).collect()
}

/// The suites by agents with their sets, and what to type.
fn listed(args: &InspectArgs, program: &Program) -> String {
    let suites = by_agents(program);
    let Some(first) = suites.first() else { return "the scenario has no suite by agents".to_owned() };
    let mut out = "the suites by agents are:\n".to_owned();
    for suite in &suites {
        let sets = match how_many_sets(program, suite, args.count, args.seed) {
            Ok((sets, space)) => format!("{sets} of {space} belief sets"),
            Err(fault) => fault,
        };
        out += &format!("  {}: {sets}\n", suite.name);
    }
    out + &format!("help: hrdsl inspect {} {} --set 1", terminal::shown(&args.file), first.name)
}

/// A suite by agents and the number of a test: `bdi_tests.t017`, with or without the scenario's name before it.
fn test_of<'p>(program: &'p Program, name: &str) -> Option<(&'p Suite, usize)> {
    let name = name.strip_prefix(&format!("{}.", program.name)).unwrap_or(name);
    let (suite, number) = name.split_once(".t")?;
    let suite = by_agents(program).into_iter().find(|s| s.name == suite)?;
    Some((suite, number.parse().ok().filter(|n| *n > 0)?))
}

fn of_test<'p>(
    args: &InspectArgs,
    program: &Program,
    (suite, number): (&'p Suite, usize),
) -> Result<InspectedRun<'p>, CommandFault> {
    let minimise = args.minimise.then_some(true);
    let generated = generate_with(
        program,
        suite,
        GenerateOptions { count: args.count, seed: args.seed, minimise, ..GenerateOptions::default() },
    )?;
    let name = format!("{}.t{number:03}", suite.name);
    let origin = generated.origins.get(number - 1);
    let chosen = origin.and_then(|origin| InspectedRun::of_test(suite, &name, origin, args.seed));
    chosen.ok_or_else(|| format!("no test `{name}`: the suite has {}", generated.tests.len()))
}

/// A line of the log, with its place as people count.
#[derive(Serialize)]
struct LocatedLogLine<'a> {
    #[serde(flatten)]
    line: &'a LogLine,
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<String>,
}

/// The log as lines of JSON.
///
/// # Errors
/// What cannot be written as JSON.
pub fn json_lines(
    inspection: &ModelInspection,
    picked: &ReasoningFilter<'_>,
    place: &dyn Fn(Span) -> String,
) -> Result<String, CommandFault> {
    let mut out = String::new();
    for line in inspection.run.log.iter().filter(|l| picked.has(l)) {
        out += &json(&LocatedLogLine { line, place: line.origin.map(place) })?;
        out.push('\n');
    }
    Ok(out)
}

fn json(value: &impl Serialize) -> Result<String, CommandFault> {
    serde_json::to_string(value).map_err(|e| format!("cannot print: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        let read = |text| time(text).unwrap();
        assert_eq!(
            [read("10 s"), read("10"), read("1.5s"), read("500 ms"), read("2min")],
            [10_000_000_000, 10_000_000_000, 1_500_000_000, 500_000_000, 120_000_000_000]
        );
        for wrong in ["", "s", "-1 s", "1 h", "inf", "1 s s"] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }
}
