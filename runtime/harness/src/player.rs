//! The seam to the players: what they are told, and what they want to happen.

use hrdsl_ir::{ActorId, EventId, Nanos, Program, Role, Value};

use crate::{
    fault::SystemFault, log::SystemLog, message::PlayerMessage, port::PortHistory, said::SaidHistory,
    stage::WorldStage,
};

/// What a player is given when it is asked.
pub struct PlayerContext<'a, 'p> {
    pub now: Nanos,
    /// Waits for events may be given up now: nothing else happens any more at this instant by itself.
    pub expire: bool,
    /// Counts the events delivered; players that are told together know by it that it is the same event.
    pub delivery: u64,
    pub out: &'a mut Vec<PlayerMessage>,
    /// The world, if there is one: only the program under test and the sensors reach for it.
    pub stage: Option<&'a mut WorldStage<'p>>,
}

/// Anything that plays actors.
pub trait ActorPlayer {
    /// The actors it plays; it hears what any of them hears.
    fn actors(&self) -> &[ActorId];
    /// The run begins, or the time it asked for has come.
    ///
    /// # Errors
    /// What ends the run.
    fn wake(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError>;
    /// An event addressed to its actor happened.
    ///
    /// # Errors
    /// What ends the run.
    fn hear(
        &mut self,
        event: EventId,
        args: &[Value],
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError>;
    /// When it next wants to be woken.
    fn next_wake(&self) -> Option<Nanos>;
    /// It will do nothing more, whatever happens.
    fn is_finished(&self) -> bool;
    /// What its programs opened to speak with each other, in a run that ends now.
    fn ports(&self, end: Nanos) -> PortHistory {
        let _ = end;
        PortHistory::default()
    }
    /// What it awaited in vain, in a run that ends now, in the order in which that was given up.
    fn unmet_awaits(&self, end: Nanos) -> Vec<AwaitInVain> {
        let _ = end;
        Vec::new()
    }
    /// What its programs have logged.
    fn log(&self) -> SystemLog {
        SystemLog::default()
    }
    /// What its programs said, if it was to be written down.
    fn said(&self) -> SaidHistory {
        SaidHistory::default()
    }
}

/// A step of a test that awaited something which did not come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AwaitInVain {
    /// Its place among all steps of the test, script after script, from 0.
    pub step: usize,
    pub since: Nanos,
    /// When it was given up, or the run ended.
    pub until: Nanos,
}

/// Why a run could not go on.
#[derive(Clone, Debug, thiserror::Error)]
pub enum HarnessError {
    #[error("{0}")]
    Model(String),
    #[error("{0}")]
    World(String),
    #[error("{0}")]
    System(SystemFault),
    /// Of hrdsl itself.
    #[error("{0}")]
    Internal(String),
}

/// Whether an actor perceives an event: stimuli reach the environment only; what is addressed to nobody in particular
/// reaches everybody.
#[must_use]
pub fn is_perceived(program: &Program, actor: ActorId, event: EventId) -> bool {
    let e = program.event(event);
    if e.is_stimulus() {
        program.actor(actor).role == Role::Environment
    } else {
        e.to.is_empty() || e.from == actor || e.to.contains(&actor)
    }
}
