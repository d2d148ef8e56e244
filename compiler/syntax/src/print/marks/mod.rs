//! What the tree knows of single tokens, and the tokens alone do not tell: declarations and stimuli here, other members in
//! `members`, what they are made of in `terms`.

mod members;
mod terms;

use crate::ast::{
    Cover, CrossMemberKind, Event, File, Item, ItemKind, PatternKind, Require, SampleRange, Stimulus,
    StimulusStep, StimulusStepKind,
};
use crate::token::{Kind, Lexeme};

/// What stands in a block, and what separates it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::print) enum BlockKind {
    /// Members; a semicolon only between two of one line.
    Members,
    /// The steps of a plan, with semicolons between them.
    Steps,
    /// The values or fields of a type, with commas.
    List,
}

/// What is known of a token.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::print) struct Mark {
    /// Starts a declaration, a member, a step, an element of a block.
    pub start: bool,
    /// Starts an action of an edge.
    pub action: bool,
    /// Starts the pattern of a requirement.
    pub pattern: bool,
    /// A parenthesis that belongs to the name before it.
    pub call: bool,
    /// A square bracket that does not belong to what is before it.
    pub apart: bool,
    /// A sign that belongs to what follows.
    pub prefix: bool,
    /// `..` between two small operands.
    pub tight: bool,
    /// A brace that opens a block.
    pub block: Option<BlockKind>,
}

/// One mark for each token of a text without faults.
pub(in crate::print) fn marks(file: &File, tokens: &[Lexeme]) -> Vec<Mark> {
    let mut marker = Marker { tokens, marks: vec![Mark::default(); tokens.len()] };
    if let (Some(_), Some(first)) = (&file.scenario, marker.marks.first_mut()) {
        first.start = true;
    }
    file.items.iter().for_each(|item| marker.item(item));
    marker.marks
}

struct Marker<'t> {
    tokens: &'t [Lexeme],
    marks: Vec<Mark>,
}

impl Marker<'_> {
    /// The first token that starts here or later.
    fn at(&self, offset: u32) -> usize {
        self.tokens.partition_point(|t| t.start < offset)
    }

    fn set(&mut self, offset: u32, mark: impl FnOnce(&mut Mark)) {
        let at = self.at(offset);
        if let Some(found) = self.marks.get_mut(at) {
            mark(found);
        }
    }

    fn start(&mut self, offset: u32) {
        self.set(offset, |m| m.start = true);
    }

    /// The parenthesis right after a name.
    fn call_after(&mut self, end: u32) {
        let at = self.at(end);
        if self.tokens.get(at).is_some_and(|t| t.kind == Kind::LParen) {
            self.marks[at].call = true;
        }
    }

    /// The first brace from here on, outside parentheses.
    fn block(&mut self, offset: u32, kind: BlockKind) {
        let mut depth = 0_usize;
        for at in self.at(offset)..self.tokens.len() {
            match self.tokens[at].kind {
                Kind::LParen => depth += 1,
                Kind::RParen => depth = depth.saturating_sub(1),
                Kind::LBrace if depth == 0 => {
                    self.marks[at].block = Some(kind);
                    return;
                }
                _ => {}
            }
        }
    }

    // ── Declarations ──

    fn item(&mut self, item: &Item) {
        let start = item.span.start;
        self.start(start);
        match &item.kind {
            ItemKind::Use(_)
            | ItemKind::Allow(_)
            | ItemKind::Actor { .. }
            | ItemKind::Network { .. }
            | ItemKind::Error => {}
            ItemKind::Enum { values, .. } => {
                self.block(start, BlockKind::List);
                values.iter().for_each(|v| self.start(v.span.start));
            }
            ItemKind::Record { fields, .. } => {
                self.block(start, BlockKind::List);
                for field in fields {
                    self.start(field.name.span.start);
                    self.param(field);
                }
            }
            ItemKind::Const { value, .. } => self.expr(value),
            ItemKind::Event(event) => self.event(event),
            ItemKind::Stimulus(stimulus) => self.stimulus(start, stimulus),
            ItemKind::Agent(agent) => {
                self.block(start, BlockKind::Members);
                self.params(agent.name.span.end, agent.params.as_deref().unwrap_or_default());
                agent.members.iter().for_each(|m| self.agent_member(m));
            }
            ItemKind::Var(var) => self.var(var),
            ItemKind::Automaton(automaton) => self.automaton(start, automaton),
            ItemKind::Channel(channel) => {
                channel.names.iter().for_each(|name| self.params(name.name.span.end, &name.params));
            }
            ItemKind::Function(function) => self.function(function),
            ItemKind::Query(query) => self.query(query),
            ItemKind::Require(require) => self.require(require),
            ItemKind::Assume(assume) => {
                self.expr(&assume.at_most);
                self.calls(&assume.events);
                self.maybe(assume.within.as_ref());
            }
            ItemKind::Cover(cover) => self.cover(cover),
            ItemKind::Instance(instance) => self.args(instance.of.span.end, &instance.args),
            ItemKind::Cross(_)
            | ItemKind::Suite(_)
            | ItemKind::Part(_)
            | ItemKind::Device(_)
            | ItemKind::World(_)
            | ItemKind::System(_)
            | ItemKind::Test(_) => {
                self.block(start, BlockKind::Members);
                self.simple_members(&item.kind);
            }
        }
    }

    /// The members of the declarations that hold nothing but one line each.
    fn simple_members(&mut self, kind: &ItemKind) {
        if let ItemKind::Cross(cross) = kind {
            self.params(cross.name.span.end, cross.params.as_deref().unwrap_or_default());
            for member in &cross.members {
                self.start(member.span.start);
                self.cross_member(&member.kind);
            }
        }
        if let ItemKind::Suite(suite) = kind {
            for member in &suite.members {
                self.start(member.span.start);
                self.suite_member(&member.kind);
            }
        }
        if let ItemKind::Part(part) = kind {
            self.params(part.name.span.end, part.params.as_deref().unwrap_or_default());
            part.members.iter().for_each(|m| self.world_member(m));
        }
        if let ItemKind::Device(device) = kind {
            device.members.iter().for_each(|m| self.device_member(m));
        }
        if let ItemKind::World(world) = kind {
            world.members.iter().for_each(|m| self.world_member(m));
        }
        if let ItemKind::System(system) = kind {
            for member in &system.members {
                self.start(member.span.start);
                self.system_member(&member.kind);
            }
        }
        if let ItemKind::Test(test) = kind {
            for member in &test.members {
                self.start(member.span.start);
                self.test_member(&member.kind);
            }
        }
    }

    fn event(&mut self, event: &Event) {
        for name in &event.names {
            self.params(name.name.span.end, &name.params);
        }
    }

    fn require(&mut self, require: &Require) {
        self.params(require.name.span.end, require.params.as_deref().unwrap_or_default());
        self.set(require.pattern.span.start, |m| m.pattern = true);
        match &require.pattern.kind {
            PatternKind::Causes { trigger, response, within } => {
                self.calls(trigger);
                self.calls(response);
                self.maybe(within.as_ref());
            }
            PatternKind::Forbids { trigger, forbidden, until } => {
                self.calls(trigger);
                self.calls(forbidden);
                self.calls(until);
            }
            PatternKind::NeverWhile { events, condition } => {
                self.calls(events);
                self.maybe(condition.as_ref());
            }
            PatternKind::Globally(expr) => self.expr(expr),
            PatternKind::Error => {}
        }
    }

    fn cover(&mut self, cover: &Cover) {
        self.params(cover.name.span.end, cover.params.as_deref().unwrap_or_default());
        if let Some(first) = cover.count.first() {
            let before = self.at(first.span.start).saturating_sub(1);
            self.marks[before].call = true;
        }
        self.calls(&cover.count);
        for bin in &cover.bins {
            self.range_of(&bin.lo, bin.hi.as_ref(), bin.open);
        }
    }

    fn cross_member(&mut self, kind: &CrossMemberKind) {
        match kind {
            CrossMemberKind::Bin { when, .. } | CrossMemberKind::Ignore { when } => self.expr(when),
            CrossMemberKind::Allow(_) | CrossMemberKind::Error => {}
        }
    }

    // ── Stimuli ──

    fn stimulus(&mut self, start: u32, stimulus: &Stimulus) {
        self.block(start, BlockKind::Members);
        self.params(stimulus.name.span.end, &stimulus.params);
        stimulus.body.iter().for_each(|s| self.stimulus_step(s));
    }

    fn stimulus_step(&mut self, step: &StimulusStep) {
        self.start(step.span.start);
        self.stimulus_kind(step);
    }

    fn stimulus_kind(&mut self, step: &StimulusStep) {
        match &step.kind {
            StimulusStepKind::Sample { range, .. } => self.sample(range),
            StimulusStepKind::Emit(call) => self.call(call),
            StimulusStepKind::Hold(expr) => self.expr(expr),
            StimulusStepKind::Act { path, args } => self.args(path.span.end, args),
            StimulusStepKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.block(condition.span.end, BlockKind::Members);
                then.iter().for_each(|s| self.stimulus_step(s));
                self.otherwise(step.span.end, otherwise);
            }
            StimulusStepKind::Error => {}
        }
    }

    /// What follows `else`: another choice, or a block that ends with the step.
    fn otherwise(&mut self, end: u32, steps: &[StimulusStep]) {
        if let [step] = steps
            && self.after_else(step.span.start)
        {
            return self.stimulus_kind(step);
        }
        self.else_block(end, BlockKind::Members);
        steps.iter().for_each(|s| self.stimulus_step(s));
    }

    fn after_else(&self, offset: u32) -> bool {
        self.at(offset).checked_sub(1).is_some_and(|at| self.tokens[at].kind == Kind::Else)
    }

    /// The block after `else` that ends here, if there is one.
    fn else_block(&mut self, end: u32, kind: BlockKind) {
        let last = self.at(end).saturating_sub(1);
        if let Some(open) = self.opening(last)
            && open > 0
            && self.tokens[open - 1].kind == Kind::Else
        {
            self.marks[open].block = Some(kind);
        }
    }

    /// The brace that the brace at `close` closes.
    fn opening(&self, close: usize) -> Option<usize> {
        let mut depth = 0_usize;
        for at in (0..=close).rev() {
            match self.tokens[at].kind {
                Kind::RBrace => depth += 1,
                Kind::LBrace => {
                    depth = depth.checked_sub(1)?;
                    if depth == 0 {
                        return Some(at);
                    }
                }
                _ => {}
            }
        }
        None
    }

    /// The brace that closes the brace at `open`.
    fn closing(&self, open: usize) -> Option<usize> {
        let mut depth = 0_usize;
        for (at, token) in self.tokens.iter().enumerate().skip(open) {
            match token.kind {
                Kind::LBrace => depth += 1,
                Kind::RBrace => {
                    depth = depth.checked_sub(1)?;
                    if depth == 0 {
                        return Some(at);
                    }
                }
                _ => {}
            }
        }
        None
    }

    fn sample(&mut self, range: &SampleRange) {
        match range {
            SampleRange::Plain(range) => self.range(range),
            SampleRange::If { condition, then, otherwise } => {
                self.expr(condition);
                self.sample(then);
                self.sample(otherwise);
            }
        }
    }
}
