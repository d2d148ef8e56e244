//! The one place that prints. What comes from outside (files and their names, programs) does not steer a terminal:
//! whoever puts it in a colour makes it [`printable`] before, and nothing but colours gets through here.

use std::{
    borrow::Cow,
    fmt::Display,
    io::{self, IsTerminal, Write},
    path::Path,
};

use hrdsl_source::{printable, printable_line};

use crate::{color, fault::CommandFault};

/// Prints for people, on stdout. That nobody reads on is the reader's choice, and no fault.
///
/// # Errors
/// What is wrong with stdout.
pub fn print(text: &str) -> Result<(), CommandFault> {
    exactly(&passed(text, color::stdout_has()))
}

/// Prints what is made for programs or files, on stdout: to the byte, unless a terminal shows it.
///
/// # Errors
/// What is wrong with stdout.
pub fn print_data(text: &str) -> Result<(), CommandFault> {
    exactly(&if io::stdout().is_terminal() { printable(text) } else { Cow::Borrowed(text) })
}

fn exactly(text: &str) -> Result<(), CommandFault> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(format!("cannot print: {e}")),
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Says something to people, on stderr. If it cannot be said there, there is nowhere to say so.
pub fn say(text: impl Display) {
    let text = text.to_string();
    let _ = io::stderr().lock().write_all(passed(&text, color::stderr_has()).as_bytes());
}

/// The same, as a line.
pub fn say_line(text: impl Display) {
    say(format_args!("{text}\n"));
}

/// A path as people read it, on one line.
#[must_use]
pub fn shown(path: &Path) -> String {
    printable_line(&path.to_string_lossy()).into_owned()
}

/// The text with nothing that steers a terminal but, if colours are on, colours.
fn passed(text: &str, colours: bool) -> Cow<'_, str> {
    if !colours || !text.contains('\u{1b}') {
        return printable(text);
    }
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('\u{1b}') {
        out += &printable(&rest[..at]);
        let length = colour(&rest[at..]).unwrap_or(0);
        if length == 0 {
            out.push(hrdsl_source::printable_char('\u{1b}'));
        }
        out += &rest[at..at + length];
        rest = &rest[at + length.max(1)..];
    }
    out += &printable(rest);
    Cow::Owned(out)
}

/// The length of the sequence that sets a colour or style, with which the text begins.
fn colour(text: &str) -> Option<usize> {
    let parameters = text.strip_prefix("\u{1b}[")?;
    let end = parameters.find(|c: char| !c.is_ascii_digit() && c != ';')?;
    parameters[end..].starts_with('m').then_some(2 + end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_colours_pass_and_only_where_there_are_colours() {
        let text = "\u{1b}[1;31mred\u{1b}[0m \u{1b}]0;title\u{7} \u{1b}[2J\u{1b}[1\u{202e}é\u{1b}";
        assert_eq!(passed(text, true), "\u{1b}[1;31mred\u{1b}[0m ␛]0;title␇ ␛[2J␛[1�é␛");
        assert_eq!(passed(text, false), "␛[1;31mred␛[0m ␛]0;title␇ ␛[2J␛[1�é␛");
        assert_eq!(shown(Path::new("a\nb\u{1b}")), "a␊b␛");
    }
}
