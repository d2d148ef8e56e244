//! Execution of one step of a plan's body.

use crate::{
    Action, ActionToken, Cause, Logged, Outcome,
    belief::{Annotations, sourced, typed},
    code::{Op, settle},
    cycle::Machine,
    event::{Args, Event, Ground},
    intention::{Deadline, State, Timer},
    log::sources,
    mind::Mind,
    unify::{Slot, Trail, eval, known, undo, unify, unify_all, well_bound},
};
use hrdsl_ir::{
    EventId, EventPattern, Expr, Nanos, Value,
    bdi::{Annotation, Assertion, BeliefId, GoalId, Literal, StepKind, Term, TriggerOn, source_self},
    expr::EvalError,
    value::nanos,
};

/// What becomes of the intention after a step that did not fail.
pub(crate) enum Flow {
    /// It may go on.
    Next,
    /// It waits for something, or the step has seen to it.
    Suspended,
}

fn values<C: Default + Extend<T>, T>(
    exprs: &[Expr],
    slots: &[Slot],
    of: impl Fn(Value) -> T,
) -> Result<C, Cause> {
    let mut all = C::default();
    for expr in exprs {
        all.extend(Some(of(eval(expr, slots)?)));
    }
    Ok(all)
}

/// Where a step is: its intention, its plan, and its place in the body.
#[derive(Clone, Copy)]
pub(crate) struct Here {
    pub place: u32,
    pub plan: u16,
    pub line: u16,
    pub site: u16,
}

impl<'p> Machine<'p> {
    /// The next step of a ready intention.
    pub fn step(&mut self, place: u32) {
        match self.lines(place) {
            Ok(Flow::Next) => self.resume(place),
            Ok(Flow::Suspended) => {}
            Err(cause) => self.fail(place, cause),
        }
    }

    /// Executes lines up to the end of one step: the beginning of a `while` takes no turn.
    fn lines(&mut self, place: u32) -> Result<Flow, Cause> {
        loop {
            let Some(top) = self.mind.pool.see(place).frames.last().copied() else { return Ok(Flow::Next) };
            let code = self.mind.library.code(top.plan);
            let Some(line) = code.get(usize::from(top.next)) else { return Ok(Flow::Next) };
            let here = Here { place, plan: top.plan, line: top.next, site: line.site };
            self.working = top.plan;
            let after = line.after;
            // A copy of the little that the line has, so that the machine is free to change.
            match &line.op {
                Op::Plain(step) => {
                    let step = *step;
                    self.move_on(here, after);
                    return self.plain(here, step);
                }
                Op::Branch { condition, otherwise } => {
                    let (condition, to) = (*condition, settle(code, *otherwise));
                    self.move_on(here, after);
                    return self.branch(here, condition, to);
                }
                Op::Jump(to) => {
                    let to = settle(code, *to);
                    self.jump(place, to);
                }
                Op::Enter(variables) => {
                    let variables = variables.clone();
                    self.enter_loop(place, &variables, Vec::new());
                    self.jump(place, after);
                }
                Op::While { condition, end } => {
                    let (condition, end) = (*condition, settle(code, *end));
                    self.move_on(here, after);
                    return self.again(here, condition, end);
                }
                Op::For { condition, variables } => {
                    let (condition, variables) = (*condition, variables.clone());
                    self.move_on(here, after);
                    return self.each_answer(here, condition, &variables);
                }
                // The next answer of a `for` is found by `resume`, and so is the end of a branch.
                Op::Next { .. } | Op::Join => return Ok(Flow::Next),
                Op::Fork { branches, all, end } => {
                    let (branches, all, end) = (branches.clone(), *all, settle(code, *end));
                    self.move_on(here, end);
                    self.done(here, Outcome::Branches(branches.len()));
                    self.fork(here, &branches, all);
                    return Ok(Flow::Suspended);
                }
            }
        }
    }

    /// The step at this line begins; this line is the next.
    #[inline]
    fn move_on(&mut self, here: Here, next: u16) {
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
    pub fn done(&mut self, here: Here, outcome: Outcome) {
        let Here { place, plan, line, .. } = here;
        if self.log.detail >= crate::Detail::Steps {
            let intention = self.mind.pool.see(place);
            let (number, vars) = (intention.number, intention.vars().to_vec());
            self.enter(number, Logged::Step { plan, line, vars, outcome });
        }
    }

    // ── Plain steps ──

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn plain(&mut self, here: Here, step: &'p StepKind) -> Result<Flow, Cause> {
        self.done(here, Outcome::Done);
        let Here { place, .. } = here;
        let slots = self.mind.pool.see(place).vars();
        match step {
            StepKind::Do { event, args } => {
                let args = values(args, slots, |v| v)?;
                self.act(place, *event, args)?;
                Ok(Flow::Suspended)
            }
            StepKind::Achieve { goal, args, within: None } => {
                self.post_goal(here, *goal, args, Some(place))?;
                Ok(Flow::Suspended)
            }
            StepKind::Achieve { goal, args, within: Some(within) } => {
                let event = self.goal_event(here, *goal, args, Some(place))?;
                self.set_deadline(place, within)?;
                self.post(event);
                Ok(Flow::Suspended)
            }
            StepKind::Spawn { goal, args } => {
                self.post_goal(here, *goal, args, None)?;
                Ok(Flow::Next)
            }
            StepKind::Query(literal) => self.query(here, literal),
            StepKind::Test(condition) => {
                if self.holds(place, condition)? {
                    Ok(Flow::Next)
                } else {
                    Err(Cause::NoAnswer)
                }
            }
            StepKind::Add(assertion) => {
                let (args, annotations) = self.asserted(place, assertion)?;
                self.believe(assertion.belief, &args, annotations);
                Ok(Flow::Next)
            }
            StepKind::Remove(literal) => self.forget(place, literal),
            StepKind::Replace(assertion) => self.replace(place, assertion),
            StepKind::Abolish(literal) => self.abolish(place, literal),
            StepKind::Await { events, within } => self.start_await(place, events, within.as_ref()),
            StepKind::Wait { seconds } => {
                let time = self.time(place, seconds)?;
                let timer = self.set_timer(place, time);
                self.mind.pool.at(place).state = State::Sleeping(timer);
                Ok(Flow::Suspended)
            }
            StepKind::Send { to, performative, content, args } => {
                self.send(here, to.as_ref(), *performative, *content, args)
            }
            StepKind::Ask { to, content, args, within } => {
                self.ask(here, to, *content, args, within.as_ref(), false)
            }
            StepKind::AskAll { to, content, args, within, .. } => {
                self.ask(here, to, *content, args, within.as_ref(), true)
            }
            StepKind::Print { args } => {
                let args: Vec<Value> = values(args, slots, |v| v)?;
                let text: String = args.iter().map(|v| plain(*v)).collect();
                self.entry(0, || Logged::Printed(text));
                Ok(Flow::Next)
            }
            StepKind::Control { what, goal } => self.control(place, *what, goal.as_ref()),
            StepKind::Fail => Err(Cause::Fail),
            // INVARIANT: blocks are lines of their own.
            StepKind::If { .. } | StepKind::While { .. } | StepKind::For { .. } | StepKind::Fork { .. } => {
                Ok(Flow::Next)
            }
        }
    }

    /// Posts a goal with these arguments.
    fn post_goal(&mut self, here: Here, goal: GoalId, args: &[Expr], of: Option<u32>) -> Result<(), Cause> {
        let declared = self.mind.agent.and_then(|a| a.goals.get(usize::from(goal.0)));
        if declared.is_some_and(|g| g.params.is_some()) || self.mind.pool.see(here.place).atomic > 0 {
            let event = self.goal_event(here, goal, args, of)?;
            self.post(event);
            return Ok(());
        }
        // The commonest step of all: the event is made where it waits, since moving it costs as much as the rest.
        let Mind { pool, events, .. } = &mut self.mind;
        let event = Event {
            of,
            by: Some((here.plan, here.site)),
            ..Event::new(TriggerOn::GoalAdded(goal), Args::new())
        };
        events.push_back(event);
        let slots = pool.see(here.place).vars();
        for expr in args {
            let value = eval(expr, slots);
            match (events.back_mut(), value) {
                (Some(event), Ok(value)) => event.args.push(Some(value)),
                (_, Err(error)) => {
                    events.pop_back();
                    return Err(error.into());
                }
                (None, Ok(_)) => {}
            }
        }
        if let Some(place) = of {
            pool.at(place).state = State::Posted;
        }
        Ok(())
    }

    /// A goal with these arguments, as its declaration has them, if it is declared.
    fn goal_event(&self, here: Here, goal: GoalId, args: &[Expr], of: Option<u32>) -> Result<Event, Cause> {
        let slots = self.mind.pool.see(here.place).vars();
        let mut event = Event::new(TriggerOn::GoalAdded(goal), Args::new());
        (event.of, event.by) = (of, Some((here.plan, here.site)));
        for expr in args {
            event.args.push(Some(eval(expr, slots)?));
        }
        let declared = self.mind.agent.and_then(|a| a.goals.get(usize::from(goal.0)));
        if let Some(params) = declared.and_then(|g| g.params.as_ref()) {
            let ground = event.args.iter().copied().flatten().collect();
            let typed = typed(params, ground).ok_or(Cause::OutOfRange)?;
            event.args = typed.into_iter().map(Some).collect();
        }
        Ok(event)
    }

    fn act(&mut self, place: u32, event: EventId, args: Ground) -> Result<(), Cause> {
        let args = typed(&self.mind.program.event(event).params, args).ok_or(Cause::OutOfRange)?;
        // Only the low half: a token need only differ from the intention's earlier ones.
        let serial = self.next_serial() as u32;
        self.mind.pool.at(place).state = State::Acting(serial);
        self.actions.push(Action { token: ActionToken::new(place, serial), event, args: args.into_vec() });
        Ok(())
    }

    /// The arguments, as the belief's declaration has them.
    pub fn declared(&self, belief: BeliefId, args: Ground) -> Option<Ground> {
        let declared = self.mind.agent.and_then(|a| a.beliefs.get(usize::from(belief.0)));
        declared.and_then(|b| typed(&b.params, args))
    }

    fn asserted(&self, place: u32, assertion: &Assertion) -> Result<(Ground, Annotations), Cause> {
        let slots = self.mind.pool.see(place).vars();
        let args = values(&assertion.args, slots, |v| v)?;
        let args = self.declared(assertion.belief, args).ok_or(Cause::OutOfRange)?;
        let mut annotations = Annotations::new();
        let declared = self.mind.agent.map(|a| &a.beliefs[usize::from(assertion.belief.0)].annotations);
        for (what, value) in &assertion.annotations {
            let mut value = eval(value, slots)?;
            if let Annotation::Declared(at) = what {
                let param = declared.and_then(|d| d.get(usize::from(*at))).ok_or(Cause::OutOfRange)?;
                let one = typed(std::slice::from_ref(param), Ground::from_slice(&[value]));
                value = one.ok_or(Cause::OutOfRange)?[0];
            }
            annotations.push((*what, value));
        }
        Ok((args, sourced(annotations)))
    }

    /// Asks the belief base, and the plans for the test goal if it has no answer.
    fn query(&mut self, here: Here, literal: &'p Literal) -> Result<Flow, Cause> {
        let Here { place, .. } = here;
        self.solver.with(self.mind.pool.see(place).vars());
        if self.solver.answer(&self.mind, &mut self.dice, literal)? {
            let vars = self.mind.pool.at(place).vars_mut();
            vars.copy_from_slice(&self.solver.slots[..vars.len()]);
            return Ok(Flow::Next);
        }
        let on = TriggerOn::TestAdded(literal.belief);
        if !literal.annotations.is_empty() || !self.plans_answer(literal.belief) {
            return Err(Cause::NoAnswer);
        }
        // A term that computes with a variable which this literal binds is compared with the answer.
        let slots = self.mind.pool.see(place).vars();
        let asked: Args = literal.args.iter().map(|term| known(term, slots)).collect();
        let by = Some((here.plan, here.site));
        self.post(Event { of: Some(place), by, ..Event::new(on, asked) });
        Ok(Flow::Suspended)
    }

    /// Whether a plan is relevant to a query of the belief, or to its failure.
    pub fn plans_answer(&self, belief: BeliefId) -> bool {
        let on = [TriggerOn::TestAdded(belief), TriggerOn::TestFailed(belief)];
        on.iter().any(|on| !self.mind.library.relevant(*on).is_empty())
    }

    /// Takes one source away from the first fact that has it.
    fn forget(&mut self, place: u32, literal: &'p Literal) -> Result<Flow, Cause> {
        let own = Term::Expr(Expr::Const(Value::Symbol(source_self())));
        let wanted = literal.annotations.iter().position(|(what, _)| *what == Annotation::Source);
        let source = wanted.map_or(&own, |at| &literal.annotations[at].1);
        let others = literal.annotations.iter().enumerate().filter(|(at, _)| Some(*at) != wanted);
        let others: Vec<&(Annotation, Term)> = others.map(|(_, a)| a).collect();
        let plain: Vec<&(Annotation, Term)> =
            literal.annotations.iter().filter(|(what, _)| *what != Annotation::Source).collect();
        self.solver.with(self.mind.pool.see(place).vars());
        well_bound(&literal.args, &self.solver.slots)?;
        let belief = literal.belief;
        let mut kept = None;
        for row in self.mind.beliefs.of(belief).iter().collect::<Vec<_>>() {
            if let Some(gone) = self.source_of(literal, row, source, &others)? {
                self.take(belief, row, gone);
                return Ok(Flow::Next);
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
            self.enter(0, Logged::StillHeld { belief, args, meant, from });
        }
        Ok(Flow::Next)
    }

    /// The fact's first source that the term means, if the fact matches with it.
    fn source_of(
        &mut self,
        literal: &Literal,
        row: usize,
        source: &Term,
        others: &[&(Annotation, Term)],
    ) -> Result<Option<Value>, Cause> {
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
        undo(&mut self.solver.slots, &mut self.solver.trail, mark);
        Ok(found)
    }

    /// Whether the fact matches, with these annotations; nothing is bound.
    fn agrees(
        &mut self,
        literal: &Literal,
        row: usize,
        annotations: &[&(Annotation, Term)],
    ) -> Result<bool, Cause> {
        let facts = self.mind.beliefs.of(literal.belief);
        let (slots, trail) = (&mut self.solver.slots, &mut self.solver.trail);
        let mark = trail.len();
        let args = facts.row(row).iter().map(|v| Some(*v));
        let agrees = unify_all(&literal.args, args, 0, slots, trail)?
            && annotated(annotations, facts.annotations(row), slots, trail)?;
        undo(&mut self.solver.slots, &mut self.solver.trail, mark);
        Ok(agrees)
    }

    fn replace(&mut self, place: u32, assertion: &Assertion) -> Result<Flow, Cause> {
        let (args, annotations) = self.asserted(place, assertion)?;
        let belief = assertion.belief;
        for row in self.mind.beliefs.of(belief).others(&args) {
            self.remove(belief, row);
        }
        self.believe(belief, &args, annotations);
        Ok(Flow::Next)
    }

    fn abolish(&mut self, place: u32, literal: &'p Literal) -> Result<Flow, Cause> {
        self.solver.with(self.mind.pool.see(place).vars());
        well_bound(&literal.args, &self.solver.slots)?;
        let annotations: Vec<&(Annotation, Term)> = literal.annotations.iter().collect();
        for row in self.mind.beliefs.of(literal.belief).iter().collect::<Vec<_>>() {
            if self.agrees(literal, row, &annotations)? {
                self.remove(literal.belief, row);
            }
        }
        Ok(Flow::Next)
    }

    // ── Time ──

    fn start_await(
        &mut self,
        place: u32,
        events: &'p [EventPattern],
        within: Option<&Expr>,
    ) -> Result<Flow, Cause> {
        let timer = within.map(|e| self.time(place, e)).transpose()?.map(|t| self.set_timer(place, t));
        self.mind.pool.at(place).state = State::Awaiting { events, timer };
        self.awaiting.push(place);
        Ok(Flow::Suspended)
    }

    /// A time of at least 0, in nanoseconds.
    pub fn time(&self, place: u32, seconds: &Expr) -> Result<Nanos, Cause> {
        let seconds = eval(seconds, self.mind.pool.see(place).vars())?.as_f64();
        seconds.filter(|s| s.is_finite() && *s >= 0.0).map(nanos).ok_or(Cause::BadWait)
    }

    pub fn set_timer(&mut self, place: u32, time: Nanos) -> Timer {
        let timer = Timer { due: self.mind.now.saturating_add(time), serial: self.next_serial(), of: place };
        self.timers.insert(timer);
        timer
    }

    fn set_deadline(&mut self, place: u32, within: &Expr) -> Result<(), Cause> {
        let time = self.time(place, within)?;
        let timer = self.set_timer(place, time);
        let intention = self.mind.pool.at(place);
        let height = intention.frames.len() as u32;
        intention.deadlines.push(Deadline { height, timer });
        Ok(())
    }
}

/// Whether each term matches one of the annotations, in some way; what that binds is on the trail.
pub(crate) fn annotated(
    terms: &[&(Annotation, Term)],
    held: &Annotations,
    slots: &mut [Slot],
    trail: &mut Trail,
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

/// A value as it is printed: a string without its quotes.
fn plain(value: Value) -> String {
    match value {
        Value::Text(text) => text.as_str().to_owned(),
        Value::Bool(_) | Value::Int(_) | Value::Float(_) | Value::Symbol(_) | Value::List(_) => {
            value.to_string()
        }
    }
}

/// The slots that the terms of a test goal's plan stand for at its end, for the query that asked.
pub(crate) fn answers(trigger: &[Term], asked: &[Slot], slots: &[Slot]) -> Args {
    let answer = |(term, asked): (&Term, &Slot)| match term {
        Term::Any => *asked,
        Term::Var(_) | Term::Expr(_) | Term::List(..) => known(term, slots).or(*asked),
    };
    trigger.iter().zip(asked).map(answer).collect()
}
