//! What is bound to a middleware: topics, services and actions with their interfaces, looked up in the definitions of ROS.

mod drives;
mod entries;
mod fields;
mod gaps;
mod groups;
mod joints;
mod parameters;
pub(in crate::check) mod phase;
mod places;
mod rules;
mod scope;
mod shape;
mod sources;
mod wholes;

use std::collections::BTreeMap;

use hrdsl_ir::binding::{
    BoundAction, BoundService, MiddlewareBinding, MiddlewareKind, TopicInput, TopicOutput, TransitionRule,
};
use hrdsl_ir::value::nanos;
use hrdsl_messages::{InterfaceName, InterfaceSpace};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    BindingMember, BindingMemberKind as Member, InterfaceSyntax, MiddlewareSyntax, ServedSyntax, TextSyntax,
    TopicInSyntax, TopicOutSyntax,
};

use crate::check::state::scope::ExprEnv;
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{Dimension, TypedExpr, Value, report::bindings};
use scope::BindingPlace;

/// Messages faster than this are more than any scenario samples.
const HIGHEST_RATE: f64 = 10_000.0;

impl<'a> BindingPhase<'_, 'a> {
    fn middleware(
        &mut self,
        middleware: &MiddlewareSyntax,
        kind: MiddlewareKind,
        origin: Span,
    ) -> MiddlewareBinding<TypedExpr> {
        let library = self.library;
        for fault in library.faults() {
            self.report(bindings::fault(fault));
        }
        let mut binding = MiddlewareBinding {
            kind,
            packages: library.package_folders().clone(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            services: Vec::new(),
            actions: Vec::new(),
            groups: Vec::new(),
            parameters: BTreeMap::new(),
            transitions: Vec::new(),
            origin,
        };
        for member in &middleware.members {
            self.binding_member(member, &mut binding);
        }
        binding
    }

    fn binding_member(&mut self, member: &BindingMember, binding: &mut MiddlewareBinding<TypedExpr>) {
        let origin = member.span;
        match &member.kind {
            Member::TopicIn(topic) => binding.inputs.extend(self.topic_in(topic, origin)),
            Member::TopicOut(topic) => binding.outputs.extend(self.topic_out(topic, origin)),
            Member::Service(served) => binding.services.extend(self.bound_service(served, origin)),
            Member::Action(served) => binding.actions.extend(self.bound_action(served, origin)),
            Member::Group(group) => binding.groups.extend(self.planning_group(group)),
            Member::Parameter { name, value } => self.parameter(name, value, binding),
            Member::Transition { from, to, emit } => {
                let mut env = ExprEnv::constants();
                if let Some((event, args)) = self.emission(self.actor, emit, &mut env) {
                    let constant = |e: &TypedExpr| e.constant().unwrap_or(Value::Bool(false));
                    let args = args.iter().map(constant).collect();
                    let (from, to) = (from.text.clone(), to.text.clone());
                    binding.transitions.push(TransitionRule { from, to, event, args, origin });
                }
            }
            Member::Messages(_) | Member::Error => {}
        }
    }

    fn topic_in(&mut self, topic: &TopicInSyntax, origin: Span) -> Option<TopicInput<TypedExpr>> {
        self.binding_name(&topic.name, false);
        let rate = topic.rate.as_ref().and_then(|e| {
            let rate = self.quantity_of(e, Dimension::FREQUENCY)?;
            if rate <= 0.0 || rate > HIGHEST_RATE {
                let rule = format!("more than 0 Hz and at most {HIGHEST_RATE} Hz");
                self.report(crate::report::types::must_be("the rate", &rule, e.span));
                return None;
            }
            Some(rate)
        });
        let message = self.interface(&topic.interface, InterfaceSpace::Msg)?;
        let said_before = self.issues.list.len();
        let place = BindingPlace::input(topic.rate.is_some());
        let told = self.source(topic, &message, rate);
        let place = BindingPlace { joints: topic.from.is_some(), ..place };
        let bound = self.entries_with(place, Some(&message), Some(&message), &topic.entries, told)?;
        let has_fault = self.issues.list.len() > said_before;
        if topic.rate.is_none() && !topic.latched && !bound.template.is_of_events() && !has_fault {
            self.report(bindings::never_published(topic.name.span));
        }
        Some(TopicInput {
            topic: topic.name.text.clone(),
            interface: message.written(self.library.version()),
            period: rate.map(|rate| nanos(1.0 / rate)),
            latched: topic.latched,
            message: bound.template,
            origin,
        })
    }

    fn topic_out(&mut self, topic: &TopicOutSyntax, origin: Span) -> Option<TopicOutput<TypedExpr>> {
        self.binding_name(&topic.name, true);
        let message = self.interface(&topic.interface, InterfaceSpace::Msg)?;
        let place = BindingPlace { joints: topic.drives.is_some(), ..BindingPlace::OUTPUT };
        let bound = self.entries(place, Some(&message), None, &topic.entries)?;
        let mut rules = bound.rules;
        self.driven(topic, &message, &mut rules);
        Some(TopicOutput {
            topic: topic.name.text.clone(),
            interface: message.written(self.library.version()),
            rules,
            origin,
        })
    }

    fn bound_service(&mut self, served: &ServedSyntax, origin: Span) -> Option<BoundService<TypedExpr>> {
        self.binding_name(&served.name, false);
        let name = self.interface(&served.interface, InterfaceSpace::Srv)?;
        let service = self.library.service(&name)?;
        let bound = self.entries(
            BindingPlace::SERVICE,
            Some(&service.request),
            Some(&service.response),
            &served.entries,
        )?;
        Some(BoundService {
            service: served.name.text.clone(),
            interface: name.written(self.library.version()),
            rules: bound.rules,
            response: bound.template,
            origin,
        })
    }

    fn bound_action(&mut self, served: &ServedSyntax, origin: Span) -> Option<BoundAction<TypedExpr>> {
        self.binding_name(&served.name, false);
        let name = self.interface(&served.interface, InterfaceSpace::Action)?;
        let action = self.library.action(&name)?;
        let place = BindingPlace::SERVICE;
        let bound = self.entries(place, Some(&action.goal), Some(&action.result), &served.entries)?;
        Some(BoundAction {
            action: served.name.text.clone(),
            interface: name.written(self.library.version()),
            rules: bound.rules,
            result: bound.template,
            origin,
        })
    }

    /// The definition that a name means, if it is there and nothing is wrong with it.
    fn interface(&mut self, written: &InterfaceSyntax, space: InterfaceSpace) -> Option<InterfaceName> {
        let name = match self.library.find(&written.text(), space) {
            Ok(name) => name.clone(),
            Err(unknown) => {
                self.report(bindings::unknown_interface(&unknown, written.span));
                return None;
            }
        };
        match self.library.closure(std::slice::from_ref(&name)) {
            Ok(_) => Some(name),
            Err(faults) => {
                for fault in &faults {
                    self.report(bindings::fault(fault));
                }
                None
            }
        }
    }

    /// A name of the middleware's graph, from its root: `/scan`.
    fn binding_name(&mut self, name: &TextSyntax, wild: bool) {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || (wild && c == '*');
        let parts = name.text.strip_prefix('/').unwrap_or_default();
        let fits = !parts.is_empty() && parts.split('/').all(|p| !p.is_empty() && p.chars().all(is_part));
        if !fits || name.text.matches('*').count() > 1 {
            self.report(bindings::bad_name(&name.text, wild, name.span));
        }
    }
}
