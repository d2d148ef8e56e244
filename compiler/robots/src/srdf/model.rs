//! What an SRDF says, by the names of the robot's links and joints.

use crate::fault::RobotPlace;

/// The semantics of a robot, for planners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SrdfSemantics {
    /// The robot that it is of.
    pub robot: String,
    pub groups: Vec<SrdfGroup>,
    pub states: Vec<SrdfState>,
    pub end_effectors: Vec<SrdfEndEffector>,
    pub virtual_joints: Vec<SrdfVirtualJoint>,
    pub passive_joints: Vec<SrdfPassiveJoint>,
    pub disabled_collisions: Vec<SrdfDisabledPair>,
}

/// Links and joints that move together.
#[derive(Clone, Debug, PartialEq)]
pub struct SrdfGroup {
    pub name: String,
    pub joints: Vec<String>,
    pub links: Vec<String>,
    pub chains: Vec<SrdfChain>,
    /// Groups that are parts of it.
    pub groups: Vec<String>,
    pub place: RobotPlace,
}

/// From one link down to another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SrdfChain {
    pub base: String,
    pub tip: String,
}

/// Values of a group's joints that have a name.
#[derive(Clone, Debug, PartialEq)]
pub struct SrdfState {
    pub name: String,
    pub group: String,
    /// By the joints' names; several values of a joint with several degrees of freedom.
    pub values: Vec<(String, Vec<f64>)>,
    pub place: RobotPlace,
}

/// A hand, and what carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct SrdfEndEffector {
    pub name: String,
    pub group: String,
    pub parent_link: String,
    pub parent_group: Option<String>,
    pub place: RobotPlace,
}

/// How the robot as a whole is joined to the world.
#[derive(Clone, Debug, PartialEq)]
pub struct SrdfVirtualJoint {
    pub name: String,
    pub kind: SrdfVirtualKind,
    pub parent_frame: String,
    pub child_link: String,
    pub place: RobotPlace,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SrdfVirtualKind {
    Fixed,
    Floating,
    Planar,
}

/// A joint that no motor moves.
#[derive(Clone, Debug, PartialEq)]
pub struct SrdfPassiveJoint {
    pub name: String,
    pub place: RobotPlace,
}

/// Two links that are not looked at together.
#[derive(Clone, Debug, PartialEq)]
pub struct SrdfDisabledPair {
    pub link1: String,
    pub link2: String,
    /// `Adjacent`, `Never`, `Default`, or whatever somebody wrote.
    pub reason: Option<String>,
    pub place: RobotPlace,
}

impl SrdfSemantics {
    #[must_use]
    pub fn group(&self, name: &str) -> Option<&SrdfGroup> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// The states of a group, in the order of the text.
    pub fn states_of<'a>(&'a self, group: &'a str) -> impl Iterator<Item = &'a SrdfState> {
        self.states.iter().filter(move |state| state.group == group)
    }
}
