//! What the grammar's actions build nodes with: the text, the doc comments, and a place for diagnostics.

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};

use crate::ast::{
    Access, AgentMember, AutomatonMember, AutomatonMemberKind, Bin, BinaryOp, Body, Call, Channel,
    ChannelKind, CrossMember, DeviceMember, Edge, EdgeAction, EventName, Expr, ExprKind, Instance, ItemKind,
    Literal, Name, Param, Party, Path, Range, Sort, Statement, Step, StepKind, StimulusStep, SuiteMember,
    SystemMember, TestMember, Text, TypeExpr, UnaryOp, WorldMember,
};
use crate::token::Lexeme;

/// What one run of the parser gives.
pub(crate) enum Unit {
    Item(ItemKind),
    StimulusStep(StimulusStep),
    AgentMember(AgentMember),
    Step(Step),
    Statement(Statement),
    AutomatonMember(AutomatonMember),
    CrossMember(CrossMember),
    SuiteMember(SuiteMember),
    TestMember(TestMember),
    WorldMember(WorldMember),
    DeviceMember(DeviceMember),
    SystemMember(SystemMember),
}

/// What a symbol of the grammar leaves in a list: large nodes are boxed until then.
pub(crate) trait Node {
    type Out;
    fn out(self) -> Self::Out;
}

pub(crate) type Out<T> = <T as Node>::Out;

impl<T> Node for Box<T> {
    type Out = T;

    fn out(self) -> T {
        *self
    }
}

macro_rules! small {
    ($($node:ty),*) => {$(
        impl Node for $node {
            type Out = Self;

            fn out(self) -> Self {
                self
            }
        }
    )*};
}

small!(Name, Path, Text, Call, Literal, Expr, Access, Party);

/// One of the parts of an edge that may come in any order.
pub(crate) enum EdgePart {
    Select(Vec<Param>),
    When(Expr, Span),
    On(Call, Span),
}

/// One of the properties of a body that may come in any order.
pub(crate) enum BodyPart {
    Rotated(Expr, Span),
    Mass(Expr, Span),
    Ghost(Span),
    Graspable(Span),
}

/// One file, while it is parsed.
pub(crate) struct Context<'t> {
    pub file: FileId,
    pub text: &'t str,
    /// By the start of the token that they stand before, in order.
    pub docs: &'t [(u32, String)],
    pub diagnostics: Vec<Diagnostic>,
}

impl<'t> Context<'t> {
    pub(crate) fn span(&self, start: u32, end: u32) -> Span {
        Span { file: self.file, start, end: end.max(start) }
    }

    pub(crate) fn span_of(&self, token: Lexeme) -> Span {
        self.span(token.start, token.end)
    }

    /// The text of a token.
    pub(crate) fn text_of(&self, token: Lexeme) -> &'t str {
        self.slice(token.start, token.end)
    }

    fn slice(&self, start: u32, end: u32) -> &'t str {
        self.text.get(start as usize..end as usize).unwrap_or("")
    }

    /// The doc comment before the token that starts here.
    pub(crate) fn doc(&self, start: u32) -> String {
        match self.docs.binary_search_by_key(&start, |doc| doc.0) {
            Ok(at) => self.docs[at].1.clone(),
            Err(_) => String::new(),
        }
    }

    pub(crate) fn name(&self, token: Lexeme) -> Name {
        Name { text: self.text_of(token).to_owned(), span: self.span_of(token) }
    }

    pub(crate) fn path(&self, names: Vec<Name>) -> Path {
        let span = match names.as_slice() {
            [] => self.span(0, 0),
            [only] => only.span,
            [first, .., last] => first.span.to(last.span),
        };
        Path { names, span }
    }

    /// A string without its quotes, escapes resolved; of an unknown escape the character stays.
    pub(crate) fn string(&self, token: Lexeme) -> Text {
        let raw = self.text_of(token);
        let inner = raw.strip_prefix('"').unwrap_or(raw);
        let span = self.span_of(token);
        if !inner.contains('\\') {
            return Text { text: inner.strip_suffix('"').unwrap_or(inner).to_owned(), span };
        }
        let mut text = String::with_capacity(inner.len());
        let mut chars = inner.chars();
        while let Some(c) = chars.next() {
            match c {
                '\\' => match chars.next() {
                    Some('n') => text.push('\n'),
                    Some(other) => text.push(other),
                    None => {}
                },
                '"' => break,
                other => text.push(other),
            }
        }
        Text { text, span }
    }

    pub(crate) fn call(&self, name: Name, args: Option<Vec<Expr>>, end: u32) -> Call {
        let span = self.span(name.span.start, end);
        Call { name, args, span }
    }

    pub(crate) fn range(&self, lo: Expr, hi: Expr) -> Range {
        let span = lo.span.to(hi.span);
        Range { lo, hi: Some(hi), span }
    }

    // ── Expressions ──

    pub(crate) fn leaf(&self, token: Lexeme, kind: ExprKind) -> Expr {
        Expr { kind, span: self.span_of(token) }
    }

    pub(crate) fn int(&self, token: Lexeme) -> Expr {
        // The lexer has checked that it fits.
        self.leaf(token, self.text_of(token).parse().map_or(ExprKind::Error, ExprKind::Int))
    }

    pub(crate) fn float(&self, token: Lexeme) -> Expr {
        self.leaf(token, self.text_of(token).parse().map_or(ExprKind::Error, ExprKind::Float))
    }

    pub(crate) fn quantity(&self, token: Lexeme) -> Expr {
        let number = self.slice(token.start, token.unit).trim_end();
        let unit = Name {
            text: self.slice(token.unit, token.end).to_owned(),
            span: self.span(token.unit, token.end),
        };
        self.leaf(token, number.parse().map_or(ExprKind::Error, |number| ExprKind::Quantity { number, unit }))
    }

    pub(crate) fn path_expr(&self, path: Path) -> Expr {
        let span = path.span;
        Expr { kind: ExprKind::Path(path), span }
    }

    pub(crate) fn call_expr(&self, callee: Path, args: Vec<Expr>, end: u32) -> Expr {
        let span = self.span(callee.span.start, end);
        Expr { kind: ExprKind::Call { callee, args }, span }
    }

    pub(crate) fn index(&self, of: Expr, index: Expr, end: u32) -> Expr {
        let span = self.span(of.span.start, end);
        Expr { kind: ExprKind::Index { of: Box::new(of), index: Box::new(index) }, span }
    }

    pub(crate) fn annotated(&self, of: Expr, annotations: Vec<Expr>, end: u32) -> Expr {
        let span = self.span(of.span.start, end);
        Expr { kind: ExprKind::Annotated { of: Box::new(of), annotations }, span }
    }

    pub(crate) fn list(&self, start: u32, items: Vec<Expr>, rest: Option<Expr>, end: u32) -> Expr {
        let kind = ExprKind::List { items, rest: rest.map(Box::new) };
        Expr { kind, span: self.span(start, end) }
    }

    /// The dot belongs to the call's span.
    pub(crate) fn internal(&self, start: u32, name: Name, args: Option<Vec<Expr>>, end: u32) -> Call {
        Call { name, args, span: self.span(start, end) }
    }

    pub(crate) fn internal_expr(&self, start: u32, name: Name, args: Option<Vec<Expr>>, end: u32) -> Expr {
        let call = self.internal(start, name, args, end);
        Expr { span: call.span, kind: ExprKind::Internal(call) }
    }

    pub(crate) fn strong(&self, start: u32, of: Expr) -> Expr {
        let span = self.span(start, of.span.end);
        Expr { kind: ExprKind::Strong(Box::new(of)), span }
    }

    pub(crate) fn unify(&self, left: Expr, right: Expr) -> Expr {
        let span = left.span.to(right.span);
        Expr { kind: ExprKind::Unify { left: Box::new(left), right: Box::new(right) }, span }
    }

    pub(crate) fn name_expr(&self, name: Name) -> Expr {
        self.path_expr(self.path(vec![name]))
    }

    pub(crate) fn fork(&self, first: Vec<Step>, mut rest: Vec<Vec<Step>>, all: bool) -> StepKind {
        rest.insert(0, first);
        StepKind::Fork { all, branches: rest }
    }

    pub(crate) fn field(&self, of: Expr, name: Name) -> Expr {
        let span = of.span.to(name.span);
        Expr { kind: ExprKind::Field { of: Box::new(of), name }, span }
    }

    /// A type that was read as an expression: `bool`, `bool[4]`.
    pub(crate) fn type_of(&mut self, expr: Expr) -> TypeExpr {
        match expr.kind {
            ExprKind::Path(mut path) if path.names.len() == 1 => match path.names.pop() {
                Some(name) => TypeExpr::Named(name),
                None => TypeExpr::Error,
            },
            ExprKind::Index { of, index } => TypeExpr::Array(Box::new(self.type_of(*of)), *index),
            ExprKind::List { mut items, rest: None } if items.len() == 1 => match items.pop() {
                Some(item) => TypeExpr::List(Box::new(self.type_of(item))),
                None => TypeExpr::Error,
            },
            ExprKind::Error => TypeExpr::Error,
            _ => {
                self.diagnostics.push(Diagnostic::error(DiagnosticCode::SYNTAX, expr.span, "expected a type").help(
                    "a type is a name such as `bool` or `length`, a range `0..4`, an array `bool[4]`, or a list `[0..4]`",
                ));
                TypeExpr::Error
            }
        }
    }

    pub(crate) fn instance(&self, sort: Sort, name: Name, of: Name, args: Vec<Expr>, end: u32) -> ItemKind {
        let span = self.span(of.span.start, end);
        ItemKind::Instance(Instance { sort, name, of, args, span })
    }

    /// `(e)`: the parentheses are in the span and leave no other trace.
    pub(crate) fn group(&self, start: u32, expr: Expr, end: u32) -> Expr {
        Expr { span: self.span(start, end), ..expr }
    }

    pub(crate) fn tuple(&self, start: u32, first: Expr, mut rest: Vec<Expr>, end: u32) -> Expr {
        rest.insert(0, first);
        Expr { kind: ExprKind::Tuple(rest), span: self.span(start, end) }
    }

    pub(crate) fn unary(&self, op: UnaryOp, start: u32, operand: Expr) -> Expr {
        let span = self.span(start, operand.span.end);
        Expr { kind: ExprKind::Unary { op, operand: Box::new(operand) }, span }
    }

    pub(crate) fn binary(&self, op: BinaryOp, left: Expr, right: Expr) -> Expr {
        let span = left.span.to(right.span);
        Expr { kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(right) }, span }
    }

    /// `not left or right`
    pub(crate) fn imply(&self, left: Expr, right: Expr) -> Expr {
        let span = left.span;
        let left = Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(left) }, span };
        self.binary(BinaryOp::Or, left, right)
    }

    pub(crate) fn channel(&self, names: Vec<EventName>, kind: Option<(bool, ChannelKind)>) -> Channel {
        let (urgent, kind) = kind.unwrap_or((false, ChannelKind::HandShake));
        Channel { names, urgent, kind }
    }

    pub(crate) fn choice(&self, start: u32, condition: Expr, then: Expr, otherwise: Expr, end: u32) -> Expr {
        let kind = ExprKind::If {
            condition: Box::new(condition),
            then: Box::new(then),
            otherwise: Box::new(otherwise),
        };
        Expr { kind, span: self.span(start, end) }
    }

    // ── Nodes whose parts come in any order ──

    pub(crate) fn edge(&mut self, from: Name, to: Name, parts: Vec<EdgePart>) -> Edge {
        let mut edge = Edge { from, to, selects: Vec::new(), guard: None, on: None, actions: Vec::new() };
        for part in parts {
            match part {
                EdgePart::Select(mut params) => edge.selects.append(&mut params),
                EdgePart::When(guard, span) => {
                    self.once(edge.guard.is_none(), "`when`", "an edge", span);
                    edge.guard.get_or_insert(guard);
                }
                EdgePart::On(call, span) => {
                    self.once(edge.on.is_none(), "`on`", "an edge", span);
                    edge.on.get_or_insert(call);
                }
            }
        }
        edge
    }

    /// An edge with actions ends with the last of them; the semicolons after it are not part of it.
    pub(crate) fn do_edge(&self, start: u32, edge: Edge, actions: Vec<EdgeAction>) -> AutomatonMember {
        let end = actions.last().map_or(start, |action| action.span.end);
        AutomatonMember {
            doc: self.doc(start),
            kind: AutomatonMemberKind::Edge(Edge { actions, ..edge }),
            span: self.span(start, end),
        }
    }

    pub(crate) fn body(
        &mut self,
        name: Name,
        motion: Name,
        shape: Name,
        sizes: Vec<Expr>,
        at: Expr,
        parts: Vec<BodyPart>,
    ) -> Body {
        let (rotated, mass, ghost, graspable) = (None, None, false, false);
        let mut body = Body { name, motion, shape, sizes, at, rotated, mass, ghost, graspable };
        for part in parts {
            match part {
                BodyPart::Rotated(expr, span) => {
                    self.once(body.rotated.is_none(), "`rotated`", "a body", span);
                    body.rotated.get_or_insert(expr);
                }
                BodyPart::Mass(expr, span) => {
                    self.once(body.mass.is_none(), "`mass`", "a body", span);
                    body.mass.get_or_insert(expr);
                }
                BodyPart::Ghost(span) => {
                    self.once(!body.ghost, "`ghost`", "a body", span);
                    body.ghost = true;
                }
                BodyPart::Graspable(span) => {
                    self.once(!body.graspable, "`graspable`", "a body", span);
                    body.graspable = true;
                }
            }
        }
        body
    }

    fn once(&mut self, first: bool, what: &str, of: &str, span: Span) {
        if !first {
            self.diagnostics.push(
                Diagnostic::error(DiagnosticCode::SYNTAX, span, format!("{of} has one {what} at most"))
                    .here("the second")
                    .help("join the two, or take one away"),
            );
        }
    }

    pub(crate) fn bin(&self, name: Name, lo: Expr, hi: Option<Expr>, open: bool, end: u32) -> Bin {
        let span = self.span(name.span.start, end);
        Bin { name, lo, hi, open, span }
    }
}
