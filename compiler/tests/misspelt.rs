//! No misspelt name goes unnoticed: every name of the reference scenario, at every place, is misspelt in two ways, and each
//! time the compiler must point at the very place and offer the right name.

use hrdsl_compiler::{CompilationResult, InputFile, compile};
use hrdsl_source::Diagnostic;
use hrdsl_syntax::token::{KEYWORDS, KeywordClass};

const SCENARIO: &str = include_str!("../../examples/handover/scenario.hri");

/// What a name is where it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// The name is looked up: the error is here.
    Use,
    /// The name is given here: the errors are where it is used, and offer the new spelling.
    Declaration,
    /// The name is given here and hardly used: what is wrong with another spelling, if anything, is said at the use.
    Unused,
    /// A plan's variable where it is matched: another spelling is another variable, which may be meant.
    Matched,
}

#[derive(Clone, Debug)]
struct Occurrence {
    text: String,
    at: usize,
    place: Place,
}

#[derive(Clone, Debug, PartialEq)]
struct Token {
    text: String,
    at: usize,
    name: bool,
}

/// Names, units and punctuation; no comments, strings or numbers but as `0`.
fn tokens(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let mut tokens: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < bytes.len() {
        let rest = &text[i..];
        let run = |f: fn(char) -> bool| rest.find(|c: char| !f(c)).unwrap_or(rest.len());
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let (length, kept, name) = if rest.starts_with("//") {
            (run(|c| c != '\n'), None, false)
        } else if let Some(inner) = rest.strip_prefix('"') {
            (inner.find('"').unwrap() + 2, Some("\"".to_owned()), false)
        } else if bytes[i].is_ascii_digit() {
            let mut n = run(|c| c.is_ascii_digit() || c == '.');
            // `0..4` is not one number
            n = rest[..n].find("..").unwrap_or(n);
            (n, Some("0".to_owned()), false)
        } else if bytes[i].is_ascii_alphabetic() || bytes[i] == b'_' {
            let mut n = run(is_name);
            let unit = tokens.last().is_some_and(|t| t.text == "0") && rest[n..].starts_with("/s");
            n += if unit { 2 } else { 0 };
            (n, Some(rest[..n].to_owned()), true)
        } else if bytes[i].is_ascii_whitespace() {
            (1, None, false)
        } else {
            let n = if rest.starts_with("->") { 2 } else { rest.chars().next().unwrap().len_utf8() };
            (n, Some(rest[..n].to_owned()), false)
        };
        tokens.extend(kept.map(|text| Token { text, at: i, name }));
        i += length;
    }
    tokens
}

fn is_keyword(word: &str) -> bool {
    KEYWORDS.iter().any(|k| k.word == word)
}

/// Words that name something though they are keywords elsewhere.
fn is_name(tokens: &[Token], i: usize) -> bool {
    let word = tokens[i].text.as_str();
    if !tokens[i].name || word == "_" || word == "rising" {
        return false;
    }
    if !is_keyword(word) {
        return true;
    }
    let neighbour = |i: Option<usize>| i.and_then(|i| tokens.get(i)).map_or("", |t| t.text.as_str());
    let (before, after) = (neighbour(i.checked_sub(1)), neighbour(Some(i + 1)));
    let called = after == "(" && !["at", "count", "tool", "never"].contains(&word);
    let soft = KEYWORDS.iter().any(|k| k.word == word && k.class == KeywordClass::Soft);
    soft && after != "each"
        && (called
            || ["->", "=", ".", ":", ",", ")"].contains(&after)
            || [".", "->", "location", "stimulus"].contains(&before))
}

/// What declares a name by standing before it.
const DECLARING: [&str; 21] = [
    "actor",
    "const",
    "event",
    "stimulus",
    "agent",
    "automaton",
    "belief",
    "clock",
    "var",
    "location",
    "network",
    "cover",
    "cross",
    "body",
    "current",
    "signal",
    "sample",
    "select",
    "scenario",
    "require",
    "suite",
];

fn occurrences(text: &str) -> Vec<Occurrence> {
    let tokens = tokens(text);
    let mut found = Vec::new();
    let (mut section, mut in_body, mut on_args, mut depth) = (String::new(), false, false, 0usize);
    for i in 0..tokens.len() {
        let word = tokens[i].text.as_str();
        let before = i.checked_sub(1).map_or("", |i| tokens[i].text.as_str());
        let after = tokens.get(i + 1).map_or("", |t| t.text.as_str());
        match word {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        let heads =
            ["agent", "automaton", "cover", "world", "suite", "event", "stimulus", "require", "cross"];
        if depth == 0 && (heads.contains(&word) || word == "actor" || word == "var") {
            word.clone_into(&mut section);
        }
        in_body = section == "agent" && depth == 2 && (in_body || word == "{");
        on_args = section == "automaton" && (on_args || after == "(" && before == "on") && word != ")";
        if !is_name(&tokens, i) {
            continue;
        }
        let variable = word.starts_with(char::is_uppercase) && section == "agent" && word != "LEGS";
        let of_part = before == "part" || (after == "=" && section == "cover");
        let unit = before == "0";
        let place = if ["scenario", "require", "suite"].contains(&before) {
            Place::Unused
        } else if unit {
            Place::Use
        } else if DECLARING.contains(&before) || of_part {
            Place::Declaration
        } else if after == ":" && before != "." {
            // `leg` is what `choose … per leg` names; other parameters are known by their place.
            let named = section == "stimulus" || section == "automaton" || word == "grip";
            if named { Place::Declaration } else { Place::Unused }
        } else if variable
            && !in_body
            && before != "<"
            && after != "<"
            && word != "Human"
            && word != "Sensors"
        {
            Place::Matched
        } else if on_args && before != "on" {
            Place::Declaration
        } else {
            Place::Use
        };
        found.push(Occurrence { text: word.to_owned(), at: tokens[i].at, place });
    }
    found
}

/// One letter too many, and two letters swapped.
fn misspellings(name: &str) -> Vec<String> {
    let mut all = vec![format!("{name}x")];
    let letters: Vec<char> = name.chars().collect();
    let pairs = (0..letters.len().saturating_sub(1)).rev();
    let differ =
        pairs.filter(|i| letters[*i] != letters[i + 1] && letters[*i] != '/' && letters[i + 1] != '/');
    if let Some(i) = differ.min_by_key(|i| i.abs_diff(letters.len() / 2)) {
        let mut swapped = letters.clone();
        swapped.swap(i, i + 1);
        let swapped: String = swapped.into_iter().collect();
        // `R12` would be `R21`, which is another one.
        let is_there = SCENARIO.split(|c: char| !c.is_alphanumeric() && c != '_').any(|w| w == swapped);
        if !is_keyword(&swapped) && !is_there && !swapped.starts_with(|c: char| c.is_ascii_digit()) {
            all.push(swapped);
        }
    }
    all
}

fn compiled(text: &str) -> CompilationResult {
    compile(InputFile { name: "scenario.hri", text }, &[])
}

fn offers(d: &Diagnostic, name: &str) -> bool {
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == '/';
    d.help.as_deref().is_some_and(|h| h.split(|c| !word(c)).any(|w| w == name))
}

/// What is wrong with the compiler's answer to a misspelling, if anything.
fn fault(o: &Occurrence, wrong: &str) -> Option<String> {
    let text = format!("{}{wrong}{}", &SCENARIO[..o.at], &SCENARIO[o.at + o.text.len()..]);
    let c = compiled(&text);
    let (start, end) = (o.at, o.at + wrong.len());
    let covers = |d: &Diagnostic| {
        let span = d.span();
        span.file.0 == 0 && span.range() == (start..end)
    };
    let right = match o.place {
        // The only plan for a goal declares it.
        Place::Use if SCENARIO[..o.at].ends_with("plan +!") => {
            c.diagnostics.iter().any(|d| covers(d) && offers(d, &o.text) || !covers(d) && offers(d, wrong))
        }
        // In a goal it may be what that is to give.
        Place::Use => {
            let unread = |d: &Diagnostic| d.code == hrdsl_source::DiagnosticCode::UNUSED;
            c.diagnostics.iter().any(|d| (d.is_error() || unread(d)) && covers(d) && offers(d, &o.text))
        }
        Place::Declaration => {
            let at_use =
                |d: &Diagnostic| !covers(d) && (offers(d, wrong) || c.files.text(d.span()) == o.text);
            let once = || occurrences(SCENARIO).iter().filter(|other| other.text == o.text).count() == 1;
            c.diagnostics.iter().any(at_use) || c.diagnostics.is_empty() && (o.text == "no" || once())
        }
        Place::Unused | Place::Matched => c.diagnostics.iter().all(|d| offers(d, wrong)),
    };
    (!right).then(|| {
        let place = c.files.place(hrdsl_source::Span::new(hrdsl_source::FileId(0), start, end));
        let said: Vec<String> = c
            .diagnostics
            .iter()
            .map(|d| {
                format!(
                    "\n    {} {}: {} ({})",
                    d.code,
                    c.files.place(d.span()),
                    d.message,
                    d.help.as_deref().unwrap_or("-")
                )
            })
            .collect();
        format!("{place}: {:?} `{}` as `{wrong}`:{}\n", o.place, o.text, said.concat())
    })
}

#[test]
fn every_misspelt_name_is_found_where_it_stands() {
    let all = occurrences(SCENARIO);
    let uses = all.iter().filter(|o| o.place == Place::Use).count();
    let declared = all.iter().filter(|o| o.place == Place::Declaration).count();
    assert!(
        uses > 700 && declared > 100,
        "{uses} uses, {declared} declarations: the test looks at too little"
    );
    let goal = all.iter().find(|o| SCENARIO[..o.at].ends_with("plan +!")).unwrap();
    assert_eq!(goal.place, Place::Use);
    let faults: Vec<String> = all
        .iter()
        .flat_map(|o| misspellings(&o.text).into_iter().filter_map(|wrong| fault(o, &wrong)))
        .collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.concat());
}

// ── a scenario of all types and templates ──

const WHOLE: &str = include_str!("scenarios/whole.hri");

/// How many misspellings still have an error that only follows from another; it must not grow.
const LEFT: usize = 2;

/// What is said of the scenario with another spelling of one name.
struct Said {
    /// A diagnostic stands at the name and offers the right one.
    found: bool,
    /// The others stand where the name is used, or offer the new spelling.
    cascades: Vec<String>,
    errors: usize,
}

fn said(name: &Token, wrong: &str) -> Said {
    let text = format!("{}{wrong}{}", &WHOLE[..name.at], &WHOLE[name.at + name.text.len()..]);
    let c = compiled(&text);
    let place = name.at..name.at + wrong.len();
    let here = |d: &Diagnostic| d.span().file.0 == 0 && d.span().range() == place && offers(d, &name.text);
    let elsewhere = |d: &Diagnostic| {
        let text = c.files.text(d.span());
        offers(d, wrong) || text == name.text || text.split('.').any(|part| part == name.text)
    };
    let found = c.diagnostics.iter().any(here);
    let errors = c.diagnostics.iter().filter(|d| d.is_error());
    let rest = errors.filter(|d| !here(d) && (found || !elsewhere(d)));
    let shown = |d: &Diagnostic| {
        let help = d.help.as_deref().unwrap_or("-");
        format!("    {} {}: {} ({help})\n", d.code, c.files.place(d.span()), d.message)
    };
    let errors = c.diagnostics.iter().filter(|d| d.is_error()).count();
    Said { found, cascades: rest.map(shown).collect(), errors }
}

#[test]
fn one_misspelt_name_is_one_error() {
    assert_eq!(compiled(WHOLE).diagnostics, [], "the scenario itself is right");
    let tokens = tokens(WHOLE);
    let (mut found, mut free, mut faults) = (0, 0, Vec::new());
    for (i, name) in tokens.iter().enumerate().filter(|(i, _)| is_name(&tokens, *i)) {
        // Units are not names.
        let before = |n: usize| i.checked_sub(n).map_or("", |i| tokens[i].text.as_str());
        if before(1) == "0" || before(1) == "/" && before(3) == "0" {
            continue;
        }
        for wrong in misspellings(&name.text) {
            let said = said(name, &wrong);
            found += usize::from(said.found);
            free += usize::from(!said.found && said.errors == 0);
            if !said.cascades.is_empty() {
                let line = WHOLE[..name.at].matches('\n').count() + 1;
                faults.push(format!(
                    "line {line}: `{}` as `{wrong}`:\n{}",
                    name.text,
                    said.cascades.concat()
                ));
            }
        }
    }
    // Left: the name of a part where it is made, since what others are given by it is then missing.
    assert!(faults.len() <= LEFT, "{} faults:\n{}", faults.len(), faults.concat());
    assert!(found > 500 && free < 200, "{found} are found where they stand, of {free} nothing is said");
}
