//! What is imported of UPPAAL's models checks, whatever has been cut out of them or changed in them, and no file breaks the import.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::{fs, path::Path};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_interop::{
    ForeignSource,
    uppaal::{UppaalOptions, import},
};

/// Random numbers that are the same each time.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

/// Words of declarations and labels, which go where others were.
const WORDS: &[&str] = &[
    "0",
    "1",
    "x",
    "n",
    "id",
    "len",
    "true",
    "i : int[0,1]",
    "x[id]",
    "list[0]",
    "len++",
    "x &lt;= 5",
    "(1 + 2)",
    "-1",
    "!b",
    "x = 0",
    "int",
    "clock",
    "chan c;",
    "meta int m;",
    "[2]",
    "&amp;",
    "&lt;&lt;",
    "==",
    "or",
    "urgent",
    "/* said */",
    "x' == 0",
    "void f() { x = 0; }",
    "f()",
    "struct { int a; } r;",
    "r.a",
    "abs(n)",
    "INT16_MAX",
    "?",
    ":",
    "forall (k : int[0,1]) k == n",
];

fn changed(text: &str, random: &mut Random) -> String {
    let places: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
    let start = random.below(places.len());
    let end = start + [1, 2, 5, 12, 40][random.below(5)];
    let (start, end) = (places[start], places.get(end).copied().unwrap_or(text.len()));
    let put = WORDS[random.below(WORDS.len())];
    // A word in the place of another keeps most texts whole.
    let word = |from: usize| {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let begin = text[from..].find(is_part).map_or(text.len(), |i| from + i);
        let end = text[begin..].find(|c| !is_part(c)).map_or(text.len(), |i| begin + i);
        (begin, end)
    };
    let (begin, stop) = word(start);
    match random.below(5) {
        0 => format!("{}{}", &text[..start], &text[end..]),
        1 => format!("{}{}{}", &text[..end], &text[start..end], &text[end..]),
        2 => format!("{}{put}{}", &text[..start], &text[start..]),
        _ => format!("{}{put}{}", &text[..begin], &text[stop..]),
    }
}

#[test]
fn what_is_imported_checks() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/uppaal");
    let mut names: Vec<_> = fs::read_dir(folder.join("demos")).unwrap().map(|e| e.unwrap().path()).collect();
    names.retain(|path| path.extension().is_some_and(|e| e != "q"));
    names.push(folder.join("handover.xml"));
    names.sort();
    assert!(names.len() >= 8);
    let rounds = std::env::var("HRDSL_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(150);
    let mut random = Random(7);
    let (mut errors, mut read, mut refused) = (Vec::new(), 0, 0);
    for path in names {
        let text = fs::read_to_string(&path).unwrap();
        for _ in 0..rounds {
            let mut now = changed(&text, &mut random);
            if random.below(2) == 0 {
                now = changed(&now, &mut random);
            }
            let source = ForeignSource { name: path.display().to_string(), text: now.clone() };
            let imported = match import(&source, None, &UppaalOptions::default()) {
                Ok(imported) => imported,
                Err(said) => {
                    refused += 1;
                    assert!(!said.is_empty() && said.iter().all(|e| e.line > 0 && !e.message.is_empty()));
                    continue;
                }
            };
            read += 1;
            let compilation = compile(InputFile { name: "m.hri", text: &imported.text }, &[]);
            let wrong = compilation.diagnostics.iter().filter(|d| d.is_error());
            errors.extend(wrong.map(|d| {
                let place = compilation.files.place(d.span());
                let line = place.split(':').nth(1).and_then(|n| n.parse::<usize>().ok()).unwrap_or(1);
                let shown = imported.text.lines().nth(line - 1).unwrap_or_default();
                format!("{}: {place} {} {}\n    {:.200}", path.display(), d.code, d.message, shown)
            }));
        }
    }
    assert!(errors.is_empty(), "{} of {read}:\n{}", errors.len(), errors.join("\n"));
    assert!(read > 100 && refused > 100, "{read} read, {refused} refused");
}
