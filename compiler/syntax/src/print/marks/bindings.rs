//! The members of systems: their programs, and what is bound to a middleware.

use crate::ast::{
    BindingEntry, BindingEntryKind, BindingMember, BindingMemberKind, ExprSyntax, InterfaceSyntax,
    SystemMember, SystemMemberKind,
};
use crate::print::marks::{BlockKind, TokenMarker};
use crate::token::TokenKind;

impl TokenMarker<'_> {
    pub(super) fn system_member(&mut self, member: &SystemMember) {
        self.start(member.span.start);
        match &member.kind {
            SystemMemberKind::Limit(expr)
            | SystemMemberKind::Budget(expr)
            | SystemMemberKind::Cpu(expr)
            | SystemMemberKind::Wall(expr)
            | SystemMemberKind::Memory(expr)
            | SystemMemberKind::Output(expr) => self.expr(expr),
            SystemMemberKind::Program(program) => {
                self.block(member.span.start, BlockKind::Members);
                program.members.iter().for_each(|m| self.system_member(m));
            }
            SystemMemberKind::Middleware(middleware) => {
                self.block(member.span.start, BlockKind::Members);
                middleware.members.iter().for_each(|m| self.binding_member(m));
            }
            SystemMemberKind::Run(_)
            | SystemMemberKind::Coverage(_)
            | SystemMemberKind::Env(_)
            | SystemMemberKind::Online
            | SystemMemberKind::Error => {}
        }
    }

    fn binding_member(&mut self, member: &BindingMember) {
        self.start(member.span.start);
        match &member.kind {
            BindingMemberKind::TopicIn(topic) => {
                self.interface(&topic.interface);
                self.maybe(topic.rate.as_ref());
                let header = topic.rate.as_ref().map_or(topic.interface.span.end, |rate| rate.span.end);
                self.entries(header, &topic.entries);
            }
            BindingMemberKind::TopicOut(topic) => {
                self.interface(&topic.interface);
                self.entries(topic.interface.span.end, &topic.entries);
            }
            BindingMemberKind::Service(served) | BindingMemberKind::Action(served) => {
                self.interface(&served.interface);
                self.entries(served.interface.span.end, &served.entries);
            }
            BindingMemberKind::Parameter { value, .. } => self.expr(value),
            BindingMemberKind::Transition { emit, .. } => self.call(emit),
            BindingMemberKind::Group(group) => {
                self.maybe(group.acceleration.as_ref());
                let settings = group.acceleration.as_ref().map(|e| e.span.end);
                self.entries(settings.unwrap_or(group.device.span.end), &group.entries);
            }
            BindingMemberKind::Messages(_) | BindingMemberKind::Error => {}
        }
    }

    /// `std_msgs/Int8` holds together.
    fn interface(&mut self, interface: &InterfaceSyntax) {
        for name in interface.names.iter().skip(1) {
            let slash = self.at(name.span.start).saturating_sub(1);
            if self.tokens.get(slash).is_some_and(|t| t.kind == TokenKind::Slash) {
                self.marks[slash].tight = true;
            }
        }
    }

    fn entries(&mut self, header: u32, entries: &[BindingEntry]) {
        if entries.is_empty() {
            return;
        }
        self.block(header, BlockKind::Members);
        entries.iter().for_each(|entry| self.entry(entry));
    }

    fn entry(&mut self, entry: &BindingEntry) {
        self.start(entry.span.start);
        let when = match &entry.kind {
            BindingEntryKind::Field { field, value, when } => {
                field.elements.iter().for_each(|element| self.expr(&element.index));
                self.expr(value);
                when
            }
            BindingEntryKind::Emit { emit, when } => {
                self.call(emit);
                when
            }
            BindingEntryKind::Command { device, args, when, .. } => {
                self.args(device.span.end, args.as_deref().unwrap_or_default());
                when
            }
            BindingEntryKind::Joint { .. } | BindingEntryKind::Error => return,
        };
        self.maybe(when.as_ref() as Option<&ExprSyntax>);
    }
}
