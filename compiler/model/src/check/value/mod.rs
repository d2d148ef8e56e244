//! Values: what expressions mean, of one part and of several.

pub(super) mod args;
pub(super) mod combine;
pub(super) mod contact;
pub(super) mod due;
pub(super) mod element;
pub(super) mod expr;
pub(super) mod linear;
pub(super) mod list;
pub(super) mod locals;
pub(super) mod lookup;
pub(super) mod measure;
pub(super) mod parts;
pub(super) mod range;
pub(super) mod roles;
