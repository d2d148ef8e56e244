//! What could not be read may have declared the name that is missed: one bad declaration costs that one alone.

use hrdsl_syntax::ast::{
    Agent, AgentMemberKind, Automaton, AutomatonMemberKind, DeviceMemberKind, ItemKind, WorldMember,
    WorldMemberKind,
};

use crate::noun::Noun;

/// Whether a declaration, or a member of a world or part, could not be read.
pub(in crate::check) fn in_item(item: &ItemKind) -> bool {
    let broken = |members: &[WorldMember]| members.iter().any(|m| matches!(m.kind, WorldMemberKind::Error));
    match item {
        ItemKind::Error => true,
        ItemKind::World(world) => broken(&world.members),
        ItemKind::Part(part) => broken(&part.members),
        ItemKind::Device(device) => device.members.iter().any(|m| m.kind == DeviceMemberKind::Error),
        ItemKind::Use(_)
        | ItemKind::Allow(_)
        | ItemKind::Enum { .. }
        | ItemKind::Record { .. }
        | ItemKind::Instance(_)
        | ItemKind::Actor { .. }
        | ItemKind::Const { .. }
        | ItemKind::Event(_)
        | ItemKind::Stimulus(_)
        | ItemKind::Agent(_)
        | ItemKind::Var(_)
        | ItemKind::Automaton(_)
        | ItemKind::Channel(_)
        | ItemKind::Function(_)
        | ItemKind::Query(_)
        | ItemKind::Network { .. }
        | ItemKind::Require(_)
        | ItemKind::Assume(_)
        | ItemKind::Cover(_)
        | ItemKind::Cross(_)
        | ItemKind::Suite(_)
        | ItemKind::System(_)
        | ItemKind::Test(_) => false,
    }
}

/// Whether a member of an agent could not be read.
pub(in crate::check) fn in_agent(agent: &Agent) -> bool {
    agent.members.iter().any(|m| matches!(m.kind, AgentMemberKind::Error))
}

/// Whether a member of an automaton could not be read.
pub(in crate::check) fn in_automaton(automaton: &Automaton) -> bool {
    automaton.members.iter().any(|m| matches!(m.kind, AutomatonMemberKind::Error))
}

/// Whether a name of this kind may have been declared by what could not be read.
pub(in crate::check) fn may_declare(noun: Noun, items: bool, members: bool) -> bool {
    match noun {
        // The language's own words.
        Noun::Role
        | Noun::Unit
        | Noun::RequirementKind
        | Noun::Method
        | Noun::Explore
        | Noun::Reach
        | Noun::SearchReach
        | Noun::ReachOf
        | Noun::Witness
        | Noun::Delays
        | Noun::InternalAction
        | Noun::Performative
        | Noun::Motion
        | Noun::Shape
        | Noun::Action
        | Noun::DeviceKind
        | Noun::DeviceMeasure
        | Noun::Primitive
        | Noun::Coordinate => false,
        // Declared in one piece with the place that uses them.
        Noun::Parameter | Noun::Sample | Noun::Label | Noun::Bin | Noun::Field | Noun::EnumValue => false,
        Noun::Annotation | Noun::Belief | Noun::Goal | Noun::Clock | Noun::Location | Noun::Member => members,
        Noun::Variable | Noun::Function => items || members,
        Noun::Actor
        | Noun::Type
        | Noun::Enum
        | Noun::Record
        | Noun::Template
        | Noun::Constant
        | Noun::Event
        | Noun::Stimulus
        | Noun::EventOrStimulus
        | Noun::Channel
        | Noun::Medium
        | Noun::Agent
        | Noun::Automaton
        | Noun::Player
        | Noun::Network
        | Noun::Query
        | Noun::Requirement
        | Noun::Point
        | Noun::Cross
        | Noun::Suite
        | Noun::Test
        | Noun::Part
        | Noun::PartInstance
        | Noun::Body
        | Noun::Joint
        | Noun::Arm
        | Noun::Gripper
        | Noun::Device
        | Noun::Command
        | Noun::Current
        | Noun::Signal => items,
    }
}
