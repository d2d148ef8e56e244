//! The dimensions of a belief space, and why choices may span none.

use std::fmt;

use hrdsl_ir::{
    Program, Value,
    bdi::{AgentId, BeliefDecl, InitialFact},
    suite::{BeliefChoice, ChoiceKind},
};

use crate::{query::BeliefQueryError, show::call as literal};

/// Alternatives of all factors together.
pub const MAX_ALTERNATIVES: usize = 10_000;

/// Choices that a message names, at most.
const NAMED: usize = 5;

/// One dimension of the belief space.
#[derive(Clone, Debug, PartialEq)]
pub struct BeliefFactor {
    pub agent: AgentId,
    /// What is chosen: `wants`, `shows(leg = 1)`, `gets_bored(2)`.
    pub name: String,
    /// Never empty.
    pub alternatives: Vec<FactorAlternative>,
}

/// One value of a dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct FactorAlternative {
    /// The beliefs held; none for a belief that is chosen not to be.
    pub facts: Vec<InitialFact>,
    /// `shows(1, true, false, true)`; if nothing is held `not gets_bored(2)`. With the agent's name and a dot before it
    /// if beliefs of several agents are chosen.
    pub text: String,
}

/// Why choices span no finite space.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChooseError {
    /// An agent, belief or parameter that is not declared.
    Undeclared,
    /// A parameter without a finite type.
    Infinite { belief: String, param: String },
    /// A parameter whose type has no value.
    Empty { belief: String, param: String },
    /// More than [`MAX_ALTERNATIVES`].
    TooMany { belief: String },
    /// A condition that cannot be asked.
    Malformed { why: String },
    /// No set of beliefs fulfils the conditions on these choices.
    NothingAllowed {
        choices: Vec<String>,
        /// All sets were tried.
        is_proved: bool,
        /// Why a condition had no value.
        fault: Option<BeliefQueryError>,
    },
}

impl fmt::Display for ChooseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ChooseError::Undeclared => f.write_str("a choice of what is not declared"),
            ChooseError::Infinite { belief, param } => {
                write!(f, "cannot choose {belief}: {param} has infinitely many values")
            }
            ChooseError::Empty { belief, param } => write!(f, "cannot choose {belief}: {param} has no value"),
            ChooseError::TooMany { belief } => {
                write!(f, "cannot choose {belief}: more than {MAX_ALTERNATIVES} alternatives")
            }
            ChooseError::Malformed { why } => f.write_str(why),
            ChooseError::NothingAllowed { choices, is_proved, fault } => {
                f.write_str(if *is_proved {
                    "no belief set fulfils"
                } else {
                    "no belief set was found that fulfils"
                })?;
                f.write_str(" what `where` says")?;
                let shown: Vec<&str> = choices.iter().take(NAMED).map(String::as_str).collect();
                let more = if choices.len() > NAMED { ", …" } else { "" };
                if !shown.is_empty() {
                    write!(f, " of {}{more}", shown.join(", "))?;
                }
                fault.map_or(Ok(()), |fault| write!(f, ": {fault}"))
            }
        }
    }
}

impl std::error::Error for ChooseError {}

/// The dimensions of the belief space, in the order of the choices. Ground instances are in lexicographic order of
/// their arguments, `false` before `true` and not held before held.
///
/// # Errors
/// See [`ChooseError`].
pub fn factors(program: &Program, choices: &[BeliefChoice]) -> Result<Vec<BeliefFactor>, ChooseError> {
    let several = choices.iter().any(|c| c.agent != choices[0].agent);
    let mut factors = Vec::new();
    let mut alternatives = 0usize;
    for choice in choices {
        let agent = program.agents.get(choice.agent.0 as usize).ok_or(ChooseError::Undeclared)?;
        let belief = agent.beliefs.get(choice.belief.0 as usize).ok_or(ChooseError::Undeclared)?;
        let instances = instances(belief)?;
        alternatives += instances.len() * if choice.how == ChoiceKind::Any { 2 } else { 1 };
        if alternatives > MAX_ALTERNATIVES {
            return Err(ChooseError::TooMany { belief: belief.name.clone() });
        }
        let owner = if several { format!("{}.", agent.name) } else { String::new() };
        span(SpannedBelief { choice, belief, owner }, instances, &mut factors)?;
    }
    Ok(factors)
}

struct SpannedBelief<'a> {
    choice: &'a BeliefChoice,
    belief: &'a BeliefDecl,
    /// What stands before names.
    owner: String,
}

impl SpannedBelief<'_> {
    fn held(&self, args: &[Value]) -> FactorAlternative {
        let fact = InitialFact { belief: self.choice.belief, args: args.to_vec(), annotations: Vec::new() };
        FactorAlternative { text: self.owner.clone() + &literal(&self.belief.name, args), facts: vec![fact] }
    }

    fn factor(&self, name: &str, alternatives: Vec<FactorAlternative>) -> BeliefFactor {
        BeliefFactor { agent: self.choice.agent, name: format!("{}{name}", self.owner), alternatives }
    }
}

fn span(
    of: SpannedBelief,
    instances: Vec<Vec<Value>>,
    factors: &mut Vec<BeliefFactor>,
) -> Result<(), ChooseError> {
    let name = &of.belief.name;
    match of.choice.how {
        ChoiceKind::One => {
            factors.push(of.factor(name, instances.iter().map(|i| of.held(i)).collect()));
        }
        ChoiceKind::OnePer(param) => {
            let at = usize::from(param);
            let declared = of.belief.params.get(at).ok_or(ChooseError::Undeclared)?;
            for value in declared.ty.domain().unwrap_or_default() {
                let name = format!("{name}({} = {value})", declared.name);
                let with = instances.iter().filter(|i| i[at].key() == value.key());
                factors.push(of.factor(&name, with.map(|i| of.held(i)).collect()));
            }
        }
        ChoiceKind::Any => {
            for instance in &instances {
                let held = of.held(instance);
                let not = FactorAlternative { facts: Vec::new(), text: format!("not {}", held.text) };
                factors.push(of.factor(&literal(name, instance), vec![not, held]));
            }
        }
    }
    Ok(())
}

/// All ground instances of a belief, in lexicographic order.
fn instances(belief: &BeliefDecl) -> Result<Vec<Vec<Value>>, ChooseError> {
    use hrdsl_ir::Type;
    let mut count = 1usize;
    for param in &belief.params {
        let (name, param_name) = (belief.name.clone(), param.name.clone());
        let size = match param.ty {
            Type::Bool => 2,
            Type::Int { lo, hi } => i128::from(hi) - i128::from(lo) + 1,
            Type::Enum(e) => i128::try_from(e.values().len()).unwrap_or(i128::MAX),
            Type::Float(_) | Type::Text | Type::List(_) => {
                return Err(ChooseError::Infinite { belief: name, param: param_name });
            }
        };
        if size <= 0 {
            return Err(ChooseError::Empty { belief: name, param: param_name });
        }
        // Checked before a domain is made.
        count = count.saturating_mul(usize::try_from(size).unwrap_or(usize::MAX));
    }
    if count > MAX_ALTERNATIVES {
        return Err(ChooseError::TooMany { belief: belief.name.clone() });
    }
    let mut all = vec![Vec::new()];
    for param in &belief.params {
        let domain = param.ty.domain().unwrap_or_default();
        all = all
            .into_iter()
            .flat_map(|prefix: Vec<Value>| {
                domain.iter().map(move |value| [prefix.as_slice(), &[*value]].concat()).collect::<Vec<_>>()
            })
            .collect();
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        ActorId, Enumeration, Parameter, Symbol, Type, Unit,
        bdi::{Agent, BeliefId},
    };

    use super::*;

    fn belief(name: &str, params: &[(&str, Type)]) -> BeliefDecl {
        let params = params.iter().map(|(n, ty)| Parameter { name: (*n).into(), ty: *ty }).collect();
        let origin = Default::default();
        BeliefDecl { name: name.into(), params, annotations: vec![], percept: None, negates: None, origin }
    }

    fn pace() -> Type {
        Type::Enum(Enumeration::intern("Pace", &["slow", "fast", "crawl"]))
    }

    fn program() -> Program {
        let leg = Type::Int { lo: 1, hi: 4 };
        let human = Agent {
            name: "Human".into(),
            actor: ActorId(0),
            beliefs: vec![
                belief("wants", &[("legs", Type::Int { lo: 0, hi: 4 })]),
                belief("gets_bored", &[("leg", leg)]),
                belief("shows", &[("leg", leg), ("gaze", Type::Bool), ("pressure", Type::Bool)]),
                belief("hurried", &[]),
                belief("near", &[("by", Type::Float(Unit::Metre))]),
                belief("huge", &[("n", Type::Int { lo: i64::MIN, hi: i64::MAX })]),
                belief("void", &[("n", Type::Int { lo: 1, hi: 0 })]),
                belief("prefers", &[("pace", pace()), ("gaze", Type::Bool)]),
                belief("nameless", &[("n", Type::Enum(Enumeration::intern("Nothing", &[])))]),
            ],
            goals: vec![],
            rules: vec![],
            jason: false,
            initial_beliefs: vec![],
            initial_goals: vec![],
            plans: vec![],
            origin: Default::default(),
        };
        let dog = Agent { name: "Dog".into(), beliefs: vec![belief("barks", &[])], ..human.clone() };
        Program { agents: vec![human, dog], ..Program::default() }
    }

    fn choose(belief: u16, how: ChoiceKind) -> BeliefChoice {
        BeliefChoice { agent: AgentId(0), belief: BeliefId(belief), how, condition: None }
    }

    fn texts(factor: &BeliefFactor) -> Vec<&str> {
        factor.alternatives.iter().map(|a| a.text.as_str()).collect()
    }

    #[test]
    fn one_is_a_factor_of_all_instances() {
        let factors = factors(&program(), &[choose(0, ChoiceKind::One), choose(3, ChoiceKind::One)]).unwrap();
        assert_eq!(texts(&factors[0]), ["wants(0)", "wants(1)", "wants(2)", "wants(3)", "wants(4)"]);
        assert_eq!(texts(&factors[1]), ["hurried"]);
        assert_eq!(
            factors[0].alternatives[2].facts,
            [InitialFact { belief: BeliefId(0), args: vec![Value::Int(2)], annotations: vec![] }]
        );
    }

    #[test]
    fn one_per_parameter_is_a_factor_for_each_value() {
        let found = factors(&program(), &[choose(2, ChoiceKind::OnePer(0))]).unwrap();
        assert_eq!(found.len(), 4);
        assert_eq!(found[1].name, "shows(leg = 2)");
        assert_eq!(
            texts(&found[1]),
            [
                "shows(2, false, false)",
                "shows(2, false, true)",
                "shows(2, true, false)",
                "shows(2, true, true)"
            ]
        );
        let by_gaze = factors(&program(), &[choose(2, ChoiceKind::OnePer(1))]).unwrap();
        assert_eq!((by_gaze.len(), by_gaze[0].alternatives.len()), (2, 8));
    }

    #[test]
    fn symbols_are_chosen_in_the_order_of_their_declaration() {
        let found = factors(&program(), &[choose(7, ChoiceKind::OnePer(0))]).unwrap();
        let names: Vec<&str> = found.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["prefers(pace = slow)", "prefers(pace = fast)", "prefers(pace = crawl)"]);
        assert_eq!(texts(&found[2]), ["prefers(crawl, false)", "prefers(crawl, true)"]);
        let crawl = Value::Symbol(Symbol::intern("crawl"));
        assert_eq!(found[2].alternatives[1].facts[0].args, [crawl, Value::Bool(true)]);
        let one = factors(&program(), &[choose(7, ChoiceKind::One)]).unwrap();
        assert_eq!(texts(&one[0])[1..3], ["prefers(slow, true)", "prefers(fast, false)"]);
    }

    #[test]
    fn any_is_a_factor_for_each_instance() {
        let found = factors(&program(), &[choose(1, ChoiceKind::Any)]).unwrap();
        assert_eq!(found.len(), 4);
        assert_eq!(texts(&found[3]), ["not gets_bored(4)", "gets_bored(4)"]);
        assert!(found[3].alternatives[0].facts.is_empty());
    }

    #[test]
    fn agents_are_named_when_there_are_several() {
        let dog =
            BeliefChoice { agent: AgentId(1), belief: BeliefId(0), how: ChoiceKind::Any, condition: None };
        let found = factors(&program(), &[choose(3, ChoiceKind::Any), dog]).unwrap();
        assert_eq!(texts(&found[0]), ["not Human.hurried", "Human.hurried"]);
        assert_eq!(found[1].name, "Dog.barks");
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        let refused = |choice| factors(&program(), &[choice]).unwrap_err();
        let (belief, param) = (|b: &str| b.to_owned(), |p: &str| p.to_owned());
        assert_eq!(refused(choose(9, ChoiceKind::One)), ChooseError::Undeclared);
        assert_eq!(refused(choose(0, ChoiceKind::OnePer(1))), ChooseError::Undeclared);
        assert_eq!(
            refused(choose(4, ChoiceKind::One)),
            ChooseError::Infinite { belief: belief("near"), param: param("by") }
        );
        assert_eq!(refused(choose(5, ChoiceKind::Any)), ChooseError::TooMany { belief: belief("huge") });
        assert_eq!(
            refused(choose(6, ChoiceKind::One)),
            ChooseError::Empty { belief: belief("void"), param: param("n") }
        );
        assert_eq!(
            refused(choose(8, ChoiceKind::One)),
            ChooseError::Empty { belief: belief("nameless"), param: param("n") }
        );
    }
}
