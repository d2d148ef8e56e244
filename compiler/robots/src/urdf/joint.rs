//! `joint`: its kind, axis, limits, and what it follows; links and joints still by name.

use hrdsl_source::nearest;

use super::{
    link::read_origin,
    model::{UrdfDynamics, UrdfJointKind, UrdfLimits, UrdfOrigin, UrdfSafety},
    names::PlacedName,
};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace, say},
    space::transform::{RobotVector, dot},
    xml::{XmlAttribute, XmlElement},
};

/// A joint as it is written: what it joins is known by name.
pub(crate) struct DescribedJoint {
    pub name: String,
    pub place: RobotPlace,
    pub kind: UrdfJointKind,
    pub parent: PlacedName,
    pub child: PlacedName,
    pub origin: UrdfOrigin,
    pub axis: RobotVector,
    pub limits: Option<UrdfLimits>,
    pub dynamics: UrdfDynamics,
    pub mimic: Option<DescribedMimic>,
    pub safety: Option<UrdfSafety>,
}

pub(crate) struct DescribedMimic {
    pub joint: PlacedName,
    pub multiplier: f64,
    pub offset: f64,
}

/// Reads a joint; `None` if there is too little of it to be one.
pub(crate) fn read_joint(element: &XmlElement, faults: &mut Vec<RobotFault>) -> Option<DescribedJoint> {
    let mut reader = JointReader { faults };
    let read = reader.joint(element);
    reader.kept(read)
}

struct JointReader<'a> {
    faults: &'a mut Vec<RobotFault>,
}

impl JointReader<'_> {
    fn kept<T>(&mut self, read: Result<T, RobotFault>) -> Option<T> {
        read.map_err(|fault| say(self.faults, fault)).ok()
    }

    fn joint(&mut self, element: &XmlElement) -> Result<DescribedJoint, RobotFault> {
        let name = element.needs_name("name")?;
        let kind = joint_kind(element)?;
        let end = |which: &'static str| -> Result<PlacedName, RobotFault> {
            let child = element.needs_child(which)?;
            Ok(PlacedName::of(child, child.needs_name("link")?))
        };
        let (parent, child) = (end("parent")?, end("child")?);
        let read = read_origin(element);
        let origin = self.kept(read).unwrap_or_default();
        let read = read_axis(element, kind, &name.value);
        let axis = self.kept(read).unwrap_or([1.0, 0.0, 0.0]);
        let limits = self.limits(element, kind, name);
        let read = read_dynamics(element);
        let dynamics = self.kept(read).unwrap_or_default();
        let read = read_mimic(element);
        let mimic = self.kept(read).flatten();
        let read = read_safety(element);
        let safety = self.kept(read).flatten();
        let place = element.place_of(name);
        let name = name.value.clone();
        Ok(DescribedJoint { name, place, kind, parent, child, origin, axis, limits, dynamics, mimic, safety })
    }

    fn limits(
        &mut self,
        element: &XmlElement,
        kind: UrdfJointKind,
        name: &XmlAttribute,
    ) -> Option<UrdfLimits> {
        let Some(limit) = element.child("limit") else {
            let missing = RobotFaultKind::MissingLimits(name.value.clone());
            let place = element.place_of(name);
            if kind.has_range() {
                let help = "write `<limit lower=\"…\" upper=\"…\" effort=\"…\" velocity=\"…\"/>`, or `type=\"continuous\"`";
                say(self.faults, missing.at(place, help));
            } else if kind.has_one_value() {
                let help = "write `<limit effort=\"…\" velocity=\"…\"/>`: without it nothing says what its motor can do";
                say(self.faults, missing.warned(place, help));
            }
            return None;
        };
        let read = read_limits(limit);
        let limits = self.kept(read)?;
        if kind.has_range() && limits.lower > limits.upper {
            let fault = RobotFaultKind::EmptyLimits { lower: limits.lower, upper: limits.upper };
            let place = limit.attribute("lower").map_or(limit.place, |at| limit.place_of(at));
            say(self.faults, fault.at(place, "exchange the two"));
        }
        if kind.has_one_value() {
            self.bounds(limit, &limits, name);
        }
        Some(limits)
    }

    /// What a motor can do must be said, and be something.
    fn bounds(&mut self, limit: &XmlElement, limits: &UrdfLimits, name: &XmlAttribute) {
        let units = "in N m or N, and rad/s or m/s";
        for (what, bound) in [("effort", limits.effort), ("velocity", limits.velocity)] {
            match bound {
                None => {
                    let fault = RobotFaultKind::NoBound { joint: name.value.clone(), what };
                    say(self.faults, fault.at(limit.place, format!("write `{what}=\"…\"`, {units}")));
                }
                Some(value) if value <= 0.0 => {
                    let what = if what == "effort" { "the effort" } else { "the velocity" };
                    let fault = RobotFaultKind::BadSize { what, value: value.to_string() };
                    let at = if what == "the effort" { "effort" } else { "velocity" };
                    let place = limit.attribute(at).map_or(limit.place, |at| limit.place_of(at));
                    let help = format!(
                        "write more than 0, {units}; as it is, the joint cannot be moved by its motor"
                    );
                    let fault = if value < 0.0 { fault.at(place, help) } else { fault.warned(place, help) };
                    say(self.faults, fault);
                }
                Some(_) => {}
            }
        }
    }
}

fn joint_kind(element: &XmlElement) -> Result<UrdfJointKind, RobotFault> {
    let word = element.needs("type")?;
    UrdfJointKind::ALL.into_iter().find(|kind| kind.word() == word.value).ok_or_else(|| {
        let near = nearest(&word.value, UrdfJointKind::ALL.map(UrdfJointKind::word));
        let all = UrdfJointKind::ALL.map(UrdfJointKind::word).join(", ");
        let help = near.map_or(format!("write one of {all}"), |near| format!("write `{near}`"));
        let kind = RobotFaultKind::UnknownWord { what: "kind of a joint", word: word.value.clone() };
        kind.at(element.place_of(word), help)
    })
}

/// The axis with length 1; along x where none is written.
fn read_axis(element: &XmlElement, kind: UrdfJointKind, joint: &str) -> Result<RobotVector, RobotFault> {
    const ALONG_X: RobotVector = [1.0, 0.0, 0.0];
    let Some(axis) = element.child("axis") else { return Ok(ALONG_X) };
    let written = axis.numbers::<3>("xyz")?.unwrap_or(ALONG_X);
    let length = libm::sqrt(dot(written, written));
    match kind {
        UrdfJointKind::Fixed | UrdfJointKind::Floating => Ok(ALONG_X),
        _ if length > 1e-9 => Ok(written.map(|part| part / length)),
        UrdfJointKind::Revolute
        | UrdfJointKind::Continuous
        | UrdfJointKind::Prismatic
        | UrdfJointKind::Planar => {
            let place = axis.attribute("xyz").map_or(axis.place, |at| axis.place_of(at));
            Err(RobotFaultKind::ZeroAxis(joint.to_owned()).at(place, "write a direction: `xyz=\"0 0 1\"`"))
        }
    }
}

fn read_limits(limit: &XmlElement) -> Result<UrdfLimits, RobotFault> {
    Ok(UrdfLimits {
        lower: limit.number("lower")?.unwrap_or_default(),
        upper: limit.number("upper")?.unwrap_or_default(),
        effort: limit.number("effort")?,
        velocity: limit.number("velocity")?,
        place: limit.place,
    })
}

fn read_dynamics(element: &XmlElement) -> Result<UrdfDynamics, RobotFault> {
    let Some(dynamics) = element.child("dynamics") else { return Ok(UrdfDynamics::default()) };
    let not_negative = |name: &'static str, what: &'static str| -> Result<f64, RobotFault> {
        let value = dynamics.number(name)?.unwrap_or_default();
        if value < 0.0 {
            let place = dynamics.attribute(name).map_or(dynamics.place, |at| dynamics.place_of(at));
            let kind = RobotFaultKind::BadSize { what, value: value.to_string() };
            return Err(kind.at(place, "write 0 or more"));
        }
        Ok(value)
    };
    let damping = not_negative("damping", "the damping")?;
    Ok(UrdfDynamics { damping, friction: not_negative("friction", "the friction")? })
}

fn read_mimic(element: &XmlElement) -> Result<Option<DescribedMimic>, RobotFault> {
    let Some(mimic) = element.child("mimic") else { return Ok(None) };
    Ok(Some(DescribedMimic {
        joint: PlacedName::of(mimic, mimic.needs_name("joint")?),
        multiplier: mimic.number("multiplier")?.unwrap_or(1.0),
        offset: mimic.number("offset")?.unwrap_or_default(),
    }))
}

fn read_safety(element: &XmlElement) -> Result<Option<UrdfSafety>, RobotFault> {
    let Some(safety) = element.child("safety_controller") else { return Ok(None) };
    Ok(Some(UrdfSafety {
        soft_lower_limit: safety.number("soft_lower_limit")?.unwrap_or_default(),
        soft_upper_limit: safety.number("soft_upper_limit")?.unwrap_or_default(),
        k_position: safety.number("k_position")?.unwrap_or_default(),
        k_velocity: safety.number("k_velocity")?.unwrap_or_default(),
    }))
}
