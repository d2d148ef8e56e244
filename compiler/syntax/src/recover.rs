//! A declaration that does not fit, read again member by member, so that a fault costs one member or one step.
//!
//! The grammar itself says where a member ends: the first token that cannot belong to it. Only after a broken member the
//! next one is looked for by its keyword.

mod nested;
mod statements;
mod steps;

use std::ops::Range;

use hrdsl_source::Span;

use crate::ast::{
    AgentMember, AgentMemberKind, AutomatonMember, AutomatonMemberKind, BindingEntry, BindingEntryKind,
    BindingMember, BindingMemberKind, CrossMember, CrossMemberKind, DeviceMember, DeviceMemberKind,
    ExprSyntax, ExprSyntaxKind, ItemSyntaxKind, PlanSyntax, StimulusStepKind, StimulusStepSyntax,
    SuiteMember, SuiteMemberKind, SystemMember, SystemMemberKind, TestMember, TestMemberKind, WorldMember,
    WorldMemberKind,
};
use crate::context::{ParseContext, ParsedUnit};
use crate::run::run;
use crate::token::{Lexeme, TokenKind, TokenTrait};
use crate::{expected::ParseFault, report::report};

pub(crate) struct RecoveringParser<'a, 't> {
    pub cx: &'a mut ParseContext<'t>,
    /// All tokens of the file.
    pub tokens: &'a [Lexeme],
}

/// What the members of a block are.
trait BlockMember: Sized {
    const START: TokenKind;
    fn of(unit: ParsedUnit) -> Option<Self>;
    fn broken(doc: String, span: Span) -> Self;
    /// A token that starts a member of this sort.
    fn starts(kind: TokenKind) -> bool;
}

impl RecoveringParser<'_, '_> {
    /// Reads what can be read of a declaration; there is a diagnostic afterwards.
    pub(crate) fn item(&mut self, range: Range<usize>, fault: &ParseFault) -> ItemSyntaxKind {
        let said = self.cx.diagnostics.len();
        let erroneous = self.tokens[range.clone()].iter().any(|t| t.kind == TokenKind::Error);
        let kind = match self.block(&range) {
            Some((open, close)) => self.with_block(range.start, open, close),
            None => {
                self.report(fault, range.clone());
                self.without_block(&range, fault)
            }
        };
        if self.cx.diagnostics.len() == said && !erroneous {
            self.report(fault, range);
        }
        kind
    }

    fn report(&mut self, fault: &ParseFault, range: Range<usize>) {
        let next = self.tokens.get(range.end).copied();
        report(self.cx, fault, &self.tokens[range], next);
    }

    /// From the first token to the last that is not a semicolon.
    fn span(&self, range: &Range<usize>) -> Span {
        let mut run = &self.tokens[range.clone()];
        while let [rest @ .., last] = run
            && last.kind == TokenKind::Semi
        {
            run = rest;
        }
        let (start, end) = (run.first().map_or(0, |t| t.start), run.last().map_or(0, |t| t.end));
        self.cx.span(start, end)
    }

    // ── Declarations ──

    /// The braces of the declaration's block.
    fn block(&self, range: &Range<usize>) -> Option<(usize, usize)> {
        if !self.tokens[range.start].kind.has_block() {
            return None;
        }
        let open = range.clone().find(|i| self.tokens[*i].kind == TokenKind::LBrace)?;
        let close = range.end - 1;
        (self.tokens[close].kind == TokenKind::RBrace && close > open).then_some((open, close))
    }

    fn with_block(&mut self, start: usize, open: usize, close: usize) -> ItemSyntaxKind {
        let shell = self.shell(start, &[(open, close)]);
        let mut kind = match run(self.cx, None, &shell) {
            Ok(ParsedUnit::Item(kind)) => kind,
            Ok(_) => ItemSyntaxKind::Error,
            Err(fault) => {
                report(self.cx, &fault, &shell, None);
                ItemSyntaxKind::Error
            }
        };
        let block = open + 1..close;
        // INVARIANT: a header that could not be read still has its members looked at, for their faults.
        match (&mut kind, self.tokens[start].kind) {
            (ItemSyntaxKind::Stimulus(item), _) => item.body = self.members(block),
            (ItemSyntaxKind::Agent(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::Automaton(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::Cross(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::Suite(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::Test(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::Part(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::Device(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::World(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::System(item), _) => item.members = self.members(block),
            (ItemSyntaxKind::Function(item), _) => item.body = self.statements(block),
            // Of a list with a fault nothing is kept: its names would be said to be unknown.
            (ItemSyntaxKind::Enum { .. } | ItemSyntaxKind::Record { .. }, _) => kind = ItemSyntaxKind::Error,
            (_, TokenKind::Stimulus) => drop(self.members::<StimulusStepSyntax>(block)),
            (_, TokenKind::Fn) => drop(self.statements(block)),
            (_, TokenKind::Agent) => drop(self.members::<AgentMember>(block)),
            (_, TokenKind::Automaton) => drop(self.members::<AutomatonMember>(block)),
            (_, TokenKind::Cross) => drop(self.members::<CrossMember>(block)),
            (_, TokenKind::Suite) => drop(self.members::<SuiteMember>(block)),
            (_, TokenKind::Test) => drop(self.members::<TestMember>(block)),
            (_, TokenKind::Part | TokenKind::World) => drop(self.members::<WorldMember>(block)),
            (_, TokenKind::Device) => drop(self.members::<DeviceMember>(block)),
            (_, TokenKind::System) => drop(self.members::<SystemMember>(block)),
            (_, _) => {}
        }
        kind
    }

    /// The tokens from `start`, with these blocks, up to the last, empty.
    fn shell(&self, start: usize, blocks: &[(usize, usize)]) -> Vec<Lexeme> {
        let mut shell = Vec::new();
        let mut from = start;
        for (open, close) in blocks {
            shell.extend_from_slice(&self.tokens[from..=*open]);
            from = *close;
        }
        shell.extend(self.tokens.get(from));
        shell
    }

    /// Keeps what is complete before the fault, and the name of a constant or requirement whose rest is broken: other
    /// declarations use them.
    fn without_block(&mut self, range: &Range<usize>, fault: &ParseFault) -> ItemSyntaxKind {
        if fault.complete()
            && let Ok(ParsedUnit::Item(kind)) =
                run(self.cx, None, &self.tokens[range.start..range.start + fault.at])
        {
            return kind;
        }
        let text = &self.tokens[range.clone()];
        match text {
            [head, name, assign, ..]
                if head.kind == TokenKind::Const
                    && name.kind.can_be_name()
                    && assign.kind == TokenKind::Assign =>
            {
                let span = self.span(&(range.start + 3..range.end));
                let value = ExprSyntax { kind: ExprSyntaxKind::Error, span };
                ItemSyntaxKind::Const { name: self.cx.name(*name), value }
            }
            [head, name, kind, rest @ ..]
                if head.kind == TokenKind::Require && name.kind.can_be_name() && kind.kind.can_be_name() =>
            {
                let header = 3 + usize::from(rest.first().is_some_and(|t| t.kind == TokenKind::Str));
                if fault.at < header {
                    return ItemSyntaxKind::Error;
                }
                let mut shell = text[..header].to_vec();
                let span = self.span(&(range.start + header..range.end));
                shell.push(Lexeme { end: span.end, ..Lexeme::synthetic(TokenKind::Error, span.start) });
                match run(self.cx, None, &shell) {
                    Ok(ParsedUnit::Item(kind)) => kind,
                    Ok(_) | Err(_) => ItemSyntaxKind::Error,
                }
            }
            _ => ItemSyntaxKind::Error,
        }
    }

    // ── Members ──

    fn members<M: BlockMember>(&mut self, block: Range<usize>) -> Vec<M> {
        let mut members = Vec::new();
        let mut at = block.start;
        while at < block.end {
            if self.tokens[at].kind == TokenKind::Semi {
                at += 1;
                continue;
            }
            match run(self.cx, Some(M::START), &self.tokens[at..block.end]) {
                Ok(unit) => {
                    members.extend(M::of(unit));
                    break;
                }
                Err(fault) => at = self.part::<M>(at, block.end, fault, &mut members),
            }
        }
        members
    }

    /// Takes the member at `at`, which more text follows, and gives where the next one starts.
    fn part<M: BlockMember>(
        &mut self,
        at: usize,
        end: usize,
        mut fault: ParseFault,
        members: &mut Vec<M>,
    ) -> usize {
        let stop = at + fault.at;
        let member = M::START == TokenKind::StartAgentMember && stop > at && stop < end && fault.complete();
        if member
            && self.is_full_stop(stop)
            && let Ok(unit) = run(self.cx, Some(M::START), &self.tokens[at..stop])
        {
            members.extend(M::of(unit));
            self.full_stop(stop);
            return stop + 1;
        }
        if stop > at && fault.complete() && self.can_start::<M>(stop) {
            if let Ok(unit) = run(self.cx, Some(M::START), &self.tokens[at..stop]) {
                members.extend(M::of(unit));
                return stop;
            }
        } else if stop > at + 1 && self.tokens[stop - 1].first && M::starts(self.tokens[stop - 1].kind) {
            // A keyword on a new line was taken for a name that is missing before it, as in `emit` / `hold 5 s`.
            match run(self.cx, Some(M::START), &self.tokens[at..stop - 1]) {
                Ok(unit) => {
                    members.extend(M::of(unit));
                    return stop - 1;
                }
                Err(before) if at + before.at == stop - 1 => fault = before,
                Err(_) => {}
            }
        }
        let next = self.resume::<M>(at, at + fault.at, end);
        members.push(self.broken::<M>(at..next, end, &fault));
        next
    }

    /// After a complete member: a new one, or what was meant to be one.
    fn can_start<M: BlockMember>(&self, at: usize) -> bool {
        self.tokens[at - 1].kind == TokenKind::Semi
            || self.tokens.get(at).is_some_and(|t| t.first || t.kind == TokenKind::Semi || M::starts(t.kind))
    }

    /// Where the next member starts after a broken one that starts at `at` and stops to fit at `stop`.
    fn resume<M: BlockMember>(&self, at: usize, stop: usize, end: usize) -> usize {
        let mut depth = 0_usize;
        for i in at..end {
            let token = self.tokens[i];
            if i > at && i >= stop && depth == 0 && M::starts(token.kind) {
                let before = self.tokens[i - 1].kind;
                let keyword = !matches!(token.kind, TokenKind::Ident) && before != TokenKind::RBrace;
                let fresh = token.first && !before.continues();
                let apart = keyword && before.ends_operand() && before.class().is_none();
                if before == TokenKind::Semi || before == TokenKind::RBrace || fresh || apart {
                    return i;
                }
            }
            match token.kind {
                TokenKind::LBrace => depth += 1,
                TokenKind::RBrace => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
        end
    }

    /// A member that does not fit: of plans and conditions the blocks are read, of others nothing.
    fn broken<M: BlockMember>(&mut self, range: Range<usize>, end: usize, fault: &ParseFault) -> M {
        let said = self.cx.diagnostics.len();
        let unit = match self.tokens[range.start].kind {
            TokenKind::Plan if M::START == TokenKind::StartAgentMember => self.plan(&range),
            TokenKind::Fn if M::START == TokenKind::StartAutomatonMember => self.function(&range),
            TokenKind::If if M::START == TokenKind::StartStimulusStep => self.condition(&range),
            _ if matches!(
                M::START,
                TokenKind::StartSystemMember | TokenKind::StartBindingMember | TokenKind::StartTestMember
            ) =>
            {
                self.nested(M::START, &range)
            }
            _ => None,
        };
        if self.cx.diagnostics.len() == said {
            let next = self.tokens.get(range.end.max(end.min(range.start + fault.at))).copied();
            self.report_member::<M>(fault, &range, next);
        }
        unit.and_then(M::of).unwrap_or_else(|| {
            let start = self.tokens[range.start].start;
            M::broken(self.cx.doc(start), self.span(&range))
        })
    }

    fn report_member<M: BlockMember>(
        &mut self,
        fault: &ParseFault,
        range: &Range<usize>,
        next: Option<Lexeme>,
    ) {
        let said = self.cx.diagnostics.len();
        report(self.cx, fault, &self.tokens[range.clone()], next);
        let helpless = self.cx.diagnostics.get(said).is_some_and(|d| d.help.is_none());
        let at = (range.start + fault.at).min(range.end);
        let acts = self.tokens[range.start..at].iter().any(|t| t.kind == TokenKind::Do);
        let name = self.tokens.get(at).is_some_and(|t| t.kind.can_be_name());
        if M::START == TokenKind::StartAutomatonMember && acts && name && helpless {
            self.cx.diagnostics[said].help = Some("put `;` between two actions of an edge".to_owned());
        }
    }

    /// The brace pairs of a run that are in no other.
    fn pairs(&self, range: &Range<usize>) -> Vec<(usize, usize)> {
        let mut pairs = Vec::new();
        let mut depth = 0_usize;
        let mut open = range.start;
        for i in range.clone() {
            match self.tokens[i].kind {
                TokenKind::LBrace => {
                    if depth == 0 {
                        open = i;
                    }
                    depth += 1;
                }
                TokenKind::RBrace if depth > 0 => {
                    depth -= 1;
                    if depth == 0 {
                        pairs.push((open, i));
                    }
                }
                _ => {}
            }
        }
        pairs
    }

    /// A plan whose header or body is broken.
    fn plan(&mut self, range: &Range<usize>) -> Option<ParsedUnit> {
        let (open, close) = self.pairs(range).pop()?;
        let shell = self.shell(range.start, &[(open, close)]);
        let unit = run(self.cx, Some(TokenKind::StartAgentMember), &shell);
        let unit = match unit {
            Ok(unit) => Some(unit),
            Err(fault) => {
                report(self.cx, &fault, &shell, None);
                None
            }
        };
        let body = self.steps(open + 1..close);
        match unit {
            Some(ParsedUnit::AgentMember(AgentMember { doc, kind: AgentMemberKind::Plan(plan), .. })) => {
                let kind = AgentMemberKind::Plan(PlanSyntax { body, ..plan });
                let span = self.span(&(range.start..close + 1));
                Some(ParsedUnit::AgentMember(AgentMember { doc, kind, span }))
            }
            _ => None,
        }
    }

    /// `if c { … } else { … }` in a stimulus.
    fn condition(&mut self, range: &Range<usize>) -> Option<ParsedUnit> {
        let pairs = self.pairs(range);
        let last = *pairs.last()?;
        // The condition may have braces itself: the blocks are the last pair, and with `else` the last two.
        let both = pairs.len() >= 2 && self.tokens[last.0 - 1].kind == TokenKind::Else;
        let blocks = if both { &pairs[pairs.len() - 2..] } else { &pairs[pairs.len() - 1..] };
        let shell = self.shell(range.start, blocks);
        let unit = match run(self.cx, Some(TokenKind::StartStimulusStep), &shell) {
            Ok(unit) => Some(unit),
            Err(fault) => {
                report(self.cx, &fault, &shell, None);
                None
            }
        };
        let mut bodies: Vec<Vec<StimulusStepSyntax>> =
            blocks.iter().map(|(open, close)| self.members(open + 1..*close)).collect();
        let second = if both { bodies.pop().unwrap_or_default() } else { Vec::new() };
        let first = bodies.pop().unwrap_or_default();
        match unit {
            Some(ParsedUnit::StimulusStepSyntax(StimulusStepSyntax {
                kind: StimulusStepKind::If { condition, .. },
                ..
            })) => {
                let kind = StimulusStepKind::If { condition, then: first, otherwise: second };
                let span = self.span(&(range.start..last.1 + 1));
                Some(ParsedUnit::StimulusStepSyntax(StimulusStepSyntax { kind, span }))
            }
            _ => None,
        }
    }
}

macro_rules! members {
    ($($member:ident $kinds:ident $start:ident [$($doc:ident)?] $first:ident $(| $names:ident)?;)*) => {$(
        impl BlockMember for $member {
            const START: TokenKind = TokenKind::$start;

            fn of(unit: ParsedUnit) -> Option<Self> {
                if let ParsedUnit::$member(member) = unit { Some(member) } else { None }
            }

            fn broken(_doc: String, span: Span) -> Self {
                Self { $($doc: _doc,)? kind: $kinds::Error, span }
            }

            fn starts(kind: TokenKind) -> bool {
                kind.is(TokenTrait::$first) $(|| kind.$names())?
            }
        }
    )*};
}

members! {
    StimulusStepSyntax StimulusStepKind StartStimulusStep [] InStimulus | starts_call;
    AgentMember AgentMemberKind StartAgentMember [doc] InAgent;
    AutomatonMember AutomatonMemberKind StartAutomatonMember [doc] InAutomaton | starts_edge;
    CrossMember CrossMemberKind StartCrossMember [] InCross;
    SuiteMember SuiteMemberKind StartSuiteMember [] InSuite;
    TestMember TestMemberKind StartTestMember [] InTest | starts_call;
    WorldMember WorldMemberKind StartWorldMember [doc] InWorld;
    DeviceMember DeviceMemberKind StartDeviceMember [doc] InDevice;
    SystemMember SystemMemberKind StartSystemMember [] InSystem;
    BindingMember BindingMemberKind StartBindingMember [] InBinding;
    BindingEntry BindingEntryKind StartBindingEntry [] InBinding | starts_call;
}
