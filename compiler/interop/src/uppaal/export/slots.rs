//! Variables: what they are called in UPPAAL, arrays put together again from their elements, and what `Expr::Var` stands for.

use hrdsl_ir::{Enumeration, ta::AutomatonVar};
use indexmap::IndexSet;

/// Names that are in use.
#[derive(Clone, Debug, Default)]
pub struct UppaalNames(IndexSet<String>);

/// Words of UPPAAL's language that are no names.
const KEYWORDS: &[&str] = &[
    "A",
    "E",
    "M",
    "R",
    "U",
    "W",
    "abs",
    "after_update",
    "and",
    "assert",
    "assign",
    "before_update",
    "bool",
    "branchpoint",
    "break",
    "broadcast",
    "case",
    "chan",
    "clock",
    "commit",
    "const",
    "continue",
    "control",
    "deadlock",
    "default",
    "do",
    "double",
    "dynamic",
    "else",
    "enum",
    "exists",
    "exit",
    "false",
    "fint",
    "for",
    "forall",
    "gantt",
    "guard",
    "hybrid",
    "if",
    "imply",
    "import",
    "inf",
    "init",
    "int",
    "int16_t",
    "int32_t",
    "int64_t",
    "int8_t",
    "invariant",
    "max",
    "meta",
    "min",
    "not",
    "numOf",
    "or",
    "priority",
    "probability",
    "proctype",
    "process",
    "progress",
    "query",
    "rate",
    "return",
    "scalar",
    "select",
    "simulate",
    "spawn",
    "state",
    "strategy",
    "string",
    "struct",
    "sum",
    "sup",
    "switch",
    "sync",
    "system",
    "trans",
    "true",
    "type",
    "typedef",
    "uint16_t",
    "uint32_t",
    "uint8_t",
    "urgent",
    "void",
    "while",
];

impl UppaalNames {
    /// A name that nothing else has.
    pub fn fresh(&mut self, wanted: &str) -> String {
        let clean: String = wanted.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let mut name = clean.trim_end_matches('_').to_owned();
        if name.is_empty() || name.starts_with(|c: char| c.is_ascii_digit()) {
            name.insert(0, 'x');
        }
        let base = name.clone();
        let mut n = 1;
        while KEYWORDS.contains(&name.as_str()) || !self.0.insert(name.clone()) {
            n += 1;
            name = format!("{base}_{n}");
        }
        name
    }
}

/// One variable as an expression sees it.
#[derive(Clone, Debug)]
pub struct UppaalSlot {
    /// What reads it and, unless it is a binder, what assigns it.
    pub text: String,
    /// A bool that UPPAAL keeps as a number of 0..1.
    pub as_number: bool,
    pub enumeration: Option<Enumeration>,
}

/// Variables that are one array in UPPAAL.
#[derive(Clone, Debug)]
pub struct SlotArray {
    /// The slot of the first element.
    pub first: usize,
    pub name: String,
    /// How many indices each dimension has, from the outermost.
    pub dims: Vec<usize>,
}

impl SlotArray {
    pub fn count(&self) -> usize {
        self.dims.iter().product()
    }

    /// How far apart the elements of each dimension are.
    pub fn strides(&self) -> Vec<usize> {
        (0..self.dims.len()).map(|d| self.dims[d + 1..].iter().product()).collect()
    }
}

/// What the variables of a place in the program are.
#[derive(Clone, Debug, Default)]
pub struct UppaalSlotTable {
    pub slots: Vec<UppaalSlot>,
    pub groups: Vec<SlotArray>,
}

impl UppaalSlotTable {
    /// Adds variables and gives their declarations.
    pub fn declare(&mut self, vars: &[AutomatonVar], names: &mut UppaalNames) -> Vec<String> {
        let mut lines = Vec::new();
        let mut at = 0;
        while at < vars.len() {
            let rest = &vars[at..];
            let (base, dims) = array(rest).unwrap_or_else(|| (rest[0].name.clone(), Vec::new()));
            let name = names.fresh(&base);
            let count = dims.iter().product::<usize>();
            let group = SlotArray { first: self.slots.len(), name: name.clone(), dims };
            for (offset, var) in rest.iter().enumerate().take(count) {
                let mut text = name.clone();
                let mut left = offset;
                for stride in group.strides() {
                    text += &format!("[{}]", left / stride);
                    left %= stride;
                }
                self.slots.push(UppaalSlot { text, ..slot(var) });
            }
            let sizes: String = group.dims.iter().map(|d| format!("[{d}]")).collect();
            let init = initial(&rest[..count], &group.dims);
            lines.push(format!("{} {name}{sizes} = {init};", ty(&rest[0])));
            if !group.dims.is_empty() {
                self.groups.push(group);
            }
            at += count;
        }
        lines
    }

    /// The same with a prefix on everything from a slot on: as queries name what a process has.
    pub fn prefixed(mut self, prefix: &str) -> Self {
        self.slots.iter_mut().for_each(|s| s.text.insert_str(0, prefix));
        self.groups.iter_mut().for_each(|g| g.name.insert_str(0, prefix));
        self
    }

    pub fn append(&mut self, other: UppaalSlotTable) {
        let shift = self.slots.len();
        self.slots.extend(other.slots);
        self.groups.extend(other.groups.into_iter().map(|g| SlotArray { first: g.first + shift, ..g }));
    }
}

pub fn slot(var: &AutomatonVar) -> UppaalSlot {
    UppaalSlot { text: var.name.clone(), as_number: false, enumeration: var.enumeration }
}

pub fn ty(var: &AutomatonVar) -> String {
    if var.is_bool { "bool".to_owned() } else { format!("int[{},{}]", var.lo, var.hi) }
}

fn value(var: &AutomatonVar, n: i64) -> String {
    if var.is_bool { (n != 0).to_string() } else { n.to_string() }
}

fn initial(vars: &[AutomatonVar], dims: &[usize]) -> String {
    let Some((_, rest)) = dims.split_first() else {
        return vars.first().map_or_else(|| "0".to_owned(), |v| value(v, v.init));
    };
    let part = rest.iter().product::<usize>().max(1);
    let parts: Vec<String> = vars.chunks(part).map(|vars| initial(vars, rest)).collect();
    format!("{{ {} }}", parts.join(", "))
}

/// The array that begins with the first variable: its name and its sizes, if its elements follow in order.
fn array(vars: &[AutomatonVar]) -> Option<(String, Vec<usize>)> {
    let (base, zeros) = indices(&vars.first()?.name)?;
    if zeros.iter().any(|i| *i != 0) {
        return None;
    }
    let belongs =
        |v: &&AutomatonVar| indices(&v.name).is_some_and(|(b, at)| b == base && at.len() == zeros.len());
    let elements: Vec<&AutomatonVar> = vars.iter().take_while(belongs).collect();
    let last = indices(&elements.last()?.name)?.1;
    let dims: Vec<usize> = last.iter().map(|i| i + 1).collect();
    let same = |v: &&AutomatonVar| {
        let first = &vars[0];
        (v.lo, v.hi, v.is_bool, v.enumeration) == (first.lo, first.hi, first.is_bool, first.enumeration)
    };
    let in_order = elements.iter().enumerate().all(|(n, v)| {
        let Some((_, at)) = indices(&v.name) else { return false };
        at.iter().zip(&dims).fold(0, |sum, (i, d)| sum * d + i) == n
    });
    let whole = elements.len() == dims.iter().product::<usize>();
    (whole && in_order && elements.iter().all(same)).then(|| (base.to_owned(), dims))
}

/// `q[1][0]` is `q` and 1, 0. A field after the indices makes it no element.
fn indices(name: &str) -> Option<(&str, Vec<usize>)> {
    let (base, rest) = name.split_once('[')?;
    let inner = rest.strip_suffix(']')?;
    let at: Option<Vec<usize>> = inner.split("][").map(|i| i.parse().ok()).collect();
    Some((base, at?))
}
