//! What is typed during a walk.

use std::{path::PathBuf, time::Duration};

use hrdsl_ir::Nanos;

use crate::quantity;

/// What can be typed, for people.
pub const HELP: &str = "\
  N          take the transition with this number, at any of its times
  N @ T      take it at this time since the start: `2 @ 3.5 s`, `1 @ 500ms`
  list       say again where the walk is and what can happen
  undo [N]   take back the last transition, or the last N
  random [N] take any transition, or N of them one after the other
  reset      go back to the start
  replay TRACE [NAME]
             go along a recorded run (JSON of `prove` or `step`, or UPPAAL's .xtr); NAME says which, if there are several
  trace      tell the walk so far as a run, with times
  json       print it as JSON, which `replay` and `hrdsl prove --follow` read
  help       say this
  quit       end (so does the end of the input)
  The first letter will do, but for `reset` and `replay`.
";

/// A command of the walk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepCommand {
    /// Nothing was typed, or a comment.
    Nothing,
    Take {
        /// From 1.
        choice: usize,
        at: Option<Nanos>,
    },
    List,
    Undo(usize),
    Random(usize),
    Reset,
    Replay {
        file: PathBuf,
        name: Option<String>,
    },
    Trace,
    Json,
    Help,
    Quit,
}

/// Reads a line.
///
/// # Errors
/// What is wrong with it, and what could be typed.
pub fn read(line: &str) -> Result<StepCommand, String> {
    let line = line.trim();
    if line.is_empty() || line.starts_with('#') {
        return Ok(StepCommand::Nothing);
    }
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let rest = rest.trim();
    if line.starts_with(|c: char| c.is_ascii_digit()) {
        return take(line);
    }
    let count = || match rest {
        "" => Ok(1),
        n => n.parse().map_err(|_| format!("`{n}` is no number of transitions")),
    };
    let alone = |command| if rest.is_empty() { Ok(command) } else { Err(format!("`{word}` stands alone")) };
    match word {
        "l" | "list" => alone(StepCommand::List),
        "u" | "undo" => count().map(StepCommand::Undo),
        "r" | "random" => count().map(StepCommand::Random),
        "reset" => alone(StepCommand::Reset),
        "replay" => replay(rest),
        "t" | "trace" => alone(StepCommand::Trace),
        "j" | "json" => alone(StepCommand::Json),
        "h" | "help" | "?" => alone(StepCommand::Help),
        "q" | "quit" | "exit" => alone(StepCommand::Quit),
        _ => Err(format!(
            "`{word}` is no command: a number takes a transition, `help` says what else there is"
        )),
    }
}

/// `2`, `2 @ 3.5 s`
fn take(line: &str) -> Result<StepCommand, String> {
    let (number, at) = match line.split_once('@') {
        Some((number, at)) => (number.trim(), Some(at.trim())),
        None => (line, None),
    };
    let choice = number.parse().map_err(|_| format!("`{number}` is no number of a transition"))?;
    let nanos = |time: Duration| Nanos::try_from(time.as_nanos()).map_err(|_| "that is too late".to_owned());
    let at = at.map(|text| quantity::time(text).and_then(nanos)).transpose()?;
    Ok(StepCommand::Take { choice, at })
}

/// The name of a file may have spaces if nothing follows it.
fn replay(rest: &str) -> Result<StepCommand, String> {
    if rest.is_empty() {
        return Err("`replay` needs the file of a run".to_owned());
    }
    let whole = PathBuf::from(rest);
    let (file, name) = match rest.split_once(char::is_whitespace) {
        Some((file, name)) if !whole.exists() => (PathBuf::from(file), Some(name.trim().to_owned())),
        Some(_) | None => (whole, None),
    };
    Ok(StepCommand::Replay { file, name })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_read() {
        let take = |choice, at| Ok(StepCommand::Take { choice, at });
        assert_eq!(read(" 2 "), take(2, None));
        assert_eq!(read("2@3.5s"), take(2, Some(3_500_000_000)));
        assert_eq!(read("12 @ 500 ms"), take(12, Some(500_000_000)));
        assert_eq!(read("random 5"), Ok(StepCommand::Random(5)));
        assert_eq!(read("u"), Ok(StepCommand::Undo(1)));
        assert_eq!(read("# a comment"), Ok(StepCommand::Nothing));
        let named = StepCommand::Replay { file: "no-such.json".into(), name: Some("query waits".into()) };
        assert_eq!(read("replay no-such.json query waits"), Ok(named));
        for wrong in ["2 3", "2 @", "2 @ 3 parsecs", "undo x", "list 3", "replay", "dance"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
