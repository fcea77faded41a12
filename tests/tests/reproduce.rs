//! The paper's synthetic experiment, section VI-A, keeps its pattern.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use terrace_tests::terrace;

#[test]
fn planes_are_merged_at_first_and_three_after_optimisation() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("paper").to_str().unwrap().to_owned();
    let run = terrace(["reproduce", "--seeds", "3", "--quiet", "--out", &out]).ended_with(0);
    assert!(run.stdout.contains("the pattern of Table I holds for 3 of 3 seeds"), "{}", run.stdout);
    for figure in ["fig1.png", "staircase.png", "staircase.svg"] {
        assert!(folder.path().join("paper").join(figure).is_file(), "{figure}");
    }
}
