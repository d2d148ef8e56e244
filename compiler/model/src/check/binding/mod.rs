//! What is bound to a middleware: topics, services and actions with their interfaces, looked up in the definitions of ROS.

mod drives;
mod entries;
mod fields;
mod gaps;
mod groups;
mod joints;
mod parameters;
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
use hrdsl_messages::{InterfaceName, InterfaceSpace, MessageLibrary};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    BindingMember, BindingMemberKind as Member, InterfaceSyntax, MiddlewareSyntax, ServedSyntax, TextSyntax,
    TopicInSyntax, TopicOutSyntax,
};

use crate::check::{checker::Checker, state::scope::ExprEnv};
use crate::{ActorId, Dimension, TypedExpr, Value, report::bindings};
use scope::{BindingPlace, BindingScope};

/// Messages faster than this are more than any scenario samples.
const HIGHEST_RATE: f64 = 10_000.0;

impl<'a> Checker<'a> {
    /// `None` where the definitions are not there: they were not asked for.
    pub(in crate::check) fn middleware(
        &mut self,
        middleware: &MiddlewareSyntax,
        actor: ActorId,
        origin: Span,
    ) -> Option<MiddlewareBinding<TypedExpr>> {
        let kind =
            if middleware.version.text == "ros1" { MiddlewareKind::Ros1 } else { MiddlewareKind::Ros2 };
        let library = self.source.interfaces.iter().find(|l| kind_of(l) == kind)?;
        let scope = BindingScope { actor, library };
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
            self.binding_member(scope, member, &mut binding);
        }
        Some(binding)
    }

    fn binding_member(
        &mut self,
        scope: BindingScope<'a>,
        member: &BindingMember,
        binding: &mut MiddlewareBinding<TypedExpr>,
    ) {
        let origin = member.span;
        match &member.kind {
            Member::TopicIn(topic) => binding.inputs.extend(self.topic_in(scope, topic, origin)),
            Member::TopicOut(topic) => binding.outputs.extend(self.topic_out(scope, topic, origin)),
            Member::Service(served) => binding.services.extend(self.bound_service(scope, served, origin)),
            Member::Action(served) => binding.actions.extend(self.bound_action(scope, served, origin)),
            Member::Group(group) => binding.groups.extend(self.planning_group(group)),
            Member::Parameter { name, value } => self.parameter(name, value, binding),
            Member::Transition { from, to, emit } => {
                let mut env = ExprEnv::constants();
                if let Some((event, args)) = self.emission(scope.actor, emit, &mut env) {
                    let constant = |e: &TypedExpr| e.constant().unwrap_or(Value::Bool(false));
                    let args = args.iter().map(constant).collect();
                    let (from, to) = (from.text.clone(), to.text.clone());
                    binding.transitions.push(TransitionRule { from, to, event, args, origin });
                }
            }
            Member::Messages(_) | Member::Error => {}
        }
    }

    fn topic_in(
        &mut self,
        scope: BindingScope<'a>,
        topic: &TopicInSyntax,
        origin: Span,
    ) -> Option<TopicInput<TypedExpr>> {
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
        let message = self.interface(scope, &topic.interface, InterfaceSpace::Msg)?;
        let said_before = self.issues.list.len();
        let place = BindingPlace::input(topic.rate.is_some());
        let told = self.source(scope, topic, &message, rate);
        let place = BindingPlace { joints: topic.from.is_some(), ..place };
        let bound = self.entries_with(scope, place, Some(&message), Some(&message), &topic.entries, told)?;
        let has_fault = self.issues.list.len() > said_before;
        if topic.rate.is_none() && !topic.latched && !bound.template.is_of_events() && !has_fault {
            self.report(bindings::never_published(topic.name.span));
        }
        Some(TopicInput {
            topic: topic.name.text.clone(),
            interface: message.written(scope.library.version()),
            period: rate.map(|rate| nanos(1.0 / rate)),
            latched: topic.latched,
            message: bound.template,
            origin,
        })
    }

    fn topic_out(
        &mut self,
        scope: BindingScope<'a>,
        topic: &TopicOutSyntax,
        origin: Span,
    ) -> Option<TopicOutput<TypedExpr>> {
        self.binding_name(&topic.name, true);
        let message = self.interface(scope, &topic.interface, InterfaceSpace::Msg)?;
        let place = BindingPlace { joints: topic.drives.is_some(), ..BindingPlace::OUTPUT };
        let bound = self.entries(scope, place, Some(&message), None, &topic.entries)?;
        let mut rules = bound.rules;
        self.driven(scope, topic, &message, &mut rules);
        Some(TopicOutput {
            topic: topic.name.text.clone(),
            interface: message.written(scope.library.version()),
            rules,
            origin,
        })
    }

    fn bound_service(
        &mut self,
        scope: BindingScope<'a>,
        served: &ServedSyntax,
        origin: Span,
    ) -> Option<BoundService<TypedExpr>> {
        self.binding_name(&served.name, false);
        let name = self.interface(scope, &served.interface, InterfaceSpace::Srv)?;
        let service = scope.library.service(&name)?;
        let bound = self.entries(
            scope,
            BindingPlace::SERVICE,
            Some(&service.request),
            Some(&service.response),
            &served.entries,
        )?;
        Some(BoundService {
            service: served.name.text.clone(),
            interface: name.written(scope.library.version()),
            rules: bound.rules,
            response: bound.template,
            origin,
        })
    }

    fn bound_action(
        &mut self,
        scope: BindingScope<'a>,
        served: &ServedSyntax,
        origin: Span,
    ) -> Option<BoundAction<TypedExpr>> {
        self.binding_name(&served.name, false);
        let name = self.interface(scope, &served.interface, InterfaceSpace::Action)?;
        let action = scope.library.action(&name)?;
        let place = BindingPlace::SERVICE;
        let bound = self.entries(scope, place, Some(&action.goal), Some(&action.result), &served.entries)?;
        Some(BoundAction {
            action: served.name.text.clone(),
            interface: name.written(scope.library.version()),
            rules: bound.rules,
            result: bound.template,
            origin,
        })
    }

    /// The definition that a name means, if it is there and nothing is wrong with it.
    fn interface(
        &mut self,
        scope: BindingScope<'a>,
        written: &InterfaceSyntax,
        space: InterfaceSpace,
    ) -> Option<InterfaceName> {
        let name = match scope.library.find(&written.text(), space) {
            Ok(name) => name.clone(),
            Err(unknown) => {
                self.report(bindings::unknown_interface(&unknown, written.span));
                return None;
            }
        };
        match scope.library.closure(std::slice::from_ref(&name)) {
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

fn kind_of(library: &MessageLibrary) -> MiddlewareKind {
    match library.version() {
        hrdsl_messages::RosVersion::Ros1 => MiddlewareKind::Ros1,
        hrdsl_messages::RosVersion::Ros2 => MiddlewareKind::Ros2,
    }
}
