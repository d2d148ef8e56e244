//! Tokens to declarations, statements and expressions.

use hrdsl_source::Span;

use super::{
    Fault,
    ast::{
        Base, BinaryOp, Decl, Declarator, Dim, Expr, ExprKind, Function, Init, Instance, Param, Quantifier,
        Select, Statement, StatementKind, Sync, Type,
    },
    lex::{Piece, Tok, Token, lex},
};

/// How deep expressions and statements may be nested.
const MAX_DEPTH: usize = 60;

/// How many operators an expression may have.
const MAX_OPERATORS: usize = 600;

type Parsed<T> = Result<T, Fault>;

pub struct Parser {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
    /// Operators of the expression that is being read: they are as high as the expression can be.
    operators: usize,
}

/// Words of declarations that mean things no scenario has.
const UNSUPPORTED: &[(&str, &str)] = &[
    ("scalar", "scalar sets (`scalar[n]`)"),
    ("struct", "records (`struct`)"),
    ("double", "numbers with a fraction (`double`)"),
    ("string", "texts (`string`)"),
    ("meta", "`meta` variables"),
    ("hybrid", "hybrid clocks (`hybrid`)"),
    ("dynamic", "dynamic templates (`dynamic`)"),
    ("spawn", "dynamic templates (`spawn`)"),
    ("gantt", "Gantt charts (`gantt`)"),
    ("progress", "progress measures (`progress`)"),
    ("before_update", "`before_update`"),
    ("after_update", "`after_update`"),
    ("import", "functions of libraries (`import`)"),
    ("switch", "`switch`"),
    ("break", "`break`"),
    ("continue", "`continue`"),
    ("assert", "`assert`"),
    ("priority", "priorities of channels (`chan priority`)"),
];

impl Parser {
    pub fn new(piece: &Piece) -> Parsed<Self> {
        Ok(Self { tokens: lex(piece)?, at: 0, depth: 0, operators: 0 })
    }

    // ── Tokens ──

    fn peek(&self) -> &Tok {
        self.ahead(0)
    }

    fn ahead(&self, n: usize) -> &Tok {
        self.tokens.get(self.at + n).map_or(&Tok::End, |t| &t.tok)
    }

    fn span(&self) -> Span {
        self.tokens.get(self.at).or(self.tokens.last()).map_or_else(Span::default, |t| t.span)
    }

    /// The span of the token before.
    fn last(&self) -> Span {
        self.at.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or_else(|| self.span(), |t| t.span)
    }

    fn next(&mut self) {
        self.at = (self.at + 1).min(self.tokens.len().saturating_sub(1));
    }

    fn is(&self, mark: &str) -> bool {
        matches!(self.peek(), Tok::Mark(m) if *m == mark)
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Tok::Word(w) if w == word)
    }

    fn take(&mut self, mark: &str) -> bool {
        let found = self.is(mark);
        if found {
            self.next();
        }
        found
    }

    fn take_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.next();
        }
        found
    }

    fn fault(&self, expected: &str) -> Fault {
        let message = format!("expected {expected}, found {}", self.peek().shown());
        Fault { span: self.span(), message }
    }

    fn expect(&mut self, mark: &str) -> Parsed<()> {
        if self.take(mark) { Ok(()) } else { Err(self.fault(&format!("`{mark}`"))) }
    }

    fn name(&mut self, what: &str) -> Parsed<(String, Span)> {
        self.supported()?;
        match self.peek() {
            Tok::Word(w) if !is_keyword(w) => {
                let out = (w.clone(), self.span());
                self.next();
                Ok(out)
            }
            Tok::Word(_) | Tok::Int(_) | Tok::Mark(_) | Tok::End => Err(self.fault(what)),
        }
    }

    /// Nothing follows.
    pub fn end(&self) -> Parsed<()> {
        if *self.peek() == Tok::End { Ok(()) } else { Err(self.fault("the end")) }
    }

    pub fn at_end(&self) -> bool {
        *self.peek() == Tok::End
    }

    fn supported(&self) -> Parsed<()> {
        let Tok::Word(word) = self.peek() else { return Ok(()) };
        match UNSUPPORTED.iter().find(|(w, _)| w == word) {
            Some((_, what)) => Err(unsupported(self.span(), what)),
            None => Ok(()),
        }
    }

    fn deeper<T>(&mut self, parse: impl FnOnce(&mut Self) -> Parsed<T>) -> Parsed<T> {
        if self.depth == MAX_DEPTH {
            return Err(Fault { span: self.span(), message: "this is nested too deeply".to_owned() });
        }
        self.depth += 1;
        let out = parse(self);
        self.depth -= 1;
        out
    }

    // ── Declarations ──

    /// Declarations up to the end of the piece; those of the system, too.
    pub fn declarations(&mut self) -> Parsed<Vec<Decl>> {
        let mut all = Vec::new();
        while !self.at_end() {
            if !self.take(";") {
                all.push(self.declaration()?);
            }
        }
        Ok(all)
    }

    fn declaration(&mut self) -> Parsed<Decl> {
        self.supported()?;
        if self.take_word("typedef") {
            let ty = self.ty()?;
            let declarator = self.declarator()?;
            self.expect(";")?;
            return Ok(Decl::Typedef(ty, declarator));
        }
        if self.take_word("system") {
            return self.system();
        }
        if matches!((self.peek(), self.ahead(1)), (Tok::Word(_), Tok::Mark("=" | ":=" | "("))) {
            return self.instance();
        }
        let start = self.span();
        let ty = self.ty()?;
        if self.is_word("priority") {
            return Err(unsupported(self.span(), "priorities of channels (`chan priority`)"));
        }
        if matches!((self.peek(), self.ahead(1)), (Tok::Word(_), Tok::Mark("("))) {
            let (name, _) = self.name("a name")?;
            let params = self.params_in_parentheses()?;
            let body = self.block()?;
            return Ok(Decl::Function(Function { ty, name, params, body, span: start.to(self.last()) }));
        }
        let mut declarators = vec![self.declarator()?];
        while self.take(",") {
            declarators.push(self.declarator()?);
        }
        self.expect(";")?;
        Ok(Decl::Vars(ty, declarators))
    }

    fn system(&mut self) -> Parsed<Decl> {
        let mut names = vec![self.name("a process")?];
        while !self.take(";") {
            if self.is("<") {
                return Err(unsupported(self.span(), "priorities of processes (`<` in `system`)"));
            }
            self.expect(",")?;
            names.push(self.name("a process")?);
        }
        Ok(Decl::System(names))
    }

    fn instance(&mut self) -> Parsed<Decl> {
        let (name, span) = self.name("the name of a process")?;
        let params = if self.is("(") { self.params_in_parentheses()? } else { Vec::new() };
        if !self.take(":=") {
            self.expect("=")?;
        }
        let (of, _) = self.name("the name of a template")?;
        self.expect("(")?;
        let args = self.list(")")?;
        self.expect(")")?;
        self.expect(";")?;
        Ok(Decl::Instance(Instance { name, params, of, args, span }))
    }

    fn ty(&mut self) -> Parsed<Type> {
        let span = self.span();
        let (mut constant, mut urgent, mut broadcast) = (false, false, false);
        loop {
            if self.take_word("const") {
                constant = true;
            } else if self.take_word("urgent") {
                urgent = true;
            } else if self.take_word("broadcast") {
                broadcast = true;
            } else {
                break;
            }
        }
        self.supported()?;
        // `const N 5;` of the old language has no type.
        let untyped = constant
            && matches!(
                (self.peek(), self.ahead(1)),
                (Tok::Word(_), Tok::Int(_) | Tok::Mark("=" | ":=" | "-"))
            );
        let base = if untyped { Base::Int(None) } else { self.base()? };
        Ok(Type { constant, urgent, broadcast, base, span: span.to(self.last()) })
    }

    fn base(&mut self) -> Parsed<Base> {
        let Tok::Word(word) = self.peek().clone() else { return Err(self.fault("a type")) };
        let base = match word.as_str() {
            "int" => {
                self.next();
                return Ok(Base::Int(if self.take("[") { Some(Box::new(self.bounds()?)) } else { None }));
            }
            "bool" => Base::Bool,
            "clock" => Base::Clock,
            "chan" => Base::Chan,
            "void" => Base::Void,
            w if is_keyword(w) => return Err(self.fault("a type")),
            _ => Base::Named(word),
        };
        self.next();
        Ok(base)
    }

    fn bounds(&mut self) -> Parsed<(Expr, Expr)> {
        let lo = self.expr()?;
        self.expect(",")?;
        let hi = self.expr()?;
        self.expect("]")?;
        Ok((lo, hi))
    }

    fn dims(&mut self) -> Parsed<Vec<Dim>> {
        let mut dims = Vec::new();
        while self.take("[") {
            self.supported()?;
            let is_type = self.is_word("int") || self.is_word("bool");
            dims.push(if is_type { Dim::Of(self.ty()?) } else { Dim::Size(self.expr()?) });
            self.expect("]")?;
        }
        Ok(dims)
    }

    fn declarator(&mut self) -> Parsed<Declarator> {
        let (name, span) = self.name("a name")?;
        let dims = self.dims()?;
        let old_constant = matches!(self.peek(), Tok::Int(_));
        let init = if self.take("=") || self.take(":=") || old_constant { Some(self.init()?) } else { None };
        Ok(Declarator { name, span, dims, init })
    }

    fn init(&mut self) -> Parsed<Init> {
        let start = self.span();
        if !self.take("{") {
            return Ok(Init::One(self.expr()?));
        }
        self.deeper(|p| {
            let mut all = Vec::new();
            while !p.is("}") {
                if matches!((p.peek(), p.ahead(1)), (Tok::Word(_), Tok::Mark(":"))) {
                    return Err(unsupported(p.span(), "records (`struct`)"));
                }
                all.push(p.init()?);
                if !p.take(",") {
                    break;
                }
            }
            p.expect("}")?;
            Ok(Init::List(all, start.to(p.last())))
        })
    }

    fn params_in_parentheses(&mut self) -> Parsed<Vec<Param>> {
        self.expect("(")?;
        let params = self.params(")")?;
        self.expect(")")?;
        Ok(params)
    }

    /// Parameters up to a mark, or to the end.
    pub fn params(&mut self, close: &str) -> Parsed<Vec<Param>> {
        let mut params: Vec<Param> = Vec::new();
        while !self.at_end() && !self.is(close) {
            // `int a, b` of the old language repeats no type.
            let repeats = matches!(
                (self.peek(), self.ahead(1)),
                (Tok::Word(w), Tok::Mark("," | ";" | ")") | Tok::End) if !is_keyword(w)
            );
            let before = params.last().filter(|_| repeats).map(|p| (p.ty.clone(), p.by_reference));
            let ty = match &before {
                Some((ty, _)) => ty.clone(),
                None => self.ty()?,
            };
            let by_reference = self.take("&") || before.is_some_and(|(_, r)| r);
            let (name, span) = self.name("the name of a parameter")?;
            let dims = self.dims()?;
            params.push(Param { ty, by_reference, name, dims, span });
            if !self.take(",") && !self.take(";") {
                break;
            }
        }
        Ok(params)
    }

    // ── Statements ──

    fn block(&mut self) -> Parsed<Vec<Statement>> {
        self.expect("{")?;
        let mut all = Vec::new();
        while !self.take("}") {
            if self.at_end() {
                return Err(self.fault("`}`"));
            }
            all.push(self.deeper(Self::statement)?);
        }
        Ok(all)
    }

    fn boxed(&mut self) -> Parsed<Box<Statement>> {
        self.deeper(Self::statement).map(Box::new)
    }

    fn statement(&mut self) -> Parsed<Statement> {
        let start = self.span();
        self.supported()?;
        let kind = self.statement_kind()?;
        Ok(Statement { kind, span: start.to(self.last()) })
    }

    fn statement_kind(&mut self) -> Parsed<StatementKind> {
        if self.is("{") {
            return Ok(StatementKind::Block(self.block()?));
        }
        if self.take(";") {
            return Ok(StatementKind::Empty);
        }
        if self.take_word("if") {
            let condition = self.parenthesised()?;
            let then = self.boxed()?;
            let otherwise = if self.take_word("else") { Some(self.boxed()?) } else { None };
            return Ok(StatementKind::If(condition, then, otherwise));
        }
        if self.take_word("while") {
            return Ok(StatementKind::While(self.parenthesised()?, self.boxed()?));
        }
        if self.take_word("do") {
            let body = self.boxed()?;
            if !self.take_word("while") {
                return Err(self.fault("`while`"));
            }
            let condition = self.parenthesised()?;
            self.expect(";")?;
            return Ok(StatementKind::DoWhile(body, condition));
        }
        if self.take_word("for") {
            return self.for_statement();
        }
        if self.take_word("return") {
            let value = if self.is(";") { None } else { Some(self.expr()?) };
            self.expect(";")?;
            return Ok(StatementKind::Return(value));
        }
        let starts_type =
            ["const", "int", "bool", "clock", "chan", "typedef"].iter().any(|w| self.is_word(w));
        if starts_type
            || matches!((self.peek(), self.ahead(1)), (Tok::Word(_), Tok::Word(w)) if !is_keyword(w))
        {
            return Ok(StatementKind::Decl(self.declaration()?));
        }
        let mut all = vec![self.expr()?];
        while self.take(",") {
            all.push(self.expr()?);
        }
        self.expect(";")?;
        Ok(if all.len() == 1 {
            StatementKind::Expr(all.swap_remove(0))
        } else {
            let each = |e: Expr| Statement { span: e.span, kind: StatementKind::Expr(e) };
            StatementKind::Block(all.into_iter().map(each).collect())
        })
    }

    fn for_statement(&mut self) -> Parsed<StatementKind> {
        self.expect("(")?;
        if matches!((self.peek(), self.ahead(1)), (Tok::Word(_), Tok::Mark(":"))) {
            let (name, _) = self.name("a name")?;
            self.expect(":")?;
            let ty = self.ty()?;
            self.expect(")")?;
            return Ok(StatementKind::ForRange(name, ty, self.boxed()?));
        }
        let init = self.list(";")?;
        self.expect(";")?;
        let condition = if self.is(";") { None } else { Some(self.expr()?) };
        self.expect(";")?;
        let step = self.list(")")?;
        self.expect(")")?;
        Ok(StatementKind::For(init, condition, step, self.boxed()?))
    }

    fn parenthesised(&mut self) -> Parsed<Expr> {
        self.expect("(")?;
        let e = self.expr()?;
        self.expect(")")?;
        Ok(e)
    }

    // ── Labels ──

    /// Expressions separated by commas, none if `close` is next.
    pub fn list(&mut self, close: &str) -> Parsed<Vec<Expr>> {
        let mut all = Vec::new();
        if self.is(close) || self.at_end() {
            return Ok(all);
        }
        loop {
            all.push(self.expr()?);
            if !self.take(",") {
                return Ok(all);
            }
        }
    }

    pub fn selects(&mut self) -> Parsed<Vec<Select>> {
        let mut all = Vec::new();
        while !self.at_end() {
            let (name, span) = self.name("the name of what is selected")?;
            self.expect(":")?;
            all.push(Select { name, ty: self.ty()?, span });
            if !self.take(",") && !self.take(";") {
                break;
            }
        }
        Ok(all)
    }

    pub fn sync(&mut self) -> Parsed<Sync> {
        let channel = self.postfix()?;
        let offers = self.take("!");
        if !offers && !self.take("?") {
            return Err(self.fault("`!` or `?`"));
        }
        Ok(Sync { channel, offers })
    }

    /// `f --> g`, or `f` alone.
    pub fn leads_to(&mut self) -> Parsed<(Expr, Option<Expr>)> {
        let left = self.expr()?;
        let right = if self.take("-->") { Some(self.expr()?) } else { None };
        Ok((left, right))
    }

    /// `{ f } : a, b` or `: a, b`
    pub fn measures(&mut self) -> Parsed<(Option<Expr>, Vec<Expr>)> {
        let when = if self.take("{") {
            let f = self.expr()?;
            self.expect("}")?;
            Some(f)
        } else {
            None
        };
        self.expect(":")?;
        Ok((when, self.list(";")?))
    }

    // ── Expressions, from the loosest operator to the tightest ──

    pub fn expr(&mut self) -> Parsed<Expr> {
        if self.depth == 0 {
            self.operators = 0;
        }
        self.deeper(Self::words_or)
    }

    fn operator(&mut self) -> Parsed<()> {
        self.operators += 1;
        if self.operators > MAX_OPERATORS {
            let message = format!("this expression has more than {MAX_OPERATORS} operators");
            return Err(Fault { span: self.span(), message });
        }
        Ok(())
    }

    fn words_or(&mut self) -> Parsed<Expr> {
        let mut left = self.words_and()?;
        loop {
            let op = if self.take_word("or") {
                BinaryOp::Or
            } else if self.take_word("imply") {
                BinaryOp::Imply
            } else {
                return Ok(left);
            };
            self.operator()?;
            left = binary(op, left, self.words_and()?);
        }
    }

    fn words_and(&mut self) -> Parsed<Expr> {
        let mut left = self.word_not()?;
        while self.take_word("and") {
            self.operator()?;
            left = binary(BinaryOp::And, left, self.word_not()?);
        }
        Ok(left)
    }

    fn word_not(&mut self) -> Parsed<Expr> {
        let start = self.span();
        if self.take_word("not") {
            let of = self.deeper(Self::word_not)?;
            return Ok(Expr { span: start.to(of.span), kind: ExprKind::Not(Box::new(of)) });
        }
        self.assignment()
    }

    fn assignment(&mut self) -> Parsed<Expr> {
        let left = self.choice()?;
        let Tok::Mark(mark) = *self.peek() else { return Ok(left) };
        let op = match mark {
            "=" | ":=" => None,
            "+=" => Some(BinaryOp::Add),
            "-=" => Some(BinaryOp::Sub),
            "*=" => Some(BinaryOp::Mul),
            "/=" => Some(BinaryOp::Div),
            "%=" => Some(BinaryOp::Rem),
            "&=" | "|=" | "^=" | "<<=" | ">>=" => return Err(self.bits(mark)),
            _ => return Ok(left),
        };
        self.next();
        let right = self.deeper(Self::assignment)?;
        let span = left.span.to(right.span);
        Ok(Expr { kind: ExprKind::Assign(op, Box::new(left), Box::new(right)), span })
    }

    fn bits(&self, mark: &str) -> Fault {
        unsupported(self.span(), &format!("operations on bits (`{mark}`)"))
    }

    fn choice(&mut self) -> Parsed<Expr> {
        let condition = self.operators(0)?;
        // In a synchronisation `?` is the last mark; there it is never read here.
        if !self.take("?") {
            return Ok(condition);
        }
        let then = self.deeper(Self::choice)?;
        self.expect(":")?;
        let otherwise = self.deeper(Self::choice)?;
        let span = condition.span.to(otherwise.span);
        Ok(Expr { kind: ExprKind::Choice(Box::new(condition), Box::new(then), Box::new(otherwise)), span })
    }

    fn operators(&mut self, level: usize) -> Parsed<Expr> {
        let Some(operators) = LEVELS.get(level) else { return self.unary() };
        let mut left = self.operators(level + 1)?;
        loop {
            let Tok::Mark(mark) = *self.peek() else { return Ok(left) };
            if ["&", "|", "^", "<<", ">>"].contains(&mark) {
                return Err(self.bits(mark));
            }
            let Some((_, op)) = operators.iter().find(|(m, _)| *m == mark) else { return Ok(left) };
            self.next();
            self.operator()?;
            left = binary(*op, left, self.operators(level + 1)?);
        }
    }

    fn unary(&mut self) -> Parsed<Expr> {
        let start = self.span();
        let Tok::Mark(mark @ ("!" | "-" | "+" | "++" | "--")) = *self.peek() else { return self.postfix() };
        self.next();
        let of = self.deeper(Self::unary)?;
        let span = start.to(of.span);
        Ok(match mark {
            "!" => Expr { kind: ExprKind::Not(Box::new(of)), span },
            "-" => Expr { kind: ExprKind::Neg(Box::new(of)), span },
            "++" | "--" => Expr { kind: ExprKind::Step { up: mark == "++", of: Box::new(of) }, span },
            _ => of,
        })
    }

    fn postfix(&mut self) -> Parsed<Expr> {
        let mut e = self.atom()?;
        loop {
            self.operator()?;
            let kind = if self.take("[") {
                let index = self.expr()?;
                self.expect("]")?;
                ExprKind::Index(Box::new(e.clone()), Box::new(index))
            } else if self.take("(") {
                let args = self.list(")")?;
                self.expect(")")?;
                ExprKind::Call(Box::new(e.clone()), args)
            } else if self.take(".") {
                let Tok::Word(field) = self.peek().clone() else { return Err(self.fault("a name")) };
                self.next();
                ExprKind::Field(Box::new(e.clone()), field)
            } else if self.is("++") || self.is("--") {
                let up = self.is("++");
                self.next();
                ExprKind::Step { up, of: Box::new(e.clone()) }
            } else if self.take("'") {
                ExprKind::Rate
            } else {
                return Ok(e);
            };
            e = Expr { kind, span: e.span.to(self.last()) };
        }
    }

    fn atom(&mut self) -> Parsed<Expr> {
        let span = self.span();
        self.supported()?;
        let kind = match self.peek().clone() {
            Tok::Int(n) => ExprKind::Int(n),
            Tok::Mark("(") => return self.parenthesised(),
            Tok::Word(w) => match w.as_str() {
                "true" => ExprKind::Bool(true),
                "false" => ExprKind::Bool(false),
                "deadlock" => ExprKind::Deadlock,
                "forall" => return self.quantified(Quantifier::Forall),
                "exists" => return self.quantified(Quantifier::Exists),
                "sum" => return self.quantified(Quantifier::Sum),
                w if is_keyword(w) => return Err(self.fault("an expression")),
                _ => ExprKind::Name(w),
            },
            Tok::Mark(_) | Tok::End => return Err(self.fault("an expression")),
        };
        self.next();
        Ok(Expr { kind, span })
    }

    fn quantified(&mut self, quantifier: Quantifier) -> Parsed<Expr> {
        let start = self.span();
        self.next();
        self.expect("(")?;
        let (name, _) = self.name("a name")?;
        self.expect(":")?;
        let ty = self.ty()?;
        self.expect(")")?;
        let of = self.expr()?;
        let span = start.to(of.span);
        Ok(Expr { kind: ExprKind::Quantified(quantifier, name, Box::new(ty), Box::new(of)), span })
    }
}

/// Operators of two operands, from the loosest to the tightest.
const LEVELS: &[&[(&str, BinaryOp)]] = &[
    &[("||", BinaryOp::Or)],
    &[("&&", BinaryOp::And)],
    &[("==", BinaryOp::Eq), ("!=", BinaryOp::Ne)],
    &[("<", BinaryOp::Lt), ("<=", BinaryOp::Le), (">", BinaryOp::Gt), (">=", BinaryOp::Ge)],
    &[("<?", BinaryOp::Min), (">?", BinaryOp::Max)],
    &[("+", BinaryOp::Add), ("-", BinaryOp::Sub)],
    &[("*", BinaryOp::Mul), ("/", BinaryOp::Div), ("%", BinaryOp::Rem)],
];

fn binary(op: BinaryOp, left: Expr, right: Expr) -> Expr {
    let span = left.span.to(right.span);
    Expr { kind: ExprKind::Binary(op, Box::new(left), Box::new(right)), span }
}

/// What no scenario has, by its name.
pub fn unsupported(span: Span, what: &str) -> Fault {
    Fault { span, message: format!("{what} are not supported: a scenario has nothing that means the same") }
}

fn is_keyword(word: &str) -> bool {
    const WORDS: &[&str] = &[
        "and",
        "bool",
        "broadcast",
        "chan",
        "clock",
        "const",
        "deadlock",
        "do",
        "else",
        "exists",
        "false",
        "for",
        "forall",
        "if",
        "imply",
        "int",
        "not",
        "or",
        "return",
        "sum",
        "system",
        "true",
        "typedef",
        "urgent",
        "void",
        "while",
    ];
    WORDS.contains(&word)
}
