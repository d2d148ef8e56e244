//! Probabilistic branches (`branchpoint`): a transition to one goes on, in the same moment, to one of those that it leads to.
//!
//! Which is likelier is a question of statistical model checking. To the model checker, as to a scenario, each may be taken: so each
//! transition into a branchpoint becomes as many as the branches that lead out of it.

use std::collections::BTreeSet;

use hrdsl_source::Span;

use super::{fault::UppaalFault, lex::UppaalFragment, xml::UppaalTransition};

/// Where a transition begins or ends.
#[derive(Clone, Debug)]
pub enum TransitionEnd {
    Location(usize),
    /// A branchpoint, by its id.
    Branchpoint(String),
}

/// The branchpoints of a template, and the transitions to and from them, whose ends there count nothing.
#[derive(Debug, Default)]
pub struct BranchingTransitions {
    pub points: BTreeSet<String>,
    into: Vec<(String, Span, UppaalTransition)>,
    out_of: Vec<(String, UppaalTransition)>,
}

impl BranchingTransitions {
    /// Keeps a transition that has such an end; gives back any other.
    pub fn keep(
        &mut self,
        ends: (TransitionEnd, TransitionEnd),
        span: Span,
        transition: UppaalTransition,
    ) -> Result<Option<UppaalTransition>, UppaalFault> {
        let fault = |message: &str| Err(UppaalFault { span, message: message.to_owned() });
        match ends {
            (TransitionEnd::Location(from), TransitionEnd::Location(to)) => {
                return Ok(Some(UppaalTransition { from, to, ..transition }));
            }
            (TransitionEnd::Location(from), TransitionEnd::Branchpoint(to)) => {
                self.into.push((to, span, UppaalTransition { from, ..transition }));
            }
            (TransitionEnd::Branchpoint(from), TransitionEnd::Location(to)) => {
                let asks = [&transition.select, &transition.guard, &transition.sync];
                if !asks.iter().all(|label| label.is_blank()) {
                    return fault(
                        "a branch has assignments only: what it asks stands before the branchpoint",
                    );
                }
                self.out_of.push((from, UppaalTransition { to, ..transition }));
            }
            (TransitionEnd::Branchpoint(_), TransitionEnd::Branchpoint(_)) => {
                return fault("a branch leads to a location, and not to another branchpoint");
            }
        }
        Ok(None)
    }

    /// Each transition into a branchpoint with each branch out of it.
    pub fn joined(self) -> Result<Vec<UppaalTransition>, Vec<UppaalFault>> {
        let (mut joined, mut faults) = (Vec::new(), Vec::new());
        for (point, span, first) in &self.into {
            let branches = self.out_of.iter().filter(|(from, _)| from == point);
            let before = joined.len();
            joined.extend(branches.map(|(_, second)| first.then(second)));
            if joined.len() == before {
                faults.push(UppaalFault {
                    span: *span,
                    message: "no branch leads out of this branchpoint".to_owned(),
                });
            }
        }
        if faults.is_empty() { Ok(joined) } else { Err(faults) }
    }
}

impl UppaalTransition {
    /// This one, and in the same moment what another assigns on the way to where it leads.
    fn then(&self, branch: &UppaalTransition) -> UppaalTransition {
        let comments = [&self.comment, &branch.comment].into_iter().filter(|comment| !comment.is_empty());
        UppaalTransition {
            from: self.from,
            to: branch.to,
            select: self.select.clone(),
            guard: self.guard.clone(),
            sync: self.sync.clone(),
            assign: listed(&self.assign, &branch.assign),
            probability: branch.probability.clone(),
            uncontrollable: self.uncontrollable,
            comment: comments.cloned().collect::<Vec<_>>().join("\n"),
        }
    }
}

/// Two lists as one.
fn listed(first: &UppaalFragment, second: &UppaalFragment) -> UppaalFragment {
    if first.is_blank() || second.is_blank() {
        return if first.is_blank() { second.clone() } else { first.clone() };
    }
    let mut both = first.clone();
    both.chars.push((second.span().start, ','));
    both.chars.extend(&second.chars);
    both.end = second.end;
    both
}
