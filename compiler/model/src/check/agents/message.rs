//! Messages: what is sent to whom is checked against what the receiver has declared.

use std::collections::BTreeSet;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, CallSyntax, ExprSyntaxKind as Syntax};

use crate::check::{
    agents::{
        agent::AgentScope,
        context::{known, restore},
        phase::AgentsPhase,
        terms::literal_of,
    },
    checker::Checker,
    state::{issues::too_many, names::DeclaredPlayer, record::DeclaredFields, scope::ExprEnv},
    template::CheckerPhase,
    unread,
};
use crate::{
    AgentId, AgentSpeech, BeliefAnnotation, BeliefId, ContentId, GoalId, InferredType, MessageContent,
    Parameter, Performative, PlayerRef, Type, TypedExpr, TypedExprKind, TypedStepKind, TypedTerm, Value,
    noun::Noun,
    report::{
        agents::{self, bad_message},
        names, types,
    },
};

/// The performatives as they are written.
const PERFORMATIVES: [(&str, Performative); 6] = [
    ("tell", Performative::Tell),
    ("untell", Performative::Untell),
    ("achieve", Performative::Achieve),
    ("unachieve", Performative::Unachieve),
    ("askOne", Performative::AskOne),
    ("askAll", Performative::AskAll),
];

/// Whom a message is for.
enum MessageReceiver {
    /// This agent.
    One(AgentId),
    /// Whoever it is at run time.
    Some,
    /// Nobody that is known: there is a diagnostic.
    Unknown,
}

/// What a message is about, as its receivers declare it.
struct MessageTopic {
    id: ContentId,
    fields: Option<DeclaredFields>,
    arity: usize,
    call: CallSyntax,
    /// The belief of the one receiver, if it is one.
    belief: Option<(AgentId, BeliefId)>,
    /// As they are written, and what the receivers' belief declares.
    annotations: Vec<ast::ExprSyntax>,
    declared: Vec<Parameter>,
}

impl AgentsPhase<'_, '_> {
    /// `.send(A, tell, b(…))`, `.broadcast(tell, b(…))`
    pub(in crate::check) fn send_message(
        &mut self,
        scope: &AgentScope,
        to: Option<&ast::ExprSyntax>,
        how: &ast::ExprSyntax,
        what: &ast::ExprSyntax,
        env: &mut ExprEnv,
    ) -> Option<TypedStepKind> {
        let to = to.map(|e| self.receiver(scope, e, env));
        let performative = self.performative(how)?;
        let receiver = to.as_ref().map_or(&MessageReceiver::Some, |(_, receiver)| receiver);
        let goal = matches!(performative, Performative::Achieve | Performative::Unachieve);
        let about = self.about(scope, receiver, what, goal, to.is_none())?;
        if performative != Performative::Tell {
            self.has_no_annotations(&about);
        }
        self.used(scope, &about, Some(performative));
        let args = match performative {
            Performative::Tell | Performative::Achieve => {
                self.told(&about, goal, env).into_iter().map(TypedTerm::Expr).collect()
            }
            Performative::Untell | Performative::Unachieve => self.asked_for(&about, goal, env, false),
            Performative::AskOne | Performative::AskAll => {
                self.has_for_answers(scope, &about, what.span);
                let before = known(env);
                let args = self.asked_for(&about, goal, env, true);
                restore(env, &before);
                args
            }
        };
        let annotations =
            if performative == Performative::Tell { self.told_annotations(&about, env) } else { Vec::new() };
        let to = to.map(|(e, _)| e);
        Some(TypedStepKind::Send { to, performative, content: about.id, args, annotations })
    }

    /// The values of the annotations of what is told.
    fn told_annotations(&mut self, about: &MessageTopic, env: &mut ExprEnv) -> Vec<(String, TypedExpr)> {
        let mut told = Vec::new();
        for e in &about.annotations {
            let Some((annotation, value, ty)) = self.annotation(e, Some(&about.declared)) else { continue };
            let value = self.expr_for(value, ty, env);
            match annotation {
                BeliefAnnotation::Source => {
                    self.report(agents::not_annotated("a sender, who is the source,", e.span));
                }
                BeliefAnnotation::Declared(at) => {
                    told.push((about.declared[usize::from(at)].name.clone(), value));
                }
            }
        }
        told
    }

    /// Only what is told has annotations.
    fn has_no_annotations(&mut self, about: &MessageTopic) {
        if let Some(first) = about.annotations.first() {
            self.report(agents::not_annotated("what is not told", first.span));
        }
    }

    /// `.ask(A, b(X), 5 s)`
    pub(in crate::check) fn ask(
        &mut self,
        scope: &AgentScope,
        to: &ast::ExprSyntax,
        what: &ast::ExprSyntax,
        within: Option<&ast::ExprSyntax>,
        env: &mut ExprEnv,
    ) -> Option<TypedStepKind> {
        let (to, receiver) = self.receiver(scope, to, env);
        let within = within.map(|e| self.duration(e, "the time to wait", env));
        let Some(about) = self.about(scope, &receiver, what, false, false) else {
            let variable = |c: &Checker<'_>, name: &ast::NameSyntax| c.is_variable(&name.text);
            self.bind_names(what, env, &variable);
            return None;
        };
        self.has_no_annotations(&about);
        self.used(scope, &about, None);
        let args = self.asked_for(&about, false, env, true);
        Some(TypedStepKind::Ask { to, content: about.id, args, within })
    }

    /// `.ask_all(A, X, b(X), L, 5 s)`
    pub(in crate::check) fn ask_all(
        &mut self,
        scope: &AgentScope,
        (to, template, what, out): (&ast::ExprSyntax, &ast::ExprSyntax, &ast::ExprSyntax, &ast::ExprSyntax),
        within: Option<&ast::ExprSyntax>,
        env: &mut ExprEnv,
    ) -> Option<TypedStepKind> {
        let (to, receiver) = self.receiver(scope, to, env);
        let within = within.map(|e| self.duration(e, "the time to wait", env));
        let Some(about) = self.about(scope, &receiver, what, false, false) else {
            self.out(out, InferredType::list(InferredType::Unknown), env);
            return None;
        };
        self.used(scope, &about, None);
        let before = known(env);
        let args = self.asked_for(&about, false, env, true);
        let template = self.expr(template, env);
        restore(env, &before);
        let out = self.out(out, InferredType::list(template.ty), env);
        Some(TypedStepKind::AskAll { to, template, content: about.id, args, out, within })
    }

    fn performative(&mut self, e: &ast::ExprSyntax) -> Option<Performative> {
        let Syntax::Path(path) = &e.kind else {
            if e.kind != Syntax::Error {
                self.report(types::needs_name(Noun::Performative, e.span));
            }
            return None;
        };
        let [name] = path.names.as_slice() else {
            self.report(types::needs_name(Noun::Performative, e.span));
            return None;
        };
        let found = PERFORMATIVES.iter().find(|(text, _)| *text == name.text);
        if found.is_none() {
            let all = PERFORMATIVES.iter().map(|(text, _)| *text);
            self.report(names::unknown(Noun::Performative, &name.text, name.span, all));
        }
        found.map(|(_, performative)| *performative)
    }

    /// The agent that a message is for.
    fn receiver(
        &mut self,
        scope: &AgentScope,
        e: &ast::ExprSyntax,
        env: &mut ExprEnv,
    ) -> (TypedExpr, MessageReceiver) {
        if let Syntax::Path(path) = &e.kind
            && let [name] = path.names.as_slice()
            && self.players.agent_names.symbol(&name.text).is_none()
            && env.find(&name.text).is_none()
            && !self.has_value(&name.text)
            && let Some(is) = self.kind_of(&name.text)
        {
            let all: Vec<&str> = self.players.agent_names.values().iter().map(|s| s.name()).collect();
            let all = all.into_iter().filter(|n| !matches!(*n, "self" | "percept"));
            self.report(names::wrong_kind(Noun::Agent, is, &name.text, name.span, all));
            return (TypedExpr::error(e.span), MessageReceiver::Unknown);
        }
        let named = InferredType::Enum(self.players.agent_names);
        let to = self.expr_of(e, named, env);
        let receiver = match (&to.kind, to.constant()) {
            (TypedExprKind::Error, _) => MessageReceiver::Unknown,
            (_, Some(Value::Symbol(symbol))) => match symbol.name() {
                "self" => MessageReceiver::One(scope.id),
                name => match self.players.table.get(name).map(|id| self.players.ids[usize::from(id)]) {
                    Some(PlayerRef::Agent(agent)) => MessageReceiver::One(agent),
                    Some(PlayerRef::Automaton(_)) | None => {
                        let message = format!("`{name}` is no agent that takes messages");
                        self.report(bad_message(e.span, message, "name an agent"));
                        MessageReceiver::Unknown
                    }
                },
            },
            (_, Some(_) | None) => MessageReceiver::Some,
        };
        (to, receiver)
    }

    /// What the receivers have of this name.
    fn about(
        &mut self,
        scope: &AgentScope,
        receiver: &MessageReceiver,
        e: &ast::ExprSyntax,
        goal: bool,
        to_others: bool,
    ) -> Option<MessageTopic> {
        let literal = if goal {
            let call = self.goal_call(e)?;
            ast::LiteralSyntax { negated: false, span: call.span, call, annotations: Vec::new() }
        } else {
            match literal_of(e) {
                Some(literal) => literal,
                None => {
                    if e.kind != Syntax::Error {
                        self.report(types::needs_name(Noun::Belief, e.span));
                    }
                    return None;
                }
            }
        };
        let receivers: Vec<AgentId> = match receiver {
            MessageReceiver::Unknown => return None,
            MessageReceiver::One(agent) => vec![*agent],
            MessageReceiver::Some => {
                let all = (0u16..).map(AgentId).take(self.s.agents.len());
                all.filter(|a| !to_others || *a != scope.id).collect()
            }
        };
        let name = &literal.call.name;
        let noun = if goal { Noun::Goal } else { Noun::Belief };
        let having: Vec<AgentId> =
            receivers.iter().copied().filter(|a| self.kind_of_agent(*a, &name.text) == Some(noun)).collect();
        let Some(first) = having.first().copied() else {
            self.nobody_has(noun, name, receiver, &receivers);
            return None;
        };
        let (params, fields, belief) = self.declared_in(first, name, literal.negated, goal)?;
        self.agree(noun, &having, &literal, params.as_ref(), goal);
        let arity = params.as_ref().map_or(literal.call.args.as_ref().map_or(0, Vec::len), Vec::len);
        let id = self.content(&literal, goal, arity)?;
        let declared = belief.map_or_else(Vec::new, |b| {
            self.s.agents[usize::from(first.0)].beliefs[usize::from(b.0)].annotations.clone()
        });
        let belief = belief.filter(|_| having.len() == 1).map(|b| (first, b));
        let ast::LiteralSyntax { call, annotations, .. } = literal;
        Some(MessageTopic { id, fields, arity, call, belief, annotations, declared })
    }

    /// How an agent declares a belief or goal; goals may be without types.
    #[allow(clippy::type_complexity, reason = "three answers to one question")]
    fn declared_in(
        &mut self,
        agent: AgentId,
        name: &ast::NameSyntax,
        negated: bool,
        goal: bool,
    ) -> Option<(Option<Vec<Parameter>>, Option<DeclaredFields>, Option<BeliefId>)> {
        let index = usize::from(agent.0);
        if goal {
            let at = self.names.goals[index].get_index_of(&name.text)?;
            let id = GoalId(u16::try_from(at).ok()?);
            return Some((self.s.agents[index].goals[at].params.clone(), self.goal_fields(agent, id), None));
        }
        let plain = BeliefId(self.names.beliefs[index].get(&name.text)?);
        let belief = if negated { self.negation(agent, plain)? } else { plain };
        let params = self.s.agents[index].beliefs[usize::from(belief.0)].params.clone();
        Some((Some(params), Some(self.belief_fields(agent, belief)), Some(belief)))
    }

    /// The types of the annotations that are written, as an agent declares them.
    fn annotation_types(
        &mut self,
        agent: AgentId,
        literal: &ast::LiteralSyntax,
        goal: bool,
    ) -> Option<Vec<Option<Type>>> {
        let (_, _, belief) = self.declared_in(agent, &literal.call.name, literal.negated, goal)?;
        Some(self.types_of(agent, belief?, literal))
    }

    fn types_of(&self, agent: AgentId, belief: BeliefId, literal: &ast::LiteralSyntax) -> Vec<Option<Type>> {
        let declared = &self.s.agents[usize::from(agent.0)].beliefs[usize::from(belief.0)].annotations;
        let name = |e: &ast::ExprSyntax| {
            let Syntax::Call { callee, .. } = &e.kind else { return None };
            callee.names.first().map(|n| n.text.clone())
        };
        let ty = |name: &str| declared.iter().find(|p| p.name == name).map(|p| p.ty);
        literal.annotations.iter().map(|e| name(e).and_then(|n| ty(&n))).collect()
    }

    /// All that can take a message must take it alike.
    fn agree(
        &mut self,
        noun: Noun,
        having: &[AgentId],
        literal: &ast::LiteralSyntax,
        params: Option<&Vec<Parameter>>,
        goal: bool,
    ) {
        let types =
            |params: Option<&Vec<Parameter>>| params.map(|p| p.iter().map(|p| p.ty).collect::<Vec<_>>());
        let name = &literal.call.name;
        for other in having.iter().skip(1) {
            let Some((theirs, _, belief)) = self.declared_in(*other, name, literal.negated, goal) else {
                continue;
            };
            let (marks, their_marks) = (
                self.annotation_types(having[0], literal, goal),
                belief.map(|b| self.types_of(*other, b, literal)),
            );
            let arity = |c: &Self, agent: AgentId| {
                c.names.goals[usize::from(agent.0)].get(&name.text).map(|g| g.arity)
            };
            let alike = match (types(params), types(theirs.as_ref())) {
                (Some(ours), Some(theirs)) => ours == theirs,
                (None, _) | (_, None) => arity(self, having[0]) == arity(self, *other),
            };
            if !alike || their_marks.is_some_and(|theirs| marks.is_some_and(|ours| ours != theirs)) {
                let who = |a: AgentId| self.s.agents[usize::from(a.0)].name.clone();
                let message = format!(
                    "the {noun} `{}` has other parameters or annotations in `{}` than in `{}`",
                    name.text,
                    who(having[0]),
                    who(*other)
                );
                let help =
                    "declare it alike in all agents that may get the message, or send it to one by name";
                self.report(bad_message(name.span, message, help));
                return;
            }
        }
    }

    fn nobody_has(
        &mut self,
        noun: Noun,
        name: &ast::NameSyntax,
        receiver: &MessageReceiver,
        receivers: &[AgentId],
    ) {
        let mut names: Vec<String> = Vec::new();
        for agent in receivers {
            let index = usize::from(agent.0);
            if noun == Noun::Goal {
                names.extend(self.names.goals[index].keys().cloned());
            } else {
                let beliefs = self.names.beliefs[index].names();
                names.extend(beliefs.filter(|n| !n.starts_with('~')).map(str::to_owned));
            }
        }
        names.dedup();
        let is = receivers.iter().find_map(|a| self.kind_of_agent(*a, &name.text));
        let unread = |d: &DeclaredPlayer<'_, ast::AgentSyntax>| unread::in_agent(d.syntax);
        if receivers.iter().any(|a| self.players.agents.get(usize::from(a.0)).is_some_and(unread)) {
            return;
        }
        let near = self.near(names.iter().map(String::as_str));
        self.issues.compared += near.len();
        let near = near.iter().map(String::as_str);
        if let Some(is) = is {
            return self.report(names::wrong_kind(noun, is, &name.text, name.span, near));
        }
        let who = match receiver {
            MessageReceiver::One(agent) => format!("`{}`", self.s.agents[usize::from(agent.0)].name),
            MessageReceiver::Some | MessageReceiver::Unknown => "no other agent".to_owned(),
        };
        let message = match receiver {
            MessageReceiver::One(_) => format!("{who} has no {noun} `{}`", name.text),
            MessageReceiver::Some | MessageReceiver::Unknown => format!("{who} has a {noun} `{}`", name.text),
        };
        let issue = bad_message(name.span, message, String::new());
        let issue = names::with_nearest(issue, noun, &name.text, near);
        let issue = match issue.help.as_deref() {
            Some("") | None => issue.help(format!("declare the {noun} in the agent that gets the message")),
            Some(_) => issue,
        };
        self.report(issue);
    }

    fn content(&mut self, literal: &ast::LiteralSyntax, is_goal: bool, arity: usize) -> Option<ContentId> {
        let sign = if literal.negated { "~" } else { "" };
        let name = format!("{sign}{}", literal.call.name.text);
        let mut known = self.s.contents.iter().zip(&self.s.speech);
        let same = |(c, s): (&MessageContent, &AgentSpeech)| {
            (&c.name, s.is_goal, s.arity) == (&name, is_goal, arity)
        };
        let at = known.position(same).unwrap_or_else(|| {
            self.s.contents.push(MessageContent { name: name.clone(), of: Vec::new() });
            self.s.speech.push(AgentSpeech { is_goal, arity, uses: BTreeSet::new() });
            self.s.contents.len() - 1
        });
        let id = u16::try_from(at).ok().filter(|id| *id < u16::MAX);
        if id.is_none() {
            let message = "there are more kinds of messages than can be told apart".to_owned();
            self.report(too_many(message, literal.span));
        }
        id.map(ContentId)
    }

    fn used(&mut self, scope: &AgentScope, about: &MessageTopic, how: Option<Performative>) {
        if let Some(speech) = self.s.speech.get_mut(usize::from(about.id.0)) {
            speech.uses.insert((how, scope.id));
        }
    }

    /// The arguments of what is told or to be achieved.
    fn told(&mut self, about: &MessageTopic, goal: bool, env: &mut ExprEnv) -> Vec<TypedExpr> {
        let noun = if goal { Noun::Goal } else { Noun::Belief };
        match &about.fields {
            Some(fields) => self.args(noun, &about.call, fields, env),
            None => {
                self.counted(about);
                let args = about.call.args.as_deref().unwrap_or_default();
                args.iter().map(|a| self.expr(a, env)).collect()
            }
        }
    }

    /// The terms of what is asked for or taken back.
    fn asked_for(
        &mut self,
        about: &MessageTopic,
        goal: bool,
        env: &mut ExprEnv,
        binds: bool,
    ) -> Vec<TypedTerm> {
        let noun = if goal { Noun::Goal } else { Noun::Belief };
        if about.fields.is_none() {
            self.counted(about);
        }
        let before: Vec<bool> = env.locals.iter().map(|l| l.bound).collect();
        let args = self.matched(noun, &about.call, about.fields.as_ref(), env, binds);
        if let (Some((agent, belief)), true) = (about.belief, binds) {
            self.needs_inputs((agent.0, belief), &args, &before, &about.call, env);
        }
        args
    }

    /// A goal without declared types has a number of arguments all the same.
    fn counted(&mut self, about: &MessageTopic) {
        let name = &about.call.name.text;
        let having = self.names.goals.iter().filter_map(|goals| goals.get(name)).map(|g| g.arity);
        let all: Vec<usize> = having.collect();
        if let Some(want) = all.first()
            && !all.contains(&about.arity)
        {
            self.report(types::counts(Noun::Goal, name, *want, about.arity, about.call.span));
        }
    }

    /// What is asked is told back, so the agent that asks needs the belief as well.
    fn has_for_answers(&mut self, scope: &AgentScope, about: &MessageTopic, span: Span) {
        let name = &about.call.name.text;
        let index = usize::from(scope.id.0);
        let ours = self.names.beliefs[index].get(name);
        let types = |params: &[Parameter]| params.iter().map(|p| p.ty).collect::<Vec<_>>();
        let theirs = about.fields.as_ref().map(|f| self.flat(f)).unwrap_or_default();
        let fits = ours
            .is_some_and(|id| types(&self.s.agents[index].beliefs[usize::from(id)].params) == types(&theirs));
        if !fits {
            let own = &self.s.agents[index].name;
            let message = format!("the answer becomes a belief `{name}`, which `{own}` does not have");
            let help = format!("declare it in `{own}` as in the other agent, or write `.ask(…)`");
            self.report(bad_message(span, message, help));
        }
    }
}
