//! Messages between agents: speech acts sent, and what they do to who hears them.

use hrdsl_ir::{
    Expr, List, Span, Symbol, Value,
    bdi::{
        AgentTerm, BeliefAnnotation, BeliefId, BeliefLiteral, ContentId, ControlAct, GoalId, MessageSubject,
        Performative, PlanStepKind, TriggerOn, source_self,
    },
    expr::EvalError,
    list::same,
};

use smallvec::{SmallVec, smallvec};

use crate::{
    belief::{FactAnnotations, GroundArguments, from as told_by, typed},
    code::PlanOp,
    cycle::AgentMachine,
    event::{EventArguments, OutgoingMail, QueuedEvent, ReplyAddress, SpeechAct},
    intention::IntentionState,
    log::{FailureCause, LogDetail, LogItem, sources},
    mind::agree,
    query::{BeliefQueryError, QuerySolver},
    step::{StepFlow, StepLocation},
    unify::{BindingTrail, VariableSlot, eval, known, unify, unify_all},
};

/// Whether the performative is about a goal.
fn is_of_goal(performative: Performative) -> bool {
    match performative {
        Performative::Achieve | Performative::Unachieve => true,
        Performative::Tell | Performative::Untell | Performative::AskOne | Performative::AskAll => false,
    }
}

impl<'p> AgentMachine<'p> {
    /// What the content is to the agent at this place.
    fn subject(&self, content: ContentId, place: u16) -> Option<MessageSubject> {
        let (_, id) = self.mind.me.peers.agents.get(usize::from(place))?;
        let content = self.mind.program.contents.get(usize::from(content.0))?;
        content.of.get(usize::from(id.0)).copied().flatten()
    }

    fn belief(&self, content: ContentId) -> Option<BeliefId> {
        match self.subject(content, self.mind.me.place)? {
            MessageSubject::Belief(belief) => Some(belief),
            MessageSubject::Goal(_) => None,
        }
    }

    fn goal(&self, content: ContentId) -> Option<GoalId> {
        match self.subject(content, self.mind.me.place)? {
            MessageSubject::Goal(goal) => Some(goal),
            MessageSubject::Belief(_) => None,
        }
    }

    fn receiver(&self, place: u32, to: &Expr) -> Result<u16, FailureCause> {
        let value = eval(to, self.mind.pool.see(place).vars())?;
        let own = |name: Symbol| (name == source_self()).then_some(self.mind.me.place);
        let found = value.as_symbol().and_then(|name| own(name).or_else(|| self.mind.me.peers.place(name)));
        found.ok_or(FailureCause::NoSuchAgent(value))
    }

    pub fn say(&mut self, to: u16, speech: SpeechAct) {
        self.outbox.push(OutgoingMail { to, speech });
    }

    // ── Sending ──

    pub fn send(
        &mut self,
        here: StepLocation,
        to: Option<&Expr>,
        performative: Performative,
        (content, args, annotations): (ContentId, &[AgentTerm], &[(String, Expr)]),
    ) -> Result<StepFlow, FailureCause> {
        let suits = |subject: Option<MessageSubject>| match subject {
            Some(MessageSubject::Goal(_)) => is_of_goal(performative),
            Some(MessageSubject::Belief(_)) => !is_of_goal(performative),
            None => false,
        };
        let receivers: SmallVec<[u16; 4]> = match to {
            Some(to) => {
                let to = self.receiver(here.place, to)?;
                if !suits(self.subject(content, to)) {
                    return Err(FailureCause::NoSuchContent(self.name_of(to)));
                }
                smallvec![to]
            }
            None => {
                let all = 0..self.mind.me.peers.agents.len() as u16;
                all.filter(|p| *p != self.mind.me.place && suits(self.subject(content, *p))).collect()
            }
        };
        let is_question = matches!(performative, Performative::AskOne | Performative::AskAll);
        if is_question && self.belief(content).is_none() {
            return Err(FailureCause::NoSuchContent(self.mind.me.name));
        }
        let closed = matches!(performative, Performative::Tell | Performative::Achieve);
        let args = self.content(here.place, args, closed)?;
        let slots = self.mind.pool.see(here.place).vars();
        let marks: Vec<(&str, Value)> = annotations
            .iter()
            .map(|(name, e)| Ok((name.as_str(), eval(e, slots)?)))
            .collect::<Result<_, EvalError>>()?;
        let before = self.outbox.len();
        for to in receivers {
            let args = if closed { self.fitting(content, to, &args) } else { Ok(args.clone()) };
            let suiting = args.and_then(|args| Ok((args, self.fitting_annotations(content, to, &marks)?)));
            match suiting {
                Ok((args, annotations)) => {
                    self.say(to, SpeechAct::Say { performative, content, args, annotations });
                }
                Err(cause) => {
                    // Nothing is sent if it does not suit everybody.
                    self.outbox.truncate(before);
                    return Err(cause);
                }
            }
        }
        self.measure(|m| *m.sent.entry((here.plan, here.site)).or_default() += 1);
        Ok(StepFlow::Next)
    }

    /// The values that are known; all must be, if it is `closed`.
    fn content(&self, place: u32, terms: &[AgentTerm], closed: bool) -> Result<EventArguments, FailureCause> {
        let slots = self.mind.pool.see(place).vars();
        crate::unify::well_bound(terms, slots)?;
        let mut args = EventArguments::new();
        for term in terms {
            let value = if closed && let AgentTerm::Expr(expr) = term {
                Some(eval(expr, slots)?)
            } else {
                known(term, slots)
            };
            if closed && value.is_none() {
                let variable = if let AgentTerm::Var(v) = term { *v } else { u16::MAX };
                return Err(FailureCause::NoValue(EvalError::Unbound(variable)));
            }
            args.push(value);
        }
        Ok(args)
    }

    /// The values, as the receiver declares them.
    fn fitting(
        &self,
        content: ContentId,
        to: u16,
        args: &EventArguments,
    ) -> Result<EventArguments, FailureCause> {
        let (_, id) = self.mind.me.peers.agents[usize::from(to)];
        let agent = &self.mind.program.agents[usize::from(id.0)];
        let params = match self.subject(content, to) {
            Some(MessageSubject::Belief(belief)) => Some(&agent.beliefs[usize::from(belief.0)].params),
            Some(MessageSubject::Goal(goal)) => agent.goals[usize::from(goal.0)].params.as_ref(),
            None => None,
        };
        let Some(params) = params else { return Ok(args.clone()) };
        let ground: GroundArguments = args.iter().copied().flatten().collect();
        let typed = typed(params, ground).ok_or(FailureCause::OutOfRange)?;
        Ok(typed.into_iter().map(Some).collect())
    }

    /// The annotations, as the receiver declares them.
    fn fitting_annotations(
        &self,
        content: ContentId,
        to: u16,
        marks: &[(&str, Value)],
    ) -> Result<FactAnnotations, FailureCause> {
        let (_, id) = self.mind.me.peers.agents[usize::from(to)];
        let Some(MessageSubject::Belief(belief)) = self.subject(content, to) else {
            return Ok(FactAnnotations::new());
        };
        let declared =
            &self.mind.program.agents[usize::from(id.0)].beliefs[usize::from(belief.0)].annotations;
        let fit = |(name, value): &(&str, Value)| {
            let at = declared.iter().position(|p| p.name == *name).ok_or(FailureCause::OutOfRange)?;
            let one = typed(&declared[at..=at], GroundArguments::from_slice(&[*value]));
            let place = u16::try_from(at).unwrap_or(u16::MAX);
            Ok((BeliefAnnotation::Declared(place), one.ok_or(FailureCause::OutOfRange)?[0]))
        };
        marks.iter().map(fit).collect()
    }

    pub fn ask(
        &mut self,
        here: StepLocation,
        to: &Expr,
        content: ContentId,
        args: &[AgentTerm],
        within: Option<&Expr>,
        all: bool,
    ) -> Result<StepFlow, FailureCause> {
        let to = self.receiver(here.place, to)?;
        if !matches!(self.subject(content, to), Some(MessageSubject::Belief(_))) {
            return Err(FailureCause::NoSuchContent(self.name_of(to)));
        }
        let args = self.content(here.place, args, false)?;
        let time = within.map(|e| self.time(here.place, e)).transpose()?;
        let question = self.next_serial();
        let timer = time.map(|t| self.set_timer(here.place, t));
        self.mind.pool.at(here.place).state = IntentionState::Asking { question, timer };
        self.say(to, SpeechAct::Ask { question, content, args, all });
        self.measure(|m| *m.sent.entry((here.plan, here.site)).or_default() += 1);
        Ok(StepFlow::Suspended)
    }

    // ── Hearing ──

    pub fn hear(&mut self, from: u16, speech: SpeechAct) {
        match speech {
            SpeechAct::Say { performative, content, args, annotations } => {
                if self.log.detail >= LogDetail::Steps {
                    let (args, annotations) = (args.clone(), annotations.clone());
                    self.enter(0, LogItem::Heard { from, performative, content, args, annotations });
                }
                self.measure(|m| *m.received.entry((performative, content)).or_default() += 1);
                self.obey(from, performative, content, (args, annotations));
            }
            SpeechAct::Ask { question, content, args, all } => {
                let asked = args.clone();
                self.entry(0, || LogItem::Asked { from, content, args: asked, all });
                let performative = if all { Performative::AskAll } else { Performative::AskOne };
                self.measure(|m| *m.received.entry((performative, content)).or_default() += 1);
                self.reply(from, content, args, Some(question), all);
            }
            SpeechAct::Answer { question, content, all, answers } => {
                let given = answers.clone();
                self.entry(0, || LogItem::Answered { from, content, all, answers: given });
                self.learn(question, answers.as_deref());
            }
        }
    }

    fn obey(
        &mut self,
        from: u16,
        performative: Performative,
        content: ContentId,
        (args, mut annotations): (EventArguments, FactAnnotations),
    ) {
        let me = from == self.mind.me.place;
        let name = Value::Symbol(if me { source_self() } else { self.name_of(from) });
        match performative {
            Performative::Tell => {
                let Some(belief) = self.belief(content) else { return };
                let ground: GroundArguments = args.iter().copied().flatten().collect();
                annotations.extend(told_by(name));
                match self.declared(belief, ground.clone()) {
                    Some(args) => self.believe(belief, &args, annotations),
                    None => self.enter(0, LogItem::Refused { belief, args: ground.into_vec() }),
                }
            }
            Performative::Untell => {
                if let Some(belief) = self.belief(content) {
                    self.untell(belief, &args, name);
                }
            }
            Performative::Achieve => {
                let Some(goal) = self.goal(content) else { return };
                let told = name.as_symbol();
                self.post(QueuedEvent { told, ..QueuedEvent::new(TriggerOn::GoalAdded(goal), args) });
            }
            Performative::Unachieve => {
                if let Some(goal) = self.goal(content) {
                    self.control_goal(ControlAct::DropDesire, goal, &args);
                }
            }
            Performative::AskOne => self.reply(from, content, args, None, false),
            Performative::AskAll => self.reply(from, content, args, None, true),
        }
    }

    /// The first fact that matches and has the source loses it.
    fn untell(&mut self, belief: BeliefId, args: &EventArguments, source: Value) {
        let mut kept = None;
        for row in self.mind.beliefs.of(belief).iter().collect::<Vec<_>>() {
            let rows = self.mind.beliefs.of(belief);
            let values: Vec<VariableSlot> = rows.row(row).iter().map(|v| Some(*v)).collect();
            if !agree(&values, args) {
                continue;
            }
            if sources(rows.annotations(row)).iter().any(|s| same(*s, source)) {
                return self.take(belief, row, source);
            }
            kept = kept.or(Some(row));
        }
        if let Some(row) = kept {
            let rows = self.mind.beliefs.of(belief);
            let (args, from) = (rows.row(row).to_vec(), sources(rows.annotations(row)));
            self.enter(0, LogItem::StillHeld { belief, args, meant: Some(source), from });
        }
    }

    fn name_of(&self, place: u16) -> Symbol {
        self.mind.me.peers.agents[usize::from(place)].0
    }

    /// Answers a question from what is believed; a single answer also by the plans for the test goal.
    fn reply(&mut self, to: u16, content: ContentId, args: EventArguments, question: Option<u64>, all: bool) {
        let reply = ReplyAddress { to, content, question };
        let Some(belief) = self.belief(content) else { return self.answer_nothing(reply) };
        let found = match self.answers_to(belief, &args, all) {
            Ok(found) => found,
            Err(fault) => {
                self.enter(0, LogItem::FaultyAnswer { belief, fault });
                return self.answer_nothing(reply);
            }
        };
        if found.is_empty() && !all && self.plans_answer(belief) {
            self.post(QueuedEvent::new(TriggerOn::TestAdded(belief), args).asked(reply));
        } else if found.is_empty() && !all {
            self.answer_nothing(reply);
        } else if let Some(question) = question {
            self.say(to, SpeechAct::Answer { question, content, all, answers: Some(found) });
        } else {
            found.into_iter().for_each(|args| self.tell_back(reply, &args));
        }
    }

    /// Tells who asked, if the answer suits its belief.
    fn tell_back(&mut self, reply: ReplyAddress, args: &EventArguments) {
        let ReplyAddress { to, content, .. } = reply;
        if let (Some(MessageSubject::Belief(_)), Ok(args)) =
            (self.subject(content, to), self.fitting(content, to, args))
        {
            let annotations = FactAnnotations::new();
            self.say(to, SpeechAct::Say { performative: Performative::Tell, content, args, annotations });
        }
    }

    /// The plan for a test goal that another agent asked for has this answer; what it left open, the belief base is
    /// asked.
    pub fn answer(&mut self, reply: ReplyAddress, answer: &EventArguments) -> Result<(), FailureCause> {
        let mut whole = answer.clone();
        if answer.iter().any(Option::is_none) {
            let belief = self.belief(reply.content).ok_or(FailureCause::NoAnswer)?;
            whole = self.answers_to(belief, answer, false)?.pop().ok_or(FailureCause::NoAnswer)?;
        }
        let content = reply.content;
        match reply.question {
            Some(question) => {
                let answers = Some(vec![whole]);
                self.say(reply.to, SpeechAct::Answer { question, content, all: false, answers });
            }
            None => self.tell_back(reply, &whole),
        }
        Ok(())
    }

    /// The first fact that follows, or all.
    fn answers_to(
        &mut self,
        belief: BeliefId,
        args: &EventArguments,
        all: bool,
    ) -> Result<Vec<EventArguments>, BeliefQueryError> {
        let terms = (0..args.len() as u16).map(AgentTerm::Var).collect();
        let literal = BeliefLiteral { belief, args: terms, annotations: Vec::new(), origin: Span::default() };
        let mut solver = QuerySolver::default();
        solver.with(args);
        let mut found = Vec::new();
        let mut more = solver.answer(&self.mind, &mut self.dice, &literal)?;
        while more {
            found.push(EventArguments::from_slice(&solver.slots[..args.len()]));
            more = all && solver.again(&self.mind, &mut self.dice)?;
        }
        Ok(found)
    }

    /// The answer to a question comes.
    fn learn(&mut self, question: u64, answers: Option<&[EventArguments]>) {
        let asks = |state: IntentionState| matches!(state, IntentionState::Asking { question: q, .. } if q == question);
        let Some(place) = self.mind.pool.iter().find(|(_, i)| asks(i.state)).map(|(p, _)| p) else { return };
        self.detach(place);
        match answers.ok_or(FailureCause::NoAnswer).and_then(|answers| self.take_answers(place, answers)) {
            Ok(()) => self.resume(place),
            Err(cause) => self.fail(place, cause),
        }
    }

    fn take_answers(&mut self, place: u32, answers: &[EventArguments]) -> Result<(), FailureCause> {
        let Some(top) = self.mind.pool.see(place).frames.last().copied() else { return Ok(()) };
        let line = self.mind.library.code(top.plan).get(usize::from(top.at));
        let Some(PlanOp::Plain(step)) = line.map(|l| &l.op) else { return Ok(()) };
        let step: &'p PlanStepKind = step;
        let fits = if let PlanStepKind::Ask { args, .. } = step {
            let answer = answers.first().ok_or(FailureCause::NoAnswer)?;
            let vars = self.mind.pool.at(place).vars_mut();
            unify_all(args, answer.iter().copied(), 0, vars, &mut BindingTrail::new())?
        } else if let PlanStepKind::AskAll { template, args, out, .. } = step {
            let vars = self.mind.pool.see(place).vars();
            let mut all = Vec::new();
            for answer in answers {
                let mut own = vars.to_vec();
                if unify_all(args, answer.iter().copied(), 0, &mut own, &mut BindingTrail::new())? {
                    all.push(eval(template, &own)?);
                }
            }
            let vars = self.mind.pool.at(place).vars_mut();
            unify(out, Value::List(List::of(&all)), 0, vars, &mut BindingTrail::new())?
        } else {
            // INVARIANT: only these two ask.
            true
        };
        if fits { Ok(()) } else { Err(FailureCause::NoAnswer) }
    }
}
