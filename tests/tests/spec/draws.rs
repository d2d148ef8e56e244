//! The page on random draws is a program: it draws what the generators of tests draw.

use std::{
    fmt::Write as _,
    io::Write as _,
    process::{Command, Stdio},
};

use hrdsl_bdi::choose::{BeliefExplorer, BeliefFactor, FactorAlternative, explore};
use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{
    Value,
    abstract_test::BeliefSet,
    bdi::{AgentId, BeliefId, InitialFact},
    suite::ExploreMode,
    test::TestStep,
    world::SignalId,
};
use hrdsl_runtime::testgen::generate;

use crate::page::{read, split};

const SCENARIO: &str = "scenario draws
    actor person : environment
    actor child  : environment
    stimulus act(kind: 0..6) by person {
      sample number in -3 .. 40
      sample near in if kind > 3 { -10 cm .. 20 cm } else { 0 m .. 0 m }
      sample turn in 0 rad .. 3 rad
      hold near / 1 m * 1 s
    }
    stimulus run(far: bool) by child {
      sample speed in 0 m/s .. 2 m/s
      hold 1 s
    }
    suite chance by random { stimuli act length 3..9 pause 0 s .. 10 s tests 12 }
    suite chances by random { stimuli act, run length 3..9 pause 0 s .. 10 s tests 12 }
    suite beside by random { stimuli act length 3..9 pause 0 s .. 2 s boundary 0.5 tests 12 }
    require R functional act(0) causes act(1) within 1500 ms";

/// What hrdsl draws, a line for each number.
fn drawn(seed: u64, suite: usize) -> (String, Vec<u64>) {
    let compilation = compile(InputFile { name: "draws", text: SCENARIO }, &[]);
    let program = compilation.program.expect("the scenario compiles");
    let generated = generate(&program, &program.suites[suite], None, seed).unwrap();
    let (mut lines, mut seeds) = (String::new(), Vec::new());
    for test in &generated.tests {
        seeds.push(test.seed);
        for step in test.scripts.iter().flat_map(|script| &script.steps) {
            match step {
                TestStep::Wait { time } => {
                    let _ = writeln!(lines, "{time}");
                }
                TestStep::Do { args, samples, .. } => {
                    for value in args.iter().chain(samples) {
                        let _ = match value {
                            Value::Int(n) => writeln!(lines, "{n}"),
                            Value::Float(x) => writeln!(lines, "{:016x}", x.to_bits()),
                            Value::Bool(b) => writeln!(lines, "{b}"),
                            Value::Symbol(_) | Value::Text(_) | Value::List(_) => panic!("{value:?}"),
                        };
                    }
                }
                TestStep::Await { .. } => panic!("none is in the suite"),
            }
        }
    }
    (lines, seeds)
}

/// The same by the program of the page.
const BY_THE_PAGE: &str = "
import struct, sys
seed, seeds = int(sys.argv[1]), [int(s) for s in sys.argv[2:]]
chance = Generator(seed)
hexed = lambda x: '%016x' % struct.unpack('>Q', struct.pack('>d', x))[0]
for own in seeds:
    steps = []
    for _ in range(chance.whole(3, 9, 32)):
        pause = chance.whole(0, 10 * 10**9, 64) // 10**8 * 10**8
        steps.append((pause, chance.whole(0, 6, 32)))
    samples = Generator(own)
    for pause, kind in steps:
        if pause: print(pause)
        print(kind)
        print(samples.sample(-3, 40))
        print(hexed(samples.sample(-0.1, 0.2) if kind > 3 else samples.sample(0.0, 0.0)))
        print(hexed(samples.sample(0.0, 3.0)))
";

/// The same of two actors, each with a script.
const BY_THE_PAGE_FOR_TWO: &str = "
import struct, sys
seed, seeds = int(sys.argv[1]), [int(s) for s in sys.argv[2:]]
chance = Generator(seed)
hexed = lambda x: '%016x' % struct.unpack('>Q', struct.pack('>d', x))[0]
for own in seeds:
    scripts = [], []
    for _ in range(chance.whole(3, 9, 32)):
        pause = chance.whole(0, 10 * 10**9, 64) // 10**8 * 10**8
        choice = chance.whole(0, 8, 32)
        scripts[choice > 6].append((pause, choice))
    stream = 0
    for script in scripts:
        samples = Generator(own, stream)
        stream += bool(script)
        for pause, choice in script:
            if pause: print(pause)
            if choice > 6:
                print('true' if choice == 8 else 'false')
                print(hexed(samples.sample(0.0, 2.0)))
                continue
            print(choice)
            print(samples.sample(-3, 40))
            print(hexed(samples.sample(-0.1, 0.2) if choice > 3 else samples.sample(0.0, 0.0)))
            print(hexed(samples.sample(0.0, 3.0)))
";

/// The same with half of the pauses beside a bound: the ends of their range, and the time of the requirement.
const BY_THE_PAGE_BESIDE: &str = "
import struct, sys
seed, seeds = int(sys.argv[1]), [int(s) for s in sys.argv[2:]]
chance = Generator(seed)
beside = [n * 10**8 for n in (0, 1, 14, 15, 16, 19, 20)]
hexed = lambda x: '%016x' % struct.unpack('>Q', struct.pack('>d', x))[0]
for own in seeds:
    steps = []
    for _ in range(chance.whole(3, 9, 32)):
        if chance.real(0, 1) < 0.5: pause = beside[chance.whole(0, 6, 32)]
        else: pause = chance.whole(0, 2 * 10**9, 64) // 10**8 * 10**8
        steps.append((pause, chance.whole(0, 6, 32)))
    samples = Generator(own)
    for pause, kind in steps:
        if pause: print(pause)
        print(kind)
        print(samples.sample(-3, 40))
        print(hexed(samples.sample(-0.1, 0.2) if kind > 3 else samples.sample(0.0, 0.0)))
        print(hexed(samples.sample(0.0, 3.0)))
";

/// The programs of the page, followed by one more; what it prints.
fn by_the_page(more: &str, args: &[String]) -> String {
    let blocks = split(&read("spec/randomness.md")).0.into_iter().filter(|b| b.info == "python");
    let program: String = blocks.map(|b| b.text).chain([more.to_owned()]).collect();
    let mut child = Command::new("python3")
        .arg("-")
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 is there");
    child.stdin.take().unwrap().write_all(program.as_bytes()).unwrap();
    String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap()
}

fn compare(what: &str, expected: &str, got: &str) {
    let first = expected.lines().zip(got.lines()).enumerate().find(|(_, (e, g))| e != g);
    assert!(first.is_none(), "{what}: line, expected, got: {first:?}");
    assert_eq!(expected.lines().count(), got.lines().count(), "{what}");
}

#[test]
fn the_page_draws_what_the_generators_draw() {
    for seed in [0, 1, 77, 18_000_000] {
        for (suite, page) in [BY_THE_PAGE, BY_THE_PAGE_FOR_TWO, BY_THE_PAGE_BESIDE].into_iter().enumerate() {
            let (expected, seeds) = drawn(seed, suite);
            let args: Vec<String> = std::iter::once(seed).chain(seeds).map(|s| s.to_string()).collect();
            compare(&format!("seed {seed}, suite {suite}"), &expected, &by_the_page(page, &args));
            assert!(expected.lines().count() > 100);
        }
    }
}

/// Readings at rest: sensors, and the world, stand still, and what is read is the error.
const SENSORS: &str = "scenario errors
    actor robot : system
    world {
      body wall: fixed box(1 m, 1 m, 1 m) at (0 m, 0 m, 0 m)
      signal place: length to robot = wall.x every 10 ms noise 2 mm dropout 20 %
      signal truth: bool to robot = wall.x > 1 m every 10 ms dropout 20 % flip 30 %
    }
    system robot { run \"python3 robot.py\" }";

const SENSORS_BY_THE_PAGE: &str = "
import sys
def newest(sensor, number, dropout):
    while True:
        draws = of_sample(int(sys.argv[1]), sensor, number)
        if not happens(draws, dropout): return draws
        number -= 1
for number in range(200):
    print('%.9f' % (gaussian(newest('signal place', number, 0.2), 0.002) + 0.0))
    print(str(happens(newest('signal truth', number, 0.2), 0.3)).lower())
";

#[test]
fn the_page_draws_the_errors_of_sensors() {
    let compilation = compile(InputFile { name: "errors", text: SENSORS }, &[]);
    let program = compilation.program.expect("the scenario compiles");
    let world = program.world.as_ref().expect("a world");
    for seed in [0, 1, u64::MAX] {
        let sim = hrdsl_sim::WorldSimulation::new(world, &program.signals).expect("a world");
        let mut sim = sim.seeded(seed).expect("sensors");
        let mut got = String::new();
        for number in 0..200 {
            sim.advance(number * 10_000_000);
            let place = sim.reading(SignalId(0)).as_f64().expect("a length");
            let _ = writeln!(got, "{:.9}", place + 0.0);
            let _ = writeln!(got, "{}", sim.reading(SignalId(1)).as_bool().expect("a truth"));
        }
        let page = by_the_page(SENSORS_BY_THE_PAGE, &[seed.to_string()]);
        compare(&format!("seed {seed}"), &got.replace("-0.000000000", "0.000000000"), &page);
    }
}

#[test]
fn the_page_chooses_what_suites_choose() {
    let choose = "
import sys
sizes, tests, seed = eval(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
chance = Generator(seed)
rows = fitting(2, sizes, pairwise(sizes, chance), tests, Generator(seed, 1))
for row in fill(rows, sizes, tests, chance): print(*row)
chance = Generator(seed)
for row in fill([], sizes, tests, chance): print(*row)
";
    let spaces: [&[u32]; 6] = [&[], &[4], &[2, 2], &[3, 1, 2, 5], &[5, 8, 8, 8, 8, 2, 2], &[4; 9]];
    let whole = spaces.iter().flat_map(|sizes| [(*sizes, 40, 5), (*sizes, 1000, 1)]);
    // Fewer tests than greedy rows: by construction (a field of 3, of 4 and of 8, the sum of the others, halves), and by
    // search.
    let fewer: [(&[u32], u32, u64); 11] = [
        (&[], 0, 0),
        (&[4], 3, 0),
        (&[3, 1, 2, 5], 3, 0),
        (&[3; 13], 15, 0),
        (&[4; 5], 16, 2),
        (&[8, 3, 8, 7], 64, 1),
        (&[6, 2, 5], 30, 3),
        (&[2; 12], 7, 0),
        (&[5, 3, 3, 3, 3, 2, 2, 2, 2, 2, 2], 16, 0),
        (&[4; 9], 26, 4),
        (&[3; 5], 11, 9),
    ];
    for (sizes, tests, seed) in whole.chain(fewer) {
        let factors: Vec<BeliefFactor> = sizes.iter().map(|n| factor(*n)).collect();
        let mut expected = String::new();
        for how in [ExploreMode::Wise(2), ExploreMode::Random] {
            for set in explore(&factors, how, tests, seed).sets {
                let row: Vec<String> = set.facts.iter().map(|(_, f)| f.args[0].to_string()).collect();
                let _ = writeln!(expected, "{}", row.join(" "));
            }
        }
        let args = [format!("{sizes:?}"), tests.to_string(), seed.to_string()];
        compare(&format!("{args:?}"), &expected, &by_the_page(choose, &args));
    }
}

#[test]
fn the_page_covers_tuples_as_suites_do() {
    let choose = "
import sys
sizes, strength, seed = eval(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
tests = int(sys.argv[4])
rows = wise(strength, sizes, Generator(seed))
if tests > 0: rows = fitting(strength, sizes, rows, tests, Generator(seed, 1))
for row in rows: print(*row)
";
    let spaces: [&[u32]; 5] = [&[3], &[2, 2], &[3, 2, 4], &[3, 1, 2, 3], &[2, 3, 2, 2, 3]];
    let whole = spaces.iter().flat_map(|sizes| {
        [(2u8, 4), (3, 0), (3, 9), (4, 1), (6, 2)].map(|(strength, seed)| (*sizes, strength, seed, 0))
    });
    let fewer: [(&[u32], u8, u64, u32); 4] =
        [(&[3; 4], 3, 0, 27), (&[4; 6], 3, 0, 64), (&[3, 2, 3, 2, 2], 3, 5, 20), (&[2; 6], 4, 1, 22)];
    for (sizes, strength, seed, tests) in whole.chain(fewer) {
        let factors: Vec<BeliefFactor> = sizes.iter().map(|n| factor(*n)).collect();
        let sets = explore(&factors, ExploreMode::Wise(strength), tests, seed).sets;
        let expected: String = sets.iter().map(|s| row(s) + "\n").collect();
        let args = [format!("{sizes:?}"), strength.to_string(), seed.to_string(), tests.to_string()];
        compare(&format!("{args:?}"), &expected, &by_the_page(choose, &args));
    }
}

#[test]
fn the_page_learns_as_suites_do() {
    let choose = "
import sys
sizes, tests, seed = eval(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
for row in learn(sizes, tests, Generator(seed), lambda row: sum(row) % 3): print(*row)
";
    let spaces: [&[u32]; 4] = [&[4], &[2, 3, 2], &[5, 8, 8, 2], &[4; 6]];
    for sizes in spaces {
        for (tests, seed) in [(10, 0), (200, 3)] {
            let factors: Vec<BeliefFactor> = sizes.iter().map(|n| factor(*n)).collect();
            let mut explorer = BeliefExplorer::new(&factors, ExploreMode::Learn, tests, seed);
            let mut expected = String::new();
            loop {
                let batch = explorer.next_batch();
                if batch.is_empty() {
                    break;
                }
                let reward = |set: &BeliefSet| {
                    let sum: i64 = set.facts.iter().filter_map(|(_, f)| f.args[0].as_int()).sum();
                    u32::try_from(sum % 3).unwrap()
                };
                explorer.learn(&batch.iter().map(reward).collect::<Vec<_>>());
                expected.extend(batch.iter().map(|s| row(s) + "\n"));
            }
            let args = [format!("{sizes:?}"), tests.to_string(), seed.to_string()];
            compare(&format!("{args:?}"), &expected, &by_the_page(choose, &args));
        }
    }
}

/// The numbers of a set, as the page prints them.
fn row(set: &BeliefSet) -> String {
    let row: Vec<String> = set.facts.iter().map(|(_, f)| f.args[0].to_string()).collect();
    row.join(" ")
}

/// A dimension whose alternatives are numbers.
fn factor(size: u32) -> BeliefFactor {
    let fact =
        |n: u32| InitialFact { belief: BeliefId(0), args: vec![Value::Int(n.into())], annotations: vec![] };
    let alternative = |n| FactorAlternative { facts: vec![fact(n)], text: n.to_string() };
    BeliefFactor {
        agent: AgentId(0),
        name: "n".to_owned(),
        alternatives: (0..size).map(alternative).collect(),
    }
}
