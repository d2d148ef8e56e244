//! `transmission`: which motor moves which joint, and by what ratio.

use hrdsl_source::Severity;

use super::{
    model::{UrdfActuator, UrdfJointId, UrdfTransmission, UrdfTransmissionJoint},
    names::{NumberOf, PlacedName, number_of},
};
use crate::{
    fault::{RobotFault, RobotFaultKind, say},
    xml::{XmlElement, number_in},
};

/// Reads a transmission; `None` if it has no name.
pub(crate) fn read_transmission(
    element: &XmlElement,
    joints: &NumberOf,
    faults: &mut Vec<RobotFault>,
) -> Option<UrdfTransmission> {
    let name = kept(element.needs_name("name").map(Some), faults)?;
    let kind = match (element.child("type"), element.attribute("type")) {
        (Some(child), _) => child.text().trim().to_owned(),
        // The older form of PR2's.
        (None, Some(attribute)) => attribute.value.clone(),
        (None, None) => String::new(),
    };
    // The older form has the ratio beside the joints.
    let common = kept(reduction(element), faults);
    let mut read = UrdfTransmission {
        name: name.value.clone(),
        kind,
        joints: Vec::new(),
        actuators: Vec::new(),
        place: element.place_of(name),
    };
    for joint in element.all("joint") {
        let Some(name) = kept(joint.needs_name("name").map(Some), faults) else { continue };
        let Some(id) = kept(number_of(&PlacedName::of(joint, name), "joint", joints).map(Some), faults)
        else {
            continue;
        };
        read.joints.push(UrdfTransmissionJoint {
            joint: UrdfJointId(id),
            hardware_interfaces: interfaces(joint),
            reduction: kept(reduction(joint), faults).or(common),
        });
    }
    for actuator in element.all("actuator") {
        let Some(name) = kept(actuator.needs_name("name").map(Some), faults) else { continue };
        read.actuators.push(UrdfActuator {
            name: name.value.clone(),
            hardware_interfaces: interfaces(actuator),
            reduction: kept(reduction(actuator), faults).or(common),
        });
    }
    Some(read)
}

/// Nothing in a transmission keeps the robot from moving: it is written for controllers.
fn kept<T>(read: Result<Option<T>, RobotFault>, faults: &mut Vec<RobotFault>) -> Option<T> {
    read.map_err(|fault| say(faults, RobotFault { severity: Severity::Warning, ..fault })).ok().flatten()
}

fn interfaces(element: &XmlElement) -> Vec<String> {
    element.all("hardwareInterface").map(|interface| interface.text().trim().to_owned()).collect()
}

/// `mechanicalReduction`, which is not 0.
fn reduction(element: &XmlElement) -> Result<Option<f64>, RobotFault> {
    let Some(written) = element.child("mechanicalReduction") else { return Ok(None) };
    let value = number_in(&written.text(), written.place)?;
    if value == 0.0 {
        let kind = RobotFaultKind::BadSize { what: "the reduction", value: "0".to_owned() };
        return Err(kind.at(written.place, "write how often the motor turns for one turn of the joint"));
    }
    Ok(Some(value))
}
