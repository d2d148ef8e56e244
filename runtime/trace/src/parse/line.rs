//! The lines of a recording as JSON objects, before names and types are looked at.

use std::{borrow::Cow, fmt};

use serde::{
    Deserialize, Deserializer,
    de::{MapAccess, Visitor},
};
use serde_json::{Value as Json, value::RawValue};

use super::problem::LineProblem;
use crate::{MachineDeclaration, MachineEdge, MachineStep, RunEnd, record::RecordingEnd};

/// The first line. Other programs may say more in it, which is skipped.
#[derive(Deserialize)]
pub(super) struct HeaderLine {
    pub hrdsl: Option<String>,
    pub version: Option<u64>,
    pub scenario: Option<String>,
    pub vocabulary: Option<String>,
    pub test: Option<String>,
    pub seed: Option<u64>,
}

/// Any other line: a step or the end. Times stay text, since they must not become floats.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StepLine<'a> {
    #[serde(borrow)]
    pub t: Option<&'a RawValue>,
    #[serde(borrow)]
    pub event: Option<Cow<'a, str>>,
    pub args: Option<JsonArguments>,
    #[serde(borrow)]
    pub signal: Option<Cow<'a, str>>,
    pub value: Option<Json>,
    pub machine: Option<String>,
    pub states: Option<Vec<String>>,
    pub transitions: Option<Vec<(String, String, String)>>,
    pub outcomes: Option<Vec<String>>,
    pub from: Option<String>,
    pub outcome: Option<String>,
    pub to: Option<String>,
    #[serde(borrow)]
    pub end: Option<&'a RawValue>,
    #[serde(borrow)]
    pub ended: Option<Cow<'a, str>>,
    #[serde(borrow)]
    pub error: Option<Cow<'a, str>>,
}

/// An event's arguments in the order written, doubles included.
pub(super) struct JsonArguments(pub Vec<(String, Json)>);

impl HeaderLine {
    pub fn read(text: &str) -> Result<Self, LineProblem> {
        serde_json::from_str(text).map_err(|error| problem(&error))
    }
}

impl<'a> StepLine<'a> {
    pub fn read(text: &'a str) -> Result<Self, LineProblem> {
        serde_json::from_str(text).map_err(|error| problem(&error))
    }

    /// Whether there is anything of a state machine.
    pub fn has_machine(&self) -> bool {
        self.machine.is_some()
            || self.states.is_some()
            || self.transitions.is_some()
            || self.outcomes.is_some()
            || self.from.is_some()
            || self.outcome.is_some()
            || self.to.is_some()
    }

    /// The step of a state machine; fails if there is more or less than that.
    pub fn machine_step(self) -> Result<MachineStep, LineProblem> {
        let other =
            self.event.is_some() || self.args.is_some() || self.signal.is_some() || self.value.is_some();
        let Some(machine) = self.machine.filter(|_| !other) else {
            return Err(LineProblem::Form(
                "a step of a state machine has `t`, `machine` and what it did only",
            ));
        };
        match (self.states, self.transitions, self.outcomes, self.from, self.outcome, self.to) {
            (Some(states), Some(transitions), Some(outcomes), None, None, None) => {
                let edge = |(from, outcome, to)| MachineEdge { from, outcome, to };
                let transitions = transitions.into_iter().map(edge).collect();
                Ok(MachineStep::Declared(MachineDeclaration { machine, states, transitions, outcomes }))
            }
            (None, None, None, None, None, Some(state)) => Ok(MachineStep::Begun { machine, state }),
            (None, None, None, Some(from), Some(outcome), Some(to)) => {
                Ok(MachineStep::Moved { machine, edge: MachineEdge { from, outcome, to } })
            }
            _ => Err(LineProblem::Form(
                "a state machine has `states`, `transitions` and `outcomes`, or goes `from` a state by an `outcome` `to` another, \
                 or begins with a state `to` which it goes",
            )),
        }
    }

    /// How the run ended; fails if there is anything of a step.
    pub fn ending(self) -> Result<RecordingEnd, LineProblem> {
        let more = self.t.is_some()
            || self.event.is_some()
            || self.args.is_some()
            || self.signal.is_some()
            || self.value.is_some()
            || self.has_machine();
        if more {
            return Err(LineProblem::Form("the last line has `end`, `ended` and `error` only"));
        }
        let kind = match &self.ended {
            None => RunEnd::default(),
            Some(word) => RunEnd::of_word(word).ok_or_else(|| LineProblem::End(word.to_string()))?,
        };
        let error = self.error.map(Cow::into_owned);
        if error.is_some() && kind != RunEnd::Error {
            return Err(LineProblem::Form("a run has an `error` only if it `ended` in error"));
        }
        Ok(RecordingEnd { kind, error })
    }
}

/// The parser sees one line only, so its own line number would mislead.
fn problem(error: &serde_json::Error) -> LineProblem {
    let full = error.to_string();
    let message = full.rsplit_once(" at line ").map_or(full.as_str(), |(message, _)| message);
    LineProblem::Json(format!("{message} (column {})", error.column()))
}

impl<'de> Deserialize<'de> for JsonArguments {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ArgumentVisitor;

        impl<'de> Visitor<'de> for ArgumentVisitor {
            type Value = JsonArguments;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of arguments by name")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<JsonArguments, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(JsonArguments(pairs))
            }
        }

        deserializer.deserialize_map(ArgumentVisitor)
    }
}
