//! Formulas: contexts of plans, bodies of rules, conditions of steps. They are read from the left; what they bind has a
//! value after them.

use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax};

use crate::check::{
    agents::{
        agent::AgentScope,
        phase::AgentsPhase,
        terms::{TermMode, literal_of},
    },
    state::scope::{ExprEnv, is_variable_name},
    template::CheckerPhase,
    value::{expr::FUNCTIONS, range},
};
use crate::{
    BinaryOp, Dimension, InferredType, TypedContext, TypedTerm, UnaryOp,
    noun::Noun,
    report::{agents, names},
};

/// What is known of the variables at a place.
pub(in crate::check) type KnownVars = Vec<(bool, InferredType, Option<(i64, i64)>)>;

pub(in crate::check) fn known(env: &ExprEnv) -> KnownVars {
    env.locals.iter().map(|l| (l.bound, l.ty, l.range)).collect()
}

/// Undoes the bindings made since; variables first seen since then stay known, without a value.
pub(in crate::check) fn restore(env: &mut ExprEnv, before: &KnownVars) {
    for (i, local) in env.locals.iter_mut().enumerate() {
        match before.get(i) {
            Some((true, ty, range)) => {
                // What was learnt of its type since then stays.
                let ty = ty.with(local.ty).unwrap_or(*ty);
                (local.bound, local.ty, local.range) = (true, ty, *range);
            }
            Some((false, ..)) | None => local.bound = false,
        }
    }
}

impl AgentsPhase<'_, '_> {
    pub(in crate::check) fn context(
        &mut self,
        scope: &AgentScope,
        e: &ast::ExprSyntax,
        env: &mut ExprEnv,
    ) -> TypedContext {
        match &e.kind {
            Syntax::Binary { op: BinaryOp::And, left, right } => {
                let mut parts = Vec::new();
                for side in [left, right] {
                    let side = self.context(scope, side, env);
                    if let TypedContext::And(more) = side { parts.extend(more) } else { parts.push(side) }
                }
                Self::all_of(parts)
            }
            Syntax::Binary { op: BinaryOp::Or, left, right } => self.either(scope, left, right, env),
            Syntax::Unary { op: UnaryOp::Not, operand } => {
                // What a negation binds is bound within it only.
                let before = known(env);
                let inner = self.context(scope, operand, env);
                restore(env, &before);
                TypedContext::Not(Box::new(inner))
            }
            Syntax::Unify { left, right } => self.unify(left, right, env),
            Syntax::Internal(call) => self.asked(scope, call, env),
            Syntax::Call { callee, .. } if FUNCTIONS.iter().any(|(f, _)| callee.names[0].text == *f) => {
                TypedContext::Test(self.expr_of(e, InferredType::Bool, env))
            }
            Syntax::Call { .. } | Syntax::Strong(_) | Syntax::Annotated { .. } => match literal_of(e) {
                Some(literal) => self.belief_in(scope, &literal, env),
                None => TypedContext::Test(self.expr_of(e, InferredType::Bool, env)),
            },
            Syntax::Path(path) if self.is_literal(path, env) => match literal_of(e) {
                Some(literal) => self.belief_in(scope, &literal, env),
                None => TypedContext::True,
            },
            Syntax::Index { of, .. } if matches!(&of.kind, Syntax::Path(p) if self.is_literal(p, env)) => {
                match literal_of(e) {
                    Some(literal) => self.belief_in(scope, &literal, env),
                    None => TypedContext::True,
                }
            }
            Syntax::Path(_) | Syntax::Index { .. } | Syntax::Field { .. } => self.test(scope, e, env),
            Syntax::Bool(_) | Syntax::Int(_) | Syntax::Float(_) => self.test(scope, e, env),
            Syntax::Quantity { .. } | Syntax::Text(_) | Syntax::Any => self.test(scope, e, env),
            Syntax::Unary { .. } | Syntax::Binary { .. } | Syntax::If { .. } => self.test(scope, e, env),
            Syntax::Tuple(_) | Syntax::List { .. } | Syntax::Error => self.test(scope, e, env),
        }
    }

    /// A condition on values; one in which a belief is written as if it had one has been said.
    fn test(&mut self, scope: &AgentScope, e: &ast::ExprSyntax, env: &mut ExprEnv) -> TypedContext {
        if self.belief_in_test(scope, e) {
            return TypedContext::True;
        }
        TypedContext::Test(self.expr_of(e, InferredType::Bool, env))
    }

    /// A single name that is neither a variable nor a constant is meant as a belief.
    fn is_literal(&self, path: &ast::PathSyntax, env: &ExprEnv) -> bool {
        let [name] = path.names.as_slice() else { return false };
        let text = name.text.as_str();
        env.find(text).is_none()
            && env.layout(text).is_none()
            && !self.has_value(text)
            && !is_variable_name(text)
    }

    fn belief_in(
        &mut self,
        scope: &AgentScope,
        literal: &ast::LiteralSyntax,
        env: &mut ExprEnv,
    ) -> TypedContext {
        self.literal(scope, literal, env, (true, true)).map_or(TypedContext::True, TypedContext::Belief)
    }

    /// `X = e`, `[H | T] = e`: the side with open variables is matched with the other.
    pub(in crate::check) fn unify(
        &mut self,
        left: &ast::ExprSyntax,
        right: &ast::ExprSyntax,
        env: &mut ExprEnv,
    ) -> TypedContext {
        let swapped = self.is_pattern(right, env) && !self.is_pattern(left, env);
        let (term, value) = if swapped { (right, left) } else { (left, right) };
        let due = if let Syntax::Path(path) = &term.kind
            && let [name] = path.names.as_slice()
        {
            env.find(&name.text).filter(|l| l.bound).map_or(InferredType::Unknown, |l| l.ty)
        } else {
            InferredType::Unknown
        };
        // A whole number and a float are compared as numbers.
        let value = self.single(value, if due.is_bare() { InferredType::Unknown } else { due }, env);
        let term = self.matched_arg(term, TermMode::Kind(value.ty), env, true);
        if let TypedTerm::Var(i) = term
            && let Some((lo, hi)) = range::of(&value, env)
            && let Some(local) = env.locals.get_mut(usize::from(i))
        {
            let known = local.range.unwrap_or((lo, hi));
            local.range = Some((lo.max(known.0), hi.min(known.1))).filter(|(lo, hi)| lo <= hi);
        }
        TypedContext::Unify(term, value)
    }

    /// After an alternative a variable has a value if both sides give it one.
    fn either(
        &mut self,
        scope: &AgentScope,
        left: &ast::ExprSyntax,
        right: &ast::ExprSyntax,
        env: &mut ExprEnv,
    ) -> TypedContext {
        let before = known(env);
        let mut parts = Vec::new();
        let mut sides = Vec::new();
        for side in [left, right] {
            let side = self.context(scope, side, env);
            if let TypedContext::Or(more) = side {
                parts.extend(more)
            } else {
                parts.push(side)
            }
            sides.push(known(env));
            restore(env, &before);
        }
        if let [a, b] = sides.as_slice() {
            self.join(a, b, left.span.to(right.span), env);
        }
        TypedContext::Or(parts)
    }

    /// What is known where two ways come together.
    pub(in crate::check) fn join(
        &mut self,
        a: &KnownVars,
        b: &KnownVars,
        span: hrdsl_source::Span,
        env: &mut ExprEnv,
    ) {
        let mut clashes = Vec::new();
        for (i, local) in env.locals.iter_mut().enumerate() {
            let (Some((true, one, r)), Some((true, other, s))) = (a.get(i), b.get(i)) else {
                local.bound = false;
                continue;
            };
            local.bound = true;
            local.range = r.zip(*s).map(|(r, s)| (r.0.min(s.0), r.1.max(s.1)));
            local.ty = match one.with(*other) {
                Some(kind) => kind,
                None if one.is_bare() && other.is_bare() => InferredType::Float(Dimension::NUMBER),
                None => {
                    clashes.push((local.name.clone(), *one, *other));
                    InferredType::Unknown
                }
            };
        }
        for (name, one, other) in clashes {
            self.report(agents::two_kinds(&name, one, other, span));
        }
    }

    /// A belief inside of a comparison is a frequent slip.
    fn belief_in_test(&mut self, scope: &AgentScope, e: &ast::ExprSyntax) -> bool {
        let Syntax::Binary { left, right, .. } = &e.kind else { return false };
        for side in [left, right] {
            if let Syntax::Call { callee, .. } = &side.kind
                && callee.names.len() == 1
                && self.kind_in_agent(scope, &callee.names[0].text) == Some(Noun::Belief)
            {
                let name = &callee.names[0];
                let issue = names::wrong_kind(Noun::Function, Noun::Belief, &name.text, name.span, []);
                self.report(issue.help(format!("bind its value first: `{}(X) && X …`", name.text)));
                return true;
            }
        }
        false
    }
}
