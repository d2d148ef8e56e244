//! `reach each bound` of suites by search: a stimulus just before, at and just after each time that a clock is compared with.
//!
//! # Steps
//! 1. [`sites`] lists the comparisons of clocks with times, each with the location in which it matters, and which stimuli the
//!    environment may do there;
//! 2. for each of them and each of the three times one question is asked: can the automaton be in that location, the clock be
//!    that much, and one of these stimuli be done? Those of a location are decided in one exploration;
//! 3. where the location cannot be kept beyond the bound, the time just after it is that after the edge by which it is left at
//!    the bound: [`after`];
//! 4. the deadlines of requirements are bounds of their [observers](ObservedNetwork), one exploration for each;
//! 5. the stimulus is [done](closing) at the end of the witness, and the interpreter replays the whole.
//!
//! What is chosen is when the environment acts, and never when the system does: that a bound of the robot's is met means that a
//! stimulus comes at that time.

mod after;
mod closing;
mod sites;

use hrdsl_ir::{
    Nanos, Program,
    suite::BoundaryStep,
    ta::{ClockConstraint, ClockOp, LocationId, Network, QueryFormula},
    value::SECOND,
};
use hrdsl_prove::{GoalFate, ObservedNetwork, ProofOptions, SearchWatch, decide, of_formula};
use hrdsl_results::{GoalStatus, SuiteGoalId};
use hrdsl_ta::{SearchError, WitnessRun};

use crate::extract;
use sites::{BoundSite, StimulusEdge};

/// "Just before" and "just after" are so far beside the bound: as the suite says; else a step of the world, between which and the
/// next no code sees anything new; else a millisecond, the finest time that robots' programs count in.
pub fn boundary_step(program: &Program, step: BoundaryStep) -> Nanos {
    let of_world = program.world.as_ref().map(|world| world.step);
    step.by.or(of_world).unwrap_or(SECOND / 1000).max(1)
}

/// A time beside a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundSide {
    Before,
    At,
    After,
}

impl BoundSide {
    pub const ALL: [BoundSide; 3] = [BoundSide::Before, BoundSide::At, BoundSide::After];

    pub fn words(self) -> &'static str {
        match self {
            BoundSide::Before => "just before",
            BoundSide::At => "at it",
            BoundSide::After => "just after",
        }
    }

    fn shift(self, step: Nanos) -> Nanos {
        match self {
            BoundSide::Before => -step,
            BoundSide::At => 0,
            BoundSide::After => step,
        }
    }
}

/// What became of one side of a bound.
pub struct BoundFinding {
    /// In the network.
    pub automaton: usize,
    pub location: LocationId,
    pub side: BoundSide,
    pub id: SuiteGoalId,
    pub status: GoalStatus,
    pub reason: String,
    /// Up to the stimulus, and what that sends.
    pub run: Option<WitnessRun>,
}

/// What became of all bounds of a network.
#[derive(Default)]
pub struct BoundFindings {
    pub findings: Vec<BoundFinding>,
    pub states: usize,
    pub searches: usize,
}

/// Looks for a stimulus beside each bound.
///
/// # Errors
/// If the network is at fault, or the engine contradicts itself.
pub fn decided(
    program: &Program,
    network: &Network,
    step: Nanos,
    settings: &ProofOptions,
) -> Result<BoundFindings, SearchError> {
    let mut all = BoundFindings::default();
    let plain = ObservedNetwork::new(program, network);
    let stimuli = sites::stimuli(program, network);
    let own = sites::of_members(program, network, &stimuli, 0..network.automata.len());
    all.extend(&plain, &own, step, settings)?;
    for monitor in &program.monitors {
        let mut observed = ObservedNetwork::new(program, network);
        // What cannot be judged on a model has no deadline that a run of it meets.
        if observed.add(monitor).is_err() {
            continue;
        }
        let observer = observed.network.automata.len() - 1;
        let members = observer..observer + 1;
        let mut of_requirement = sites::of_members(&observed.program, &observed.network, &stimuli, members);
        // Others make no difference to the requirement.
        of_requirement.retain(|site| site.is_heard);
        if !of_requirement.is_empty() {
            all.extend(&observed, &of_requirement, step, settings)?;
        }
    }
    Ok(all)
}

impl BoundFindings {
    /// One exploration for each location: the times that are asked for are told apart everywhere in the network, and many of them
    /// at once make many zones.
    fn extend(
        &mut self,
        observed: &ObservedNetwork,
        sites: &[BoundSite],
        step: Nanos,
        settings: &ProofOptions,
    ) -> Result<(), SearchError> {
        for of_location in sites.chunk_by(|a, b| (a.member, a.location) == (b.member, b.location)) {
            self.location(observed, of_location, step, settings)?;
        }
        Ok(())
    }

    fn location(
        &mut self,
        observed: &ObservedNetwork,
        sites: &[BoundSite],
        step: Nanos,
        settings: &ProofOptions,
    ) -> Result<(), SearchError> {
        let sides = || sites.iter().flat_map(|site| BoundSide::ALL.map(|side| (site, side)));
        let asked = sides().filter(|(site, side)| site.can_be(side.shift(step))).collect::<Vec<_>>();
        let questions: Vec<_> =
            asked.iter().map(|(site, side)| of_formula(&question(site, side.shift(step)))).collect();
        let watch = SearchWatch::default();
        let decided = decide(&observed.program, observed, &questions, &[], settings, &watch)?;
        self.states += decided.states;
        self.searches += decided.searches;
        for ((site, side), fate) in asked.into_iter().zip(decided.fates) {
            let mut finding = match fate {
                GoalFate::Reached(run) => {
                    site.finding(side, closing::closed(observed, &run.witness, &site.stimuli))
                }
                GoalFate::Inconclusive(why) => site.finding(side, Err(why)),
                GoalFate::Unreachable => BoundFinding {
                    status: GoalStatus::Unreachable,
                    ..site.finding(side, Err(nothing_possible(decided.states)))
                },
            };
            if side == BoundSide::After && finding.status == GoalStatus::Unreachable {
                self.beyond(observed, site, step, settings, &mut finding)?;
            }
            self.findings.push(finding);
        }
        Ok(())
    }

    /// Just after a bound at which the location is left for certain: that much after the edge.
    fn beyond(
        &mut self,
        observed: &ObservedNetwork,
        site: &BoundSite,
        step: Nanos,
        settings: &ProofOptions,
        finding: &mut BoundFinding,
    ) -> Result<(), SearchError> {
        let Some(after) = after::just_after(observed, site, step) else { return Ok(()) };
        let watch = SearchWatch::default();
        let question = [of_formula(&after.question)];
        let decided = decide(&after.observed.program, &after.observed, &question, &[], settings, &watch)?;
        self.states += decided.states;
        self.searches += decided.searches;
        match decided.fates.into_iter().next() {
            Some(GoalFate::Reached(run)) => {
                let closed = closing::closed(&after.observed, &run.witness, &site.stimuli);
                *finding = site.finding(BoundSide::After, closed);
            }
            Some(GoalFate::Inconclusive(why)) => *finding = site.finding(BoundSide::After, Err(why)),
            Some(GoalFate::Unreachable) | None => {}
        }
        Ok(())
    }
}

fn nothing_possible(states: usize) -> String {
    format!(
        "proved: in none of the {states} symbolic states that the model can reach may the environment do anything then"
    )
}

impl BoundSite {
    /// With the run up to the stimulus and what that sends, or why there is none.
    fn finding(&self, side: BoundSide, run: Result<WitnessRun, String>) -> BoundFinding {
        let (status, reason, run) = match run {
            Ok(run) => (GoalStatus::Reached, format!("in {} steps", run.steps.len()), Some(run)),
            Err(why) => (GoalStatus::Inconclusive, why, None),
        };
        BoundFinding {
            automaton: usize::from(self.member),
            location: self.location,
            side,
            id: SuiteGoalId::Bound(format!("{}, {}", self.name, side.words())),
            status,
            reason,
            run,
        }
    }
}

/// The automaton is in the location, its clock is so far from the bound, and a stimulus is possible.
fn question(site: &BoundSite, shift: Nanos) -> QueryFormula {
    let mut bound = site.time.clone();
    bound.nanos += shift;
    let clock = ClockConstraint { clock: site.clock, minus: None, op: ClockOp::Eq, bound };
    QueryFormula::And(vec![
        QueryFormula::At { automaton: site.member, location: site.location },
        QueryFormula::Clock(clock),
        possible(&site.stimuli),
    ])
}

fn possible(stimuli: &[StimulusEdge]) -> QueryFormula {
    QueryFormula::Or(stimuli.iter().map(|s| s.enabled.clone()).collect())
}

/// Why no test is made of a run, if none is: it breaks an assumption, or the stimulus would come late, since one before it holds.
pub fn refused(program: &Program, run: &WitnessRun) -> Option<String> {
    let trace = run.trace();
    if !extract::keeps_assumptions(program, &trace) {
        return Some("the stimulus there would break an assumption".to_owned());
    }
    extract::is_late(program, &trace)
        .then(|| "the stimulus would come late in a test: one before it still holds then".to_owned())
}
