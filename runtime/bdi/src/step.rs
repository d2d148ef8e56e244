//! Execution of one step of a plan's body.

use hrdsl_ir::{
    EventId, EventPattern, Expr, Nanos, Span, Value,
    bdi::{Assertion, BeliefId, Context, Literal, StepKind, Term, TriggerOn},
    value::nanos,
};
use smallvec::SmallVec;

use crate::{
    Action, ActionToken, Cause, Logged, Outcome,
    belief::{Annotations, sourced, typed},
    code::{Op, settle},
    cycle::Machine,
    event::{Args, Event, Ground},
    intention::{Deadline, Loop, State, Timer},
    log::sources,
    unify::{Slot, Trail, eval, known, unify_all, unify},
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

/// The same, for the arguments of a goal.
fn given(exprs: &[Expr], slots: &[Slot]) -> Result<Args, Cause> {
    let mut all = Args::new();
    for expr in exprs {
        all.push(Some(eval(expr, slots)?));
    }
    Ok(all)
}

/// Where a step is: its intention, its plan, its place in the body, and in the text.
#[derive(Clone, Copy)]
pub(crate) struct Here {
    pub place: u32,
    pub plan: u16,
    pub line: u16,
    pub site: u16,
    pub origin: Span,
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

    /// Executes lines up to the end of one step: the beginning of a loop, and the choice of its next answer, take no turn.
    fn lines(&mut self, place: u32) -> Result<Flow, Cause> {
        loop {
            let Some(top) = self.mind.pool.see(place).frames.last().copied() else { return Ok(Flow::Next) };
            let code = self.mind.library.code(top.plan);
            let Some(line) = code.get(usize::from(top.next)) else { return Ok(Flow::Next) };
            let here =
                Here { place, plan: top.plan, line: top.next, site: line.site, origin: line.origin };
            let after = settle(code, top.next + 1);
            if let Some(top) = self.mind.pool.at(place).frames.last_mut() {
                top.at = here.line;
            }
            // A copy of the little that the line has, so that the machine is free to change.
            match &line.op {
                Op::Plain(step) => {
                    let step = *step;
                    self.jump(place, after);
                    return self.plain(here, step);
                }
                Op::Branch { condition, otherwise } => {
                    let to = settle(code, *otherwise);
                    return self.branch(here, condition, after, to);
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
                    let end = settle(code, *end);
                    return self.again(here, condition, after, end);
                }
                Op::For { condition, variables } => {
                    let (condition, variables) = (*condition, variables.clone());
                    self.jump(place, after);
                    return self.each_answer(here, condition, &variables);
                }
                Op::Next { end } => {
                    let end = settle(code, *end);
                    if self.next_answer(place) {
                        self.jump(place, after);
                    } else {
                        self.jump(place, end);
                        return Ok(Flow::Next);
                    }
                }
                Op::Fork { branches, all, end } => {
                    let (branches, all, end) = (branches.clone(), *all, settle(code, *end));
                    self.jump(place, end);
                    self.done(here, Outcome::Branches(branches.len()));
                    self.fork(here, &branches, all);
                    return Ok(Flow::Suspended);
                }
                // A branch that ends is found by `resume`.
                Op::Join => return Ok(Flow::Next),
            }
        }
    }

    fn jump(&mut self, place: u32, to: u16) {
        if let Some(top) = self.mind.pool.at(place).frames.last_mut() {
            top.next = to;
        }
    }

    /// Logs the step, with the variables as they are before it.
    fn done(&mut self, here: Here, outcome: Outcome) {
        let Here { place, plan, line, .. } = here;
        if self.log.detail >= crate::Detail::Steps {
            let intention = self.mind.pool.see(place);
            let (number, vars) = (intention.number, intention.vars().to_vec());
            self.enter(number, Logged::Step { plan, line, vars, outcome });
        }
    }

    // ── Blocks ──

    /// The first answer's bindings become the plan's.
    fn holds(&mut self, place: u32, condition: &'p Context) -> Result<bool, Cause> {
        self.solver.with(self.mind.pool.see(place).vars());
        let holds = self.solver.solve(&self.mind, &mut self.dice, condition)?;
        if holds {
            let vars = self.mind.pool.at(place).vars_mut();
            vars.copy_from_slice(&self.solver.slots[..vars.len()]);
        }
        Ok(holds)
    }

    fn branch(
        &mut self,
        here: Here,
        condition: &'p Context,
        then: u16,
        otherwise: u16,
    ) -> Result<Flow, Cause> {
        self.jump(here.place, then);
        let before = self.mind.pool.see(here.place).vars().to_vec();
        let holds = self.holds(here.place, condition)?;
        self.decided(here, holds, before);
        if !holds {
            self.jump(here.place, otherwise);
        }
        Ok(Flow::Next)
    }

    fn decided(&mut self, here: Here, holds: bool, vars: Vec<Slot>) {
        let Here { place, plan, line, .. } = here;
        self.entry_of(place, || Logged::Step { plan, line, vars, outcome: Outcome::Holds(holds) });
    }

    fn enter_loop(&mut self, place: u32, variables: &[u16], answers: Vec<Slot>) {
        let intention = self.mind.pool.at(place);
        let open = variables.iter().copied().filter(|v| intention.vars()[usize::from(*v)].is_none());
        let open: SmallVec<[u16; 4]> = open.collect();
        let height = intention.frames.len() as u32;
        intention.loops.push(Loop { height, open, answers, used: 0 });
    }

    /// Opens the loop's variables.
    fn reopen(&mut self, place: u32) {
        let intention = self.mind.pool.at(place);
        let Some(open) = intention.loops.last().map(|l| l.open.clone()) else { return };
        let vars = intention.vars_mut();
        open.iter().for_each(|v| vars[usize::from(*v)] = None);
    }

    fn again(&mut self, here: Here, condition: &'p Context, body: u16, end: u16) -> Result<Flow, Cause> {
        self.jump(here.place, body);
        self.reopen(here.place);
        let before = self.mind.pool.see(here.place).vars().to_vec();
        let holds = self.holds(here.place, condition)?;
        self.decided(here, holds, before);
        if !holds {
            self.mind.pool.at(here.place).loops.pop();
            self.jump(here.place, end);
        }
        Ok(Flow::Next)
    }

    fn each_answer(
        &mut self,
        here: Here,
        condition: &'p Context,
        variables: &[u16],
    ) -> Result<Flow, Cause> {
        self.solver.with(self.mind.pool.see(here.place).vars());
        let vars = self.mind.pool.see(here.place).vars();
        let open: SmallVec<[u16; 4]> =
            variables.iter().copied().filter(|v| vars[usize::from(*v)].is_none()).collect();
        let mut answers = Vec::new();
        let mut count = 0;
        let mut found = self.solver.solve(&self.mind, &mut self.dice, condition)?;
        while found {
            answers.extend(open.iter().map(|v| self.solver.slots[usize::from(*v)]));
            count += 1;
            // A condition that is only tested is answered without a search.
            found = !matches!(condition, Context::True | Context::Test(_))
                && self.solver.again(&self.mind, &mut self.dice)?;
        }
        self.done(here, Outcome::Answers(count));
        self.enter_loop(here.place, variables, answers);
        if let Some(l) = self.mind.pool.at(here.place).loops.last_mut() {
            l.used = 0;
            if l.open.is_empty() {
                // Nothing is bound: only the number of answers matters.
                l.answers = vec![None; count];
            }
        }
        Ok(Flow::Next)
    }

    /// Binds the loop's next answer; after the last the loop is over.
    fn next_answer(&mut self, place: u32) -> bool {
        self.reopen(place);
        let intention = self.mind.pool.at(place);
        let Some(l) = intention.loops.last_mut() else { return false };
        let width = l.open.len().max(1);
        if l.used * width >= l.answers.len() {
            intention.loops.pop();
            return false;
        }
        let from = l.used * width;
        l.used += 1;
        let (open, answer) = (l.open.clone(), l.answers[from..from + width].to_vec());
        let vars = intention.vars_mut();
        open.iter().zip(answer).for_each(|(v, value)| vars[usize::from(*v)] = value);
        true
    }

    fn fork(&mut self, here: Here, branches: &[u16], all: bool) {
        let parent = self.mind.pool.at(here.place);
        let Some(frame) = parent.frames.last().copied() else { return };
        let (args, vars) = (parent.args(frame).to_vec(), parent.vars().to_vec());
        parent.state = State::Forked { left: branches.len() as u32, all };
        let suspended = parent.suspended;
        let mut children = SmallVec::new();
        for start in branches {
            let child = self.mind.pool.adopt();
            children.push(child);
            let first = settle(self.mind.library.code(frame.plan), *start);
            let intention = self.mind.pool.at(child);
            intention.push(frame.plan, first, &args, &vars);
            intention.frames[0].branch = true;
            intention.frames[0].under = frame.under;
            (intention.parent, intention.suspended) = (Some(here.place), suspended);
        }
        self.mind.pool.at(here.place).children = children.clone();
        for child in children {
            // An earlier branch that ended at once may have dropped it.
            if self.mind.pool.see(child).parent == Some(here.place) {
                self.resume(child);
            }
        }
    }

    // ── Plain steps ──

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
            StepKind::Achieve { goal, args, within } => {
                let args = given(args, slots)?;
                if let Some(within) = within {
                    self.set_deadline(place, within)?;
                }
                self.post_goal(here, TriggerOn::GoalAdded(*goal), args, Some(place));
                Ok(Flow::Suspended)
            }
            StepKind::Spawn { goal, args } => {
                let args = given(args, slots)?;
                self.post_goal(here, TriggerOn::GoalAdded(*goal), args, None);
                Ok(Flow::Next)
            }
            StepKind::Query(literal) => self.query(here, literal),
            StepKind::Test(condition) => {
                if self.holds(place, condition)? { Ok(Flow::Next) } else { Err(Cause::NoMatch) }
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
                self.entry_of(place, || Logged::Printed(text));
                Ok(Flow::Next)
            }
            StepKind::Control { what, goal } => self.control(place, *what, goal.as_ref()),
            StepKind::Fail => Err(Cause::Told),
            // INVARIANT: blocks are lines of their own.
            StepKind::If { .. } | StepKind::While { .. } | StepKind::For { .. } | StepKind::Fork { .. } => {
                Ok(Flow::Next)
            }
        }
    }

    fn post_goal(&mut self, here: Here, on: TriggerOn, args: Args, of: Option<u32>) {
        let by = Some((here.plan, here.site));
        self.post(Event { on, args, annotations: None, of, origin: here.origin, by, reply: None });
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
            if let hrdsl_ir::bdi::Annotation::Declared(at) = what {
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
        if self.mind.library.relevant(on).is_empty() {
            return Err(Cause::NoAnswer(literal.belief));
        }
        // A term that computes with a variable which this literal binds is compared with the answer.
        let slots = self.mind.pool.see(place).vars();
        let asked: Args = literal.args.iter().map(|term| known(term, slots)).collect();
        self.post_goal(here, on, asked, Some(place));
        Ok(Flow::Suspended)
    }

    /// Takes one source away from the first fact that has it.
    fn forget(&mut self, place: u32, literal: &'p Literal) -> Result<Flow, Cause> {
        let belief = literal.belief;
        self.solver.with(self.mind.pool.see(place).vars());
        let rows = self.matching(literal)?;
        let source = self.source_of(literal);
        for row in &rows {
            let held = sources(self.mind.beliefs.of(belief).annotations(*row));
            let gone = match source {
                Some(Some(wanted)) => held.into_iter().find(|s| hrdsl_ir::list::same(*s, wanted)),
                Some(None) => held.first().copied(),
                None => {
                    let own = Value::Symbol(hrdsl_ir::bdi::source_self());
                    held.into_iter().find(|s| hrdsl_ir::list::same(*s, own))
                }
            };
            if let Some(gone) = gone {
                let fact = Ground::from_slice(self.mind.beliefs.of(belief).row(*row));
                if self.mind.beliefs.of_mut(belief).withdraw(*row, gone) {
                    self.left(belief, &fact);
                }
                return Ok(Flow::Next);
            }
        }
        if let Some(row) = rows.first() {
            let facts = self.mind.beliefs.of(belief);
            let (args, from) = (facts.row(*row).to_vec(), sources(facts.annotations(*row)));
            let number = self.mind.pool.see(place).number;
            self.enter(number, Logged::StillHeld { belief, args, from });
        }
        Ok(Flow::Next)
    }

    /// The source that the literal names: `Some(None)` is any.
    fn source_of(&self, literal: &Literal) -> Option<Option<Value>> {
        let of = literal.annotations.iter().find(|(what, _)| *what == hrdsl_ir::bdi::Annotation::Source);
        of.map(|(_, term)| known(term, &self.solver.slots))
    }

    /// The facts that match, oldest first, with the variables that the solver holds; nothing is bound.
    fn matching(&mut self, literal: &'p Literal) -> Result<Vec<usize>, Cause> {
        crate::unify::well_bound(&literal.args, &self.solver.slots)?;
        let rows = self.mind.beliefs.of(literal.belief);
        let mut found = Vec::new();
        for row in rows.iter() {
            let mut slots = self.solver.slots.clone();
            let args = rows.row(row).iter().map(|v| Some(*v));
            if !unify_all(&literal.args, args, 0, &mut slots, &mut Trail::new())? {
                continue;
            }
            let mut all = true;
            for (what, term) in &literal.annotations {
                let mut one = false;
                for (held, value) in rows.annotations(row) {
                    let mut slots = slots.clone();
                    one = one || (held == what && unify(term, *value, 0, &mut slots, &mut Trail::new())?);
                }
                all = all && one;
            }
            if all {
                found.push(row);
            }
        }
        Ok(found)
    }

    fn replace(&mut self, place: u32, assertion: &Assertion) -> Result<Flow, Cause> {
        let (args, annotations) = self.asserted(place, assertion)?;
        let belief = assertion.belief;
        for row in self.mind.beliefs.of(belief).others(&args) {
            let fact = Ground::from_slice(self.mind.beliefs.of(belief).row(row));
            self.mind.beliefs.of_mut(belief).remove(row);
            self.left(belief, &fact);
        }
        self.believe(belief, &args, annotations);
        Ok(Flow::Next)
    }

    fn abolish(&mut self, place: u32, literal: &'p Literal) -> Result<Flow, Cause> {
        self.solver.with(self.mind.pool.see(place).vars());
        for row in self.matching(literal)? {
            let fact = Ground::from_slice(self.mind.beliefs.of(literal.belief).row(row));
            self.mind.beliefs.of_mut(literal.belief).remove(row);
            self.left(literal.belief, &fact);
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
