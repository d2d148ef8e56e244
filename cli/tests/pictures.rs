//! What is kept of the world for looking lies where the judged signals say that it was; and the pictures of the documents.
#![allow(clippy::disallowed_methods, reason = "a browser draws the pictures")]

mod support;

use std::{collections::BTreeMap, fs, io::Cursor, path::Path, process::Command};

use hrdsl_runtime::recording::{self, RecordingFile, scene::RecordedScene};
use support::{expect_code, hrdsl_in, root, tree};

/// The samples of a signal in a recording: seconds and values.
fn samples(text: &str, name: &str) -> Vec<(f64, f64)> {
    let lines = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    let of_signal = lines.filter(|line| line["signal"] == name);
    of_signal.filter_map(|line| Some((line["t"].as_f64()?, line["value"].as_f64()?))).collect()
}

/// The value at a time on the lines between frames.
fn on_lines<const N: usize>(frames: &[(f64, [f64; N])], time: f64) -> [f64; N] {
    let after = frames.partition_point(|(t, _)| *t <= time);
    let (Some((t0, from)), Some((t1, to))) =
        (frames.get(after.saturating_sub(1)), frames.get(after.min(frames.len() - 1)))
    else {
        panic!("no frames")
    };
    let part = if t1 > t0 { ((time - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { 0.0 };
    std::array::from_fn(|at| from[at] + part * (to[at] - from[at]))
}

fn place_of(scene: &RecordedScene, name: &str) -> usize {
    scene.bodies.iter().position(|body| body.name == name).unwrap()
}

#[test]
fn what_is_left_out_of_a_picture_lies_on_lines_between_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in tree(&root().join("cli/tests/robots")) {
        let to = folder.path().join(name);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::write(to, bytes).unwrap();
    }
    // What a requirement needs is recorded as it was.
    let scenario = folder.path().join("pick.hri");
    let judging = "\nrequire Turn safety \"it turns, and not too far\" globally turn < 3 rad\n";
    fs::write(&scenario, fs::read_to_string(&scenario).unwrap() + judging).unwrap();
    expect_code(&hrdsl_in(folder.path(), "sim pick.hri --replays all --exit-zero -o out"), 0);
    let bytes = fs::read(folder.path().join("out/replays/pick.once.t001.mcap")).unwrap();
    let RecordingFile { text, scene, picture, faults, .. } = recording::read(&bytes).unwrap();
    assert_eq!(faults, Vec::<String>::new());
    let scene = scene.unwrap();

    // A body: how far it is from another that rests, as the requirement judges it.
    let (moved, rests) = (place_of(&scene, "box"), place_of(&scene, "goal"));
    let track = picture.bodies.iter().find(|track| usize::from(track.body.0) == moved).unwrap();
    let frames: Vec<(f64, [f64; 3])> =
        track.frames.iter().map(|f| (f.time as f64 / 1e9, f.place.map(|x| x as f64 / 1e4))).collect();
    let goal = &scene.bodies[rests].pose;
    let judged = samples(&text, "range(box, goal)");
    let worst = judged.iter().map(|(time, range)| {
        let at = on_lines(&frames, *time);
        let shown = (0..3).map(|k| (at[k] - goal[k]).powi(2)).sum::<f64>().sqrt();
        (shown - range).abs()
    });
    let worst = worst.fold(0.0, f64::max);
    assert!(judged.len() > 50 && worst < 0.002, "{} samples, {worst} m", judged.len());

    // A joint.
    let joint = scene.joints.iter().position(|joint| joint.name == "robot.turn").unwrap();
    let track = picture.joints.iter().find(|track| usize::from(track.joint.0) == joint).unwrap();
    let joints: Vec<(f64, [f64; 1])> =
        track.frames.iter().map(|f| (f.time as f64 / 1e9, [f.position as f64 / 1e4])).collect();
    let judged = samples(&text, "turn");
    let worst = judged.iter().map(|(time, turn)| (on_lines(&joints, *time)[0] - turn).abs());
    let worst = worst.fold(0.0, f64::max);
    assert!(judged.len() > 50 && worst < 0.004, "{} samples, {worst} rad", judged.len());

    // It takes much less than what was looked at, which is 25 times a second.
    let seconds = frames.last().unwrap().0 - frames[0].0;
    for kept in [frames.len(), joints.len()] {
        assert!(kept as f64 * 3.0 < seconds * 25.0, "{kept} frames in {seconds} s");
    }
}

/// A picture of the documents: which test of which scenario is looked at, where, and in which light.
struct DocumentPicture {
    file: &'static str,
    scenario: &'static str,
    /// The options that choose the test.
    test: &'static str,
    /// What the address of the page says.
    shows: &'static str,
    dark: bool,
}

const HANDOVER: &str = "-n 3 --suite bdi_tests --test bdi_tests.t002";
const FALL: &str = "--suite bdi_tests --test bdi_tests.t006";
const LATE: &str = "--suite bdi_tests --test bdi_tests.t016";

const fn picture(
    file: &'static str,
    scenario: &'static str,
    test: &'static str,
    shows: &'static str,
    dark: bool,
) -> DocumentPicture {
    DocumentPicture { file, scenario, test, shows, dark }
}

const PICTURES: [DocumentPicture; 7] = [
    picture("spec/pictures/handover-light.png", "examples/handover", HANDOVER, "focus=R5", false),
    picture("spec/pictures/handover-dark.png", "examples/handover", HANDOVER, "focus=R5", true),
    picture("examples/homecare/pictures/fall-light.png", "examples/homecare", FALL, "focus=Upright", false),
    picture("examples/homecare/pictures/fall-dark.png", "examples/homecare", FALL, "focus=Upright", true),
    picture("examples/homecare/pictures/speed.png", "examples/homecare", FALL, "focus=R3", false),
    picture("examples/homecare/pictures/late-food.png", "examples/homecare", LATE, "focus=R1", false),
    picture("examples/homecare/pictures/long-stay.png", "examples/homecare", LATE, "focus=R4", false),
];

/// So large a picture may be, in bytes.
const LARGEST_PICTURE: u64 = 100 << 10;

#[test]
fn the_pictures_of_the_documents_are_there_and_small() {
    for DocumentPicture { file, .. } in PICTURES {
        let bytes = fs::read(root().join(file)).unwrap();
        assert!(
            bytes.starts_with(b"\x89PNG") && bytes.len() as u64 <= LARGEST_PICTURE,
            "{file}: {}",
            bytes.len()
        );
    }
}

/// Runs the tests, makes their pages, and lets Chromium draw them: `cargo test --workspace --test pictures -- --ignored --nocapture`.
#[test]
#[ignore = "it replaces the pictures of the documents, and needs Chromium"]
fn the_pictures_of_the_documents_are_made_again() {
    let folder = tempfile::tempdir().unwrap();
    for DocumentPicture { file, scenario, test, shows, dark } in PICTURES {
        let name = test.rsplit_once(' ').unwrap().1;
        let page = folder.path().join(format!("{}-{name}.html", scenario.replace('/', "-")));
        let path = root().join(scenario).join("scenario.hri");
        if !page.exists() {
            let out = folder.path().join("out");
            let words = format!("{} --replays all --exit-zero -o {}", path.display(), out.display());
            expect_code(&hrdsl_in(folder.path(), &format!("sim {words} {test}")), 0);
            let words =
                format!("{} {name} --results {} -o {}", path.display(), out.display(), page.display());
            expect_code(&hrdsl_in(folder.path(), &format!("view {words}")), 0);
        }
        let to = root().join(file);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        drawn(&format!("file://{}#run={name}&{shows}", page.display()), dark, &to);
        fs::write(&to, in_few_colours(&fs::read(&to).unwrap())).unwrap();
        println!("{file}: {} bytes", fs::metadata(to).unwrap().len());
    }
}

/// Lets Chromium draw a page, without a graphics card, into a file.
fn drawn(address: &str, dark: bool, to: &Path) {
    let mut command = Command::new("chromium");
    command.args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"]);
    command.args(["--disable-dev-shm-usage", "--hide-scrollbars", "--window-size=1280,720"]);
    command.args(["--disable-features=IsolateSandboxedIframes", "--virtual-time-budget=20000"]);
    command.args(dark.then_some("--force-dark-mode"));
    let output = command.arg(format!("--screenshot={}", to.display())).arg(address).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The same picture in at most 256 colours, those that it has most of, which takes half of the room.
fn in_few_colours(bytes: &[u8]) -> Vec<u8> {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let rough = |x: u8| u8::try_from((u16::from(x) + 4).min(255) / 8 * 8).unwrap_or(u8::MAX).min(251);
    let colour = |pixel: &[u8]| [pixel[0], pixel[1], pixel[2]].map(rough);
    let width = info.color_type.samples();
    let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for pixel in pixels.chunks_exact(width) {
        *counts.entry(colour(pixel)).or_default() += 1;
    }
    let mut most: Vec<([u8; 3], usize)> = counts.iter().map(|(colour, count)| (*colour, *count)).collect();
    most.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    most.truncate(256);
    let away =
        |a: [u8; 3], b: [u8; 3]| (0..3).map(|k| (i32::from(a[k]) - i32::from(b[k])).pow(2)).sum::<i32>();
    let nearest =
        |colour| (0_u8..=255).zip(&most).min_by_key(|(_, (known, _))| away(*known, colour)).unwrap().0;
    let places: BTreeMap<[u8; 3], u8> = counts.keys().map(|colour| (*colour, nearest(*colour))).collect();
    let indexed: Vec<u8> = pixels.chunks_exact(width).map(|pixel| places[&colour(pixel)]).collect();
    let mut small = Vec::new();
    let mut encoder = png::Encoder::new(&mut small, info.width, info.height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(most.iter().flat_map(|(colour, _)| *colour).collect::<Vec<u8>>());
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.write_header().unwrap().write_image_data(&indexed).unwrap();
    small
}
