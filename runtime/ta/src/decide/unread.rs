//! Counters that nobody reads: variables that nothing but their own assignments looks at, and that may leave their ranges.
//!
//! They change nothing of what can happen before such a fault. So goals are looked for in the network without them, in which the
//! same runs exist, and those besides that a fault would have ended. What no run reaches there is unreachable; a run that is
//! found is gone along in the network itself. If it meets the fault, another run is looked for in the network in which
//! transitions with the fault do not exist. If there is none, the goal is reached beyond the fault alone, and the fault is the
//! answer. Whether such a variable can leave its range at all is a question of its own, and is answered beside the goals. The
//! same is said, for people, in `spec/search.md`.

use std::collections::BTreeSet;

use hrdsl_ir::{
    Program,
    ta::{Network, QueryFormula, QueryKind, QueryMeasure},
};

use crate::{
    decide::{
        explore::explore,
        fastest::fastest,
        places::{each_place, of_expression},
    },
    network::{
        error::ModelError,
        model::{CompiledNetwork, ObservationOptions, OverflowTreatment, OverflowWatch},
        parts::EdgeUpdate,
        query::{GoalKind, ReachabilityGoal, SearchBudget, StateFormula},
    },
    search::{
        goals::CompiledGoals,
        options::{SearchOptions, SearchOrder, TimeFrame},
        report::{GoalOutcome, SearchCutoff, SearchProgress, SearchReport, SearchStatistics, WidestVariable},
        slice,
    },
    witness::{build, error::SearchError, run::WitnessRun, schedule::ScheduleOptions},
};

/// Whether variables that nothing reads stay in their ranges.
#[derive(Clone, Debug)]
pub struct RangeAnswer {
    /// Their slots.
    pub slots: Vec<usize>,
    /// Their names: more than one if they are computed from each other.
    pub variables: Vec<String>,
    pub finding: RangeFinding,
    /// Of the search for it, if it came to an end.
    pub statistics: Option<SearchStatistics>,
}

/// What is known of the ranges of variables.
#[derive(Clone, Debug)]
pub enum RangeFinding {
    /// In each run.
    Kept,
    /// Not in this one, which leads to the fault.
    Left { error: ModelError, run: Box<WitnessRun> },
    /// The budget was used up first.
    Inconclusive { cutoff: SearchCutoff, widest: Option<WidestVariable> },
    /// Each run that was found to it comes to this fault before.
    Behind(ModelError),
}

/// The variables of a network that nothing reads and that may leave their ranges.
pub struct UnreadCounters<'p> {
    program: &'p Program,
    network: &'p Network,
    observe: ObservationOptions,
    model: CompiledNetwork<'p>,
    /// Those that have to do with each other.
    groups: Vec<UnreadGroup>,
    assignments: Vec<UnreadAssignment>,
}

/// Variables that are computed from each other.
struct UnreadGroup {
    /// By place of the state.
    places: BTreeSet<u32>,
    /// The slots of those that may leave their ranges.
    slots: Vec<usize>,
}

/// An update that sets such variables.
struct UnreadAssignment {
    member: usize,
    edge: usize,
    update: usize,
    /// What it sets, and what of their kind it reads.
    places: BTreeSet<u32>,
    /// Of what it sets, what may leave its range.
    risky: bool,
    targets: BTreeSet<u32>,
}

impl<'p> UnreadCounters<'p> {
    /// `None`: there are none, or clocks stand still, or the network is observed in a way that sees assignments.
    ///
    /// # Errors
    /// If the program is malformed or the goals have no meaning.
    pub fn find(
        program: &'p Program,
        network: &'p Network,
        observe: &ObservationOptions,
        goals: &[ReachabilityGoal],
    ) -> Result<Option<Self>, ModelError> {
        let model = CompiledNetwork::new(program, network, observe)?;
        if model.uses || model.stops() {
            return Ok(None);
        }
        let compiled = CompiledGoals::new(&model, goals)?;
        let read = slice::read(&model, &compiled, &[]);
        let found = Self::beside(program, network, observe.clone(), model, &read);
        Ok(Some(found).filter(|found| !found.groups.is_empty()))
    }

    /// As [`find`](Self::find), for a query of any kind. A query about whole runs is searched without variables that never leave their
    /// ranges, too, if nothing reads them: its search does not leave them out by itself.
    ///
    /// # Errors
    /// If the program is malformed.
    pub fn find_for_query(
        program: &'p Program,
        network: &'p Network,
        ask: &QueryKind,
    ) -> Result<Option<Self>, ModelError> {
        let (formulas, measures, about_runs) = parts(ask);
        let observe = ObservationOptions { formulas: formulas.clone(), ..ObservationOptions::default() };
        let model = CompiledNetwork::new(program, network, &observe)?;
        if model.stops() {
            return Ok(None);
        }
        let mut asked = Vec::new();
        formulas.iter().for_each(|f| each_place(&model, &StateFormula::from(f), &mut |i| asked.push(i)));
        for measure in measures {
            if let QueryMeasure::Data(e) = measure {
                of_expression(&model, e, &mut |i| asked.push(i));
            }
        }
        let read = slice::read(&model, &CompiledGoals::new(&model, &[])?, &asked);
        let found = Self::beside(program, network, observe, model, &read);
        let some = |found: &Self| !found.groups.is_empty() || (about_runs && !found.assignments.is_empty());
        Ok(Some(found).filter(some))
    }

    /// What is not read.
    fn beside(
        program: &'p Program,
        network: &'p Network,
        observe: ObservationOptions,
        model: CompiledNetwork<'p>,
        read: &[bool],
    ) -> Self {
        let assignments = assignments(&model, read);
        let groups = groups(&model, &assignments);
        Self { program, network, observe, model, groups, assignments }
    }

    /// The network with all its variables, of which the witnesses are runs.
    #[must_use]
    pub fn model(&self) -> &CompiledNetwork<'p> {
        &self.model
    }

    /// Decides the goals, and then of each of the variables whether it stays in its range.
    ///
    /// # Errors
    /// If a fault is met that is none of these variables, or a goal is reached beyond such a fault alone; or the engine contradicts itself.
    pub fn explore(
        &self,
        goals: &[ReachabilityGoal],
        options: &SearchOptions,
        go_on: &dyn Fn(&SearchProgress<'_>) -> bool,
    ) -> Result<(SearchReport, Vec<RangeAnswer>), SearchError> {
        let Some(report) = self.goals(goals, options, go_on)? else {
            // A fault that is another's: with all variables it is met as it would be without this.
            return Ok((explore(&self.model, goals, options, go_on)?, Vec::new()));
        };
        Ok((report, self.ranges(options, &[], go_on)?))
    }

    /// Decides of each of the variables whether it stays in its range, but for those that are known already, by their slots.
    ///
    /// # Errors
    /// If the engine contradicts itself.
    pub fn ranges(
        &self,
        options: &SearchOptions,
        known: &[usize],
        go_on: &dyn Fn(&SearchProgress<'_>) -> bool,
    ) -> Result<Vec<RangeAnswer>, SearchError> {
        let open = |group: &&UnreadGroup| group.slots.iter().any(|slot| !known.contains(slot));
        self.groups.iter().filter(open).map(|group| self.range(group, known, options, go_on)).collect()
    }

    /// A run that meets a goal as early as any, given one that meets it; `None`: it is not known to be found.
    ///
    /// # Errors
    /// As [`fastest`].
    pub fn fastest(
        &self,
        goal: &ReachabilityGoal,
        known: &WitnessRun,
        budget: SearchBudget,
        timing: ScheduleOptions,
    ) -> Result<Option<Box<WitnessRun>>, SearchError> {
        let program = self.bare();
        let bare = CompiledNetwork::new(&program, self.network, &self.observe)?;
        match fastest(&bare, goal, known, budget, timing) {
            Ok(None) => return Ok(None),
            Ok(Some(run)) => {
                if let (path, None) = build::path_of(&self.model, &run)? {
                    let timing = ScheduleOptions { prompt: true, ..timing };
                    return build::witness(&self.model, path, Some(goal), timing)
                        .map(|run| Some(Box::new(run)));
                }
            }
            // It may lie beyond an overflow.
            Err(SearchError::Model { .. }) => {}
            Err(error @ SearchError::Internal(_)) => return Err(error),
        }
        fastest(&self.careful()?, goal, known, budget, timing)
    }

    /// The network in which a transition that leaves a range does not exist.
    fn careful(&self) -> Result<CompiledNetwork<'p>, ModelError> {
        let slots = self.groups.iter().flat_map(|g| &g.slots).copied().collect();
        CompiledNetwork::new(self.program, self.network, &self.watched(slots, OverflowTreatment::Avoided))
    }

    /// The program without the assignments to variables that nothing reads.
    pub(super) fn bare(&self) -> Program {
        self.without(|_| true)
    }

    pub(super) fn scenario(&self) -> (&'p Program, &'p Network) {
        (self.program, self.network)
    }

    /// `None`: the network has a fault that is another's.
    fn goals(
        &self,
        goals: &[ReachabilityGoal],
        options: &SearchOptions,
        go_on: &dyn Fn(&SearchProgress<'_>) -> bool,
    ) -> Result<Option<SearchReport>, SearchError> {
        let program = self.bare();
        let bare = CompiledNetwork::new(&program, self.network, &self.observe)?;
        let mut report = match explore(&bare, goals, options, go_on) {
            Ok(report) => report,
            Err(SearchError::Model { .. }) => return Ok(None),
            Err(error @ SearchError::Internal(_)) => return Err(error),
        };
        let mut doubtful: Vec<(usize, SearchError)> = Vec::new();
        for (i, (goal, outcome)) in goals.iter().zip(&mut report.goals).enumerate() {
            let GoalOutcome::Reached(run) = outcome else { continue };
            match build::path_of(&self.model, run)? {
                (path, None) => {
                    let timing = ScheduleOptions::default();
                    **run = build::witness(&self.model, path, Some(goal), timing)?;
                }
                (path, Some(fault)) => doubtful.push((i, self.fault(path, fault))),
            }
        }
        if !doubtful.is_empty() {
            self.before_overflow(goals, doubtful, &mut report, options, go_on)?;
        }
        Ok(Some(report))
    }

    /// Looks for runs to these goals along which nothing leaves its range.
    fn before_overflow(
        &self,
        goals: &[ReachabilityGoal],
        doubtful: Vec<(usize, SearchError)>,
        report: &mut SearchReport,
        options: &SearchOptions,
        go_on: &dyn Fn(&SearchProgress<'_>) -> bool,
    ) -> Result<(), SearchError> {
        let careful = self.careful()?;
        let asked: Vec<ReachabilityGoal> = doubtful.iter().map(|(i, _)| goals[*i].clone()).collect();
        let options = SearchOptions { time: TimeFrame::Common, ..*options };
        let again = explore(&careful, &asked, &options, go_on)?;
        report.states_visited += again.states_visited;
        report.transitions += again.transitions;
        report.peak_bytes = report.peak_bytes.max(again.peak_bytes);
        for ((i, fault), outcome) in doubtful.into_iter().zip(again.goals) {
            report.goals[i] = match outcome {
                GoalOutcome::Reached(_) | GoalOutcome::Inconclusive(SearchCutoff::Stopped) => outcome,
                // That the model is at fault is certain, whatever else may be found.
                GoalOutcome::Unreachable | GoalOutcome::Inconclusive(_) => return Err(fault),
            };
        }
        Ok(())
    }

    /// Whether variables stay in their ranges, of which some may be known to.
    fn range(
        &self,
        group: &UnreadGroup,
        known: &[usize],
        options: &SearchOptions,
        go_on: &dyn Fn(&SearchProgress<'_>) -> bool,
    ) -> Result<RangeAnswer, SearchError> {
        let program = self.without(|a| a.places.is_disjoint(&group.places));
        let observe = self.watched(group.slots.clone(), OverflowTreatment::Sought);
        let model = CompiledNetwork::new(&program, self.network, &observe)?;
        // What counts farthest comes first, and with it the fault, if there is one.
        let options = SearchOptions {
            order: SearchOrder::Topological,
            time: TimeFrame::Common,
            keep_shorter: false,
            ..*options
        };
        // Nothing meets it: the search goes on to its end.
        let never =
            ReachabilityGoal { what: GoalKind::Condition(StateFormula::Or(Vec::new())), settled: false };
        let (finding, statistics) = match explore(&model, &[never], &options, go_on) {
            Ok(report) => {
                let statistics = report.statistics();
                let finding = match report.goals.into_iter().next() {
                    Some(GoalOutcome::Inconclusive(cutoff)) => {
                        RangeFinding::Inconclusive { cutoff, widest: report.widest }
                    }
                    Some(GoalOutcome::Unreachable) => RangeFinding::Kept,
                    Some(GoalOutcome::Reached(_)) | None => {
                        return Err(SearchError::Internal("what never holds is reached".into()));
                    }
                };
                (finding, Some(statistics))
            }
            Err(SearchError::Model { error, witness: Some(run) }) => (self.left(group, error, &run)?, None),
            Err(error) => return Err(error),
        };
        let mut slots = group.slots.clone();
        if matches!(finding, RangeFinding::Kept) {
            slots.retain(|slot| !known.contains(slot));
        }
        let variables = slots.iter().map(|s| self.model.slot_name(*s)).collect();
        Ok(RangeAnswer { slots, variables, finding, statistics })
    }

    /// What a run to a fault, found without the other variables, is in the network itself.
    fn left(
        &self,
        group: &UnreadGroup,
        error: ModelError,
        run: &WitnessRun,
    ) -> Result<RangeFinding, SearchError> {
        let (path, earlier) = build::path_of(&self.model, run)?;
        let error = earlier.unwrap_or(error);
        if !self.is_of(group, &error) {
            return Ok(RangeFinding::Behind(error));
        }
        let (run, others) = build::fault_among_others(&self.model, path, &error)?;
        if let Some(run) = run {
            return Ok(RangeFinding::Left { error, run: Box::new(run) });
        }
        // In the same transition another of the variables that were left out leaves its range first.
        let before = others.into_iter().find(|e| !self.is_of(group, e));
        before.map(RangeFinding::Behind).ok_or_else(|| {
            SearchError::Internal(format!("a fault is met without other variables alone: {error}"))
        })
    }

    fn fault(&self, path: Vec<crate::network::actions::PathTransition>, error: ModelError) -> SearchError {
        build::fault_after(&self.model, path.into_iter().map(std::rc::Rc::new), error)
    }

    /// Whether the fault is that one of these variables leaves its range.
    fn is_of(&self, group: &UnreadGroup, error: &ModelError) -> bool {
        let ModelError::Range { edge, variable, .. } = error else { return false };
        let own = format!("{}.{variable}", edge.automaton);
        let names = group.slots.iter().map(|s| self.model.slot_name(*s));
        names.into_iter().any(|name| name == *variable || name == own)
    }

    /// The program without some of these assignments.
    fn without(&self, some: impl Fn(&UnreadAssignment) -> bool) -> Program {
        let mut program = self.program.clone();
        // From the last, so that the numbers of those before it stay.
        for a in self.assignments.iter().rev().filter(|a| some(a)) {
            let id = self.network.automata.get(a.member).map(|id| usize::from(id.0));
            let automaton = id.and_then(|id| program.automata.get_mut(id));
            if let Some(edge) = automaton.and_then(|automaton| automaton.edges.get_mut(a.edge)) {
                edge.updates.remove(a.update);
            }
        }
        program
    }

    fn watched(&self, slots: Vec<usize>, treatment: OverflowTreatment) -> ObservationOptions {
        ObservationOptions { overflow: OverflowWatch { slots, treatment }, ..self.observe.clone() }
    }
}

/// The formulas of a query, its measures, and whether it is about whole runs.
fn parts(ask: &QueryKind) -> (Vec<QueryFormula>, &[QueryMeasure], bool) {
    match ask {
        QueryKind::Possibly(f) | QueryKind::Invariantly(f) => (vec![f.clone()], &[], false),
        QueryKind::PotentiallyAlways(f) | QueryKind::Eventually(f) => (vec![f.clone()], &[], true),
        QueryKind::LeadsTo(f, g) => (vec![f.clone(), g.clone()], &[], true),
        QueryKind::Sup { of, when } | QueryKind::Inf { of, when } => (vec![when.clone()], of, false),
    }
}

/// The assignments to variables that nothing reads.
fn assignments(model: &CompiledNetwork, read: &[bool]) -> Vec<UnreadAssignment> {
    let mut all = Vec::new();
    for (member, of) in model.members.iter().enumerate() {
        for (edge, arrow) in of.edges.iter().enumerate() {
            for (update, what) in arrow.updates.iter().enumerate() {
                let EdgeUpdate::Assign(place, value) = what else { continue };
                let mut targets = BTreeSet::new();
                place.targets(&mut |i| {
                    targets.insert(i);
                });
                if targets.iter().any(|i| read[*i as usize]) {
                    continue;
                }
                let mut places = targets.clone();
                let mut note = |i: u32| {
                    if !read[i as usize] {
                        places.insert(i);
                    }
                };
                value.each_var(&model.library, &mut note);
                place.indices.iter().for_each(|i| i.0.each_var(&model.library, &mut note));
                let span = value.span(&model.library, &arrow.locals(&model.library));
                let risky = !slice::fits(&model.library, place, span);
                all.push(UnreadAssignment { member, edge, update, places, risky, targets });
            }
        }
    }
    all
}

/// What hangs together, as far as something of it may leave its range.
fn groups(model: &CompiledNetwork, assignments: &[UnreadAssignment]) -> Vec<UnreadGroup> {
    let mut groups: Vec<BTreeSet<u32>> = Vec::new();
    for a in assignments {
        let (mut with, apart): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|group| !group.is_disjoint(&a.places));
        with.push(a.places.clone());
        groups = apart;
        groups.push(with.into_iter().flatten().collect());
    }
    let risky: BTreeSet<u32> =
        assignments.iter().filter(|a| a.risky).flat_map(|a| &a.targets).copied().collect();
    let slot = |place: &u32| (*place as usize).checked_sub(model.members.len());
    let group = |places: BTreeSet<u32>| {
        let slots: Vec<usize> = places.intersection(&risky).filter_map(slot).collect();
        (!slots.is_empty()).then_some(UnreadGroup { places, slots })
    };
    let mut groups: Vec<UnreadGroup> = groups.into_iter().filter_map(group).collect();
    groups.sort_by(|a, b| a.slots.cmp(&b.slots));
    groups
}
