//! `hrdsl fmt`, as a user types it.

mod support;

use std::fs;
use std::path::Path;

use support::{expect_code, hrdsl, stderr, stdout};

const UGLY: &str = "scenario   s\n\n\n\nactor a:environment // who\n";
const TIDY: &str = "scenario s\n\nactor a : environment // who\n";

/// A folder with files in style, out of style, with a fault, and where nobody looks.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for sub in ["inner", ".hidden", "target", "node_modules", "hrdsl-out"] {
        fs::create_dir(folder.path().join(sub)).unwrap();
    }
    for (name, text) in [
        ("ugly.hri", UGLY),
        ("tidy.hri", TIDY),
        ("inner/ugly.hri", UGLY),
        ("text.txt", UGLY),
        (".hidden/ugly.hri", UGLY),
        ("target/ugly.hri", UGLY),
        ("node_modules/ugly.hri", UGLY),
        ("hrdsl-out/ugly.hri", UGLY),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn a_folder_is_formatted_once() {
    let folder = folder();
    let path = folder.path().to_str().unwrap();
    let out = hrdsl(["fmt", path]);
    expect_code(&out, 0);
    assert_eq!(stderr(&out), "2 files reformatted, 1 left unchanged\n");
    assert_eq!(stdout(&out), "");
    for name in ["ugly.hri", "tidy.hri", "inner/ugly.hri"] {
        assert_eq!(text(folder.path(), name), TIDY, "{name}");
    }
    for name in
        ["text.txt", ".hidden/ugly.hri", "target/ugly.hri", "node_modules/ugly.hri", "hrdsl-out/ugly.hri"]
    {
        assert_eq!(text(folder.path(), name), UGLY, "{name}");
    }
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left.len(), 8, "{left:?}");
    let again = hrdsl(["fmt", path]);
    assert_eq!(stderr(&again), "0 files reformatted, 3 left unchanged\n");
}

#[test]
fn check_lists_and_changes_nothing() {
    let folder = folder();
    let out = hrdsl(["fmt", "--check", folder.path().to_str().unwrap()]);
    expect_code(&out, 1);
    assert_eq!(stdout(&out).lines().count(), 2);
    assert!(stdout(&out).contains("inner/ugly.hri\n"));
    assert_eq!(stderr(&out), "2 files would be reformatted, 1 left unchanged\n");
    assert_eq!(text(folder.path(), "ugly.hri"), UGLY);
    let tidy = hrdsl(["fmt", "--check", folder.path().join("tidy.hri").to_str().unwrap()]);
    expect_code(&tidy, 0);
}

#[test]
fn diff_shows_and_changes_nothing() {
    let folder = folder();
    let file = folder.path().join("ugly.hri");
    let out = hrdsl(["fmt", "--diff", file.to_str().unwrap()]);
    expect_code(&out, 0);
    assert!(stdout(&out).contains("\n-actor a:environment // who\n+actor a : environment // who\n"));
    assert_eq!(text(folder.path(), "ugly.hri"), UGLY);
    expect_code(&hrdsl(["fmt", "--diff", "--check", file.to_str().unwrap()]), 1);
}

#[test]
fn a_file_with_a_fault_is_not_changed() {
    let folder = folder();
    let file = folder.path().join("broken.hri");
    fs::write(&file, "scenario   s\nevent\n").unwrap();
    let out = hrdsl(["fmt", folder.path().to_str().unwrap()]);
    expect_code(&out, 1);
    assert!(stderr(&out).contains("HR0002"), "{}", stderr(&out));
    assert!(stderr(&out).ends_with("2 files reformatted, 1 left unchanged, 1 with errors\n"));
    assert_eq!(text(folder.path(), "broken.hri"), "scenario   s\nevent\n");
    assert_eq!(text(folder.path(), "ugly.hri"), TIDY);
}

#[test]
fn a_missing_file_is_named() {
    let out = hrdsl(["fmt", "nowhere.hri"]);
    expect_code(&out, 2);
    assert!(stderr(&out).starts_with("error: no such file: nowhere.hri\n"));
}

#[test]
fn the_examples_and_the_library_are_formatted() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let [examples, library] = ["examples", "stdlib"].map(|f| root.join(f).to_string_lossy().into_owned());
    let out = hrdsl(["fmt", "--check", &examples, &library]);
    assert_eq!(stdout(&out), "");
    expect_code(&out, 0);
}
