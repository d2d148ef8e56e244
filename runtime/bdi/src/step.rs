//! Execution of one step of a plan's body.

use crate::{
    belief::{FactAnnotations, GroundArguments, sourced, typed},
    change::waits,
    code::{PlanOp, settle},
    cycle::AgentMachine,
    event::{ActionToken, AgentAction, EventArguments, QueuedEvent},
    intention::{GoalDeadline, IntentionState, IntentionTimer},
    log::{FailureCause, LogItem, StepOutcome},
    mind::MentalState,
    print::{as_jason, plain},
    unify::{BindingTrail, VariableSlot, eval, known, undo, unify, wanted},
};
use hrdsl_ir::{
    EventId, EventPattern, Expr, Nanos, Value,
    bdi::{AgentTerm, Assertion, BeliefAnnotation, BeliefId, BeliefLiteral, GoalId, PlanStepKind, TriggerOn},
    expr::EvalError,
    value::nanos,
};

/// What becomes of the intention after a step that did not fail.
pub(crate) enum StepFlow {
    /// It may go on.
    Next,
    /// It waits for something, or the step has seen to it.
    Suspended,
}

fn values<C: Default + Extend<T>, T>(
    exprs: &[Expr],
    slots: &[VariableSlot],
    of: impl Fn(Value) -> T,
) -> Result<C, FailureCause> {
    let mut all = C::default();
    for expr in exprs {
        all.extend(Some(of(eval(expr, slots)?)));
    }
    Ok(all)
}

/// Where a step is: its intention, its plan, and its place in the body.
#[derive(Clone, Copy)]
pub(crate) struct StepLocation {
    pub place: u32,
    pub plan: u16,
    pub line: u16,
    pub site: u16,
}

impl<'p> AgentMachine<'p> {
    /// The next step of a ready intention.
    pub fn step(&mut self, place: u32) {
        match self.lines(place) {
            Ok(StepFlow::Next) => self.resume(place),
            Ok(StepFlow::Suspended) => {}
            Err(cause) => self.fail(place, cause),
        }
    }

    /// Executes lines up to the end of one step: the beginning of a `while` takes no turn.
    fn lines(&mut self, place: u32) -> Result<StepFlow, FailureCause> {
        loop {
            let Some(top) = self.mind.pool.see(place).frames.last().copied() else {
                return Ok(StepFlow::Next);
            };
            let code = self.mind.library.code(top.plan);
            let Some(line) = code.get(usize::from(top.next)) else { return Ok(StepFlow::Next) };
            let here = StepLocation { place, plan: top.plan, line: top.next, site: line.site };
            self.working = top.plan;
            let after = line.after;
            // A copy of the little that the line has, so that the machine is free to change.
            match &line.op {
                PlanOp::Plain(step) => {
                    let step = *step;
                    self.move_on(here, after);
                    return self.plain(here, step);
                }
                PlanOp::Branch { condition, otherwise } => {
                    let (condition, to) = (*condition, settle(code, *otherwise));
                    self.move_on(here, after);
                    return self.branch(here, condition, to);
                }
                PlanOp::Jump(to) => {
                    let to = settle(code, *to);
                    self.jump(place, to);
                }
                PlanOp::Enter(variables) => {
                    let variables = variables.clone();
                    self.enter_loop(place, &variables, Vec::new());
                    self.jump(place, after);
                }
                PlanOp::While { condition, end } => {
                    let (condition, end) = (*condition, settle(code, *end));
                    self.move_on(here, after);
                    return self.again(here, condition, end);
                }
                PlanOp::For { condition, variables } => {
                    let (condition, variables) = (*condition, variables.clone());
                    self.move_on(here, after);
                    return self.each_answer(here, condition, &variables);
                }
                // The next answer of a `for` is found by `resume`, and so is the end of a branch.
                PlanOp::Next { .. } | PlanOp::Join => return Ok(StepFlow::Next),
                PlanOp::Fork { branches, all, end } => {
                    let (branches, all, end) = (branches.clone(), *all, settle(code, *end));
                    self.move_on(here, end);
                    self.done(here, StepOutcome::Branches(branches.len()));
                    self.fork(here, &branches, all);
                    return Ok(StepFlow::Suspended);
                }
            }
        }
    }

    /// The step at this line begins; this line is the next.
    #[inline]
    fn move_on(&mut self, here: StepLocation, next: u16) {
        if let Some(top) = self.mind.pool.at(here.place).frames.last_mut() {
            (top.at, top.next) = (here.line, next);
        }
    }

    pub fn jump(&mut self, place: u32, to: u16) {
        if let Some(top) = self.mind.pool.at(place).frames.last_mut() {
            top.next = to;
        }
    }

    /// Logs the step, with the variables as they are before it.
    pub fn done(&mut self, here: StepLocation, outcome: StepOutcome) {
        let StepLocation { place, plan, line, .. } = here;
        if self.log.detail >= crate::log::LogDetail::Steps {
            let intention = self.mind.pool.see(place);
            let (number, vars) = (intention.number, intention.vars().to_vec());
            self.enter(number, LogItem::Step { plan, line, vars, outcome });
        }
    }

    // ── Plain steps ──

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn plain(&mut self, here: StepLocation, step: &'p PlanStepKind) -> Result<StepFlow, FailureCause> {
        self.done(here, StepOutcome::Done);
        let StepLocation { place, .. } = here;
        let slots = self.mind.pool.see(place).vars();
        match step {
            PlanStepKind::Do { event, args } => {
                let args = values(args, slots, |v| v)?;
                self.act(place, *event, args)?;
                Ok(StepFlow::Suspended)
            }
            PlanStepKind::Achieve { goal, args, within: None } => {
                self.post_goal(here, *goal, args, Some(place))?;
                Ok(StepFlow::Suspended)
            }
            PlanStepKind::Achieve { goal, args, within: Some(within) } => {
                let event = self.goal_event(here, *goal, args, Some(place))?;
                self.set_deadline(place, within)?;
                self.post(event);
                Ok(StepFlow::Suspended)
            }
            PlanStepKind::Spawn { goal, args } => {
                self.post_goal(here, *goal, args, None)?;
                Ok(StepFlow::Next)
            }
            PlanStepKind::Query(literal) => self.query(here, literal),
            PlanStepKind::Test(condition) => {
                if self.holds(place, condition)? {
                    Ok(StepFlow::Next)
                } else {
                    Err(FailureCause::NoAnswer)
                }
            }
            PlanStepKind::Add(assertion) => {
                let (args, annotations) = self.asserted(place, assertion)?;
                let of = self.handled_by(place);
                Ok(waits(self.believe_for(of, assertion.belief, &args, annotations)))
            }
            PlanStepKind::Remove(literal) => self.forget(place, literal),
            PlanStepKind::Replace(assertion) => self.replace(place, assertion),
            PlanStepKind::Abolish(literal) => self.abolish(place, literal),
            PlanStepKind::Await { events, within } => self.start_await(place, events, within.as_ref()),
            PlanStepKind::Wait { seconds } => {
                let time = self.time(place, seconds)?;
                let timer = self.set_timer(place, time);
                self.mind.pool.at(place).state = IntentionState::Sleeping(timer);
                Ok(StepFlow::Suspended)
            }
            PlanStepKind::Send { to, performative, content, args, annotations } => {
                self.send(here, to.as_ref(), *performative, (*content, args, annotations))
            }
            PlanStepKind::Ask { to, content, args, within } => {
                self.ask(here, to, *content, args, within.as_ref(), false)
            }
            PlanStepKind::AskAll { to, content, args, within, .. } => {
                self.ask(here, to, *content, args, within.as_ref(), true)
            }
            PlanStepKind::Print { args } => {
                let args: Vec<Value> = values(args, slots, |v| v)?;
                let print = if self.mind.agent.jason { as_jason } else { plain };
                let text: String = args.iter().map(|v| print(*v)).collect();
                self.entry(0, || LogItem::Printed(text));
                Ok(StepFlow::Next)
            }
            PlanStepKind::Control { what, goal } => self.control(place, *what, goal.as_ref()),
            PlanStepKind::Fail => Err(FailureCause::Fail),
            // INVARIANT: blocks are lines of their own.
            PlanStepKind::If { .. }
            | PlanStepKind::While { .. }
            | PlanStepKind::For { .. }
            | PlanStepKind::Fork { .. } => Ok(StepFlow::Next),
        }
    }

    /// Posts a goal with these arguments.
    fn post_goal(
        &mut self,
        here: StepLocation,
        goal: GoalId,
        args: &[Expr],
        of: Option<u32>,
    ) -> Result<(), FailureCause> {
        let is_typed = self.mind.agent.goal(goal).params.is_some();
        if is_typed || self.mind.pool.see(here.place).atomic > 0 {
            let event = self.goal_event(here, goal, args, of)?;
            self.post(event);
            return Ok(());
        }
        // The commonest step of all: the event is made where it waits, since moving it costs as much as the rest.
        let MentalState { pool, events, .. } = &mut self.mind;
        let event = QueuedEvent {
            of,
            by: Some((here.plan, here.site)),
            ..QueuedEvent::new(TriggerOn::GoalAdded(goal), EventArguments::new())
        };
        events.push_back(event);
        let slots = pool.see(here.place).vars();
        for expr in args {
            let value = if of.is_some() { wanted(expr, slots) } else { eval(expr, slots).map(Some) };
            match (events.back_mut(), value) {
                (Some(event), Ok(value)) => event.args.push(value),
                (_, Err(error)) => {
                    events.pop_back();
                    return Err(error.into());
                }
                (None, Ok(_)) => {}
            }
        }
        if let Some(place) = of {
            pool.at(place).state = IntentionState::Posted;
        }
        Ok(())
    }

    /// A goal with these arguments, as its declaration has them, if it is declared.
    fn goal_event(
        &self,
        here: StepLocation,
        goal: GoalId,
        args: &[Expr],
        of: Option<u32>,
    ) -> Result<QueuedEvent, FailureCause> {
        let slots = self.mind.pool.see(here.place).vars();
        let mut event = QueuedEvent::new(TriggerOn::GoalAdded(goal), EventArguments::new());
        (event.of, event.by) = (of, Some((here.plan, here.site)));
        for expr in args {
            event.args.push(if of.is_some() { wanted(expr, slots)? } else { Some(eval(expr, slots)?) });
        }
        event.args = self.of_goal(goal, event.args)?;
        Ok(event)
    }

    /// The arguments of a goal, as its declaration has them, if it is declared; open ones stay open.
    pub fn of_goal(&self, goal: GoalId, mut args: EventArguments) -> Result<EventArguments, FailureCause> {
        let Some(params) = &self.mind.agent.goal(goal).params else { return Ok(args) };
        for (param, arg) in params.iter().zip(&mut args) {
            let Some(value) = *arg else { continue };
            let one = typed(std::slice::from_ref(param), GroundArguments::from_slice(&[value]));
            *arg = Some(one.ok_or(FailureCause::OutOfRange)?[0]);
        }
        Ok(args)
    }

    fn act(&mut self, place: u32, event: EventId, args: GroundArguments) -> Result<(), FailureCause> {
        let args = typed(&self.mind.program.event(event).params, args).ok_or(FailureCause::OutOfRange)?;
        // Only the low half: a token need only differ from the intention's earlier ones.
        let serial = self.next_serial() as u32;
        self.mind.pool.at(place).state = IntentionState::Acting(serial);
        self.actions.push(AgentAction {
            token: ActionToken::new(place, serial),
            event,
            args: args.into_vec(),
        });
        Ok(())
    }

    /// The arguments, as the belief's declaration has them.
    pub fn declared(&self, belief: BeliefId, args: GroundArguments) -> Option<GroundArguments> {
        typed(&self.mind.agent.belief(belief).params, args)
    }

    pub fn asserted(
        &self,
        place: u32,
        assertion: &Assertion,
    ) -> Result<(GroundArguments, FactAnnotations), FailureCause> {
        let slots = self.mind.pool.see(place).vars();
        let args = values(&assertion.args, slots, |v| v)?;
        let args = self.declared(assertion.belief, args).ok_or(FailureCause::OutOfRange)?;
        let mut annotations = FactAnnotations::new();
        let declared = self.mind.agent.belief(assertion.belief);
        for (what, value) in &assertion.annotations {
            let mut value = eval(value, slots)?;
            if let BeliefAnnotation::Declared(at) = what {
                let param = declared.annotation(*at);
                let one = typed(std::slice::from_ref(param), GroundArguments::from_slice(&[value]));
                value = one.ok_or(FailureCause::OutOfRange)?[0];
            }
            annotations.push((*what, value));
        }
        Ok((args, sourced(annotations)))
    }

    /// Asks the belief base, and the plans for the test goal if it has no answer.
    fn query(&mut self, here: StepLocation, literal: &'p BeliefLiteral) -> Result<StepFlow, FailureCause> {
        let StepLocation { place, .. } = here;
        self.solver.with(self.mind.pool.see(place).vars());
        if self.solver.answer(&self.mind, &mut self.dice, literal)? {
            let vars = self.mind.pool.at(place).vars_mut();
            vars.copy_from_slice(&self.solver.slots[..vars.len()]);
            return Ok(StepFlow::Next);
        }
        let on = TriggerOn::TestAdded(literal.belief);
        if !literal.annotations.is_empty() || !self.plans_answer(literal.belief) {
            return Err(FailureCause::NoAnswer);
        }
        // A term that computes with a variable which this literal binds is compared with the answer.
        let slots = self.mind.pool.see(place).vars();
        let asked: EventArguments = literal.args.iter().map(|term| known(term, slots)).collect();
        let by = Some((here.plan, here.site));
        self.post(QueuedEvent { of: Some(place), by, ..QueuedEvent::new(on, asked) });
        Ok(StepFlow::Suspended)
    }

    /// Whether a plan is relevant to a query of the belief, or to its failure.
    pub fn plans_answer(&self, belief: BeliefId) -> bool {
        let on = [TriggerOn::TestAdded(belief), TriggerOn::TestFailed(belief)];
        on.iter().any(|on| !self.mind.library.relevant(*on).is_empty())
    }

    // ── Time ──

    fn start_await(
        &mut self,
        place: u32,
        events: &'p [EventPattern],
        within: Option<&Expr>,
    ) -> Result<StepFlow, FailureCause> {
        let timer = within.map(|e| self.time(place, e)).transpose()?.map(|t| self.set_timer(place, t));
        self.mind.pool.at(place).state = IntentionState::Awaiting { events, timer };
        self.awaiting.push(place);
        Ok(StepFlow::Suspended)
    }

    /// A time of at least 0, in nanoseconds.
    pub fn time(&self, place: u32, seconds: &Expr) -> Result<Nanos, FailureCause> {
        let seconds = eval(seconds, self.mind.pool.see(place).vars())?.as_f64();
        seconds.filter(|s| s.is_finite() && *s >= 0.0).map(nanos).ok_or(FailureCause::BadWait)
    }

    pub fn set_timer(&mut self, place: u32, time: Nanos) -> IntentionTimer {
        let timer =
            IntentionTimer { due: self.mind.now.saturating_add(time), serial: self.next_serial(), of: place };
        self.timers.insert(timer);
        timer
    }

    fn set_deadline(&mut self, place: u32, within: &Expr) -> Result<(), FailureCause> {
        let time = self.time(place, within)?;
        let timer = self.set_timer(place, time);
        let intention = self.mind.pool.at(place);
        let height = intention.frames.len() as u32;
        intention.deadlines.push(GoalDeadline { height, timer });
        Ok(())
    }
}

/// Whether each term matches one of the annotations, in some way; what that binds is on the trail.
pub(crate) fn annotated(
    terms: &[&(BeliefAnnotation, AgentTerm)],
    held: &FactAnnotations,
    slots: &mut [VariableSlot],
    trail: &mut BindingTrail,
) -> Result<bool, EvalError> {
    let Some(((what, term), rest)) = terms.split_first() else { return Ok(true) };
    for (_, value) in held.iter().filter(|(w, _)| w == what) {
        let mark = trail.len();
        if unify(term, *value, 0, slots, trail)? && annotated(rest, held, slots, trail)? {
            return Ok(true);
        }
        undo(slots, trail, mark);
    }
    Ok(false)
}

/// The slots that the terms of a test goal's plan stand for at its end, for the query that asked.
pub(crate) fn answers(
    trigger: &[AgentTerm],
    asked: &[VariableSlot],
    slots: &[VariableSlot],
) -> EventArguments {
    let answer = |(term, asked): (&AgentTerm, &VariableSlot)| match term {
        AgentTerm::Any => *asked,
        AgentTerm::Var(_) | AgentTerm::Expr(_) | AgentTerm::List(..) => known(term, slots).or(*asked),
    };
    trigger.iter().zip(asked).map(answer).collect()
}
