//! Jason programs to scenarios: each program of `tests/agentspeak` against its expected text and report.
//!
//! `HRDSL_UPDATE=1 cargo test -p hrdsl-interop` writes the expected files anew; the difference is read.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_interop::{
    ForeignLoader, ForeignSource, ImportedScenario, NoForeignFiles, NoteSeverity, SyntaxError,
    agentspeak::{AgentSpeakOptions, import},
};
use hrdsl_source::FileId;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agentspeak")
}

/// The files of the folder of programs.
struct Disk;

impl ForeignLoader for Disk {
    fn load(&self, from: &str, path: &str) -> Result<ForeignSource, String> {
        let folder = Path::new(from).parent().unwrap();
        let name = folder.join(path).display().to_string();
        let text = fs::read_to_string(root().join(&name)).map_err(|_| format!("there is no file {name}"))?;
        Ok(ForeignSource { name, text })
    }
}

fn from_files(names: &[&str]) -> Result<ImportedScenario, Vec<SyntaxError>> {
    let source =
        |n: &&str| ForeignSource { name: (*n).to_owned(), text: fs::read_to_string(root().join(n)).unwrap() };
    let files: Vec<ForeignSource> = names.iter().map(source).collect();
    import(&files, &Disk, &AgentSpeakOptions::default())
}

fn from_text(text: &str) -> ImportedScenario {
    let files = [ForeignSource { name: "bob.asl".to_owned(), text: text.to_owned() }];
    import(&files, &NoForeignFiles, &AgentSpeakOptions::default()).unwrap_or_else(|e| panic!("{e:?}"))
}

fn report(result: &Result<ImportedScenario, Vec<SyntaxError>>) -> String {
    match result {
        Ok(imported) => imported.notes.iter().map(|n| format!("{n}\n")).collect(),
        Err(errors) => errors.iter().map(|e| format!("{e}\n")).collect(),
    }
}

/// The text can be read, and is in the style of the language.
fn is_readable(text: &str, name: &str) {
    let (_, diagnostics) = hrdsl_syntax::parse(FileId(0), text);
    let said: Vec<String> =
        diagnostics.iter().map(|d| format!("{} at {}", d.message, d.span().start)).collect();
    assert_eq!(said, Vec::<String>::new(), "{name}:\n{text}");
    assert_eq!(hrdsl_syntax::format(text).unwrap(), text, "{name} is formatted");
}

fn compare(file: &str, text: &str) {
    let path = root().join("expected").join(file);
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(text, expected, "{file}");
}

const PROGRAMS: &[&[&str]] = &[
    &["domestic/domestic.mas2j"],
    &["contract_net/cnp.mas2j"],
    &["counter.asl"],
    &["quirks.asl"],
    &["words.asl"],
    &["include.asl"],
    &["ask.asl"],
    &["lists.asl"],
    &["values.asl"],
    &["terms.asl"],
    &["control.asl"],
    &["domestic/src/owner.asl"],
    &["contract_net/p.asl", "contract_net/c.asl", "contract_net/pr.asl"],
    &["contract_net/pr.asl"],
];

#[test]
fn programs_become_scenarios() {
    for files in PROGRAMS {
        let name = files[0].replace('/', "_");
        let result = from_files(files);
        compare(&format!("{name}.txt"), &report(&result));
        let imported = result.unwrap_or_else(|e| panic!("{name}: {e:?}"));
        is_readable(&imported.text, &name);
        compare(&format!("{name}.hri"), &imported.text);
        let comments = imported.text.matches("// not carried over: ").count();
        let left_out = imported.notes.iter().filter(|n| n.severity == NoteSeverity::LeftOut).count();
        assert!(comments >= left_out, "{name}: {left_out} are left out, and {comments} comments say so");
    }
}

#[test]
fn what_cannot_be_read_is_said() {
    for file in ["broken.asl", "crew/crew.mas2j"] {
        let result = from_files(&[file]);
        assert!(result.is_err(), "{file}");
        compare(&format!("{}.txt", file.replace('/', "_")), &report(&result));
    }
}

/// Whatever is cut out of a program: nothing panics, and what is imported can be read.
#[test]
fn any_text_is_an_error_or_a_scenario() {
    let all = PROGRAMS.iter().flat_map(|p| p.iter()).filter(|p| p.ends_with(".asl"));
    for name in
        all.chain(&["broken.asl", "domestic/src/robot.asl", "domestic/src/shop.asl", "contract_net/c.asl"])
    {
        let text = fs::read_to_string(root().join(name)).unwrap();
        let places: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
        for (n, start) in places.iter().enumerate().step_by(23) {
            for length in [1, 2, 9, 60] {
                let end = places.get(n + length).copied().unwrap_or(text.len());
                let cut = format!("{}{}", &text[..*start], &text[end..]);
                let files = [ForeignSource { name: "bob.asl".to_owned(), text: cut }];
                if let Ok(imported) = import(&files, &NoForeignFiles, &AgentSpeakOptions::default()) {
                    is_readable(&imported.text, name);
                }
            }
        }
    }
}

#[test]
fn deep_texts_are_refused() {
    for text in [
        format!("b({}1{}).", "f(".repeat(5000), ")".repeat(5000)),
        format!("!g. +!g <- {}a{}.", "{".repeat(5000), "}".repeat(5000)),
        format!("+!g : {}b.", "not ".repeat(100_000)),
        format!("b({}1).", "-".repeat(100_000)),
        format!("+!g <- {}x.", "x |&| ".repeat(100_000)),
    ] {
        let files = [ForeignSource { name: "bob.asl".to_owned(), text }];
        let said = report(&import(&files, &NoForeignFiles, &AgentSpeakOptions::default()));
        assert!(said.contains("too deep"), "{said}");
    }
}

fn messages(imported: &ImportedScenario, severity: NoteSeverity) -> Vec<&str> {
    imported.notes.iter().filter(|n| n.severity == severity).map(|n| n.message.as_str()).collect()
}

#[test]
fn types_come_from_where_values_meet() {
    let of = |text: &str| from_text(text).text;
    assert!(of("b(1). c(X) :- b(X).").contains("belief c(x: int)"));
    assert!(of("b(1). c(2.5). d(X) :- b(X) & c(X).").contains("belief b(x: float) = b(1.0)"));
    assert!(of("b(red). c(green). d :- b(X) & c(X).").contains("belief c(x: BKind) = c(green)"));
    assert!(
        of("b(\"x\"). c([\"y\"]). +!g <- .concat(\"a\", 1, S); +e(S).\n!g.").contains("belief e(s: string)")
    );
    assert!(of("likes(bob). b(X) :- likes(X).").contains("belief likes(x: agent) = likes(bob)"));
    assert!(
        of("at(pos(1, 2.5)). near(P) :- at(P).").contains("belief at(p_1: int, p_2: float) = at(1, 2.5)")
    );
    assert!(
        of("l([p(1, a)]). !g. +!g : l([p(X, Y) | T]) <- .print(X, Y, T).")
            .contains("l([X | T_1], [Y | T_2])")
    );
}

#[test]
fn what_does_not_fit_is_left_out_alone() {
    let imported =
        from_text("b(1).\nb(N) :- b(s(N)).\n!g.\n+!g : b(N) & N > 0 <- .length(N, \"t\"); .print(N).\n");
    assert_eq!(
        messages(&imported, NoteSeverity::LeftOut),
        [
            "a value would contain others of its own type, to any depth: it has no fixed number of parts",
            "a number meets a string"
        ]
    );
    assert!(imported.text.contains(".print(N)") && imported.text.contains("belief b(n: int) = b(1)"));
    let places: Vec<(u32, u32)> = imported.notes.iter().map(|n| (n.line, n.column)).collect();
    assert!(places.contains(&(2, 1)) && places.contains(&(4, 23)), "{places:?}");
}

#[test]
fn values_of_several_types_are_a_tag_and_parts() {
    let imported = from_text("b(1).\nb(x).\n!g.\n+!g : b(N) & N > 0 <- +b(\"t\"); .print(N).\n");
    assert_eq!(messages(&imported, NoteSeverity::LeftOut), Vec::<&str>::new());
    assert!(
        imported.text.contains("b(BTag.number, 1, x, \"\"), b(BTag.atom, 0, x, \"\")"),
        "{}",
        imported.text
    );
    let listed = from_text("b(1).\nb(x).\n!g.\n+!g <- .findall(X, b(X), L); .print(L).\n");
    assert_eq!(
        messages(&listed, NoteSeverity::LeftOut),
        ["a list of values of several types cannot be printed"]
    );
    // The plan stays, for what it is asked of are numbers as a rule.
    let best = from_text("best(none).\n!b(3).\n+!b(N) : best(M) & N > M <- -+best(N).\n");
    assert_eq!(messages(&best, NoteSeverity::LeftOut), Vec::<&str>::new());
    let said = messages(&best, NoteSeverity::Warning);
    assert!(said.iter().any(|m| m.ends_with("of two that differ, this never holds")), "{said:?}");
}

#[test]
fn a_rule_needs_what_it_reads_first() {
    let imported = from_text("r(X, Y) :- Y = X * 2.\n!g.\n+!g <- ?r(2, A); ?r(B, 4); .print(A).\n");
    assert!(imported.text.contains("?r(2, A);"), "{}", imported.text);
    assert_eq!(messages(&imported, NoteSeverity::LeftOut), ["`B` has no value here"]);
}

#[test]
fn a_misspelt_belief_has_a_nearest_name() {
    let imported = from_text("battery(5).\n!g.\n+!g : batery(N) <- .print(N).\n");
    let warnings = messages(&imported, NoteSeverity::Warning);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].ends_with("did you mean `battery`?"), "{warnings:?}");
    assert_eq!(messages(&from_text("b. !g. +!g : b <- -b."), NoteSeverity::Warning), Vec::<&str>::new());
}

#[test]
fn agents_of_a_number_have_numbers() {
    let files = [ForeignSource {
        name: "m.mas2j".to_owned(),
        text: "MAS m { agents: w work.asl [goals=\"go(2)\"] #2; }".to_owned(),
    }];
    struct One;
    impl ForeignLoader for One {
        fn load(&self, _: &str, path: &str) -> Result<ForeignSource, String> {
            let text = "+!go(N) <- dig(N); .send(w2, tell, done(N)).\n+done(_).".to_owned();
            Ok(ForeignSource { name: path.to_owned(), text })
        }
    }
    let text = import(&files, &One, &AgentSpeakOptions::default()).unwrap().text;
    for piece in [
        "agent w1 plays w1[jason] {",
        "agent w2 plays w2[jason] {",
        "stimulus w1_dig(n: int) by w1",
        "goal !go(2)",
        "w2_dig(N)",
    ] {
        assert!(text.contains(piece), "{piece}: {text}");
    }
    is_readable(&text, "m");
}
