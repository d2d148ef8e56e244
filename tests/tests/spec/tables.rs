//! What the pages repeat from registries is generated: between `<!-- NAME -->` and `<!-- end -->` stands what the code says.
//! `HRDSL_UPDATE=1` writes it.

use std::{env, fmt::Write, fs};

use hrdsl_compiler::token::{KEYWORDS, KeywordClass};
use hrdsl_ir::{
    Type,
    device::{CommandType, DevicePrimitive, NumberCount},
    device_state::DeviceState,
};
use hrdsl_model::{Dimension, UNITS, type_named, type_names};
use hrdsl_source::{GROUPS, REGISTRY};

use crate::page::{pages, read, root};

/// Compares a generated part of a page with what it should be, or writes it.
pub fn generated(page: &str, name: &str, text: &str) {
    let old = read(page);
    let (start, end) = (format!("<!-- {name} -->\n"), "<!-- end -->");
    let (before, rest) = old.split_once(&start).unwrap_or_else(|| panic!("{page} has no `{}`", start.trim()));
    let (_, after) = rest.split_once(end).unwrap_or_else(|| panic!("{page}: `{name}` has no end"));
    same(page, &old, &format!("{before}{start}\n{}\n\n{end}{after}", text.trim()));
}

/// Compares a page with what it should be, or writes it.
fn same(page: &str, old: &str, new: &str) {
    if old == new {
        return;
    }
    if env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(root().join(page), new).unwrap();
        return;
    }
    let line = old.lines().zip(new.lines()).find(|(o, n)| o != n);
    panic!("{page} differs from the code, first in {line:?} (old, new): update it with HRDSL_UPDATE=1");
}

/// The name of a dimension's type.
fn type_of(dim: Dimension) -> &'static str {
    let mut names = type_names().filter(|n| *n != "float");
    names.find(|n| type_named(n) == Some(Type::Float(dim.unit()))).expect("each unit is of a named dimension")
}

#[test]
fn the_types() {
    let mut table = String::from("| type | values | counted in |\n|---|---|---|\n");
    for name in type_names() {
        let (values, unit) = match type_named(name) {
            Some(Type::Float(unit)) => {
                let symbol = Some(unit.symbol()).filter(|s| !s.is_empty()).map(|s| format!("`{s}`"));
                ("64-bit floats", symbol.unwrap_or_default())
            }
            Some(Type::Bool) => ("`false`, `true`", String::new()),
            Some(Type::Int { .. }) => ("whole numbers of 64 bits", String::new()),
            Some(Type::Text) => ("texts", String::new()),
            Some(Type::List(_) | Type::Enum(_)) | None => panic!("{name}"),
        };
        let _ = writeln!(table, "| `{name}` | {values} | {unit} |");
    }
    generated("spec/types.md", "types", &table);
}

#[test]
fn the_units() {
    let mut table = String::from("| unit | type | 1 of it is |\n|---|---|---|\n");
    for unit in UNITS {
        let si = unit.dim.symbol().unwrap_or_default();
        let _ = writeln!(table, "| `{}` | `{}` | {} {si} |", unit.symbol, type_of(unit.dim), unit.to_si(1.0));
    }
    generated("spec/types.md", "units", &table.replace("  |", " |"));
}

#[test]
fn the_keywords() {
    let mut table = String::from("| keyword | reserved | where |\n|---|---|---|\n");
    for keyword in KEYWORDS {
        let reserved = match keyword.class {
            KeywordClass::Reserved => "always",
            KeywordClass::Head | KeywordClass::Hard | KeywordClass::Soft => "in its place",
        };
        let _ = writeln!(table, "| `{}` | {reserved} | {} |", keyword.word, keyword.place);
    }
    generated("spec/grammar.md", "keywords", &table);
}

/// What follows the comment at the module's head.
#[test]
fn the_devices() {
    let module = hrdsl_stdlib::module(hrdsl_stdlib::DEVICES).unwrap();
    let declared = module.split_once("\n\n").unwrap().1;
    let mut text = String::from("```text\n");
    let mut example = false;
    for line in declared.lines() {
        let comment = line.starts_with("///");
        example = comment && (example || line == "///");
        if !example {
            let _ = writeln!(text, "{line}");
        }
    }
    generated("spec/world.md", "devices", &(text + "```"));
}

#[test]
fn the_primitives() {
    let type_text = |ty: CommandType| {
        let dim = UNITS
            .iter()
            .find(|unit| unit.symbol == ty.unit.symbol())
            .map_or(Dimension::NUMBER, |unit| unit.dim);
        match ty.count {
            NumberCount::One => type_of(dim).to_owned(),
            NumberCount::Array(n) => format!("{}[{n}]", type_of(dim)),
            NumberCount::List => format!("[{}]", type_of(dim)),
        }
    };
    let mut table = String::from("| primitive | of | needs | may take |\n|---|---|---|---|\n");
    for primitive in DevicePrimitive::ALL {
        let params = |optional: bool| {
            let these = primitive.params().iter().filter(|p| p.optional == optional);
            let these: Vec<String> = these.map(|p| format!("`{}: {}`", p.name, type_text(p.ty))).collect();
            if these.is_empty() { "–".to_owned() } else { these.join(", ") }
        };
        let (name, of) = (primitive.name(), primitive.sort().name());
        let _ = writeln!(table, "| `{name}` | {of} | {} | {} |", params(false), params(true));
    }
    generated("spec/world.md", "primitives", &table);
}

#[test]
fn what_a_world_can_tell() {
    let mut table = String::from("| primitive | of | numbers |\n|---|---|---|\n");
    for state in DeviceState::ALL {
        let _ = writeln!(table, "| `{}` | {} | {} |", state.name(), state.sort().name(), state.numbers());
    }
    generated("spec/world.md", "states", &table);
}

#[test]
fn the_codes() {
    let mut text = String::new();
    for (hundred, about) in GROUPS {
        let _ = writeln!(text, "\n### HR{hundred:02}xx: {about}\n\n| code | rule |\n|---|---|");
        for info in REGISTRY.iter().filter(|i| i.code.0 / 100 == *hundred) {
            let _ = writeln!(text, "| [{0}](codes/{0}.md) | {1} |", info.code, info.title);
        }
    }
    generated("spec/diagnostics.md", "codes", &text);
}

/// The contents of the book have a line for each code, below that of the diagnostics; updated, also for each page that is
/// not yet there, before it.
#[test]
fn the_contents_of_the_book() {
    let old = read("spec/SUMMARY.md");
    let is_code = |line: &&str| line.trim_start().starts_with("- [HR");
    let missing: Vec<String> = pages(&root().join("spec"))
        .iter()
        .map(|p| p.file_name().unwrap().to_string_lossy().into_owned())
        .filter(|name| name != "SUMMARY.md" && !old.contains(&format!("]({name})")))
        .collect();
    let mut new = String::new();
    for line in old.lines().filter(|l| !is_code(l)) {
        let of_codes = line.contains("(diagnostics.md)");
        for name in missing.iter().filter(|_| of_codes) {
            let page = read(&format!("spec/{name}"));
            let title = page.lines().next().unwrap_or_default().trim_start_matches('#').trim();
            let _ = writeln!(new, "- [{title}]({name})");
        }
        let _ = writeln!(new, "{line}");
        for info in REGISTRY.iter().filter(|_| of_codes) {
            let _ = writeln!(new, "  - [{0}: {1}](codes/{0}.md)", info.code, info.title);
        }
    }
    same("spec/SUMMARY.md", &old, &new);
}

/// Literals of metric formulas have the units of the language.
#[test]
fn formulas_have_all_units() {
    let of_language = UNITS.iter().map(|u| (u.symbol, u.dim.unit(), u.to_si(55.55)));
    let of_formulas = hrdsl_metric::LITERAL_UNITS.iter().map(|u| (u.symbol, u.si, u.to_si(55.55)));
    assert_eq!(of_formulas.collect::<Vec<_>>(), of_language.collect::<Vec<_>>());
}
