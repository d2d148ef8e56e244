//! What did not fit, in words: what was found, what was expected there, and what to type.

use hrdsl_source::{Diagnostic, DiagnosticCode};

use crate::context::ParseContext;
use crate::expected::{ParseFault, describe, keyword, row};
use crate::token::{Keyword, KeywordClass, Lexeme, TokenKind, TokenTrait};

/// The diagnostic of a fault in these tokens, which `next` follows; none if the lexer has made it.
pub(crate) fn report(cx: &mut ParseContext<'_>, fault: &ParseFault, tokens: &[Lexeme], next: Option<Lexeme>) {
    let token = tokens.get(fault.at).copied().or(next);
    let before = fault.at.checked_sub(1).and_then(|i| tokens.get(i)).copied();
    if [token, before].iter().flatten().any(|t| t.kind == TokenKind::Error) {
        return;
    }
    let end = tokens.last().map_or(0, |t| t.end);
    let span = token.map_or(cx.span(end, end), |t| cx.span_of(t));
    let what = token.map_or("the end of the file".to_owned(), |t| found(t, cx.text));
    let wanted = describe(fault, token.is_some_and(|t| t.first));
    let message = if wanted.is_empty() {
        format!("{what} does not fit here")
    } else {
        format!("expected {}, found {what}", any_of(&wanted))
    };
    let mut diagnostic = Diagnostic::error(DiagnosticCode::SYNTAX, span, message);
    if let Some(open) = unclosed(fault, tokens) {
        diagnostic = diagnostic.label(cx.span_of(open), "this `(` is not closed");
    }
    let after = tokens.get(fault.at + 1).copied().or(next);
    if let Some((token, near)) = token.and_then(|t| Some((t, keyword_near(cx, fault, t)?))) {
        let title = format!("replace `{}` by `{near}`", cx.text_of(token));
        diagnostic = diagnostic.help(format!("did you mean `{near}`?")).fix(title, span, near, false);
    } else if let Some((word, near)) =
        before.and_then(|word| Some((word, requirement_near(cx, fault, word, tokens)?)))
    {
        let title = format!("replace `{}` by `{near}`", cx.text_of(word));
        diagnostic = diagnostic.help(format!("did you mean `{near}` before it?")).fix(
            title,
            cx.span_of(word),
            near,
            false,
        );
    } else if let Some(help) = agentspeak(fault, tokens).or_else(|| help(cx, fault, [before, after], token?))
    {
        diagnostic = diagnostic.help(help);
    }
    cx.diagnostics.push(diagnostic);
}

/// A token as a message names it.
pub(crate) fn found(token: Lexeme, text: &str) -> String {
    match token.kind {
        TokenKind::Str => "a text".to_owned(),
        TokenKind::RBrace => "`}`".to_owned(),
        _ => format!("`{}`", text.get(token.start as usize..token.end as usize).unwrap_or("")),
    }
}

/// `a`, `a or b`, `a, b or c`; five at most.
fn any_of(words: &[String]) -> String {
    let words = &words[..words.len().min(5)];
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
    }
}

// ── What to type ──

/// The parenthesis that should have been closed where the fault is.
fn unclosed(fault: &ParseFault, tokens: &[Lexeme]) -> Option<Lexeme> {
    if !fault.has(")") {
        return None;
    }
    let mut depth = 0_usize;
    for token in tokens[..fault.at.min(tokens.len())].iter().rev() {
        match token.kind {
            TokenKind::RParen => depth += 1,
            TokenKind::LParen if depth == 0 => return Some(*token),
            TokenKind::LParen => depth -= 1,
            _ => {}
        }
    }
    None
}

/// The expected keyword that a word was meant to be.
fn keyword_near<'f>(cx: &ParseContext<'_>, fault: &'f ParseFault, token: Lexeme) -> Option<&'f str> {
    let keywords = fault.expected.iter().map(|e| e.trim_matches('"')).filter(|e| keyword(e).is_some());
    let meant = token.kind.is_word()
        && !matches!(token.kind.class(), Some(KeywordClass::Hard | KeywordClass::Reserved));
    // Where a name fits, every keyword is one.
    (meant && !fault.has("IDENT")).then(|| nearest(cx.text_of(token), keywords))?
}

/// What a requirement can begin with, and what stands before an operand in a formula.
const PATTERN_WORDS: [&str; 6] = ["never", "globally", "always", "eventually", "whenever", "formula"];
const FORMULA_WORDS: [&str; 5] = ["always", "eventually", "once", "historically", "not"];

/// The keyword that the word before the fault was meant to be, where a requirement has to have one: a word that is none was read as a name.
fn requirement_near(
    cx: &ParseContext<'_>,
    fault: &ParseFault,
    word: Lexeme,
    tokens: &[Lexeme],
) -> Option<&'static str> {
    let before = tokens.get(..fault.at.checked_sub(1)?)?;
    let is_required = before.first().is_some_and(|t| t.kind == TokenKind::Require);
    if !is_required || !word.kind.is_name() || word.kind.class().is_some() {
        return None;
    }
    // An operand of a formula stands anywhere, a pattern behind name, kind and title.
    let is_first = before.len() <= 4;
    if before.iter().any(|t| t.kind == TokenKind::Formula) {
        nearest(cx.text_of(word), FORMULA_WORDS.into_iter())
    } else if is_first {
        nearest(cx.text_of(word), PATTERN_WORDS.into_iter())
    } else {
        None
    }
}

/// The keyword, if no name can be like it.
fn reserved(word: &str) -> Option<&'static Keyword> {
    row(word).filter(|k| k.class == KeywordClass::Reserved)
}

fn help(
    cx: &ParseContext<'_>,
    fault: &ParseFault,
    around: [Option<Lexeme>; 2],
    token: Lexeme,
) -> Option<String> {
    let word = cx.text_of(token);
    let [before, after] = around.map(|t| t.map(|t| t.kind));
    let named = after.is_some_and(|kind| kind.is(TokenTrait::AfterDeclared));
    // Where an expression is expected, the word may have been meant as the operator that it is.
    if let Some(keyword) = reserved(word)
        && fault.has("IDENT")
        && (named || !fault.has("INT"))
    {
        let place = keyword.place;
        return Some(format!(
            "`{word}` is a keyword ({place}) and cannot be a name; write another one, such as `{word}_`"
        ));
    }
    let text = match token.kind {
        TokenKind::Eq if fault.has("=") => "to set a value, write `=`",
        kind if (kind == TokenKind::Assign || kind.is(TokenTrait::Comparison)) && fault.has("&&") => {
            "comparisons cannot be chained: write `a < b && b < c`"
        }
        // The expression before may have been taken for complete.
        TokenKind::Pipe
            if fault.has("||") || fault.has("{") || fault.complete() && fault.expected.len() == 1 =>
        {
            "in expressions `or` is written `||` or `or`"
        }
        TokenKind::Pipe if fault.has("or") => "lists of events in requirements are written with `or`",
        TokenKind::Pipe if before.is_some_and(TokenKind::ends_operand) && !fault.has("|") => {
            "in expressions `or` is written `||` or `or`"
        }
        TokenKind::Or | TokenKind::OrOr if fault.has("|") => "alternatives are written with `|` here",
        kind if kind.is_word() && fault.has("STRING") && !fault.has("IDENT") => {
            "texts are written between `\"` and `\"`"
        }
        TokenKind::Dot if fault.has("INTERNAL") && after.is_some_and(TokenKind::is_word) => {
            "an internal action is written `.print`: with a blank before its dot, and none after it"
        }
        TokenKind::Dot if fault.has("INT") => "write a digit before the point, as in `0.5`",
        TokenKind::Dot if matches!(before, Some(TokenKind::Int)) => {
            "write a digit after the point, as in `1.0`"
        }
        TokenKind::DotDot
            if matches!(before, Some(TokenKind::Int | TokenKind::Quantity)) && !fault.has("IDENT") =>
        {
            "a range does not fit here"
        }
        TokenKind::Arrow if fault.has("IDENT") => "an edge is written `a -> b`, and both are names",
        _ => return None,
    };
    Some(text.to_owned())
}

/// What to write for what AgentSpeak writes in another way, and for what is easily mixed up in agents.
fn agentspeak(fault: &ParseFault, tokens: &[Lexeme]) -> Option<String> {
    let at = fault.at.min(tokens.len());
    let rest: Vec<TokenKind> = tokens[at..].iter().take(2).map(|t| t.kind).collect();
    let start: Vec<TokenKind> = tokens.iter().take(2).map(|t| t.kind).collect();
    let member = fault.has("belief") && fault.has("plan") && !fault.has("IDENT");
    let text = match (rest.as_slice(), start.as_slice()) {
        ([TokenKind::Bang, ..], _) if member => "a goal that is adopted at the start is written `goal !g`",
        ([TokenKind::Plus | TokenKind::Minus | TokenKind::At_, ..], _) if member => {
            "a plan is written `plan +!g when context { steps }`"
        }
        ([name, ..], _) if member && name.is_name() => {
            "a belief is declared by `belief b(x: type)`, with `= b(1)` if it is held at the start; a rule is `rule b(X) when …`"
        }
        ([TokenKind::Colon, TokenKind::Minus], _) if fault.has("when") => "`:-` is written `when`",
        ([TokenKind::Colon, ..], _) if fault.has("when") => "the context of a plan is written `when …`",
        ([TokenKind::Lt, TokenKind::Minus], _) if fault.has("{") => {
            "the body of a plan is written `{ … }`, without `<-`"
        }
        (_, [TokenKind::Plan, ..]) if fault.has("{") && has_left_arrow(&tokens[..at]) => {
            "the body of a plan is written `{ … }`, without `<-`"
        }
        (_, [TokenKind::Goal, TokenKind::Bang]) if rest.first() == Some(&TokenKind::Colon) => {
            "`goal g(x: type)`, without `!`, declares the types of a goal; `goal !g(1)` adopts it at the start"
        }
        (_, [TokenKind::Goal, name]) if name.is_name() && fault.has("IDENT") => {
            "`goal g(x: type)` declares the types of a goal; `goal !g(1)` adopts it at the start"
        }
        ([TokenKind::LBracket, ..], [TokenKind::Bang | TokenKind::BangBang, ..]) => {
            "a goal is adopted without annotations; the triggers of plans have them"
        }
        ([TokenKind::And | TokenKind::Or, TokenKind::LBrace], [TokenKind::Fork, ..]) => {
            "a fork has `and` between all of its branches, or `or` between all"
        }
        (
            [
                TokenKind::Eq | TokenKind::Ne | TokenKind::Lt | TokenKind::Le | TokenKind::Gt | TokenKind::Ge,
                ..,
            ],
            _,
        ) if fault.of == "step" && fault.has("=") => {
            "a step binds or compares by `X = e`; other conditions are asked by `?(…)`"
        }
        ([TokenKind::Else, ..], _) if fault.of == "step" => {
            "`else` follows the block of an `if`, and a `{` follows it"
        }
        _ => return None,
    };
    Some(text.to_owned())
}

/// `<-`, which is read as two tokens.
fn has_left_arrow(tokens: &[Lexeme]) -> bool {
    tokens
        .windows(2)
        .any(|w| (w[0].kind, w[1].kind) == (TokenKind::Lt, TokenKind::Minus) && w[0].end == w[1].start)
}

/// The word that differs from `word` by a slip of the fingers, if there is one.
pub(crate) fn nearest<'w>(word: &str, words: impl Iterator<Item = &'w str>) -> Option<&'w str> {
    let allowed = |other: &str| match other.len() {
        0..=2 => 0,
        3 | 4 => 1,
        _ => 2,
    };
    words
        .map(|other| (distance(word, other), other))
        .filter(|(d, other)| (1..=allowed(other)).contains(d))
        .min()
        .map(|(_, other)| other)
}

/// How many letters have to be put in, taken out, replaced or swapped with the next (optimal string alignment).
fn distance(a: &str, b: &str) -> usize {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len().abs_diff(b.len()) > 2 {
        return usize::MAX;
    }
    let mut before = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let cost = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (last[j] + 1).min(row[j - 1] + 1).min(last[j - 1] + cost);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}
