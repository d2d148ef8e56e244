//! What the tree knows of single tokens, and the tokens alone do not tell: declarations and stimuli here, other members in
//! `members`, what they are made of in `terms`.

mod bindings;
mod members;
mod terms;

use crate::ast::{
    CoverSyntax, CrossMemberKind, EventSyntax, FileSyntax, ItemSyntax, ItemSyntaxKind, RequireSyntax,
    SampleRange, StimulusStepKind, StimulusStepSyntax, StimulusSyntax,
};
use crate::token::{Lexeme, TokenKind};

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
pub(in crate::print) struct TokenMark {
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
    /// `..` between two small operands; `/` in the name of a ROS interface.
    pub tight: bool,
    /// A brace that opens a block.
    pub block: Option<BlockKind>,
}

/// One mark for each token of a text without faults.
pub(in crate::print) fn marks(file: &FileSyntax, tokens: &[Lexeme]) -> Vec<TokenMark> {
    let mut marker = TokenMarker { tokens, marks: vec![TokenMark::default(); tokens.len()] };
    if let (Some(_), Some(first)) = (&file.scenario, marker.marks.first_mut()) {
        first.start = true;
    }
    file.items.iter().for_each(|item| marker.item(item));
    marker.marks
}

struct TokenMarker<'t> {
    tokens: &'t [Lexeme],
    marks: Vec<TokenMark>,
}

impl TokenMarker<'_> {
    /// The first token that starts here or later.
    fn at(&self, offset: u32) -> usize {
        self.tokens.partition_point(|t| t.start < offset)
    }

    fn set(&mut self, offset: u32, mark: impl FnOnce(&mut TokenMark)) {
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
        if self.tokens.get(at).is_some_and(|t| t.kind == TokenKind::LParen) {
            self.marks[at].call = true;
        }
    }

    /// The first brace from here on, outside parentheses.
    fn block(&mut self, offset: u32, kind: BlockKind) {
        let mut depth = 0_usize;
        for at in self.at(offset)..self.tokens.len() {
            match self.tokens[at].kind {
                TokenKind::LParen => depth += 1,
                TokenKind::RParen => depth = depth.saturating_sub(1),
                TokenKind::LBrace if depth == 0 => {
                    self.marks[at].block = Some(kind);
                    return;
                }
                _ => {}
            }
        }
    }

    // ── Declarations ──

    fn item(&mut self, item: &ItemSyntax) {
        let start = item.span.start;
        self.start(start);
        match &item.kind {
            ItemSyntaxKind::Use(_)
            | ItemSyntaxKind::Allow(_)
            | ItemSyntaxKind::Actor { .. }
            | ItemSyntaxKind::Network { .. }
            | ItemSyntaxKind::Error => {}
            ItemSyntaxKind::Enum { values, .. } => {
                self.block(start, BlockKind::List);
                values.iter().for_each(|v| self.start(v.span.start));
            }
            ItemSyntaxKind::Record { fields, .. } => {
                self.block(start, BlockKind::List);
                for field in fields {
                    self.start(field.name.span.start);
                    self.param(field);
                }
            }
            ItemSyntaxKind::Const { value, .. } => self.expr(value),
            ItemSyntaxKind::Event(event) => self.event(event),
            ItemSyntaxKind::Stimulus(stimulus) => self.stimulus(start, stimulus),
            ItemSyntaxKind::Agent(agent) => {
                self.block(start, BlockKind::Members);
                self.params(agent.name.span.end, agent.params.as_deref().unwrap_or_default());
                agent.members.iter().for_each(|m| self.agent_member(m));
            }
            ItemSyntaxKind::Var(var) => self.var(var),
            ItemSyntaxKind::Automaton(automaton) => self.automaton(start, automaton),
            ItemSyntaxKind::Channel(channel) => {
                channel.names.iter().for_each(|name| self.params(name.name.span.end, &name.params));
            }
            ItemSyntaxKind::Function(function) => self.function(function),
            ItemSyntaxKind::Query(query) => self.query(query),
            ItemSyntaxKind::Require(require) => self.require(require),
            ItemSyntaxKind::Assume(assume) => {
                self.expr(&assume.at_most);
                self.calls(&assume.events);
                self.maybe(assume.within.as_ref());
            }
            ItemSyntaxKind::Cover(cover) => self.cover(cover),
            ItemSyntaxKind::Instance(instance) => self.args(instance.of.span.end, &instance.args),
            ItemSyntaxKind::Cross(_)
            | ItemSyntaxKind::Suite(_)
            | ItemSyntaxKind::Part(_)
            | ItemSyntaxKind::Device(_)
            | ItemSyntaxKind::World(_)
            | ItemSyntaxKind::System(_)
            | ItemSyntaxKind::Test(_) => {
                self.block(start, BlockKind::Members);
                self.simple_members(&item.kind);
            }
        }
    }

    /// The members of the declarations that hold nothing but one line each.
    fn simple_members(&mut self, kind: &ItemSyntaxKind) {
        if let ItemSyntaxKind::Cross(cross) = kind {
            self.params(cross.name.span.end, cross.params.as_deref().unwrap_or_default());
            for member in &cross.members {
                self.start(member.span.start);
                self.cross_member(&member.kind);
            }
        }
        if let ItemSyntaxKind::Suite(suite) = kind {
            for member in &suite.members {
                self.start(member.span.start);
                self.suite_member(&member.kind);
            }
        }
        if let ItemSyntaxKind::Part(part) = kind {
            self.params(part.name.span.end, part.params.as_deref().unwrap_or_default());
            part.members.iter().for_each(|m| self.world_member(m));
        }
        if let ItemSyntaxKind::Device(device) = kind {
            device.members.iter().for_each(|m| self.device_member(m));
        }
        if let ItemSyntaxKind::World(world) = kind {
            world.members.iter().for_each(|m| self.world_member(m));
        }
        if let ItemSyntaxKind::System(system) = kind {
            system.members.iter().for_each(|m| self.system_member(m));
        }
        if let ItemSyntaxKind::Test(test) = kind {
            test.members.iter().for_each(|m| self.test_member(m));
        }
    }

    fn event(&mut self, event: &EventSyntax) {
        for name in &event.names {
            self.params(name.name.span.end, &name.params);
        }
    }

    fn require(&mut self, require: &RequireSyntax) {
        self.params(require.name.span.end, require.params.as_deref().unwrap_or_default());
        self.set(require.pattern.span.start, |m| m.pattern = true);
        let Some(pattern) = &require.pattern.kind else { return };
        pattern.events().for_each(|e| self.call(e));
        let parts = pattern.conditions().chain(pattern.times()).chain(pattern.count());
        parts.for_each(|e| self.expr(e));
    }

    fn cover(&mut self, cover: &CoverSyntax) {
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

    fn stimulus(&mut self, start: u32, stimulus: &StimulusSyntax) {
        self.block(start, BlockKind::Members);
        self.params(stimulus.name.span.end, &stimulus.params);
        stimulus.body.iter().for_each(|s| self.stimulus_step(s));
    }

    fn stimulus_step(&mut self, step: &StimulusStepSyntax) {
        self.start(step.span.start);
        self.stimulus_kind(step);
    }

    fn stimulus_kind(&mut self, step: &StimulusStepSyntax) {
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
    fn otherwise(&mut self, end: u32, steps: &[StimulusStepSyntax]) {
        if let [step] = steps
            && self.after_else(step.span.start)
        {
            return self.stimulus_kind(step);
        }
        self.else_block(end, BlockKind::Members);
        steps.iter().for_each(|s| self.stimulus_step(s));
    }

    fn after_else(&self, offset: u32) -> bool {
        self.at(offset).checked_sub(1).is_some_and(|at| self.tokens[at].kind == TokenKind::Else)
    }

    /// The block after `else` that ends here, if there is one.
    fn else_block(&mut self, end: u32, kind: BlockKind) {
        let last = self.at(end).saturating_sub(1);
        if let Some(open) = self.opening(last)
            && open > 0
            && self.tokens[open - 1].kind == TokenKind::Else
        {
            self.marks[open].block = Some(kind);
        }
    }

    /// The brace that the brace at `close` closes.
    fn opening(&self, close: usize) -> Option<usize> {
        let mut depth = 0_usize;
        for at in (0..=close).rev() {
            match self.tokens[at].kind {
                TokenKind::RBrace => depth += 1,
                TokenKind::LBrace => {
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
                TokenKind::LBrace => depth += 1,
                TokenKind::RBrace => {
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
