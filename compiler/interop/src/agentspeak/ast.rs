//! The tree of an AgentSpeak program, as Jason reads it.

use std::collections::BTreeSet;

use hrdsl_source::Span;

/// A program: a `.asl` file with all that it includes.
#[derive(Clone, Debug, Default)]
pub struct AgentSpeakProgram {
    /// In the order of the text, those of included files at the place of the directive.
    pub items: Vec<AgentSpeakItem>,
}

#[derive(Clone, Debug)]
pub struct AgentSpeakItem {
    pub kind: AgentSpeakItemKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum AgentSpeakItemKind {
    Belief(AgentSpeakLiteral),
    Rule {
        head: AgentSpeakLiteral,
        body: AgentSpeakTerm,
    },
    Goal(AgentSpeakTerm),
    Plan(AgentSpeakPlan),
    /// A directive that means nothing here, with what is to be said of it.
    Skipped(String),
    /// A clause that cannot be read, with what was expected.
    Broken(String),
}

#[derive(Clone, Debug)]
pub struct AgentSpeakPlan {
    pub label: Option<String>,
    /// Those of the label: `atomic`, …
    pub annotations: Vec<AgentSpeakTerm>,
    pub trigger: AgentSpeakTrigger,
    pub context: Option<AgentSpeakTerm>,
    pub body: Vec<AgentSpeakStep>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AgentSpeakTriggerKind {
    Added,
    Removed,
    Achieve,
    Failed,
    Test,
    TestFailed,
    /// `^!g`, `^?b`
    State,
}

impl AgentSpeakTriggerKind {
    /// As it is written.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Added => "+",
            Self::Removed => "-",
            Self::Achieve => "+!",
            Self::Failed => "-!",
            Self::Test => "+?",
            Self::TestFailed => "-?",
            Self::State => "^!",
        }
    }

    /// Whether it is about a goal to achieve, and not about a belief.
    pub fn is_goal(self) -> bool {
        match self {
            Self::Achieve | Self::Failed | Self::State => true,
            Self::Added | Self::Removed | Self::Test | Self::TestFailed => false,
        }
    }
}

#[derive(Clone, Debug)]
pub struct AgentSpeakTrigger {
    pub kind: AgentSpeakTriggerKind,
    /// A literal, or a variable for one.
    pub of: AgentSpeakTerm,
}

#[derive(Clone, Debug)]
pub struct AgentSpeakLiteral {
    pub negated: bool,
    pub functor: String,
    pub args: Vec<AgentSpeakTerm>,
    pub annotations: Vec<AgentSpeakTerm>,
    pub span: Span,
}

impl AgentSpeakLiteral {
    /// The name and the number of arguments.
    pub fn key(&self) -> PredicateIndicator {
        (self.functor.clone(), self.args.len())
    }

    /// `.print`, `math.abs`: what is no belief and no action of the environment.
    pub fn is_internal(&self) -> bool {
        self.functor.contains('.')
    }
}

/// A name and a number of arguments.
pub type PredicateIndicator = (String, usize);

#[derive(Clone, Debug)]
pub struct AgentSpeakTerm {
    pub kind: TermKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum TermKind {
    Int(i64),
    Float(f64),
    Text(String),
    Bool(bool),
    /// `_`
    Any,
    Var {
        name: String,
        annotations: Vec<AgentSpeakTerm>,
    },
    /// An atom, structure, belief, action.
    Literal(AgentSpeakLiteral),
    List {
        items: Vec<AgentSpeakTerm>,
        rest: Option<Box<AgentSpeakTerm>>,
    },
    Not(Box<AgentSpeakTerm>),
    Neg(Box<AgentSpeakTerm>),
    Binary {
        op: AgentSpeakOperator,
        left: Box<AgentSpeakTerm>,
        right: Box<AgentSpeakTerm>,
    },
    /// `{ … }` as an argument.
    Body(Vec<AgentSpeakStep>),
    /// `{ +!g }` as an argument.
    Trigger(Box<AgentSpeakTrigger>),
    /// `{ +!g : c <- b }` as an argument.
    Plan,
}

/// What a term is where a formula stands.
pub enum AgentSpeakFormula<'a> {
    Truth(bool),
    /// A belief, or an internal action.
    Literal(&'a AgentSpeakLiteral),
    Not(&'a AgentSpeakTerm),
    /// `&`, `|`
    Connective {
        op: AgentSpeakOperator,
        left: &'a AgentSpeakTerm,
        right: &'a AgentSpeakTerm,
    },
    Relation {
        op: AgentSpeakOperator,
        left: &'a AgentSpeakTerm,
        right: &'a AgentSpeakTerm,
    },
}

impl AgentSpeakTerm {
    /// The formula that it is; `None`: a value.
    pub fn as_formula(&self) -> Option<AgentSpeakFormula<'_>> {
        match &self.kind {
            TermKind::Bool(b) => Some(AgentSpeakFormula::Truth(*b)),
            TermKind::Literal(l) => Some(AgentSpeakFormula::Literal(l)),
            TermKind::Not(inner) => Some(AgentSpeakFormula::Not(inner)),
            TermKind::Binary { op, left, right } => match op.sort() {
                AgentSpeakOperatorSort::Connective => {
                    Some(AgentSpeakFormula::Connective { op: *op, left, right })
                }
                AgentSpeakOperatorSort::Order | AgentSpeakOperatorSort::Likeness => {
                    Some(AgentSpeakFormula::Relation { op: *op, left, right })
                }
                AgentSpeakOperatorSort::Arithmetic => None,
            },
            TermKind::Int(_)
            | TermKind::Float(_)
            | TermKind::Text(_)
            | TermKind::Any
            | TermKind::Var { .. }
            | TermKind::List { .. }
            | TermKind::Neg(_)
            | TermKind::Body(_)
            | TermKind::Trigger(_)
            | TermKind::Plan => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AgentSpeakOperator {
    Or,
    And,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    Different,
    Unify,
    NotUnify,
    /// `=..`
    Univ,
    Add,
    Sub,
    Mul,
    Div,
    IntDiv,
    Mod,
    Pow,
}

/// What sort of operator one is, by what it takes and gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AgentSpeakOperatorSort {
    /// Of formulas.
    Connective,
    /// Which of two terms is less.
    Order,
    /// Whether, or how, two terms are alike.
    Likeness,
    Arithmetic,
}

impl AgentSpeakOperator {
    pub fn sort(self) -> AgentSpeakOperatorSort {
        match self {
            Self::Or | Self::And => AgentSpeakOperatorSort::Connective,
            Self::Less | Self::LessEqual | Self::Greater | Self::GreaterEqual => {
                AgentSpeakOperatorSort::Order
            }
            Self::Equal | Self::Different | Self::Unify | Self::NotUnify | Self::Univ => {
                AgentSpeakOperatorSort::Likeness
            }
            Self::Add | Self::Sub | Self::Mul | Self::Div | Self::IntDiv | Self::Mod | Self::Pow => {
                AgentSpeakOperatorSort::Arithmetic
            }
        }
    }

    /// Whether it computes a number.
    pub fn is_arithmetic(self) -> bool {
        self.sort() == AgentSpeakOperatorSort::Arithmetic
    }
}

#[derive(Clone, Debug)]
pub struct AgentSpeakStep {
    pub kind: AgentSpeakStepKind,
    pub span: Span,
}

/// Where `+b` puts the belief, and who handles the event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeliefAddition {
    Plain,
    /// `+<b`
    First,
    /// `+>b`
    Last,
    /// `++b`
    NewFocus,
}

#[derive(Clone, Debug)]
pub enum AgentSpeakStepKind {
    Achieve(AgentSpeakTerm),
    Spawn(AgentSpeakTerm),
    Query(AgentSpeakTerm),
    Add(AgentSpeakTerm, BeliefAddition),
    Remove(AgentSpeakTerm),
    Replace(AgentSpeakTerm),
    /// An action of the environment, or an internal one.
    Action(AgentSpeakLiteral),
    /// A relation, `true`, or another formula.
    Formula(AgentSpeakTerm),
    If {
        condition: AgentSpeakTerm,
        then: Vec<AgentSpeakStep>,
        otherwise: Vec<AgentSpeakStep>,
    },
    While {
        condition: AgentSpeakTerm,
        body: Vec<AgentSpeakStep>,
    },
    For {
        condition: AgentSpeakTerm,
        body: Vec<AgentSpeakStep>,
    },
    Fork {
        branches: Vec<Vec<AgentSpeakStep>>,
        all: bool,
    },
    Block(Vec<AgentSpeakStep>),
}

impl AgentSpeakStep {
    /// The steps within it; `None`: it is a plain step.
    pub fn blocks(&self) -> Option<Vec<&[AgentSpeakStep]>> {
        match &self.kind {
            AgentSpeakStepKind::If { then, otherwise, .. } => Some(vec![then, otherwise]),
            AgentSpeakStepKind::While { body, .. }
            | AgentSpeakStepKind::For { body, .. }
            | AgentSpeakStepKind::Block(body) => Some(vec![body]),
            AgentSpeakStepKind::Fork { branches, .. } => Some(branches.iter().map(Vec::as_slice).collect()),
            AgentSpeakStepKind::Achieve(_)
            | AgentSpeakStepKind::Spawn(_)
            | AgentSpeakStepKind::Query(_)
            | AgentSpeakStepKind::Add(..)
            | AgentSpeakStepKind::Remove(_)
            | AgentSpeakStepKind::Replace(_)
            | AgentSpeakStepKind::Action(_)
            | AgentSpeakStepKind::Formula(_) => None,
        }
    }
}

/// Whether steps, or what is within them, name one of these variables.
pub fn names_any(steps: &[AgentSpeakStep], names: &BTreeSet<String>) -> bool {
    let mut found = false;
    let mut look = |term: &AgentSpeakTerm| found |= variables(term).iter().any(|v| names.contains(v));
    each_step(steps, &mut |step| match &step.kind {
        AgentSpeakStepKind::Achieve(of)
        | AgentSpeakStepKind::Spawn(of)
        | AgentSpeakStepKind::Query(of)
        | AgentSpeakStepKind::Add(of, _)
        | AgentSpeakStepKind::Remove(of)
        | AgentSpeakStepKind::Replace(of)
        | AgentSpeakStepKind::Formula(of)
        | AgentSpeakStepKind::If { condition: of, .. }
        | AgentSpeakStepKind::While { condition: of, .. }
        | AgentSpeakStepKind::For { condition: of, .. } => look(of),
        AgentSpeakStepKind::Action(of) => of.args.iter().chain(&of.annotations).for_each(&mut look),
        AgentSpeakStepKind::Fork { .. } | AgentSpeakStepKind::Block(_) => {}
    });
    found
}

/// Calls `f` with each step, those within blocks too, in the order of the text.
pub fn each_step<'a>(steps: &'a [AgentSpeakStep], f: &mut dyn FnMut(&'a AgentSpeakStep)) {
    for step in steps {
        f(step);
        step.blocks().into_iter().flatten().for_each(|block| each_step(block, f));
    }
}

/// Calls `f` with a term and all within it, but not with what is in the bodies of plans.
pub fn each_term<'a>(term: &'a AgentSpeakTerm, f: &mut dyn FnMut(&'a AgentSpeakTerm)) {
    f(term);
    match &term.kind {
        TermKind::Literal(l) => each_in_literal(l, f),
        TermKind::Var { annotations, .. } => annotations.iter().for_each(|t| each_term(t, f)),
        TermKind::List { items, rest } => {
            items.iter().for_each(|t| each_term(t, f));
            if let Some(rest) = rest {
                each_term(rest, f);
            }
        }
        TermKind::Not(t) | TermKind::Neg(t) => each_term(t, f),
        TermKind::Binary { left, right, .. } => {
            each_term(left, f);
            each_term(right, f);
        }
        TermKind::Trigger(t) => each_term(&t.of, f),
        TermKind::Int(_)
        | TermKind::Float(_)
        | TermKind::Text(_)
        | TermKind::Bool(_)
        | TermKind::Any
        | TermKind::Body(_)
        | TermKind::Plan => {}
    }
}

/// Calls `f` with the terms within a literal.
pub fn each_in_literal<'a>(literal: &'a AgentSpeakLiteral, f: &mut dyn FnMut(&'a AgentSpeakTerm)) {
    literal.args.iter().chain(&literal.annotations).for_each(|t| each_term(t, f));
}

/// The variables in a term, each as often as it stands there.
pub fn variables(of: &AgentSpeakTerm) -> Vec<String> {
    let mut all = Vec::new();
    each_term(of, &mut |t| {
        if let TermKind::Var { name, .. } = &t.kind {
            all.push(name.clone());
        }
    });
    all
}

/// Whether `_` stands in a term.
pub fn has_any(of: &AgentSpeakTerm) -> bool {
    let mut any = false;
    each_term(of, &mut |t| any |= matches!(t.kind, TermKind::Any));
    any
}
