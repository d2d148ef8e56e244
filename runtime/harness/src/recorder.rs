//! What is written down of the signals: so few samples that a recording stays small, and so many that whoever judges it finds what
//! he would find if he saw each step of the world.
//!
//! Of each instant the recorder knows whether a monitor that reacts to samples would see anything new in it: another truth of a
//! condition, or a margin less than all before. An instant at which a truth changes is written at once. One with a new least
//! margin is *kept in mind*, for the next one may be worse; it is written, with its own time, when the next point of the grid, or
//! an event, ends the interval, unless by then there is a worse one. Of what a formula compares each change is written: its windows begin and end at any
//! moment.

use std::borrow::Cow;

use hrdsl_ir::{
    Nanos, Program, Value,
    expr::Expr,
    monitor::{Monitor, MonitorTrigger},
    world::SignalId,
};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};

use crate::world::WorldBackend;

/// The recorder of one run.
pub(crate) struct SignalRecorder<'p> {
    /// The signals that are recorded, with what was last recorded of each.
    recorded: Vec<(SignalId, Option<Value>)>,
    /// Those of them that some monitor judges at every step, with their latest values; none before the start.
    watched: Vec<SignalId>,
    values: Vec<Value>,
    watches: Vec<SampleWatch<'p>>,
    grid: Nanos,
    /// The period in which the signals were last sampled by the clock.
    sampled: Nanos,
    /// How the world was when the watched signals, and when all recorded ones, were last read.
    seen: Option<u64>,
    written: Option<u64>,
    /// Write each instant at which a watched signal has changed.
    everything: bool,
}

/// What one monitor that reacts to samples would see.
struct SampleWatch<'p> {
    /// Where its signals stand among the watched ones.
    places: Vec<Option<usize>>,
    /// The conditions on which it may move, with their values when it last looked.
    guards: Vec<(Cow<'p, Expr>, Option<Value>)>,
    /// For each of its signals, whether it had no finite number then.
    without_number: Vec<bool>,
    margin: Option<&'p Expr>,
    /// The least of the margins so far.
    worst: f64,
    /// The instant at which it was met, and all watched values then, as long as it is not written.
    unwritten: Option<(Nanos, Vec<Value>)>,
}

impl<'p> SignalRecorder<'p> {
    pub fn new(program: &'p Program) -> Self {
        let numbered = program.signals.iter().zip(0u16..);
        let recorded = numbered.filter(|(s, _)| s.recorded).map(|(_, i)| (SignalId(i), None)).collect();
        let judging: Vec<&Monitor> = program.monitors.iter().filter(|m| judges_samples(m)).collect();
        let mut watched: Vec<SignalId> = judging.iter().flat_map(|m| m.signals.iter().copied()).collect();
        watched.sort_unstable();
        watched.dedup();
        Self {
            recorded,
            watches: judging.iter().map(|m| SampleWatch::new(m, &watched)).collect(),
            watched,
            values: Vec::new(),
            grid: program.world.as_ref().map_or(Nanos::MAX, |world| world.sample.max(1)),
            sampled: 0,
            seen: None,
            written: None,
            everything: false,
        }
    }

    pub fn write_everything(&mut self) {
        self.everything = true;
    }

    /// Time has come to this: what has to be written of it is.
    pub fn pass(&mut self, to: Nanos, world: &mut dyn WorldBackend, trace: &mut Trace) {
        // The physics steps from when the world was last stirred: not on the sampling period's grid.
        if to / self.grid > self.sampled {
            self.sampled = to / self.grid;
            self.sample(to, world, trace);
        } else if self.look(to, world) {
            self.settle(to, trace);
            for (signal, value) in self.watched.iter().zip(&self.values) {
                note(&mut self.recorded, *signal, *value, to, trace);
            }
        }
    }

    /// Writes all signals that have changed.
    pub fn sample(&mut self, now: Nanos, world: &mut dyn WorldBackend, trace: &mut Trace) {
        self.look(now, world);
        self.settle(now, trace);
        let state = world.changes();
        if state.is_some() && state == self.written {
            return;
        }
        self.written = state;
        for at in 0..self.recorded.len() {
            let signal = self.recorded[at].0;
            let value = match self.watched.binary_search(&signal) {
                Ok(at) => self.values[at],
                Err(_) => on_grid(world.read(signal)),
            };
            note(&mut self.recorded, signal, value, now, trace);
        }
    }

    /// Writes what is kept in mind of instants before this one: something is about to be written.
    pub fn settle(&mut self, now: Nanos, trace: &mut Trace) {
        let mut kept: Vec<(Nanos, Vec<Value>)> = self
            .watches
            .iter_mut()
            .filter_map(|watch| watch.unwritten.take_if(|(at, _)| *at < now))
            .collect();
        kept.sort_by_key(|(at, _)| *at);
        kept.dedup_by_key(|(at, _)| *at);
        for (at, values) in kept {
            for (signal, value) in self.watched.iter().zip(values) {
                note(&mut self.recorded, *signal, value, at, trace);
            }
        }
    }

    /// Reads the watched signals; says whether this instant has to be written at once.
    fn look(&mut self, now: Nanos, world: &mut dyn WorldBackend) -> bool {
        let state = world.changes();
        if self.watches.is_empty() || (state.is_some() && state == self.seen) {
            return false;
        }
        self.seen = state;
        let is_first = self.values.is_empty();
        self.values.resize(self.watched.len(), Value::Bool(false));
        let mut changed = is_first;
        for (signal, known) in self.watched.iter().zip(&mut self.values) {
            let value = on_grid(world.read(*signal));
            changed |= value.key() != known.key();
            *known = value;
        }
        // All of them look, whatever the first finds.
        let values = &self.values;
        let found = self.watches.iter_mut().fold(false, |found, watch| watch.look(now, values) | found);
        changed && (found || self.everything)
    }
}

impl<'p> SampleWatch<'p> {
    fn new(monitor: &'p Monitor, watched: &[SignalId]) -> Self {
        let mut guards: Vec<(Cow<'p, Expr>, Option<Value>)> = Vec::new();
        let edges = monitor.edges.iter().filter(|edge| edge.on == MonitorTrigger::Sample);
        let conditions = monitor.conditions.iter().chain(edges.filter_map(|edge| edge.guard.as_ref()));
        // Windows begin and end at any moment: of a formula each new value counts, and not its sign alone.
        let atoms = monitor.formula.iter().flat_map(|formula| &formula.atoms);
        let readings = atoms.filter_map(|atom| atom.what.reading());
        for guard in conditions.map(Cow::Borrowed).chain(readings.map(Cow::Owned)) {
            if guards.iter().all(|(known, _)| *known != guard) {
                guards.push((guard, None));
            }
        }
        let margin = monitor.margin.as_ref().filter(|margin| margin.at.is_empty());
        Self {
            places: monitor.signals.iter().map(|s| watched.binary_search(s).ok()).collect(),
            without_number: vec![false; monitor.signals.len()],
            guards,
            margin: margin.map(|margin| &margin.value),
            worst: f64::INFINITY,
            unwritten: None,
        }
    }

    /// Whether a truth has changed, or whether some signal has a number: a truth that rests on none is another one for a monitor.
    fn look(&mut self, now: Nanos, values: &[Value]) -> bool {
        let places = &self.places;
        let value = |expr: &Expr| {
            let read = |i: u16| places.get(usize::from(i)).copied().flatten().and_then(|at| values.get(at));
            expr.eval(&|i| read(i).copied()).ok()
        };
        let mut found = false;
        for (guard, known) in &mut self.guards {
            let truth = value(guard);
            found |= *known != truth;
            *known = truth;
        }
        for (place, known) in places.iter().zip(&mut self.without_number) {
            let read = place.and_then(|at| values.get(at));
            let without = matches!(read, Some(Value::Float(number)) if !number.is_finite());
            found |= *known != without;
            *known = without;
        }
        let measured = self.margin.and_then(value).and_then(Value::as_f64);
        if let Some(margin) = measured.filter(|m| m.is_finite() && *m < self.worst) {
            self.worst = margin;
            self.unwritten = Some((now, values.to_vec()));
        }
        found
    }
}

/// Whether a monitor reacts to samples, or takes its margin at each.
fn judges_samples(monitor: &Monitor) -> bool {
    monitor.formula.is_some()
        || !monitor.conditions.is_empty()
        || monitor.edges.iter().any(|edge| edge.on == MonitorTrigger::Sample)
        || monitor.margin.as_ref().is_some_and(|margin| margin.at.is_empty())
}

/// Writes a sample, if it says something new.
fn note(
    recorded: &mut [(SignalId, Option<Value>)],
    signal: SignalId,
    value: Value,
    time: Nanos,
    trace: &mut Trace,
) {
    let Ok(at) = recorded.binary_search_by_key(&signal, |(id, _)| *id) else { return };
    let last = &mut recorded[at].1;
    if last.is_none_or(|last| last.key() != value.key()) {
        *last = Some(value);
        trace.steps.push(TraceStep { time, what: TraceStepKind::Sample { signal, value } });
    }
}

/// Recorded floats lie on a grid of 10⁻⁶ of their SI unit: below what the physics is good for.
fn on_grid(value: Value) -> Value {
    match value {
        // Adding zero makes a negative zero positive.
        Value::Float(x) if x.abs() < 1e9 => Value::Float((x * 1e6).round() / 1e6 + 0.0),
        Value::Float(_)
        | Value::Bool(_)
        | Value::Int(_)
        | Value::Symbol(_)
        | Value::Text(_)
        | Value::List(_) => value,
    }
}
