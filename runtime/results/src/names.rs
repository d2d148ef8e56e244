//! What things are called: each kind of name is a type of its own, so that none is taken for another.

use std::{borrow::Borrow, fmt, ops::Deref};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

macro_rules! names {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(
            Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
        )]
        #[serde(transparent)]
        pub struct $name(String);

        impl From<&str> for $name {
            fn from(name: &str) -> Self {
                Self(name.to_owned())
            }
        }

        impl From<String> for $name {
            fn from(name: String) -> Self {
                Self(name)
            }
        }

        impl $name {
            #[must_use]
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl PartialEq<str> for $name {
            fn eq(&self, other: &str) -> bool {
                self.0 == other
            }
        }

        impl PartialEq<&str> for $name {
            fn eq(&self, other: &&str) -> bool {
                self.0 == *other
            }
        }

        impl Deref for $name {
            type Target = str;

            fn deref(&self) -> &str {
                &self.0
            }
        }

        impl Borrow<str> for $name {
            fn borrow(&self) -> &str {
                &self.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(&self.0)
            }
        }
    )*};
}

names! {
    /// The name of a requirement: `R5`
    RequirementName;
    /// The name of a suite: `bdi_tests`
    SuiteName;
    /// The name of a test: `handover.bdi_tests.t017`; where a suite speaks of its own tests, without the scenario:
    /// `bdi_tests.t017`
    TestName;
}

/// The longest name of a file that leaves room for an ending in any file system.
const LONGEST_STEM: usize = 200;

impl TestName {
    /// The name without that of its scenario.
    #[must_use]
    pub fn within(&self, scenario: &str) -> &str {
        self.0.strip_prefix(scenario).and_then(|n| n.strip_prefix('.')).unwrap_or(&self.0)
    }

    /// The name of the test's files, without folder and ending: its own name, or if that is too long or cannot be the name
    /// of a file, a part of it and a digest.
    #[must_use]
    pub fn file_stem(&self) -> String {
        let fits = |c: char| c.is_alphanumeric() || matches!(c, '.' | '_' | '-');
        let name = self.0.as_str();
        if name.len() <= LONGEST_STEM && name.chars().all(fits) && !name.starts_with('.') {
            return name.to_owned();
        }
        let digest = Sha256::digest(name).iter().take(8).fold(0_u64, |n, byte| n << 8 | u64::from(*byte));
        let mut stem = String::new();
        for c in name.chars().map(|c| if fits(c) { c } else { '_' }) {
            if stem.len() + c.len_utf8() > LONGEST_STEM - 17 {
                break;
            }
            stem.push(c);
        }
        format!("{}-{digest:016x}", stem.trim_start_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::TestName;

    #[test]
    fn names_of_files_are_short_and_differ() {
        let stem = |name: &str| TestName::from(name).file_stem();
        assert_eq!(stem("bdi_tests.t017"), "bdi_tests.t017");
        let (a, b) = (stem(&format!("{}a", "x".repeat(300))), stem(&format!("{}b", "x".repeat(300))));
        assert!(a.len() <= 200 && b.len() <= 200 && a != b, "{a} {b}");
        for odd in ["../up", "a/b", ".hidden", "a b", "ä".repeat(150).as_str()] {
            let stem = stem(odd);
            assert!(stem.len() <= 200 && !stem.contains('/') && !stem.starts_with('.'), "{odd}: {stem}");
        }
    }
}
