//! Models like those that come with UPPAAL, written from what papers say of them: each is imported, and answers as published.

mod support;

use std::{collections::BTreeSet, fs, path::Path};

use support::{
    expect_code, hrdsl_in,
    uppaal::{NO, YES, answers},
};

const DEMOS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../compiler/interop/tests/uppaal/demos");

fn demo(model: &str, published: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(Path::new(DEMOS).join(model), folder.path().join(model)).unwrap();
    let queries = Path::new(model).with_extension("q");
    if Path::new(DEMOS).join(&queries).is_file() {
        fs::copy(Path::new(DEMOS).join(&queries), folder.path().join(&queries)).unwrap();
    }
    assert_eq!(answers(folder.path(), model), published, "{model}");
    // As a model of UPPAAL again, whose locations have ids of their own, it answers the same.
    expect_code(&hrdsl_in(folder.path(), "export uppaal there.hri -o back.xml"), 0);
    let back = fs::read_to_string(folder.path().join("back.xml")).unwrap();
    let ids: Vec<&str> = back.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert!(ids.len() > 2 && ids.len() == ids.iter().collect::<BTreeSet<_>>().len(), "{ids:?}");
    assert_eq!(answers(folder.path(), "back.xml"), published, "{model}, back");
}

/// Yi, Pettersson and Daniels (1994), with the queue as functions (Behrmann, David and Larsen 2004).
#[test]
fn trains_cross_one_at_a_time() {
    demo("train_gate.xml", &[YES; 7]);
}

/// Fischer's protocol: who waits may wait for ever.
#[test]
fn fischer_excludes() {
    demo("fischer.xml", &[YES, YES, YES, YES, NO]);
}

/// The same in the textual format, with the queries in a file beside it.
#[test]
fn fischer_excludes_as_text_too() {
    let bound = "2 s, which is not attained";
    let late = [YES, YES, YES, YES, NO, YES, NO, YES, NO, bound, NO, NO, NO, YES, YES];
    demo("fischer_text.xta", &late);
}

#[test]
fn two_doors_are_never_open_at_once() {
    demo("two_doors.xml", &[YES, YES, YES, YES, YES, YES, YES, "26 s"]);
}

/// Rote's puzzle of the bridge: 5, 10, 20 and 25 minutes make 60.
#[test]
fn vikings_cross_in_sixty() {
    demo("bridge.xml", &[YES, YES, NO, YES, YES, NO, YES]);
}

/// Bengtsson and others' sorter of Lego: red boxes are kicked off the belt, black ones are not.
#[test]
fn red_boxes_are_kicked_off() {
    demo("box_sorter.xml", &[YES; 8]);
}

/// The shortest schedule, 11, is that of a search through all orders of the nine steps.
#[test]
fn jobs_end_as_early_as_they_can() {
    demo("job_shop.xml", &[YES, NO, YES, "11 s"]);
}

/// Three tasks by fixed priorities, each of which a more urgent one interrupts: 3, 6 and 20 are the longest responses by the recurrence
/// R = C + Σ ⌈R / Tⱼ⌉ Cⱼ of Joseph and Pandya (1986).
#[test]
fn tasks_are_interrupted_and_respond_in_time() {
    demo("interruption.xml", &[YES, NO, YES, NO, YES, NO, YES, NO, YES]);
}

/// David and others' framework, without interruption. The longest responses, 9, 13 and 13, are those of a simulation in whole units of
/// time that tries every execution time.
#[test]
fn tasks_meet_their_deadlines() {
    demo("scheduling.xml", &[YES, YES, "9 s", "13 s", "13 s", YES, YES]);
}
