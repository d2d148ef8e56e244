//! The tree of an AgentSpeak program, as Jason reads it.

use hrdsl_source::Span;

/// A program: a `.asl` file with all that it includes.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// In the order of the text, those of included files at the place of the directive.
    pub items: Vec<Item>,
}

#[derive(Clone, Debug)]
pub struct Item {
    pub kind: ItemKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum ItemKind {
    Belief(Literal),
    Rule {
        head: Literal,
        body: Term,
    },
    Goal(Term),
    Plan(Plan),
    /// A directive that means nothing here, with what is to be said of it.
    Skipped(String),
}

#[derive(Clone, Debug)]
pub struct Plan {
    pub label: Option<String>,
    /// Those of the label: `atomic`, …
    pub annotations: Vec<Term>,
    pub trigger: Trigger,
    pub context: Option<Term>,
    pub body: Vec<Step>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TriggerKind {
    Added,
    Removed,
    Achieve,
    Failed,
    Test,
    TestFailed,
    /// `^!g`, `^?b`
    State,
}

impl TriggerKind {
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
pub struct Trigger {
    pub kind: TriggerKind,
    /// A literal, or a variable for one.
    pub of: Term,
}

#[derive(Clone, Debug)]
pub struct Literal {
    pub negated: bool,
    pub functor: String,
    pub args: Vec<Term>,
    pub annotations: Vec<Term>,
    pub span: Span,
}

impl Literal {
    /// The name and the number of arguments.
    pub fn key(&self) -> Key {
        (self.functor.clone(), self.args.len())
    }

    /// `.print`, `math.abs`: what is no belief and no action of the environment.
    pub fn is_internal(&self) -> bool {
        self.functor.contains('.')
    }
}

/// A name and a number of arguments.
pub type Key = (String, usize);

#[derive(Clone, Debug)]
pub struct Term {
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
        annotations: Vec<Term>,
    },
    /// An atom, structure, belief, action.
    Literal(Literal),
    List {
        items: Vec<Term>,
        rest: Option<Box<Term>>,
    },
    Not(Box<Term>),
    Neg(Box<Term>),
    Binary {
        op: Op,
        left: Box<Term>,
        right: Box<Term>,
    },
    /// `{ … }` as an argument.
    Body(Vec<Step>),
    /// `{ +!g }` as an argument.
    Trigger(Box<Trigger>),
    /// `{ +!g : c <- b }` as an argument.
    Plan,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Op {
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

impl Op {
    /// Whether it compares two terms.
    pub fn is_relation(self) -> bool {
        match self {
            Self::Less
            | Self::LessEqual
            | Self::Greater
            | Self::GreaterEqual
            | Self::Equal
            | Self::Different
            | Self::Unify
            | Self::NotUnify
            | Self::Univ => true,
            Self::Or
            | Self::And
            | Self::Add
            | Self::Sub
            | Self::Mul
            | Self::Div
            | Self::IntDiv
            | Self::Mod
            | Self::Pow => false,
        }
    }

    /// Whether it computes a number.
    pub fn is_arithmetic(self) -> bool {
        !self.is_relation() && !matches!(self, Self::Or | Self::And)
    }
}

#[derive(Clone, Debug)]
pub struct Step {
    pub kind: StepKind,
    pub span: Span,
}

/// Where `+b` puts the belief, and who handles the event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adding {
    Plain,
    /// `+<b`
    First,
    /// `+>b`
    Last,
    /// `++b`
    NewFocus,
}

#[derive(Clone, Debug)]
pub enum StepKind {
    Achieve(Term),
    Spawn(Term),
    Query(Term),
    Add(Term, Adding),
    Remove(Term),
    Replace(Term),
    /// An action of the environment, or an internal one.
    Action(Literal),
    /// A relation, `true`, or another formula.
    Formula(Term),
    If {
        condition: Term,
        then: Vec<Step>,
        otherwise: Vec<Step>,
    },
    While {
        condition: Term,
        body: Vec<Step>,
    },
    For {
        condition: Term,
        body: Vec<Step>,
    },
    Fork {
        branches: Vec<Vec<Step>>,
        all: bool,
    },
    Block(Vec<Step>),
}

/// Calls `f` with each step, those within blocks too, in the order of the text.
pub fn each_step<'a>(steps: &'a [Step], f: &mut dyn FnMut(&'a Step)) {
    for step in steps {
        f(step);
        match &step.kind {
            StepKind::If { then, otherwise, .. } => {
                each_step(then, f);
                each_step(otherwise, f);
            }
            StepKind::While { body, .. } | StepKind::For { body, .. } | StepKind::Block(body) => {
                each_step(body, f);
            }
            StepKind::Fork { branches, .. } => branches.iter().for_each(|b| each_step(b, f)),
            StepKind::Achieve(_)
            | StepKind::Spawn(_)
            | StepKind::Query(_)
            | StepKind::Add(..)
            | StepKind::Remove(_)
            | StepKind::Replace(_)
            | StepKind::Action(_)
            | StepKind::Formula(_) => {}
        }
    }
}

/// Calls `f` with a term and all within it, but not with what is in the bodies of plans.
pub fn each_term<'a>(term: &'a Term, f: &mut dyn FnMut(&'a Term)) {
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
pub fn each_in_literal<'a>(literal: &'a Literal, f: &mut dyn FnMut(&'a Term)) {
    literal.args.iter().chain(&literal.annotations).for_each(|t| each_term(t, f));
}
