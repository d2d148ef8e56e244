//! Random small networks, with all that the language has, against explicit exploration of clock regions.
//!
//! `HRDSL_CASES` sets the number of networks of each kind, `HRDSL_SEED` the first seed; with `HRDSL_SOAK=1` it is 25,000, a hundred thousand in all. A network in which engine and regions differ is
//! made smaller, and printed.

mod common;
#[path = "random_networks/dice.rs"]
mod dice;
#[path = "random_networks/engine.rs"]
mod engine;
#[path = "random_networks/less.rs"]
mod less;
#[path = "common/oracle/mod.rs"]
mod oracle;
#[path = "random_networks/pinned.rs"]
mod pinned;

use dice::{Flavour, network};
use engine::disagreement;

pub fn number(name: &str, default: u64) -> u64 {
    #[allow(clippy::disallowed_methods, reason = "how long to look is asked from outside")]
    let given = std::env::var(name).ok();
    given.and_then(|n| n.parse().ok()).unwrap_or(default)
}

/// Compares networks of one kind. At least half of them must be for the oracle.
fn compare(flavour: Flavour, cases: u64) {
    let (cases, first) = (
        number("HRDSL_CASES", if number("HRDSL_SOAK", 0) == 1 { 25_000 } else { cases }),
        number("HRDSL_SEED", 0),
    );
    let mut compared = 0;
    for seed in first..first + cases {
        let p = network(seed, flavour);
        match disagreement(&p) {
            Ok(None) => compared += 1,
            // The oracle cannot say.
            Err(_) => {}
            Ok(Some(_)) => {
                let small = less::reduced(&p, &|p| matches!(disagreement(p), Ok(Some(_))));
                let what = disagreement(&small);
                let what = what.ok().flatten().unwrap_or_default();
                panic!("seed {seed} of {flavour:?}: {what}\n{}", oracle::text::program(&small));
            }
        }
    }
    assert!(compared * 2 >= cases, "only {compared} of {cases} networks could be compared");
}

#[test]
fn events_agree_with_regions() {
    compare(Flavour::Events, 1200);
}

#[test]
fn channels_agree_with_regions() {
    compare(Flavour::Channels, 1200);
}

#[test]
fn data_and_clocks_agree_with_regions() {
    compare(Flavour::Whole, 1200);
}

#[test]
fn differences_agree_with_regions() {
    compare(Flavour::Differences, 500);
}
