//! What a TChecker file says.

/// Where something is written: a byte offset in the file.
pub type ByteOffset = usize;

#[derive(Debug, Default)]
pub struct TcheckerModel {
    pub name: String,
    pub clocks: Vec<TcheckerArray>,
    pub ints: Vec<TcheckerInt>,
    pub events: Vec<String>,
    pub processes: Vec<TcheckerProcess>,
    pub syncs: Vec<TcheckerSync>,
    /// Attributes that mean nothing here: the key, and where it is.
    pub ignored: Vec<(String, ByteOffset)>,
}

/// `clock:size:name`
#[derive(Debug)]
pub struct TcheckerArray {
    pub name: String,
    pub size: u32,
    pub at: ByteOffset,
}

/// `int:size:min:max:init:name`
#[derive(Debug)]
pub struct TcheckerInt {
    pub of: TcheckerArray,
    pub lo: i64,
    pub hi: i64,
    pub init: i64,
}

#[derive(Debug)]
pub struct TcheckerProcess {
    pub name: String,
    pub at: ByteOffset,
    pub locations: Vec<TcheckerLocation>,
    pub edges: Vec<TcheckerEdge>,
}

#[derive(Debug, Default)]
pub struct TcheckerLocation {
    pub name: String,
    pub initial: bool,
    pub committed: bool,
    pub urgent: bool,
    pub labels: Vec<String>,
    /// A conjunction.
    pub invariant: Vec<TcheckerExpr>,
    pub at: ByteOffset,
}

#[derive(Debug)]
pub struct TcheckerEdge {
    /// Indices into the process's locations.
    pub from: usize,
    pub to: usize,
    pub event: String,
    /// A conjunction.
    pub provided: Vec<TcheckerExpr>,
    pub body: Vec<TcheckerStatement>,
    pub at: ByteOffset,
}

/// `sync:P@a:Q@b?`
#[derive(Debug)]
pub struct TcheckerSync {
    pub participants: Vec<SyncParticipant>,
}

#[derive(Debug)]
pub struct SyncParticipant {
    /// Index into the model's processes.
    pub process: usize,
    pub event: String,
    pub weak: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct TcheckerExpr {
    pub kind: TcheckerExprKind,
    pub at: ByteOffset,
}

#[derive(Clone, Debug, PartialEq)]
pub enum TcheckerExprKind {
    Int(i64),
    /// An integer or clock, perhaps an element of an array.
    Name(String, Option<Box<TcheckerExpr>>),
    Neg(Box<TcheckerExpr>),
    Not(Box<TcheckerExpr>),
    Binary(TcheckerOperator, Box<TcheckerExpr>, Box<TcheckerExpr>),
    If(Box<TcheckerExpr>, Box<TcheckerExpr>, Box<TcheckerExpr>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TcheckerOperator {
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

impl TcheckerOperator {
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
pub struct TcheckerStatement {
    pub kind: TcheckerStatementKind,
    pub at: ByteOffset,
}

#[derive(Clone, Debug)]
pub enum TcheckerStatementKind {
    Assign { name: String, index: Option<TcheckerExpr>, value: TcheckerExpr },
    If { condition: TcheckerExpr, then: Vec<TcheckerStatement>, otherwise: Vec<TcheckerStatement> },
    While { condition: TcheckerExpr, body: Vec<TcheckerStatement> },
    Local { name: String, size: Option<TcheckerExpr>, init: Option<TcheckerExpr> },
}
