//! Keywords are names wherever they cannot be meant as keywords: each that is not reserved, as the name of each thing, declared and
//! used, checked without errors, formatted, and checked again.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_syntax::format;
use hrdsl_syntax::token::{KEYWORDS, KeywordClass};

const PEOPLE: &str =
    "scenario words\n\nactor cook : environment\nactor robot : system\n\nevent ready from robot to cook\n";

/// Scenarios in which `@` is the name of a thing of this kind.
const KINDS: &[(&str, &str)] = &[
    (
        "stimulus",
        "stimulus @ by cook { hold 1 s }
         stimulus go by cook { hold 1 s }
         agent A plays cook {
           goal !serve
           plan +!serve { @; await ready; @(); if true { @ } }
           plan -!serve { }
         }
         suite s by agents A { tests 1 }
         test s.one { seed 1
           go; @
           await ready within 3 s
           @
           wait 1 s
           @
         }
         suite r by random { tests 1; stimuli @, go; length 1..2; pause 1 s .. 2 s }
         require R1 functional @ causes ready within 9 s
         require R2 functional after @ : ready within 9 s
         cover C = count(@ or ready) bins none = 0, some = 1..",
    ),
    (
        "stimulus with a parameter",
        "stimulus @(n: 0..3) by cook { hold n * 1 s }
         agent A plays cook { goal !serve; plan +!serve { await ready; @(2) }; plan -!serve { } }
         suite s by agents A { tests 1 }
         test s.one { seed 1
           go
           @(2)
         }
         stimulus go by cook { hold 1 s }
         require R1 functional @(2) causes ready within 9 s
         cover C = count(@(1)) bins none = 0, some = 1..",
    ),
    (
        "event",
        "event @ from robot to cook
         event @2(n: 0..3) from robot
         stimulus ask by cook { hold 1 s }
         agent A plays cook {
           belief seen
           plan on @2(N) { await @; await ready | @ within 3 s; ask }
           plan on @ { ask }
         }
         suite s by agents A { tests 1 }
         suite r by random { tests 1; stimuli ask; await @ | ready; length 1..2; pause 1 s .. 2 s }
         test s.one { seed 1
           ask
           await @ within 3 s
           await ready | @ within 3 s
         }
         automaton M plays robot { init location a; location b
           a -> b do @
           b -> a do @2(2) }
         require R1 functional @ causes ready within 9 s
         require R2 functional after @ : ready or @2(_) within 9 s
         require R3 functional ready forbids @ until @2
         require R4 safety never @ or ready
         require R5 safety @ or ready causes ready
         assume at most 4 @ within 30 s
         cover C = count(ready or @) bins none = 0, some = 1..",
    ),
    (
        "emitted event",
        "event @ from cook to robot
         stimulus ask by cook { emit @ hold 1 s if true { emit @ } emit @ }
         automaton M plays robot { init location a; location b
           a -> b on @
           b -> a when true on @ }",
    ),
    (
        "event with a parameter",
        "event @(@: bool, n: 0..3) from cook
         stimulus ask by cook { sample @ in 1..3 emit @(true, @) if @ > 1 { hold @ * 1 s } else { emit @(false, 0) } }
         require R1 functional @(true, 1) causes ready within 9 s
         require R2 functional after @(true, _): ready
         require R3 safety never (@(true, _) or ready)
         cover C = count(@(true, _)) bins none = 0, some = 1..",
    ),
    (
        "actor",
        "actor @ : environment
         event hello from @ to robot
         event bye from robot to @, cook
         stimulus greet by @ { emit hello }
         agent A plays @ { plan on bye { greet } }
         suite s by agents A { tests 1 }",
    ),
    (
        "part",
        "part @(@2: length) { body top: fixed box(@2, @2, 10 cm) at (0 m, 0 m, @2) }
         part person { body hand: kinematic sphere(4 cm) at (0 m, 0 m, 1 m) }
         stimulus reach by cook { cook.hand.move_to(@.top, 800 ms) hold 800 ms }
         require R1 safety globally distance(cook.hand, @.top) < 3 m
         world {
           part cook = person at (2 m, 0 m, 0 m)
           part @ = @(1 m) at (0 m, 0 m, 0 m)
         }",
    ),
    (
        "body",
        "part person { body @: kinematic sphere(4 cm) at (0 m, 0 m, 1 m) }
         event near from cook
         stimulus reach by cook { cook.@.move_to(@, 800 ms) hold 800 ms }
         require R1 safety globally distance(cook.@, @) < 3 m && distance(@, cook.@) > 1 mm
         world {
           body @: fixed box(1 m, 1 m, 10 cm) at (0 m, 0 m, 0 m)
           part cook = person at (2 m, 0 m, 0 m)
           signal close: bool to robot = distance(@, cook.@) < 1 m
         }",
    ),
    (
        "command of a device",
        "event told from robot
         device gripper { command @ do open_fingers; command @2 do close_fingers expect holds else \"it is empty\" }
         device arm { command @2(to: length[3]) do reach_point }
         world {
           body palm: kinematic sphere(4 cm) at (0 m, 0 m, 1 m)
           gripper hand: palm tool (0 m, 0 m, 0 m) reach 1 cm delay 1 s
           on @ hand emit told
           on @2 hand when holds(hand) emit told
         }",
    ),
    (
        "gripper",
        "event told from robot
         part hand {
           body palm: kinematic sphere(4 cm) at (0 m, 0 m, 1 m)
           gripper @: palm tool (0 m, 0 m, 0 m) reach 1 cm delay 1 s
         }
         world {
           part hand = hand at (0 m, 0 m, 0 m)
           on close hand.@ emit told
           on open hand.@ when holds(hand.@) emit told
         }",
    ),
    (
        "belief",
        "stimulus ask by cook { hold 1 s }
         agent A plays cook {
           belief @(n: 0..3) = @(1)
           belief @2
           belief big
           rule big when @(N) && N > 2
           goal @3(n: 0..3)
           goal !@3(1)
           plan on ready when @(N) && not @2 { -@(N); +@(2); ?@(M); -+@(3); !@3(M); ask }
           plan +!@3(N) when @(N) || big { ask }
           plan +!@3(_) { ask }
         }
         suite s by agents A { tests 1; choose any @ of A }",
    ),
    (
        "parameter",
        "const LONG = 2 s
         stimulus ask(@: 0..3, c: bool) by cook { hold @ * 1 s if @ > 1 { hold LONG } if c && @ == 1 { hold 1 s } }
         event told(@: bool, n: 0..3) from cook
         stimulus tell(@: bool) by cook { emit told(@, 1) emit told(not @, if @ { 1 } else { 2 }) if @ { hold 1 s } }
         agent A plays cook { plan on ready { ask(1, true); tell(false) } }
         suite s by agents A { tests 1 }",
    ),
];

fn errors(text: &str) -> Vec<String> {
    let c = compile(InputFile { name: "words.hri", text }, &[]);
    let errors = c.diagnostics.iter().filter(|d| d.is_error());
    errors.map(|d| format!("{} {} {}", c.files.place(d.span()), c.files.text(d.span()), d.message)).collect()
}

#[test]
fn every_keyword_is_a_name_of_everything() {
    let mut wrong = Vec::new();
    for word in KEYWORDS.iter().filter(|k| k.class != KeywordClass::Reserved).map(|k| k.word) {
        for (kind, body) in KINDS {
            // What follows `wait` and `seed` in parentheses is a time, and a number.
            if kind.starts_with("stimulus with") && ["wait", "seed"].contains(&word) {
                continue;
            }
            // In an expression `if (` starts a choice.
            if (*kind, word) == ("belief", "if") {
                continue;
            }
            let text = format!("{PEOPLE}{}\n", body.replace('@', word));
            let mut said = errors(&text);
            if said.is_empty() {
                match format(&text) {
                    Ok(once) if format(&once).as_ref() != Ok(&once) => {
                        said.push("is formatted twice".to_owned())
                    }
                    Ok(once) => said.extend(errors(&once).into_iter().map(|e| format!("formatted: {e}"))),
                    Err(_) => said.push("is not formatted".to_owned()),
                }
            }
            wrong.extend(said.first().map(|first| format!("{word} as {kind}: {first}")));
        }
    }
    assert!(wrong.is_empty(), "{} of them:\n{}", wrong.len(), wrong.join("\n"));
}
