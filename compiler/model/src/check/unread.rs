//! What could not be read may have declared the name that is missed: one bad declaration costs that one alone.

use hrdsl_syntax::ast::{
    AgentMemberKind, AgentSyntax, AutomatonMemberKind, AutomatonSyntax, DeviceMemberKind, ItemSyntaxKind,
    WorldMember, WorldMemberKind,
};

use crate::noun::Noun;

/// Whether a declaration, or a member of a world or part, could not be read.
pub(in crate::check) fn in_item(item: &ItemSyntaxKind) -> bool {
    let broken = |members: &[WorldMember]| members.iter().any(|m| matches!(m.kind, WorldMemberKind::Error));
    match item {
        ItemSyntaxKind::Error => true,
        ItemSyntaxKind::World(world) => broken(&world.members),
        ItemSyntaxKind::Part(part) => broken(&part.members),
        ItemSyntaxKind::Device(device) => device.members.iter().any(|m| m.kind == DeviceMemberKind::Error),
        ItemSyntaxKind::Use(_)
        | ItemSyntaxKind::Allow(_)
        | ItemSyntaxKind::Enum { .. }
        | ItemSyntaxKind::Record { .. }
        | ItemSyntaxKind::Instance(_)
        | ItemSyntaxKind::Actor { .. }
        | ItemSyntaxKind::Const { .. }
        | ItemSyntaxKind::Event(_)
        | ItemSyntaxKind::Stimulus(_)
        | ItemSyntaxKind::Agent(_)
        | ItemSyntaxKind::Var(_)
        | ItemSyntaxKind::Automaton(_)
        | ItemSyntaxKind::Channel(_)
        | ItemSyntaxKind::Function(_)
        | ItemSyntaxKind::Query(_)
        | ItemSyntaxKind::Network { .. }
        | ItemSyntaxKind::Require(_)
        | ItemSyntaxKind::Assume(_)
        | ItemSyntaxKind::Cover(_)
        | ItemSyntaxKind::Cross(_)
        | ItemSyntaxKind::Suite(_)
        | ItemSyntaxKind::System(_)
        | ItemSyntaxKind::Test(_) => false,
    }
}

/// Whether a member of an agent could not be read.
pub(in crate::check) fn in_agent(agent: &AgentSyntax) -> bool {
    agent.members.iter().any(|m| matches!(m.kind, AgentMemberKind::Error))
}

/// Whether a member of an automaton could not be read.
pub(in crate::check) fn in_automaton(automaton: &AutomatonSyntax) -> bool {
    automaton.members.iter().any(|m| matches!(m.kind, AutomatonMemberKind::Error))
}

/// Whether a name of this kind may have been declared by what could not be read.
#[expect(clippy::too_many_lines, reason = "a flat match")]
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
        | Noun::System
        | Noun::Program
        | Noun::Test
        | Noun::Part
        | Noun::PartInstance
        | Noun::Body
        | Noun::Joint
        | Noun::Arm
        | Noun::Gripper
        | Noun::Base
        | Noun::Laser
        | Noun::Limb
        | Noun::Figure
        | Noun::Posture
        | Noun::Group
        | Noun::Device
        | Noun::Command
        | Noun::Current
        | Noun::Signal => items,
    }
}
