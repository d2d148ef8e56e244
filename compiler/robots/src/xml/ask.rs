//! What readers of descriptions ask of an element: a name, numbers, a child.

use super::{
    numbers::{number_in, numbers_in},
    tree::{XmlAttribute, XmlElement},
};
use crate::fault::{RobotFault, RobotFaultKind};

impl XmlElement {
    /// An attribute that must be there.
    pub fn needs(&self, name: &'static str) -> Result<&XmlAttribute, RobotFault> {
        self.attribute(name).ok_or_else(|| {
            let kind = RobotFaultKind::MissingAttribute { element: self.name.clone(), attribute: name };
            kind.at(self.place, format!("write `<{} {name}=\"…\"`", self.name))
        })
    }

    /// A name that must be there and not be empty.
    pub fn needs_name(&self, name: &'static str) -> Result<&XmlAttribute, RobotFault> {
        let attribute = self.needs(name)?;
        if attribute.value.trim().is_empty() {
            let kind = RobotFaultKind::MissingAttribute { element: self.name.clone(), attribute: name };
            return Err(kind.at(self.place, format!("give a name: `{name}=\"…\"`")));
        }
        Ok(attribute)
    }

    /// A number that must be there.
    pub fn needs_number(&self, name: &'static str) -> Result<f64, RobotFault> {
        let attribute = self.needs(name)?;
        number_in(&attribute.value, self.place_of(attribute))
    }

    /// A number that may be there.
    pub fn number(&self, name: &str) -> Result<Option<f64>, RobotFault> {
        self.attribute(name).map(|a| number_in(&a.value, self.place_of(a))).transpose()
    }

    /// So many numbers that may be there.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, RobotFault> {
        self.attribute(name).map(|a| numbers_in(&a.value, self.place_of(a))).transpose()
    }

    /// A child that must be there.
    pub fn needs_child(&self, name: &'static str) -> Result<&XmlElement, RobotFault> {
        self.child(name).ok_or_else(|| {
            let kind = RobotFaultKind::MissingElement { element: self.name.clone(), child: name };
            kind.at(self.place, format!("write `<{name} …/>` in it"))
        })
    }
}
