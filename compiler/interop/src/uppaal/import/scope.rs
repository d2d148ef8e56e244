//! What names stand for, and what they are called in the scenario.

use std::rc::Rc;

use hrdsl_source::Span;
use hrdsl_syntax::token::{KEYWORDS, KeywordClass};
use indexmap::{IndexMap, IndexSet};

use super::ast;

/// An expression of the scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenarioExprText {
    pub text: String,
    pub level: ScenarioPrecedence,
    pub is_bool: bool,
    /// A bool as 0 or 1.
    pub value: Option<i64>,
}

/// How tightly an expression holds together, from the loosest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ScenarioPrecedence {
    Imply,
    Or,
    And,
    Not,
    Comparison,
    Sum,
    Product,
    Factor,
    Atom,
}

impl ScenarioExprText {
    pub fn int(n: i64) -> Self {
        let level = if n < 0 { ScenarioPrecedence::Factor } else { ScenarioPrecedence::Atom };
        Self { text: n.to_string(), level, is_bool: false, value: Some(n) }
    }

    pub fn bool(b: bool) -> Self {
        Self {
            text: b.to_string(),
            level: ScenarioPrecedence::Atom,
            is_bool: true,
            value: Some(i64::from(b)),
        }
    }

    pub fn new(text: String, level: ScenarioPrecedence, is_bool: bool) -> Self {
        Self { text, level, is_bool, value: None }
    }

    /// In parentheses, if it holds together less tightly than it must here.
    pub fn at(&self, level: ScenarioPrecedence) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text.clone() }
    }

    /// As a number: 1 for true, 0 for false.
    pub fn into_int(self) -> Self {
        match (self.is_bool, self.value) {
            (false, _) => self,
            (true, Some(n)) => Self::int(n),
            (true, None) => {
                Self::new(format!("if {} {{ 1 }} else {{ 0 }}", self.text), ScenarioPrecedence::Atom, false)
            }
        }
    }

    /// As a condition: a number is true if it is not 0.
    pub fn into_bool(self) -> Self {
        match (self.is_bool, self.value) {
            (true, _) => self,
            (false, Some(n)) => Self::bool(n != 0),
            (false, None) => Self::new(
                format!("{} != 0", self.at(ScenarioPrecedence::Sum)),
                ScenarioPrecedence::Comparison,
                true,
            ),
        }
    }

    pub fn of_type(self, is_bool: bool) -> Self {
        if is_bool { self.into_bool() } else { self.into_int() }
    }
}

/// The type of single values.
#[derive(Clone, Debug, PartialEq)]
pub struct UppaalScalarType {
    pub is_bool: bool,
    pub lo: i64,
    pub hi: i64,
    /// `bool`, or `lo..hi` as written.
    pub text: String,
}

impl UppaalScalarType {
    pub fn bool() -> Self {
        Self { is_bool: true, lo: 0, hi: 1, text: "bool".to_owned() }
    }

    pub fn range(lo: i64, hi: i64) -> Self {
        Self { is_bool: false, lo, hi, text: format!("{lo}..{hi}") }
    }

    /// The value of a variable that is given none.
    pub fn default(&self) -> i64 {
        if self.lo <= 0 && 0 <= self.hi { 0 } else { self.lo }
    }

    pub fn literal(&self, n: i64) -> ScenarioExprText {
        if self.is_bool { ScenarioExprText::bool(n != 0) } else { ScenarioExprText::int(n) }
    }
}

/// The indices of one dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexRange {
    pub lo: i64,
    pub hi: i64,
}

impl IndexRange {
    pub fn count(self) -> i64 {
        self.hi - self.lo + 1
    }
}

#[derive(Clone, Debug)]
pub enum UppaalSymbolType {
    Data(UppaalScalarType, Vec<IndexRange>),
    Clock(Vec<IndexRange>),
    Chan {
        urgent: bool,
        broadcast: bool,
        dims: Vec<IndexRange>,
    },
    /// `struct`: its fields in order.
    Record(Vec<(String, UppaalSymbolType)>, Vec<IndexRange>),
    Void,
}

#[derive(Clone, Debug)]
pub struct VarSym {
    pub name: String,
    pub ty: UppaalScalarType,
    /// Those that no index has been given for.
    pub dims: Vec<IndexRange>,
    /// The indices given so far, counted from 0.
    pub at: Vec<ScenarioExprText>,
    /// Of a constant array.
    pub values: Option<Rc<ArrayOf>>,
    /// Belongs to a process.
    pub own: bool,
    /// Belongs to a function.
    pub local: bool,
    pub readonly: bool,
}

/// The values of a constant array, the last dimension fastest.
#[derive(Debug)]
pub struct ArrayOf {
    pub sizes: Vec<usize>,
    pub values: Vec<i64>,
}

#[derive(Clone, Debug)]
pub struct ClockSym {
    pub name: String,
    pub dims: Vec<IndexRange>,
    pub own: bool,
}

#[derive(Clone, Debug)]
pub struct ChanSym {
    pub name: String,
    pub dims: Vec<IndexRange>,
    pub at: Vec<ScenarioExprText>,
    pub urgent: bool,
    pub broadcast: bool,
}

/// A record: each of its fields is a variable of its own, or an array if the record is in one.
#[derive(Clone, Debug)]
pub struct RecordSym {
    pub name: String,
    /// Those that no index has been given for.
    pub dims: Vec<IndexRange>,
    pub fields: IndexMap<String, UppaalSymbol>,
}

#[derive(Debug)]
pub struct FunctionSym {
    pub decl: ast::UppaalFunction,
    pub params: Vec<UppaalSymbolType>,
    pub result: Option<UppaalScalarType>,
    pub own: bool,
    /// It is not written as a function, but its statements where it is called.
    pub sets_clocks: bool,
    /// Its name, if it has no parameters that are references: then there is one function for all calls.
    pub name: Option<String>,
}

#[derive(Clone, Debug)]
pub enum UppaalSymbol {
    Const(ScenarioExprText),
    Var(VarSym),
    Clock(ClockSym),
    Chan(ChanSym),
    Record(RecordSym),
    Type(UppaalSymbolType),
    Function(Rc<FunctionSym>),
    /// In queries: that a process is there.
    Location(String),
}

impl UppaalSymbol {
    pub fn is_clock(&self) -> bool {
        matches!(self, UppaalSymbol::Clock(_))
    }

    /// It is a clock, or a record with one.
    pub fn has_clocks(&self) -> bool {
        self.leaves().into_iter().any(UppaalSymbol::is_clock)
    }

    /// The indices that it still takes; none of what is no array and cannot be one.
    pub fn dims(&self) -> Option<&Vec<IndexRange>> {
        match self {
            UppaalSymbol::Var(v) => Some(&v.dims),
            UppaalSymbol::Clock(c) => Some(&c.dims),
            UppaalSymbol::Chan(c) => Some(&c.dims),
            UppaalSymbol::Record(r) => Some(&r.dims),
            UppaalSymbol::Const(_)
            | UppaalSymbol::Type(_)
            | UppaalSymbol::Function(_)
            | UppaalSymbol::Location(_) => None,
        }
    }

    pub fn first_dim(&self) -> Option<IndexRange> {
        self.dims()?.first().copied()
    }

    /// Nothing of it may be assigned.
    pub fn make_readonly(&mut self) {
        for leaf in self.leaves_mut() {
            if let UppaalSymbol::Var(v) = leaf {
                v.readonly = true;
            }
        }
    }

    /// How queries name what belongs to a process.
    pub fn belong_to(&mut self, automaton: &str) {
        match self {
            UppaalSymbol::Var(v) if v.own => v.name = format!("{automaton}.{}", v.name),
            UppaalSymbol::Clock(c) if c.own => c.name = format!("{automaton}.{}", c.name),
            UppaalSymbol::Location(l) => *l = format!("{automaton}.{l}"),
            UppaalSymbol::Const(_)
            | UppaalSymbol::Var(_)
            | UppaalSymbol::Clock(_)
            | UppaalSymbol::Chan(_)
            | UppaalSymbol::Record(_)
            | UppaalSymbol::Type(_)
            | UppaalSymbol::Function(_) => {}
        }
    }

    /// Of a record all its fields, those of its records among them; of anything else itself.
    pub fn leaves(&self) -> Vec<&UppaalSymbol> {
        match self {
            UppaalSymbol::Record(r) => r.fields.values().flat_map(UppaalSymbol::leaves).collect(),
            UppaalSymbol::Const(_)
            | UppaalSymbol::Var(_)
            | UppaalSymbol::Clock(_)
            | UppaalSymbol::Chan(_)
            | UppaalSymbol::Type(_)
            | UppaalSymbol::Function(_)
            | UppaalSymbol::Location(_) => vec![self],
        }
    }

    /// The same of a record.
    pub fn leaves_mut(&mut self) -> Vec<&mut UppaalSymbol> {
        match self {
            UppaalSymbol::Record(r) => r.fields.values_mut().flat_map(UppaalSymbol::leaves_mut).collect(),
            UppaalSymbol::Const(_)
            | UppaalSymbol::Var(_)
            | UppaalSymbol::Clock(_)
            | UppaalSymbol::Chan(_)
            | UppaalSymbol::Type(_)
            | UppaalSymbol::Function(_)
            | UppaalSymbol::Location(_) => vec![self],
        }
    }

    pub fn noun(&self) -> &'static str {
        match self {
            UppaalSymbol::Const(_) => "a constant",
            UppaalSymbol::Var(v) if !v.dims.is_empty() => "an array",
            UppaalSymbol::Var(_) => "a variable",
            UppaalSymbol::Clock(_) => "a clock",
            UppaalSymbol::Chan(_) => "a channel",
            UppaalSymbol::Record(r) if !r.dims.is_empty() => "an array",
            UppaalSymbol::Record(_) => "a record",
            UppaalSymbol::Type(_) => "a type",
            UppaalSymbol::Function(_) => "a function",
            UppaalSymbol::Location(_) => "a location",
        }
    }
}

pub type UppaalScope = IndexMap<String, UppaalSymbol>;

/// Words with a meaning of their own where names stand.
const TAKEN: &[&str] = &[
    "sup",
    "inf",
    "deadlock",
    "min",
    "max",
    "abs",
    "norm",
    "int",
    "bool",
    "float",
    "string",
    "self",
    "distance",
    "range",
    "angle",
    "visible",
    "speed",
    "joint_speed",
    "holds",
    "text",
    "list",
    "wait",
    "while",
    "for",
    "fork",
    "clock",
    "bool",
    "event",
    "actor",
];

/// Names that are in use. Those of a process are kept apart from those of all, and differ from them.
#[derive(Debug, Default)]
pub struct UppaalScenarioNames {
    global: IndexSet<String>,
    own: IndexSet<String>,
    /// Of the function that is being written.
    local: IndexSet<String>,
    /// Of all functions: what is declared for all after them has other names, too.
    locals: IndexSet<String>,
    pub renamed: Vec<(Span, String, String)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameOwner {
    All,
    Process,
    Function,
}

impl UppaalScenarioNames {
    /// A name that is nothing else's; it is noted if it is another one than in the model.
    pub fn fresh(&mut self, wanted: &str, span: Span, owner: NameOwner) -> String {
        let name = self.unused(wanted, owner);
        if name != wanted {
            self.renamed.push((span, wanted.to_owned(), name.clone()));
        }
        name
    }

    /// The same for what has no name in the model.
    pub fn unused(&mut self, wanted: &str, owner: NameOwner) -> String {
        let base = crate::exchange::name::clean(wanted);
        let mut name = base.clone();
        let mut n = 1;
        while is_reserved(&name) || self.has(&name, owner) {
            n += 1;
            name = if n == 2 && is_reserved(&base) { format!("{base}_") } else { format!("{base}_{n}") };
        }
        let pool = match owner {
            NameOwner::All => &mut self.global,
            NameOwner::Process => &mut self.own,
            NameOwner::Function => &mut self.local,
        };
        pool.insert(name.clone());
        if owner == NameOwner::Function {
            self.locals.insert(name.clone());
        }
        name
    }

    fn has(&self, name: &str, owner: NameOwner) -> bool {
        self.global.contains(name)
            || owner == NameOwner::All && self.locals.contains(name)
            || owner != NameOwner::All && self.own.contains(name)
            || owner == NameOwner::Function && self.local.contains(name)
    }

    pub fn start_process(&mut self) {
        self.own.clear();
    }

    pub fn start_function(&mut self) {
        self.local.clear();
    }
}

/// Why a name of the model is another one in the scenario.
pub fn why_renamed(name: &str, scenario: &str) -> &'static str {
    if is_reserved(name) {
        "the language has that word"
    } else if crate::exchange::name::clean(name) == crate::exchange::name::clean(scenario) {
        "the scenario has that name"
    } else {
        "that name is in use elsewhere in the scenario"
    }
}

fn is_reserved(name: &str) -> bool {
    let keyword = KEYWORDS.iter().find(|k| k.word == name);
    keyword.is_some_and(|k| k.class != KeywordClass::Soft) || is_soft_word(name) || TAKEN.contains(&name)
}

/// Soft keywords that are not taken as names everywhere.
fn is_soft_word(name: &str) -> bool {
    const WORDS: &[&str] = &[
        "seed",
        "method",
        "because",
        "predicts",
        "with",
        "init",
        "committed",
        "urgent",
        "location",
        "after",
        "never",
        "globally",
        "invariant",
        "select",
        "broadcast",
    ];
    WORDS.contains(&name)
}

/// What UPPAAL declares for every model: the limits of integers of so many bits, and their types.
pub fn built_in() -> UppaalScope {
    let mut scope = UppaalScope::new();
    for bits in [8, 16, 32] {
        let half = 1_i64 << (bits - 1);
        scope.insert(format!("INT{bits}_MIN"), UppaalSymbol::Const(ScenarioExprText::int(-half)));
        scope.insert(format!("INT{bits}_MAX"), UppaalSymbol::Const(ScenarioExprText::int(half - 1)));
        let ty = UppaalScalarType::range(-half, half - 1);
        scope.insert(format!("int{bits}_t"), UppaalSymbol::Type(UppaalSymbolType::Data(ty, Vec::new())));
        if bits < 32 {
            scope.insert(format!("UINT{bits}_MAX"), UppaalSymbol::Const(ScenarioExprText::int(2 * half - 1)));
            let ty = UppaalScalarType::range(0, 2 * half - 1);
            scope.insert(format!("uint{bits}_t"), UppaalSymbol::Type(UppaalSymbolType::Data(ty, Vec::new())));
        }
    }
    scope
}

/// Every combination of indices, the last fastest.
pub fn combinations(dims: &[IndexRange]) -> Vec<Vec<i64>> {
    let mut all = vec![Vec::new()];
    for dim in dims {
        all = all
            .into_iter()
            .flat_map(|before: Vec<i64>| {
                (dim.lo..=dim.hi).map(move |i| before.iter().copied().chain([i]).collect())
            })
            .collect();
    }
    all
}

/// What a name is written as, with a minus as `m`: `x` at 1 and -2 is `x_1_m2`.
pub fn numbered(name: &str, at: &[i64]) -> String {
    at.iter().fold(name.to_owned(), |name, n| {
        if *n < 0 { format!("{name}_m{}", n.unsigned_abs()) } else { format!("{name}_{n}") }
    })
}
