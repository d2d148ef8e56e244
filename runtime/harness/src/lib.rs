//! One discrete-event loop in virtual, simulated or outside time: who plays whom, and who hears what.
//!
//! Players (agents, automata, a test script, the system under test) are asked in a fixed order; none sees another.
//! The [`WorldStage`], when present, holds the world: it plays the actors that no player plays. Everything that happens is
//! recorded in a [`Trace`](hrdsl_trace::Trace).
//!
//! # Seams
//! What the loop does not do itself is behind three traits, each with a [double](doubles) for tests:
//! - a [`WorldBackend`] holds the bodies, and says when it next changes by itself;
//! - a [`SystemActor`] plays the system actor: it asks, and is answered, by a [`SystemPlayer`];
//! - a [`TimeSource`] lets time pass: at once, or as the outside wants.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod argument;
mod clock;
mod command;
pub mod doubles;
mod edge;
mod fault;
mod keyframes;
mod log;
mod message;
mod picture;
mod player;
mod port;
mod recorder;
mod run;
mod said;
mod script;
mod spent;
mod stage;
mod stimulus;
mod stopwatch;
mod system;
mod world;

pub use argument::SystemArgument;
pub use clock::{TimeSource, VirtualClock};
pub use command::{CheckedCommand, CommandRequest, NotBegun};
pub use fault::{SystemFault, SystemFaultKind};
pub use hrdsl_trace::{MachineDeclaration, MachineEdge, MachineStep};
pub use log::{KeptRecord, LogRecord, ProgramLogLevel, SystemLog};
pub use message::PlayerMessage;
pub use player::{ActorPlayer, AwaitInVain, HarnessError, PlayerContext, is_perceived};
pub use port::{
    AwaitedPort, GoalEnd, MessageText, PortDeclaration, PortHistory, PortKind, PortListing, PortQos, PortUse,
    QosDurability, QosPolicy, QosReliability, VainWait,
};
pub use run::{HarnessLoop, HarnessRun, RunTermination};
pub use said::{MessagePart, SaidHistory, TopicHistory};
pub use script::{ScriptPlayer, script_rng};
pub use spent::{SpentTime, ThreadClock};
pub use stage::WorldStage;
pub use stimulus::{StimulusPerformance, draw_samples};
pub use stopwatch::{RunStopwatch, SeamTimes, TimedSystem, TimedWorld};
pub use system::player::SystemPlayer;
pub use system::seam::{
    CallRequest, CanceledGoals, ParameterRequest, PlanForm, RequestTicket, SystemActor, SystemAnswer,
    SystemArrival, SystemRequest,
};
pub use world::{
    ArmTarget, BodyPose, CommandId, MotionPlanRequest, PlannedPoint, PlannedTrajectory, WorldAccuracy,
    WorldBackend,
};
