//! Tests.

use hrdsl_ir::{
    coverage::BinName,
    test::{Provenance, Test, TestMethod, TestStep},
    value::nanos,
};
use hrdsl_model as model;

use super::{expr, vocabulary::patterns};

/// The test's full name starts with the scenario's, whether it was written or not.
pub(crate) fn test(t: &model::Test, scenario: &str) -> Test {
    let prefix = format!("{scenario}.");
    let name = t.name.strip_prefix(&prefix).unwrap_or(&t.name);
    let suite = name.rsplit_once('.').map_or("", |(suite, _)| suite);
    Test {
        name: format!("{prefix}{name}"),
        seed: t.seed,
        provenance: Provenance {
            suite: suite.to_owned(),
            // The checker knows these words and this form alone.
            method: TestMethod::of_word(&t.method).unwrap_or_default(),
            because: t.because.clone(),
            predicts: t.predicts.iter().filter_map(|name| BinName::parse(name)).collect(),
        },
        steps: t.steps.iter().map(step).collect(),
        origin: t.span,
    }
}

fn step(s: &model::TestStep) -> TestStep {
    match s {
        model::TestStep::Do { event, args, samples } => {
            TestStep::Do { event: *event, args: expr::values(args), samples: expr::values(samples) }
        }
        model::TestStep::Await { events, within } => {
            TestStep::Await { events: patterns(events), within: nanos(*within) }
        }
        model::TestStep::Wait(time) => TestStep::Wait { time: nanos(*time) },
    }
}
