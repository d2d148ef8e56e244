//! What names in expressions stand for: locals, parameters of templates, constants, values of enumerations, signals.

use hrdsl_source::{Enumeration, Span, Symbol};
use hrdsl_syntax::ast::{self, NameSyntax};

use crate::check::{
    checker::Checker,
    state::{
        item::ExprItem,
        names::ConstState,
        scope::{ExprEnv, LocalName, is_variable_name},
        template::TemplateArgument,
    },
    value::{expr::symbol_value, measure::text, operands::names_in},
};
use crate::{
    TypedExpr, TypedExprKind,
    noun::Noun,
    report::{agents::unbound, automata::clock_misused, functions, names, types},
};

impl<'a> Checker<'a> {
    pub(in crate::check) fn path(&mut self, path: &ast::PathSyntax, env: &mut ExprEnv) -> ExprItem {
        if let [_, _, ..] = path.names.as_slice() {
            // A part of a local has a name of its own.
            if let Some(leaf) =
                env.find(&text(&path.names)).filter(|l| l.bound).and_then(|l| Some((l.leaf?, l.ty)))
            {
                return ExprItem::One(TypedExpr {
                    kind: TypedExprKind::Leaf(leaf.0),
                    ty: leaf.1,
                    span: path.span,
                });
            }
        }
        // Of an automaton, in a query.
        if let [_, _, fields @ ..] = path.names.as_slice()
            && let whole = text(&path.names[..2])
            && let Some(layout) = env.layout(&whole).cloned()
        {
            let item = self.assembled(&whole, &layout, env, path.span);
            return fields.iter().fold(item, |item, field| self.field(item, field));
        }
        let [first, fields @ ..] = path.names.as_slice() else { return ExprItem::error(path.span) };
        if let ([value, parts @ ..], Some(of)) = (fields, self.types.enums.get(&first.text)) {
            let of = self.s.enums[usize::from(of)].of;
            self.refer(first, self.types.enums.span_of(&first.text));
            self.refer_value(of, value);
            let symbol = ExprItem::One(self.symbol_named(of, value, first.span.to(value.span)));
            return parts.iter().fold(symbol, |item, part| self.field(item, part));
        }
        if let ([value, ..], None, None) = (fields, env.find(&first.text), env.layout(&first.text))
            && env.world.is_none()
            && let Some(of) = self.misspelt_enum(first, value)
        {
            self.report(names::unknown(Noun::Enum, &first.text, first.span, [of]));
            return ExprItem::error(path.span);
        }
        let Some(mut item) = self.named(first, env) else {
            let alone = fields.is_empty() || env.world.is_none();
            return ExprItem::One(if alone {
                self.without_value(first, env)
            } else {
                self.dotted(path, env)
            });
        };
        for field in fields {
            item = self.field(item, field);
        }
        item
    }

    /// What a name stands for that has a value; `None` if it has none.
    fn named(&mut self, name: &NameSyntax, env: &mut ExprEnv) -> Option<ExprItem> {
        if env.broken.contains(&name.text) {
            return Some(ExprItem::error(name.span));
        }
        if let Some(local) = env.find(&name.text) {
            return Some(ExprItem::One(self.local_named(name, local, env)));
        }
        if let Some(layout) = env.layout(&name.text).cloned() {
            if !self.all_bound(&name.text, &layout, env) {
                return Some(ExprItem::One(self.without_value(name, env)));
            }
            self.refer(name, env.place_of(&name.text));
            return Some(self.assembled(&name.text, &layout, env, name.span));
        }
        if self.given(&name.text).is_some() {
            self.refer_given(name);
        }
        match self.given(&name.text) {
            Some(TemplateArgument::Value(item)) => {
                let item = item.named_at(name.span);
                return Some(if self.may_copy(&item, 1, name.span) {
                    item
                } else {
                    ExprItem::error(name.span)
                });
            }
            Some(TemplateArgument::Unknown) => return Some(ExprItem::error(name.span)),
            Some(
                TemplateArgument::Events(_)
                | TemplateArgument::Actor(_)
                | TemplateArgument::Thing(..)
                | TemplateArgument::Point(_),
            )
            | None => {}
        }
        if let Some(constant) = self.consts.get(name.text.as_str()) {
            let place = constant.name.span;
            self.refer(name, Some(place));
            return Some(self.const_value(name));
        }
        if let Some(value) = self.enumeration_value(name) {
            return Some(value);
        }
        if env.plan
            && let Some(symbol) = self.players.agent_names.symbol(&name.text)
        {
            return Some(ExprItem::One(symbol_value(self.players.agent_names, symbol, name.span)));
        }
        self.signal_named(name, env).map(ExprItem::One)
    }

    /// The value of a variable of the place itself: a parameter, a bound variable or a clock.
    fn local_named(&mut self, name: &NameSyntax, local: &LocalName, env: &ExprEnv) -> TypedExpr {
        self.refer(name, Some(local.place));
        match local.leaf {
            Some(leaf) if local.bound => {
                TypedExpr { kind: TypedExprKind::Leaf(leaf), ty: local.ty, span: name.span }
            }
            Some(_) => self.without_value(name, env),
            None => {
                self.report(if self.shared.functions.open.is_some() {
                    functions::clock(&name.text, name.span)
                } else {
                    clock_misused(&name.text, name.span)
                });
                TypedExpr::error(name.span)
            }
        }
    }

    /// A value of an enumeration; of two enumerations that both have it, neither is meant.
    fn enumeration_value(&mut self, name: &NameSyntax) -> Option<ExprItem> {
        match self.types.values.get(name.text.as_str())?.as_slice() {
            &[of] => {
                self.refer_value(of, name);
                Some(ExprItem::One(symbol_value(of, Symbol::intern(&name.text), name.span)))
            }
            several => {
                let of: Vec<&str> = several.iter().map(|of| of.name()).collect();
                self.report(names::ambiguous(&name.text, &of, name.span));
                Some(ExprItem::error(name.span))
            }
        }
    }

    /// A name is that of a value of an enumeration, which is used by it.
    pub(in crate::check) fn refer_value(&mut self, of: Enumeration, name: &NameSyntax) {
        let Some(whole) = self.s.enums.iter().find(|e| e.of == of).map(|e| e.span) else { return };
        let value = self.s.names.named_in(whole, Noun::EnumValue, &name.text);
        self.refer(name, value);
        let enumeration = self.s.names.named_in(whole, Noun::Enum, of.name());
        self.refer(name, enumeration);
    }

    /// Whether a name like this is an agent's variable, and not a constant or another agent.
    pub(in crate::check) fn is_variable(&self, text: &str) -> bool {
        is_variable_name(text) && !self.has_value(text) && self.players.agent_names.symbol(text).is_none()
    }

    /// A plan's variable by its full name, of which `P.x` may be one.
    pub(in crate::check) fn variable(&mut self, name: &NameSyntax, env: &ExprEnv) -> TypedExpr {
        let local = env.find(&name.text).filter(|l| l.bound);
        self.refer(name, local.map(|l| l.place));
        match local.and_then(|l| Some((l.leaf?, l.ty))) {
            Some((leaf, ty)) => TypedExpr { kind: TypedExprKind::Leaf(leaf), ty, span: name.span },
            None => self.without_value(name, env),
        }
    }

    /// `Odrer.feed`: the enumeration that a name was meant to be, if it has the value and nothing has the name.
    fn misspelt_enum(&self, name: &NameSyntax, value: &NameSyntax) -> Option<&'static str> {
        if self.has_value(&name.text) || self.is_spoken_of(&name.text) {
            return None;
        }
        let of = self.types.values.get(value.text.as_str())?;
        let names = of.iter().map(|of| of.name());
        hrdsl_source::nearest(&name.text, names)
    }

    /// `Order.feed`
    fn symbol_named(&mut self, of: Enumeration, value: &NameSyntax, span: Span) -> TypedExpr {
        match of.symbol(&value.text) {
            Some(symbol) => symbol_value(of, symbol, span),
            None => {
                let near = of.values().iter().map(|v| v.name());
                self.report(names::unknown(Noun::EnumValue, &value.text, value.span, near));
                TypedExpr::error(span)
            }
        }
    }

    /// A name that has no value here.
    fn without_value(&mut self, name: &NameSyntax, env: &ExprEnv) -> TypedExpr {
        let names = self.names_with_value(env);
        self.unbound.insert(name.text.clone());
        if let Some(help) = self.values_of_type(name) {
            let is = if self.types.enums.get(&name.text).is_some() { Noun::Enum } else { Noun::Record };
            let noun = env.noun.unwrap_or(Noun::Constant);
            self.report(names::wrong_kind(noun, is, &name.text, name.span, []).help(help));
        } else if env.plan && is_variable_name(&name.text) {
            self.report(unbound(&name.text, name.span, names.iter().map(String::as_str)));
        } else {
            let said = self.issues.list.len();
            // A small letter instead of a capital one is likelier than that something far away was meant.
            let variable = env.noun.filter(|noun| env.plan && *noun == Noun::Variable);
            let apart = self.kind_of(&name.text).is_some_and(Noun::is_apart);
            self.unknown(env.noun.unwrap_or(Noun::Constant), name, &names, variable.filter(|_| apart));
            if variable.is_some()
                && let Some(issue) = self.issues.list.get_mut(said)
            {
                crate::report::agents::small_variable(issue, &name.text, &names);
            }
        }
        TypedExpr::error(name.span)
    }

    /// All names that have a value here.
    pub(in crate::check) fn names_with_value(&self, env: &ExprEnv) -> Vec<String> {
        let whole = |name: &str| !name.is_empty() && !name.contains(['.', '[']);
        let locals = env.all().filter(|l| l.bound && whole(&l.name)).map(|l| l.name.as_str());
        let mut names = self.near(locals.chain(env.layout_names()));
        names.extend(self.near_of(&[Noun::Constant]));
        let given = self.templates.given.iter().flat_map(|given| given.iter());
        names.extend(
            given
                .filter(|(_, bound)| matches!(bound.given, TemplateArgument::Value(_)))
                .map(|(n, _)| n.clone()),
        );
        names.extend(self.signal_names(env));
        if env.plan {
            names.extend(self.near(self.players.agent_names.values().iter().map(|s| s.name())));
        }
        names
    }

    /// How a value of the type of this name is written.
    fn values_of_type(&self, name: &NameSyntax) -> Option<String> {
        if let Some(of) = self.types.enums.get(&name.text) {
            let first = self.s.enums[usize::from(of)].of.values().first().copied()?;
            return Some(format!("name one of its values: `{}.{first}`", name.text));
        }
        let record = self.types.record_names.get(&name.text)?;
        let fields: Vec<&str> =
            self.types.records[usize::from(record)].fields.iter().map(|(n, _)| n.as_str()).collect();
        Some(format!("write `{}({})`", name.text, fields.join(", ")))
    }

    /// The value of a constant, worked out at its first use.
    fn const_value(&mut self, name: &NameSyntax) -> ExprItem {
        let Some(entry) = self.consts.get_mut(name.text.as_str()) else { return ExprItem::error(name.span) };
        match std::mem::replace(&mut entry.state, ConstState::Open) {
            ConstState::Done(item) => {
                let here = item.named_at(name.span);
                entry.state = ConstState::Done(item);
                here
            }
            ConstState::Open => {
                let declared = entry.name.span;
                self.report(types::constant_cycle(&name.text, name.span, declared));
                ExprItem::error(name.span)
            }
            ConstState::Unseen => {
                let declared = entry.name;
                self.work_out(declared);
                match self.consts.get(name.text.as_str()).map(|entry| &entry.state) {
                    Some(ConstState::Done(item)) => item.named_at(name.span),
                    Some(ConstState::Unseen | ConstState::Open) | None => ExprItem::error(name.span),
                }
            }
        }
    }

    /// Works out a constant after those that it names, without recursion: a chain of constants may be long.
    fn work_out(&mut self, name: &'a NameSyntax) {
        let mut open = vec![(name, self.unseen_in(name))];
        while let Some((name, needed)) = open.last_mut() {
            let name = *name;
            if let Some(next) = needed.pop() {
                let Some(entry) = self.consts.get_mut(next.text.as_str()) else { continue };
                if matches!(entry.state, ConstState::Unseen) {
                    entry.state = ConstState::Open;
                    let next = entry.name;
                    open.push((next, self.unseen_in(next)));
                }
                continue;
            }
            open.pop();
            let Some(value) = self.consts.get(name.text.as_str()).map(|entry| entry.value) else { continue };
            // A constant does not see the template that reads it.
            let given = self.templates.given.take();
            let mut item = self.item(value, &mut ExprEnv::constants());
            self.templates.given = given;
            if !item.is_constant() {
                item = ExprItem::error(item.span());
            }
            let ty = self.shown(&item);
            self.s.names.infer(name.span, ty);
            if let Some(entry) = self.consts.get_mut(name.text.as_str()) {
                entry.state = ConstState::Done(item);
            }
        }
    }

    /// The constants that the value of a constant names and that are not worked out, the first last.
    fn unseen_in(&self, name: &NameSyntax) -> Vec<&'a NameSyntax> {
        let entry = self.consts.get(name.text.as_str());
        let mut names = entry.map_or_else(Vec::new, |entry| names_in(entry.value));
        let unseen = |n: &&NameSyntax| {
            self.consts.get(n.text.as_str()).is_some_and(|c| matches!(c.state, ConstState::Unseen))
        };
        names.retain(unseen);
        names.reverse();
        names
    }

    /// Works out all constants, so that each fault in one is found.
    pub(in crate::check) fn all_consts(&mut self) {
        let names: Vec<NameSyntax> = self.consts.values().map(|c| c.name.clone()).collect();
        for name in names {
            self.const_value(&name);
        }
    }
}
