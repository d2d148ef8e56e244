//! Selection of a plan: the first relevant one whose context has an answer.

use hrdsl_ir::{
    Value,
    bdi::{AgentTerm, Plan, PlanContext, TriggerOn},
    expr::EvalError,
};

use crate::{
    belief::{FactAnnotations, from, own, picked},
    cycle::AgentMachine,
    event::QueuedEvent,
    log::{ApplicabilityVerdict, LogDetail, LogItem},
    query::{BeliefQueryError, QuerySolver},
    unify::{VariableSlot, eval, unify, unify_all, well_bound},
};

impl<'p> AgentMachine<'p> {
    /// The first applicable plan; its variables are in the solver. What went wrong on the way is logged.
    pub fn select(&mut self, event: &QueuedEvent, of: Option<u32>) -> Option<u16> {
        if self.measured.is_some() || self.log.detail >= LogDetail::Reasons {
            return self.select_closely(event, of);
        }
        for at in 0..self.mind.library.relevant(event.on).len() {
            let index = self.mind.library.relevant(event.on)[at];
            match self.attempt(index, event) {
                ApplicabilityVerdict::Applicable => return Some(index),
                ApplicabilityVerdict::Unlike | ApplicabilityVerdict::False { .. } => {}
                ApplicabilityVerdict::Faulty(fault) => self.enter_fault(index, fault),
            }
        }
        None
    }

    fn enter_fault(&mut self, plan: u16, fault: BeliefQueryError) {
        let origin = self.mind.library.plan(plan).origin;
        self.enter(0, LogItem::Fault { plan, fault, origin });
    }

    /// The same, with all that was tried counted and logged; how many more would be applicable is counted, too.
    fn select_closely(&mut self, event: &QueuedEvent, of: Option<u32>) -> Option<u16> {
        let number = of.map_or(0, |place| self.mind.pool.see(place).number);
        let mut selected = None;
        let mut applicable = 0;
        let mut vars = Vec::new();
        for at in 0..self.mind.library.relevant(event.on).len() {
            let index = self.mind.library.relevant(event.on)[at];
            let verdict = self.attempt(index, event);
            if selected.is_none() {
                if let ApplicabilityVerdict::Faulty(fault) = verdict {
                    self.enter_fault(index, fault);
                }
                if self.log.detail >= LogDetail::Reasons {
                    let (on, args) = (event.on, event.args.clone());
                    self.enter(number, LogItem::Tried { on, args, plan: index, verdict });
                }
                self.measure_attempt(index, verdict);
            }
            if verdict == ApplicabilityVerdict::Applicable {
                applicable += 1;
                if selected.is_none() {
                    selected = Some(index);
                    vars.clone_from(&self.solver.slots);
                }
            }
        }
        if let Some(measured) = &mut self.measured {
            measured.applicable.entry(event.on).or_default()[applicable.min(2)] += 1;
        }
        // The plans after it were tried to be counted.
        self.solver.slots = vars;
        selected
    }

    fn attempt(&mut self, index: u16, event: &QueuedEvent) -> ApplicabilityVerdict {
        let plan: &'p Plan = self.mind.library.plan(index);
        self.solver.open(plan.vars.len());
        let QuerySolver { slots, trail, .. } = &mut self.solver;
        if self.mind.library.is_plain(index) {
            for (term, value) in plan.trigger.args.iter().zip(&event.args) {
                if let AgentTerm::Var(var) = term {
                    slots[usize::from(*var)] = *value;
                }
            }
            return self.verdict(plan);
        }
        let likes = well_bound(&plan.trigger.args, slots)
            .and_then(|()| unify_all(&plan.trigger.args, event.args.iter().copied(), 0, slots, trail));
        match likes {
            Err(error) => return ApplicabilityVerdict::Faulty(BeliefQueryError::NoValue(error)),
            Ok(false) => return ApplicabilityVerdict::Unlike,
            Ok(true) => {}
        }
        if !plan.trigger.annotations.is_empty() {
            return self.attempt_annotated(plan, event);
        }
        self.verdict(plan)
    }

    #[inline]
    fn verdict(&mut self, plan: &'p Plan) -> ApplicabilityVerdict {
        if let PlanContext::Test(expr) = &plan.context {
            return match eval(expr, &self.solver.slots) {
                Ok(Value::Bool(true)) => ApplicabilityVerdict::Applicable,
                Ok(Value::Bool(false)) => ApplicabilityVerdict::False { part: 0 },
                Ok(_) => ApplicabilityVerdict::Faulty(BeliefQueryError::NoValue(EvalError::Type)),
                Err(error) => ApplicabilityVerdict::Faulty(BeliefQueryError::NoValue(error)),
            };
        }
        match self.solver.solve(&self.mind, &mut self.dice, &plan.context) {
            Ok(true) => ApplicabilityVerdict::Applicable,
            Ok(false) => ApplicabilityVerdict::False { part: self.solver.farthest },
            Err(fault) => ApplicabilityVerdict::Faulty(fault),
        }
    }

    /// Each way in which the trigger's annotations match the event's is tried, the last changing fastest.
    fn attempt_annotated(&mut self, plan: &'p Plan, event: &QueuedEvent) -> ApplicabilityVerdict {
        let is_goal = matches!(event.on, TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_));
        let held: FactAnnotations = match event.annotations() {
            Some(held) => held.clone(),
            None if is_goal => event.told.map_or_else(own, |who| from(Value::Symbol(who))),
            None => FactAnnotations::new(),
        };
        let terms = &plan.trigger.annotations;
        let before: Vec<VariableSlot> = self.solver.slots.clone();
        let mut verdict = ApplicabilityVerdict::Unlike;
        'matches: for match_no in 0..held.len().saturating_pow(terms.len() as u32) {
            self.solver.with(&before);
            let picked = picked(match_no, held.len(), terms.len());
            for ((what, term), at) in terms.iter().zip(picked) {
                let (kind, value) = held[at];
                let QuerySolver { slots, trail, .. } = &mut self.solver;
                match unify(term, value, 0, slots, trail) {
                    Err(error) => return ApplicabilityVerdict::Faulty(BeliefQueryError::NoValue(error)),
                    Ok(likes) if likes && kind == *what => {}
                    Ok(_) => continue 'matches,
                }
            }
            verdict = self.verdict(plan);
            if !matches!(verdict, ApplicabilityVerdict::False { .. }) {
                return verdict;
            }
        }
        verdict
    }

    fn measure_attempt(&mut self, index: u16, verdict: ApplicabilityVerdict) {
        let Some(measured) = &mut self.measured else { return };
        let at = usize::from(index);
        match verdict {
            ApplicabilityVerdict::Unlike => measured.unmatched[at] += 1,
            ApplicabilityVerdict::False { part } => {
                measured.contexts[at][0] += 1;
                if let Some(blocked) = measured.blocked[at].get_mut(part) {
                    *blocked += 1;
                }
            }
            ApplicabilityVerdict::Faulty(_) => measured.faults[at] += 1,
            ApplicabilityVerdict::Applicable => measured.contexts[at][1] += 1,
        }
    }
}
