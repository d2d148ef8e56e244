//! What a library keeps of each interface.

use hrdsl_source::Span;

use crate::{
    definition::MessageDefinition, fault::MessageFault, implied::ActionInterfaces, name::InterfaceName,
};

/// A message, and what is wrong with it.
#[derive(Clone, Debug)]
pub struct KnownMessage {
    pub definition: MessageDefinition,
    pub faults: Vec<MessageFault>,
}

/// The messages of a service.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KnownService {
    pub request: InterfaceName,
    pub response: InterfaceName,
}

/// The messages of an action, and the interfaces by which it is spoken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KnownAction {
    pub goal: InterfaceName,
    pub result: InterfaceName,
    pub feedback: InterfaceName,
    pub interfaces: ActionInterfaces,
    /// Of its definition.
    pub span: Span,
}
