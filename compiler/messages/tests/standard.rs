//! The standard packages: nothing is wrong in them, they have the sums that every ROS 1 has, and a table that somebody has read.

mod common;

use common::{packages, standard, with_standard};
use hrdsl_messages::{InterfaceName, InterfaceSpace, MessageLibrary, RosVersion};
use hrdsl_source::SourceFiles;

fn name(library: &MessageLibrary, written: &str, space: InterfaceSpace) -> InterfaceName {
    library.find(written, space).unwrap_or_else(|unknown| panic!("{unknown}")).clone()
}

#[test]
fn nothing_is_wrong_in_them() {
    for version in [RosVersion::Ros1, RosVersion::Ros2] {
        let mut files = SourceFiles::default();
        let library = with_standard(version, &mut files).finish();
        let faults: Vec<_> =
            library.faults().iter().chain(library.messages().flat_map(|(_, m)| &m.faults)).collect();
        let told: Vec<String> =
            faults.iter().map(|f| format!("{}: {}", files.place(f.span), f.kind)).collect();
        assert!(told.is_empty(), "{version}:\n{}", told.join("\n"));
        let names: Vec<InterfaceName> = library
            .messages()
            .map(|(name, _)| name)
            .chain(library.services().map(|(name, _)| name))
            .chain(library.actions().map(|(name, _)| name))
            .cloned()
            .collect();
        let table = library.closure(&names).unwrap_or_else(|faults| panic!("{version}: {faults:?}"));
        assert_eq!(table.messages.len(), library.messages().count(), "{version}");
        assert_eq!(table.services.len(), library.services().count(), "{version}");
        assert_eq!(table.actions.len(), library.actions().count(), "{version}");
    }
}

/// They are facts: a comment would be somebody's words.
#[test]
fn they_hold_no_comments_and_are_in_order() {
    for (name, text) in packages(RosVersion::Ros1).iter().chain(packages(RosVersion::Ros2)) {
        let sections: Vec<&str> = text.lines().filter(|l| l.starts_with("== ")).collect();
        assert!(!sections.is_empty(), "{name}");
        for line in text.lines() {
            assert!(!line.contains('#') && !line.is_empty() && line.trim() == line, "{name}: {line:?}");
        }
        let folders: Vec<&str> = sections.iter().filter_map(|s| Some(s[3..].split_once('/')?.0)).collect();
        let order = |folder: &&str| ["msg", "srv", "action"].iter().position(|f| f == folder);
        assert!(folders.is_sorted_by_key(order), "{name}: messages, then services, then actions");
    }
}

#[test]
fn messages_have_the_sums_that_every_ros_1_has() {
    let library = standard(RosVersion::Ros1);
    for (written, expected) in [
        ("std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e"),
        ("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1"),
        ("std_msgs/Header", "2176decaecbce78abc3b96ef049fabed"),
        ("geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a"),
        ("geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5"),
        ("sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"),
        ("sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743"),
        ("sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd"),
        ("nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"),
        ("tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec"),
        ("visualization_msgs/Marker", "4048c9de2a16f4ae8e0538085ebf1b97"),
    ] {
        let table = library.closure(&[name(&library, written, InterfaceSpace::Msg)]).unwrap();
        let row = table.messages.last().unwrap();
        assert_eq!((&*row.name, row.md5.as_deref()), (written, Some(expected)));
    }
    for (written, expected) in [
        ("std_srvs/Empty", "d41d8cd98f00b204e9800998ecf8427e"),
        ("std_srvs/SetBool", "09fb03525b03e7ea1fd3992bafd87e16"),
        ("std_srvs/Trigger", "937c9679a518e3a18d831e57125ea522"),
    ] {
        let table = library.closure(&[name(&library, written, InterfaceSpace::Srv)]).unwrap();
        assert_eq!(table.services[0].md5.as_deref(), Some(expected), "{written}");
    }
}

/// Actions of ROS 1 are known by the sum of the message that holds all their parts.
#[test]
fn actions_of_ros_1_have_their_messages() {
    let library = standard(RosVersion::Ros1);
    let action = name(&library, "control_msgs/FollowJointTrajectory", InterfaceSpace::Action);
    let table = library.closure(&[action]).unwrap();
    let row = table.messages.iter().find(|m| m.name == "control_msgs/FollowJointTrajectoryAction").unwrap();
    assert_eq!(row.md5.as_deref(), Some("bc4f9b743838566551c0390c65f1a248"));
    let names: Vec<&str> = table.messages.iter().map(|m| m.name.as_str()).collect();
    for suffix in ["Goal", "Result", "Feedback", "ActionGoal", "ActionResult", "ActionFeedback", "Action"] {
        assert!(names.contains(&&*format!("control_msgs/FollowJointTrajectory{suffix}")), "{suffix}");
    }
    // To cancel a goal, and to hear of all of them.
    assert!(names.contains(&"actionlib_msgs/GoalID") && names.contains(&"actionlib_msgs/GoalStatusArray"));
}

#[test]
fn actions_of_ros_2_have_their_services() {
    let library = standard(RosVersion::Ros2);
    let action = name(&library, "example_interfaces/Fibonacci", InterfaceSpace::Action);
    let table = library.closure(&[action]).unwrap();
    insta::assert_json_snapshot!("fibonacci", (&table.services, &table.actions));
    let names: Vec<&str> = table.messages.iter().map(|m| m.name.as_str()).collect();
    insta::assert_json_snapshot!("fibonacci_messages", names);
}

#[test]
fn a_table_has_all_that_is_needed_each_after_what_it_holds() {
    for (version, snapshot) in [(RosVersion::Ros1, "laser_scan_ros1"), (RosVersion::Ros2, "laser_scan_ros2")]
    {
        let library = standard(version);
        let scan = name(&library, "sensor_msgs/LaserScan", InterfaceSpace::Msg);
        insta::assert_json_snapshot!(snapshot, library.closure(&[scan]).unwrap());
    }
    let library = standard(RosVersion::Ros1);
    let all: Vec<InterfaceName> = library.messages().map(|(name, _)| name.clone()).collect();
    let mut seen: Vec<String> = Vec::new();
    for row in library.closure(&all).unwrap().messages {
        assert!(row.holds.iter().all(|held| seen.contains(held)), "{}", row.name);
        seen.push(row.name);
    }
}

#[test]
fn a_full_text_has_each_message_once() {
    let library = standard(RosVersion::Ros1);
    let text = |written: &str| library.full_text(&name(&library, written, InterfaceSpace::Msg)).unwrap();
    assert_eq!(text("std_msgs/String"), "string data\n");
    let border = "=".repeat(80);
    assert_eq!(
        text("geometry_msgs/PoseStamped"),
        format!(
            "std_msgs/Header header\nPose pose\n\n{border}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n\
            \n{border}\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n\
            \n{border}\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n\
            \n{border}\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
        )
    );
}

#[test]
fn a_name_that_is_not_there_has_a_nearest() {
    let library = standard(RosVersion::Ros2);
    let nearest = |written, space| library.find(written, space).unwrap_err().nearest;
    for (written, expected) in [
        ("sensor_msgs/LaserScn", Some("sensor_msgs/LaserScan")),
        ("sensor_msg/LaserScan", Some("sensor_msgs/LaserScan")),
        ("LaserScan", Some("sensor_msgs/LaserScan")),
        ("sensor_msgs/Pose", Some("geometry_msgs/Pose")),
        ("sensor_msgs/laserscan", Some("sensor_msgs/LaserScan")),
        ("zebra_msgs/Stripe", None),
        ("", None),
    ] {
        assert_eq!(nearest(written, InterfaceSpace::Msg).as_deref(), expected, "{written}");
    }
    assert_eq!(nearest("std_srvs/SetBol", InterfaceSpace::Srv).as_deref(), Some("std_srvs/SetBool"));
    assert!(library.find("sensor_msgs/msg/LaserScan", InterfaceSpace::Msg).is_ok());
    assert!(library.find("std_srvs/srv/SetBool_Request", InterfaceSpace::Msg).is_ok());
    assert!(library.find("std_srvs/SetBool_Request", InterfaceSpace::Msg).is_err());
    assert!(standard(RosVersion::Ros1).find("std_srvs/SetBoolRequest", InterfaceSpace::Msg).is_ok());
    let unknown = library.find("a_msgs/B", InterfaceSpace::Action).unwrap_err();
    assert_eq!(unknown.to_string(), "no action is called `a_msgs/B`");
}
