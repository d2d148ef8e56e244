//! Declarations, types and parameters.

use super::{UppaalParseResult, UppaalParser, is_keyword};
use crate::uppaal::import::{
    ast::{
        UppaalBaseType, UppaalDeclaration, UppaalDeclarator, UppaalDimension, UppaalExpr, UppaalFunction,
        UppaalInitializer, UppaalInstance, UppaalParameter, UppaalType,
    },
    fault::unsupported,
    lex::UppaalTokenKind,
};

/// Declarations that change nothing of what a model does.
const IDLE: &[(&str, &str)] = &[
    ("progress", "`progress`: measures of progress only steer the search of old versions"),
    ("gantt", "`gantt`: charts are drawn by the simulator only"),
];

impl UppaalParser {
    /// Declarations up to the end of the piece; those of the system, too.
    pub fn declarations(&mut self) -> UppaalParseResult<Vec<UppaalDeclaration>> {
        let mut all = Vec::new();
        while !self.at_end() {
            if self.take(";") {
                continue;
            }
            let start = self.at;
            let declaration = self.declaration()?;
            let inside = match &declaration {
                UppaalDeclaration::Function(_) => start + 1,
                _ => self.at,
            };
            let said = self.comments(start, inside);
            if !said.is_empty() {
                all.push(UppaalDeclaration::Comment(said));
            }
            all.push(declaration);
        }
        Ok(all)
    }

    pub(super) fn declaration(&mut self) -> UppaalParseResult<UppaalDeclaration> {
        self.supported()?;
        if self.take_word("typedef") {
            let ty = self.ty()?;
            let declarator = self.declarator()?;
            self.expect(";")?;
            return Ok(UppaalDeclaration::Typedef(ty, declarator));
        }
        if self.take_word("system") {
            return self.system();
        }
        if matches!(
            (self.peek(), self.ahead(1)),
            (UppaalTokenKind::Word(_), UppaalTokenKind::Mark("=" | ":=" | "("))
        ) {
            return self.instance();
        }
        if matches!(self.ahead(1), UppaalTokenKind::Mark("{")) {
            for (word, what) in IDLE {
                if self.is_word(word) {
                    return self.idle(what);
                }
            }
        }
        let start = self.span();
        let ty = self.ty()?;
        if self.is_word("priority") {
            return Err(unsupported(self.span(), "priorities of channels (`chan priority`)"));
        }
        if matches!((self.peek(), self.ahead(1)), (UppaalTokenKind::Word(_), UppaalTokenKind::Mark("("))) {
            let (name, _) = self.name("a name")?;
            let params = self.params_in_parentheses()?;
            let body = self.block()?;
            return Ok(UppaalDeclaration::Function(UppaalFunction {
                ty,
                name,
                params,
                body,
                span: start.to(self.last()),
            }));
        }
        let mut declarators = vec![self.declarator()?];
        while self.take(",") {
            declarators.push(self.declarator()?);
        }
        self.expect(";")?;
        Ok(UppaalDeclaration::Vars(ty, declarators))
    }

    pub(super) fn system(&mut self) -> UppaalParseResult<UppaalDeclaration> {
        let mut names = vec![self.name("a process")?];
        while !self.take(";") {
            if self.is("<") {
                return Err(unsupported(self.span(), "priorities of processes (`<` in `system`)"));
            }
            self.expect(",")?;
            names.push(self.name("a process")?);
        }
        Ok(UppaalDeclaration::System(names))
    }

    pub(super) fn instance(&mut self) -> UppaalParseResult<UppaalDeclaration> {
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
        Ok(UppaalDeclaration::Instance(UppaalInstance { name, params, of, args, span }))
    }

    pub(super) fn ty(&mut self) -> UppaalParseResult<UppaalType> {
        let span = self.span();
        let (mut constant, mut urgent, mut broadcast, mut meta) = (false, false, false, false);
        loop {
            if self.take_word("const") {
                constant = true;
            } else if self.take_word("urgent") {
                urgent = true;
            } else if self.take_word("broadcast") {
                broadcast = true;
            } else if self.take_word("meta") {
                meta = true;
            } else {
                break;
            }
        }
        self.supported()?;
        // `const N 5;` of the old language has no type.
        let untyped = constant
            && matches!(
                (self.peek(), self.ahead(1)),
                (UppaalTokenKind::Word(_), UppaalTokenKind::Int(_) | UppaalTokenKind::Mark("=" | ":=" | "-"))
            );
        let base = if untyped { UppaalBaseType::Int(None) } else { self.base()? };
        Ok(UppaalType { constant, urgent, broadcast, meta, base, span: span.to(self.last()) })
    }

    pub(super) fn base(&mut self) -> UppaalParseResult<UppaalBaseType> {
        let UppaalTokenKind::Word(word) = self.peek().clone() else { return Err(self.fault("a type")) };
        let base = match word.as_str() {
            "int" => {
                self.next();
                return Ok(UppaalBaseType::Int(if self.take("[") {
                    Some(Box::new(self.bounds()?))
                } else {
                    None
                }));
            }
            "bool" => UppaalBaseType::Bool,
            "clock" => UppaalBaseType::Clock,
            "chan" => UppaalBaseType::Chan,
            "void" => UppaalBaseType::Void,
            "scalar" => {
                self.next();
                self.expect("[")?;
                let size = self.expr()?;
                self.expect("]")?;
                return Ok(UppaalBaseType::Scalar(Box::new(size)));
            }
            "struct" => return self.fields(),
            w if is_keyword(w) => return Err(self.fault("a type")),
            _ => UppaalBaseType::Named(word),
        };
        self.next();
        Ok(base)
    }

    /// The fields of `struct { … }`.
    fn fields(&mut self) -> UppaalParseResult<UppaalBaseType> {
        self.next();
        self.expect("{")?;
        self.deeper(|p| {
            let mut fields = Vec::new();
            while !p.take("}") {
                let ty = p.ty()?;
                let mut names = vec![p.declarator()?];
                while p.take(",") {
                    names.push(p.declarator()?);
                }
                p.expect(";")?;
                fields.push((ty, names));
            }
            Ok(UppaalBaseType::Struct(fields))
        })
    }

    /// `progress { … }`, with what its braces hold.
    fn idle(&mut self, what: &'static str) -> UppaalParseResult<UppaalDeclaration> {
        let start = self.span();
        let mut open = 0;
        loop {
            self.next();
            if self.is("{") {
                open += 1;
            } else if self.is("}") {
                open -= 1;
            }
            if self.at_end() {
                return Err(self.fault("`}`"));
            }
            if open == 0 {
                break;
            }
        }
        self.next();
        Ok(UppaalDeclaration::Idle(start, what))
    }

    pub(super) fn bounds(&mut self) -> UppaalParseResult<(UppaalExpr, UppaalExpr)> {
        let lo = self.expr()?;
        self.expect(",")?;
        let hi = self.expr()?;
        self.expect("]")?;
        Ok((lo, hi))
    }

    pub(super) fn dims(&mut self) -> UppaalParseResult<Vec<UppaalDimension>> {
        let mut dims = Vec::new();
        while self.take("[") {
            self.supported()?;
            let is_type = ["int", "bool", "scalar"].iter().any(|w| self.is_word(w));
            dims.push(if is_type {
                UppaalDimension::Of(self.ty()?)
            } else {
                UppaalDimension::Size(self.expr()?)
            });
            self.expect("]")?;
        }
        Ok(dims)
    }

    pub(super) fn declarator(&mut self) -> UppaalParseResult<UppaalDeclarator> {
        let (name, span) = self.name("a name")?;
        let dims = self.dims()?;
        let old_constant = matches!(self.peek(), UppaalTokenKind::Int(_));
        let init = if self.take("=") || self.take(":=") || old_constant { Some(self.init()?) } else { None };
        Ok(UppaalDeclarator { name, span, dims, init })
    }

    pub(super) fn init(&mut self) -> UppaalParseResult<UppaalInitializer> {
        let start = self.span();
        if !self.take("{") {
            return Ok(UppaalInitializer::One(self.expr()?));
        }
        self.deeper(|p| {
            let mut all = Vec::new();
            while !p.is("}") {
                if matches!((p.peek(), p.ahead(1)), (UppaalTokenKind::Word(_), UppaalTokenKind::Mark(":"))) {
                    let (name, _) = p.name("the name of a field")?;
                    p.expect(":")?;
                    all.push(UppaalInitializer::Named(name, Box::new(p.init()?)));
                } else {
                    all.push(p.init()?);
                }
                if !p.take(",") {
                    break;
                }
            }
            p.expect("}")?;
            Ok(UppaalInitializer::List(all, start.to(p.last())))
        })
    }

    pub(super) fn params_in_parentheses(&mut self) -> UppaalParseResult<Vec<UppaalParameter>> {
        self.expect("(")?;
        let params = self.params(")")?;
        self.expect(")")?;
        Ok(params)
    }

    /// Parameters up to a mark, or to the end.
    pub fn params(&mut self, close: &str) -> UppaalParseResult<Vec<UppaalParameter>> {
        let mut params: Vec<UppaalParameter> = Vec::new();
        while !self.at_end() && !self.is(close) {
            // `int a, b` of the old language repeats no type.
            let repeats = matches!(
                (self.peek(), self.ahead(1)),
                (UppaalTokenKind::Word(w), UppaalTokenKind::Mark("," | ";" | ")") | UppaalTokenKind::End) if !is_keyword(w)
            );
            let before = params.last().filter(|_| repeats).map(|p| (p.ty.clone(), p.by_reference));
            let ty = match &before {
                Some((ty, _)) => ty.clone(),
                None => self.ty()?,
            };
            let by_reference = self.take("&") || before.is_some_and(|(_, r)| r);
            let (name, span) = self.name("the name of a parameter")?;
            let dims = self.dims()?;
            params.push(UppaalParameter { ty, by_reference, name, dims, span });
            if !self.take(",") && !self.take(";") {
                break;
            }
        }
        Ok(params)
    }
}
