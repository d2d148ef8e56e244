//! Recordings, judged while they are read.

use std::io::BufRead;

use hrdsl_conformance::ConformanceOptions;
use hrdsl_ir::{Nanos, Program, value::seconds};
use hrdsl_results::TraceJudgement;
use hrdsl_trace::{
    MachineDeclaration, RunEnd, Trace, TraceObserver, TraceStep,
    parse::{OpenRecording, ReadError, RecordingSummary},
    record::RecordingHeader,
    vocabulary,
};
use thiserror::Error;

use crate::{
    TraceJudge,
    formula::{FormulaJudge, JudgedFormula, NamedFormula},
};

/// A recording with the judgement on it.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedRecording {
    pub recorded: RecordingSummary,
    pub judgement: TraceJudgement,
    /// What the state machines in it consist of.
    pub machines: Vec<MachineDeclaration>,
}

impl JudgedRecording {
    /// Simulated seconds, or those of a real run.
    #[must_use]
    pub fn duration(&self) -> f64 {
        seconds(self.recorded.end)
    }

    #[must_use]
    pub fn ended(&self) -> RunEnd {
        self.recorded.ending.kind
    }
}

/// Why a recording is not judged.
#[derive(Debug, Error)]
pub enum JudgeError {
    #[error("{0}")]
    Read(#[from] ReadError),
    #[error("this is a recording of the scenario `{found}`, not of `{expected}`")]
    Scenario { expected: String, found: String },
    #[error(
        "this is a recording of `{scenario}` with other events or signals (vocabulary {found}, the scenario has {expected}): \
         the scenario has changed since"
    )]
    Vocabulary { scenario: String, expected: String, found: String },
}

/// Reads a recording in one pass, and judges it. Unless `changed` is allowed, the recording must be of this scenario and its
/// vocabulary; where it is allowed, every name in the recording must still be known. `options` say how the recording shows what the code did.
///
/// # Errors
/// A recording of another scenario, and the first line that is wrong.
pub fn judge_recording(
    program: &Program,
    source: impl BufRead,
    changed: bool,
    options: &ConformanceOptions,
) -> Result<JudgedRecording, JudgeError> {
    let mut judge = TraceJudge::new(program, options);
    let recorded = observe(program, source, changed, &mut judge)?;
    let (judgement, machines) = judge.finish(recorded.ending.kind);
    Ok(JudgedRecording { recorded, judgement, machines })
}

/// A signal of a formula that has no sample in a recording, by their names.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct UnseenSignal {
    pub formula: String,
    pub signal: String,
}

/// The same, by formulas, too, whose verdicts come behind those of the requirements.
///
/// # Errors
/// A recording of another scenario, and the first line that is wrong.
pub fn judge_by_formulas(
    (program, formulas): (&Program, &[NamedFormula]),
    source: impl BufRead,
    changed: bool,
    options: &ConformanceOptions,
) -> Result<(JudgedRecording, Vec<UnseenSignal>), JudgeError> {
    let mut judges = JudgesBesides {
        judge: TraceJudge::new(program, options),
        formulas: formulas.iter().map(FormulaJudge::new).collect(),
    };
    let recorded = observe(program, source, changed, &mut judges)?;
    let ended = recorded.ending.kind;
    let (mut judgement, machines) = judges.judge.finish(ended);
    let (mut verdicts, mut unseen) = (Vec::new(), Vec::new());
    for (named, judge) in formulas.iter().zip(judges.formulas) {
        let JudgedFormula { verdict, unseen: signals } = judge.finish(program);
        verdicts.push(verdict);
        let named_signals = signals.iter().filter_map(|s| program.signals.get(usize::from(s.0)));
        unseen.extend(
            named_signals
                .map(|signal| UnseenSignal { formula: named.name.clone(), signal: signal.name.clone() }),
        );
    }
    judgement.verdicts.extend(verdicts);
    if ended == RunEnd::Error {
        judgement.break_off();
    }
    Ok((JudgedRecording { recorded, judgement, machines }, unseen))
}

/// The judge of a trace, and formulas besides.
struct JudgesBesides<'p> {
    judge: TraceJudge<'p>,
    formulas: Vec<FormulaJudge<'p>>,
}

impl TraceObserver for JudgesBesides<'_> {
    fn step(&mut self, index: usize, step: &TraceStep) {
        self.judge.step(index, step);
        self.formulas.iter_mut().for_each(|formula| formula.step(index, step));
    }

    fn end(&mut self, time: Nanos) {
        self.judge.end(time);
        self.formulas.iter_mut().for_each(|formula| formula.end(time));
    }
}

/// What a recording has, and how its run ended, without a judgement; `changed` as in [`judge_recording`].
///
/// # Errors
/// A recording of another scenario, and the first line that is wrong.
pub fn recorded_run(
    program: &Program,
    source: impl BufRead,
    changed: bool,
) -> Result<(Trace, RunEnd), JudgeError> {
    let mut trace = Trace::default();
    let recorded = observe(program, source, changed, &mut trace)?;
    Ok((trace, recorded.ending.kind))
}

pub(crate) fn observe(
    program: &Program,
    source: impl BufRead,
    changed: bool,
    observer: &mut dyn TraceObserver,
) -> Result<RecordingSummary, JudgeError> {
    let recording = OpenRecording::open(source)?;
    if !changed {
        is_of(program, recording.header())?;
    }
    Ok(recording.replay(program, observer)?)
}

/// Whether a recording is of this scenario as it is now. Recordings by other programs need not have a vocabulary.
fn is_of(program: &Program, header: &RecordingHeader) -> Result<(), JudgeError> {
    if header.scenario != program.name {
        let (expected, found) = (program.name.clone(), header.scenario.clone());
        return Err(JudgeError::Scenario { expected, found });
    }
    let expected = vocabulary::digest(program);
    match &header.vocabulary {
        Some(found) if *found != expected => {
            let (scenario, found) = (header.scenario.clone(), found.clone());
            Err(JudgeError::Vocabulary { scenario, expected, found })
        }
        Some(_) | None => Ok(()),
    }
}
