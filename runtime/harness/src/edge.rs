//! Rules that wait for a condition to become true, or to cease to be: how the world's truths were, and what changes them.

use hrdsl_ir::{
    Nanos, Value,
    world::{RuleTrigger, WorldRule},
};

use crate::world::WorldBackend;

/// What is known of the condition of one rule.
pub(crate) struct EdgeWatch<'p> {
    pub rule: &'p WorldRule,
    condition: &'p hrdsl_ir::Expr,
    rising: bool,
    /// For how long the condition must have held to count as true.
    held: Nanos,
    /// Since when it has held without a break; none if it does not.
    since: Option<Nanos>,
    /// Whether it counts as true.
    truth: bool,
    /// What the rule's signals are at the instant that is looked at.
    values: Vec<Value>,
    /// [`WorldBackend::changes`] when it last was.
    seen: Option<u64>,
}

impl<'p> EdgeWatch<'p> {
    /// The watch of a rule that waits for a condition, at time 0: what is true then is so from the start, and no edge.
    pub fn new(rule: &'p WorldRule, world: &mut dyn WorldBackend) -> Option<Self> {
        let RuleTrigger::Edge { rising, condition, held } = &rule.on else { return None };
        let mut watch = Self {
            rule,
            condition,
            rising: *rising,
            held: *held,
            since: None,
            truth: false,
            values: Vec::new(),
            seen: None,
        };
        watch.look(0, world);
        Some(watch)
    }

    /// When it changes though nothing moves: when the condition will have held for long enough.
    pub fn next_wake(&self) -> Option<Nanos> {
        self.since.filter(|_| !self.truth).map(|since| since.saturating_add(self.held))
    }

    /// Whether this instant has the edge that the rule waits for. A condition without a value is as it was.
    pub fn look(&mut self, now: Nanos, world: &mut dyn WorldBackend) -> bool {
        let state = world.changes();
        if state.is_none() || state != self.seen {
            self.seen = state;
            self.evaluate(now, world);
        }
        let truth = self.since.is_some_and(|since| now - since >= self.held);
        let is_edge = truth != self.truth && truth == self.rising;
        self.truth = truth;
        is_edge
    }

    fn evaluate(&mut self, now: Nanos, world: &mut dyn WorldBackend) {
        self.values.clear();
        self.values.extend(self.rule.signals.iter().map(|s| world.read(*s)));
        match self.condition.eval(&|i| self.values.get(usize::from(i)).copied()) {
            Ok(Value::Bool(true)) => _ = self.since.get_or_insert(now),
            Ok(_) => self.since = None,
            Err(_) => {}
        }
    }
}
