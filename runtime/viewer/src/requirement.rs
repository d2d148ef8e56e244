//! What a document says of requirements: verdicts, obligations, violations, and what they measure.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the run says of a requirement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ViewVerdict {
    Pass,
    Fail,
    /// It was never triggered.
    #[default]
    Vacuous,
    /// The run ended while an obligation was pending.
    Inconclusive,
    /// It is not known to be violated, in a run that broke off.
    Error,
}

/// A requirement, and how this run fared by it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewRequirement {
    /// Such as `R5`.
    pub id: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// `safety` or `functional`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
    /// As the scenario has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
    pub verdict: ViewVerdict,
    /// The least margin, in `unit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// When it was triggered: differences.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub triggers: Vec<i64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obligations: Vec<ViewObligation>,
    /// All violations, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub violations: Vec<ViewViolation>,
    /// The signals that it reads, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub signals: Vec<String>,
    /// The events that it reads, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<String>,
    /// What it judges, as far as it can be drawn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measures: Vec<ViewMeasure>,
    /// How the measures, and what else is asked for, make it up; left out if it asks for its one measure, or nothing is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condition: Option<ViewCondition>,
    /// The condition is what meets an obligation: that it is not so, is no violation.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub meets: bool,
    /// The condition is asked only when one of these events happens; at any time, if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<String>,
}

/// How an obligation ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ObligationOutcome {
    #[default]
    Met,
    Violated,
    /// The run ended before it was decided.
    Pending,
    /// It lapsed: what it was for came to nothing.
    Dropped,
}

/// Something that had to happen, or must not, for a while.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewObligation {
    /// When it was made.
    pub from: u64,
    /// When it was decided; left out if it never was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<u64>,
    /// By when it had to be met.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deadline: Option<u64>,
    pub outcome: ObligationOutcome,
    /// What made it: `decided(ready: true)`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trigger: Option<String>,
}

/// A violation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewViolation {
    pub t: u64,
    /// In a sentence.
    pub text: String,
    /// When the violated obligation was made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub since: Option<u64>,
    /// Of a formula: when it holds again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<u64>,
    /// The steps of the recording that bear it out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<u64>,
}

/// What a measure is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MeasureKind {
    /// Between the surfaces of two bodies.
    Distance,
    /// Between the centres of two bodies.
    Range,
    /// Between the x axis of the first body and the way from it to the second.
    Angle,
    /// Of a body: between the vertical and where its direction points that was vertical at the start.
    Tilt,
    /// Of a body above z = 0.
    Height,
    /// Where a body is along an axis of the world.
    Coordinate,
    /// How far a body is from a place, or from a second body, along some axes.
    Offset,
    /// How far a body has come within a time.
    Way,
    /// Of a body.
    Speed,
    /// Between two bodies, or on one.
    Force,
    /// Anything else: it is plotted, and told beside the first of its bodies.
    #[default]
    Signal,
}

/// An axis of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MeasureAxis {
    X,
    Y,
    Z,
}

/// How values lie to the limit where the requirement is content.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum LimitRelation {
    #[serde(rename = "<")]
    #[default]
    Below,
    #[serde(rename = "<=")]
    AtMost,
    #[serde(rename = ">")]
    Above,
    #[serde(rename = ">=")]
    AtLeast,
}

/// A value that a requirement compares with a limit. It is as it should be where value, relation and limit make a true sentence.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewMeasure {
    pub kind: MeasureKind,
    /// As the scenario has it: `distance(person.hand, robot.palm)`. If a signal has this name, its values are those of the measure.
    pub name: String,
    /// The places of the bodies that it is about among the bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<usize>,
    /// Of a way, and of a speed: the way of how many seconds is drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
    /// Of a way, a coordinate and an offset: along which axes; all of them, if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<MeasureAxis>,
    /// Of an offset: where the place is along each of the axes, in metres; from a second body, where it is beside that.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub place: Vec<f64>,
    pub relation: LimitRelation,
    /// In the signal's unit.
    pub limit: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The unit in which the scenario writes the limit: values are read in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shown: Option<ShownUnit>,
    /// The requirement is about this event, which the world tells when the value is no longer as it should be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tells: Option<String>,
    /// The two nearest points. Without them the page works them out from the shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points: Option<PointPairs>,
}

/// A unit in which numbers are shown.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShownUnit {
    /// Such as `cm`.
    pub symbol: String,
    /// How large it is, in the unit in which the value is.
    pub size: f64,
}

/// What has to be so, as far as it is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "is", rename_all = "lowercase")]
pub enum ViewCondition {
    /// All of these.
    All { of: Vec<ViewCondition> },
    /// At least one of these.
    Any { of: Vec<ViewCondition> },
    /// The measure in this place among the requirement's is as it should be.
    Measure { measure: usize },
    /// Something else: a truth, or an event that happens.
    Fact {
        /// As the scenario has it.
        text: String,
        /// It must not be so.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        negated: bool,
        /// The signal that is true while it is so.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        signal: Option<String>,
    },
    /// An operator of a formula that looks at other moments than now.
    Window {
        /// As the scenario has it: `historically[0 s, 2 s]`.
        text: String,
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        negated: bool,
        /// The signal that is true while it holds.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        signal: Option<String>,
        /// Its operands.
        of: Vec<ViewCondition>,
    },
    /// The world tells this event, which must not be, when what it is of is no longer so.
    Told {
        event: String,
        /// It tells it once that has lasted for so many seconds.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        held: Option<f64>,
        of: Vec<ViewCondition>,
    },
}

/// Two points over time, interpolated like poses.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PointPairs {
    /// Differences.
    pub t: Vec<i64>,
    /// x, y, z in the world in tenths of a millimetre: differences.
    pub a: Vec<i64>,
    pub b: Vec<i64>,
}
