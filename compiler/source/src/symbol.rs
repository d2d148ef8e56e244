//! Symbols, the values of enumerations: names kept once in a table of the process, so that a value is as small as a number.
//!
//! The table only grows. It holds each distinct name that a program declares; whoever reads names from elsewhere (a
//! recording, the robot's code) looks them up in the [`Enumeration`] that is due, and does not intern them.

use std::{
    cmp::Ordering,
    collections::{BTreeMap, btree_map::Entry},
    fmt,
    hash::{Hash, Hasher},
    sync::{Mutex, PoisonError},
};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A name kept for as long as the process lives.
struct SymbolName {
    name: Box<str>,
    hash: u64,
}

struct EnumEntry {
    name: Box<str>,
    values: Box<[Symbol]>,
    /// Of each value, its place among them.
    places: BTreeMap<Symbol, usize>,
}

static SYMBOLS: Mutex<BTreeMap<&'static str, Symbol>> = Mutex::new(BTreeMap::new());
static ENUMERATIONS: Mutex<BTreeMap<(String, Vec<Symbol>), Enumeration>> = Mutex::new(BTreeMap::new());

/// How much this process has interned so far, and keeps until it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InternedTotals {
    pub names: usize,
    pub enumerations: usize,
}

impl InternedTotals {
    #[must_use]
    pub fn now() -> Self {
        Self {
            names: SYMBOLS.lock().unwrap_or_else(PoisonError::into_inner).len(),
            enumerations: ENUMERATIONS.lock().unwrap_or_else(PoisonError::into_inner).len(),
        }
    }
}

/// A value of an enumeration: a name. Symbols of the same name are equal, whatever enumeration they come from, and are
/// ordered by name.
#[derive(Clone, Copy)]
pub struct Symbol(&'static SymbolName);

impl Symbol {
    /// The symbol of this name.
    #[must_use]
    pub fn intern(name: &str) -> Self {
        let mut table = SYMBOLS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = table.get(name) {
            return *known;
        }
        let entry: &'static SymbolName =
            Box::leak(Box::new(SymbolName { name: name.into(), hash: hash(name) }));
        table.insert(&entry.name, Symbol(entry));
        Symbol(entry)
    }

    #[must_use]
    pub fn name(self) -> &'static str {
        &self.0.name
    }

    /// A number that depends on the name only: the same in every process and on every machine.
    #[must_use]
    pub fn number(self) -> u64 {
        self.0.hash
    }
}

/// FNV-1a. Not `std`'s hash, which may change from version to version.
fn hash(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

impl PartialEq for Symbol {
    fn eq(&self, other: &Self) -> bool {
        // The table makes most comparisons one of addresses.
        std::ptr::eq(self.0, other.0) || self.name() == other.name()
    }
}

impl Eq for Symbol {}

impl Ord for Symbol {
    fn cmp(&self, other: &Self) -> Ordering {
        self.name().cmp(other.name())
    }
}

impl PartialOrd for Symbol {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Hash for Symbol {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}

impl fmt::Debug for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Serialize for Symbol {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Symbol {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|name| Self::intern(&name))
    }
}

/// A declared enumeration: its name, and its symbols in the order of the declaration.
#[derive(Clone, Copy)]
pub struct Enumeration(&'static EnumEntry);

impl Enumeration {
    /// The enumeration of this name and these values.
    ///
    /// Of equal values the first stands; the checker refuses such a declaration.
    #[must_use]
    pub fn intern(name: &str, values: &[&str]) -> Self {
        Self::of(name, values.iter().map(|v| Symbol::intern(v)))
    }

    fn of(name: &str, values: impl Iterator<Item = Symbol>) -> Self {
        let mut places: BTreeMap<Symbol, usize> = BTreeMap::new();
        let mut distinct: Vec<Symbol> = Vec::new();
        for value in values {
            if let Entry::Vacant(new) = places.entry(value) {
                new.insert(distinct.len());
                distinct.push(value);
            }
        }
        let mut table = ENUMERATIONS.lock().unwrap_or_else(PoisonError::into_inner);
        let make = move |(name, values): &(String, Vec<Symbol>)| {
            let (name, values) = (name.as_str().into(), values.as_slice().into());
            Enumeration(Box::leak(Box::new(EnumEntry { name, values, places })))
        };
        *table.entry((name.to_owned(), distinct)).or_insert_with_key(make)
    }

    #[must_use]
    pub fn name(self) -> &'static str {
        &self.0.name
    }

    /// The symbols, in the order of the declaration.
    #[must_use]
    pub fn values(self) -> &'static [Symbol] {
        &self.0.values
    }

    /// The place of a symbol among the values.
    #[must_use]
    pub fn index_of(self, symbol: Symbol) -> Option<usize> {
        self.0.places.get(&symbol).copied()
    }

    /// The value of this name.
    #[must_use]
    pub fn symbol(self, name: &str) -> Option<Symbol> {
        let known = SYMBOLS.lock().unwrap_or_else(PoisonError::into_inner).get(name).copied();
        known.filter(|symbol| self.0.places.contains_key(symbol))
    }

    /// The values as a message lists them: `` `slow`, `fast` ``.
    #[must_use]
    pub fn listed(self) -> String {
        let names: Vec<String> = self.values().iter().map(|v| format!("`{v}`")).collect();
        names.join(", ")
    }
}

impl PartialEq for Enumeration {
    fn eq(&self, other: &Self) -> bool {
        let same = || self.name() == other.name() && self.values() == other.values();
        std::ptr::eq(self.0, other.0) || same()
    }
}

impl Eq for Enumeration {}

impl fmt::Debug for Enumeration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ", self.name())?;
        f.debug_set().entries(self.values()).finish()
    }
}

impl fmt::Display for Enumeration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// How an enumeration is written as data.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Enumeration")]
struct WrittenSymbol {
    name: String,
    values: Vec<Symbol>,
}

impl Serialize for Enumeration {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        WrittenSymbol { name: self.name().to_owned(), values: self.values().to_vec() }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Enumeration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        WrittenSymbol::deserialize(deserializer).map(|w| Self::of(&w.name, w.values.into_iter()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_the_same_name_are_equal() {
        let entry: &'static SymbolName =
            Box::leak(Box::new(SymbolName { name: "same".into(), hash: hash("same") }));
        assert_eq!(Symbol(entry), Symbol::intern("same"));
        let (values, places) = (vec![Symbol(entry)].into(), BTreeMap::from([(Symbol(entry), 0)]));
        let made = Enumeration(Box::leak(Box::new(EnumEntry { name: "Same".into(), values, places })));
        assert_eq!(made, Enumeration::intern("Same", &["same"]));
    }
}
