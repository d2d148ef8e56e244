//! How beliefs change: what is added, taken away and replaced, with the events of that.

use crate::{
    belief::{FactAnnotations, FactWithdrawal, GroundArguments},
    cycle::AgentMachine,
    event::{EventArguments, QueuedEvent},
    log::{FailureCause, LogItem, sources},
    step::{StepFlow, annotated},
    unify::{known, undo, unify, unify_all, well_bound},
};
use hrdsl_ir::{
    Expr, Value,
    bdi::{AgentTerm, Assertion, BeliefAnnotation, BeliefId, BeliefLiteral, TriggerOn, source_self},
};

impl<'p> AgentMachine<'p> {
    /// Posts an event that matters only if a plan is relevant to it, or if an intention waits for its turn to be over; whether
    /// it did.
    pub fn announce(
        &mut self,
        on: TriggerOn,
        args: &[Value],
        annotations: Option<FactAnnotations>,
        of: Option<u32>,
    ) -> bool {
        if of.is_none() && self.mind.library.relevant(on).is_empty() {
            return false;
        }
        let args: EventArguments = args.iter().map(|v| Some(*v)).collect();
        let event = QueuedEvent { of, ..QueuedEvent::new(on, args) };
        self.post(event.annotated(annotations.unwrap_or_default()));
        true
    }

    /// Adds a belief.
    pub fn believe(&mut self, belief: BeliefId, args: &[Value], annotations: FactAnnotations) {
        self.believe_for(None, belief, args, annotations);
    }

    /// The same; the plan for it goes on this intention, if any. Whether the intention waits for it.
    pub fn believe_for(
        &mut self,
        of: Option<u32>,
        belief: BeliefId,
        args: &[Value],
        annotations: FactAnnotations,
    ) -> bool {
        let new = self.mind.beliefs.insert(belief, args, annotations);
        if new.is_empty() {
            return false;
        }
        self.entry(0, || LogItem::Added { belief, args: args.to_vec(), annotations: new.clone() });
        self.announce(TriggerOn::BeliefAdded(belief), args, Some(new), of) && of.is_some()
    }

    /// A belief leaves the base.
    pub fn remove(&mut self, belief: BeliefId, row: usize) {
        let fact = GroundArguments::from_slice(self.mind.beliefs.of(belief).row(row));
        let had = self.mind.beliefs.remove(belief, row);
        self.left(None, belief, &fact, had);
    }

    fn left(&mut self, of: Option<u32>, belief: BeliefId, args: &[Value], had: FactAnnotations) -> bool {
        self.entry(0, || LogItem::Left { belief, args: args.to_vec() });
        self.announce(TriggerOn::BeliefRemoved(belief), args, Some(had), of) && of.is_some()
    }

    /// Takes a source away from a fact, if it has it.
    pub fn take(&mut self, belief: BeliefId, row: usize, source: Value) {
        self.take_for(None, belief, row, source);
    }

    /// The same; the plan for what leaves goes on this intention, if any. Whether the intention waits for it.
    pub fn take_for(&mut self, of: Option<u32>, belief: BeliefId, row: usize, source: Value) -> bool {
        let fact = GroundArguments::from_slice(self.mind.beliefs.of(belief).row(row));
        match self.mind.beliefs.withdraw(belief, row, source) {
            FactWithdrawal::Nothing => false,
            FactWithdrawal::Source => {
                self.entry(0, || LogItem::Taken { belief, args: fact.to_vec(), source });
                false
            }
            FactWithdrawal::Fact(had) => self.left(of, belief, &fact, had),
        }
    }

    // ── Steps ──

    /// Takes one source away from the first fact that has it; what is open in the literal gets its values.
    pub fn forget(&mut self, place: u32, literal: &'p BeliefLiteral) -> Result<StepFlow, FailureCause> {
        let own = AgentTerm::Expr(Expr::Const(Value::Symbol(source_self())));
        let wanted = literal.annotations.iter().position(|(what, _)| *what == BeliefAnnotation::Source);
        let source = wanted.map_or(&own, |at| &literal.annotations[at].1);
        let others = literal.annotations.iter().enumerate().filter(|(at, _)| Some(*at) != wanted);
        let others: Vec<&(BeliefAnnotation, AgentTerm)> = others.map(|(_, a)| a).collect();
        let plain: Vec<&(BeliefAnnotation, AgentTerm)> =
            literal.annotations.iter().filter(|(what, _)| *what != BeliefAnnotation::Source).collect();
        self.solver.with(self.mind.pool.see(place).vars());
        well_bound(&literal.args, &self.solver.slots)?;
        let belief = literal.belief;
        let mut kept = None;
        for row in self.mind.beliefs.of(belief).asked() {
            if let Some(gone) = self.source_of(literal, row, source, &others)? {
                let vars = self.mind.pool.at(place).vars_mut();
                vars.copy_from_slice(&self.solver.slots[..vars.len()]);
                let of = self.handled_by(place);
                return Ok(waits(self.take_for(of, belief, row, gone)));
            }
            if kept.is_none() && self.agrees(literal, row, &plain)? {
                kept = Some(row);
            }
        }
        if let Some(row) = kept {
            let facts = self.mind.beliefs.of(belief);
            let (args, from) = (facts.row(row).to_vec(), sources(facts.annotations(row)));
            let meant = known(source, &self.solver.slots);
            // An entry of its own accord: the step may have been meant otherwise.
            self.enter(0, LogItem::StillHeld { belief, args, meant, from });
        }
        Ok(StepFlow::Next)
    }

    /// The fact's first source that the term means, if the fact matches with it; what that binds is in the solver.
    fn source_of(
        &mut self,
        literal: &BeliefLiteral,
        row: usize,
        source: &AgentTerm,
        others: &[&(BeliefAnnotation, AgentTerm)],
    ) -> Result<Option<Value>, FailureCause> {
        let facts = self.mind.beliefs.of(literal.belief);
        let (slots, trail) = (&mut self.solver.slots, &mut self.solver.trail);
        let mark = trail.len();
        let args = facts.row(row).iter().map(|v| Some(*v));
        let mut found = None;
        if unify_all(&literal.args, args, 0, slots, trail)? {
            for one in sources(facts.annotations(row)) {
                let here = trail.len();
                if unify(source, one, 0, slots, trail)?
                    && annotated(others, facts.annotations(row), slots, trail)?
                {
                    found = Some(one);
                    break;
                }
                undo(slots, trail, here);
            }
        }
        if found.is_none() {
            undo(&mut self.solver.slots, &mut self.solver.trail, mark);
        }
        Ok(found)
    }

    /// Whether the fact matches, with these annotations; nothing is bound.
    fn agrees(
        &mut self,
        literal: &BeliefLiteral,
        row: usize,
        annotations: &[&(BeliefAnnotation, AgentTerm)],
    ) -> Result<bool, FailureCause> {
        let facts = self.mind.beliefs.of(literal.belief);
        let (slots, trail) = (&mut self.solver.slots, &mut self.solver.trail);
        let mark = trail.len();
        let args = facts.row(row).iter().map(|v| Some(*v));
        let agrees = unify_all(&literal.args, args, 0, slots, trail)?
            && annotated(annotations, facts.annotations(row), slots, trail)?;
        undo(&mut self.solver.slots, &mut self.solver.trail, mark);
        Ok(agrees)
    }

    pub fn replace(&mut self, place: u32, assertion: &Assertion) -> Result<StepFlow, FailureCause> {
        let (args, annotations) = self.asserted(place, assertion)?;
        let belief = assertion.belief;
        if let Some(place) = self.handled_by(place) {
            return Ok(waits(self.replace_one(place, belief, &args, annotations)));
        }
        for row in self.mind.beliefs.of(belief).others(&args) {
            self.remove(belief, row);
        }
        self.believe(belief, &args, annotations);
        Ok(StepFlow::Next)
    }

    /// As Jason does it: the first fact that the agent holds itself makes room. What its removal triggers has an intention
    /// of its own.
    fn replace_one(
        &mut self,
        place: u32,
        belief: BeliefId,
        args: &[Value],
        annotations: FactAnnotations,
    ) -> bool {
        let own = Value::Symbol(source_self());
        let facts = self.mind.beliefs.of(belief);
        let held = |row: &usize| sources(facts.annotations(*row)).contains(&own);
        if let Some(row) = facts.asked().into_iter().find(held) {
            self.take(belief, row, own);
        }
        self.believe_for(Some(place), belief, args, annotations)
    }

    /// The intention on which the plan for a belief that it changes goes: in agents as in Jason.
    pub fn handled_by(&self, place: u32) -> Option<u32> {
        self.mind.agent.jason.then_some(place)
    }

    pub fn abolish(&mut self, place: u32, literal: &'p BeliefLiteral) -> Result<StepFlow, FailureCause> {
        self.solver.with(self.mind.pool.see(place).vars());
        well_bound(&literal.args, &self.solver.slots)?;
        let annotations: Vec<&(BeliefAnnotation, AgentTerm)> = literal.annotations.iter().collect();
        for row in self.mind.beliefs.of(literal.belief).iter().collect::<Vec<_>>() {
            if self.agrees(literal, row, &annotations)? {
                self.remove(literal.belief, row);
            }
        }
        Ok(StepFlow::Next)
    }
}

/// What becomes of a step that changed a belief, by whether its intention waits for a plan.
pub(crate) fn waits(posted: bool) -> StepFlow {
    if posted { StepFlow::Suspended } else { StepFlow::Next }
}
