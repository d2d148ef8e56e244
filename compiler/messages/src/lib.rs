//! Definitions of ROS interfaces: messages, services and actions of both versions of ROS.
//!
//! 1. [`MessageLibraryBuilder`] takes packages: standard ones as texts, those of a workspace by a [`WorkspaceReader`];
//! 2. [`parse_definition`] reads each `.msg`, `.srv` and `.action`, with a [`MessageFault`] for whatever is wrong in it;
//! 3. [`MessageLibraryBuilder::finish`] adds what services and actions imply, and checks the definitions against each other;
//! 4. [`MessageLibrary::find`] finds an interface, or the name that was probably meant;
//! 5. [`MessageLibrary::closure`] gives the [`InterfaceTable`] that a client builds its classes from.
//!
//! Faults are told by their place and a help; the codes that diagnostics have are given to them where they are reported.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod checksum;
mod closure;
mod definition;
mod fault;
mod guess;
mod implied;
mod known;
mod library;
pub mod limits;
mod manifest;
mod name;
mod parse;
mod placed;
mod primitive;
mod print;
mod resolve;
mod standard;
mod table;
mod types;
mod value;
mod workspace;

pub use definition::{
    ActionDefinition, ElementCount, FieldElement, MessageConstant, MessageDefinition, MessageField,
    MessageFieldType, ServiceDefinition,
};
pub use fault::{MessageFault, MessageFaultKind};
pub use implied::ActionInterfaces;
pub use known::{KnownAction, KnownMessage, KnownService};
pub use library::{MessageLibrary, MessageLibraryBuilder, UnknownInterface};
pub use name::{InterfaceName, InterfaceSpace, NamedPart, RosVersion};
pub use parse::{DefinitionText, InterfaceDefinition, parse_definition};
pub use primitive::PrimitiveType;
pub use table::{
    ActionRow, ArrayRow, ConstantRow, FieldRow, InterfaceTable, MessageRow, ServedAction, ServiceRow,
};
pub use value::MessageValue;
pub use workspace::{WorkspaceEntry, WorkspaceReader};
