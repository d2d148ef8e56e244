//! Expressions: TChecker has conjunctions and negations of comparisons, and `if` on numbers.

use hrdsl_ir::{
    Enumeration, Expr, Nanos, Program, Value,
    expr::{BinaryOp, Lvalue, NumberFunction, UnaryOp},
    ta::{self, ClockConstraint, ClockId, ClockOp, FunctionStatement, TimeSum},
};

use super::{
    names::TcheckerNames,
    value::{BoundTcheckerValue, GuardPart, TcheckerTextResult, number},
};

/// Writes the expressions of one automaton, with constants for what an edge binds.
pub struct TcheckerExprWriter<'a> {
    pub(super) program: &'a Program,
    names: &'a TcheckerNames,
    automaton: usize,
    unit: Nanos,
    /// What the slots after the automaton's own stand for.
    bound: SlotSubstitution<'a>,
}

#[derive(Clone, Copy)]
enum SlotSubstitution<'a> {
    /// Of an edge.
    Values(&'a [BoundTcheckerValue]),
    /// Of a function's body: each parameter and local, and how many slots come before them.
    Texts(&'a [LocalText], usize),
}

/// A parameter or local of a function that is put in: its text, and the enumeration that it is of.
pub struct LocalText {
    pub text: String,
    pub of: Option<Enumeration>,
}

/// How deep functions may be inserted into each other.
pub const MAX_DEPTH: u8 = 20;

impl<'a> TcheckerExprWriter<'a> {
    pub fn new(
        program: &'a Program,
        names: &'a TcheckerNames,
        automaton: usize,
        unit: Nanos,
        bound: &'a [BoundTcheckerValue],
    ) -> Self {
        Self { program, names, automaton, unit, bound: SlotSubstitution::Values(bound) }
    }

    /// How many variables the automaton sees: the shared ones and its own.
    fn own_slots(&self) -> usize {
        let end = self.names.first_slot.get(self.automaton + 1).copied().unwrap_or(self.names.slots.len());
        self.names.shared_slots + end - self.names.first_slot[self.automaton]
    }

    /// The network's slot of what the automaton calls `slot`.
    fn network_slot(&self, slot: usize) -> Option<usize> {
        if slot < self.names.shared_slots {
            return Some(slot);
        }
        (slot < self.known()).then(|| self.names.first_slot[self.automaton] + slot - self.names.shared_slots)
    }

    /// How many slots come before what is bound.
    fn known(&self) -> usize {
        match self.bound {
            SlotSubstitution::Values(_) => self.own_slots(),
            SlotSubstitution::Texts(_, known) => known,
        }
    }

    pub fn var(&self, slot: u16) -> TcheckerTextResult {
        let slot = usize::from(slot);
        if let Some(at) = self.network_slot(slot) {
            let (int, element) = self.names.slots[at];
            let int = &self.names.ints[int];
            return Ok(if int.inits.len() > 1 {
                format!("{}[{element}]", int.name)
            } else {
                int.name.clone()
            });
        }
        match self.bound {
            SlotSubstitution::Values(values) => match values.get(slot - self.known()) {
                Some(v) => number(self.program, v.value, v.of),
                None => Err("a variable is not there".to_owned()),
            },
            SlotSubstitution::Texts(texts, known) => match texts.get(slot - known) {
                Some(local) => Ok(local.text.clone()),
                None => Err("a variable is not there".to_owned()),
            },
        }
    }

    /// An element by its indices: arrays of arrays are one array.
    pub fn place(&self, place: &Lvalue, depth: u8) -> TcheckerTextResult {
        if place.indices.is_empty() {
            return self.var(place.slot);
        }
        let Some(at) = self.network_slot(usize::from(place.slot)) else {
            return Err(
                "TChecker's local arrays cannot be put in: make it a variable of the automaton".to_owned()
            );
        };
        let (int, element) = self.names.slots[at];
        let mut index = if element == 0 { String::new() } else { format!("{element}+") };
        let parts: Result<Vec<String>, String> = place
            .indices
            .iter()
            .map(|i| {
                let at = self.term(&i.at, None, depth)?;
                Ok(if i.stride == 1 { at } else { format!("{at}*{}", i.stride) })
            })
            .collect();
        index += &parts?.join("+");
        Ok(format!("{}[{index}]", self.names.ints[int].name))
    }

    /// The enumeration that a variable is of.
    pub fn enumeration_of(&self, slot: u16) -> Option<Enumeration> {
        let slot = usize::from(slot);
        if let Some(at) = self.network_slot(slot) {
            return self.names.ints[self.names.slots[at].0].enumeration;
        }
        let at = slot.checked_sub(self.known())?;
        match self.bound {
            SlotSubstitution::Values(values) => values.get(at).and_then(|v| v.of),
            SlotSubstitution::Texts(texts, _) => texts.get(at).and_then(|local| local.of),
        }
    }

    /// The enumeration that an expression's value is of, if the expression alone tells.
    fn enumeration(&self, e: &Expr) -> Option<Enumeration> {
        match e {
            Expr::Var(slot) => self.enumeration_of(*slot),
            Expr::Element(place) => self.enumeration_of(place.slot),
            Expr::If(_, a, b) => self.enumeration(a).or_else(|| self.enumeration(b)),
            Expr::Apply(f, _) => {
                let function = self.program.functions.get(usize::from(f.0));
                function.and_then(|f| f.result.as_ref()).and_then(|r| r.enumeration)
            }
            Expr::Const(_) | Expr::Unary(..) | Expr::Binary(..) | Expr::Call(..) | Expr::List(..) => None,
        }
    }

    // ── Conditions ──

    /// The parts of a condition.
    ///
    /// # Errors
    /// What TChecker cannot say.
    pub fn conjunction(&self, e: &Expr) -> Result<Vec<String>, String> {
        let mut out = Vec::new();
        self.conjuncts(e, 0, &mut out)?;
        Ok(out)
    }

    pub fn conjuncts(&self, e: &Expr, depth: u8, out: &mut Vec<String>) -> Result<(), String> {
        match e {
            Expr::Binary(BinaryOp::And, a, b) => {
                self.conjuncts(a, depth, out)?;
                self.conjuncts(b, depth, out)
            }
            Expr::Const(Value::Bool(true)) => Ok(()),
            _ => {
                out.push(self.atom(e, true, depth)?);
                Ok(())
            }
        }
    }

    /// A comparison that is true where the condition is what it is wanted to be.
    fn atom(&self, e: &Expr, wanted: bool, depth: u8) -> TcheckerTextResult {
        match e {
            Expr::Unary(UnaryOp::Not, a) => self.atom(a, !wanted, depth),
            Expr::Binary(op, a, b) => match comparison(*op, wanted) {
                Some(sign) => {
                    let of = self.enumeration(a).or_else(|| self.enumeration(b));
                    Ok(format!("{}{sign}{}", self.term(a, of, depth)?, self.term(b, of, depth)?))
                }
                None => Ok(format!("{}=={}", self.truth(e, depth)?, i32::from(wanted))),
            },
            Expr::Const(Value::Bool(b)) => Ok(if *b == wanted { "1==1" } else { "1==0" }.to_owned()),
            _ => Ok(format!("{}=={}", self.term(e, None, depth)?, i32::from(wanted))),
        }
    }

    /// A condition as 0 or 1.
    fn truth(&self, e: &Expr, depth: u8) -> TcheckerTextResult {
        match e {
            Expr::Binary(BinaryOp::Or, a, b) => {
                let mut left = Vec::new();
                self.conjuncts(a, depth, &mut left)?;
                let otherwise = self.truth(b, depth)?;
                Ok(if left.is_empty() {
                    "1".to_owned()
                } else {
                    format!("(if {} then 1 else {otherwise})", left.join(" && "))
                })
            }
            _ => {
                let mut parts = Vec::new();
                self.conjuncts(e, depth, &mut parts)?;
                Ok(if parts.is_empty() {
                    "1".to_owned()
                } else {
                    format!("(if {} then 1 else 0)", parts.join(" && "))
                })
            }
        }
    }

    // ── Numbers ──

    /// The number that a value is kept as; `of` is the enumeration that it is of, where the place tells.
    pub fn int(&self, e: &Expr, of: Option<Enumeration>, depth: u8) -> TcheckerTextResult {
        if depth > MAX_DEPTH {
            return Err("functions are nested too deep to be inserted".to_owned());
        }
        match e {
            Expr::Const(v) => number(self.program, *v, of),
            Expr::Var(slot) => self.var(*slot),
            Expr::Element(place) => self.place(place, depth),
            Expr::Unary(UnaryOp::Neg, a) => Ok(format!("-{}", self.term(a, None, depth)?)),
            Expr::Binary(op, a, b) => match arithmetic(*op) {
                Some(sign) => {
                    Ok(format!("{}{sign}{}", self.term(a, None, depth)?, self.term(b, None, depth)?))
                }
                None => self.truth(e, depth),
            },
            Expr::Unary(UnaryOp::Not, _) => self.truth(e, depth),
            Expr::If(c, a, b) => self.choice(c, &self.int(a, of, depth)?, &self.int(b, of, depth)?, depth),
            Expr::Call(function, args) => self.call(*function, args, depth),
            Expr::List(..) => Err("TChecker has no lists: keep what is in it in an array".to_owned()),
            Expr::Apply(function, args) => self.applied(usize::from(function.0), args, depth),
        }
    }

    /// In parentheses, unless it is a number or a name.
    pub fn term(&self, e: &Expr, of: Option<Enumeration>, depth: u8) -> TcheckerTextResult {
        let text = self.int(e, of, depth)?;
        let simple = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        Ok(if simple || text.starts_with("(if ") { text } else { format!("({text})") })
    }

    fn choice(&self, condition: &Expr, then: &str, otherwise: &str, depth: u8) -> TcheckerTextResult {
        let mut parts = Vec::new();
        self.conjuncts(condition, depth, &mut parts)?;
        Ok(if parts.is_empty() {
            then.to_owned()
        } else {
            format!("(if {} then {then} else {otherwise})", parts.join(" && "))
        })
    }

    fn call(&self, function: NumberFunction, args: &[Expr], depth: u8) -> TcheckerTextResult {
        let args: Vec<String> = args.iter().map(|a| self.term(a, None, depth)).collect::<Result<_, _>>()?;
        let choose = |sign: &str| {
            let fold =
                |best: String, next: &String| format!("(if {best}{sign}{next} then {best} else {next})");
            args.iter().skip(1).fold(args.first().cloned().unwrap_or_default(), fold)
        };
        match (function, args.as_slice()) {
            (NumberFunction::Abs, [a]) => Ok(format!("(if {a}<0 then -{a} else {a})")),
            (NumberFunction::Min, [_, ..]) => Ok(choose("<=")),
            (NumberFunction::Max, [_, ..]) => Ok(choose(">=")),
            (NumberFunction::Abs | NumberFunction::Min | NumberFunction::Max | NumberFunction::Norm, _) => {
                Err("TChecker has integers only, and `norm` is none: compare the sum of the squares"
                    .to_owned())
            }
        }
    }

    /// A function that is one expression, with its arguments put in.
    fn applied(&self, function: usize, args: &[Expr], depth: u8) -> TcheckerTextResult {
        let Some(f) = self.program.functions.get(function) else {
            return Err("a function is not there".to_owned());
        };
        let [FunctionStatement::Return(Some(value))] = f.body.as_slice() else {
            return Err(format!(
                "the function `{}` is more than one expression where a value is needed, and TChecker has no functions: \
                 write it as one expression, or let an update keep its value in a variable",
                f.name
            ));
        };
        let one = |(a, param): (&Expr, &ta::AutomatonVar)| {
            Ok(LocalText { text: self.term(a, param.enumeration, depth)?, of: param.enumeration })
        };
        let texts: Vec<LocalText> = args.iter().zip(&f.params).map(one).collect::<Result<_, String>>()?;
        let of = f.result.as_ref().and_then(|r| r.enumeration);
        self.inside(f, &texts).int(value, of, depth + 1)
    }

    pub fn inside<'b>(&'b self, f: &ta::AutomatonFunction, texts: &'b [LocalText]) -> TcheckerExprWriter<'b> {
        let known = if f.owner.is_some() { self.own_slots() } else { self.names.shared_slots };
        let bound = SlotSubstitution::Texts(texts, known);
        TcheckerExprWriter {
            program: self.program,
            names: self.names,
            automaton: self.automaton,
            unit: self.unit,
            bound,
        }
    }

    // ── Clocks ──

    pub fn clock(&self, clock: ClockId) -> &str {
        let at = usize::from(clock.0);
        let shared = self.names.shared_clocks;
        let at = if at < shared { at } else { self.names.first_clock[self.automaton] + at - shared };
        &self.names.clocks[at]
    }

    pub fn time(&self, time: &TimeSum) -> TcheckerTextResult {
        let mut parts = Vec::new();
        for term in &time.terms {
            parts.push(format!("{}*{}", self.term(&term.value, None, 0)?, term.factor / self.unit));
        }
        if time.nanos != 0 || parts.is_empty() {
            parts.push((time.nanos / self.unit).to_string());
        }
        Ok(parts.join("+"))
    }

    pub fn bound(&self, c: &ClockConstraint) -> TcheckerTextResult {
        Ok(self.clock_part(c)?.text)
    }

    /// A bound on a clock, and the ways in which it does not hold.
    pub fn clock_part(&self, c: &ClockConstraint) -> Result<GuardPart, String> {
        let minus = c.minus.map_or(String::new(), |m| format!("-{}", self.clock(m)));
        let (sign, opposite): (_, &[&str]) = match c.op {
            ClockOp::Lt => ("<", &[">="]),
            ClockOp::Le => ("<=", &[">"]),
            ClockOp::Eq => ("==", &["<", ">"]),
            ClockOp::Ge => (">=", &["<"]),
            ClockOp::Gt => (">", &["<="]),
        };
        let (clock, time) = (self.clock(c.clock), self.time(&c.bound)?);
        let text = |sign: &str| format!("{clock}{minus}{sign}{time}");
        Ok(GuardPart { text: text(sign), closed: opposite.iter().map(|sign| text(sign)).collect() })
    }
}

/// How an operator is written.
enum OperatorSigns {
    Arithmetic(&'static str),
    /// With the sign of the opposite.
    Comparison(&'static str, &'static str),
    /// `&&` and `||` have no signs: guards are split up.
    Logic,
}

fn signs(op: BinaryOp) -> OperatorSigns {
    match op {
        BinaryOp::Add => OperatorSigns::Arithmetic("+"),
        BinaryOp::Sub => OperatorSigns::Arithmetic("-"),
        BinaryOp::Mul => OperatorSigns::Arithmetic("*"),
        BinaryOp::Div => OperatorSigns::Arithmetic("/"),
        BinaryOp::Rem => OperatorSigns::Arithmetic("%"),
        BinaryOp::Eq => OperatorSigns::Comparison("==", "!="),
        BinaryOp::Ne => OperatorSigns::Comparison("!=", "=="),
        BinaryOp::Lt => OperatorSigns::Comparison("<", ">="),
        BinaryOp::Le => OperatorSigns::Comparison("<=", ">"),
        BinaryOp::Gt => OperatorSigns::Comparison(">", "<="),
        BinaryOp::Ge => OperatorSigns::Comparison(">=", "<"),
        BinaryOp::And | BinaryOp::Or => OperatorSigns::Logic,
    }
}

fn comparison(op: BinaryOp, wanted: bool) -> Option<&'static str> {
    let OperatorSigns::Comparison(yes, no) = signs(op) else { return None };
    Some(if wanted { yes } else { no })
}

fn arithmetic(op: BinaryOp) -> Option<&'static str> {
    if let OperatorSigns::Arithmetic(sign) = signs(op) { Some(sign) } else { None }
}
