//! Rules: what follows from other beliefs, and which of its arguments must have a value where it is asked.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, AgentMemberKind as Member};

use crate::check::{
    agents::{agent::AgentScope, phase::AgentsPhase},
    state::{names::ArgumentMode, scope::ExprEnv},
    template::CheckerPhase,
};
use crate::{
    BeliefId, InferredType, TypedBeliefRule, TypedContext, TypedExprKind, TypedTerm, VariableRef,
    noun::Noun,
    report::{agents, types},
};

/// A rule that is worked on.
struct RuleClause<'a> {
    head: &'a ast::LiteralSyntax,
    body: Option<&'a ast::ExprSyntax>,
    span: Span,
}

/// What one look at a rule has found.
struct RuleFindings {
    rule: TypedBeliefRule,
    modes: Vec<ArgumentMode>,
}

impl AgentsPhase<'_, '_> {
    /// The rules of an agent. First their modes are worked out: what a rule needs may depend on what those need that it
    /// asks; then what is wrong is said.
    pub(in crate::check) fn agent_rules(&mut self, scope: &AgentScope, agent: &ast::AgentSyntax) {
        let clauses: Vec<RuleClause<'_>> = agent
            .members
            .iter()
            .filter_map(|m| match &m.kind {
                Member::Rule { head, body } => Some(RuleClause { head, body: body.as_ref(), span: m.span }),
                Member::Belief { .. }
                | Member::GoalType { .. }
                | Member::Goal(_)
                | Member::Plan(_)
                | Member::Allow(_)
                | Member::Error => None,
            })
            .collect();
        if clauses.is_empty() {
            return;
        }
        self.infer_modes(scope, &clauses);
        for clause in &clauses {
            let found = self.rule(scope, clause);
            self.s.agents[usize::from(scope.id.0)].rules.extend(found.map(|f| f.rule));
        }
    }

    fn infer_modes(&mut self, scope: &AgentScope, clauses: &[RuleClause<'_>]) {
        let mut open: VecDeque<usize> = (0..clauses.len()).collect();
        let mut waiting: BTreeSet<usize> = open.iter().copied().collect();
        // By belief: the rules that ask it.
        let mut askers: BTreeMap<BeliefId, BTreeSet<usize>> = BTreeMap::new();
        while let Some(at) = open.pop_front() {
            waiting.remove(&at);
            let before = self.issues.list.len();
            let found = self.rule(scope, &clauses[at]);
            self.issues.list.truncate(before);
            let Some(found) = found else { continue };
            found.rule.body.each(&mut |part| {
                if let TypedContext::Belief(literal) = part {
                    askers.entry(literal.belief).or_default().insert(at);
                }
            });
            let belief = found.rule.belief;
            let free = vec![ArgumentMode::Free; found.modes.len()];
            let known = self.names.modes.entry((scope.id.0, belief.0)).or_insert(free);
            let mut changed = false;
            for (known, new) in known.iter_mut().zip(&found.modes) {
                changed |= *new > *known;
                *known = (*known).max(*new);
            }
            if changed {
                let again = askers.get(&belief).into_iter().flatten().copied();
                let same = (0..clauses.len())
                    .filter(|i| clauses[*i].head.call.name.text == clauses[at].head.call.name.text);
                let again: Vec<usize> = again.chain(same).filter(|i| waiting.insert(*i)).collect();
                open.extend(again);
            }
        }
    }

    /// Looks at a rule with what is known of the modes.
    fn rule(&mut self, scope: &AgentScope, clause: &RuleClause<'_>) -> Option<RuleFindings> {
        let mut env = ExprEnv { plan: true, noun: Some(Noun::Variable), ..ExprEnv::default() };
        let head = clause.head;
        if let Some(first) = head.annotations.first() {
            self.report(agents::not_annotated("the head of a rule", first.span));
        }
        let belief = self.belief_or_negation(scope, head);
        let fields = belief.map(|b| self.belief_fields(scope.id, b));
        let args = self.matched(Noun::Belief, &head.call, fields.as_ref(), &mut env, true);
        let mut modes = vec![ArgumentMode::Free; args.len()];
        if let Some(known) = belief.and_then(|b| self.names.modes.get(&(scope.id.0, b.0))) {
            modes.iter_mut().zip(known).for_each(|(mode, known)| *mode = *known);
        }
        let heads = open_heads(&args, &mut modes, &mut env);
        self.unbound.clear();
        let body = clause.body.map_or(TypedContext::True, |e| self.context(scope, e, &mut env));
        self.fits_head(&args, belief, &heads, scope, &mut env, head.span);
        for (var, at) in &heads {
            let Some(local) = env.locals.get(usize::from(*var)) else { continue };
            if !local.bound || self.unbound.contains(&local.name) {
                modes[*at] = ArgumentMode::Input;
            }
        }
        let vars = env.locals.iter().map(|l| l.name.clone()).collect();
        let (origin, head) = (clause.span, head.span);
        Some(RuleFindings {
            rule: TypedBeliefRule { belief: belief?, args, body, vars, head, origin },
            modes,
        })
    }

    /// What the body gives the head's variables must be of the belief's types.
    fn fits_head(
        &mut self,
        args: &[TypedTerm],
        belief: Option<BeliefId>,
        heads: &BTreeMap<u16, usize>,
        scope: &AgentScope,
        env: &mut ExprEnv,
        span: Span,
    ) {
        let Some(belief) = belief else { return };
        let params = self.s.agents[usize::from(scope.id.0)].beliefs[usize::from(belief.0)].params.clone();
        for (arg, param) in args.iter().zip(&params) {
            let TypedTerm::Var(var) = arg else { continue };
            let Some(local) = env.locals.get(usize::from(*var)).filter(|l| l.bound) else { continue };
            let (got, want): (InferredType, InferredType) = (local.ty, InferredType::of(param.ty));
            let numbers = got.is_bare() && want.is_bare();
            if heads.contains_key(var) && !numbers && got.with(want).is_none() {
                self.report(types::other_before(&local.name, &want.to_string(), &got.to_string(), span));
            }
        }
    }
}

/// The variables of a head that have no value before the body, each with the first argument that it is in. They are open
/// in `env` then.
fn open_heads(args: &[TypedTerm], modes: &mut [ArgumentMode], env: &mut ExprEnv) -> BTreeMap<u16, usize> {
    let mut first: BTreeMap<u16, usize> = BTreeMap::new();
    let mut given: BTreeSet<u16> = BTreeSet::new();
    for (at, arg) in args.iter().enumerate() {
        if is_any(arg) {
            modes[at] = modes[at].max(ArgumentMode::Named);
        }
        arg.each_var(&mut |var| {
            first.entry(var).or_insert(at);
            if modes[at] == ArgumentMode::Input {
                given.insert(var);
            }
        });
    }
    for arg in args {
        // A computed argument needs its variables first.
        if let TypedTerm::Expr(e) = arg {
            e.each(&mut |part| {
                if let TypedExprKind::Leaf(VariableRef::Local(var)) = part.kind
                    && !given.contains(&var)
                    && let Some(at) = first.get(&var)
                {
                    modes[*at] = ArgumentMode::Input;
                    given.insert(var);
                }
            });
        }
    }
    first.retain(|var, _| !given.contains(var));
    for var in first.keys() {
        if let Some(local) = env.locals.get_mut(usize::from(*var)) {
            local.bound = false;
        }
    }
    first
}

fn is_any(arg: &TypedTerm) -> bool {
    match arg {
        TypedTerm::Any => true,
        TypedTerm::Var(_) | TypedTerm::Expr(_) => false,
        TypedTerm::List(items, rest) => items.iter().chain(rest.as_deref()).any(is_any),
    }
}
