//! What is kept of the world for looking lies where the judged signals say that it was.

mod support;

use std::fs;

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
