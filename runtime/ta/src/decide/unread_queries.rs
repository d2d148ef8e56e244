//! Queries of all kinds without the variables that nothing reads.
//!
//! Let N be the network, and N⁻ that without the assignments to such variables. Each run of N without a fault is one of N⁻, and each maximal
//! one a maximal one: a transition that is possible in N⁻ is possible in N, or is a fault there. So what no run of N⁻ shows none of N does, and
//! a run that N⁻ shows is gone along in N. If that meets a fault, the query is asked of N itself.

use hrdsl_ir::ta::{Query, QueryFormula, QueryKind};

use crate::{
    decide::{
        answer::{QueryAnswer, QueryOptions, QueryVerdict, answer_watched},
        unread::UnreadCounters,
    },
    network::query::StateFormula,
    search::report::SearchProgress,
    witness::{
        error::SearchError,
        retell::{RetoldRun, retell},
        run::WitnessRun,
    },
};

impl UnreadCounters<'_> {
    /// Answers a query for which they were [found](Self::find_for_query), and says whether that was done without them: then their ranges are
    /// a question of its own.
    ///
    /// # Errors
    /// As [`answer`](crate::answer).
    pub fn answer(
        &self,
        query: &Query,
        options: &QueryOptions,
        go_on: &dyn Fn(&SearchProgress<'_>) -> bool,
    ) -> Result<(QueryAnswer, bool), SearchError> {
        let (program, network) = self.scenario();
        let bare = self.bare();
        match answer_watched(&bare, network, query, options, go_on) {
            Ok(mut answer) => {
                // A clock that grows in a loop may be bounded where the loop ends with a fault.
                let is_open = answer.verdict == QueryVerdict::Inconclusive && !answer.extrema.is_empty();
                if !is_open && self.tell_in_full(query, &mut answer, options)? {
                    return Ok((answer, true));
                }
            }
            // It may lie beyond an overflow.
            Err(SearchError::Model { .. }) => {}
            Err(error @ SearchError::Internal(_)) => return Err(error),
        }
        Ok((answer_watched(program, network, query, options, go_on)?, false))
    }

    /// Tells the runs of an answer with all variables; `false`: one of them is none of the network.
    fn tell_in_full(
        &self,
        query: &Query,
        answer: &mut QueryAnswer,
        options: &QueryOptions,
    ) -> Result<bool, SearchError> {
        let (end, all) = held(&query.ask);
        let is_timed = all.iter().any(|f| StateFormula::from(*f).is_timed());
        let end = end.as_ref().map(StateFormula::from);
        let of_bounds = answer.extrema.iter_mut().filter_map(|e| e.run.as_mut());
        for run in answer.run.iter_mut().chain(of_bounds) {
            let told: &mut WitnessRun = run;
            match retell(self.model(), told, end.as_ref(), is_timed, options.timing())? {
                RetoldRun::Run(retold) => *told = retold,
                RetoldRun::Fault(error) => return Err(error),
                RetoldRun::Another => return Ok(false),
            }
        }
        Ok(true)
    }
}

/// What holds at the end of a run that an answer shows, if anything is known to, and all formulas of the query.
fn held(ask: &QueryKind) -> (Option<QueryFormula>, Vec<&QueryFormula>) {
    match ask {
        QueryKind::Possibly(f) | QueryKind::Sup { when: f, .. } | QueryKind::Inf { when: f, .. } => {
            (Some(f.clone()), vec![f])
        }
        QueryKind::Invariantly(f) => (Some(QueryFormula::Not(Box::new(f.clone()))), vec![f]),
        QueryKind::PotentiallyAlways(f) | QueryKind::Eventually(f) => (None, vec![f]),
        QueryKind::LeadsTo(f, g) => (None, vec![f, g]),
    }
}
