//! Words to trees, with Python's precedence.

use super::{
    lex::{ExprWord, words},
    syntax::{XacroArithmetic, XacroComparison, XacroExpr},
    value::{EvalResult, XacroValue, not_done, wrong},
};
use crate::limits::MOST_NESTING;

/// Words that are no names.
pub(super) const KEYWORDS: [&str; 12] =
    ["and", "or", "not", "in", "is", "if", "else", "for", "True", "False", "None", "lambda"];
/// Signs of Python that nothing in a description needs.
const NOT_DONE: [&str; 7] = ["&", "|", "^", "~", "<<", ">>", "@"];

pub(super) fn parse_expression(text: &str) -> EvalResult<XacroExpr> {
    let mut parser = ExprParser { words: words(text)?, at: 0, depth: 0 };
    if parser.words.is_empty() {
        return wrong("nothing stands in it", "write an expression between the braces");
    }
    let first = parser.ternary()?;
    let expr = if parser.sees(",") { parser.rest_of_tuple(first, &[])? } else { first };
    match parser.peek() {
        None => Ok(expr),
        Some(word) => {
            let word = told(word);
            if NOT_DONE.contains(&word.as_str()) {
                return not_done(format!("operator `{word}`"), "compute it otherwise");
            }
            wrong(format!("`{word}` does not belong there"), "take it out, or write an operator before it")
        }
    }
}

fn told(word: &ExprWord) -> String {
    match word {
        ExprWord::Value(value) => super::written::represented(value),
        ExprWord::Name(name) => name.clone(),
        ExprWord::Sign(sign) => (*sign).to_owned(),
    }
}

struct ExprParser {
    words: Vec<ExprWord>,
    at: usize,
    depth: usize,
}

type ParsedExpr = EvalResult<XacroExpr>;

impl ExprParser {
    fn peek(&self) -> Option<&ExprWord> {
        self.words.get(self.at)
    }

    fn sees(&self, sign: &str) -> bool {
        matches!(self.peek(), Some(ExprWord::Sign(s)) if *s == sign)
    }

    fn sees_name(&self, name: &str) -> bool {
        matches!(self.peek(), Some(ExprWord::Name(n)) if n == name)
    }

    fn takes(&mut self, sign: &str) -> bool {
        let takes = self.sees(sign);
        self.at += usize::from(takes);
        takes
    }

    fn takes_name(&mut self, name: &str) -> bool {
        let takes = self.sees_name(name);
        self.at += usize::from(takes);
        takes
    }

    fn needs(&mut self, sign: &str) -> EvalResult<()> {
        if self.takes(sign) {
            Ok(())
        } else {
            wrong(format!("`{sign}` is missing"), format!("write `{sign}`"))
        }
    }

    /// Goes one level down.
    fn nested(&mut self, parse: impl FnOnce(&mut Self) -> ParsedExpr) -> ParsedExpr {
        self.depth += 1;
        if self.depth > MOST_NESTING {
            return wrong(
                format!("it is nested deeper than {MOST_NESTING}"),
                "put parts of it into properties",
            );
        }
        let parsed = parse(self);
        self.depth -= 1;
        parsed
    }

    fn ternary(&mut self) -> ParsedExpr {
        self.nested(|parser| {
            let yes = parser.or()?;
            if !parser.takes_name("if") {
                return Ok(yes);
            }
            let condition = parser.or()?;
            if !parser.takes_name("else") {
                return wrong("an `if` has no `else`", "write `a if condition else b`");
            }
            let no = parser.ternary()?;
            Ok(XacroExpr::If { condition: Box::new(condition), yes: Box::new(yes), no: Box::new(no) })
        })
    }

    fn or(&mut self) -> ParsedExpr {
        let mut left = self.and()?;
        while self.takes_name("or") {
            left = XacroExpr::Or(Box::new(left), Box::new(self.and()?));
        }
        Ok(left)
    }

    fn and(&mut self) -> ParsedExpr {
        let mut left = self.not()?;
        while self.takes_name("and") {
            left = XacroExpr::And(Box::new(left), Box::new(self.not()?));
        }
        Ok(left)
    }

    fn not(&mut self) -> ParsedExpr {
        if self.takes_name("not") {
            return self.nested(|parser| Ok(XacroExpr::Not(Box::new(parser.not()?))));
        }
        self.comparison()
    }

    fn comparison(&mut self) -> ParsedExpr {
        let left = self.sum()?;
        let mut others = Vec::new();
        while let Some(comparison) = self.comparison_sign() {
            others.push((comparison, self.sum()?));
        }
        Ok(if others.is_empty() { left } else { XacroExpr::Compare(Box::new(left), others) })
    }

    fn comparison_sign(&mut self) -> Option<XacroComparison> {
        const SIGNS: [(&str, XacroComparison); 6] = [
            ("==", XacroComparison::Equal),
            ("!=", XacroComparison::NotEqual),
            ("<=", XacroComparison::LessOrEqual),
            (">=", XacroComparison::GreaterOrEqual),
            ("<", XacroComparison::Less),
            (">", XacroComparison::Greater),
        ];
        if let Some((_, comparison)) = SIGNS.iter().find(|(sign, _)| self.sees(sign)) {
            self.at += 1;
            return Some(*comparison);
        }
        if self.takes_name("in") {
            return Some(XacroComparison::In);
        }
        if self.takes_name("is") {
            return Some(if self.takes_name("not") { XacroComparison::IsNot } else { XacroComparison::Is });
        }
        let before = self.at;
        if self.takes_name("not") {
            if self.takes_name("in") {
                return Some(XacroComparison::NotIn);
            }
            self.at = before;
        }
        None
    }

    fn sum(&mut self) -> ParsedExpr {
        let mut left = self.product()?;
        loop {
            let operator = match self.peek() {
                Some(ExprWord::Sign("+")) => XacroArithmetic::Add,
                Some(ExprWord::Sign("-")) => XacroArithmetic::Subtract,
                _ => return Ok(left),
            };
            self.at += 1;
            left = XacroExpr::Binary(operator, Box::new(left), Box::new(self.product()?));
        }
    }

    fn product(&mut self) -> ParsedExpr {
        let mut left = self.unary()?;
        loop {
            let operator = match self.peek() {
                Some(ExprWord::Sign("*")) => XacroArithmetic::Multiply,
                Some(ExprWord::Sign("/")) => XacroArithmetic::Divide,
                Some(ExprWord::Sign("//")) => XacroArithmetic::FloorDivide,
                Some(ExprWord::Sign("%")) => XacroArithmetic::Modulo,
                _ => return Ok(left),
            };
            self.at += 1;
            left = XacroExpr::Binary(operator, Box::new(left), Box::new(self.unary()?));
        }
    }

    fn unary(&mut self) -> ParsedExpr {
        if self.takes("-") {
            return self.nested(|parser| Ok(XacroExpr::Negative(Box::new(parser.unary()?))));
        }
        if self.takes("+") {
            return self.nested(|parser| Ok(XacroExpr::Positive(Box::new(parser.unary()?))));
        }
        self.power()
    }

    /// Binds tighter than a sign before it, and less tight than one behind it: `-a ** -b`.
    fn power(&mut self) -> ParsedExpr {
        let base = self.postfix()?;
        if !self.takes("**") {
            return Ok(base);
        }
        let exponent = self.nested(Self::unary)?;
        Ok(XacroExpr::Binary(XacroArithmetic::Power, Box::new(base), Box::new(exponent)))
    }

    fn postfix(&mut self) -> ParsedExpr {
        let mut expr = self.atom()?;
        loop {
            if self.takes("(") {
                if matches!(&expr, XacroExpr::Name(name) if name == "dict") {
                    expr = self.named_pairs()?;
                    continue;
                }
                let arguments = self.arguments()?;
                expr = XacroExpr::Call(Box::new(expr), arguments);
            } else if self.takes("[") {
                expr = self.index(expr)?;
            } else if self.takes(".") {
                let Some(ExprWord::Name(name)) = self.peek().cloned() else {
                    return wrong("a name is missing after `.`", "write `dictionary.key`");
                };
                self.at += 1;
                if name.starts_with("__") {
                    return wrong(format!("`{name}` cannot be used"), "take it out");
                }
                expr = XacroExpr::Attribute(Box::new(expr), name);
            } else {
                return Ok(expr);
            }
        }
    }

    /// `dict(a=1, b=2)`
    fn named_pairs(&mut self) -> ParsedExpr {
        let mut pairs = Vec::new();
        while !self.takes(")") {
            let Some(ExprWord::Name(name)) = self.peek().cloned() else {
                return not_done("`dict` of anything but `name=value`", "write `dict(a=1, b=2)`");
            };
            self.at += 1;
            self.needs("=")?;
            pairs.push((XacroExpr::Value(XacroValue::text(name)?), self.ternary()?));
            if !self.takes(",") {
                self.needs(")")?;
                break;
            }
        }
        Ok(XacroExpr::Dict(pairs))
    }

    fn arguments(&mut self) -> EvalResult<Vec<XacroExpr>> {
        let mut arguments = Vec::new();
        while !self.takes(")") {
            let first = self.ternary()?;
            if self.sees("=") {
                return not_done("argument by name", "write the arguments in their order");
            }
            if self.sees_name("for") {
                let each = self.each(first)?;
                self.needs(")")?;
                arguments.push(each);
                break;
            }
            arguments.push(first);
            if !self.takes(",") {
                self.needs(")")?;
                break;
            }
        }
        Ok(arguments)
    }

    fn index(&mut self, of: XacroExpr) -> ParsedExpr {
        let mut parts: [Option<Box<XacroExpr>>; 3] = [None, None, None];
        let mut colons = 0;
        for slot in &mut parts {
            if !self.sees(":") && !self.sees("]") {
                *slot = Some(Box::new(self.ternary()?));
            }
            if !self.takes(":") {
                break;
            }
            colons += 1;
        }
        self.needs("]")?;
        let [first, second, third] = parts;
        match (colons, first) {
            (0, Some(at)) => Ok(XacroExpr::Index(Box::new(of), at)),
            (0, None) => wrong("an index is missing", "write `list[0]` or `dictionary['key']`"),
            (_, first) => Ok(XacroExpr::Slice(Box::new(of), [first, second, third])),
        }
    }

    fn atom(&mut self) -> ParsedExpr {
        let Some(word) = self.peek().cloned() else {
            return wrong("it breaks off", "write the rest of it");
        };
        self.at += 1;
        match word {
            ExprWord::Value(XacroValue::Text(text)) => {
                let mut joined = text.to_string();
                // Texts side by side are one.
                while let Some(ExprWord::Value(XacroValue::Text(more))) = self.peek() {
                    joined.push_str(more);
                    self.at += 1;
                }
                XacroValue::text(joined).map(XacroExpr::Value)
            }
            ExprWord::Value(value) => Ok(XacroExpr::Value(value)),
            ExprWord::Name(name) => match name.as_str() {
                "True" => Ok(XacroExpr::Value(XacroValue::Bool(true))),
                "False" => Ok(XacroExpr::Value(XacroValue::Bool(false))),
                "None" => Ok(XacroExpr::Value(XacroValue::None)),
                word if KEYWORDS.contains(&word) => {
                    wrong(format!("`{word}` does not belong there"), "take it out")
                }
                word if word.starts_with("__") => wrong(format!("`{word}` cannot be used"), "take it out"),
                _ => Ok(XacroExpr::Name(name)),
            },
            ExprWord::Sign("(") => self.parenthesis(),
            ExprWord::Sign("[") => self.list(),
            ExprWord::Sign("{") => self.dict(),
            ExprWord::Sign(sign) if NOT_DONE.contains(&sign) => {
                not_done(format!("operator `{sign}`"), "compute it otherwise")
            }
            ExprWord::Sign(sign) => {
                wrong(format!("`{sign}` does not belong there"), "write a value before it")
            }
        }
    }

    fn parenthesis(&mut self) -> ParsedExpr {
        if self.takes(")") {
            return Ok(XacroExpr::Tuple(Vec::new()));
        }
        let first = self.ternary()?;
        let inside = if self.sees(",") {
            self.rest_of_tuple(first, &[")"])?
        } else if self.sees_name("for") {
            self.each(first)?
        } else {
            first
        };
        self.needs(")")?;
        Ok(inside)
    }

    fn rest_of_tuple(&mut self, first: XacroExpr, ends: &[&str]) -> ParsedExpr {
        let mut items = vec![first];
        while self.takes(",") {
            if self.peek().is_none() || ends.iter().any(|end| self.sees(end)) {
                break;
            }
            items.push(self.ternary()?);
        }
        Ok(XacroExpr::Tuple(items))
    }

    fn list(&mut self) -> ParsedExpr {
        let mut items = Vec::new();
        while !self.takes("]") {
            let item = self.ternary()?;
            if items.is_empty() && self.sees_name("for") {
                let each = self.each(item)?;
                self.needs("]")?;
                return Ok(each);
            }
            items.push(item);
            if !self.takes(",") {
                self.needs("]")?;
                break;
            }
        }
        Ok(XacroExpr::List(items))
    }

    fn each(&mut self, item: XacroExpr) -> ParsedExpr {
        self.at += 1;
        let mut names = Vec::new();
        let in_parentheses = self.takes("(");
        while let Some(ExprWord::Name(name)) = self.peek().filter(|_| !self.sees_name("in")).cloned() {
            names.push(name);
            self.at += 1;
            if !self.takes(",") {
                break;
            }
        }
        if in_parentheses {
            self.needs(")")?;
        }
        if names.is_empty() || !self.takes_name("in") {
            return wrong("a `for` has no `in`", "write `[f(x) for x in list]`");
        }
        let over = Box::new(self.or()?);
        let condition = if self.takes_name("if") { Some(Box::new(self.or()?)) } else { None };
        if self.sees_name("for") || self.sees_name("if") {
            return not_done("list with two `for` or two `if`", "write two lists, one after the other");
        }
        Ok(XacroExpr::Each { item: Box::new(item), names, over, condition })
    }

    fn dict(&mut self) -> ParsedExpr {
        let mut pairs = Vec::new();
        while !self.takes("}") {
            let key = self.ternary()?;
            self.needs(":")?;
            pairs.push((key, self.ternary()?));
            if !self.takes(",") {
                self.needs("}")?;
                break;
            }
        }
        Ok(XacroExpr::Dict(pairs))
    }
}
