//! Which bounds of a model recordings contradict, and which would fit them.
//!
//! A recording that departs is asked which bound, or two, would have to go for it to get farthest. Of those that it needs to be without, times
//! are tried until the tightest with which it conforms are found. Without these bounds it is followed once more, and the clocks are looked at.

use hrdsl_ir::{Nanos, Program, ta::ClockOp};
use hrdsl_results::{ConformanceOutcome, ConformanceVerdict, ModelPlace};
use hrdsl_trace::{RunEnd, Trace, TraceStepKind};

use crate::{
    ConformanceOptions,
    bounds::{ModelBound, bounds, replaced},
    checker::FollowedModel,
    fitting::{BoundFitting, Loosening},
    model::{SystemModel, system_models},
};

/// A recording: what happened, and how its run ended.
pub type RecordedRun = (Trace, RunEnd);

/// What recordings say of one model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelCalibration {
    /// The automata that play the system, joined by ` | `.
    pub model: String,
    /// By recording, what the model as it stands says.
    pub before: Vec<ConformanceVerdict>,
    /// The bounds that are contradicted, in the order of the text.
    pub contradicted: Vec<ContradictedBound>,
    /// By recording, what the model with the bounds that fit says.
    pub after: Vec<ConformanceVerdict>,
    /// By recording, whether it would conform to the model without any of its bounds.
    pub explicable: Vec<bool>,
}

/// A bound that recordings contradict.
#[derive(Clone, Debug, PartialEq)]
pub struct ContradictedBound {
    /// The edge or location whose bound it is.
    pub place: ModelPlace,
    pub clock: String,
    /// As it stands in the model.
    pub bound: (ClockOp, Nanos),
    /// How many recordings contradict it.
    pub recordings: usize,
    /// How often its clock was looked at.
    pub count: usize,
    /// How often of these its value is known: a silent edge may leave open when it was taken.
    pub known: usize,
    /// The least and the greatest of the known values.
    pub observed: Option<(Nanos, Nanos)>,
    /// What would fit, one comparison or two; none: it would have to go.
    pub fits: Vec<(ClockOp, Nanos)>,
}

/// A bound is contradicted if one in so many of the recordings that depart contradict it.
const RARE: usize = 10;

/// Which bounds of the system's models these recordings contradict, and which would fit.
#[must_use]
pub fn calibrate(
    program: &Program,
    runs: &[RecordedRun],
    options: &ConformanceOptions,
) -> Vec<ModelCalibration> {
    let models = system_models(program).into_iter();
    models.map(|model| ModelRelaxation { program, model, runs, options }.calibrate()).collect()
}

struct ModelRelaxation<'a> {
    program: &'a Program,
    model: SystemModel,
    runs: &'a [RecordedRun],
    options: &'a ConformanceOptions,
}

/// A recording, and the bounds that it needs to be without.
struct RunWitness<'r> {
    run: &'r RecordedRun,
    without: Vec<ModelBound>,
}

/// How far a recording goes with a model: to the end, or how many observations were taken before it departed.
type RunProgress = Option<usize>;

/// Whether the first goes farther.
fn is_farther(new: RunProgress, old: RunProgress) -> bool {
    match (new, old) {
        (_, None) => false,
        (None, Some(_)) => true,
        (Some(new), Some(old)) => new > old,
    }
}

impl ModelRelaxation<'_> {
    fn calibrate(&self) -> ModelCalibration {
        let before = self.verdicts(self.program);
        let all = bounds(self.program, &self.model);
        let mut gone: Vec<ModelBound> = Vec::new();
        for run in self.runs {
            self.relax(run, &all, &mut gone);
        }
        let departing = before.iter().filter(|v| v.outcome == ConformanceOutcome::Departs).count();
        let mut witnesses: Vec<RunWitness> = self.runs.iter().map(|run| self.witness(run, &gone)).collect();
        loop {
            let needed = |bound: &ModelBound| witnesses.iter().filter(|w| w.without.contains(bound)).count();
            let found: Vec<(ModelBound, usize)> =
                all.iter().map(|bound| (bound.clone(), needed(bound))).filter(|(_, n)| *n > 0).collect();
            // What hardly any recording needs is a coincidence: those differ from the model in something else.
            let rare: Vec<&ModelBound> =
                found.iter().filter(|(_, n)| n * RARE < departing).map(|(bound, _)| bound).collect();
            let count = witnesses.len();
            if !rare.is_empty() {
                witnesses.retain(|w| !w.without.iter().any(|bound| rare.contains(&bound)));
                continue;
            }
            let bounds: Vec<ModelBound> = found.iter().map(|(bound, _)| bound.clone()).collect();
            let fitting = BoundFitting::new(self.program, &all, &bounds, self.end());
            let loosened = self.fitted(&fitting, &witnesses);
            let after = self.verdicts(&fitting.applied(&loosened));
            // Nor is one that departs even so a witness of times, unless there is no better one.
            let conforms = |w: &RunWitness| {
                let verdict = self.runs.iter().zip(&after).find(|(run, _)| std::ptr::eq(*run, w.run));
                verdict.is_some_and(|(_, verdict)| verdict.outcome == ConformanceOutcome::Conforms)
            };
            let better = witnesses.iter().filter(|w| conforms(w)).count();
            if better == 0 || better == count {
                let contradicted = self.measured(&found, (&fitting, &loosened), &witnesses);
                let explicable = self.runs.iter().map(|run| self.progress(&all, run).is_none()).collect();
                let model = self.model.name.clone();
                return ModelCalibration { model, before, contradicted, after, explicable };
            }
            witnesses.retain(conforms);
        }
    }

    /// When the last of the recordings ends.
    fn end(&self) -> Nanos {
        self.runs.iter().map(|(trace, _)| trace.end).max().unwrap_or(0)
    }

    /// The tightest bounds with which all of these recordings conform that conform without the bounds they need to be without.
    fn fitted(&self, fitting: &BoundFitting, witnesses: &[RunWitness]) -> Vec<Loosening> {
        let mut joint = fitting.without(&[]);
        let fits = |program: &Program, run: &RecordedRun| self.followed(program, run).is_none();
        for RunWitness { run, without } in witnesses {
            if without.is_empty() || fits(&fitting.applied(&joint), run) {
                continue;
            }
            let gone = fitting.without(without);
            let own = if fits(&fitting.applied(&gone), run) {
                fitting.tightened(gone, &|program| fits(program, run))
            } else {
                // It gets farther without them, and departs later by something else.
                let farthest = self.followed(&fitting.applied(&gone), run);
                fitting.tightened(gone, &|program| !is_farther(farthest, self.followed(program, run)))
            };
            joint = BoundFitting::looser(&joint, &own);
        }
        // One recording may have needed what another one has loosened in another way.
        let whole = fitting.applied(&joint);
        let explained: Vec<&RecordedRun> =
            witnesses.iter().map(|w| w.run).filter(|run| fits(&whole, run)).collect();
        if explained.len() < witnesses.len() {
            return joint;
        }
        fitting.tightened(joint, &|program| explained.iter().all(|run| fits(program, run)))
    }

    /// The recording with those of these bounds without which it gets as far as without all of them.
    fn witness<'r>(&self, run: &'r RecordedRun, gone: &[ModelBound]) -> RunWitness<'r> {
        let reached = self.progress(gone, run);
        let mut without = gone.to_vec();
        // Those that were found last are needed least.
        for bound in gone.iter().rev() {
            let fewer: Vec<ModelBound> = without.iter().filter(|b| *b != bound).cloned().collect();
            if !is_farther(reached, self.progress(&fewer, run)) {
                without = fewer;
            }
        }
        RunWitness { run, without }
    }

    fn verdicts(&self, program: &Program) -> Vec<ConformanceVerdict> {
        let verdict = |(trace, ended): &RecordedRun| {
            let mut follow = FollowedModel::new(program, self.model.clone(), self.options);
            shown(trace, &mut follow);
            follow.finish(trace.end, *ended)
        };
        self.runs.iter().map(verdict).collect()
    }

    fn without(&self, gone: &[ModelBound]) -> Program {
        let all: Vec<_> = gone.iter().map(|bound| (bound.clone(), Vec::new())).collect();
        replaced(self.program, &all)
    }

    fn progress(&self, gone: &[ModelBound], run: &RecordedRun) -> RunProgress {
        self.followed(&self.without(gone), run)
    }

    fn followed(&self, program: &Program, (trace, ended): &RecordedRun) -> RunProgress {
        let mut follow = FollowedModel::new(program, self.model.clone(), self.options);
        shown(trace, &mut follow);
        let observed = follow.observed;
        let verdict = follow.finish(trace.end, *ended);
        // What cannot be followed is no better than what departs.
        match verdict.outcome {
            ConformanceOutcome::Conforms => None,
            ConformanceOutcome::Departs => Some(observed),
            ConformanceOutcome::Inconclusive if *ended == RunEnd::Error => None,
            ConformanceOutcome::Inconclusive => Some(0),
        }
    }

    /// Lets bounds go until the recording conforms, or none would help.
    fn relax(&self, run: &RecordedRun, all: &[ModelBound], gone: &mut Vec<ModelBound>) {
        loop {
            let reached = self.progress(gone, run);
            if reached.is_none() {
                return;
            }
            let left: Vec<&ModelBound> = all.iter().filter(|bound| !gone.contains(bound)).collect();
            let singles = left.iter().map(|bound| vec![(*bound).clone()]);
            let chosen = self.best(run, gone, reached, singles).or_else(|| {
                let pairs = left
                    .iter()
                    .enumerate()
                    .flat_map(|(n, a)| left.iter().skip(n + 1).map(|b| vec![(*a).clone(), (*b).clone()]));
                // An invariant and a guard that say the same of one clock go together.
                let pairs = pairs.filter(|pair| match pair.as_slice() {
                    [a, b] => a.clock == b.clock,
                    _ => false,
                });
                self.best(run, gone, reached, pairs)
            });
            let Some(chosen) = chosen else {
                // Several that are needed at once and help none alone.
                if !left.is_empty() && self.progress(all, run).is_none() {
                    gone.extend(left.into_iter().cloned());
                }
                return;
            };
            gone.extend(chosen);
        }
    }

    /// The first of those without which the recording goes farthest.
    fn best(
        &self,
        run: &RecordedRun,
        gone: &[ModelBound],
        reached: RunProgress,
        candidates: impl Iterator<Item = Vec<ModelBound>>,
    ) -> Option<Vec<ModelBound>> {
        let (mut chosen, mut farthest) = (None, reached);
        for candidate in candidates {
            let progress = self.progress(&[gone, &candidate].concat(), run);
            if is_farther(progress, farthest) {
                (chosen, farthest) = (Some(candidate), progress);
            }
            if farthest.is_none() {
                break;
            }
        }
        chosen
    }

    /// The bounds that are loosened, with the values of their clocks where they were looked at. Each recording is followed without the
    /// bounds that it needs to be without: what fits would tell times that nobody saw.
    fn measured(
        &self,
        found: &[(ModelBound, usize)],
        (fitting, loosened): (&BoundFitting, &[Loosening]),
        witnesses: &[RunWitness],
    ) -> Vec<ContradictedBound> {
        let watched = || found.iter().map(|(bound, _)| bound.watched(self.program, &self.model)).collect();
        let mut samples: Vec<Vec<(Nanos, Option<Nanos>)>> = vec![Vec::new(); found.len()];
        for witness in witnesses {
            let program = self.without(&witness.without);
            let mut follow = FollowedModel::watching(&program, self.model.clone(), self.options, watched());
            shown(&witness.run.0, &mut follow);
            for (bound, least, most) in follow.samples {
                if let Some(of) = samples.get_mut(bound) {
                    of.push((least, most));
                }
            }
        }
        let all = found.iter().zip(&samples).enumerate();
        let contradicted = all.filter(|(at, _)| !fitting.is_kept(*at, loosened));
        contradicted
            .map(|(at, (bound, samples))| {
                self.contradicted(bound, samples, fitting.comparisons(at, loosened))
            })
            .collect()
    }

    fn contradicted(
        &self,
        (bound, recordings): &(ModelBound, usize),
        samples: &[(Nanos, Option<Nanos>)],
        fits: Vec<(ClockOp, Nanos)>,
    ) -> ContradictedBound {
        let (name, origin) = bound.site(self.program);
        let known: Vec<Nanos> =
            samples.iter().filter(|(least, most)| *most == Some(*least)).map(|(least, _)| *least).collect();
        ContradictedBound {
            place: ModelPlace::new(name, origin),
            clock: bound.clock_name(self.program),
            bound: (bound.op, bound.time),
            recordings: *recordings,
            count: samples.len(),
            known: known.len(),
            observed: known.iter().min().copied().zip(known.iter().max().copied()),
            fits,
        }
    }
}

fn shown(trace: &Trace, follow: &mut FollowedModel) {
    for (index, step) in trace.steps.iter().enumerate() {
        match &step.what {
            TraceStepKind::Event { event, args } => follow.event(index, step.time, (*event, args)),
            TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => {}
        }
    }
}
