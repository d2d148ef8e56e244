//! Assumptions: which stimuli a generator may still add to a test.

use std::collections::VecDeque;

use hrdsl_ir::{EventId, Nanos, Program, Value, monitor::Assumption};

/// The assumptions of a program and the latest events that count for each.
///
/// `assume at most N e within D` is violated by N + 1 such events of which the first and the last are at most D apart:
/// like a requirement's deadline, the window includes its very end. Without `within` the whole test is the window.
#[derive(Clone, Debug)]
pub struct AssumptionChecker {
    watches: Vec<AssumptionWatch>,
}

#[derive(Clone, Debug)]
struct AssumptionWatch {
    assumption: Assumption,
    /// Times of the latest events, oldest first; never more than `at_most`.
    latest: VecDeque<Nanos>,
    /// The most that ever were in one window.
    peak: u64,
}

impl AssumptionChecker {
    /// All assumptions of the program, at the start of a test.
    #[must_use]
    pub fn new(program: &Program) -> Self {
        let watch =
            |a: &Assumption| AssumptionWatch { assumption: a.clone(), latest: VecDeque::new(), peak: 0 };
        Self { watches: program.assumptions.iter().map(watch).collect() }
    }

    /// The first assumption, as an index into [`Program::assumptions`], that this event would violate, in addition to
    /// those recorded. It records nothing itself. Times must not go backwards; an earlier time counts as the latest seen.
    pub fn would_violate(&mut self, time: Nanos, event: EventId, args: &[Value]) -> Option<usize> {
        self.would_violate_beside(&[], time, event, args)
    }

    /// The same, beside other sequences of which nobody knows when they happen: any window may hold the most that each of them
    /// ever has in one.
    pub fn would_violate_beside(
        &mut self,
        others: &[&Self],
        time: Nanos,
        event: EventId,
        args: &[Value],
    ) -> Option<usize> {
        self.watches.iter_mut().enumerate().position(|(at, watch)| {
            let beside = others.iter().filter_map(|other| other.watches.get(at)).map(|w| w.peak).sum();
            watch.counts(event, args) && watch.is_full(time, beside)
        })
    }

    /// Takes note of an event that happens.
    pub fn record(&mut self, time: Nanos, event: EventId, args: &[Value]) {
        for watch in self.watches.iter_mut().filter(|watch| watch.counts(event, args)) {
            let time = watch.latest.back().map_or(time, |last| time.max(*last));
            watch.forget(time);
            watch.latest.push_back(time);
            watch.peak = watch.peak.max(watch.latest.len() as u64);
            if watch.latest.len() as u64 > u64::from(watch.assumption.at_most) {
                watch.latest.pop_front();
            }
        }
    }

    /// Records the event unless it would violate an assumption, which is then named.
    ///
    /// # Errors
    /// The index of the first assumption violated.
    pub fn admit(&mut self, time: Nanos, event: EventId, args: &[Value]) -> Result<(), usize> {
        match self.would_violate(time, event, args) {
            Some(violated) => Err(violated),
            None => {
                self.record(time, event, args);
                Ok(())
            }
        }
    }

    /// Whether a whole sequence of events keeps all assumptions, from the start of a test.
    #[must_use]
    pub fn allows(program: &Program, events: &[(Nanos, EventId, Vec<Value>)]) -> bool {
        let mut fresh = Self::new(program);
        events.iter().all(|(time, event, args)| fresh.admit(*time, *event, args).is_ok())
    }
}

impl AssumptionWatch {
    fn counts(&self, event: EventId, args: &[Value]) -> bool {
        self.assumption.events.iter().any(|p| p.matches(event, args))
    }

    /// Whether one more event at this time would be too many, if a window holds so many others. Forgets those that no later
    /// window can hold.
    fn is_full(&mut self, time: Nanos, others: u64) -> bool {
        self.forget(time);
        self.latest.len() as u64 + others >= u64::from(self.assumption.at_most)
    }

    fn forget(&mut self, time: Nanos) {
        if let Some(within) = self.assumption.within {
            while self.latest.front().is_some_and(|first| time.saturating_sub(*first) > within) {
                self.latest.pop_front();
            }
        }
    }
}
