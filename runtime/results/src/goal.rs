//! Which goal of a suite is meant: by its kind and a name, printed and read back as one text.

use std::{borrow::Cow, fmt};

use hrdsl_ir::{coverage::BinName, suite::CoverItemKind};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::names::RequirementName;

/// What a suite is to reach. As text it is a word for its kind and a name: `bin human_robot.4 legs, bored`,
/// `edge Robot: sense -> decide (edge 3)`, `plan Human.leg#2`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum SuiteGoalId {
    /// `bin human_robot.4 legs, bored`
    Bin(BinName),
    /// Of an automaton: `location Robot.sense`
    Location(String),
    /// Of an automaton: `edge Robot: sense -> decide (edge 3)`
    Edge(String),
    /// `edge pair Robot: sense -> decide (edge 3), decide -> idle (edge 4)`
    EdgePair(String),
    /// `def-use pair of legs: its first value, read by Robot: sense -> decide (edge 3)`
    DefUsePair(String),
    /// Of a variable: `value legs = 4`
    Value(String),
    /// Of several variables: `combination legs = 4, gaze = true`
    Combination(String),
    /// A stimulus beside a bound of a clock: `bound Robot.asked: x = 3 s, just before`
    Bound(String),
    /// `violation of R5`
    Violation(RequirementName),
    /// `trigger of R5`
    Trigger(RequirementName),
    /// `query never_stuck`
    Query(String),
    /// Something of an agent's program: `plan Human.leg#2 failed`, `edge Human.table#1 -> leg#2 (step 1)`
    Item(CoverItemKind, String),
}

/// How the name of an edge between plans ends, up to its number; that of an automaton's edge ends otherwise.
const STEP: &str = " (step ";

impl SuiteGoalId {
    /// The words before the name, and after it.
    fn words(&self) -> (&'static str, &'static str) {
        match self {
            Self::Bin(_) => ("bin ", ""),
            Self::Location(_) => ("location ", ""),
            Self::Edge(_) => ("edge ", ""),
            Self::EdgePair(_) => ("edge pair ", ""),
            Self::DefUsePair(_) => ("def-use pair of ", ""),
            Self::Value(_) => ("value ", ""),
            Self::Combination(_) => ("combination ", ""),
            Self::Bound(_) => ("bound ", ""),
            Self::Violation(_) => ("violation of ", ""),
            Self::Trigger(_) => ("trigger of ", ""),
            Self::Query(_) => ("query ", ""),
            Self::Item(kind, _) => kind.words(),
        }
    }

    fn name(&self) -> &str {
        match self {
            Self::Bin(name) => name.as_str(),
            Self::Violation(name) | Self::Trigger(name) => name.as_str(),
            Self::Location(name)
            | Self::Edge(name)
            | Self::EdgePair(name)
            | Self::DefUsePair(name)
            | Self::Value(name)
            | Self::Combination(name)
            | Self::Bound(name)
            | Self::Query(name)
            | Self::Item(_, name) => name,
        }
    }

    /// Reads what is printed; `None` if it is no goal.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let after = |word: &str| text.strip_prefix(word).map(str::to_owned);
        // An edge pair is no edge: the longer word comes first.
        let goal = if let Some(name) = after("bin ") {
            Self::Bin(BinName::parse(&name)?)
        } else if let Some(name) = after("edge pair ") {
            Self::EdgePair(name)
        } else if let Some(name) = after("edge ").filter(|name| !name.contains(STEP)) {
            Self::Edge(name)
        } else if let Some(name) = after("location ") {
            Self::Location(name)
        } else if let Some(name) = after("def-use pair of ") {
            Self::DefUsePair(name)
        } else if let Some(name) = after("value ") {
            Self::Value(name)
        } else if let Some(name) = after("combination ") {
            Self::Combination(name)
        } else if let Some(name) = after("bound ") {
            Self::Bound(name)
        } else if let Some(name) = after("violation of ") {
            Self::Violation(name.into())
        } else if let Some(name) = after("trigger of ") {
            Self::Trigger(name.into())
        } else if let Some(name) = after("query ") {
            Self::Query(name)
        } else {
            Self::item(text)?
        };
        Some(goal)
    }

    /// A plan's ending says which of its kinds is meant; the kind without one comes last.
    fn item(text: &str) -> Option<Self> {
        let read = |kind: CoverItemKind| {
            let (before, after) = kind.words();
            let name = text.strip_prefix(before)?.strip_suffix(after)?;
            Some(Self::Item(kind, name.to_owned()))
        };
        let (plain, ending): (Vec<_>, Vec<_>) =
            CoverItemKind::ALL.into_iter().partition(|kind| kind.words().1.is_empty());
        ending.into_iter().chain(plain).find_map(read)
    }
}

impl fmt::Display for SuiteGoalId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (before, after) = self.words();
        write!(f, "{before}{}{after}", self.name())
    }
}

impl From<SuiteGoalId> for String {
    fn from(goal: SuiteGoalId) -> Self {
        goal.to_string()
    }
}

impl TryFrom<String> for SuiteGoalId {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        Self::parse(&text).ok_or_else(|| {
            format!("`{text}` is not the name of a goal, as `bin cross.name` or `plan Agent.label`")
        })
    }
}

impl JsonSchema for SuiteGoalId {
    fn schema_name() -> Cow<'static, str> {
        "SuiteGoalId".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "What a suite is to reach, by a word for its kind and a name: `bin human_robot.4 legs, bored`,\n`edge Robot: sense -> decide (edge 3)`, `plan Human.leg#2`",
            "type": "string"
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_read_as_they_are_printed() {
        let item = |kind, name: &str| SuiteGoalId::Item(kind, name.into());
        for (text, goal) in [
            ("bin human_robot.4 legs, bored", SuiteGoalId::Bin(BinName::new("human_robot", "4 legs, bored"))),
            ("location Robot.sense", SuiteGoalId::Location("Robot.sense".into())),
            ("edge Robot: a -> b (edge 3)", SuiteGoalId::Edge("Robot: a -> b (edge 3)".into())),
            (
                "edge pair Robot: a -> b (edge 1), b -> c (edge 2)",
                SuiteGoalId::EdgePair("Robot: a -> b (edge 1), b -> c (edge 2)".into()),
            ),
            ("def-use pair of n: its first value", SuiteGoalId::DefUsePair("n: its first value".into())),
            ("value n = 4", SuiteGoalId::Value("n = 4".into())),
            ("combination n = 4, b = true", SuiteGoalId::Combination("n = 4, b = true".into())),
            ("bound A.l: x = 3 s, at it", SuiteGoalId::Bound("A.l: x = 3 s, at it".into())),
            ("violation of R5", SuiteGoalId::Violation("R5".into())),
            ("trigger of R5", SuiteGoalId::Trigger("R5".into())),
            ("query q", SuiteGoalId::Query("q".into())),
            ("plan Human.leg#2", item(CoverItemKind::Selected, "Human.leg#2")),
            ("plan Human.leg#2 completed", item(CoverItemKind::Completed, "Human.leg#2")),
            ("plan Human.leg#2 failed", item(CoverItemKind::Failed, "Human.leg#2")),
            ("context Human.leg#2 true", item(CoverItemKind::ContextTrue, "Human.leg#2")),
            ("context Human.leg#2 false", item(CoverItemKind::ContextFalse, "Human.leg#2")),
            ("applicable Human.+!leg many", item(CoverItemKind::Applicable, "Human.+!leg many")),
            ("message Human.a: tell b (step 1)", item(CoverItemKind::Message, "Human.a: tell b (step 1)")),
            ("edge Human.a -> b (step 1)", item(CoverItemKind::Edge, "Human.a -> b (step 1)")),
            ("path Human: a > b > c", item(CoverItemKind::Path, "Human: a > b > c")),
        ] {
            assert_eq!(SuiteGoalId::parse(text), Some(goal.clone()), "{text}");
            assert_eq!(goal.to_string(), text);
        }
    }

    #[test]
    fn what_is_no_goal_is_refused_with_a_reason() {
        let refusal = |text: &str| serde_json::from_str::<SuiteGoalId>(text).unwrap_err().to_string();
        for text in [r#""nothing""#, r#""bin odd""#, r#""context A.b perhaps""#] {
            assert!(refusal(text).contains("is not the name of a goal"), "{text}");
        }
    }
}
