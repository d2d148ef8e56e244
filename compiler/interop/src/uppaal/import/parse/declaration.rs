//! Declarations, types and parameters.

use super::{Parsed, Parser, is_keyword};
use crate::uppaal::import::{
    ast::{Base, Decl, Declarator, Dim, Expr, Function, Init, Instance, Param, Type},
    fault::unsupported,
    lex::Tok,
};

impl Parser {
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

    pub(super) fn declaration(&mut self) -> Parsed<Decl> {
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

    pub(super) fn system(&mut self) -> Parsed<Decl> {
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

    pub(super) fn instance(&mut self) -> Parsed<Decl> {
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

    pub(super) fn ty(&mut self) -> Parsed<Type> {
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

    pub(super) fn base(&mut self) -> Parsed<Base> {
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

    pub(super) fn bounds(&mut self) -> Parsed<(Expr, Expr)> {
        let lo = self.expr()?;
        self.expect(",")?;
        let hi = self.expr()?;
        self.expect("]")?;
        Ok((lo, hi))
    }

    pub(super) fn dims(&mut self) -> Parsed<Vec<Dim>> {
        let mut dims = Vec::new();
        while self.take("[") {
            self.supported()?;
            let is_type = self.is_word("int") || self.is_word("bool");
            dims.push(if is_type { Dim::Of(self.ty()?) } else { Dim::Size(self.expr()?) });
            self.expect("]")?;
        }
        Ok(dims)
    }

    pub(super) fn declarator(&mut self) -> Parsed<Declarator> {
        let (name, span) = self.name("a name")?;
        let dims = self.dims()?;
        let old_constant = matches!(self.peek(), Tok::Int(_));
        let init = if self.take("=") || self.take(":=") || old_constant { Some(self.init()?) } else { None };
        Ok(Declarator { name, span, dims, init })
    }

    pub(super) fn init(&mut self) -> Parsed<Init> {
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

    pub(super) fn params_in_parentheses(&mut self) -> Parsed<Vec<Param>> {
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
}
