//! Texts and names that would steer a terminal, and places far to the right, are shown and do no harm.

mod support;

use support::{command, expect_code, folder, hrdsl_in, scenario, stderr, stdout};

/// What a terminal obeys, and what turns the direction of writing; a colour, too, is none of ours.
const EVIL: &str = "\u{1b}[2J\u{1b}]0;mine\u{7}\u{1b}[31m\u{9b}1m\u{202e}\u{2066}\r\u{8}";

fn is_harmless(text: &str) -> bool {
    !text.chars().any(|c| c != '\n' && hrdsl_source::is_steering(c))
}

#[test]
fn what_is_quoted_does_not_steer_the_terminal() {
    let text =
        format!("{}// {EVIL} said\nassume at most 1 {EVIL} within 1 s // {EVIL}\n", scenario("a", "wave"));
    let text = text + &format!("require R safety \"{EVIL}\" nothing {EVIL} forbids\n\"{EVIL}\n");
    let folder = folder(&[("a.hri", &text)]);
    let out = hrdsl_in(folder.path(), "check a.hri");
    expect_code(&out, 1);
    assert!(is_harmless(&stderr(&out)) && stderr(&out).contains('␛'), "{:?}", stderr(&out));
    let out = hrdsl_in(folder.path(), "--color=always check a.hri");
    let said = stderr(&out);
    assert!(
        !said.contains("\u{1b}[2J") && !said.contains("\u{1b}]") && !said.contains('\u{202e}'),
        "{said:?}"
    );
    // Colours of our own are there, and what is quoted has none: the file's red is a sign and its numbers.
    assert!(said.contains("\u{1b}[") && said.contains("␛[31m") && !said.contains("\u{1b}[31mx"), "{said:?}");
    let diff = format!(
        "{}agent A plays guest {{ goal !g\n plan +!g {{ wave;; wave }} }} // {EVIL}\n",
        scenario("a", "wave")
    );
    std::fs::write(folder.path().join("d.hri"), diff).unwrap();
    let out = hrdsl_in(folder.path(), "check --diff d.hri");
    assert!(stdout(&out).contains("+ plan") && is_harmless(&stdout(&out)), "{:?}", stdout(&out));
}

#[test]
fn names_of_files_do_not_steer_the_terminal() {
    let name = "b\u{1b}[2J\u{202e}\nerror: c.hri";
    let folder = folder(&[(name, "scenario b\nactor\n"), ("ok/scenario.hri", &scenario("a", "wave"))]);
    for (arguments, code) in [
        (vec!["check", name], 1),
        (vec!["fmt", "--check", name], 1),
        (vec!["check", "no\u{1b}[2J\nsuch"], 2),
        (vec!["fmt", "no\u{1b}[2J\nsuch"], 2),
        (vec!["gen", "no\u{1b}[2J\nsuch"], 2),
        (vec!["import", "uppaal", "no\u{1b}[2J\nsuch.xml"], 2),
    ] {
        let out = command().args(&arguments).current_dir(folder.path()).output().unwrap();
        expect_code(&out, code);
        assert!(is_harmless(&stderr(&out)), "{:?}", stderr(&out));
        assert!(
            stderr(&out).contains("␛[2J") && !stderr(&out).contains("\nerror: c.hri"),
            "{}",
            stderr(&out)
        );
    }
    let out =
        command().args(["check", "--format", "json", name]).current_dir(folder.path()).output().unwrap();
    let document: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(document["files"][0]["path"], name, "JSON says the real name");
}

#[test]
fn data_is_the_same_to_the_byte() {
    let text = format!("{}// {EVIL}\n", scenario("a", "wave"));
    let out = support::hrdsl_reading(folder(&[]).path(), "fmt -", &text);
    expect_code(&out, 0);
    assert!(
        stdout(&out).contains("\u{1b}[2J\u{1b}]0;mine"),
        "what goes to a file or program is what was written"
    );
}

#[test]
fn a_place_far_to_the_right_is_shown_near_its_label() {
    for (start, column) in
        [("a".repeat(70_000), 70_000), (" ".repeat(200_000), 200_000), ("ä€".repeat(40_000), 80_000)]
    {
        let text = format!(
            "{}require R safety \"{start}\" nothing forbids called until called // {}\n",
            scenario("wide", "wave"),
            "z".repeat(80_000)
        );
        let folder = folder(&[("w.hri", &text)]);
        let out = hrdsl_in(folder.path(), "check w.hri");
        expect_code(&out, 1);
        let said = stderr(&out);
        assert!(said.contains("nothing forbids called") && said.contains(" … "), "{said}");
        assert!(said.lines().all(|l| l.chars().count() < 250), "{said}");
        let place = said.lines().find(|l| l.contains("w.hri:9:")).unwrap_or_default();
        assert!(place.contains(&format!(":{}", column + 21)), "{place}");
    }
}
