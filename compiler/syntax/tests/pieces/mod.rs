//! Text in pieces: blanks, comments, and what stands between them.

/// A piece of text: a blank between tokens, a comment, or something else.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Piece<'t> {
    Blank(&'t str),
    Comment(&'t str),
    Code(&'t str),
}

/// Length of the number that `text` starts with. An exponent is part of it: `e300` is no name.
fn number(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let whole = digits(0);
    if !text[whole..].starts_with('.') || digits(whole + 1) == 0 {
        return whole;
    }
    let fraction = whole + 1 + digits(whole + 1);
    let Some(power) = text[fraction..].strip_prefix(['e', 'E']) else { return fraction };
    let sign = usize::from(power.starts_with(['+', '-']));
    match digits(fraction + 1 + sign) {
        0 => fraction,
        digits => fraction + 1 + sign + digits,
    }
}

pub fn pieces(text: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = if c.is_whitespace() {
            rest.find(|c: char| !c.is_whitespace()).unwrap_or(rest.len())
        } else if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if c == '"' {
            let mut end = 1;
            while !rest[end..].starts_with('"') {
                let escaped = usize::from(rest[end..].starts_with('\\'));
                end += escaped;
                end += rest[end..].chars().next().map_or(1, char::len_utf8);
            }
            end + 1
        } else if c.is_ascii_digit() {
            number(rest)
        } else if c.is_alphanumeric() || c == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else {
            c.len_utf8()
        };
        let (piece, after) = rest.split_at(length);
        pieces.push(match c {
            c if c.is_whitespace() => Piece::Blank(piece),
            '/' if piece.len() > 1 => Piece::Comment(piece.trim_end()),
            _ => Piece::Code(piece),
        });
        rest = after;
    }
    pieces
}

pub fn comments(text: &str) -> Vec<&str> {
    let comment = |p| if let Piece::Comment(comment) = p { Some(comment) } else { None };
    pieces(text).into_iter().filter_map(comment).collect()
}

/// All words and marks, without semicolons and last commas.
pub fn code(text: &str) -> Vec<&str> {
    let code = |p| if let Piece::Code(code) = p { Some(code) } else { None };
    let mut code: Vec<&str> = pieces(text).into_iter().filter_map(code).filter(|c| *c != ";").collect();
    let next: Vec<&str> = code.iter().skip(1).copied().chain([""]).collect();
    let mut next = next.iter();
    code.retain(|c| {
        let closed = matches!(next.next(), Some(&(")" | "}")));
        *c != "," || !closed
    });
    code
}
