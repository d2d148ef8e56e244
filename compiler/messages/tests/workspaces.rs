//! Workspaces of every layout, and what cannot be read of them.

mod common;

use std::collections::{BTreeMap, BTreeSet};

use common::with_standard;
use hrdsl_messages::{
    InterfaceName, InterfaceSpace, MessageLibrary, MessageLibraryBuilder, RosVersion, WorkspaceEntry,
    WorkspaceReader, limits,
};
use hrdsl_source::{SourceFiles, Span};

/// Files in memory, by their paths.
struct FilesInMemory(BTreeMap<String, String>);

impl FilesInMemory {
    fn new(files: &[(&str, &str)]) -> Self {
        Self(files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect())
    }

    fn package(mut self, folder: &str, name: &str, files: &[(&str, &str)]) -> Self {
        self.0.insert(format!("{folder}/package.xml"), format!("<package><name>{name}</name></package>"));
        self.0.extend(files.iter().map(|(path, text)| (format!("{folder}/{path}"), (*text).to_owned())));
        self
    }

    fn read(&self, version: RosVersion) -> MessageLibrary {
        MessageLibraryBuilder::new(version, &mut SourceFiles::default())
            .workspace(self, "ws/", Span::default())
            .finish()
    }
}

impl WorkspaceReader for FilesInMemory {
    fn entries(&self, folder: &str) -> Result<Vec<WorkspaceEntry>, String> {
        let prefix = format!("{folder}/");
        let inside = self.0.keys().filter_map(|path| path.strip_prefix(&prefix));
        let entries: BTreeSet<WorkspaceEntry> = inside
            .map(|rest| match rest.split_once('/') {
                Some((name, _)) => WorkspaceEntry { name: name.to_owned(), is_folder: true },
                None => WorkspaceEntry { name: rest.to_owned(), is_folder: false },
            })
            .collect();
        if entries.is_empty() {
            Err("there is no such folder".to_owned())
        } else {
            Ok(entries.into_iter().collect())
        }
    }

    fn text(&self, file: &str) -> Result<String, String> {
        match self.0.get(file).map(String::as_str) {
            Some("unreadable") | None => Err("it is not UTF-8".to_owned()),
            Some(text) => Ok(text.to_owned()),
        }
    }
}

fn messages(library: &MessageLibrary) -> Vec<String> {
    library.messages().map(|(name, _)| name.written(RosVersion::Ros2)).collect()
}

fn words(library: &MessageLibrary) -> Vec<&'static str> {
    library.faults().iter().map(|fault| fault.kind.word()).collect()
}

const FINE: &[(&str, &str)] = &[("msg/Fine.msg", "int32 x\n")];

#[test]
fn packages_are_found_in_every_layout() {
    let nothing = || FilesInMemory::new(&[]);
    for (layout, files) in [
        ("src", nothing().package("ws/src/a", "a", FINE).package("ws/install/a", "a", FINE)),
        ("nested", nothing().package("ws/src/group/of/a", "a", FINE)),
        ("a folder of packages", nothing().package("ws/a", "a", FINE)),
        ("one package", nothing().package("ws", "a", FINE).package("ws/src/b", "b", FINE)),
        ("installed", nothing().package("ws/share/a", "a", FINE)),
        ("another name than the folder's", nothing().package("ws/src/other", "a", FINE)),
    ] {
        let library = files.read(RosVersion::Ros2);
        assert_eq!(
            (messages(&library), words(&library)),
            (vec!["a/msg/Fine".to_owned()], vec![]),
            "{layout}"
        );
    }
}

#[test]
fn marks_hide_what_is_below_them() {
    for mark in ["COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"] {
        let files = FilesInMemory::new(&[]).package("ws/src/a", "a", FINE).package("ws/src/old/b", "b", FINE);
        let mut files = files.package("ws/src/c", "c", FINE);
        files.0.insert(format!("ws/src/old/{mark}"), String::new());
        files.0.insert(format!("ws/src/c/{mark}"), String::new());
        assert_eq!(messages(&files.read(RosVersion::Ros2)), ["a/msg/Fine"], "{mark}");
    }
}

#[test]
fn only_definitions_are_read() {
    let others = [
        ("msg/README.md", ""),
        ("msg/Fine.idl", ""),
        ("srv/Fine.msg", "x"),
        ("msg/deeper/Far.msg", ""),
        ("src/a.cpp", ""),
    ];
    let files = FilesInMemory::new(&[]).package("ws/src/a", "a", FINE).package("ws/src/a", "a", &others);
    let files = files.package("ws/src/no_messages", "not a name", &[("src/main.cpp", "")]);
    let library = files.read(RosVersion::Ros2);
    assert_eq!((messages(&library), words(&library)), (vec!["a/msg/Fine".to_owned()], vec![]));
}

#[test]
fn what_cannot_be_read_is_said_and_the_rest_is_read() {
    let files = FilesInMemory::new(&[]).package("ws/src/a", "a", FINE);
    let files = files.package("ws/src/a", "a", &[("msg/Odd.msg", "unreadable")]);
    let library = files.read(RosVersion::Ros2);
    assert_eq!((messages(&library), words(&library)), (vec!["a/msg/Fine".to_owned()], vec!["unreadable"]));
    let said = library.faults()[0].kind.to_string();
    assert_eq!(said, "ws/src/a/msg/Odd.msg cannot be read: it is not UTF-8");

    let absent = FilesInMemory::new(&[]).read(RosVersion::Ros1);
    assert_eq!(absent.faults()[0].kind.to_string(), "ws cannot be read: there is no such folder");
    let empty = FilesInMemory::new(&[("ws/src/README.md", "")]).read(RosVersion::Ros1);
    assert_eq!(words(&empty), ["empty-workspace"]);
}

#[test]
fn a_workspace_takes_the_place_of_standard_packages_whole() {
    let files =
        FilesInMemory::new(&[]).package("ws/src/std_srvs", "std_srvs", &[("srv/Own.srv", "---\nint32 x\n")]);
    let mut sources = SourceFiles::default();
    let library =
        with_standard(RosVersion::Ros1, &mut sources).workspace(&files, "ws", Span::default()).finish();
    assert!(library.find("std_srvs/Own", InterfaceSpace::Srv).is_ok());
    assert!(library.find("std_srvs/SetBool", InterfaceSpace::Srv).is_err());
    assert!(library.find("std_msgs/String", InterfaceSpace::Msg).is_ok());
}

#[test]
fn what_is_written_comes_before_what_is_implied() {
    let generated =
        [("action/Go.action", "---\n---\n"), ("msg/GoGoal.msg", ""), ("msg/GoAction.msg", "int32 own\n")];
    let files = FilesInMemory::new(&[]).package("ws/share/a", "a", &generated);
    let mut sources = SourceFiles::default();
    let library =
        with_standard(RosVersion::Ros1, &mut sources).workspace(&files, "ws", Span::default()).finish();
    let action = library.message(&InterfaceName::message("a", "GoAction")).unwrap();
    assert_eq!(action.definition.fields[0].name, "own");
}

/// What an action is spoken by lies in another package, which has to be there.
#[test]
fn an_action_needs_the_packages_that_it_is_spoken_by() {
    let files = FilesInMemory::new(&[]).package("ws/src/a", "a", &[("action/Go.action", "---\n---\n")]);
    for version in [RosVersion::Ros1, RosVersion::Ros2] {
        let library = files.read(version);
        let faults = library.closure(&[InterfaceName::new("a", InterfaceSpace::Action, "Go")]).unwrap_err();
        assert!(faults.iter().all(|f| f.kind.word() == "unknown-type"), "{faults:?}");
        assert!(faults.len() > 2, "{faults:?}");
    }
}

/// A table is refused if anything in it is wrong, and what is wrong elsewhere does not matter to it.
#[test]
fn a_table_is_as_good_as_what_it_needs() {
    let definitions =
        [("msg/Good.msg", "int32 x\n"), ("msg/Bad.msg", "in32 x\n"), ("msg/Holder.msg", "Bad[] bad\n")];
    let library = FilesInMemory::new(&[]).package("ws/src/a", "a", &definitions).read(RosVersion::Ros2);
    assert!(library.closure(&[InterfaceName::message("a", "Good")]).is_ok());
    let faults = library.closure(&[InterfaceName::message("a", "Holder")]).unwrap_err();
    assert_eq!(faults.iter().map(|f| f.kind.to_string()).collect::<Vec<_>>(), ["no type is called `in32`"]);
    assert!(library.closure(&[InterfaceName::message("a", "Absent")]).is_err());
}

/// Of the parts of a file only those are refused in which something is wrong; what is made of them needs them all.
#[test]
fn each_part_has_its_own_faults() {
    let definitions = [("action/Go.action", "int32 x\n---\nint32\n---\n"), ("srv/Ask.srv", "int32 x\n---\n")];
    let files = FilesInMemory::new(&[]).package("ws/src/a", "a", &definitions);
    let mut sources = SourceFiles::default();
    let library =
        with_standard(RosVersion::Ros1, &mut sources).workspace(&files, "ws", Span::default()).finish();
    let is_right = |name| library.closure(&[name]).is_ok();
    assert!(
        is_right(InterfaceName::message("a", "GoGoal"))
            && is_right(InterfaceName::message("a", "GoFeedback"))
    );
    assert!(
        !is_right(InterfaceName::message("a", "GoResult"))
            && !is_right(InterfaceName::message("a", "GoAction"))
    );
    assert!(!is_right(InterfaceName::new("a", InterfaceSpace::Action, "Go")));
    assert!(is_right(InterfaceName::new("a", InterfaceSpace::Srv, "Ask")));
}

#[test]
fn depth_and_size_are_bounded() {
    let chain = |n: u32| format!("M{}{} next\n", n + 1, if n.is_multiple_of(2) { "[]" } else { "" });
    let most = limits::MOST_DEPTH + 36;
    let mut files: Vec<(String, String)> = (0..most).map(|n| (format!("msg/M{n}.msg"), chain(n))).collect();
    files.push((format!("msg/M{most}.msg"), "int32 x\n".to_owned()));
    let large = ["uint8[4096] x\n", "Large0[4096] x\n", "Large1[4096] x\n", "Large2[4096] x\n"];
    files.extend(large.iter().enumerate().map(|(n, text)| (format!("msg/Large{n}.msg"), (*text).to_owned())));
    let files: Vec<(&str, &str)> = files.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
    let library = FilesInMemory::new(&[]).package("ws/src/a", "a", &files).read(RosVersion::Ros2);
    let closure = |name: &str| library.closure(&[InterfaceName::message("a", name)]);
    let at_fault =
        |name: &str| closure(name).err().map(|f| f.iter().map(|f| f.kind.to_string()).collect::<Vec<_>>());
    assert_eq!(at_fault(&format!("M{}", most - limits::MOST_DEPTH + 1)), None);
    let too_deep = Some(vec!["messages within messages: at most 64".to_owned()]);
    assert_eq!(at_fault(&format!("M{}", most - limits::MOST_DEPTH)), too_deep);
    assert_eq!(at_fault("M0"), too_deep);
    assert_eq!(at_fault("Large0"), None);
    let too_large = Some(vec!["values in arrays of a fixed size: at most 16777216".to_owned()]);
    assert_eq!(at_fault("Large1"), too_large);
    assert_eq!(at_fault("Large3"), too_large);
}

#[test]
fn long_texts_and_many_lines_are_refused() {
    let long = format!("int32 x\n#{}", "x".repeat(limits::MOST_BYTES));
    let many: String = (0..limits::MOST_MEMBERS + 10).map(|n| format!("int32 f{n}\n")).collect();
    let wrong = "int32\n".repeat(limits::MOST_FAULTS + 10);
    let definitions: [(&str, &str); 3] =
        [("msg/Long.msg", &long), ("msg/Many.msg", &many), ("msg/Wrong.msg", &wrong)];
    let library = FilesInMemory::new(&[]).package("ws/src/a", "a", &definitions).read(RosVersion::Ros2);
    let faults = |name: &str| library.message(&InterfaceName::message("a", name)).unwrap().faults.clone();
    assert_eq!(faults("Long")[0].kind.to_string(), "bytes of a definition: at most 1048576");
    assert_eq!(faults("Many")[0].kind.to_string(), "fields and constants of a message: at most 4096");
    assert_eq!(faults("Wrong").len(), limits::MOST_FAULTS + 1);
}

#[test]
fn deep_folders_are_not_followed_for_ever() {
    /// Each folder holds itself, as by a link.
    struct FolderInItself;
    impl WorkspaceReader for FolderInItself {
        fn entries(&self, _: &str) -> Result<Vec<WorkspaceEntry>, String> {
            Ok(vec![WorkspaceEntry { name: "again".to_owned(), is_folder: true }])
        }
        fn text(&self, _: &str) -> Result<String, String> {
            Err("there are no files".to_owned())
        }
    }
    let builder = MessageLibraryBuilder::new(RosVersion::Ros2, &mut SourceFiles::default())
        .workspace(&FolderInItself, "ws", Span::default())
        .finish();
    assert_eq!(builder.faults()[0].kind.to_string(), "folders within folders: at most 16");
}

#[test]
fn a_package_text_names_its_definitions() {
    let mut files = SourceFiles::default();
    let text = "int32 lost\n== msg/A.msg\nint32 x\n== A\nint32 y\n== msg/B.msg\r\nA a\r\n";
    let library =
        MessageLibraryBuilder::new(RosVersion::Ros2, &mut files).package("a", "a.txt", text).finish();
    assert_eq!(messages(&library), ["a/msg/A", "a/msg/B"]);
    let places: Vec<String> = library.faults().iter().map(|f| files.place(f.span)).collect();
    assert_eq!(
        (words(&library), places),
        (vec!["misplaced-text"; 2], vec!["a.txt:1:1".to_owned(), "a.txt:4:1".to_owned()])
    );
}
