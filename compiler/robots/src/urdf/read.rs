//! A `robot` element to a robot: its parts read, their names resolved.

use std::collections::BTreeMap;

use super::{
    check::tree_of,
    gazebo::read_gazebo,
    joint::{DescribedJoint, read_joint},
    link::LinkReader,
    model::{UrdfJoint, UrdfJointId, UrdfLink, UrdfLinkId, UrdfMimic, UrdfRobot},
    names::{NumberOf, number_of, numbered},
    physical::check_bodies,
    transmission::read_transmission,
};
use crate::{
    fault::{RobotFault, RobotFaultKind, say},
    files::{package::PackageTable, reader::RobotReader},
    limits::MOST_LINKS,
    xml::XmlElement,
};

/// Reads a description; no robot if its links are no tree.
pub(crate) fn read_urdf(
    root: &XmlElement,
    file: &str,
    packages: &PackageTable,
    reader: &dyn RobotReader,
    faults: &mut Vec<RobotFault>,
) -> Option<UrdfRobot> {
    if root.name != "robot" {
        let kind = RobotFaultKind::WrongRoot { found: root.name.clone(), wanted: "description of a robot" };
        say(faults, kind.at(root.place, "name a file that begins with `<robot name=\"…\">`"));
        return None;
    }
    let before = faults.len();
    let links = read_links(root, file, packages, reader, faults);
    let link_numbers = numbered(links.iter().map(|link| (link.name.as_str(), link.place)), "link", faults);
    let written: Vec<DescribedJoint> =
        root.all("joint").filter_map(|element| read_joint(element, faults)).collect();
    let joint_numbers =
        numbered(written.iter().map(|joint| (joint.name.as_str(), joint.place)), "joint", faults);
    if links.is_empty() {
        say(faults, RobotFaultKind::NoLinks.at(root.place, "write `<link name=\"base_link\"/>` in it"));
    }
    let joints = joined(written, &link_numbers, &joint_numbers, faults);
    if links.is_empty() || faults.iter().skip(before).any(RobotFault::is_error) {
        return None;
    }
    let (base, order) = tree_of(&links, &joints, faults)?;
    let name = root.attribute("name").map(|name| name.value.clone()).unwrap_or_default();
    let mut robot = UrdfRobot {
        name,
        links,
        joints,
        root: base,
        order,
        transmissions: Vec::new(),
        range_sensors: Vec::new(),
        place: root.place,
    };
    robot.transmissions = root
        .all("transmission")
        .filter_map(|element| read_transmission(element, &joint_numbers, faults))
        .collect();
    read_gazebo(root, &mut robot, &link_numbers, faults);
    check_bodies(&robot, faults);
    Some(robot)
}

fn read_links(
    root: &XmlElement,
    file: &str,
    packages: &PackageTable,
    reader: &dyn RobotReader,
    faults: &mut Vec<RobotFault>,
) -> Vec<UrdfLink> {
    let mut of =
        LinkReader { file, packages, reader, colors: BTreeMap::new(), faults: std::mem::take(faults) };
    for material in root.all("material") {
        of.material(material);
    }
    let mut links = Vec::new();
    for element in root.all("link") {
        if links.len() == MOST_LINKS {
            let kind = RobotFaultKind::TooMuch { what: "links of a robot", limit: MOST_LINKS };
            say(&mut of.faults, kind.at(element.place, "describe a smaller robot"));
            break;
        }
        links.extend(of.link(element));
    }
    *faults = of.faults;
    links
}

fn joined(
    written: Vec<DescribedJoint>,
    links: &NumberOf,
    joints: &NumberOf,
    faults: &mut Vec<RobotFault>,
) -> Vec<UrdfJoint> {
    let mut all = Vec::new();
    for joint in written {
        let mut kept = |found: Result<usize, RobotFault>| found.map_err(|fault| say(faults, fault)).ok();
        let parent = kept(number_of(&joint.parent, "link", links));
        let child = kept(number_of(&joint.child, "link", links));
        let mimic = joint.mimic.and_then(|mimic| {
            let of = kept(number_of(&mimic.joint, "joint", joints))?;
            let place = mimic.joint.place;
            Some(UrdfMimic {
                joint: UrdfJointId(of),
                multiplier: mimic.multiplier,
                offset: mimic.offset,
                place,
            })
        });
        let (Some(parent), Some(child)) = (parent, child) else { continue };
        all.push(UrdfJoint {
            name: joint.name,
            kind: joint.kind,
            parent: UrdfLinkId(parent),
            child: UrdfLinkId(child),
            origin: joint.origin,
            axis: joint.axis,
            limits: joint.limits,
            dynamics: joint.dynamics,
            mimic,
            safety: joint.safety,
            place: joint.place,
        });
    }
    all
}
