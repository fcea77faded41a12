//! `planes.json`: the planes of a scene with their uncertainty, and how they were found.
//!
//! Every field, with its unit, is described in `docs/planes-json.md` of the repository.

mod plane;

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::{FileError, WriteError, WriteErrorKind, write_atomically};

pub use plane::{PhiInterval, PlaneRecord, TiltOffset};

/// What the field `format` holds.
pub const FORMAT: &str = "terrace-planes";

/// The version written, and the only one read.
pub const VERSION: u32 = 1;

/// The planes of a scene.
///
/// ```
/// use terrace_io::planes_json::{PlaneRecord, PlanesFile};
/// use terrace_types::{Plane, PlaneId};
///
/// let floor = Plane::through([0.0, 0.0, 0.1], [0.0, 0.0, 1.0])?;
/// let mut record = PlaneRecord::new(PlaneId::from_index(0).unwrap(), &floor, 1200);
/// record.name = Some("floor".into());
/// let file = PlanesFile { planes: vec![record], ..PlanesFile::default() };
///
/// let text = file.to_json()?;
/// assert_eq!(PlanesFile::from_json(text.as_bytes())?, file);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct PlanesFile {
    /// Every parameter that shaped the result, by name; in a file they are sorted by name. Numbers that are not finite
    /// cannot be held here: `serde_json` turns them into null.
    #[serde(default)]
    pub parameters: Map<String, Value>,
    /// The planes, in the order of their numbers.
    pub planes: Vec<PlaneRecord>,
    /// Totals over the whole result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub summary: Option<Summary>,
    /// Wall-clock time of each stage; left out where files of two runs are to be compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timings_seconds: Option<Timings>,
}

/// Totals over a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Number of points of all inputs, absent ones included: the length of `labels.npy`.
    pub points: u64,
    /// Number of points that belong to a plane.
    pub labelled: u64,
    /// Number of planes.
    pub planes: u64,
    /// Mean of `normal_uncertainty` over the planes, per axis; left out when there is no plane or it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_uncertainty_mean: Option<[f64; 3]>,
    /// What the search for thresholds did; left out when there was none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub optimised: Option<OptimisedSummary>,
}

/// Totals over the clusters whose threshold was searched.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OptimisedSummary {
    /// Number of these clusters.
    pub clusters: u64,
    /// Those for which it is proven that no threshold costs less.
    pub proven: u64,
    /// Mean share of the thresholds for which it is proven, 0 to 1; left out without clusters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certified_mean: Option<f64>,
    /// Clusterings that were made.
    pub evaluations: u64,
}

/// Seconds of wall-clock time that each stage took.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Timings {
    /// Reading the inputs.
    pub load: f64,
    /// Sorting points into the grid.
    pub grid: f64,
    /// Fitting normals.
    pub normals: f64,
    /// Growing regions; left out where cells were clustered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grow: Option<f64>,
    /// Clustering.
    pub cluster: f64,
    /// Optimising φ.
    pub optimise: f64,
    /// Labelling points.
    pub label: f64,
    /// Outlining the planes; left out where that was not asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extent: Option<f64>,
    /// Writing the outputs before this file.
    pub write: f64,
    /// From start to end.
    pub total: f64,
}

/// Why JSON is not a file of planes.
#[derive(Debug, thiserror::Error)]
pub enum PlanesJsonError {
    /// It is not JSON, or a field is missing or of another type.
    #[error("{0}")]
    Json(serde_json::Error),
    /// It is JSON of another kind.
    #[error("the format is '{found}', expected '{FORMAT}'")]
    Format {
        /// What the field `format` says.
        found: String,
    },
    /// It was written by another version of terrace whose files differ.
    #[error("version {found} is not known; this program reads version {VERSION}")]
    Version {
        /// What the field `version` says.
        found: u32,
    },
}

/// What comes first in a file.
#[derive(Serialize, Deserialize)]
struct Envelope<'a> {
    #[serde(borrow)]
    format: std::borrow::Cow<'a, str>,
    version: u32,
}

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    envelope: Envelope<'a>,
    #[serde(flatten)]
    content: &'a PlanesFile,
}

impl PlanesFile {
    /// The text of the file, ending with a newline. Numbers read back to the same bits.
    ///
    /// # Errors
    /// [`WriteErrorKind::NotFinite`] naming the field, when a number is NaN or infinite.
    pub fn to_json(&self) -> Result<String, WriteErrorKind> {
        self.check_finite()?;
        let envelope = Envelope { format: FORMAT.into(), version: VERSION };
        let document = Document { envelope, content: self };
        let mut text = serde_json::to_string_pretty(&document).map_err(std::io::Error::from)?;
        text.push('\n');
        Ok(text)
    }

    /// Writes the file; a damaged one is never left behind.
    ///
    /// # Errors
    /// [`WriteError`] when a number is not finite or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_atomically(path, |out| Ok(out.write_all(self.to_json()?.as_bytes())?))
    }

    /// Reads the bytes of a file. Fields that are not known are passed over.
    ///
    /// # Errors
    /// [`PlanesJsonError`] when it is not JSON, of another format or version, or a field is missing.
    pub fn from_json(bytes: &[u8]) -> Result<Self, PlanesJsonError> {
        let Envelope { format, version } = serde_json::from_slice(bytes).map_err(PlanesJsonError::Json)?;
        if format != FORMAT {
            return Err(PlanesJsonError::Format { found: format.chars().take(40).collect() });
        }
        if version != VERSION {
            return Err(PlanesJsonError::Version { found: version });
        }
        serde_json::from_slice(bytes).map_err(PlanesJsonError::Json)
    }

    /// Reads a file as [`PlanesFile::from_json`] does.
    ///
    /// # Errors
    /// [`FileError`] naming the file.
    pub fn open(path: &Path) -> Result<Self, FileError<PlanesJsonError>> {
        crate::file::open_with(path, Self::from_json)
    }

    fn check_finite(&self) -> Result<(), WriteErrorKind> {
        let refuse = |what: String, value: f64| Err(WriteErrorKind::NotFinite { what, value });
        for (index, plane) in self.planes.iter().enumerate() {
            if let Some((field, value)) = plane.numbers().find(|(_, value)| !value.is_finite()) {
                return refuse(format!("planes[{index}].{field}"), value);
            }
        }
        let means = self.summary.iter().filter_map(|s| s.normal_uncertainty_mean).flatten();
        let times = self.timings_seconds.iter();
        let times = times.flat_map(|t| {
            let always = [t.load, t.grid, t.normals, t.cluster, t.optimise, t.label, t.write, t.total];
            always.into_iter().chain(t.grow).chain(t.extent)
        });
        let named = means
            .map(|v| ("summary.normal_uncertainty_mean", v))
            .chain(times.map(|v| ("timings_seconds", v)));
        match named.into_iter().find(|(_, value)| !value.is_finite()) {
            Some((field, value)) => refuse(field.to_owned(), value),
            None => Ok(()),
        }
    }
}
