//! Reads a recording back, with its names resolved against a program: step by step ([`OpenRecording`]), or as a whole trace
//! ([`parse`]).
//!
//! Recordings come from other programs, too: whatever is wrong with one is said with the number of its line.

mod line;
mod problem;
mod quick;

use std::{
    collections::BTreeMap,
    io::{BufRead, Read as _},
};

use hrdsl_ir::{EventId, Nanos, Parameter, Program, Type, Unit, Value, world::SignalId};
use serde_json::Value as Json;
use thiserror::Error;

use crate::{
    Trace, TraceObserver, TraceStep, TraceStepKind, decimal,
    record::{KIND, RecordingEnd, RecordingHeader, VERSION},
};
use line::{HeaderLine, StepLine};
use problem::LONGEST_LINE;
pub use problem::LineProblem;
use quick::{QuickLine, quick_value};

/// A recording, apart from its steps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordingSummary {
    pub header: RecordingHeader,
    /// When the run ended.
    pub end: Nanos,
    pub ending: RecordingEnd,
    /// How many steps there were.
    pub steps: usize,
}

/// Why a recording could not be read.
#[derive(Debug, Error)]
pub enum ReadError {
    #[error("{0}")]
    Io(#[from] std::io::Error),
    #[error("{0}")]
    Parse(#[from] ParseError),
}

/// Why a text is not a recording of this program.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}: {problem}")]
pub struct ParseError {
    /// Counted from 1.
    pub line: usize,
    pub problem: LineProblem,
}

/// A recording's trace and the rest of it. Blank lines are skipped.
///
/// # Errors
/// The first line that is wrong, and why.
pub fn parse(program: &Program, text: &str) -> Result<(RecordingSummary, Trace), ParseError> {
    let mut trace = Trace::default();
    match OpenRecording::open(text.as_bytes()).and_then(|r| r.replay(program, &mut trace)) {
        Ok(recorded) => Ok((recorded, trace)),
        Err(ReadError::Parse(error)) => Err(error),
        // Nothing goes wrong with reading from memory.
        Err(ReadError::Io(error)) => {
            Err(ParseError { line: 1, problem: LineProblem::Json(error.to_string()) })
        }
    }
}

/// A recording of which the header was read.
#[derive(Debug)]
pub struct OpenRecording<R> {
    lines: RecordingLines<R>,
    header: RecordingHeader,
}

impl<R: BufRead> OpenRecording<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// A first line that is none.
    pub fn open(source: R) -> Result<Self, ReadError> {
        let mut lines = RecordingLines { source, bytes: Vec::new(), read: 0, number: 0, is_whole: true };
        let header = match lines.next()? {
            Some(text) => header(text),
            None => Err(LineProblem::NoHeader),
        };
        let header = header.map_err(|problem| lines.wrong(problem))?;
        Ok(Self { lines, header })
    }

    #[must_use]
    pub fn header(&self) -> &RecordingHeader {
        &self.header
    }

    /// Shows the steps to an observer, one by one, in memory that does not grow with the recording.
    ///
    /// # Errors
    /// The first line that is wrong, and why; then the observer has seen the steps before it.
    pub fn replay(
        self,
        program: &Program,
        observer: &mut dyn TraceObserver,
    ) -> Result<RecordingSummary, ReadError> {
        let Self { mut lines, header } = self;
        let mut reader = StepReader::new(program, header);
        while let Some(text) = lines.next()? {
            match reader.line(text) {
                Ok(Some(step)) => {
                    observer.step(reader.recorded.steps, &step);
                    reader.recorded.steps += 1;
                }
                Ok(None) => {}
                Err(problem) => return Err(lines.wrong(problem).into()),
            }
        }
        let recorded = reader.finish().map_err(|problem| lines.wrong(problem))?;
        observer.end(recorded.end);
        Ok(recorded)
    }
}

/// The lines of a recording, one at a time.
#[derive(Debug)]
struct RecordingLines<R> {
    source: R,
    bytes: Vec<u8>,
    /// How many were read.
    read: usize,
    /// Of the latest line that is not blank, from 1.
    number: usize,
    /// Whether that line has a line break.
    is_whole: bool,
}

impl<R: BufRead> RecordingLines<R> {
    /// The next line that is not blank.
    fn next(&mut self) -> Result<Option<&str>, ReadError> {
        loop {
            self.bytes.clear();
            if (&mut self.source).take(LONGEST_LINE).read_until(b'\n', &mut self.bytes)? == 0 {
                return Ok(None);
            }
            self.read += 1;
            self.is_whole = self.bytes.ends_with(b"\n");
            if !self.is_whole && self.bytes.len() as u64 == LONGEST_LINE {
                return Err(ParseError { line: self.read, problem: LineProblem::TooLong }.into());
            }
            if !self.bytes.iter().all(u8::is_ascii_whitespace) {
                break;
            }
        }
        self.number = self.read;
        match std::str::from_utf8(&self.bytes) {
            Ok(text) => Ok(Some(text.trim_end_matches(['\n', '\r']))),
            Err(_) => Err(ParseError { line: self.number, problem: LineProblem::NotText }.into()),
        }
    }

    /// What is wrong with the latest line.
    fn wrong(&self, problem: LineProblem) -> ParseError {
        // A line that was being written when the recorder died has no line break.
        let is_cut = matches!(problem, LineProblem::Json(_)) && !self.is_whole;
        ParseError {
            line: self.number.max(1),
            problem: if is_cut { LineProblem::Truncated } else { problem },
        }
    }
}

/// Gives names their meaning, line by line.
struct StepReader<'a> {
    program: &'a Program,
    events: BTreeMap<&'a str, EventId>,
    signals: BTreeMap<&'a str, SignalId>,
    recorded: RecordingSummary,
    now: Nanos,
    ended: bool,
}

impl<'a> StepReader<'a> {
    fn new(program: &'a Program, header: RecordingHeader) -> Self {
        // From the back, so that the first of several of the same name stands.
        let events = (0u16..).zip(&program.events).map(|(i, e)| (e.name.as_str(), EventId(i)));
        let signals = (0u16..).zip(&program.signals).map(|(i, s)| (s.name.as_str(), SignalId(i)));
        Self {
            program,
            events: events.collect::<Vec<_>>().into_iter().rev().collect(),
            signals: signals.collect::<Vec<_>>().into_iter().rev().collect(),
            recorded: RecordingSummary { header, ..RecordingSummary::default() },
            now: 0,
            ended: false,
        }
    }

    /// The line's step; none if it is the last line.
    fn line(&mut self, text: &str) -> Result<Option<TraceStep>, LineProblem> {
        match self.quick(text) {
            Some(step) => Ok(Some(step)),
            None => self.any_line(text),
        }
    }

    /// A step that is right, and written as recordings are.
    fn quick(&mut self, text: &str) -> Option<TraceStep> {
        let mut line = QuickLine::new(text);
        line.over("{\"t\":")?;
        let time = decimal::nanos(line.number()?).filter(|time| *time >= self.now && !self.ended)?;
        let what = if line.over(",\"event\":\"").is_some() {
            let event = *self.events.get(line.name()?)?;
            TraceStepKind::Event { event, args: self.quick_args(event, &mut line)? }
        } else {
            line.over(",\"signal\":\"")?;
            let signal = *self.signals.get(line.name()?)?;
            line.over(",\"value\":")?;
            let ty = self.program.signals.get(usize::from(signal.0))?.ty;
            TraceStepKind::Sample { signal, value: quick_value(ty, line.value()?)? }
        };
        line.over("}")?;
        if !line.is_over() {
            return None;
        }
        self.now = time;
        Some(TraceStep { time, what })
    }

    /// Arguments in the order of the parameters.
    fn quick_args(&self, event: EventId, line: &mut QuickLine<'_>) -> Option<Vec<Value>> {
        let params = &self.program.event(event).params;
        let mut args = Vec::with_capacity(params.len());
        for param in params {
            line.over(if args.is_empty() { ",\"args\":{\"" } else { ",\"" })?;
            let name = line.name()?;
            line.over(":")?;
            args.push(quick_value(param.ty, line.value()?).filter(|_| name == param.name)?);
        }
        if !params.is_empty() {
            line.over("}")?;
        }
        Some(args)
    }

    fn any_line(&mut self, text: &str) -> Result<Option<TraceStep>, LineProblem> {
        let line = StepLine::read(text)?;
        if self.ended {
            return Err(LineProblem::AfterEnd);
        }
        if let Some(end) = line.end {
            self.recorded.end = self.pass(end.get())?;
            self.ended = true;
            self.recorded.ending = line.ending()?;
            return Ok(None);
        }
        if line.ended.is_some() || line.error.is_some() {
            return Err(LineProblem::Form("only the last line says how the run ended"));
        }
        let Some(time) = line.t else { return Err(LineProblem::Form("the step lacks its time `t`")) };
        let time = self.pass(time.get())?;
        if line.has_machine() {
            let what = TraceStepKind::Machine(Box::new(line.machine_step()?));
            return Ok(Some(TraceStep { time, what }));
        }
        let what = match (line.event, line.args, line.signal, line.value) {
            (Some(event), args, None, None) => self.event(&event, args.map(|a| a.0).unwrap_or_default())?,
            (None, None, Some(signal), Some(value)) => self.sample(&signal, &value)?,
            (Some(_), _, _, _) => return Err(LineProblem::Form("an event has `t`, `event` and `args` only")),
            (None, _, Some(_), None) => return Err(LineProblem::Form("the sample lacks its `value`")),
            (None, _, Some(_), Some(_)) => {
                return Err(LineProblem::Form("a sample has `t`, `signal` and `value` only"));
            }
            (None, _, None, _) => {
                return Err(LineProblem::Form("the step has neither `event` nor `signal` nor `machine`"));
            }
        };
        Ok(Some(TraceStep { time, what }))
    }

    fn pass(&mut self, text: &str) -> Result<Nanos, LineProblem> {
        let time =
            decimal::nanos(text).filter(|t| *t >= 0).ok_or_else(|| LineProblem::Time(text.to_owned()))?;
        if time < self.now {
            let (before, now) = (decimal::seconds(self.now), decimal::seconds(time));
            return Err(LineProblem::Backwards { before, now });
        }
        self.now = time;
        Ok(time)
    }

    fn event(&self, name: &str, given: Vec<(String, Json)>) -> Result<TraceStepKind, LineProblem> {
        let Some(&event) = self.events.get(name) else {
            let near = nearest(name, self.events.keys().copied());
            return Err(LineProblem::UnknownEvent { name: name.to_owned(), near });
        };
        let params = &self.program.event(event).params;
        let mut args: Vec<Option<Value>> = vec![None; params.len()];
        for (arg, json) in given {
            let Some((param, place)) = params.iter().zip(&mut args).find(|(p, _)| p.name == arg) else {
                let near = nearest(&arg, params.iter().map(|p| p.name.as_str()));
                return Err(LineProblem::UnknownArgument { event: name.to_owned(), name: arg, near });
            };
            if place.is_some() {
                return Err(LineProblem::DoubleArgument { event: name.to_owned(), name: arg });
            }
            *place = Some(typed(&arg, param.ty, &json)?);
        }
        let missing = |param: &Parameter| LineProblem::MissingArgument {
            event: name.to_owned(),
            name: param.name.clone(),
        };
        let all = args.into_iter().zip(params).map(|(arg, param)| arg.ok_or_else(|| missing(param)));
        Ok(TraceStepKind::Event { event, args: all.collect::<Result<_, _>>()? })
    }

    #[expect(clippy::indexing_slicing, reason = "the names are of this program's signals")]
    fn sample(&self, name: &str, json: &Json) -> Result<TraceStepKind, LineProblem> {
        let Some(&signal) = self.signals.get(name) else {
            let near = nearest(name, self.signals.keys().copied());
            return Err(LineProblem::UnknownSignal { name: name.to_owned(), near });
        };
        let ty = self.program.signals[usize::from(signal.0)].ty;
        Ok(TraceStepKind::Sample { signal, value: typed(name, ty, json)? })
    }

    fn finish(self) -> Result<RecordingSummary, LineProblem> {
        if self.ended { Ok(self.recorded) } else { Err(LineProblem::Truncated) }
    }
}

fn header(text: &str) -> Result<RecordingHeader, LineProblem> {
    let head = HeaderLine::read(text)?;
    let (Some(kind), Some(version), Some(scenario)) = (head.hrdsl, head.version, head.scenario) else {
        return Err(LineProblem::NoHeader);
    };
    if kind != KIND {
        return Err(LineProblem::NoHeader);
    }
    if !(1..=VERSION).contains(&version) {
        return Err(LineProblem::Version(version));
    }
    Ok(RecordingHeader { scenario, vocabulary: head.vocabulary, test: head.test, seed: head.seed })
}

/// The value, if it is of the type. A whole number will do for a float; a float that no JSON number can be is a string.
fn typed(of: &str, ty: Type, json: &Json) -> Result<Value, LineProblem> {
    let value = match ty {
        Type::Bool => json.as_bool().map(Value::Bool),
        Type::Int { .. } => json.as_i64().map(Value::Int),
        Type::Float(_) => match json.as_str() {
            Some("nan") => Some(Value::Float(f64::NAN)),
            Some("inf") => Some(Value::Float(f64::INFINITY)),
            Some("-inf") => Some(Value::Float(f64::NEG_INFINITY)),
            Some(_) => None,
            None => json.as_f64().map(Value::Float),
        },
        // Looked up, not interned: what a recording says must not stay in memory.
        Type::Enum(e) => json.as_str().and_then(|name| e.symbol(name)).map(Value::Symbol),
        // Agents have these alone; no event or signal does.
        Type::Text | Type::List(_) => None,
    };
    value.filter(|v| ty.admits(*v)).ok_or_else(|| LineProblem::Type {
        of: of.to_owned(),
        expected: described(ty),
        found: json.to_string(),
    })
}

fn described(ty: Type) -> String {
    match ty {
        Type::Bool => "true or false".to_owned(),
        Type::Int { lo, hi } => format!("a whole number in {lo}..{hi}"),
        Type::Float(Unit::None) => "a number".to_owned(),
        Type::Float(unit) => format!("a number ({})", unit.symbol()),
        Type::Enum(e) => format!("the name of a value of `{e}` ({})", e.listed()),
        Type::Text => "nothing: events have no strings".to_owned(),
        Type::List(_) => "nothing: events have no lists".to_owned(),
    }
}

/// The most similar name, if it differs in no more than a third of its letters.
fn nearest<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
    let close = names.map(|n| (distance(name, n), n)).filter(|(d, n)| d * 3 <= n.chars().count().max(3));
    close.min().map(|(_, n)| n.to_owned())
}

/// How many letters have to be added, dropped or changed (Levenshtein's edit distance).
#[expect(clippy::indexing_slicing, reason = "the row has a place for each letter, and one before them")]
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let change = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = change.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
