//! Maps into files.

use std::io::Write;
use std::sync::Arc;

use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_writer::ArrowWriterOptions;
use parquet::basic::{Compression, Encoding};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
use parquet::schema::types::ColumnPath;
use terrace::Mapper;

use crate::SaveError;
use crate::cells::Columns;
use crate::head::Head;
use crate::schema::{METADATA_KEY, NOISE, PLACE, SAMPLE, SECOND, SUM, schema};

/// Rows that are put together at once.
const BATCH: usize = 1 << 13;
/// Rows that a reader may hold at once.
const ROW_GROUP: usize = 1 << 16;

/// Writes a map as Parquet. The same map gives the same bytes.
///
/// # Errors
/// [`SaveError`] for a map that needs its points or has sums that are not finite, and when `out` cannot be written to.
pub fn write_map(mapper: &Mapper, out: impl Write + Send) -> Result<(), SaveError> {
    let parts = mapper.parts()?;
    let schema = Arc::new(schema());
    let options =
        ArrowWriterOptions::new().with_properties(properties(mapper)?).with_skip_arrow_metadata(true);
    let mut writer = ArrowWriter::try_new_with_options(out, Arc::clone(&schema), options)?;
    let mut columns = Columns::default();
    for cell in parts.cells() {
        if !columns.push(&cell) {
            return Err(SaveError::NotFinite { key: cell.key });
        }
        if columns.len() == BATCH {
            writer.write(&columns.batch(&schema)?)?;
        }
    }
    writer.write(&columns.batch(&schema)?)?;
    writer.close()?;
    Ok(())
}

fn properties(mapper: &Mapper) -> Result<WriterProperties, SaveError> {
    let head = KeyValue::new(METADATA_KEY.to_owned(), Head::write(mapper)?);
    let properties = WriterProperties::builder()
        .set_created_by(concat!("terrace-checkpoint ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_compression(Compression::SNAPPY)
        .set_max_row_group_row_count(Some(ROW_GROUP))
        .set_key_value_metadata(Some(vec![head]));
    // Hardly any two of these numbers are the same, but their exponents are alike.
    let split = |properties: WriterPropertiesBuilder, path: ColumnPath| {
        properties
            .set_column_dictionary_enabled(path.clone(), false)
            .set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT)
    };
    let sums = SUM.iter().chain(&SECOND).chain(&NOISE).map(|name| ColumnPath::from(*name));
    let place = |name: &&str| ColumnPath::new([SAMPLE, "list", "element", name].map(str::to_owned).to_vec());
    Ok(sums.chain(PLACE.iter().map(place)).fold(properties, split).build())
}
