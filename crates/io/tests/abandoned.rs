//! A program that is interrupted leaves nothing half-written. A binary of its own with one test, because what is
//! abandoned is so for the process.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;

use terrace_io::{
    LabelledPoint, LabelsWriter, PlyExtent, PlyWriter, WriteErrorKind, abandon_outputs, write_atomically,
};

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn abandoned_outputs_are_removed_and_stay_away() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name| folder.path().join(name);
    write_atomically(&path("finished.txt"), |out| Ok(out.write_all(b"whole")?)).unwrap();
    let mut labels = LabelsWriter::create(&path("labels.npy"), 100_000).unwrap();
    labels.push(vec![None; 99_999]).unwrap();
    let extent = PlyExtent { points: 1, largest: 0.0 };
    let mut points = PlyWriter::create(&path("points.ply"), extent).unwrap();
    points.push([LabelledPoint { position: [0.0; 3], plane: None }]).unwrap();
    // A writer that was dropped has nothing left to remove.
    drop(LabelsWriter::create(&path("dropped.npy"), 1).unwrap());
    assert_eq!(names(folder.path()).len(), 3);

    let other_thread = std::thread::spawn(abandon_outputs);
    other_thread.join().unwrap();
    assert_eq!(names(folder.path()), ["finished.txt"]);

    // Writers that go on until they notice get no name, and nobody begins anew.
    labels.push([None]).unwrap();
    for error in [
        labels.finish().unwrap_err(),
        points.finish().unwrap_err(),
        LabelsWriter::create(&path("labels.npy"), 0).unwrap_err(),
        write_atomically(&path("note.txt"), |_| Ok(())).unwrap_err(),
    ] {
        assert!(
            matches!(&error.kind, WriteErrorKind::Io(e) if e.to_string().contains("interrupted")),
            "{error}"
        );
    }
    assert_eq!(names(folder.path()), ["finished.txt"]);
}
