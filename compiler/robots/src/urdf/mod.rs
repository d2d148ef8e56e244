//! URDF: from elements to a robot, and what is wrong with it.

pub(crate) mod check;
pub(crate) mod gazebo;
pub(crate) mod joint;
pub(crate) mod kinematics;
pub(crate) mod link;
pub(crate) mod meshes;
pub(crate) mod model;
pub(crate) mod names;
pub(crate) mod physical;
pub(crate) mod read;
pub(crate) mod transmission;
