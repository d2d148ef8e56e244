//! Doing a stimulus: its samples are drawn, then its steps run in order, holding for the time they say.

use std::collections::VecDeque;

use hrdsl_ir::{
    EventId, Nanos, Program, Type, Value, event::StimulusStep, expr::Expr, value::nanos, world::WorldAction,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::{
    message::PlayerMessage,
    player::{HarnessError, PlayerContext},
};

/// A stimulus under way.
pub struct StimulusPerformance {
    steps: VecDeque<StimulusPrimitive>,
    vars: Vec<Value>,
    /// It holds until then.
    pub until: Nanos,
}

enum StimulusPrimitive {
    Emit(EventId, Vec<Value>),
    Hold(Nanos),
    Act(WorldAction),
}

/// Draws the second tier's values of a stimulus, in order, uniformly from their ranges.
///
/// # Errors
/// A range that has no value for these arguments.
pub fn draw_samples(
    program: &Program,
    event: EventId,
    args: &[Value],
    rng: &mut ChaCha8Rng,
) -> Result<Vec<Value>, HarnessError> {
    let Some(stimulus) = &program.event(event).stimulus else { return Ok(Vec::new()) };
    let mut vars = args.to_vec();
    for sample in &stimulus.samples {
        let (lo, hi) = (eval(program, event, &sample.lo, &vars)?, eval(program, event, &sample.hi, &vars)?);
        vars.push(draw(sample.ty, lo, hi, rng));
    }
    Ok(vars.split_off(args.len()))
}

fn draw(ty: Type, lo: Value, hi: Value, rng: &mut ChaCha8Rng) -> Value {
    match (ty, lo, hi) {
        (Type::Int { .. }, Value::Int(lo), Value::Int(hi)) if lo < hi => {
            Value::Int(rng.random_range(lo..=hi))
        }
        // A range of symbols goes by the order of their declaration.
        (Type::Enum(e), Value::Symbol(lo), Value::Symbol(hi)) => match (e.index_of(lo), e.index_of(hi)) {
            (Some(first), Some(last)) if first < last => {
                Value::Symbol(e.values()[rng.random_range(first..=last)])
            }
            (Some(_) | None, _) => Value::Symbol(lo),
        },
        (
            Type::Float(_) | Type::Int { .. } | Type::Bool | Type::Enum(_) | Type::Text | Type::List(_),
            lo,
            hi,
        ) => {
            match (lo.as_f64(), hi.as_f64()) {
                // Micrometres, microradians: what a generated test's text says is exactly what runs.
                (Some(lo), Some(hi)) if lo < hi => {
                    Value::Float(on_grid(rng.random_range(lo..hi)).clamp(lo, hi))
                }
                (Some(_) | None, _) => lo,
            }
        }
    }
}

fn on_grid(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}

fn eval(program: &Program, event: EventId, expr: &Expr, vars: &[Value]) -> Result<Value, HarnessError> {
    expr.eval(&|i| vars.get(i as usize).copied())
        .map_err(|e| HarnessError::Model(format!("stimulus `{}`: {e}", program.event(event).name)))
}

/// A step with its expressions evaluated.
fn primitive(
    program: &Program,
    event: EventId,
    step: &StimulusStep,
    vars: &[Value],
) -> Result<Option<StimulusPrimitive>, HarnessError> {
    Ok(match step {
        StimulusStep::Emit { event: emitted, args } => {
            let args = args.iter().map(|a| eval(program, event, a, vars)).collect::<Result<_, _>>()?;
            Some(StimulusPrimitive::Emit(*emitted, args))
        }
        StimulusStep::Hold { seconds } => {
            let time = eval(program, event, seconds, vars)?.as_f64().unwrap_or(0.0);
            Some(StimulusPrimitive::Hold(nanos(time.max(0.0))))
        }
        StimulusStep::Act(action) => Some(StimulusPrimitive::Act(action.clone())),
        // INVARIANT: a branch has been taken.
        StimulusStep::If { .. } => None,
    })
}

impl StimulusPerformance {
    /// Begins a stimulus: it is recorded as an event, then its first steps run.
    ///
    /// # Errors
    /// An expression of the stimulus without a value.
    pub fn begin(
        program: &Program,
        event: EventId,
        args: &[Value],
        samples: &[Value],
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<Self, HarnessError> {
        cx.out.push(PlayerMessage::Event { event, args: args.to_vec() });
        let mut this = Self { steps: VecDeque::new(), vars: [args, samples].concat(), until: cx.now };
        if let Some(stimulus) = &program.event(event).stimulus {
            let holds = |c: &Expr| Ok(eval(program, event, c, &this.vars)?.as_bool() == Some(true));
            for step in stimulus.taken(&holds)? {
                this.steps.extend(primitive(program, event, step, &this.vars)?);
            }
        }
        this.go_on(cx);
        Ok(this)
    }

    /// Runs steps until one holds beyond now. `is_done` tells whether any are left.
    pub fn go_on(&mut self, cx: &mut PlayerContext<'_, '_>) {
        while self.until <= cx.now {
            match self.steps.pop_front() {
                None => return,
                Some(StimulusPrimitive::Emit(event, args)) => {
                    cx.out.push(PlayerMessage::Event { event, args })
                }
                Some(StimulusPrimitive::Hold(time)) => self.until = cx.now + time,
                Some(StimulusPrimitive::Act(action)) => {
                    cx.out.push(PlayerMessage::Act { action, vars: self.vars.clone() });
                }
            }
        }
    }

    /// No step is left and nothing holds.
    #[must_use]
    pub fn is_done(&self, now: Nanos) -> bool {
        self.steps.is_empty() && self.until <= now
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use hrdsl_ir::{Enumeration, Symbol};
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn symbols_are_drawn_between_their_bounds() {
        let pace = Type::Enum(Enumeration::intern("Pace", &["still", "slow", "fast", "run"]));
        let symbol = |name: &str| Value::Symbol(Symbol::intern(name));
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut drawn = |lo: &str, hi: &str| -> BTreeSet<String> {
            (0..99).map(|_| draw(pace, symbol(lo), symbol(hi), &mut rng).to_string()).collect()
        };
        assert_eq!(drawn("slow", "run").into_iter().collect::<Vec<_>>(), ["fast", "run", "slow"]);
        assert_eq!(drawn("slow", "slow").len(), 1);
    }
}
