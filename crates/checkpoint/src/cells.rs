//! Cells as columns, and columns as cells.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Float32Type, Float64Type, Int32Type, UInt8Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, ListArray, PrimitiveArray, RecordBatch, StructArray};
use arrow_buffer::{OffsetBuffer, ScalarBuffer};
use arrow_schema::{Fields, Schema};
use parquet::errors::ParquetError;
use terrace::{MapCell, Moments, SampledPoint, Sighting, SymmetricMatrix3};

use crate::MapFileError;
use crate::schema::{
    ENDURES, HALVINGS, KEY, NOISE, PLACE, POINTS, SAMPLE, SECOND, SEEN, SIGHTING, SUM, entry, of_sample,
    of_seen,
};

/// Rows that are put together.
#[derive(Default)]
pub(crate) struct Columns {
    key: [Vec<i32>; 3],
    points: Vec<u64>,
    sum: [Vec<f64>; 3],
    second: [Vec<f64>; 6],
    noise: [Vec<f64>; 6],
    places: [Vec<f32>; 3],
    endures: Vec<u8>,
    sample_ends: Vec<i32>,
    halvings: Vec<u8>,
    sightings: [Vec<u32>; 2],
    seen_ends: Vec<i32>,
}

impl Columns {
    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// Adds a row, unless its sums are not finite.
    pub(crate) fn push(&mut self, cell: &MapCell) -> bool {
        let (sum, second, noise) = (cell.sums.sum(), cell.sums.second().0, cell.sums.noise().0);
        if !sum.iter().chain(&second).chain(&noise).all(|x| x.is_finite()) {
            return false;
        }
        add(&mut self.key, cell.key);
        self.points.push(cell.sums.count());
        add(&mut self.sum, sum);
        add(&mut self.second, second);
        add(&mut self.noise, noise);
        for SampledPoint { place, endures } in &*cell.sample {
            add(&mut self.places, *place);
            self.endures.push(*endures);
        }
        self.halvings.push(cell.halvings);
        cell.seen.iter().for_each(|sighting| add(&mut self.sightings, [sighting.view, sighting.points]));
        // A batch has some thousand rows: what cannot be counted would not fit into memory before.
        let end = |entries: usize| i32::try_from(entries).unwrap_or(i32::MAX);
        self.sample_ends.push(end(self.places[0].len()));
        self.seen_ends.push(end(self.sightings[0].len()));
        true
    }

    /// The rows so far, which are then no longer here.
    pub(crate) fn batch(&mut self, schema: &Arc<Schema>) -> Result<RecordBatch, ParquetError> {
        fn column<T: ArrowPrimitiveType>(values: Vec<T::Native>) -> ArrayRef {
            Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::from(values), None))
        }
        let Self {
            key,
            points,
            sum,
            second,
            noise,
            places,
            endures,
            sample_ends,
            halvings,
            sightings,
            seen_ends,
        } = std::mem::take(self);
        let sampled = places.map(column::<Float32Type>).into_iter().chain([column::<UInt8Type>(endures)]);
        let sample = list(of_sample(), sampled.collect(), sample_ends)?;
        let seen = list(of_seen(), sightings.map(column::<UInt32Type>).to_vec(), seen_ends)?;
        let columns: Vec<ArrayRef> = (key.into_iter().map(column::<Int32Type>))
            .chain([column::<UInt64Type>(points)])
            .chain(sum.into_iter().chain(second).chain(noise).map(column::<Float64Type>))
            .chain([sample, column::<UInt8Type>(halvings), seen])
            .collect();
        Ok(RecordBatch::try_new(Arc::clone(schema), columns)?)
    }
}

/// Adds a row to some columns.
fn add<T, const N: usize>(columns: &mut [Vec<T>; N], row: [T; N]) {
    columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
}

/// Lists of entries with these fields, given where each list ends.
fn list(fields: Fields, columns: Vec<ArrayRef>, ends: Vec<i32>) -> Result<ArrayRef, ParquetError> {
    let offsets = OffsetBuffer::new(std::iter::once(0).chain(ends).collect::<ScalarBuffer<i32>>());
    let entries = StructArray::try_new(fields.clone(), columns, None)?;
    Ok(Arc::new(ListArray::try_new(entry(fields), offsets, Arc::new(entries), None)?))
}

/// The columns of some rows that were read.
pub(crate) struct Rows<'b> {
    key: [&'b [i32]; 3],
    points: &'b [u64],
    sum: [&'b [f64]; 3],
    second: [&'b [f64]; 6],
    noise: [&'b [f64]; 6],
    places: [&'b [f32]; 3],
    endures: &'b [u8],
    sample_ends: &'b [i32],
    halvings: &'b [u8],
    sightings: [&'b [u32]; 2],
    seen_ends: &'b [i32],
}

impl<'b> Rows<'b> {
    /// Finds the columns by their names.
    pub(crate) fn of(batch: &'b RecordBatch) -> Result<Self, MapFileError> {
        let (sample_ends, sample) = entries(batch, SAMPLE)?;
        let (seen_ends, seen) = entries(batch, SEEN)?;
        Ok(Self {
            key: each(KEY, |name| values::<Int32Type>(batch.column_by_name(name), name))?,
            points: values::<UInt64Type>(batch.column_by_name(POINTS), POINTS)?,
            sum: each(SUM, |name| values::<Float64Type>(batch.column_by_name(name), name))?,
            second: each(SECOND, |name| values::<Float64Type>(batch.column_by_name(name), name))?,
            noise: each(NOISE, |name| values::<Float64Type>(batch.column_by_name(name), name))?,
            places: each(PLACE, |name| values::<Float32Type>(sample.column_by_name(name), SAMPLE))?,
            endures: values::<UInt8Type>(sample.column_by_name(ENDURES), SAMPLE)?,
            sample_ends,
            halvings: values::<UInt8Type>(batch.column_by_name(HALVINGS), HALVINGS)?,
            sightings: each(SIGHTING, |name| values::<UInt32Type>(seen.column_by_name(name), SEEN))?,
            seen_ends,
        })
    }

    /// Hands out all rows, in order.
    pub(crate) fn each<E>(&self, mut to: impl FnMut(&MapCell) -> Result<(), E>) -> Result<(), E> {
        let (mut sample, mut seen) = (Vec::new(), Vec::new());
        for row in 0..self.points.len() {
            let (second, noise) = (self.second.map(|of| of[row]), self.noise.map(|of| of[row]));
            sample.clear();
            let sampled =
                |at: usize| SampledPoint { place: self.places.map(|of| of[at]), endures: self.endures[at] };
            sample.extend(within(self.sample_ends, row).map(sampled));
            seen.clear();
            let sighting =
                |at: usize| Sighting { view: self.sightings[0][at], points: self.sightings[1][at] };
            seen.extend(within(self.seen_ends, row).map(sighting));
            to(&MapCell {
                key: self.key.map(|of| of[row]),
                sums: Moments::from_sums(
                    self.points[row],
                    self.sum.map(|of| of[row]),
                    SymmetricMatrix3(second),
                    SymmetricMatrix3(noise),
                ),
                sample: sample.as_slice().into(),
                halvings: self.halvings[row],
                seen: &seen,
            })?;
        }
        Ok(())
    }
}

/// The entries of a row; those of lists that were read are within their columns.
fn within(ends: &[i32], row: usize) -> std::ops::Range<usize> {
    let [start, end] = [ends[row], ends[row + 1]].map(|end| usize::try_from(end).unwrap_or(0));
    start..end
}

fn each<T: Copy + Default, const N: usize>(
    names: [&'static str; N],
    find: impl Fn(&'static str) -> Result<T, MapFileError>,
) -> Result<[T; N], MapFileError> {
    let mut found = [T::default(); N];
    for (found, name) in found.iter_mut().zip(names) {
        *found = find(name)?;
    }
    Ok(found)
}

/// The values of a column of this type without gaps.
fn values<'b, T: ArrowPrimitiveType>(
    column: Option<&'b ArrayRef>,
    name: &'static str,
) -> Result<&'b [T::Native], MapFileError> {
    let found = column.and_then(|column| column.as_primitive_opt::<T>());
    let array = found.ok_or_else(|| other(name, column, &T::DATA_TYPE.to_string()))?;
    without_gaps(array, name)?;
    Ok(array.values())
}

/// Where the lists of a column end, and their entries.
fn entries<'b>(
    batch: &'b RecordBatch,
    name: &'static str,
) -> Result<(&'b [i32], &'b StructArray), MapFileError> {
    let column = batch.column_by_name(name);
    let list = column.and_then(|column| column.as_list_opt::<i32>());
    let of_list = list.and_then(|list| Some((list, list.values().as_struct_opt()?)));
    let (list, entries) = of_list.ok_or_else(|| other(name, column, "a list of records"))?;
    without_gaps(list, name)?;
    without_gaps(entries, name)?;
    Ok((list.value_offsets(), entries))
}

fn without_gaps(array: &dyn Array, name: &'static str) -> Result<(), MapFileError> {
    if array.null_count() == 0 { Ok(()) } else { Err(MapFileError::Null { name }) }
}

fn other(name: &'static str, column: Option<&ArrayRef>, expected: &str) -> MapFileError {
    let found = column.map_or("missing".to_owned(), |column| column.data_type().to_string());
    MapFileError::Column { name, found, expected: expected.to_owned() }
}
