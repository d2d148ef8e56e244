//! Equal abstract tests become one: the first keeps its place and takes over the others' reasons.

use hrdsl_ir::{
    ArgPattern, Value,
    abstract_test::AbstractTest,
    test::{TestScript, TestStep},
};
use indexmap::IndexMap;

/// How many origins of one abstract test are written out.
const ORIGINS: usize = 3;

/// The different tests, in the order in which each first came.
pub fn distinct(tests: Vec<AbstractTest>) -> Vec<AbstractTest> {
    let mut seen: IndexMap<TestIdentity, AbstractTest> = IndexMap::new();
    for test in tests {
        match seen.entry(identity(&test.scripts)) {
            indexmap::map::Entry::Vacant(slot) => {
                slot.insert(test);
            }
            indexmap::map::Entry::Occupied(mut slot) => {
                let known = slot.get_mut();
                known.reaches.extend(test.reaches);
                for line in test.because {
                    if !known.because.contains(&line) {
                        known.because.push(line);
                    }
                }
            }
        }
    }
    let mut tests: Vec<AbstractTest> = seen.into_values().collect();
    for test in &mut tests {
        let more = test.because.len().saturating_sub(ORIGINS);
        if more > 0 {
            test.because.truncate(ORIGINS);
            test.because.push(format!("and {more} more that lead to the same test"));
        }
    }
    tests
}

/// The numbers of the belief sets that lead to each of the different tests.
pub fn sets(tests: &[AbstractTest]) -> Vec<Vec<u64>> {
    let mut seen: IndexMap<TestIdentity, Vec<u64>> = IndexMap::new();
    for test in tests {
        let sets = seen.entry(identity(&test.scripts)).or_default();
        sets.extend(test.origin.iter().map(|origin| origin.number));
    }
    seen.into_values().collect()
}

/// A number for each thing that makes a test what it is.
pub type TestIdentity = Vec<(u8, u64)>;

/// Marks a part that says what kind the next ones are of, or how many they are.
const KIND: u8 = u8::MAX;

/// Equal for equal scripts alone: the kind of each step, and how many parts a list of parts has, come before the parts.
pub fn identity(scripts: &[TestScript]) -> TestIdentity {
    let mut parts = TestIdentity::new();
    for script in scripts {
        let actor = script.actor.map_or(u64::MAX, |actor| u64::from(actor.0));
        parts.extend([(KIND, actor), (KIND, script.steps.len() as u64)]);
        add_steps(&mut parts, &script.steps);
    }
    parts
}

fn add_steps(parts: &mut TestIdentity, steps: &[TestStep]) {
    let count = |n: usize| (KIND, n as u64);
    let values = |parts: &mut TestIdentity, values: &[Value]| {
        parts.push(count(values.len()));
        parts.extend(values.iter().map(|v| v.key()));
    };
    for step in steps {
        match step {
            TestStep::Do { event, args, samples, meanwhile } => {
                parts.extend([(KIND, 0), (KIND, u64::from(event.0)), (KIND, u64::from(*meanwhile))]);
                values(parts, args);
                values(parts, samples);
            }
            TestStep::Await { events, within } => {
                parts.extend([(KIND, 1), (KIND, within.unsigned_abs()), count(events.len())]);
                for pattern in events {
                    parts.extend([(KIND, u64::from(pattern.event.0)), count(pattern.args.len())]);
                    parts.extend(pattern.args.iter().map(|arg| match arg {
                        ArgPattern::Any => (KIND, 0),
                        ArgPattern::Is(value) => value.key(),
                    }));
                }
            }
            TestStep::Wait { time } => parts.extend([(KIND, 2), (KIND, time.unsigned_abs())]),
        }
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        ActorId, EventId, EventPattern,
        abstract_test::{BeliefSet, TestOrigin},
    };

    use super::*;
    use crate::tests::test;

    #[test]
    fn equal_tests_reach_what_each_of_them_does() {
        let different = distinct(vec![test(1, "a", &[0]), test(2, "b", &[1]), test(1, "c", &[2])]);
        assert_eq!(different.len(), 2);
        assert_eq!(different[0].reaches, [0, 2].into());
        assert_eq!(different[0].because, ["a", "c"]);
    }

    #[test]
    fn equal_tests_stand_for_the_sets_of_all_of_them() {
        let of = |wait, number| AbstractTest {
            origin: Some(TestOrigin { number, beliefs: BeliefSet::default() }),
            ..test(wait, "", &[])
        };
        assert_eq!(sets(&[of(1, 1), of(2, 3), of(1, 4)]), [vec![1, 4], vec![3]]);
    }

    #[test]
    fn whatever_differs_tells_tests_apart() {
        let done = |event, args: &[Value], samples: &[Value]| TestStep::Do {
            event: EventId(event),
            args: args.to_vec(),
            samples: samples.to_vec(),
            meanwhile: false,
        };
        let beside = TestStep::Do { event: EventId(1), args: vec![], samples: vec![], meanwhile: true };
        let awaits = |args: &[ArgPattern], within| TestStep::Await {
            events: vec![EventPattern { event: EventId(1), args: args.to_vec() }],
            within,
        };
        let (one, half) = (Value::Int(1), Value::Float(0.5));
        let all = [
            vec![],
            vec![done(1, &[], &[])],
            vec![beside],
            vec![done(2, &[], &[])],
            vec![done(1, &[one], &[])],
            vec![done(1, &[], &[one])],
            vec![done(1, &[half], &[])],
            vec![done(1, &[Value::Bool(true)], &[])],
            vec![done(1, &[], &[]), done(1, &[], &[])],
            vec![awaits(&[], 5)],
            vec![awaits(&[], 6)],
            vec![awaits(&[ArgPattern::Any], 5)],
            vec![awaits(&[ArgPattern::Is(one)], 5)],
            vec![TestStep::Wait { time: 5 }],
        ];
        let step = || TestStep::Wait { time: 5 };
        let of = |actor, steps| TestScript { actor: Some(ActorId(actor)), steps };
        let mut all: Vec<Vec<TestScript>> = all.into_iter().map(TestScript::of_all).collect();
        all.push(vec![of(0, vec![step()])]);
        all.push(vec![of(1, vec![step()])]);
        all.push(vec![of(0, vec![step()]), of(1, vec![])]);
        all.push(vec![of(0, vec![]), of(1, vec![step()])]);
        for (i, a) in all.iter().enumerate() {
            for (j, b) in all.iter().enumerate() {
                assert_eq!(identity(a) == identity(b), i == j, "{a:?} {b:?}");
            }
        }
    }
}
