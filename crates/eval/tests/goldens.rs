//! Ten pairs of real labelings and a made one, measured by another program.
//!
//! `data/goldens.txt` holds what a Python script with NumPy, of the same definitions but written apart from this crate,
//! gives for them from the labels of every point. The truth is that of public and of synthetic scans, the found labels are
//! those of `terrace extract` at several settings; the made pair has shares of exactly 0.5 and 0.8 and labels below 0. The
//! file holds how many points have which two labels: all that the measures depend on, and no scan is handed on.
#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use std::collections::BTreeMap;

use terrace_eval::{Contingency, Evaluation, PlaneAt, Spread};
use terrace_types::{Plane, PlaneId};

#[derive(Default)]
struct Pair {
    name: String,
    goldens: Vec<(String, f64)>,
    offsets: BTreeMap<PlaneId, f64>,
    truth: BTreeMap<PlaneId, Plane>,
    found: BTreeMap<PlaneId, PlaneAt>,
    labels: [Vec<i32>; 2],
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|x| x.parse().unwrap()).collect()
}

/// The plane with this normal and `normal . x + d = 0`.
fn plane(normal: &[f64], d: f64) -> Plane {
    let normal = [normal[0], normal[1], normal[2]];
    Plane::through(normal.map(|x| -d * x), normal).unwrap()
}

impl Pair {
    fn add(&mut self, key: &str, rest: &str) {
        let id = || PlaneId::new(rest.split_whitespace().next().unwrap().parse().unwrap()).unwrap();
        match key {
            "golden" => {
                let (name, value) = rest.split_once(' ').unwrap();
                self.goldens.push((name.to_owned(), value.parse().unwrap()));
            }
            "offset" => drop(self.offsets.insert(id(), numbers(rest)[1])),
            "truth" => drop(self.truth.insert(id(), plane(&numbers(rest)[1..4], -numbers(rest)[4]))),
            "found" => {
                let n = numbers(rest);
                let centre = Some([n[5], n[6], n[7]]);
                self.found.insert(id(), PlaneAt { plane: plane(&n[1..4], n[4]), centre });
            }
            "counts" => {
                for group in rest.split(',') {
                    let group: Vec<i32> = group.split_whitespace().map(|x| x.parse().unwrap()).collect();
                    let points = usize::try_from(group[2]).unwrap();
                    for (labels, label) in self.labels.iter_mut().zip(group) {
                        labels.extend(std::iter::repeat_n(label, points));
                    }
                }
            }
            _ => panic!("{key}"),
        }
    }

    fn evaluation(&self) -> Evaluation {
        Evaluation::of(&Contingency::of_numbers(&self.labels[0], &self.labels[1]).unwrap())
    }
}

fn pairs() -> Vec<Pair> {
    let mut pairs: Vec<Pair> = Vec::new();
    for line in include_str!("data/goldens.txt").lines().filter(|line| !line.starts_with('#')) {
        match line.split_once(' ').unwrap() {
            ("pair", name) => pairs.push(Pair { name: name.to_owned(), ..Pair::default() }),
            (key, rest) => pairs.last_mut().unwrap().add(key, rest),
        }
    }
    pairs
}

/// Its name here, and what stands there where there is no value here.
fn name_here(golden: &str) -> Option<(&str, f64)> {
    Some(match golden {
        "n_pred" => ("found_planes", 0.0),
        "n_gt" => ("true_planes", 0.0),
        "tp@0.5" => ("matched_50", 0.0),
        "precision@0.5" => ("precision_50", 0.0),
        "recall@0.5" => ("recall_50", 0.0),
        "f1@0.5" => ("f1_50", 0.0),
        "tp@0.8" => ("matched_80", 0.0),
        "precision@0.8" => ("precision_80", 0.0),
        "recall@0.8" => ("recall_80", 0.0),
        "f1@0.8" => ("f1_80", 0.0),
        "miou_matched" => ("mean_iou", 0.0),
        "dice_matched" => ("mean_dice", 0.0),
        "miou_all" => ("mean_iou_all", f64::NAN),
        "cov" => ("cover", f64::NAN),
        "wcov" => ("weighted_cover", f64::NAN),
        "nonplanar_claimed" => ("non_planar_claimed", 0.0),
        "correct" | "over" | "under" | "missed" | "noise" | "point_accuracy" => (golden, 0.0),
        _ => return None,
    })
}

#[test]
fn measures_are_those_of_the_script() {
    let pairs = pairs();
    assert_eq!(pairs.len(), 11);
    for pair in &pairs {
        let measures = pair.evaluation().measures();
        let mut compared = 0;
        for (golden, expected) in &pair.goldens {
            let Some((name, absent)) = name_here(golden) else {
                assert!(golden.starts_with("angle_native_"), "{golden}");
                continue;
            };
            let value = measures.iter().find(|m| m.name == name).unwrap().value.unwrap_or(absent);
            assert!((value - expected).abs() < 1e-14, "{}: {name} {value}, the script {expected}", pair.name);
            // The script shows four decimals.
            assert_eq!(format!("{value:.4}"), format!("{expected:.4}"), "{}: {name}", pair.name);
            compared += 1;
        }
        assert_eq!(compared, measures.len(), "{}", pair.name);
    }
}

#[test]
fn the_pairs_hold_every_kind_of_plane() {
    let all: Vec<_> = pairs().iter().map(|pair| pair.evaluation().segcomp).collect();
    assert!(all.iter().any(|s| s.over > 0 && s.over_found > s.over));
    assert!(all.iter().any(|s| s.under > 0 && s.under_true > s.under));
    assert!(all.iter().any(|s| s.missed > 0) && all.iter().any(|s| s.noise > 0));
    assert!(pairs().iter().filter(|pair| pair.labels[0].iter().any(|label| *label < 0)).count() > 1);
}

#[test]
fn angles_and_offsets_are_those_of_the_script() {
    let (mut with_angles, mut with_offsets) = (0, 0);
    for pair in pairs() {
        let deviations = pair.evaluation().deviations(&pair.truth, &pair.found);
        let spread = Spread::of(deviations.iter().map(|d| d.angle.to_degrees()));
        for (golden, expected) in &pair.goldens {
            let Some(which) = golden.strip_prefix("angle_native_") else { continue };
            let spread = spread.unwrap();
            let value = match which {
                "median" => spread.median,
                "mean" => spread.mean,
                _ => spread.max,
            };
            assert!((value - expected).abs() < 1e-11, "{}: {golden} {value}, {expected}", pair.name);
            with_angles += 1;
        }
        for (truth, expected) in &pair.offsets {
            // The script takes the centre itself, not its foot on the plane: these are planes of all their points.
            let offset = deviations.iter().find(|d| d.truth == *truth).unwrap().offset.unwrap();
            assert!((offset - expected).abs() < 1e-9, "{}: {truth} {offset}, {expected}", pair.name);
            with_offsets += 1;
        }
    }
    assert_eq!((with_angles, with_offsets), (9, 6));
}
