//! Where a run of a mutant first goes another way than the original's.

use hrdsl_ir::{Program, value::seconds};
use hrdsl_judge::recorded_run;
use hrdsl_results::{RunDifference, TestName};
use hrdsl_trace::{Trace, TraceStep, print};

/// The first difference of two recordings of a test, the original's and the mutant's; `None` if there is none in what happens, or one of
/// them cannot be read.
#[must_use]
pub fn first_difference(
    program: &Program,
    test: &TestName,
    (original, mutant): (&str, &str),
) -> Option<RunDifference> {
    let read = |text: &str| recorded_run(program, text.as_bytes(), false).ok();
    let ((original, _), (mutant, _)) = (read(original)?, read(mutant)?);
    let same = original.steps.iter().zip(&mutant.steps).take_while(|(a, b)| a == b).count();
    let (before, now) = (original.steps.get(same), mutant.steps.get(same));
    if before.is_none() && now.is_none() && original.end == mutant.end {
        return None;
    }
    let time = |step: Option<&TraceStep>, trace: &Trace| step.map_or(trace.end, |step| step.time);
    Some(RunDifference {
        test: test.clone(),
        time: seconds(time(before, &original).min(time(now, &mutant))),
        original: shown(program, before, &original),
        mutant: shown(program, now, &mutant),
    })
}

fn shown(program: &Program, step: Option<&TraceStep>, trace: &Trace) -> String {
    let Some(step) = step else { return format!("the end at {:.3} s", seconds(trace.end)) };
    let (who, what) = print::who_did_what(program, &step.what);
    format!("{who} {what} at {:.3} s", seconds(step.time))
}
