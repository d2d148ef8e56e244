//! What could not be read may have declared the name that is missed: one bad declaration costs that one alone.

use hrdsl_syntax::ast::{
    AgentMemberKind, AgentSyntax, AutomatonMemberKind, AutomatonSyntax, DeviceMemberKind, ItemSyntaxKind,
    WorldMember, WorldMemberKind,
};

use crate::noun::{Noun, NounSource};

/// Whether a declaration, or a member of a world or part, could not be read.
pub(in crate::check) fn in_item(item: &ItemSyntaxKind) -> bool {
    let device = matches!(item, ItemSyntaxKind::Device(device)
        if device.members.iter().any(|m| m.kind == DeviceMemberKind::Error));
    let world = world_members(item).iter().any(|m| m.kind == WorldMemberKind::Error);
    matches!(item, ItemSyntaxKind::Error) || device || world
}

/// The members of a world or part.
fn world_members(item: &ItemSyntaxKind) -> &[WorldMember] {
    if let ItemSyntaxKind::World(world) = item {
        &world.members
    } else if let ItemSyntaxKind::Part(part) = item {
        &part.members
    } else {
        &[]
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
pub(in crate::check) fn may_declare(noun: Noun, items: bool, members: bool) -> bool {
    match noun.declared_by() {
        NounSource::Language | NounSource::Beside => false,
        NounSource::Member => members,
        NounSource::ItemOrMember => items || members,
        NounSource::Item => items,
    }
}
