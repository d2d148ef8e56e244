//! Members that have a block of their own: programs and middleware of a system, what is bound to it, and what an actor
//! does in a test.

use std::ops::Range;

use super::{RecoveringParser, report, run};
use crate::ast::{
    BindingEntry, BindingMember, BindingMemberKind, MiddlewareSyntax, ProgramSyntax, SystemMember,
    SystemMemberKind, TestMember, TestMemberKind,
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
            ParsedUnit::TestMember(TestMember { kind, .. }) => {
                ParsedUnit::TestMember(TestMember { kind: self.test_block(kind, block), span })
            }
            other => other,
        })
    }

    fn test_block(&mut self, kind: TestMemberKind, block: Range<usize>) -> TestMemberKind {
        match kind {
            TestMemberKind::Script { actor, .. } => {
                TestMemberKind::Script { actor, members: self.members(block) }
            }
            other => other,
        }
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
