//! Expressions, conditions over clocks and times as UPPAAL writes them.

use hrdsl_ir::{
    Enumeration, Expr, Value,
    expr::{BinaryOp, Lvalue, NumberFunction, UnaryOp},
    ta::{ClockConstraint, ClockOp, TimeSum, located_automaton},
};

use super::slots::UppaalSlotTable;

/// How tightly an expression holds together, from the loosest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum UppaalPrecedence {
    Or,
    And,
    Equality,
    Order,
    Extreme,
    Sum,
    Product,
    Unary,
    Atom,
}

#[derive(Clone, Debug)]
pub struct UppaalExprText {
    pub text: String,
    pub level: UppaalPrecedence,
}

impl UppaalExprText {
    pub fn new(text: impl Into<String>, level: UppaalPrecedence) -> Self {
        Self { text: text.into(), level }
    }

    pub fn at(&self, level: UppaalPrecedence) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text.clone() }
    }
}

/// What cannot be said.
pub type UppaalTextResult<T> = Result<T, String>;

/// What expressions need to know.
#[derive(Clone, Debug, Default)]
pub struct UppaalExprContext {
    pub slots: UppaalSlotTable,
    pub clocks: Vec<String>,
    /// Names of functions by their id; `None`: it cannot be called here.
    pub functions: Vec<Option<String>>,
    /// What functions give, if it is of an enumeration.
    pub results: Vec<Option<Enumeration>>,
    /// Enumerations of the functions' parameters.
    pub params: Vec<Vec<Option<Enumeration>>>,
    /// The constants that stand for the values of enumerations.
    pub symbols: Vec<(Enumeration, Vec<String>)>,
    /// Nanoseconds of one unit of time.
    pub unit: i64,
    /// In queries: each automaton's locations, with its process.
    pub locations: Vec<Vec<String>>,
}

impl UppaalExprContext {
    /// The text of an expression; `of` is the enumeration that its value is of, if it is one.
    pub fn expr(&self, e: &Expr, of: Option<Enumeration>) -> UppaalTextResult<UppaalExprText> {
        match e {
            Expr::Const(value) => self.constant(*value, of),
            Expr::Var(slot) => self.slot(*slot),
            Expr::Unary(UnaryOp::Not, a) => Ok(UppaalExprText::new(
                format!("!{}", self.expr(a, None)?.at(UppaalPrecedence::Unary)),
                UppaalPrecedence::Unary,
            )),
            Expr::Unary(UnaryOp::Neg, a) => Ok(UppaalExprText::new(
                format!("-{}", self.expr(a, None)?.at(UppaalPrecedence::Atom)),
                UppaalPrecedence::Unary,
            )),
            Expr::Binary(op, a, b) => match self.location(*op, a, b) {
                Some(name) => Ok(UppaalExprText::new(name.to_owned(), UppaalPrecedence::Atom)),
                None => self.binary(*op, a, b),
            },
            Expr::If(c, a, b) => {
                let (c, a, b) = (self.expr(c, None)?, self.expr(a, of)?, self.expr(b, of)?);
                let text = format!(
                    "({} ? {} : {})",
                    c.at(UppaalPrecedence::Or),
                    a.at(UppaalPrecedence::Or),
                    b.at(UppaalPrecedence::Or)
                );
                Ok(UppaalExprText::new(text, UppaalPrecedence::Atom))
            }
            Expr::Call(function, args) => self.call(*function, args),
            Expr::List(..) => Err("lists".to_owned()),
            Expr::Element(place) => Ok(UppaalExprText::new(self.place(place)?, UppaalPrecedence::Atom)),
            Expr::Apply(function, args) => {
                Ok(UppaalExprText::new(self.apply(function.0, args)?, UppaalPrecedence::Atom))
            }
        }
    }

    /// The location that a query's expression asks for.
    fn location(&self, op: BinaryOp, a: &Expr, b: &Expr) -> Option<&str> {
        let (BinaryOp::Eq, Expr::Var(slot), Expr::Const(Value::Int(n))) = (op, a, b) else { return None };
        let of = &self.locations[usize::from(located_automaton(*slot, self.locations.len())?)];
        of.get(usize::try_from(*n).ok()?).map(String::as_str)
    }

    /// A constant; a value of an enumeration is the constant for its number.
    pub fn constant(&self, value: Value, of: Option<Enumeration>) -> UppaalTextResult<UppaalExprText> {
        match value {
            Value::Bool(b) => Ok(UppaalExprText::new(b.to_string(), UppaalPrecedence::Atom)),
            Value::Int(n) if i32::try_from(n).is_ok() => Ok(number(n)),
            Value::Int(n) => Err(format!("the number {n}: UPPAAL's integers have 32 bits")),
            Value::Symbol(symbol) => {
                let at = of.and_then(|e| e.index_of(symbol));
                let at = at.ok_or_else(|| {
                    format!("the value `{symbol}`, of which nothing says what it is compared with")
                })?;
                let known = of.and_then(|of| self.symbols.iter().find(|(e, _)| *e == of));
                let name = known.and_then(|(_, names)| names.get(at));
                Ok(name.map_or_else(
                    || number(at as i64),
                    |name| UppaalExprText::new(name.clone(), UppaalPrecedence::Atom),
                ))
            }
            Value::Float(x) => Err(format!("the number {x} with a fraction")),
            Value::Text(_) => Err("strings".to_owned()),
            Value::List(_) => Err("lists".to_owned()),
        }
    }

    fn slot(&self, slot: u16) -> UppaalTextResult<UppaalExprText> {
        let slot = self.slots.slots.get(usize::from(slot)).ok_or("a variable that is not known here")?;
        Ok(if slot.as_number {
            UppaalExprText::new(format!("{} == 1", slot.text), UppaalPrecedence::Equality)
        } else {
            UppaalExprText::new(slot.text.clone(), UppaalPrecedence::Atom)
        })
    }

    fn binary(&self, op: BinaryOp, a: &Expr, b: &Expr) -> UppaalTextResult<UppaalExprText> {
        let (sign, level) = match op {
            BinaryOp::Or => ("||", UppaalPrecedence::Or),
            BinaryOp::And => ("&&", UppaalPrecedence::And),
            BinaryOp::Eq => ("==", UppaalPrecedence::Equality),
            BinaryOp::Ne => ("!=", UppaalPrecedence::Equality),
            BinaryOp::Lt => ("<", UppaalPrecedence::Order),
            BinaryOp::Le => ("<=", UppaalPrecedence::Order),
            BinaryOp::Gt => (">", UppaalPrecedence::Order),
            BinaryOp::Ge => (">=", UppaalPrecedence::Order),
            BinaryOp::Add => ("+", UppaalPrecedence::Sum),
            BinaryOp::Sub => ("-", UppaalPrecedence::Sum),
            BinaryOp::Mul => ("*", UppaalPrecedence::Product),
            BinaryOp::Div => ("/", UppaalPrecedence::Product),
            BinaryOp::Rem => ("%", UppaalPrecedence::Product),
        };
        let of = self.enumeration(a).or_else(|| self.enumeration(b));
        let (a, b) = (self.expr(a, of)?, self.expr(b, of)?);
        let tighter = match level {
            UppaalPrecedence::Or | UppaalPrecedence::And => level,
            UppaalPrecedence::Sum => UppaalPrecedence::Product,
            UppaalPrecedence::Product => UppaalPrecedence::Unary,
            UppaalPrecedence::Equality
            | UppaalPrecedence::Order
            | UppaalPrecedence::Extreme
            | UppaalPrecedence::Unary
            | UppaalPrecedence::Atom => UppaalPrecedence::Sum,
        };
        let left = if matches!(level, UppaalPrecedence::Equality | UppaalPrecedence::Order) {
            UppaalPrecedence::Sum
        } else {
            level
        };
        Ok(UppaalExprText::new(format!("{} {sign} {}", a.at(left), b.at(tighter)), level))
    }

    /// The enumeration that a variable's or function's value is of.
    fn enumeration(&self, e: &Expr) -> Option<Enumeration> {
        let of_slot = |slot: u16| self.slots.slots.get(usize::from(slot)).and_then(|s| s.enumeration);
        match e {
            Expr::Var(slot) => of_slot(*slot),
            Expr::Element(place) => of_slot(place.slot),
            Expr::If(_, a, b) => self.enumeration(a).or_else(|| self.enumeration(b)),
            Expr::Apply(function, _) => self.results.get(usize::from(function.0)).copied().flatten(),
            Expr::Const(_) | Expr::Unary(..) | Expr::Binary(..) | Expr::Call(..) | Expr::List(..) => None,
        }
    }

    fn call(&self, function: NumberFunction, args: &[Expr]) -> UppaalTextResult<UppaalExprText> {
        let args = args.iter().map(|a| self.expr(a, None)).collect::<UppaalTextResult<Vec<_>>>()?;
        match (function, args.as_slice()) {
            (NumberFunction::Min, [a, b]) => Ok(UppaalExprText::new(
                format!("{} <? {}", a.at(UppaalPrecedence::Sum), b.at(UppaalPrecedence::Sum)),
                UppaalPrecedence::Extreme,
            )),
            (NumberFunction::Max, [a, b]) => Ok(UppaalExprText::new(
                format!("{} >? {}", a.at(UppaalPrecedence::Sum), b.at(UppaalPrecedence::Sum)),
                UppaalPrecedence::Extreme,
            )),
            (NumberFunction::Abs, [a]) => {
                let negative = UppaalExprText::new(
                    format!("-{}", a.at(UppaalPrecedence::Atom)),
                    UppaalPrecedence::Unary,
                )
                .text;
                Ok(UppaalExprText::new(
                    format!("({} >? {negative})", a.at(UppaalPrecedence::Sum)),
                    UppaalPrecedence::Atom,
                ))
            }
            (NumberFunction::Norm, _) => Err("`norm`".to_owned()),
            (NumberFunction::Min | NumberFunction::Max | NumberFunction::Abs, _) => {
                Err("a call without arguments".to_owned())
            }
        }
    }

    pub fn apply(&self, function: u16, args: &[Expr]) -> UppaalTextResult<String> {
        let at = usize::from(function);
        let name = self.functions.get(at).cloned().flatten();
        let name = name.ok_or("a function of another automaton")?;
        let params = self.params.get(at).map_or(&[] as &[_], Vec::as_slice);
        let of = params.iter().copied().chain(std::iter::repeat(None));
        let args = args.iter().zip(of).map(|(a, of)| self.expr(a, of).map(|t| t.text));
        Ok(format!("{name}({})", args.collect::<UppaalTextResult<Vec<_>>>()?.join(", ")))
    }

    // ── Places ──

    /// A variable, or an element that indices choose.
    pub fn place(&self, place: &Lvalue) -> UppaalTextResult<String> {
        let slot = usize::from(place.slot);
        if place.indices.is_empty() {
            let slot = self.slots.slots.get(slot).ok_or("a variable that is not known here")?;
            return Ok(slot.text.clone());
        }
        let group = self.slots.groups.iter().find(|g| (g.first..g.first + g.count()).contains(&slot));
        let Some(group) = group else {
            return Err("an index that is not constant into an array of records".to_owned());
        };
        let mut text = group.name.clone();
        let mut left = slot - group.first;
        for (size, stride) in group.dims.iter().zip(group.strides()) {
            let constant = left / stride;
            left %= stride;
            let fits = |i: &&hrdsl_ir::expr::ArrayIndex| {
                usize::from(i.stride) == stride && usize::from(i.count) == *size
            };
            let index = match place.indices.iter().find(fits) {
                Some(index) => self.expr(&index.at, None)?.text,
                None => constant.to_string(),
            };
            text += &format!("[{index}]");
        }
        Ok(text)
    }

    pub fn enumeration_of(&self, place: &Lvalue) -> Option<Enumeration> {
        self.slots.slots.get(usize::from(place.slot)).and_then(|s| s.enumeration)
    }

    // ── Time ──

    pub fn time(&self, time: &TimeSum) -> UppaalTextResult<UppaalExprText> {
        let mut terms = Vec::new();
        for term in &time.terms {
            let factor = self.units(term.factor)?;
            let value = self.expr(&term.value, None)?;
            terms.push(match factor {
                1 => value,
                n => UppaalExprText::new(
                    format!(
                        "{} * {}",
                        number(n).at(UppaalPrecedence::Unary),
                        value.at(UppaalPrecedence::Unary)
                    ),
                    UppaalPrecedence::Product,
                ),
            });
        }
        let constant = self.units(time.nanos)?;
        if constant != 0 || terms.is_empty() {
            terms.push(number(constant));
        }
        let text = terms.into_iter().reduce(|a, b| {
            UppaalExprText::new(
                format!("{} + {}", a.at(UppaalPrecedence::Sum), b.at(UppaalPrecedence::Product)),
                UppaalPrecedence::Sum,
            )
        });
        text.ok_or_else(|| "an empty time".to_owned())
    }

    fn units(&self, nanos: i64) -> UppaalTextResult<i64> {
        let units = nanos / self.unit;
        // UPPAAL's clocks are compared with half the range of its integers.
        if units.unsigned_abs() >= 1 << 30 {
            return Err(format!(
                "a time of {units} units (one unit, the greatest that all times are multiples of, is {} ns); \
                 UPPAAL's constants have 31 bits",
                self.unit
            ));
        }
        Ok(units)
    }

    pub fn constraint(&self, c: &ClockConstraint) -> UppaalTextResult<String> {
        let clock = |id: hrdsl_ir::ta::ClockId| {
            self.clocks
                .get(usize::from(id.0))
                .cloned()
                .ok_or_else(|| "a clock that is not known here".to_owned())
        };
        let mut text = clock(c.clock)?;
        if let Some(minus) = c.minus {
            text += &format!(" - {}", clock(minus)?);
        }
        let sign = match c.op {
            ClockOp::Lt => "<",
            ClockOp::Le => "<=",
            ClockOp::Eq => "==",
            ClockOp::Ge => ">=",
            ClockOp::Gt => ">",
        };
        Ok(format!("{text} {sign} {}", self.time(&c.bound)?.at(UppaalPrecedence::Sum)))
    }
}

pub fn number(n: i64) -> UppaalExprText {
    UppaalExprText::new(n.to_string(), if n < 0 { UppaalPrecedence::Unary } else { UppaalPrecedence::Atom })
}
