//! What a message makes happen: the rules of a topic, a service or an action, carried out.

use std::{cell::RefCell, collections::BTreeMap};

use hrdsl_ir::{
    EventId, Expr, Program, Type, Value,
    binding::{
        CommandArgument, MessageEffect, MessageRule, MessageRules, MessageStep, TextOperand, place_text,
    },
    device::{Device, DeviceBody, DevicePrimitive, POSITIONS, TIMES},
    world::{DeviceCommandId, DeviceId, NamedPosture, World},
};
use serde_json::Value as Json;

use super::read;
use crate::{
    argument::SystemArgument,
    command::{CommandRequest, NotBegun},
    message::PlayerMessage,
    player::PlayerContext,
    stage::WorldStage,
    world::{ArmTarget, CommandId, MotionPlanRequest},
};

/// Of each rule: whether its guard held at the message before.
pub(super) struct RuleState {
    held: Vec<bool>,
}

impl RuleState {
    pub fn new(rules: &MessageRules) -> Self {
        Self { held: vec![false; rules.rules.len()] }
    }
}

/// What a message came to.
#[derive(Default)]
pub(super) struct RuleOutcome {
    /// How many rules it fitted.
    pub rules: usize,
    /// The commands that were begun.
    pub commands: Vec<CommandId>,
    /// Why some command could not be begun as things are.
    pub failed: Option<String>,
    /// Which of the conditions hold on which the answer depends.
    pub conditions: Vec<bool>,
}

/// Carries out the rules that a message fits.
///
/// # Errors
/// What makes no sense about the message.
pub(super) fn carry_out(
    program: &Program,
    rules: &MessageRules,
    message: (&Json, Option<&str>),
    state: &mut RuleState,
    cx: &mut PlayerContext<'_, '_>,
) -> Result<RuleOutcome, String> {
    let mut outcome = RuleOutcome::default();
    let heard = HeardMessage { program, rules, json: message.0, wildcard: message.1 };
    for (rule, held) in rules.rules.iter().zip(&mut state.held) {
        let holds = match &rule.guard {
            Some(guard) => heard.eval(guard)?.as_bool() == Some(true),
            None => true,
        };
        let before = std::mem::replace(held, holds);
        if holds && !(rule.rising && before) {
            outcome.rules += 1;
            heard.carry_out(rule, &mut outcome, cx)?;
        }
    }
    for condition in &rules.conditions {
        outcome.conditions.push(heard.eval(condition)?.as_bool() == Some(true));
    }
    Ok(outcome)
}

struct HeardMessage<'a> {
    program: &'a Program,
    rules: &'a MessageRules,
    json: &'a Json,
    /// What the `*` of the topic stands for.
    wildcard: Option<&'a str>,
}

impl HeardMessage<'_> {
    /// Only what the value depends on is looked up in the message: `length(data) > 2 and data[2] > 0` reads no element that is not
    /// there.
    fn eval(&self, e: &Expr) -> Result<Value, String> {
        let wrong = RefCell::new(None);
        let read = |i: u16| match read::value(self.json, self.rules.reads.get(usize::from(i))?) {
            Ok(value) => Some(value),
            Err(why) => {
                wrong.replace(Some(why));
                None
            }
        };
        let value = e.eval(&read);
        match wrong.into_inner() {
            Some(why) => Err(why),
            None => value.map_err(|e| e.to_string()),
        }
    }

    fn carry_out(
        &self,
        rule: &MessageRule,
        outcome: &mut RuleOutcome,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), String> {
        match &rule.effect {
            MessageEffect::Emit { event, args } => {
                let args = self.arguments(*event, args)?;
                cx.out.push(PlayerMessage::Event { event: *event, args });
            }
            MessageEffect::Command { device, command, args } => {
                let Some(world) = &self.program.world else { return Ok(()) };
                let begun = if let Some(posture) = self.timed_posture(world, (*device, *command), args)? {
                    let Some(stage) = cx.stage.as_deref_mut() else { return Ok(()) };
                    follow_points(world, world.device(*device), posture, stage)
                } else {
                    let Some(request) = self.request(*device, *command, args)? else { return Ok(()) };
                    let Some(stage) = cx.stage.as_deref_mut() else { return Ok(()) };
                    stage.command(&request)
                };
                match begun {
                    Ok(id) => outcome.commands.push(id),
                    // Nobody tells a publisher: it sees what the robot does.
                    Err(NotBegun::Failed(why)) => outcome.failed = Some(why),
                    Err(NotBegun::Refused { error, .. }) => return Err(error),
                }
            }
        }
        Ok(())
    }

    fn arguments(&self, event: EventId, args: &[Expr]) -> Result<Vec<Value>, String> {
        let event = self.program.event(event);
        let argument = |(e, param): (&Expr, &hrdsl_ir::Parameter)| {
            let value = match (self.eval(e)?, param.ty) {
                (Value::Int(n), Type::Float(_)) => Value::Float(n as f64),
                (value, _) => value,
            };
            let wrong =
                || format!("`{}` of `{}` cannot be {value}{}", param.name, event.name, self.origin(e));
            if param.ty.admits(value) { Ok(value) } else { Err(wrong()) }
        };
        args.iter().zip(&event.params).map(argument).collect()
    }

    /// Which fields a value was made of, for a sentence about it.
    fn origin(&self, e: &Expr) -> String {
        let mut fields = Vec::new();
        e.each_var(&mut |i| {
            if let Some(read) = self.rules.reads.get(usize::from(i)) {
                let field = format!("`{}`", place_text(&read.path));
                if !fields.contains(&field) {
                    fields.push(field);
                }
            }
        });
        if fields.is_empty() { String::new() } else { format!(" (from {})", fields.join(", ")) }
    }

    fn request(
        &self,
        device: DeviceId,
        command: DeviceCommandId,
        args: &[Option<CommandArgument>],
    ) -> Result<Option<CommandRequest>, String> {
        let Some(world) = &self.program.world else { return Ok(None) };
        let declared = world.command(device, command);
        let mut given = BTreeMap::new();
        for (param, arg) in declared.params.iter().zip(args) {
            let Some(arg) = arg else { continue };
            let numbers = match arg {
                CommandArgument::Numbers(all) => {
                    let number = |e: &Expr| self.eval(e)?.as_f64().ok_or_else(|| "not a number".to_owned());
                    all.iter().map(number).collect::<Result<Vec<f64>, String>>()?
                }
                CommandArgument::Sequence(path) => read::numbers(self.json, path)?,
                CommandArgument::Wildcard { names } => {
                    let part = self.wildcard.unwrap_or_default();
                    let Some(at) = names.iter().position(|name| name == part) else { return Ok(None) };
                    vec![at as f64]
                }
                CommandArgument::TrackPositions { names } => self.track_positions(names)?,
                CommandArgument::TrackTimes => self.track_times()?,
                CommandArgument::Posture(name) => self.posture(world, device, name)?.angles.clone(),
            };
            let argument = match (param.ty.count, numbers.as_slice()) {
                (hrdsl_ir::device::NumberCount::One, [one]) => SystemArgument::Scalar(Value::Float(*one)),
                _ => SystemArgument::Numbers(numbers),
            };
            given.insert(param.name.clone(), argument);
        }
        let device = world.device(device).name.clone();
        Ok(Some(CommandRequest { device, command: declared.name.clone(), args: given }))
    }

    /// The posture with points that a command is to bring an arm to, if it is such a command.
    fn timed_posture<'w>(
        &self,
        world: &'w World,
        (device, command): (DeviceId, DeviceCommandId),
        args: &[Option<CommandArgument>],
    ) -> Result<Option<&'w NamedPosture>, String> {
        let name = args.iter().flatten().find_map(|arg| match arg {
            CommandArgument::Posture(name) => Some(name),
            CommandArgument::Numbers(_)
            | CommandArgument::Sequence(_)
            | CommandArgument::Wildcard { .. }
            | CommandArgument::TrackPositions { .. }
            | CommandArgument::TrackTimes => None,
        });
        let Some(name) = name else { return Ok(None) };
        let posture = self.posture(world, device, name)?;
        if posture.points.is_empty()
            || world.command(device, command).primitive != DevicePrimitive::ReachJoints
        {
            return Ok(None);
        }
        if args.iter().flatten().count() > 1 {
            let name = &posture.name;
            return Err(format!(
                "the posture `{name}` has times of its own: nothing else can be asked of the motion"
            ));
        }
        Ok(Some(posture))
    }

    /// The posture that the message names.
    fn posture<'w>(
        &self,
        world: &'w World,
        device: DeviceId,
        name: &TextOperand,
    ) -> Result<&'w NamedPosture, String> {
        let device = world.device(device);
        let DeviceBody::Arm(arm) = device.body else {
            return Err(format!("`{}` has no postures", device.name));
        };
        let name = read::text(self.json, name)?;
        let known = world.arms.get(usize::from(arm.0)).map(|arm| arm.postures.as_slice()).unwrap_or_default();
        let found = known.iter().find(|posture| posture.name == name);
        found.ok_or_else(|| {
            let all: Vec<String> = known.iter().map(|posture| format!("`{}`", posture.name)).collect();
            format!("`{}` has no posture `{}`: it has {}", device.name, name, all.join(", "))
        })
    }

    fn points(&self) -> Result<&[Json], String> {
        let points = read::at(self.json, &[MessageStep::Field("points".to_owned())])?;
        points.as_array().map(Vec::as_slice).ok_or_else(|| "`points` is no sequence".to_owned())
    }

    /// In the order of the arm's joints, whatever that of the message.
    fn track_positions(&self, names: &[String]) -> Result<Vec<f64>, String> {
        let given = read::at(self.json, &[MessageStep::Field("joint_names".to_owned())])?;
        let given: Vec<&str> = given.as_array().into_iter().flatten().filter_map(Json::as_str).collect();
        let place = |name: &String| {
            let at = given.iter().position(|g| g == name);
            at.ok_or_else(|| format!("the trajectory does not say where the joint `{name}` goes"))
        };
        let places = names.iter().map(place).collect::<Result<Vec<usize>, String>>()?;
        let mut all = Vec::new();
        for point in self.points()? {
            let positions = read::numbers(point, &[MessageStep::Field("positions".to_owned())])?;
            for at in &places {
                let position = positions.get(*at).copied();
                all.push(position.ok_or("a point of the trajectory has fewer positions than joints")?);
            }
        }
        Ok(all)
    }

    fn track_times(&self) -> Result<Vec<f64>, String> {
        let time = |point: &Json| {
            let time = read::at(point, &[MessageStep::Field("time_from_start".to_owned())])?;
            let part =
                |ros1: &str, ros2: &str| time.get(ros1).or_else(|| time.get(ros2)).and_then(Json::as_f64);
            let parts = part("secs", "sec").zip(part("nsecs", "nanosec"));
            parts.map(|(s, n)| s + n / 1e9).ok_or_else(|| "`time_from_start` is no time".to_owned())
        };
        self.points()?.iter().map(time).collect()
    }
}

/// Lets an arm come to the first point of a posture as it would by itself, no earlier than at that point's time, and then go through the others,
/// each so long after the first as its time says.
fn follow_points(
    world: &World,
    device: &Device,
    posture: &NamedPosture,
    stage: &mut WorldStage<'_>,
) -> Result<CommandId, NotBegun> {
    let kind = world.kind_of(device);
    let follow = kind.command_doing(DevicePrimitive::FollowJoints);
    let Some(follow) = follow.and_then(|id| kind.commands.get(usize::from(id.0))) else {
        let (kind, name) = (kind.with_article(), &posture.name);
        return Err(NotBegun::Failed(format!("{kind} cannot go through the points of the posture `{name}`")));
    };
    let Some(first) = posture.points.first() else {
        return Err(NotBegun::Failed(format!("the posture `{}` has no points", posture.name)));
    };
    let to_first = MotionPlanRequest {
        to: ArmTarget::Posture(first.angles.clone()),
        from: None,
        speeds: None,
        accelerations: None,
    };
    let planned = stage.plan(&device.name, &to_first)?.points;
    let arrival = planned.last().map_or(0.0, |point| point.time);
    let (mut times, mut positions) = (Vec::new(), Vec::new());
    for point in planned.iter().filter(|point| point.time > 0.0) {
        times.push(point.time);
        positions.extend(&point.positions);
    }
    // Who is there early waits for the time of the first point.
    let (rest, late) = if arrival < first.time {
        (posture.points.as_slice(), 0.0)
    } else {
        (posture.points.get(1..).unwrap_or_default(), arrival - first.time)
    };
    for point in rest {
        times.push(point.time + late);
        positions.extend(&point.angles);
    }
    let args = [(POSITIONS, positions), (TIMES, times)]
        .map(|(name, numbers)| (name.to_owned(), SystemArgument::Numbers(numbers)));
    stage.command(&CommandRequest {
        device: device.name.clone(),
        command: follow.name.clone(),
        args: args.into(),
    })
}

/// What the `*` of a pattern stands for in a name; `None`: the name does not fit, or the pattern has none.
pub(super) fn wildcard(pattern: &str, name: &str) -> Option<String> {
    let (before, after) = pattern.split_once('*')?;
    let part = name.strip_prefix(before)?.strip_suffix(after)?;
    (!part.is_empty() && !part.contains('/')).then(|| part.to_owned())
}

/// Whether the rules know what to do for this part of a topic: those that ask for a joint know those of their arm.
pub(super) fn knows(rules: &MessageRules, part: &str) -> bool {
    rules.rules.iter().any(|rule| match &rule.effect {
        MessageEffect::Emit { .. } => true,
        MessageEffect::Command { args, .. } => args.iter().flatten().all(|arg| match arg {
            CommandArgument::Wildcard { names } => names.iter().any(|name| name == part),
            CommandArgument::Numbers(_)
            | CommandArgument::Sequence(_)
            | CommandArgument::TrackPositions { .. }
            | CommandArgument::TrackTimes
            | CommandArgument::Posture(_) => true,
        }),
    })
}

/// Stops the devices that rules command, those that can be stopped.
pub(super) fn stop_devices(program: &Program, rules: &MessageRules, stage: &mut WorldStage<'_>) {
    let Some(world) = &program.world else { return };
    for rule in &rules.rules {
        let MessageEffect::Command { device, .. } = &rule.effect else { continue };
        let device = world.device(*device);
        if let Some(stop) = world.kind_of(device).stop() {
            let request = CommandRequest {
                device: device.name.clone(),
                command: stop.name.clone(),
                args: BTreeMap::new(),
            };
            // It knows the command, which takes nothing: a device that cannot stop now is stopped by the next one.
            let _ = stage.command(&request);
        }
    }
}
