//! The resolution table: every name of the examples means something, and what it means is where it should be.

#![allow(clippy::disallowed_methods, reason = "the test reads the examples")]

use std::{collections::BTreeSet, fs, path::Path};

use hrdsl_compiler::{CompilationResult, InputFile, compile};
use hrdsl_model::{DefinedType, INTERNAL_ACTIONS, NameDefinition, UNITS, type_named};
use hrdsl_source::FileId;
use hrdsl_syntax::token::KEYWORDS;

fn examples() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path().join("scenario.hri");
        // Whoever names a workspace, or a module of its own, needs files, which this test does not give.
        let alone = |text: &String| !text.contains("messages \"") && !text.contains("use \"");
        if let Some(text) = fs::read_to_string(&path).ok().filter(alone) {
            found.push((path.display().to_string(), text));
        }
    }
    found.sort();
    assert!(found.len() >= 2);
    found
}

fn compiled(name: &str, text: &str) -> CompilationResult {
    let c = compile(InputFile { name, text }, &[]);
    assert!(c.program.is_some(), "{name}: {:?}", c.diagnostics);
    c
}

/// What a word of the first file means.
fn meanings(c: &CompilationResult, at: usize) -> Vec<NameDefinition> {
    c.scenario.as_ref().unwrap().names.at(FileId(0), at).cloned().collect()
}

/// Names of the language that are in no table: roles, functions, fields, methods, kinds.
const FIXED: &str = "\
    environment system safety functional abs min max norm distance range angle visible \
    holds joint_speed joint_position touches tilt speed rising falling x y z move_to look_at grasp let_go walk_to turn_to fixed dynamic kinematic guided box \
    sphere capsule cylinder pairwise wise random learn exhaustive each plan context message \
    path location edge bin shortest fastest any earliest latest sampled violation trigger \
    query source atomic tell achieve self percept clock event cover";

/// Words that the language gives a meaning to, not the scenario.
fn is_of_the_language(word: &str) -> bool {
    FIXED.split(' ').any(|fixed| fixed == word)
        || KEYWORDS.iter().any(|k| k.word == word)
        || UNITS.iter().any(|u| u.symbol == word)
        || type_named(word).is_some()
        || INTERNAL_ACTIONS.iter().any(|a| a.name == word)
}

#[test]
fn every_name_of_the_examples_means_something() {
    let mut lost = BTreeSet::new();
    for (name, text) in examples() {
        let c = compiled(&name, &text);
        let used = text.lines().scan(0, |at, line| {
            let start = *at;
            *at += line.len() + 1;
            Some((start, line))
        });
        for (start, line) in used {
            let code = line.split("//").next().unwrap_or("");
            // Modules, codes of diagnostics and the scenario's own name are no definitions.
            if ["use ", "scenario ", "allow "].iter().any(|word| code.trim_start().starts_with(word)) {
                continue;
            }
            let mut quoted = false;
            for (at, c_) in code.char_indices() {
                quoted ^= c_ == '"';
                let begins = (c_.is_alphabetic() || c_ == '_')
                    && !code[..at].ends_with(|p: char| p.is_alphanumeric() || p == '_');
                if quoted || !begins {
                    continue;
                }
                let word = code[at..].split(|p: char| !p.is_alphanumeric() && p != '_').next().unwrap_or("");
                if word != "_" && !is_of_the_language(word) && meanings(&c, start + at).is_empty() {
                    lost.insert(format!(
                        "{}: `{word}` in `{}`",
                        c.files.place(hrdsl_source::Span::new(FileId(0), start + at, start + at + 1)),
                        line.trim()
                    ));
                }
            }
        }
    }
    assert!(
        lost.is_empty(),
        "{} names mean nothing:\n{}",
        lost.len(),
        lost.into_iter().collect::<Vec<_>>().join("\n")
    );
}

const SMALL: &str = "scenario small\nactor person : environment\nactor robot : system\n\
/// How sure.\nconst SURE = 3 m\nenum Order { feed, clean }\n\
event asked(what: Order, far: length) from person\nevent done from robot\n\
agent Human plays person {\n  /// What it wants.\n  belief wants(what: Order) = wants(feed)\n  \
plan +!go when wants(W) { asked(W, SURE) }\n  goal !go\n}\n";

/// The place of the nth occurrence of a word.
fn nth(word: &str, n: usize) -> usize {
    SMALL.match_indices(word).nth(n).unwrap().0
}

#[test]
fn a_use_has_its_definition_and_that_its_type_and_documentation() {
    let c = compiled("small.hri", SMALL);
    let one = |at: usize| -> NameDefinition {
        let all = meanings(&c, at);
        assert_eq!(all.len(), 1, "{all:?}");
        all[0].clone()
    };
    let text = |span| c.files.text(span);
    let sure = one(nth("SURE", 1));
    assert_eq!((sure.noun, sure.doc.as_str(), text(sure.place)), ("constant", "How sure.", "SURE"));
    assert_eq!(sure.ty, DefinedType::Inferred("a length".to_owned()));
    assert_eq!(text(sure.whole), "const SURE = 3 m");
    let wants = one(nth("wants", 2));
    assert_eq!((wants.noun, wants.doc.as_str()), ("belief", "What it wants."));
    let far = one(nth("far", 0));
    let DefinedType::Written(ty) = far.ty else { panic!("{far:?}") };
    assert_eq!((far.noun, text(ty)), ("parameter", "length"));
    // The variable is defined where it is bound, and its type follows from the belief.
    let bound = one(nth("(W, SURE", 0) + 1);
    assert_eq!((bound.noun, bound.place.start as usize), ("variable", nth("(W)", 0) + 1));
    assert_eq!(bound.ty, DefinedType::Inferred("a value of `Order`".to_owned()));
    let names = &c.scenario.as_ref().unwrap().names;
    let goal = one(nth("!go", 1) + 1);
    assert_eq!((goal.noun, names.uses_of(goal.place).count()), ("goal", 1));
    assert!(!names.is_used(one(nth("done", 0)).place));
}

#[test]
fn the_uses_in_a_template_are_those_of_all_its_instances() {
    let text = "scenario small\nactor person : environment\nactor robot : system\nevent a from person\nevent b from person\n\
                cover Seen(what: event) = count(what) bins no = 0, yes = 1..\ncover as = Seen(a)\ncover bs = Seen(b)\n";
    let c = compiled("small.hri", text);
    let at = text.find("count(what").unwrap() + "count(".len();
    let all = meanings(&c, at);
    assert_eq!((all.len(), all[0].noun), (1, "parameter"));
    let seen = meanings(&c, text.find("Seen").unwrap());
    assert_eq!(c.scenario.as_ref().unwrap().names.uses_of(seen[0].place).count(), 2);
}
