//! What a text may name, how much is said of it, and what is left alone.

#![allow(clippy::disallowed_methods, reason = "the test makes a pipe")]

mod support;

use tempfile::TempDir;

use support::{command, expect_code, folder, hrdsl_in, scenario, stderr, stdout};

const SECRET: &str = "s3cret: hunter2\n";

/// A project with a scenario that uses `path`, and a secret beside it.
fn using(path: &str) -> tempfile::TempDir {
    let text = scenario("a", "wave").replacen('\n', &format!("\n\nuse \"{path}\"\n"), 1);
    folder(&[
        ("project/.git/config", SECRET),
        ("project/deep/a.hri", &text),
        ("project/words.hri", "const FEW = 3\n"),
        ("project/.env", SECRET),
        ("outside/words.hri", "const FEW = 3\n"),
        ("outside/secret.hri", SECRET),
    ])
}

#[test]
fn a_text_uses_the_files_of_its_project() {
    let here = using("../words.hri");
    expect_code(&hrdsl_in(here.path(), "check project/deep/a.hri"), 0);
    std::fs::remove_dir_all(here.path().join("project/.git")).unwrap();
    let out = hrdsl_in(here.path(), "check project/deep/a.hri");
    expect_code(&out, 1);
    assert!(
        stderr(&out).contains("is outside of") && stderr(&out).contains("--allow-path"),
        "{}",
        stderr(&out)
    );
    expect_code(&hrdsl_in(here.path(), "check project/deep/a.hri --allow-path project"), 0);
    expect_code(&hrdsl_in(here.path(), "--allow-path project emit ast project/deep/a.hri"), 0);
    expect_code(&hrdsl_in(here.path(), "check project/deep/a.hri --allow-path nowhere"), 2);
}

#[test]
fn what_is_no_file_of_the_project_is_not_shown() {
    for path in [
        "../../outside/secret.hri",
        "/etc/passwd",
        "../.env",
        "../.git/config",
        "/dev/zero",
        "..",
        "link.hri",
        "env.hri",
        "pipe.hri",
    ] {
        let here = using(path);
        let deep = here.path().join("project/deep");
        std::os::unix::fs::symlink(here.path().join("outside/secret.hri"), deep.join("link.hri")).unwrap();
        std::os::unix::fs::symlink(deep.join("../.env"), deep.join("env.hri")).unwrap();
        let made = std::process::Command::new("mkfifo").arg(deep.join("pipe.hri")).status();
        assert!(made.is_ok_and(|s| s.success()));
        for line in ["check a.hri", "gen a.hri", "emit ast a.hri", "check --format json a.hri", "prove a.hri"]
        {
            let out = hrdsl_in(&deep, line);
            let said = stderr(&out) + &stdout(&out);
            assert_eq!(out.status.code(), Some(1), "{path}: {line}: {said}");
            assert!(!said.contains("hunter2") && !said.contains("root:"), "{path}: {line}: {said}");
        }
    }
}

#[test]
fn a_program_includes_the_files_of_its_project() {
    for (path, code) in
        [("more.asl", 0), ("/dev/zero", 1), ("/etc/passwd", 1), ("../secret.asl", 1), (".env", 1)]
    {
        let text = format!("{{ include(\"{path}\") }}\n!go.\n+!go <- wave.\n");
        let here = folder(&[
            ("p/a.asl", &text),
            ("p/more.asl", "+!rest <- wave.\n"),
            ("secret.asl", SECRET),
            ("p/.env", SECRET),
        ]);
        let out = hrdsl_in(here.path(), "import agentspeak p/a.asl");
        expect_code(&out, code);
        assert!(!stderr(&out).contains("hunter2") && !stderr(&out).contains("root:"), "{}", stderr(&out));
    }
}

/// Each file includes the next one twice.
#[test]
fn what_grows_when_it_is_read_is_refused() {
    let pad = format!("// {}\n", "x".repeat(60_000));
    let names: Vec<String> = (0..20).map(|i| format!("a{i}.asl")).collect();
    let texts: Vec<String> =
        (1..=20).map(|i| format!("{{ include(\"a{i}.asl\") }}\n").repeat(2) + &pad).collect();
    let mut files: Vec<(&str, &str)> =
        names.iter().map(String::as_str).zip(texts.iter().map(String::as_str)).collect();
    files.push(("a20.asl", "!go.\n"));
    let here = folder(&files);
    let out = hrdsl_in(here.path(), "import agentspeak a0.asl");
    expect_code(&out, 1);
    assert!(stderr(&out).contains("are larger than 8 MiB"), "{}", stderr(&out));

    let entity = format!(
        "<!DOCTYPE nta [<!ENTITY a \"{}\">]><nta><declaration>{}</declaration></nta>",
        "x".repeat(50_000),
        "&a;".repeat(50_000)
    );
    let attributes: String = (0..200_000).map(|i| format!(" a{i}=\"1\"")).collect();
    let plans: String = (0..10_000).map(|i| format!("+!g{i} <- act.\n")).collect();
    let here =
        folder(&[("e.xml", &entity), ("a.xml", &format!("<nta><b{attributes}/></nta>")), ("p.asl", &plans)]);
    for (line, what) in [
        ("import uppaal e.xml", "entities are not read"),
        ("import uppaal a.xml", "more than 100 attributes"),
        ("import agentspeak p.asl", "at most 3000 are imported at once"),
    ] {
        let out = hrdsl_in(here.path(), line);
        expect_code(&out, 1);
        assert!(stderr(&out).contains(what), "{}", stderr(&out));
    }
}

#[test]
fn so_many_findings_of_a_file_are_shown() {
    let wrong: String = (0..60).map(|i| format!("assume at most 1 nothing_{i} within 1 s\n")).collect();
    let unused: String = (0..70).map(|i| format!("const A{i} = 1\n")).collect();
    let here = folder(&[
        ("wrong.hri", &(scenario("w", "wave") + &wrong)),
        ("unused.hri", &(scenario("u", "wave") + &unused)),
    ]);
    let shown = |line: &str| {
        let out = hrdsl_in(here.path(), line);
        let said = stderr(&out);
        (said.matches("  × ").count() + said.matches("  ⚠ ").count(), said)
    };
    let (count, said) = shown("check wrong.hri unused.hri");
    assert_eq!(count, 100, "{said}");
    assert!(
        said.contains("wrong.hri: 10 errors more are not shown (`hrdsl check --max-findings 0` shows all)"),
        "{said}"
    );
    assert!(
        said.contains("unused.hri: 20 warnings more") && said.contains("60 errors, 70 warnings"),
        "{said}"
    );
    assert_eq!(shown("check --max-findings 0 wrong.hri unused.hri").0, 130);
    assert_eq!(shown("check --max-findings 3 wrong.hri").0, 3);
    let out = hrdsl_in(here.path(), "check --format json wrong.hri");
    let document: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(document["diagnostics"].as_array().unwrap().len(), 60);
}

#[test]
fn results_are_not_searched_unless_they_are_named() {
    let random = "suite some by random { stimuli wave }\n";
    let here =
        folder(&[("scenario.hri", &(scenario("a", "wave") + random)), ("own/t.hri", "test a.t { wave }\n")]);
    expect_code(&hrdsl_in(here.path(), "gen scenario.hri -o made"), 0);
    assert!(here.path().join("made/.hrdsl-results").exists());
    std::fs::write(here.path().join("made/some.hri"), "test some.t { no_longer_there }\n").unwrap();
    expect_code(&hrdsl_in(here.path(), "check ."), 0);
    expect_code(&hrdsl_in(here.path(), "check made scenario.hri"), 1);
    // One's own files beside them are searched.
    expect_code(&hrdsl_in(here.path(), "gen scenario.hri -o own"), 0);
    expect_code(&hrdsl_in(here.path(), "check ."), 0);
    std::fs::write(here.path().join("own/t.hri"), "test a.t { not_there }\n").unwrap();
    expect_code(&hrdsl_in(here.path(), "check ."), 1);
}

#[test]
fn more_tests_than_can_be_held_are_refused() {
    let text = scenario("a", "wave") + "suite some by random { stimuli wave }\n";
    let here = folder(&[("a.hri", &text)]);
    let mut gen_ = command();
    let out = gen_.args(["gen", "a.hri", "-n", "1000000000"]).current_dir(here.path()).output().unwrap();
    expect_code(&out, 2);
    assert!(stderr(&out).contains("at most 20000"), "{}", stderr(&out));
}

/// A scenario whose agent takes up ever more.
fn growing(body: &str) -> TempDir {
    let listens = "agent Robot plays robot { belief heard(n: int) }";
    let text = format!(
        "scenario g\nactor human : environment\nactor robot : environment\nactor arm : system\n\
         agent Human plays human {{\n{body}\n}}\n{listens}\n\
         suite all by agents Human, Robot {{ explore exhaustive horizon 300 s }}\n"
    );
    folder(&[("g.hri", &text)])
}

/// What an agent does, and what is said of it.
const GROWING: [(&str, &str); 6] = [
    (
        "goal !g
         plan @grow +!g { !!h; !!g }
         plan @idle +!h { wait 1 h }",
        "100000 intentions at once: most of them of the plan `idle`",
    ),
    (
        "goal !g
         plan @grow +!g { !!h; wait 1 ms; !g }
         plan @idle +!h { wait 1 h }",
        "100000 intentions at once: most of them of the plan `idle`",
    ),
    (
        "goal !g
         plan @grow +!g { fork { wait 1 h } and { !g } }",
        "100000 intentions at once: most of them of the plan `grow`",
    ),
    (
        "belief b(n: int)
         goal !g(0)
         plan @grow +!g(N) { +b(N); !g(N + 1) }",
        "100000 facts at once: most of them of the belief `b`; the last step was of the plan `grow`",
    ),
    (
        "goal !g(0)
         plan @grow +!g(N) { .send(Robot, tell, heard(N)); !g(N + 1) }",
        "100000 messages at once: the last step was of the plan `grow`",
    ),
    (
        "belief b(n: int)
         goal !g(0)
         plan +!g(N) when N < 3000 { +b(N); !g(N + 1) }
         plan @pairs +!g(N) { for b(X) && b(Y) { .print(X) } }",
        "5000000 values on its stacks at once: most of them of the plan `pairs`",
    ),
];

#[test]
fn an_agent_that_holds_ever_more_ends_its_run() {
    for (body, what) in GROWING {
        let here = growing(body);
        let out = hrdsl_in(here.path(), "gen g.hri");
        expect_code(&out, 2);
        let said = stderr(&out);
        assert!(said.contains("agent `Human`: holds more than ") && said.contains(what), "{body}: {said}");
        let out = hrdsl_in(here.path(), "inspect g.hri all --from 299");
        expect_code(&out, 1);
        let said = stdout(&out);
        assert!(said.contains("holding bound") && said.contains(what), "{body}: {}", stderr(&out));
    }
}
