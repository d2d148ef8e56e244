//! What agents do does not depend on the threads that they reason on.

use hrdsl_bdi::{ActionToken, AgentSociety, LogDetail, RunStatus, show};
use hrdsl_ir::{Nanos, Program, value::SECOND};
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;

#[path = "programs/mod.rs"]
#[allow(dead_code, reason = "the benchmark has the others")]
mod programs;
#[path = "programs/random.rs"]
mod random;

/// Runs a society for a minute: each action takes half a second and is then perceived by all others. The log, and what
/// everybody believes in the end.
fn played(program: &Program, parallel: bool) -> String {
    let mut society = AgentSociety::with_detail(program, &programs::all(program), 7, LogDetail::Reasons);
    society.set_parallel(parallel);
    society.set_cycle_limit(3000);
    society.measure();
    let mut acting: Vec<(Nanos, usize, ActionToken)> = Vec::new();
    let mut now = 0;
    while now <= 60 * SECOND {
        let (done, left): (Vec<_>, Vec<_>) = acting.into_iter().partition(|(due, ..)| *due <= now);
        acting = left;
        for (_, agent, token) in done {
            society.stimulus_done(agent, token, now);
        }
        let mut out = Vec::new();
        society.run(now, &mut out);
        for (agent, action) in out {
            for other in (0..program.agents.len()).filter(|o| *o != agent) {
                society.perceive(other, action.event, &action.args);
            }
            acting.push((now + SECOND / 2, agent, action.token));
        }
        let next = acting.iter().map(|(due, ..)| *due).chain(society.next_wake()).min();
        match (society.status(), next) {
            (RunStatus::Livelock | RunStatus::Endless | RunStatus::Overfull(_) | RunStatus::Malformed, _)
            | (_, None) => {
                break;
            }
            (RunStatus::Ready, _) => {}
            (_, Some(next)) => now = next.max(now),
        }
    }
    let mut text: String = society
        .log()
        .iter()
        .map(|(agent, entry)| {
            let what = society.describe(*agent, entry);
            format!("{} {agent} {} {} {what}\n", show::time(entry.time), entry.round, entry.cycle)
        })
        .collect();
    for agent in 0..program.agents.len() {
        text += &format!("{:?}\n", society.beliefs(agent).collect::<Vec<_>>());
    }
    text + &format!("{:?} {:?}", society.status(), society.measured())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn one_thread_and_many_are_the_same(seed: u64, agents in 2u16..9) {
        let program = random::society(seed, agents);
        let one = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let many = ThreadPoolBuilder::new().num_threads(4).build().unwrap();
        let alone = played(&program, false);
        prop_assert_eq!(&one.install(|| played(&program, true)), &alone);
        prop_assert_eq!(&many.install(|| played(&program, true)), &alone);
    }
}

/// The programs do something: else the property would say little.
#[test]
fn the_programs_are_lively() {
    let logs: Vec<String> = (0..150).map(|seed| played(&random::society(seed, 4), false)).collect();
    let all = logs.concat();
    let least = [
        ("→", 3000),
        ("finished", 1000),
        ("failed", 300),
        ("hears tell", 30),
        ("hears answer", 20),
        ("perceives", 200),
        ("fork", 50),
        ("dropped", 20),
        ("the time is over", 40),
    ];
    for (what, least) in least {
        let found = all.matches(what).count();
        assert!(found >= least, "only {found} × {what}");
    }
}
