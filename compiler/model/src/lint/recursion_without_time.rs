//! HR0410: a goal that comes back to itself at the same instant, with nothing changed.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::{Code, Diagnostic, Span};

use super::{
    agent_facts::{AgentFacts, agents, all_steps, change},
    dead_plan::never_runs,
    facts::Facts,
    plan_terms::{Term, of_args, of_exprs, same_value},
};
use crate::{Arg, Context, GoalId, Internal, Plan, Scenario, Step, StepKind, TriggerOn, Value};

/// Longer ways back are not looked for.
const DEEP: usize = 8;

/// So many triggers are followed from one step.
const FAR: usize = 400;

/// So many adoptions are followed in one agent.
const MANY: usize = 20_000;

pub(crate) fn check<'a>(scenario: &'a Scenario, all: &'a Facts<'a>, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario, all) {
        for plan in facts.agent.plans.iter().filter(|p| !never_runs(&facts, p)) {
            let endless = all_steps(&plan.body).into_iter().filter(|step| is_endless(&facts, step));
            issues.extend(endless.map(|step| endless_loop(step.origin)));
        }
        let (mut left, mut progress, mut said) = (MANY, BTreeMap::new(), BTreeSet::new());
        for start in &facts.agent.plans {
            if let TriggerOn::GoalAdded(goal) = start.trigger.on
                && !never_runs(&facts, start)
            {
                let args: Vec<Passed> = start.trigger.args.iter().enumerate().map(Passed::at_start).collect();
                let (left, progress, said) = (&mut left, &mut progress, &mut said);
                let way = Vec::new();
                let mut search =
                    Search { facts, start, goal, args: &args, way, left, progress, said, issues };
                search.from(start, &args);
            }
        }
    }
}

/// What a goal's argument is, in terms of those at the start of the cycle.
#[derive(Clone, Debug, PartialEq)]
enum Passed {
    /// The argument with this number.
    Same(usize),
    Const(Value),
    /// Computed or looked up on the way.
    New,
}

impl Passed {
    fn at_start((i, arg): (usize, &Arg)) -> Self {
        match Term::of_arg(arg) {
            Term::Const(value) => Passed::Const(value),
            Term::Any | Term::Var(_) | Term::Other(_) | Term::Part => Passed::Same(i),
        }
    }

    fn may_match(&self, term: Term<'_>) -> bool {
        match (self, term) {
            (Passed::Const(a), Term::Const(b)) => same_value(*a, b),
            (Passed::Same(_) | Passed::Const(_) | Passed::New, _) => true,
        }
    }
}

struct Search<'a, 'i> {
    facts: AgentFacts<'a>,
    /// The first plan of the cycle in the text: so each cycle is found once.
    start: &'a Plan,
    goal: GoalId,
    args: &'i [Passed],
    /// The plans and adoptions on the way.
    way: Vec<(&'a Plan, Span)>,
    /// How many adoptions are still followed.
    left: &'i mut usize,
    /// By goal: whether its plans let time pass or change a belief.
    progress: &'i mut BTreeMap<GoalId, bool>,
    /// The cycles that are said already, by their places.
    said: &'i mut BTreeSet<Vec<Span>>,
    issues: &'i mut Vec<Diagnostic>,
}

impl<'a> Search<'a, '_> {
    /// Follows the adoptions of a plan that are reached at the same instant with the same beliefs.
    fn from(&mut self, plan: &'a Plan, passed: &[Passed]) {
        self.follow(plan, passed, &plan.body);
    }

    /// Whether something may change on the way through the steps.
    fn follow(&mut self, plan: &'a Plan, passed: &[Passed], steps: &'a [Step]) -> bool {
        for step in steps {
            if let StepKind::Achieve { goal, args, within: _ } = &step.kind {
                let args: Vec<Passed> = of_exprs(args).into_iter().map(|t| given(plan, passed, t)).collect();
                self.way.push((plan, step.origin));
                self.adopted(*goal, &args, step.origin);
                self.way.pop();
            }
            for block in step.blocks() {
                self.follow(plan, passed, block);
            }
            if self.progresses(step) {
                return true;
            }
        }
        false
    }

    fn progresses(&mut self, step: &Step) -> bool {
        let StepKind::Achieve { goal, .. } = &step.kind else {
            return progresses(&self.facts, step, &mut BTreeSet::new());
        };
        if let Some(known) = self.progress.get(goal) {
            return *known;
        }
        let found = progresses(&self.facts, step, &mut BTreeSet::new());
        self.progress.insert(*goal, found);
        found
    }

    fn adopted(&mut self, goal: GoalId, args: &[Passed], span: Span) {
        if goal == self.goal && args == self.args {
            let issue = self.issue(span);
            if self.said.insert(issue.labels.iter().map(|l| l.span).collect()) {
                self.issues.push(issue);
            }
            return;
        }
        if self.way.len() > DEEP || *self.left == 0 {
            return;
        }
        *self.left -= 1;
        let facts = self.facts;
        for plan in facts.plans(TriggerOn::GoalAdded(goal)) {
            let later = plan.origin.start > self.start.origin.start;
            let again = self.way.iter().any(|(p, _)| std::ptr::eq(*p, plan));
            let fits = args.iter().zip(of_args(&plan.trigger.args)).all(|(a, t)| a.may_match(t));
            if later && !again && fits {
                self.from(plan, args);
            }
        }
    }

    fn issue(&self, span: Span) -> Diagnostic {
        let name = self.facts.goal(self.goal);
        let message = format!("the goal `!{name}` comes back to itself, and no time passes");
        let mut issue = Diagnostic::warning(Code::NO_TIME_PASSES, span, message)
            .here("adopted again, at the same instant and with nothing changed");
        issue = issue.label(self.start.trigger.origin, "the cycle begins here");
        for (_, through) in self.way.iter().filter(|(_, at)| *at != span) {
            issue = issue.label(*through, "and goes on here");
        }
        issue.help(
            "let something happen on the path: a stimulus, an `await`, a `wait`, or a change of a belief",
        )
    }
}

/// A `while` whose body does nothing that could change the answer of its condition, nor fails.
fn is_endless(facts: &AgentFacts<'_>, step: &Step) -> bool {
    let StepKind::While { condition, body } = &step.kind else { return false };
    let quiet = |step: &&Step| match &step.kind {
        StepKind::Print { .. } => true,
        StepKind::Do { .. }
        | StepKind::If { .. }
        | StepKind::For { .. }
        | StepKind::Fork { .. }
        | StepKind::While { .. } => !progresses(facts, step, &mut BTreeSet::new()),
        StepKind::Achieve { .. }
        | StepKind::Spawn { .. }
        | StepKind::Query(_)
        | StepKind::Test(_)
        | StepKind::Add(_)
        | StepKind::Remove(_)
        | StepKind::Replace(_)
        | StepKind::Abolish(_)
        | StepKind::Await { .. }
        | StepKind::Wait { .. }
        | StepKind::Send { .. }
        | StepKind::Ask { .. }
        | StepKind::AskAll { .. }
        | StepKind::Control { .. }
        | StepKind::Fail => false,
    };
    !draws(condition) && all_steps(body).iter().all(quiet)
}

fn endless_loop(span: Span) -> Diagnostic {
    let message = "this loop never ends once it has begun, and no time passes";
    Diagnostic::warning(Code::NO_TIME_PASSES, span, message)
        .here("nothing in it changes what its condition asks")
        .help("let the body change a belief, or let time pass: a stimulus, an `await`, a `wait`")
}

/// Whether a formula's answer may be another one each time.
fn draws(condition: &Context) -> bool {
    let mut draws = false;
    condition.each(&mut |part| {
        if let Context::Internal(action, _) = part {
            draws |= matches!(
                **action,
                Internal::Random { .. }
                    | Internal::Shuffle { .. }
                    | Internal::Intend { .. }
                    | Internal::Desire { .. }
                    | Internal::Suspended { .. }
            );
        }
    });
    draws
}

/// What an argument of an adoption is, in a plan whose goal has these arguments.
fn given(plan: &Plan, passed: &[Passed], term: Term<'_>) -> Passed {
    match term {
        Term::Const(value) => Passed::Const(value),
        Term::Var(var) => {
            let at = plan.trigger.args.iter().position(|arg| *arg == Arg::Var(var));
            at.and_then(|at| passed.get(at)).cloned().unwrap_or(Passed::New)
        }
        Term::Any | Term::Other(_) | Term::Part => Passed::New,
    }
}

/// Whether time may pass in a step, or a belief change.
fn progresses(facts: &AgentFacts<'_>, step: &Step, seen: &mut BTreeSet<TriggerOn>) -> bool {
    let on = match &step.kind {
        StepKind::Do { event, args: _ } => {
            return facts.scenario.events[usize::from(event.0)].stimulus.is_some();
        }
        // A message may be answered by another; what is dropped or suspended may be this goal.
        StepKind::Await { .. }
        | StepKind::Wait { .. }
        | StepKind::Send { .. }
        | StepKind::Ask { .. }
        | StepKind::AskAll { .. }
        | StepKind::Control { .. }
        | StepKind::Fail => return true,
        StepKind::Add(..) | StepKind::Remove(..) | StepKind::Replace(..) | StepKind::Abolish(_) => {
            return change(step).is_some();
        }
        StepKind::Spawn { .. } | StepKind::Print { .. } => return false,
        // What is drawn at random may be another thing each time.
        StepKind::Test(condition) => return draws(condition),
        StepKind::If { .. } | StepKind::While { .. } | StepKind::For { .. } | StepKind::Fork { .. } => {
            return step.condition().is_some_and(draws)
                || step.blocks().into_iter().flatten().any(|inner| progresses(facts, inner, seen));
        }
        StepKind::Achieve { goal, .. } => TriggerOn::GoalAdded(*goal),
        StepKind::Query(l) => TriggerOn::TestAdded(l.belief),
    };
    // Where there is that much on the way, something may well change.
    if seen.len() == FAR || !facts.work(1) {
        return true;
    }
    if !seen.insert(on) {
        return false;
    }
    let failed = match on {
        TriggerOn::GoalAdded(goal) => Some(TriggerOn::GoalFailed(goal)),
        TriggerOn::BeliefAdded(_)
        | TriggerOn::BeliefRemoved(_)
        | TriggerOn::GoalFailed(_)
        | TriggerOn::TestAdded(_)
        | TriggerOn::TestFailed(_)
        | TriggerOn::Perceived(_) => None,
    };
    [Some(on), failed]
        .into_iter()
        .flatten()
        .any(|on| facts.plans(on).any(|p| p.body.iter().any(|step| progresses(facts, step, seen))))
}
