//! Binary records of fixed layout turned into coordinates.

/// Type of a number in a binary file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    Little,
    Big,
}

/// One number of every record: `offset` bytes into each stretch of `stride` bytes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column<'a> {
    pub bytes: &'a [u8],
    pub stride: usize,
    pub offset: usize,
    pub scalar: Scalar,
}

/// Calls a function with the decoder of a scalar type as its last argument, so that the inner loop is compiled for it.
macro_rules! with_decoder {
    ($scalar:expr, $call:ident($($argument:expr),*)) => {
        match $scalar {
            Scalar::I8 => $call($($argument,)* |b| f64::from(i8::from_le_bytes(b))),
            Scalar::U8 => $call($($argument,)* |b| f64::from(u8::from_le_bytes(b))),
            Scalar::I16 => $call($($argument,)* |b| f64::from(i16::from_le_bytes(b))),
            Scalar::U16 => $call($($argument,)* |b| f64::from(u16::from_le_bytes(b))),
            Scalar::I32 => $call($($argument,)* |b| f64::from(i32::from_le_bytes(b))),
            Scalar::U32 => $call($($argument,)* |b| f64::from(u32::from_le_bytes(b))),
            Scalar::I64 => $call($($argument,)* |b| i64::from_le_bytes(b) as f64),
            Scalar::U64 => $call($($argument,)* |b| u64::from_le_bytes(b) as f64),
            Scalar::F32 => $call($($argument,)* |b| f64::from(f32::from_le_bytes(b))),
            Scalar::F64 => $call($($argument,)* f64::from_le_bytes),
        }
    };
}

impl Scalar {
    /// Bytes of one number.
    pub(crate) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Whether it holds whole numbers only.
    pub(crate) const fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The number at the start of `bytes`; NaN when there are too few.
    pub(crate) fn read(self, bytes: &[u8], order: ByteOrder) -> f64 {
        with_decoder!(self, value(Some(bytes), order))
    }

    /// The whole number at the start of `bytes`, exactly; `None` for floating types and too few bytes.
    pub(crate) fn read_integer(self, bytes: &[u8], order: ByteOrder) -> Option<i128> {
        if !self.is_integer() {
            return None;
        }
        let bytes = bytes.get(..self.size())?;
        let bits = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        let number = match order {
            ByteOrder::Little => bytes.iter().rev().fold(0, bits),
            ByteOrder::Big => bytes.iter().fold(0, bits),
        };
        // Shifting up and back spreads the sign bit of the narrow signed types.
        let unused = 64 - 8 * self.size();
        Some(match self {
            Self::I8 | Self::I16 | Self::I32 | Self::I64 => {
                i128::from((number << unused).cast_signed() >> unused)
            }
            _ => i128::from(number),
        })
    }
}

/// Adds `count` rows of one number from each column. The caller has checked that the columns hold that many.
pub(crate) fn gather<const K: usize>(
    columns: [Column<'_>; K],
    order: ByteOrder,
    count: usize,
    into: &mut Vec<[f64; K]>,
) {
    if let Some(first) = columns.first()
        && columns.iter().all(|column| column.scalar == first.scalar)
    {
        return with_decoder!(first.scalar, rows(columns, order, count, into));
    }
    let start = into.len();
    into.resize(start + count, [f64::NAN; K]);
    for (k, column) in columns.into_iter().enumerate() {
        fill(into.get_mut(start..).unwrap_or_default(), k, column, order);
    }
}

/// Sets number `k` of each row from a column.
pub(crate) fn fill<const K: usize>(rows: &mut [[f64; K]], k: usize, column: Column<'_>, order: ByteOrder) {
    with_decoder!(column.scalar, fill_with(rows, k, column, order));
}

/// All columns at once, when they are of one type. What does not change from row to row is settled here, outside the
/// loops: the order of bytes, and whether the numbers of a row, or of all rows, follow each other.
fn rows<const K: usize, const N: usize>(
    columns: [Column<'_>; K],
    order: ByteOrder,
    count: usize,
    into: &mut Vec<[f64; K]>,
    decode: impl Fn([u8; N]) -> f64,
) {
    match order {
        ByteOrder::Little => ordered_rows(columns, count, into, decode),
        ByteOrder::Big => ordered_rows(columns, count, into, |mut bytes: [u8; N]| {
            bytes.reverse();
            decode(bytes)
        }),
    }
}

fn ordered_rows<const K: usize, const N: usize>(
    columns: [Column<'_>; K],
    count: usize,
    into: &mut Vec<[f64; K]>,
    decode: impl Fn([u8; N]) -> f64,
) {
    let Some(first) = columns.first().copied() else { return };
    let follow = |(k, column): (usize, &Column<'_>)| {
        std::ptr::eq(column.bytes, first.bytes)
            && column.stride == first.stride
            && column.offset == first.offset + k * N
    };
    let start = into.len();
    if columns.iter().enumerate().all(follow) {
        let bytes = first.bytes.get(first.offset..).unwrap_or_default();
        if first.stride == K * N {
            let records = bytes.as_chunks::<N>().0.as_chunks::<K>().0;
            into.extend(records.iter().take(count).map(|record| record.map(&decode)));
        } else {
            let records = bytes.chunks(first.stride.max(1)).take(count);
            let records = records.map(|record| record.as_chunks::<N>().0.first_chunk::<K>());
            into.extend(records.map(|record| record.map_or([f64::NAN; K], |record| record.map(&decode))));
        }
    } else {
        let mut columns = columns.map(Column::numbers);
        let number =
            |bytes: Option<&[u8]>| bytes.and_then(<[u8]>::first_chunk).map_or(f64::NAN, |b| decode(*b));
        into.extend((0..count).map(|_| columns.each_mut().map(|numbers| number(numbers.next()))));
    }
    into.resize(start + count, [f64::NAN; K]);
}

fn fill_with<const K: usize, const N: usize>(
    rows: &mut [[f64; K]],
    k: usize,
    column: Column<'_>,
    order: ByteOrder,
    decode: impl Fn([u8; N]) -> f64,
) {
    for (row, number) in rows.iter_mut().zip(column.numbers()) {
        row[k] = value(Some(number), order, &decode);
    }
}

impl<'a> Column<'a> {
    /// The bytes from each number of the column on.
    fn numbers(self) -> std::slice::Chunks<'a, u8> {
        self.bytes.get(self.offset..).unwrap_or_default().chunks(self.stride.max(1))
    }
}

#[inline]
fn value<const N: usize>(bytes: Option<&[u8]>, order: ByteOrder, decode: impl Fn([u8; N]) -> f64) -> f64 {
    bytes.and_then(<[u8]>::first_chunk).map_or(f64::NAN, |bytes| {
        let mut bytes = *bytes;
        if order == ByteOrder::Big {
            bytes.reverse();
        }
        decode(bytes)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::float_cmp, clippy::cast_possible_truncation)]
    fn every_type_in_both_orders() {
        let cases: [(Scalar, &[u8], f64); 10] = [
            (Scalar::I8, &[0xfe], -2.0),
            (Scalar::U8, &[0xfe], 254.0),
            (Scalar::I16, &[0xfe, 0xff], -2.0),
            (Scalar::U16, &[0xfe, 0xff], 65534.0),
            (Scalar::I32, &[0xfe, 0xff, 0xff, 0xff], -2.0),
            (Scalar::U32, &[0xfe, 0xff, 0xff, 0xff], 4_294_967_294.0),
            (Scalar::I64, &[0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff], -2.0),
            (Scalar::U64, &[0, 0, 0, 0, 0, 0, 0, 0x80], 9_223_372_036_854_775_808.0),
            (Scalar::F32, &[0, 0, 0x20, 0xc0], -2.5),
            (Scalar::F64, &[0, 0, 0, 0, 0, 0, 4, 0xc0], -2.5),
        ];
        for (scalar, little, expected) in cases {
            assert_eq!(scalar.size(), little.len());
            let big: Vec<u8> = little.iter().rev().copied().collect();
            assert_eq!(scalar.read(little, ByteOrder::Little), expected, "{scalar:?}");
            assert_eq!(scalar.read(&big, ByteOrder::Big), expected, "{scalar:?}");
            assert!(scalar.read(&little[1..], ByteOrder::Little).is_nan());
            let whole = scalar.is_integer().then_some(expected as i128);
            assert_eq!(scalar.read_integer(little, ByteOrder::Little), whole, "{scalar:?}");
            assert_eq!(scalar.read_integer(&big, ByteOrder::Big), whole, "{scalar:?}");
        }
    }

    fn gathered<const K: usize>(columns: [Column<'_>; K], order: ByteOrder, count: usize) -> Vec<[f64; K]> {
        let mut rows = vec![[f64::INFINITY; K]];
        gather(columns, order, count, &mut rows);
        assert!(rows.remove(0).iter().all(|x| x.is_infinite()), "rows that were there stay");
        rows
    }

    #[test]
    fn columns_of_different_types_and_places() {
        // Records of 7 bytes: u8, f32, i16.
        let records = [[9, 0, 0, 128, 63, 255, 255], [8, 0, 0, 0, 64, 2, 0]].concat();
        let column = |offset, scalar| Column { bytes: &records, stride: 7, offset, scalar };
        let mixed = [column(1, Scalar::F32), column(5, Scalar::I16), column(0, Scalar::U8)];
        assert_eq!(gathered(mixed, ByteOrder::Little, 2), [[1.0, -1.0, 9.0], [2.0, 2.0, 8.0]]);
        assert_eq!(gathered([column(1, Scalar::F32)], ByteOrder::Little, 2), [[1.0], [2.0]]);
    }

    #[test]
    fn columns_side_by_side_swapped_and_apart() {
        let bytes: Vec<u8> = (0..24).collect();
        for (stride, count) in [(2, 12), (3, 8), (5, 4), (24, 1)] {
            let column = |offset| Column { bytes: &bytes, stride, offset, scalar: Scalar::U8 };
            let expected = |a: usize, b: usize| -> Vec<[f64; 2]> {
                (0..count).map(|i| [a, b].map(|offset| (i * stride + offset) as f64)).collect()
            };
            for order in [ByteOrder::Little, ByteOrder::Big] {
                assert_eq!(gathered([column(0), column(1)], order, count), expected(0, 1), "{stride}");
                assert_eq!(gathered([column(1), column(0)], order, count), expected(1, 0), "{stride}");
                assert_eq!(gathered([column(0), column(0)], order, count), expected(0, 0), "{stride}");
            }
        }
        let wide = |offset| Column { bytes: &bytes, stride: 4, offset, scalar: Scalar::U16 };
        assert_eq!(gathered([wide(0), wide(2)], ByteOrder::Big, 2), [[1.0, 515.0], [1029.0, 1543.0]]);
        // What the bytes do not hold is no number.
        assert!(gathered([wide(0), wide(2)], ByteOrder::Big, 7)[6].iter().all(|x| x.is_nan()));
    }
}
