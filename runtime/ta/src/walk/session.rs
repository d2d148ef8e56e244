//! A walk with its history: what was taken and when, one step back, by chance, and the run that it is.

use std::rc::Rc;

use hrdsl_ir::{Nanos, Program, ta::Network};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    network::{actions::PathTransition, error::ModelError, graph::ZoneGraph},
    walk::{
        follow::{FollowDeparture, FollowTrail, RecordedTime, RecordedWalk},
        state::{MomentRange, NetworkWalk, WalkOption, WalkState},
    },
    witness::{
        build::{PathSegment, concrete},
        error::SearchError,
        run::{RunEnding, WitnessRun},
        schedule::ScheduleOptions,
    },
    zone::{constraint::DifferenceConstraint, dbm::DbmBound},
};

/// A walk through a network, from its start to where it is.
pub struct WalkSession<'p> {
    pub walk: NetworkWalk<'p>,
    start: WalkState,
    taken: Vec<TakenTransition>,
    rng: ChaCha8Rng,
}

/// A transition of the walk.
struct TakenTransition {
    taken: Rc<PathTransition>,
    /// The moment, if it was chosen.
    when: Option<MomentRange>,
    next: WalkState,
}

impl<'p> WalkSession<'p> {
    /// # Errors
    /// If the network cannot be walked through, or its start is a fault.
    pub fn new(program: &'p Program, network: &'p Network, seed: u64) -> Result<Self, ModelError> {
        let walk = NetworkWalk::new(program, network)?;
        let start = walk.start()?;
        Ok(Self { walk, start, taken: Vec::new(), rng: ChaCha8Rng::seed_from_u64(seed) })
    }

    /// Where it is.
    #[must_use]
    pub fn state(&self) -> &WalkState {
        self.taken.last().map_or(&self.start, |t| &t.next)
    }

    /// How many transitions led here.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.taken.len()
    }

    /// What can happen now or later.
    #[must_use]
    pub fn options(&self) -> Vec<WalkOption> {
        self.walk.options(self.state())
    }

    /// Takes one of the [`options`](Self::options), by its place among them, perhaps at a certain moment since the start.
    ///
    /// # Errors
    /// Why it cannot be taken, or not then.
    pub fn take(&mut self, choice: usize, at: Option<Nanos>) -> Result<(), String> {
        let when = at.map(|t| MomentRange { from: t, after: false, until: Some(t), before: false });
        self.take_within(choice, when)
    }

    /// As [`take`](Self::take), at some moment of a range.
    ///
    /// # Errors
    /// Why it cannot be taken, or not then.
    pub fn take_within(&mut self, choice: usize, when: Option<MomentRange>) -> Result<(), String> {
        let options = self.options();
        let Some(option) = options.get(choice) else {
            return Err(match options.len() {
                0 => "nothing can happen here".to_owned(),
                1 => "only 1 can happen here".to_owned(),
                n => format!("only 1 to {n} can happen here"),
            });
        };
        if let Some(fault) = &option.fault {
            return Err(format!("it is a fault of the model: {fault}"));
        }
        let option = match &when {
            None => option.clone(),
            Some(moment) => {
                let there = self.walk.at(self.state(), moment).map(|state| self.walk.options(&state));
                let same =
                    |o: &WalkOption| o.told.parts == option.told.parts && o.told.over == option.told.over;
                let found = there.into_iter().flatten().find(same);
                found.ok_or_else(|| format!("it can be taken at {} only", option.time))?
            }
        };
        let Some(next) = option.next else { return Err("it leads nowhere".to_owned()) };
        self.taken.push(TakenTransition { taken: option.transition.action.taken, when, next });
        Ok(())
    }

    /// Takes one of those that are no fault, each with the same chance. `None`: nothing can happen.
    pub fn take_any(&mut self) -> Option<WalkOption> {
        let options = self.options();
        let sound: Vec<usize> = (0..options.len()).filter(|i| options[*i].fault.is_none()).collect();
        if sound.is_empty() {
            return None;
        }
        let choice = sound[self.rng.random_range(0..sound.len())];
        self.take(choice, None).ok()?;
        options.into_iter().nth(choice)
    }

    /// From the start along a recorded run, as far as the network goes along. Where several transitions are what was recorded, one of those
    /// that lead on is taken.
    ///
    /// Gives where the run leaves the network, if it does.
    ///
    /// # Errors
    /// As [`follow`](crate::follow).
    pub fn replay(&mut self, run: &RecordedWalk) -> Result<Option<Box<FollowDeparture>>, ModelError> {
        let trail = FollowTrail::new(&self.walk, run)?;
        let times = run.steps.iter().map(|step| step.time.map(RecordedTime::range));
        let steps = trail.path().into_iter().zip(times);
        self.taken = steps.map(|((taken, next), when)| TakenTransition { taken, when, next }).collect();
        Ok(trail.leaves)
    }

    /// One transition back; `false`: it is at the start.
    pub fn undo(&mut self) -> bool {
        self.taken.pop().is_some()
    }

    /// Back to the start.
    pub fn restart(&mut self) {
        self.taken.clear();
    }

    /// The walk as a run: each transition at the moment that was chosen, or else as early as the others let it be.
    ///
    /// # Errors
    /// If the interpreter does not believe it.
    pub fn run(&self) -> Result<WitnessRun, SearchError> {
        let graph = ZoneGraph::new(&self.walk.model, &[])?;
        let stop = |t: &TakenTransition| PathSegment::Take {
            taken: Rc::clone(&t.taken),
            before: t.when.iter().flat_map(|when| self.moment(when)).collect(),
            after: Vec::new(),
        };
        let stops: Vec<PathSegment> = self.taken.iter().map(stop).collect();
        concrete(&graph, &stops, RunEnding::Reached, None, ScheduleOptions::default())
    }

    /// A range of moments as bounds on the time since the start.
    fn moment(&self, when: &MomentRange) -> Vec<DifferenceConstraint> {
        // INVARIANT: the path's schedule numbers that time as the walk does, after the clocks of the network.
        let now = u16::try_from(self.walk.now()).unwrap_or(u16::MAX);
        let bound = |value: i64, strict: bool| if strict { DbmBound::lt(value) } else { DbmBound::le(value) };
        let least = DifferenceConstraint { i: 0, j: now, bound: bound(-when.from, when.after) };
        let most = when.until.map(|t| DifferenceConstraint { i: now, j: 0, bound: bound(t, when.before) });
        std::iter::once(least).chain(most).collect()
    }
}
