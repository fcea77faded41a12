//! What can be wrong with maps and their files.

use parquet::errors::ParquetError;
use terrace::{PartsError, PoseNoiseError, StreamingError, VoxelKey};

use crate::schema::{METADATA_KEY, VERSION};

/// Why a map was not saved.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The map needs its points.
    #[error(transparent)]
    Map(#[from] StreamingError),
    /// The coordinates or errors of some points are so large that their sums are not finite.
    #[error("the sums of the cell {key:?} are not finite")]
    NotFinite {
        /// The voxel.
        key: VoxelKey,
    },
    /// The metadata cannot be written as JSON.
    #[error("the metadata: {0}")]
    Json(#[from] serde_json::Error),
    /// It could not be written.
    #[error("{0}")]
    Parquet(#[from] ParquetError),
}

/// Why a file is no map.
#[derive(Debug, thiserror::Error)]
pub enum MapFileError {
    /// It could not be opened.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// It is not Parquet, damaged, or packed in a way that is not read.
    #[error("not Parquet, or damaged: {0}")]
    Parquet(#[from] ParquetError),
    /// Its pages cannot be decoded.
    #[error("damaged: some values cannot be decoded")]
    Undecodable,
    /// A page does not hold what a map can have.
    #[error("damaged: column {column} at byte {offset}: {error}")]
    Page {
        /// The column.
        column: String,
        /// Where the page begins.
        offset: u64,
        /// What is wrong with it.
        error: PageError,
    },
    /// It is a table of something else.
    #[error("no map: the metadata '{METADATA_KEY}' is missing")]
    NoMap,
    /// It was written by another version of terrace whose files differ.
    #[error("a map of version {found}; this program reads version {VERSION}")]
    Version {
        /// What the metadata say.
        found: u64,
    },
    /// The metadata are not those of a map.
    #[error("the metadata '{METADATA_KEY}': {0}")]
    Metadata(#[from] serde_json::Error),
    /// A setting has a value that is not known.
    #[error("the setting {name} is {value}, which is not known")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: String,
    },
    /// The pose of a view has no such covariance.
    #[error("view {view}: {error}")]
    Pose {
        /// Its place among the views, from 0.
        view: usize,
        /// What is wrong.
        error: PoseNoiseError,
    },
    /// A column is missing or of another type.
    #[error("the column {name} is {found}, it must be {expected}")]
    Column {
        /// The column.
        name: &'static str,
        /// What it is.
        found: String,
        /// What it must be.
        expected: String,
    },
    /// A value is missing.
    #[error("the column {name} has no value in some row")]
    Null {
        /// The column.
        name: &'static str,
    },
    /// Settings, views and cells as a whole are those of no map.
    #[error("no map: {0}")]
    Map(PartsError),
    /// A row is no cell of this map.
    #[error("row {row}: {error}")]
    Cell {
        /// Its number, from 0.
        row: u64,
        /// What is wrong.
        error: PartsError,
    },
}

/// Why a page is not unpacked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PageError {
    /// It is not within the file.
    #[error("{bytes} bytes are not within the file of {file}")]
    Outside {
        /// How many it should have.
        bytes: i64,
        /// Those of the file.
        file: u64,
    },
    /// Its header is none.
    #[error("no header of a page")]
    Header,
    /// It would be larger than such values can be packed.
    #[error("{packed} bytes cannot be {bytes} bytes packed")]
    Packed {
        /// In the file.
        packed: i64,
        /// Unpacked.
        bytes: i64,
    },
    /// There are more values, or fewer, than the column has.
    #[error("{values} values where there can be {most}")]
    Values {
        /// As many as it says.
        values: i64,
        /// As many as there can be.
        most: i64,
    },
}
