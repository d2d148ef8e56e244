//! What was decided, as rows of a table.

use std::time::Duration;

use hrdsl_ir::Program;
use hrdsl_runtime::prove::{
    ObservedRun, ProofStatus, QueryFinding, QueryResult, RangeResult, RangeVerdict, RequirementProof,
    SearchStatistics, WitnessTrace,
};
use serde::Serialize;

use crate::{edge_sources::EdgeSources, exit::CommandExit};

/// One requirement or query.
pub struct ProofRow {
    pub network: String,
    pub kind: PropertyKind,
    pub name: String,
    /// Its title, or else its text.
    pub title: String,
    pub text: String,
    pub verdict: PropertyVerdict,
    /// What else there is to say.
    pub remark: Option<String>,
    /// For a `sup` or `inf`: of each measure.
    pub bounds: Vec<String>,
    pub trace: Option<WitnessTrace>,
    /// Of its search, if that is known.
    pub statistics: Option<SearchStatistics>,
    /// That search was for several queries, and so was the time.
    pub joint: bool,
    pub time: Duration,
    /// The network, what it is, and its number: the order in which rows are shown.
    pub place: (usize, PropertyKind, usize),
    /// The slots of the variables whose ranges it is about.
    pub slots: Vec<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PropertyKind {
    Requirement,
    Query,
    /// That variables that no query reads stay in their ranges.
    Range,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PropertyVerdict {
    Holds,
    Violated,
    Satisfied,
    NotSatisfied,
    /// `sup` and `inf`.
    Answered,
    Inconclusive,
    NotOnTheModel,
    Fault,
}

impl PropertyVerdict {
    pub fn words(self) -> &'static str {
        match self {
            PropertyVerdict::Holds => "holds",
            PropertyVerdict::Violated => "violated",
            PropertyVerdict::Satisfied => "satisfied",
            PropertyVerdict::NotSatisfied => "not satisfied",
            PropertyVerdict::Answered => "answered",
            PropertyVerdict::Inconclusive => "inconclusive",
            PropertyVerdict::NotOnTheModel => "not on the model",
            PropertyVerdict::Fault => "fault of the model",
        }
    }

    /// `not_satisfied`
    pub fn key(self) -> String {
        self.words().replace(' ', "_")
    }
}

impl ProofRow {
    /// What the row alone makes the command end with.
    pub fn exit(&self) -> CommandExit {
        match self.verdict {
            PropertyVerdict::Holds
            | PropertyVerdict::Satisfied
            | PropertyVerdict::Answered
            | PropertyVerdict::NotOnTheModel => CommandExit::Ok,
            PropertyVerdict::Violated | PropertyVerdict::NotSatisfied => CommandExit::Findings,
            PropertyVerdict::Inconclusive => CommandExit::Inconclusive,
            PropertyVerdict::Fault => CommandExit::Errors,
        }
    }

    /// Says of the edges of its run how they are written.
    pub fn locate(&mut self, sources: &EdgeSources<'_>) {
        if let Some(trace) = &mut self.trace {
            trace.locate(&|origin| sources.at(origin));
        }
    }

    pub fn of_proof(program: &Program, proof: &RequirementProof) -> Self {
        let monitor = &program.monitors[proof.monitor];
        let (verdict, remark, run) = match &proof.status {
            ProofStatus::Violated(run) => (PropertyVerdict::Violated, None, Some(run.as_ref())),
            ProofStatus::Holds { triggered } => {
                (PropertyVerdict::Holds, untriggered(*triggered, proof.note.as_deref()), None)
            }
            ProofStatus::Inconclusive(why) => (PropertyVerdict::Inconclusive, Some(why.clone()), None),
            ProofStatus::NotOnTheModel(why) => (PropertyVerdict::NotOnTheModel, Some(why.clone()), None),
            ProofStatus::Fault { what, run } => (PropertyVerdict::Fault, Some(what.clone()), run.as_deref()),
        };
        let trace = run.map(ObservedRun::named_trace);
        Self {
            network: String::new(),
            kind: PropertyKind::Requirement,
            name: monitor.name.clone(),
            title: monitor.title.clone(),
            text: monitor.text.clone(),
            verdict,
            remark: remark.or_else(|| trace.as_ref().map(shape)),
            bounds: Vec::new(),
            trace,
            statistics: proof.statistics,
            joint: false,
            time: Duration::ZERO,
            place: (0, PropertyKind::Requirement, proof.monitor),
            slots: Vec::new(),
        }
    }

    pub fn of_answer(program: &Program, answer: &QueryResult) -> Self {
        let query = &program.queries[answer.query];
        let (verdict, remark) = match &answer.found {
            QueryFinding::Satisfied => (PropertyVerdict::Satisfied, None),
            QueryFinding::NotSatisfied => (PropertyVerdict::NotSatisfied, None),
            QueryFinding::Bounds(_) => (PropertyVerdict::Answered, None),
            QueryFinding::Inconclusive(why) => (PropertyVerdict::Inconclusive, Some(why.clone())),
            QueryFinding::Fault(what) => (PropertyVerdict::Fault, Some(what.clone())),
        };
        let bounds = match &answer.found {
            QueryFinding::Bounds(bounds) => bounds.clone(),
            QueryFinding::Satisfied
            | QueryFinding::NotSatisfied
            | QueryFinding::Inconclusive(_)
            | QueryFinding::Fault(_) => Vec::new(),
        };
        let trace = answer.run.as_deref().map(ObservedRun::named_trace);
        let remarks: Vec<String> =
            remark.into_iter().chain(answer.notes.iter().cloned()).chain(trace.as_ref().map(shape)).collect();
        Self {
            network: String::new(),
            kind: PropertyKind::Query,
            name: query.name.clone(),
            title: query.title.clone(),
            text: query.text.clone(),
            verdict,
            remark: (!remarks.is_empty()).then(|| remarks.join("; ")),
            bounds,
            trace,
            statistics: answer.statistics,
            joint: answer.joint,
            time: Duration::ZERO,
            place: (0, PropertyKind::Query, answer.query),
            slots: Vec::new(),
        }
    }

    /// Whether variables that the search for an answer left out stay in their ranges.
    pub fn of_range(range: &RangeResult) -> Self {
        let (verdict, remark) = match &range.found {
            RangeVerdict::Kept => (PropertyVerdict::Holds, None),
            RangeVerdict::Inconclusive(why) => (PropertyVerdict::Inconclusive, Some(why.clone())),
            RangeVerdict::Left(what) => (PropertyVerdict::Fault, Some(what.clone())),
        };
        let trace = range.run.as_deref().map(ObservedRun::named_trace);
        let remarks: Vec<String> = remark.into_iter().chain(trace.as_ref().map(shape)).collect();
        Self {
            network: String::new(),
            kind: PropertyKind::Range,
            name: range.variables.join(", "),
            title: String::new(),
            text: "left out where nothing reads it: stays in its range".to_owned(),
            verdict,
            remark: (!remarks.is_empty()).then(|| remarks.join("; ")),
            bounds: Vec::new(),
            trace,
            statistics: range.statistics,
            joint: false,
            time: Duration::ZERO,
            place: (0, PropertyKind::Range, range.slots.first().copied().unwrap_or_default()),
            slots: range.slots.clone(),
        }
    }
}

fn untriggered(triggered: Option<bool>, why: Option<&str>) -> Option<String> {
    match triggered {
        Some(true) => None,
        Some(false) => Some(match why {
            Some(why) => format!("vacuously: it is never triggered; {why}"),
            None => "vacuously: it is never triggered".to_owned(),
        }),
        None => Some("whether it is ever triggered is inconclusive".to_owned()),
    }
}

/// `in 7 steps, at 12.5 s`
fn shape(trace: &WitnessTrace) -> String {
    let steps = trace.steps.len();
    format!("in {steps} {}, at {} s", if steps == 1 { "step" } else { "steps" }, trace.end)
}
