//! Whether output has colours: `--color`, then `NO_COLOR`, then `CLICOLOR_FORCE`, then whether it goes to a terminal.

use std::{
    ffi::OsString,
    io::{IsTerminal, stderr, stdout},
    sync::OnceLock,
};

use clap::ValueEnum;
use hrdsl_source::printable;

/// What `--color` takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ColorArg {
    /// On a terminal, unless NO_COLOR is set; elsewhere if CLICOLOR_FORCE is set.
    #[default]
    Auto,
    /// Everywhere.
    Always,
    /// Nowhere.
    Never,
}

impl From<ColorArg> for clap::ColorChoice {
    fn from(choice: ColorArg) -> Self {
        match choice {
            ColorArg::Auto => Self::Auto,
            ColorArg::Always => Self::Always,
            ColorArg::Never => Self::Never,
        }
    }
}

static CHOICE: OnceLock<ColorArg> = OnceLock::new();

/// Settles the choice for the whole process.
pub fn choose(choice: ColorArg) {
    CHOICE.get_or_init(|| choice);
}

/// What `--color` says in these arguments. Help and usage errors are printed while the arguments are still being read,
/// and have to obey it, too.
pub fn from_args(args: impl IntoIterator<Item = OsString>) -> ColorArg {
    let mut choice = ColorArg::Auto;
    let mut args = args.into_iter().take_while(|arg| arg != "--");
    while let Some(arg) = args.next() {
        let arg = arg.to_string_lossy();
        let word = match arg.strip_prefix("--color") {
            Some("") => args.next().map(|next| next.to_string_lossy().into_owned()),
            Some(rest) => rest.strip_prefix('=').map(str::to_owned),
            None => None,
        };
        choice = word.and_then(|w| ColorArg::from_str(&w, false).ok()).unwrap_or(choice);
    }
    choice
}

/// Whether stdout takes colours.
#[must_use]
pub fn stdout_has() -> bool {
    decide(stdout().is_terminal())
}

/// Whether stderr takes colours.
#[must_use]
pub fn stderr_has() -> bool {
    decide(stderr().is_terminal())
}

fn decide(terminal: bool) -> bool {
    let set = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty());
    let forced = set("CLICOLOR_FORCE").is_some_and(|v| v != "0");
    has(CHOICE.get().copied().unwrap_or_default(), set("NO_COLOR").is_some(), forced, terminal)
}

fn has(choice: ColorArg, no_color: bool, forced: bool, terminal: bool) -> bool {
    match choice {
        ColorArg::Always => true,
        ColorArg::Never => false,
        ColorArg::Auto => !no_color && (forced || terminal),
    }
}

/// The few styles that are used, as SGR parameters.
#[derive(Clone, Copy, Debug)]
pub enum TextStyle {
    Bold,
    Code,
    Added,
    Removed,
}

/// A piece of text in a style, if colours are on. It cannot leave its style.
#[must_use]
pub fn paint(on: bool, style: TextStyle, text: &str) -> String {
    let sgr = match style {
        TextStyle::Bold => "1",
        TextStyle::Code => "36",
        TextStyle::Added => "32",
        TextStyle::Removed => "31",
    };
    let text = printable(text);
    if on && !text.is_empty() { format!("\u{1b}[{sgr}m{text}\u{1b}[0m") } else { text.into_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_option_is_above_the_environment_and_that_above_the_terminal() {
        assert!(has(ColorArg::Always, true, false, false));
        assert!(!has(ColorArg::Never, false, true, true));
        assert!(has(ColorArg::Auto, false, false, true) && !has(ColorArg::Auto, false, false, false));
        assert!(has(ColorArg::Auto, false, true, false));
        assert!(!has(ColorArg::Auto, true, true, true));
    }

    #[test]
    fn the_option_is_found_wherever_it_stands() {
        let from = |line: &str| from_args(line.split(' ').map(OsString::from));
        assert_eq!(from("hrdsl --color always check a.hri"), ColorArg::Always);
        assert_eq!(from("hrdsl check --color=never a.hri"), ColorArg::Never);
        assert_eq!(from("hrdsl check -- --color=never"), ColorArg::Auto);
        assert_eq!(from("hrdsl --color"), ColorArg::Auto);
        assert_eq!(from("hrdsl --color=pink"), ColorArg::Auto);
    }
}
