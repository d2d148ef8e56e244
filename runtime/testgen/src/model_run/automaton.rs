//! The player that is a timed automaton: the model of the code, run as fast as its guards allow.

use hrdsl_ir::{ActorId, EventId, Nanos, Program, Value, ta::AutomatonId};
use hrdsl_ta::VirtualTimePlayer as Machine;

use hrdsl_harness::{ActorPlayer, HarnessError, PlayerContext, PlayerMessage};

pub struct AutomatonPlayer<'p> {
    program: &'p Program,
    name: &'p str,
    /// One, or none if it plays nobody.
    actors: Vec<ActorId>,
    machine: Machine<'p>,
}

impl<'p> AutomatonPlayer<'p> {
    #[must_use]
    pub fn new(program: &'p Program, automaton: AutomatonId) -> Self {
        let declared = &program.automata[automaton.0 as usize];
        let machine = Machine::new(program, automaton);
        Self { program, name: &declared.name, actors: declared.actor.into_iter().collect(), machine }
    }

    fn go_on(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        let mut sent = Vec::new();
        self.machine
            .run(cx.now, &mut sent)
            .map_err(|e| HarnessError::Model(format!("automaton `{}`: {e}", self.name)))?;
        for (event, args) in sent {
            debug_assert!(self.actors.contains(&self.program.event(event).from));
            cx.out.push(PlayerMessage::Event { event, args });
        }
        Ok(())
    }
}

impl ActorPlayer for AutomatonPlayer<'_> {
    fn actors(&self) -> &[ActorId] {
        &self.actors
    }

    fn wake(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        self.go_on(cx)
    }

    fn hear(
        &mut self,
        event: EventId,
        args: &[Value],
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        self.machine
            .receive(event, args, cx.now)
            .map_err(|e| HarnessError::Model(format!("automaton `{}`: {e}", self.name)))?;
        self.go_on(cx)
    }

    fn next_wake(&self) -> Option<Nanos> {
        self.machine.next_wake()
    }

    fn is_finished(&self) -> bool {
        false
    }
}
