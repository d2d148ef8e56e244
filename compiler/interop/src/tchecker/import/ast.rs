//! What a TChecker file says.

/// Where something is written: a byte offset in the file.
pub type At = usize;

#[derive(Debug, Default)]
pub struct Model {
    pub name: String,
    pub clocks: Vec<Array>,
    pub ints: Vec<Int>,
    pub events: Vec<String>,
    pub processes: Vec<Process>,
    pub syncs: Vec<Sync>,
    /// Attributes that mean nothing here: the key, and where it is.
    pub ignored: Vec<(String, At)>,
}

/// `clock:size:name`
#[derive(Debug)]
pub struct Array {
    pub name: String,
    pub size: u32,
    pub at: At,
}

/// `int:size:min:max:init:name`
#[derive(Debug)]
pub struct Int {
    pub of: Array,
    pub lo: i64,
    pub hi: i64,
    pub init: i64,
}

#[derive(Debug)]
pub struct Process {
    pub name: String,
    pub at: At,
    pub locations: Vec<Location>,
    pub edges: Vec<Edge>,
}

#[derive(Debug, Default)]
pub struct Location {
    pub name: String,
    pub initial: bool,
    pub committed: bool,
    pub urgent: bool,
    pub labels: Vec<String>,
    /// A conjunction.
    pub invariant: Vec<Expr>,
    pub at: At,
}

#[derive(Debug)]
pub struct Edge {
    /// Indices into the process's locations.
    pub from: usize,
    pub to: usize,
    pub event: String,
    /// A conjunction.
    pub provided: Vec<Expr>,
    pub body: Vec<Statement>,
    pub at: At,
}

/// `sync:P@a:Q@b?`
#[derive(Debug)]
pub struct Sync {
    pub parties: Vec<Party>,
}

#[derive(Debug)]
pub struct Party {
    /// Index into the model's processes.
    pub process: usize,
    pub event: String,
    pub weak: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub kind: Kind,
    pub at: At,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    Int(i64),
    /// An integer or clock, perhaps an element of an array.
    Name(String, Option<Box<Expr>>),
    Neg(Box<Expr>),
    Not(Box<Expr>),
    Binary(Op, Box<Expr>, Box<Expr>),
    If(Box<Expr>, Box<Expr>, Box<Expr>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Op {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
    And,
}

impl Op {
    pub fn text(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Sub => "-",
            Self::Mul => "*",
            Self::Div => "/",
            Self::Rem => "%",
            Self::Eq => "==",
            Self::Ne => "!=",
            Self::Lt => "<",
            Self::Le => "<=",
            Self::Gt => ">",
            Self::Ge => ">=",
            Self::And => "&&",
        }
    }

    pub fn compares(self) -> bool {
        match self {
            Self::Eq | Self::Ne | Self::Lt | Self::Le | Self::Gt | Self::Ge => true,
            Self::Add | Self::Sub | Self::Mul | Self::Div | Self::Rem | Self::And => false,
        }
    }

    /// With the sides exchanged.
    pub fn flipped(self) -> Self {
        match self {
            Self::Lt => Self::Gt,
            Self::Le => Self::Ge,
            Self::Gt => Self::Lt,
            Self::Ge => Self::Le,
            Self::Eq | Self::Ne | Self::Add | Self::Sub | Self::Mul | Self::Div | Self::Rem | Self::And => {
                self
            }
        }
    }

    /// True exactly where this is false; of comparisons only.
    pub fn negated(self) -> Option<Self> {
        match self {
            Self::Eq => Some(Self::Ne),
            Self::Ne => Some(Self::Eq),
            Self::Lt => Some(Self::Ge),
            Self::Le => Some(Self::Gt),
            Self::Gt => Some(Self::Le),
            Self::Ge => Some(Self::Lt),
            Self::Add | Self::Sub | Self::Mul | Self::Div | Self::Rem | Self::And => None,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Statement {
    pub kind: Act,
    pub at: At,
}

#[derive(Clone, Debug)]
pub enum Act {
    Assign { name: String, index: Option<Expr>, value: Expr },
    If { condition: Expr, then: Vec<Statement>, otherwise: Vec<Statement> },
    While { condition: Expr, body: Vec<Statement> },
    Local { name: String, size: Option<Expr>, init: Option<Expr> },
}
