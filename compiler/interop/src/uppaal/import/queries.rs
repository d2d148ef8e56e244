//! Files of queries: one formula on each line, comments before it.

use hrdsl_source::FileId;

use super::{
    ast::UppaalQuery,
    fault::{UppaalFault, unsupported},
    lex::UppaalFragment,
    parse::UppaalParser,
    xml::QueryText,
};

/// The formulas of a `.q` file with the comments before them.
pub fn read(file: FileId, text: &str) -> Vec<QueryText> {
    let all = UppaalFragment::of_file(file, text);
    let (mut queries, mut comment, mut line_start, mut at) = (Vec::new(), String::new(), 0, 0);
    let char = |i: usize| all.chars.get(i).map(|(_, c)| *c);
    let mut blank = true;
    while at <= all.chars.len() {
        match (char(at), char(at + 1)) {
            (Some('/'), Some('*')) if blank => {
                let end = (at + 2..all.chars.len())
                    .find(|i| char(*i) == Some('*') && char(i + 1) == Some('/'))
                    .unwrap_or(all.chars.len());
                comment = words(&all.part(at + 2, end).text());
                at = end + 2;
                line_start = at.min(all.chars.len());
            }
            (Some('/'), Some('/')) if blank => {
                let end = (at..all.chars.len()).find(|i| char(*i) == Some('\n')).unwrap_or(all.chars.len());
                let said = words(&all.part(at + 2, end).text());
                // UPPAAL writes `//NO_QUERY` for a row without a formula.
                if said != "NO_QUERY" {
                    comment = said;
                }
                at = end;
            }
            (Some('\\'), Some('\n')) => at += 2,
            (Some('\n') | None, _) => {
                let formula = all.part(line_start, at);
                if !blank {
                    queries.push(QueryText { formula, comment: std::mem::take(&mut comment) });
                }
                blank = true;
                at += 1;
                line_start = at;
            }
            (Some(c), _) => {
                blank = blank && c.is_whitespace();
                at += 1;
            }
        }
    }
    queries
}

fn words(text: &str) -> String {
    text.lines()
        .map(|l| l.trim().trim_start_matches('*').trim())
        .filter(|l| !l.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

/// How queries begin that ask for more than a scenario's can.
const UNSUPPORTED: &[(&str, &str)] = &[
    ("Pr", "probabilities (`Pr`)"),
    ("simulate", "simulations (`simulate`)"),
    ("strategy", "strategies (`strategy`)"),
    ("saveStrategy", "strategies (`saveStrategy`)"),
    ("loadStrategy", "strategies (`loadStrategy`)"),
    ("control", "games (`control`)"),
    ("control_t", "games (`control_t`)"),
    ("minE", "learning (`minE`)"),
    ("maxE", "learning (`maxE`)"),
    ("minPr", "learning (`minPr`)"),
    ("maxPr", "learning (`maxPr`)"),
    ("E", "expected values and bounded searches (`E[…]`)"),
    ("bounds", "`bounds`"),
    ("refinement", "refinement (`refinement`)"),
    ("specification", "refinement (`specification`)"),
    ("consistency", "refinement (`consistency`)"),
];

/// What a formula asks.
pub fn parse(piece: &UppaalFragment) -> Result<UppaalQuery, UppaalFault> {
    let found = |i: usize| piece.chars.get(i).map(|(_, c)| *c);
    let mut at = 0;
    while found(at).is_some_and(char::is_whitespace) {
        at += 1;
    }
    // Blanks may stand between the quantifier and its box or diamond.
    let mut head: Vec<(usize, char)> = Vec::new();
    for (i, (_, c)) in piece.chars.iter().enumerate().skip(at) {
        if !c.is_whitespace() {
            head.push((i, *c));
        }
        if head.len() == 3 {
            break;
        }
    }
    let symbol: String = head.iter().map(|(_, c)| *c).collect();
    let after = head.last().map_or(at, |(i, _)| i + 1);
    let make = match symbol.as_str() {
        "E<>" => Some(UppaalQuery::Possibly as fn(_) -> _),
        "A[]" => Some(UppaalQuery::Invariantly as fn(_) -> _),
        "E[]" => Some(UppaalQuery::PotentiallyAlways as fn(_) -> _),
        "A<>" => Some(UppaalQuery::Eventually as fn(_) -> _),
        _ => None,
    };
    if let Some(make) = make {
        let mut parser = UppaalParser::new(&piece.part(after, piece.chars.len()))?;
        let formula = parser.expr()?;
        ended(&parser, piece)?;
        return Ok(make(formula));
    }
    let mut end = at;
    while found(end).is_some_and(|c| c.is_ascii_alphanumeric() || c == '_') {
        end += 1;
    }
    let word = piece.part(at, end).text();
    let rest = piece.part(end, piece.chars.len());
    let next = rest.chars.iter().map(|(_, c)| *c).find(|c| !c.is_whitespace());
    if matches!(word.as_str(), "sup" | "inf") && matches!(next, Some(':' | '{')) {
        let mut parser = UppaalParser::new(&rest)?;
        let (when, of) = parser.measures()?;
        ended(&parser, piece)?;
        return Ok(if word == "sup" { UppaalQuery::Sup(when, of) } else { UppaalQuery::Inf(when, of) });
    }
    let starts = |w: &str| w == word && !matches!(next, Some('.' | '=' | '-' | '!' | '>'));
    if let Some((_, what)) = UNSUPPORTED.iter().find(|(w, _)| starts(w)) {
        return Err(unsupported(piece.part(at, end).span(), what));
    }
    let mut parser = UppaalParser::new(piece)?;
    let (left, right) = parser.leads_to()?;
    ended(&parser, piece)?;
    right.map(|right| UppaalQuery::LeadsTo(left, right)).ok_or_else(|| UppaalFault {
        span: piece.span(),
        message: "expected a query that begins with `E<>`, `A[]`, `E[]`, `A<>`, `sup` or `inf`, or has `-->`"
            .to_owned(),
    })
}

/// `under S` belongs to games and strategies.
fn ended(parser: &UppaalParser, piece: &UppaalFragment) -> Result<(), UppaalFault> {
    parser.end().map_err(|fault| {
        if fault.message.contains("`under`") {
            return unsupported(piece.span(), "strategies (`under`)");
        }
        fault
    })
}
