//! What is kept between steps, of each kind of thing: data, and what needs no engine but its own part of it.

pub(crate) mod accuracy;
pub mod adapter;
pub mod before;
pub mod bodies;
pub mod energy;
pub mod guide;
pub mod joint;
pub mod loads;
pub mod losses;
pub mod pairs;
pub(crate) mod place;
pub mod roots;
pub mod solid;
pub mod yielding;
