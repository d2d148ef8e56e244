//! The names that a scenario declares, read off its syntax.

use std::collections::BTreeSet;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, AgentMemberKind as AgentMember, AutomatonMemberKind as AutomatonMember, DeviceMemberKind,
    ItemSyntaxKind, NameSyntax, StatementSyntaxKind, StimulusStepKind, TypeExpr, WorldMemberKind,
};

use super::{DefinedType, NameDefinition, global::GlobalNames};
use crate::noun::Noun;

/// The definitions of these items and of all in them, and those of them that are visible everywhere.
pub(super) fn of_items(items: &[&ast::ItemSyntax]) -> (Vec<NameDefinition>, GlobalNames) {
    let mut reader = DefinitionReader {
        found: Vec::new(),
        everywhere: GlobalNames::default(),
        whole: Span::default(),
        doc: String::new(),
    };
    for item in items {
        reader.whole = item.span;
        reader.doc.clone_from(&item.doc);
        reader.item(&item.kind);
    }
    (reader.found, reader.everywhere)
}

struct DefinitionReader {
    found: Vec<NameDefinition>,
    everywhere: GlobalNames,
    /// Of the declaration that is being read.
    whole: Span,
    doc: String,
}

impl DefinitionReader {
    fn define(&mut self, noun: Noun, name: &NameSyntax) {
        self.typed(noun, name, DefinedType::None);
    }

    fn typed(&mut self, noun: Noun, name: &NameSyntax, ty: DefinedType) {
        let (text, doc) = (name.text.clone(), self.doc.clone());
        self.found.push(NameDefinition {
            noun: noun.word(),
            name: text,
            place: name.span,
            whole: self.whole,
            ty,
            doc,
        });
    }

    /// A name that is visible everywhere.
    fn global(&mut self, noun: Noun, name: &NameSyntax) {
        self.everywhere.enter(noun, &name.text, name.span);
        self.define(noun, name);
    }

    /// The name of a declaration that is a template if it has parameters; those are defined, too.
    fn template(&mut self, noun: Noun, name: &NameSyntax, params: Option<&Vec<ast::ParamSyntax>>) {
        let is = if params.is_some() { Noun::Template } else { noun };
        self.everywhere.enter(is, &name.text, name.span);
        self.define(noun, name);
        self.params(Noun::Parameter, params.map_or(&[], Vec::as_slice));
    }

    /// Those of a declaration have its documentation no more.
    fn params(&mut self, noun: Noun, params: &[ast::ParamSyntax]) {
        let doc = std::mem::take(&mut self.doc);
        for param in params {
            self.typed(noun, &param.name, written(&param.ty));
        }
        self.doc = doc;
    }

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn item(&mut self, kind: &ItemSyntaxKind) {
        match kind {
            ItemSyntaxKind::Enum { name, values } => {
                self.global(Noun::Enum, name);
                values.iter().for_each(|value| self.global(Noun::EnumValue, value));
            }
            ItemSyntaxKind::Record { name, fields } => {
                self.global(Noun::Record, name);
                self.params(Noun::Field, fields);
            }
            ItemSyntaxKind::Actor { name, .. } => self.global(Noun::Actor, name),
            ItemSyntaxKind::Const { name, .. } => self.global(Noun::Constant, name),
            ItemSyntaxKind::Event(event) => {
                for one in &event.names {
                    self.global(Noun::Event, &one.name);
                    self.params(Noun::Parameter, &one.params);
                }
            }
            ItemSyntaxKind::Stimulus(stimulus) => {
                self.global(Noun::Stimulus, &stimulus.name);
                self.params(Noun::Parameter, &stimulus.params);
                self.samples(&stimulus.body);
            }
            ItemSyntaxKind::Agent(agent) => self.agent(agent),
            ItemSyntaxKind::Var(var) => {
                self.everywhere.enter(Noun::Variable, &var.name.text, var.name.span);
                self.typed(Noun::Variable, &var.name, written(&var.ty));
            }
            ItemSyntaxKind::Automaton(automaton) => self.automaton(automaton),
            ItemSyntaxKind::Channel(channel) => {
                for one in &channel.names {
                    self.global(Noun::Channel, &one.name);
                    self.params(Noun::Parameter, &one.params);
                }
            }
            ItemSyntaxKind::Function(function) => {
                self.everywhere.enter(Noun::Function, &function.name.text, function.name.span);
                self.function(function);
            }
            ItemSyntaxKind::Query(query) => self.global(Noun::Query, &query.name),
            ItemSyntaxKind::Network { name, .. } => self.global(Noun::Network, name),
            ItemSyntaxKind::Require(require) => {
                self.template(Noun::Requirement, &require.name, require.params.as_ref());
            }
            ItemSyntaxKind::Cover(cover) => {
                self.template(Noun::Point, &cover.name, cover.params.as_ref());
                cover.bins.iter().for_each(|bin| self.define(Noun::Bin, &bin.name));
            }
            ItemSyntaxKind::Cross(cross) => {
                self.template(Noun::Cross, &cross.name, cross.params.as_ref());
            }
            ItemSyntaxKind::Suite(suite) => self.global(Noun::Suite, &suite.name),
            ItemSyntaxKind::Part(part) => {
                self.global(Noun::Part, &part.name);
                self.params(Noun::Parameter, part.params.as_deref().unwrap_or_default());
                self.world(&part.members);
            }
            ItemSyntaxKind::World(world) => self.world(&world.members),
            ItemSyntaxKind::Device(device) => self.device(device),
            ItemSyntaxKind::Test(test) => {
                if let Some(last) = test.name.names.last() {
                    self.define(Noun::Test, last);
                }
            }
            ItemSyntaxKind::Instance(instance) => self.global(of_sort(instance.sort), &instance.name),
            ItemSyntaxKind::Use(_)
            | ItemSyntaxKind::Allow(_)
            | ItemSyntaxKind::Assume(_)
            | ItemSyntaxKind::System(_)
            | ItemSyntaxKind::Error => {}
        }
    }

    fn samples(&mut self, steps: &[ast::StimulusStepSyntax]) {
        for step in steps {
            match &step.kind {
                StimulusStepKind::Sample { name, .. } => self.define(Noun::Sample, name),
                StimulusStepKind::If { then, otherwise, .. } => {
                    self.samples(then);
                    self.samples(otherwise);
                }
                StimulusStepKind::Emit(_)
                | StimulusStepKind::Hold(_)
                | StimulusStepKind::Act { .. }
                | StimulusStepKind::Error => {}
            }
        }
    }

    fn agent(&mut self, agent: &ast::AgentSyntax) {
        self.template(Noun::Agent, &agent.name, agent.params.as_ref());
        let mut goals: BTreeSet<&str> = BTreeSet::new();
        for member in &agent.members {
            if let AgentMember::GoalType { name, .. } = &member.kind {
                goals.insert(&name.text);
            }
        }
        for member in &agent.members {
            (self.whole, self.doc) = (member.span, member.doc.clone());
            match &member.kind {
                AgentMember::Belief { name, params, annotations, .. } => {
                    self.define(Noun::Belief, name);
                    self.params(Noun::Parameter, params);
                    self.params(Noun::Annotation, annotations);
                }
                AgentMember::GoalType { name, params } => {
                    self.define(Noun::Goal, name);
                    self.params(Noun::Parameter, params);
                }
                AgentMember::Plan(plan) => {
                    plan.label.iter().for_each(|label| self.define(Noun::Label, &label.name));
                    // A goal that is not declared is what its first plan achieves.
                    let of = &plan.trigger.literal.call.name;
                    if plan.trigger.kind == ast::TriggerSyntaxKind::Achieve && goals.insert(&of.text) {
                        self.define(Noun::Goal, of);
                    }
                }
                AgentMember::Rule { .. }
                | AgentMember::Goal(_)
                | AgentMember::Allow(_)
                | AgentMember::Error => {}
            }
        }
    }

    fn automaton(&mut self, automaton: &ast::AutomatonSyntax) {
        self.template(Noun::Automaton, &automaton.name, automaton.params.as_ref());
        for member in &automaton.members {
            (self.whole, self.doc) = (member.span, member.doc.clone());
            match &member.kind {
                AutomatonMember::Clock(clocks) => clocks.iter().for_each(|c| self.define(Noun::Clock, c)),
                AutomatonMember::Var(var) => self.typed(Noun::Variable, &var.name, written(&var.ty)),
                AutomatonMember::Location { name, .. } => self.define(Noun::Location, name),
                AutomatonMember::Edge(edge) => self.params(Noun::Variable, &edge.selects),
                AutomatonMember::Function(function) => self.function(function),
                AutomatonMember::Allow(_) | AutomatonMember::Error => {}
            }
        }
    }

    fn function(&mut self, function: &ast::FunctionSyntax) {
        let ty = function.result.as_ref().map_or(DefinedType::None, written);
        self.typed(Noun::Function, &function.name, ty);
        self.params(Noun::Parameter, &function.params);
        let doc = std::mem::take(&mut self.doc);
        self.statements(&function.body);
        self.doc = doc;
    }

    fn statements(&mut self, statements: &[ast::StatementSyntax]) {
        for statement in statements {
            match &statement.kind {
                StatementSyntaxKind::Var(var) => self.typed(Noun::Variable, &var.name, written(&var.ty)),
                StatementSyntaxKind::If { then, otherwise, .. } => {
                    self.statements(then);
                    self.statements(otherwise);
                }
                StatementSyntaxKind::While { body, .. } => self.statements(body),
                StatementSyntaxKind::For { name, body, .. } => {
                    self.define(Noun::Variable, name);
                    self.statements(body);
                }
                StatementSyntaxKind::Assign { .. }
                | StatementSyntaxKind::Call(_)
                | StatementSyntaxKind::Return(_)
                | StatementSyntaxKind::Error => {}
            }
        }
    }

    fn device(&mut self, device: &ast::DeviceSyntax) {
        for member in &device.members {
            (self.whole, self.doc) = (member.span, member.doc.clone());
            match &member.kind {
                DeviceMemberKind::Command(command) => {
                    self.define(Noun::Command, &command.name);
                    let params: Vec<ast::ParamSyntax> =
                        command.params.iter().map(|p| p.param.clone()).collect();
                    self.params(Noun::Parameter, &params);
                }
                DeviceMemberKind::State(state) => self.define(Noun::DeviceState, &state.name),
                DeviceMemberKind::Error => {}
            }
        }
    }

    fn world(&mut self, members: &[ast::WorldMember]) {
        for member in members {
            (self.whole, self.doc) = (member.span, member.doc.clone());
            match &member.kind {
                WorldMemberKind::Part { name, .. } => self.define(Noun::PartInstance, name),
                WorldMemberKind::Body(body) => self.define(Noun::Body, &body.name),
                WorldMemberKind::Joint(joint) => self.define(Noun::Joint, &joint.name),
                WorldMemberKind::Arm(arm) => self.define(Noun::Arm, &arm.name),
                WorldMemberKind::Gripper(gripper) => self.define(Noun::Gripper, &gripper.name),
                WorldMemberKind::Base(base) => self.define(Noun::Base, &base.name),
                WorldMemberKind::Laser(laser) => self.define(Noun::Laser, &laser.name),
                WorldMemberKind::Limb(limb) => self.define(Noun::Limb, &limb.name),
                WorldMemberKind::Figure(figure) => self.define(Noun::Figure, &figure.name),
                WorldMemberKind::Scanner { name, .. } => self.define(Noun::Laser, name),
                WorldMemberKind::Walls(walls) => self.define(Noun::Body, &walls.name),
                WorldMemberKind::Posture(posture) => self.define(Noun::Posture, &posture.name),
                WorldMemberKind::Current { name, .. } => self.define(Noun::Current, name),
                WorldMemberKind::Signal { name, ty, .. } => self.typed(Noun::Signal, name, written(ty)),
                WorldMemberKind::Step(_)
                | WorldMemberKind::Sample(_)
                | WorldMemberKind::Gravity(_)
                | WorldMemberKind::Robot(_)
                | WorldMemberKind::Packages(_)
                | WorldMemberKind::Argument { .. }
                | WorldMemberKind::Semantics(_)
                | WorldMemberKind::Start(_)
                | WorldMemberKind::Rule(_)
                | WorldMemberKind::Allow(_)
                | WorldMemberKind::Error => {}
            }
        }
    }
}

fn written(ty: &TypeExpr) -> DefinedType {
    match ty {
        TypeExpr::Error => DefinedType::None,
        TypeExpr::Named(_) | TypeExpr::Range(..) | TypeExpr::Array(..) | TypeExpr::List(_) => {
            DefinedType::Written(type_span(ty))
        }
    }
}

/// What the instances of a template are.
pub(crate) fn of_sort(of: ast::TemplateSyntaxKind) -> Noun {
    match of {
        ast::TemplateSyntaxKind::Agent => Noun::Agent,
        ast::TemplateSyntaxKind::Automaton => Noun::Automaton,
        ast::TemplateSyntaxKind::Require => Noun::Requirement,
        ast::TemplateSyntaxKind::Cover => Noun::Point,
        ast::TemplateSyntaxKind::Cross => Noun::Cross,
    }
}

/// Where a type is written.
pub(crate) fn type_span(ty: &TypeExpr) -> Span {
    match ty {
        TypeExpr::Named(name) => name.span,
        TypeExpr::Range(lo, hi) => lo.span.to(hi.span),
        TypeExpr::Array(of, size) if **of == TypeExpr::Error => size.span,
        TypeExpr::Array(of, size) => type_span(of).to(size.span),
        TypeExpr::List(of) => type_span(of),
        TypeExpr::Error => Span::default(),
    }
}
