//! Where a search with one time for all begins: with numbers as narrow as the constants allow.

use crate::{
    network::{
        model::{BoundWidth, CompiledNetwork},
        query::ReachabilityGoal,
    },
    search::{
        options::SearchOptions,
        report::{SearchProgress, SearchReport},
        round_search::{RoundSearch, SearchAside},
        rounds::ZoneGraphSearch,
    },
    witness::error::SearchError,
};

/// With one time for all.
pub(crate) fn explore(
    model: &CompiledNetwork,
    goals: &[ReachabilityGoal],
    options: &SearchOptions,
    go_on: &dyn Fn(&SearchProgress) -> bool,
) -> Result<SearchReport, SearchError> {
    let beside = SearchAside::default();
    match width(model, beside)? {
        BoundWidth::Bits16 => ZoneGraphSearch::<i16>::new(model, goals, options, beside)?.explore(go_on),
        BoundWidth::Bits32 => ZoneGraphSearch::<i32>::new(model, goals, options, beside)?.explore(go_on),
        BoundWidth::Bits64 => ZoneGraphSearch::<i64>::new(model, goals, options, beside)?.explore(go_on),
    }
}

fn width(model: &CompiledNetwork, beside: SearchAside) -> Result<BoundWidth, SearchError> {
    let width = model.reach.width(beside.within.unwrap_or(0));
    width.ok_or_else(|| SearchError::Internal("a time is too great for zones".into()))
}

/// A search to be gone through.
///
/// # Errors
/// If the goals have no meaning.
pub(crate) fn begin<'m>(
    model: &'m CompiledNetwork,
    goals: &'m [ReachabilityGoal],
    options: &SearchOptions,
    beside: SearchAside<'m>,
) -> Result<Box<dyn RoundSearch + 'm>, SearchError> {
    Ok(match width(model, beside)? {
        BoundWidth::Bits16 => Box::new(ZoneGraphSearch::<i16>::new(model, goals, options, beside)?),
        BoundWidth::Bits32 => Box::new(ZoneGraphSearch::<i32>::new(model, goals, options, beside)?),
        BoundWidth::Bits64 => Box::new(ZoneGraphSearch::<i64>::new(model, goals, options, beside)?),
    })
}
