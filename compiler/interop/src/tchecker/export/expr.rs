//! Expressions and statements: TChecker has conjunctions and negations of comparisons, and `if` on numbers.

use hrdsl_ir::{
    Enumeration, Expr, Nanos, Program, Type, Value,
    expr::{BinaryOp, Lvalue, NumberFunction, UnaryOp},
    ta::{self, ClockConstraint, ClockId, ClockOp, EdgeAssignment, FunctionStatement, TimeSum},
};

use super::names::TcheckerNames;

/// Writes the expressions of one automaton, with constants for what an edge binds.
pub struct TcheckerExprWriter<'a> {
    program: &'a Program,
    names: &'a TcheckerNames,
    automaton: usize,
    unit: Nanos,
    /// What the slots after the automaton's own stand for.
    bound: SlotSubstitution<'a>,
}

#[derive(Clone, Copy)]
enum SlotSubstitution<'a> {
    /// Of an edge.
    Values(&'a [Value]),
    /// Of a function's body: the text of each parameter and local, and how many slots come before them.
    Texts(&'a [(String, bool)], usize),
}

type TcheckerTextResult = Result<String, String>;

/// How deep functions may be inserted into each other.
const MAX_DEPTH: u8 = 20;

impl<'a> TcheckerExprWriter<'a> {
    pub fn new(
        program: &'a Program,
        names: &'a TcheckerNames,
        automaton: usize,
        unit: Nanos,
        bound: &'a [Value],
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

    fn var(&self, slot: u16) -> TcheckerTextResult {
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
                Some(v) => number(self.program, *v),
                None => Err("a variable is not there".to_owned()),
            },
            SlotSubstitution::Texts(texts, known) => match texts.get(slot - known) {
                Some((text, _)) => Ok(text.clone()),
                None => Err("a variable is not there".to_owned()),
            },
        }
    }

    /// An element by its indices: arrays of arrays are one array.
    fn place(&self, place: &Lvalue, depth: u8) -> TcheckerTextResult {
        if place.indices.is_empty() {
            return self.var(place.slot);
        }
        let Some(at) = self.network_slot(usize::from(place.slot)) else {
            return Err("an array of a function has no counterpart in TChecker".to_owned());
        };
        let (int, element) = self.names.slots[at];
        let mut index = if element == 0 { String::new() } else { format!("{element}+") };
        let parts: Result<Vec<String>, String> = place
            .indices
            .iter()
            .map(|i| {
                let at = self.term(&i.at, depth)?;
                Ok(if i.stride == 1 { at } else { format!("{at}*{}", i.stride) })
            })
            .collect();
        index += &parts?.join("+");
        Ok(format!("{}[{index}]", self.names.ints[int].name))
    }

    fn is_bool(&self, e: &Expr) -> bool {
        match e {
            Expr::Const(Value::Bool(_)) | Expr::Unary(UnaryOp::Not, _) => true,
            Expr::Binary(op, ..) => {
                !matches!(op, BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem)
            }
            Expr::If(_, a, _) => self.is_bool(a),
            Expr::Apply(f, _) => {
                let function = self.program.functions.get(usize::from(f.0));
                function.and_then(|f| f.result.as_ref()).is_some_and(|r| r.is_bool)
            }
            Expr::Const(_)
            | Expr::Var(_)
            | Expr::Unary(UnaryOp::Neg, _)
            | Expr::Call(..)
            | Expr::List(..) => false,
            Expr::Element(_) => false,
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

    fn conjuncts(&self, e: &Expr, depth: u8, out: &mut Vec<String>) -> Result<(), String> {
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
                Some(sign) => Ok(format!("{}{sign}{}", self.term(a, depth)?, self.term(b, depth)?)),
                None => Ok(format!("{}=={}", self.truth(e, depth)?, i32::from(wanted))),
            },
            Expr::Const(Value::Bool(b)) => Ok(if *b == wanted { "1==1" } else { "1==0" }.to_owned()),
            _ => Ok(format!("{}=={}", self.term(e, depth)?, i32::from(wanted))),
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

    /// The number that a value is kept as.
    pub fn int(&self, e: &Expr, depth: u8) -> TcheckerTextResult {
        if depth > MAX_DEPTH {
            return Err("functions are nested too deep to be inserted".to_owned());
        }
        match e {
            Expr::Const(v) => number(self.program, *v),
            Expr::Var(slot) => self.var(*slot),
            Expr::Element(place) => self.place(place, depth),
            Expr::Unary(UnaryOp::Neg, a) => Ok(format!("-{}", self.term(a, depth)?)),
            Expr::Binary(op, a, b) => match arithmetic(*op) {
                Some(sign) => Ok(format!("{}{sign}{}", self.term(a, depth)?, self.term(b, depth)?)),
                None => self.truth(e, depth),
            },
            Expr::Unary(UnaryOp::Not, _) => self.truth(e, depth),
            Expr::If(c, a, b) => self.choice(c, &self.int(a, depth)?, &self.int(b, depth)?, depth),
            Expr::Call(function, args) => self.call(*function, args, depth),
            Expr::List(..) => Err("lists have no counterpart in TChecker".to_owned()),
            Expr::Apply(function, args) => self.applied(usize::from(function.0), args, depth),
        }
    }

    /// In parentheses, unless it is a number or a name.
    fn term(&self, e: &Expr, depth: u8) -> TcheckerTextResult {
        let text = self.int(e, depth)?;
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
        let args: Vec<String> = args.iter().map(|a| self.term(a, depth)).collect::<Result<_, _>>()?;
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
                Err("this function has no counterpart in TChecker".to_owned())
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
                "the function `{}` is more than one expression: TChecker has no functions",
                f.name
            ));
        };
        let texts: Vec<(String, bool)> = args
            .iter()
            .map(|a| Ok((self.term(a, depth)?, self.is_bool(a))))
            .collect::<Result<_, String>>()?;
        let inner = self.inside(f, &texts);
        inner.int(value, depth + 1)
    }

    fn inside<'b>(
        &'b self,
        f: &ta::AutomatonFunction,
        texts: &'b [(String, bool)],
    ) -> TcheckerExprWriter<'b> {
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

    fn clock(&self, clock: ClockId) -> &str {
        let at = usize::from(clock.0);
        let shared = self.names.shared_clocks;
        let at = if at < shared { at } else { self.names.first_clock[self.automaton] + at - shared };
        &self.names.clocks[at]
    }

    fn time(&self, time: &TimeSum) -> TcheckerTextResult {
        let mut parts = Vec::new();
        for term in &time.terms {
            parts.push(format!("{}*{}", self.term(&term.value, 0)?, term.factor / self.unit));
        }
        if time.nanos != 0 || parts.is_empty() {
            parts.push((time.nanos / self.unit).to_string());
        }
        Ok(parts.join("+"))
    }

    pub fn bound(&self, c: &ClockConstraint) -> TcheckerTextResult {
        let minus = c.minus.map_or(String::new(), |m| format!("-{}", self.clock(m)));
        let sign = match c.op {
            ClockOp::Lt => "<",
            ClockOp::Le => "<=",
            ClockOp::Eq => "==",
            ClockOp::Ge => ">=",
            ClockOp::Gt => ">",
        };
        Ok(format!("{}{minus}{sign}{}", self.clock(c.clock), self.time(&c.bound)?))
    }

    // ── Statements ──

    /// The statements of an update.
    ///
    /// # Errors
    /// What TChecker cannot say.
    pub fn update(
        &self,
        update: &EdgeAssignment,
        fresh: &mut dyn FnMut(&str) -> String,
    ) -> Result<Vec<String>, String> {
        match update {
            EdgeAssignment::Assign { place, value } => {
                Ok(vec![format!("{}={}", self.place(place, 0)?, self.int(value, 0)?)])
            }
            EdgeAssignment::Reset { clock, from, to } => {
                let from = from.map_or(String::new(), |f| format!("{}+", self.clock(f)));
                Ok(vec![format!("{}={from}{}", self.clock(*clock), self.time(to)?)])
            }
            EdgeAssignment::Call { function, args } => self.called(usize::from(function.0), args, 0, fresh),
        }
    }

    /// An update function, put in where it is called: its parameters and locals become local variables.
    fn called(
        &self,
        function: usize,
        args: &[Expr],
        depth: u8,
        fresh: &mut dyn FnMut(&str) -> String,
    ) -> Result<Vec<String>, String> {
        let Some(f) = self.program.functions.get(function) else {
            return Err("a function is not there".to_owned());
        };
        if depth > MAX_DEPTH {
            return Err("functions are nested too deep to be inserted".to_owned());
        }
        if f.locals.iter().any(|l| l.name.contains('[')) {
            return Err(format!("the function `{}` has an array of its own", f.name));
        }
        let mut out = Vec::new();
        let mut texts = Vec::new();
        for (i, var) in f.params.iter().chain(&f.locals).enumerate() {
            let name = fresh(&var.name);
            let init = match args.get(i).filter(|_| i < f.params.len()) {
                Some(arg) => self.int(arg, depth)?,
                None => var.init.to_string(),
            };
            out.push(format!("local {name}={init}"));
            texts.push((name, var.is_bool));
        }
        let inner = self.inside(f, &texts);
        let body = match f.body.split_last() {
            Some((FunctionStatement::Return(None), rest)) => rest,
            Some(_) | None => &f.body,
        };
        inner.statements(body, depth + 1, fresh, &mut out)?;
        Ok(out)
    }

    fn statements(
        &self,
        body: &[FunctionStatement],
        depth: u8,
        fresh: &mut dyn FnMut(&str) -> String,
        out: &mut Vec<String>,
    ) -> Result<(), String> {
        for statement in body {
            match statement {
                FunctionStatement::Assign { place, value } => {
                    out.push(format!("{}={}", self.place(place, depth)?, self.int(value, depth)?));
                }
                FunctionStatement::Call { function, args } => {
                    out.extend(self.called(usize::from(function.0), args, depth, fresh)?);
                }
                FunctionStatement::If { condition, then, otherwise } => {
                    let (mut a, mut b) = (Vec::new(), Vec::new());
                    self.statements(then, depth, fresh, &mut a)?;
                    self.statements(otherwise, depth, fresh, &mut b)?;
                    let tail = if b.is_empty() { String::new() } else { format!(" else {}", b.join("; ")) };
                    let then = if a.is_empty() { "nop".to_owned() } else { a.join("; ") };
                    out.push(format!("if {} then {then}{tail} end", self.all(condition, depth)?));
                }
                FunctionStatement::While { condition, body } => {
                    let mut inner = Vec::new();
                    self.statements(body, depth, fresh, &mut inner)?;
                    out.push(format!("while {} do {} end", self.all(condition, depth)?, inner.join("; ")));
                }
                FunctionStatement::For { slot, lo, hi, body } => {
                    let (at, last) = (self.var(*slot)?, fresh("last"));
                    out.push(format!("local {last}={}", self.int(hi, depth)?));
                    out.push(format!("{at}={}", self.int(lo, depth)?));
                    let mut inner = Vec::new();
                    self.statements(body, depth, fresh, &mut inner)?;
                    inner.push(format!("{at}={at}+1"));
                    out.push(format!("while {at}<={last} do {} end", inner.join("; ")));
                }
                FunctionStatement::Return(_) => {
                    return Err("a function returns before its end: TChecker has no `return`".to_owned());
                }
            }
        }
        Ok(())
    }

    fn all(&self, condition: &Expr, depth: u8) -> TcheckerTextResult {
        let mut parts = Vec::new();
        self.conjuncts(condition, depth, &mut parts)?;
        Ok(if parts.is_empty() { "1==1".to_owned() } else { parts.join(" && ") })
    }
}

/// The number that a value is kept as.
pub fn number(program: &Program, v: Value) -> TcheckerTextResult {
    match v {
        Value::Bool(b) => Ok(i32::from(b).to_string()),
        Value::Int(n) if n < 0 => Ok(format!("({n})")),
        Value::Int(n) => Ok(n.to_string()),
        Value::Symbol(symbol) => {
            let mut found: Vec<usize> =
                enumerations(program).into_iter().filter_map(|e| e.index_of(symbol)).collect();
            found.dedup();
            match found.as_slice() {
                [index] => Ok(index.to_string()),
                [] | [_, _, ..] => Err(format!("`{v}` is a value of several enumerations")),
            }
        }
        Value::Float(_) | Value::Text(_) | Value::List(_) => {
            Err(format!("`{v}` is no number: TChecker has integers only"))
        }
    }
}

/// All enumerations that variables and parameters are of, without repetition.
fn enumerations(program: &Program) -> Vec<Enumeration> {
    let automata = program.automata.iter();
    let own = automata.flat_map(|a| a.vars.iter().chain(a.edges.iter().flat_map(|e| &e.selects)));
    let functions = program.functions.iter().flat_map(|f| f.params.iter().chain(&f.locals));
    let channels = program.channels.iter().flat_map(|c| &c.params);
    let vars = program.shared.iter().chain(own).chain(functions).chain(channels);
    let events = program.events.iter().flat_map(|e| &e.params).filter_map(|p| match p.ty {
        Type::Enum(e) => Some(e),
        Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Text | Type::List(_) => None,
    });
    let mut all: Vec<Enumeration> = Vec::new();
    for e in vars.filter_map(|v| v.enumeration).chain(events) {
        if !all.contains(&e) {
            all.push(e);
        }
    }
    all
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
