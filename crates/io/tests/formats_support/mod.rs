//! Small writers of point files for the tests of the readers, and what several of those tests need.

#![allow(dead_code)]

pub mod memory;

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use proptest::prelude::*;
use terrace_io::{Cloud, FieldChoice, npy, pcd, ply, text};

/// Type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

pub const TYPES: [Type; 8] =
    [Type::I8, Type::U8, Type::I16, Type::U16, Type::I32, Type::U32, Type::F32, Type::F64];

/// One column of a point file.
#[derive(Debug, Clone)]
pub struct Column {
    pub name: String,
    pub ty: Type,
    pub values: Vec<f64>,
}

impl Type {
    pub fn ply(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uint8",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }

    pub fn pcd(self) -> (char, usize) {
        match self {
            Self::I8 => ('I', 1),
            Self::U8 => ('U', 1),
            Self::I16 => ('I', 2),
            Self::U16 => ('U', 2),
            Self::I32 => ('I', 4),
            Self::U32 => ('U', 4),
            Self::F32 => ('F', 4),
            Self::F64 => ('F', 8),
        }
    }

    pub fn encode(self, value: f64, big: bool) -> Vec<u8> {
        let mut bytes = match self {
            Self::I8 => (value as i8).to_le_bytes().to_vec(),
            Self::U8 => (value as u8).to_le_bytes().to_vec(),
            Self::I16 => (value as i16).to_le_bytes().to_vec(),
            Self::U16 => (value as u16).to_le_bytes().to_vec(),
            Self::I32 => (value as i32).to_le_bytes().to_vec(),
            Self::U32 => (value as u32).to_le_bytes().to_vec(),
            Self::F32 => (value as f32).to_le_bytes().to_vec(),
            Self::F64 => value.to_le_bytes().to_vec(),
        };
        if big {
            bytes.reverse();
        }
        bytes
    }

    /// Numbers this type can hold.
    pub fn values(self, count: usize) -> BoxedStrategy<Vec<f64>> {
        let one = match self {
            Self::I8 => any::<i8>().prop_map(f64::from).boxed(),
            Self::U8 => any::<u8>().prop_map(f64::from).boxed(),
            Self::I16 => any::<i16>().prop_map(f64::from).boxed(),
            Self::U16 => any::<u16>().prop_map(f64::from).boxed(),
            Self::I32 => any::<i32>().prop_map(f64::from).boxed(),
            Self::U32 => any::<u32>().prop_map(f64::from).boxed(),
            Self::F32 => prop::num::f32::ANY.prop_map(f64::from).boxed(),
            Self::F64 => prop::num::f64::ANY.boxed(),
        };
        prop::collection::vec(one, count).boxed()
    }
}

/// `x`, `y`, `z` and some other columns, of random types, values and order.
pub fn columns() -> impl Strategy<Value = Vec<Column>> {
    (0_usize..20, 0_usize..5)
        .prop_flat_map(|(count, others)| {
            let column = move |name: String| {
                prop::sample::select(&TYPES[..]).prop_flat_map(move |ty| {
                    let name = name.clone();
                    ty.values(count).prop_map(move |values| Column { name: name.clone(), ty, values })
                })
            };
            let names = ["x", "y", "z"].map(str::to_owned).into_iter();
            names.chain((0..others).map(|i| format!("other{i}"))).map(column).collect::<Vec<_>>()
        })
        .prop_shuffle()
}

/// The rows that a reader should find in three columns.
pub fn rows(columns: &[Column], names: [&str; 3]) -> Vec<[f64; 3]> {
    let of = |name: &str| &columns.iter().find(|c| c.name == name).unwrap().values;
    let [x, y, z] = names.map(of);
    (0..x.len()).map(|i| [x[i], y[i], z[i]]).collect()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlyEncoding {
    Ascii,
    Little,
    Big,
}

pub const PLY_ENCODINGS: [PlyEncoding; 3] = [PlyEncoding::Ascii, PlyEncoding::Little, PlyEncoding::Big];

/// What a PLY file has beside the scalar properties of its vertices.
#[derive(Debug, Clone, Copy, Default)]
pub struct PlyExtras {
    /// Faces before the vertices.
    pub faces_before: usize,
    /// Faces after the vertices.
    pub faces_after: usize,
    /// A list of varying length in the middle of each vertex.
    pub list: bool,
    /// Lines of the header end with CRLF.
    pub crlf: bool,
}

pub fn ply_bytes(columns: &[Column], encoding: PlyEncoding, extras: PlyExtras) -> Vec<u8> {
    let count = columns.first().map_or(0, |c| c.values.len());
    let name = match encoding {
        PlyEncoding::Ascii => "ascii",
        PlyEncoding::Little => "binary_little_endian",
        PlyEncoding::Big => "binary_big_endian",
    };
    let mut header = format!("ply\nformat {name} 1.0\ncomment made by a test\nobj_info none\n");
    let face = |header: &mut String, name: &str, count: usize| {
        if count > 0 {
            writeln!(header, "element {name} {count}\nproperty list uchar int vertex_indices").unwrap();
            writeln!(header, "property uchar flag").unwrap();
        }
    };
    face(&mut header, "face", extras.faces_before);
    writeln!(header, "element vertex {count}").unwrap();
    for (i, column) in columns.iter().enumerate() {
        if extras.list && i == columns.len() / 2 {
            writeln!(header, "property list uint16 double extra").unwrap();
        }
        writeln!(header, "property {} {}", column.ty.ply(), column.name).unwrap();
    }
    face(&mut header, "tail", extras.faces_after);
    header.push_str("end_header\n");
    if extras.crlf {
        header = header.replace('\n', "\r\n");
    }

    let mut bytes = header.into_bytes();
    let mut put = |values: &[(Type, f64)]| match encoding {
        PlyEncoding::Ascii => {
            let line: Vec<String> = values.iter().map(|(_, value)| value.to_string()).collect();
            bytes.extend(line.join(" ").into_bytes());
            bytes.extend(if extras.crlf { &b"\r\n"[..] } else { b"\n" });
        }
        _ => values
            .iter()
            .for_each(|(ty, value)| bytes.extend(ty.encode(*value, encoding == PlyEncoding::Big))),
    };
    let face = |i: usize| {
        let corners = i % 4;
        let mut record = vec![(Type::U8, corners as f64)];
        record.extend((0..corners).map(|c| (Type::I32, c as f64)));
        record.push((Type::U8, 7.0));
        record
    };
    (0..extras.faces_before).for_each(|i| put(&face(i)));
    for row in 0..count {
        let mut record = Vec::new();
        for (i, column) in columns.iter().enumerate() {
            if extras.list && i == columns.len() / 2 {
                record.push((Type::U16, (row % 3) as f64));
                record.extend((0..row % 3).map(|_| (Type::F64, 0.5)));
            }
            record.push((column.ty, column.values[row]));
        }
        put(&record);
    }
    (0..extras.faces_after).for_each(|i| put(&face(i)));
    bytes
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PcdData {
    Ascii,
    Binary,
    Compressed,
}

pub const PCD_DATA: [PcdData; 3] = [PcdData::Ascii, PcdData::Binary, PcdData::Compressed];

pub fn pcd_bytes(columns: &[Column], data: PcdData) -> Vec<u8> {
    let count = columns.first().map_or(0, |c| c.values.len());
    let list = |of: &dyn Fn(&Column) -> String| columns.iter().map(of).collect::<Vec<_>>().join(" ");
    let data_name = match data {
        PcdData::Ascii => "ascii",
        PcdData::Binary => "binary",
        PcdData::Compressed => "binary_compressed",
    };
    let mut bytes = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH {count}\n\
         HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {data_name}\n",
        list(&|c| c.name.clone()),
        list(&|c| c.ty.pcd().1.to_string()),
        list(&|c| c.ty.pcd().0.to_string()),
        list(&|_| "1".into()),
    )
    .into_bytes();
    match data {
        PcdData::Ascii => {
            for row in 0..count {
                let line: Vec<String> = columns.iter().map(|c| c.values[row].to_string()).collect();
                bytes.extend((line.join(" ") + "\n").into_bytes());
            }
        }
        PcdData::Binary => {
            for row in 0..count {
                bytes.extend(columns.iter().flat_map(|c| c.ty.encode(c.values[row], false)));
            }
        }
        PcdData::Compressed => {
            let fields: Vec<u8> =
                columns.iter().flat_map(|c| c.values.iter().flat_map(|v| c.ty.encode(*v, false))).collect();
            bytes.extend(packed(&fields));
        }
    }
    bytes
}

/// The two sizes and the LZF stream of `binary_compressed`.
pub fn packed(input: &[u8]) -> Vec<u8> {
    let stream = lzf(input);
    let mut bytes = (stream.len() as u32).to_le_bytes().to_vec();
    bytes.extend((input.len() as u32).to_le_bytes());
    bytes.extend(stream);
    bytes
}

/// Packs with the last place of each three bytes.
fn lzf(input: &[u8]) -> Vec<u8> {
    let (mut stream, mut literal, mut seen, mut at) = (Vec::new(), Vec::new(), HashMap::new(), 0);
    let flush = |stream: &mut Vec<u8>, literal: &mut Vec<u8>| {
        for piece in literal.chunks(32) {
            stream.push((piece.len() - 1) as u8);
            stream.extend_from_slice(piece);
        }
        literal.clear();
    };
    while at < input.len() {
        let earlier = input.get(at..at + 3).and_then(|key| seen.insert(key, at)).filter(|e| at - e <= 8192);
        let Some(earlier) = earlier else {
            literal.push(input[at]);
            at += 1;
            continue;
        };
        flush(&mut stream, &mut literal);
        let length = input[earlier..].iter().zip(&input[at..]).take(264).take_while(|(a, b)| a == b).count();
        let distance = at - earlier - 1;
        let high = (distance >> 8) as u8;
        if length < 9 {
            stream.push(((length - 2) as u8) << 5 | high);
        } else {
            stream.extend([7 << 5 | high, (length - 9) as u8]);
        }
        stream.push(distance as u8);
        at += length;
    }
    flush(&mut stream, &mut literal);
    stream
}

/// An NPY file of version 1.0.
pub fn npy_bytes(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.into_bytes());
    bytes.extend(data);
    bytes
}

/// A good file of a variant, for tests that damage it.
pub struct Good {
    pub name: String,
    pub bytes: Vec<u8>,
    pub format: Format,
    /// Byte where the points start.
    pub body: usize,
    /// Whether the points are text.
    pub is_text: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Ply,
    Pcd,
    Text,
    Npy,
}

impl Format {
    pub fn read(self, bytes: &[u8]) -> Result<Cloud, String> {
        let choice = FieldChoice::Automatic;
        match self {
            Self::Ply => ply::read(bytes, &choice).map_err(|e| e.to_string()),
            Self::Pcd => pcd::read(bytes, &choice).map_err(|e| e.to_string()),
            Self::Text => text::read(bytes, &choice).map_err(|e| e.to_string()),
            Self::Npy => npy::read(bytes).map_err(|e| e.to_string()),
        }
    }
}

/// Columns x, y, z, sigma, intensity with `count` points.
pub fn plain_columns(count: usize) -> Vec<Column> {
    let column = |name: &str, ty, of: &dyn Fn(usize) -> f64| Column {
        name: name.to_owned(),
        ty,
        values: (0..count).map(of).collect(),
    };
    vec![
        column("x", Type::F32, &|i| i as f64 * 0.25),
        column("y", Type::F32, &|i| if i == 1 { f64::NAN } else { -1.5 }),
        column("z", Type::F64, &|i| 100.125 + i as f64),
        column("sigma", Type::F32, &|_| 0.0625),
        column("intensity", Type::U16, &|i| (i * 1000 % 65536) as f64),
    ]
}

/// A good file of every variant with `count` points.
pub fn good_files(count: usize) -> Vec<Good> {
    let columns = plain_columns(count);
    let mut files = Vec::new();
    let after = |bytes: &[u8], mark: &str| {
        let at = bytes.windows(mark.len()).position(|window| window == mark.as_bytes()).unwrap() + mark.len();
        at + bytes[at..].iter().position(|b| *b == b'\n').unwrap() + 1
    };
    for encoding in PLY_ENCODINGS {
        let variants = [
            ("plain", PlyExtras::default()),
            ("CRLF", PlyExtras { crlf: true, ..PlyExtras::default() }),
            ("list", PlyExtras { list: true, ..PlyExtras::default() }),
            ("faces", PlyExtras { faces_before: 5, faces_after: 5, ..PlyExtras::default() }),
        ];
        for (name, extras) in variants {
            let bytes = ply_bytes(&columns, encoding, extras);
            let body = after(&bytes, "end_header");
            let name = format!("PLY {encoding:?} {name}");
            files.push(Good {
                name,
                body,
                bytes,
                format: Format::Ply,
                is_text: encoding == PlyEncoding::Ascii,
            });
        }
    }
    for data in PCD_DATA {
        let bytes = pcd_bytes(&columns, data);
        // Once with POINTS alone, so that a wrong count is not already told from the width.
        let body = after(&bytes, "DATA");
        let width = format!("WIDTH {count}\nHEIGHT 1\n");
        let header = String::from_utf8_lossy(&bytes[..body]).replace(&width, "").into_bytes();
        let short = [&header[..], &bytes[body..]].concat();
        for (name, bytes, body) in [("", bytes, body), (" without width", short, header.len())] {
            let name = format!("PCD {data:?}{name}");
            files.push(Good { name, body, bytes, format: Format::Pcd, is_text: data == PcdData::Ascii });
        }
    }
    let values: Vec<f64> = rows(&columns, ["x", "y", "z"]).concat();
    let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    for fortran in [false, true] {
        let bytes = npy_bytes("<f8", fortran, &format!("({count}, 3)"), &data);
        let name = format!("NPY, Fortran order {fortran}");
        files.push(Good { name, body: bytes.len() - data.len(), bytes, format: Format::Npy, is_text: false });
    }
    for (name, start, separator) in [
        ("counted", format!("{count}\n"), " "),
        ("named", "x,y,z,sigma,intensity\n".to_owned(), ","),
        ("commented", "//X Y Z sigma I\n# more\n\n".to_owned(), "\t"),
    ] {
        let mut bytes = start.clone().into_bytes();
        for row in 0..count {
            let line: Vec<String> = columns.iter().map(|c| c.values[row].to_string()).collect();
            bytes.extend((line.join(separator) + "\r\n").into_bytes());
        }
        let name = format!("text {name}");
        files.push(Good { name, bytes, format: Format::Text, body: start.len(), is_text: true });
    }
    files
}

/// A byte to set, a range to remove, or bytes to put in.
#[derive(Debug, Clone)]
pub enum Damage {
    Set(usize, u8),
    Remove(usize, usize),
    Insert(usize, Vec<u8>),
    Number(usize, u64),
}

/// Some damage to any file.
pub fn damage() -> impl Strategy<Value = Damage> {
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(at, byte)| Damage::Set(at, byte)),
        (any::<usize>(), 0_usize..40).prop_map(|(at, length)| Damage::Remove(at, length)),
        (any::<usize>(), prop::collection::vec(any::<u8>(), 0..20)).prop_map(|(at, b)| Damage::Insert(at, b)),
        (any::<usize>(), prop_oneof![0_u64..70_000, any::<u64>()]).prop_map(|(at, n)| Damage::Number(at, n)),
    ]
}

pub fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    let place = |at: usize| at % (bytes.len() + 1);
    match damage {
        Damage::Set(at, byte) => {
            let at = place(*at);
            if let Some(old) = bytes.get_mut(at) {
                *old = *byte;
            }
        }
        Damage::Remove(at, length) => {
            let at = place(*at);
            bytes.drain(at..(at + length).min(bytes.len()));
        }
        Damage::Insert(at, more) => {
            let at = place(*at);
            bytes.splice(at..at, more.iter().copied());
        }
        Damage::Number(at, number) => {
            // The next number in text becomes another.
            let at = place(*at);
            if let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit) {
                let start = at + start;
                let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
                bytes.splice(start..start + digits, number.to_string().into_bytes());
            }
        }
    }
}

/// Equal, where every NaN equals every other.
pub fn same(a: &[[f64; 3]], b: &[[f64; 3]]) -> bool {
    let equal = |a: &f64, b: &f64| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
    a.len() == b.len() && a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| equal(a, b))
}

/// The folder of real scans, if there is one: `TERRACE_DATA`, or `shared/data` beside the repository.
pub fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("TERRACE_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    if folder.is_dir() {
        Some(folder)
    } else {
        eprintln!("skipped: no scans at TERRACE_DATA or ../shared/data");
        None
    }
}
