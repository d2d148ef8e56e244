//! The baseline: stimuli, awaits and pauses drawn at random.

use std::collections::BTreeSet;

use hrdsl_coverage::assume::AssumptionChecker;
use hrdsl_ir::{
    ActorId, Event, EventId, Expr, Nanos, Program, Type, Value,
    abstract_test::AbstractTest,
    event::StimulusStep,
    suite::{Suite, SuiteMethod},
    test::{TestScript, TestStep},
    value::SECOND,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use hrdsl_harness::is_perceived;

use hrdsl_results::AbstractTests;

use crate::{extract, times};

/// Draws `count` sequences.
///
/// # Errors
/// A suite without stimuli, or a stimulus whose arguments cannot be enumerated.
pub fn harvest(program: &Program, suite: &Suite, count: u32, seed: u64) -> Result<AbstractTests, String> {
    let SuiteMethod::Random { stimuli, awaits, length_lo, length_hi, pause_lo, pause_hi, boundary } =
        &suite.method
    else {
        return Err(format!("suite `{}` is not by random", suite.name));
    };
    let pauses = RandomPauses::of(program, (*pause_lo, *pause_hi), *boundary);
    let mut actors: Vec<ActorId> = stimuli.iter().map(|event| program.event(*event).from).collect();
    actors.sort_unstable();
    actors.dedup();
    let mut harvest = AbstractTests::default();
    let mut choices: Vec<RandomChoice> = Vec::new();
    for event in stimuli {
        let actor = program.event(*event).from;
        choices.extend(instances(program, *event)?.into_iter().map(|step| RandomChoice { step, actor }));
    }
    for pattern in awaits {
        let step = TestStep::Await { events: vec![pattern.clone()], within: suite.settings.patience };
        let waiting = listeners(program, &actors, pattern.event);
        if waiting.is_empty() {
            let name = &program.event(pattern.event).name;
            let note = format!("nobody with a stimulus in the suite hears `{name}`: it is not awaited");
            harvest.notes.push(note);
        }
        choices.extend(waiting.into_iter().map(|actor| RandomChoice { step: step.clone(), actor }));
    }
    if choices.is_empty() {
        return Err(format!("suite `{}` has no stimuli to draw from", suite.name));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for _ in 0..count {
        let length = rng.random_range(*length_lo..=*length_hi.max(length_lo));
        let mut draw = RandomSequences::new(program, &actors);
        for _ in 0..length {
            let pause = pauses.draw(&mut rng);
            draw.add(&choices[rng.random_range(0..choices.len())], pause);
        }
        harvest.tests.push(AbstractTest {
            scripts: draw.finish(),
            because: vec![format!("{length} steps drawn at random")],
            ..AbstractTest::default()
        });
    }
    Ok(harvest)
}

/// Pauses are tenths of a second: a person's, readable in the test's text.
const PAUSE_GRID: Nanos = SECOND / 10;

/// The pauses of a suite.
struct RandomPauses {
    lo: Nanos,
    hi: Nanos,
    /// The share that is put at a bound, and the times there.
    beside: Option<(f64, Vec<Nanos>)>,
}

impl RandomPauses {
    fn of(program: &Program, (lo, hi): (Nanos, Nanos), share: Option<f64>) -> Self {
        let beside = share.map(|share| {
            let times = [lo, hi].into_iter().chain(times::of(program));
            let beside = times.flat_map(|time| [time - PAUSE_GRID, time, time + PAUSE_GRID]);
            let all: BTreeSet<Nanos> = beside.filter(|time| (lo..=hi).contains(time)).collect();
            (share, all.into_iter().collect())
        });
        Self { lo, hi, beside }
    }

    fn draw(&self, rng: &mut ChaCha8Rng) -> Nanos {
        if let Some((share, times)) = &self.beside
            && rng.random_range(0.0..1.0) < *share
        {
            return times[rng.random_range(0..times.len())];
        }
        let pause = if self.lo < self.hi { rng.random_range(self.lo..=self.hi) } else { self.lo };
        pause / PAUSE_GRID * PAUSE_GRID
    }
}

/// Which of the actors can wait for an event. An actor alone has the script of all, which hears what any of them hears.
fn listeners(program: &Program, actors: &[ActorId], event: EventId) -> Vec<ActorId> {
    let is_alone = actors.len() <= 1;
    // What its own stimuli make an actor does not hear; what the world makes in its name it does.
    let declared = program.event(event);
    let own =
        declared.is_stimulus() || program.events.iter().any(|e| e.from == declared.from && emits(e, event));
    let hears = |actor: &&ActorId| {
        is_alone || is_perceived(program, **actor, event) && !(own && declared.from == **actor)
    };
    actors.iter().filter(hears).copied().collect()
}

/// Whether a stimulus may emit an event.
fn emits(stimulus: &Event, event: EventId) -> bool {
    let mut open: Vec<&StimulusStep> = stimulus.stimulus.iter().flat_map(|s| &s.steps).collect();
    while let Some(step) = open.pop() {
        match step {
            StimulusStep::Emit { event: emitted, .. } if *emitted == event => return true,
            StimulusStep::If { then, otherwise, .. } => open.extend(then.iter().chain(otherwise)),
            StimulusStep::Emit { .. } | StimulusStep::Hold { .. } | StimulusStep::Act(_) => {}
        }
    }
    false
}

/// A step that may be drawn, and whose it is.
struct RandomChoice {
    step: TestStep,
    actor: ActorId,
}

/// The sequences of a test under construction, one for each actor.
struct RandomSequences<'p> {
    program: &'p Program,
    sequences: Vec<RandomSequence>,
}

/// What one actor does. Its times are lower bounds: that is what an assumption's window must be judged by.
struct RandomSequence {
    actor: ActorId,
    assumptions: AssumptionChecker,
    steps: Vec<TestStep>,
    time: Nanos,
}

impl<'p> RandomSequences<'p> {
    fn new(program: &'p Program, actors: &[ActorId]) -> Self {
        let sequence = |actor: &ActorId| RandomSequence {
            actor: *actor,
            assumptions: AssumptionChecker::new(program),
            steps: Vec::new(),
            time: 0,
        };
        Self { program, sequences: actors.iter().map(sequence).collect() }
    }

    /// Adds a pause, and the step unless it would break an assumption.
    fn add(&mut self, choice: &RandomChoice, pause: Nanos) {
        let Some(at) = self.sequences.iter().position(|s| s.actor == choice.actor) else { return };
        let (before, rest) = self.sequences.split_at_mut(at);
        let Some((own, after)) = rest.split_first_mut() else { return };
        if pause > 0 {
            own.time += pause;
            own.steps.push(TestStep::Wait { time: pause });
        }
        if let TestStep::Do { event, args, .. } = &choice.step {
            let made = makes(self.program, *event, args);
            let others: Vec<&AssumptionChecker> =
                before.iter().chain(after.iter()).map(|s| &s.assumptions).collect();
            let mut breaks = |(e, a): &(EventId, Vec<Value>)| {
                own.assumptions.would_violate_beside(&others, own.time, *e, a).is_some()
            };
            if made.iter().any(&mut breaks) {
                return;
            }
            for (event, args) in &made {
                own.assumptions.record(own.time, *event, args);
            }
        }
        own.steps.push(choice.step.clone());
    }

    /// A script for each actor that has a step, or one of all if there is one actor.
    fn finish(self) -> Vec<TestScript> {
        if self.sequences.len() <= 1 {
            return TestScript::of_all(self.sequences.into_iter().flat_map(|s| s.steps).collect());
        }
        let drawn = self.sequences.into_iter().filter(|s| !s.steps.is_empty());
        drawn.map(|s| TestScript { actor: Some(s.actor), steps: s.steps }).collect()
    }
}

/// A stimulus with each tuple of its arguments.
fn instances(program: &Program, event: EventId) -> Result<Vec<TestStep>, String> {
    let declared = program.event(event);
    let mut tuples: Vec<Vec<Value>> = vec![Vec::new()];
    for param in &declared.params {
        let Some(domain) = Type::domain(param.ty) else {
            return Err(format!(
                "stimulus `{}`: values of `{}` cannot be enumerated",
                declared.name, param.name
            ));
        };
        let extend = |tuple: &Vec<Value>| {
            let tuple = tuple.clone();
            domain.iter().map(move |v| [tuple.as_slice(), &[*v]].concat()).collect::<Vec<_>>()
        };
        tuples = tuples.iter().flat_map(extend).collect();
    }
    let step = |args| TestStep::Do { event, args, samples: Vec::new(), meanwhile: false };
    Ok(tuples.into_iter().map(step).collect())
}

/// The stimulus itself and the events that it makes whose arguments do not depend on samples.
fn makes(program: &Program, event: EventId, args: &[Value]) -> Vec<(EventId, Vec<Value>)> {
    let eval = |e: &Expr| e.eval(&|i| args.get(i as usize).copied()).ok();
    let made = |step: &StimulusStep| match step {
        StimulusStep::Emit { event, args } => {
            Some((*event, args.iter().map(eval).collect::<Option<Vec<Value>>>()?))
        }
        StimulusStep::Hold { .. } | StimulusStep::Act(_) | StimulusStep::If { .. } => None,
    };
    let made = extract::taken(program, event, args).into_iter().filter_map(made);
    std::iter::once((event, args.to_vec())).chain(made).collect()
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{ActorId, Enumeration, Event, Parameter, Span, Unit};

    use super::*;

    #[test]
    fn every_symbol_is_a_choice() {
        let pace = Type::Enum(Enumeration::intern("Pace", &["slow", "fast", "crawl"]));
        let param = |name: &str, ty| Parameter { name: name.into(), ty };
        let mut event = Event {
            name: "go".into(),
            params: vec![param("pace", pace), param("on", Type::Bool)],
            from: ActorId(0),
            to: Vec::new(),
            stimulus: None,
            origin: Span::default(),
        };
        let program = Program { events: vec![event.clone()], ..Program::default() };
        let suite = Suite {
            name: "s".into(),
            method: SuiteMethod::Random {
                stimuli: vec![EventId(0)],
                awaits: Vec::new(),
                length_lo: 60,
                length_hi: 60,
                pause_lo: 0,
                pause_hi: 0,
                boundary: None,
            },
            settings: hrdsl_ir::suite::SuiteSettings {
                tests: 1,
                ..hrdsl_ir::suite::SuiteSettings::default()
            },
            origin: Span::default(),
        };
        let drawn = harvest(&program, &suite, 1, 3).unwrap();
        let mut seen: Vec<String> =
            drawn.tests[0].scripts[0].steps.iter().map(|s| crate::write::step_text(&program, s)).collect();
        seen.sort();
        seen.dedup();
        let all = ["crawl, false", "crawl, true", "fast, false", "fast, true", "slow, false", "slow, true"];
        assert_eq!(seen, all.map(|args| format!("go({args})")));
        event.params.push(param("far", Type::Float(Unit::Metre)));
        let program = Program { events: vec![event], ..Program::default() };
        assert!(harvest(&program, &suite, 1, 3).is_err());
    }
}
