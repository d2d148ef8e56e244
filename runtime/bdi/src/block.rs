//! Steps with blocks: `if`, `while`, `for`, `fork`.

use hrdsl_ir::bdi::PlanContext;
use smallvec::SmallVec;

use crate::{
    code::settle,
    cycle::AgentMachine,
    holding::HoldingKind,
    intention::{IntentionState, LoopFrame},
    log::{FailureCause, StepOutcome},
    step::{StepFlow, StepLocation},
    unify::VariableSlot,
};

impl<'p> AgentMachine<'p> {
    /// The first answer's bindings become the plan's.
    pub fn holds(&mut self, place: u32, condition: &'p PlanContext) -> Result<bool, FailureCause> {
        self.solver.with(self.mind.pool.see(place).vars());
        let holds = self.solver.solve(&self.mind, &mut self.dice, condition)?;
        if holds {
            let vars = self.mind.pool.at(place).vars_mut();
            vars.copy_from_slice(&self.solver.slots[..vars.len()]);
        }
        Ok(holds)
    }

    pub fn branch(
        &mut self,
        here: StepLocation,
        condition: &'p PlanContext,
        otherwise: u16,
    ) -> Result<StepFlow, FailureCause> {
        if !self.decide(here, condition)? {
            self.jump(here.place, otherwise);
        }
        Ok(StepFlow::Next)
    }

    /// The condition of a block; whether it holds is in the log.
    fn decide(&mut self, here: StepLocation, condition: &'p PlanContext) -> Result<bool, FailureCause> {
        let holds = self.holds(here.place, condition);
        self.done(here, holds.as_ref().map_or(StepOutcome::Faulty, |h| StepOutcome::Holds(*h)));
        holds
    }

    pub fn enter_loop(&mut self, place: u32, variables: &[u16], answers: Vec<VariableSlot>) {
        let intention = self.mind.pool.at(place);
        let open = variables.iter().copied().filter(|v| intention.vars()[usize::from(*v)].is_none());
        let open: SmallVec<[u16; 4]> = open.collect();
        let height = intention.frames.len() as u32;
        self.mind.pool.enter(place, LoopFrame { height, open, answers, used: 0 });
    }

    /// Opens the loop's variables.
    fn reopen(&mut self, place: u32) {
        let intention = self.mind.pool.at(place);
        let Some(open) = intention.loops.last().map(|l| l.open.clone()) else { return };
        let vars = intention.vars_mut();
        open.iter().for_each(|v| vars[usize::from(*v)] = None);
    }

    pub fn again(
        &mut self,
        here: StepLocation,
        condition: &'p PlanContext,
        end: u16,
    ) -> Result<StepFlow, FailureCause> {
        self.reopen(here.place);
        if !self.decide(here, condition)? {
            self.mind.pool.leave_loop(here.place);
            self.jump(here.place, end);
        }
        Ok(StepFlow::Next)
    }

    pub fn each_answer(
        &mut self,
        here: StepLocation,
        condition: &'p PlanContext,
        variables: &[u16],
    ) -> Result<StepFlow, FailureCause> {
        self.solver.with(self.mind.pool.see(here.place).vars());
        let vars = self.mind.pool.see(here.place).vars();
        let open: SmallVec<[u16; 4]> =
            variables.iter().copied().filter(|v| vars[usize::from(*v)].is_none()).collect();
        let found = self.all_answers(condition, &open);
        self.done(
            here,
            found.as_ref().map_or(StepOutcome::Faulty, |(count, _)| StepOutcome::Answers(*count)),
        );
        let (count, mut answers) = found?;
        if open.is_empty() {
            // Nothing is bound: only the number of answers matters.
            answers = vec![None; count];
        }
        self.enter_loop(here.place, variables, answers);
        Ok(StepFlow::Next)
    }

    /// How many answers there are, and the values of these variables in each.
    fn all_answers(
        &mut self,
        condition: &'p PlanContext,
        open: &[u16],
    ) -> Result<(usize, Vec<VariableSlot>), FailureCause> {
        let mut answers = Vec::new();
        let mut count = 0;
        let mut found = self.solver.solve(&self.mind, &mut self.dice, condition)?;
        while found {
            answers.extend(open.iter().map(|v| self.solver.slots[usize::from(*v)]));
            count += 1;
            // Too many end the run after this cycle, whether they are used or not.
            self.found = self.found.max(count * open.len().max(1));
            if self.found > HoldingKind::Values.most() {
                break;
            }
            // A condition that is only tested is answered without a search.
            found = !matches!(condition, PlanContext::True | PlanContext::Test(_))
                && self.solver.again(&self.mind, &mut self.dice)?;
        }
        Ok((count, answers))
    }

    /// Binds the loop's next answer; after the last the loop is over.
    pub fn next_answer(&mut self, place: u32) -> bool {
        self.reopen(place);
        let intention = self.mind.pool.at(place);
        let Some(l) = intention.loops.last_mut() else { return false };
        let width = l.open.len().max(1);
        if l.used * width >= l.answers.len() {
            self.mind.pool.leave_loop(place);
            return false;
        }
        let from = l.used * width;
        l.used += 1;
        let (open, answer) = (l.open.clone(), l.answers[from..from + width].to_vec());
        let vars = intention.vars_mut();
        open.iter().zip(answer).for_each(|(v, value)| vars[usize::from(*v)] = value);
        true
    }

    pub fn fork(&mut self, here: StepLocation, branches: &[u16], all: bool) {
        let parent = self.mind.pool.at(here.place);
        let Some(frame) = parent.frames.last().copied() else { return };
        let (args, vars) = (parent.args(frame).to_vec(), parent.vars().to_vec());
        parent.state = IntentionState::Forked { left: branches.len() as u32, all };
        let atomic = parent.atomic > 0;
        let mut children: SmallVec<[u32; 2]> = SmallVec::new();
        for start in branches {
            let child = self.mind.pool.adopt();
            children.push(child);
            let first = settle(self.mind.library.code(frame.plan), *start);
            self.mind.pool.push(child, frame.plan, first, &args, &vars);
            let intention = self.mind.pool.at(child);
            (intention.frames[0].branch, intention.frames[0].under) = (true, frame.under);
            (intention.frames[0].told, intention.atomic) = (frame.told, u32::from(atomic));
            intention.parent = Some(here.place);
            self.mind.pool.count(child);
        }
        self.mind.pool.at(here.place).children.clone_from(&children);
        // At the front, too, the first branch is the first.
        if atomic {
            children.reverse();
        }
        for child in children {
            // A branch that ended at once may have dropped it.
            if self.mind.pool.see(child).parent == Some(here.place) {
                self.resume(child);
            }
        }
    }
}
