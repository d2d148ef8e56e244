//! `gazebo`: of all its extensions, whether a link touches its robot, and laser scanners.

use super::{
    model::{UrdfLinkId, UrdfOrigin, UrdfRangeSensor, UrdfRobot, UrdfScan},
    names::NumberOf,
};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace, say},
    xml::{XmlElement, number_in, numbers_in},
};

/// The kinds of sensors that measure ranges, by what is below them in the element.
const RANGE_SENSORS: [(&str, &str); 4] =
    [("ray", "ray"), ("gpu_ray", "ray"), ("lidar", "lidar"), ("gpu_lidar", "lidar")];

/// Adds what `<gazebo reference="LINK">` says of links. Nothing in it is an error: it is written for another program.
pub(crate) fn read_gazebo(
    root: &XmlElement,
    robot: &mut UrdfRobot,
    links: &NumberOf,
    faults: &mut Vec<RobotFault>,
) {
    for element in root.all("gazebo") {
        let Some(reference) = element.attribute("reference") else { continue };
        // It may name a joint, too.
        let Some((at, _)) = links.get(&reference.value) else { continue };
        for name in ["selfCollide", "self_collide"] {
            let said = element.child(name).map(|said| said.text().trim().to_ascii_lowercase());
            if let (Some(said), Some(link)) = (said, robot.links.get_mut(*at)) {
                link.self_collide = Some(matches!(said.as_str(), "1" | "true"));
            }
        }
        for sensor in element.all("sensor") {
            match range_sensor(sensor, UrdfLinkId(*at)) {
                Ok(read) => robot.range_sensors.extend(read),
                Err(fault) => say(faults, RobotFault { severity: hrdsl_source::Severity::Warning, ..fault }),
            }
        }
    }
}

/// The sensor, if it measures ranges.
fn range_sensor(sensor: &XmlElement, link: UrdfLinkId) -> Result<Option<UrdfRangeSensor>, RobotFault> {
    let word = sensor.attribute("type").map(|word| word.value.as_str()).unwrap_or_default();
    let Some((_, inside)) = RANGE_SENSORS.iter().find(|(kind, _)| *kind == word) else { return Ok(None) };
    let ray = sensor.child(inside).or_else(|| sensor.child("ray")).or_else(|| sensor.child("lidar"));
    let ray = ray.ok_or_else(|| missing(sensor, "ray"))?;
    let scan = ray.child("scan").ok_or_else(|| missing(ray, "scan"))?;
    let range = ray.child("range").ok_or_else(|| missing(ray, "range"))?;
    let horizontal = scan.child("horizontal").ok_or_else(|| missing(scan, "horizontal"))?;
    let vertical = scan.child("vertical").map(beams).transpose()?;
    let origin = match sensor.child("pose") {
        Some(pose) => {
            let [x, y, z, roll, pitch, yaw] = numbers_in::<6>(&pose.text(), pose.place)?;
            UrdfOrigin { xyz: [x, y, z], rpy: [roll, pitch, yaw] }
        }
        None => UrdfOrigin::default(),
    };
    let name = sensor.attribute("name");
    let place = name.map_or(sensor.place, |name| sensor.place_of(name));
    let read = UrdfRangeSensor {
        name: name.map(|name| name.value.clone()).unwrap_or_default(),
        link,
        origin,
        horizontal: beams(horizontal)?,
        vertical: vertical.filter(|scan| scan.samples > 1),
        range_min: number_below(range, "min")?,
        range_max: number_below(range, "max")?,
        update_rate: sensor
            .child("update_rate")
            .map(|rate| number_in(&rate.text(), rate.place))
            .transpose()?,
        place,
    };
    sensible(&read, range.place)?;
    Ok(Some(read))
}

fn sensible(sensor: &UrdfRangeSensor, range: RobotPlace) -> Result<(), RobotFault> {
    if sensor.range_min < 0.0 || sensor.range_max <= sensor.range_min {
        let kind =
            RobotFaultKind::BadSize { what: "the farthest range", value: sensor.range_max.to_string() };
        return Err(kind.at(range, "write `<min>` of 0 and more, and `<max>` above it"));
    }
    Ok(())
}

fn beams(scan: &XmlElement) -> Result<UrdfScan, RobotFault> {
    let samples = number_below(scan, "samples")?;
    let (min_angle, max_angle) = (number_below(scan, "min_angle")?, number_below(scan, "max_angle")?);
    if !(1.0..=1e6).contains(&samples) {
        let kind = RobotFaultKind::BadSize { what: "the number of samples", value: samples.to_string() };
        return Err(kind.at(scan.place, "write a whole number from 1 to 1000000"));
    }
    if min_angle > max_angle {
        return Err(RobotFaultKind::EmptyLimits { lower: min_angle, upper: max_angle }
            .at(scan.place, "exchange the two"));
    }
    // A whole number in the range above.
    Ok(UrdfScan { samples: samples as u32, min_angle, max_angle })
}

fn number_below(element: &XmlElement, name: &'static str) -> Result<f64, RobotFault> {
    let child = element.child(name).ok_or_else(|| missing(element, name))?;
    number_in(&child.text(), child.place)
}

fn missing(element: &XmlElement, child: &'static str) -> RobotFault {
    let kind = RobotFaultKind::MissingElement { element: element.name.clone(), child };
    kind.at(element.place, format!("write `<{child}>…</{child}>` in it; without it, there is no such sensor"))
}
