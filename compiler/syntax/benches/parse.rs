//! How many lines a second are lexed and parsed, and formatted: the reference scenario, repeated to 100,000 lines.

use divan::Bencher;
use divan::counter::ItemsCount;
use hrdsl_source::FileId;

const LINES: usize = 100_000;

fn main() {
    divan::main();
}

fn text() -> String {
    let scenario = include_str!("../../../examples/handover/scenario.hri");
    let times = LINES.div_ceil(scenario.lines().count());
    scenario.replace("scenario handover\n", "").repeat(times)
}

#[divan::bench(sample_count = 10)]
fn scenario(bencher: Bencher<'_, '_>) {
    let text = text();
    bencher
        .counter(ItemsCount::new(text.lines().count()))
        .bench(|| hrdsl_syntax::parse(FileId(0), divan::black_box(&text)));
}

/// One broken step in every agent: the price of recovery.
#[divan::bench(sample_count = 10)]
fn broken(bencher: Bencher<'_, '_>) {
    let text = text().replace("ask_leg; -+asked(N + 1)", "ask_leg -+asked(N + )");
    bencher
        .counter(ItemsCount::new(text.lines().count()))
        .bench(|| hrdsl_syntax::parse(FileId(0), divan::black_box(&text)));
}

#[divan::bench(sample_count = 10)]
fn format(bencher: Bencher<'_, '_>) {
    let text = text();
    bencher
        .counter(ItemsCount::new(text.lines().count()))
        .bench(|| hrdsl_syntax::format(divan::black_box(&text)));
}
