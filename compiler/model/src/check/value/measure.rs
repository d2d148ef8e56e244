//! Names and measurements of the world in expressions.

use hrdsl_source::{Span, nearest};
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax, NameSyntax};

use crate::check::{
    checker::Checker,
    state::{scope::ExprEnv, template::TemplateArgument},
    value::expr::FUNCTIONS,
};
use crate::{
    Axis, BodyRef, Dimension, GripperId, InferredType, SignalId, SignalTerm, TypedExpr, TypedExprKind,
    VariableRef,
    measures::MEASURES,
    noun::Noun,
    report::{names, types},
};

impl Checker<'_> {
    /// A declared signal.
    pub(in crate::check) fn signal_named(&mut self, name: &NameSyntax, env: &ExprEnv) -> Option<TypedExpr> {
        let prefix = env.world.as_ref()?;
        let id = self.world.names.signals.get(&format!("{prefix}{}", name.text))?;
        self.refer(name, self.world.names.signals.span(id));
        Some(self.signal(id, name.span))
    }

    fn signal(&self, id: u16, span: Span) -> TypedExpr {
        let ty = self.s.world.as_ref().and_then(|w| w.signals.get(usize::from(id)));
        if ty.is_some_and(|s| self.world.names.broken.contains(&s.name)) {
            return TypedExpr::error(span);
        }
        let ty = ty.map_or(InferredType::Unknown, |s| InferredType::of(s.ty));
        TypedExpr { kind: TypedExprKind::Leaf(VariableRef::Signal(SignalId(id))), ty, span }
    }

    pub(in crate::check) fn signal_names(&self, env: &ExprEnv) -> Vec<String> {
        match &env.world {
            Some(prefix) => self.world.names.below(Noun::Signal, prefix),
            None => Vec::new(),
        }
    }

    /// `person.hand.x`, `robot.signal`
    pub(in crate::check) fn dotted(&mut self, path: &ast::PathSyntax, env: &ExprEnv) -> TypedExpr {
        let Some(prefix) = env.world.clone() else {
            self.report(names::unknown(
                env.noun.unwrap_or(Noun::Constant),
                &text(&path.names),
                path.span,
                [],
            ));
            return TypedExpr::error(path.span);
        };
        let full = format!("{prefix}{}", text(&path.names));
        if let Some(id) = self.world.names.signals.get(&full) {
            self.refer_in_world(Noun::Signal, &path.names, &full);
            return self.signal(id, path.span);
        }
        let (axis, body) = path.names.split_last().expect("a path has a name");
        let whole = self
            .full_name(&path.names, &prefix)
            .is_some_and(|full| self.world.names.body_ref(&full).is_some());
        if whole {
            let issue = types::no_value(&format!("the body `{}`", text(&path.names)), path.span);
            self.report(issue.help(format!("name a coordinate: `{}.x`", text(&path.names))));
            return TypedExpr::error(path.span);
        }
        if let Some(base) = self.full_name(body, &prefix).filter(|base| self.world.names.is_instance(base)) {
            if !self.world.names.broken.contains(&base) {
                let near = self.world.names.below(Noun::Signal, &format!("{base}."));
                self.unknown(Noun::Signal, axis, &near, Some(Noun::Signal));
            }
            return TypedExpr::error(path.span);
        }
        if let [only] = body
            && let Some((noun, near)) = self.meant_in_world(only, &prefix, env)
        {
            self.unknown(noun, only, &near, None);
            return TypedExpr::error(path.span);
        }
        let Some(body) = self.body_ref(body, &prefix) else { return TypedExpr::error(path.span) };
        match self.choice(Noun::Coordinate, axis, &["x", "y", "z"]) {
            Some(axis) => {
                let axis = [Axis::X, Axis::Y, Axis::Z][axis];
                term(SignalTerm::Coordinate(body, axis), InferredType::Float(Dimension::LENGTH), path.span)
            }
            None => TypedExpr::error(path.span),
        }
    }

    /// What a name before a dot is near to, if that is a value or a part of the world, and no body is.
    fn meant_in_world(&self, name: &NameSyntax, prefix: &str, env: &ExprEnv) -> Option<(Noun, Vec<String>)> {
        let near = |names: &[String]| nearest(&name.text, names.iter().map(String::as_str)).is_some();
        let full = self.full_name(std::slice::from_ref(name), prefix)?;
        let bodies = self.world.names.below(Noun::Body, prefix);
        if self.world.names.kind_of(&full).is_some() || near(&bodies) {
            return None;
        }
        let values = self.names_with_value(env);
        let parts = self.world.names.below(Noun::PartInstance, prefix);
        let found = [(Noun::Constant, values), (Noun::PartInstance, parts)];
        found.into_iter().find(|(_, names)| near(names))
    }

    /// A function over the world.
    pub(in crate::check) fn measured(
        &mut self,
        callee: &ast::PathSyntax,
        args: &[ast::ExprSyntax],
        span: Span,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        let name = text(&callee.names);
        let known = MEASURES.contains(&name.as_str());
        let Some(prefix) = env.world.clone().filter(|_| known) else {
            self.no_function(callee, env, known);
            args.iter().for_each(|a| self.item_quietly(a, env));
            return TypedExpr::error(span);
        };
        let want = match name.as_str() {
            "distance" | "range" | "angle" | "visible" | "touches" | "delta" => 2..=2,
            "holds" | "force" | "transient_force" | "quasistatic_force" => 1..=2,
            "estimated_pressure" => 2..=3,
            "nearest" if args.len() != 1 => 3..=3,
            _ => 1..=1,
        };
        if !want.contains(&args.len()) {
            self.report(types::counts(Noun::Function, &name, *want.start(), args.len(), span));
            return TypedExpr::error(span);
        }
        self.term(&name, args, &prefix, span).unwrap_or_else(|| TypedExpr::error(span))
    }

    fn term(&mut self, name: &str, args: &[ast::ExprSyntax], prefix: &str, span: Span) -> Option<TypedExpr> {
        let length = InferredType::Float(Dimension::LENGTH);
        let (what, ty) = match name {
            "joint_speed" | "joint_angle" | "torque" | "joint_position" | "joint_effort" => {
                self.of_joint(name, &args[0], prefix)?
            }
            "nearest" => self.nearest(args, prefix, span)?,
            "estimated_pressure" => self.pressure(args, prefix)?,
            "delta" => self.delta(&args[0], &args[1], prefix)?,
            "reading" => self.reading(&args[0], prefix)?,
            "touches" | "force" | "weight" | "transient_force" | "quasistatic_force" => {
                self.contact(name, args, prefix)?
            }
            "holds" => {
                let gripper = self.world_arg(Noun::Gripper, &args[0], prefix).map(GripperId);
                let body = args.get(1).map(|a| self.body_arg(a, prefix));
                match body {
                    Some(body) => (SignalTerm::Holds(gripper?, body?), InferredType::Bool),
                    None => (SignalTerm::HoldsAny(gripper?), InferredType::Bool),
                }
            }
            "speed" | "heading" | "tilt" | "height" => {
                let body = self.body_arg(&args[0], prefix)?;
                match name {
                    "speed" => (SignalTerm::Speed(body), InferredType::Float(Dimension::SPEED)),
                    "heading" => (SignalTerm::Heading(body), InferredType::Float(Dimension::ANGLE)),
                    "tilt" => (SignalTerm::Tilt(body), InferredType::Float(Dimension::ANGLE)),
                    _ => (SignalTerm::Height(body), length),
                }
            }
            _ => {
                let (a, b) = (self.body_arg(&args[0], prefix), self.body_arg(&args[1], prefix));
                let (a, b) = (a?, b?);
                match name {
                    "distance" => (SignalTerm::Distance(a, b), length),
                    "range" => (SignalTerm::Range(a, b), length),
                    "angle" => (SignalTerm::Angle(a, b), InferredType::Float(Dimension::ANGLE)),
                    _ => (SignalTerm::Visible(a, b), InferredType::Bool),
                }
            }
        };
        Some(term(what, ty, span))
    }

    /// An argument that names a body.
    pub(in crate::check) fn body_arg(&mut self, arg: &ast::ExprSyntax, prefix: &str) -> Option<BodyRef> {
        let Syntax::Path(path) = &arg.kind else {
            self.report(not_a_name(Noun::Body, arg.span));
            return None;
        };
        self.body_ref(&path.names, prefix)
    }

    pub(in crate::check) fn world_arg(
        &mut self,
        noun: Noun,
        arg: &ast::ExprSyntax,
        prefix: &str,
    ) -> Option<u16> {
        let Syntax::Path(path) = &arg.kind else {
            self.report(not_a_name(noun, arg.span));
            return None;
        };
        self.world_name(noun, &path.names, prefix)
    }

    /// A body or current body.
    pub(in crate::check) fn body_ref(&mut self, names: &[NameSyntax], prefix: &str) -> Option<BodyRef> {
        let full = self.full_name(names, prefix)?;
        if let Some(body) = self.world.names.body_ref(&full) {
            self.refer_in_world(Noun::Body, names, &full);
            return Some(body);
        }
        self.world_name(Noun::Body, names, prefix);
        None
    }

    /// That there is no world is one fault, however much needs one.
    pub(in crate::check) fn say_without_world(&mut self) {
        const PLACES: usize = 8;
        let mut places = std::mem::take(&mut self.world.missed);
        places.sort();
        places.dedup();
        let Some(((span, name), others)) = places.split_first() else { return };
        let message = match others.len() {
            0 => format!("`{name}` needs a world, and the scenario has none"),
            more => format!("`{name}` and {more} more need a world, and the scenario has none"),
        };
        let mut issue = names::missing(*span, message, "declare it: `world { … }`");
        for (span, _) in others.iter().take(PLACES) {
            issue = issue.label(*span, "and this");
        }
        self.report(issue);
    }

    /// Something in the world by its dotted name, or a diagnostic at the first name that leads nowhere.
    pub(in crate::check) fn world_name(
        &mut self,
        noun: Noun,
        names: &[NameSyntax],
        prefix: &str,
    ) -> Option<u16> {
        let full = self.full_name(names, prefix)?;
        if let Some(id) = self.world.names.get(noun, &full) {
            self.refer_in_world(noun, names, &full);
            return Some(id);
        }
        if let Some(TemplateArgument::Thing(is, given)) = self.given(&names[0].text) {
            let (is, given) = (*is, given.clone());
            return self.not_in_given(noun, is, names, &given);
        }
        if !prefix.is_empty() && self.world.names.broken.contains(prefix.trim_end_matches('.')) {
            return None;
        }
        if !self.world.exists && prefix.is_empty() {
            let span = names[0].span.to(names[names.len() - 1].span);
            self.world.missed.push((span, text(names)));
            return None;
        }
        let mut base = prefix.to_owned();
        for name in &names[..names.len() - 1] {
            let full = format!("{base}{}", name.text);
            if !self.world.names.is_instance(&full) {
                let near = self.world.names.below(Noun::PartInstance, &base);
                let is = self.world.names.kind_of(&full);
                self.unknown(Noun::PartInstance, name, &near, is);
                return None;
            }
            if self.world.names.broken.contains(&full) {
                return None;
            }
            base = format!("{full}.");
        }
        let last = &names[names.len() - 1];
        let mut near = self.world.names.below(noun, &base);
        if names.len() == 1 {
            near.extend(self.given_names(noun));
        }
        let is = self.world.names.kind_of(&format!("{base}{}", last.text));
        // Within a part, what the name is elsewhere says nothing.
        let is = is.or(if base.is_empty() { None } else { Some(noun) });
        self.unknown(noun, last, &near, is);
        None
    }

    /// The full name of something of the world, which a parameter may stand for; `None` if that is not known.
    pub(in crate::check) fn full_name(&self, names: &[NameSyntax], prefix: &str) -> Option<String> {
        match self.given(&names[0].text) {
            Some(TemplateArgument::Unknown) => None,
            Some(TemplateArgument::Thing(_, full)) if names.len() == 1 => Some(full.clone()),
            Some(TemplateArgument::Thing(_, full)) => Some(format!("{full}.{}", text(&names[1..]))),
            Some(
                TemplateArgument::Value(_)
                | TemplateArgument::Events(_)
                | TemplateArgument::Actor(_)
                | TemplateArgument::Point(_),
            )
            | None => Some(format!("{prefix}{}", text(names))),
        }
    }

    /// The names of a path in the world: the last is that of something of this kind, each before it that of an instance of a
    /// part.
    pub(in crate::check) fn refer_in_world(&mut self, noun: Noun, names: &[NameSyntax], full: &str) {
        if self.given(&names[0].text).is_some() {
            return self.refer_given(&names[0]);
        }
        let (mut noun, mut whole) = (noun, full);
        for name in names.iter().rev() {
            self.refer(name, self.world.names.place_of(noun, whole));
            let Some((outer, _)) = whole.rsplit_once('.') else { break };
            (noun, whole) = (Noun::PartInstance, outer);
        }
    }

    /// What a parameter stands for has no such thing, or is of another kind.
    fn not_in_given(&mut self, noun: Noun, is: Noun, names: &[NameSyntax], given: &str) -> Option<u16> {
        if self
            .world
            .names
            .broken
            .iter()
            .any(|b| given.strip_prefix(b).is_some_and(|rest| rest.starts_with('.')))
        {
            return None;
        }
        match names {
            [only] => {
                let base = given.rsplit_once('.').map_or(String::new(), |(base, _)| format!("{base}."));
                let near = self.world.names.below(noun, &base).into_iter().map(|n| format!("{base}{n}"));
                let near: Vec<String> = near.collect();
                let is = self.world.names.kind_of(given).or((is != noun).then_some(is));
                let before = self.issues.list.len();
                self.unknown(noun, &NameSyntax { text: given.to_owned(), span: only.span }, &near, is);
                // What is to be fixed is what the instance gives.
                for issue in self.issues.list.iter_mut().skip(before) {
                    let help = issue.help.take().map_or(String::new(), |help| format!(": {help}"));
                    issue.help = Some(format!("`{}` stands for `{given}`{help}", only.text));
                    issue.fixes.clear();
                }
            }
            [_, .., last] => {
                let near = self.world.names.below(noun, &format!("{given}."));
                self.unknown(noun, last, &near, Some(noun));
            }
            [] => {}
        }
        None
    }

    fn no_function(&mut self, callee: &ast::PathSyntax, env: &ExprEnv, known: bool) {
        let name = text(&callee.names);
        if known {
            let message = format!("`{name}` is measured in the world, which cannot be read here");
            let issue = types::no_value("a measurement", callee.span);
            self.report(hrdsl_source::Diagnostic { message, ..issue });
            return;
        }
        if let [name] = callee.names.as_slice()
            && self.function_elsewhere(name)
        {
            return;
        }
        let mut all: Vec<String> = FUNCTIONS.iter().map(|f| f.0.to_owned()).collect();
        if env.world.is_some() {
            all.extend(MEASURES.map(str::to_owned));
        }
        all.extend(self.near_of(&[Noun::Record]));
        all.extend(env.function_names().map(str::to_owned));
        let callee = NameSyntax { text: name, span: callee.span };
        self.unknown(Noun::Function, &callee, &all, None);
    }

    /// Checks what can be checked about an argument of an unknown function: nothing is said about names of bodies.
    fn item_quietly(&mut self, e: &ast::ExprSyntax, env: &mut ExprEnv) {
        if let Syntax::Tuple(parts) = &e.kind {
            parts.iter().for_each(|p| self.item_quietly(p, env));
        } else if !matches!(e.kind, Syntax::Path(_) | Syntax::Any) {
            self.item(e, env);
        }
    }
}

fn not_a_name(noun: Noun, span: Span) -> hrdsl_source::Diagnostic {
    types::no_value("this expression", span).help(format!("name {} of the world here", noun.with_article()))
}

fn term(term: SignalTerm, ty: InferredType, span: Span) -> TypedExpr {
    TypedExpr { kind: TypedExprKind::Term(term), ty, span }
}

/// A dotted name as text.
pub(in crate::check) fn text(names: &[NameSyntax]) -> String {
    names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(".")
}
