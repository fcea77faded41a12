//! Which format the bytes of a file are in.

/// Formats of scans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Ply,
    Pcd,
    Npy,
    Png,
    Text,
    /// A format known by its first bytes that is not read, with what to do about it.
    Foreign(&'static str, &'static str),
    Unknown,
}

/// First bytes of formats that are not read, their name, and the way out.
const FOREIGN: [(&[u8], &str, &str); 12] = [
    (b"#ROSBAG", "a ROS 1 bag", "export its clouds to PCD first, as `rosrun pcl_ros bag_to_pcd` does"),
    (b"\x89MCAP0", "an MCAP recording", "export its clouds to PCD first"),
    (b"SQLite format 3", "a database, perhaps a ROS 2 bag", "export its clouds to PCD first"),
    (b"LASF", "LAS or LAZ", "convert it to PLY or PCD first, as PDAL and CloudCompare do"),
    (b"ASTM-E57", "E57", "convert it to PLY or PCD first, as PDAL and CloudCompare do"),
    (b"\xff\xd8\xff", "a JPEG image", "depth is read from 16-bit grey PNG"),
    (b"II*\0", "a TIFF image", "depth is read from 16-bit grey PNG"),
    (b"MM\0*", "a TIFF image", "depth is read from 16-bit grey PNG"),
    (b"P5", "a PGM image", "depth is read from 16-bit grey PNG"),
    (b"PAR1", "Parquet, perhaps a saved map", "give maps to `terrace merge`, and points as PLY, PCD or NPY"),
    (b"\x1f\x8b", "gzip", "unpack it first"),
    (b"PK\x03\x04", "a ZIP archive", "unpack it first"),
];

/// Finds the format by content, and by the extension (in lower case) where content does not tell.
pub(crate) fn detect(bytes: &[u8], extension: &str) -> Format {
    let first_line = || bytes.split(|b| *b == b'\n' || *b == b'\r').next().unwrap_or_default();
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Format::Png;
    }
    if bytes.starts_with(b"\x93NUMPY") {
        return Format::Npy;
    }
    if let Some((_, name, advice)) = FOREIGN.iter().find(|(magic, ..)| bytes.starts_with(magic)) {
        return Format::Foreign(name, advice);
    }
    if first_line().trim_ascii() == b"ply" {
        return Format::Ply;
    }
    if bytes.starts_with(b"# .PCD") || bytes.starts_with(b"VERSION ") {
        return Format::Pcd;
    }
    match extension {
        "ply" => Format::Ply,
        "pcd" => Format::Pcd,
        "npy" => Format::Npy,
        "png" => Format::Png,
        "xyz" | "csv" | "txt" | "asc" | "pts" => Format::Text,
        _ => Format::Unknown,
    }
}
