//! Devices: which one a path names, and what it can be told.

use hrdsl_ir::{
    device::{DeviceBody, DeviceKind, DeviceSort},
    world::{DeviceCommandId, DeviceId},
};
use hrdsl_syntax::ast::{self, NameSyntax};

use crate::check::{checker::Checker, state::template::TemplateArgument};
use crate::{
    ArmId, BaseId, GripperId, LaserId,
    noun::Noun,
    report::{devices, names},
};

impl Checker<'_> {
    fn device_kind(&self, sort: DeviceSort) -> Option<&DeviceKind> {
        self.s.device_kinds.iter().find(|kind| kind.sort == sort)
    }

    /// `on close robot.grip`
    pub(in crate::check) fn commanded(
        &mut self,
        command: &NameSyntax,
        device: &ast::PathSyntax,
        prefix: &str,
    ) -> Option<(DeviceBody, DeviceCommandId)> {
        let knows = |kind: &&DeviceKind| kind.command(&command.text).is_some();
        let knowing: Vec<DeviceSort> = self.s.device_kinds.iter().filter(knows).map(|k| k.sort).collect();
        let Some(body) = self.device_of(device, &knowing, prefix) else {
            if knowing.is_empty() && !self.source.unread_items {
                let all: Vec<DeviceKind> = self.s.device_kinds.clone();
                let all = all.iter().flat_map(|kind| &kind.commands).map(|c| c.name.as_str());
                self.report(names::unknown(Noun::Command, &command.text, command.span, all));
            }
            return None;
        };
        let place = self.s.places.commands.get(&(body.sort().name(), command.text.clone())).copied();
        let kind = self.device_kind(body.sort())?;
        if let Some(id) = kind.command(&command.text) {
            self.refer(command, place);
            return Some((body, id));
        }
        let all = kind.commands.iter().map(|c| c.name.as_str());
        let issue = devices::cannot(command, &kind.with_article(), all);
        if !self.source.unread_items {
            self.report(issue);
        }
        None
    }

    /// The device that a path names; if there is none, one of these sorts was meant.
    pub(in crate::check) fn device_of(
        &mut self,
        path: &ast::PathSyntax,
        meant: &[DeviceSort],
        prefix: &str,
    ) -> Option<DeviceBody> {
        // A parameter stands for what it is declared to be.
        if let [only] = path.names.as_slice()
            && let Some(TemplateArgument::Thing(is, _)) = self.given(&only.text)
        {
            let is = *is;
            let sort = DeviceSort::ALL.into_iter().find(|sort| noun_of(*sort) == is);
            let id = self.world_name(if sort.is_some() { is } else { Noun::Device }, &path.names, prefix)?;
            return sort.map(|sort| body(sort, id));
        }
        let full = self.full_name(&path.names, prefix)?;
        for sort in DeviceSort::ALL {
            if let Some(id) = self.world.names.get(noun_of(sort), &full) {
                self.refer_in_world(noun_of(sort), &path.names, &full);
                return Some(body(sort, id));
            }
        }
        let noun = if let [only] = meant { noun_of(*only) } else { Noun::Device };
        self.world_name(noun, &path.names, prefix);
        None
    }

    /// Its place among all devices of the world.
    pub(in crate::check) fn device_id(&self, body: DeviceBody) -> DeviceId {
        self.s.world.as_ref().map_or(DeviceId(0), |world| world.device_id(body))
    }
}

fn body(sort: DeviceSort, id: u16) -> DeviceBody {
    match sort {
        DeviceSort::Arm => DeviceBody::Arm(ArmId(id)),
        DeviceSort::Gripper => DeviceBody::Gripper(GripperId(id)),
        DeviceSort::Base => DeviceBody::Base(BaseId(id)),
        DeviceSort::Laser => DeviceBody::Laser(LaserId(id)),
    }
}

pub(in crate::check) fn noun_of(sort: DeviceSort) -> Noun {
    match sort {
        DeviceSort::Arm => Noun::Arm,
        DeviceSort::Gripper => Noun::Gripper,
        DeviceSort::Base => Noun::Base,
        DeviceSort::Laser => Noun::Laser,
    }
}
