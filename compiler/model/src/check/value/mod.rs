//! Values: what types and expressions mean, of one part and of several.

pub(super) mod args;
pub(super) mod call;
pub(super) mod combine;
pub(super) mod contact;
pub(super) mod devices;
pub(super) mod due;
pub(super) mod element;
pub(super) mod expr;
pub(super) mod layout;
pub(super) mod linear;
pub(super) mod list;
pub(super) mod locals;
pub(super) mod lookup;
pub(super) mod measure;
pub(super) mod operands;
pub(super) mod parts;
pub(super) mod quantity;
pub(super) mod range;
pub(super) mod reading;
pub(super) mod roles;
pub(super) mod variable;
