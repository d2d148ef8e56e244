//! What would have fitted where the parser found something else, in words that a person uses.

use crate::token::{KEYWORDS, Keyword, KeywordClass, TokenKind, TokenTrait};

/// Where a run stopped fitting the grammar.
#[derive(Clone, Debug)]
pub(crate) struct ParseFault {
    /// What was being read.
    pub of: &'static str,
    /// Its first token: the keyword of a declaration, or the synthetic token before a member.
    pub within: Option<TokenKind>,
    /// The index of the token; that of the end, if it was the end that did not fit.
    pub at: usize,
    /// The terminals that would have fitted, as the grammar calls them.
    pub expected: Vec<String>,
}

impl ParseFault {
    /// The run could have ended here: what is before is complete.
    pub(crate) fn complete(&self) -> bool {
        self.has("END")
    }

    pub(crate) fn has(&self, terminal: &str) -> bool {
        self.expected.iter().any(|e| e.trim_matches('"') == terminal)
    }
}

const OPERATORS: &[&str] =
    &["+", "-", "*", "/", "%", "=", "==", "!=", "<", "<=", ">", ">=", "&&", "and", "||", "or", "imply"];

/// Terminals that together mean one thing to a person. The first that fits is taken. Where a name fits, nearly all keywords
/// do; a step that starts with a name is told by what it cannot start with.
struct TerminalGroup {
    /// In one of these.
    within: &'static [TokenKind],
    /// All of these are expected,
    if_all: &'static [&'static str],
    /// and none of these.
    if_none: &'static [&'static str],
    /// Names, and with them all soft keywords, are part of it.
    names: bool,
    /// The keywords that start a member of this block are part of it.
    members: Option<TokenTrait>,
    /// The others that are part of it.
    covers: &'static [&'static str],
    says: &'static [&'static str],
}

const EXPRESSION: &[&str] = &[
    "INT", "FLOAT", "QUANTITY", "STRING", "INTERNAL", "(", "[", "-", "~", "!", "!!", "not", "true", "false",
    "_", "if", "ERROR", ".",
];

const GROUPS: &[TerminalGroup] = &[
    TerminalGroup {
        within: &[],
        if_all: &["-+", "await"],
        if_none: &[],
        names: true,
        members: None,
        covers: &["!", "!!", "?", "+", "-", "-+", "await", "wait", "if", "while", "for", "fork", "INTERNAL"],
        says: &["a step such as `!goal` or `await`"],
    },
    TerminalGroup {
        within: &[TokenKind::Stimulus, TokenKind::StartStimulusStep],
        if_all: &["emit", "hold", "sample"],
        if_none: &["INT"],
        names: true,
        members: None,
        covers: &["emit", "hold", "sample", "if"],
        says: &["a step such as `emit` or `hold`"],
    },
    TerminalGroup {
        within: &[TokenKind::Test, TokenKind::StartTestMember],
        if_all: &["seed", "because", "await"],
        if_none: &["INT"],
        names: true,
        members: None,
        covers: &["seed", "method", "because", "predicts", "meanwhile", "await", "wait"],
        says: &["a step such as `await` or `wait`"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["gravity", "joint"],
        if_none: &["IDENT"],
        names: false,
        members: Some(TokenTrait::InWorld),
        covers: &[],
        says: &["a member of the world such as `body` or `signal`"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["explore", "horizon"],
        if_none: &["IDENT"],
        names: false,
        members: Some(TokenTrait::InSuite),
        covers: &[],
        says: &["a line such as `choose` or `tests`"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["each", "query", "IDENT"],
        if_none: &["imply"],
        names: true,
        members: None,
        covers: &["each", "query"],
        says: &["`each`", "`query`", "a name"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["ORIGIN", "clock"],
        if_none: &["IDENT"],
        names: false,
        members: Some(TokenTrait::InAutomaton),
        covers: &["ORIGIN"],
        says: &["`location`", "`clock`", "`var`", "an edge such as `a -> b`"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["after", "never", "ERROR", "("],
        if_none: &["-"],
        names: true,
        members: None,
        covers: &[
            "ERROR",
            "(",
            "after",
            "never",
            "globally",
            "always",
            "eventually",
            "whenever",
            "at",
            "exactly",
        ],
        says: &["a pattern such as `after` or `globally`"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["+", "-", "on"],
        if_none: &["*"],
        names: false,
        members: None,
        covers: &["+", "-", "on"],
        says: &["a trigger such as `+!goal` or `on event`"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["INT", "-", "not"],
        if_none: &[],
        names: true,
        members: None,
        covers: EXPRESSION,
        says: &["an expression"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["INT", "-", "("],
        if_none: &[],
        names: true,
        members: None,
        covers: EXPRESSION,
        says: &["a value"],
    },
    TerminalGroup {
        within: &[],
        if_all: &["+", "*", "."],
        if_none: &[],
        names: false,
        members: None,
        covers: &[".", "(", "["],
        says: &[],
    },
    TerminalGroup {
        within: &[],
        if_all: &["+", "*", "["],
        if_none: &[],
        names: false,
        members: None,
        covers: &["["],
        says: &[],
    },
    TerminalGroup {
        within: &[],
        if_all: &["=", "+=", "["],
        if_none: &[],
        names: false,
        members: None,
        covers: &[".", "["],
        says: &[],
    },
    TerminalGroup {
        within: &[],
        if_all: &["when", "["],
        if_none: &[],
        names: false,
        members: None,
        covers: &["(", "["],
        says: &[],
    },
    // A path may go on where a step may start.
    TerminalGroup {
        within: &[],
        if_all: &["IDENT", "."],
        if_none: &[],
        names: false,
        members: None,
        covers: &["."],
        says: &[],
    },
    // Fits before every member, and is never what was meant.
    TerminalGroup {
        within: &[],
        if_all: &["allow", "plan"],
        if_none: &["IDENT"],
        names: false,
        members: None,
        covers: &["allow"],
        says: &[],
    },
    TerminalGroup {
        within: &[],
        if_all: &["allow", "clock"],
        if_none: &["IDENT"],
        names: false,
        members: None,
        covers: &["allow"],
        says: &[],
    },
    TerminalGroup {
        within: &[],
        if_all: &["allow", "ORIGIN"],
        if_none: &["IDENT"],
        names: false,
        members: None,
        covers: &["allow"],
        says: &[],
    },
    TerminalGroup {
        within: &[],
        if_all: &["allow", "bin"],
        if_none: &["IDENT"],
        names: false,
        members: None,
        covers: &["allow"],
        says: &[],
    },
];

/// The words for what would have fitted, where the token that did not is the first of its line or not.
pub(crate) fn describe(fault: &ParseFault, first: bool) -> Vec<String> {
    let mut left: Vec<&str> = fault.expected.iter().map(|e| e.trim_matches('"')).collect();
    let mut said = Vec::new();
    for group in GROUPS {
        // After an operand there are operators.
        let any_name = left.contains(&"imply") && left.contains(&"else") && !left.contains(&"*");
        let within = group.within.is_empty()
            || !any_name && fault.within.is_some_and(|within| group.within.contains(&within));
        let fits = within
            && group.if_all.iter().all(|t| left.contains(t))
            && !group.if_none.iter().any(|t| left.contains(t));
        if fits {
            said.extend(group.says.iter().map(|s| (*s).to_owned()));
            let member =
                |t: &str| group.members.is_some_and(|m| row(t).is_some_and(|k| k.traits.contains(&m)));
            left.retain(|t| !(group.covers.contains(t) || group.names && is_name(t) || member(t)));
        }
    }
    if left.contains(&"IDENT") {
        said.push("a name".to_owned());
        left.retain(|t| !is_name(t));
    }
    // `and` and `or` alone stand between the branches of a fork.
    let fork = !left.iter().any(|t| OPERATORS.contains(t) && !["and", "or", "imply"].contains(t));
    if !fork && left.iter().filter(|t| OPERATORS.contains(t)).count() >= 2 {
        said.push("an operator".to_owned());
        left.retain(|t| !OPERATORS.contains(t));
    }
    said.extend(left.iter().filter(|t| **t != "END").filter_map(|t| terminal(t)));
    // Members may end anywhere: that goes without saying, unless nothing else fits.
    if left.contains(&"END") && (said.is_empty() || fault.of == "declaration") {
        said.truncate(4);
        said.push(if first { format!("a new {}", fault.of) } else { format!("the end of the {}", fault.of) });
    }
    said
}

fn is_name(terminal: &str) -> bool {
    terminal == "IDENT" || keyword(terminal).is_some_and(|class| class != KeywordClass::Reserved)
}

pub(crate) fn row(word: &str) -> Option<&'static Keyword> {
    KEYWORDS.iter().find(|k| k.word == word)
}

pub(crate) fn keyword(word: &str) -> Option<KeywordClass> {
    row(word).map(|k| k.class)
}

fn terminal(name: &str) -> Option<String> {
    Some(match name {
        "ORIGIN" => "a name".to_owned(),
        "INTERNAL" => "an internal action such as `.print`".to_owned(),
        "INT" => "a number".to_owned(),
        "STRING" => "a text in quotes".to_owned(),
        "END" | "ERROR" | "FLOAT" | "QUANTITY" => return None,
        start if start.starts_with("START_") => return None,
        other => format!("`{other}`"),
    })
}
