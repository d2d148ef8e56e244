//! An SRDF's elements to data, checked against the robot that it is of.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::{Severity, nearest};

use super::model::{
    SrdfChain, SrdfDisabledPair, SrdfEndEffector, SrdfGroup, SrdfPassiveJoint, SrdfSemantics, SrdfState,
    SrdfVirtualJoint, SrdfVirtualKind,
};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace, say},
    urdf::model::{UrdfJointId, UrdfRobot},
    xml::{XmlAttribute, XmlElement, numbers_in},
};

/// Reads an SRDF; what is wrong in one element leaves that out.
pub(crate) fn read_semantics(
    root: &XmlElement,
    robot: &UrdfRobot,
    faults: &mut Vec<RobotFault>,
) -> Option<SrdfSemantics> {
    if root.name != "robot" {
        let kind = RobotFaultKind::WrongRoot { found: root.name.clone(), wanted: "SRDF" };
        say(faults, kind.at(root.place, "name a file that begins with `<robot name=\"…\">`"));
        return None;
    }
    let name = root.attribute("name").map(|name| name.value.clone()).unwrap_or_default();
    let groups =
        root.all("group").filter_map(|group| Some(group.attribute("name")?.value.as_str())).collect();
    let links = robot.links.iter().map(|link| link.name.as_str()).collect();
    let joints = robot.joints.iter().map(|joint| joint.name.as_str());
    let virtual_joints =
        root.all("virtual_joint").filter_map(|joint| Some(joint.attribute("name")?.value.as_str()));
    let joints = joints.chain(virtual_joints).collect();
    let mut reader = SemanticsReader { robot, links, joints, groups, faults };
    let mut read = SrdfSemantics { robot: name, ..SrdfSemantics::default() };
    for element in root.elements() {
        let kept = match element.name.as_str() {
            "group" => reader.group(element).map(|group| read.groups.push(group)),
            "group_state" => reader.state(element).map(|state| read.states.push(state)),
            "end_effector" => reader.end_effector(element).map(|hand| read.end_effectors.push(hand)),
            "virtual_joint" => reader.virtual_joint(element).map(|joint| read.virtual_joints.push(joint)),
            "passive_joint" => reader.passive_joint(element).map(|joint| read.passive_joints.push(joint)),
            "disable_collisions" => reader.disabled(element).map(|pair| read.disabled_collisions.push(pair)),
            _ => Ok(()),
        };
        if let Err(fault) = kept {
            // Pairs of links that are not there are left over from another version of the robot.
            let severity =
                if element.name == "disable_collisions" { Severity::Warning } else { fault.severity };
            say(reader.faults, RobotFault { severity, ..fault });
        }
    }
    doubled(read.groups.iter().map(|group| (group.name.as_str(), group.place)), reader.faults);
    Some(read)
}

fn doubled<'a>(groups: impl Iterator<Item = (&'a str, RobotPlace)>, faults: &mut Vec<RobotFault>) {
    let mut first: BTreeMap<&str, RobotPlace> = BTreeMap::new();
    for (name, place) in groups {
        match first.get(name) {
            Some(first) => {
                let kind = RobotFaultKind::DuplicateName { what: "group", name: name.to_owned() };
                say(faults, kind.at(place, "give one of them another name").clashes(first.span));
            }
            None => drop(first.insert(name, place)),
        }
    }
}

struct SemanticsReader<'a> {
    robot: &'a UrdfRobot,
    links: BTreeSet<&'a str>,
    joints: BTreeSet<&'a str>,
    groups: BTreeSet<&'a str>,
    faults: &'a mut Vec<RobotFault>,
}

impl SemanticsReader<'_> {
    /// A name that must be one of those.
    fn known(
        element: &XmlElement,
        attribute: &XmlAttribute,
        what: &'static str,
        known: &BTreeSet<&str>,
    ) -> Result<String, RobotFault> {
        let name = &attribute.value;
        if known.contains(name.as_str()) {
            return Ok(name.clone());
        }
        let help = match nearest(name, known.iter().copied()) {
            Some(near) => format!("write `{near}`"),
            None => format!("name a {what} of the robot"),
        };
        let kind = RobotFaultKind::UnknownName { what, name: name.clone() };
        Err(kind.at(element.place_of(attribute), help))
    }

    fn link(&self, element: &XmlElement, attribute: &'static str) -> Result<String, RobotFault> {
        Self::known(element, element.needs(attribute)?, "link", &self.links)
    }

    fn named_group(&self, element: &XmlElement, attribute: &'static str) -> Result<String, RobotFault> {
        Self::known(element, element.needs(attribute)?, "group", &self.groups)
    }

    fn named_joint(&self, element: &XmlElement) -> Result<String, RobotFault> {
        Self::known(element, element.needs("name")?, "joint", &self.joints)
    }

    fn group(&mut self, element: &XmlElement) -> Result<SrdfGroup, RobotFault> {
        let name = element.needs_name("name")?;
        let mut group = SrdfGroup {
            name: name.value.clone(),
            joints: Vec::new(),
            links: Vec::new(),
            chains: Vec::new(),
            groups: Vec::new(),
            place: element.place_of(name),
        };
        for part in element.elements() {
            let kept = match part.name.as_str() {
                "joint" => self.named_joint(part).map(|joint| group.joints.push(joint)),
                "link" => self.link(part, "name").map(|link| group.links.push(link)),
                "chain" => self.chain(part).map(|chain| group.chains.push(chain)),
                "group" => self.named_group(part, "name").map(|inner| group.groups.push(inner)),
                _ => Ok(()),
            };
            if let Err(fault) = kept {
                say(self.faults, fault);
            }
        }
        Ok(group)
    }

    fn chain(&self, element: &XmlElement) -> Result<SrdfChain, RobotFault> {
        let (base, tip) = (self.link(element, "base_link")?, self.link(element, "tip_link")?);
        let ids = self.robot.link_named(&base).zip(self.robot.link_named(&tip));
        if ids.and_then(|(base, tip)| self.robot.chain(base, tip)).is_none() {
            let place = element.attribute("tip_link").map_or(element.place, |at| element.place_of(at));
            let kind = RobotFaultKind::NoChain { base, tip };
            return Err(kind.at(place, "exchange the two, or name a link that hangs on the first"));
        }
        Ok(SrdfChain { base, tip })
    }

    fn state(&mut self, element: &XmlElement) -> Result<SrdfState, RobotFault> {
        let name = element.needs_name("name")?;
        let group = self.named_group(element, "group")?;
        let mut values = Vec::new();
        for joint in element.all("joint") {
            // Where a free root is, or what another version of the robot has: the other values hold without it.
            let name = self.named_joint(joint).map_err(|fault| {
                let is_unknown = matches!(fault.kind, RobotFaultKind::UnknownName { .. });
                if is_unknown { RobotFault { severity: Severity::Warning, ..fault } } else { fault }
            });
            let read = name.and_then(|name| {
                let value = joint.needs("value")?;
                let place = joint.place_of(value);
                let numbers = value.value.split_whitespace().map(|word| numbers_in::<1>(word, place));
                let numbers =
                    numbers.map(|one| one.map(|[number]| number)).collect::<Result<Vec<f64>, _>>()?;
                if numbers.is_empty() {
                    return Err(RobotFaultKind::BadNumber(String::new()).at(place, "write radians or metres"));
                }
                Ok((name, numbers))
            });
            match read {
                Ok((joint_name, numbers)) => {
                    self.within_limits(joint, &joint_name, &numbers);
                    values.push((joint_name, numbers));
                }
                Err(fault) => say(self.faults, fault),
            }
        }
        Ok(SrdfState { name: name.value.clone(), group, values, place: element.place_of(name) })
    }

    fn within_limits(&mut self, element: &XmlElement, name: &str, values: &[f64]) {
        let id = self.robot.joint_named(name);
        let joint =
            id.and_then(|UrdfJointId(at)| self.robot.joints.get(at)).filter(|joint| joint.kind.has_range());
        let (Some(limits), [value]) = (joint.and_then(|joint| joint.limits), values) else { return };
        // Values are often written with fewer digits than the limits.
        const ROUNDING: f64 = 1e-3;
        if *value < limits.lower - ROUNDING || *value > limits.upper + ROUNDING {
            let place = element.attribute("value").map_or(element.place, |at| element.place_of(at));
            let kind = RobotFaultKind::BadSize { what: "the joint's value", value: value.to_string() };
            let help = format!("write one from {} to {}: the limits of `{name}`", limits.lower, limits.upper);
            say(self.faults, kind.warned(place, help));
        }
    }

    fn end_effector(&self, element: &XmlElement) -> Result<SrdfEndEffector, RobotFault> {
        let name = element.needs_name("name")?;
        // An empty one is none.
        let parent_group = element.attribute("parent_group").filter(|parent| !parent.value.is_empty());
        Ok(SrdfEndEffector {
            name: name.value.clone(),
            group: self.named_group(element, "group")?,
            parent_link: self.link(element, "parent_link")?,
            parent_group: parent_group
                .map(|parent| Self::known(element, parent, "group", &self.groups))
                .transpose()?,
            place: element.place_of(name),
        })
    }

    fn virtual_joint(&self, element: &XmlElement) -> Result<SrdfVirtualJoint, RobotFault> {
        let name = element.needs_name("name")?;
        let word = element.needs("type")?;
        let kind = match word.value.as_str() {
            "fixed" => SrdfVirtualKind::Fixed,
            "floating" => SrdfVirtualKind::Floating,
            "planar" => SrdfVirtualKind::Planar,
            other => {
                let kind =
                    RobotFaultKind::UnknownWord { what: "kind of a virtual joint", word: other.to_owned() };
                return Err(kind.at(element.place_of(word), "write one of fixed, floating, planar"));
            }
        };
        Ok(SrdfVirtualJoint {
            name: name.value.clone(),
            kind,
            parent_frame: element.needs("parent_frame")?.value.clone(),
            child_link: self.link(element, "child_link")?,
            place: element.place_of(name),
        })
    }

    fn passive_joint(&self, element: &XmlElement) -> Result<SrdfPassiveJoint, RobotFault> {
        let name = self.named_joint(element)?;
        Ok(SrdfPassiveJoint { name, place: element.place })
    }

    fn disabled(&self, element: &XmlElement) -> Result<SrdfDisabledPair, RobotFault> {
        Ok(SrdfDisabledPair {
            link1: self.link(element, "link1")?,
            link2: self.link(element, "link2")?,
            reason: element.attribute("reason").map(|reason| reason.value.clone()),
            place: element.place,
        })
    }
}
