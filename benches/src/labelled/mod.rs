//! Scenes whose planes are known, as the data folder describes them.
//!
//! Labels are numbers: 0 for no plane, 1 and up for planes, below 0 for points that no count looks at.

mod files;
mod made;
mod motion;

use std::collections::BTreeMap;

use terrace::{Plane, PlaneId, Scan};

use crate::scenes::{self, SceneError};
pub use motion::Motion;

/// A scene with its truth.
#[derive(Debug, Clone)]
pub struct Labelled {
    /// The scans, with their errors where the scene tells them.
    pub scans: Vec<Scan>,
    /// The true plane of each point, scan after scan.
    pub truth: Vec<i32>,
    /// Where the true planes are; empty where only their points are known.
    pub planes: BTreeMap<PlaneId, TruePlane>,
}

/// A true plane.
#[derive(Debug, Clone)]
pub struct TruePlane {
    /// What it is.
    pub name: String,
    /// Where it is, in the world of the scans.
    pub plane: Plane,
}

/// A scene that may be read.
#[derive(Debug, Clone)]
pub struct Entry {
    /// What the scene is called.
    pub name: String,
    /// What it belongs to; scenes of a group have a mean.
    pub group: &'static str,
    source: From,
}

#[derive(Debug, Clone)]
enum From {
    /// A folder of arrays, and whether the sensor is at the origin.
    Arrays { folder: String, at_origin: bool },
    /// A PLY file with its labels beside it, named without endings.
    Ply { stem: String },
    /// The simulated lidar, with noise.
    Balm,
    /// The simulated room with this many points.
    Room { points: usize },
}

/// Points of the large room.
const ROOM: usize = 3_000_000;
/// From this number on, the labels of `mosd` leave out what lies on the table.
const FIRST_WITHOUT_BOXES: u32 = 25;

/// All scenes, in the order of the table. Of folders with any number of scenes those that are there, or the folder
/// itself when none is.
///
/// # Errors
/// When a folder cannot be looked at.
pub fn entries() -> Result<Vec<Entry>, SceneError> {
    let entry = |name: &str, group, source| Entry { name: name.to_owned(), group, source };
    let arrays = |name: &str, at_origin| From::Arrays { folder: format!("scenes/{name}"), at_origin };
    let mut all = vec![
        entry("table", "", arrays("table", false)),
        entry("room300k", "", arrays("room300k", false)),
        entry("synth-room-3M", "", From::Room { points: ROOM }),
        entry("roomframe0", "roomframe", arrays("roomframe0", true)),
        entry("roomframe1", "roomframe", arrays("roomframe1", true)),
    ];
    for (folder, group) in [("evops_icl", "evops_icl"), ("synpeb", "synpeb")] {
        all.extend(in_folder(folder, |_| group)?);
    }
    all.push(entry("balm_sim", "", From::Balm));
    let of_mosd = |name: &str| {
        let number = name.trim_start_matches(|c: char| !c.is_ascii_digit()).parse();
        if number.is_ok_and(|n: u32| n >= FIRST_WITHOUT_BOXES) { "mosd-bare" } else { "mosd-boxes" }
    };
    all.extend(in_folder("mosd", of_mosd)?);
    all.extend(in_folder("nyuv2_planes", |_| "nyuv2_planes")?);
    all.extend(in_folder("roofs", |_| "roofs")?);
    Ok(all)
}

fn in_folder(folder: &str, group: impl Fn(&str) -> &'static str) -> Result<Vec<Entry>, SceneError> {
    let mut names = files::labelled(folder)?;
    if names.is_empty() {
        names.push(folder.to_owned());
    }
    let entry = |name: String| {
        let group = group(&name);
        Entry { source: From::Ply { stem: format!("{folder}/{name}") }, name, group }
    };
    let mut entries: Vec<Entry> = names.into_iter().map(entry).collect();
    // Scenes of one group stand together.
    entries.sort_by_key(|entry| entry.group);
    Ok(entries)
}

impl Entry {
    /// Whether one of the words is part of its name or group; all are meant when there is no word.
    pub fn is_meant(&self, words: &[String]) -> bool {
        let matches = |word: &String| self.name.contains(word) || self.group.contains(word);
        words.is_empty() || words.iter().any(matches)
    }

    /// Reads or makes the scene; `None` when the data folder does not have it.
    ///
    /// # Errors
    /// When a file of it cannot be read, or the files contradict each other.
    pub fn load(&self) -> Result<Option<Labelled>, SceneError> {
        let scene = match &self.source {
            From::Arrays { folder, at_origin } => match scenes::path(folder) {
                Some(folder) => files::arrays(&folder, *at_origin)?,
                None => return Ok(None),
            },
            From::Ply { stem } => match scenes::path(&format!("{stem}.ply")) {
                Some(ply) => files::ply(&ply, self.group == "mosd-bare", self.group == "synpeb")?,
                None => return Ok(None),
            },
            From::Balm => match scenes::path("balm_sim") {
                Some(folder) => made::balm(&folder)?,
                None => return Ok(None),
            },
            From::Room { points } => made::room(*points)?,
        };
        let points: usize = scene.scans.iter().map(Scan::len).sum();
        if points != scene.truth.len() {
            return Err(format!("{}: {} labels for {points} points", self.name, scene.truth.len()).into());
        }
        Ok(Some(scene))
    }
}
