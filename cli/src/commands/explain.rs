//! `hrdsl explain`: the page of a diagnostic code, or what the requirements of a scenario say.

use std::path::Path;

use hrdsl_compiler::{
    pages,
    reading::{RequirementReading, readings},
};
use hrdsl_source::{CodeInfo, DiagnosticCode, GROUPS, REGISTRY};
use serde::Serialize;

use crate::{
    color::{self, TextStyle, paint},
    exit::CommandExit,
    fault::CommandFault,
    files, input, render, terminal,
};

/// Explain a diagnostic code, with an example that fails and the same fixed, or what a scenario's requirements say; without
/// either, list all codes.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl explain HR0101
  hrdsl explain
  hrdsl explain scenario.hri R3
  hrdsl explain HR0101 --json | jq -r .text")]
pub struct ExplainArgs {
    /// The code: `HR0101`, or `101`; or a scenario.
    #[arg(value_name = "CODE|FILE")]
    what: Option<String>,
    /// Of a scenario, the requirements to explain; all without one.
    requirements: Vec<String>,
    /// Print JSON: the page's `code`, `title`, `group`, `page` and `text`, or a list of all but the texts; of requirements a list
    /// of `requirement`, `title`, `doc` (its doc comment, if it has one), `text`, `says` and what each verdict means.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct ExplainedCode {
    code: String,
    title: &'static str,
    group: &'static str,
    page: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<&'static str>,
}

impl ExplainedCode {
    fn of(info: &CodeInfo, text: Option<&'static str>) -> Self {
        let code = info.code;
        Self { code: code.to_string(), title: info.title, group: code.group(), page: pages::path(code), text }
    }
}

/// # Errors
/// A code that does not exist.
pub fn run(args: &ExplainArgs) -> Result<CommandExit, CommandFault> {
    let colour = color::stdout_has();
    if let Some(file) = args.what.as_deref().filter(|what| is_scenario(what)) {
        return of_scenario(Path::new(file), args);
    }
    if !args.requirements.is_empty() {
        return Err("a code stands alone: after a scenario come the names of requirements".to_owned());
    }
    let text = match (&args.what, args.json) {
        (None, false) => list(colour),
        (None, true) => {
            files::json(&REGISTRY.iter().map(|info| ExplainedCode::of(info, None)).collect::<Vec<_>>())?
        }
        (Some(code), as_json) => {
            let info = find(code)?;
            let page = pages::page(info.code).ok_or_else(|| format!("{} has no page", info.code))?;
            if as_json {
                files::json(&ExplainedCode::of(info, Some(page)))?
            } else {
                render::page(page, colour)
            }
        }
    };
    terminal::print(&text)?;
    Ok(CommandExit::Ok)
}

fn is_scenario(what: &str) -> bool {
    Path::new(what).extension().is_some_and(|e| e == "hri")
}

fn of_scenario(file: &Path, args: &ExplainArgs) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(file, &[])?;
    if input::report_errors(file, &compilation).is_none() {
        return Ok(CommandExit::Errors);
    }
    let all = compilation.scenario.as_ref().map(|s| readings(s, &compilation.files)).unwrap_or_default();
    let wanted = |name: &String| {
        all.iter().find(|r| r.requirement == *name).ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|r| r.requirement.as_str()).collect();
            format!("no requirement is called `{name}`; there are {}", names.join(", "))
        })
    };
    let chosen: Vec<&RequirementReading> = if args.requirements.is_empty() {
        all.iter().collect()
    } else {
        args.requirements.iter().map(wanted).collect::<Result<_, _>>()?
    };
    let colour = color::stdout_has();
    let text = if args.json {
        files::json(&chosen)?
    } else {
        chosen.iter().map(|r| read_out(r, colour)).collect::<Vec<_>>().join("\n")
    };
    terminal::print(&text)?;
    Ok(CommandExit::Ok)
}

fn read_out(reading: &RequirementReading, colour: bool) -> String {
    let title = if reading.title.is_empty() { String::new() } else { format!(" \"{}\"", reading.title) };
    let mut out = format!("{}{title}\n", paint(colour, TextStyle::Bold, &reading.requirement));
    for line in reading.doc.lines() {
        out += &format!("  {line}\n");
    }
    out += &format!("  {}\n\n  {}\n\n", reading.text, reading.says);
    let verdicts = [
        ("pass", &reading.pass),
        ("fail", &reading.fail),
        ("vacuous", &reading.vacuous),
        ("inconclusive", &reading.inconclusive),
    ];
    for (verdict, when) in verdicts {
        let when = when.as_deref().unwrap_or("never");
        out += &format!(
            "  {}{}{when}\n",
            paint(colour, TextStyle::Code, verdict),
            " ".repeat(14 - verdict.len())
        );
    }
    out
}

/// All codes with their titles, by hundreds.
fn list(colour: bool) -> String {
    let mut out = String::new();
    for (hundred, about) in GROUPS {
        let heading = format!("HR{hundred:02}xx: {about}");
        out += &format!("{}\n", paint(colour, TextStyle::Bold, &heading));
        for info in REGISTRY.iter().filter(|i| i.code.0 / 100 == *hundred) {
            out += &format!("  {}  {}\n", paint(colour, TextStyle::Code, &info.code.to_string()), info.title);
        }
        out.push('\n');
    }
    out + "`hrdsl explain CODE` shows a code's page.\n"
}

/// The code that is meant: with or without `HR`, in any case, with or without its zeros.
fn find(text: &str) -> Result<&'static CodeInfo, CommandFault> {
    let start = text.get(..2).filter(|s| s.eq_ignore_ascii_case("HR")).map_or(0, str::len);
    let digits = &text[start..];
    let number = digits.parse::<u16>().ok().filter(|_| digits.bytes().all(|b| b.is_ascii_digit()));
    let Some(number) = number else {
        return Err(format!(
            "no code is called `{text}`; a code is HR and four digits, and `hrdsl explain` lists them all"
        ));
    };
    DiagnosticCode(number).info().ok_or_else(|| {
        let near: Vec<String> = nearest(number).iter().map(|i| format!("{} ({})", i.code, i.title)).collect();
        format!("no code is called `{text}`; near it are {}", near.join(", "))
    })
}

/// The three nearest codes, those of the same hundred first, then by number.
fn nearest(number: u16) -> Vec<&'static CodeInfo> {
    let mut all: Vec<&CodeInfo> = REGISTRY.iter().collect();
    all.sort_by_key(|i| (i.code.0 / 100 != number / 100, i.code.0.abs_diff(number), i.code));
    all.truncate(3);
    all.sort_by_key(|i| i.code);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_found_as_people_write_them() {
        for text in ["HR0101", "hr0101", "101", "0101", "HR101"] {
            assert_eq!(find(text).unwrap().code, DiagnosticCode(101), "{text}");
        }
        for text in ["", "HR", "H", "HR01O1", "ü1", "+101", "99999", "-1"] {
            assert!(find(text).is_err(), "{text}");
        }
    }

    #[test]
    fn every_code_is_in_the_list() {
        let list = list(false);
        assert!(REGISTRY.iter().all(|i| list.contains(&format!("  {}  {}\n", i.code, i.title))));
    }
}
