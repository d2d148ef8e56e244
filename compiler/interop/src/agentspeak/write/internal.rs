//! Internal actions in the scenario's words.

use hrdsl_source::Span;

use super::{
    super::{
        alternatives::AlternativeSort,
        ast::{AgentSpeakLiteral, AgentSpeakTerm, TermKind},
        term::{AgentSpeakMessage, atom, literal, message, performative},
    },
    clause::{
        AND, ATOM, BindingMode, ClauseFailure, ClauseFragment, ClauseResult, ClauseTranslator, NOT, PRODUCT,
    },
};

impl ClauseTranslator<'_> {
    /// One that asks.
    #[expect(clippy::too_many_lines, reason = "a flat match")]
    pub(super) fn internal_formula(&mut self, of: &AgentSpeakLiteral) -> ClauseResult<ClauseFragment> {
        let name = of.functor.as_str();
        let text = match (name, of.args.as_slice()) {
            (".findall" | ".setof", [template, formula, list]) => {
                return self.find_all(name, template, formula, list);
            }
            (".count", [formula, n]) => {
                let before = self.bound.clone();
                let formula = self.formula(formula);
                self.bound = before;
                format!(
                    ".count({}, {})",
                    formula?.text,
                    self.single(n, BindingMode::Pattern, &AlternativeSort::Number)?
                )
            }
            (".member", [element, list]) => return self.member(element, list),
            (".nth", [index, list, element]) => {
                let index = self.number(index)?.text;
                let lists = self.part(list, BindingMode::Value, &AlternativeSort::List)?;
                let elements = self.values(element, BindingMode::Pattern)?;
                let each = lists.iter().zip(&elements).map(|(l, e)| format!(".nth({index}, {l}, {e})"));
                return Ok(ClauseFragment::all(each.map(|t| ClauseFragment::new(t, ATOM)).collect()));
            }
            (".min" | ".max", [list, element]) => return self.extreme(name, list, element),
            (".length", [list, n]) => {
                self.no_choice(list)?;
                format!(
                    ".length({}, {})",
                    self.values(list, BindingMode::Value)?[0],
                    self.single(n, BindingMode::Pattern, &AlternativeSort::Number)?
                )
            }
            (".empty", [list]) if self.no_choice(list).is_ok() => {
                format!(".empty({})", self.values(list, BindingMode::Value)?[0])
            }
            (".concat", [args @ .., result]) => return self.componentwise(name, args, result),
            (".reverse", [list, result]) => {
                return self.componentwise(name, std::slice::from_ref(list), result);
            }
            (".term2string", [value, result]) => {
                format!(".string({}, {})", self.expr(value)?.text, self.value(result, BindingMode::Pattern)?)
            }
            (".range", [x, lo, hi]) => {
                let (lo, hi) = (self.number(lo)?.text, self.number(hi)?.text);
                let x = self.value(x, BindingMode::Pattern)?;
                self.between(&x, &lo, &hi)
            }
            (".union" | ".intersection" | ".difference", [a, b, result]) => {
                // In Jason sets are sorted.
                let (a, b) = (self.value(a, BindingMode::Value)?, self.value(b, BindingMode::Value)?);
                let set = self.fresh("Set");
                let made = ClauseFragment::new(format!("{name}({a}, {b}, {set})"), ATOM);
                let sorted = format!(".sort({set}, {})", self.value(result, BindingMode::Pattern)?);
                return Ok(ClauseFragment::all(vec![made, ClauseFragment::new(sorted, ATOM)]));
            }
            (".sort" | ".shuffle" | ".delete", [args @ .., result]) => {
                let args = args
                    .iter()
                    .map(|a| self.value(a, BindingMode::Value))
                    .collect::<ClauseResult<Vec<_>>>()?;
                format!("{name}({}, {})", args.join(", "), self.value(result, BindingMode::Pattern)?)
            }
            (".substring", [part, whole, places @ ..]) => return self.substring(part, whole, places),
            (".number" | ".string" | ".list" | ".atom" | ".structure" | ".literal" | ".ground", [term]) => {
                return self.is_of(name, term);
            }
            (".prefix" | ".suffix" | ".sublist", [a, b]) => {
                format!(
                    "{name}({}, {})",
                    self.value(a, BindingMode::Value)?,
                    self.value(b, BindingMode::Value)?
                )
            }
            (".random", [list, x]) => {
                format!(
                    ".random({}, {})",
                    self.value(list, BindingMode::Value)?,
                    self.value(x, BindingMode::Pattern)?
                )
            }
            (".random" | ".my_name" | ".all_names", [x]) => {
                format!("{name}({})", self.value(x, BindingMode::Pattern)?)
            }
            (".intend" | ".desire" | ".suspended", [goal]) => format!("{name}({})", self.asked_goal(goal)?),
            _ => return Err(format!("`{name}` cannot stand in a condition").into()),
        };
        Ok(ClauseFragment::new(text, ATOM))
    }

    /// A goal that is matched; what it would bind stays open.
    fn asked_goal(&mut self, of: &AgentSpeakTerm) -> ClauseResult<String> {
        let goal = literal(of)?;
        let before = self.bound.clone();
        let text = self.goal(goal, BindingMode::Pattern);
        self.bound = before;
        self.used.adopted.insert(goal.key());
        text
    }

    /// A list of structures is as many lists.
    fn find_all(
        &mut self,
        name: &str,
        template: &AgentSpeakTerm,
        formula: &AgentSpeakTerm,
        list: &AgentSpeakTerm,
    ) -> ClauseResult<ClauseFragment> {
        let (before, outer) = (self.bound.clone(), std::mem::take(&mut self.first));
        let found = self.formula(formula).and_then(|f| Ok((f, self.values(template, BindingMode::Value)?)));
        self.bound = before;
        let first = std::mem::replace(&mut self.first, outer);
        let (formula, values) = found?;
        // What the template asks is asked of each answer.
        let asked = first.into_iter().map(|text| ClauseFragment::new(text, ATOM));
        let formula = ClauseFragment::all([formula].into_iter().chain(asked).collect()).text;
        if name == ".setof" && values.len() > 1 {
            return Err("a list of structures cannot be sorted".into());
        }
        let lists = self.part(list, BindingMode::Pattern, &AlternativeSort::List)?;
        let each = values
            .iter()
            .zip(&lists)
            .map(|(v, l)| ClauseFragment::new(format!("{name}({v}, {formula}, {l})"), ATOM));
        Ok(ClauseFragment::all(each.collect()))
    }

    /// Of a list of structures, the elements of its lists at one place.
    fn member(&mut self, element: &AgentSpeakTerm, list: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        let lists = self.part(list, BindingMode::Value, &AlternativeSort::List)?;
        let elements = self.values(element, BindingMode::Pattern)?;
        match (elements.as_slice(), lists.as_slice()) {
            ([x], [l]) => Ok(ClauseFragment::new(format!(".member({x}, {l})"), ATOM)),
            _ => Ok(self.at_one_place(&elements, &lists, Vec::new())),
        }
    }

    fn extreme(
        &mut self,
        name: &str,
        list: &AgentSpeakTerm,
        element: &AgentSpeakTerm,
    ) -> ClauseResult<ClauseFragment> {
        self.of_one_type(list)?;
        let lists = self.values(list, BindingMode::Value)?;
        let mut elements = self.values(element, BindingMode::Pattern)?;
        if let ([x], [l]) = (elements.as_slice(), lists.as_slice()) {
            return Ok(ClauseFragment::new(format!("{name}({l}, {x})"), ATOM));
        }
        if elements[0] == "_" {
            elements[0] = self.fresh("Best");
        }
        let first = ClauseFragment::new(format!("{name}({}, {})", lists[0], elements[0]), ATOM);
        Ok(self.at_one_place(&elements, &lists, vec![first]))
    }

    fn at_one_place(
        &mut self,
        elements: &[String],
        lists: &[String],
        mut parts: Vec<ClauseFragment>,
    ) -> ClauseFragment {
        let (length, index) = (self.fresh("Length"), self.fresh("Index"));
        parts.push(ClauseFragment::new(format!(".length({}, {length})", lists[0]), ATOM));
        parts.push(ClauseFragment::new(self.between(&index, "0", &format!("{length} - 1")), ATOM));
        let each = elements.iter().zip(lists).filter(|(e, _)| *e != "_");
        parts.extend(each.map(|(e, l)| ClauseFragment::new(format!(".nth({index}, {l}, {e})"), ATOM)));
        ClauseFragment::all(parts)
    }

    fn between(&mut self, x: &str, lo: &str, hi: &str) -> String {
        self.used.between = true;
        format!("{}({x}, {lo}, {hi})", super::writer::between(self.cx.names))
    }

    fn componentwise(
        &mut self,
        name: &str,
        args: &[AgentSpeakTerm],
        result: &AgentSpeakTerm,
    ) -> ClauseResult<ClauseFragment> {
        for of in args.iter().chain([result]) {
            self.no_choice(of)?;
        }
        let args =
            args.iter().map(|a| self.values(a, BindingMode::Value)).collect::<ClauseResult<Vec<_>>>()?;
        let results = self.values(result, BindingMode::Pattern)?;
        let one = |k: usize, result: &String| -> Option<ClauseFragment> {
            let args = args.iter().map(|a| a.get(k).cloned()).collect::<Option<Vec<_>>>()?;
            Some(ClauseFragment::new(format!("{name}({}, {result})", args.join(", ")), ATOM))
        };
        let each: Option<Vec<ClauseFragment>> = results.iter().enumerate().map(|(k, r)| one(k, r)).collect();
        each.map(ClauseFragment::all).ok_or_else(|| ClauseFailure::from("a structure cannot stand here"))
    }

    // ── Steps ──

    pub(super) fn internal_step(
        &mut self,
        of: &AgentSpeakLiteral,
        span: Span,
        out: &mut Vec<(Span, String)>,
    ) -> ClauseResult<Vec<String>> {
        let name = of.functor.as_str();
        Ok(match (name, of.args.as_slice()) {
            (".print" | ".println", args) => vec![self.print(args)?],
            (".send" | ".broadcast", _) => self.send(&message(of)?)?,
            (".wait", [what, rest @ ..]) => self.wait(what, rest, span)?,
            (".fail", args) => {
                if !args.is_empty() {
                    self.remarks.push((span, "why `.fail` fails is not carried over".to_owned()));
                }
                vec![".fail".to_owned()]
            }
            (
                ".drop_intention" | ".drop_desire" | ".drop_event" | ".succeed_goal" | ".fail_goal"
                | ".suspend" | ".resume",
                [goal],
            ) => vec![format!("{name}({})", self.asked_goal(goal)?)],
            (".drop_all_intentions" | ".drop_all_desires" | ".drop_all_events" | ".suspend", []) => {
                vec![name.to_owned()]
            }
            (".abolish", [belief]) => {
                let before = self.bound.clone();
                let text = self.belief(literal(belief)?, BindingMode::Pattern);
                self.bound = before;
                vec![format!(".abolish({})", text?)]
            }
            (".fork", [kind, bodies @ ..]) => {
                let all = atom(kind) == Some("and");
                let bodies = bodies.iter().filter_map(|b| match &b.kind {
                    TermKind::Body(steps) => Some(steps.as_slice()),
                    _ => None,
                });
                vec![self.fork(bodies, all, out)]
            }
            _ => {
                let piece = self.internal_formula(of)?;
                let plain = piece.level == ATOM && piece.text.starts_with('.');
                vec![if plain { piece.text } else { format!("?({})", piece.text) }]
            }
        })
    }

    // ── Messages ──

    fn send(&mut self, message: &AgentSpeakMessage<'_>) -> ClauseResult<Vec<String>> {
        let named =
            message.to.is_some_and(|to| atom(to).is_some() || matches!(to.kind, TermKind::List { .. }));
        if !named && self.cx.system.agents.len() < 2 {
            return Err("there is no other agent to send this to".into());
        }
        if let Some(items) = message.each() {
            let one = |c: &mut Self, content| c.send(&AgentSpeakMessage { content, ..*message });
            let each = items.iter().map(|item| one(self, item)).collect::<ClauseResult<Vec<_>>>()?;
            return Ok(each.concat());
        }
        let Some(to) = message.to else {
            let content = self.content(message, None)?;
            return Ok(vec![format!(".broadcast({}, {content})", message.performative)]);
        };
        if let TermKind::List { items, rest: None } = &to.kind {
            let each =
                items.iter().map(|item| self.send_to(item, message)).collect::<ClauseResult<Vec<_>>>()?;
            return Ok(each.concat());
        }
        let listed = atom(to).is_none()
            && self.cx.types.leaves(self.type_of(to)?).first().is_some_and(|l| l.lists > 0);
        if !listed {
            return self.send_to(to, message);
        }
        let list = self.value(to, BindingMode::Value)?;
        let one = self.fresh("Each");
        let content = self.content(message, None)?;
        if !message.rest.is_empty() {
            return Err("several agents cannot be asked at once".into());
        }
        Ok(vec![format!(
            "for .member({one}, {list}) {{ .send({one}, {}, {content}) }}",
            message.performative
        )])
    }

    fn send_to(&mut self, to: &AgentSpeakTerm, message: &AgentSpeakMessage<'_>) -> ClauseResult<Vec<String>> {
        let known = atom(to).filter(|name| *name != "self").map(str::to_owned);
        let whom = match atom(to) {
            Some(name) => self.cx.names.agents.get(name).cloned().unwrap_or_else(|| name.to_owned()),
            None => self.single(to, BindingMode::Value, &AlternativeSort::Atom)?,
        };
        match (message.performative, message.rest) {
            ("askOne", [answer, time @ ..]) => self.ask(&whom, known, message, answer, time),
            ("askAll", [answer, time @ ..]) => self.ask_all(&whom, known, message, answer, time),
            (performative, _) => {
                let content = self.content(message, known)?;
                Ok(vec![format!(".send({whom}, {performative}, {content})")])
            }
        }
    }

    fn content(&mut self, message: &AgentSpeakMessage<'_>, to: Option<String>) -> ClauseResult<String> {
        let mut of = literal(message.content)?;
        let plain = AgentSpeakLiteral { annotations: self.told_annotations(message, of), ..of.clone() };
        of = &plain;
        let goal = performative(message.performative) == Some(true);
        self.used.sent.insert((to, goal, of.key()));
        let want = if matches!(message.performative, "tell" | "achieve") {
            BindingMode::Value
        } else {
            BindingMode::Pattern
        };
        let before = self.bound.clone();
        let (mentioned, text) = if goal {
            (true, self.goal(of, want))
        } else {
            let declared = self.used.beliefs.contains(&of.key());
            (declared, self.belief(of, want))
        };
        // What is sent is declared where it arrives; of an answer that is the sender.
        if !mentioned && !matches!(message.performative, "askOne" | "askAll") {
            self.used.beliefs.shift_remove(&of.key());
        }
        self.bound = before;
        text
    }

    fn timeout(&mut self, time: &[AgentSpeakTerm]) -> ClauseResult<String> {
        time.first().map_or(Ok(String::new()), |t| Ok(format!(", {}", self.milliseconds(t)?)))
    }

    pub(super) fn milliseconds(&mut self, of: &AgentSpeakTerm) -> ClauseResult<String> {
        Ok(match of.kind {
            TermKind::Int(n) if n % 1000 == 0 => format!("{} s", n / 1000),
            TermKind::Int(n) => format!("{n} ms"),
            _ => format!("{} * 1 ms", self.expr(of)?.at(PRODUCT)),
        })
    }

    /// The answer and the question are one literal: an open place of the question is the answer's.
    fn ask(
        &mut self,
        whom: &str,
        known: Option<String>,
        message: &AgentSpeakMessage<'_>,
        answer: &AgentSpeakTerm,
        time: &[AgentSpeakTerm],
    ) -> ClauseResult<Vec<String>> {
        let question = literal(message.content)?;
        let time = self.timeout(time)?;
        let otherwise =
            "without an answer in time this step fails; in Jason the answer is `false` or `timeout` then";
        self.remarks.push((answer.span, otherwise.to_owned()));
        if let TermKind::Var { name, .. } = &answer.kind {
            let source = known.clone().map_or_else(|| Err(whom.to_owned()), Ok);
            self.answers.insert(name.clone(), source);
        }
        self.used.sent.insert((known, false, question.key()));
        let answers: Vec<Option<&AgentSpeakTerm>> = match &answer.kind {
            TermKind::Literal(l) if l.key() == question.key() => l.args.iter().map(Some).collect(),
            TermKind::Var { .. } | TermKind::Any => vec![None; question.args.len()],
            _ => return Err("the answer is not of the form of the question".into()),
        };
        self.no_choice(answer)?;
        let whole = match &answer.kind {
            TermKind::Var { .. } if !question.args.is_empty() => self.values(answer, BindingMode::Pattern)?,
            _ => Vec::new(),
        };
        let (mut args, mut after, mut at) = (Vec::new(), Vec::new(), 0);
        for (asked, answered) in question.args.iter().zip(answers) {
            let count = self.cx.types.leaves(self.type_of(asked)?).len();
            let mine: Vec<String> = whole.iter().skip(at).take(count).cloned().collect();
            at += count;
            match (self.is_bound(asked), answered) {
                (true, Some(answered)) => {
                    args.extend(self.values(asked, BindingMode::Value)?);
                    if !matches!(answered.kind, TermKind::Any) && answered.span != asked.span {
                        after.extend(Some(self.unify(answered, asked)?).filter(|p| p.text != "true"));
                    }
                }
                (true, None) => {
                    let values = self.values(asked, BindingMode::Value)?;
                    after.extend(
                        mine.iter().zip(&values).map(|(m, v)| ClauseFragment::new(format!("{m} = {v}"), AND)),
                    );
                    args.extend(values);
                }
                (false, Some(answered)) => args.extend(self.values(answered, BindingMode::Pattern)?),
                (false, None) if mine.is_empty() => {
                    let before = self.bound.clone();
                    let values = self.values(asked, BindingMode::Pattern);
                    self.bound = before;
                    args.extend(values?);
                }
                (false, None) => args.extend(mine),
            }
        }
        let name = self.cx.names.belief(&question.key());
        let sign = if question.negated { "~" } else { "" };
        let mut steps = vec![format!(".ask({whom}, {sign}{}{time})", super::clause::call(&name, &args))];
        if !after.is_empty() {
            let after = ClauseFragment::all(after);
            steps.push(format!("?({})", after.text));
        }
        Ok(steps)
    }

    fn ask_all(
        &mut self,
        whom: &str,
        known: Option<String>,
        message: &AgentSpeakMessage<'_>,
        answer: &AgentSpeakTerm,
        time: &[AgentSpeakTerm],
    ) -> ClauseResult<Vec<String>> {
        let question = literal(message.content)?;
        let [asked] = question.args.as_slice() else {
            return Err("all answers are asked for at once only if the question has one place".into());
        };
        let time = self.timeout(time)?;
        self.used.sent.insert((known, false, question.key()));
        let before = self.bound.clone();
        let mut template = self.value(asked, BindingMode::Pattern)?;
        self.bound = before;
        if template == "_" {
            template = self.fresh("Each");
        }
        let list = self.value(answer, BindingMode::Pattern)?;
        let name = self.cx.names.belief(&question.key());
        Ok(vec![format!(".ask_all({whom}, {template}, {name}({template}), {list}{time})")])
    }

    /// For a time; or until something is believed, which is looked at every 100 ms.
    fn wait(
        &mut self,
        what: &AgentSpeakTerm,
        rest: &[AgentSpeakTerm],
        span: Span,
    ) -> ClauseResult<Vec<String>> {
        let trigger = match &what.kind {
            TermKind::Trigger(t) => Some(&t.of),
            _ => None,
        };
        let is_formula = match &what.kind {
            TermKind::Literal(l) => !l.is_internal(),
            TermKind::Binary { op, .. } => !op.is_arithmetic(),
            TermKind::Not(_) => true,
            _ => false,
        };
        let what = match trigger {
            None if !is_formula => return Ok(vec![format!("wait {}", self.milliseconds(what)?)]),
            None => what,
            Some(of) => of,
        };
        let open = !self.is_bound(what);
        let time = rest.first().map(|t| self.milliseconds(t)).transpose()?;
        let before = self.bound.clone();
        let condition = self.formula(what)?;
        if time.is_none() && !open {
            self.bound = before;
        }
        let until =
            format!("not {}", ClauseFragment::new(condition.text.clone(), condition.level).at(NOT + 1));
        let mut steps = vec![match &time {
            None => format!("while {until} {{ wait 100 ms }}"),
            Some(time) => format!("fork {{ while {until} {{ wait 100 ms }} }} or {{ wait {time} }}"),
        }];
        // With a place for the time that it took, it goes on after the time-out.
        if open || (time.is_some() && rest.len() == 1) {
            steps.push(format!("?({})", condition.text));
        }
        let at_once =
            if trigger.is_some() { "; it goes on at once if the belief is held already" } else { "" };
        self.remarks.push((span, format!("this looks every 100 ms whether it is so{at_once}")));
        Ok(steps)
    }
}
