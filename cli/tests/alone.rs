//! Names of the middleware at which somebody is alone: found, said with what to do, and read back.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

mod support;

use std::fs;

use serde_json::Value;
use support::{expect_code, folder, hrdsl_in, stdout};

const SCENARIO: &str = r#"scenario s

actor guest : environment
actor robot : system

event called(n: 0..9) from guest to robot
event answered(n: 0..9) from robot

stimulus call(n: 0..9) by guest { emit called(n) }

require R1 functional "whoever calls is answered" called causes answered within 3 s

suite some by random { stimuli call; length 1..2; pause 0 s .. 1 s; tests 3 }

system robot {
  program ears { run "python3 ears.py" }
  program brain { run "python3 brain.py" }
  limit 10 s
  ros1 {
    topic "/calls": std_msgs/Int8 in { data = called.n }
    topic "/answers": std_msgs/Int8 out { emit answered(data) }
    service "/grip": std_srvs/SetBool { success = true }
  }
}
"#;

const EARS: &str = r#"import rospy
from std_msgs.msg import Int8, String
rospy.init_node("ears")
heard = rospy.Publisher("/heard", Int8, queue_size=1)
rospy.Publisher("/debug", String, queue_size=1)
rospy.Subscriber("/robot/calls", Int8, lambda message: heard.publish(message))
rospy.spin()
"#;

const BRAIN: &str = r#"import rospy
from std_srvs.srv import SetBool, Trigger
from std_msgs.msg import Int8
rospy.init_node("brain")
rospy.Subscriber("/heard", Int8, lambda message: None)
rospy.sleep(1.5)
rospy.wait_for_service("/plan")
"#;

#[test]
fn wrong_names_are_said_with_what_to_do() {
    let folder = folder(&[("s.hri", SCENARIO), ("ears.py", EARS), ("brain.py", BRAIN)]);
    let run = hrdsl_in(folder.path(), "sim s.hri -o out --exit-zero");
    expect_code(&run, 0);
    let said = "
Interfaces  where nobody met in any test
! ears subscribes to /robot/calls, which nobody publishes  3 tests
  did you mean /calls? If not, add to the binding: topic \"/robot/calls\": std_msgs/Int8 in { … }
! brain uses the service /plan, which nobody serves  3 tests
  add to the binding: service \"/plan\": PACKAGE/NAME { … }
! no program publishes /answers, which the binding hears  3 tests
! no program uses the service /grip, which the binding serves  3 tests
";
    assert!(stdout(&run).contains(said), "{}", stdout(&run));
    let out = folder.path().join("out");
    let results: Value =
        serde_json::from_str(&fs::read_to_string(out.join("results.json")).unwrap()).unwrap();
    let warnings = results["warnings"].as_array().unwrap();
    let faults: Vec<(&str, &str)> =
        warnings.iter().map(|w| (w["fault"].as_str().unwrap(), w["name"].as_str().unwrap())).collect();
    let expected = [
        ("unserved", "/robot/calls"),
        ("unserved", "/plan"),
        ("unused", "/answers"),
        ("unused", "/grip"),
        ("unheard", "/debug"),
    ];
    assert_eq!(faults, expected);
    assert_eq!(results["tests"][0]["waits"][0]["since"], 1.5);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(
        page.contains("brain waited from 1.50 s to the end for the service &#x2f;plan, which nobody serves")
    );
    // The reports are made of the results alone.
    let before = ["report.html", "junit.xml"].map(|name| fs::read(out.join(name)).unwrap());
    let again = hrdsl_in(folder.path(), "report out");
    assert!(stdout(&again).contains(said), "{}", stdout(&again));
    assert!(before == ["report.html", "junit.xml"].map(|name| fs::read(out.join(name)).unwrap()));
    // What the binding and the programs agree on is not said.
    let right = SCENARIO.replace("\"/calls\"", "\"/robot/calls\"").replace("\"/answers\"", "\"/heard\"");
    let right = right.replace("    service \"/grip\"", "    service \"/plan\"");
    fs::write(folder.path().join("s.hri"), right).unwrap();
    let run = hrdsl_in(folder.path(), "sim s.hri -o out");
    expect_code(&run, 0);
    assert!(!stdout(&run).contains("Interfaces"), "{}", stdout(&run));
}
