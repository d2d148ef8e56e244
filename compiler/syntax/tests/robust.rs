//! Whatever the text: no panic, spans inside the text, and every `Error` node has its diagnostic.

use hrdsl_source::{Diagnostic, FileId};
use hrdsl_syntax::ast::FileSyntax;
use hrdsl_syntax::parse;
use proptest::prelude::*;

const SCENARIO: &str =
    concat!(include_str!("../../../examples/handover/scenario.hri"), include_str!("texts/agents.hri"));

/// Parses, and checks what holds for every text.
fn check(text: &str) -> (FileSyntax, Vec<Diagnostic>) {
    let (file, diagnostics) = parse(FileId(0), text);
    for label in diagnostics.iter().flat_map(|d| &d.labels) {
        assert!(text.get(label.span.range()).is_some(), "span {:?} of {text:?}", label.span);
    }
    let tree = serde_json::to_string(&file).expect("trees are plain data");
    let broken = tree.contains("\"kind\":\"error\"") || tree.contains("\"pattern\":{\"kind\":\"error\"");
    assert!(!broken || !diagnostics.is_empty(), "a silent error in {text:?}");
    assert!(diagnostics.is_sorted_by_key(|d| d.span().start), "not in the order of the text");
    (file, diagnostics)
}

/// The tokens of the scenario, roughly.
fn pieces() -> Vec<&'static str> {
    let mut pieces: Vec<&str> = SCENARIO
        .split_inclusive(|c: char| !c.is_alphanumeric() && c != '_')
        .flat_map(|p| {
            let at = p.char_indices().next_back().map_or(0, |(i, _)| i);
            [&p[..at], &p[at..]]
        })
        .collect();
    pieces.retain(|p| !p.is_empty());
    pieces
}

fn braces(text: &str) -> i64 {
    text.bytes().map(|b| i64::from(b == b'{') - i64::from(b == b'}')).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        check(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn characters(text in "\\PC{0,200}") {
        check(&text);
    }

    #[test]
    fn tokens(picks in prop::collection::vec(any::<prop::sample::Index>(), 0..200)) {
        let pieces = pieces();
        let text: Vec<&str> = picks.iter().map(|i| *i.get(&pieces)).collect();
        check(&text.join(" "));
        check(&text.concat());
    }

    /// What the file has before the cut stays; an open block is reported.
    #[test]
    fn truncated(at in any::<prop::sample::Index>()) {
        let mut at = at.index(SCENARIO.len());
        while !SCENARIO.is_char_boundary(at) {
            at -= 1;
        }
        let text = &SCENARIO[..at];
        let (_, diagnostics) = check(text);
        if braces(text) != 0 {
            prop_assert!(!diagnostics.is_empty());
        }
    }

    /// One brace less: reported, and most declarations are still there.
    #[test]
    fn without_a_brace(pick in any::<prop::sample::Index>()) {
        let places: Vec<usize> =
            SCENARIO.char_indices().filter(|(_, c)| matches!(c, '{' | '}')).map(|(i, _)| i).collect();
        let at = *pick.get(&places);
        let text = format!("{}{}", &SCENARIO[..at], &SCENARIO[at + 1..]);
        let (file, diagnostics) = check(&text);
        prop_assert!(!diagnostics.is_empty());
        prop_assert!(diagnostics.len() <= 12, "{}: {diagnostics:#?}", &SCENARIO[at..][..40]);
        prop_assert!(file.items.len() >= 50, "{} items", file.items.len());
    }

    /// A few pieces less, twice, or swapped.
    #[test]
    fn mangled(edits in prop::collection::vec((any::<prop::sample::Index>(), 0..3_u8), 1..6)) {
        let mut pieces = pieces();
        for (at, edit) in edits {
            let at = at.index(pieces.len() - 1);
            match edit {
                0 => { pieces.remove(at); }
                1 => { let piece = pieces[at]; pieces.insert(at, piece); }
                _ => pieces.swap(at, at + 1),
            }
        }
        check(&pieces.concat());
    }
}

/// Megabytes of one token must neither hang nor overflow.
#[test]
fn runs() {
    for piece in [
        "{",
        "}",
        "(",
        ")",
        "if ",
        "if a { ",
        "if a { } ",
        "if a { } else ",
        "while a { b ",
        "fork { ",
        "fork { } and { } ",
        "for a { } fork { a; } or ",
        "rule a(X) when ",
        "[",
        "[a | ",
        "~",
        ".f(",
        "a[b] ",
        "- ",
        "!",
        "!!",
        "a ",
        "a.",
        "1 s ",
        "\"",
        "/",
        "///\n",
        ";",
        "plan +!a { ",
        "agent A plays b { ",
        "test t { x ",
    ] {
        check(&piece.repeat(20_000));
        check(&format!("agent A plays b {{ plan +!a {{ {} }} }}", piece.repeat(5_000)));
        check(&format!("stimulus A by b {{ {} }}", piece.repeat(5_000)));
        check(&format!("automaton A plays b {{ a -> b when {} }}", piece.repeat(5_000)));
    }
}
