//! How long texts with 20,000 of one thing are compiled, and how much memory that takes.

use divan::{AllocProfiler, Bencher, counter::BytesCount};
use hrdsl_compiler::{InputFile, compile};

#[path = "many/mod.rs"]
mod many;

#[global_allocator]
static ALLOC: AllocProfiler = AllocProfiler::system();

const MANY: usize = 20_000;

fn main() {
    divan::main();
}

fn names() -> impl Iterator<Item = &'static str> {
    many::SHAPES.iter().map(|s| s.0)
}

#[divan::bench(args = names(), sample_count = 3, sample_size = 1)]
fn of(bencher: Bencher<'_, '_>, name: &str) {
    let text = many::SHAPES.iter().find(|s| s.0 == name).map(|s| s.1(MANY)).unwrap_or_default();
    bencher
        .counter(BytesCount::new(text.len()))
        .bench(|| compile(InputFile { name: "many.hri", text: divan::black_box(&text) }, &[]));
}
