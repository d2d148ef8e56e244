//! The data of one run, as the viewer reads it: `spec/view.schema.json` is made from these types.
//!
//! Numbers that come in long columns are whole: times in ticks, places in tenths of a millimetre, quaternions in ten-thousandths. Such a
//! column has its first value, and then what each differs from the one before; [`differences`](crate::columns::differences) makes one.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::requirement::ViewRequirement;

/// What kind of document it is: its `format`.
pub const FORMAT: &str = "hrdsl-view";
/// The version of the format. A field that is added leaves it as it is; one that goes, or means something else, does not.
pub const VERSION: u32 = 1;

/// One run of a test, ready to be replayed. Times are whole numbers of ticks, lengths in metres where nothing else is said.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewDocument {
    /// `hrdsl-view`
    pub format: String,
    /// The version of the format, 1.
    pub version: u32,
    /// The version of hrdsl that made it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub hrdsl: String,
    pub scenario: String,
    /// The test that was run; left out if the recording says none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub test: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Where a generated test comes from, in the words of the test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub because: Option<String>,
    /// The length of a tick in nanoseconds.
    pub tick: u32,
    /// When the run ended.
    pub end: u64,
    pub ended: ViewEnd,
    /// Why the run broke off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    #[serde(default)]
    pub scene: ViewScene,
    /// Of bodies that move. A body without a track stays where it starts.
    #[serde(default)]
    pub poses: Vec<PoseTrack>,
    /// Positions of joints, each with its limits: rad or m.
    #[serde(default)]
    pub joints: Vec<SignalTrack>,
    /// Signals of the scenario, and what else can be plotted.
    #[serde(default)]
    pub signals: Vec<SignalTrack>,
    #[serde(default)]
    pub contacts: Vec<ContactTrack>,
    /// In the order in which they happened.
    #[serde(default)]
    pub events: Vec<ViewEvent>,
    #[serde(default)]
    pub machines: Vec<MachineTrack>,
    #[serde(default)]
    pub topics: Vec<TopicTrack>,
    /// What programs wrote, in order.
    #[serde(default)]
    pub log: Vec<ViewLogLine>,
    /// The files of the robot's code. Those without text may be among the shared assets of the page.
    #[serde(default)]
    pub files: Vec<ViewSourceFile>,
    /// At which lines of the robot's code each thread of its programs was; none if nobody measured it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub code: Vec<CodeTrack>,
    #[serde(default)]
    pub requirements: Vec<ViewRequirement>,
    /// What could not be shown, a sentence each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ViewEnd {
    /// Nothing more could happen.
    #[default]
    Quiescent,
    /// At the time limit.
    Limit,
    /// It broke off.
    Error,
}

/// x, y, z in metres, then the quaternion x, y, z, w.
pub type PoseNumbers = [f64; 7];

/// What there is to be seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewScene {
    pub bodies: Vec<ViewBody>,
    #[serde(default)]
    pub lasers: Vec<ViewLaser>,
    /// Meshes that shapes name. One that is not here may be among the shared assets of the page.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub meshes: BTreeMap<String, ViewMesh>,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewBody {
    /// As the scenario calls it: `robot.palm`.
    pub name: String,
    /// Whose body it is: an actor of the scenario.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actor: Option<String>,
    pub kind: BodyKind,
    pub shapes: Vec<ViewShape>,
    /// At the start, in the world.
    pub pose: PoseNumbers,
    /// Collides with nothing: it is drawn faintly.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub ghost: bool,
    /// `#rrggbb`, if its description gives it a colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
}

/// What a body belongs to. It decides its colour, and whether it may be cut away.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum BodyKind {
    Robot,
    /// Somebody alive, animals too.
    Person,
    /// Furniture, and what is carried.
    Thing,
    /// Floors and walls.
    Room,
}

/// A shape of a body, with its pose in the body's frame; without one it is at the origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum ViewShape {
    Box {
        /// The full lengths of the edges.
        size: [f64; 3],
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pose: Option<PoseNumbers>,
    },
    Sphere {
        radius: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pose: Option<PoseNumbers>,
    },
    /// Along z.
    Cylinder {
        radius: f64,
        length: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pose: Option<PoseNumbers>,
    },
    /// Along z; the length is without the caps.
    Capsule {
        radius: f64,
        length: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pose: Option<PoseNumbers>,
    },
    Mesh {
        /// Its name among the meshes of the scene, or among the shared assets of the page. If it is in neither, a placeholder is drawn.
        mesh: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        scale: Option<[f64; 3]>,
        /// The full lengths of the box that encloses it, for a placeholder.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        extent: Option<[f64; 3]>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pose: Option<PoseNumbers>,
    },
}

/// A triangle mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewMesh {
    /// x, y, z of each point, in tenths of a millimetre; not as differences.
    pub points: Vec<i64>,
    /// Three numbers of points for each triangle, anticlockwise as seen from outside.
    pub triangles: Vec<u32>,
}

/// A laser scanner. Its beams lie in the level plane of its pose; an angle of 0 is along x, and angles grow to the left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewLaser {
    pub name: String,
    /// The place of its body among the bodies.
    pub body: usize,
    /// In the body's frame.
    pub pose: PoseNumbers,
    /// Of the first beam and of the last, in radians.
    pub angles: [f64; 2],
    pub beams: u32,
    /// The least and the greatest distance that it sees, in metres.
    pub range: [f64; 2],
    /// What it saw. Without it, the page works out what a perfect one would have seen, and says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scans: Option<ScanTrack>,
}

/// Scans, each in force until the next.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScanTrack {
    /// Differences.
    pub t: Vec<i64>,
    /// Of each scan one number a beam, in centimetres: −1 if nothing was met, −2 if something was too near. From the second scan on they are
    /// differences from the scan before.
    pub ranges: Vec<i64>,
}

/// Where a body was: places at some times. Between two, the place is interpolated linearly and the orientation along the shortest arc; before the
/// first and after the last it stays.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseTrack {
    /// The place of the body among the bodies.
    pub body: usize,
    /// Differences.
    pub t: Vec<i64>,
    /// x, y, z of each time in tenths of a millimetre: differences from the time before.
    pub p: Vec<i64>,
    /// x, y, z, w of each time in ten-thousandths: differences from the time before. Left out if it never turns.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub q: Vec<i64>,
}

/// What kind of values a signal has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SignalKind {
    Bool,
    Int,
    #[default]
    Float,
    Enum,
}

/// A value over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SignalTrack {
    pub name: String,
    /// Whose it is; it decides beside whom it is listed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actor: Option<String>,
    #[serde(rename = "type")]
    pub kind: SignalKind,
    /// Such as `m` or `rad/s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The names of an enumeration's values.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<String>,
    /// What a whole number stands for, such as 0.0001; 1 without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// The least and the greatest value that it may have, in its unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[f64; 2]>,
    /// Whether values between two samples lie on a line. Otherwise each is in force until the next.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub linear: bool,
    /// Whether it is what a sensor says: it is then shown among the sensors.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sensor: bool,
    /// Differences.
    pub t: Vec<i64>,
    /// Differences from the value before; of an enumeration the places in `values`, of a bool 0 or 1. `null` is no value, and the next is the
    /// difference from the last that was one.
    pub v: Vec<Option<i64>>,
}

/// Two bodies that touch each other, and how hard.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContactTrack {
    /// The places of the two bodies among the bodies.
    pub bodies: [usize; 2],
    /// Differences.
    pub t: Vec<i64>,
    /// x, y, z of the point in the world, in tenths of a millimetre: differences.
    pub p: Vec<i64>,
    /// x, y, z of the force on the first of the two, in hundredths of a newton: differences. Three zeros end the contact.
    pub f: Vec<i64>,
}

/// What kind of event it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum EventKind {
    /// Somebody around the robot did something.
    Stimulus,
    /// Somebody said it, the robot's code too.
    #[default]
    Said,
    /// The world or a sensor saw it.
    Seen,
    /// The robot's code told a device to do it.
    Commanded,
}

/// Something that happened.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewEvent {
    pub t: u64,
    /// Until when it went on, if it takes time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<u64>,
    pub name: String,
    /// Who made it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actor: Option<String>,
    pub kind: EventKind,
    /// Its arguments as text: `gaze: true, legs: 2`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub args: Option<String>,
    /// Which step of the recording it is, counted from 0: line `step` + 2 of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u64>,
}

/// A state machine of the system, or an automaton: in which state it was.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MachineTrack {
    pub name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actor: Option<String>,
    /// The labels of its states, and of what it can end with.
    pub states: Vec<String>,
    /// When it came to a state: differences.
    pub t: Vec<i64>,
    /// Which, as a place in `states`; −1 if it is in none from then on. Not as differences.
    pub state: Vec<i64>,
    /// By which outcome it left the state before, if it says so.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outcome: Vec<Option<String>>,
}

/// Which way messages go, as the robot's code sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TopicDirection {
    /// To the robot's code.
    #[default]
    In,
    /// From the robot's code.
    Out,
}

/// What messages are to a name of the middleware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MessageRole {
    /// Of a topic.
    #[default]
    Message,
    /// Requests of a service, or goals of an action.
    Request,
    /// Answers of a service, or results of goals; or why there are none.
    Answer,
    /// How far goals are.
    Feedback,
}

/// A topic, service or action of the middleware, with the messages of one role that go one way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TopicTrack {
    pub name: String,
    /// Such as `sensor_msgs/LaserScan`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<String>,
    pub direction: TopicDirection,
    /// A topic's, if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub role: Option<MessageRole>,
    /// When the messages were: differences.
    pub t: Vec<i64>,
    /// What they say, shortened; `null` where nobody kept it. May be shorter than `t`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub text: Vec<Option<String>>,
}

/// How grave a line of the log is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LogLevel {
    Debug,
    #[default]
    Info,
    Warning,
    Error,
}

/// What a program wrote.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewLogLine {
    pub t: u64,
    pub level: LogLevel,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub program: Option<String>,
    pub text: String,
}

/// A file of the robot's code.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ViewSourceFile {
    pub name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
    /// The CRC-32 of its bytes when it ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crc: Option<u32>,
}

/// At which line of the robot's code a thread was when: where it asked for something, told something, or began to wait. It is there until the next.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CodeTrack {
    /// The program, as the scenario names it.
    pub program: String,
    /// The name of the thread: `MainThread`
    pub thread: String,
    /// Since when nobody looked any more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<u64>,
    /// Differences.
    pub t: Vec<i64>,
    /// The places of the files: differences.
    pub file: Vec<i64>,
    /// The lines, from 1: differences; 0 while the thread is in none of the files.
    pub line: Vec<i64>,
}

/// What several runs of a page share: it is stored once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SharedAssets {
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub meshes: BTreeMap<String, ViewMesh>,
    /// The text of files of the robot's code, by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, String>,
}
