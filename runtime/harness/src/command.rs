//! Commands to devices: what the system asked for, compared with what is declared, so that every world begins the same and refuses
//! in the same words.

use std::collections::BTreeMap;

use hrdsl_ir::{
    Value,
    device::{CommandParam, Device, DeviceCommand, DeviceKind, NumberCount, PrimitiveCall},
    world::{DeviceCommandId, DeviceId, World},
};

use crate::argument::SystemArgument;

/// What the system asks a device to do, as it said it.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandRequest {
    /// `robot.arm`
    pub device: String,
    /// `move_to`
    pub command: String,
    pub args: BTreeMap<String, SystemArgument>,
}

/// A command that its device knows, with arguments that fit.
#[derive(Clone, Debug)]
pub struct CheckedCommand<'p> {
    pub device: &'p Device,
    pub device_id: DeviceId,
    pub command: &'p DeviceCommand,
    pub command_id: DeviceCommandId,
    /// What is to be done.
    pub call: PrimitiveCall,
}

/// Why a command was not begun.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotBegun {
    /// It makes no sense: no such device or command, or other arguments than it takes.
    Refused {
        error: String,
        /// What to write instead.
        help: Option<String>,
    },
    /// It makes sense, and cannot be done as things are.
    Failed(String),
}

impl CommandRequest {
    /// What it means in a world with these devices.
    ///
    /// # Errors
    /// What makes no sense about it.
    pub fn checked<'p>(&self, world: Option<&'p World>) -> Result<CheckedCommand<'p>, NotBegun> {
        let Some((world, device_id)) = world.and_then(|w| Some((w, w.device_named(&self.device)?))) else {
            return Err(self.no_device(world));
        };
        let device = world.device(device_id);
        let kind = world.kind_of(device);
        let Some(command_id) = kind.command(&self.command) else {
            let error =
                format!("`{}` is {}, and cannot `{}`", self.device, kind.with_article(), self.command);
            return Err(refused(error, Some(can(kind))));
        };
        let command = world.command(device_id, command_id);
        let call = command.call(&self.arguments(command, kind)?);
        let call = call.ok_or_else(|| NotBegun::Failed(format!("`{}` cannot be done", self.command)))?;
        Ok(CheckedCommand { device, device_id, command, command_id, call })
    }

    fn no_device(&self, world: Option<&World>) -> NotBegun {
        let devices = world.map_or(&[][..], |world| &world.devices);
        let names: Vec<&str> = devices.iter().map(|d| d.name.as_str()).collect();
        let help = (!names.is_empty()).then(|| format!("devices it can command: {}", names.join(", ")));
        refused(format!("the world has no device `{}`", self.device), help)
    }

    /// The numbers of each argument, by its name.
    fn arguments<'c>(
        &self,
        command: &'c DeviceCommand,
        kind: &DeviceKind,
    ) -> Result<BTreeMap<&'c str, Vec<f64>>, NotBegun> {
        let name = &command.name;
        if let Some(extra) = self.args.keys().find(|given| command.params.iter().all(|p| p.name != **given)) {
            let known: Vec<&str> = command.params.iter().map(|p| p.name.as_str()).collect();
            let help = (!known.is_empty()).then(|| format!("arguments it can use: {}", known.join(", ")));
            return Err(refused(format!("`{name}` has no argument `{extra}`"), help));
        }
        let mut arguments = BTreeMap::new();
        for param in &command.params {
            match self.args.get(&param.name) {
                Some(given) => {
                    arguments.insert(param.name.as_str(), numbers(name, param, given)?);
                }
                None if param.optional => {}
                None => {
                    let error = format!("`{name}` needs `{}`: {}", param.name, param.ty);
                    return Err(refused(error, Some(can(kind))));
                }
            }
        }
        Ok(arguments)
    }
}

/// `an arm can move_to(to, speed?), move_joints(to, speed?)`
fn can(kind: &DeviceKind) -> String {
    let commands: Vec<String> = kind.commands.iter().map(ToString::to_string).collect();
    format!("{} can {}", kind.with_article(), commands.join(", "))
}

fn numbers(command: &str, param: &CommandParam, given: &SystemArgument) -> Result<Vec<f64>, NotBegun> {
    let fits = match (given, param.ty.count) {
        (SystemArgument::Numbers(numbers), NumberCount::List) => Some(numbers.clone()),
        (SystemArgument::Numbers(numbers), NumberCount::Array(n)) => {
            (numbers.len() == usize::from(n)).then(|| numbers.clone())
        }
        (SystemArgument::Scalar(value @ (Value::Int(_) | Value::Float(_))), NumberCount::One) => {
            value.as_f64().map(|x| vec![x])
        }
        (
            SystemArgument::Scalar(_) | SystemArgument::Text(_) | SystemArgument::Numbers(_),
            NumberCount::One | NumberCount::Array(_) | NumberCount::List,
        ) => None,
    };
    fits.ok_or_else(|| {
        let error = format!("`{command}`: `{}` is {given}, but must be {}", param.name, param.ty);
        refused(error, None)
    })
}

fn refused(error: String, help: Option<String>) -> NotBegun {
    NotBegun::Refused { error, help }
}
