//! Templates: declarations with parameters, what an instance gives for them, and the check of a template by itself.

use std::{collections::BTreeSet, rc::Rc};

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};
use hrdsl_syntax::ast::{
    self, ExprSyntaxKind as Syntax, ItemSyntaxKind, NameSyntax, TemplateSyntaxKind, TypeExpr,
};

use crate::check::{
    checker::Checker,
    state::{
        item::ExprItem,
        scope::ExprEnv,
        template::{BoundParam, DeclaredTemplate, TemplateArgument, TemplateArguments, kind_word},
    },
    value::measure,
};
use crate::{
    BinaryOp, EventPattern, InferredType, List, Text, Type, TypedExpr, Value,
    noun::Noun,
    report::{names, types},
    resolution::of_sort,
    types::TypeLayout,
};

/// Values that stand for the parameters of a template that is checked by itself.
#[derive(Clone, Copy)]
pub(in crate::check) enum TemplateTrial {
    Least,
    Greatest,
    /// Least and greatest in turn.
    Mixed,
    Mirrored,
}

impl TemplateTrial {
    pub const ALL: [TemplateTrial; 4] =
        [TemplateTrial::Greatest, TemplateTrial::Least, TemplateTrial::Mixed, TemplateTrial::Mirrored];

    fn great(self, index: usize) -> bool {
        match self {
            TemplateTrial::Least => false,
            TemplateTrial::Greatest => true,
            TemplateTrial::Mixed => index.is_multiple_of(2),
            TemplateTrial::Mirrored => !index.is_multiple_of(2),
        }
    }
}

/// The kind of a parameter that is no value.
fn kind_of_param(param: &ast::ParamSyntax) -> Option<Noun> {
    match &param.ty {
        TypeExpr::Named(name) => kind_word(&name.text),
        TypeExpr::Range(..) | TypeExpr::Array(..) | TypeExpr::List(_) | TypeExpr::Error => None,
    }
}

/// The template that an item declares, if it has parameters.
pub(in crate::check) fn template(
    kind: &ItemSyntaxKind,
) -> Option<(TemplateSyntaxKind, DeclaredTemplate<'_>)> {
    let (sort, name, params) = match kind {
        ItemSyntaxKind::Agent(a) => (TemplateSyntaxKind::Agent, &a.name, &a.params),
        ItemSyntaxKind::Automaton(a) => (TemplateSyntaxKind::Automaton, &a.name, &a.params),
        ItemSyntaxKind::Require(r) => (TemplateSyntaxKind::Require, &r.name, &r.params),
        ItemSyntaxKind::Cover(c) => (TemplateSyntaxKind::Cover, &c.name, &c.params),
        ItemSyntaxKind::Cross(c) => (TemplateSyntaxKind::Cross, &c.name, &c.params),
        ItemSyntaxKind::Use(_)
        | ItemSyntaxKind::Allow(_)
        | ItemSyntaxKind::Enum { .. }
        | ItemSyntaxKind::Record { .. }
        | ItemSyntaxKind::Actor { .. }
        | ItemSyntaxKind::Const { .. }
        | ItemSyntaxKind::Event(_)
        | ItemSyntaxKind::Stimulus(_)
        | ItemSyntaxKind::Var(_)
        | ItemSyntaxKind::Channel(_)
        | ItemSyntaxKind::Function(_)
        | ItemSyntaxKind::Query(_)
        | ItemSyntaxKind::Network { .. }
        | ItemSyntaxKind::Assume(_)
        | ItemSyntaxKind::Suite(_)
        | ItemSyntaxKind::Part(_)
        | ItemSyntaxKind::Device(_)
        | ItemSyntaxKind::World(_)
        | ItemSyntaxKind::System(_)
        | ItemSyntaxKind::Test(_)
        | ItemSyntaxKind::Instance(_)
        | ItemSyntaxKind::Error => return None,
    };
    params.as_deref().map(|params| (sort, DeclaredTemplate { kind, name, params }))
}

impl<'a> Checker<'a> {
    /// A name that a template of the sort has already.
    pub(in crate::check) fn not_a_template(&mut self, sort: TemplateSyntaxKind, name: &NameSyntax) {
        let first = self.templates.declared.get(&(sort, name.text.as_str())).map(|t| t.name.span);
        if first.is_some() {
            self.report(names::duplicate(Noun::Template, &name.text, name.span, first));
        }
    }

    /// What a name stands for in the instance that is being checked.
    pub(in crate::check) fn given(&self, name: &str) -> Option<&TemplateArgument> {
        self.templates.given.as_ref()?.get(name).map(|bound| &bound.given)
    }

    /// A name is that of a parameter of the template.
    pub(in crate::check) fn refer_given(&mut self, name: &NameSyntax) {
        let place =
            self.templates.given.as_ref().and_then(|given| given.get(&name.text)).map(|bound| bound.place);
        self.refer(name, place);
    }

    /// The parameters that stand for something of this kind, or may do so.
    pub(in crate::check) fn given_names(&self, kind: Noun) -> Vec<String> {
        let given = self.templates.given.iter().flat_map(|given| given.iter());
        given.filter(|(_, bound)| bound.given.is(kind)).map(|(name, _)| name.clone()).collect()
    }

    /// A name that is never bound by a pattern: a constant, a value of an enumeration, a parameter of the template.
    pub(in crate::check) fn has_value(&self, text: &str) -> bool {
        self.consts.contains_key(text) || self.types.values.contains_key(text) || self.given(text).is_some()
    }

    /// The template that an instance is of, and what is given for its parameters.
    pub(in crate::check) fn instance(
        &mut self,
        instance: &'a ast::InstanceSyntax,
        env: &ExprEnv,
    ) -> Option<(DeclaredTemplate<'a>, Rc<TemplateArguments>)> {
        let made = self.make_instance(instance, env);
        if made.is_none() {
            self.templates.broken_instances.insert(instance.name.text.clone());
        }
        made
    }

    fn make_instance(
        &mut self,
        instance: &'a ast::InstanceSyntax,
        env: &ExprEnv,
    ) -> Option<(DeclaredTemplate<'a>, Rc<TemplateArguments>)> {
        let Some(template) =
            self.templates.declared.get(&(instance.sort, instance.of.text.as_str())).copied()
        else {
            let sort = of_sort(instance.sort).word();
            let of_sort = self.s.names.all_of(Noun::Template).filter(|template| template.noun == sort);
            let all = self.near(of_sort.map(|template| template.name.as_str()));
            // That the name is one of a plain declaration says that it has no parameters.
            self.unknown(Noun::Template, &instance.of, &all, None);
            return None;
        };
        self.refer(&instance.of, Some(template.name.span));
        let given = self.bind(template.name, template.params, &instance.args, instance.span, env, true)?;
        Some((template, given))
    }

    /// What the arguments give for the parameters. `whole`: the world is there, and what they name must be in it.
    pub(in crate::check) fn bind(
        &mut self,
        name: &NameSyntax,
        params: &[ast::ParamSyntax],
        args: &[ast::ExprSyntax],
        span: Span,
        env: &ExprEnv,
        whole: bool,
    ) -> Option<Rc<TemplateArguments>> {
        if args.len() != params.len() {
            let names: Vec<&str> = params.iter().map(|p| p.name.text.as_str()).collect();
            self.report(types::arity(Noun::Template, &name.text, &names, args.len(), span));
            return None;
        }
        let mut given = TemplateArguments::default();
        for (param, arg) in params.iter().zip(args) {
            let value = match kind_of_param(param) {
                Some(kind) => self.given_thing(kind, arg, env, whole),
                None => {
                    let layout = self.inside(&given, |c| c.layout(&param.ty));
                    match layout {
                        Some(layout) => {
                            TemplateArgument::Value(self.item_for(arg, &layout, &mut env.clone()))
                        }
                        None => TemplateArgument::Unknown,
                    }
                }
            };
            let bound = BoundParam { given: value, place: param.name.span };
            given.insert(param.name.text.clone(), bound);
        }
        Some(Rc::new(given))
    }

    /// Something that sees these parameters.
    fn inside<T>(&mut self, given: &TemplateArguments, f: impl FnOnce(&mut Self) -> T) -> T {
        let outer = self.templates.given.replace(Rc::new(given.clone()));
        let result = f(self);
        self.templates.given = outer;
        result
    }

    fn given_thing(
        &mut self,
        kind: Noun,
        arg: &ast::ExprSyntax,
        env: &ExprEnv,
        whole: bool,
    ) -> TemplateArgument {
        if kind == Noun::Event
            && let Some(patterns) = self.alternatives(arg)
        {
            return patterns.map_or(TemplateArgument::Unknown, TemplateArgument::Events);
        }
        let Syntax::Path(path) = &arg.kind else {
            if arg.kind != Syntax::Error {
                self.report(types::needs_name(kind, arg.span));
            }
            return TemplateArgument::Unknown;
        };
        if let [name] = path.names.as_slice()
            && let Some(outer) = self.given(&name.text).cloned()
        {
            if outer.is(kind) {
                return outer;
            }
            let issue = names::wrong_kind(kind, Noun::Parameter, &name.text, name.span, []);
            self.report(issue.help(format!("this parameter does not stand for {}", kind.with_article())));
            return TemplateArgument::Unknown;
        }
        match (kind, path.names.as_slice()) {
            (Noun::Actor, [name]) => {
                self.actor(name).map_or(TemplateArgument::Unknown, TemplateArgument::Actor)
            }
            (Noun::Point, [name]) => {
                self.point_named(name).map_or(TemplateArgument::Unknown, TemplateArgument::Point)
            }
            (Noun::Actor | Noun::Point | Noun::Event, _) => {
                self.report(types::needs_name(kind, arg.span));
                TemplateArgument::Unknown
            }
            (_, _) => {
                let prefix = env.world.clone().unwrap_or_default();
                let known = !whole
                    || if kind == Noun::Body {
                        self.body_ref(&path.names, &prefix).is_some()
                    } else {
                        self.world_name(kind, &path.names, &prefix).is_some()
                    };
                let full = format!("{prefix}{}", measure::text(&path.names));
                if known { TemplateArgument::Thing(kind, full) } else { TemplateArgument::Unknown }
            }
        }
    }

    /// `a`, `a(true)`, `a or b(_)`: `None` if it is nothing of this form.
    fn alternatives(&mut self, arg: &ast::ExprSyntax) -> Option<Option<Vec<EventPattern>>> {
        if let Syntax::Binary { op: BinaryOp::Or, left, right } = &arg.kind {
            let (left, right) = (self.alternatives(left)?, self.alternatives(right)?);
            return Some(left.zip(right).map(|(mut l, r)| {
                l.extend(r);
                l
            }));
        }
        let (path, args) = if let Syntax::Call { callee, args } = &arg.kind {
            (callee, Some(args.clone()))
        } else if let Syntax::Path(path) = &arg.kind {
            (path, None)
        } else {
            return None;
        };
        let [name] = path.names.as_slice() else { return None };
        Some(self.pattern_of(&ast::CallSyntax { name: name.clone(), args, span: arg.span }))
    }

    fn pattern_of(&mut self, call: &ast::CallSyntax) -> Option<Vec<EventPattern>> {
        let before = self.issues.list.len();
        let patterns = self.patterns(std::slice::from_ref(call));
        (self.issues.list.len() == before && !patterns.is_empty()).then_some(patterns)
    }

    // ── the template by itself ──

    /// What the parameters are in the check of the template by itself: some value of their type, or nothing known.
    fn placeholders(&mut self, params: &[ast::ParamSyntax], trial: TemplateTrial) -> Rc<TemplateArguments> {
        let mut given = TemplateArguments::default();
        for (index, param) in params.iter().enumerate() {
            let value = if kind_of_param(param).is_some() {
                TemplateArgument::Unknown
            } else {
                match self.inside(&given, |c| c.layout(&param.ty)) {
                    Some(layout) => {
                        TemplateArgument::Value(self.some_value(&layout, param.name.span, trial.great(index)))
                    }
                    None => TemplateArgument::Unknown,
                }
            };
            let bound = BoundParam { given: value, place: param.name.span };
            if given.insert(param.name.text.clone(), bound).is_some() {
                self.report(names::duplicate(Noun::Parameter, &param.name.text, param.name.span, None));
            }
        }
        Rc::new(given)
    }

    fn some_value(&self, layout: &TypeLayout, span: Span, great: bool) -> ExprItem {
        let one = |ty: Type| {
            let value = match ty {
                Type::Bool => Value::Bool(great),
                Type::Int { lo, hi } => Value::Int(if great { hi } else { lo }),
                Type::Float(_) => Value::Float(if great { 1000.0 } else { 1.0 }),
                Type::Enum(of) => {
                    let values = of.values();
                    let value = if great { values.last() } else { values.first() };
                    value.map_or(Value::Bool(false), |v| Value::Symbol(*v))
                }
                Type::Text => Value::Text(Text::new(if great { "b" } else { "a" })),
                Type::List(_) => Value::List(List::EMPTY),
            };
            ExprItem::One(TypedExpr::value(value, InferredType::of(ty), span))
        };
        match layout {
            TypeLayout::Scalar(ty) => one(*ty),
            TypeLayout::Unknown => ExprItem::error(span),
            TypeLayout::Record(id) => {
                let fields = &self.types.records[usize::from(*id)].fields;
                let parts = fields.iter().map(|(_, l)| self.some_value(l, span, great)).collect();
                ExprItem::Record(*id, parts, span)
            }
            TypeLayout::Array(of, n) => {
                ExprItem::Array((0..*n).map(|_| self.some_value(of, span, great)).collect(), span)
            }
        }
    }

    /// The diagnostics since then are of an instance: what is new in them is said with the instance.
    pub(in crate::check) fn said_in(&mut self, before: usize, instance: Option<(&NameSyntax, Span)>) {
        let new = self.issues.list.split_off(before);
        let found = !new.is_empty();
        if found {
            // Each issue is entered once, however many instances there are.
            let unseen = self.issues.list.get(self.issues.said_of..).unwrap_or_default();
            self.issues.said.extend(unseen.iter().map(|i| (i.code, i.span())));
        }
        for issue in new {
            if !self.issues.said.insert((issue.code, issue.span())) {
                continue;
            }
            self.issues.list.push(match instance {
                Some((name, span)) => issue.label(span, format!("in the instance `{}`", name.text)),
                None => issue,
            });
        }
        if found {
            self.issues.said_of = self.issues.list.len();
        }
    }
}

/// The checker, or a phase over it.
pub(in crate::check) trait CheckerPhase<'a> {
    fn checker(&mut self) -> &mut Checker<'a>;

    /// A name means what is declared there.
    fn refer(&mut self, name: &NameSyntax, place: Option<Span>) {
        self.checker().refer(name, place);
    }

    fn report(&mut self, issue: Diagnostic) {
        self.checker().report(issue);
    }

    /// Checks each template of a sort by itself.
    fn templates_of(&mut self, sort: TemplateSyntaxKind, check: impl Fn(&mut Self, DeclaredTemplate<'a>)) {
        let of_sort =
            |((s, _), t): (&(TemplateSyntaxKind, &'a str), &DeclaredTemplate<'a>)| (*s == sort).then_some(*t);
        let templates: Vec<DeclaredTemplate<'a>> =
            self.checker().templates.declared.iter().filter_map(of_sort).collect();
        for template in templates {
            self.by_itself(template.params, |c| check(c, template));
        }
    }

    /// Checks something with parameters by itself. Wrong is what is wrong whatever the parameters stand for: with each
    /// of several values. What is wrong with some values only is found in the instances that give them.
    fn by_itself(&mut self, params: &[ast::ParamSyntax], check: impl Fn(&mut Self)) {
        let issues = &self.checker().issues;
        let before = issues.list.len();
        let mut always: Option<Vec<Diagnostic>> = None;
        // What is said in one trial may be taken back.
        let (said, said_of) = (issues.said.clone(), issues.said_of);
        for trial in TemplateTrial::ALL {
            let checker = self.checker();
            let given = checker.placeholders(params, trial);
            let outer = checker.templates.given.replace(given);
            let alone = std::mem::replace(&mut checker.templates.by_itself, true);
            check(self);
            let checker = self.checker();
            checker.templates.by_itself = alone;
            checker.templates.given = outer;
            let found = checker.issues.list.split_off(before);
            checker.issues.said.clone_from(&said);
            checker.issues.said_of = said_of;
            let places: BTreeSet<(DiagnosticCode, Span)> = found.iter().map(|f| (f.code, f.span())).collect();
            let again = |known: &Diagnostic| places.contains(&(known.code, known.span()));
            always = Some(match always {
                None => found,
                Some(known) => known.into_iter().filter(again).collect(),
            });
            if always.as_ref().is_some_and(Vec::is_empty) {
                break;
            }
        }
        self.checker().issues.list.extend(always.unwrap_or_default());
    }

    /// Checks a template as one instance. What is wrong with the template itself has been said; the rest is said with
    /// the instance that it is wrong in.
    fn as_instance<T>(
        &mut self,
        given: Option<Rc<TemplateArguments>>,
        instance: Option<(&NameSyntax, Span)>,
        check: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let Some(given) = given else { return check(self) };
        let checker = self.checker();
        let outer = checker.templates.given.replace(given);
        let before = checker.issues.list.len();
        let result = check(self);
        let checker = self.checker();
        checker.templates.given = outer;
        checker.said_in(before, instance);
        result
    }
}

impl<'a> CheckerPhase<'a> for Checker<'a> {
    fn checker(&mut self) -> &mut Checker<'a> {
        self
    }
}
