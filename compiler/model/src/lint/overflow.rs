//! HR0209: a value that leaves its range whenever it is worked out. HR0210: one that may.

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::{
    facts::ScenarioFacts, flow::ValueFlow, interval::IntervalEnv, plan_terms::tested, triggers::matched,
};
use crate::{
    EventId, Parameter, Scenario, Type, TypedAgent, TypedAutomaton, TypedContext, TypedEvent, TypedExpr,
    TypedStep, TypedStepKind, TypedStimulusStep, TypedSync, TypedTerm, TypedUpdate, VariableRef,
    interval::ValueInterval,
};

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    let mut checker = OverflowChecker { scenario, issues };
    scenario.events.iter().for_each(|e| checker.stimulus(e));
    scenario.agents.iter().for_each(|a| checker.agent(a));
    for (automaton, flow) in scenario.automata.iter().zip(&facts.flows) {
        checker.automaton(automaton, flow);
    }
    checker.rules();
}

struct OverflowChecker<'a> {
    scenario: &'a Scenario,
    issues: &'a mut Vec<Diagnostic>,
}

impl<'a> OverflowChecker<'a> {
    /// Compares a value with the range of what it is for.
    fn fits(&mut self, env: &IntervalEnv<'_>, e: &TypedExpr, ty: Type, what: &str) {
        let Type::Int { .. } = ty else { return };
        // A constant has been looked at where it was resolved.
        if e.constant().is_some() {
            return;
        }
        let (value, range) = (env.eval(e), ValueInterval::of(ty));
        if value.within(range) {
            return;
        }
        let (shown, of) = (shown(value), shown(range));
        let issue = if value.meet(range).is_none() {
            let message = format!("this leaves the range of {what}: it is {shown}, and the range {of}");
            Diagnostic::error(DiagnosticCode::OVERFLOW, e.span, message)
        } else if reads_open(env, e) {
            return;
        } else {
            let message =
                format!("this may leave the range of {what}: it can be {shown}, and the range is {of}");
            Diagnostic::warning(DiagnosticCode::MAY_OVERFLOW, e.span, message)
        };
        self.issues.push(issue.help("compare it first, in a condition with `when`, or widen the range"));
    }

    fn args(&mut self, env: &IntervalEnv<'_>, args: &[TypedExpr], params: &[Parameter]) {
        for (arg, param) in args.iter().zip(params) {
            self.fits(env, arg, param.ty, &format!("the parameter `{}`", param.name));
        }
    }

    fn params(&self, event: EventId) -> &'a [Parameter] {
        self.scenario.events.get(usize::from(event.0)).map_or(&[], |e| &e.params)
    }

    // ── automata ──

    fn automaton(&mut self, automaton: &TypedAutomaton, flow: &ValueFlow) {
        for edge in &automaton.edges {
            let Some(mut env) = flow.taken(edge) else { continue };
            match &edge.sync {
                TypedSync::Send { event, args } => self.args(&env, args, self.params(*event)),
                TypedSync::Offer { channel, args } => {
                    let channel = self.scenario.channels.get(usize::from(channel.0));
                    for (arg, param) in args.iter().zip(channel.map_or(&[][..], |c| &c.params)) {
                        self.fits(&env, arg, param.ty(), &format!("the parameter `{}`", param.name));
                    }
                }
                TypedSync::Internal
                | TypedSync::Receive { .. }
                | TypedSync::Accept { .. }
                | TypedSync::Join { .. } => {}
            }
            for update in &edge.updates {
                flow.disturb(&mut env, update);
                if let TypedUpdate::Assign { place, value } = update {
                    self.assigned(&env, place.slot, value, automaton);
                }
                let Some((leaf, e, range)) = flow.set_by(update) else { continue };
                match env.eval(e).meet(range) {
                    Some(value) => env.assign(leaf, value),
                    None => break,
                }
            }
        }
    }

    /// What a variable becomes, or an element that an index chooses; all of an array are of one type.
    fn assigned(
        &mut self,
        env: &IntervalEnv<'_>,
        leaf: VariableRef,
        e: &TypedExpr,
        automaton: &TypedAutomaton,
    ) {
        let var = match leaf {
            VariableRef::Own(i) => automaton.vars.get(usize::from(i)),
            VariableRef::Shared(i) => self.scenario.shared.get(usize::from(i)),
            VariableRef::Local(_) | VariableRef::Signal(_) => None,
        };
        if let Some(var) = var {
            let name = var.name.split('[').next().unwrap_or(&var.name);
            self.fits(env, e, var.ty(), &format!("`{name}`"));
        }
    }

    // ── stimuli and the world ──

    fn stimulus(&mut self, event: &TypedEvent) {
        let Some(stimulus) = &event.stimulus else { return };
        let types = event.params.iter().map(|p| p.ty).chain(stimulus.samples.iter().map(|s| s.ty));
        let env = IntervalEnv::new(&[], &[], types.map(ValueInterval::of).collect());
        self.steps(&stimulus.steps, &env);
    }

    fn steps(&mut self, steps: &[TypedStimulusStep], env: &IntervalEnv<'_>) {
        for step in steps {
            match step {
                TypedStimulusStep::Emit { event, args } => self.args(env, args, self.params(*event)),
                TypedStimulusStep::If { condition, then, otherwise } => {
                    for (steps, want) in [(then, true), (otherwise, false)] {
                        let mut env = env.clone();
                        if env.assume(condition, want) {
                            self.steps(steps, &env);
                        }
                    }
                }
                TypedStimulusStep::Hold { .. } | TypedStimulusStep::Act(_) => {}
            }
        }
    }

    fn rules(&mut self) {
        let Some(world) = &self.scenario.world else { return };
        let signals: Vec<ValueInterval> = world.signals.iter().map(|s| ValueInterval::of(s.ty)).collect();
        for rule in &world.rules {
            let mut env = IntervalEnv::new(&[], &[], Vec::new());
            env.signals = &signals;
            if rule.guard.as_ref().is_none_or(|g| env.assume(g, true)) {
                self.args(&env, &rule.args, self.params(rule.event));
            }
        }
    }

    // ── agents ──

    fn agent(&mut self, agent: &TypedAgent) {
        for plan in &agent.plans {
            let mut env = IntervalEnv::new(&[], &[], vec![ValueInterval::ALL; plan.vars.len()]);
            let matched = matched(self.scenario, agent, plan.trigger.on);
            if !bind(&mut env, &plan.trigger.args, matched) || !context(&mut env, &plan.context, agent) {
                continue;
            }
            self.plan_body(agent, &plan.body, env);
        }
    }

    fn plan_body(&mut self, agent: &TypedAgent, steps: &[TypedStep], mut env: IntervalEnv<'_>) {
        let params = |b: crate::BeliefId| agent.beliefs.get(usize::from(b.0)).map_or(&[][..], |b| &b.params);
        for step in steps {
            let kind = &step.kind;
            if let Some((event, args)) = kind.as_do() {
                self.args(&env, args, self.params(event));
            }
            if let Some(made) = kind.as_assertion() {
                self.args(&env, &made.args, params(made.belief));
            }
            if kind.as_query().is_some_and(|l| !bind(&mut env, &l.args, params(l.belief))) {
                return;
            }
            if let TypedStepKind::Test(condition) = kind
                && !context(&mut env, condition, agent)
            {
                return;
            }
            self.blocks(agent, step, &mut env);
        }
    }

    /// The steps within a step. Only the first block stands under its condition: the other one of an `if` does not.
    fn blocks(&mut self, agent: &TypedAgent, step: &TypedStep, env: &mut IntervalEnv<'_>) {
        let blocks = step.blocks();
        if blocks.is_empty() {
            return;
        }
        for (i, block) in blocks.into_iter().enumerate() {
            let mut inner = env.clone();
            let condition = step.condition().filter(|_| i == 0);
            if condition.is_none_or(|c| context(&mut inner, c, agent)) {
                self.plan_body(agent, block, inner);
            }
        }
        self.forget(step, env);
    }

    /// A name that a block binds may stand for something else afterwards; what was known before is still so.
    fn forget(&self, block: &TypedStep, env: &mut IntervalEnv<'_>) {
        let mut bound = Vec::new();
        hrdsl_ir::bdi::each_step(std::slice::from_ref(block), &mut |step| {
            if let TypedStepKind::Query(l) = &step.kind {
                bound.extend(super::plan_terms::vars_of(&l.args));
            }
            step.condition().iter().for_each(|c| c.each(&mut |part| bound.extend(part.binds())));
        });
        env.less.retain(|(leaf, _)| !matches!(leaf, VariableRef::Local(i) if bound.contains(i)));
    }
}

/// Variables that are matched lie in the ranges of what they are matched with; `false`: that cannot be.
fn bind(env: &mut IntervalEnv<'_>, args: &[TypedTerm], params: &[Parameter]) -> bool {
    args.iter().zip(params).all(|(arg, param)| match arg {
        TypedTerm::Var(i) => {
            let both = env.get(VariableRef::Local(*i)).meet(ValueInterval::of(param.ty));
            both.is_some_and(|both| {
                env.set(VariableRef::Local(*i), both);
                true
            })
        }
        TypedTerm::Any | TypedTerm::Expr(_) | TypedTerm::List(..) => true,
    })
}

/// What a context leaves of the variables; `false`: it is never met.
fn context(env: &mut IntervalEnv<'_>, c: &TypedContext, agent: &TypedAgent) -> bool {
    if let Some((e, holds)) = tested(c) {
        return env.assume(e, holds);
    }
    match c {
        // A negation binds nothing.
        TypedContext::True | TypedContext::Not(_) | TypedContext::Test(_) => true,
        TypedContext::Belief(l) => {
            let params = agent.beliefs.get(usize::from(l.belief.0)).map_or(&[][..], |b| &b.params);
            bind(env, &l.args, params)
        }
        TypedContext::Unify(TypedTerm::Var(i), e) => {
            let value = env.eval(e);
            match env.get(VariableRef::Local(*i)).meet(value) {
                Some(both) => {
                    env.set(VariableRef::Local(*i), both);
                    true
                }
                None => false,
            }
        }
        TypedContext::Unify(..) | TypedContext::Internal(..) => true,
        TypedContext::And(cs) => cs.iter().all(|c| context(env, c, agent)),
        TypedContext::Or(cs) => {
            let mut joined: Option<IntervalEnv<'_>> = None;
            for c in cs {
                let mut side = env.clone();
                if context(&mut side, c, agent) {
                    joined = Some(match joined {
                        Some(before) => before.or(&side),
                        None => side,
                    });
                }
            }
            let possible = joined.is_some();
            if let Some(joined) = joined {
                env.less = joined.less;
            }
            possible
        }
    }
}

/// Whether an expression reads something without a range.
fn reads_open(env: &IntervalEnv<'_>, e: &TypedExpr) -> bool {
    let mut open = false;
    e.each_leaf(&mut |leaf| open |= env.get(leaf).is_open());
    open
}

fn shown(i: ValueInterval) -> String {
    if i.lo == i.hi { i.lo.to_string() } else { format!("{}..{}", i.lo, i.hi) }
}
