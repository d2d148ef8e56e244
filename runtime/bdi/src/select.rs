//! Selection of a plan: the first relevant one whose context has an answer.

use hrdsl_ir::bdi::{Plan, TriggerOn};

use crate::{
    Detail, Logged, Verdict,
    belief::{Annotations, own},
    cycle::Machine,
    event::Event,
    query::{Fault, Solver},
    unify::{undo, unify, unify_all, well_bound},
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
            if let Verdict::Faulty(fault) = verdict {
                let origin = self.mind.library.plan(index).origin;
                self.enter(number, Logged::Fault { plan: index, fault, origin });
            }
            if self.log.detail >= Detail::Reasons && selected.is_none() {
                let (on, args) = (event.on, event.args.clone());
                self.enter(number, Logged::Tried { on, args, plan: index, verdict });
            }
            self.measure_attempt(index, verdict);
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
            let own = own();
            let is_goal = matches!(event.on, TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_));
            let none = Annotations::new();
            let held = match &event.annotations {
                Some(held) => held,
                None if is_goal => &own,
                None => &none,
            };
            match self.annotated(plan, held) {
                Err(fault) => return Verdict::Faulty(fault),
                Ok(false) => return Verdict::Unlike,
                Ok(true) => {}
            }
        }
        match self.solver.solve(&self.mind, &mut self.dice, &plan.context) {
            Ok(true) => Verdict::Applicable,
            Ok(false) => Verdict::False { part: self.solver.farthest },
            Err(fault) => Verdict::Faulty(fault),
        }
    }

    /// Each annotation of the trigger takes the first of the event's that it matches.
    fn annotated(&mut self, plan: &Plan, held: &Annotations) -> Result<bool, Fault> {
        let Solver { slots, trail, .. } = &mut self.solver;
        'terms: for (what, term) in &plan.trigger.annotations {
            for (held, value) in held {
                let mark = trail.len();
                if held == what && unify(term, *value, 0, slots, trail)? {
                    continue 'terms;
                }
                undo(slots, trail, mark);
            }
            return Ok(false);
        }
        Ok(true)
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
