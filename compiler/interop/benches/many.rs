//! How long programs of other tools with many of one thing are imported, or refused, and how much memory that takes.

use divan::{AllocProfiler, Bencher, counter::BytesCount};
use hrdsl_interop::{ForeignLoader, ForeignSource, agentspeak, uppaal};

#[global_allocator]
static ALLOC: AllocProfiler = AllocProfiler::system();

fn main() {
    divan::main();
}

/// Nothing is included.
struct Nothing;

impl ForeignLoader for Nothing {
    fn load(&self, _: &str, path: &str) -> Result<ForeignSource, String> {
        Err(format!("there is no {path}"))
    }
}

fn plans(count: usize) -> String {
    (0..count).map(|n| format!("+!g{n}(X) : b(X) <- .print(X); !g{}(X).\n", n + 1)).collect()
}

/// As many plans as are imported, and more than that, which are refused.
#[divan::bench(args = [500, 2_000, 10_000], sample_count = 3, sample_size = 1)]
fn plans_of_agentspeak(bencher: Bencher<'_, '_>, count: usize) {
    let files = [ForeignSource { name: "bob.asl".to_owned(), text: plans(count) }];
    bencher.counter(BytesCount::new(files[0].text.len())).bench(|| {
        agentspeak::import(divan::black_box(&files), &Nothing, &agentspeak::AgentSpeakOptions::default())
            .is_ok()
    });
}

/// Models of UPPAAL that grow when they are read: an entity that stands 50,000 times, and an element with 200,000 attributes.
#[divan::bench(args = ["entity", "attributes"], sample_count = 3, sample_size = 1)]
fn models_that_are_refused(bencher: Bencher<'_, '_>, which: &str) {
    let text = if which == "entity" {
        let (long, uses) = ("x".repeat(50_000), "&e;".repeat(50_000));
        format!("<!DOCTYPE nta [<!ENTITY e \"{long}\">]><nta><declaration>{uses}</declaration></nta>")
    } else {
        let attributes: String = (0..200_000).map(|n| format!(" a{n}=\"\"")).collect();
        format!("<nta{attributes}></nta>")
    };
    let model = ForeignSource { name: "model.xml".to_owned(), text };
    bencher.counter(BytesCount::new(model.text.len())).bench(|| {
        let refused =
            uppaal::import(divan::black_box(&model), None, &uppaal::UppaalOptions::default()).is_err();
        assert!(refused);
    });
}
