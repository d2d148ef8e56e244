//! The processes of the system: templates with their arguments, their locations and edges.

use hrdsl_source::Span;

use super::{
    ast::{UppaalExpr, UppaalExprKind, UppaalInstance, UppaalParameter, UppaalSync},
    clocks::GuardConjunction,
    declare::{in_range, var_line},
    fault::{UppaalFault, fault},
    scope::{
        NameOwner, ScenarioExprText, UppaalScope, UppaalSymbol, UppaalSymbolType, VarSym, combinations,
        numbered,
    },
    template::ParsedEdge,
    translation::{UppaalProcess, UppaalTranslation},
    write::one_line,
    xml::UppaalTransition,
};
use crate::exchange::note::NoteSeverity;

/// How many processes a system may have.
const MAX_PROCESSES: usize = 512;

/// What a process is made of, before its automaton is written.
pub struct UppaalProcessPlan {
    pub model_name: String,
    pub args: Vec<i64>,
    pub template: usize,
    pub scope: UppaalScope,
    /// The text of its arguments, for people.
    pub shown: Vec<String>,
}

impl UppaalTranslation<'_> {
    // ── Instances ──

    /// What the name in the `system` line stands for: one process, or one for each value of its parameters.
    pub fn plans(
        &mut self,
        name: &str,
        span: Span,
        instances: &[UppaalInstance],
    ) -> Result<Vec<UppaalProcessPlan>, UppaalFault> {
        let params = match instances.iter().find(|i| i.name == name) {
            Some(instance) => instance.params.clone(),
            None => match self.templates.iter().find(|t| t.name == name) {
                Some(template) => template.params.clone(),
                None => return fault(span, format!("there is no template or process `{name}`")),
            },
        };
        let mut scalars = Vec::new();
        for param in &params {
            let ty = self.declared(&param.ty, &param.dims)?;
            match ty {
                UppaalSymbolType::Data(scalar, dims) if dims.is_empty() && !param.by_reference => {
                    scalars.push(scalar)
                }
                UppaalSymbolType::Data(..)
                | UppaalSymbolType::Clock(_)
                | UppaalSymbolType::Chan { .. }
                | UppaalSymbolType::Record(..)
                | UppaalSymbolType::Void => {
                    let message = format!(
                        "`{name}` needs an argument for `{}`: make a process of it first",
                        param.name
                    );
                    return fault(span, message);
                }
            }
        }
        let ranges: Vec<_> =
            scalars.iter().map(|s| super::scope::IndexRange { lo: s.lo, hi: s.hi }).collect();
        let count = ranges.iter().try_fold(1i64, |n, r| n.checked_mul(r.count()));
        if count.is_none_or(|n| n > MAX_PROCESSES as i64) {
            return fault(span, format!("`{name}` stands for more than {MAX_PROCESSES} processes"));
        }
        let mut plans = Vec::new();
        for args in combinations(&ranges) {
            let given = scalars.iter().zip(&args).map(|(s, n)| UppaalSymbol::Const(s.literal(*n))).collect();
            let (template, scope, shown) = self.bound(name, given, instances, span)?;
            plans.push(UppaalProcessPlan { model_name: name.to_owned(), args, template, scope, shown });
        }
        Ok(plans)
    }

    /// The template behind a name, with its parameters bound.
    fn bound(
        &mut self,
        name: &str,
        given: Vec<UppaalSymbol>,
        instances: &[UppaalInstance],
        span: Span,
    ) -> Result<(usize, UppaalScope, Vec<String>), UppaalFault> {
        if let Some(at) = instances.iter().position(|i| i.name == name) {
            // An instance is made of what stands before it.
            let (instance, before) = (&instances[at], &instances[..at]);
            let scope = instance.params.iter().map(|p| p.name.clone()).zip(given).collect();
            let params = self.params_of(&instance.of, before, instance.span)?;
            if params.len() != instance.args.len() {
                let (want, got) = (params.len(), instance.args.len());
                let message =
                    format!("`{}` has {want} parameters, and is given {got} arguments", instance.of);
                return fault(instance.span, message);
            }
            let outer = std::mem::replace(&mut self.locals, vec![scope]);
            let args = params.iter().zip(&instance.args).map(|(p, a)| self.argument(p, a)).collect();
            self.locals = outer;
            let args: Result<Vec<UppaalSymbol>, UppaalFault> = args;
            return self.bound(&instance.of, args?, before, instance.span);
        }
        let Some(template) = self.templates.iter().position(|t| t.name == name) else {
            return fault(span, format!("there is no template `{name}`"));
        };
        let params = &self.templates[template].params;
        let shown = params.iter().zip(&given).map(|(p, s)| format!("{} = {}", p.name, shown(s))).collect();
        Ok((template, params.iter().map(|p| p.name.clone()).zip(given).collect(), shown))
    }

    fn params_of(
        &self,
        name: &str,
        instances: &[UppaalInstance],
        span: Span,
    ) -> Result<Vec<UppaalParameter>, UppaalFault> {
        let instance = instances.iter().find(|i| i.name == name).map(|i| &i.params);
        let template = || self.templates.iter().find(|t| t.name == name).map(|t| &t.params);
        match instance.or_else(template) {
            Some(params) => Ok(params.clone()),
            None => fault(span, format!("there is no template `{name}`")),
        }
    }

    fn argument(&mut self, param: &UppaalParameter, arg: &UppaalExpr) -> Result<UppaalSymbol, UppaalFault> {
        match self.declared(&param.ty, &param.dims)? {
            UppaalSymbolType::Data(scalar, dims) if dims.is_empty() && !param.by_reference => {
                let n = self.constant(arg)?;
                in_range(&scalar, n, arg.span)?;
                Ok(UppaalSymbol::Const(scalar.literal(n)))
            }
            UppaalSymbolType::Data(scalar, dims) => match self.place(arg)? {
                UppaalSymbol::Const(out) if dims.is_empty() && param.ty.constant => {
                    Ok(UppaalSymbol::Const(out))
                }
                UppaalSymbol::Var(mut v) if v.dims.len() == dims.len() && v.ty.is_bool == scalar.is_bool => {
                    v.readonly |= param.ty.constant || !param.by_reference;
                    Ok(UppaalSymbol::Var(v))
                }
                other => fault(arg.span, format!("`{}` cannot be {}", param.name, other.noun())),
            },
            UppaalSymbolType::Clock(dims) => match self.place(arg)? {
                UppaalSymbol::Clock(c) if c.dims.len() == dims.len() => Ok(UppaalSymbol::Clock(c)),
                other => fault(arg.span, format!("`{}` is a clock, not {}", param.name, other.noun())),
            },
            UppaalSymbolType::Chan { dims, .. } => match self.place(arg)? {
                UppaalSymbol::Chan(c) if c.dims.len() == dims.len() => Ok(UppaalSymbol::Chan(c)),
                other => fault(arg.span, format!("`{}` is a channel, not {}", param.name, other.noun())),
            },
            UppaalSymbolType::Record(fields, dims) => match self.place(arg)? {
                UppaalSymbol::Record(r) if r.dims.len() == dims.len() && r.fields.len() == fields.len() => {
                    let mut sym = UppaalSymbol::Record(r);
                    if param.ty.constant || !param.by_reference {
                        sym.make_readonly();
                    }
                    Ok(sym)
                }
                other => fault(arg.span, format!("`{}` is a record, not {}", param.name, other.noun())),
            },
            UppaalSymbolType::Void => fault(param.span, "a parameter cannot be `void`"),
        }
    }

    // ── Automata ──

    /// Writes the automaton of a process.
    pub fn automaton(&mut self, plan: UppaalProcessPlan, name: String) {
        self.names.start_process();
        self.own_specialised.clear();
        let template = &self.model.templates[plan.template];
        self.process = Some(plan.scope);
        self.own_values(plan.template);
        let declarations = std::mem::take(&mut self.templates[plan.template].declarations);
        declarations.iter().for_each(|d| self.declare(d, true));
        self.templates[plan.template].declarations = declarations;
        let written: Vec<String> = self.location_names(template);
        let parsed = std::mem::take(&mut self.templates[plan.template]);
        let stopped = self.stopped(template, &parsed, &written);
        let stopped = self.kept(stopped).unwrap_or_default();
        let (mut locations, mut texts) = (Vec::new(), Vec::new());
        for (i, (location, stopped)) in template.locations.iter().zip(&stopped).enumerate() {
            self.standing.clone_from(&stopped.values);
            let made = self.location(location, &written[i], i == template.initial, stopped);
            locations.extend(self.kept(made));
        }
        for (transition, edge) in template.transitions.iter().zip(&parsed.edges) {
            self.standing = stopped.get(transition.from).map(|s| s.values.clone()).unwrap_or_default();
            let made = self.edge(transition, edge, &written);
            texts.extend(self.kept(made).unwrap_or_default());
        }
        self.standing.clear();
        self.templates[plan.template] = parsed;
        let mut scope = self.process.take().unwrap_or_default();
        for (location, written) in template.locations.iter().zip(&written) {
            if let Some(name) = &location.name {
                scope.insert(name.clone(), UppaalSymbol::Location(written.clone()));
            }
        }
        let mut doc = format!("The template `{}`", template.name);
        if !plan.shown.is_empty() {
            doc += &format!(", {}", plan.shown.join(", "));
        }
        self.processes.push(UppaalProcess {
            model_name: plan.model_name,
            args: plan.args,
            name,
            scope,
            arrays: std::mem::take(&mut self.own_arrays),
            clocks: std::mem::take(&mut self.own_clocks),
            clock_comments: std::mem::take(&mut self.own_clock_comments),
            lines: std::mem::take(&mut self.own_lines),
            functions: std::mem::take(&mut self.own_functions),
            locations,
            edges: texts,
            doc,
        });
    }

    fn kept<T>(&mut self, made: Result<T, UppaalFault>) -> Option<T> {
        made.map_err(|fault| self.faults.push(fault)).ok()
    }

    /// A parameter by value that is assigned is a variable of the process.
    fn own_values(&mut self, template: usize) {
        let params = self.templates[template].params.clone();
        for param in params {
            let is_assigned = self.templates[template].assigned.contains(&param.name);
            if param.by_reference || param.ty.constant || !is_assigned {
                continue;
            }
            let Ok(UppaalSymbolType::Data(scalar, dims)) = self.declared(&param.ty, &param.dims) else {
                continue;
            };
            let value = match self.process.as_ref().and_then(|p| p.get(&param.name)) {
                Some(UppaalSymbol::Const(out)) if dims.is_empty() => out.text.clone(),
                Some(_) | None => continue,
            };
            let name = self.names.fresh(&param.name, param.span, NameOwner::Process);
            self.own_lines.push(var_line(&name, &scalar, &[], &value));
            let (at, values) = (Vec::new(), None);
            let sym = VarSym { name, ty: scalar, dims, at, values, own: true, local: false, readonly: false };
            self.bind(&param.name, UppaalSymbol::Var(sym), true);
        }
    }

    fn edge(
        &mut self,
        t: &UppaalTransition,
        edge: &ParsedEdge,
        names: &[String],
    ) -> Result<Vec<String>, UppaalFault> {
        self.clock_log.clear();
        let cases = self.edge_cases(edge, |cx| cx.edge_texts(t, edge, names))?;
        let mut texts: Vec<String> = cases.concat();
        let mut kept = String::new();
        if t.uncontrollable {
            kept += "// controllable=\"false\"\n";
        }
        if !t.probability.trim().is_empty() {
            kept += &format!("// probability {}\n", one_line(&t.probability));
            let message =
                "`probability` is kept as a comment: any branch may be taken, as UPPAAL's model checker may";
            self.notes.push((edge.span(), NoteSeverity::Info, message.to_owned()));
        }
        texts.iter_mut().for_each(|text| *text = kept.clone() + text);
        if let Some(first) = texts.first_mut() {
            *first = doc(&t.comment) + first;
        }
        Ok(texts)
    }

    /// What `write` makes of each case of an edge.
    pub fn edge_cases<T>(
        &mut self,
        edge: &ParsedEdge,
        mut write: impl FnMut(&mut Self) -> Result<T, UppaalFault>,
    ) -> Result<Vec<T>, UppaalFault> {
        let receives = edge.sync.as_ref().is_some_and(|sync| !sync.offers);
        self.every_case(edge.span(), receives, |cx| {
            cx.locals.push(UppaalScope::new());
            let made = write(cx);
            cx.locals.pop();
            made
        })
    }

    pub fn edge_texts(
        &mut self,
        t: &UppaalTransition,
        edge: &ParsedEdge,
        names: &[String],
    ) -> Result<Vec<String>, UppaalFault> {
        let mut head = format!("{} -> {}", names[t.from], names[t.to]);
        let mut selects = Vec::new();
        self.names.start_function();
        for select in &edge.select {
            let scalar = self.scalar(&select.ty)?;
            if self.chooses_clock(edge, &select.name) {
                let n = self.choice_of(scalar.lo, scalar.hi).unwrap_or(scalar.lo);
                if let Some(scope) = self.locals.last_mut() {
                    scope.insert(select.name.clone(), UppaalSymbol::Const(scalar.literal(n)));
                }
                continue;
            }
            let name = self.names.fresh(&select.name, select.span, NameOwner::Function);
            selects.push(format!("{name}: {}", scalar.text));
            let (at, dims, values) = (Vec::new(), Vec::new(), None);
            let sym = VarSym { name, ty: scalar, dims, at, values, own: false, local: true, readonly: true };
            if let Some(scope) = self.locals.last_mut() {
                scope.insert(select.name.clone(), UppaalSymbol::Var(sym));
            }
        }
        if !selects.is_empty() {
            head += &format!(" select {}", selects.join(", "));
        }
        let mut guards = match &edge.guard {
            Some(guard) => self.alternatives(guard)?,
            None => vec![GuardConjunction::default()],
        };
        let sync = match &edge.sync {
            Some(sync) => Some(self.sync(sync, guards.iter().any(|g| !g.clocks.is_empty()))?),
            None => None,
        };
        let mut actions = Vec::new();
        let mut on = String::new();
        match sync {
            Some((true, text)) => actions.push(text),
            Some((false, text)) => on = format!(" on {text}"),
            None => {}
        }
        if let Some(cases) = &mut self.cases {
            cases.in_updates = true;
        }
        // What stood until now is set to where it stood, and runs from there.
        let standing = std::mem::take(&mut self.standing);
        actions.extend(standing.iter().map(|(clock, n)| format!("{clock} = {}", seconds(*n))));
        edge.assign.iter().try_for_each(|e| self.effect(e, &mut actions))?;
        self.standing = standing;
        let asked = self.cases.as_mut().map(|cases| std::mem::take(&mut cases.conditions));
        for guard in &mut guards {
            guard.data.extend(asked.iter().flatten().cloned());
        }
        let actions = if actions.is_empty() { String::new() } else { format!(" do {}", actions.join("; ")) };
        let mut texts = Vec::new();
        for guard in &guards {
            match guard.text() {
                None => {}
                Some(when) if when.is_empty() => texts.push(format!("{head}{on}{actions}")),
                Some(when) => texts.push(format!("{head} when {when}{on}{actions}")),
            }
        }
        Ok(texts)
    }

    /// Whether what is selected chooses a clock: then there is an edge for each value.
    fn chooses_clock(&self, edge: &ParsedEdge, name: &str) -> bool {
        let is_named = |e: &UppaalExpr| {
            let mut found = false;
            e.each(&mut |part| found |= matches!(&part.kind, UppaalExprKind::Name(n) if n == name));
            found
        };
        let mut found = false;
        for label in edge.guard.iter().chain(&edge.assign) {
            label.each(&mut |e| match &e.kind {
                UppaalExprKind::Index(of, index) => {
                    let clocks = self.kind_of(of).is_some_and(|sym| sym.has_clocks());
                    found |= clocks && is_named(index);
                }
                UppaalExprKind::Call(of, args) => {
                    let called = of.root().and_then(|f| self.find(f));
                    let sets = matches!(called, Some(UppaalSymbol::Function(f)) if f.sets_clocks);
                    found |= sets && args.iter().any(is_named);
                }
                _ => {}
            });
        }
        found
    }

    /// Whether the edge offers, and the channel with its arguments.
    fn sync(&mut self, sync: &UppaalSync, has_clocks: bool) -> Result<(bool, String), UppaalFault> {
        let sym = self.place(&sync.channel)?;
        let channel = self.channel(&sym, sync.channel.span)?;
        if channel.urgent && has_clocks && (sync.offers || !channel.broadcast) {
            let message = format!("`{}` is urgent: its edges have no conditions over clocks", channel.name);
            return fault(sync.channel.span, message);
        }
        let args: Vec<&str> = channel.at.iter().map(|a: &ScenarioExprText| a.text.as_str()).collect();
        let args = if args.is_empty() { String::new() } else { format!("({})", args.join(", ")) };
        Ok((sync.offers, channel.name.clone() + &args))
    }

    /// The automaton's name: that of the process, and the values that it ranges over.
    pub fn automaton_name(&mut self, plan: &UppaalProcessPlan, span: Span) -> String {
        if plan.args.is_empty() {
            return self.names.fresh(&plan.model_name, span, NameOwner::All);
        }
        let digit = plan.model_name.ends_with(|c: char| c.is_ascii_digit());
        let wanted = match plan.args.as_slice() {
            [only] if !digit && *only >= 0 => format!("{}{only}", plan.model_name),
            args => numbered(&plan.model_name, args),
        };
        self.names.unused(&wanted, NameOwner::All)
    }
}

/// A number of units of time.
fn seconds(n: i64) -> String {
    if n == 0 { "0".to_owned() } else { format!("{n} s") }
}

fn shown(sym: &UppaalSymbol) -> String {
    match sym {
        UppaalSymbol::Const(out) => out.text.clone(),
        UppaalSymbol::Var(v) => super::place::place_text(v),
        UppaalSymbol::Clock(c) => c.name.clone(),
        UppaalSymbol::Chan(c) => c.at.iter().fold(c.name.clone(), |text, at| format!("{text}[{}]", at.text)),
        UppaalSymbol::Location(l) => l.clone(),
        UppaalSymbol::Record(r) => r.name.clone(),
        UppaalSymbol::Type(_) | UppaalSymbol::Function(_) => sym.noun().to_owned(),
    }
}

/// A doc comment and its line end, or nothing.
pub fn doc(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("/// {text}\n") }
}
