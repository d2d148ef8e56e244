//! Recordings with a picture, and the page that shows them, with the real binary.
#![allow(clippy::disallowed_methods, reason = "tests start a browser and an independent reader")]

mod support;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use hrdsl_runtime::recording::{self, RecordingFile, message::TopicPart};
use support::{expect_code, handover, hrdsl, hrdsl_in, root, shown_by_chromium, stderr, stdout, tree};

/// A few tests of the hand-over, each recorded.
fn campaign(out: &Path, more: &[&str]) {
    let scenario = handover();
    let args = ["sim", scenario.to_str().unwrap(), "-o", out.to_str().unwrap(), "-n", "3", "--exit-zero"];
    expect_code(&hrdsl(args.iter().chain(more)), 0);
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut all: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    all.sort();
    all
}

/// The recordings with a picture, without what the report keeps beside them.
fn replays(results: &Path) -> Vec<PathBuf> {
    let is_recording = |file: &PathBuf| file.extension().is_some_and(|ending| ending == "mcap");
    files(&results.join("replays")).into_iter().filter(is_recording).collect()
}

#[test]
fn the_same_tests_give_the_same_files_and_both_forms_the_same_verdicts() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    campaign(&one, &["--replays", "all", "-j", "1"]);
    campaign(&two, &["--replays", "all", "-j", "2"]);
    let (a, b) = (replays(&one), replays(&two));
    assert_eq!(a.len(), files(&one.join("traces")).len());
    for (a, b) in a.iter().zip(&b) {
        assert_eq!(a.file_name(), b.file_name());
        assert!(fs::read(a).unwrap() == fs::read(b).unwrap(), "{} differs with two workers", a.display());
    }
    let largest = a.iter().map(|file| fs::metadata(file).unwrap().len()).max().unwrap();
    assert!(largest <= 150 * 1024, "a test has {largest} bytes");
    let scenario = handover();
    let judged = |of: &Path| {
        let judged =
            hrdsl(["judge", scenario.to_str().unwrap(), of.to_str().unwrap(), "--json", "--exit-zero"]);
        expect_code(&judged, 0);
        stdout(&judged)
    };
    assert_eq!(judged(&one.join("traces")), judged(&one.join("replays")), "byte for byte");
    // A run is the same with a picture and without.
    let none = folder.path().join("none");
    campaign(&none, &["--replays", "none"]);
    assert!(!none.join("replays").exists());
    for (a, b) in files(&one.join("traces")).iter().zip(files(&none.join("traces"))) {
        assert!(fs::read(a).unwrap() == fs::read(b).unwrap(), "{}", a.display());
    }
    the_page_is_made(&one, folder.path());
    let exports = exported(&one, folder.path());
    assert_eq!(judged(&one.join("traces")), judged(&folder.path().join("exports")), "byte for byte");
    an_independent_reader_opens_them(&a, &exports);
}

/// A test that violates something, by the name of its file.
fn failing(results: &Path) -> String {
    let text = fs::read_to_string(results.join("results.json")).unwrap();
    let results: serde_json::Value = serde_json::from_str(&text).unwrap();
    let tests = results["tests"].as_array().unwrap();
    let fails = |test: &&serde_json::Value| {
        test["verdicts"].as_array().unwrap().iter().any(|verdict| verdict["outcome"] == "fail")
    };
    tests.iter().find(fails).expect("a test fails")["name"].as_str().unwrap().to_owned()
}

fn the_page_is_made(results: &Path, folder: &Path) {
    let (scenario, name) = (handover(), failing(results));
    let short = name.trim_start_matches("handover.");
    let view = |more: &[&str]| {
        let args = ["view", scenario.to_str().unwrap(), "--results", results.to_str().unwrap()];
        hrdsl_in_words(folder, args.iter().chain(more))
    };
    let made = view(&[short, "-o", "one.html"]);
    expect_code(&made, 0);
    assert_eq!(stderr(&made), "", "nothing is left out");
    let html = fs::read_to_string(folder.join("one.html")).unwrap();
    assert!(html.contains(&format!("\"open\":\"{short}\"")) && html.contains("\"group\":\"failure\""));
    let data = html.split_once("id=\"hrdsl-run-0\">").unwrap().1.split_once('<').unwrap().0.len();
    assert!(data <= 200 * 1024, "a test has {data} bytes in the page");
    // Another one beside it, and all of them.
    let other = replays(results).into_iter().find(|path| !path.to_string_lossy().contains(&name));
    let both = view(&[short, "--beside", other.unwrap().to_str().unwrap(), "-o", "both.html"]);
    expect_code(&both, 0);
    let html = fs::read_to_string(folder.join("both.html")).unwrap();
    assert!(html.contains("\"compare\":") && html.contains("id=\"hrdsl-run-1\""));
    expect_code(&view(&["-o", "all.html"]), 0);
    assert!(fs::metadata(folder.join("all.html")).unwrap().len() <= 8 << 20);
    // What is not there, and what is somebody else's.
    let unknown = view(&["bdi_tests.t999"]);
    expect_code(&unknown, 2);
    assert!(stderr(&unknown).contains("`bdi_tests.t999` is no recording, and no test of the results"));
    assert!(stderr(&unknown).contains("there are bdi_tests.t"), "{}", stderr(&unknown));
    fs::write(folder.join("mine.html"), "mine").unwrap();
    expect_code(&view(&[short, "-o", "mine.html"]), 2);
    assert_eq!(fs::read_to_string(folder.join("mine.html")).unwrap(), "mine");
    what_is_wrong_is_named(results, folder, &name);
    looked_at(&folder.join("one.html"));
}

fn hrdsl_in_words<'a>(folder: &Path, args: impl Iterator<Item = &'a &'a str>) -> std::process::Output {
    support::command().args(args).current_dir(folder).output().unwrap()
}

/// A cut file and one in text are shown as far as they go; one of another scenario is refused.
fn what_is_wrong_is_named(results: &Path, folder: &Path, name: &str) {
    let scenario = handover();
    let bytes = fs::read(results.join(format!("replays/{name}.mcap"))).unwrap();
    fs::write(folder.join("cut.mcap"), &bytes[..bytes.len() * 3 / 4]).unwrap();
    let view = |what: &str| hrdsl_in(folder, &format!("view {} {what} -o cut.html", scenario.display()));
    let cut = view("cut.mcap");
    expect_code(&cut, 0);
    assert!(stderr(&cut).contains("the file is cut off"), "{}", stderr(&cut));
    let judged = hrdsl_in(folder, &format!("judge {} cut.mcap", scenario.display()));
    expect_code(&judged, 2);
    let text = view(&format!("{}/traces/{name}.jsonl", results.display()));
    expect_code(&text, 0);
    assert!(stderr(&text).contains("no picture of the world"), "{}", stderr(&text));
    let corridor = root().join("examples/corridor/scenario.hri");
    let foreign = hrdsl_in(folder, &format!("view {} cut.mcap -o foreign.html", corridor.display()));
    expect_code(&foreign, 2);
    assert!(stderr(&foreign).contains("of the scenario `handover`, not of"), "{}", stderr(&foreign));
}

/// The page opens in Chromium, if there is one, at the violation and without an error.
fn looked_at(page: &Path) {
    let Some(shown) = shown_by_chromium(&format!("file://{}", page.display()), "data-opened") else {
        eprintln!("the page is not looked at: there is no Chromium");
        return;
    };
    assert!(shown.contains("data-opened"), "the page did not open: {}", &shown[..shown.len().min(2_000)]);
    assert!(shown.contains("✗"), "no violation is shown");
}

/// What programs of a middleware log and send is in their recordings, the same with one worker as with two.
#[test]
fn recordings_have_the_log_and_the_messages_of_a_middleware() {
    let folder = tempfile::tempdir().unwrap();
    let system = root().join("examples/handover/with_rospy/system.hri");
    let record = |jobs: &str| {
        let out = folder.path().join(jobs);
        campaign(
            &out,
            &["--replays", "all", "-j", jobs, "--suite", "bdi_tests", "--system", system.to_str().unwrap()],
        );
        replays(&out)
    };
    let (one, two) = (record("1"), record("2"));
    assert!(!one.is_empty() && one.len() == two.len());
    for (a, b) in one.iter().zip(&two) {
        assert!(fs::read(a).unwrap() == fs::read(b).unwrap(), "{} differs with two workers", a.display());
        assert!(fs::metadata(a).unwrap().len() <= 150 * 1024, "{}", a.display());
    }
    let found: Vec<RecordingFile> =
        one.iter().map(|file| recording::read(&fs::read(file).unwrap()).unwrap()).collect();
    assert!(found.iter().all(|file| file.faults.is_empty() && file.log.len() > 1), "all of the log");
    let topics = || found.iter().flat_map(|file| &file.topics);
    let voice = topics().find(|topic| topic.name == "/human/voice").expect("what the person says");
    assert!(!voice.outward && voice.texts[0].as_ref().unwrap().contains("\"leg_request\":"));
    let commands = topics().filter(|topic| topic.name.ends_with("/command"));
    let command = commands.max_by_key(|topic| topic.times.len()).expect("what the code commands");
    assert!(command.outward && command.times.len() > 200 && command.texts.len() == 200);
    assert!(command.times.is_sorted() && command.interface.contains('/'));
    let parts = |outward| {
        let of_grip =
            topics().filter(move |t| t.name == "/gripper_controller/gripper_cmd" && t.outward == outward);
        of_grip.map(|topic| (topic.part, topic)).collect::<BTreeMap<_, _>>()
    };
    let (goals, results) = (parts(true), parts(false));
    assert!(goals.contains_key(&TopicPart::Request), "goals of actions, too");
    let result = results.get(&TopicPart::Answer).expect("and what became of them");
    assert!(result.texts[0].as_ref().unwrap().starts_with("succeeded: {"), "{:?}", result.texts);
    lines_of_code_are_there(&found, &one[0], folder.path());
}

/// Which line of which file each thread was at, and the text of these files in the page.
fn lines_of_code_are_there(found: &[RecordingFile], recording: &Path, folder: &Path) {
    for file in found {
        let [program] = &file.lines[..] else { panic!("{:?}", file.lines) };
        assert!(program.files.iter().all(|file| file.name.ends_with(".py") && file.crc.is_some()));
        let main = program.threads.iter().find(|thread| thread.thread == "MainThread").unwrap();
        assert!(main.t.len() > 10 && main.line.len() == main.t.len() && main.file.len() == main.t.len());
        assert_eq!((program.until, program.unseen), (None, 0));
    }
    let view = |scenario: &Path| {
        let made =
            hrdsl_in(folder, &format!("view {} {} -o code.html", scenario.display(), recording.display()));
        expect_code(&made, 0);
        (stderr(&made), fs::metadata(folder.join("code.html")).unwrap().len())
    };
    let (said, with) = view(&handover());
    assert_eq!(said, "", "the code is there, and as it was");
    // The scenario somewhere else, with other code, and without.
    let other = folder.join("elsewhere");
    for (name, bytes) in tree(handover().parent().unwrap()) {
        let to = other.join(name);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::write(to, bytes).unwrap();
    }
    let name = &found[0].lines[0].files[0].name;
    let text = fs::read_to_string(other.join(name)).unwrap();
    fs::write(other.join(name), format!("# new\n{text}")).unwrap();
    let (said, _) = view(&other.join("scenario.hri"));
    assert!(said.contains(&format!("The code in {name} has changed since")), "{said}");
    fs::remove_file(other.join(name)).unwrap();
    let (said, without) = view(&other.join("scenario.hri"));
    assert!(said.contains(&format!("The code in {name} cannot be shown: no such file")), "{said}");
    assert!(without < with, "{without} of {with}");
}

/// A small world with a robot whose links have meshes, recorded once.
fn picker(folder: &Path) {
    for (name, bytes) in tree(&root().join("cli/tests/robots")) {
        let to = folder.join(name);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::write(to, bytes).unwrap();
    }
    expect_code(&hrdsl_in(folder, "sim pick.hri --replays all --exit-zero -o out"), 0);
}

#[test]
fn a_mesh_that_is_gone_has_a_box_and_is_named() {
    let folder = tempfile::tempdir().unwrap();
    picker(folder.path());
    let view = |to: &str| hrdsl_in(folder.path(), &format!("view pick.hri once.t001 --results out -o {to}"));
    let whole = view("whole.html");
    expect_code(&whole, 0);
    assert_eq!(stderr(&whole), "", "nothing is left out");
    for mesh in ["bracket.stl", "forearm.obj"] {
        let file = folder.path().join("ws/picker_description/meshes").join(mesh);
        let bytes = fs::read(&file).unwrap();
        fs::remove_file(&file).unwrap();
        let gone = view("gone.html");
        expect_code(&gone, 0);
        let said = stderr(&gone);
        assert!(said.contains(&format!("{mesh} is not there; a box stands for it")), "{said}");
        assert!(said.contains("and boxes stand for them: robot.") && !said.contains("world"), "{said}");
        // Whoever runs tests needs the mesh.
        expect_code(&hrdsl_in(folder.path(), "check pick.hri"), 1);
        fs::write(&file, bytes).unwrap();
        let sizes =
            ["whole.html", "gone.html"].map(|page| fs::metadata(folder.path().join(page)).unwrap().len());
        assert!(sizes[1] < sizes[0], "one mesh less: {sizes:?}");
    }
}

#[test]
fn what_has_changed_since_is_named_and_the_rest_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    picker(folder.path());
    let text = fs::read_to_string(folder.path().join("pick.hri")).unwrap();
    let view = |from: &str, to: &str| {
        fs::write(folder.path().join("pick.hri"), text.replace(from, to)).unwrap();
        let shown = hrdsl_in(folder.path(), "view pick.hri once.t001 --results out");
        expect_code(&shown, 0);
        (stderr(&shown), fs::read_to_string(folder.path().join("view.html")).unwrap())
    };
    let (said, page) = view("placed", "put");
    assert!(said.contains("unknown event `placed`; the scenario has changed since"), "{said}");
    assert!(page.contains("\"ended\":\"error\""));
    let (said, page) = view("box(40 cm, 1 m, 60 cm)", "box(40 cm, 1 m, 55 cm)");
    assert!(said.contains("has changed since (table): the one of the recording is shown"), "{said}");
    assert!(!page.contains("\"ended\":\"error\""), "all of the run is there");
    // Requirements are those of the scenario as it is now.
    let (said, page) = view("tilt(box) < 20 deg", "tilt(box) < 0.0001 deg");
    assert_eq!(said, "");
    assert!(page.contains("[\"R2\",\"fail\"]") && page.contains("\"requirement\":\"R2\""));
}

#[test]
fn files_of_others_are_refused_by_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = handover();
    let view = |bytes: &[u8]| {
        fs::write(folder.path().join("other.mcap"), bytes).unwrap();
        let refused = hrdsl_in(folder.path(), &format!("view {} other.mcap", scenario.display()));
        expect_code(&refused, 2);
        assert!(!folder.path().join("view.html").exists(), "no page is made of it");
        stderr(&refused)
    };
    // What another tool writes: the signs at both ends, a header, and no channel of ours.
    let magic = b"\x89MCAP0\r\n";
    let header = [&[1_u8][..], &8_u64.to_le_bytes(), &[0; 8]].concat();
    let end = [&[2_u8][..], &20_u64.to_le_bytes(), &[0; 20]].concat();
    let said = view(&[&magic[..], &header, &end, magic].concat());
    assert!(said.contains("no channel `/hrdsl/header`: hrdsl did not write it"), "{said}");
    let said = view(b"\xff\xfe\x00 no recording");
    assert!(said.contains("it is neither MCAP nor UTF-8 text"), "{said}");
    assert!(view(b"{\"other\": 1}\n").contains("other.mcap: "));
    assert!(view(b"").contains("other.mcap: "));
}

const PINNED: &str = "mcap==1.6.0";

/// Python's own reader of MCAP takes them apart, and each message keeps to the schema that the file says it has.
fn an_independent_reader_opens_them(replays: &[PathBuf], exports: &[PathBuf]) {
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let packages = cache.join("mcap-reader");
    let wheels = [PINNED, "zstandard", "lz4", "jsonschema"];
    if !packages.exists() {
        let scratch = tempfile::tempdir_in(cache).unwrap();
        let environment = scratch.path().join("venv");
        let made = Command::new("python3").args(["-m", "venv"]).arg(&environment).output().unwrap();
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let target = scratch.path().join("packages");
        let mut pip = Command::new(environment.join("bin/python"));
        pip.args(["-m", "pip", "install", "--no-input", "--disable-pip-version-check", "--target"]);
        let installed = pip.arg(&target).args(wheels).output().unwrap();
        if !installed.status.success() {
            let why = String::from_utf8_lossy(&installed.stderr).into_owned();
            let is_away =
                ["Failed to establish", "Temporary failure", "No matching distribution", "Connection"];
            assert!(is_away.iter().any(|sign| why.contains(sign)), "{why}");
            eprintln!("no independent reader has read the files: the package index cannot be reached");
            return;
        }
        let moved = fs::rename(&target, &packages);
        assert!(moved.is_ok() || packages.exists());
    }
    let script = root().join("cli/tests/support/read_mcap.py");
    let reads = |files: &[PathBuf], each: &[&str], some: &[&str]| {
        let mut python = Command::new("python3");
        let read = python.arg("-I").arg(&script).arg(&packages).args(files).output().unwrap();
        let said = String::from_utf8_lossy(&read.stdout).into_owned();
        assert!(read.status.success(), "{said}{}", String::from_utf8_lossy(&read.stderr));
        assert_eq!(said.lines().count(), files.len(), "{said}");
        let has = |line: &str, topic: &&str| line.contains(&format!("'{topic}'"));
        assert!(said.lines().all(|line| each.iter().all(|topic| has(line, topic))), "{said}");
        assert!(some.iter().all(|topic| has(&said, topic)), "{said}");
    };
    let each = ["/hrdsl/header", "/hrdsl/end", "/hrdsl/scene", "/scene", "/tf"];
    reads(replays, &each, &["/hrdsl/events", "/hrdsl/samples", "/hrdsl/tracks"]);
    reads(exports, &each, &["/hrdsl/signals", "/hrdsl/contacts", "/joint_states"]);
}

/// What other tools play: every test once more, in messages of Foxglove's, with the same verdicts.
fn exported(results: &Path, folder: &Path) -> Vec<PathBuf> {
    let (scenario, to) = (handover(), folder.join("exports"));
    for file in replays(results) {
        let out = to.join(file.file_name().unwrap());
        let args = [scenario.as_os_str(), file.as_os_str(), "-o".as_ref(), out.as_os_str()];
        let view = || support::command().arg("view").args(args).output().unwrap();
        expect_code(&view(), 0);
        let bytes = fs::read(&out).unwrap();
        expect_code(&view(), 0);
        assert!(fs::read(&out).unwrap() == bytes, "the same bytes in the place of an export");
        // A recording of a campaign is not replaced.
        let lost = support::command().arg("view").args(args).arg("-o").arg(&file).output().unwrap();
        assert_ne!(lost.status.code(), Some(0), "{}", stderr(&lost));
    }
    files(&to)
}
