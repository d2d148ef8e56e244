//! Selection of a plan: the first relevant one whose context has an answer in the belief base.

use hrdsl_ir::{
    Value,
    bdi::{Context, TriggerOn},
    expr::EvalError,
};

use crate::{
    belief::BeliefBase,
    plan::Library,
    unify::{Slot, Trail, eval, undo, unify_all, well_bound},
};

/// Space for a selection, kept between selections.
#[derive(Debug, Default)]
pub(crate) struct Selector {
    /// The variables of the selected plan.
    pub slots: Vec<Slot>,
    pub trail: Trail,
    /// Plans that could not be tried because an expression had no value.
    pub faults: Vec<(u16, EvalError)>,
}

impl Selector {
    /// The first applicable plan, its variables bound in `slots`.
    pub fn select(
        &mut self,
        library: &Library,
        beliefs: &BeliefBase,
        on: TriggerOn,
        args: &[Option<Value>],
    ) -> Option<u16> {
        for &index in library.relevant(on) {
            let plan = library.plan(index);
            self.slots.clear();
            self.slots.resize(plan.vars.len(), None);
            self.trail.clear();
            let mut search = Search { beliefs, slots: &mut self.slots, trail: &mut self.trail };
            let applicable = well_bound(&plan.trigger.args, search.slots)
                .and_then(|()| {
                    unify_all(&plan.trigger.args, args.iter().copied(), search.slots, search.trail)
                })
                .and_then(|relevant| Ok(relevant && search.solve(&plan.context, None)?));
            match applicable {
                Ok(true) => return Some(index),
                Ok(false) => {}
                Err(error) => self.faults.push((index, error)),
            }
        }
        None
    }
}

/// A depth-first search for the first answer of a context.
struct Search<'a> {
    beliefs: &'a BeliefBase,
    slots: &'a mut [Slot],
    trail: &'a mut Trail,
}

/// What is left to solve: the rest of a conjunction, then what follows that.
struct Rest<'c> {
    all: &'c [Context],
    next: Option<&'c Rest<'c>>,
}

impl Search<'_> {
    /// Solves the formula and then the rest. On success the bindings of the first answer stay; otherwise none do.
    fn solve(&mut self, context: &Context, rest: Option<&Rest>) -> Result<bool, EvalError> {
        match context {
            Context::True => self.go_on(rest),
            Context::Belief { belief, args } => {
                well_bound(args, self.slots)?;
                let beliefs = self.beliefs;
                for row in beliefs.of(*belief).iter() {
                    let mark = self.trail.len();
                    let row = row.iter().map(|v| Some(*v));
                    if unify_all(args, row, self.slots, self.trail)? && self.go_on(rest)? {
                        return Ok(true);
                    }
                    undo(self.slots, self.trail, mark);
                }
                Ok(false)
            }
            Context::Not(inner) => {
                let mark = self.trail.len();
                let holds = self.solve(inner, None)?;
                undo(self.slots, self.trail, mark);
                if holds { Ok(false) } else { self.go_on(rest) }
            }
            Context::And(all) => self.go_on(Some(&Rest { all, next: rest })),
            Context::Or(any) => {
                for choice in any {
                    let mark = self.trail.len();
                    if self.solve(choice, rest)? {
                        return Ok(true);
                    }
                    undo(self.slots, self.trail, mark);
                }
                Ok(false)
            }
            Context::Test(expr) => match eval(expr, self.slots)? {
                Value::Bool(true) => self.go_on(rest),
                Value::Bool(false) => Ok(false),
                Value::Int(_) | Value::Float(_) | Value::Symbol(_) => Err(EvalError::Type),
            },
        }
    }

    fn go_on(&mut self, rest: Option<&Rest>) -> Result<bool, EvalError> {
        let Some(rest) = rest else { return Ok(true) };
        match rest.all.split_first() {
            Some((first, all)) => self.solve(first, Some(&Rest { all, next: rest.next })),
            None => self.go_on(rest.next),
        }
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        ActorId, Param, Span, Type,
        bdi::{Agent, Belief, BeliefId, Term},
    };
    use proptest::prelude::*;

    use super::*;

    const VARS: usize = 3;

    /// Three beliefs of two arguments.
    fn base(facts: &[(u16, i64, i64)]) -> BeliefBase {
        let param = Param { name: "p".into(), ty: Type::Int { lo: 0, hi: 2 } };
        let belief = Belief { name: "b".into(), params: vec![param; 2], origin: Span::default() };
        let mut base = BeliefBase::new(&Agent {
            name: String::new(),
            actor: ActorId(0),
            beliefs: vec![belief; 3],
            goals: vec![],
            initial_beliefs: vec![],
            initial_goals: vec![],
            plans: vec![],
            origin: Span::default(),
        });
        for (b, x, y) in facts {
            base.of_mut(BeliefId(*b)).insert(&[Value::Int(*x), Value::Int(*y)]);
        }
        base
    }

    /// The answer by definition: of all choices of a row for each literal, in lexicographic order, the first that
    /// agrees on the variables.
    fn first_answer(base: &BeliefBase, literals: &[(u16, [u16; 2])]) -> Option<Vec<Slot>> {
        let mut answers: Vec<Vec<Slot>> = vec![vec![None; VARS]];
        for (belief, vars) in literals {
            let mut longer = vec![];
            for answer in &answers {
                for row in base.of(BeliefId(*belief)).iter() {
                    let mut next = answer.clone();
                    let agrees = vars.iter().zip(row).all(|(v, value)| {
                        let slot = &mut next[usize::from(*v)];
                        *slot.get_or_insert(*value) == *value
                    });
                    if agrees {
                        longer.push(next);
                    }
                }
            }
            answers = longer;
        }
        answers.into_iter().next()
    }

    proptest! {
        #[test]
        fn the_search_finds_the_first_answer_and_leaves_nothing_else(
            facts in prop::collection::vec((0u16..3, 0i64..3, 0i64..3), 0..15),
            literals in prop::collection::vec((0u16..3, [0u16..3, 0u16..3]), 0..5),
            split in 0usize..5,
        ) {
            let base = base(&facts);
            let literal = |(belief, vars): &(u16, [u16; 2])| Context::Belief {
                belief: BeliefId(*belief),
                args: vars.map(Term::Var).to_vec(),
            };
            let (left, right) = literals.split_at(split.min(literals.len()));
            let both = |l: &[(u16, [u16; 2])]| Context::And(l.iter().map(literal).collect());
            // Nested, so that tracking back crosses formulas.
            let context = Context::And(vec![Context::Or(vec![both(left)]), both(right)]);
            let (mut slots, mut trail) = (vec![None; VARS], Trail::new());
            let mut search = Search { beliefs: &base, slots: &mut slots, trail: &mut trail };
            let found = search.solve(&context, None).unwrap();
            let expected = first_answer(&base, &literals);
            prop_assert_eq!(found, expected.is_some());
            prop_assert_eq!(slots, expected.unwrap_or(vec![None; VARS]));
            let (mut slots, mut trail) = (vec![None; VARS], Trail::new());
            let mut search = Search { beliefs: &base, slots: &mut slots, trail: &mut trail };
            prop_assert_eq!(search.solve(&Context::Not(Box::new(context)), None).unwrap(), !found);
            prop_assert_eq!(slots, vec![None; VARS]);
        }
    }
}
