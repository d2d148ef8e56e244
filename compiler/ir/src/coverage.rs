//! Coverpoints over a trace, and their cross products.

use std::fmt;

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

use crate::event::EventPattern;

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    pub points: Vec<Coverpoint>,
    pub crosses: Vec<CoverCross>,
}

/// Index into [`Coverage::points`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CoverpointId(pub u16);

/// Index into [`Coverage::crosses`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CrossId(pub u16);

/// A number of a test, sorted into bins: how often any of the events happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coverpoint {
    pub name: String,
    pub count: Vec<EventPattern>,
    pub bins: Vec<CoverBin>,
    pub origin: Span,
}

/// `lo..=hi`; no upper end: `lo..`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoverBin {
    pub name: String,
    pub lo: i64,
    pub hi: Option<i64>,
}

impl CoverBin {
    #[must_use]
    pub fn holds(&self, n: i64) -> bool {
        self.lo <= n && self.hi.is_none_or(|hi| n <= hi)
    }
}

/// A cross product of points, collapsed into named bins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoverCross {
    pub name: String,
    pub points: Vec<CoverpointId>,
    pub bins: Vec<CrossBin>,
    /// Combinations that do not count.
    pub ignore: Vec<BinCondition>,
    pub origin: Span,
}

/// A test falls into each bin whose condition it meets (it may be several), unless an `ignore` holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrossBin {
    pub name: String,
    pub when: BinCondition,
    pub origin: Span,
}

/// The name of a bin of a point or cross, as it is printed, stored and read back: `legs.four`, `human_robot.4 legs, ready`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct BinName {
    text: String,
    /// Where the dot is.
    dot: usize,
}

impl BinName {
    /// The name of a bin of this owner. The owner is an identifier, so that the first dot ends it; a line break or another
    /// control character in the bin's name becomes a space, so that a name is one line.
    #[must_use]
    pub fn new(owner: &str, bin: &str) -> Self {
        Self { text: format!("{owner}.{}", bin.replace(char::is_control, " ")), dot: owner.len() }
    }

    /// Reads what [`new`](Self::new) has made; `None` if it has not that form.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (owner, bin) =
            text.split_once('.').filter(|(owner, bin)| !owner.is_empty() && !bin.is_empty())?;
        Some(Self::new(owner, bin))
    }

    /// The point or cross that it belongs to.
    #[must_use]
    pub fn owner(&self) -> &str {
        &self.text[..self.dot]
    }

    /// Its name there.
    #[must_use]
    pub fn bin(&self) -> &str {
        &self.text[self.dot + 1..]
    }

    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.text
    }
}

impl fmt::Display for BinName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.text)
    }
}

impl PartialEq<&str> for BinName {
    fn eq(&self, other: &&str) -> bool {
        self.text == *other
    }
}

impl From<BinName> for String {
    fn from(name: BinName) -> Self {
        name.text
    }
}

impl TryFrom<String> for BinName {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        Self::parse(&text).ok_or_else(|| format!("`{text}` is not the name of a bin, as `cross.bin`"))
    }
}

/// A formula over points' bins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BinCondition {
    /// The point's number lies in its bin of this index.
    In {
        point: CoverpointId,
        bin: u16,
    },
    Not(Box<BinCondition>),
    And(Vec<BinCondition>),
    Or(Vec<BinCondition>),
}

impl BinCondition {
    /// Whether the condition holds, `number(point)` giving each point's number.
    #[must_use]
    pub fn holds(&self, coverage: &Coverage, number: &dyn Fn(CoverpointId) -> i64) -> bool {
        match self {
            BinCondition::In { point, bin } => {
                coverage.points[point.0 as usize].bins[*bin as usize].holds(number(*point))
            }
            BinCondition::Not(c) => !c.holds(coverage, number),
            BinCondition::And(cs) => cs.iter().all(|c| c.holds(coverage, number)),
            BinCondition::Or(cs) => cs.iter().any(|c| c.holds(coverage, number)),
        }
    }
}
