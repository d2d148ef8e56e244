//! Holds a trace against each model of the system, step by step.

use std::fmt;

use hrdsl_ir::{EventId, Nanos, Program, Value, value::seconds};
use hrdsl_results::{ConformanceOutcome, ConformanceVerdict, DepartedEvent, DepartureKind, ModelDeparture};
use hrdsl_trace::{RunEnd, TraceObserver, TraceStep, TraceStepKind, print};

use crate::{
    ConformanceOptions,
    allowed::{allowed, farthest, locations},
    model::{SystemModel, limit, system_models},
    states::{PossibleState, common_samples},
    trail::ModelTrail,
    walk::{ModelWalk, ObservationEffect, WalkFault, WatchedBound},
};

/// Holds a trace against each model of the system.
#[derive(Debug)]
pub struct ConformanceChecker<'p> {
    models: Vec<FollowedModel<'p>>,
    end: Nanos,
}

impl<'p> ConformanceChecker<'p> {
    #[must_use]
    pub fn new(program: &'p Program, options: &ConformanceOptions) -> Self {
        let models = system_models(program).into_iter();
        Self { models: models.map(|model| FollowedModel::new(program, model, options)).collect(), end: 0 }
    }

    /// One that keeps the trail of each model, looking as far ahead as the model speaks of in `of`: the same program, but for changes of its
    /// automata.
    #[must_use]
    pub fn trailing(program: &'p Program, options: &ConformanceOptions, of: &Program) -> Self {
        let mut checker = Self::new(program, options);
        for followed in &mut checker.models {
            followed.keep_trail(farthest(of, &followed.model));
        }
        checker
    }

    /// As [`finish`](Self::finish), with the trail of each model, if they are kept.
    #[must_use]
    pub fn finish_trails(self, ended: RunEnd) -> Vec<(ConformanceVerdict, ModelTrail)> {
        let Self { models, end } = self;
        models.into_iter().map(|model| model.finish_trail(end, ended)).collect()
    }

    /// A verdict by each model, on a run that ended like this.
    #[must_use]
    pub fn finish(self, ended: RunEnd) -> Vec<ConformanceVerdict> {
        let Self { models, end } = self;
        models.into_iter().map(|model| model.finish(end, ended)).collect()
    }
}

impl TraceObserver for ConformanceChecker<'_> {
    fn step(&mut self, index: usize, step: &TraceStep) {
        match &step.what {
            TraceStepKind::Event { event, args } => {
                self.models.iter_mut().for_each(|model| model.event(index, step.time, (*event, args)));
            }
            TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => {}
        }
    }

    fn end(&mut self, time: Nanos) {
        self.end = time;
    }
}

/// How far a model was followed.
enum FollowState {
    /// The states in which it was at the last observation, and when that was.
    Possible(Vec<PossibleState>, Nanos),
    Departed(ModelDeparture),
    Lost(String),
}

/// A model with the states in which it can be.
pub(crate) struct FollowedModel<'p> {
    program: &'p Program,
    model: SystemModel,
    hidden: Vec<EventId>,
    walk: Option<ModelWalk<'p>>,
    state: FollowState,
    /// Observations so far.
    pub(crate) observed: usize,
    /// Of each bound that is watched, what its clock was whenever an edge was taken: at least, at most.
    pub(crate) samples: Vec<(usize, Nanos, Option<Nanos>)>,
    /// If it is kept, with how far ahead is looked for it.
    trail: Option<(ModelTrail, i64)>,
}

impl fmt::Debug for FollowedModel<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FollowedModel").field("model", &self.model.name).finish_non_exhaustive()
    }
}

impl<'p> FollowedModel<'p> {
    pub(crate) fn new(program: &'p Program, model: SystemModel, options: &ConformanceOptions) -> Self {
        Self::watching(program, model, options, Vec::new())
    }

    /// One whose clocks are looked at.
    pub(crate) fn watching(
        program: &'p Program,
        model: SystemModel,
        options: &ConformanceOptions,
        watched: Vec<WatchedBound>,
    ) -> Self {
        let begun = match &model.obstacle {
            Some(obstacle) => Err(obstacle.clone()),
            None => ModelWalk::new(program, &model, options, watched)
                .and_then(|walk| Ok((walk.start()?, walk)))
                .map_err(|fault| fault.sentence()),
        };
        let (walk, state) = match begun {
            Ok((states, walk)) => (Some(walk), FollowState::Possible(states, 0)),
            Err(why) => (None, FollowState::Lost(why)),
        };
        let hidden = options.unobserved.clone();
        Self { program, model, hidden, walk, state, observed: 0, samples: Vec::new(), trail: None }
    }

    fn keep_trail(&mut self, ahead: i64) {
        self.trail = Some((ModelTrail::default(), ahead));
        if let Some(walk) = &mut self.walk {
            walk.keep_visited();
        }
        self.look_ahead();
    }

    /// What the model allows now belongs to its trail.
    fn look_ahead(&mut self) {
        let (Some((trail, ahead)), Some(walk)) = (&mut self.trail, &mut self.walk) else { return };
        if let FollowState::Possible(states, _) = &self.state {
            trail.look_ahead(walk, states, *ahead);
        }
    }

    fn is_output(&self, event: EventId) -> bool {
        self.model.outputs.contains(&event) && !self.hidden.contains(&event)
    }

    pub(crate) fn event(&mut self, index: usize, time: Nanos, (event, args): (EventId, &[Value])) {
        let is_output = self.is_output(event);
        if !is_output && !self.model.inputs.contains(&event) {
            return;
        }
        let seen = || DepartedEvent {
            step: index,
            time: seconds(time),
            text: print::event_text(self.program, event, args),
        };
        let (states, last) = match &mut self.state {
            FollowState::Possible(states, last) => (std::mem::take(states), *last),
            // What came after a silence that was too long is told, too.
            FollowState::Departed(departure) => {
                if is_output && departure.kind == DepartureKind::Silence && departure.event.is_none() {
                    departure.event = Some(seen());
                }
                return;
            }
            FollowState::Lost(_) => return,
        };
        self.observed += 1;
        let departed = is_output.then(seen);
        let Some(walk) = &mut self.walk else { return };
        let since = time - last;
        let effect = if is_output {
            walk.output_seen(&states, since, (event, args))
        } else {
            walk.input(&states, since, (event, args))
        };
        let state = match effect {
            Ok(ObservationEffect::Now(next)) => {
                self.samples.extend(common_samples(&next));
                Ok(FollowState::Possible(walk.kept(next), time))
            }
            Ok(ObservationEffect::Late) => self.silence(&states, last, since, departed),
            Ok(ObservationEffect::Wrong(at)) => self.wrong(&states, (last, since), departed, &at),
            Ok(ObservationEffect::Refused) => {
                let text = print::event_text(self.program, event, args);
                let when = seconds(time);
                Ok(FollowState::Lost(format!(
                    "the model cannot take {text} at {when} s: it excludes that others do so then"
                )))
            }
            Err(fault) => Err(fault),
        };
        self.state = state.unwrap_or_else(|fault| FollowState::Lost(fault.sentence()));
        self.look_ahead();
    }

    /// The model cannot be silent so long.
    fn silence(
        &mut self,
        states: &[PossibleState],
        last: Nanos,
        since: i64,
        event: Option<DepartedEvent>,
    ) -> Result<FollowState, WalkFault> {
        let Some(walk) = &mut self.walk else { return Ok(FollowState::Lost(String::new())) };
        let can = allowed(self.program, &self.model, walk, states, (last, since))?;
        let until = can.silent_until.unwrap_or(last + since);
        Ok(FollowState::Departed(ModelDeparture {
            kind: DepartureKind::Silence,
            time: seconds(until),
            event,
            allowed: can.events,
            silent_until: Some(seconds(until)),
            locations: locations(self.program, &self.model, walk, &can.last),
        }))
    }

    /// The model cannot make this event now.
    fn wrong(
        &mut self,
        states: &[PossibleState],
        (last, since): (Nanos, i64),
        event: Option<DepartedEvent>,
        at: &[PossibleState],
    ) -> Result<FollowState, WalkFault> {
        let ahead = since.saturating_add(farthest(self.program, &self.model));
        let Some(walk) = &mut self.walk else { return Ok(FollowState::Lost(String::new())) };
        // Where it is too much to look so far ahead, what was possible until now is told.
        let can = allowed(self.program, &self.model, walk, states, (last, ahead))
            .or_else(|_| allowed(self.program, &self.model, walk, states, (last, since)))?;
        Ok(FollowState::Departed(ModelDeparture {
            kind: DepartureKind::Event,
            time: seconds(last + since),
            event,
            allowed: can.events,
            silent_until: can.silent_until.map(seconds),
            locations: locations(self.program, &self.model, walk, at),
        }))
    }

    pub(crate) fn finish(mut self, end: Nanos, ended: RunEnd) -> ConformanceVerdict {
        self.rest(end, ended);
        self.verdict(ended)
    }

    fn finish_trail(mut self, end: Nanos, ended: RunEnd) -> (ConformanceVerdict, ModelTrail) {
        self.rest(end, ended);
        let (mut trail, _) = self.trail.take().unwrap_or_default();
        trail.visit(self.walk.take().map(ModelWalk::visited).unwrap_or_default());
        (self.verdict(ended), trail)
    }

    fn verdict(self, ended: RunEnd) -> ConformanceVerdict {
        let name = self.model.name;
        let verdict =
            |outcome, departure| ConformanceVerdict { model: name.clone(), outcome, departure, why: None };
        match self.state {
            FollowState::Departed(departure) => verdict(ConformanceOutcome::Departs, Some(departure)),
            FollowState::Lost(why) => ConformanceVerdict::inconclusive(name, why),
            FollowState::Possible(..) if ended == RunEnd::Error => {
                ConformanceVerdict::inconclusive(name, "the run broke off".to_owned())
            }
            FollowState::Possible(..) => {
                match self.hidden.iter().find(|event| self.model.outputs.contains(event)) {
                    Some(event) => {
                        let event = &self.program.event(*event).name;
                        let why = format!("nothing contradicts it, but {event} is not observed");
                        ConformanceVerdict::inconclusive(name, why)
                    }
                    None => verdict(ConformanceOutcome::Conforms, None),
                }
            }
        }
    }

    /// The silence after the last observation. A run that came to rest would have stayed so until the system's limit.
    fn rest(&mut self, end: Nanos, ended: RunEnd) {
        let end = match ended {
            RunEnd::Error => return,
            RunEnd::Limit => end,
            RunEnd::Quiescent => limit(self.program).map_or(end, |limit| limit.max(end)),
        };
        let FollowState::Possible(states, last) = &mut self.state else { return };
        let (states, last) = (std::mem::take(states), *last);
        let Some(walk) = &mut self.walk else { return };
        let since = (end - last).max(0);
        let state = match walk.after(&states, since) {
            Ok(now) if now.is_empty() => self.silence(&states, last, since, None),
            Ok(now) => Ok(FollowState::Possible(now, end)),
            Err(fault) => Err(fault),
        };
        self.state = state.unwrap_or_else(|fault| FollowState::Lost(fault.sentence()));
    }
}
