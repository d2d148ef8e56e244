//! The players of a test: each does the stimuli, awaits and waits of one script, in order.

use hrdsl_ir::{
    ActorId, EventId, EventPattern, Nanos, Program, Role, Value,
    test::{Test, TestScript, TestStep},
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::{
    player::{ActorPlayer, AwaitInVain, HarnessError, PlayerContext},
    stimulus::{StimulusPerformance, draw_samples},
};

pub struct ScriptPlayer<'p> {
    program: &'p Program,
    script: &'p TestScript,
    actors: Vec<ActorId>,
    rng: ChaCha8Rng,
    /// How many steps the scripts before it have.
    first: usize,
    /// The step under way, or the next.
    at: usize,
    state: ScriptState,
    /// Stimuli that go on beside the steps after them.
    beside: Vec<StimulusPerformance>,
    /// What was heard since the last await ended.
    heard: Vec<(EventId, Vec<Value>)>,
    /// What did not come in its time.
    unmet: Vec<AwaitInVain>,
}

enum ScriptState {
    Ready,
    Performing(StimulusPerformance),
    Awaiting {
        since: Nanos,
        until: Nanos,
    },
    Waiting {
        until: Nanos,
    },
    /// Only what goes on beside is left.
    Finished,
}

/// Where the samples of a test's script are drawn from: a stream of random numbers for each script.
#[must_use]
pub fn script_rng(seed: u64, script: usize) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(script as u64);
    rng
}

impl<'p> ScriptPlayer<'p> {
    /// The players of all scripts of a test, in their order. A script without an actor plays all environment actors at once, and
    /// hears whatever any of them hears.
    pub fn all(program: &'p Program, test: &'p Test) -> impl Iterator<Item = Self> {
        let steps_before =
            move |at: usize| test.scripts.iter().take(at).map(|script| script.steps.len()).sum();
        test.scripts.iter().enumerate().map(move |(at, script)| Self {
            program,
            script,
            first: steps_before(at),
            actors: match script.actor {
                Some(actor) => vec![actor],
                None => program.actors_of(Role::Environment).collect(),
            },
            rng: script_rng(test.seed, at),
            at: 0,
            state: ScriptState::Ready,
            beside: Vec::new(),
            heard: Vec::new(),
            unmet: Vec::new(),
        })
    }

    fn begin(&mut self, step: &'p TestStep, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        self.state = match step {
            TestStep::Do { event, args, samples, meanwhile } => {
                let drawn = if samples.is_empty() {
                    draw_samples(self.program, *event, args, &mut self.rng)?
                } else {
                    samples.clone()
                };
                let begun = StimulusPerformance::begin(self.program, *event, args, &drawn, cx)?;
                if *meanwhile {
                    self.beside.push(begun);
                    self.at += 1;
                    ScriptState::Ready
                } else {
                    ScriptState::Performing(begun)
                }
            }
            TestStep::Await { within, .. } => ScriptState::Awaiting { since: cx.now, until: cx.now + within },
            TestStep::Wait { time } => ScriptState::Waiting { until: cx.now + time },
        };
        Ok(())
    }

    /// Goes on as far as it can now.
    fn go_on(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        self.beside.retain_mut(|performance| {
            performance.go_on(cx);
            !performance.is_done(cx.now)
        });
        loop {
            let over = match &mut self.state {
                ScriptState::Finished => return Ok(()),
                ScriptState::Ready => {
                    let Some(step) = self.script.steps.get(self.at) else {
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
                ScriptState::Awaiting { since, until } => {
                    let (since, until) = (*since, *until);
                    let is_heard = self.awaited_was_heard();
                    let in_vain = cx.expire && until <= cx.now && !is_heard;
                    let over = in_vain || is_heard;
                    if in_vain {
                        self.unmet.push(AwaitInVain { step: self.first + self.at, since, until });
                    }
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
        let Some(TestStep::Await { events, .. }) = self.script.steps.get(self.at) else { return false };
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
        let step = match &self.state {
            ScriptState::Ready => Some(0),
            ScriptState::Performing(performance) => Some(performance.until),
            ScriptState::Awaiting { until, .. } | ScriptState::Waiting { until } => Some(*until),
            ScriptState::Finished => None,
        };
        self.beside.iter().map(|performance| performance.until).chain(step).min()
    }

    fn unmet_awaits(&self, end: Nanos) -> Vec<AwaitInVain> {
        let open = match self.state {
            ScriptState::Awaiting { since, .. } => {
                Some(AwaitInVain { step: self.first + self.at, since, until: end })
            }
            ScriptState::Ready
            | ScriptState::Performing(_)
            | ScriptState::Waiting { .. }
            | ScriptState::Finished => None,
        };
        self.unmet.iter().copied().chain(open).collect()
    }

    fn is_finished(&self) -> bool {
        matches!(self.state, ScriptState::Finished) && self.beside.is_empty()
    }
}
