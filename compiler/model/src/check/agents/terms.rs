//! Terms and literals: what is matched with facts and goals, and what is made. A variable that has no value yet gets it.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, Call, ExprKind as Syntax};

use crate::check::{
    agents::agent::Scope,
    checker::Checker,
    state::{
        item::Part,
        names::Mode,
        record::Fields,
        scope::{Env, is_variable_name},
    },
};
use crate::{
    Annotation, Arg, Assertion, BeliefId, Expr, ExprKind, Kind, Leaf, Literal, Param, Type,
    noun::Noun,
    report::{agents, types},
};

/// What is known of a value that a term is matched with.
#[derive(Clone, Copy, Debug)]
pub(in crate::check) enum Due {
    Type(Type),
    Kind(Kind),
}

impl Due {
    pub fn kind(self) -> Kind {
        match self {
            Due::Type(ty) => Kind::of(ty),
            Due::Kind(kind) => kind,
        }
    }

    fn range(self) -> Option<(i64, i64)> {
        match self {
            Due::Type(ty) => ty.range(),
            Due::Kind(_) => None,
        }
    }

    /// Of the elements, if it can be a list.
    fn element(self) -> Option<Due> {
        match self {
            Due::Type(Type::List(of)) => Some(Due::Type(of.element())),
            Due::Type(Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text) => None,
            Due::Kind(kind) => kind.element().map(Due::Kind),
        }
    }
}

/// A literal that is written as an expression: `~b(X)[source(S)]`.
pub(in crate::check) fn literal_of(e: &ast::Expr) -> Option<ast::Literal> {
    let literal = match &e.kind {
        Syntax::Path(path) => {
            let [name] = path.names.as_slice() else { return None };
            let call = Call { name: name.clone(), args: None, span: e.span };
            ast::Literal { negated: false, call, annotations: Vec::new(), span: e.span }
        }
        Syntax::Call { callee, args } => {
            let [name] = callee.names.as_slice() else { return None };
            let call = Call { name: name.clone(), args: Some(args.clone()), span: e.span };
            ast::Literal { negated: false, call, annotations: Vec::new(), span: e.span }
        }
        Syntax::Strong(inner) => {
            let inner = literal_of(inner).filter(|l| !l.negated)?;
            ast::Literal { negated: true, span: e.span, ..inner }
        }
        Syntax::Annotated { of, annotations } => {
            let of = literal_of(of).filter(|l| l.annotations.is_empty())?;
            ast::Literal { annotations: annotations.clone(), span: e.span, ..of }
        }
        Syntax::Index { of, index } => {
            let of = literal_of(of).filter(|l| l.annotations.is_empty())?;
            ast::Literal { annotations: vec![(**index).clone()], span: e.span, ..of }
        }
        _ => return None,
    };
    Some(literal)
}

impl Checker<'_> {
    /// Whether a name like this is an agent's variable, and not a constant or another agent.
    pub(in crate::check) fn is_variable(&self, text: &str) -> bool {
        is_variable_name(text) && !self.has_value(text) && self.players.agent_names.symbol(text).is_none()
    }

    /// Arguments that are matched: `_`, a variable, or a value. `None` for parameters: their types are not known.
    pub(in crate::check) fn matched(
        &mut self,
        noun: Noun,
        call: &Call,
        fields: Option<&Fields>,
        env: &mut Env,
        binds: bool,
    ) -> Vec<Arg> {
        let args = call.args.as_deref().unwrap_or_default();
        let variable = |c: &Checker<'_>, name: &ast::Name| c.is_variable(&name.text);
        if fields.is_none() && noun != Noun::Goal {
            // Its name has a diagnostic.
            if binds {
                args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            }
            return args.iter().map(|_| Arg::Any).collect();
        }
        let unknown = Due::Kind(Kind::Unknown);
        let Some(fields) = fields else {
            return args.iter().map(|arg| self.matched_arg(arg, unknown, env, binds)).collect();
        };
        if args.len() != fields.len() {
            self.wrong_arity(noun, call, fields);
        }
        let parts = self.spread_args(args, fields, env, &variable);
        let mut matched: Vec<Arg> =
            parts.into_iter().map(|part| self.matched_part(part, env, binds)).collect();
        for arg in args.iter().skip(fields.len()) {
            matched.push(self.matched_arg(arg, unknown, env, binds));
        }
        matched
    }

    fn matched_part(&mut self, part: Part<'_>, env: &mut Env, binds: bool) -> Arg {
        match part {
            Part::Any => Arg::Any,
            Part::Syntax(arg, ty) => self.matched_arg(arg, Due::Type(ty), env, binds),
            Part::Done(e, _) => Arg::Expr(e),
            Part::Variable(name, ty) => self.matched_variable(&name, Due::Type(ty), env, binds),
        }
    }

    /// A term where something is due.
    pub(in crate::check) fn matched_arg(
        &mut self,
        arg: &ast::Expr,
        due: Due,
        env: &mut Env,
        binds: bool,
    ) -> Arg {
        match &arg.kind {
            Syntax::Any => return Arg::Any,
            Syntax::Path(path) => {
                if let [name] = path.names.as_slice()
                    && self.is_variable(&name.text)
                    && env.layout(&name.text).is_none()
                {
                    return self.matched_variable(name, due, env, binds);
                }
            }
            Syntax::List { items, rest } if self.is_pattern(arg, env) => {
                return self.matched_list(items, rest.as_deref(), due, arg.span, env, binds);
            }
            _ => {}
        }
        Arg::Expr(match due {
            Due::Type(ty) => self.expr_for(arg, ty, env),
            Due::Kind(kind) => self.expr_of(arg, kind, env),
        })
    }

    /// `[H | T]`
    fn matched_list(
        &mut self,
        items: &[ast::Expr],
        rest: Option<&ast::Expr>,
        due: Due,
        span: Span,
        env: &mut Env,
        binds: bool,
    ) -> Arg {
        let element = due.element();
        if element.is_none() {
            self.report(types::mismatch(due.kind(), Kind::list(Kind::Unknown), None, span));
        }
        let unknown = Due::Kind(Kind::Unknown);
        let element = element.unwrap_or(unknown);
        let items: Vec<Arg> = items.iter().map(|i| self.matched_arg(i, element, env, binds)).collect();
        let whole = match due {
            Due::Kind(Kind::Unknown) => Due::Kind(Kind::list(Kind::Unknown)),
            due if due.element().is_some() => due,
            Due::Type(_) | Due::Kind(_) => unknown,
        };
        let rest = rest.map(|r| Box::new(self.matched_arg(r, whole, env, binds)));
        Arg::List(items, rest)
    }

    /// Whether something in a list is matched, and not only computed.
    pub(in crate::check) fn is_pattern(&self, e: &ast::Expr, env: &Env) -> bool {
        match &e.kind {
            Syntax::Any => true,
            Syntax::Path(path) => match path.names.as_slice() {
                [name] => {
                    let open = env.find(&name.text).is_none_or(|l| !l.bound);
                    self.is_variable(&name.text)
                        && open
                        && env.layout(&name.text).is_none()
                        && !env.broken.contains(&name.text)
                }
                _ => false,
            },
            Syntax::List { items, rest } => {
                items.iter().chain(rest.as_deref()).any(|part| self.is_pattern(part, env))
            }
            _ => false,
        }
    }

    /// Binds a variable, or compares with its value.
    pub(in crate::check) fn matched_variable(
        &mut self,
        name: &ast::Name,
        due: Due,
        env: &mut Env,
        binds: bool,
    ) -> Arg {
        let kind = due.kind();
        match env.find_mut(&name.text) {
            Some(local) if !local.bound && binds => {
                local.bound = true;
                local.ty = kind;
                local.range = due.range();
            }
            Some(_) => {}
            None if binds => match due {
                Due::Type(ty) => {
                    env.push_typed(&name.text, name.span, Noun::Variable, ty);
                    self.define_here(name, kind);
                }
                Due::Kind(_) => {
                    env.push_local(&name.text, name.span, Noun::Variable, kind);
                    self.define_here(name, kind);
                }
            },
            None => {}
        }
        let e = self.variable(name, env);
        let ExprKind::Leaf(Leaf::Local(i)) = e.kind else { return Arg::Any };
        // A whole number matches the float that equals it.
        let numbers = e.ty.is_bare() && kind.is_bare();
        if !numbers && self.fit(e, kind, env).kind == ExprKind::Error {
            return Arg::Any;
        }
        Arg::Var(i)
    }

    // ── literals ──

    /// A belief that is matched. `asks`: rules may answer.
    pub(in crate::check) fn literal(
        &mut self,
        scope: &Scope,
        literal: &ast::Literal,
        env: &mut Env,
        (binds, asks): (bool, bool),
    ) -> Option<Literal> {
        let belief = self.belief_or_negation(scope, literal);
        let fields = belief.map(|b| self.belief_fields(scope.id, b));
        let before: Vec<bool> = env.locals.iter().map(|l| l.bound).collect();
        let args = self.matched(Noun::Belief, &literal.call, fields.as_ref(), env, binds);
        if let (Some(belief), true) = (belief, asks) {
            self.needs_inputs((scope.id.0, belief), &args, &before, &literal.call, env);
        }
        let declared = belief.map(|b| self.annotations_of(scope, b));
        let annotations = self.matched_annotations(&literal.annotations, declared.as_deref(), env, binds);
        Some(Literal { belief: belief?, args, annotations, origin: literal.span })
    }

    /// A belief that is made: its arguments have values.
    pub(in crate::check) fn assertion(
        &mut self,
        scope: &Scope,
        literal: &ast::Literal,
        env: &mut Env,
    ) -> Option<Assertion> {
        let belief = self.belief_or_negation(scope, literal)?;
        let fields = self.belief_fields(scope.id, belief);
        let args = self.args(Noun::Belief, &literal.call, &fields, env);
        let declared = self.annotations_of(scope, belief);
        let mut annotations = Vec::new();
        for e in &literal.annotations {
            let Some((annotation, value, ty)) = self.annotation(e, Some(&declared)) else { continue };
            annotations.push((annotation, self.expr_for(value, ty, env)));
        }
        Some(Assertion { belief, args, annotations })
    }

    pub(in crate::check) fn annotations_of(&self, scope: &Scope, belief: BeliefId) -> Vec<Param> {
        self.s.agents[usize::from(scope.id.0)].beliefs[usize::from(belief.0)].annotations.clone()
    }

    /// Annotations that are matched; `declared`: besides `source`, `None` if that is not known.
    pub(in crate::check) fn matched_annotations(
        &mut self,
        annotations: &[ast::Expr],
        declared: Option<&[Param]>,
        env: &mut Env,
        binds: bool,
    ) -> Vec<(Annotation, Arg)> {
        let mut matched = Vec::new();
        for e in annotations {
            if let Some((annotation, value, ty)) = self.annotation(e, declared) {
                matched.push((annotation, self.matched_arg(value, Due::Type(ty), env, binds)));
            } else if let Syntax::Call { args, .. } = &e.kind
                && binds
            {
                let variable = |c: &Checker<'_>, name: &ast::Name| c.is_variable(&name.text);
                args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            }
        }
        matched
    }

    /// `sure(90)`: which annotation it is, its value and the type of that.
    pub(in crate::check) fn annotation<'e>(
        &mut self,
        e: &'e ast::Expr,
        declared: Option<&[Param]>,
    ) -> Option<(Annotation, &'e ast::Expr, Type)> {
        let declared = declared?;
        let (name, args): (&ast::Name, &[ast::Expr]) = match &e.kind {
            Syntax::Call { callee, args } if callee.names.len() == 1 => (&callee.names[0], args),
            Syntax::Path(path) if path.names.len() == 1 => (&path.names[0], &[]),
            Syntax::Error => return None,
            _ => {
                self.report(agents::no_annotation(e.span));
                return None;
            }
        };
        let at = declared.iter().position(|p| p.name == name.text);
        let (annotation, ty) = match at {
            Some(at) => (Annotation::Declared(u16::try_from(at).unwrap_or(u16::MAX)), declared[at].ty),
            None if name.text == "source" => (Annotation::Source, Type::Enum(self.players.agent_names)),
            None => {
                let mut names: Vec<String> = vec!["source".to_owned()];
                names.extend(declared.iter().map(|p| p.name.clone()));
                self.unknown(Noun::Annotation, name, &names, Some(Noun::Annotation));
                return None;
            }
        };
        let [value] = args else {
            let issue = types::counts(Noun::Annotation, &name.text, 1, args.len(), e.span);
            self.report(issue.help(format!("write `{}(…)`", name.text)));
            return None;
        };
        Some((annotation, value, ty))
    }

    /// The rules of a belief may need some of its arguments to have a value.
    pub(in crate::check) fn needs_inputs(
        &mut self,
        (agent, belief): (u16, BeliefId),
        args: &[Arg],
        before: &[bool],
        call: &Call,
        env: &Env,
    ) {
        let Some(modes) = self.agents.modes.get(&(agent, belief.0)).cloned() else { return };
        let written = call.args.as_deref().unwrap_or_default();
        for (i, (arg, mode)) in args.iter().zip(&modes).enumerate() {
            let span = if written.len() == modes.len() { written[i].span } else { call.span };
            let mut open = Vec::new();
            arg.each_var(&mut |var| {
                if !before.get(usize::from(var)).copied().unwrap_or(false) {
                    open.push(var);
                }
            });
            let needs = match mode {
                Mode::Free => false,
                Mode::Named => !open.is_empty(),
                Mode::Input => !open.is_empty() || has_any(arg),
            };
            if needs {
                let names = open.iter().filter_map(|v| env.locals.get(usize::from(*v)));
                self.agents.unbound.extend(names.map(|l| l.name.clone()));
                self.report(agents::rule_needs(&call.name.text, i, span));
            }
        }
    }

    /// An expression of the kind that a variable or literal is compared with.
    pub(in crate::check) fn single(&mut self, e: &ast::Expr, kind: Kind, env: &mut Env) -> Expr {
        if kind == Kind::Unknown { self.expr(e, env) } else { self.expr_of(e, kind, env) }
    }
}

fn has_any(arg: &Arg) -> bool {
    match arg {
        Arg::Any => true,
        Arg::Var(_) | Arg::Expr(_) => false,
        Arg::List(items, rest) => items.iter().chain(rest.as_deref()).any(has_any),
    }
}
