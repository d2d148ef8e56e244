//! Programs in Python from end to end: one that drives by what its laser sees, and a race of threads that `--schedules` finds.

mod support;

use std::fs;

use support::{expect_code, folder, hrdsl_in, stdout};

const BRAKING: &str = r#"scenario braking

actor house : environment
actor robot : system
event begun from house to robot
event arrived from robot
stimulus look by house { emit begun; hold 8 s }

part rover {
  body chassis: kinematic cylinder(20 cm, 20 cm) at (0 m, 0 m, 10 cm)
  base wheels: chassis speed 0.5 m/s turn 90 deg/s acceleration 1 m/s^2
  laser eye: chassis at (0 m, 0 m, 5 cm) angles -30 deg .. 30 deg beams 13 range 5 cm .. 1 m
}
world {
  body ground: fixed box(10 m, 10 m, 10 cm) at (0 m, 0 m, -5 cm)
  body wall: fixed box(10 cm, 4 m, 1 m) at (2 m, 0 m, 50 cm)
  part robot = rover at (0 m, 0 m, 0 m)
}

require R1 safety "it keeps off the wall" globally distance(robot.chassis, wall) > 10 cm
require R2 functional "it gets there" begun causes arrived within 8 s
require R3 safety "it stands by the wall" never arrived while distance(robot.chassis, wall) > 50 cm

system robot { run "python3 robot.py" }
"#;

const DRIVER: &str = r#"import hrdsl
node = hrdsl.Node("robot")
wheels, eye = node.base("robot.wheels"), node.laser("robot.eye")
node.wait_for("begun")
print(min(eye.ranges()), len(eye.ranges()), eye.state("limits"))
wheels.drive(forward=0.4)
while min(eye.ranges()) > LIMIT:
    node.sleep(0.05)
print("%.1f" % wheels.state("velocity")[0], wheels.stop(), wheels.state("velocity"))
print("%.2f %.2f %.2f" % tuple(wheels.state("pose")))
node.emit("arrived")
"#;

#[test]
fn a_robot_drives_and_brakes_by_what_its_laser_sees() {
    for (limit, code, passed) in [("0.5", 0, true), ("0.05", 3, false)] {
        let driver = DRIVER.replace("LIMIT", limit);
        let tests = "test look.t1 { seed 1; look }\n";
        let at = folder(&[("scenario.hri", BRAKING), ("a.tests.hri", tests), ("robot.py", &driver)]);
        let done = hrdsl_in(at.path(), "sim scenario.hri a.tests.hri -o out --check-determinism");
        expect_code(&done, code);
        let results = fs::read_to_string(at.path().join("out/results.json")).unwrap();
        let results: serde_json::Value = serde_json::from_str(&results).unwrap();
        assert!(results["tests"][0]["error"].is_null(), "{}", results["tests"][0]);
        assert_eq!(stdout(&done).contains("✗ R1"), !passed, "{}", stdout(&done));
        if passed {
            let output = fs::read_dir(at.path().join("out/output")).unwrap().next().unwrap().unwrap();
            let output = fs::read_to_string(output.path()).unwrap();
            assert!(output.contains("inf 13 [0.05, 1.0]\n0.4 True [0.0, 0.0, 0.0]\n1."), "{output}");
        }
    }
}

const PAYING: &str = r#"scenario paying

actor shop : environment
actor robot : system
event asked from shop to robot
event paid, lost from robot
stimulus ask by shop { emit asked }

require R1 safety "nothing is lost" never lost

system robot { run "python3 robot.py" }
"#;

/// Two threads wake at one instant, and one of them counts on being the second.
const RACE: &str = r#"import threading
import hrdsl
node, account = hrdsl.Node("robot"), {}
def open_account():
    node.sleep(1)
    account["sum"] = 100
def pay():
    node.sleep(1)
    node.emit("paid" if account else "lost")
node.wait_for("asked")
threads = [threading.Thread(target=each) for each in (open_account, pay)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
"#;

#[test]
fn schedules_find_a_race_and_name_one_that_shows_it_again() {
    let tests = "test race.t1 { seed 1; ask; wait 2 s }\ntest race.t2 { seed 2; wait 1 s; ask; wait 2 s }\n";
    let at = folder(&[("scenario.hri", PAYING), ("a.tests.hri", tests), ("robot.py", RACE)]);
    let sim = |more: &str| hrdsl_in(at.path(), &format!("sim scenario.hri a.tests.hri -o out {more}"));
    expect_code(&sim("--check-determinism"), 0);

    let found = sim("--schedules 6");
    expect_code(&found, 3);
    let text = stdout(&found);
    assert!(text.contains("2 of 2 tests come to something else in another order"), "{text}");
    let line = text.lines().find(|l| l.contains("paying.race.t2: with --schedule ")).expect(&text);
    let (_, rest) = line.split_once("--schedule ").unwrap();
    let (schedule, what) = rest.split_once(',').unwrap();
    assert!(what.contains("R1 is violated"), "{line}");

    // With this number it fails again, and the line to repeat it has the number; all before it pass.
    for _ in 0..2 {
        let again = sim(&format!("--schedule {schedule} --test race.t2"));
        expect_code(&again, 3);
        assert!(
            stdout(&again).contains(&format!("--schedule {schedule} --test race.t2")),
            "{}",
            stdout(&again)
        );
    }
    for before in 1..schedule.parse::<u32>().unwrap() {
        expect_code(&sim(&format!("--schedule {before} --test race.t2")), 0);
    }

    // A program that locks what it shares has no race.
    let safe = RACE
        .replace("account else", "wait(account) else")
        .replace("def pay():", "def wait(account):\n    opened.wait(9)\n    return account\ndef pay():");
    let safe = safe.replace("    account[\"sum\"] = 100", "    account[\"sum\"] = 100\n    opened.set()");
    let safe = safe.replace("node.wait_for(", "opened = threading.Event()\nnode.wait_for(");
    fs::write(at.path().join("robot.py"), safe).unwrap();
    let none = sim("--schedules 6");
    expect_code(&none, 0);
    assert!(stdout(&none).contains("2 tests come to the same in 6 other orders"), "{}", stdout(&none));
}

/// A program of several files, one of which nobody imports.
const PARTS: &str = r#"scenario parts
actor house : environment
actor robot : system
event begun from house to robot
stimulus look by house { emit begun }
system robot { run "python3 robot.py"; coverage "*.py", "lib/**/*.py"; limit 1 s }
"#;

#[test]
fn a_pattern_measures_every_file_that_it_matches() {
    let robot = "import hrdsl\nfrom lib.motion import move\nnode = hrdsl.Node('robot')\nmove()\n";
    let motion = "def move():\n    return 1\n\n\ndef stop():\n    return 2\n";
    let at = folder(&[
        ("scenario.hri", PARTS),
        ("a.tests.hri", "test look.t1 { seed 1; look }\n"),
        ("robot.py", robot),
        ("lib/__init__.py", ""),
        ("lib/motion.py", motion),
        ("lib/deep/unused.py", "a = 1\n"),
        ("lib/notes.txt", "a = 1\n"),
    ]);
    expect_code(&hrdsl_in(at.path(), "sim scenario.hri a.tests.hri -o out"), 0);
    let results = fs::read_to_string(at.path().join("out/results.json")).unwrap();
    let results: serde_json::Value = serde_json::from_str(&results).unwrap();
    let files = results["code"].as_array().unwrap().iter();
    let lines = |file: &serde_json::Value| {
        let lines = file["lines"].as_array().unwrap();
        let hit = lines.iter().filter(|line| line[1] != 0).count();
        format!("{} {hit}/{}", file["file"].as_str().unwrap(), lines.len())
    };
    let files: Vec<String> = files.map(lines).collect();
    assert_eq!(files, ["lib/__init__.py 0/0", "lib/deep/unused.py 0/1", "lib/motion.py 3/4", "robot.py 4/4"]);
}
