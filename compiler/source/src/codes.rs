//! The registry of diagnostic codes: HR00xx lexical and syntax, HR01xx names, HR02xx types and units, HR03xx roles,
//! HR04xx agents, HR05xx automata, HR06xx requirements, HR07xx coverage and suites, HR08xx world and system, HR09xx tests.

use std::fmt;

use serde::{Serialize, Serializer};

/// A diagnostic code; its page is `spec/codes/HRnnnn.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct DiagnosticCode(pub u16);

impl fmt::Display for DiagnosticCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "HR{:04}", self.0)
    }
}

impl Serialize for DiagnosticCode {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.collect_str(self)
    }
}

/// One row of the registry.
#[derive(Clone, Copy, Debug)]
pub struct CodeInfo {
    pub code: DiagnosticCode,
    /// The rule in a few words.
    pub title: &'static str,
}

/// What the codes of each hundred are about: of HR01xx, names.
pub const GROUPS: &[(u16, &str)] = &[
    (0, "characters and syntax"),
    (1, "names"),
    (2, "types and units"),
    (3, "roles"),
    (4, "agents"),
    (5, "automata"),
    (6, "requirements"),
    (7, "coverage and suites"),
    (8, "world and system"),
    (9, "tests"),
];

impl DiagnosticCode {
    /// What the codes of its hundred are about.
    #[must_use]
    pub fn group(self) -> &'static str {
        GROUPS.iter().find(|(hundred, _)| *hundred == self.0 / 100).map_or("others", |(_, about)| about)
    }

    /// The code's row in the registry.
    #[must_use]
    pub fn info(self) -> Option<&'static CodeInfo> {
        REGISTRY.iter().find(|info| info.code == self)
    }
}

macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $number:literal $title:literal),* $(,)?) => {
        impl DiagnosticCode {
            $($(#[$doc])* pub const $name: DiagnosticCode = DiagnosticCode($number);)*
        }

        /// All codes, in order.
        pub const REGISTRY: &[CodeInfo] = &[$(CodeInfo { code: DiagnosticCode::$name, title: $title }),*];
    };
}

codes! {
    BAD_CHARACTER = 1 "a character that the language does not use",
    SYNTAX = 2 "text that does not fit the grammar",
    UNTERMINATED_STRING = 3 "a string without an end",
    BAD_NUMBER = 4 "a number that cannot be represented",
    TOO_DEEP = 5 "more than the compiler takes",
    UNKNOWN_NAME = 101 "a name that is not declared",
    DUPLICATE_NAME = 102 "a name declared twice",
    WRONG_KIND = 103 "a name of another kind than the place needs",
    UNKNOWN_MODULE = 104 "a module that does not exist",
    MISSING_DECLARATION = 105 "a declaration that the scenario needs",
    MODULE_ITEM = 106 "a declaration that a module cannot have",
    UNUSED = 107 "a declaration that nothing uses",
    USELESS_ALLOW = 109 "an allowance for nothing",
    TYPE_MISMATCH = 201 "a value of the wrong type",
    UNKNOWN_UNIT = 202 "a unit that does not exist",
    UNIT_MISMATCH = 203 "a quantity of the wrong dimension",
    NOT_CONSTANT = 204 "a constant is needed here",
    ARITY = 205 "the wrong number of arguments",
    OUT_OF_RANGE = 206 "a value outside its range",
    EMPTY_RANGE = 207 "a range without a value",
    CONSTANT_CYCLE = 208 "a constant that needs its own value",
    OVERFLOW = 209 "a value that leaves its variable's range",
    MAY_OVERFLOW = 210 "a value that may leave its variable's range",
    OF_AGENTS_ONLY = 211 "a string or list outside of agents",
    WRONG_ROLE = 301 "an actor in a role it does not have",
    NOT_ITS_EVENT = 302 "an event made by another actor than it belongs to",
    NOT_PERCEIVED = 303 "an event that its receiver never perceives",
    EVENT_NOT_MADE = 304 "an event that nobody makes",
    EVENT_NOT_TAKEN = 305 "an event that nobody takes",
    UNBOUND_VARIABLE = 401 "a variable without a value",
    NO_PLAN = 402 "a goal that no plan achieves",
    NOT_ADOPTED = 403 "a plan for a goal that nothing adopts",
    BELIEF_NEVER_ADDED = 404 "a belief tested that nothing adds",
    AWAITS_NOTHING = 405 "a wait for an event that nobody makes",
    DROPS_ANOTHERS_BELIEF = 406 "a plan that drops another plan's belief",
    SHADOWED_PLAN = 407 "a plan that an earlier one always takes the place of",
    DEAD_PLAN = 408 "a plan that never runs",
    NO_FAILURE_PLAN = 409 "a failure that nothing handles",
    NO_TIME_PASSES = 410 "a recursion in which no time passes",
    OUT_OF_PLACE = 411 "a formula or internal action out of place",
    BAD_MESSAGE = 412 "a message that nobody understands",
    REMOVES_NOTHING = 413 "a removal that takes nothing away",
    NO_INITIAL_LOCATION = 501 "an automaton without exactly one initial location",
    BAD_CLOCK_CONSTRAINT = 502 "a clock used other than in a bound",
    TWO_SENDS = 503 "an edge that sends twice",
    SAMPLED_EVENT = 504 "an event that depends on a sample, sent by an automaton",
    UNREACHABLE_LOCATION = 505 "a location that no edge reaches",
    TIME_STOPS = 506 "an invariant that stops time",
    NO_TIME_PASSES_HERE = 507 "a cycle in which no time passes",
    CLOCKS_COMPARED = 508 "two clocks compared where one stands still",
    URGENT_GUARD = 511 "a clock guard on an edge of an urgent channel",
    BAD_JOINT = 512 "a multi-way channel that is used as another kind",
    NO_ACTOR = 513 "an event in an automaton without an actor",
    ONE_SIDED_CHANNEL = 514 "a channel with a side missing",
    BAD_QUERY = 520 "a query that cannot be asked",
    RECURSION = 521 "a function that calls itself",
    BAD_RETURN = 522 "a function without its value, or with one too many",
    IMPURE = 523 "a change where a value is only looked at",
    BAD_PATTERN = 601 "a requirement that says nothing",
    NEVER_TRIGGERED = 602 "a requirement that can never be triggered",
    CONTRADICTING_REQUIREMENTS = 603 "requirements that contradict each other",
    SAID_DISCHARGES = 604 "a requirement that takes the code at its word",
    CANNOT_FAIL = 605 "a requirement that cannot fail",
    OVERLAPPING_BINS = 701 "bins that overlap",
    BAD_SUITE = 702 "a suite that cannot make tests",
    EMPTY_BIN = 703 "a bin that contradicts itself",
    EQUAL_BINS = 704 "bins that are the same",
    BAD_WORLD = 801 "a world that cannot be built",
    NOTHING_CARRIES = 802 "a body that nothing carries",
    NO_SUCH_FILE = 803 "a file that does not exist",
    BAD_COMMAND = 804 "a command that the world cannot do",
    BAD_DEFINITION = 805 "a ROS interface with a fault",
    BAD_BINDING = 806 "a binding that cannot work",
    BAD_DESCRIPTION = 807 "a description of a robot, or a map, with a fault",
    BAD_TEST = 901 "a test that cannot run",
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_hundred_that_has_codes_is_about_something() {
        for info in REGISTRY {
            assert_ne!(info.code.group(), "others", "{}", info.code);
            assert_eq!(info.code.info().map(|i| i.title), Some(info.title));
        }
    }
}
