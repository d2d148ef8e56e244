//! How many lines a second are compiled: a generated scenario of 100,000 lines, alone with its library. Asked for are
//! 500,000 lines a second for reading, 200,000 for reading, resolving, checking and the static help together.

use divan::Bencher;
use divan::counter::ItemsCount;
use hrdsl_compiler::{InputFile, compile};
use hrdsl_source::FileId;

mod large;

const LINES: usize = 100_000;

fn main() {
    divan::main();
}

fn lines(text: &str) -> ItemsCount {
    ItemsCount::new(text.lines().count())
}

#[divan::bench(sample_count = 10)]
fn parse(bencher: Bencher<'_, '_>) {
    let text = large::scenario(LINES);
    bencher.counter(lines(&text)).bench(|| hrdsl_syntax::parse(FileId(0), divan::black_box(&text)));
}

/// What `hrdsl check` does, without the Program.
#[divan::bench(sample_count = 10)]
fn parse_resolve_lint(bencher: Bencher<'_, '_>) {
    let text = large::scenario(LINES);
    bencher.counter(lines(&text)).bench(|| {
        let (file, issues) = hrdsl_syntax::parse(FileId(0), divan::black_box(&text));
        let (scenario, more) = hrdsl_model::resolve(&file, &[], &[]);
        assert!(issues.is_empty() && more.is_empty());
        (hrdsl_model::lint(&scenario), scenario, file)
    });
}

/// The whole compiler, with the Program.
#[divan::bench(sample_count = 10)]
fn whole(bencher: Bencher<'_, '_>) {
    let text = large::scenario(LINES);
    bencher
        .counter(lines(&text))
        .bench(|| compile(InputFile { name: "line.hri", text: divan::black_box(&text) }, &[]));
}

/// One declaration of it checked again alone: what an editor waits for after each key.
#[divan::bench(sample_count = 10)]
fn recheck_one_declaration(bencher: Bencher<'_, '_>) {
    let text = large::scenario(LINES);
    let compiled = compile(InputFile { name: "large", text: &text }, &[]);
    let span = compiled.ast[0].items[compiled.ast[0].items.len() / 2].span;
    bencher.bench(|| {
        let again =
            hrdsl_compiler::recheck(&compiled, span.start as usize, divan::black_box(&text[span.range()]));
        assert!(again.is_some_and(|again| again.diagnostics.is_empty()));
    });
}
