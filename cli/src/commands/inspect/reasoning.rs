//! How the agents of a model run reasoned, for a terminal or a file: by instants, rounds and agents, then how it ended.

use std::fmt::Write as _;

use hrdsl_ir::{Nanos, Span};
use serde::Serialize;

use hrdsl_runtime::{
    harness::{HarnessError, RunTermination},
    report::text,
    testgen::model_run::{IntentionSummary, LogLine, ModelInspection, RunStatus, show},
};

/// Of more cycles of an agent in a round than this only the first and last are shown.
const MANY: usize = 60;
const FIRST: usize = 40;
const LAST: usize = 10;

/// What of a run is shown.
#[derive(Clone, Copy, Debug)]
pub struct ReasoningFilter<'a> {
    /// Only this agent.
    pub agent: Option<&'a str>,
    /// What happens before is left out.
    pub from: Nanos,
    /// What happens later is left out.
    pub until: Nanos,
    /// Of an agent that goes on and on at one instant, all cycles.
    pub all: bool,
}

impl Default for ReasoningFilter<'_> {
    fn default() -> Self {
        Self { agent: None, from: 0, until: Nanos::MAX, all: false }
    }
}

impl ReasoningFilter<'_> {
    fn has_agent(&self, name: &str) -> bool {
        self.agent.is_none_or(|a| a == name)
    }

    /// Whether a line is of what is shown.
    #[must_use]
    pub fn has(&self, line: &LogLine) -> bool {
        (self.from..=self.until).contains(&line.time) && self.has_agent(&line.agent)
    }
}

/// How a model run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ModelRunEnd {
    /// In nanoseconds.
    pub time: Nanos,
    /// `quiescent`, `horizon`, `livelock`, `cycle bound`, `holding bound` or `fault`; `under way` if it was looked at before its end.
    pub how: &'static str,
    /// What that means; of a fault, which.
    pub why: String,
    pub agents: Vec<AgentEnd>,
    /// Entries of the log that are left out.
    pub left_out: u64,
}

/// How an agent stands at the end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AgentEnd {
    pub agent: String,
    pub intentions: Vec<LocatedIntention>,
    pub beliefs: Vec<String>,
}

/// An intention, with the place of its step as people count.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LocatedIntention {
    #[serde(flatten)]
    pub summary: IntentionSummary,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
}

impl ModelRunEnd {
    /// How a run ended for the agents that are shown. `place` says where a span is, as people count.
    #[must_use]
    pub fn of(
        inspection: &ModelInspection,
        picked: &ReasoningFilter<'_>,
        place: &dyn Fn(Span) -> String,
    ) -> Self {
        let (how, why) = match (&inspection.run.ended, inspection.status) {
            (RunTermination::Quiescent, _) => {
                ("quiescent", "nobody waits for anything that can still come".to_owned())
            }
            (RunTermination::Limit, _) => {
                ("horizon", "the time of the suite's model runs is over".to_owned())
            }
            (RunTermination::Fault(fault), RunStatus::Livelock) => ("livelock", reason(fault)),
            (RunTermination::Fault(fault), RunStatus::Endless) => ("cycle bound", reason(fault)),
            (RunTermination::Fault(fault), RunStatus::Overfull(_)) => ("holding bound", reason(fault)),
            (
                RunTermination::Fault(fault),
                RunStatus::Ready | RunStatus::Waiting | RunStatus::Idle | RunStatus::Malformed,
            ) => ("fault", fault.to_string()),
        };
        let last = inspection.snapshots.last();
        let located = |summary: &IntentionSummary| LocatedIntention {
            summary: summary.clone(),
            place: summary.origin.map(place),
        };
        let agent = |(at, name): (usize, &String)| AgentEnd {
            agent: name.clone(),
            intentions: last.and_then(|s| s.agents.get(at)).into_iter().flatten().map(located).collect(),
            beliefs: inspection.beliefs.get(at).cloned().unwrap_or_default(),
        };
        let agents = inspection.agents.iter().enumerate().filter(|(_, name)| picked.has_agent(name));
        Self {
            time: inspection.run.trace.end,
            how,
            why,
            agents: agents.map(agent).collect(),
            left_out: inspection.left_out,
        }
    }

    /// The same where the time at which the run was stopped is not its end.
    #[must_use]
    pub fn under_way(self) -> Self {
        if self.how != "horizon" {
            return self;
        }
        Self { how: "under way", why: "the run goes on".to_owned(), ..self }
    }

    /// Whether it came to its end without a fault of the model.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        matches!(self.how, "quiescent" | "horizon" | "under way")
    }
}

/// The fault, without the word that says how the run ended.
fn reason(fault: &HarnessError) -> String {
    fault.to_string().replacen("livelock: ", "", 1).replacen("cycle bound: ", "", 1)
}

#[derive(Clone, Copy)]
enum ReasoningStyle {
    Plain,
    Bold,
    Dim,
    Event,
    Chosen,
    Bad,
}

struct ReasoningPage<'a> {
    out: String,
    color: bool,
    place: &'a dyn Fn(Span) -> String,
}

impl ReasoningPage<'_> {
    /// `start` is blank, or a number.
    fn line(&mut self, start: &str, pieces: &[(ReasoningStyle, &str)]) {
        self.out.push_str(start);
        for (style, piece) in pieces.iter().filter(|(_, piece)| !piece.is_empty()) {
            let sgr = match style {
                ReasoningStyle::Plain => "",
                ReasoningStyle::Bold => "1",
                ReasoningStyle::Dim => "2",
                ReasoningStyle::Event => "36",
                ReasoningStyle::Chosen => "32",
                ReasoningStyle::Bad => "1;31",
            };
            let piece = text::line(piece);
            if self.color && !sgr.is_empty() {
                let _ = write!(self.out, "\u{1b}[{sgr}m{piece}\u{1b}[0m");
            } else {
                self.out.push_str(&piece);
            }
            self.out.push(' ');
        }
        self.out.truncate(self.out.trim_end_matches(' ').len());
        self.out.push('\n');
    }

    fn standing(&mut self, start: &str, who: &str, standing: &IntentionSummary, place: Option<&str>) {
        let number = format!("#{}", standing.intention);
        let plans = standing.plans.join(" > ");
        let held = if standing.suspended { ", suspended" } else { "" };
        let rest = format!("{plans}: {}{held}", standing.waits);
        let who = if who.is_empty() { vec![] } else { vec![(ReasoningStyle::Dim, who)] };
        let place = place.map_or_else(String::new, |place| format!("({place})"));
        let pieces = [
            (ReasoningStyle::Dim, number.as_str()),
            (ReasoningStyle::Dim, rest.trim_start_matches(": ")),
            (ReasoningStyle::Dim, place.as_str()),
        ];
        self.line(start, &[&who[..], &pieces].concat());
    }
}

/// The log of a run, with what the agents intend at the end of each instant; with ANSI colours if `color`. `place` says
/// where a span is, as people count.
#[must_use]
pub fn reasoning(
    inspection: &ModelInspection,
    picked: &ReasoningFilter<'_>,
    color: bool,
    place: &dyn Fn(Span) -> String,
) -> String {
    let mut page = ReasoningPage { out: String::new(), color, place };
    let lines: Vec<&LogLine> = inspection.run.log.iter().filter(|l| picked.has(l)).collect();
    for instant in lines.chunk_by(|a, b| a.time == b.time) {
        let time = instant[0].time;
        page.line("", &[(ReasoningStyle::Bold, &show::time(time))]);
        for agent in instant.chunk_by(|a, b| (a.round, &a.agent) == (b.round, &b.agent)) {
            let round = format!("round {}", agent[0].round);
            page.line("  ", &[(ReasoningStyle::Bold, &agent[0].agent), (ReasoningStyle::Dim, &round)]);
            let cycles: Vec<&[&LogLine]> = agent.chunk_by(|a, b| a.cycle == b.cycle).collect();
            if picked.all || cycles.len() <= MANY {
                turn(&mut page, agent);
                continue;
            }
            let (first, rest) = cycles.split_at(FIRST);
            let (middle, last) = rest.split_at(rest.len() - LAST);
            turn(&mut page, &first.concat());
            let left_out = format!("… {} cycles (--all shows them)", middle.len());
            page.line("       ", &[(ReasoningStyle::Dim, &left_out)]);
            turn(&mut page, &last.concat());
        }
        still_to_do(&mut page, inspection, picked, time);
        page.out.push('\n');
    }
    page.out
}

/// What an agent did in a round, cycle by cycle.
fn turn(page: &mut ReasoningPage<'_>, lines: &[&LogLine]) {
    let mut under: Option<(u64, u32, &str)> = None;
    let mut cycle = None;
    for (at, line) in lines.iter().enumerate() {
        let gutter = if cycle == Some(line.cycle) { String::new() } else { line.cycle.to_string() };
        cycle = Some(line.cycle);
        let gutter = format!("{gutter:>5}  ");
        let Some(event) = line.event.as_deref() else {
            plain(page, &gutter, line);
            continue;
        };
        let number = if has_number(line) { line.intention } else { 0 };
        let here = (line.cycle, number, event);
        if under != Some(here) {
            let number = if number == 0 { String::new() } else { format!("#{number} ") };
            page.line(&gutter, &[(ReasoningStyle::Event, &format!("{number}{event}"))]);
            under = Some(here);
        }
        // That a plan is applicable is plain if it is chosen then.
        let chosen = lines.get(at + 1).is_some_and(|l| l.kind == "selected" && l.cycle == line.cycle);
        if line.kind == "tried" && line.text.ends_with(" is applicable") && chosen {
            continue;
        }
        considered(page, line, event);
    }
}

/// A plan of an event, or that there is none.
fn considered(page: &mut ReasoningPage<'_>, line: &LogLine, event: &str) {
    let said = line.text.find(event).map_or(line.text.as_str(), |at| &line.text[at + event.len()..]);
    let said = said.trim_start_matches([':', ' ']);
    let style = match line.kind {
        "selected" => ReasoningStyle::Chosen,
        "unhandled" => ReasoningStyle::Bad,
        _ => ReasoningStyle::Dim,
    };
    let is_placed = matches!(line.kind, "unhandled" | "selected");
    let place = line.origin.filter(|_| is_placed).map(|o| (page.place)(o));
    let at = place.map_or_else(String::new, |p| format!("({p})"));
    page.line("         ", &[(style, said), (ReasoningStyle::Dim, &at)]);
}

/// Whether the text begins with the intention's number: the entry is not about a new one.
fn has_number(line: &LogLine) -> bool {
    line.text.starts_with('#')
}

fn plain(page: &mut ReasoningPage<'_>, gutter: &str, line: &LogLine) {
    let style = match line.kind {
        "failed" | "fault" | "warning" | "livelock" | "cycle_bound" => ReasoningStyle::Bad,
        "finished" | "dropped" => ReasoningStyle::Dim,
        "perceived" | "heard" => ReasoningStyle::Event,
        _ => ReasoningStyle::Plain,
    };
    // What is done is found by its plan.
    let origin = line.origin.filter(|_| line.kind != "step");
    let place = origin.map_or_else(String::new, |o| format!("({})", (page.place)(o)));
    page.line(gutter, &[(style, &line.text), (ReasoningStyle::Dim, &place)]);
}

fn still_to_do(
    page: &mut ReasoningPage<'_>,
    inspection: &ModelInspection,
    picked: &ReasoningFilter<'_>,
    time: Nanos,
) {
    let Ok(at) = inspection.snapshots.binary_search_by_key(&time, |s| s.time) else { return };
    let each = inspection.agents.iter().zip(&inspection.snapshots[at].agents);
    let mut each = each.filter(|(name, all)| picked.has_agent(name) && !all.is_empty()).peekable();
    if each.peek().is_some() {
        page.line("  ", &[(ReasoningStyle::Dim, "still to do")]);
    }
    for (name, all) in each {
        for standing in all {
            let place = standing.origin.map(|origin| (page.place)(origin));
            page.standing("       ", name, standing, place.as_deref());
        }
    }
}

/// How a run ended: why, what is still waited for, and what is believed.
#[must_use]
pub fn ending(end: &ModelRunEnd, color: bool) -> String {
    let mut page = ReasoningPage { out: String::new(), color, place: &|_| String::new() };
    let style = if end.is_regular() { ReasoningStyle::Chosen } else { ReasoningStyle::Bad };
    let when = if end.how == "under way" { "at" } else { "the end, at" };
    let time = format!("{when} {}:", show::time(end.time));
    page.line(
        "",
        &[(ReasoningStyle::Bold, &time), (style, end.how), (ReasoningStyle::Dim, &format!("({})", end.why))],
    );
    if end.left_out > 0 {
        let left_out = format!("{} entries of the log are left out, the last ones", end.left_out);
        page.line("  ", &[(ReasoningStyle::Bad, &left_out)]);
    }
    for agent in &end.agents {
        page.line("  ", &[(ReasoningStyle::Bold, &agent.agent)]);
        if agent.intentions.is_empty() {
            page.line("    ", &[(ReasoningStyle::Dim, "intends nothing")]);
        }
        for LocatedIntention { summary, place } in &agent.intentions {
            page.standing("    ", "", summary, place.as_deref());
        }
        let what = if agent.beliefs.is_empty() { "believes nothing" } else { "believes" };
        page.line("    ", &[(ReasoningStyle::Dim, what)]);
        agent.beliefs.iter().for_each(|belief| page.line("      ", &[(ReasoningStyle::Plain, belief)]));
    }
    page.out
}
