//! The stimulus at the end of a witness: done there, with all that it sends, and replayed.

use hrdsl_ir::Nanos;
use hrdsl_prove::{ObservedNetwork, WalkOption, WalkSession, WitnessTrace};
use hrdsl_ta::{MomentRange, WitnessRun};

use super::StimulusEdge;
use crate::named::is_generated;

/// More transitions are not what one stimulus sends.
const MOST_SENT: usize = 64;

/// Walks along the witness, and does the first of these stimuli that can be done at its end.
///
/// # Errors
/// Why none can be done.
pub fn closed(
    observed: &ObservedNetwork,
    witness: &WitnessRun,
    stimuli: &[StimulusEdge],
) -> Result<WitnessRun, String> {
    let (program, network) = (&observed.program, &observed.network);
    let mut session = WalkSession::new(program, network, 0).map_err(|e| e.to_string())?;
    let told = WitnessTrace::from_run(program, network, witness);
    for (step, told) in witness.steps.iter().zip(&told.steps) {
        let same = |o: &WalkOption| o.told.parts == told.parts && o.told.over == told.over;
        take(&mut session, moment(step.time, witness.ticks), same)
            .ok_or("the witness cannot be walked along")?;
    }
    let end = moment(witness.end, witness.ticks);
    let does = |o: &WalkOption| {
        let first = o.told.parts.first();
        first.is_some_and(|part| stimuli.iter().any(|s| (s.member, s.edge + 1) == (part.member, part.edge)))
    };
    let actor =
        take(&mut session, end, does).ok_or("what the stimulus leads to is ruled out by the model")?;
    // What the body of the stimulus sends follows at once, through locations of the compiler's.
    for _ in 0..MOST_SENT {
        let at = session.walk.locations(session.state());
        if !at.get(actor).is_some_and(|name| is_generated(name)) {
            break;
        }
        let own = |o: &WalkOption| o.told.parts.first().is_some_and(|part| part.member == actor);
        if take(&mut session, end, own).is_none() {
            break;
        }
    }
    session.run().map_err(|e| e.to_string())
}

/// Takes the first such transition that is possible at the moment; gives who starts it.
fn take(
    session: &mut WalkSession<'_>,
    when: MomentRange,
    is_it: impl Fn(&WalkOption) -> bool,
) -> Option<usize> {
    let options = session.options();
    let candidates = options.iter().enumerate().filter(|(_, o)| is_it(o));
    for (choice, option) in candidates {
        if session.take_within(choice, Some(when)).is_ok() {
            return option.told.parts.first().map(|part| part.member);
        }
    }
    None
}

/// The nanosecond of a time in ticks, or what lies between it and the next.
fn moment(time: i64, ticks: i64) -> MomentRange {
    let ticks = ticks.max(1);
    let from: Nanos = time.div_euclid(ticks);
    let exact = time.rem_euclid(ticks) == 0;
    MomentRange { from, after: !exact, until: Some(if exact { from } else { from + 1 }), before: !exact }
}
