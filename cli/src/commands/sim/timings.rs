//! `--timings`: where the processor time of the tests went.

use std::fmt::Write as _;

use hrdsl_runtime::campaign::CampaignTimes;

/// The times as a table, and the figures that they come to.
pub fn table(times: &CampaignTimes) -> String {
    let rows = [
        ("physics engine", times.engine),
        ("programs under test", times.programs),
        ("physics beside the engine", times.world),
        ("reading signals and devices", times.sensing),
        ("plans, commands, actions", times.planning),
        ("messages of programs", times.exchange),
        ("harness", times.harness),
        ("monitors and coverpoints", times.judgement),
        ("recordings", times.recordings),
        ("results", times.results),
        ("worlds and programs, begun and ended", times.start_up),
        ("cells and interpreters", times.cells),
    ];
    let whole = times.total();
    let percent = |part: f64, of: f64| if of > 0.0 { 100.0 * part / of } else { 0.0 };
    let mut text = String::from("processor time of the tests\n");
    for (name, time) in rows.into_iter().chain([("all", whole)]) {
        let _ = writeln!(text, "  {name:<38}{time:>9.3} s {:>6.1} %", percent(time, whole));
    }
    let bare = times.engine + times.programs;
    let faster = if whole > 0.0 { times.simulated / whole } else { 0.0 };
    let _ = writeln!(
        text,
        "  {:.1} s simulated, {faster:.0} × as fast as real time on one core; to engine and programs, hrdsl adds {:.1} %, and \
         the physics beside the engine {:.1} %",
        times.simulated,
        percent(times.own(), bare),
        percent(times.world, bare)
    );
    text
}

#[cfg(test)]
mod tests {
    use hrdsl_runtime::campaign::CampaignTimes;

    use super::table;

    #[test]
    fn shares_are_of_all_and_the_addition_is_to_engine_and_programs() {
        let times = CampaignTimes {
            simulated: 300.0,
            engine: 0.25,
            programs: 0.15,
            world: 0.05,
            harness: 0.03,
            cells: 0.02,
            ..CampaignTimes::default()
        };
        let text = table(&times);
        assert!(text.contains("  physics engine                            0.250 s   50.0 %\n"), "{text}");
        assert!(text.contains("  all                                       0.500 s  100.0 %\n"), "{text}");
        assert!(text.ends_with("  300.0 s simulated, 600 × as fast as real time on one core; to engine and programs, hrdsl adds 7.5 %, and the physics beside the engine 12.5 %\n"), "{text}");
        assert!(table(&CampaignTimes::default()).contains(" 0 × as fast"));
    }
}
