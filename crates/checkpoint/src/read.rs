//! Files into maps.

use std::fs::File;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use bytes::Bytes;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReaderBuilder,
};
use parquet::errors::ParquetError;
use parquet::file::reader::ChunkReader;
use terrace::Mapper;

use crate::MapFileError;
use crate::cells::Rows;
use crate::guard::check_pages;
use crate::head::Head;
use crate::schema::{METADATA_KEY, schema};

/// What a Parquet file begins with.
const MAGIC: [u8; 4] = *b"PAR1";
/// Rows that are read at once.
const BATCH: usize = 1 << 13;

/// Reads a map from the bytes of a file, as [`write_map`](crate::write_map) writes them. It is one that
/// [forgets](Mapper::streaming) its points, and can grow on.
///
/// # Errors
/// [`MapFileError`] for anything else.
pub fn read_map(bytes: Vec<u8>) -> Result<Mapper, MapFileError> {
    read(Bytes::from(bytes))
}

/// Reads a map from a file as [`read_map`] does, without holding all its bytes.
///
/// # Errors
/// [`MapFileError`], which does not name the file.
pub fn open_map(path: &Path) -> Result<Mapper, MapFileError> {
    read(File::open(path)?)
}

/// Whether a file begins as Parquet does. `false` for one that cannot be read.
pub fn is_parquet(path: &Path) -> bool {
    let mut begin = [0; MAGIC.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut begin)).is_ok() && begin == MAGIC
}

fn read<R: ChunkReader + 'static>(file: R) -> Result<Mapper, MapFileError> {
    let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
    let metadata = contained(|| ArrowReaderMetadata::load(&file, options))?;
    let all = metadata.metadata();
    let entries = all.file_metadata().key_value_metadata().into_iter().flatten();
    let head = entries.filter(|entry| entry.key == METADATA_KEY).find_map(|entry| entry.value.as_deref());
    let mut builder = Head::read(head.ok_or(MapFileError::NoMap)?)?;

    let columns = schema();
    let known = ProjectionMask::columns(
        all.file_metadata().schema_descr(),
        columns.fields().iter().map(|field| field.name().as_str()),
    );
    check_pages(&file, all, |column| known.leaf_included(column))?;
    let reader = ParquetRecordBatchReaderBuilder::new_with_metadata(file, metadata);
    let mut reader = contained(|| reader.with_projection(known).with_batch_size(BATCH).build())?;
    let mut row = 0;
    while let Some(batch) = contained(|| reader.next().transpose().map_err(ParquetError::from))? {
        Rows::of(&batch)?.each(|cell| {
            let pushed = builder.push(cell).map_err(|error| MapFileError::Cell { row, error });
            row += 1;
            pushed
        })?;
    }
    builder.finish().map_err(MapFileError::Map)
}

/// What the reader of Parquet returns, or that it panicked: its decoders do on some damaged files, where the bytes of a page are not as many
/// as its values take. After that it is not used again.
fn contained<T>(read: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, MapFileError> {
    match catch_unwind(AssertUnwindSafe(read)) {
        Ok(outcome) => Ok(outcome?),
        Err(_) => Err(MapFileError::Undecodable),
    }
}
