//! Members of a system that have a block of their own: programs, middleware, and what is bound to it.

use std::ops::Range;

use super::{RecoveringParser, report, run};
use crate::ast::{
    BindingEntry, BindingMember, BindingMemberKind, MiddlewareSyntax, ProgramSyntax, SystemMember,
    SystemMemberKind,
};
use crate::context::ParsedUnit;
use crate::token::TokenKind;

impl RecoveringParser<'_, '_> {
    /// A member with a block, whose own members are read one by one.
    pub(super) fn nested(&mut self, start: TokenKind, range: &Range<usize>) -> Option<ParsedUnit> {
        let (open, close) = self.pairs(range).pop()?;
        let shell = self.shell(range.start, &[(open, close)]);
        let unit = match run(self.cx, Some(start), &shell) {
            Ok(unit) => unit,
            Err(fault) => {
                report(self.cx, &fault, &shell, None);
                return None;
            }
        };
        let (block, span) = (open + 1..close, self.span(&(range.start..close + 1)));
        Some(match unit {
            ParsedUnit::SystemMember(SystemMember { kind, .. }) => {
                ParsedUnit::SystemMember(SystemMember { kind: self.system_block(kind, block), span })
            }
            ParsedUnit::BindingMember(BindingMember { kind, .. }) => {
                ParsedUnit::BindingMember(BindingMember { kind: self.binding_block(kind, block), span })
            }
            other => other,
        })
    }

    fn system_block(&mut self, kind: SystemMemberKind, block: Range<usize>) -> SystemMemberKind {
        match kind {
            SystemMemberKind::Program(program) => {
                SystemMemberKind::Program(ProgramSyntax { members: self.members(block), ..program })
            }
            SystemMemberKind::Middleware(middleware) => {
                let members = self.members::<BindingMember>(block);
                SystemMemberKind::Middleware(MiddlewareSyntax { members, ..middleware })
            }
            other => other,
        }
    }

    fn binding_block(&mut self, mut kind: BindingMemberKind, block: Range<usize>) -> BindingMemberKind {
        let entries = match &mut kind {
            BindingMemberKind::TopicIn(topic) => &mut topic.entries,
            BindingMemberKind::TopicOut(topic) => &mut topic.entries,
            BindingMemberKind::Service(served) | BindingMemberKind::Action(served) => &mut served.entries,
            BindingMemberKind::Group(group) => &mut group.entries,
            BindingMemberKind::Messages(_)
            | BindingMemberKind::Parameter { .. }
            | BindingMemberKind::Transition { .. }
            | BindingMemberKind::Error => return kind,
        };
        *entries = self.members::<BindingEntry>(block);
        kind
    }
}
