//! The values that an edge's selects take, and those that it binds of what it receives.

use hrdsl_ir::{
    ArgPattern, Value,
    ta::{AutomatonVar, ReceiveArg},
};
use smallvec::SmallVec;

/// The values of an edge's selects, then of the parameters it binds.
pub type BinderValues = SmallVec<[Value; 2]>;

/// All combinations of the selects' values, the first select slowest.
pub(crate) fn choices(selects: &[AutomatonVar]) -> Vec<BinderValues> {
    let mut all = vec![BinderValues::new()];
    for s in selects {
        let mut longer = Vec::new();
        for chosen in &all {
            for value in (s.lo..=s.hi).filter_map(|n| s.value(n)) {
                let mut next = chosen.clone();
                next.push(value);
                longer.push(next);
            }
        }
        all = longer;
    }
    all
}

/// Binds an event's arguments to a receiving edge's parameters, if they match.
pub(crate) fn bind(pattern: &[ReceiveArg], args: &[Value], binders: &mut BinderValues) -> bool {
    for (p, &v) in pattern.iter().zip(args) {
        match p {
            ReceiveArg::Match(ArgPattern::Any) => {}
            ReceiveArg::Match(ArgPattern::Is(want)) if want.key() == v.key() => {}
            ReceiveArg::Match(ArgPattern::Is(_)) => return false,
            ReceiveArg::Bind => binders.push(v),
        }
    }
    true
}

/// The least of all combinations of selects; `false`: there is none.
#[inline]
pub(crate) fn first(selects: &[(i64, i64)], out: &mut SmallVec<[i64; 4]>) -> bool {
    out.clear();
    // Most edges have none.
    if selects.is_empty() {
        return true;
    }
    out.extend(selects.iter().map(|s| s.0));
    selects.iter().all(|s| s.0 <= s.1)
}

/// The next combination, the last select fastest.
pub(crate) fn next(selects: &[(i64, i64)], chosen: &mut [i64]) -> bool {
    for (n, s) in chosen.iter_mut().zip(selects).rev() {
        if *n < s.1 {
            *n += 1;
            return true;
        }
        *n = s.0;
    }
    false
}
