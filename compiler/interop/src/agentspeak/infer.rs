//! Which values meet where: walks all programs, fact by fact, plan by plan, step by step. What does not fit with what came
//! before is left out alone.

use hrdsl_source::Span;
use indexmap::IndexMap;

use super::{
    alternatives::AlternativeSort,
    ast::{
        AgentSpeakFormula, AgentSpeakItem, AgentSpeakItemKind, AgentSpeakLiteral, AgentSpeakOperator,
        AgentSpeakOperatorSort, AgentSpeakPlan, AgentSpeakStep, AgentSpeakStepKind, AgentSpeakTerm,
        AgentSpeakTriggerKind, PredicateIndicator, TermKind,
    },
    internal,
    system::AgentSpeakSystem,
    term::{OmissionReason, atom, literal, small_power, texts, valued},
    types::{AgentSpeakType, TyId, UnificationTable},
};

/// The types of a system, and what is left out: the place of a fact, rule, plan or step, and why.
#[derive(Debug, Default)]
pub struct InferenceOutcome {
    pub types: UnificationTable,
    pub left_out: IndexMap<Span, OmissionReason>,
}

/// Infers the types of all programs.
pub fn infer(system: &AgentSpeakSystem) -> InferenceOutcome {
    let mut types = UnificationTable::default();
    types.agents = system.agents.iter().map(|a| a.name.clone()).collect();
    let mut walk = TypeInferrer { types, left_out: IndexMap::new(), vars: IndexMap::new() };
    // Facts say most surely what a belief is about, then rules.
    for rank in 0..3 {
        for agent in &system.agents {
            for belief in agent.beliefs.iter().filter(|_| rank == 0) {
                walk.alone(belief.span, |w| w.belief(belief));
            }
            for goal in agent.goals.iter().filter(|_| rank == 2) {
                walk.alone(goal.span, |w| w.goal(goal));
            }
        }
        for item in system.programs.iter().flat_map(|p| &p.items) {
            walk.item(item, rank);
        }
    }
    if let Err(clash) = walk.types.settle_concats(true) {
        // What is open to the end concerns no declared place, or else it is said where it is written.
        walk.left_out.entry(Span::default()).or_insert(clash);
    }
    walk.types.settle_decimals();
    InferenceOutcome { types: walk.types, left_out: walk.left_out }
}

pub struct TypeInferrer {
    pub types: UnificationTable,
    left_out: IndexMap<Span, OmissionReason>,
    /// The variables of the present clause.
    vars: IndexMap<String, TyId>,
}

impl TypeInferrer {
    /// Tries something; if it does not fit, all is as before, and the place is left out.
    fn attempt(&mut self, span: Span, what: impl FnOnce(&mut Self) -> Result<(), OmissionReason>) -> bool {
        let (before, vars) = (self.types.mark(), self.vars.len());
        let result = what(self).and_then(|()| self.types.settle_concats(false));
        let Err(reason) = result else { return true };
        self.types.back(before);
        self.vars.truncate(vars);
        self.left_out.entry(span).or_insert(reason);
        false
    }

    fn alone(&mut self, span: Span, what: impl FnOnce(&mut Self) -> Result<(), OmissionReason>) {
        self.vars.clear();
        self.attempt(span, what);
    }

    fn item(&mut self, item: &AgentSpeakItem, rank: usize) {
        match (&item.kind, rank) {
            (AgentSpeakItemKind::Belief(b), 0) => self.alone(item.span, |w| w.belief(b)),
            (AgentSpeakItemKind::Rule { head, body }, 1) => self.alone(item.span, |w| {
                w.belief(head)?;
                w.formula(body)
            }),
            (AgentSpeakItemKind::Goal(goal), 2) => self.alone(item.span, |w| w.goal(literal(goal)?)),
            (AgentSpeakItemKind::Plan(plan), 2) => self.plan(plan, item.span),
            (
                AgentSpeakItemKind::Belief(_)
                | AgentSpeakItemKind::Rule { .. }
                | AgentSpeakItemKind::Goal(_)
                | AgentSpeakItemKind::Plan(_)
                | AgentSpeakItemKind::Skipped(_)
                | AgentSpeakItemKind::Broken(_),
                _,
            ) => {}
        }
    }

    fn plan(&mut self, plan: &AgentSpeakPlan, span: Span) {
        self.vars.clear();
        let fits = self.attempt(span, |w| {
            let of = literal(&plan.trigger.of).map_err(|_| "the trigger is a variable".to_owned())?;
            match plan.trigger.kind {
                AgentSpeakTriggerKind::State => return Err("hrdsl has no events `^!`".to_owned()),
                AgentSpeakTriggerKind::Achieve | AgentSpeakTriggerKind::Failed => w.goal(of)?,
                AgentSpeakTriggerKind::Added
                | AgentSpeakTriggerKind::Removed
                | AgentSpeakTriggerKind::Test
                | AgentSpeakTriggerKind::TestFailed => {
                    w.belief(of)?;
                }
            }
            plan.context.as_ref().map_or(Ok(()), |c| w.formula(c))
        });
        if fits {
            self.steps(&plan.body);
        }
    }

    fn steps(&mut self, steps: &[AgentSpeakStep]) {
        for step in steps {
            if self.attempt(step.span, |w| w.step(step)) {
                self.within(step);
            }
        }
    }

    /// The steps within a step.
    fn within(&mut self, step: &AgentSpeakStep) {
        if let AgentSpeakStepKind::Action(action) = &step.kind
            && action.functor == ".fork"
        {
            for arg in &action.args {
                if let TermKind::Body(body) = &arg.kind {
                    self.steps(body);
                }
            }
        }
        step.blocks().into_iter().flatten().for_each(|block| self.steps(block));
    }

    fn step(&mut self, step: &AgentSpeakStep) -> Result<(), OmissionReason> {
        match &step.kind {
            AgentSpeakStepKind::Achieve(of) | AgentSpeakStepKind::Spawn(of) => self.goal(literal(of)?),
            AgentSpeakStepKind::Query(of) | AgentSpeakStepKind::Formula(of) => self.formula(of),
            AgentSpeakStepKind::Add(of, _)
            | AgentSpeakStepKind::Remove(of)
            | AgentSpeakStepKind::Replace(of) => self.belief_or_var(of),
            AgentSpeakStepKind::Action(action) if action.is_internal() => internal::infer(self, action),
            AgentSpeakStepKind::Action(action) => {
                if action.negated {
                    return Err("an action cannot be negated".to_owned());
                }
                let places = self.types.action(&action.key());
                action.args.iter().zip(places).try_for_each(|(arg, place)| self.action_arg(arg, place))
            }
            AgentSpeakStepKind::If { condition, .. }
            | AgentSpeakStepKind::While { condition, .. }
            | AgentSpeakStepKind::For { condition, .. } => self.formula(condition),
            AgentSpeakStepKind::Fork { .. } | AgentSpeakStepKind::Block(_) => Ok(()),
        }
    }

    /// Strings and atoms as arguments of actions are values of one enumeration.
    fn action_arg(&mut self, arg: &AgentSpeakTerm, place: TyId) -> Result<(), OmissionReason> {
        let id = match (&arg.kind, self.types.get(place)) {
            (TermKind::Literal(_), AgentSpeakType::Text) if atom(arg).is_some() => {
                self.types.add(AgentSpeakType::Text)
            }
            (TermKind::Text(text), AgentSpeakType::Atoms { agent: false, .. }) if is_word(text) => {
                let names = [text.clone()].into_iter().collect();
                self.types.add(AgentSpeakType::Atoms { names, agent: false })
            }
            _ => self.term(arg)?,
        };
        self.types.record(arg.span, id)?;
        self.types.meet(place, id)
    }

    /// `+X`: a variable that holds a structure stands for the belief of that name.
    fn belief_or_var(&mut self, of: &AgentSpeakTerm) -> Result<(), OmissionReason> {
        let TermKind::Var { .. } = &of.kind else { return self.belief(literal(of)?) };
        let id = self.term(of)?;
        let AgentSpeakType::Struct(functor, args) = self.types.get(id).clone() else {
            return Err("which belief this is about is known only when it runs".to_owned());
        };
        let places = self.types.belief(&(functor, args.len()));
        args.into_iter().zip(places).try_for_each(|(a, p)| self.types.unify(a, p))
    }

    pub fn belief(&mut self, of: &AgentSpeakLiteral) -> Result<(), OmissionReason> {
        if of.is_internal() {
            return Err(format!("`{}` is no belief", of.functor));
        }
        let key = of.key();
        let places = self.types.belief(&key);
        self.args(&of.args, &places)?;
        self.annotations(of, Some(&key))
    }

    pub fn goal(&mut self, of: &AgentSpeakLiteral) -> Result<(), OmissionReason> {
        if of.negated || of.is_internal() {
            return Err("this is no goal that a scenario can have".to_owned());
        }
        let places = self.types.goal(&of.key());
        self.args(&of.args, &places)?;
        self.annotations(of, None)
    }

    /// Only annotations with one value have a type; others are dropped where they are written.
    fn annotations(
        &mut self,
        of: &AgentSpeakLiteral,
        belief: Option<&PredicateIndicator>,
    ) -> Result<(), OmissionReason> {
        for annotation in &of.annotations {
            let Some((name, value)) = valued(annotation) else { continue };
            if belief.is_none() && name != "source" {
                continue;
            }
            let none = (String::new(), 0);
            let place = self.types.annotation(belief.unwrap_or(&none), name);
            let id = self.term(value)?;
            self.types.demand(id, place)?;
        }
        Ok(())
    }

    pub fn args(&mut self, args: &[AgentSpeakTerm], places: &[TyId]) -> Result<(), OmissionReason> {
        for (arg, place) in args.iter().zip(places) {
            let id = self.term(arg)?;
            self.types.unify(*place, id)?;
        }
        Ok(())
    }

    pub fn formula(&mut self, of: &AgentSpeakTerm) -> Result<(), OmissionReason> {
        let Some(formula) = of.as_formula() else {
            let is_variable = matches!(of.kind, TermKind::Var { .. });
            let why =
                if is_variable { "a variable cannot stand for a formula" } else { "this is no formula" };
            return Err(why.to_owned());
        };
        match formula {
            AgentSpeakFormula::Truth(_) => Ok(()),
            AgentSpeakFormula::Literal(l) if l.is_internal() => internal::infer(self, l),
            AgentSpeakFormula::Literal(l) => self.belief(l),
            AgentSpeakFormula::Not(inner) => self.formula(inner),
            AgentSpeakFormula::Connective { left, right, .. } => {
                self.formula(left)?;
                self.formula(right)
            }
            AgentSpeakFormula::Relation { op: AgentSpeakOperator::Univ, .. } => {
                Err("hrdsl has no `=..`".to_owned())
            }
            // Which of two texts comes first is known at once.
            AgentSpeakFormula::Relation { op, left, right }
                if op.sort() == AgentSpeakOperatorSort::Order && texts(left, right).is_some() =>
            {
                Ok(())
            }
            AgentSpeakFormula::Relation { op, left, right } => {
                let (l, r) = (self.term(left)?, self.term(right)?);
                if op.sort() == AgentSpeakOperatorSort::Order {
                    self.ordered(l, r)
                } else {
                    self.types.unify(l, r)
                }
            }
        }
    }

    /// Numbers are compared with each other, and values of several types with both.
    fn ordered(&mut self, left: TyId, right: TyId) -> Result<(), OmissionReason> {
        let number = self.types.number(false);
        if [left, right].iter().all(|id| self.types.alternatives(*id).is_none()) {
            let before = self.types.mark();
            let meets = self.types.meet(left, right).and_then(|()| self.types.meet(left, number));
            let Err(clash) = meets else { return Ok(()) };
            self.types.back(before);
            // A value that is no number yet, compared with a number, will be one: `best(none)`, `best(M) & N > M`.
            let is_number = |w: &Self, id| w.types.get(id).sort() == Some(AlternativeSort::Number);
            let other = match (is_number(self, left), is_number(self, right)) {
                (true, false) => right,
                (false, true) => left,
                (true, true) | (false, false) => return Err(clash),
            };
            self.types.unify(other, number)?;
        }
        for id in [left, right] {
            if self.types.alternatives(id).is_none() {
                self.types.meet(id, number)?;
            }
        }
        self.types.decimals.push((left, right));
        Ok(())
    }

    /// The class of a term.
    pub fn term(&mut self, of: &AgentSpeakTerm) -> Result<TyId, OmissionReason> {
        let id = match &of.kind {
            TermKind::Int(_) => self.types.number(false),
            TermKind::Float(_) => self.types.number(true),
            TermKind::Text(_) => self.types.add(AgentSpeakType::Text),
            TermKind::Bool(_) => self.types.add(AgentSpeakType::Bool),
            TermKind::Any => self.types.fresh(),
            TermKind::Var { name, annotations } => {
                if !annotations.is_empty() {
                    return Err("a variable with annotations stands for a literal".to_owned());
                }
                match self.vars.get(name) {
                    Some(id) => *id,
                    None => {
                        let id = self.types.fresh();
                        self.vars.insert(name.clone(), id);
                        id
                    }
                }
            }
            TermKind::Literal(l) => self.structure(l)?,
            TermKind::List { items, rest } => {
                let element = self.types.fresh();
                for item in items {
                    let id = self.term(item)?;
                    self.types.unify(element, id)?;
                }
                let list = self.types.add(AgentSpeakType::List(element));
                if let Some(rest) = rest {
                    let id = self.term(rest)?;
                    self.types.demand(id, list)?;
                }
                list
            }
            TermKind::Neg(inner) => {
                let number = self.types.number(false);
                let id = self.term(inner)?;
                self.types.demand(id, number)?;
                if self.types.alternatives(id).is_some() { number } else { id }
            }
            TermKind::Binary { op, left, right } if op.is_arithmetic() => {
                self.arithmetic(*op, left, right)?
            }
            TermKind::Not(_) | TermKind::Binary { .. } => {
                return Err("a formula stands where a value should".to_owned());
            }
            TermKind::Body(_) | TermKind::Trigger(_) | TermKind::Plan => {
                return Err("plans and steps are no values".to_owned());
            }
        };
        self.types.record(of.span, id)?;
        Ok(id)
    }

    /// What is divided, or not taken to a small power, may be whole, and the result is none.
    fn arithmetic(
        &mut self,
        op: AgentSpeakOperator,
        left: &AgentSpeakTerm,
        right: &AgentSpeakTerm,
    ) -> Result<TyId, OmissionReason> {
        let has_decimals = match op {
            AgentSpeakOperator::Pow => small_power(right).is_none(),
            op => op == AgentSpeakOperator::Div,
        };
        let number = self.types.number(has_decimals);
        for side in [left, right] {
            let id = self.term(side)?;
            let expected = if has_decimals { self.types.number(false) } else { number };
            self.types.demand(id, expected)?;
        }
        Ok(number)
    }

    fn structure(&mut self, of: &AgentSpeakLiteral) -> Result<TyId, OmissionReason> {
        if of.negated || !of.annotations.is_empty() {
            return Err("a literal with `~` or annotations is no value".to_owned());
        }
        if of.is_internal() {
            return internal::infer_function(self, of);
        }
        if of.args.is_empty() {
            let names = [of.functor.clone()].into_iter().collect();
            return Ok(self.types.add(AgentSpeakType::Atoms { names, agent: false }));
        }
        let args = of.args.iter().map(|a| self.term(a)).collect::<Result<Vec<_>, _>>()?;
        Ok(self.types.add(AgentSpeakType::Struct(of.functor.clone(), args)))
    }
}

/// Whether a text could be an atom.
fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_lowercase())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
