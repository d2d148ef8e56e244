//! Terms and literals: what is matched with facts and goals, and what is made. A variable that has no value yet gets it.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, CallSyntax, ExprSyntaxKind as Syntax};

use crate::check::{
    agents::{agent::AgentScope, phase::AgentsPhase},
    checker::Checker,
    state::{item::ArgumentPart, names::ArgumentMode, record::DeclaredFields, scope::ExprEnv},
    template::CheckerPhase,
};
use crate::{
    BeliefAnnotation, BeliefId, InferredType, Parameter, Type, TypedAssertion, TypedExpr, TypedExprKind,
    TypedLiteral, TypedTerm, VariableRef,
    noun::Noun,
    report::{agents, types},
};

/// What is known of a value that a term is matched with.
#[derive(Clone, Copy, Debug)]
pub(in crate::check) enum TermMode {
    Type(Type),
    Kind(InferredType),
}

impl TermMode {
    pub fn kind(self) -> InferredType {
        match self {
            TermMode::Type(ty) => InferredType::of(ty),
            TermMode::Kind(kind) => kind,
        }
    }

    fn range(self) -> Option<(i64, i64)> {
        match self {
            TermMode::Type(ty) => ty.range(),
            TermMode::Kind(_) => None,
        }
    }

    /// Of the elements, if it can be a list.
    fn element(self) -> Option<TermMode> {
        match self {
            TermMode::Type(Type::List(of)) => Some(TermMode::Type(of.element())),
            TermMode::Type(Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text) => {
                None
            }
            TermMode::Kind(kind) => kind.element().map(TermMode::Kind),
        }
    }
}

/// A literal that is written as an expression: `~b(X)[source(S)]`.
pub(in crate::check) fn literal_of(e: &ast::ExprSyntax) -> Option<ast::LiteralSyntax> {
    if let Syntax::Strong(inner) = &e.kind {
        let inner = literal_of(inner).filter(|l| !l.negated)?;
        return Some(ast::LiteralSyntax { negated: true, span: e.span, ..inner });
    }
    let annotated = if let Syntax::Annotated { of, annotations } = &e.kind {
        Some((of, annotations.clone()))
    } else if let Syntax::Index { of, index } = &e.kind {
        Some((of, vec![(**index).clone()]))
    } else {
        None
    };
    if let Some((of, annotations)) = annotated {
        let of = literal_of(of).filter(|l| l.annotations.is_empty())?;
        return Some(ast::LiteralSyntax { annotations, span: e.span, ..of });
    }
    let (path, args) = if let Syntax::Call { callee, args } = &e.kind {
        (callee, Some(args.clone()))
    } else if let Syntax::Path(path) = &e.kind {
        (path, None)
    } else {
        return None;
    };
    let [name] = path.names.as_slice() else { return None };
    let call = CallSyntax { name: name.clone(), args, span: e.span };
    Some(ast::LiteralSyntax { negated: false, call, annotations: Vec::new(), span: e.span })
}

impl AgentsPhase<'_, '_> {
    /// Arguments that are matched: `_`, a variable, or a value. `None` for parameters: their types are not known.
    pub(in crate::check) fn matched(
        &mut self,
        noun: Noun,
        call: &CallSyntax,
        fields: Option<&DeclaredFields>,
        env: &mut ExprEnv,
        binds: bool,
    ) -> Vec<TypedTerm> {
        let args = call.args.as_deref().unwrap_or_default();
        let variable = |c: &Checker<'_>, name: &ast::NameSyntax| c.is_variable(&name.text);
        if fields.is_none() && noun != Noun::Goal {
            // Its name has a diagnostic.
            if binds {
                args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            }
            return args.iter().map(|_| TypedTerm::Any).collect();
        }
        let unknown = TermMode::Kind(InferredType::Unknown);
        let Some(fields) = fields else {
            return args.iter().map(|arg| self.matched_arg(arg, unknown, env, binds)).collect();
        };
        if args.len() != fields.len() {
            self.wrong_arity(noun, call, fields);
        }
        let parts = self.spread_args(args, fields, env, &variable);
        let mut matched: Vec<TypedTerm> =
            parts.into_iter().map(|part| self.matched_part(part, env, binds)).collect();
        for arg in args.iter().skip(fields.len()) {
            matched.push(self.matched_arg(arg, unknown, env, binds));
        }
        matched
    }

    fn matched_part(&mut self, part: ArgumentPart<'_>, env: &mut ExprEnv, binds: bool) -> TypedTerm {
        match part {
            ArgumentPart::Any => TypedTerm::Any,
            ArgumentPart::Syntax(arg, ty) => self.matched_arg(arg, TermMode::Type(ty), env, binds),
            ArgumentPart::Done(e, _) => TypedTerm::Expr(e),
            ArgumentPart::Variable(name, ty) => self.matched_variable(&name, TermMode::Type(ty), env, binds),
        }
    }

    /// A term where something is due.
    pub(in crate::check) fn matched_arg(
        &mut self,
        arg: &ast::ExprSyntax,
        due: TermMode,
        env: &mut ExprEnv,
        binds: bool,
    ) -> TypedTerm {
        if arg.kind == Syntax::Any {
            return TypedTerm::Any;
        }
        if let Syntax::Path(path) = &arg.kind
            && let [name] = path.names.as_slice()
            && self.is_variable(&name.text)
            && env.layout(&name.text).is_none()
        {
            return self.matched_variable(name, due, env, binds);
        }
        if let Syntax::List { items, rest } = &arg.kind
            && self.is_pattern(arg, env)
        {
            return self.matched_list(items, rest.as_deref(), due, arg.span, env, binds);
        }
        TypedTerm::Expr(match due {
            TermMode::Type(ty) => self.expr_for(arg, ty, env),
            TermMode::Kind(kind) => self.expr_of(arg, kind, env),
        })
    }

    /// `[H | T]`
    fn matched_list(
        &mut self,
        items: &[ast::ExprSyntax],
        rest: Option<&ast::ExprSyntax>,
        due: TermMode,
        span: Span,
        env: &mut ExprEnv,
        binds: bool,
    ) -> TypedTerm {
        let element = due.element();
        if element.is_none() {
            self.report(types::mismatch(due.kind(), InferredType::list(InferredType::Unknown), None, span));
        }
        let unknown = TermMode::Kind(InferredType::Unknown);
        let element = element.unwrap_or(unknown);
        let items: Vec<TypedTerm> = items.iter().map(|i| self.matched_arg(i, element, env, binds)).collect();
        let whole = match due {
            TermMode::Kind(InferredType::Unknown) => {
                TermMode::Kind(InferredType::list(InferredType::Unknown))
            }
            due if due.element().is_some() => due,
            TermMode::Type(_) | TermMode::Kind(_) => unknown,
        };
        let rest = rest.map(|r| Box::new(self.matched_arg(r, whole, env, binds)));
        TypedTerm::List(items, rest)
    }

    /// Whether something in a list is matched, and not only computed.
    pub(in crate::check) fn is_pattern(&self, e: &ast::ExprSyntax, env: &ExprEnv) -> bool {
        if let Syntax::List { items, rest } = &e.kind {
            return items.iter().chain(rest.as_deref()).any(|part| self.is_pattern(part, env));
        }
        let Syntax::Path(path) = &e.kind else { return e.kind == Syntax::Any };
        let [name] = path.names.as_slice() else { return false };
        let open = env.find(&name.text).is_none_or(|l| !l.bound);
        self.is_variable(&name.text)
            && open
            && env.layout(&name.text).is_none()
            && !env.broken.contains(&name.text)
    }

    /// Binds a variable, or compares with its value.
    pub(in crate::check) fn matched_variable(
        &mut self,
        name: &ast::NameSyntax,
        due: TermMode,
        env: &mut ExprEnv,
        binds: bool,
    ) -> TypedTerm {
        let kind = due.kind();
        match env.find_mut(&name.text) {
            Some(local) if !local.bound && binds => {
                local.bound = true;
                local.ty = kind;
                local.range = due.range();
            }
            Some(_) => {}
            None if binds => match due {
                TermMode::Type(ty) => {
                    env.push_typed(&name.text, name.span, Noun::Variable, ty);
                    self.define_here(name, kind);
                }
                TermMode::Kind(_) => {
                    env.push_local(&name.text, name.span, Noun::Variable, kind);
                    self.define_here(name, kind);
                }
            },
            None => {}
        }
        let e = self.variable(name, env);
        let TypedExprKind::Leaf(VariableRef::Local(i)) = e.kind else { return TypedTerm::Any };
        // A whole number matches the float that equals it.
        let numbers = e.ty.is_bare() && kind.is_bare();
        if !numbers && self.fit(e, kind, env).kind == TypedExprKind::Error {
            return TypedTerm::Any;
        }
        TypedTerm::Var(i)
    }

    // ── literals ──

    /// A belief that is matched. `asks`: rules may answer.
    pub(in crate::check) fn literal(
        &mut self,
        scope: &AgentScope,
        literal: &ast::LiteralSyntax,
        env: &mut ExprEnv,
        (binds, asks): (bool, bool),
    ) -> Option<TypedLiteral> {
        let belief = self.belief_or_negation(scope, literal);
        let fields = belief.map(|b| self.belief_fields(scope.id, b));
        let before: Vec<bool> = env.locals.iter().map(|l| l.bound).collect();
        let args = self.matched(Noun::Belief, &literal.call, fields.as_ref(), env, binds);
        if let (Some(belief), true) = (belief, asks) {
            self.needs_inputs((scope.id.0, belief), &args, &before, &literal.call, env);
        }
        let declared = belief.map(|b| self.annotations_of(scope, b));
        let annotations = self.matched_annotations(&literal.annotations, declared.as_deref(), env, binds);
        Some(TypedLiteral { belief: belief?, args, annotations, origin: literal.span })
    }

    /// A belief that is made: its arguments have values.
    pub(in crate::check) fn assertion(
        &mut self,
        scope: &AgentScope,
        literal: &ast::LiteralSyntax,
        env: &mut ExprEnv,
    ) -> Option<TypedAssertion> {
        let belief = self.belief_or_negation(scope, literal)?;
        let fields = self.belief_fields(scope.id, belief);
        let args = self.args(Noun::Belief, &literal.call, &fields, env);
        let declared = self.annotations_of(scope, belief);
        let mut annotations = Vec::new();
        for e in &literal.annotations {
            let Some((annotation, value, ty)) = self.annotation(e, Some(&declared)) else { continue };
            annotations.push((annotation, self.expr_for(value, ty, env)));
        }
        Some(TypedAssertion { belief, args, annotations })
    }

    pub(in crate::check) fn annotations_of(&self, scope: &AgentScope, belief: BeliefId) -> Vec<Parameter> {
        self.s.agents[usize::from(scope.id.0)].beliefs[usize::from(belief.0)].annotations.clone()
    }

    /// Annotations that are matched; `declared`: besides `source`, `None` if that is not known.
    pub(in crate::check) fn matched_annotations(
        &mut self,
        annotations: &[ast::ExprSyntax],
        declared: Option<&[Parameter]>,
        env: &mut ExprEnv,
        binds: bool,
    ) -> Vec<(BeliefAnnotation, TypedTerm)> {
        let mut matched = Vec::new();
        for e in annotations {
            if let Some((annotation, value, ty)) = self.annotation(e, declared) {
                matched.push((annotation, self.matched_arg(value, TermMode::Type(ty), env, binds)));
            } else if let Syntax::Call { args, .. } = &e.kind
                && binds
            {
                let variable = |c: &Checker<'_>, name: &ast::NameSyntax| c.is_variable(&name.text);
                args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            }
        }
        matched
    }

    /// `sure(90)`: which annotation it is, its value and the type of that.
    pub(in crate::check) fn annotation<'e>(
        &mut self,
        e: &'e ast::ExprSyntax,
        declared: Option<&[Parameter]>,
    ) -> Option<(BeliefAnnotation, &'e ast::ExprSyntax, Type)> {
        let declared = declared?;
        let (path, args): (Option<&ast::PathSyntax>, &[ast::ExprSyntax]) = if let Syntax::Path(path) = &e.kind
        {
            (Some(path), &[])
        } else if let Syntax::Call { callee, args } = &e.kind {
            (Some(callee), args)
        } else {
            (None, &[])
        };
        let Some([name]) = path.map(|path| path.names.as_slice()) else {
            if e.kind != Syntax::Error {
                self.report(agents::no_annotation(e.span));
            }
            return None;
        };
        let at = declared.iter().position(|p| p.name == name.text);
        let (annotation, ty) = match at {
            Some(at) => (BeliefAnnotation::Declared(u16::try_from(at).unwrap_or(u16::MAX)), declared[at].ty),
            None if name.text == "source" => (BeliefAnnotation::Source, Type::Enum(self.players.agent_names)),
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
        args: &[TypedTerm],
        before: &[bool],
        call: &CallSyntax,
        env: &ExprEnv,
    ) {
        let Some(modes) = self.names.modes.get(&(agent, belief.0)).cloned() else { return };
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
                ArgumentMode::Free => false,
                ArgumentMode::Named => !open.is_empty(),
                ArgumentMode::Input => !open.is_empty() || has_any(arg),
            };
            if needs {
                let names = open.iter().filter_map(|v| env.locals.get(usize::from(*v)));
                self.unbound.extend(names.map(|l| l.name.clone()));
                self.report(agents::rule_needs(&call.name.text, i, span));
            }
        }
    }

    /// An expression of the kind that a variable or literal is compared with.
    pub(in crate::check) fn single(
        &mut self,
        e: &ast::ExprSyntax,
        kind: InferredType,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        if kind == InferredType::Unknown { self.expr(e, env) } else { self.expr_of(e, kind, env) }
    }
}

fn has_any(arg: &TypedTerm) -> bool {
    match arg {
        TypedTerm::Any => true,
        TypedTerm::Var(_) | TypedTerm::Expr(_) => false,
        TypedTerm::List(items, rest) => items.iter().chain(rest.as_deref()).any(has_any),
    }
}
