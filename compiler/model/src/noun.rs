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
    /// What a suite by search can reach each of, of some values.
    Combination,
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
    DeviceState,
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

/// What of a text declares names of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NounSource {
    /// They are the language's own words.
    Language,
    /// One piece with the place that uses them.
    Beside,
    /// A member of an agent or automaton.
    Member,
    ItemOrMember,
    /// A declaration, or a member of a world or part.
    Item,
}

struct NounRow {
    word: &'static str,
    /// Where it is not the word with an `s`.
    plural: Option<&'static str>,
    declared_by: NounSource,
}

impl NounRow {
    fn plural(self, plural: &'static str) -> Self {
        Self { plural: Some(plural), ..self }
    }
}

impl Noun {
    /// `a clock`
    pub fn with_article(self) -> String {
        let word = self.to_string();
        let article = if word.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" };
        format!("{article} {word}")
    }

    pub fn plural(self) -> String {
        let row = self.row();
        row.plural.map_or_else(|| format!("{}s", row.word), str::to_owned)
    }

    /// Networks, and what is judged and covered: other declarations do not speak of them in expressions, so that whoever writes
    /// such a name there most likely means another one.
    pub fn is_apart(self) -> bool {
        [Noun::Network, Noun::Query, Noun::Requirement, Noun::Point, Noun::Cross, Noun::Suite].contains(&self)
    }

    /// `clock`
    pub fn word(self) -> &'static str {
        self.row().word
    }

    /// What of a text declares names of this kind.
    pub fn declared_by(self) -> NounSource {
        self.row().declared_by
    }

    /// All that is known of a kind of names.
    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn row(self) -> NounRow {
        let of = |declared_by| move |word| NounRow { word, plural: None, declared_by };
        let language = of(NounSource::Language);
        let beside = of(NounSource::Beside);
        let member = of(NounSource::Member);
        let either = of(NounSource::ItemOrMember);
        let item = of(NounSource::Item);
        match self {
            Noun::Actor => item("actor"),
            Noun::Role => language("role"),
            Noun::Constant => item("constant"),
            Noun::Event => item("event"),
            Noun::Stimulus => item("stimulus").plural("stimuli"),
            Noun::EventOrStimulus => item("event or stimulus").plural("events and stimuli"),
            Noun::Channel => item("channel"),
            Noun::Medium => item("event, stimulus or channel").plural("events, stimuli and channels"),
            Noun::Parameter => beside("parameter"),
            Noun::Sample => beside("sample"),
            Noun::Unit => language("unit"),
            Noun::Type => item("type"),
            Noun::Enum => item("enumeration"),
            Noun::EnumValue => beside("value"),
            Noun::Record => item("record"),
            Noun::Field => beside("field"),
            Noun::Template => item("template"),
            Noun::Function => either("function"),
            Noun::Agent => item("agent"),
            Noun::Automaton => item("automaton").plural("automata"),
            Noun::Player => item("agent or automaton").plural("agents and automata"),
            Noun::Belief => member("belief"),
            Noun::Goal => member("goal"),
            Noun::Label => beside("plan label"),
            Noun::Variable => either("variable"),
            Noun::Clock => member("clock"),
            Noun::Location => member("location"),
            Noun::Network => item("network"),
            Noun::Query => item("query").plural("queries"),
            Noun::Member => member("location, variable or clock of this automaton")
                .plural("locations, variables and clocks of this automaton"),
            Noun::SearchReach => language("thing that a suite by search reaches")
                .plural("things that a suite by search reaches"),
            Noun::Combination => language("thing that a suite by search reaches of values")
                .plural("things that a suite by search reaches of values"),
            Noun::ReachOf => language("thing of a requirement that a suite by search reaches")
                .plural("things of a requirement that a suite by search reaches"),
            Noun::Witness => language("kind of witness").plural("kinds of witness"),
            Noun::Delays => language("kind of delays").plural("kinds of delays"),
            Noun::Requirement => item("requirement"),
            Noun::RequirementKind => language("kind of requirement").plural("kinds of requirement"),
            Noun::Point => item("coverpoint"),
            Noun::Bin => beside("bin"),
            Noun::Cross => item("cross product").plural("cross products"),
            Noun::Suite => item("suite"),
            Noun::Method => language("method"),
            Noun::Explore => language("explore option"),
            Noun::Reach => language("thing that a suite by agents reaches")
                .plural("things that a suite by agents reaches"),
            Noun::Annotation => member("annotation"),
            Noun::InternalAction => language("internal action"),
            Noun::Performative => language("performative"),
            Noun::Test => item("test"),
            Noun::System => item("system"),
            Noun::Program => item("program"),
            Noun::Part => item("part"),
            Noun::PartInstance => item("part of the world").plural("parts of the world"),
            Noun::Body => item("body").plural("bodies"),
            Noun::Motion => language("kind of body").plural("kinds of body"),
            Noun::Shape => language("shape"),
            Noun::Joint => item("joint"),
            Noun::Arm => item("arm"),
            Noun::Gripper => item("gripper"),
            Noun::Base => item("base"),
            Noun::Laser => item("laser"),
            Noun::Device => item("device"),
            Noun::Limb => item("limb"),
            Noun::Figure => item("figure"),
            Noun::Posture => item("posture"),
            Noun::Group => item("group"),
            Noun::DeviceKind => language("kind of device").plural("kinds of device"),
            Noun::Command => item("command"),
            Noun::DeviceState => item("state"),
            Noun::Primitive => language("primitive"),
            Noun::DeviceMeasure => {
                language("measurement of this kind of device").plural("measurements of this kind of device")
            }
            Noun::Current => item("current body"),
            Noun::Signal => item("signal"),
            Noun::Action => language("action"),
            Noun::Coordinate => language("coordinate"),
        }
    }
}

impl fmt::Display for Noun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}
