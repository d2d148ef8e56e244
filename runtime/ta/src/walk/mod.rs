//! A network gone through transition by transition: by hand, or along a recorded run.

pub(crate) mod follow;
pub(crate) mod session;
pub(crate) mod state;
