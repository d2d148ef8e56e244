//! The baseline: stimuli, awaits and pauses drawn at random (Section "Baseline: Pseudorandom Test Generation").

use hrdsl_coverage::assume::AssumptionChecker;
use hrdsl_ir::{
    EventId, Expr, Nanos, Program, Type, Value,
    event::StimulusStep,
    suite::{Suite, SuiteMethod},
    test::TestStep,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    extract,
    harvest::{AbstractTest, AbstractTests},
};

/// Draws `count` sequences.
///
/// # Errors
/// A suite without stimuli, or a stimulus whose arguments cannot be enumerated.
pub fn harvest(program: &Program, suite: &Suite, count: u32, seed: u64) -> Result<AbstractTests, String> {
    let SuiteMethod::Random { stimuli, awaits, length_lo, length_hi, pause_lo, pause_hi } = &suite.method
    else {
        return Err(format!("suite `{}` is not by random", suite.name));
    };
    let mut choices: Vec<TestStep> = Vec::new();
    for event in stimuli {
        choices.extend(instances(program, *event)?);
    }
    choices.extend(
        awaits.iter().map(|e| TestStep::Await { events: vec![e.clone()], within: suite.settings.patience }),
    );
    if choices.is_empty() {
        return Err(format!("suite `{}` has no stimuli to draw from", suite.name));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut harvest = AbstractTests::default();
    for _ in 0..count {
        let length = rng.random_range(*length_lo..=*length_hi.max(length_lo));
        let mut draw = RandomSequence {
            program,
            assumptions: AssumptionChecker::new(program),
            steps: Vec::new(),
            time: 0,
        };
        for _ in 0..length {
            let pause = if pause_lo < pause_hi { rng.random_range(*pause_lo..=*pause_hi) } else { *pause_lo };
            // Tenths of a second: a person's pauses, readable in the test's text.
            draw.pause(pause / 100_000_000 * 100_000_000);
            let choice = &choices[rng.random_range(0..choices.len())];
            draw.step(choice);
        }
        harvest.tests.push(AbstractTest {
            steps: draw.steps,
            because: vec![format!("{length} steps drawn at random")],
            ..AbstractTest::default()
        });
    }
    Ok(harvest)
}

/// A sequence under construction. Its times are lower bounds: that is what an assumption's window must be judged by.
struct RandomSequence<'p> {
    program: &'p Program,
    assumptions: AssumptionChecker,
    steps: Vec<TestStep>,
    time: Nanos,
}

impl RandomSequence<'_> {
    fn pause(&mut self, time: Nanos) {
        if time > 0 {
            self.time += time;
            self.steps.push(TestStep::Wait { time });
        }
    }

    /// Adds the step, unless it would break an assumption.
    fn step(&mut self, step: &TestStep) {
        if let TestStep::Do { event, args, .. } = step {
            let made = makes(self.program, *event, args);
            let breaks =
                |(e, a): &(EventId, Vec<Value>)| self.assumptions.would_violate(self.time, *e, a).is_some();
            if made.iter().any(breaks) {
                return;
            }
            for (event, args) in &made {
                self.assumptions.record(self.time, *event, args);
            }
        }
        self.steps.push(step.clone());
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
    Ok(tuples.into_iter().map(|args| TestStep::Do { event, args, samples: Vec::new() }).collect())
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
            },
            settings: hrdsl_ir::suite::SuiteSettings {
                tests: 1,
                ..hrdsl_ir::suite::SuiteSettings::default()
            },
            origin: Span::default(),
        };
        let drawn = harvest(&program, &suite, 1, 3).unwrap();
        let mut seen: Vec<String> =
            drawn.tests[0].steps.iter().map(|s| super::super::write::step_text(&program, s)).collect();
        seen.sort();
        seen.dedup();
        let all = ["crawl, false", "crawl, true", "fast, false", "fast, true", "slow, false", "slow, true"];
        assert_eq!(seen, all.map(|args| format!("go({args})")));
        event.params.push(param("far", Type::Float(Unit::Metre)));
        let program = Program { events: vec![event], ..Program::default() };
        assert!(harvest(&program, &suite, 1, 3).is_err());
    }
}
