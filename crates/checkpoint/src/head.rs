//! What belongs to a map as a whole, as JSON.

use serde::{Deserialize, Serialize};
use terrace::{CellSizeChoice, MapBuilder, Mapper, PoseNoise, View};

use crate::schema::VERSION;
use crate::settings::Settings;
use crate::{MapFileError, SaveError};

/// The metadata under [`METADATA_KEY`](crate::METADATA_KEY).
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Head {
    version: u64,
    /// In metres.
    cell_size: Option<f64>,
    /// `null` where the cell size was given.
    cell_size_from: Option<ChosenFrom>,
    /// Edge of a row's cell in metres. For people: it follows.
    #[serde(skip_deserializing)]
    edge: Option<f64>,
    params: Settings,
    views: Vec<ViewRecord>,
}

#[derive(Debug, Serialize, Deserialize)]
struct ChosenFrom {
    spacing: f64,
    sigma: f64,
}

#[derive(Debug, Serialize, Deserialize)]
struct ViewRecord {
    points: usize,
    absent: usize,
    out_of_range: usize,
    sensor: Option<[f64; 3]>,
    pose_covariance: Option<[[f64; 6]; 6]>,
}

/// Read before the rest, which other versions may have changed.
#[derive(Deserialize)]
struct Versioned {
    version: u64,
}

impl Head {
    /// As JSON.
    pub(crate) fn write(mapper: &Mapper) -> Result<String, SaveError> {
        let chosen = mapper.chosen_cell_size();
        let view = |view: &View| ViewRecord {
            points: view.points,
            absent: view.absent,
            out_of_range: view.out_of_range,
            sensor: view.sensor,
            pose_covariance: view.pose.map(|pose| pose.covariance()),
        };
        let head = Self {
            version: VERSION,
            cell_size: mapper.cell_size(),
            cell_size_from: chosen.map(|CellSizeChoice { spacing, sigma, .. }| ChosenFrom { spacing, sigma }),
            edge: mapper.edge(),
            params: Settings::from(mapper.params()),
            views: mapper.views().iter().map(view).collect(),
        };
        Ok(serde_json::to_string(&head)?)
    }

    /// A map of these metadata, without cells so far.
    pub(crate) fn read(text: &str) -> Result<MapBuilder, MapFileError> {
        let Versioned { version } = serde_json::from_str(text)?;
        if version != VERSION {
            return Err(MapFileError::Version { found: version });
        }
        let Self { cell_size, cell_size_from, params, views, .. } = serde_json::from_str(text)?;
        let mut of_map = Vec::with_capacity(views.len());
        for (number, view) in views.into_iter().enumerate() {
            let pose = view.pose_covariance.map(PoseNoise::from_covariance).transpose();
            of_map.push(View {
                points: view.points,
                absent: view.absent,
                out_of_range: view.out_of_range,
                sensor: view.sensor,
                pose: pose.map_err(|error| MapFileError::Pose { view: number, error })?,
            });
        }
        let (given, chosen) = match cell_size_from {
            None => (cell_size, None),
            Some(ChosenFrom { spacing, sigma }) => {
                (None, cell_size.map(|cell_size| CellSizeChoice { cell_size, spacing, sigma }))
            }
        };
        MapBuilder::new(params.params(given)?, chosen, of_map).map_err(MapFileError::Map)
    }
}
