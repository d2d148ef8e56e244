//! The names that a scenario declares, read off its syntax.

use std::collections::BTreeSet;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, AgentMemberKind as AgentMember, AutomatonMemberKind as AutomatonMember, DeviceMemberKind,
    ItemSyntaxKind, NameSyntax, StatementSyntaxKind, StimulusStepKind, TypeExpr, WorldMemberKind,
};

use super::{DefinedType, NameDefinition};

/// The definitions of these items and of all in them.
pub(super) fn of_items(items: &[&ast::ItemSyntax]) -> Vec<NameDefinition> {
    let mut reader = DefinitionReader { found: Vec::new(), whole: Span::default(), doc: String::new() };
    for item in items {
        reader.whole = item.span;
        reader.doc.clone_from(&item.doc);
        reader.item(&item.kind);
    }
    reader.found
}

struct DefinitionReader {
    found: Vec<NameDefinition>,
    /// Of the declaration that is being read.
    whole: Span,
    doc: String,
}

impl DefinitionReader {
    fn define(&mut self, noun: &'static str, name: &NameSyntax) {
        self.typed(noun, name, DefinedType::None);
    }

    fn typed(&mut self, noun: &'static str, name: &NameSyntax, ty: DefinedType) {
        let (text, doc) = (name.text.clone(), self.doc.clone());
        self.found.push(NameDefinition { noun, name: text, place: name.span, whole: self.whole, ty, doc });
    }

    /// Those of a declaration have its documentation no more.
    fn params(&mut self, noun: &'static str, params: &[ast::ParamSyntax]) {
        let doc = std::mem::take(&mut self.doc);
        for param in params {
            self.typed(noun, &param.name, written(&param.ty));
        }
        self.doc = doc;
    }

    fn template(&mut self, params: Option<&Vec<ast::ParamSyntax>>) {
        self.params("parameter", params.map_or(&[], Vec::as_slice));
    }

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn item(&mut self, kind: &ItemSyntaxKind) {
        match kind {
            ItemSyntaxKind::Enum { name, values } => {
                self.define("enumeration", name);
                values.iter().for_each(|value| self.define("value", value));
            }
            ItemSyntaxKind::Record { name, fields } => {
                self.define("record", name);
                self.params("field", fields);
            }
            ItemSyntaxKind::Actor { name, .. } => self.define("actor", name),
            ItemSyntaxKind::Const { name, .. } => self.define("constant", name),
            ItemSyntaxKind::Event(event) => {
                for one in &event.names {
                    self.define("event", &one.name);
                    self.params("parameter", &one.params);
                }
            }
            ItemSyntaxKind::Stimulus(stimulus) => {
                self.define("stimulus", &stimulus.name);
                self.params("parameter", &stimulus.params);
                self.samples(&stimulus.body);
            }
            ItemSyntaxKind::Agent(agent) => self.agent(agent),
            ItemSyntaxKind::Var(var) => self.typed("variable", &var.name, written(&var.ty)),
            ItemSyntaxKind::Automaton(automaton) => self.automaton(automaton),
            ItemSyntaxKind::Channel(channel) => {
                for one in &channel.names {
                    self.define("channel", &one.name);
                    self.params("parameter", &one.params);
                }
            }
            ItemSyntaxKind::Function(function) => self.function(function),
            ItemSyntaxKind::Query(query) => self.define("query", &query.name),
            ItemSyntaxKind::Network { name, .. } => self.define("network", name),
            ItemSyntaxKind::Require(require) => {
                self.define("requirement", &require.name);
                self.template(require.params.as_ref());
            }
            ItemSyntaxKind::Cover(cover) => {
                self.define("coverpoint", &cover.name);
                self.template(cover.params.as_ref());
                cover.bins.iter().for_each(|bin| self.define("bin", &bin.name));
            }
            ItemSyntaxKind::Cross(cross) => {
                self.define("cross product", &cross.name);
                self.template(cross.params.as_ref());
            }
            ItemSyntaxKind::Suite(suite) => self.define("suite", &suite.name),
            ItemSyntaxKind::Part(part) => {
                self.define("part", &part.name);
                self.template(part.params.as_ref());
                self.world(&part.members);
            }
            ItemSyntaxKind::World(world) => self.world(&world.members),
            ItemSyntaxKind::Device(device) => self.device(device),
            ItemSyntaxKind::Test(test) => {
                if let Some(last) = test.name.names.last() {
                    self.define("test", last);
                }
            }
            ItemSyntaxKind::Instance(instance) => self.define(sort(instance.sort), &instance.name),
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
                StimulusStepKind::Sample { name, .. } => self.define("sample", name),
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
        self.define("agent", &agent.name);
        self.template(agent.params.as_ref());
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
                    self.define("belief", name);
                    self.params("parameter", params);
                    self.params("annotation", annotations);
                }
                AgentMember::GoalType { name, params } => {
                    self.define("goal", name);
                    self.params("parameter", params);
                }
                AgentMember::Plan(plan) => {
                    plan.label.iter().for_each(|label| self.define("plan label", &label.name));
                    // A goal that is not declared is what its first plan achieves.
                    let of = &plan.trigger.literal.call.name;
                    if plan.trigger.kind == ast::TriggerSyntaxKind::Achieve && goals.insert(&of.text) {
                        self.define("goal", of);
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
        self.define("automaton", &automaton.name);
        self.template(automaton.params.as_ref());
        for member in &automaton.members {
            (self.whole, self.doc) = (member.span, member.doc.clone());
            match &member.kind {
                AutomatonMember::Clock(clocks) => clocks.iter().for_each(|c| self.define("clock", c)),
                AutomatonMember::Var(var) => self.typed("variable", &var.name, written(&var.ty)),
                AutomatonMember::Location { name, .. } => self.define("location", name),
                AutomatonMember::Edge(edge) => self.params("variable", &edge.selects),
                AutomatonMember::Function(function) => self.function(function),
                AutomatonMember::Allow(_) | AutomatonMember::Error => {}
            }
        }
    }

    fn function(&mut self, function: &ast::FunctionSyntax) {
        let ty = function.result.as_ref().map_or(DefinedType::None, written);
        self.typed("function", &function.name, ty);
        self.params("parameter", &function.params);
        let doc = std::mem::take(&mut self.doc);
        self.statements(&function.body);
        self.doc = doc;
    }

    fn statements(&mut self, statements: &[ast::StatementSyntax]) {
        for statement in statements {
            match &statement.kind {
                StatementSyntaxKind::Var(var) => self.typed("variable", &var.name, written(&var.ty)),
                StatementSyntaxKind::If { then, otherwise, .. } => {
                    self.statements(then);
                    self.statements(otherwise);
                }
                StatementSyntaxKind::While { body, .. } => self.statements(body),
                StatementSyntaxKind::For { name, body, .. } => {
                    self.define("variable", name);
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
            let DeviceMemberKind::Command(command) = &member.kind else { continue };
            self.define("command", &command.name);
            let params: Vec<ast::ParamSyntax> = command.params.iter().map(|p| p.param.clone()).collect();
            self.params("parameter", &params);
        }
    }

    fn world(&mut self, members: &[ast::WorldMember]) {
        for member in members {
            (self.whole, self.doc) = (member.span, member.doc.clone());
            match &member.kind {
                WorldMemberKind::Part { name, .. } => self.define("part of the world", name),
                WorldMemberKind::Body(body) => self.define("body", &body.name),
                WorldMemberKind::Joint(joint) => self.define("joint", &joint.name),
                WorldMemberKind::Arm(arm) => self.define("arm", &arm.name),
                WorldMemberKind::Gripper(gripper) => self.define("gripper", &gripper.name),
                WorldMemberKind::Base(base) => self.define("base", &base.name),
                WorldMemberKind::Laser(laser) => self.define("laser", &laser.name),
                WorldMemberKind::Limb(limb) => self.define("limb", &limb.name),
                WorldMemberKind::Figure(figure) => self.define("figure", &figure.name),
                WorldMemberKind::Scanner { name, .. } => self.define("laser", name),
                WorldMemberKind::Walls(walls) => self.define("body", &walls.name),
                WorldMemberKind::Posture(posture) => self.define("posture", &posture.name),
                WorldMemberKind::Current { name, .. } => self.define("current body", name),
                WorldMemberKind::Signal { name, ty, .. } => self.typed("signal", name, written(ty)),
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

fn sort(of: ast::TemplateSyntaxKind) -> &'static str {
    match of {
        ast::TemplateSyntaxKind::Agent => "agent",
        ast::TemplateSyntaxKind::Automaton => "automaton",
        ast::TemplateSyntaxKind::Require => "requirement",
        ast::TemplateSyntaxKind::Cover => "coverpoint",
        ast::TemplateSyntaxKind::Cross => "cross product",
    }
}

/// Where a type is written.
pub(crate) fn type_span(ty: &TypeExpr) -> Span {
    match ty {
        TypeExpr::Named(name) => name.span,
        TypeExpr::Range(lo, hi) => lo.span.to(hi.span),
        TypeExpr::Array(of, size) => match of.as_ref() {
            TypeExpr::Error => size.span,
            of => type_span(of).to(size.span),
        },
        TypeExpr::List(of) => type_span(of),
        TypeExpr::Error => Span::default(),
    }
}
