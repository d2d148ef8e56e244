//! Makes a local run a global one: its transitions in the order of their times.

use std::ops::ControlFlow;

use super::{
    refusal::LocalSearchError,
    space::{LocalStateSpace, LocalWorkspace, LocalZoneFilter, clock_bound},
    zone::ClockBound,
};
use crate::{
    network::{
        actions::PathTransition,
        semantics::{EnumerationScratch, FiringOrError},
    },
    witness::error::SearchError,
};

/// Units, then infinitely small steps for strict bounds.
type SeparationTime = (i64, i64);

/// `later ≥ earlier + by`, of transitions counted from 1; 0 is the start.
struct TransitionSeparation {
    later: usize,
    earlier: usize,
    by: SeparationTime,
}

/// The constraints on a path's times, as it goes on.
struct PathClocks<'s, 'm, 'p> {
    space: &'s LocalStateSpace<'m, 'p>,
    constraints: Vec<TransitionSeparation>,
    /// The last transition of each process.
    last: Vec<usize>,
    /// The transition that last set each clock, and what it had then.
    set: Vec<(usize, i64)>,
}

impl PathClocks<'_, '_, '_> {
    fn at_least(&mut self, later: usize, earlier: usize, by: SeparationTime) {
        self.constraints.push(TransitionSeparation { later, earlier, by });
    }

    /// A bound on a clock at the transition `now`.
    fn bound(&mut self, b: &ClockBound, now: usize) {
        let (set, value) = self.set[usize::from(b.clock)];
        let (n, small) = (i64::from(b.bound >> 1), i64::from(b.bound & 1 == 0));
        if b.upper {
            // now - set + value ≺ n
            self.at_least(set, now, (value - n, small));
        } else {
            // set - value - now ≺ n
            self.at_least(now, set, (-n - value, small));
        }
    }

    /// A process goes from its last transition to `now`.
    fn pass(&mut self, state: &mut [i64], process: usize, now: usize) -> Result<(), LocalSearchError> {
        self.at_least(now, self.last[process], (0, 0));
        if process < self.space.model.members.len() {
            if self.space.is_still(state, process) {
                self.at_least(self.last[process], now, (0, 0));
            }
            // INVARIANT: invariants are convex: they hold all the while if they hold at both ends.
            let mut bounds = Vec::new();
            let known = self.space.invariant(process, state, &mut Vec::new(), &mut bounds);
            known.map_err(|_| SearchError::Internal("a path leads through a fault".into()))?;
            for c in &bounds {
                self.bound(&clock_bound(c)?, now);
            }
        }
        self.last[process] = now;
        Ok(())
    }

    /// The transition in `w` is taken.
    fn take(&mut self, w: &LocalWorkspace, state: &mut [i64], now: usize) -> Result<(), LocalSearchError> {
        for &p in &w.who {
            self.pass(state, usize::from(p), now)?;
        }
        w.bounds.iter().for_each(|b| self.bound(b, now));
        let before = self.set.clone();
        for s in &w.sets {
            let by = i64::from(s.by >> 1);
            self.set[usize::from(s.clock)] = match s.from {
                None => (now, by),
                Some(y) => (before[usize::from(y)].0, before[usize::from(y)].1 + by),
            };
        }
        Ok(())
    }
}

/// The path, given by the successors' numbers, as transitions whose times do not go back. If `to_last`, it ends with what
/// is its last transition now: what others did later has no part in that.
///
/// INVARIANT: the sort is stable, and the times of a process do not fall along the path. So each process keeps the order of
/// its transitions, and no transition overtakes one that it depends on: the sorted path has the same end. What happens
/// while a location is committed has one time, so it stays together.
pub(super) fn by_time(
    space: &LocalStateSpace,
    path: &[u32],
    to_last: bool,
) -> Result<Vec<PathTransition>, SearchError> {
    let (taken, constraints) = walk(space, path).map_err(|f| match f {
        LocalSearchError::Search(error) => error,
        LocalSearchError::NotApplicable(why) => SearchError::Internal(why.to_string()),
    })?;
    let times = least(taken.len() + 2, &constraints)
        .ok_or_else(|| SearchError::Internal("the local zones reach a goal that no run reaches".into()))?;
    let last = times.get(taken.len()).copied();
    let mut ordered: Vec<(SeparationTime, PathTransition)> = times.into_iter().skip(1).zip(taken).collect();
    ordered.sort_by_key(|(time, _)| *time);
    if to_last {
        // The sort is stable: of those of its time it is the last.
        ordered.retain(|(time, _)| Some(*time) <= last);
    }
    Ok(ordered.into_iter().map(|(_, taken)| taken).collect())
}

fn walk(
    space: &LocalStateSpace,
    path: &[u32],
) -> Result<(Vec<PathTransition>, Vec<TransitionSeparation>), LocalSearchError> {
    let (mut w, mut scratch) = (LocalWorkspace::default(), EnumerationScratch::default());
    space.start(&mut w)?;
    let mut clocks = PathClocks {
        space,
        constraints: Vec::new(),
        last: vec![0; space.processes.count],
        set: vec![(0, 0); space.clocks()],
    };
    let mut taken = Vec::new();
    for (now, &number) in (1..).zip(path) {
        let (mut state, zone) = (w.effect.target.clone(), w.zone.clone());
        taken.push(advance(space, &mut w, &mut scratch, &mut state, &zone, number)?);
        clocks.take(&w, &mut state, now)?;
    }
    // In the end all have one time.
    for p in 0..space.processes.count {
        clocks.pass(&mut w.effect.target, p, taken.len() + 1)?;
    }
    Ok((taken, clocks.constraints))
}

/// Takes the successor of this number.
fn advance(
    space: &LocalStateSpace,
    w: &mut LocalWorkspace,
    scratch: &mut EnumerationScratch,
    state: &mut [i64],
    zone: &super::zone::LocalZone,
    number: u32,
) -> Result<PathTransition, LocalSearchError> {
    let (before, mut left) = (state.to_vec(), number);
    let mut end = None;
    let may = LocalZoneFilter { zone, processes: &space.processes };
    let _ = space.model.enumerate(state, &may, scratch, &mut |found| {
        match space.found(w, &before, zone, &found, None) {
            Ok(false) => return ControlFlow::Continue(()),
            Ok(true) if left > 0 => {
                left -= 1;
                return ControlFlow::Continue(());
            }
            Ok(true) => {}
            Err(failure) => end = Some(Err(failure)),
        }
        if let (None, FiringOrError::Firing(firing)) = (&end, &found) {
            end = Some(Ok(PathTransition {
                parts: firing.parts.to_vec(),
                medium: firing.medium,
                args: firing.args.to_vec(),
                guard: firing.guard.to_vec(),
                resets: w.effect.resets.clone(),
            }));
        }
        ControlFlow::Break(())
    });
    end.unwrap_or_else(|| {
        Err(SearchError::Internal("a path takes a transition that is not there".into()).into())
    })
}

/// The least times that keep all constraints, from 0 for the start; `None`: there are none.
fn least(count: usize, constraints: &[TransitionSeparation]) -> Option<Vec<SeparationTime>> {
    let mut times = vec![(0, 0); count];
    for _ in 0..=count {
        let mut changed = false;
        for c in constraints {
            let from: SeparationTime = times[c.earlier];
            let at = (from.0 + c.by.0, from.1 + c.by.1);
            if at > times[c.later] {
                if c.later == 0 {
                    return None;
                }
                times[c.later] = at;
                changed = true;
            }
        }
        if !changed {
            return Some(times);
        }
    }
    None
}
