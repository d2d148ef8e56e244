//! `hrdsl run`: agents alone, of a scenario or of programs of Jason, with what they print and how it ends.

mod support;

use support::{expect_code, folder, hrdsl_in, stderr, stdout};

const SHOP: &str = "scenario shop
actor clerk : environment
actor boy : environment
stimulus carry(what: 1..9) by boy { hold 1 s }

agent Clerk plays clerk {
  goal !serve
  plan +!serve { .print(\"first\"); wait 2 s; .print(\"second\") }
}

agent Boy plays boy {
  goal !fetch
  plan +!fetch { carry(3); .print(\"done\") }
}
";

#[test]
fn agents_print_what_they_print() {
    let folder = folder(&[("shop.hri", SHOP)]);
    let out = hrdsl_in(folder.path(), "run shop.hri");
    expect_code(&out, 0);
    assert_eq!(stdout(&out), "[Clerk] first\n[Boy] does carry(3)\n[Boy] done\n[Clerk] second\n");
    let out = hrdsl_in(folder.path(), "run shop.hri --agent Boy --json");
    let lines: Vec<serde_json::Value> =
        stdout(&out).lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!(lines.len(), 2);
    assert_eq!((&lines[0]["kind"], &lines[0]["text"]), (&"does".into(), &"carry(3)".into()));
    assert_eq!((&lines[1]["time"], &lines[1]["agent"]), (&1_000_000_000_u64.into(), &"Boy".into()));
    let out = hrdsl_in(folder.path(), "run shop.hri --until 1s");
    assert!(!stdout(&out).contains("second"), "{}", stdout(&out));
}

#[test]
fn what_cannot_be_run_is_said() {
    let folder = folder(&[("shop.hri", SHOP), ("a.asl", "!s.\n+!s <- .print(x).\n"), ("b.asl", "!s")]);
    for (line, code, said) in [
        ("run shop.hri --agent Girl", 2, "no agent `Girl`; the scenario has: Clerk, Boy"),
        ("run shop.hri a.asl", 2, "give one scenario (.hri), or programs (.asl)"),
        ("run shop.txt", 2, "shop.txt is neither a scenario (.hri) nor a program (.asl)"),
        ("run c.asl", 2, "no such file: c.asl"),
        ("run b.asl", 1, "error: b.asl:"),
    ] {
        let out = hrdsl_in(folder.path(), line);
        expect_code(&out, code);
        assert!(stderr(&out).contains(said), "{line}: {}", stderr(&out));
    }
}

/// What is a value in Jason is asked before.
#[test]
fn internal_actions_are_values() {
    let program = "b(1). b(2).\nmany :- .count(b(_)) > 1.\n!s.\n\
        +!s <- .print(.length([1,2,3])); X = .count(b(_)) + 1; (?many; .print(X)); .findall(.length(L), .member(L,[[],[1]]), N);\n\
        .print(N); if (not .count(b(_)) > 2) { .print(few) }; while (.count(b(_)) < 4) { +b(.count(b(_)) + 1) }; !t(.length([1])).\n\
        +!t(N) : .length([a,b]) > N <- .print(.count(b(_)), N).\n";
    let folder = folder(&[("a.asl", program)]);
    let out = hrdsl_in(folder.path(), "run a.asl");
    assert_eq!(stdout(&out), "[a] 3\n[a] 3\n[a] [0,1]\n[a] few\n[a] 41\n", "{}", stderr(&out));
}

/// Goals, removed beliefs and rules give values; strings of actions are kept.
#[test]
fn values_come_back() {
    let program = "bag(1,5). bag(2,7).\nmost(X,Y,X) :- X >= Y.\nmost(X,Y,Y) :- X < Y.\n!s.\n\
        +!s <- !sum([3,4],N); -bag(T,7); ?most(N,T,M); .print(N,T,M); say(\"a b\"); !sum([],_); !none(K); .print(K).\n\
        -!s <- .print(failed).\n\
        +!sum([],0).\n+!sum([H|R],N) <- !sum(R,M); N = H + M.\n+!none(X) <- .print(none).\n";
    let folder = folder(&[("a.asl", program)]);
    let out = hrdsl_in(folder.path(), "run a.asl");
    expect_code(&out, 0);
    assert_eq!(stdout(&out), "[a] 727\n[a] does say(a_b)\n[a] none\n[a] failed\n");
    assert!(stderr(&out).contains("a.asl:9:3: warning: this plan gives `X` no value"), "{}", stderr(&out));
}

#[test]
fn agents_that_cannot_go_on_are_named() {
    let folder = folder(&[
        ("count.asl", "!n(0).\n+!n(X) <- !!n(X + 1).\n"),
        (
            "stuck.asl",
            "!s.\n!t.\n@one[atomic] +!s <- .print(waits); .suspend; .print(never).\n+!t <- .resume(s).\n",
        ),
    ]);
    let out = hrdsl_in(folder.path(), "run count.asl --cycles 500");
    expect_code(&out, 1);
    assert!(stderr(&out).contains("error: cycle bound: "), "{}", stderr(&out));
    let out = hrdsl_in(folder.path(), "run stuck.asl");
    expect_code(&out, 1);
    assert_eq!(stdout(&out), "[stuck] waits\n");
    assert!(
        stderr(&out).contains("error: deadlock: the atomic plan `one` of stuck waits"),
        "{}",
        stderr(&out)
    );
}

#[test]
fn one_clause_that_cannot_be_read_costs_one_clause() {
    let folder = folder(&[("a.asl", "!s.\n+!t <- a b.\n+!s <- .print(x).\n")]);
    let out = hrdsl_in(folder.path(), "run a.asl");
    expect_code(&out, 0);
    assert_eq!(stdout(&out), "[a] x\n");
    assert!(
        stderr(&out).contains("a.asl:2:1: left out: line 2, column 10: expected `;`"),
        "{}",
        stderr(&out)
    );
}
