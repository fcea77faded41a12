//! The columns of a map.

use std::sync::Arc;

use arrow_schema::{DataType, Field, Fields, Schema};

/// The key of the metadata of the file that holds what belongs to the map as a whole, as JSON.
pub const METADATA_KEY: &str = "terrace-map";

/// The version written, and the only one read.
pub const VERSION: u64 = 2;

pub(crate) const KEY: [&str; 3] = ["x", "y", "z"];
pub(crate) const POINTS: &str = "points";
pub(crate) const SUM: [&str; 3] = ["sum_x", "sum_y", "sum_z"];
pub(crate) const SECOND: [&str; 6] =
    ["second_xx", "second_xy", "second_xz", "second_yy", "second_yz", "second_zz"];
pub(crate) const NOISE: [&str; 6] = ["noise_xx", "noise_xy", "noise_xz", "noise_yy", "noise_yz", "noise_zz"];
pub(crate) const SAMPLE: &str = "sample";
pub(crate) const PLACE: [&str; 3] = ["x", "y", "z"];
pub(crate) const ENDURES: &str = "endures";
pub(crate) const HALVINGS: &str = "sample_halvings";
pub(crate) const SEEN: &str = "seen";
pub(crate) const SIGHTING: [&str; 2] = ["view", "points"];

/// The fields of an entry of `sample`.
pub(crate) fn of_sample() -> Fields {
    let places = PLACE.iter().map(|name| Field::new(*name, DataType::Float32, false));
    places.chain([Field::new(ENDURES, DataType::UInt8, false)]).collect()
}

/// The fields of an entry of `seen`.
pub(crate) fn of_seen() -> Fields {
    SIGHTING.iter().map(|name| Field::new(*name, DataType::UInt32, false)).collect()
}

/// What an entry of a list is called by all who read Parquet.
pub(crate) fn entry(fields: Fields) -> Arc<Field> {
    Arc::new(Field::new("element", DataType::Struct(fields), false))
}

/// All columns.
pub(crate) fn schema() -> Schema {
    let of = |names: &'static [&'static str], of: DataType| {
        names.iter().map(move |name| Field::new(*name, of.clone(), false))
    };
    let list = |name, fields| Field::new(name, DataType::List(entry(fields)), false);
    let fields: Vec<Field> = of(&KEY, DataType::Int32)
        .chain([Field::new(POINTS, DataType::UInt64, false)])
        .chain(of(&SUM, DataType::Float64))
        .chain(of(&SECOND, DataType::Float64))
        .chain(of(&NOISE, DataType::Float64))
        .chain([
            list(SAMPLE, of_sample()),
            Field::new(HALVINGS, DataType::UInt8, false),
            list(SEEN, of_seen()),
        ])
        .collect();
    Schema::new(fields)
}
