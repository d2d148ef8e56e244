//! The world on stage: physics, the sampling of signals into the trace, and the rules by which the world makes events.

use hrdsl_ir::{
    EventId, Nanos, Program, Value,
    event::EventPattern,
    expr::Expr,
    world::{GripperId, Rule, RuleOn, SignalId, WorldAction},
};
use hrdsl_sim::{Command, CommandError, CommandId, Sim};
use hrdsl_trace::{Step, Trace, What};

use super::Message;

/// The physical world of one run.
pub struct Stage {
    sim: Sim,
    rules: Vec<Rule>,
    /// The signals that are recorded, with what was last recorded of each.
    recorded: Vec<(SignalId, Option<Value>)>,
    sample: Nanos,
    /// The period in which the signals were last sampled by the clock.
    sampled: Nanos,
    /// Commands that ended and that their maker has not yet been told of.
    finished: Vec<(CommandId, Result<(), CommandError>)>,
    /// Events set off by commands.
    answers: Vec<Message>,
}

impl Stage {
    /// The program's world at its start; `None` if the scenario has none.
    ///
    /// # Errors
    /// Why the world cannot be built.
    pub fn new(program: &Program) -> Result<Option<Self>, String> {
        let Some(world) = &program.world else { return Ok(None) };
        let sim = Sim::new(world, &program.signals).map_err(|e| e.to_string())?;
        let numbered = program.signals.iter().zip(0u16..);
        let recorded = numbered.filter(|(s, _)| s.recorded).map(|(_, i)| (SignalId(i), None)).collect();
        Ok(Some(Self {
            sim,
            rules: world.rules.clone(),
            recorded,
            sample: world.sample.max(1),
            sampled: 0,
            finished: Vec::new(),
            answers: Vec::new(),
        }))
    }

    /// When it next changes by itself; `None`: at rest.
    #[must_use]
    pub fn next_wake(&self) -> Option<Nanos> {
        self.sim.next_wake()
    }

    /// Time passes.
    pub fn advance(&mut self, to: Nanos, trace: &mut Trace) {
        self.sim.advance(to);
        self.finished.extend(self.sim.finished());
        // The physics steps from when the world was last stirred: not on the sampling period's grid.
        if to / self.sample > self.sampled {
            self.sampled = to / self.sample;
            self.sample(to, trace);
        }
    }

    /// Records the signals that have changed.
    pub fn sample(&mut self, now: Nanos, trace: &mut Trace) {
        for (signal, last) in &mut self.recorded {
            let value = on_grid(self.sim.read(*signal));
            if last.is_none_or(|last| last.key() != value.key()) {
                *last = Some(value);
                trace.steps.push(Step { time: now, what: What::Sample { signal: *signal, value } });
            }
        }
    }

    #[must_use]
    pub fn read(&mut self, signal: SignalId) -> Value {
        self.sim.read(signal)
    }

    /// The simulated world, for looking up components by name.
    #[must_use]
    pub fn sim(&self) -> &Sim {
        &self.sim
    }

    /// An environment actor's action.
    ///
    /// # Errors
    /// Why the world cannot do it.
    pub fn act(&mut self, action: &WorldAction, vars: &[Value]) -> Result<(), String> {
        self.sim.act(action, &|i| vars.get(i as usize).copied()).map_err(|e| e.to_string())
    }

    /// The system's command; sets off the rules on closing and opening grippers.
    ///
    /// # Errors
    /// Why it cannot begin.
    pub fn command(&mut self, command: Command) -> Result<CommandId, CommandError> {
        let on = match &command {
            Command::Close { gripper } => Some((*gripper, true)),
            Command::Open { gripper } => Some((*gripper, false)),
            Command::MoveTo { .. } | Command::MoveJoints { .. } => None,
        };
        let id = self.sim.command(command)?;
        if let Some((gripper, closes)) = on {
            let answers = self.fire(&|on| sets_off(on, gripper, closes));
            self.answers.extend(answers);
        }
        Ok(id)
    }

    #[must_use]
    pub fn has_finished_commands(&self) -> bool {
        !self.finished.is_empty()
    }

    /// How a command ended, if it has; told once.
    pub fn take_finished(&mut self, id: CommandId) -> Option<Result<(), CommandError>> {
        let at = self.finished.iter().position(|(done, _)| *done == id)?;
        Some(self.finished.remove(at).1)
    }

    /// What the world answers to an event.
    pub fn hear(&mut self, event: EventId, args: &[Value]) -> Vec<Message> {
        self.fire(&|on| match on {
            RuleOn::Event(pattern) => EventPattern::matches(pattern, event, args),
            RuleOn::Closes(_) | RuleOn::Opens(_) => false,
        })
    }

    /// What the world answered to commands since this was last asked.
    pub fn take_answers(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.answers)
    }

    fn fire(&mut self, is_set_off: &dyn Fn(&RuleOn) -> bool) -> Vec<Message> {
        let mut out = Vec::new();
        for rule in &self.rules {
            if !is_set_off(&rule.on) {
                continue;
            }
            let values: Vec<Value> = rule.signals.iter().map(|s| self.sim.read(*s)).collect();
            let eval = |e: &Expr| e.eval(&|i| values.get(i as usize).copied()).ok();
            let holds = rule.guard.as_ref().is_none_or(|g| eval(g) == Some(Value::Bool(true)));
            let args: Option<Vec<Value>> = rule.args.iter().map(eval).collect();
            if let (true, Some(args)) = (holds, args) {
                out.push(Message::Event { event: rule.event, args });
            }
        }
        out
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

fn sets_off(on: &RuleOn, gripper: GripperId, closes: bool) -> bool {
    match on {
        RuleOn::Closes(g) => closes && *g == gripper,
        RuleOn::Opens(g) => !closes && *g == gripper,
        RuleOn::Event(_) => false,
    }
}
