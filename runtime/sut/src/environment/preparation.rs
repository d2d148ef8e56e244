//! What happens while an environment is prepared, as data: the console shows it, tests count it.

use std::time::Duration;

/// A step of the preparation. `what` is what is installed, in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PreparationStep<'a> {
    /// Another process installs the same; this one waits until it has ended.
    Waiting {
        what: &'a str,
    },
    /// What was installed is damaged, and is made again; `why` names the first file that differs.
    Damaged {
        what: &'a str,
        why: &'a str,
    },
    Started {
        what: &'a str,
    },
    /// Comes again and again, about once a second at least; `doing` is what pip said last.
    Working {
        what: &'a str,
        doing: &'a str,
        elapsed: Duration,
    },
    Finished {
        what: &'a str,
        elapsed: Duration,
    },
    /// The interpreter has packages that are installed as editable by a hook of `site`. Hooks do not run in tests, so
    /// programs do not find these packages.
    Hooked {
        packages: &'a [HookedPackage],
    },
}

/// A package that only a hook can find.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HookedPackage {
    pub package: String,
    /// Where its code is, if that is known: what to write into `requirements.txt`.
    pub folder: Option<String>,
}
