//! The kinds of names, in the words of a person.

use std::fmt;

/// What a name can be the name of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Noun {
    Actor,
    Role,
    Constant,
    Event,
    Stimulus,
    /// Where both are good.
    EventOrStimulus,
    Channel,
    /// Where all three are good.
    Medium,
    Parameter,
    Sample,
    Unit,
    Type,
    Enum,
    EnumValue,
    Record,
    Field,
    Template,
    Function,
    Agent,
    Automaton,
    /// An agent or automaton.
    Player,
    Belief,
    Goal,
    Label,
    Variable,
    Clock,
    Location,
    Network,
    Query,
    /// Of an automaton, in a query.
    Member,
    Requirement,
    RequirementKind,
    Point,
    Bin,
    Cross,
    Suite,
    Method,
    Explore,
    /// What a suite by agents can reach each of.
    Reach,
    /// What a suite by search can reach each of.
    SearchReach,
    /// What a suite by search can reach of a requirement.
    ReachOf,
    Witness,
    Delays,
    Test,
    Part,
    PartInstance,
    Body,
    Motion,
    Shape,
    Joint,
    Arm,
    Gripper,
    Base,
    Laser,
    /// Any of these four.
    Device,
    Limb,
    Figure,
    Posture,
    Group,
    /// Of which devices are.
    DeviceKind,
    /// What a device can be told.
    Command,
    /// What a command does.
    Primitive,
    /// What a device can say of itself.
    DeviceMeasure,
    Current,
    Signal,
    Action,
    Coordinate,
    /// Of a belief: `source`.
    Annotation,
    InternalAction,
    Performative,
    /// A system under test.
    System,
    /// Of a system.
    Program,
}

impl Noun {
    /// `a clock`
    pub fn with_article(self) -> String {
        let word = self.to_string();
        let article = if word.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" };
        format!("{article} {word}")
    }

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    pub fn plural(self) -> String {
        match self {
            Noun::Stimulus => "stimuli".to_owned(),
            Noun::Automaton => "automata".to_owned(),
            Noun::Body => "bodies".to_owned(),
            Noun::EventOrStimulus => "events and stimuli".to_owned(),
            Noun::Medium => "events, stimuli and channels".to_owned(),
            Noun::Player => "agents and automata".to_owned(),
            Noun::RequirementKind => "kinds of requirement".to_owned(),
            Noun::Explore => "explore options".to_owned(),
            Noun::Reach => "things that a suite by agents reaches".to_owned(),
            Noun::Query => "queries".to_owned(),
            Noun::Member => "locations, variables and clocks of this automaton".to_owned(),
            Noun::SearchReach => "things that a suite by search reaches".to_owned(),
            Noun::ReachOf => "things of a requirement that a suite by search reaches".to_owned(),
            Noun::Witness => "kinds of witness".to_owned(),
            Noun::Delays => "kinds of delays".to_owned(),
            Noun::Cross => "cross products".to_owned(),
            Noun::Motion => "kinds of body".to_owned(),
            Noun::DeviceKind => "kinds of device".to_owned(),
            Noun::DeviceMeasure => "measurements of this kind of device".to_owned(),
            Noun::PartInstance => "parts of the world".to_owned(),
            Noun::Coordinate
            | Noun::Actor
            | Noun::Role
            | Noun::Constant
            | Noun::Event
            | Noun::Channel
            | Noun::Parameter
            | Noun::Sample
            | Noun::Unit
            | Noun::Type
            | Noun::Enum
            | Noun::EnumValue
            | Noun::Record
            | Noun::Field
            | Noun::Template
            | Noun::Function
            | Noun::Agent
            | Noun::Belief
            | Noun::Goal
            | Noun::Label
            | Noun::Variable
            | Noun::Clock
            | Noun::Location
            | Noun::Network
            | Noun::Requirement
            | Noun::Point
            | Noun::Bin
            | Noun::Suite
            | Noun::Method
            | Noun::Test
            | Noun::Part
            | Noun::Shape
            | Noun::Joint
            | Noun::Arm
            | Noun::Gripper
            | Noun::Base
            | Noun::Laser
            | Noun::Limb
            | Noun::Figure
            | Noun::Posture
            | Noun::Group
            | Noun::Device
            | Noun::Command
            | Noun::Primitive
            | Noun::Current
            | Noun::Signal
            | Noun::Annotation
            | Noun::InternalAction
            | Noun::Performative
            | Noun::System
            | Noun::Program
            | Noun::Action => format!("{self}s"),
        }
    }

    /// Networks, and what is judged and covered: other declarations do not speak of them in expressions, so that whoever writes
    /// such a name there most likely means another one.
    pub fn is_apart(self) -> bool {
        [Noun::Network, Noun::Query, Noun::Requirement, Noun::Point, Noun::Cross, Noun::Suite].contains(&self)
    }

    /// `clock`
    #[expect(clippy::too_many_lines, reason = "a flat match")]
    pub fn word(self) -> &'static str {
        match self {
            Noun::Actor => "actor",
            Noun::Role => "role",
            Noun::Constant => "constant",
            Noun::Event => "event",
            Noun::Stimulus => "stimulus",
            Noun::EventOrStimulus => "event or stimulus",
            Noun::Channel => "channel",
            Noun::Medium => "event, stimulus or channel",
            Noun::Parameter => "parameter",
            Noun::Sample => "sample",
            Noun::Unit => "unit",
            Noun::Type => "type",
            Noun::Enum => "enumeration",
            Noun::EnumValue => "value",
            Noun::Record => "record",
            Noun::Field => "field",
            Noun::Template => "template",
            Noun::Function => "function",
            Noun::Agent => "agent",
            Noun::Automaton => "automaton",
            Noun::Player => "agent or automaton",
            Noun::Belief => "belief",
            Noun::Goal => "goal",
            Noun::Label => "plan label",
            Noun::Variable => "variable",
            Noun::Clock => "clock",
            Noun::Location => "location",
            Noun::Network => "network",
            Noun::Query => "query",
            Noun::Member => "location, variable or clock of this automaton",
            Noun::SearchReach => "thing that a suite by search reaches",
            Noun::ReachOf => "thing of a requirement that a suite by search reaches",
            Noun::Witness => "kind of witness",
            Noun::Delays => "kind of delays",
            Noun::Requirement => "requirement",
            Noun::RequirementKind => "kind of requirement",
            Noun::Point => "coverpoint",
            Noun::Bin => "bin",
            Noun::Cross => "cross product",
            Noun::Suite => "suite",
            Noun::Method => "method",
            Noun::Explore => "explore option",
            Noun::Reach => "thing that a suite by agents reaches",
            Noun::Annotation => "annotation",
            Noun::InternalAction => "internal action",
            Noun::Performative => "performative",
            Noun::Test => "test",
            Noun::System => "system",
            Noun::Program => "program",
            Noun::Part => "part",
            Noun::PartInstance => "part of the world",
            Noun::Body => "body",
            Noun::Motion => "kind of body",
            Noun::Shape => "shape",
            Noun::Joint => "joint",
            Noun::Arm => "arm",
            Noun::Gripper => "gripper",
            Noun::Base => "base",
            Noun::Laser => "laser",
            Noun::Device => "device",
            Noun::Limb => "limb",
            Noun::Figure => "figure",
            Noun::Posture => "posture",
            Noun::Group => "group",
            Noun::DeviceKind => "kind of device",
            Noun::Command => "command",
            Noun::Primitive => "primitive",
            Noun::DeviceMeasure => "measurement of this kind of device",
            Noun::Current => "current body",
            Noun::Signal => "signal",
            Noun::Action => "action",
            Noun::Coordinate => "coordinate",
        }
    }
}

impl fmt::Display for Noun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}
