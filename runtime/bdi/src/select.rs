//! Selection of a plan: the first relevant one whose context has an answer.

use hrdsl_ir::bdi::{Plan, TriggerOn};

use crate::{
    Detail, Logged, Verdict,
    belief::{Annotations, own},
    cycle::Machine,
    event::Event,
    query::{Fault, Solver},
    unify::{Slot, unify, unify_all, well_bound},
};

impl<'p> Machine<'p> {
    /// The first applicable plan; its variables are in the solver. What went wrong on the way is logged.
    pub fn select(&mut self, event: &Event, of: Option<u32>) -> Option<u16> {
        let number = of.map_or(0, |place| self.mind.pool.see(place).number);
        let mut selected = None;
        let mut applicable = 0;
        let mut vars = Vec::new();
        for at in 0..self.mind.library.relevant(event.on).len() {
            let index = self.mind.library.relevant(event.on)[at];
            let verdict = self.attempt(index, event);
            if let (Verdict::Faulty(fault), None) = (verdict, selected) {
                let origin = self.mind.library.plan(index).origin;
                self.enter(0, Logged::Fault { plan: index, fault, origin });
            }
            if self.log.detail >= Detail::Reasons && selected.is_none() {
                let (on, args) = (event.on, event.args.clone());
                self.enter(number, Logged::Tried { on, args, plan: index, verdict });
            }
            if selected.is_none() {
                self.measure_attempt(index, verdict);
            }
            if verdict == Verdict::Applicable {
                applicable += 1;
                if selected.is_none() {
                    selected = Some(index);
                    if self.measured.is_none() {
                        return selected;
                    }
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

    fn attempt(&mut self, index: u16, event: &Event) -> Verdict {
        let plan: &'p Plan = self.mind.library.plan(index);
        self.solver.open(plan.vars.len());
        let Solver { slots, trail, .. } = &mut self.solver;
        let likes = well_bound(&plan.trigger.args, slots)
            .and_then(|()| unify_all(&plan.trigger.args, event.args.iter().copied(), 0, slots, trail));
        match likes {
            Err(error) => return Verdict::Faulty(Fault::NoValue(error)),
            Ok(false) => return Verdict::Unlike,
            Ok(true) => {}
        }
        if !plan.trigger.annotations.is_empty() {
            return self.attempt_annotated(plan, event);
        }
        self.verdict(plan)
    }

    fn verdict(&mut self, plan: &'p Plan) -> Verdict {
        match self.solver.solve(&self.mind, &mut self.dice, &plan.context) {
            Ok(true) => Verdict::Applicable,
            Ok(false) => Verdict::False { part: self.solver.farthest },
            Err(fault) => Verdict::Faulty(fault),
        }
    }

    /// Each way in which the trigger's annotations match the event's is tried, the last changing fastest.
    fn attempt_annotated(&mut self, plan: &'p Plan, event: &Event) -> Verdict {
        let is_goal = matches!(event.on, TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_));
        let held: Annotations = match &event.annotations {
            Some(held) => (**held).clone(),
            None if is_goal => own(),
            None => Annotations::new(),
        };
        let terms = &plan.trigger.annotations;
        let before: Vec<Slot> = self.solver.slots.clone();
        let mut verdict = Verdict::Unlike;
        'ways: for mut way in 0..held.len().saturating_pow(terms.len() as u32) {
            self.solver.with(&before);
            let mut picked = vec![0; terms.len()];
            for place in picked.iter_mut().rev() {
                *place = way % held.len();
                way /= held.len();
            }
            for ((what, term), at) in terms.iter().zip(picked) {
                let (kind, value) = held[at];
                let Solver { slots, trail, .. } = &mut self.solver;
                match unify(term, value, 0, slots, trail) {
                    Err(error) => return Verdict::Faulty(Fault::NoValue(error)),
                    Ok(likes) if likes && kind == *what => {}
                    Ok(_) => continue 'ways,
                }
            }
            verdict = self.verdict(plan);
            if !matches!(verdict, Verdict::False { .. }) {
                return verdict;
            }
        }
        verdict
    }

    fn measure_attempt(&mut self, index: u16, verdict: Verdict) {
        let Some(measured) = &mut self.measured else { return };
        let at = usize::from(index);
        match verdict {
            Verdict::Unlike => measured.unmatched[at] += 1,
            Verdict::False { part } => {
                measured.contexts[at][0] += 1;
                if let Some(blocked) = measured.blocked[at].get_mut(part) {
                    *blocked += 1;
                }
            }
            Verdict::Faulty(_) => measured.faults[at] += 1,
            Verdict::Applicable => measured.contexts[at][1] += 1,
        }
    }
}
