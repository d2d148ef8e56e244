//! UPPAAL's declarations, statements and expressions, as they are written.

use hrdsl_source::Span;

#[derive(Clone, Debug)]
pub struct UppaalExpr {
    pub kind: UppaalExprKind,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UppaalBinaryOperator {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    /// `<?`
    Min,
    /// `>?`
    Max,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
    And,
    Or,
    Imply,
    BitAnd,
    BitOr,
    BitXor,
    ShiftLeft,
    ShiftRight,
}

impl UppaalBinaryOperator {
    pub fn compares(self) -> bool {
        matches!(self, Self::Eq | Self::Ne | Self::Lt | Self::Le | Self::Gt | Self::Ge)
    }

    pub fn is_on_bits(self) -> bool {
        matches!(self, Self::BitAnd | Self::BitOr | Self::BitXor | Self::ShiftLeft | Self::ShiftRight)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UppaalQuantifier {
    Forall,
    Exists,
    Sum,
}

#[derive(Clone, Debug)]
pub enum UppaalExprKind {
    Int(i64),
    Bool(bool),
    Name(String),
    Neg(Box<UppaalExpr>),
    Not(Box<UppaalExpr>),
    Binary(UppaalBinaryOperator, Box<UppaalExpr>, Box<UppaalExpr>),
    Choice(Box<UppaalExpr>, Box<UppaalExpr>, Box<UppaalExpr>),
    Index(Box<UppaalExpr>, Box<UppaalExpr>),
    Call(Box<UppaalExpr>, Vec<UppaalExpr>),
    Field(Box<UppaalExpr>, String),
    /// `a op= b`; no operator: `a = b`
    Assign(Option<UppaalBinaryOperator>, Box<UppaalExpr>, Box<UppaalExpr>),
    /// `++` and `--`; `first`: before its operand, whose new value it has.
    Step {
        up: bool,
        first: bool,
        of: Box<UppaalExpr>,
    },
    Quantified(UppaalQuantifier, String, Box<UppaalType>, Box<UppaalExpr>),
    /// `x'`
    Rate(Box<UppaalExpr>),
    Deadlock,
}

#[derive(Clone, Debug)]
pub struct UppaalType {
    pub constant: bool,
    pub urgent: bool,
    pub broadcast: bool,
    /// Not part of the state.
    pub meta: bool,
    pub base: UppaalBaseType,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum UppaalBaseType {
    Int(Option<Box<(UppaalExpr, UppaalExpr)>>),
    Bool,
    Clock,
    Chan,
    Void,
    Named(String),
    /// `scalar[n]`
    Scalar(Box<UppaalExpr>),
    Struct(Vec<(UppaalType, Vec<UppaalDeclarator>)>),
}

/// One dimension of an array: so many, or one for each value of a type.
#[derive(Clone, Debug)]
pub enum UppaalDimension {
    Size(UppaalExpr),
    Of(UppaalType),
}

#[derive(Clone, Debug)]
pub enum UppaalInitializer {
    One(UppaalExpr),
    List(Vec<UppaalInitializer>, Span),
    /// Of a field: `name: value`
    Named(String, Box<UppaalInitializer>),
}

#[derive(Clone, Debug)]
pub struct UppaalDeclarator {
    pub name: String,
    pub span: Span,
    pub dims: Vec<UppaalDimension>,
    pub init: Option<UppaalInitializer>,
}

#[derive(Clone, Debug)]
pub struct UppaalParameter {
    pub ty: UppaalType,
    pub by_reference: bool,
    pub name: String,
    pub dims: Vec<UppaalDimension>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct UppaalFunction {
    pub ty: UppaalType,
    pub name: String,
    pub params: Vec<UppaalParameter>,
    pub body: Vec<UppaalStatement>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum UppaalDeclaration {
    Vars(UppaalType, Vec<UppaalDeclarator>),
    Typedef(UppaalType, UppaalDeclarator),
    Function(UppaalFunction),
    /// `name(params) = of(args);`
    Instance(UppaalInstance),
    /// `system A, B;`
    System(Vec<(String, Span)>),
    /// What is said of the declaration that follows.
    Comment(Vec<String>),
    /// What changes nothing of what a model does.
    Idle(Span, &'static str),
}

#[derive(Clone, Debug)]
pub struct UppaalInstance {
    pub name: String,
    pub params: Vec<UppaalParameter>,
    pub of: String,
    pub args: Vec<UppaalExpr>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct UppaalStatement {
    pub kind: UppaalStatementKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum UppaalStatementKind {
    Decl(UppaalDeclaration),
    Expr(UppaalExpr),
    Block(Vec<UppaalStatement>),
    If(UppaalExpr, Box<UppaalStatement>, Option<Box<UppaalStatement>>),
    While(UppaalExpr, Box<UppaalStatement>),
    DoWhile(Box<UppaalStatement>, UppaalExpr),
    For(Vec<UppaalExpr>, Option<UppaalExpr>, Vec<UppaalExpr>, Box<UppaalStatement>),
    ForRange(String, UppaalType, Box<UppaalStatement>),
    Return(Option<UppaalExpr>),
    Empty,
}

/// `c[i]!`
#[derive(Clone, Debug)]
pub struct UppaalSync {
    pub channel: UppaalExpr,
    pub offers: bool,
}

#[derive(Clone, Debug)]
pub struct UppaalSelect {
    pub name: String,
    pub ty: UppaalType,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum UppaalQuery {
    Possibly(UppaalExpr),
    Invariantly(UppaalExpr),
    PotentiallyAlways(UppaalExpr),
    Eventually(UppaalExpr),
    LeadsTo(UppaalExpr, UppaalExpr),
    Sup(Option<UppaalExpr>, Vec<UppaalExpr>),
    Inf(Option<UppaalExpr>, Vec<UppaalExpr>),
}

/// An expression that names something: `x`, `q[0]`, `P.x`.
pub enum UppaalPlace<'a> {
    Name(&'a str),
    Index(&'a UppaalExpr, &'a UppaalExpr),
    Field(&'a UppaalExpr, &'a str),
}

impl UppaalExpr {
    /// The name at the bottom of a chain of indices and fields.
    pub fn root(&self) -> Option<&str> {
        match self.as_place()? {
            UppaalPlace::Name(name) => Some(name),
            UppaalPlace::Index(of, _) | UppaalPlace::Field(of, _) => of.root(),
        }
    }

    /// What is named, if something is.
    pub fn as_place(&self) -> Option<UppaalPlace<'_>> {
        match &self.kind {
            UppaalExprKind::Name(name) => Some(UppaalPlace::Name(name)),
            UppaalExprKind::Index(of, index) => Some(UppaalPlace::Index(of, index)),
            UppaalExprKind::Field(of, name) => Some(UppaalPlace::Field(of, name)),
            UppaalExprKind::Int(_)
            | UppaalExprKind::Bool(_)
            | UppaalExprKind::Neg(_)
            | UppaalExprKind::Not(_)
            | UppaalExprKind::Binary(..)
            | UppaalExprKind::Choice(..)
            | UppaalExprKind::Call(..)
            | UppaalExprKind::Assign(..)
            | UppaalExprKind::Step { .. }
            | UppaalExprKind::Quantified(..)
            | UppaalExprKind::Rate(_)
            | UppaalExprKind::Deadlock => None,
        }
    }

    /// Calls `f` with it and every expression in it.
    pub fn each(&self, f: &mut dyn FnMut(&UppaalExpr)) {
        f(self);
        match &self.kind {
            UppaalExprKind::Int(_)
            | UppaalExprKind::Bool(_)
            | UppaalExprKind::Name(_)
            | UppaalExprKind::Deadlock => {}
            UppaalExprKind::Neg(a)
            | UppaalExprKind::Not(a)
            | UppaalExprKind::Rate(a)
            | UppaalExprKind::Field(a, _)
            | UppaalExprKind::Step { of: a, .. } => {
                a.each(f);
            }
            UppaalExprKind::Quantified(_, _, _, a) => a.each(f),
            UppaalExprKind::Binary(_, a, b)
            | UppaalExprKind::Index(a, b)
            | UppaalExprKind::Assign(_, a, b) => {
                a.each(f);
                b.each(f);
            }
            UppaalExprKind::Choice(a, b, c) => {
                a.each(f);
                b.each(f);
                c.each(f);
            }
            UppaalExprKind::Call(of, args) => {
                of.each(f);
                args.iter().for_each(|a| a.each(f));
            }
        }
    }
}

impl UppaalStatement {
    /// Nothing goes on after it.
    pub fn returns(&self) -> bool {
        match &self.kind {
            UppaalStatementKind::Return(_) => true,
            UppaalStatementKind::Block(all) => all.last().is_some_and(UppaalStatement::returns),
            UppaalStatementKind::If(_, then, otherwise) => {
                then.returns() && otherwise.as_ref().is_some_and(|otherwise| otherwise.returns())
            }
            UppaalStatementKind::Decl(_)
            | UppaalStatementKind::Expr(_)
            | UppaalStatementKind::While(..)
            | UppaalStatementKind::DoWhile(..)
            | UppaalStatementKind::For(..)
            | UppaalStatementKind::ForRange(..)
            | UppaalStatementKind::Empty => false,
        }
    }

    /// Calls `f` with every expression in it.
    pub fn each(&self, f: &mut dyn FnMut(&UppaalExpr)) {
        match &self.kind {
            UppaalStatementKind::Expr(e) | UppaalStatementKind::Return(Some(e)) => e.each(f),
            UppaalStatementKind::Block(all) => all.iter().for_each(|s| s.each(f)),
            UppaalStatementKind::If(c, then, otherwise) => {
                c.each(f);
                then.each(f);
                otherwise.iter().for_each(|s| s.each(f));
            }
            UppaalStatementKind::While(c, body) | UppaalStatementKind::DoWhile(body, c) => {
                c.each(f);
                body.each(f);
            }
            UppaalStatementKind::For(init, c, step, body) => {
                init.iter().chain(c).chain(step).for_each(|e| e.each(f));
                body.each(f);
            }
            UppaalStatementKind::ForRange(_, _, body) => body.each(f),
            UppaalStatementKind::Decl(_) | UppaalStatementKind::Return(None) | UppaalStatementKind::Empty => {
            }
        }
    }
}
