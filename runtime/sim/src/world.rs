//! The simulated world as the harness's world: what orders to devices mean, and when they have succeeded.

use std::collections::BTreeMap;

use hrdsl_harness::{Begun, DeviceOrder, OrderError, OrderId, SystemArgument, World};
use hrdsl_ir::{
    Nanos, Program, Value,
    world::{GripperId, RuleOn, SignalId, WorldAction},
};

use crate::{Command, Sim, SimError};

/// A [`Sim`] behind the seam.
pub struct SimWorld {
    sim: Sim,
    /// Of orders under way: what the gripper's sensor must say for them to have succeeded.
    confirms: BTreeMap<OrderId, Confirm>,
}

/// What a gripper's sensor must say.
#[derive(Clone, Copy)]
struct Confirm {
    gripper: GripperId,
    holds: bool,
}

impl SimWorld {
    /// The program's world at its start; `None` if the scenario has none.
    ///
    /// # Errors
    /// Why the world cannot be built.
    pub fn new(program: &Program) -> Result<Option<Self>, SimError> {
        let Some(world) = &program.world else { return Ok(None) };
        let sim = Sim::new(world, &program.signals)?;
        Ok(Some(Self { sim, confirms: BTreeMap::new() }))
    }

    /// What a device is told to do.
    fn command(&self, order: &DeviceOrder) -> Result<Command, OrderError> {
        let DeviceOrder { device, verb, args } = order;
        let numbers = |name: &str| match args.get(name) {
            Some(SystemArgument::Numbers(v)) => Ok(v.clone()),
            Some(SystemArgument::Scalar(_) | SystemArgument::Text(_)) | None => {
                Err(refused(format!("`{verb}` needs `{name}`, a list of numbers"), None))
            }
        };
        let max_speed = match args.get("speed") {
            Some(SystemArgument::Scalar(v)) => v.as_f64(),
            Some(SystemArgument::Numbers(_) | SystemArgument::Text(_)) | None => None,
        };
        match (self.sim.arm_named(device), self.sim.gripper_named(device), verb.as_str()) {
            (Some(arm), _, "move_to") => match numbers("to")?.as_slice() {
                [x, y, z] => Ok(Command::MoveTo { arm, target: [*x, *y, *z], max_speed }),
                _ => Err(refused("`move_to` needs `to` with x, y and z in metres".into(), None)),
            },
            (Some(arm), _, "move_joints") => {
                Ok(Command::MoveJoints { arm, positions: numbers("to")?, max_speed })
            }
            (None, Some(gripper), "close") => Ok(Command::Close { gripper }),
            (None, Some(gripper), "open") => Ok(Command::Open { gripper }),
            (None, None, _) => Err(refused(format!("the world has no arm or gripper `{device}`"), None)),
            (Some(_), _, _) => {
                Err(refused(format!("`{device}` cannot `{verb}`"), Some("an arm can move_to, move_joints")))
            }
            (None, Some(_), _) => {
                Err(refused(format!("`{device}` cannot `{verb}`"), Some("a gripper can open, close")))
            }
        }
    }

    /// Whether the gripper holds something, or nothing, as it should.
    fn confirmed(&self, confirm: Confirm) -> Result<(), String> {
        match (confirm.holds, self.sim.holding(confirm.gripper).is_some()) {
            (true, false) => Err("the gripper closed on nothing".to_owned()),
            (false, true) => Err("the gripper still holds something".to_owned()),
            (true, true) | (false, false) => Ok(()),
        }
    }
}

fn refused(error: String, help: Option<&str>) -> OrderError {
    OrderError::Refused { error, help: help.map(str::to_owned) }
}

impl World for SimWorld {
    fn next_wake(&self) -> Option<Nanos> {
        self.sim.next_wake()
    }

    fn advance(&mut self, to: Nanos) {
        self.sim.advance(to);
    }

    fn read(&mut self, signal: SignalId) -> Value {
        self.sim.read(signal)
    }

    fn act(&mut self, action: &WorldAction, vars: &[Value]) -> Result<(), String> {
        self.sim.act(action, &|i| vars.get(usize::from(i)).copied()).map_err(|e| e.to_string())
    }

    fn order(&mut self, order: &DeviceOrder) -> Result<Begun, OrderError> {
        let command = self.command(order)?;
        let (sign, confirm) = match &command {
            Command::Close { gripper } => (Some(RuleOn::Closes(*gripper)), Some((*gripper, true))),
            Command::Open { gripper } => (Some(RuleOn::Opens(*gripper)), Some((*gripper, false))),
            Command::MoveTo { .. } | Command::MoveJoints { .. } => (None, None),
        };
        let id = self.sim.command(command).map_err(|e| OrderError::Failed(e.to_string()))?;
        let id = OrderId(id.0);
        self.confirms.extend(confirm.map(|(gripper, holds)| (id, Confirm { gripper, holds })));
        Ok(Begun { id, sign })
    }

    fn take_ended(&mut self) -> Vec<(OrderId, Result<(), String>)> {
        let ended = self.sim.finished();
        let ended = ended.into_iter().map(|(id, how)| {
            let id = OrderId(id.0);
            let confirm = self.confirms.remove(&id);
            let how = how.map_err(|e| e.to_string());
            (id, how.and_then(|()| confirm.map_or(Ok(()), |c| self.confirmed(c))))
        });
        ended.collect()
    }
}
