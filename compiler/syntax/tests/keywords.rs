//! One registry of keywords: the grammar uses all of them, soft ones can be names, and the rules of the specification (generated
//! by a test of the documents) use all of them.

use hrdsl_source::FileId;
use hrdsl_syntax::ast::{ExprSyntaxKind, ItemSyntaxKind};
use hrdsl_syntax::parse;
use hrdsl_syntax::token::{KEYWORDS, KeywordClass};

const SPEC: &str = include_str!("../../../spec/grammar.md");
const LEXICAL: &str = include_str!("../../../spec/lexical.md");

#[test]
fn the_grammar_uses_every_keyword() {
    let rules = include_str!("../src/grammar.lalrpop").split("extern {").next().unwrap_or("");
    for keyword in KEYWORDS.iter().filter(|k| k.word != "scenario") {
        assert!(rules.contains(&format!("\"{}\"", keyword.word)), "{}", keyword.word);
    }
}

/// Every keyword that is not reserved, as a name in every place that the grammar does not need for the keyword itself;
/// `if` is one where no condition can follow (`compiler/tests/words.rs`).
#[test]
fn keywords_are_names() {
    for word in
        KEYWORDS.iter().filter(|k| k.class != KeywordClass::Reserved && k.word != "if").map(|k| k.word)
    {
        let text = format!(
            "actor {word} : {word}
             const {word} = {word}
             event {word}({word}: {word}) from {word} to {word}, {word}
             stimulus {word}({word}: {word}) by {word} {{ emit {word} sample {word} in {word} .. {word} {word}.{word}() }}
             agent {word} plays {word} {{ belief {word} = {word}({word}) goal !{word}
               belief {word}({word}: [{word}]) [{word}: {word}] on {word} = ~{word}[{word}({word})] goal {word}({word}: {word})
               rule {word}({word}, [{word} | {word}])[{word}] when {word}({word})[{word}, {word}] && .{word} && {word}
               plan @{word} +!{word} when {word} {{ !{word}; +{word}; await {word} | {word} }}
               plan @{word}[{word}] -?{word}[{word}] when ~{word} || {word}[{word}] = {word} {{
                 if {word} {{ !{word} within {word} }} else if {word} {{ ?({word} = {word}) }} else {{ .{word}({word}, [{word}]) }}
                 while {word} {{ -~{word}[{word}]; }} for {word}({word}) {{ }} fork {{ +{word} }} and {{ .{word} }} }} }}
             automaton {word} plays {word} {{ clock {word} location {word} {word} -> {word} on {word} when {word} < 3
               location {word} }}
             network {word} = {word} | {word}
             require {word} {word} never {word} while {word} > {word}
             require {word} {word} x causes {word} or {word} within {word}
             cover {word} = count({word}) bins {word} = {word}
             cross {word} = {word} * {word} {{ ignore when {word}.{word} }}
             suite {word} by agents {word}, {word} {{ choose one {word} of {word} per {word} where {word}({word}) && {word} explore {word} }}
             part {word} {{ body {word}: {word} {word}({word}) at {word} joint {word}: {word} -> {word} at {word}
               axis {word} limits {word} .. {word} current {word} in {word} by {word}.{word}
               on x emit {word} on {word} x.{word} emit {word} }}
             device {word} {{ command {word} do {word} command {word}({word}: {word}?) do {word} expect {word} else \"x\" }}
             test {word}.{word} {{ method {word}; await {word} within {word} }}"
        );
        let (_, diagnostics) = parse(FileId(0), &text);
        assert!(diagnostics.is_empty(), "{word}: {diagnostics:#?}");
    }
}

#[test]
fn reserved_words_are_not() {
    for keyword in KEYWORDS.iter().filter(|k| k.class == KeywordClass::Reserved) {
        let (_, diagnostics) = parse(FileId(0), &format!("event {} from a", keyword.word));
        assert!(!diagnostics.is_empty(), "{}", keyword.word);
        let (_, diagnostics) = parse(FileId(0), &format!("const a = b.{}", keyword.word));
        assert!(diagnostics.is_empty(), "{}: after a dot it is a name", keyword.word);
    }
}

/// A number and a keyword on the same line are not a quantity.
#[test]
fn keywords_are_not_units() {
    for keyword in KEYWORDS {
        let (file, _) = parse(FileId(0), &format!("const a = 5 {} ", keyword.word));
        let ItemSyntaxKind::Const { value, .. } = &file.items[0].kind else { panic!("{}", keyword.word) };
        assert!(!matches!(value.kind, ExprSyntaxKind::Quantity { .. }), "{}", keyword.word);
    }
}

/// Every word in quotes in the EBNF is a keyword, and every keyword is there.
#[test]
fn the_ebnf_uses_them() {
    let ebnf: String = SPEC.split("```").skip(1).step_by(2).filter(|b| b.starts_with("ebnf")).collect();
    let mut quoted: Vec<&str> = ebnf.split('"').skip(1).step_by(2).collect();
    // The marks of queries begin with a letter, and are no words.
    quoted.retain(|w| w.starts_with(|c: char| c.is_ascii_alphabetic()) && !w.ends_with(['>', ']']));
    for keyword in KEYWORDS {
        assert!(quoted.contains(&keyword.word), "`{}` is not in the EBNF", keyword.word);
    }
    for word in quoted {
        assert!(KEYWORDS.iter().any(|k| k.word == word), "`{word}` is not a keyword");
    }
}

/// The blocks of the two pages are read without fault.
#[test]
fn the_examples_are_read() {
    let mut blocks = 0;
    for page in [SPEC, LEXICAL] {
        for block in page.split("```").skip(1).step_by(2).filter_map(|b| b.strip_prefix("hri\n")) {
            let (_, diagnostics) = parse(FileId(0), block);
            assert!(diagnostics.is_empty(), "{block}\n{diagnostics:#?}");
            blocks += 1;
        }
    }
    assert!(blocks >= 2);
}
