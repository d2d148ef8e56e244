//! What the grammar's actions build nodes with: the text, the doc comments, and a place for diagnostics.

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};

use crate::ast::{
    AccessSyntax, AgentMember, AutomatonMember, AutomatonMemberKind, BinSyntax, BinaryOp, BindingEntry,
    BindingMember, BodySyntax, CallSyntax, ChannelSyntax, ChannelSyntaxKind, CrossMember, DeviceMember,
    EdgeAction, EdgeSyntax, EventName, ExprSyntax, ExprSyntaxKind, InstanceSyntax, ItemSyntaxKind,
    LiteralSyntax, NameSyntax, ParamSyntax, ParticipantSyntax, PathSyntax, PlaceSyntax, RangeSyntax,
    StatementSyntax, StepSyntax, StepSyntaxKind, StimulusStepSyntax, SuiteMember, SystemMember,
    TemplateSyntaxKind, TestMember, TextSyntax, TurnSyntax, TypeExpr, UnaryOp, WorldMember,
};
use crate::token::Lexeme;

/// What one run of the parser gives.
pub(crate) enum ParsedUnit {
    Item(ItemSyntaxKind),
    StimulusStepSyntax(StimulusStepSyntax),
    AgentMember(AgentMember),
    Step(StepSyntax),
    Statement(StatementSyntax),
    AutomatonMember(AutomatonMember),
    CrossMember(CrossMember),
    SuiteMember(SuiteMember),
    TestMember(TestMember),
    WorldMember(WorldMember),
    DeviceMember(DeviceMember),
    SystemMember(SystemMember),
    BindingMember(BindingMember),
    BindingEntry(BindingEntry),
}

/// What a symbol of the grammar leaves in a list: large nodes are boxed until then.
pub(crate) trait GrammarNode {
    type NodeOutput;
    fn out(self) -> Self::NodeOutput;
}

pub(crate) type NodeOutput<T> = <T as GrammarNode>::NodeOutput;

impl<T> GrammarNode for Box<T> {
    type NodeOutput = T;

    fn out(self) -> T {
        *self
    }
}

macro_rules! small {
    ($($node:ty),*) => {$(
        impl GrammarNode for $node {
            type NodeOutput = Self;

            fn out(self) -> Self {
                self
            }
        }
    )*};
}

small!(
    NameSyntax,
    PathSyntax,
    TextSyntax,
    CallSyntax,
    LiteralSyntax,
    ExprSyntax,
    AccessSyntax,
    ParticipantSyntax
);

/// One of the parts of an edge that may come in any order.
pub(crate) enum EdgePart {
    Select(Vec<ParamSyntax>),
    When(ExprSyntax, Span),
    On(CallSyntax, Span),
}

/// One of the properties of a body that may come in any order.
pub(crate) enum BodyPart {
    Rotated(ExprSyntax, Span),
    Facing(PathSyntax, Span),
    Mass(ExprSyntax, Span),
    Stiffness(ExprSyntax, Span),
    Ghost(Span),
    Graspable(Span),
}

/// One file, while it is parsed.
pub(crate) struct ParseContext<'t> {
    pub file: FileId,
    pub text: &'t str,
    /// By the start of the token that they stand before, in order.
    pub docs: &'t [(u32, String)],
    pub diagnostics: Vec<Diagnostic>,
}

impl<'t> ParseContext<'t> {
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

    pub(crate) fn name(&self, token: Lexeme) -> NameSyntax {
        NameSyntax { text: self.text_of(token).to_owned(), span: self.span_of(token) }
    }

    pub(crate) fn path(&self, names: Vec<NameSyntax>) -> PathSyntax {
        let span = match names.as_slice() {
            [] => self.span(0, 0),
            [only] => only.span,
            [first, .., last] => first.span.to(last.span),
        };
        PathSyntax { names, span }
    }

    /// A string without its quotes, escapes resolved; of an unknown escape the character stays.
    pub(crate) fn string(&self, token: Lexeme) -> TextSyntax {
        let raw = self.text_of(token);
        let inner = raw.strip_prefix('"').unwrap_or(raw);
        let span = self.span_of(token);
        if !inner.contains('\\') {
            return TextSyntax { text: inner.strip_suffix('"').unwrap_or(inner).to_owned(), span };
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
        TextSyntax { text, span }
    }

    pub(crate) fn call(&self, name: NameSyntax, args: Option<Vec<ExprSyntax>>, end: u32) -> CallSyntax {
        let span = self.span(name.span.start, end);
        CallSyntax { name, args, span }
    }

    pub(crate) fn range(&self, lo: ExprSyntax, hi: ExprSyntax) -> RangeSyntax {
        let span = lo.span.to(hi.span);
        RangeSyntax { lo, hi: Some(hi), span }
    }

    // ── Expressions ──

    pub(crate) fn leaf(&self, token: Lexeme, kind: ExprSyntaxKind) -> ExprSyntax {
        ExprSyntax { kind, span: self.span_of(token) }
    }

    pub(crate) fn int(&self, token: Lexeme) -> ExprSyntax {
        // The lexer has checked that it fits.
        self.leaf(token, self.text_of(token).parse().map_or(ExprSyntaxKind::Error, ExprSyntaxKind::Int))
    }

    pub(crate) fn float(&self, token: Lexeme) -> ExprSyntax {
        self.leaf(token, self.text_of(token).parse().map_or(ExprSyntaxKind::Error, ExprSyntaxKind::Float))
    }

    pub(crate) fn quantity(&self, token: Lexeme) -> ExprSyntax {
        let number = self.slice(token.start, token.unit).trim_end();
        let unit = NameSyntax {
            text: self.slice(token.unit, token.end).to_owned(),
            span: self.span(token.unit, token.end),
        };
        self.leaf(
            token,
            number.parse().map_or(ExprSyntaxKind::Error, |number| ExprSyntaxKind::Quantity { number, unit }),
        )
    }

    pub(crate) fn path_expr(&self, path: PathSyntax) -> ExprSyntax {
        let span = path.span;
        ExprSyntax { kind: ExprSyntaxKind::Path(path), span }
    }

    pub(crate) fn call_expr(&self, callee: PathSyntax, args: Vec<ExprSyntax>, end: u32) -> ExprSyntax {
        let span = self.span(callee.span.start, end);
        ExprSyntax { kind: ExprSyntaxKind::Call { callee, args }, span }
    }

    pub(crate) fn index(&self, of: ExprSyntax, index: ExprSyntax, end: u32) -> ExprSyntax {
        let span = self.span(of.span.start, end);
        ExprSyntax { kind: ExprSyntaxKind::Index { of: Box::new(of), index: Box::new(index) }, span }
    }

    pub(crate) fn annotated(&self, of: ExprSyntax, annotations: Vec<ExprSyntax>, end: u32) -> ExprSyntax {
        let span = self.span(of.span.start, end);
        ExprSyntax { kind: ExprSyntaxKind::Annotated { of: Box::new(of), annotations }, span }
    }

    pub(crate) fn list(
        &self,
        start: u32,
        items: Vec<ExprSyntax>,
        rest: Option<ExprSyntax>,
        end: u32,
    ) -> ExprSyntax {
        let kind = ExprSyntaxKind::List { items, rest: rest.map(Box::new) };
        ExprSyntax { kind, span: self.span(start, end) }
    }

    /// The dot belongs to the call's span.
    pub(crate) fn internal(
        &self,
        start: u32,
        name: NameSyntax,
        args: Option<Vec<ExprSyntax>>,
        end: u32,
    ) -> CallSyntax {
        CallSyntax { name, args, span: self.span(start, end) }
    }

    pub(crate) fn internal_expr(
        &self,
        start: u32,
        name: NameSyntax,
        args: Option<Vec<ExprSyntax>>,
        end: u32,
    ) -> ExprSyntax {
        let call = self.internal(start, name, args, end);
        ExprSyntax { span: call.span, kind: ExprSyntaxKind::Internal(call) }
    }

    pub(crate) fn strong(&self, start: u32, of: ExprSyntax) -> ExprSyntax {
        let span = self.span(start, of.span.end);
        ExprSyntax { kind: ExprSyntaxKind::Strong(Box::new(of)), span }
    }

    pub(crate) fn unify(&self, left: ExprSyntax, right: ExprSyntax) -> ExprSyntax {
        let span = left.span.to(right.span);
        ExprSyntax { kind: ExprSyntaxKind::Unify { left: Box::new(left), right: Box::new(right) }, span }
    }

    pub(crate) fn name_expr(&self, name: NameSyntax) -> ExprSyntax {
        self.path_expr(self.path(vec![name]))
    }

    pub(crate) fn fork(
        &self,
        first: Vec<StepSyntax>,
        mut rest: Vec<Vec<StepSyntax>>,
        all: bool,
    ) -> StepSyntaxKind {
        rest.insert(0, first);
        StepSyntaxKind::Fork { all, branches: rest }
    }

    pub(crate) fn field(&self, of: ExprSyntax, name: NameSyntax) -> ExprSyntax {
        let span = of.span.to(name.span);
        ExprSyntax { kind: ExprSyntaxKind::Field { of: Box::new(of), name }, span }
    }

    /// A type that was read as an expression: `bool`, `bool[4]`.
    pub(crate) fn type_of(&mut self, expr: ExprSyntax) -> TypeExpr {
        match expr.kind {
            ExprSyntaxKind::Path(mut path) if path.names.len() == 1 => match path.names.pop() {
                Some(name) => TypeExpr::Named(name),
                None => TypeExpr::Error,
            },
            ExprSyntaxKind::Index { of, index } => TypeExpr::Array(Box::new(self.type_of(*of)), *index),
            ExprSyntaxKind::List { mut items, rest: None } if items.len() == 1 => match items.pop() {
                Some(item) => TypeExpr::List(Box::new(self.type_of(item))),
                None => TypeExpr::Error,
            },
            ExprSyntaxKind::Error => TypeExpr::Error,
            _ => {
                self.diagnostics.push(Diagnostic::error(DiagnosticCode::SYNTAX, expr.span, "expected a type").help(
                    "a type is a name such as `bool` or `length`, a range `0..4`, an array `bool[4]`, or a list `[0..4]`",
                ));
                TypeExpr::Error
            }
        }
    }

    pub(crate) fn instance(
        &self,
        sort: TemplateSyntaxKind,
        name: NameSyntax,
        of: NameSyntax,
        args: Vec<ExprSyntax>,
        end: u32,
    ) -> ItemSyntaxKind {
        let span = self.span(of.span.start, end);
        ItemSyntaxKind::Instance(InstanceSyntax { sort, name, of, args, span })
    }

    /// `(e)`: the parentheses are in the span and leave no other trace.
    pub(crate) fn group(&self, start: u32, expr: ExprSyntax, end: u32) -> ExprSyntax {
        ExprSyntax { span: self.span(start, end), ..expr }
    }

    pub(crate) fn tuple(
        &self,
        start: u32,
        first: ExprSyntax,
        mut rest: Vec<ExprSyntax>,
        end: u32,
    ) -> ExprSyntax {
        rest.insert(0, first);
        ExprSyntax { kind: ExprSyntaxKind::Tuple(rest), span: self.span(start, end) }
    }

    pub(crate) fn unary(&self, op: UnaryOp, start: u32, operand: ExprSyntax) -> ExprSyntax {
        let span = self.span(start, operand.span.end);
        ExprSyntax { kind: ExprSyntaxKind::Unary { op, operand: Box::new(operand) }, span }
    }

    pub(crate) fn binary(&self, op: BinaryOp, left: ExprSyntax, right: ExprSyntax) -> ExprSyntax {
        let span = left.span.to(right.span);
        ExprSyntax { kind: ExprSyntaxKind::Binary { op, left: Box::new(left), right: Box::new(right) }, span }
    }

    /// `not left or right`
    pub(crate) fn imply(&self, left: ExprSyntax, right: ExprSyntax) -> ExprSyntax {
        let span = left.span;
        let left =
            ExprSyntax { kind: ExprSyntaxKind::Unary { op: UnaryOp::Not, operand: Box::new(left) }, span };
        self.binary(BinaryOp::Or, left, right)
    }

    pub(crate) fn channel(
        &self,
        names: Vec<EventName>,
        kind: Option<(bool, ChannelSyntaxKind)>,
    ) -> ChannelSyntax {
        let (urgent, kind) = kind.unwrap_or((false, ChannelSyntaxKind::Binary));
        ChannelSyntax { names, urgent, kind }
    }

    pub(crate) fn choice(
        &self,
        start: u32,
        condition: ExprSyntax,
        then: ExprSyntax,
        otherwise: ExprSyntax,
        end: u32,
    ) -> ExprSyntax {
        let kind = ExprSyntaxKind::If {
            condition: Box::new(condition),
            then: Box::new(then),
            otherwise: Box::new(otherwise),
        };
        ExprSyntax { kind, span: self.span(start, end) }
    }

    // ── Nodes whose parts come in any order ──

    pub(crate) fn edge(&mut self, from: NameSyntax, to: NameSyntax, parts: Vec<EdgePart>) -> EdgeSyntax {
        let mut edge =
            EdgeSyntax { from, to, selects: Vec::new(), guard: None, on: None, actions: Vec::new() };
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
    pub(crate) fn do_edge(&self, start: u32, edge: EdgeSyntax, actions: Vec<EdgeAction>) -> AutomatonMember {
        let end = actions.last().map_or(start, |action| action.span.end);
        AutomatonMember {
            doc: self.doc(start),
            kind: AutomatonMemberKind::Edge(EdgeSyntax { actions, ..edge }),
            span: self.span(start, end),
        }
    }

    pub(crate) fn body(
        &mut self,
        (name, motion, shape): (NameSyntax, NameSyntax, NameSyntax),
        sizes: Vec<ExprSyntax>,
        place: Box<PlaceSyntax>,
        parts: Vec<BodyPart>,
    ) -> BodySyntax {
        let (turn, mass, stiffness, ghost, graspable) = (None, None, None, false, false);
        let mut body =
            BodySyntax { name, motion, shape, sizes, place, turn, mass, stiffness, ghost, graspable };
        for part in parts {
            match part {
                BodyPart::Rotated(expr, span) => {
                    self.once(body.turn.is_none(), "`rotated` or `facing`", "a body", span);
                    body.turn.get_or_insert(TurnSyntax::Rotated(expr));
                }
                BodyPart::Facing(path, span) => {
                    self.once(body.turn.is_none(), "`rotated` or `facing`", "a body", span);
                    body.turn.get_or_insert(TurnSyntax::Facing(path));
                }
                BodyPart::Mass(expr, span) => {
                    self.once(body.mass.is_none(), "`mass`", "a body", span);
                    body.mass.get_or_insert(expr);
                }
                BodyPart::Stiffness(expr, span) => {
                    self.once(body.stiffness.is_none(), "`stiffness`", "a body", span);
                    body.stiffness.get_or_insert(expr);
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

    pub(crate) fn bin(
        &self,
        name: NameSyntax,
        lo: ExprSyntax,
        hi: Option<ExprSyntax>,
        open: bool,
        end: u32,
    ) -> BinSyntax {
        let span = self.span(name.span.start, end);
        BinSyntax { name, lo, hi, open, span }
    }
}
