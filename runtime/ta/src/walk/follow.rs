//! Whether a recorded run is one of a network, and where it leaves it.
//!
//! What a record does not say (a time, which of two edges between the same locations) may be anything: all states in which the network can be
//! are carried along, each with all its clocks.

use std::rc::Rc;

use hrdsl_ir::Nanos;

use crate::{
    network::{actions::PathTransition, error::ModelError},
    walk::state::{MomentRange, NetworkWalk, WalkOption, WalkState},
    witness::{run::RunEnding, trace::seconds},
};

/// More states than this at once are not followed: the record says too little.
const MOST_STATES: usize = 2_000;

/// A run as somebody recorded it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedWalk {
    pub steps: Vec<RecordedStep>,
    pub end: Option<RecordedTime>,
    pub ending: Option<RunEnding>,
}

/// A transition as it was recorded; what is `None` is not said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedStep {
    pub time: Option<RecordedTime>,
    /// `asked(false)`
    pub over: Option<String>,
    pub parts: Vec<RecordedPart>,
    /// What changes, as `q: 0 -> 1`.
    pub variables: Option<Vec<String>>,
}

/// Who takes which edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedPart {
    /// Index in the network.
    pub member: usize,
    pub from: Option<String>,
    pub to: Option<String>,
    /// The number of the edge, from 1.
    pub edge: Option<usize>,
    /// As `n = 2`.
    pub selected: Option<Vec<String>>,
}

/// When something happened, since the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordedTime {
    At(Nanos),
    /// Between this nanosecond and the next, neither included.
    After(Nanos),
}

/// What became of a recorded run.
#[derive(Clone)]
pub enum FollowOutcome {
    /// It is a run of the network.
    Run,
    /// It is a run of the network, and what is recorded of its end is so: this fault of the model is next.
    Fault(Box<ModelError>),
    Leaves(Box<FollowDeparture>),
}

/// Where a recorded run leaves the network.
#[derive(Clone)]
pub struct FollowDeparture {
    /// The number of the step, from 1; one more than there are steps: what is recorded of the end.
    pub step: usize,
    pub why: String,
    /// What can happen there instead.
    pub enabled: Vec<WalkOption>,
    /// When the network can be there, without a transition.
    pub stays: Option<MomentRange>,
}

impl RecordedTime {
    pub(crate) fn range(self) -> MomentRange {
        match self {
            RecordedTime::At(t) => MomentRange { from: t, after: false, until: Some(t), before: false },
            RecordedTime::After(t) => {
                MomentRange { from: t, after: true, until: Some(t.saturating_add(1)), before: true }
            }
        }
    }
}

/// A state in which the network can be after some steps of a record, and how it comes there.
pub(crate) struct FollowedState {
    pub(crate) state: WalkState,
    /// Its place among the states before the step.
    before: usize,
    /// `None`: it is the start.
    taken: Option<Rc<PathTransition>>,
}

/// All states along a recorded run: at the start, and after each step as far as the network goes along.
pub(crate) struct FollowTrail {
    layers: Vec<Vec<FollowedState>>,
    pub(crate) leaves: Option<Box<FollowDeparture>>,
}

impl FollowTrail {
    /// # Errors
    /// If the start of the network is a fault, or the record says so little that there is too much to follow.
    pub(crate) fn new(walk: &NetworkWalk<'_>, run: &RecordedWalk) -> Result<Self, ModelError> {
        let start = FollowedState { state: walk.start()?, before: 0, taken: None };
        let mut trail = Self { layers: vec![vec![start]], leaves: None };
        for (index, step) in run.steps.iter().enumerate() {
            let Some(states) = trail.layers.last() else { break };
            let mut next: Vec<FollowedState> = Vec::new();
            for (before, followed) in states.iter().enumerate() {
                // INVARIANT: a moment only narrows the clocks, so that what is possible then is among what is possible at all.
                let there = match step.time {
                    Some(time) => walk.at(&followed.state, &time.range()),
                    None => Some(followed.state.clone()),
                };
                let options = there.map(|state| walk.options(&state)).unwrap_or_default();
                for option in options.into_iter().filter(|o| step.fits(o)) {
                    let Some(state) = option.next else { continue };
                    let includes = |s: &FollowedState| {
                        s.state.discrete == state.discrete && s.state.zone.includes(&state.zone)
                    };
                    if !next.iter().any(includes) {
                        next.push(FollowedState {
                            state,
                            before,
                            taken: Some(option.transition.action.taken),
                        });
                    }
                }
            }
            if next.is_empty() {
                let states: Vec<WalkState> = states.iter().map(|s| s.state.clone()).collect();
                trail.leaves = Some(Box::new(leaves(walk, &states, step, index + 1)));
                break;
            }
            if next.len() > MOST_STATES {
                let step = index + 1;
                let what =
                    format!("step {step}: the record says too little: more than {MOST_STATES} states fit");
                return Err(ModelError::Question(what));
            }
            trail.layers.push(next);
        }
        Ok(trail)
    }

    fn last(&self) -> impl Iterator<Item = &FollowedState> {
        self.layers.last().into_iter().flatten()
    }

    /// One way along it: the transitions, and the states that they lead to.
    pub(crate) fn path(&self) -> Vec<(Rc<PathTransition>, WalkState)> {
        let (mut path, mut at) = (Vec::new(), 0);
        for layer in self.layers.iter().rev() {
            let Some(followed) = layer.get(at) else { break };
            at = followed.before;
            path.extend(followed.taken.as_ref().map(|taken| (Rc::clone(taken), followed.state.clone())));
        }
        path.reverse();
        path
    }
}

/// Follows a recorded run.
///
/// # Errors
/// If the start of the network is a fault, or the record says so little that there is too much to follow.
pub fn follow(walk: &NetworkWalk<'_>, run: &RecordedWalk) -> Result<FollowOutcome, ModelError> {
    let trail = FollowTrail::new(walk, run)?;
    if let Some(left) = trail.leaves {
        return Ok(FollowOutcome::Leaves(left));
    }
    let states: Vec<WalkState> = trail.last().map(|s| s.state.clone()).collect();
    let history = trail.layers.iter().filter_map(|layer| layer.first());
    let history: Vec<Vec<i64>> = history.map(|s| s.state.discrete.clone()).collect();
    Ok(ended(walk, &states, run, &history))
}

impl RecordedStep {
    /// Whether an option is what was recorded, as far as that says.
    fn fits(&self, option: &WalkOption) -> bool {
        let told = &option.told;
        let same = |(said, part): (&RecordedPart, &crate::TransitionParticipant)| {
            let agrees = |said: &Option<String>, is: &String| said.as_ref().is_none_or(|s| s == is);
            said.member == part.member
                && agrees(&said.from, &part.from)
                && agrees(&said.to, &part.to)
                && said.edge.is_none_or(|e| e == part.edge)
                && said.selected.as_ref().is_none_or(|s| *s == part.selected)
        };
        option.fault.is_none()
            && self.parts.len() == told.parts.len()
            && self.parts.iter().zip(&told.parts).all(same)
            && self.over.as_ref().is_none_or(|over| Some(over) == told.over.as_ref())
            && self.variables.as_ref().is_none_or(|changes| *changes == told.variables)
    }
}

/// Why no state takes a step.
fn leaves(
    walk: &NetworkWalk<'_>,
    states: &[WalkState],
    step: &RecordedStep,
    number: usize,
) -> FollowDeparture {
    let mut enabled: Vec<WalkOption> = Vec::new();
    for option in states.iter().flat_map(|s| walk.options(s)) {
        let known = |o: &WalkOption| o.told == option.told && o.time == option.time;
        if !enabled.iter().any(known) {
            enabled.push(option);
        }
    }
    let stays = states.first().map(|s| walk.time(s));
    let same_parts = |o: &&WalkOption| {
        let parts = RecordedStep { parts: step.parts.clone(), ..RecordedStep::default() };
        parts.fits(o)
    };
    let why = if let Some(option) = enabled.iter().find(|o| step.fits(o)) {
        format!("it can be taken {} only", option.time.during())
    } else if let Some(place) = elsewhere(walk, states, step) {
        place
    } else if let Some(option) = enabled.iter().find(same_parts) {
        differs(step, option)
    } else {
        "no such transition is possible there".to_owned()
    };
    FollowDeparture { step: number, why, enabled, stays }
}

/// The first automaton that is not where it was recorded to leave.
fn elsewhere(walk: &NetworkWalk<'_>, states: &[WalkState], step: &RecordedStep) -> Option<String> {
    let automata = walk.automata();
    for part in &step.parts {
        let Some(from) = &part.from else { continue };
        let mut places = states.iter().filter_map(|s| walk.locations(s).get(part.member).copied());
        let first = places.next()?;
        if first != from && places.all(|place| place != from) {
            return Some(format!("`{}` is in `{first}`, not in `{from}`", automata.get(part.member)?));
        }
    }
    None
}

/// What a transition of the recorded parts does in another way.
fn differs(step: &RecordedStep, option: &WalkOption) -> String {
    let told = &option.told;
    if let Some(over) = step.over.as_ref().filter(|over| Some(*over) != told.over.as_ref()) {
        let other = told.over.as_deref().unwrap_or("nothing");
        return format!("these edges go over `{other}` there, not over `{over}`");
    }
    let changes = |all: &[String]| if all.is_empty() { "nothing".to_owned() } else { all.join(", ") };
    let recorded = step.variables.as_deref().unwrap_or_default();
    format!("these edges change {}, not {}", changes(&told.variables), changes(recorded))
}

/// Whether what was recorded of the end is so.
fn ended(
    walk: &NetworkWalk<'_>,
    states: &[WalkState],
    run: &RecordedWalk,
    history: &[Vec<i64>],
) -> FollowOutcome {
    let until = |state: &WalkState| match run.end {
        Some(end) => walk.at(state, &end.range()),
        None => Some(state.clone()),
    };
    let stays: Vec<WalkState> = states.iter().filter_map(until).collect();
    let time = states.first().map(|s| walk.time(s));
    let left = |why: String, enabled: Vec<WalkOption>| {
        let step = run.steps.len() + 1;
        FollowOutcome::Leaves(Box::new(FollowDeparture { step, why, enabled, stays: time }))
    };
    let from = |state: &WalkState| {
        let range = run.end.map_or_else(|| walk.time(state), RecordedTime::range);
        walk.at(state, &MomentRange { until: None, before: false, ..range })
    };
    let later = || states.iter().filter_map(from).flat_map(|s| walk.options(&s)).collect::<Vec<_>>();
    if stays.is_empty() {
        let end = run.end.map_or(0, |end| end.range().from);
        return left(format!("time cannot pass until {} s there", seconds(end, 1)), later());
    }
    match run.ending {
        Some(RunEnding::Stuck) if !later().is_empty() => {
            left("it was recorded that nothing more can happen, and something can".to_owned(), later())
        }
        Some(RunEnding::Waits) if !stays.iter().any(|s| s.for_ever) => {
            left("it was recorded that time can pass for ever, and it cannot".to_owned(), later())
        }
        Some(RunEnding::Again(from)) if history.get(from) != history.last() => {
            left(format!("it does not end where step {} begins", from + 1), later())
        }
        Some(RunEnding::Fault) => {
            let mut options = stays.iter().flat_map(|s| walk.options(s));
            match options.find_map(|option| option.fault) {
                Some(fault) => FollowOutcome::Fault(Box::new(fault)),
                None => {
                    left("it was recorded that a fault of the model is next, and none is".to_owned(), later())
                }
            }
        }
        Some(RunEnding::Stuck | RunEnding::Waits | RunEnding::Again(_) | RunEnding::Reached) | None => {
            FollowOutcome::Run
        }
    }
}
