//! The world on stage: the sampling of signals into the trace, and the rules by which the world makes events.

use hrdsl_ir::{
    EventId, EventPattern, Nanos, Program, Value,
    device::{Device, DeviceKind},
    device_state::DeviceState,
    expr::Expr,
    world::{DeviceId, RuleTrigger, SignalId, WorldAction, WorldRule},
};
use hrdsl_trace::{Trace, picture::WorldPicture};

use crate::{
    command::{CommandRequest, NotBegun},
    edge::EdgeWatch,
    message::PlayerMessage,
    picture::PictureRecorder,
    recorder::SignalRecorder,
    world::{CommandId, MotionPlanRequest, PlannedTrajectory, WorldAccuracy, WorldBackend},
};

/// The world of one run.
pub struct WorldStage<'p> {
    world: Box<dyn WorldBackend + 'p>,
    /// What it has, as it was declared.
    declared: Option<&'p hrdsl_ir::world::World>,
    rules: &'p [WorldRule],
    /// Of those rules that wait for conditions, in their order.
    edges: Vec<EdgeWatch<'p>>,
    recorder: SignalRecorder<'p>,
    /// What people will look at; `None`: nobody will.
    picture: Option<PictureRecorder>,
    /// Commands that ended and that their maker has not yet been told of.
    ended: Vec<(CommandId, Result<(), String>)>,
    /// Events set off by commands and by conditions.
    answers: Vec<PlayerMessage>,
}

impl<'p> WorldStage<'p> {
    /// The world of a program on stage, with the rules and signals that the program says; without a `world` block it has no
    /// rules, and signals are recorded at events only.
    #[must_use]
    pub fn new(program: &'p Program, mut world: Box<dyn WorldBackend + 'p>) -> Self {
        let rules = program.world.as_ref().map_or(&[][..], |world| &world.rules);
        Self {
            edges: rules.iter().filter_map(|rule| EdgeWatch::new(rule, world.as_mut())).collect(),
            world,
            declared: program.world.as_ref(),
            rules,
            recorder: SignalRecorder::new(program),
            picture: None,
            ended: Vec::new(),
            answers: Vec::new(),
        }
    }

    /// The same, with every instant recorded at which a signal that is judged at each step has changed: for those who want to
    /// compare.
    #[must_use]
    pub fn recording_everything(mut self) -> Self {
        self.recorder.write_everything();
        self
    }

    /// The same, with a picture of the world, which changes nothing else.
    #[must_use]
    pub fn picturing(mut self) -> Self {
        self.picture = Some(PictureRecorder::default());
        self
    }

    /// The picture so far; empty if none was taken.
    pub fn take_picture(&mut self) -> WorldPicture {
        self.picture.take().map(PictureRecorder::finish).unwrap_or_default()
    }

    /// When it next changes by itself; `None`: at rest.
    #[must_use]
    pub fn next_wake(&self) -> Option<Nanos> {
        self.edges.iter().filter_map(EdgeWatch::next_wake).chain(self.world.next_wake()).min()
    }

    /// Time passes.
    pub fn advance(&mut self, to: Nanos, trace: &mut Trace) {
        self.world.advance(to);
        self.ended.extend(self.world.take_ended());
        self.recorder.pass(to, self.world.as_mut(), trace);
        if let Some(picture) = &mut self.picture {
            picture.look(to, self.world.as_ref());
        }
        for edge in &mut self.edges {
            if edge.look(to, self.world.as_mut()) {
                self.answers.extend(answer(edge.rule, self.world.as_mut()));
            }
        }
    }

    /// Why the world cannot go on.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        self.world.fault()
    }

    /// How far it strayed from what cannot be.
    #[must_use]
    pub fn accuracy(&self) -> Option<WorldAccuracy> {
        self.world.accuracy()
    }

    /// Records the signals that have changed.
    pub fn sample(&mut self, now: Nanos, trace: &mut Trace) {
        self.recorder.sample(now, self.world.as_mut(), trace);
    }

    /// Records what is still to be said of instants before this one.
    pub fn settle(&mut self, now: Nanos, trace: &mut Trace) {
        self.recorder.settle(now, trace);
    }

    /// What the system can read of a signal.
    #[must_use]
    pub fn reading(&mut self, signal: SignalId) -> Value {
        self.world.reading(signal)
    }

    /// An environment actor's action.
    ///
    /// # Errors
    /// Why the world cannot do it.
    pub fn act(&mut self, action: &WorldAction, vars: &[Value]) -> Result<(), String> {
        self.world.act(action, vars)
    }

    /// The system's command; sets off the rules that wait for it.
    ///
    /// # Errors
    /// Why it cannot begin.
    pub fn command(&mut self, request: &CommandRequest) -> Result<CommandId, NotBegun> {
        let checked = request.checked(self.declared)?;
        let id = self.world.command(&checked).map_err(NotBegun::Failed)?;
        let told = RuleTrigger::Commanded { device: checked.device_id, command: checked.command_id };
        let answers = self.fire(&|on| *on == told);
        self.answers.extend(answers);
        Ok(id)
    }

    /// What a device tells of itself, as numbers in SI units.
    ///
    /// # Errors
    /// That there is no such device, or that it cannot tell this.
    pub fn state(&self, device: &str, what: &str) -> Result<Vec<f64>, NotBegun> {
        let found = self.device(device)?;
        let kind = self.declared.map(|world| world.kind_of(found));
        let told =
            kind.and_then(|kind| kind.state(what)).and_then(|state| self.world.state(found.body, state));
        told.ok_or_else(|| NotBegun::Refused {
            error: format!("`{device}` has no state `{what}`"),
            help: kind.map(DeviceKind::tells),
        })
    }

    /// The same, of a device of the program by its number; `None`: it cannot tell this.
    #[must_use]
    pub fn told(&self, device: DeviceId, what: DeviceState) -> Option<Vec<f64>> {
        let device = self.declared?.devices.get(usize::from(device.0))?;
        self.world.state(device.body, what)
    }

    /// Whether something is read otherwise than it is.
    #[must_use]
    pub fn has_sensors(&self) -> bool {
        self.declared.is_some_and(|world| !world.sensors.is_empty())
    }

    /// When that was so which a device tells; `None`: it is so now.
    #[must_use]
    pub fn sampled_at(&self, device: DeviceId) -> Option<Nanos> {
        let device = self.declared?.devices.get(usize::from(device.0))?;
        self.world.sampled_at(device.body)
    }

    /// A free way of an arm.
    ///
    /// # Errors
    /// That there is no such arm, or no such way.
    pub fn plan(&self, device: &str, wanted: &MotionPlanRequest) -> Result<PlannedTrajectory, NotBegun> {
        let found = self.device(device)?;
        self.world.plan(found.body, wanted).map_err(NotBegun::Failed)
    }

    fn device(&self, name: &str) -> Result<&'p Device, NotBegun> {
        let devices = self.declared.map_or(&[][..], |world| &world.devices);
        devices.iter().find(|d| d.name == name).ok_or_else(|| {
            let names: Vec<&str> = devices.iter().map(|d| d.name.as_str()).collect();
            let help = (!names.is_empty()).then(|| format!("its devices: {}", names.join(", ")));
            NotBegun::Refused { error: format!("the world has no device `{name}`"), help }
        })
    }

    #[must_use]
    pub fn has_ended_commands(&self) -> bool {
        !self.ended.is_empty()
    }

    /// How a command ended, if it has; told once.
    pub fn take_ended(&mut self, id: CommandId) -> Option<Result<(), String>> {
        let at = self.ended.iter().position(|(ended, _)| *ended == id)?;
        Some(self.ended.remove(at).1)
    }

    /// What the world answers to an event.
    pub fn hear(&mut self, event: EventId, args: &[Value]) -> Vec<PlayerMessage> {
        self.fire(&|on| match on {
            RuleTrigger::Event(pattern) => EventPattern::matches(pattern, event, args),
            RuleTrigger::Commanded { .. } | RuleTrigger::Edge { .. } => false,
        })
    }

    /// What the world answered to commands since this was last asked.
    pub fn take_answers(&mut self) -> Vec<PlayerMessage> {
        std::mem::take(&mut self.answers)
    }

    fn fire(&mut self, is_set_off: &dyn Fn(&RuleTrigger) -> bool) -> Vec<PlayerMessage> {
        let set_off = self.rules.iter().filter(|rule| is_set_off(&rule.on));
        let world = self.world.as_mut();
        set_off.filter_map(|rule| answer(rule, world)).collect()
    }
}

/// What a rule that is set off makes happen, if its guard holds.
fn answer(rule: &WorldRule, world: &mut dyn WorldBackend) -> Option<PlayerMessage> {
    let values: Vec<Value> = rule.signals.iter().map(|s| world.read(*s)).collect();
    let eval = |e: &Expr| e.eval(&|i| values.get(i as usize).copied()).ok();
    let holds = rule.guard.as_ref().is_none_or(|g| eval(g) == Some(Value::Bool(true)));
    let args: Option<Vec<Value>> = rule.args.iter().map(eval).collect();
    args.filter(|_| holds).map(|args| PlayerMessage::Event { event: rule.event, args })
}
