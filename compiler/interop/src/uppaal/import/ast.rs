//! UPPAAL's declarations, statements and expressions, as they are written.

use hrdsl_source::Span;

#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
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
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantifier {
    Forall,
    Exists,
    Sum,
}

#[derive(Clone, Debug)]
pub enum ExprKind {
    Int(i64),
    Bool(bool),
    Name(String),
    Neg(Box<Expr>),
    Not(Box<Expr>),
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    Choice(Box<Expr>, Box<Expr>, Box<Expr>),
    Index(Box<Expr>, Box<Expr>),
    Call(Box<Expr>, Vec<Expr>),
    Field(Box<Expr>, String),
    /// `a op= b`; no operator: `a = b`
    Assign(Option<BinaryOp>, Box<Expr>, Box<Expr>),
    /// `++` and `--`, before or after.
    Step {
        up: bool,
        of: Box<Expr>,
    },
    Quantified(Quantifier, String, Box<Type>, Box<Expr>),
    /// `x'`
    Rate,
    Deadlock,
}

#[derive(Clone, Debug)]
pub struct Type {
    pub constant: bool,
    pub urgent: bool,
    pub broadcast: bool,
    pub base: Base,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Base {
    Int(Option<Box<(Expr, Expr)>>),
    Bool,
    Clock,
    Chan,
    Void,
    Named(String),
}

/// One dimension of an array: so many, or one for each value of a type.
#[derive(Clone, Debug)]
pub enum Dim {
    Size(Expr),
    Of(Type),
}

#[derive(Clone, Debug)]
pub enum Init {
    One(Expr),
    List(Vec<Init>, Span),
}

#[derive(Clone, Debug)]
pub struct Declarator {
    pub name: String,
    pub span: Span,
    pub dims: Vec<Dim>,
    pub init: Option<Init>,
}

#[derive(Clone, Debug)]
pub struct Param {
    pub ty: Type,
    pub by_reference: bool,
    pub name: String,
    pub dims: Vec<Dim>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Function {
    pub ty: Type,
    pub name: String,
    pub params: Vec<Param>,
    pub body: Vec<Statement>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Decl {
    Vars(Type, Vec<Declarator>),
    Typedef(Type, Declarator),
    Function(Function),
    /// `name(params) = of(args);`
    Instance(Instance),
    /// `system A, B;`
    System(Vec<(String, Span)>),
}

#[derive(Clone, Debug)]
pub struct Instance {
    pub name: String,
    pub params: Vec<Param>,
    pub of: String,
    pub args: Vec<Expr>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Statement {
    pub kind: StatementKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum StatementKind {
    Decl(Decl),
    Expr(Expr),
    Block(Vec<Statement>),
    If(Expr, Box<Statement>, Option<Box<Statement>>),
    While(Expr, Box<Statement>),
    DoWhile(Box<Statement>, Expr),
    For(Vec<Expr>, Option<Expr>, Vec<Expr>, Box<Statement>),
    ForRange(String, Type, Box<Statement>),
    Return(Option<Expr>),
    Empty,
}

/// `c[i]!`
#[derive(Clone, Debug)]
pub struct Sync {
    pub channel: Expr,
    pub offers: bool,
}

#[derive(Clone, Debug)]
pub struct Select {
    pub name: String,
    pub ty: Type,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Ask {
    Possibly(Expr),
    Invariantly(Expr),
    PotentiallyAlways(Expr),
    Eventually(Expr),
    LeadsTo(Expr, Expr),
    Sup(Option<Expr>, Vec<Expr>),
    Inf(Option<Expr>, Vec<Expr>),
}

impl Expr {
    /// The name at the bottom of a chain of indices and fields.
    pub fn root(&self) -> Option<&str> {
        match &self.kind {
            ExprKind::Name(name) => Some(name),
            ExprKind::Index(of, _) | ExprKind::Field(of, _) => of.root(),
            ExprKind::Int(_)
            | ExprKind::Bool(_)
            | ExprKind::Neg(_)
            | ExprKind::Not(_)
            | ExprKind::Binary(..)
            | ExprKind::Choice(..)
            | ExprKind::Call(..)
            | ExprKind::Assign(..)
            | ExprKind::Step { .. }
            | ExprKind::Quantified(..)
            | ExprKind::Rate
            | ExprKind::Deadlock => None,
        }
    }

    /// Calls `f` with it and every expression in it.
    pub fn each(&self, f: &mut dyn FnMut(&Expr)) {
        f(self);
        match &self.kind {
            ExprKind::Int(_)
            | ExprKind::Bool(_)
            | ExprKind::Name(_)
            | ExprKind::Rate
            | ExprKind::Deadlock => {}
            ExprKind::Neg(a) | ExprKind::Not(a) | ExprKind::Field(a, _) | ExprKind::Step { of: a, .. } => {
                a.each(f);
            }
            ExprKind::Quantified(_, _, _, a) => a.each(f),
            ExprKind::Binary(_, a, b) | ExprKind::Index(a, b) | ExprKind::Assign(_, a, b) => {
                a.each(f);
                b.each(f);
            }
            ExprKind::Choice(a, b, c) => {
                a.each(f);
                b.each(f);
                c.each(f);
            }
            ExprKind::Call(of, args) => {
                of.each(f);
                args.iter().for_each(|a| a.each(f));
            }
        }
    }
}

impl Statement {
    /// Calls `f` with every expression in it.
    pub fn each(&self, f: &mut dyn FnMut(&Expr)) {
        match &self.kind {
            StatementKind::Expr(e) | StatementKind::Return(Some(e)) => e.each(f),
            StatementKind::Block(all) => all.iter().for_each(|s| s.each(f)),
            StatementKind::If(c, then, otherwise) => {
                c.each(f);
                then.each(f);
                otherwise.iter().for_each(|s| s.each(f));
            }
            StatementKind::While(c, body) | StatementKind::DoWhile(body, c) => {
                c.each(f);
                body.each(f);
            }
            StatementKind::For(init, c, step, body) => {
                init.iter().chain(c).chain(step).for_each(|e| e.each(f));
                body.each(f);
            }
            StatementKind::ForRange(_, _, body) => body.each(f),
            StatementKind::Decl(_) | StatementKind::Return(None) | StatementKind::Empty => {}
        }
    }
}
