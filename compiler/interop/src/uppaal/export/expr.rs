//! Expressions, conditions over clocks and times as UPPAAL writes them.

use hrdsl_ir::{
    Enumeration, Expr, Value,
    expr::{BinaryOp, Lvalue, NumberFunction, UnaryOp},
    ta::{ClockConstraint, ClockOp, TimeSum},
};

use super::slots::Slots;

/// How tightly an expression holds together, from the loosest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
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
pub struct Text {
    pub text: String,
    pub level: Level,
}

impl Text {
    pub fn new(text: impl Into<String>, level: Level) -> Self {
        Self { text: text.into(), level }
    }

    pub fn at(&self, level: Level) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text.clone() }
    }
}

/// What cannot be said.
pub type Said<T> = Result<T, String>;

/// What expressions need to know.
#[derive(Clone, Debug, Default)]
pub struct Context {
    pub slots: Slots,
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
}

impl Context {
    /// The text of an expression; `of` is the enumeration that its value is of, if it is one.
    pub fn expr(&self, e: &Expr, of: Option<Enumeration>) -> Said<Text> {
        match e {
            Expr::Const(value) => self.constant(*value, of),
            Expr::Var(slot) => self.slot(*slot),
            Expr::Unary(UnaryOp::Not, a) => {
                Ok(Text::new(format!("!{}", self.expr(a, None)?.at(Level::Unary)), Level::Unary))
            }
            Expr::Unary(UnaryOp::Neg, a) => {
                Ok(Text::new(format!("-{}", self.expr(a, None)?.at(Level::Atom)), Level::Unary))
            }
            Expr::Binary(op, a, b) => self.binary(*op, a, b),
            Expr::If(c, a, b) => {
                let (c, a, b) = (self.expr(c, None)?, self.expr(a, of)?, self.expr(b, of)?);
                let text = format!("({} ? {} : {})", c.at(Level::Or), a.at(Level::Or), b.at(Level::Or));
                Ok(Text::new(text, Level::Atom))
            }
            Expr::Call(function, args) => self.call(*function, args),
            Expr::List(..) => Err("lists".to_owned()),
            Expr::Element(place) => Ok(Text::new(self.place(place)?, Level::Atom)),
            Expr::Apply(function, args) => Ok(Text::new(self.apply(function.0, args)?, Level::Atom)),
        }
    }

    /// A constant; a value of an enumeration is the constant for its number.
    pub fn constant(&self, value: Value, of: Option<Enumeration>) -> Said<Text> {
        match value {
            Value::Bool(b) => Ok(Text::new(b.to_string(), Level::Atom)),
            Value::Int(n) if i32::try_from(n).is_ok() => Ok(number(n)),
            Value::Int(n) => Err(format!("the number {n}: UPPAAL's integers have 32 bits")),
            Value::Symbol(symbol) => {
                let at = of.and_then(|e| e.index_of(symbol));
                let at = at.ok_or_else(|| {
                    format!("the value `{symbol}`, of which nothing says what it is compared with")
                })?;
                let known = of.and_then(|of| self.symbols.iter().find(|(e, _)| *e == of));
                let name = known.and_then(|(_, names)| names.get(at));
                Ok(name.map_or_else(|| number(at as i64), |name| Text::new(name.clone(), Level::Atom)))
            }
            Value::Float(x) => Err(format!("the number {x} with a fraction")),
            Value::Text(_) => Err("strings".to_owned()),
            Value::List(_) => Err("lists".to_owned()),
        }
    }

    fn slot(&self, slot: u16) -> Said<Text> {
        let slot = self.slots.slots.get(usize::from(slot)).ok_or("a variable that is not known here")?;
        Ok(if slot.as_number {
            Text::new(format!("{} == 1", slot.text), Level::Equality)
        } else {
            Text::new(slot.text.clone(), Level::Atom)
        })
    }

    fn binary(&self, op: BinaryOp, a: &Expr, b: &Expr) -> Said<Text> {
        let (sign, level) = match op {
            BinaryOp::Or => ("||", Level::Or),
            BinaryOp::And => ("&&", Level::And),
            BinaryOp::Eq => ("==", Level::Equality),
            BinaryOp::Ne => ("!=", Level::Equality),
            BinaryOp::Lt => ("<", Level::Order),
            BinaryOp::Le => ("<=", Level::Order),
            BinaryOp::Gt => (">", Level::Order),
            BinaryOp::Ge => (">=", Level::Order),
            BinaryOp::Add => ("+", Level::Sum),
            BinaryOp::Sub => ("-", Level::Sum),
            BinaryOp::Mul => ("*", Level::Product),
            BinaryOp::Div => ("/", Level::Product),
            BinaryOp::Rem => ("%", Level::Product),
        };
        let of = self.enumeration(a).or_else(|| self.enumeration(b));
        let (a, b) = (self.expr(a, of)?, self.expr(b, of)?);
        let tighter = match level {
            Level::Or | Level::And => level,
            Level::Sum => Level::Product,
            Level::Product => Level::Unary,
            Level::Equality | Level::Order | Level::Extreme | Level::Unary | Level::Atom => Level::Sum,
        };
        let left = if matches!(level, Level::Equality | Level::Order) { Level::Sum } else { level };
        Ok(Text::new(format!("{} {sign} {}", a.at(left), b.at(tighter)), level))
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

    fn call(&self, function: NumberFunction, args: &[Expr]) -> Said<Text> {
        let args = args.iter().map(|a| self.expr(a, None)).collect::<Said<Vec<_>>>()?;
        match (function, args.as_slice()) {
            (NumberFunction::Min, [a, b]) => {
                Ok(Text::new(format!("{} <? {}", a.at(Level::Sum), b.at(Level::Sum)), Level::Extreme))
            }
            (NumberFunction::Max, [a, b]) => {
                Ok(Text::new(format!("{} >? {}", a.at(Level::Sum), b.at(Level::Sum)), Level::Extreme))
            }
            (NumberFunction::Abs, [a]) => {
                let negative = Text::new(format!("-{}", a.at(Level::Atom)), Level::Unary).text;
                Ok(Text::new(format!("({} >? {negative})", a.at(Level::Sum)), Level::Atom))
            }
            (NumberFunction::Norm, _) => Err("`norm`".to_owned()),
            (NumberFunction::Min | NumberFunction::Max | NumberFunction::Abs, _) => {
                Err("a call without arguments".to_owned())
            }
        }
    }

    pub fn apply(&self, function: u16, args: &[Expr]) -> Said<String> {
        let at = usize::from(function);
        let name = self.functions.get(at).cloned().flatten();
        let name = name.ok_or("a function of another automaton")?;
        let params = self.params.get(at).map_or(&[] as &[_], Vec::as_slice);
        let of = params.iter().copied().chain(std::iter::repeat(None));
        let args = args.iter().zip(of).map(|(a, of)| self.expr(a, of).map(|t| t.text));
        Ok(format!("{name}({})", args.collect::<Said<Vec<_>>>()?.join(", ")))
    }

    // ── Places ──

    /// A variable, or an element that indices choose.
    pub fn place(&self, place: &Lvalue) -> Said<String> {
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

    pub fn time(&self, time: &TimeSum) -> Said<Text> {
        let mut terms = Vec::new();
        for term in &time.terms {
            let factor = self.units(term.factor)?;
            let value = self.expr(&term.value, None)?;
            terms.push(match factor {
                1 => value,
                n => Text::new(
                    format!("{} * {}", number(n).at(Level::Unary), value.at(Level::Unary)),
                    Level::Product,
                ),
            });
        }
        let constant = self.units(time.nanos)?;
        if constant != 0 || terms.is_empty() {
            terms.push(number(constant));
        }
        let text = terms
            .into_iter()
            .reduce(|a, b| Text::new(format!("{} + {}", a.at(Level::Sum), b.at(Level::Product)), Level::Sum));
        text.ok_or_else(|| "an empty time".to_owned())
    }

    fn units(&self, nanos: i64) -> Said<i64> {
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

    pub fn constraint(&self, c: &ClockConstraint) -> Said<String> {
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
        Ok(format!("{text} {sign} {}", self.time(&c.bound)?.at(Level::Sum)))
    }
}

pub fn number(n: i64) -> Text {
    Text::new(n.to_string(), if n < 0 { Level::Unary } else { Level::Atom })
}
