//! Events as requirements ask for them: whatever their arguments are, or with some that were seen.

use std::{cmp::Reverse, collections::BTreeMap};

use hrdsl_ir::{
    EventId, Program, Value,
    event::{ArgPattern, EventPattern, Provenance},
};

use crate::facts::{RunFacts, SeenEvent};

/// Forms with arguments that one event has: those that are seen most.
const MOST_OF_AN_EVENT: usize = 6;
/// Forms with arguments that all events have together: each is held against each other form.
const MOST_WITH_ARGUMENTS: usize = 64;

/// An event in one form, as the language writes it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EventForm {
    pub pattern: EventPattern,
    pub text: String,
    /// Whether a test does it, and no actor says or sees it.
    pub is_stimulus: bool,
    /// Whether the script of a test brings it about, so that it is no fault of the code.
    pub is_played: bool,
}

impl EventForm {
    fn new(program: &Program, pattern: EventPattern) -> Self {
        let declared = program.event(pattern.event);
        let args: Vec<String> = pattern.args.iter().map(ToString::to_string).collect();
        let text = match args.as_slice() {
            [] => declared.name.clone(),
            args => format!("{}({})", declared.name, args.join(", ")),
        };
        let is_stimulus = declared.is_stimulus();
        let is_played = is_stimulus || program.provenance(pattern.event) == Provenance::Played;
        Self { pattern, text, is_stimulus, is_played }
    }

    pub(crate) fn any(program: &Program, event: EventId) -> Self {
        let args = vec![ArgPattern::Any; program.event(event).params.len()];
        Self::new(program, EventPattern { event, args })
    }

    /// How many of its arguments are asked for.
    pub(crate) fn narrowness(&self) -> usize {
        self.pattern.args.iter().filter(|arg| **arg != ArgPattern::Any).count()
    }

    /// Whether no event is of both forms.
    pub(crate) fn excludes(&self, other: &Self) -> bool {
        let differ = |(a, b): (&ArgPattern, &ArgPattern)| match (a, b) {
            (ArgPattern::Is(a), ArgPattern::Is(b)) => a.key() != b.key(),
            (ArgPattern::Any, _) | (_, ArgPattern::Any) => false,
        };
        let (own, others) = (&self.pattern, &other.pattern);
        own.event != others.event || own.args.iter().zip(&others.args).any(differ)
    }
}

/// All events whatever their arguments are, and those with arguments that runs have: with one of them, and with all.
pub(crate) fn forms_of(program: &Program, runs: &[RunFacts]) -> Vec<EventForm> {
    let ids = (0..program.events.len()).filter_map(|at| at.try_into().ok()).map(EventId);
    let mut forms: Vec<EventForm> = ids.map(|event| EventForm::any(program, event)).collect();
    let mut seen: BTreeMap<(EventId, String), (usize, EventForm)> = BTreeMap::new();
    for event in runs.iter().flat_map(|run| &run.events) {
        for form in narrower(program, event) {
            let (count, _) = seen.entry((event.event, form.text.clone())).or_insert((0, form));
            *count += 1;
        }
    }
    let mut narrow: Vec<(usize, EventForm)> = seen.into_values().collect();
    narrow.sort_by_key(|(count, _)| Reverse(*count));
    let mut of_event: BTreeMap<EventId, usize> = BTreeMap::new();
    narrow.retain(|(_, form)| {
        let count = of_event.entry(form.pattern.event).or_default();
        *count += 1;
        *count <= MOST_OF_AN_EVENT
    });
    forms.extend(narrow.into_iter().take(MOST_WITH_ARGUMENTS).map(|(_, form)| form));
    forms
}

/// The event with all its arguments, and with each alone. Those that no two runs have alike, to the bit, make no form.
pub(crate) fn narrower(program: &Program, event: &SeenEvent) -> Vec<EventForm> {
    let form = |args| EventForm::new(program, EventPattern { event: event.event, args });
    let is_discrete = |value: &Value| match value {
        Value::Bool(_) | Value::Int(_) | Value::Symbol(_) | Value::Text(_) => true,
        Value::Float(_) | Value::List(_) => false,
    };
    let mut forms = Vec::new();
    if !event.args.is_empty() && event.args.iter().all(is_discrete) {
        forms.push(form(event.args.iter().copied().map(ArgPattern::Is).collect()));
    }
    if event.args.len() > 1 {
        let places = event.args.iter().enumerate().filter(|(_, value)| is_discrete(value));
        forms.extend(places.map(|(place, value)| {
            let mut args = vec![ArgPattern::Any; event.args.len()];
            if let Some(arg) = args.get_mut(place) {
                *arg = ArgPattern::Is(*value);
            }
            form(args)
        }));
    }
    forms
}
