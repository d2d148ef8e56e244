//! Timed conformance: what was seen of the code, held against the automata that model it.

use std::fmt;

use hrdsl_ir::Span;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Whether a run is one of the model's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConformanceOutcome {
    /// All that was seen, and when, the model allows.
    Conforms,
    /// The code did something that the model does not allow, or did nothing where the model must do something.
    Departs,
    /// Neither can be said.
    Inconclusive,
}

/// The verdict on a run by one model of the system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConformanceVerdict {
    /// The automata that play the system, joined by ` | `.
    pub model: String,
    pub outcome: ConformanceOutcome,
    /// Where the run left the model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub departure: Option<ModelDeparture>,
    /// Why nothing can be said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

/// How a run left the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DepartureKind {
    /// An event that the model does not allow then.
    Event,
    /// Silence for longer than the model can be silent.
    Silence,
}

/// Where a run left the model, and what the model would have allowed there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelDeparture {
    pub kind: DepartureKind,
    /// Of the event, or the last moment until which the model can be silent, in seconds.
    pub time: f64,
    /// The event that is not allowed; after a silence, the next one that came, if one did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub event: Option<DepartedEvent>,
    /// What the model allowed since the event before: its events, with their windows.
    pub allowed: Vec<AllowedEvent>,
    /// Until when the model could have been silent, in seconds; left out if it could for ever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub silent_until: Option<f64>,
    /// The locations in which the model could have been.
    pub locations: Vec<ModelPlace>,
}

/// An event with which, or after which, a run left the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DepartedEvent {
    /// Its place in the trace's steps, from 0: line `step + 2` of the recording.
    pub step: usize,
    /// Seconds.
    pub time: f64,
    pub text: String,
}

/// An event that a model allows, and when.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AllowedEvent {
    pub event: String,
    /// Seconds from the start of the run.
    pub from: f64,
    /// Left out if there is no bound near.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<f64>,
    /// The edges that send it.
    pub edges: Vec<ModelPlace>,
}

/// An edge or location of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelPlace {
    /// `Robot.move`, `Robot: send -> receive2`
    pub name: String,
    /// The line of the scenario in which it is written, if that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Where it is written, for whoever has the scenario's text.
    #[serde(skip)]
    pub origin: Option<Span>,
}

impl ModelPlace {
    #[must_use]
    pub fn new(name: String, origin: Span) -> Self {
        Self { name, line: None, origin: Some(origin) }
    }
}

impl fmt::Display for ModelPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{} (line {line})", self.name),
            None => f.write_str(&self.name),
        }
    }
}

impl fmt::Display for AllowedEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let from = Seconds(self.from);
        match self.until {
            Some(until) if until <= self.from => write!(f, "{} at {from}", self.event),
            Some(until) => write!(f, "{} from {from} to {}", self.event, Seconds(until)),
            None => write!(f, "{} from {from} on", self.event),
        }
    }
}

/// A time for people, without digits that say nothing.
struct Seconds(f64);

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.3}", self.0);
        write!(f, "{} s", text.trim_end_matches('0').trim_end_matches('.'))
    }
}

impl ConformanceVerdict {
    /// The verdict of a model about which, or by which, nothing can be said.
    #[must_use]
    pub fn inconclusive(model: String, why: String) -> Self {
        Self { model, outcome: ConformanceOutcome::Inconclusive, departure: None, why: Some(why) }
    }

    /// The run broke off: what it did not do, it might have done. A departure stands.
    pub fn break_off(&mut self) {
        if self.outcome == ConformanceOutcome::Conforms {
            *self = Self::inconclusive(std::mem::take(&mut self.model), "the run broke off".to_owned());
        }
    }

    /// Where the run left the model, or why that is not known, in a sentence for people. `None` if it conforms.
    #[must_use]
    pub fn sentence(&self) -> Option<String> {
        let said = self.departure.as_ref().map(ModelDeparture::to_string);
        Some(format!("{}: {}", self.model, said.or_else(|| self.why.clone())?))
    }

    /// Asks for the line of each place that it names.
    pub fn locate(&mut self, line: &dyn Fn(Span) -> Option<usize>) {
        let Some(departure) = &mut self.departure else { return };
        let edges = departure.allowed.iter_mut().flat_map(|a| &mut a.edges);
        for place in edges.chain(&mut departure.locations) {
            place.line = place.origin.and_then(line);
        }
    }
}

impl fmt::Display for ModelDeparture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.kind, &self.event) {
            (DepartureKind::Event, event) => {
                let text = event.as_ref().map_or("an event", |e| e.text.as_str());
                write!(f, "at {} {text} came", Seconds(self.time))?;
            }
            (DepartureKind::Silence, Some(next)) => {
                write!(
                    f,
                    "nothing came by {}, and {} at {}",
                    Seconds(self.time),
                    next.text,
                    Seconds(next.time)
                )?;
            }
            (DepartureKind::Silence, None) => write!(f, "nothing came by {}", Seconds(self.time))?,
        }
        let allowed: Vec<String> = self.allowed.iter().map(ToString::to_string).collect();
        let silence = match self.silent_until {
            Some(until) if self.kind == DepartureKind::Event => {
                Some(format!("silence to {}", Seconds(until)))
            }
            Some(_) => None,
            None => Some("silence".to_owned()),
        };
        let all: Vec<String> = allowed.into_iter().chain(silence).collect();
        write!(
            f,
            "; the model allows {}",
            if all.is_empty() { "nothing".to_owned() } else { all.join(", ") }
        )?;
        let places: Vec<String> = self.locations.iter().take(3).map(ToString::to_string).collect();
        let more = if self.locations.len() > 3 { ", …" } else { "" };
        if places.is_empty() { Ok(()) } else { write!(f, ", in {}{more}", places.join(", ")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late() -> ConformanceVerdict {
        let place = |name: &str| ModelPlace { name: name.into(), line: None, origin: Some(Span::default()) };
        let allowed = AllowedEvent {
            event: "offered".into(),
            from: 20.0,
            until: Some(30.5),
            edges: vec![place("Robot: send -> wait")],
        };
        let departure = ModelDeparture {
            kind: DepartureKind::Silence,
            time: 30.5,
            event: Some(DepartedEvent { step: 4, time: 31.25, text: "offered".into() }),
            allowed: vec![allowed],
            silent_until: Some(30.5),
            locations: vec![place("Robot.move")],
        };
        ConformanceVerdict {
            model: "Robot".into(),
            outcome: ConformanceOutcome::Departs,
            departure: Some(departure),
            why: None,
        }
    }

    #[test]
    fn a_departure_says_when_what_was_allowed_and_where_the_model_was() {
        let mut verdict = late();
        verdict.locate(&|_| Some(7));
        assert_eq!(
            verdict.sentence().as_deref(),
            Some(
                "Robot: nothing came by 30.5 s, and offered at 31.25 s; the model allows offered from 20 s to 30.5 s, in Robot.move (line 7)"
            )
        );
        let departure = verdict.departure.as_mut().unwrap();
        (departure.kind, departure.time, departure.silent_until) = (DepartureKind::Event, 13.4, None);
        departure.allowed[0].until = None;
        departure.locations.clear();
        assert_eq!(
            departure.to_string(),
            "at 13.4 s offered came; the model allows offered from 20 s on, silence"
        );
    }

    #[test]
    fn a_run_that_broke_off_may_have_left_the_model_but_conforms_to_nothing() {
        let mut verdict = late();
        verdict.break_off();
        assert_eq!(verdict, late());
        verdict.outcome = ConformanceOutcome::Conforms;
        verdict.break_off();
        assert_eq!(verdict.sentence().as_deref(), Some("Robot: the run broke off"));
    }
}
