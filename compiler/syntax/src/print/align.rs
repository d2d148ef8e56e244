//! Columns of neighbouring lines; lines to text.

use crate::print::measure::WIDTH;
use crate::token::TokenKind;

/// How many blanks a line may get so that its columns stand under those of its neighbours.
const REACH: usize = 16;

/// A line of the result.
#[derive(Debug, Default)]
pub(super) struct OutputLine<'t> {
    /// An empty line is before it.
    pub blank: bool,
    /// Blanks before it.
    pub indent: usize,
    pub text: String,
    /// Where columns start: places in the text. The second is used only with the first.
    pub stops: [Option<usize>; 2],
    /// A whole member of this sort.
    pub sort: Option<TokenKind>,
    /// One or several whole members.
    pub whole: bool,
    pub comment: Option<&'t str>,
}

/// Aligns and joins the lines.
pub(super) fn text(mut lines: Vec<OutputLine<'_>>) -> String {
    each_run(
        &mut lines,
        |a, b| a.sort.is_some() && a.sort == b.sort,
        |run| (0..2).for_each(|c| column(run, c)),
    );
    let mut out = String::with_capacity(lines.iter().map(|l| l.indent + l.text.len() + 8).sum());
    let mut pads = vec![0; lines.len()];
    comments(&lines, &mut pads);
    for (line, pad) in lines.iter().zip(pads) {
        if line.blank {
            out.push('\n');
        }
        out.extend(std::iter::repeat_n(' ', line.indent));
        out.push_str(&line.text);
        if let Some(comment) = line.comment {
            let blanks = if line.text.is_empty() { 0 } else { pad + 1 };
            out.extend(std::iter::repeat_n(' ', blanks));
            out.push_str(comment);
        }
        out.push('\n');
    }
    out
}

/// Neighbours: no empty line between them, the same indentation, and what `same` says.
fn each_run<'l, 't>(
    lines: &'l mut [OutputLine<'t>],
    same: impl Fn(&OutputLine<'t>, &OutputLine<'t>) -> bool,
    mut use_run: impl FnMut(&mut [OutputLine<'t>]),
) {
    let mut rest = lines;
    while !rest.is_empty() {
        let together = |w: &[OutputLine<'t>]| !w[1].blank && w[0].indent == w[1].indent && same(&w[0], &w[1]);
        let length = 1 + rest.windows(2).take_while(|w| together(w)).count();
        let (run, after) = rest.split_at_mut(length);
        if length > 1 {
            use_run(run);
        }
        rest = after;
    }
}

/// The column to go to: the widest that leaves none more than [`REACH`] blanks behind; wider ones stick out.
fn target(widths: impl Iterator<Item = usize> + Clone) -> usize {
    let least = widths.clone().min().unwrap_or(0);
    widths.filter(|w| *w <= least + REACH).max().unwrap_or(0)
}

fn width(text: &str) -> usize {
    text.chars().count()
}

/// The width of the cell that ends at a stop.
fn cell(line: &OutputLine<'_>, column: usize) -> Option<(usize, usize)> {
    let end = line.stops[column]?;
    let start = if column == 0 { 0 } else { line.stops[0]? };
    Some((end, width(&line.text[start..end])))
}

fn column(run: &mut [OutputLine<'_>], column: usize) {
    let target = target(run.iter().filter_map(|l| cell(l, column).map(|c| c.1)));
    for line in run {
        let Some((end, own)) = cell(line, column) else { continue };
        let pad = target.saturating_sub(own);
        if pad == 0 || line.indent + width(&line.text) + pad > WIDTH {
            continue;
        }
        line.text.insert_str(end, &" ".repeat(pad));
        for stop in line.stops[column..].iter_mut().flatten() {
            *stop += pad;
        }
    }
}

/// Comments at the ends of neighbouring lines start in one column.
fn comments(lines: &[OutputLine<'_>], pads: &mut [usize]) {
    let has = |l: &OutputLine<'_>| l.whole && l.comment.is_some();
    let mut at = 0;
    while at < lines.len() {
        let mut end = at + 1;
        while end < lines.len()
            && has(&lines[end - 1])
            && has(&lines[end])
            && !lines[end].blank
            && lines[end].indent == lines[at].indent
        {
            end += 1;
        }
        let widths: Vec<usize> = lines[at..end].iter().map(|l| width(&l.text)).collect();
        let target = target(widths.iter().copied());
        for (pad, own) in pads[at..end].iter_mut().zip(widths) {
            *pad = target.saturating_sub(own);
        }
        at = end;
    }
}
