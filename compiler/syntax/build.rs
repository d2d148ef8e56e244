//! Generates the parser from `src/grammar.lalrpop`, after the registry of keywords has been put into it.
#![expect(clippy::disallowed_methods, reason = "a build script reads and writes files")]

use std::{env, error::Error, fs, path::Path};

macro_rules! keywords {
    ($($kind:ident $word:tt $class:ident $place:literal [$($holds:ident)*];)*) => {
        &[$(RegistryRow {
            kind: stringify!($kind),
            word: $word,
            class: stringify!($class),
            traits: &[$(stringify!($holds)),*],
        }),*]
    };
}

struct RegistryRow {
    kind: &'static str,
    word: &'static str,
    class: &'static str,
    traits: &'static [&'static str],
}

const REGISTRY: &[RegistryRow] = include!("src/keywords.in");

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/grammar.lalrpop");
    println!("cargo::rerun-if-changed=src/keywords.in");
    let out = env::var("OUT_DIR")?;
    let whole = with_keywords(&fs::read_to_string("src/grammar.lalrpop")?);
    let place = Path::new(&out).join("grammar.lalrpop");
    // Unchanged it keeps its time, and nothing that is made of it is made again.
    if fs::read_to_string(&place).ok().as_ref() != Some(&whole) {
        fs::write(&place, whole)?;
    }
    lalrpop::Configuration::new().set_in_dir(&out).set_out_dir(&out).process()?;
    Ok(())
}

/// The grammar with what the registry says: all tokens of keywords, and those that are names wherever `Soft` is.
fn with_keywords(grammar: &str) -> String {
    let token =
        |row: &RegistryRow| format!("\"{}\" => Lexeme {{ kind: TokenKind::{}, .. }},", row.word, row.kind);
    let is_soft = |row: &&RegistryRow| row.class != "Reserved" && !row.traits.contains(&"Apart");
    let tokens: Vec<String> = REGISTRY.iter().map(token).collect();
    let soft: Vec<String> = REGISTRY.iter().filter(is_soft).map(|row| format!("\"{}\",", row.word)).collect();
    grammar.replace("@KEYWORDS@", &tokens.join("\n        ")).replace("@SOFT@", &soft.join("\n    "))
}
