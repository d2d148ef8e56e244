//! The names that a scenario declares, read off its syntax.

use std::collections::BTreeSet;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, AgentMemberKind as AgentMember, AutomatonMemberKind as AutomatonMember, DeviceMemberKind, ItemKind,
    Name, StatementKind, StimulusStepKind, TypeExpr, WorldMemberKind,
};

use super::{DefinedType, NameDefinition};
use crate::check::type_span;

/// The definitions of these items and of all in them.
pub(super) fn of_items(items: &[&ast::Item]) -> Vec<NameDefinition> {
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
    fn define(&mut self, noun: &'static str, name: &Name) {
        self.typed(noun, name, DefinedType::None);
    }

    fn typed(&mut self, noun: &'static str, name: &Name, ty: DefinedType) {
        let (text, doc) = (name.text.clone(), self.doc.clone());
        self.found.push(NameDefinition { noun, name: text, place: name.span, whole: self.whole, ty, doc });
    }

    /// Those of a declaration have its documentation no more.
    fn params(&mut self, noun: &'static str, params: &[ast::Param]) {
        let doc = std::mem::take(&mut self.doc);
        for param in params {
            self.typed(noun, &param.name, written(&param.ty));
        }
        self.doc = doc;
    }

    fn template(&mut self, params: Option<&Vec<ast::Param>>) {
        self.params("parameter", params.map_or(&[], Vec::as_slice));
    }

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn item(&mut self, kind: &ItemKind) {
        match kind {
            ItemKind::Enum { name, values } => {
                self.define("enumeration", name);
                values.iter().for_each(|value| self.define("value", value));
            }
            ItemKind::Record { name, fields } => {
                self.define("record", name);
                self.params("field", fields);
            }
            ItemKind::Actor { name, .. } => self.define("actor", name),
            ItemKind::Const { name, .. } => self.define("constant", name),
            ItemKind::Event(event) => {
                for one in &event.names {
                    self.define("event", &one.name);
                    self.params("parameter", &one.params);
                }
            }
            ItemKind::Stimulus(stimulus) => {
                self.define("stimulus", &stimulus.name);
                self.params("parameter", &stimulus.params);
                self.samples(&stimulus.body);
            }
            ItemKind::Agent(agent) => self.agent(agent),
            ItemKind::Var(var) => self.typed("variable", &var.name, written(&var.ty)),
            ItemKind::Automaton(automaton) => self.automaton(automaton),
            ItemKind::Channel(channel) => {
                for one in &channel.names {
                    self.define("channel", &one.name);
                    self.params("parameter", &one.params);
                }
            }
            ItemKind::Function(function) => self.function(function),
            ItemKind::Query(query) => self.define("query", &query.name),
            ItemKind::Network { name, .. } => self.define("network", name),
            ItemKind::Require(require) => {
                self.define("requirement", &require.name);
                self.template(require.params.as_ref());
            }
            ItemKind::Cover(cover) => {
                self.define("coverpoint", &cover.name);
                self.template(cover.params.as_ref());
                cover.bins.iter().for_each(|bin| self.define("bin", &bin.name));
            }
            ItemKind::Cross(cross) => {
                self.define("cross product", &cross.name);
                self.template(cross.params.as_ref());
            }
            ItemKind::Suite(suite) => self.define("suite", &suite.name),
            ItemKind::Part(part) => {
                self.define("part", &part.name);
                self.template(part.params.as_ref());
                self.world(&part.members);
            }
            ItemKind::World(world) => self.world(&world.members),
            ItemKind::Device(device) => self.device(device),
            ItemKind::Test(test) => {
                if let Some(last) = test.name.names.last() {
                    self.define("test", last);
                }
            }
            ItemKind::Instance(instance) => self.define(sort(instance.sort), &instance.name),
            ItemKind::Use(_)
            | ItemKind::Allow(_)
            | ItemKind::Assume(_)
            | ItemKind::System(_)
            | ItemKind::Error => {}
        }
    }

    fn samples(&mut self, steps: &[ast::StimulusStep]) {
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

    fn agent(&mut self, agent: &ast::Agent) {
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
                    if plan.trigger.kind == ast::TriggerKind::Achieve && goals.insert(&of.text) {
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

    fn automaton(&mut self, automaton: &ast::Automaton) {
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

    fn function(&mut self, function: &ast::Function) {
        let ty = function.result.as_ref().map_or(DefinedType::None, written);
        self.typed("function", &function.name, ty);
        self.params("parameter", &function.params);
        let doc = std::mem::take(&mut self.doc);
        self.statements(&function.body);
        self.doc = doc;
    }

    fn statements(&mut self, statements: &[ast::Statement]) {
        for statement in statements {
            match &statement.kind {
                StatementKind::Var(var) => self.typed("variable", &var.name, written(&var.ty)),
                StatementKind::If { then, otherwise, .. } => {
                    self.statements(then);
                    self.statements(otherwise);
                }
                StatementKind::While { body, .. } => self.statements(body),
                StatementKind::For { name, body, .. } => {
                    self.define("variable", name);
                    self.statements(body);
                }
                StatementKind::Assign { .. }
                | StatementKind::Call(_)
                | StatementKind::Return(_)
                | StatementKind::Error => {}
            }
        }
    }

    fn device(&mut self, device: &ast::Device) {
        for member in &device.members {
            (self.whole, self.doc) = (member.span, member.doc.clone());
            let DeviceMemberKind::Command(command) = &member.kind else { continue };
            self.define("command", &command.name);
            let params: Vec<ast::Param> = command.params.iter().map(|p| p.param.clone()).collect();
            self.params("parameter", &params);
        }
    }

    fn world(&mut self, members: &[ast::WorldMember]) {
        for member in members {
            (self.whole, self.doc) = (member.span, member.doc.clone());
            match &member.kind {
                WorldMemberKind::Part { name, .. } => self.define("part of the world", name),
                WorldMemberKind::Body(body) => self.define("body", &body.name),
                WorldMemberKind::Joint { name, .. } => self.define("joint", name),
                WorldMemberKind::Arm { name, .. } => self.define("arm", name),
                WorldMemberKind::Gripper { name, .. } => self.define("gripper", name),
                WorldMemberKind::Current { name, .. } => self.define("current body", name),
                WorldMemberKind::Signal { name, ty, .. } => self.typed("signal", name, written(ty)),
                WorldMemberKind::Step(_)
                | WorldMemberKind::Sample(_)
                | WorldMemberKind::Gravity(_)
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

fn sort(of: ast::Sort) -> &'static str {
    match of {
        ast::Sort::Agent => "agent",
        ast::Sort::Automaton => "automaton",
        ast::Sort::Require => "requirement",
        ast::Sort::Cover => "coverpoint",
        ast::Sort::Cross => "cross product",
    }
}
