//! The search chooses whose time its zones tell: that of all automata, or one for each.
//!
//! Local time stores a zone for each discrete state at least, as common time does, and its steps cost more: it wins where
//! common time keeps several zones of a discrete state, and there it wins by much. So the search begins in common time. If
//! that has shown enough zones of a discrete state, local time is tried for as many transitions, and goes on where it has
//! fewer. What it says of goals that no run meets is a proof. The runs to all others are those of common time, which goes on
//! where it stood, so that witnesses do not depend on the choice. Work is counted in transitions, never in seconds, so that
//! the same is chosen each time.

use crate::{
    local::{LocalPause, LocalSearch, LocalSearchError, LocalSearchOptions},
    network::{model::CompiledNetwork, query::ReachabilityGoal},
    search::{
        options::{SearchOptions, SearchOrder},
        report::{GoalOutcome, SearchCutoff, SearchProgress, SearchReport, SearchStatistics},
        round_search::{RoundSearch, SearchAside},
        start,
    },
    witness::error::SearchError,
};

/// Transitions that the search computes in common time before it asks what local time would do.
const FIRST: usize = 20_000;
/// Zones of a discrete state, in hundredths, from which on local time is tried.
const MANY: usize = 130;
/// Of the zones of a discrete state in common time, in hundredths, local time must have no more than this to go on.
const FEWER: usize = 60;

/// What has become of local time.
enum LocalTrial<'m, 'p> {
    /// It is not used, for this reason.
    Left(String),
    /// It has come to its end.
    Decided(LocalSearch<'m, 'p>, String),
    /// The caller had enough.
    Stopped(LocalSearch<'m, 'p>),
}

/// As [`explore`](super::explore::explore), with zones of whichever time takes fewer.
pub(super) fn explore(
    model: &CompiledNetwork,
    goals: &[ReachabilityGoal],
    options: &SearchOptions,
    go_on: &dyn Fn(&SearchProgress) -> bool,
) -> Result<SearchReport, SearchError> {
    let mut common =
        start::begin(model, goals, options, SearchAside { go_on: Some(go_on), ..SearchAside::default() })?;
    if let Some(end) = rounds(common.as_mut(), FIRST)? {
        let why = format!("one time for all automata: it came to its end within {FIRST} transitions");
        return Ok(SearchReport { chosen: Some(why), ..common.report(end)? });
    }
    let seen = common.statistics();
    let (search, why) = match trial(model, goals, options, seen, go_on) {
        LocalTrial::Left(why) => {
            let end = rounds(common.as_mut(), usize::MAX)?.flatten();
            let why = format!("one time for all automata: {why}");
            return Ok(SearchReport { chosen: Some(why), ..common.report(end)? });
        }
        LocalTrial::Stopped(search) => return search.report(Some(SearchCutoff::Stopped)),
        LocalTrial::Decided(search, why) => (search, why),
    };
    let (unmet, took) = (search.unmet(), search.statistics());
    let both = |own: SearchStatistics, report: SearchReport| SearchReport {
        states_visited: own.visited + took.visited,
        transitions: own.transitions + took.transitions,
        peak_bytes: own.bytes.max(seen.bytes + took.bytes),
        chosen: Some(why.clone()),
        ..report
    };
    if unmet.len() == goals.len() {
        return Ok(both(seen, search.report(None)?));
    }
    common.exclude(&unmet);
    let end = rounds(common.as_mut(), usize::MAX)?.flatten();
    let report = common.report(end)?;
    let mut report = both(common.statistics(), report);
    if end.is_some() {
        // What common time has not come to has a run all the same.
        for (outcome, known) in report.goals.iter_mut().zip(search.report(None)?.goals) {
            if matches!(outcome, GoalOutcome::Inconclusive(_)) {
                *outcome = known;
            }
        }
    }
    Ok(report)
}

/// Goes on until so many transitions were computed, in all; `Some`: to the end, or that of the budget.
fn rounds(search: &mut dyn RoundSearch, until: usize) -> Result<Option<Option<SearchCutoff>>, SearchError> {
    let mut nothing = Vec::new();
    while search.statistics().transitions < until {
        if let std::ops::ControlFlow::Break(end) = search.round(&mut nothing)? {
            return Ok(Some(end));
        }
    }
    Ok(None)
}

/// Zones of a discrete state, in hundredths.
fn crowd(seen: SearchStatistics) -> usize {
    (seen.stored * 100) / seen.discrete_states.max(1)
}

fn trial<'m, 'p>(
    model: &'m CompiledNetwork<'p>,
    goals: &'m [ReachabilityGoal],
    options: &SearchOptions,
    seen: SearchStatistics,
    go_on: &dyn Fn(&SearchProgress) -> bool,
) -> LocalTrial<'m, 'p> {
    let zones = |hundredths: usize| format!("{}.{:02}", hundredths / 100, hundredths % 100);
    let many = crowd(seen);
    if many < MANY {
        return LocalTrial::Left(format!("it keeps {} zones of a discrete state", zones(many)));
    }
    let mut budget = options.budget;
    budget.bytes = budget.bytes.saturating_sub(seen.bytes);
    // Its runs are not shown, so that any order will do: breadth first needs the least memory.
    let alone = LocalSearchOptions {
        order: SearchOrder::Breadth,
        budget,
        threads: options.threads,
        ..LocalSearchOptions::default()
    };
    let begun = LocalSearch::begin(model, goals, &alone).map_err(left);
    let mut search = match begun {
        Ok(search) => search,
        Err(why) => return LocalTrial::Left(why),
    };
    let mut until = seen.transitions;
    loop {
        match search.go(until, go_on) {
            Ok(LocalPause::Ended) => break,
            Ok(LocalPause::Cut(SearchCutoff::Stopped)) => return LocalTrial::Stopped(search),
            Ok(LocalPause::Cut(_)) => {
                return LocalTrial::Left("local time has used up the budget".to_owned());
            }
            Ok(LocalPause::Paused) => {
                let less = crowd(search.statistics());
                if less * 100 > many * FEWER {
                    let (less, many) = (zones(less), zones(many));
                    let why = format!("local time keeps {less} zones of a discrete state, this {many}");
                    return LocalTrial::Left(why);
                }
                until = usize::MAX;
            }
            Err(error) => return LocalTrial::Left(left(error)),
        }
    }
    let less = zones(crowd(search.statistics()));
    let why = format!("local time: {less} zones of a discrete state, {} with one time for all", zones(many));
    LocalTrial::Decided(search, why)
}

/// A fault that local time meets is left to common time, which meets it or has its goals before.
fn left(error: LocalSearchError) -> String {
    match error {
        LocalSearchError::NotApplicable(reason) => format!("local time does not serve: {reason}"),
        LocalSearchError::Search(_) => "the network has a fault".to_owned(),
    }
}
