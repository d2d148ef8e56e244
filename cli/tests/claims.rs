//! CLAIMS.md and the documents hold each other: each figure of a document is a claim with a command that prints it, or one of
//! the numbers that claim nothing; and what CLAIMS.md names stands where it says.
//!
//! A figure is a number in digits with one of the [`UNITS`] after it. Looked at are the lines of the documents, without what is in backquotes
//! and without blocks of code; of scenarios the comments. In README.md and below `examples/`, blocks of text are looked at, too:
//! they show what hrdsl prints. What `spec/` shows in blocks is executed by tests of its own.
#![allow(clippy::disallowed_methods, reason = "tests run what the documents name")]

mod support;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::PathBuf,
    process::Command,
};

use support::{command, root};

/// A longer one stands before its beginning.
const UNITS: &[&str] = &[
    "transitions",
    "locations",
    "requests",
    "minutes",
    "seconds",
    "states/s",
    "events/s",
    "states",
    "rounds",
    "events",
    "rad/s",
    "runs/s",
    "hours",
    "lines",
    "plans",
    "goals",
    "edges",
    "bytes",
    "files",
    "tests",
    "times",
    "zones",
    "runs",
    "bins",
    "min",
    "m/s",
    "GiB",
    "MiB",
    "KiB",
    "GB",
    "MB",
    "kB",
    "cm",
    "mm",
    "ms",
    "µs",
    "ns",
    "%",
    "h",
    "m",
    "s",
];

/// A row of the table of claims.
struct Claim {
    figure: String,
    document: String,
    command: String,
    /// `run`: a test runs it; `held`: it is a test; `time`: it depends on the machine.
    kind: String,
    /// What the command prints, if that is not the figure itself.
    printed: String,
}

/// A row of the table of other numbers.
struct Other {
    document: String,
    numbers: Vec<String>,
}

fn read(document: &str) -> String {
    fs::read_to_string(root().join(document)).unwrap_or_else(|e| panic!("{document}: {e}"))
}

/// The cells of the rows of the table that comes after this heading.
fn rows(text: &str, heading: &str) -> Vec<Vec<String>> {
    let (_, after) = text.split_once(heading).unwrap_or_else(|| panic!("no heading `{heading}`"));
    let lines = after.lines().skip_while(|l| !l.starts_with('|')).take_while(|l| l.starts_with('|'));
    let row = |line: &str| line.trim_matches('|').split('|').map(|c| c.trim().to_owned()).collect();
    lines.skip(2).map(row).collect()
}

fn bare(cell: &str) -> String {
    cell.trim_matches('`').to_owned()
}

fn claims() -> Vec<Claim> {
    let row = |cells: Vec<String>| {
        let [figure, document, command, kind, printed] = &cells[..] else { panic!("five cells: {cells:?}") };
        let printed = if printed.is_empty() { figure } else { printed };
        Claim {
            figure: bare(figure),
            document: document.clone(),
            command: bare(command),
            kind: kind.clone(),
            printed: bare(printed),
        }
    };
    let claims: Vec<Claim> = rows(&read("CLAIMS.md"), "\n## The claims\n").into_iter().map(row).collect();
    assert!(claims.len() > 10, "only {} claims were found: does the test still see them?", claims.len());
    claims
}

fn others() -> Vec<Other> {
    let row = |cells: Vec<String>| {
        let [document, numbers, _] = &cells[..] else { panic!("three cells: {cells:?}") };
        Other { document: document.clone(), numbers: numbers.split("`, `").map(bare).collect() }
    };
    rows(&read("CLAIMS.md"), "\n## Numbers that claim nothing\n").into_iter().map(row).collect()
}

/// The documents whose figures are claims, in order.
fn documents() -> Vec<String> {
    let files = |folder: &str, extensions: &[&str]| {
        let is_one = |p: &PathBuf| p.extension().is_some_and(|e| extensions.contains(&e.to_str().unwrap()));
        let entries = fs::read_dir(root().join(folder)).unwrap().map(|e| e.unwrap().path());
        let name = |p: PathBuf| format!("{folder}/{}", p.file_name().unwrap().to_str().unwrap());
        let mut files: Vec<String> = entries.filter(is_one).map(name).collect();
        files.sort();
        files
    };
    let mut all = vec!["README.md".to_owned(), "ARCHITECTURE.md".to_owned()];
    all.extend(files("spec", &["md"]));
    for example in ["corridor", "delivery", "handover", "homecare", "workbench"] {
        all.extend(files(&format!("examples/{example}"), &["md", "hri"]));
    }
    let examples = fs::read_dir(root().join("examples")).unwrap().count();
    assert_eq!(examples, 5, "an example is not looked at");
    all
}

/// The parts of a document in which figures are looked for.
fn looked_at(document: &str) -> Vec<String> {
    let text = read(document);
    if document.ends_with(".hri") {
        let comment = |l: &str| l.find("//").map(|at| l[at..].to_owned());
        return text.lines().filter_map(comment).collect();
    }
    let shows_output = !document.starts_with("spec/");
    let (mut lines, mut block): (Vec<String>, Option<bool>) = (Vec::new(), None);
    for line in text.lines() {
        match (line.trim_start().strip_prefix("```"), block) {
            (Some(language), None) => block = Some(language.trim() == "text" && shows_output),
            (Some(_), Some(_)) => block = None,
            (None, Some(false)) => {}
            (None, Some(true)) => lines.push(line.to_owned()),
            (None, None) => lines.push(line.split('`').step_by(2).collect::<Vec<_>>().join("`")),
        }
    }
    lines
}

/// All figures of a line.
fn figures(line: &str) -> Vec<String> {
    let c: Vec<char> = line.chars().collect();
    let digit = |at: usize| c.get(at).is_some_and(char::is_ascii_digit);
    let part_of_word = |at: usize| c.get(at).is_some_and(|c| c.is_alphanumeric() || *c == '_');
    let (mut found, mut at) = (Vec::new(), 0);
    while at < c.len() {
        if !digit(at) {
            at += 1;
            continue;
        }
        // `t002`, `HR0203`, `#1` name something.
        if at > 0 && (part_of_word(at - 1) || c[at - 1] == '#') {
            while part_of_word(at) {
                at += 1;
            }
            continue;
        }
        let start = at;
        loop {
            while digit(at) {
                at += 1;
            }
            let groups = matches!(c.get(at), Some(' ' | '\u{202f}'))
                && (1..4).all(|n| digit(at + n))
                && !digit(at + 4);
            let goes_on = matches!(c.get(at), Some('.' | ',')) && digit(at + 1);
            if !groups && !goes_on {
                break;
            }
            at += 1;
        }
        let unit_at = at + usize::from(c.get(at) == Some(&' '));
        let rest: String = c[unit_at..].iter().collect();
        let ends = |unit: &str| {
            let after = rest[unit.len()..].chars().next();
            !after.is_some_and(|c| c.is_alphanumeric() || "_/²^".contains(c))
        };
        if let Some(unit) = UNITS.iter().find(|u| rest.starts_with(**u) && ends(u)) {
            found.push(c[start..unit_at].iter().collect::<String>() + unit);
        }
    }
    found
}

#[test]
fn figures_are_numbers_with_units() {
    let found = |line: &str| figures(line).join("|");
    assert_eq!(found("t002 at 6.77 s, HR0203, 10..20 s"), "6.77 s|20 s");
    assert_eq!(
        found("1 250 000 events, 100,000 states; 50 %, 0.25 m/s, 3 sheep"),
        "1 250 000 events|100,000 states|50 %|0.25 m/s"
    );
    assert_eq!(found("**90 s**, 5cm, 2 m/s^2 and 4 mice, 12 tests."), "90 s|5cm|12 tests");
}

#[test]
fn every_figure_is_a_claim_or_claims_nothing() {
    let mut known: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut both = Vec::new();
    for claim in claims() {
        known.entry(claim.document).or_default().insert(claim.figure);
    }
    let mut unneeded: BTreeSet<(String, String)> = BTreeSet::new();
    for other in others() {
        for number in other.numbers {
            if !known.entry(other.document.clone()).or_default().insert(number.clone()) {
                both.push(format!("{}: `{number}`", other.document));
            }
            unneeded.insert((other.document.clone(), number));
        }
    }
    let (mut unknown, mut seen) = (BTreeSet::new(), 0);
    for document in documents() {
        for figure in looked_at(&document).iter().flat_map(|l| figures(l)) {
            seen += 1;
            unneeded.remove(&(document.clone(), figure.clone()));
            if !known.get(&document).is_some_and(|k| k.contains(&figure)) {
                unknown.insert(format!("{document}: `{figure}`"));
            }
        }
    }
    assert!(seen > 60, "only {seen} figures were found: does the test still see them?");
    assert!(unknown.is_empty(), "CLAIMS.md does not know\n{}", Vec::from_iter(unknown).join("\n"));
    assert!(unneeded.is_empty(), "these are nowhere any more: {unneeded:?}");
    assert!(both.is_empty(), "these are named twice: {both:?}");
}

#[test]
fn every_claim_stands_where_it_says() {
    for claim in claims() {
        let text = read(&claim.document);
        assert!(text.contains(&claim.figure), "{} does not say `{}`", claim.document, claim.figure);
        assert!(["run", "held", "time"].contains(&claim.kind.as_str()), "{}", claim.kind);
    }
}

/// The words after an option, `--test campaign` or `-p hrdsl`.
fn after<'c>(command: &'c str, option: &str) -> Option<&'c str> {
    let mut words = command.split_whitespace();
    words.find(|w| *w == option)?;
    words.next()
}

/// The folder of each crate, by its name.
fn crates() -> BTreeMap<String, PathBuf> {
    let manifest = read("Cargo.toml");
    let members = manifest.lines().filter_map(|l| l.trim().strip_prefix('"')?.split('"').next());
    let folder = |member: &str| {
        let text = read(&format!("{member}/Cargo.toml"));
        let name = text.lines().find_map(|l| l.strip_prefix("name = \"")).unwrap();
        (name.trim_end_matches('"').to_owned(), root().join(member))
    };
    members.filter(|m| root().join(m).join("Cargo.toml").is_file()).map(folder).collect()
}

/// Why nobody can run the command, if it is so.
fn fault(command: &str, crates: &BTreeMap<String, PathBuf>) -> Option<String> {
    // `HRDSL_SOAK=1 cargo …`: variables come first.
    let words: Vec<&str> = command.split_whitespace().skip_while(|w| w.contains('=')).collect();
    if words.first() != Some(&"cargo") {
        let program = words.first()?;
        let is_known = ["hrdsl", "npm", "python3"].contains(program) || root().join(program).is_file();
        return (!is_known).then(|| format!("nothing is called `{program}`"));
    }
    let Some(package) = after(command, "-p") else {
        return (!command.contains("--workspace")).then(|| "it does not say of which crate".to_owned());
    };
    let Some(folder) = crates.get(package) else { return Some(format!("no crate is called `{package}`")) };
    for (option, targets) in [("--test", "tests"), ("--bench", "benches")] {
        let Some(target) = after(command, option) else { continue };
        let folder = folder.join(targets);
        if !folder.join(format!("{target}.rs")).is_file() && !folder.join(target).join("main.rs").is_file() {
            return Some(format!("{package} has no {target} in {targets}/"));
        }
    }
    None
}

#[test]
fn every_command_can_be_typed() {
    let crates = crates();
    assert!(crates.len() > 20, "only {} crates were found", crates.len());
    for claim in claims() {
        let fault = fault(&claim.command, &crates);
        assert!(fault.is_none(), "`{}`: {}", claim.command, fault.unwrap_or_default());
    }
}

/// What a command prints, run in the root of the repository; results go to a folder of its own.
fn printed(line: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut run = match line.strip_prefix("hrdsl ") {
        Some(arguments) => {
            let mut run = command();
            run.args(arguments.split_whitespace());
            if arguments.starts_with("gen ") || arguments.starts_with("sim ") {
                run.arg("-o").arg(folder.path().join("out"));
            }
            run
        }
        None => {
            let mut run = Command::new("sh");
            let hrdsl = PathBuf::from(env!("CARGO_BIN_EXE_hrdsl"));
            let path = std::env::var("PATH").unwrap_or_default();
            let path = format!("{}:{path}", hrdsl.parent().unwrap().display());
            run.args(["-c", line]).env("PATH", path).env("PYTHONDONTWRITEBYTECODE", "1");
            run
        }
    };
    let out = run.current_dir(root()).output().unwrap();
    assert!(out.status.success(), "`{line}`\n{}", support::stderr(&out));
    support::stdout(&out)
}

#[test]
fn the_commands_print_the_figures() {
    let mut outputs: BTreeMap<String, String> = BTreeMap::new();
    for claim in claims().into_iter().filter(|c| c.kind == "run") {
        let out = outputs.entry(claim.command.clone()).or_insert_with(|| printed(&claim.command));
        assert!(
            out.contains(&claim.printed),
            "`{}` does not print `{}`\n{out}",
            claim.command,
            claim.printed
        );
    }
    assert!(outputs.len() >= 3, "only {} commands were run", outputs.len());
}
