//! A campaign like a real one, for the tests of the reports: three suites, six requirements, fourteen bins.

mod mixture;
mod model;
mod prediction;
mod system;

use hrdsl_results::{
    BinName, BinResult, CampaignResults, CodeFile, CounterexampleStep, CoverageRatios, FORMAT, FirstFailure,
    GoalReport, GoalStatus, OutputSummary, RequirementKind, RequirementResult, RunEnd, RunMark,
    SmallestMargin, SuiteGoalId, SuiteInfo, TestMethod, TestResult, TraceJudgement, TriggerTotal, VERSION,
    VerdictOutcome as Outcome, VerdictResult, VerdictTally,
};

use mixture::mix;
pub(crate) use model::model;
pub(crate) use system::{machines, wait, warnings};

const SUITES: [(&str, TestMethod); 3] = [
    ("bdi_tests", TestMethod::Agents),
    ("ta_tests", TestMethod::Search),
    ("random_tests", TestMethod::Random),
];

const REQUIREMENTS: [(&str, RequirementKind, &str, &str); 6] = [
    (
        "R1",
        RequirementKind::Functional,
        "a leg is released or discarded in time once the robot has decided",
        "after decided(_): (released or discarded) within DEADLINE",
    ),
    (
        "R2",
        RequirementKind::Functional,
        "a person who is ready gets the leg",
        "sensed(true, true, true) causes released within DEADLINE",
    ),
    (
        "R3",
        RequirementKind::Functional,
        "a person who is not ready does not get the leg",
        "(sensed(false, _, _) or sensed(_, false, _) or sensed(_, _, false)) forbids released until leg_request",
    ),
    (
        "R4",
        RequirementKind::Functional,
        "whoever asks is answered: the leg is released or discarded",
        "leg_request causes released or discarded",
    ),
    (
        "R5",
        RequirementKind::Safety,
        "the gripper does not close on a hand",
        "never gripper_closing while distance(person.hand, robot.palm) < 5 cm",
    ),
    ("R6", RequirementKind::Safety, "the arm is slow", "globally joint_speed(robot.arm) < 0.25 rad/s"),
];

const BINS: [&str; 14] = [
    "4 legs, one released",
    "4 legs, one refused",
    "4 legs, bored",
    "3 legs, one released",
    "3 legs, one refused",
    "3 legs, bored",
    "2 legs, one released",
    "2 legs, one refused",
    "2 legs, bored and timed out",
    "1 leg, released",
    "1 leg, refused",
    "1 leg, bored",
    "asked, and never decided",
    "never asked",
];

const SOURCE: &str = r#""""Hands the legs of a table to a person."""
import hrdsl

LEGS = 4
SENSING_WINDOW = 10.0  # seconds


class Handover:
    """One leg: fetch, offer, sense, decide."""

    def __init__(self, robot):
        self.robot = robot
        self.legs = 0

    def fetch(self):
        for attempt in range(2):
            self.robot.arm.move_to(hrdsl.place("above_leg"), speed=0.2)
            if self.robot.grip.close():
                return True
        self.robot.log("could not <grasp> the leg & gave up")
        return False

    def sense(self):
        readings = self.robot.sense(within=SENSING_WINDOW)
        if readings is None:
            self.robot.emit("timed_out")
            return None
        return all(readings)

    def run(self):
        while self.legs < LEGS:
            self.robot.wait_for("leg_request")
            if not self.fetch():
                raise RuntimeError("no leg in the gripper")
            self.robot.emit("handover_offered")
            ready = self.sense()
            if ready:
                self.robot.grip.open()
                self.robot.emit("released")
            else:
                self.discard()
            self.legs += 1

    def discard(self):
        self.robot.arm.move_to(hrdsl.place("aside"), speed=0.2)
        self.robot.grip.open()
        self.robot.emit("discarded")
"#;

const STATEMENTS: [u32; 36] = [
    2, 4, 5, 8, 11, 12, 13, 15, 16, 17, 18, 19, 20, 21, 23, 24, 25, 26, 27, 28, 30, 31, 32, 33, 34, 35, 36,
    37, 38, 39, 41, 42, 44, 45, 46, 47,
];
const BRANCHES: [(u32, i32); 12] = [
    (16, 17),
    (16, 20),
    (18, 16),
    (18, 19),
    (25, 26),
    (25, 28),
    (31, -30),
    (31, 32),
    (33, 34),
    (33, 35),
    (37, 38),
    (37, 41),
];

/// A test with what it executed.
struct TestFixture {
    result: TestResult,
    executed: ExecutedCode,
}

/// Executed lines and branches.
struct ExecutedCode {
    lines: Vec<u32>,
    branches: Vec<(u32, i32)>,
}

/// A campaign with this many tests in each suite.
pub fn campaign(per_suite: usize) -> CampaignResults {
    let tests: Vec<TestFixture> =
        (0..SUITES.len()).flat_map(|s| (0..per_suite).map(move |i| test(s, i))).collect();
    let of = |s: usize| tests.iter().filter(move |t| t.result.suite == SUITES[s].0);
    CampaignResults {
        format: FORMAT.into(),
        version: VERSION,
        hrdsl: "0.1.0".into(),
        scenario: "handover".into(),
        seed: 1,
        requirements: (0..REQUIREMENTS.len()).map(|r| requirement(r, &tests)).collect(),
        suites: (0..SUITES.len()).map(|s| suite(s, &of(s).collect::<Vec<_>>())).collect(),
        bins: BINS.iter().map(|b| bin(b, &tests)).collect(),
        code: vec![code(&tests)],
        machines: Vec::new(),
        warnings: Vec::new(),
        interrupted: false,
        planned: tests.len(),
        rerun: "hrdsl sim ../scenario.hri tests --test".into(),
        view: "hrdsl view ../scenario.hri --results .".into(),
        unreplayed: Vec::new(),
        tests: tests.into_iter().map(|t| t.result).collect(),
    }
}

fn test(s: usize, i: usize) -> TestFixture {
    let (suite, method) = SUITES[s];
    let number = i + 1;
    let error = (i % 11 == 6 && s != 1).then(|| {
        "the program ended with exit status 1 at 141.30 s\nTraceback (most recent call last):\n  File \"robot.py\", line 34, in \
         run\n    raise RuntimeError(\"no leg in the gripper\")\nRuntimeError: no leg in the gripper"
            .to_owned()
    });
    let seen = ((mix(s, i, 1) % 5) as usize, mix(s, i, 2));
    let bins = if s == 2 { vec![bin_name(12 + i % 2)] } else { vec![bin_name(i % 11), bin_name(seen.0 * 2)] };
    let predicted = prediction::predicted(s, i, &bins);
    let executed = executed(s, i);
    let unmet = prediction::unmet(i);
    let ended = if error.is_some() { RunEnd::Error } else { [RunEnd::Quiescent, RunEnd::Limit][i % 2] };
    let prediction = prediction::verdict((method, ended), (&predicted, &bins), &unmet);
    let result = TestResult {
        name: format!("handover.{suite}.t{number:03}").into(),
        suite: suite.into(),
        method,
        seed: number as u64,
        ended,
        duration: if error.is_some() { 141.3 } else { 60.0 + (mix(s, i, 3) % 24000) as f64 / 100.0 },
        judgement: TraceJudgement {
            verdicts: (0..REQUIREMENTS.len()).map(|r| verdict(s, i, r, error.is_some())).collect(),
            bins,
            conformance: prediction::conformance(i),
            ..TraceJudgement::default()
        },
        predicted,
        prediction,
        unmet,
        because: because(s, i),
        code: ratios(&executed),
        steps: steps(s, i),
        marks: if i % 29 == 6 { vec![RunMark::DependsOnLoad] } else { Vec::new() },
        output: OutputSummary {
            stdout_bytes: 120,
            stderr_bytes: if error.is_some() { 42 } else { 0 },
            stderr_end: error
                .as_ref()
                .map(|_| "RuntimeError: no leg in the gripper".into())
                .unwrap_or_default(),
        },
        error,
        ..TestResult::default()
    };
    TestFixture { result, executed }
}

fn bin_name(b: usize) -> BinName {
    BinName::new("human_robot", BINS[b])
}

fn because(s: usize, i: usize) -> Vec<String> {
    match s {
        0 => vec![format!(
            "wants({}), shows(1, true, {}, true), bored_at(0), eager_at(2)",
            1 + i % 4,
            i.is_multiple_of(2)
        )],
        1 => vec![
            format!("witness of bin {}", bin_name(i % 11)),
            "witness of edge Robot: sensing -> decide".to_owned(),
        ],
        _ => vec![format!("{} steps drawn at random", 5 + i % 16)],
    }
}

fn steps(s: usize, i: usize) -> Vec<String> {
    let leg = |n: usize| {
        let draw = |salt: u64, from: f64, to: f64| {
            from + (to - from) * (mix(s, i * 9 + n, salt) % 1000) as f64 / 1000.0
        };
        vec![
            "ask_leg".to_owned(),
            "await handover_offered within 60 s".to_owned(),
            format!(
                "look(true) with offset = {:.3} m, distance = {:.3} m, angle = {:.3} deg",
                draw(5, 0.1, 0.2),
                draw(6, 0.5, 0.6),
                draw(7, 15.0, 40.0)
            ),
            "reach(true) with dx = 0.05 m, dy = -0.1 m, dz = -0.05 m".to_owned(),
            "grip(true)".to_owned(),
            "say_ready".to_owned(),
            "await released | discarded within 120 s".to_owned(),
            "put_down".to_owned(),
        ]
    };
    (0..=i % 4).flat_map(leg).collect()
}

fn verdict(s: usize, i: usize, r: usize, is_broken: bool) -> VerdictResult {
    let dice = mix(s, i, 10 + r as u64) % 100;
    let outcome = match r {
        5 => Outcome::Pass,
        0 if dice < 20 + 15 * s as u64 % 25 => Outcome::Fail,
        1 if dice < 9 && s != 2 => Outcome::Fail,
        2 if s == 0 && i % 12 == 3 => Outcome::Fail,
        4 if dice < 8 * (1 + s as u64) => Outcome::Fail,
        1 if s == 2 => Outcome::Vacuous,
        3 if dice > 92 => Outcome::Inconclusive,
        _ if is_broken => Outcome::Error,
        _ if dice > 60 => Outcome::Vacuous,
        _ => Outcome::Pass,
    };
    let failure =
        (outcome == Outcome::Fail).then(|| failure(r, 20.0 + (mix(s, i, 30) % 9000) as f64 / 100.0));
    let worst_margin = match r {
        4 if outcome == Outcome::Fail => Some((-0.0321, "m".into())),
        4 if outcome == Outcome::Pass => Some((0.184, "m".into())),
        5 => Some((0.031 + (mix(s, i, 40) % 90) as f64 / 10_000.0, "rad/s".into())),
        _ => None,
    };
    VerdictResult {
        requirement: REQUIREMENTS[r].0.into(),
        outcome,
        triggered: if outcome == Outcome::Vacuous { 0 } else { 1 + (dice % 4) as u32 },
        failures: u32::from(outcome == Outcome::Fail),
        failure,
        worst_margin,
        unvalued: None,
    }
}

fn failure(r: usize, time: f64) -> FirstFailure {
    let step = |step: usize, time: f64, text: &str| CounterexampleStep { step, time, text: text.to_owned() };
    match r {
        4 => FirstFailure {
            time,
            triggered_at: time,
            deadline: false,
            counterexample: vec![step(
                188,
                time,
                "gripper_closing, distance(person.hand, robot.palm) = 0.018 m",
            )],
            around: Vec::new(),
        },
        2 => FirstFailure {
            time,
            triggered_at: time - 3.5,
            deadline: false,
            counterexample: vec![
                step(301, time - 3.5, "sensed(true, false, true)"),
                step(316, time, "released"),
            ],
            around: Vec::new(),
        },
        _ => FirstFailure {
            time,
            triggered_at: time - 10.0,
            deadline: true,
            counterexample: vec![step(
                204,
                time - 10.0,
                if r == 0 { "decided(true)" } else { "sensed(true, true, true)" },
            )],
            around: Vec::new(),
        },
    }
}

/// What a test executes: the longer it runs, the more; only agents and search get to the rare lines.
fn executed(s: usize, i: usize) -> ExecutedCode {
    let is_executed = |line: &u32| match line {
        20 | 21 => false,
        34 => i % 11 == 6 && s != 1,
        26 | 27 => s != 1 && mix(s, i, 50).is_multiple_of(3),
        38 | 39 => s != 2 && !mix(s, i, 51).is_multiple_of(4),
        41 | 45..=47 => !mix(s, i, 52).is_multiple_of(3),
        24 | 25 | 28 | 35..=37 | 42 => s != 2 || !mix(s, i, 53).is_multiple_of(3),
        _ => true,
    };
    let lines: Vec<u32> = STATEMENTS.iter().copied().filter(is_executed).collect();
    let taken = |(from, to): &(u32, i32)| {
        lines.contains(from) && (*to < 0 || lines.contains(&u32::try_from(*to).unwrap_or(0))) && *from != 18
            || (*from, *to) == (18, 19)
    };
    ExecutedCode { branches: BRANCHES.iter().copied().filter(taken).collect(), lines }
}

fn ratios(executed: &ExecutedCode) -> CoverageRatios {
    CoverageRatios {
        lines: executed.lines.len() as u32,
        lines_total: STATEMENTS.len() as u32,
        branches: executed.branches.len() as u32,
        branches_total: BRANCHES.len() as u32,
    }
}

/// What several tests execute together.
fn together(tests: &[&TestFixture]) -> ExecutedCode {
    let line = |line: &u32| tests.iter().any(|t| t.executed.lines.contains(line));
    let branch = |branch: &(u32, i32)| tests.iter().any(|t| t.executed.branches.contains(branch));
    ExecutedCode {
        lines: STATEMENTS.iter().copied().filter(line).collect(),
        branches: BRANCHES.iter().copied().filter(branch).collect(),
    }
}

fn requirement(r: usize, tests: &[TestFixture]) -> RequirementResult {
    let (name, kind, title, text) = REQUIREMENTS[r];
    let mut tally = vec![VerdictTally::default(); SUITES.len()];
    let mut failing = Vec::new();
    let mut worst_margin: Option<SmallestMargin> = None;
    for test in tests.iter().map(|t| &t.result) {
        let suite = SUITES.iter().position(|(name, _)| test.suite == *name).unwrap_or(0);
        let verdict = &test.judgement.verdicts[r];
        tally[suite].add(verdict.outcome);
        if verdict.outcome == Outcome::Fail {
            failing.push(test.name.clone());
        }
        if let Some((value, unit)) = verdict.worst_margin.clone()
            && worst_margin.as_ref().is_none_or(|m| value < m.value)
        {
            worst_margin = Some(SmallestMargin { value, unit, test: test.name.clone() });
        }
    }
    RequirementResult {
        name: name.into(),
        kind,
        title: title.into(),
        doc: String::new(),
        text: text.into(),
        tally,
        failing,
        triggered: TriggerTotal::of(&name.into(), tests.iter().map(|test| &test.result)),
        worst_margin,
    }
}

fn suite(s: usize, tests: &[&TestFixture]) -> SuiteInfo {
    let (name, method) = SUITES[s];
    let line_percent = |n: usize| ratios(&together(&tests[..n])).line_percent();
    let goal = |goal: SuiteGoalId, status: GoalStatus, reason: &str| GoalReport {
        goal,
        status,
        reason: reason.into(),
        test: None,
    };
    let mut goals = Vec::new();
    if method == TestMethod::Search {
        goals.extend(BINS[..13].iter().zip(0..13).map(|(b, i)| {
            let name = SuiteGoalId::Bin(BinName::new("human_robot", b));
            if i == 11 {
                goal(
                    name,
                    GoalStatus::Unreachable,
                    "proved: none of the 48210 symbolic states that the model can reach meets it",
                )
            } else {
                goal(name, GoalStatus::Reached, "in 23 steps")
            }
        }));
        goals.push(goal(
            SuiteGoalId::Edge("Robot: sensing -> timeout3".into()),
            GoalStatus::Inconclusive,
            "the budget of states was used up",
        ));
        let gone = SuiteGoalId::Location("Person.gone".into());
        goals.push(goal(gone, GoalStatus::Reached, "in 5 steps"));
    }
    SuiteInfo {
        name: name.into(),
        method,
        abstract_tests: Some([131, 91, 160][s].min(tests.len())),
        tests: tests.len() as u32,
        errors: tests.iter().filter(|t| t.result.error.is_some()).count() as u32,
        goals,
        model: None,
        explanation: None,
        notes: if s == 0 { vec!["pairwise: 131 belief sets of 20480 possible".into()] } else { vec![] },
        code: ratios(&together(tests)),
        code_accumulated: (1..=tests.len()).map(line_percent).collect(),
        code_per_test: tests.iter().map(|t| t.result.code.line_percent()).collect(),
    }
}

fn bin(bin: &str, tests: &[TestFixture]) -> BinResult {
    let name = BinName::new("human_robot", bin);
    let tests: Vec<&TestResult> = tests.iter().map(|t| &t.result).collect();
    let number = |has: &dyn Fn(&TestResult) -> bool| -> Vec<u32> {
        let of = |(suite, _): &(&str, TestMethod)| {
            tests.iter().filter(|t| t.suite == *suite && has(t)).count() as u32
        };
        SUITES.iter().map(of).collect()
    };
    let hits = number(&|t| t.judgement.bins.contains(&name));
    let unreachable =
        (bin == "1 leg, bored").then(|| "none of the 48210 symbolic states of the model meets it".into());
    BinResult {
        predicted: number(&|t| t.predicted.contains(&name) && unreachable.is_none()),
        first: tests.iter().find(|t| t.judgement.bins.contains(&name)).map(|t| t.name.clone()),
        cross: "human_robot".into(),
        bin: bin.into(),
        hits,
        unreachable,
        name,
    }
}

fn code(tests: &[TestFixture]) -> CodeFile {
    let all = together(&tests.iter().collect::<Vec<_>>());
    let executed_by = |line: u32, is_of: &dyn Fn(&TestFixture) -> bool| {
        tests.iter().filter(|t| is_of(t) && t.executed.lines.contains(&line)).count() as u32
    };
    let suites = |line: &u32| {
        SUITES.iter().map(|(suite, _)| executed_by(*line, &|t| t.result.suite == *suite)).collect()
    };
    CodeFile {
        file: "robot.py".into(),
        ratios: ratios(&all),
        lines: STATEMENTS.iter().map(|l| (*l, executed_by(*l, &|_| true))).collect(),
        suites: STATEMENTS.iter().map(suites).collect(),
        missed_branches: BRANCHES.iter().copied().filter(|b| !all.branches.contains(b)).collect(),
        source: SOURCE.into(),
    }
}
