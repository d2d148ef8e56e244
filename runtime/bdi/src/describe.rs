//! Entries of the log as text, with names and values.

use hrdsl_ir::{
    Program, Value,
    bdi::{Agent, BeliefAnnotation, BeliefId, ContentId, GoalId, MessageSubject, TriggerOn},
    expr::EvalError,
};

use crate::{
    belief::FactAnnotations,
    code::PlanOp,
    cycle::AgentMachine,
    event::EventArguments,
    log::{ApplicabilityVerdict, FailureCause, IntentionFailure, LogEntry, LogItem, StepOutcome},
    mind::MentalState,
    query::BeliefQueryError,
    show::{FormulaPrinter, call, performative, slot},
    unify::{BindingTrail, VariableSlot, unify_all},
};

impl<'p> AgentMachine<'p> {
    /// The names of its program.
    pub(crate) fn names(&self) -> LogNames<'_, 'p> {
        LogNames { mind: &self.mind, program: self.mind.program, agent: self.mind.agent }
    }

    /// An entry of this agent's log, without time and agent.
    pub fn describe(&self, entry: &LogEntry) -> String {
        let what = self.names().entry(entry);
        let alone = matches!(&entry.what, LogItem::Selected { fresh: true, .. });
        if entry.intention == 0 || alone { what } else { format!("#{} {what}", entry.intention) }
    }
}

/// Names of a running agent's program.
pub(crate) struct LogNames<'a, 'p> {
    mind: &'a MentalState<'p>,
    program: &'p Program,
    agent: &'p Agent,
}

impl LogNames<'_, '_> {
    fn entry(&self, entry: &LogEntry) -> String {
        match &entry.what {
            LogItem::Selected { on, args, plan, vars, fresh } => {
                let begun = if *fresh { format!(" as #{}", entry.intention) } else { String::new() };
                format!("{} → {}{}{begun}", self.on(*on, args), self.plan(*plan), self.bound(*plan, vars))
            }
            LogItem::Tried { on, args, plan, verdict } => {
                format!("{}: {}", self.on(*on, args), self.verdict(*plan, args, *verdict))
            }
            LogItem::Unhandled { on, args, .. } => format!("{}: no plan is applicable", self.on(*on, args)),
            LogItem::Fault { plan, fault, .. } => {
                format!("fault in the context of {}: {}", self.plan(*plan), self.fault(*plan, *fault))
            }
            LogItem::FaultyAnswer { fault, .. } => format!("fault in an answer: {fault}"),
            LogItem::Step { plan, line, vars, outcome } => self.step(*plan, *line, vars, *outcome),
            LogItem::Failed(failure) => format!("failed {}", self.failure(failure)),
            LogItem::Finished => "finished".to_owned(),
            LogItem::Dropped => "dropped".to_owned(),
            LogItem::Added { belief, args, annotations } => {
                format!("+{}{}", call(self.belief(*belief), args), self.annotations(*belief, annotations))
            }
            LogItem::Left { belief, args } => format!("-{}", call(self.belief(*belief), args)),
            LogItem::Taken { belief, args, source } => {
                format!("-{}[source({source})]", call(self.belief(*belief), args))
            }
            LogItem::StillHeld { belief, args, meant, from } => {
                let from: Vec<String> = from.iter().map(ToString::to_string).collect();
                let fact = call(self.belief(*belief), args);
                let (meant, from) = (slot(meant), from.join(", "));
                format!("warning: -{fact} takes away {meant} only, it is held from {from}")
            }
            LogItem::Refused { belief, args } => {
                format!("warning: {} does not fit its declaration", call(self.belief(*belief), args))
            }
            LogItem::Perceived { event, args } => {
                format!("perceives {}", call(&self.program.event(*event).name, args))
            }
            LogItem::Heard { from, performative: p, content, args, annotations } => {
                let what = self.said(*content, args, annotations);
                format!("hears {} {what} from {}", performative(*p), self.peer(*from))
            }
            LogItem::Asked { from, content, args, all } => {
                let what = call(self.content(*content), args.iter().map(slot));
                let verb = if *all { "ask_all" } else { "ask" };
                format!("hears {verb} {what} from {}", self.peer(*from))
            }
            LogItem::Answered { from, content, all, answers } => {
                let one = |a: &EventArguments| call(self.content(*content), a.iter().map(slot));
                let each: Option<Vec<String>> = answers.as_ref().map(|a| a.iter().map(one).collect());
                let what = match each {
                    None => "nothing".to_owned(),
                    Some(each) if *all => format!("[{}]", each.join(", ")),
                    Some(each) => each.join(", "),
                };
                format!("hears answer {what} from {}", self.peer(*from))
            }
            LogItem::Printed(text) => format!("prints {text}"),
            LogItem::Livelock => "livelock".to_owned(),
            LogItem::Endless => "cycle bound".to_owned(),
            LogItem::Overfull(what) => format!("more than {} {what}", what.most()),
        }
    }

    fn plan(&self, index: u16) -> &str {
        &self.agent.plan(index).label
    }

    fn belief(&self, id: BeliefId) -> &str {
        &self.agent.belief(id).name
    }

    fn goal(&self, id: GoalId) -> &str {
        &self.agent.goal(id).name
    }

    fn content(&self, id: ContentId) -> &str {
        &self.program.content(id).name
    }

    fn peer(&self, place: u16) -> &'static str {
        self.mind.me.peers.agents[usize::from(place)].0.name()
    }

    pub(crate) fn on(&self, on: TriggerOn, args: &EventArguments) -> String {
        let (sign, name) = match on {
            TriggerOn::BeliefAdded(b) => ("+", self.belief(b)),
            TriggerOn::BeliefRemoved(b) => ("-", self.belief(b)),
            TriggerOn::GoalAdded(g) => ("+!", self.goal(g)),
            TriggerOn::GoalFailed(g) => ("-!", self.goal(g)),
            TriggerOn::TestAdded(b) => ("+?", self.belief(b)),
            TriggerOn::TestFailed(b) => ("-?", self.belief(b)),
            TriggerOn::Perceived(e) => ("on ", self.program.event(e).name.as_str()),
        };
        format!("{sign}{}", call(name, args.iter().map(slot)))
    }

    /// ` (N = 0, M = 2)`: the variables that have a value.
    fn bound(&self, plan: u16, vars: &[VariableSlot]) -> String {
        let plan = self.agent.plan(plan);
        let bound = plan.vars.iter().zip(vars).filter_map(|(name, v)| Some(format!("{name} = {}", (*v)?)));
        let bound: Vec<String> = bound.collect();
        if bound.is_empty() { String::new() } else { format!(" ({})", bound.join(", ")) }
    }

    fn annotations(&self, belief: BeliefId, all: &FactAnnotations) -> String {
        let declared = self.agent.belief(belief);
        let one = |(what, value): &(BeliefAnnotation, Value)| match what {
            BeliefAnnotation::Source => format!("source({value})"),
            BeliefAnnotation::Declared(at) => format!("{}({value})", declared.annotation(*at).name),
        };
        let all: Vec<String> = all.iter().map(one).collect();
        format!("[{}]", all.join(", "))
    }

    /// What was said, with its annotations if it was told.
    fn said(&self, content: ContentId, args: &EventArguments, annotations: &FactAnnotations) -> String {
        let said = call(self.content(content), args.iter().map(slot));
        match self.program.content(content).of.get(usize::from(self.mind.me.id.0)) {
            Some(Some(MessageSubject::Belief(belief))) if !annotations.is_empty() => {
                said + &self.annotations(*belief, annotations)
            }
            _ => said,
        }
    }

    /// A fact with its annotations.
    pub(crate) fn fact(
        &self,
        belief: BeliefId,
        args: &EventArguments,
        annotations: &FactAnnotations,
    ) -> String {
        call(self.belief(belief), args.iter().map(slot)) + &self.annotations(belief, annotations)
    }

    /// The step on a line of a plan, with the variables as they are.
    pub(crate) fn line(&self, plan: u16, line: u16, vars: &[VariableSlot]) -> String {
        self.step(plan, line, vars, StepOutcome::Done)
    }

    fn verdict(&self, plan: u16, args: &EventArguments, verdict: ApplicabilityVerdict) -> String {
        let label = self.plan(plan);
        match verdict {
            ApplicabilityVerdict::Unlike => format!("{label} is for other arguments"),
            ApplicabilityVerdict::Faulty(fault) => {
                format!("{label} cannot be tried, {}", self.fault(plan, fault))
            }
            ApplicabilityVerdict::Applicable => format!("{label} is applicable"),
            ApplicabilityVerdict::False { part } => {
                let plan = self.agent.plan(plan);
                let context = plan.context.conjuncts().get(part).unwrap_or(&plan.context);
                // What the event says is known; what the parts before found is not, and need not be the same each time.
                let mut slots = vec![None; plan.vars.len()];
                let likes = unify_all(
                    &plan.trigger.args,
                    args.iter().copied(),
                    0,
                    &mut slots,
                    &mut BindingTrail::default(),
                );
                if !matches!(likes, Ok(true)) {
                    slots.fill(None);
                }
                let show = FormulaPrinter {
                    program: self.program,
                    agent: self.agent,
                    names: &plan.vars,
                    slots: &slots,
                };
                format!("{label} is not applicable, `{}` has no answer", show.context(context))
            }
        }
    }

    fn failure(&self, failure: &IntentionFailure) -> String {
        let on = self.on(failure.on, &failure.args);
        let goal = match failure.on {
            TriggerOn::GoalAdded(_)
            | TriggerOn::GoalFailed(_)
            | TriggerOn::TestAdded(_)
            | TriggerOn::TestFailed(_) => &on[1..],
            TriggerOn::BeliefAdded(_) | TriggerOn::BeliefRemoved(_) | TriggerOn::Perceived(_) => on.as_str(),
        };
        let cause = if let FailureCause::NoValue(error) = failure.cause {
            self.fault(failure.plan, BeliefQueryError::NoValue(error))
        } else {
            failure.cause.to_string()
        };
        format!("{goal} in {}: {cause}", self.plan(failure.plan))
    }

    /// A fault with the name of the variable.
    fn fault(&self, plan: u16, fault: BeliefQueryError) -> String {
        let BeliefQueryError::NoValue(EvalError::Unbound(var)) = fault else { return fault.to_string() };
        if var == u16::MAX {
            return "`_` has no value".to_owned();
        }
        format!("`{}` has no value", self.agent.plan(plan).variable(var))
    }

    fn step(&self, plan: u16, line: u16, vars: &[VariableSlot], outcome: StepOutcome) -> String {
        let names = &self.agent.plan(plan).vars;
        let show = FormulaPrinter { program: self.program, agent: self.agent, names, slots: vars };
        let word = match &self.mind.library.code(plan)[usize::from(line)].op {
            PlanOp::Plain(step) => return show.step(step),
            PlanOp::Branch { .. } => "if",
            PlanOp::Enter(_) | PlanOp::While { .. } => "while",
            PlanOp::For { .. } | PlanOp::Next { .. } => "for",
            PlanOp::Fork { .. } | PlanOp::Join => "fork",
            PlanOp::Jump(_) => "jump",
        };
        match outcome {
            StepOutcome::Done | StepOutcome::Faulty => word.to_owned(),
            StepOutcome::Holds(holds) => format!("{word} {holds}"),
            StepOutcome::Answers(1) => format!("{word}: 1 answer"),
            StepOutcome::Answers(n) => format!("{word}: {n} answers"),
            StepOutcome::Branches(n) => format!("{word}: {n} branches"),
        }
    }
}
