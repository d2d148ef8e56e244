//! Imperfect sensors from end to end: the same bytes on one worker and on two, by the test's seed, through the protocol and ROS.

mod support;

use std::{collections::BTreeMap, path::Path};

use support::{expect_code, folder, hrdsl_in, tree};

const SCENARIO: &str = r#"scenario watchful

actor child : environment
actor robot : system
event braked from robot to child

stimulus run_by by child {
  child.move_to((70 cm, 0 m, 50 cm), 500 ms)
  hold 2 s
}

part rover {
  body chassis: kinematic cylinder(20 cm, 20 cm) at (0 m, 0 m, 10 cm)
  base wheels: chassis speed 0.5 m/s turn 90 deg/s acceleration 1 m/s^2 every 20 ms drift 5 cm, 5 deg
  laser eye: chassis at (0 m, 0 m, 5 cm) angles -30 deg .. 30 deg beams 13 range 5 cm .. 10 m
    every 100 ms late 20 ms noise 1 cm dropout 5 %
}
world {
  body ground: fixed box(10 m, 10 m, 10 cm) at (0 m, 0 m, -5 cm)
  body child: kinematic box(20 cm, 20 cm, 1 m) at (2 m, 0 m, 50 cm)
  part robot = rover at (0 m, 0 m, 0 m)
  signal near: bool to robot = distance(child, robot.chassis) < 1 m every 100 ms late 50 ms
  signal gap: length to robot = distance(child, robot.chassis) every 50 ms noise 5 mm dropout 2 %
}

require R2 safety "not before it could know" never braked while not reading(near)
require R3 safety "the child was there before" never braked while not near

system robot {
  program watcher { run "python3 watcher.py" }
  program listener { run "python3 listener.py" }
  ros1 { topic "/scan": sensor_msgs/LaserScan in at 10 Hz from robot.eye }
}
"#;

const WATCHER: &str = "import hrdsl
node = hrdsl.Node('watcher')
wheels = node.device('robot.wheels')
braked = False
for _ in range(80):
    near = node.read('near')
    print('%.2f %s %.9f' % (node.now(), near, node.read('gap')))
    if near and not braked:
        node.emit('braked')
        braked = True
    node.sleep(0.025)
";

const LISTENER: &str = "import rospy
from sensor_msgs.msg import LaserScan
def heard(scan):
    print('%.3f %.3f %s' % (rospy.get_time() % 100, scan.header.stamp.to_sec() % 100, ['%.6f' % r for r in scan.ranges]))
rospy.init_node('listener')
rospy.Subscriber('/scan', LaserScan, heard)
rospy.sleep(2.0)
";

const TESTS: &str = "test a { seed 7; wait 200 ms; run_by }\ntest b { seed 8; wait 200 ms; run_by }\n";

/// What a campaign leaves behind: recordings and what programs printed.
fn campaign(at: &Path, out: &str, more: &str) -> BTreeMap<String, Vec<u8>> {
    let line = format!("sim scenario.hri a.tests.hri -o {out} --exit-zero {more}");
    expect_code(&hrdsl_in(at, &line), 0);
    let all = tree(&at.join(out)).into_iter();
    all.filter(|(name, _)| name.starts_with("traces/") || name.starts_with("output/")).collect()
}

fn text<'t>(files: &'t BTreeMap<String, Vec<u8>>, name: &str) -> &'t str {
    let file = files.get(name).unwrap_or_else(|| panic!("no {name} in {:?}", files.keys()));
    std::str::from_utf8(file).unwrap()
}

#[test]
fn readings_are_the_same_bytes_and_those_of_the_seed() {
    let folder = folder(&[
        ("scenario.hri", SCENARIO),
        ("watcher.py", WATCHER),
        ("listener.py", LISTENER),
        ("a.tests.hri", TESTS),
    ]);
    let at = folder.path();
    let first = campaign(at, "one", "-j 1");
    assert_eq!(first, campaign(at, "again", "-j 1"), "the same again");
    assert_eq!(first, campaign(at, "two", "-j 2"), "the same on two workers");
    let (a, b) = (text(&first, "output/watchful.a.txt"), text(&first, "output/watchful.b.txt"));
    assert_ne!(a, b, "another seed, another noise");

    // The child is near at 0.43 s at the latest; the sample of 0.5 s can be read at 0.55 s.
    let trace = text(&first, "traces/watchful.a.jsonl");
    let time = |what: &str| {
        let line =
            trace.lines().find(|line| line.contains(what)).unwrap_or_else(|| panic!("{what}: {trace}"));
        line.split(['{', ':', ',']).nth(2).and_then(|t| t.parse::<f64>().ok()).expect("a time")
    };
    let (near, known) = (time(r#""near","value":true"#), time(r#"reading(near)","value":true"#));
    let braked = time(r#""event":"braked""#);
    let sample = (near / 0.1).ceil() * 0.1;
    assert!((known - sample - 0.05).abs() < 1e-9 && known <= braked && braked < known + 0.04, "{trace}");

    // A scan that comes at 10 Hz is that of the last sample that was complete 20 ms before.
    let stamps: Vec<(f64, f64)> = a
        .lines()
        .filter_map(|line| line.split_once(" ['").and_then(|(times, _)| times.rsplit_once(' ')))
        .filter_map(|(now, stamp)| Some((now.rsplit(' ').next()?.parse().ok()?, stamp.parse().ok()?)))
        .collect();
    assert!(stamps.len() >= 15, "{a}");
    for (now, stamp) in stamps {
        assert!(now - stamp >= 0.02 - 1e-6 && now - stamp < 0.12 + 1e-6, "{now} {stamp}");
    }
    assert!(a.contains("'inf'"), "some beams are lost");
}

#[test]
fn recordings_of_readings_are_judged_again() {
    let folder = folder(&[
        ("scenario.hri", SCENARIO),
        ("watcher.py", WATCHER),
        ("listener.py", LISTENER),
        ("a.tests.hri", TESTS),
    ]);
    let at = folder.path();
    campaign(at, "out", "-j 2");
    let verdicts = |document: &str| {
        let json: serde_json::Value = serde_json::from_str(document).unwrap();
        let tests = json["tests"].as_array().unwrap().clone();
        tests.iter().map(|t| t["verdicts"].clone()).collect::<Vec<_>>()
    };
    let results = std::fs::read_to_string(at.join("out/results.json")).unwrap();
    let judged = hrdsl_in(at, "judge scenario.hri out --json");
    assert_eq!(verdicts(&results), verdicts(&support::stdout(&judged)));
    let outcomes: Vec<String> = verdicts(&results)
        .iter()
        .flat_map(|all| all.as_array().unwrap().iter().map(|v| v["outcome"].to_string()))
        .collect();
    assert_eq!(outcomes, vec!["\"pass\""; 4]);
}
