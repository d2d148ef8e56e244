//! Parts that are made from descriptions: links become bodies, joints become joints, under their names.

mod groups;
mod hands;
mod joints;
mod links;
mod settle;
mod start;
mod states;
mod walls;
