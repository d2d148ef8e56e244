//! The members of agents, automata, suites, tests, systems, worlds and devices.

use crate::ast::{
    AccessSyntax, AgentMember, AgentMemberKind, AutomatonMember, AutomatonMemberKind, AutomatonSyntax,
    DeviceMember, DeviceMemberKind, EdgeActionKind, EdgeSyntax, FormulaSyntax, FunctionSyntax, JointSyntax,
    PlaceSyntax, PlanSyntax, QuerySyntax, RuleTriggerSyntax, SensorClause, StartSyntax, StatementSyntax,
    StatementSyntaxKind, StepSyntax, StepSyntaxKind, SuiteMemberKind, TestMember, TestMemberKind, TurnSyntax,
    VarSyntax, WorldMember, WorldMemberKind,
};
use crate::print::marks::{BlockKind, TokenMarker};
use crate::token::TokenKind;

impl TokenMarker<'_> {
    // ── Agents ──

    pub(super) fn agent_member(&mut self, member: &AgentMember) {
        self.start(member.span.start);
        match &member.kind {
            AgentMemberKind::Belief { name, params, annotations, initial, .. } => {
                self.params(name.span.end, params);
                if let Some(first) = annotations.first() {
                    let open = self.at(first.name.span.start).saturating_sub(1);
                    self.marks[open].apart = true;
                }
                annotations.iter().for_each(|p| self.param(p));
                initial.iter().for_each(|l| self.literal(l));
            }
            AgentMemberKind::Rule { head, body } => {
                self.literal(head);
                self.maybe(body.as_ref());
            }
            AgentMemberKind::GoalType { name, params } => self.params(name.span.end, params),
            AgentMemberKind::Goal(call) => self.call(call),
            AgentMemberKind::Plan(plan) => self.plan(plan),
            AgentMemberKind::Allow(_) | AgentMemberKind::Error => {}
        }
    }

    pub(super) fn plan(&mut self, plan: &PlanSyntax) {
        self.set(plan.trigger.span.start, |m| m.prefix = true);
        self.literal(&plan.trigger.literal);
        self.maybe(plan.context.as_ref());
        let header = plan.context.as_ref().map_or(plan.trigger.span.end, |c| c.span.end);
        self.block(header, BlockKind::Steps);
        plan.body.iter().for_each(|s| self.step(s));
    }

    pub(super) fn step(&mut self, step: &StepSyntax) {
        self.set(step.span.start, |m| {
            m.start = true;
            m.prefix = true;
        });
        self.step_kind(step);
    }

    fn step_kind(&mut self, step: &StepSyntax) {
        match &step.kind {
            StepSyntaxKind::Do(call) | StepSyntaxKind::Spawn(call) | StepSyntaxKind::Internal(call) => {
                self.call(call)
            }
            StepSyntaxKind::Achieve { call, within } => {
                self.call(call);
                self.maybe(within.as_ref());
            }
            StepSyntaxKind::Query(literal)
            | StepSyntaxKind::Add(literal)
            | StepSyntaxKind::Remove(literal)
            | StepSyntaxKind::Replace(literal) => self.literal(literal),
            StepSyntaxKind::Test(expr) | StepSyntaxKind::Wait(expr) => self.expr(expr),
            StepSyntaxKind::Unify { left, right } => {
                self.expr(left);
                self.expr(right);
            }
            StepSyntaxKind::Await { events, within } => {
                self.calls(events);
                self.maybe(within.as_ref());
            }
            StepSyntaxKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.block(condition.span.end, BlockKind::Steps);
                then.iter().for_each(|s| self.step(s));
                self.else_steps(step.span.end, otherwise);
            }
            StepSyntaxKind::While { condition, body } | StepSyntaxKind::For { condition, body } => {
                self.expr(condition);
                self.block(condition.span.end, BlockKind::Steps);
                body.iter().for_each(|s| self.step(s));
            }
            StepSyntaxKind::Fork { branches, .. } => {
                self.branches(step.span.start, branches.len());
                branches.iter().flatten().for_each(|s| self.step(s));
            }
            StepSyntaxKind::Error => {}
        }
    }

    /// What follows `else`: another choice, or a block that ends with the step.
    fn else_steps(&mut self, end: u32, steps: &[StepSyntax]) {
        if let [step] = steps
            && self.after_else(step.span.start)
        {
            return self.step_kind(step);
        }
        self.else_block(end, BlockKind::Steps);
        steps.iter().for_each(|s| self.step(s));
    }

    /// The blocks of a fork: each starts two tokens after the end of the one before.
    fn branches(&mut self, offset: u32, count: usize) {
        let mut open = self.at(offset) + 1;
        for _ in 0..count {
            let Some(mark) = self.marks.get_mut(open) else { return };
            mark.block = Some(BlockKind::Steps);
            let Some(close) = self.closing(open) else { return };
            open = close + 2;
        }
    }

    // ── Automata ──

    pub(super) fn var(&mut self, var: &VarSyntax) {
        self.ty(&var.ty);
        self.maybe(var.init.as_ref());
    }

    pub(super) fn automaton(&mut self, start: u32, automaton: &AutomatonSyntax) {
        self.block(start, BlockKind::Members);
        self.params(automaton.name.span.end, automaton.params.as_deref().unwrap_or_default());
        automaton.members.iter().for_each(|m| self.automaton_member(m));
    }

    pub(super) fn automaton_member(&mut self, member: &AutomatonMember) {
        self.start(member.span.start);
        match &member.kind {
            AutomatonMemberKind::Clock(_) | AutomatonMemberKind::Allow(_) | AutomatonMemberKind::Error => {}
            AutomatonMemberKind::Var(var) => self.var(var),
            AutomatonMemberKind::Location { name, invariant, .. } => {
                let after = self.at(name.span.end);
                if self
                    .tokens
                    .get(after)
                    .is_some_and(|t| t.kind == TokenKind::LBrace && t.start < member.span.end)
                {
                    self.marks[after].block = Some(BlockKind::Members);
                    if invariant.is_some() {
                        self.marks[after + 1].start = true;
                    }
                }
                self.maybe(invariant.as_ref());
            }
            AutomatonMemberKind::Edge(edge) => self.edge(edge),
            AutomatonMemberKind::Function(function) => self.function(function),
        }
    }

    pub(super) fn function(&mut self, function: &FunctionSyntax) {
        self.params(function.name.span.end, &function.params);
        if let Some(ty) = &function.result {
            self.ty(ty);
        }
        self.block(function.name.span.end, BlockKind::Steps);
        function.body.iter().for_each(|s| self.statement(s));
    }

    fn statement(&mut self, statement: &StatementSyntax) {
        self.set(statement.span.start, |m| m.start = true);
        self.statement_kind(statement);
    }

    fn statement_kind(&mut self, statement: &StatementSyntax) {
        match &statement.kind {
            StatementSyntaxKind::Var(var) => self.var(var),
            StatementSyntaxKind::Assign { access, value, .. } => {
                self.accesses(access);
                self.expr(value);
            }
            StatementSyntaxKind::Call(call) => self.call(call),
            StatementSyntaxKind::Return(value) => self.maybe(value.as_ref()),
            StatementSyntaxKind::Error => {}
            StatementSyntaxKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.block(condition.span.end, BlockKind::Steps);
                then.iter().for_each(|s| self.statement(s));
                self.else_statements(statement.span.end, otherwise);
            }
            StatementSyntaxKind::While { condition, body } => {
                self.expr(condition);
                self.block(condition.span.end, BlockKind::Steps);
                body.iter().for_each(|s| self.statement(s));
            }
            StatementSyntaxKind::For { range, body, .. } => {
                self.range(range);
                self.block(range.span.end, BlockKind::Steps);
                body.iter().for_each(|s| self.statement(s));
            }
        }
    }

    fn else_statements(&mut self, end: u32, statements: &[StatementSyntax]) {
        if let [statement] = statements
            && self.after_else(statement.span.start)
        {
            return self.statement_kind(statement);
        }
        self.else_block(end, BlockKind::Steps);
        statements.iter().for_each(|s| self.statement(s));
    }

    fn accesses(&mut self, access: &[AccessSyntax]) {
        for part in access {
            match part {
                AccessSyntax::Index(index) => self.expr(index),
                AccessSyntax::Field(_) => {}
            }
        }
    }

    pub(super) fn query(&mut self, query: &QuerySyntax) {
        match &query.ask {
            FormulaSyntax::Possibly(e)
            | FormulaSyntax::Invariantly(e)
            | FormulaSyntax::PotentiallyAlways(e)
            | FormulaSyntax::Eventually(e) => {
                self.expr(e);
            }
            FormulaSyntax::LeadsTo(e, f) => {
                self.expr(e);
                self.expr(f);
            }
            FormulaSyntax::Sup { when, of } | FormulaSyntax::Inf { when, of } => {
                self.maybe(when.as_ref());
                of.iter().for_each(|e| self.expr(e));
            }
        }
    }

    pub(super) fn edge(&mut self, edge: &EdgeSyntax) {
        edge.selects.iter().for_each(|p| self.param(p));
        self.maybe(edge.guard.as_ref());
        edge.on.iter().for_each(|c| self.call(c));
        for action in &edge.actions {
            self.set(action.span.start, |m| m.action = true);
            match &action.kind {
                EdgeActionKind::Send(call) => self.call(call),
                EdgeActionKind::Assign { access, value, .. } => {
                    self.accesses(access);
                    self.expr(value);
                }
            }
        }
    }

    // ── Suites, tests ──

    pub(super) fn suite_member(&mut self, kind: &SuiteMemberKind) {
        match kind {
            SuiteMemberKind::Setting { value, .. } => self.expr(value),
            SuiteMemberKind::Await(events) => self.calls(events),
            SuiteMemberKind::Explore(call) => self.call(call),
            SuiteMemberKind::Length(range) | SuiteMemberKind::Pause(range) => self.range(range),
            SuiteMemberKind::Choose { condition, .. } => self.maybe(condition.as_ref()),
            SuiteMemberKind::ReachEachOf { terms, when, .. } => {
                terms.iter().for_each(|term| self.expr(term));
                self.maybe(when.as_ref());
            }
            SuiteMemberKind::ReachEachBy { step, .. } => self.expr(step),
            SuiteMemberKind::Minimise
            | SuiteMemberKind::ReachEach(_)
            | SuiteMemberKind::ReachBins(_)
            | SuiteMemberKind::ReachLocations
            | SuiteMemberKind::ReachEdges
            | SuiteMemberKind::ReachOf { .. }
            | SuiteMemberKind::ReachQueries(_)
            | SuiteMemberKind::Witness(_)
            | SuiteMemberKind::Delays(_)
            | SuiteMemberKind::Stimuli(_)
            | SuiteMemberKind::Error => {}
        }
    }

    pub(super) fn test_member(&mut self, member: &TestMember) {
        self.start(member.span.start);
        match &member.kind {
            TestMemberKind::Seed(expr) | TestMemberKind::Wait(expr) => self.expr(expr),
            TestMemberKind::Do { call, with, .. } => {
                self.call(call);
                with.iter().for_each(|(_, value)| self.expr(value));
            }
            TestMemberKind::Await { events, within } => {
                self.calls(events);
                self.expr(within);
            }
            TestMemberKind::Script { members, .. } => {
                self.block(member.span.start, BlockKind::Members);
                members.iter().for_each(|m| self.test_member(m));
            }
            TestMemberKind::Method(_)
            | TestMemberKind::Because(_)
            | TestMemberKind::Predicts(_)
            | TestMemberKind::Error => {}
        }
    }

    // ── World ──

    fn joint(&mut self, joint: &JointSyntax) {
        self.expr(&joint.at);
        self.expr(&joint.axis);
        self.range(&joint.limits);
        for clause in [&joint.effort, &joint.speed, &joint.rotor, &joint.damping, &joint.friction] {
            self.maybe(clause.as_ref());
        }
        if let Some(mimic) = &joint.mimic {
            self.maybe(mimic.times.as_ref());
        }
    }

    fn place(&mut self, place: &PlaceSyntax, turn: Option<&TurnSyntax>) {
        self.maybe(place.at.as_ref());
        self.maybe(place.beside.as_ref().map(|beside| &beside.by));
        match turn {
            Some(TurnSyntax::Rotated(angles)) => self.expr(angles),
            Some(TurnSyntax::Facing(_)) | None => {}
        }
    }

    fn sensing(&mut self, clauses: &[SensorClause]) {
        for clause in clauses {
            clause.values.iter().for_each(|value| self.expr(value));
            if let Some(range) = &clause.range {
                self.range(range);
            }
        }
    }

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    pub(super) fn world_member(&mut self, member: &WorldMember) {
        self.start(member.span.start);
        match &member.kind {
            WorldMemberKind::Step(e) | WorldMemberKind::Sample(e) | WorldMemberKind::Gravity(e) => {
                self.expr(e)
            }
            WorldMemberKind::Part { of, args, place, turn, .. } => {
                self.args(of.span.end, args.as_deref().unwrap_or_default());
                self.place(place, turn.as_ref());
            }
            WorldMemberKind::Body(body) => {
                self.args(body.shape.span.end, &body.sizes);
                self.place(&body.place, body.turn.as_ref());
                self.maybe(body.mass.as_ref());
                self.maybe(body.stiffness.as_ref());
            }
            WorldMemberKind::Joint(joint) => self.joint(joint),
            WorldMemberKind::Arm(arm) => {
                self.expr(&arm.tool);
                self.expr(&arm.speed);
                self.maybe(arm.contact.as_ref());
                self.sensing(&arm.sensing);
            }
            WorldMemberKind::Gripper(gripper) => {
                self.expr(&gripper.tool);
                self.expr(&gripper.reach);
                self.expr(&gripper.delay);
                self.maybe(gripper.force.as_ref());
            }
            WorldMemberKind::Base(base) => {
                self.expr(&base.speed);
                self.maybe(base.sideways.as_ref());
                self.expr(&base.turn);
                self.expr(&base.acceleration);
                self.maybe(base.timeout.as_ref());
                self.sensing(&base.sensing);
            }
            WorldMemberKind::Limb(limb) => limb.pivots.iter().for_each(|pivot| self.expr(pivot)),
            WorldMemberKind::Figure(figure) => {
                for clause in [&figure.hip, &figure.speed, &figure.turn, &figure.mass] {
                    self.expr(clause);
                }
            }
            WorldMemberKind::Laser(laser) => {
                self.expr(&laser.at);
                self.range(&laser.angles);
                self.expr(&laser.beams);
                self.range(&laser.range);
                self.sensing(&laser.sensing);
            }
            WorldMemberKind::Posture(posture) => self.expr(&posture.angles),
            WorldMemberKind::Start(values) => {
                for value in values {
                    if let StartSyntax::Joint { value, .. } = value {
                        self.expr(value);
                    }
                }
            }
            WorldMemberKind::Walls(walls) => {
                self.expr(&walls.height);
                self.expr(&walls.at);
                self.maybe(walls.rotated.as_ref());
            }
            WorldMemberKind::Signal { ty, value, sensing, .. } => {
                self.ty(ty);
                self.expr(value);
                self.sensing(sensing);
            }
            WorldMemberKind::Rule(rule) => {
                match &rule.on {
                    RuleTriggerSyntax::Event(call) => self.call(call),
                    RuleTriggerSyntax::Commanded { .. } => {}
                }
                self.maybe(rule.when.as_ref());
                self.call(&rule.emit);
            }
            WorldMemberKind::Scanner { .. }
            | WorldMemberKind::Robot(_)
            | WorldMemberKind::Packages(_)
            | WorldMemberKind::Argument { .. }
            | WorldMemberKind::Semantics(_)
            | WorldMemberKind::Current { .. }
            | WorldMemberKind::Allow(_)
            | WorldMemberKind::Error => {}
        }
    }

    pub(super) fn device_member(&mut self, member: &DeviceMember) {
        self.start(member.span.start);
        match &member.kind {
            DeviceMemberKind::Command(command) => {
                self.call_after(command.name.span.end);
                command.params.iter().for_each(|p| self.param(&p.param));
            }
            DeviceMemberKind::State(_) | DeviceMemberKind::Error => {}
        }
    }
}
