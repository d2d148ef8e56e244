//! `link`: inertial, collision and visual.

use std::collections::BTreeMap;

use hrdsl_source::Severity;

use super::model::{UrdfGeometry, UrdfInertial, UrdfLink, UrdfMesh, UrdfOrigin, UrdfShape};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace, say},
    files::{address::resolve_address, package::PackageTable, reader::RobotReader},
    space::inertia::InertiaTensor,
    xml::XmlElement,
};

/// The colours of a robot's materials, by their names.
pub(crate) type MaterialColors = BTreeMap<String, [f64; 4]>;

/// What links need to know of the description that they stand in.
pub(crate) struct LinkReader<'a> {
    /// The description's file.
    pub file: &'a str,
    pub packages: &'a PackageTable,
    pub reader: &'a dyn RobotReader,
    pub colors: MaterialColors,
    pub faults: Vec<RobotFault>,
}

/// An `origin`, or none: the same frame.
pub(crate) fn read_origin(element: &XmlElement) -> Result<UrdfOrigin, RobotFault> {
    let Some(origin) = element.child("origin") else { return Ok(UrdfOrigin::default()) };
    let [xyz, rpy] = ["xyz", "rpy"].map(|name| origin.numbers::<3>(name));
    Ok(UrdfOrigin { xyz: xyz?.unwrap_or_default(), rpy: rpy?.unwrap_or_default() })
}

impl LinkReader<'_> {
    /// The colour of a `material`, kept under its name.
    pub fn material(&mut self, element: &XmlElement) -> Option<[f64; 4]> {
        let name = element.attribute("name").map(|name| name.value.clone()).filter(|name| !name.is_empty());
        let written = element.child("color").map(|color| color.numbers::<4>("rgba"));
        match written {
            Some(Ok(Some(color))) => {
                // The first that has a colour says it for all of its name.
                name.map(|name| self.colors.entry(name).or_insert(color));
                Some(color)
            }
            Some(Err(fault)) => {
                say(&mut self.faults, RobotFault { severity: Severity::Warning, ..fault });
                None
            }
            Some(Ok(None)) | None => name.and_then(|name| self.colors.get(&name).copied()),
        }
    }

    pub fn link(&mut self, element: &XmlElement) -> Option<UrdfLink> {
        let name = match element.needs_name("name") {
            Ok(name) => name,
            Err(fault) => {
                say(&mut self.faults, fault);
                return None;
            }
        };
        let inertial = element.child("inertial").and_then(|inertial| {
            let read = self.inertial(inertial, &name.value);
            self.kept(read)
        });
        let collisions = element.all("collision").filter_map(|shape| self.kept_shape(shape)).collect();
        let before = self.faults.len();
        let visuals = element.all("visual").filter_map(|shape| self.kept_shape(shape)).collect();
        // What is only seen keeps nothing from moving.
        for fault in self.faults.iter_mut().skip(before) {
            fault.severity = Severity::Warning;
        }
        Some(UrdfLink {
            name: name.value.clone(),
            inertial,
            collisions,
            visuals,
            self_collide: None,
            place: element.place_of(name),
        })
    }

    fn kept<T>(&mut self, read: Result<T, RobotFault>) -> Option<T> {
        read.map_err(|fault| say(&mut self.faults, fault)).ok()
    }

    fn inertial(&mut self, element: &XmlElement, link: &str) -> Result<UrdfInertial, RobotFault> {
        let mass = element.needs_child("mass")?;
        let value = mass.needs_number("value")?;
        if value < 0.0 {
            let kind = RobotFaultKind::BadMass { link: link.to_owned(), mass: value };
            let place = mass.attribute("value").map_or(mass.place, |at| mass.place_of(at));
            return Err(kind.at(place, "write a mass above 0, in kilograms"));
        }
        let tensor = element.needs_child("inertia")?;
        let [ixx, iyy, izz] = ["ixx", "iyy", "izz"].map(|name| tensor.needs_number(name));
        let [ixy, ixz, iyz] = ["ixy", "ixz", "iyz"].map(|name| tensor.number(name));
        let inertia = InertiaTensor {
            ixx: ixx?,
            ixy: ixy?.unwrap_or_default(),
            ixz: ixz?.unwrap_or_default(),
            iyy: iyy?,
            iyz: iyz?.unwrap_or_default(),
            izz: izz?,
        };
        Ok(UrdfInertial { origin: read_origin(element)?, mass: value, inertia, place: tensor.place })
    }

    fn kept_shape(&mut self, element: &XmlElement) -> Option<UrdfShape> {
        let shape = self.shape(element);
        let mut shape = self.kept(shape)?;
        shape.color = element.child("material").and_then(|material| self.material(material));
        Some(shape)
    }

    fn shape(&mut self, element: &XmlElement) -> Result<UrdfShape, RobotFault> {
        let geometry = self.geometry(element.needs_child("geometry")?)?;
        Ok(UrdfShape {
            name: element.attribute("name").map(|name| name.value.clone()),
            origin: read_origin(element)?,
            geometry,
            color: None,
            place: element.place,
        })
    }

    fn geometry(&mut self, element: &XmlElement) -> Result<UrdfGeometry, RobotFault> {
        const WORDS: [&str; 5] = ["box", "cylinder", "sphere", "capsule", "mesh"];
        let Some(shape) = element.elements().find(|shape| WORDS.contains(&shape.name.as_str())) else {
            let help = "write `<box size=\"…\"/>`, `<cylinder …/>`, `<sphere …/>`, `<capsule …/>` or `<mesh …/>` in it";
            let other = element.elements().next();
            let kind = match other {
                Some(other) => RobotFaultKind::UnknownWord { what: "shape", word: other.name.clone() },
                None => RobotFaultKind::MissingElement { element: element.name.clone(), child: "box" },
            };
            return Err(kind.at(other.unwrap_or(element).place, help));
        };
        match shape.name.as_str() {
            "box" => {
                shape.needs("size")?;
                let size = shape.numbers::<3>("size")?.unwrap_or_default();
                size.iter().try_for_each(|edge| positive("an edge of the box", *edge, shape, "size"))?;
                Ok(UrdfGeometry::Box { size })
            }
            "sphere" => Ok(UrdfGeometry::Sphere { radius: measure(shape, "radius")? }),
            "cylinder" => {
                let (radius, length) = (measure(shape, "radius")?, measure(shape, "length")?);
                Ok(UrdfGeometry::Cylinder { radius, length })
            }
            "capsule" => {
                let (radius, length) = (measure(shape, "radius")?, measure(shape, "length")?);
                Ok(UrdfGeometry::Capsule { radius, length })
            }
            _ => self.mesh(shape).map(UrdfGeometry::Mesh),
        }
    }

    fn mesh(&mut self, element: &XmlElement) -> Result<UrdfMesh, RobotFault> {
        let address = element.needs("filename")?;
        let place = element.place_of(address);
        let scale = match element.attribute("scale") {
            // A single number scales all three.
            Some(one) if one.value.split_whitespace().count() == 1 => [element.needs_number("scale")?; 3],
            Some(_) | None => element.numbers::<3>("scale")?.unwrap_or([1.0; 3]),
        };
        if scale.contains(&0.0) {
            let kind = RobotFaultKind::BadSize { what: "a factor of the scale", value: "0".to_owned() };
            let place = element.attribute("scale").map_or(place, |at| element.place_of(at));
            return Err(kind.at(place, "write `scale=\"1 1 1\"`"));
        }
        let path = resolve_address(&address.value, place, self.file, self.packages, self.reader);
        let path = self.kept(path);
        Ok(UrdfMesh { address: address.value.clone(), path, scale, place })
    }
}

/// A measure that must be there and be above 0.
fn measure(element: &XmlElement, name: &'static str) -> Result<f64, RobotFault> {
    let value = element.needs_number(name)?;
    positive(name, value, element, name).map(|()| value)
}

fn positive(what: &'static str, value: f64, element: &XmlElement, attribute: &str) -> Result<(), RobotFault> {
    if value > 0.0 {
        return Ok(());
    }
    let place: RobotPlace = element.attribute(attribute).map_or(element.place, |at| element.place_of(at));
    let what = match what {
        "radius" => "the radius",
        "length" => "the length",
        other => other,
    };
    Err(RobotFaultKind::BadSize { what, value: value.to_string() }.at(place, "write metres above 0"))
}
