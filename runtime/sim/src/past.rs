//! What signals were, as far back as some measurement asks: a value for each physics step.

use std::collections::VecDeque;

use hrdsl_ir::{
    Nanos,
    world::{Signal, SignalId, SignalTerm},
};

/// The signals whose past is asked for.
pub(crate) struct SignalPast {
    kept: Vec<KeptSignal>,
}

struct KeptSignal {
    signal: SignalId,
    /// How far back it is asked for.
    longest: Nanos,
    /// Its values at the physics steps, the oldest first: one that is older than asked for, if there is one.
    values: VecDeque<(Nanos, f64)>,
}

impl SignalPast {
    pub fn new(signals: &[Signal]) -> Self {
        let mut kept: Vec<KeptSignal> = Vec::new();
        for term in signals.iter().flat_map(|s| &s.terms) {
            let SignalTerm::Delta(signal, over) = *term else { continue };
            match kept.iter_mut().find(|k| k.signal == signal) {
                Some(known) => known.longest = known.longest.max(over),
                None => kept.push(KeptSignal { signal, longest: over, values: VecDeque::new() }),
            }
        }
        Self { kept }
    }

    /// How far back anything is asked for.
    pub fn longest(&self) -> Nanos {
        self.kept.iter().map(|k| k.longest).max().unwrap_or(0)
    }

    pub fn signals(&self) -> impl Iterator<Item = SignalId> + '_ {
        self.kept.iter().map(|k| k.signal)
    }

    /// The values of [`Self::signals`] at this time.
    pub fn note(&mut self, now: Nanos, values: &[f64]) {
        for (kept, value) in self.kept.iter_mut().zip(values) {
            kept.values.push_back((now, *value));
            while kept.values.get(1).is_some_and(|(time, _)| *time <= now - kept.longest) {
                kept.values.pop_front();
            }
        }
    }

    /// The world rests: what is now has been so for as long as anybody asks.
    pub fn rest(&mut self) {
        for kept in &mut self.kept {
            let last = kept.values.pop_back();
            kept.values.clear();
            kept.values.extend(last);
        }
    }

    /// What a signal was at a time; before the first value that is known, that.
    pub fn at(&self, signal: SignalId, time: Nanos) -> Option<f64> {
        let values = &self.kept.iter().find(|k| k.signal == signal)?.values;
        let after = values.partition_point(|(at, _)| *at <= time);
        values.get(after.saturating_sub(1)).map(|(_, value)| *value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hrdsl_ir::{Expr, Span, Type, Unit};

    #[test]
    fn the_past_is_kept_as_far_back_as_is_asked() {
        let asks = |over| Signal {
            name: "d".into(),
            ty: Type::Float(Unit::Metre),
            to: Vec::new(),
            terms: vec![SignalTerm::Delta(SignalId(3), over)],
            value: Expr::Var(0),
            recorded: true,
            origin: Span::default(),
        };
        let mut past = SignalPast::new(&[asks(20), asks(50)]);
        assert_eq!((past.longest(), past.signals().collect::<Vec<_>>()), (50, vec![SignalId(3)]));
        for step in 0..20 {
            past.note(step * 10, &[step as f64]);
        }
        let at = |past: &SignalPast, time| past.at(SignalId(3), time);
        assert_eq!([at(&past, 190), at(&past, 179), at(&past, 140)], [Some(19.0), Some(17.0), Some(14.0)]);
        assert_eq!(at(&past, 0), Some(14.0), "older ones are forgotten");
        assert_eq!(past.at(SignalId(0), 190), None);
        past.rest();
        assert_eq!(at(&past, 140), Some(19.0));
    }
}
