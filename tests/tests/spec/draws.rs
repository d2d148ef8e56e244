//! The page on random draws is a program: it draws what the generators of tests draw.

use std::{
    fmt::Write as _,
    io::Write as _,
    process::{Command, Stdio},
};

use hrdsl_compiler::{Input, compile};
use hrdsl_ir::{Value, test::TestStep};
use hrdsl_runtime::testgen::generate;

use crate::page::{read, split};

const SCENARIO: &str = "scenario draws
    actor person : environment
    stimulus act(kind: 0..6) by person {
      sample number in -3 .. 40
      sample near in if kind > 3 { -10 cm .. 20 cm } else { 0 m .. 0 m }
      sample turn in 0 rad .. 3 rad
      hold near / 1 m * 1 s
    }
    suite chance by random { stimuli act length 3..9 pause 0 s .. 10 s tests 12 }";

/// What hrdsl draws, a line for each number.
fn drawn(seed: u64) -> (String, Vec<u64>) {
    let compilation = compile(Input { name: "draws", text: SCENARIO }, &[]);
    let program = compilation.program.expect("the scenario compiles");
    let generated = generate(&program, &program.suites[0], None, seed).unwrap();
    let (mut lines, mut seeds) = (String::new(), Vec::new());
    for test in &generated.tests {
        seeds.push(test.seed);
        for step in &test.steps {
            match step {
                TestStep::Wait { time } => {
                    let _ = writeln!(lines, "{time}");
                }
                TestStep::Do { args, samples, .. } => {
                    for value in args.iter().chain(samples) {
                        let _ = match value {
                            Value::Int(n) => writeln!(lines, "{n}"),
                            Value::Float(x) => writeln!(lines, "{:016x}", x.to_bits()),
                            Value::Bool(_) | Value::Symbol(_) => panic!("{value:?}"),
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

#[test]
fn the_page_draws_what_the_generators_draw() {
    let block = split(&read("spec/randomness.md")).0.into_iter().find(|b| b.info == "python");
    let program = block.expect("the page has a program").text + BY_THE_PAGE;
    for seed in [0, 1, 77, 18_000_000] {
        let (expected, seeds) = drawn(seed);
        let mut child = Command::new("python3")
            .args(["-", &seed.to_string()])
            .args(seeds.iter().map(u64::to_string))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("python3 is there");
        child.stdin.take().unwrap().write_all(program.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        let got = String::from_utf8(output.stdout).unwrap();
        let lines = expected.lines().zip(got.lines()).enumerate();
        let first = lines.clone().find(|(_, (e, g))| e != g);
        assert!(first.is_none() && expected.lines().count() == got.lines().count(), "seed {seed}: {first:?}");
        assert!(lines.count() > 100);
    }
}
