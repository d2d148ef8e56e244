//! Values as TChecker's integers, and parts of guards. A value of an enumeration is its number there, so that it must be known which one is meant.

use hrdsl_ir::{Enumeration, Program, Type, Value};

pub type TcheckerTextResult = Result<String, String>;

/// One part of a guard's conjunction.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct GuardPart {
    pub text: String,
    /// The ways in which it is false: TChecker has no negation of what is asked of clocks.
    pub closed: Vec<String>,
}

impl GuardPart {
    /// A part that asks for integers alone.
    pub fn of_integers(text: String) -> Self {
        let closed = vec![format!("!({text})")];
        Self { text, closed }
    }
}

/// A value that an edge binds, and the enumeration that it is of, if it is of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundTcheckerValue {
    pub value: Value,
    pub of: Option<Enumeration>,
}

/// The number that a value is kept as; `of` is the enumeration that it is of, where the place tells.
///
/// # Errors
/// The value is no integer, or of several enumerations, and nothing tells which is meant.
pub fn number(program: &Program, v: Value, of: Option<Enumeration>) -> TcheckerTextResult {
    match v {
        Value::Bool(b) => Ok(i32::from(b).to_string()),
        Value::Int(n) if n < 0 => Ok(format!("({n})")),
        Value::Int(n) => Ok(n.to_string()),
        Value::Symbol(symbol) => {
            if let Some(index) = of.and_then(|e| e.index_of(symbol)) {
                return Ok(index.to_string());
            }
            let mut found: Vec<usize> =
                enumerations(program).into_iter().filter_map(|e| e.index_of(symbol)).collect();
            found.dedup();
            match found.as_slice() {
                [index] => Ok(index.to_string()),
                [] | [_, _, ..] => Err(format!(
                    "`{v}` is a value of several enumerations, and nothing here says of which: compare it with a variable"
                )),
            }
        }
        Value::Float(_) | Value::Text(_) | Value::List(_) => {
            Err(format!("`{v}` is no number: TChecker has integers only; say it by an `int`, as in tenths"))
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
