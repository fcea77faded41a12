//! Helpers of the whole-workspace tests: the program, the folder of real scans, and reading of results.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::missing_panics_doc,
    reason = "tests"
)]

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;
use terrace_io::planes_json::PlanesFile;

/// A folder of a test's own, gone after it.
#[derive(Debug)]
pub struct Folder(TempDir);

impl Folder {
    /// An empty one.
    #[allow(clippy::new_without_default, reason = "it makes a folder")]
    #[must_use]
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// The path of a file or folder in it.
    #[must_use]
    pub fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }
}

/// What a run of the program left behind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    /// The exit code.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Run {
    /// The run itself, when the exit code was `code` and nothing panicked.
    #[must_use]
    #[track_caller]
    pub fn ended_with(self, code: i32) -> Self {
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert_eq!(self.code, code, "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        self
    }
}

/// Runs the program with these arguments.
pub fn terrace<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Run {
    let output = Command::new(program()).args(arguments).output().expect("the program starts");
    Run {
        code: output.status.code().expect("the program ends by itself"),
        stdout: String::from_utf8(output.stdout).expect("text"),
        stderr: String::from_utf8(output.stderr).expect("text"),
    }
}

/// The program, built once per test executable in the profile and target folder of the tests. Cargo does nothing when
/// it is up to date, so that a program of an older state is never tested.
fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        // <target>/<profile>/deps/<test>
        let test = std::env::current_exe().expect("a test executable");
        let folder = test.parent().and_then(Path::parent).expect("the folder of the profile");
        let profile = match folder.file_name().and_then(OsStr::to_str) {
            Some("debug") | None => "dev",
            Some(other) => other,
        };
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let built = Command::new(cargo)
            .args(["build", "--quiet", "-p", "terrace-cli", "--bin", "terrace", "--profile", profile])
            .arg("--target-dir")
            .arg(folder.parent().expect("the target folder"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .status()
            .expect("cargo starts");
        let path = folder.join("terrace").with_extension(std::env::consts::EXE_EXTENSION);
        assert!(built.success() && path.is_file(), "{} cannot be built", path.display());
        path
    })
}

/// A file or folder of the real scans: below `TERRACE_DATA`, or `shared/data` beside the repository. `None`, with a
/// message, when it is not there.
pub fn real(name: &str) -> Option<PathBuf> {
    let root = std::env::var_os("TERRACE_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    let path = root.join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there (TERRACE_DATA names the folder of real scans)", path.display());
    None
}

/// The labels in `folder`.
#[track_caller]
pub fn labels(folder: &Path) -> Vec<i32> {
    let bytes = std::fs::read(folder.join("labels.npy")).expect("labels.npy");
    terrace_io::npy::read_labels(&bytes).expect("labels")
}

/// The planes in `folder`.
#[track_caller]
pub fn planes(folder: &Path) -> PlanesFile {
    PlanesFile::open(&folder.join("planes.json")).expect("planes.json")
}

/// `planes.json` in `folder` without the times, which differ from run to run.
#[track_caller]
pub fn planes_without_times(folder: &Path) -> Value {
    let bytes = std::fs::read(folder.join("planes.json")).expect("planes.json");
    let mut value: Value = serde_json::from_slice(&bytes).expect("JSON");
    let times = value.as_object_mut().expect("an object").remove("timings_seconds");
    assert!(times.is_some(), "planes.json has timings_seconds");
    value
}

/// The greatest intersection over union of the points of one true plane with those of any found plane.
pub fn best_overlap(truth: &[i32], found: &[i32], plane: i32) -> f64 {
    assert_eq!(truth.len(), found.len(), "one label per point");
    let count = |labels: &[i32], label| labels.iter().filter(|&&x| x == label).count();
    let true_points = count(truth, plane);
    let most = found.iter().copied().max().unwrap_or(0);
    (1..=most)
        .map(|candidate| {
            let both = truth.iter().zip(found).filter(|&(&t, &f)| t == plane && f == candidate).count();
            both as f64 / (true_points + count(found, candidate) - both).max(1) as f64
        })
        .fold(0.0, f64::max)
}
