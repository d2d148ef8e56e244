//! A case of the suite: what its drivers are told to do, what they have to say, and which events that makes.

use serde_json::Value;

/// The scenario of all cases, without a system.
const SCENARIO: &str = include_str!("../../../../spec/protocol/scenario.hri");

/// A file of `spec/protocol`, by its name.
macro_rules! case {
    ($name:literal) => {
        ($name, include_str!(concat!("../../../../spec/protocol/", $name, ".case")))
    };
}

/// All cases, in the order in which they run.
const CASES: [(&str, &str); 24] = [
    case!("time"),
    case!("events"),
    case!("drop"),
    case!("emit"),
    case!("signals"),
    case!("commands"),
    case!("stop"),
    case!("arrivals"),
    case!("begin"),
    case!("devices"),
    case!("topics"),
    case!("latched"),
    case!("quality"),
    case!("burst"),
    case!("services"),
    case!("actions"),
    case!("graph"),
    case!("programs"),
    case!("binding"),
    case!("bound-actions"),
    case!("machines"),
    case!("failed"),
    case!("log"),
    case!("parameters"),
];

/// What a library does in one run.
#[derive(Debug, Default)]
pub struct ConformanceCase {
    pub name: &'static str,
    /// What is shown, in a sentence.
    pub title: String,
    /// The version of the protocol that the library has to speak at least.
    pub version: u32,
    /// The statements of the test.
    test: String,
    limit: String,
    /// Further members of the system.
    members: String,
    pub programs: Vec<CaseProgram>,
    /// The events that the system makes, as lines of the recording.
    pub events: Vec<Value>,
    /// The first line of the error with which the test has to end; none: it ends without.
    pub error: Option<String>,
    /// What the results have to say of the log; none: it is not looked at.
    pub log: Option<Value>,
}

/// A program of the system, each a driver.
#[derive(Debug)]
pub struct CaseProgram {
    pub name: String,
    pub steps: Vec<CaseStep>,
}

/// A line for the driver, and the line that it answers.
#[derive(Debug)]
pub struct CaseStep {
    /// In the case's file, from 1.
    pub line: usize,
    pub told: String,
    pub expected: Value,
}

/// All cases.
///
/// # Errors
/// The first line that is none of a case; there is none, as long as the files are whole.
pub fn all() -> Result<Vec<ConformanceCase>, String> {
    CASES.iter().map(|(name, text)| parse(name, text)).collect()
}

fn parse(name: &'static str, text: &str) -> Result<ConformanceCase, String> {
    let mut case =
        ConformanceCase { name, version: 2, limit: "20 s".to_owned(), ..ConformanceCase::default() };
    let mut told = None;
    for (line, text) in (1..).zip(text.lines().map(str::trim_end)) {
        let wrong = |why: &str| format!("the case {name}, line {line}: {why}");
        let (sort, rest) = text.split_once(' ').unwrap_or((text, ""));
        let json = || serde_json::from_str::<Value>(rest).map_err(|e| wrong(&e.to_string()));
        match sort {
            "#" if line == 1 => rest.clone_into(&mut case.title),
            "" | "#" => {}
            "version" => case.version = rest.parse().map_err(|_| wrong("no number"))?,
            "test" => rest.clone_into(&mut case.test),
            "limit" => rest.clone_into(&mut case.limit),
            "|" => case.members = format!("{}{rest}\n", case.members),
            "@" => case.programs.push(CaseProgram { name: rest.to_owned(), steps: Vec::new() }),
            ">" => told = Some(json()?.to_string()),
            "<" => {
                let told = told.take().ok_or_else(|| wrong("an answer to nothing"))?;
                let expected = json()?;
                if case.programs.is_empty() {
                    case.programs.push(CaseProgram { name: "robot".to_owned(), steps: Vec::new() });
                }
                let program = case.programs.last_mut().ok_or_else(|| wrong("no program"))?;
                program.steps.push(CaseStep { line, told, expected });
            }
            "!" => case.events.push(json()?),
            "log" => case.log = Some(json()?),
            "error" => case.error = Some(rest.to_owned()),
            _ => return Err(wrong("what begins so is not known")),
        }
    }
    Ok(case)
}

impl ConformanceCase {
    /// Its scenario, whose programs have no command of their own yet.
    pub fn scenario(&self) -> String {
        let programs: String = match self.programs.as_slice() {
            [_] => "run \"driver\"\n".to_owned(),
            several => several.iter().map(|p| format!("program {} {{ run \"driver\" }}\n", p.name)).collect(),
        };
        format!("{SCENARIO}\nsystem robot {{\n{programs}limit {}\n{}}}\n", self.limit, self.members)
    }

    /// The file with its test.
    pub fn tests(&self) -> String {
        format!("test cases.case {{ seed 1; {} }}\n", self.test)
    }

    /// Where it is, for people.
    pub fn place(&self, line: usize) -> String {
        format!("spec/protocol/{}.case:{line}", self.name)
    }
}

impl CaseProgram {
    /// What its driver is given: a step in each line.
    pub fn script(&self) -> String {
        self.steps.iter().map(|step| format!("{}\n", step.told)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_is_read_has_a_title_and_steps_and_is_shipped() {
        let cases = all().unwrap();
        for case in &cases {
            assert!(case.title.ends_with('.') && (1..=2).contains(&case.version), "{case:?}");
            assert!(
                case.programs.iter().all(|p| !p.steps.is_empty()) && !case.programs.is_empty(),
                "{case:?}"
            );
            assert!(!case.test.is_empty(), "{case:?}");
        }
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/protocol");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let is_case = |path: &std::path::PathBuf| path.extension().is_some_and(|e| e == "case");
        assert_eq!(files.filter(is_case).count(), cases.len());
    }

    #[test]
    fn what_is_no_case_is_told_with_its_line() {
        for (text, why) in [
            ("# T.\nhello", "line 2: what begins so is not known"),
            ("# T.\n< {}", "line 2: an answer to nothing"),
            ("# T.\n> {", "line 2: EOF"),
        ] {
            let error = parse("bad", text).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
    }
}
