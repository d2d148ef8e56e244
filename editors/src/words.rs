//! The words of the language, as templates name them.

use hrdsl_model::{UNITS, type_names};
use hrdsl_syntax::token::{KEYWORDS, Keyword, KeywordClass, TokenTrait};

/// The words of a list: `heads`, `hard`, `soft`, `soft:PLACE`, `before_event`, `after_event`, `units` or `types`. `None`: there is no such list.
#[must_use]
pub fn list(name: &str) -> Option<Vec<&'static str>> {
    let words =
        |keep: &dyn Fn(&Keyword) -> bool| KEYWORDS.iter().filter(|k| keep(k)).map(|k| k.word).collect();
    match name {
        "heads" => Some(words(&|k| k.class == KeywordClass::Head)),
        "hard" => Some(words(&|k| matches!(k.class, KeywordClass::Hard | KeywordClass::Reserved))),
        "soft" => Some(words(&|k| k.class == KeywordClass::Soft)),
        "before_event" => Some(words(&|k| k.traits.contains(&TokenTrait::BeforeEvent))),
        "after_event" => Some(words(&|k| k.traits.contains(&TokenTrait::AfterEvent))),
        "units" => Some(base_units()),
        // A shared clock is declared as a variable is.
        "types" => Some(type_names().chain(["clock"]).collect()),
        other => {
            let place = other.strip_prefix("soft:")?;
            let found: Vec<_> = words(&|k| k.class == KeywordClass::Soft && places(k).any(|p| p == place));
            (!found.is_empty()).then_some(found)
        }
    }
}

/// The constructs that a keyword belongs to.
fn places(keyword: &Keyword) -> impl Iterator<Item = &'static str> {
    keyword.place.split(',').map(str::trim)
}

/// What units are made of: the names in them, each once.
fn base_units() -> Vec<&'static str> {
    let mut names: Vec<_> = UNITS.iter().flat_map(|u| u.symbol.split(['/', '^'])).collect();
    names.retain(|n| n.starts_with(|c: char| c.is_ascii_alphabetic()));
    names.sort_unstable();
    names.dedup();
    names
}

/// The registry as JSON, a keyword to a line, for tests that are not written in Rust.
pub(crate) fn registry() -> String {
    let row = |k: &Keyword| {
        let class = match k.class {
            KeywordClass::Head => "head",
            KeywordClass::Hard | KeywordClass::Reserved => "hard",
            KeywordClass::Soft => "soft",
        };
        format!("  {{ \"word\": \"{}\", \"class\": \"{class}\", \"place\": \"{}\" }}", k.word, k.place)
    };
    format!("[\n{}\n]\n", KEYWORDS.iter().map(row).collect::<Vec<_>>().join(",\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_what_the_registry_says() {
        assert_eq!(list("soft:stimulus"), Some(vec!["sample", "hold"]));
        assert_eq!(list("soft:nowhere"), None);
        assert_eq!(list("nothing"), None);
        let all: usize = ["heads", "hard", "soft"].iter().map(|l| list(l).unwrap().len()).sum();
        assert_eq!(all, KEYWORDS.len());
    }

    #[test]
    fn units_are_taken_apart() {
        let units = list("units").unwrap();
        assert!(units.contains(&"cm") && units.contains(&"h") && !units.contains(&"%"));
        assert!(units.iter().all(|u| u.chars().all(|c| c.is_ascii_alphabetic())), "{units:?}");
    }
}
