//! Functions of automata while they are checked: what each calls.

use std::collections::BTreeMap;

use hrdsl_source::Span;

use crate::FunctionId;

/// What is known of functions while they are checked.
#[derive(Default)]
pub(crate) struct FunctionCalls {
    /// The function whose body is being checked.
    pub open: Option<FunctionId>,
    /// By function: what its body calls, and where.
    pub calls: BTreeMap<u16, Vec<(FunctionId, Span)>>,
    /// Calls in places where nothing may change.
    pub only_read: Vec<(FunctionId, Span)>,
}
