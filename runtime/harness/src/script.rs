//! The player of a test: it does the test's stimuli, awaits and waits, in order.

use hrdsl_ir::{
    ActorId, EventId, EventPattern, Nanos, Program, Role, Value,
    test::{Test, TestStep},
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::{
    player::{ActorPlayer, HarnessError, PlayerContext},
    stimulus::{StimulusPerformance, draw_samples},
};

pub struct ScriptPlayer<'p> {
    program: &'p Program,
    test: &'p Test,
    actors: Vec<ActorId>,
    rng: ChaCha8Rng,
    /// The step under way, or the next.
    at: usize,
    state: ScriptState,
    /// What was heard since the last await ended.
    heard: Vec<(EventId, Vec<Value>)>,
}

enum ScriptState {
    Ready,
    Performing(StimulusPerformance),
    Awaiting { until: Nanos },
    Waiting { until: Nanos },
    Finished,
}

impl<'p> ScriptPlayer<'p> {
    /// The script plays all environment actors at once and hears whatever any of them hears.
    #[must_use]
    pub fn new(program: &'p Program, test: &'p Test) -> Self {
        let actors = program.actors_of(Role::Environment).collect();
        let rng = ChaCha8Rng::seed_from_u64(test.seed);
        Self { program, test, actors, rng, at: 0, state: ScriptState::Ready, heard: Vec::new() }
    }

    fn begin(&mut self, step: &'p TestStep, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        self.state = match step {
            TestStep::Do { event, args, samples } => {
                let drawn = if samples.is_empty() {
                    draw_samples(self.program, *event, args, &mut self.rng)?
                } else {
                    samples.clone()
                };
                ScriptState::Performing(StimulusPerformance::begin(self.program, *event, args, &drawn, cx)?)
            }
            TestStep::Await { within, .. } => ScriptState::Awaiting { until: cx.now + within },
            TestStep::Wait { time } => ScriptState::Waiting { until: cx.now + time },
        };
        Ok(())
    }

    /// Goes on as far as it can now.
    fn go_on(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        loop {
            let over = match &mut self.state {
                ScriptState::Finished => return Ok(()),
                ScriptState::Ready => {
                    let Some(step) = self.test.steps.get(self.at) else {
                        self.state = ScriptState::Finished;
                        return Ok(());
                    };
                    self.begin(step, cx)?;
                    continue;
                }
                ScriptState::Performing(performance) => {
                    performance.go_on(cx);
                    performance.is_done(cx.now)
                }
                ScriptState::Waiting { until } => *until <= cx.now,
                ScriptState::Awaiting { until } => {
                    let in_vain = cx.expire && *until <= cx.now;
                    let over = in_vain || self.awaited_was_heard();
                    if over {
                        self.heard.clear();
                    }
                    over
                }
            };
            if !over {
                return Ok(());
            }
            self.at += 1;
            self.state = ScriptState::Ready;
        }
    }

    fn awaited_was_heard(&self) -> bool {
        let Some(TestStep::Await { events, .. }) = self.test.steps.get(self.at) else { return false };
        let matches = |(event, args): &(EventId, Vec<Value>)| {
            events.iter().any(|p: &EventPattern| p.matches(*event, args))
        };
        self.heard.iter().any(matches)
    }
}

impl ActorPlayer for ScriptPlayer<'_> {
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
        if matches!(self.state, ScriptState::Finished) {
            return Ok(());
        }
        self.heard.push((event, args.to_vec()));
        self.go_on(cx)
    }

    fn next_wake(&self) -> Option<Nanos> {
        match &self.state {
            ScriptState::Ready => Some(0),
            ScriptState::Performing(performance) => Some(performance.until),
            ScriptState::Awaiting { until } | ScriptState::Waiting { until } => Some(*until),
            ScriptState::Finished => None,
        }
    }

    fn is_finished(&self) -> bool {
        matches!(self.state, ScriptState::Finished)
    }
}
