//! Members to lines: one line for what fits and may, else blocks are opened and long lines broken.

use crate::print::align::OutputLine;
use crate::print::flat::{FlatText, columns};
use crate::print::marks::BlockKind;
use crate::print::measure::{STEP, WIDTH};
use crate::print::shape::{BlockShape, MemberPart, MemberShape};
use crate::print::spacing::{BindingStrength, blank, ends_line, weakness};
use crate::print::trivia::{Comment, PrintToken};
use crate::token::TokenKind;

/// The lines of a file.
pub(super) fn lines<'t>(toks: &[PrintToken<'t>], members: &[MemberShape]) -> Vec<OutputLine<'t>> {
    let mut layout = LineLayout { toks, lines: Vec::new() };
    for (n, member) in members.iter().enumerate() {
        layout.member(member, MemberPlace { indent: 0, first: n == 0, separator: "" });
    }
    if let Some(end) = toks.last() {
        layout.comments(&end.leading, 0, members.is_empty());
    }
    layout.lines
}

/// Where a member goes.
#[derive(Clone, Copy)]
struct MemberPlace {
    indent: usize,
    /// The first of its block: no empty line before it.
    first: bool,
    /// What follows it.
    separator: &'static str,
}

/// A piece of text that no line end divides.
struct UnbreakableText {
    text: String,
    width: usize,
    /// A blank before it.
    space: bool,
    /// How weakly it holds to the one before, the brackets around first; `None`: always.
    key: Option<BindingStrength>,
    /// A line starts here, for a comment or by the author's right.
    must: bool,
    /// The author started a line here.
    newline: bool,
    depth: BindingStrength,
    tok: usize,
    last: usize,
}

/// How a sequence of atoms came out.
struct LaidSequence {
    /// All lines fit, and end where the author ended them.
    as_written: bool,
}

struct LineLayout<'a, 't> {
    toks: &'a [PrintToken<'t>],
    lines: Vec<OutputLine<'t>>,
}

impl<'t> LineLayout<'_, 't> {
    fn comments(&mut self, comments: &[Comment<'t>], indent: usize, first: bool) {
        for (n, comment) in comments.iter().enumerate() {
            let blank = comment.blank && !(first && n == 0);
            self.lines.push(OutputLine {
                blank,
                indent,
                comment: Some(comment.text),
                ..OutputLine::default()
            });
        }
    }

    // ── Members ──

    /// The members of an open block.
    fn members(&mut self, block: &BlockShape, indent: usize) {
        for (n, member) in block.members.iter().enumerate() {
            let last = n + 1 == block.members.len();
            let separator = match block.kind {
                BlockKind::Steps if !last && !ends_with_block(member) => ";",
                BlockKind::List => ",",
                BlockKind::Steps | BlockKind::Members => "",
            };
            if n > 0 && self.joins(member, block.kind, separator) {
                continue;
            }
            self.member(member, MemberPlace { indent, first: n == 0, separator });
        }
    }

    /// Puts a member on the line of the one before, if the author did and there is room.
    fn joins(&mut self, member: &MemberShape, kind: BlockKind, separator: &str) -> bool {
        let first = &self.toks[member.first];
        let Some(line) = self.lines.last() else { return false };
        if first.newline || !first.leading.is_empty() || !line.whole || line.comment.is_some() {
            return false;
        }
        // A step that ends with a block has no semicolon where the line ends.
        let between = if kind == BlockKind::Members || line.text.ends_with('}') { "; " } else { " " };
        let used = line.indent + line.text.chars().count() + between.len() + separator.len();
        let Some(flat) = FlatText::member(self.toks, member, WIDTH.saturating_sub(used)) else {
            return false;
        };
        let comment = self.toks[member.end - 1].trailing;
        if let Some(line) = self.lines.last_mut() {
            line.text += between;
            line.text += &flat.text;
            line.text += separator;
            line.sort = None;
            line.comment = comment;
        }
        true
    }

    fn member(&mut self, member: &MemberShape, place: MemberPlace) {
        let first = &self.toks[member.first];
        self.comments(&first.leading, place.indent, place.first);
        let from = self.lines.len();
        if !self.whole(member, place) && !self.inline(member, place) {
            self.open(member, place);
        }
        if let Some(line) = self.lines.get_mut(from) {
            line.blank = first.blank && !(place.first && first.leading.is_empty());
        }
    }

    /// On one line.
    fn whole(&mut self, member: &MemberShape, place: MemberPlace) -> bool {
        let room = WIDTH.saturating_sub(place.indent + place.separator.len());
        let Some(flat) = FlatText::member(self.toks, member, room) else { return false };
        let (sort, _) = columns(self.toks, member);
        self.lines.push(OutputLine {
            indent: place.indent,
            text: flat.text + place.separator,
            stops: flat.stops,
            sort,
            whole: true,
            comment: self.toks[member.end - 1].trailing,
            ..OutputLine::default()
        });
        true
    }

    /// On several lines, blocks on one: as the author has it, if every line fits.
    fn inline(&mut self, member: &MemberShape, place: MemberPlace) -> bool {
        let blocks = member.parts.iter().any(|p| matches!(p, MemberPart::Block(_)));
        let mut atoms = Vec::new();
        for part in &member.parts {
            match part {
                MemberPart::Run(run) => self.atoms(run.clone(), member.first, &mut atoms),
                MemberPart::Block(block) => match FlatText::block(self.toks, block, WIDTH) {
                    Some(flat) if !ends_line(self.toks, block.open, member.first) => {
                        let width = flat.width();
                        atoms.push(UnbreakableText {
                            text: flat.text,
                            width,
                            last: block.close,
                            ..self.brace(block.open)
                        });
                    }
                    Some(_) | None => return false,
                },
            }
        }
        end_with(&mut atoms, place.separator);
        let from = self.lines.len();
        let laid = self.lay(&atoms, place.indent, STEP);
        if blocks && !laid.as_written {
            self.lines.truncate(from);
            return false;
        }
        true
    }

    /// Every block open, one member a line.
    fn open(&mut self, member: &MemberShape, place: MemberPlace) {
        let mut atoms = Vec::new();
        for part in &member.parts {
            match part {
                MemberPart::Run(run) => self.atoms(run.clone(), member.first, &mut atoms),
                MemberPart::Block(block) => {
                    let close = &self.toks[block.close];
                    atoms.push(self.brace(block.open));
                    let commented = self.toks[block.open].trailing.is_some() || !close.leading.is_empty();
                    if block.members.is_empty() && !commented {
                        atoms.push(self.brace(block.close));
                        continue;
                    }
                    self.lay(&atoms, place.indent, 2 * STEP);
                    let inner = place.indent + STEP;
                    self.members(block, inner);
                    self.comments(&close.leading, inner, block.members.is_empty());
                    atoms.clear();
                    atoms.push(UnbreakableText { must: false, ..self.brace(block.close) });
                }
            }
        }
        end_with(&mut atoms, place.separator);
        self.lay(&atoms, place.indent, STEP);
    }

    // ── Atoms ──

    fn atoms(&self, run: std::ops::Range<usize>, first: usize, atoms: &mut Vec<UnbreakableText>) {
        let mut depth: BindingStrength = 0;
        for at in run {
            let tok = &self.toks[at];
            if matches!(tok.kind, TokenKind::RParen | TokenKind::RBracket | TokenKind::RBrace) {
                depth = depth.saturating_sub(1);
            }
            let mut text = String::with_capacity(tok.text.len() + 1);
            crate::print::flat::write(tok, &mut text);
            let closes = tok.broken && tok.kind == TokenKind::RParen;
            if closes {
                end_with(atoms, ",");
            }
            atoms.push(UnbreakableText {
                width: text.chars().count(),
                text,
                space: blank(self.toks, at),
                key: weakness(self.toks, at, first).map(|w| depth * 16 + w),
                must: ends_line(self.toks, at, first),
                newline: tok.newline,
                depth,
                tok: at,
                last: at,
            });
            if matches!(tok.kind, TokenKind::LParen | TokenKind::LBracket | TokenKind::LBrace) {
                depth += 1;
            }
        }
    }

    /// The brace of a block.
    fn brace(&self, at: usize) -> UnbreakableText {
        let text = self.toks[at].text.to_owned();
        let must = at > 0 && (!self.toks[at].leading.is_empty() || self.toks[at - 1].trailing.is_some());
        UnbreakableText {
            text,
            width: 1,
            space: true,
            key: None,
            must,
            newline: false,
            depth: 0,
            tok: at,
            last: at,
        }
    }

    // ── Lines ──

    /// Atoms to lines; those after the first are indented by `more`.
    fn lay(&mut self, atoms: &[UnbreakableText], indent: usize, more: usize) -> LaidSequence {
        let total: usize = atoms.iter().map(|a| a.width + usize::from(a.space)).sum();
        let long = indent + total > WIDTH;
        let mut laid = LaidSequence { as_written: true };
        let mut lists = BrokenLists { open: Vec::new(), base: indent, more };
        let (mut at, mut here) = (0, indent);
        while at < atoms.len() {
            if at > 0 {
                let leading = self.toks[atoms[at].tok].leading.iter().map(|c| c.text);
                let line =
                    |comment| OutputLine { indent: here, comment: Some(comment), ..OutputLine::default() };
                self.lines.extend(leading.map(line));
            }
            let end = line_end(atoms, at, here, long, &mut laid);
            let mut text = String::new();
            for (n, atom) in atoms[at..end].iter().enumerate() {
                if n > 0 && atom.space {
                    text.push(' ');
                }
                text += &atom.text;
                lists.pass(self.toks, atom, here);
            }
            let comment = self.toks[atoms[end - 1].last].trailing;
            self.lines.push(OutputLine { indent: here, text, comment, ..OutputLine::default() });
            if let Some(next) = atoms.get(end) {
                here = lists.indent(self.toks, &atoms[end - 1], next);
            }
            at = end;
        }
        laid
    }
}

/// The lists that are broken after their parenthesis, while lines are laid.
struct BrokenLists {
    /// The indentation of the elements, and how deep they are.
    open: Vec<(usize, BindingStrength)>,
    base: usize,
    more: usize,
}

impl BrokenLists {
    fn pass(&mut self, toks: &[PrintToken<'_>], atom: &UnbreakableText, here: usize) {
        let tok = &toks[atom.tok];
        if tok.broken && tok.kind == TokenKind::LParen {
            self.open.push((here + STEP, atom.depth + 1));
        } else if tok.broken {
            self.open.pop();
        }
    }

    /// The indentation of the line that starts with `next`.
    fn indent(&mut self, toks: &[PrintToken<'_>], last: &UnbreakableText, next: &UnbreakableText) -> usize {
        let Some((inner, depth)) = self.open.last().copied() else {
            let here = self.base + self.more;
            if toks[next.tok].mark.pattern {
                // What continues a pattern is not to look like one.
                self.more += STEP;
            }
            return here;
        };
        let (before, tok) = (&toks[last.tok], &toks[next.tok]);
        if tok.broken && tok.kind == TokenKind::RParen {
            return inner.saturating_sub(STEP);
        }
        let starts = (before.broken && before.kind == TokenKind::LParen)
            || (before.kind == TokenKind::Comma && last.depth == depth);
        if starts { inner } else { inner + STEP }
    }
}

fn ends_with_block(member: &MemberShape) -> bool {
    matches!(member.parts.last(), Some(MemberPart::Block(_)))
}

/// Writes a separator after the last atom.
fn end_with(atoms: &mut [UnbreakableText], separator: &str) {
    if let Some(last) = atoms.last_mut() {
        last.text += separator;
        last.width += separator.len();
    }
}

/// Where the line that starts at an atom ends: where it must, or where it holds together least of all places that fit.
fn line_end(
    atoms: &[UnbreakableText],
    at: usize,
    indent: usize,
    long: bool,
    laid: &mut LaidSequence,
) -> usize {
    let mut width = indent + atoms[at].width;
    let mut best: Option<(BindingStrength, usize)> = None;
    for (n, atom) in atoms.iter().enumerate().skip(at + 1) {
        if atom.must || (long && atom.newline && atom.key.is_some()) {
            laid.as_written &= width <= WIDTH;
            return n;
        }
        if let Some(key) = atom.key
            && (width <= WIDTH || best.is_none())
            && best.is_none_or(|(least, _)| key <= least)
        {
            best = Some((key, n));
        }
        width += atom.width + usize::from(atom.space);
        if width > WIDTH
            && let Some((_, n)) = best
        {
            laid.as_written = false;
            return n;
        }
    }
    laid.as_written &= width <= WIDTH;
    atoms.len()
}
